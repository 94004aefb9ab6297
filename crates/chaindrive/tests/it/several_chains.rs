//! Scenes with several chains, shafts, couplings and gears.
#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use std::f64::consts::TAU;

use chaindrive::channel::{chains_along, labels};
use chaindrive::scene::{Scene, diff};
use chaindrive::{Axis, Description, Run, Simulation, Stepping, Summary};
use chaindrive_mechanics::Observation;

/// Sprockets of 20 and 20 teeth, ten pitches apart and a little more, with 40 links between them.
fn pair(chain: &str, x: f64, more: f64) -> String {
    let of = if chain.is_empty() {
        String::new()
    } else {
        format!("chain = \"{chain}\"\n")
    };
    format!(
        r#"
[[sprockets]]
name = "{chain} driver"
{of}teeth = 20
centre = [{x}, 0]
motion = {{ kind = "constant", speed = 30 }}
[[sprockets]]
name = "{chain} driven"
{of}teeth = 20
centre = [{x}, {}]
inertia = 2e-3
load = [{{ kind = "constant", torque = -2 }}]
"#,
        0.127 + more
    )
}

const CHAIN: &str = r#"
pitch = "12.7 mm"
links = 40
mass = "3.81 g"
stiffness = "20 MN/m"
roller_diameter = "7.75 mm"
"#;

fn scene(text: &str) -> Scene {
    Scene::from_toml(text, "test").unwrap_or_else(|error| panic!("{error}"))
}

fn one(x: f64, more: f64, chain: &str) -> Scene {
    let pair = pair("", x, more);
    scene(&format!("[chain]{chain}\n[route]\npretension = 60\n{pair}"))
}

/// Two chains beside each other that nothing joins.
fn apart(chain: &str) -> Scene {
    let named = |name: &str| {
        format!("[[chains]]\nname = \"{name}\"{chain}\n[chains.route]\npretension = 60\n")
    };
    let (left, right) = (pair("left", 0.0, 0.0), pair("right", 2.0, 0.3e-3));
    scene(&format!("{}{}{left}{right}", named("left"), named("right")))
}

/// The last sample of a short run.
fn last(scene: &Scene, run: &Run) -> Observation {
    let drive = scene.drive().unwrap_or_else(|error| panic!("{error}"));
    let mut simulation = Simulation::start(&drive, run).unwrap();
    while simulation.next_sample().unwrap().is_some() {}
    simulation.observation().clone()
}

/// Chains that nothing joins settle, move and pull as each would in a drive of its own: to the last bit, with springs for links as
/// with play in the joints.
#[test]
fn chains_that_nothing_joins_are_drives_of_their_own() {
    let particles = CHAIN.to_owned();
    let play = "\ntype = \"081\"\nlinks = 40\nmodel = \"clearance-joints\"\n".to_owned();
    for (chain, stepping, step) in [
        (particles, Stepping::Verlet, 1e-6),
        (play, Stepping::ImplicitDamping, 2e-6),
    ] {
        let run = Run {
            until: 2e-3,
            every: 1e-3,
            stepping,
            step: Some(step),
            ..Run::default()
        };
        let alone = [(0.0, 0.0), (2.0, 0.3e-3)].map(|(x, more)| last(&one(x, more, &chain), &run));
        let both = last(&apart(&chain), &run);
        let fields: [fn(&Observation) -> &Vec<f64>; 8] = [
            |o| &o.roller_x,
            |o| &o.roller_vy,
            |o| &o.link_tension,
            |o| &o.contact_force,
            |o| &o.sprocket_angle,
            |o| &o.sprocket_speed,
            |o| &o.sprocket_torque,
            |o| &o.span_tension,
        ];
        for (i, of) in fields.into_iter().enumerate() {
            let bits = |values: &[f64]| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
            let joined = [of(&alone[0]).clone(), of(&alone[1]).clone()].concat();
            assert_eq!(bits(of(&both)), bits(&joined), "{stepping:?}, field {i}");
            assert!(joined.iter().any(|v| v.abs() > 0.0), "field {i}");
        }
    }
}

/// Theory: two inertias on a spring swing against each other with f = √(k (1/J₁ + 1/J₂))/2π.
#[test]
fn two_masses_on_a_shaft_have_their_frequency() {
    let (stiffness, inertias) = (400.0_f64, [2e-3, 5e-3]);
    let shafts = format!(
        r#"
[[shafts]]
name = "first"
inertia = {}
[[shafts]]
name = "second"
inertia = {}
[[couplings]]
name = "spring"
between = ["first", "second"]
stiffness = "{stiffness} N m/rad"
"#,
        inertias[0], inertias[1]
    );
    let text = format!("{}{shafts}", one(0.0, 0.0, CHAIN).text());
    let drive = scene(&text).drive().unwrap();
    let exact = (stiffness * (1.0 / inertias[0] + 1.0 / inertias[1])).sqrt() / TAU;

    let mut assembled = drive.assemble().unwrap();
    let frequencies = assembled.modes().unwrap().frequencies();
    let nearest = frequencies.iter().map(|f| (f / exact - 1.0).abs());
    let nearest = nearest.fold(f64::INFINITY, f64::min);
    assert!(nearest < 1e-9, "{nearest}");

    // Kicked apart without net momentum; the crossings of the torque tell the period.
    let place = |name: &str| {
        let called = format!("the angle of shaft `{name}`");
        let mut dofs = 0..assembled.q.len();
        dofs.find(|&dof| assembled.system.place(dof) == called)
            .unwrap()
    };
    let [i, j] = [place("first"), place("second")];
    assembled.v[i] += 1e-3 / inertias[0];
    assembled.v[j] -= 1e-3 / inertias[1];
    let run = Run {
        until: 10.0 / exact,
        every: 1e-5,
        stepping: Stepping::Verlet,
        step: Some(2e-6),
        ..Run::default()
    };
    let mut simulation = Simulation::from_assembled(assembled, &run).unwrap();
    let (mut crossings, mut before) = (Vec::new(), (0.0, 0.0));
    while let Some(sample) = simulation.next_sample().unwrap() {
        let (time, torque) = (sample.time, sample.coupling_torque[0]);
        if before.1 < 0.0 && torque >= 0.0 {
            let share = torque / (torque - before.1);
            crossings.push(time - share * (time - before.0));
        }
        before = (time, torque);
    }
    let turns = crossings.len() - 1;
    let period = (crossings[turns] - crossings[0]) / turns as f64;
    assert!(turns > 7 && (period * exact - 1.0).abs() < 1e-3, "{period}");
}

/// Gears turn shafts against each other in the ratio of their teeth, or the same way if one runs within the other.
#[test]
fn gears_turn_shafts_in_the_ratio_of_their_teeth() {
    for (mesh, sign) in [("", -1.0), ("mesh = \"internal\"", 1.0)] {
        let gears = format!(
            r#"
[[shafts]]
name = "pump"
inertia = 1e-3
load = [{{ kind = "resistance", linear = "1e-3 N m s" }}]
[[gears]]
name = "pump drive"
between = [" driven", "pump"]
teeth = [30, 20]
{mesh}
"#
        );
        let text = format!("{}{gears}", one(0.0, 0.0, CHAIN).text());
        let run = Run {
            until: 5e-3,
            every: 1e-3,
            step: Some(1e-6),
            ..Run::default()
        };
        let sample = last(&scene(&text), &run);
        let ratio = sign * 1.5;
        let [angle, speed] = [sample.sprocket_angle[1], sample.sprocket_speed[1]];
        assert!((sample.shaft_angle[0] - ratio * angle).abs() < 1e-12);
        assert!((sample.shaft_speed[0] - ratio * speed).abs() < 1e-9);
        assert!(speed > 25.0, "{speed}");
    }
}

/// Largest energy unaccounted for, over the energy supplied, and that.
fn ledger(preset: &str, run: &Run) -> (f64, f64) {
    let drive = Scene::preset(preset).unwrap().drive().unwrap();
    let mut simulation = Simulation::start(&drive, run).unwrap();
    let mut summary = Summary::new(&simulation);
    while let Some(sample) = simulation.next_sample().unwrap() {
        summary.push(sample);
    }
    let supplied = summary.energy_supplied();
    (summary.residual.abs() / supplied, supplied)
}

/// The reference method closes the ledger of both presets to 1e-5 of the energy supplied.
#[test]
fn the_presets_account_for_their_energy() {
    for (preset, least) in [("two_stage_timing", 1.0), ("bicycle_crank", 0.02)] {
        let (share, supplied) = ledger(preset, &Run::reference(2e-3, 1e-4));
        assert!(share < 1e-5, "{preset}: {share:.2e} of {supplied:.3e} J");
        assert!(supplied > least, "{preset}: {supplied} J");
    }
}

/// The same for as long as the scenes ask.
#[test]
#[ignore = "takes minutes"]
fn the_presets_account_for_their_energy_to_the_end() {
    for preset in ["two_stage_timing", "bicycle_crank"] {
        let until = Scene::preset(preset).unwrap().run_defaults().until.unwrap();
        let (share, supplied) = ledger(preset, &Run::reference(until, 1e-3));
        assert!(share < 1e-5, "{preset}: {share:.2e} of {supplied:.3e} J");
    }
}

/// Both stages of the timing drive turn in the ratio of their teeth, and the shaft between them carries both chains.
#[test]
fn the_timing_drive_has_two_stages() {
    let scene = Scene::preset("two_stage_timing").unwrap();
    let drive = scene.drive().unwrap();
    let run = Run::suggested(&scene.run_defaults());
    let run = Run { until: 2e-3, ..run };
    let told = Description::of(&drive, &run).unwrap();
    let names: Vec<_> = told.chains.iter().map(|it| it.name.as_deref()).collect();
    assert_eq!(names, [Some("primary"), Some("secondary")]);
    assert!(told.chains.iter().all(|it| it.closing.is_some()));
    let of = |chain: &str| {
        let stops = told.stops.iter();
        stops
            .filter(|it| it.chain.as_deref() == Some(chain))
            .count()
    };
    assert_eq!([of("primary"), of("secondary")], [4, 4]);
    // A chain of 76 and one of 84 links: all pitches are either on a stop or in a span.
    for (chain, links) in [("primary", 76), ("secondary", 84)] {
        let on = told
            .stops
            .iter()
            .filter(|it| it.chain.as_deref() == Some(chain));
        let between = told
            .spans
            .iter()
            .filter(|it| it.chain.as_deref() == Some(chain));
        let pitches: usize = on.map(|it| it.pitches as usize).sum::<usize>()
            + between.map(|it| it.pitches).sum::<usize>();
        assert_eq!(pitches, links);
    }
    let shaft = &told.shafts[0];
    assert_eq!(shaft.sprockets, ["intermediate", "pinion"]);
    assert!((shaft.speed / (-50.0 * TAU * 21.0 / 28.0) - 1.0).abs() < 1e-9);
    let text = told.to_string();
    for fragment in ["chain primary", "chain secondary", "intermediate shaft"] {
        assert!(text.contains(fragment), "{text}");
    }
    // Every span carries tension at rest, and more on the run that pulls.
    let tension = |name: &str| {
        let span = told.spans.iter().find(|it| it.name == name);
        span.unwrap_or_else(|| panic!("{name}")).tension
    };
    assert!(tension("crank-lower rail") > 1.2 * tension("lower shoe-crank"));
    assert!(tension("pinion-upper rail") > 1.2 * tension("upper shoe-pinion"));

    let simulation = Simulation::start(&drive, &run).unwrap();
    let system = simulation.system();
    for (axis, counts) in [
        (Axis::Roller, [76, 84]),
        (Axis::Link, [76, 84]),
        (Axis::Span, [2, 2]),
    ] {
        let chains = chains_along(axis, system).unwrap();
        let expected = [vec!["primary"; counts[0]], vec!["secondary"; counts[1]]].concat();
        assert_eq!(chains, expected);
        assert_eq!(labels(axis, system).unwrap().len(), chains.len());
    }
    assert_eq!(chains_along(Axis::Sprocket, system), None);
}

/// The rider turns the wheel through the spring of the hub: the mean torque of the coupling is that of the legs over the ratio.
#[test]
fn the_rider_drives_the_wheel_through_a_spring() {
    let scene = Scene::preset("bicycle_crank").unwrap();
    let run = Run {
        until: 5e-3,
        every: 1e-4,
        ..Run::suggested(&scene.run_defaults())
    };
    let drive = scene.drive().unwrap();
    let mut simulation = Simulation::start(&drive, &run).unwrap();
    let (mut sum, mut count) = (0.0, 0.0);
    while let Some(sample) = simulation.next_sample().unwrap() {
        sum += sample.coupling_torque[0];
        count += 1.0;
        assert!((sample.shaft_speed[2] / (-220.0 / 60.0 * TAU) - 1.0).abs() < 1e-12);
    }
    // The hub is turned against the wheel, clockwise: the spring pulls it back. At the dead centre the legs give 3 N m.
    let mean = sum / count;
    assert!(mean > 0.5 * 3.0 * 18.0 / 44.0 && mean < 20.0, "{mean}");
}

/// Values addressed by path can be read, replaced, compared and resolved, in chains and shafts as elsewhere.
#[test]
fn paths_lead_into_chains_and_shafts() {
    let scene = Scene::preset("two_stage_timing").unwrap();
    for (path, value, told) in [
        (
            "chains.secondary.links",
            "86",
            "chains.secondary.links: 84 | 86",
        ),
        (
            "chains.primary.route.pretension",
            "\"300 N\"",
            "chains.primary.route.pretension: 200.0 N | 300.0 N",
        ),
        (
            "shafts.intermediate shaft.inertia",
            "2e-4",
            "shafts.intermediate shaft.inertia: 0.0001 kg m^2 | 0.0002 kg m^2",
        ),
    ] {
        let changed = scene
            .replace(path, value)
            .unwrap_or_else(|error| panic!("{error}"));
        if path.ends_with("links") {
            // The camshaft moves away by as much.
            assert!(changed.datum(path).is_some());
            continue;
        }
        let differences = diff(&scene, &changed).unwrap();
        let found: Vec<String> = differences.iter().map(ToString::to_string).collect();
        assert_eq!(found, [told]);
    }
    let bicycle = Scene::preset("bicycle_crank").unwrap();
    let stiffer = bicycle
        .replace("couplings.spokes and tyre.stiffness", "\"3 kN m/rad\"")
        .unwrap();
    let differences = diff(&bicycle, &stiffer).unwrap();
    assert_eq!(
        differences[0].to_string(),
        "couplings.spokes and tyre.stiffness: 2000.0 N m/rad | 3000.0 N m/rad"
    );
}

/// Chains that differ have joints that differ: what is left open is written into each.
#[test]
fn chains_that_differ_are_resolved_each_for_itself() {
    let text = r#"
[[chains]]
name = "a"
type = "081"
model = "clearance-joints"
[[chains]]
name = "b"
type = "16B-1"
model = "clearance-joints"
[[sprockets]]
name = "a1"
chain = "a"
teeth = 20
centre = [0, 0]
motion = { kind = "constant", speed = 10 }
[[sprockets]]
name = "a2"
chain = "a"
teeth = 20
centre = ["127 mm", 0]
inertia = 1e-3
[[sprockets]]
name = "b1"
chain = "b"
teeth = 20
centre = ["127 mm", 0]
[[sprockets]]
name = "b2"
chain = "b"
teeth = 20
centre = ["381 mm", 0]
inertia = 1e-3
[[shafts]]
name = "middle"
sprockets = ["b1"]
inertia = 1e-3
[[couplings]]
name = "spring"
between = ["a2", "middle"]
stiffness = 100
"#;
    let scene = scene(text);
    let full = scene.resolved().unwrap();
    let told = |scene: &Scene| format!("{:?}", scene.drive().unwrap());
    assert_eq!(told(&scene), told(&full), "{}", full.text());
    let lengths: Vec<&str> = full
        .text()
        .lines()
        .filter(|line| line.starts_with("law = ") && line.contains("cylindrical"))
        .collect();
    assert!(lengths.is_empty(), "{lengths:?}");
    for place in ["[chains.joint.contact.law]", "[chains.joint]"] {
        assert_eq!(full.text().matches(place).count(), 2, "{}", full.text());
    }
    assert!(diff(&scene, &full).unwrap().is_empty());
}
