//! Chains of rigid links and of the catalogue: what scenes make of them, and what a run hands out.
#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use chaindrive::catalogue::catalogue;
use chaindrive::{
    Channel, ContactPair, Description, Recording, Run, Scene, Simulation, SimulationError,
    Stepping, Summary,
};
use chaindrive_contact::{Dissipation, Elastic, Friction};
use chaindrive_mechanics::{ChainModel, Joint, RigidLinks, RollerModel, Surface};

fn preset(name: &str) -> Scene {
    Scene::preset(name).unwrap()
}

fn links(scene: &Scene) -> RigidLinks {
    let drive = scene.drive().unwrap_or_else(|error| panic!("{error}"));
    let ChainModel::Rigid(links) = &drive.chains[0].chain.model else {
        panic!("these are no rigid links");
    };
    links.clone()
}

fn joint(scene: &Scene) -> Surface {
    match links(scene).joint {
        Joint::Clearance(joint) => joint.surface,
        Joint::Ideal => panic!("this joint is ideal"),
    }
}

#[test]
fn the_bicycle_is_what_the_catalogue_says() {
    let scene = preset("bicycle");
    let found = links(&scene);
    let Joint::Clearance(pins) = found.joint else {
        panic!("joints have play")
    };
    assert!((pins.pin_radius - 2.045e-3).abs() < 1e-12);
    assert!((pins.gap() - 25e-6).abs() < 1e-12);
    assert!((found.inner.mass - 2.889e-3).abs() < 1e-12);
    assert_eq!(found.rollers, RollerModel::Lumped { mass: 0.465e-3 });
    // 0.30 kg/m over 104 pitches of 12.7 mm.
    let mass: f64 = scene.drive().unwrap().chains[0].chain.masses.iter().sum();
    assert!((mass / (0.3 * 104.0 * 0.0127) - 1.0).abs() < 2e-3, "{mass}");
    // The fit of Pereira, Ramalho and Ambrósio, with K and n of a clearance of 25 µm.
    let Elastic::Cylindrical(law) = pins.surface.law.elastic else {
        panic!("{:?}", pins.surface.law.elastic)
    };
    // Y = 1.51 ln(25)^(−0.151), n = Y 0.025^(−0.005)
    let exponent = 1.51 * 25_f64.ln().powf(-0.151) * 0.025_f64.powf(-0.005);
    assert!((law.exponent - exponent).abs() < 1e-9);
}

#[test]
fn one_key_changes_the_model() {
    let scene = preset("bicycle");
    let particles = scene.replace("chain.model", "particles").unwrap();
    let drive = particles.drive().unwrap();
    assert_eq!(drive.chains[0].chain.model, ChainModel::Particles);
    assert!((drive.chains[0].chain.stiffness[0] - 47.65e6).abs() < 1.0);
    let ideal = scene.replace("chain.model", "ideal-joints").unwrap();
    assert_eq!(links(&ideal).joint, Joint::Ideal);
    let free = scene
        .replace("chain.rollers", "free")
        .and_then(|scene| scene.replace("chain.roller", "{ clearance = '50 µm' }"))
        .unwrap();
    let RollerModel::Free(roller) = links(&free).rollers else {
        panic!("rollers are free")
    };
    assert!((roller.gap() - 50e-6).abs() < 1e-12);
    let bush = scene.replace("chain.rollers", "none").unwrap();
    assert_eq!(links(&bush).rollers, RollerModel::Bush);
}

#[test]
fn a_text_names_a_chain_whose_links_are_counted() {
    let text = r#"
        chain = "16B-1"
        [[sprockets]]
        name = "a"
        teeth = 19
        centre = [0, 0]
        motion = { kind = "constant", speed = "100 rpm" }
        [[sprockets]]
        name = "b"
        teeth = 57
        centre = ["1.03 m", 0]
        inertia = 1
    "#;
    let scene = Scene::from_text(text, "text").unwrap();
    let drive = scene.drive().unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(drive.chains[0].chain.links(), 120);
    assert!((drive.chains[0].chain.pitch - 0.0254).abs() < 1e-15);
    assert!((drive.chains[0].chain.masses[0] - 2.71 * 0.0254).abs() < 1e-12);
    // A change turns the name into a table.
    let longer = scene.replace("chain.links", "124").unwrap();
    assert_eq!(longer.drive().unwrap().chains[0].chain.links(), 124);
    assert!(
        longer.text().contains("type = \"16B-1\""),
        "{}",
        longer.text()
    );
    let json = r#"{"chain": "16B-1", "sprockets": []}"#;
    let json = Scene::from_text(json, "json").unwrap();
    let json = json.replace("chain.links", "3").unwrap();
    assert!(
        json.text().contains("\"type\": \"16B-1\""),
        "{}",
        json.text()
    );
}

/// Whatever the catalogue has in full becomes a chain of every model.
#[test]
fn every_chain_of_the_catalogue_resolves() {
    let mut rigid = 0;
    for chain in catalogue() {
        let text = |model: &str| {
            format!(
                "[chain]\ntype = '{}'\nlinks = 4\nmodel = '{model}'\nends = ['fixed', 'free']\n\
                 start = {{ kind = 'line', from = [0, 0], to = [0.01, 0] }}\n",
                chain.name
            )
        };
        let made = |model| Scene::from_text(&text(model), &chain.name).unwrap().drive();
        let whole = |result: Result<_, chaindrive::scene::SceneError>| match result {
            Ok(()) => 1,
            Err(error) => {
                assert!(
                    error
                        .to_string()
                        .contains("which the catalogue does not have")
                        || error.to_string().contains("missing"),
                    "{error}"
                );
                0
            }
        };
        whole(made("particles").map(drop));
        rigid += whole(made("clearance-joints").map(drop));
    }
    assert!(rigid > 25, "{rigid}");
}

#[test]
fn every_law_can_be_written() {
    let scene = preset("bicycle");
    let with = |path: &str, value: &str| joint(&scene.replace(path, value).unwrap());
    for (kind, is) in [
        ("linear", "power"),
        ("power", "power"),
        ("hertz", "power"),
        ("johnson", "johnson"),
        ("conformal", "conformal"),
        ("radzimovsky", "radzimovsky"),
        ("esdu-78035", "esdu-78035"),
        ("dubowsky-freudenstein", "dubowsky-freudenstein"),
        ("cylindrical", "cylindrical"),
    ] {
        let more = match kind {
            "linear" => ", stiffness = '1 MN/m'",
            "power" => ", stiffness = 1e9, exponent = 1.2",
            _ => "",
        };
        let surface = with(
            "contact.joints.law",
            &format!("{{ kind = '{kind}'{more} }}"),
        );
        let written = serde_json::to_value(surface.law.elastic).unwrap();
        assert_eq!(written["kind"], is, "{kind}");
    }
    for dissipation in Dissipation::hysteretic(0.7) {
        let kind = serde_json::to_value(dissipation).unwrap()["kind"].clone();
        let name = kind.as_str().unwrap();
        assert_eq!(
            with("contact.joints.dissipation", name).law.dissipation,
            dissipation
        );
    }
    let none = "{ law = 'cylindrical', dissipation = 'none' }";
    assert_eq!(
        with("contact.joints", none).law.dissipation,
        Dissipation::None
    );
    let plain = with("contact.joints.friction", "{ coefficient = 0.1 }");
    let named = with(
        "contact.joints.friction",
        "{ kind = 'coulomb', coefficient = 0.1 }",
    );
    assert_eq!(plain.friction, named.friction);
    assert_eq!(
        with("contact.joints.friction", "none").friction,
        Friction::None
    );
}

/// The cylindrical law on teeth follows from roller and seat.
#[test]
fn teeth_of_rigid_links_have_the_law_of_their_seat() {
    let drive = preset("bicycle").drive().unwrap();
    for sprocket in &drive.sprockets {
        let Elastic::Cylindrical(law) = sprocket.surface.law.elastic else {
            panic!("{:?}", sprocket.surface.law.elastic)
        };
        // n = Y ΔR^(−0.005) grows as the seat gets tighter.
        assert!((1.15..1.3).contains(&law.exponent), "{}", law.exponent);
        assert!(sprocket.gap.seat_clearance > 30e-6);
    }
}

#[test]
fn the_method_follows_the_chain() {
    for (name, method) in [
        ("bicycle", "implicit-damping"),
        ("pin_in_bush", "implicit-damping"),
        ("spinning_ring", "verlet"),
    ] {
        let scene = preset(name);
        let run = Run {
            until: 1e-4,
            every: 1e-4,
            ..Run::suggested(&scene.run_defaults())
        };
        assert_eq!(run.stepping, Stepping::Auto);
        let simulation = Simulation::start(&scene.drive().unwrap(), &run).unwrap();
        assert_eq!(Stepping::from(simulation.method()).name(), method, "{name}");
        let chosen = Run {
            stepping: Stepping::Verlet,
            step: Some(1e-7),
            ..run
        };
        let simulation = Simulation::start(&scene.drive().unwrap(), &chosen).unwrap();
        assert_eq!(Stepping::from(simulation.method()), Stepping::Verlet);
    }
}

/// Energy unaccounted for at the end of a run by default settings, over the energy supplied.
fn open_share(scene: &Scene, until: f64, step: Option<f64>) -> f64 {
    let run = Run {
        until,
        every: 1e-4,
        step,
        ..Run::default()
    };
    let mut simulation = Simulation::start(&scene.drive().unwrap(), &run).unwrap();
    assert_eq!(
        Stepping::from(simulation.method()),
        Stepping::ImplicitDamping
    );
    let mut summary = Summary::new(&simulation);
    while let Some(sample) = simulation.next_sample().unwrap() {
        summary.push(sample);
    }
    (summary.residual / summary.energy_supplied()).abs()
}

/// A slack chain at 100 rad/s strikes the teeth at 6 m/s, and pins their bushes: an impact of a pin lasts
/// hardly longer than a step. Contacts that began as deep as the step takes them would leave 0.17 open.
#[test]
fn heavy_impacts_do_not_feed_themselves() {
    let scene = preset("bicycle_slack")
        .replace("sprockets.chainring.motion.speed", "-100 rad/s")
        .unwrap();
    let open = open_share(&scene, 5e-3, None);
    assert!(open < 0.05, "{open}");
}

/// The ledger has what the equations of a step add to the forces: 1.1e-4 of what is supplied stays open, and 1.3e-3 without that.
#[test]
fn the_ledger_of_long_steps_closes() {
    let open = open_share(&preset("bicycle"), 10e-3, Some(10e-6));
    assert!(open < 3e-4, "{open}");
}

/// The ledger closes with the step, whether the chain is taut or hangs.
#[test]
fn ideal_joints_step_by_implicit_damping() {
    for name in ["bicycle", "bicycle_slack"] {
        let scene = preset(name).replace("chain.model", "ideal-joints").unwrap();
        // Bare seats: behind softer ones so little is open at the default step that chance decides whether it halves.
        let scene = scene.replace("contact.teeth.series", "0").unwrap();
        let coarse = open_share(&scene, 10e-3, None);
        assert!(coarse < 5e-3, "{name}: {coarse}");
        let fine = open_share(&scene, 10e-3, Some(1e-6));
        assert!(fine < 0.5 * coarse, "{name}: {fine} after {coarse}");
    }
}

#[test]
fn joints_are_recorded_where_there_are_any() {
    let scene = preset("bicycle");
    let run = Run {
        until: 1e-4,
        every: 5e-5,
        ..Run::default()
    };
    let mut simulation = Simulation::start(&scene.drive().unwrap(), &run).unwrap();
    let channels = Channel::chosen(&["all"], simulation.system()).unwrap();
    let missing: Vec<Channel> = Channel::ALL
        .iter()
        .copied()
        .filter(|channel| !channels.contains(channel))
        .collect();
    // This bicycle has neither strands, free rollers, shafts of their own names, nor couplings.
    let absent = [
        Channel::StrandTensionMax,
        Channel::StrandTensionMin,
        Channel::BushForce,
        Channel::BushForceX,
        Channel::BushForceY,
        Channel::BushDepth,
        Channel::BushOffsetX,
        Channel::BushOffsetY,
        Channel::FilmThickness,
        Channel::ShaftAngle,
        Channel::ShaftSpeed,
        Channel::CouplingTorque,
    ];
    assert_eq!(missing, absent);
    let mut recording = Recording::new(&channels, simulation.system());
    while let Some(sample) = simulation.next_sample().unwrap() {
        recording.push(sample);
    }
    for column in &recording.columns {
        assert_eq!(
            column.values.len(),
            3 * column.width,
            "{}",
            column.channel.name()
        );
    }
    let ring = preset("spinning_ring").drive().unwrap();
    let ring = Simulation::start(&ring, &run).unwrap();
    let all = Channel::chosen(&["all"], ring.system()).unwrap();
    // Nor has the ring joints with a state.
    assert_eq!(all.len(), Channel::ALL.len() - absent.len() - 8);
    let error = Channel::chosen(&["joint_force"], ring.system()).unwrap_err();
    assert!(matches!(
        error,
        SimulationError::AbsentChannel {
            name: "joint_force"
        }
    ));
    assert!(error.to_string().contains("chain.model"), "{error}");
}

/// A pin that falls through its play strikes at √(2 g · 2c) and leaves at e times that (theory).
#[test]
fn a_dropped_pin_bounces_as_it_should() {
    let scene = preset("pin_in_bush");
    let run = Run::suggested(&scene.run_defaults());
    let mut simulation = Simulation::start(&scene.drive().unwrap(), &run).unwrap();
    let mut bounces = Vec::new();
    while simulation.next_sample().unwrap().is_some() {
        bounces.extend_from_slice(simulation.events());
    }
    assert_eq!(bounces[0].pair, ContactPair::Joint { joint: 0 });
    let first = (2.0 * 9.81 * 0.2e-3_f64).sqrt();
    let after = |speed: f64| 0.9 * speed;
    for (bounce, expected) in bounces
        .iter()
        .zip(std::iter::successors(Some(first), |speed| {
            Some(after(*speed))
        }))
        .take(8)
    {
        let error = bounce.onset_speed / expected - 1.0;
        assert!(
            error.abs() < 0.01,
            "{} instead of {expected}",
            bounce.onset_speed
        );
        // Momentum in and out, and the weight meanwhile.
        let mass = 0.06049;
        let impulse = mass * 1.9 * expected + mass * 9.81 * (bounce.end - bounce.start);
        assert!(
            (bounce.impulse / impulse - 1.0).abs() < 0.02,
            "{}",
            bounce.impulse
        );
    }
    assert!((bounces[0].start - (4.0 * 0.1e-3 / 9.81_f64).sqrt()).abs() < 1e-5);
}

/// Defect D: contacts were logged with the floor of the law in place of their speed, and with times rounded to steps. The
/// pin of above touches at √(4c/g), between two steps, at a sixteenth of this floor.
#[test]
fn a_touch_is_logged_as_it_was() {
    let scene = preset("pin_in_bush");
    let scene = scene
        .replace("contact.joints.onset_floor", "1 m/s")
        .unwrap();
    let step = 1e-6;
    let run = Run {
        until: 8e-3,
        stepping: Stepping::Rk4,
        step: Some(step),
        ..Run::suggested(&scene.run_defaults())
    };
    let mut simulation = Simulation::start(&scene.drive().unwrap(), &run).unwrap();
    let mut bounces = Vec::new();
    while simulation.next_sample().unwrap().is_some() {
        bounces.extend_from_slice(simulation.events());
    }
    let exact = (4.0 * 0.1e-3 / 9.81_f64).sqrt();
    let late = |time: f64| (time / step).fract() * step;
    assert!(late(exact) > 0.1 * step && late(exact) < 0.9 * step);
    let found = &bounces[0];
    assert!((found.start - exact).abs() < 1e-3 * step, "{found:?}");
    // Half a step after the touch the contact has taken 0.9 ‰ of the speed, of which the interpolation sees a half.
    assert!(
        (found.onset_speed / (9.81 * exact) - 1.0).abs() < 1e-3,
        "{found:?}"
    );
    // The bounce lasts some steps, and ends within one.
    assert!(
        found.end > found.start + step && late(found.end) > 1e-3 * step,
        "{found:?}"
    );
}

#[test]
fn a_description_says_what_the_chain_is() {
    let describe = |name: &str| {
        let scene = preset(name);
        let run = Run::suggested(&scene.run_defaults());
        Description::of(&scene.drive().unwrap(), &run).unwrap()
    };
    let bicycle = describe("bicycle");
    assert_eq!(bicycle.chains[0].bodies.model, "clearance-joints");
    assert_eq!(bicycle.model.degrees_of_freedom, 3 * 104 + 1);
    let text = bicycle.to_string();
    for words in [
        "104 joints with 25.0 µm of radial play",
        "contact of joints      cylindrical, exact 0.7, friction spring-slider",
        "pins of 4.09 mm rub, spring-slider",
        "implicit damping, step",
        "without its damping",
    ] {
        assert!(text.contains(words), "{words}:\n{text}");
    }
    assert!(
        describe("spinning_ring")
            .to_string()
            .contains("particles: point masses")
    );
}
