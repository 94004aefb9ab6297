//! Forces from outside on centres and carriers: statics, vibration, the ledger, bearings, and what may be said of them.
#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use std::f64::consts::TAU;

use chaindrive::{
    Assembled, Channel, Control, Flow, Modes, Observation, Run, Scene, Simulation, Snapshot,
    Stepping,
};

use crate::live::bits;

/// Two equal sprockets that are held, ten pitches apart: two spans of ten links, nothing is lost. The second centre moves as the text says.
const PAIR: &str = r#"
gravity = [0, 0]
[chain]
pitch = "12.7 mm"
links = 40
mass = "10 g"
stiffness = "20 MN/m"
damping = 0
roller_diameter = "7.75 mm"
[contact.teeth]
law = { kind = "linear", stiffness = "50 MN/m" }
restitution = 1
series = 0
friction = "none"
[contact.joints]
friction = "none"
[[sprockets]]
name = "held"
teeth = 20
centre = [0, 0]
motion = "held"
[[sprockets]]
name = "moved"
teeth = 20
centre = ["127 mm", 0]
motion = "held"
mass = "1 kg"
SUPPORT
[route]
stops = ["held", "moved"]
pretension = "2 kN"
"#;

const SPRINGS: &str =
    r#"support = { kind = "springs", stiffness = ["1 MN/m", "1 MN/m"], damping = [0, 0] }"#;

fn pair(support: &str) -> Scene {
    Scene::from_text(&PAIR.replace("SUPPORT", support), "pair").unwrap()
}

fn assembled(scene: &Scene) -> Assembled {
    let drive = scene.drive().unwrap_or_else(|error| panic!("{error}"));
    drive.assemble().unwrap_or_else(|error| panic!("{error}"))
}

fn moving(assembled: &Assembled, stepping: Stepping) -> Simulation {
    let run = Run {
        stepping,
        ..Run::default()
    };
    Simulation::from_assembled(assembled.clone(), &run).unwrap()
}

fn at_start(scene: &Scene) -> Observation {
    let mut simulation = moving(&assembled(scene), Stepping::Auto);
    simulation.advance_to(0.0).unwrap().clone()
}

/// Displacement of a centre under a force at it along an axis \[m/N\]: along that axis, and across.
///
/// ```text
/// K⁻¹ = Σ φ φᵀ/ω²      φᵀ M φ = 1
/// ```
fn compliance(modes: &Modes, sprocket: usize, axis: usize) -> [f64; 2] {
    let of = |seen: usize| {
        let shape = |mode: &chaindrive::Mode| {
            let [x, y] = [mode.sprocket_x[sprocket], mode.sprocket_y[sprocket]];
            [[x, y][axis], [x, y][seen]]
        };
        let each = modes.modes.iter().map(|mode| {
            let [pushed, moved] = shape(mode);
            let shares = pushed * moved;
            let squared = (TAU * mode.frequency).powi(2).copysign(mode.frequency);
            if shares == 0.0 { 0.0 } else { shares / squared }
        });
        each.sum::<f64>()
    };
    [of(axis), of(1 - axis)]
}

#[test]
fn a_small_force_moves_a_sprung_centre_as_the_linearised_drive_says() {
    // Along the spans, where the chain takes its part.
    for (preset, name, axis, stiffness, force) in [
        ("marine_two_sprockets", "camshaft", 1, 2e8, 2.0),
        ("industrial_16b", "driven", 0, 5e7, 0.1),
        ("bicycle_particles", "rear", 0, 5e6, 0.01),
    ] {
        let springs = format!(
            "{{ kind = \"springs\", stiffness = [{stiffness}, {stiffness}], damping = [0, 0] }}"
        );
        let scene = match preset {
            "bicycle_particles" => {
                let scene = Scene::preset("bicycle").unwrap();
                scene.replace("chain.model", "\"particles\"").unwrap()
            }
            preset => Scene::preset(preset).unwrap(),
        };
        let place = |key: &str| format!("sprockets.{name}.{key}");
        let scene = scene.replace(&place("support"), &springs).unwrap();
        let scene = scene.replace(&place("mass"), "5").unwrap();
        let pushed = format!("[{{ kind = \"constant\", force = {force} }}]");
        let pushed = scene
            .replace(&place(["force_x", "force_y"][axis]), &pushed)
            .unwrap();
        let before = assembled(&scene);
        let [along, across] = compliance(&before.modes().unwrap(), 1, axis);
        let [before, after] = [at_start(&scene), at_start(&pushed)];
        let moved = [
            after.sprocket_x[1] - before.sprocket_x[1],
            after.sprocket_y[1] - before.sprocket_y[1],
        ];
        let moved = [moved[axis], moved[1 - axis]];
        assert!(
            (moved[0] / (along * force) - 1.0).abs() < 1e-3
                && (moved[1] - across * force).abs() < 1e-3 * along * force,
            "{preset}: {moved:?} of {along:e} {across:e}"
        );
        // The chain takes its part: springs alone would move further.
        assert!(along * stiffness < 0.999, "{preset}: {}", along * stiffness);
    }
}

/// Springs a thousand times as stiff as the spans leave nothing for the chain.
#[test]
fn springs_alone_count_where_they_are_far_stiffer_than_the_spans() {
    // Two spans of ten links have 4 MN/m.
    let stiff = SPRINGS.replace("\"1 MN/m\"", "\"4 GN/m\"");
    let pushed = format!("{stiff}\nforce_x = [{{ kind = \"constant\", force = \"1 kN\" }}]");
    let [before, after] = [at_start(&pair(&stiff)), at_start(&pair(&pushed))];
    let moved = after.sprocket_x[1] - before.sprocket_x[1];
    assert!((moved / (1e3 / 4e9) - 1.0).abs() < 1e-3, "{moved:e}");
}

/// A shaft that carries nothing shakes the centre at a natural frequency, which swings ever farther.
///
/// ```text
/// x = Σ φ² F/(ω² − Ω²) (sin Ωt − Ω/ω sin ωt);   at Ω = ω   φ² F/2ω² (sin ωt − ωt cos ωt)
/// ```
#[test]
fn a_force_by_orders_meets_the_resonance_that_the_modes_tell() {
    let modes = assembled(&pair(SPRINGS)).modes().unwrap();
    let share = |mode: &&chaindrive::Mode| mode.sprocket_x[1].abs();
    let largest = modes
        .modes
        .iter()
        .max_by(|a, b| share(a).total_cmp(&share(b)));
    let shaken = TAU * largest.unwrap().frequency;
    let force = 0.01;
    let scene = format!(
        "{SPRINGS}\nforce_x = [{{ kind = \"orders\", of = \"shaker\", terms = [{{ order = 1, amplitude = {force} }}] }}]\n\
         [[shafts]]\nname = \"shaker\"\nmotion = {{ kind = \"constant\", speed = {shaken} }}"
    );
    let start = at_start(&pair(SPRINGS)).sprocket_x[1];
    let mut simulation = moving(&assembled(&pair(&scene)), Stepping::Rk4);
    let exact = |t: f64| {
        let each = modes.modes.iter().map(|mode| {
            let (own, shares) = (TAU * mode.frequency, mode.sprocket_x[1].powi(2) * force);
            if shares == 0.0 {
                0.0
            } else if (own / shaken - 1.0).abs() < 1e-12 {
                shares / (2.0 * own * own) * ((own * t).sin() - own * t * (own * t).cos())
            } else {
                shares / (own * own - shaken * shaken)
                    * ((shaken * t).sin() - shaken / own * (own * t).sin())
            }
        });
        each.sum::<f64>()
    };
    let (mut off, mut greatest) = (0.0_f64, 0.0_f64);
    for k in 1..=30 {
        let t = f64::from(k) * 0.1 * TAU / shaken;
        let moved = simulation.advance_to(t).unwrap().sprocket_x[1] - start;
        off = off.max((moved - exact(t)).abs());
        greatest = greatest.max(exact(t).abs());
    }
    assert!(off < 1e-3 * greatest, "{off:e} of {greatest:e}");
    // Three periods: π n times the static displacement of the mode.
    let at_rest = compliance(&modes, 1, 0)[0] * force;
    assert!(greatest > 5.0 * at_rest, "{greatest:e} {at_rest:e}");
}

/// F·d = 2 T d·x: the part along the way is on the spans, the rest on the guide.
#[test]
fn a_force_on_a_slide_tightens_the_spans_as_statics_has_it() {
    let carried = r#"support = { kind = "tensioner", name = "slide" }"#;
    let slide = r#"
[[tensioners]]
name = "slide"
carrier = { kind = "slider", direction = [0.8, 0.6], mass = "1 kg" }
push = { kind = "spring", preload = 0, stiffness = 1 }"#;
    let (x, y) = (3e3, -1e3);
    let forces = format!(
        "force_x = [{{ kind = \"constant\", force = {x} }}]\nforce_y = [{{ kind = \"constant\", force = {y} }}]"
    );
    let on_centre = pair(&format!("{carried}\n{forces}\n{slide}"));
    let on_carrier = pair(&format!("{carried}\n{slide}\n{forces}"));
    let along = 0.8 * x + 0.6 * y;
    for (scene, bears) in [(on_centre, true), (on_carrier, false)] {
        let seen = at_start(&scene);
        // Spans lean as far as the slide has moved.
        let way = [seen.sprocket_x[1], seen.sprocket_y[1]];
        let away = way[0].hypot(way[1]);
        let lean = (0.8 * way[0] + 0.6 * way[1]) / away;
        for tension in &seen.span_tension {
            let expected = along / (2.0 * lean);
            assert!((tension / expected - 1.0).abs() < 1e-3, "{tension}");
        }
        let support = [seen.support_force_x[1], seen.support_force_y[1]];
        let pushed = 0.8 * support[0] + 0.6 * support[1];
        let by_carrier = if bears { 0.0 } else { along };
        assert!((pushed - by_carrier).abs() < 1e-5 * along, "{support:?}");
        let given = [seen.centre_force_x[1], seen.carrier_force_x[0]];
        let named = if bears { [x, 0.0] } else { [0.0, x] };
        assert_eq!(given.map(f64::to_bits), named.map(f64::to_bits));
    }
}

/// r × F about the pivot of an arm, whose point is named.
#[test]
fn a_force_on_an_arm_acts_by_its_lever() {
    let arm = |force: f64| {
        pair(&format!(
            r#"support = {{ kind = "tensioner", name = "arm" }}
[[tensioners]]
name = "arm"
carrier = {{ kind = "arm", pivot = ["127 mm", "-300 mm"], inertia = "0.1 kg m^2" }}
push = {{ kind = "torsion-spring", preload = 0, stiffness = 1e-3 }}
force_x = [{{ kind = "constant", force = {force} }}]
force_at = ["127 mm", "100 mm"]"#
        ))
    };
    let force = 3e3;
    let seen = at_start(&arm(force));
    let turned = seen.tensioner_position[0];
    // F · 0.4 m cos φ = 2 T (lever of the spans)
    let centre = [seen.sprocket_x[1], seen.sprocket_y[1]];
    let lean = centre[1].atan2(centre[0]);
    let lever = (centre[1] + 0.3) * lean.cos() - (centre[0] - 0.127) * lean.sin();
    let expected = force * 0.4 * turned.cos() / (2.0 * lever);
    for tension in &seen.span_tension {
        assert!(
            (tension / expected - 1.0).abs() < 1e-3,
            "{tension} {expected}"
        );
    }
    let modes = assembled(&arm(force)).modes().unwrap();
    assert!(modes.is_stable());
}

/// W = F Δx to the last digits, whatever sets the force; what is stored and moves comes from there.
#[test]
fn the_work_of_a_force_on_springs_stands_in_the_ledger() {
    let mut simulation = moving(&assembled(&pair(SPRINGS)), Stepping::Rk4);
    simulation.advance_to(0.0).unwrap();
    let control = Control::ForceX("moved".into());
    simulation.set(&control, 200.0).unwrap();
    // A step ends where something changes.
    simulation.set_at(2e-3, &control, 0.0).unwrap();
    let start = simulation.observation().clone();
    let end = simulation.advance_to(2e-3).unwrap().clone();
    let work = end.energy.flow(Flow::Forces);
    let exact = 200.0 * (end.sprocket_x[1] - start.sprocket_x[1]);
    assert!(exact > 1e-3, "{exact}");
    assert!((work / exact - 1.0).abs() < 1e-9, "{work} {exact}");
    let residual = end.energy.residual(&start.energy);
    assert!(residual.abs() < 1e-4 * exact, "{residual} of {exact}");
    // It has the same motion beside a force of the scene.
    let given = format!(
        "{SPRINGS}\nforce_x = [{{ kind = \"time-table\", times = [0, 1], forces = [0, 0] }}]"
    );
    let mut other = moving(&assembled(&pair(&given)), Stepping::Rk4);
    other.advance_to(0.0).unwrap();
    other.set(&control, 200.0).unwrap();
    let other = other.advance_to(2e-3).unwrap().sprocket_x[1];
    assert!((other - end.sprocket_x[1]).abs() < 1e-9 * exact / 200.0);
}

/// The bearing of a fixed centre bears it, and nothing else is moved by a bit; a motion that is given works against it.
#[test]
fn a_force_on_a_centre_that_is_given_moves_nothing() {
    let prescribed =
        r#"support = { kind = "prescribed", x = { kind = "constant", speed = "20 mm/s" } }"#;
    for (support, speed) in [("", 0.0), (prescribed, 0.02)] {
        let force = 750.0;
        let forced = format!(
            "{support}\nforce_x = [{{ kind = \"constant\", force = {force} }}]\nforce_y = [{{ kind = \"orders\", of = \"held\", terms = [{{ order = 2, amplitude = 90, phase = \"90 deg\" }}] }}]"
        );
        let [bare, forced] = [support, &forced].map(|text| {
            let mut simulation = moving(&assembled(&pair(text)), Stepping::Rk4);
            simulation.advance_to(4e-4).unwrap().clone()
        });
        assert_eq!(bare.roller_x, forced.roller_x);
        assert_eq!(bare.link_tension, forced.link_tension);
        let shifts = [
            forced.support_force_x[1] - bare.support_force_x[1],
            forced.support_force_y[1] - bare.support_force_y[1],
        ];
        assert!((shifts[0] + force).abs() < 1e-9 * force, "{shifts:?}");
        assert!((shifts[1] + 90.0).abs() < 1e-9 * force, "{shifts:?}");
        // W = F v t
        let work = force * speed * 4e-4;
        let flow = |flow: Flow| forced.energy.flow(flow) - bare.energy.flow(flow);
        assert!((flow(Flow::Forces) - work).abs() <= 1e-9 * work);
        assert!((flow(Flow::Motions) + work).abs() <= 1e-9 * work.max(bare.energy.stored()));
        assert_eq!(forced.centre_force_x, [0.0, force]);
    }
}

#[test]
fn a_force_that_was_set_outlives_snapshots() {
    let start = assembled(&pair(SPRINGS));
    let mut first = moving(&start, Stepping::Auto);
    first.advance_to(1e-4).unwrap();
    let control = Control::ForceY("moved".into());
    let course = chaindrive::Course {
        to: 300.0,
        over: 5e-4,
        rate: -1e5,
    };
    first.set(&control, course).unwrap();
    first.advance_to(3e-4).unwrap();
    let written = first.snapshot().to_bytes();
    let there = bits(first.advance_to(1e-3).unwrap());
    let mut second = moving(&start, Stepping::Auto);
    second
        .restore(&Snapshot::from_bytes(&written).unwrap())
        .unwrap();
    let seen = second.advance_to(1e-3).unwrap().clone();
    assert_eq!(bits(&seen), there);
    // 300 N − 0.1 N/µs · 400 µs
    let [_, force] = second.channel(Channel::CentreForceY)[..] else {
        panic!("two sprockets")
    };
    assert!((force - 260.0).abs() < 1e-6, "{force}");
    let error = second.set(&Control::ForceX("tensioners.arm".into()), 1.0);
    let message = error.unwrap_err().to_string();
    assert!(message.contains("held, moved"), "{message}");
}

/// A force over the angle of a shaft of another chain joins the two.
#[test]
fn a_force_over_an_angle_has_the_forcings_of_its_shaft() {
    let scene = format!(
        "{SPRINGS}\nforce_y = [{{ kind = \"angle-table\", of = \"shaker\", turns = 2, angles = [0, \"360 deg\", \"720 deg\"], forces = [0, 10, 0] }}]\n\
         [[shafts]]\nname = \"shaker\"\nmotion = {{ kind = \"constant\", speed = 50 }}"
    );
    let assembled = assembled(&pair(&scene));
    // One period in two turns.
    let period = 2.0 * TAU / 50.0;
    let forcings = assembled.forcings();
    let mut periods = forcings.iter().map(|it| it.period);
    assert!(
        periods.any(|it| (it - period).abs() < 1e-12),
        "{forcings:?}"
    );
    let ramp = format!("{SPRINGS}\nforce_y = [{{ kind = \"ramp\", force = 10, duration = 1 }}]");
    let why = self::assembled(&pair(&ramp)).function_of_time();
    assert_eq!(why, Some("a force that is switched on at a time"));
}

/// A hand at a roller: its work is F Δx whatever the links are, and what it gives a free ring is F t of momentum.
#[test]
fn a_pull_at_a_roller_gives_work_and_momentum() {
    for (preset, roller, force, time) in [
        // The last one, whose ghosts close the ring.
        ("spinning_ring", 19, 20.0, 2e-4),
        ("bicycle", 30, 500.0, 1e-4),
    ] {
        let scene = Scene::preset(preset).unwrap();
        let mut simulation = moving(&assembled(&scene), Stepping::Rk4);
        let start = simulation.advance_to(0.0).unwrap().clone();
        let control = Control::ForceX(format!("rollers.{roller}"));
        simulation.set(&control, force).unwrap();
        simulation.set_at(time, &control, 0.0).unwrap();
        let end = simulation.advance_to(time).unwrap().clone();
        let work = end.energy.flow(Flow::Forces);
        let exact = force * (end.roller_x[roller] - start.roller_x[roller]);
        assert!(exact.abs() > 1e-5, "{preset}: {exact}");
        assert!(
            (work / exact - 1.0).abs() < 1e-6,
            "{preset}: {work} {exact}"
        );
        if preset == "spinning_ring" {
            let residual = end.energy.residual(&start.energy);
            assert!(residual.abs() < 1e-6 * exact.abs(), "{residual} of {exact}");
            let momentum = 8.89e-3 * end.roller_vx.iter().sum::<f64>();
            assert!((momentum / (force * time) - 1.0).abs() < 1e-9, "{momentum}");
        }
    }
}

/// Ideal hinges would open; what is no roller has no number.
#[test]
fn a_pull_is_refused_where_there_is_no_such_roller() {
    let ring = Scene::preset("spinning_ring").unwrap();
    let mut simulation = moving(&assembled(&ring), Stepping::Auto);
    for name in ["rollers.20", "rollers.last", "rollers.-1"] {
        let error = simulation.set(&Control::ForceY(name.into()), 1.0);
        let message = error.unwrap_err().to_string();
        assert!(message.contains("rollers.0 to rollers.19"), "{message}");
    }
    let hinged = Scene::preset("bicycle").unwrap();
    let hinged = hinged.replace("chain.model", "ideal-joints").unwrap();
    let mut simulation = moving(&assembled(&hinged), Stepping::Auto);
    let error = simulation.set(&Control::ForceX("rollers.0".into()), 1.0);
    let message = error.unwrap_err().to_string();
    assert!(message.contains("ideal hinges"), "{message}");
}
