//! Speeds, angles, ramps and parameters that somebody sets while a drive moves.
#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use chaindrive::{Control, Course, Flow, Run, Scene, Simulation, Snapshot, Stepping};

use crate::live::{METHODS, bits, preset, start};

/// A driver on a motor, and a load, both free.
fn two_free() -> Scene {
    let text = r#"
        tunable = ["sprockets.driven.load"]
        [chain]
        type = "16B-1"
        links = 80
        [[sprockets]]
        name = "driver"
        teeth = 19
        centre = [0, 0]
        inertia = "0.05 kg m^2"
        speed = "40 rad/s"
        drive = [{ kind = "constant", torque = "60 N m" }]
        [[sprockets]]
        name = "driven"
        teeth = 25
        centre = ["0.73 m", 0]
        inertia = "0.4 kg m^2"
        load = [{ kind = "constant", torque = "-70 N m" }]
        [route]
        pretension = "2 kN"
        adjust = { kind = "sprocket", name = "driven", direction = [1, 0], within = "20 mm" }
        [run]
        run_in = "0 s"
    "#;
    Scene::from_text(text, "two.toml").unwrap()
}

fn speed(simulation: &Simulation, sprocket: usize) -> f64 {
    simulation.observation().sprocket_speed[sprocket]
}

fn on(name: &str, kind: fn(String) -> Control) -> Control {
    kind(name.to_owned())
}

fn ramp(to: f64, over: f64) -> Course {
    let rate = 0.0;
    Course { to, over, rate }
}

/// ½ J (ω₁² − ω₀²) of the jump is work of the ideal drive, and what is read before it knows nothing of it.
#[test]
fn a_speed_jumps_and_is_kept() {
    let scene = two_free();
    let driver = on("driver", Control::Speed);
    for stepping in METHODS {
        let mut simulation = start(&scene, stepping);
        let mut untouched = simulation.clone();
        let at = 3.1415e-4;
        simulation.set_at(at, &driver, 44.0).unwrap();
        // The last reading lies within the step that ends at the jump.
        for k in 1..=6 {
            let before = at * f64::from(k) / 6.001;
            let speeds = [&mut simulation, &mut untouched]
                .map(|run| run.advance_to(before).unwrap().sprocket_speed[0]);
            let apart = (speeds[0] - speeds[1]).abs();
            assert!(apart < 1e-3, "{stepping:?}: {speeds:?}");
        }
        let just_before = speed(&simulation, 0);
        let flow = |run: &Simulation| run.observation().energy.flow(Flow::Driver);
        assert!(flow(&simulation).abs() < 1e-9);
        simulation.advance_to(at).unwrap();
        let work = 0.5 * 0.05 * (44.0_f64.powi(2) - just_before.powi(2));
        assert!(
            (flow(&simulation) / work - 1.0).abs() < 1e-3,
            "{}",
            flow(&simulation)
        );
        for k in 1..=20 {
            simulation.advance_to(at + 1e-4 * f64::from(k)).unwrap();
            assert_eq!(speed(&simulation, 0).to_bits(), 44.0_f64.to_bits());
        }
        let turned = simulation.observation().sprocket_angle[0];
        simulation.advance_to(3e-3).unwrap();
        let more = simulation.observation().sprocket_angle[0] - turned;
        assert!((more - 44.0 * (3e-3 - at - 2e-3)).abs() < 1e-12);
    }
}

/// A torque that a motion of the scene does not let act does not act on a speed either, and acts again where it is set.
#[test]
fn a_torque_takes_the_shaft_back() {
    let scene = two_free();
    let [as_speed, as_torque] = [Control::Speed, Control::Torque].map(|kind| on("driver", kind));
    let mut simulation = start(&scene, Stepping::Rk4);
    simulation.set(&as_torque, 500.0).unwrap();
    simulation.advance_to(1e-3).unwrap();
    simulation.set(&as_speed, 41.0).unwrap();
    simulation.advance_to(2e-3).unwrap();
    assert_eq!(speed(&simulation, 0).to_bits(), 41.0_f64.to_bits());
    simulation.set(&as_torque, 0.0).unwrap();
    simulation.advance_to(2e-3 + 1e-6).unwrap();
    // 60 N m on 0.05 kg m² and what the chain pulls: no more than 5000 rad/s² for a microsecond.
    assert!((speed(&simulation, 0) - 41.0).abs() < 5e-3);
    simulation.advance_to(4e-3).unwrap();
    assert!((speed(&simulation, 0) - 41.0).abs() > 1e-3);
}

/// Cubics come to their angle and pass at their rate; ramps of speed end at their speed.
#[test]
fn angles_and_ramps_come_to_where_they_are_set() {
    let scene = two_free();
    for stepping in METHODS {
        let mut simulation = start(&scene, stepping);
        simulation.advance_to(1e-3).unwrap();
        let [angle, before] = {
            let seen = simulation.observation();
            [seen.sprocket_angle[0], seen.sprocket_speed[0]]
        };
        let course = Course {
            to: angle + 0.08,
            over: 2e-3,
            rate: 41.0,
        };
        simulation
            .set(&on("driver", Control::Angle), course)
            .unwrap();
        // No jump of the speed, and no work of one.
        simulation.advance_to(1e-3).unwrap();
        assert!((speed(&simulation, 0) - before).abs() < 1e-3);
        simulation.advance_to(3e-3).unwrap();
        let seen = simulation.observation();
        assert!((seen.sprocket_angle[0] - angle - 0.08).abs() < 1e-12);
        assert!((seen.sprocket_speed[0] - 41.0).abs() < 1e-9);
        let driver = on("driver", Control::Speed);
        simulation.set(&driver, ramp(30.0, 1e-3)).unwrap();
        simulation.advance_to(3.5e-3).unwrap();
        assert!((speed(&simulation, 0) - 35.5).abs() < 1e-9);
        simulation.advance_to(4.5e-3).unwrap();
        assert!((speed(&simulation, 0) - 30.0).abs() < 1e-9);
    }
}

/// A motion that a scene gives is replaced as well, without a coordinate.
#[test]
fn a_given_motion_is_replaced() {
    let scene = preset("industrial_16b");
    let names = scene.drive().unwrap().assemble().unwrap();
    let name = names.system.sprocket_names()[0].clone();
    let mut simulation = start(&scene, Stepping::Verlet);
    simulation.advance_to(1e-4).unwrap();
    let before = speed(&simulation, 0);
    let control = Control::Speed(name.clone());
    simulation.set(&control, ramp(1.01 * before, 1e-3)).unwrap();
    simulation.advance_to(2e-3).unwrap();
    assert!((speed(&simulation, 0) / before - 1.01).abs() < 1e-12);
    let refused = simulation.set(&Control::Torque(name), 1.0).unwrap_err();
    assert!(refused.to_string().contains("set its speed"), "{refused}");
}

/// Numbers in [0, 1) that look random: multiples of the golden ratio.
fn scattered(k: u32) -> f64 {
    (f64::from(k) * 0.618_033_988_749_895).fract()
}

/// The step that is taken back ends where a plan has set something: both changes are made as if they had been planned from the beginning.
#[test]
fn a_change_takes_back_the_one_behind_it() {
    let scene = two_free();
    let [turned, pushed] = [Control::Speed, Control::Torque].map(|kind| on("driver", kind));
    let (at, later, end) = (3.1415e-4, 3.1425e-4, 1e-3);
    for stepping in METHODS {
        let mut planned = start(&scene, stepping);
        planned.set_at(at, &pushed, 30.0).unwrap();
        planned.set_at(later, &turned, 44.0).unwrap();
        planned.advance_to(end).unwrap();
        let mut late = start(&scene, stepping);
        late.set_at(later, &turned, 44.0).unwrap();
        late.advance_to(at).unwrap();
        assert!(late.time() >= at, "{stepping:?}");
        let snapshot = late.snapshot();
        late.set(&pushed, 30.0).unwrap();
        late.advance_to(end).unwrap();
        let mut another = start(&scene, stepping);
        another.restore(&snapshot).unwrap();
        another.set(&pushed, 30.0).unwrap();
        another.advance_to(end).unwrap();
        for other in [&late, &another] {
            assert_eq!(
                bits(other.observation()),
                bits(planned.observation()),
                "{stepping:?}"
            );
        }
    }
}

/// From torque to speed and back a hundred times, at times that no step knows. By the reference method the ledger closes to 1e-5 of the
/// energy moved; by Verlet's it errs by the square of the step. The same calls in pieces, and on another simulation after snapshots, are
/// the same to the bit.
#[test]
fn a_shaft_is_taken_over_and_handed_back_a_hundred_times() {
    let scene = two_free();
    let [as_speed, as_torque, as_angle] =
        [Control::Speed, Control::Torque, Control::Angle].map(|kind| on("driver", kind));
    let end = 6e-3;
    let mut times: Vec<f64> = (1..=100).map(|k| end * scattered(k)).collect();
    times.sort_by(f64::total_cmp);
    let change = |simulation: &mut Simulation, k: usize| {
        let amount = scattered(1000 + u32::try_from(k).unwrap()) - 0.5;
        match k % 3 {
            0 => {
                let over = if k.is_multiple_of(2) { 0.0 } else { 5e-5 };
                let rate = 50.0 * amount;
                let to = 40.0 + amount;
                simulation.set(&as_speed, Course { to, over, rate })
            }
            1 => simulation.set(&as_torque, ramp(100.0 * amount, 2e-5)),
            _ => {
                let to = simulation.observation().sprocket_angle[0] + 4e-3 * (1.0 + 0.2 * amount);
                let over = 1e-4;
                simulation.set(
                    &as_angle,
                    Course {
                        to,
                        over,
                        rate: 40.0,
                    },
                )
            }
        }
        .unwrap();
    };
    let assembled = scene.drive().unwrap().assemble().unwrap();
    let residual = |stepping: Stepping, step: Option<f64>| {
        let run = Run {
            stepping,
            step,
            ..Run::default()
        };
        let mut simulation = Simulation::from_assembled(assembled.clone(), &run).unwrap();
        let mut pieces = simulation.clone();
        let fresh = simulation.clone();
        let mut moved = 0.0;
        for (k, &time) in times.iter().enumerate() {
            simulation.advance_to(time).unwrap();
            change(&mut simulation, k);
            // The same in more pieces, each from bytes.
            let from = pieces.read_at();
            for part in 1..3 {
                let part = from + (time - from) * f64::from(part) / 3.0;
                pieces.advance_to(part).unwrap();
            }
            pieces.advance_to(time).unwrap();
            if k % 10 == 0 {
                let bytes = pieces.snapshot().to_bytes();
                let kept = Snapshot::from_bytes(&bytes).unwrap();
                pieces = fresh.clone();
                pieces.restore(&kept).unwrap();
            }
            change(&mut pieces, k);
            let flows = simulation.observation().energy.flows;
            moved = flows.iter().map(|flow| flow.abs()).fold(moved, f64::max);
        }
        let whole = bits(simulation.advance_to(end).unwrap());
        assert_eq!(bits(pieces.advance_to(end).unwrap()), whole, "{stepping:?}");
        let residual = simulation.energy_residual().abs() / moved;
        println!("{stepping:?}: {residual:.2e} of {moved:.1} J");
        residual
    };
    assert!(residual(Stepping::DormandPrince, None) < 1e-5);
    let [coarse, fine] = [4e-6, 2e-6].map(|step| residual(Stepping::Verlet, Some(step)));
    // The cubics to the angles take up to 5e5 rad/s²: the power of the drive is the trapezoid of steps.
    assert!((3.0..5.0).contains(&(coarse / fine)), "{coarse:e} {fine:e}");
}

/// A preload that is larger by 500 N is a force of 500 N on a slider, and the spring that was bent over holds more.
#[test]
fn a_tuned_preload_is_a_force_on_the_tensioner() {
    let scene = preset("marine_engine");
    let places = r#"["tensioners.tightener.push.preload", "tensioners.tightener.push.stiffness"]"#;
    let scene = scene.replace("tunable", places).unwrap();
    let [preload, stiffness] = ["preload", "stiffness"]
        .map(|key| Control::Parameter(format!("tensioners.tightener.push.{key}")));
    let mut tuned = start(&scene, Stepping::Rk4);
    let mut forced = tuned.clone();
    for run in [&mut tuned, &mut forced] {
        run.advance_to(3.3e-4).unwrap();
    }
    tuned.set(&preload, 23_650.0 + 500.0).unwrap();
    let force = on("tightener", Control::Force);
    forced.set(&force, 500.0).unwrap();
    let places = [&mut tuned, &mut forced].map(|run| {
        let seen = run.advance_to(3e-3).unwrap();
        seen.tensioner_position[0]
    });
    assert!((places[0] - places[1]).abs() < 1e-12, "{places:?}");
    let mut still = start(&scene, Stepping::Rk4);
    let moved = places[0] - still.advance_to(3e-3).unwrap().tensioner_position[0];
    assert!(moved > 1e-6, "{moved}");
    tuned.set(&stiffness, 2e6).unwrap();
    tuned.advance_to(5e-3).unwrap();
    let scale = tuned.observation().energy.kinetic();
    assert!(tuned.energy_residual().abs() < 1e-5 * scale);
    let refused = tuned.set(&stiffness, -1.0).unwrap_err().to_string();
    assert!(
        refused.contains("stiffness") && refused.contains("not negative"),
        "{refused}"
    );
    let refused = tuned.set(&preload, ramp(1.0, 1.0)).unwrap_err().to_string();
    assert!(refused.contains("a parameter jumps"), "{refused}");
}

/// A factor on the load is that load.
#[test]
fn a_tuned_load_is_the_load() {
    let scene = two_free();
    let mut tuned = start(&scene, Stepping::Rk4);
    let mut loaded = tuned.clone();
    let place = Control::Parameter("sprockets.driven.load".into());
    tuned.set(&place, 1.5).unwrap();
    loaded.set(&on("driven", Control::Torque), -35.0).unwrap();
    let ends = [&mut tuned, &mut loaded].map(|run| {
        run.advance_to(2e-3).unwrap();
        speed(run, 1)
    });
    assert!((ends[0] - ends[1]).abs() < 1e-12, "{ends:?}");
    let flow = |run: &Simulation, flow| run.observation().energy.flow(flow);
    assert!((flow(&tuned, Flow::Load) / (1.5 * flow(&loaded, Flow::Load)) - 1.0).abs() < 1e-9);
}

#[test]
fn what_is_no_course_is_refused() {
    let mut simulation = start(&two_free(), Stepping::Verlet);
    let mut refused = |control: Control, course: Course| {
        simulation.set(&control, course).unwrap_err().to_string()
    };
    let nan = ramp(f64::NAN, 0.0);
    for (control, course, words) in [
        (
            on("driver", Control::Angle),
            ramp(1.0, 0.0),
            "an angle takes time",
        ),
        (on("driver", Control::Speed), nan, "value = NaN"),
        (on("driver", Control::Torque), ramp(1.0, -1.0), "over = -1"),
        (
            on("drivr", Control::Speed),
            ramp(1.0, 0.0),
            "driver, driven",
        ),
        (
            on("sprockets.driver.load", Control::Parameter),
            ramp(1.0, 0.0),
            "sprockets.driven.load",
        ),
    ] {
        let said = refused(control, course);
        assert!(said.contains(words), "{said}");
    }
    let mut unlisted = start(&preset("marine_two_sprockets"), Stepping::Verlet);
    let place = on("sprockets.camshaft.load", Control::Parameter);
    let said = unlisted.set(&place, 2.0).unwrap_err().to_string();
    assert!(said.contains("`tunable`"), "{said}");
    let scene = two_free().replace("tunable", "[\"sprockets.drivn.load\"]");
    let said = scene.unwrap().drive().unwrap_err().to_string();
    assert!(
        said.contains("tunable[0]") && said.contains("sprockets.driven.load"),
        "{said}"
    );
}
