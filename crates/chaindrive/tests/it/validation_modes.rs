//! Natural frequencies from scene texts against closed forms: cases V01, V02, V08 and V12, and
//! spinning rings, T01 and T02.

use std::f64::consts::TAU;

use chaindrive::{Drive, Modes, Run, Scene, Simulation, Stepping};
use chaindrive_integrate::{Moment, SecondOrderSystem};
use chaindrive_mechanics::{Motion, Rotation};
use chaindrive_validation::Case;
use chaindrive_validation::Tolerance::Relative;

#[track_caller]
fn drive(scene: &str) -> Drive {
    let scene = Scene::from_text(scene, "scene").unwrap_or_else(|error| panic!("{error}"));
    scene.drive().unwrap_or_else(|error| panic!("{error}"))
}

#[track_caller]
fn modes(scene: &str) -> Modes {
    let assembled = drive(scene)
        .assemble()
        .unwrap_or_else(|error| panic!("{error}"));
    assembled.modes().unwrap_or_else(|error| panic!("{error}"))
}

/// A straight span of `links` between two fixed ends, `length` long.
fn span(links: f64, pitch: f64, elongation: f64, mass: f64, stiffness: f64, length: f64) -> String {
    format!(
        r#"
        gravity = [0, 0]

        [chain]
        pitch = {pitch}
        elongation = {elongation}
        links = {links}
        mass = {mass}
        stiffness = {stiffness}
        ends = ["fixed", "fixed"]
        start = {{ kind = "line", from = [0, 0], to = [{length}, 0] }}
        "#
    )
}

/// The lowest modes of a taut span are transverse, one for every roller between the ends.
#[track_caller]
fn transverse(case: &Case, scene: &str) {
    let expected = case.list("expected.frequency");
    let found = modes(scene);
    assert!(found.is_stable());
    let lowest = &found.frequencies()[..expected.len()];
    let tolerance = Relative(case.number("tolerance"));
    case.judge_each("frequencies", "Hz", lowest, &expected, tolerance);
    for mode in &found.modes[..expected.len()] {
        assert!(mode.roller_x.iter().all(|x| x.abs() < 1e-6));
    }
}

#[test]
fn transverse_modes_of_a_span_of_rigid_links() {
    let case = Case::read("V01");
    let input = |key: &str| case.number(&format!("inputs.{key}"));
    let (links, pitch) = (input("links"), input("pitch"));
    // Links that are too short by T / k have the pitch under T, whatever their stiffness.
    let stiffness = 2e7;
    let shorter = -input("tension") / (stiffness * pitch);
    let scene = span(
        links,
        pitch,
        shorter,
        input("mass"),
        stiffness,
        links * pitch,
    );
    transverse(&case, &scene);
}

#[test]
fn transverse_modes_of_a_span_of_elastic_links() {
    let case = Case::read("V02");
    let input = |key: &str| case.number(&format!("inputs.{key}"));
    let (links, pitch, stiffness) = (input("links"), input("pitch"), input("stiffness"));
    let stretched = pitch + input("tension") / stiffness;
    let scene = span(
        links,
        pitch,
        0.0,
        input("mass"),
        stiffness,
        links * stretched,
    );
    transverse(&case, &scene);
}

/// Without tension nothing opposes a motion across the links: half of the modes are zero.
#[test]
fn longitudinal_modes_of_a_span() {
    let case = Case::read("V08");
    for (i, input) in case.table("inputs.rows").iter().enumerate() {
        let (links, pitch) = (input[0], 0.0127);
        let found = modes(&span(links, pitch, 0.0, input[2], input[1], links * pitch));
        let frequencies = found.frequencies();
        let (across, along) = frequencies.split_at(frequencies.len() / 2);
        assert!(across.iter().all(|f| f.abs() < 1e-3), "{across:?}");
        let expected = case.list(&format!("expected.frequency.{i}"));
        let lowest = &along[..expected.len()];
        let tolerance = Relative(case.number("tolerance"));
        case.judge_each("frequencies", "Hz", lowest, &expected, tolerance);
        for mode in &found.modes[across.len()..] {
            let moved: f64 = mode.roller_x.iter().map(|x| x * x).sum();
            assert!((moved * input[2] - 1.0).abs() < 1e-9, "unit modal mass");
        }
    }
}

#[test]
fn swings_of_a_hanging_chain() {
    let case = Case::read("V12");
    let input = |key: &str| case.number(&format!("inputs.{key}"));
    let (pitch, gravity) = (input("pitch"), input("gravity"));
    for (i, masses) in case.list("expected.masses").into_iter().enumerate() {
        let found = modes(&format!(
            r#"
            gravity = [0, -{gravity}]

            [chain]
            pitch = {pitch}
            links = {masses}
            mass = "8.89 g"
            stiffness = "100 MN/m"
            ends = ["fixed", "free"]
            start = {{ kind = "line", from = [0, 0], to = [0, -{}] }}
            "#,
            masses * pitch,
        ));
        let expected = case.list(&format!("expected.frequency.{i}"));
        let lowest = &found.frequencies()[..expected.len()];
        let quantity = format!("frequencies, masses: {masses}");
        let tolerance = Relative(case.number("tolerance"));
        case.judge_each(&quantity, "Hz", lowest, &expected, tolerance);
    }
}

/// An inverted strand is unstable, and says so by negative frequencies: those of V12 with −g.
#[test]
fn a_chain_standing_on_its_end_is_unstable() {
    let scene = r#"
        gravity = [0, 9.80665]
        settle = false

        [chain]
        pitch = "12.7 mm"
        links = 1
        mass = "8.89 g"
        stiffness = "100 MN/m"
        ends = ["fixed", "free"]
        start = { kind = "points", positions = [[0, 0], [0, -0.012699999128188815]] }
        "#;
    let found = modes(scene);
    assert!(!found.is_stable());
    let case = Case::read("V12");
    let expected = case.list("expected.frequency.0");
    let quantity = "frequency of one mass, upside down and with its sign turned";
    let frequency = -found.modes[0].frequency;
    case.judge_each(quantity, "Hz", &[frequency], &expected, Relative(1e-5));
}

#[test]
fn modes_ask_for_a_static_state() {
    let drive = Scene::preset("spinning_ring").unwrap().drive().unwrap();
    let error = drive.assemble().unwrap().modes().unwrap_err();
    assert!(error.to_string().contains("need a static state"), "{error}");
}

/// A free ring, spinning from t = 0.
struct Ring {
    count: f64,
    pitch: f64,
    mass: f64,
    stiffness: f64,
    speed: f64,
}

/// The quantities that `spin` looks at.
const RING: [(&str, &str); 3] = [("radius", "m"), ("speed", "m/s"), ("tension", "N")];

/// Distances of the rollers from the centre, their speeds and the link tensions, of ten samples
/// by `step` \[√(m/k)\].
fn spin(ring: &Ring, step: f64, until: f64) -> [Vec<f64>; 3] {
    let Ring {
        count,
        pitch,
        mass,
        stiffness,
        speed,
    } = ring;
    let scene = format!(
        r#"
        gravity = [0, 0]
        settle = false

        [chain]
        pitch = {pitch}
        links = {count}
        mass = {mass}
        stiffness = {stiffness}
        damping = 0
        start = {{ kind = "ring", speed = {speed} }}
        "#
    );
    let drive = drive(&scene);
    let run = Run {
        until,
        every: 0.1 * until,
        stepping: Stepping::Rk4,
        step: Some(step * (mass / stiffness).sqrt()),
        ..Run::default()
    };
    let mut simulation = Simulation::start(&drive, &run).unwrap_or_else(|error| panic!("{error}"));
    let [mut radii, mut speeds, mut tensions] = [const { Vec::new() }; 3];
    while let Some(sample) = simulation.next_sample().expect("the ring turns") {
        let both = |x: &[f64], y: &[f64]| -> Vec<f64> {
            x.iter().zip(y).map(|(x, y)| x.hypot(*y)).collect()
        };
        radii.extend(both(&sample.roller_x, &sample.roller_y));
        speeds.extend(both(&sample.roller_vx, &sample.roller_vy));
        tensions.extend(&sample.link_tension);
    }
    [radii, speeds, tensions]
}

/// Rings stiff enough to be rigid keep radius, speed and tension. They run for a thousand steps:
/// rounding adds up, and the strain to be kept is 10⁻¹³.
#[test]
fn a_rigid_ring_carries_its_centrifugal_tension() {
    let case = Case::read("T01");
    let expected = case.table("expected.rows");
    for (input, expected) in case.table("inputs.rows").iter().zip(expected) {
        let [count, pitch, mass, speed] = input[..] else {
            panic!("four inputs")
        };
        let ring = Ring {
            count,
            pitch,
            mass,
            // The strain T / (k p), by which the tension exceeds that of a rigid ring, is 4·10⁻⁷.
            stiffness: 2.5e6 * expected[2] / pitch,
            speed,
        };
        let found = spin(&ring, 0.05, 50.0 * (mass / ring.stiffness).sqrt());
        for (((quantity, unit), got), expected) in RING.into_iter().zip(found).zip(expected) {
            let (all, tolerance) = (vec![expected; got.len()], case.number("tolerance"));
            case.judge_each(quantity, unit, &got, &all, Relative(tolerance));
        }
    }
}

#[test]
fn an_elastic_ring_stretches_by_its_rotation() {
    let case = Case::read("T02");
    let input = |key: &str| case.number(&format!("inputs.{key}"));
    let ring = Ring {
        count: input("N"),
        pitch: input("pitch"),
        mass: input("mass"),
        stiffness: input("stiffness"),
        speed: input("omega"),
    };
    let found = spin(&ring, 0.05, TAU / ring.speed);
    for ((quantity, unit), got) in RING.into_iter().zip(found) {
        let expected = case.number(&format!("expected.{quantity}"));
        let (all, tolerance) = (vec![expected; got.len()], case.number("tolerance"));
        case.judge_each(quantity, unit, &got, &all, Relative(tolerance));
    }
}

/// Displaced along a mode, every part of a drive is accelerated back by ω² times its displacement:
/// contacts, guides, tensioners and free sprockets included.
///
/// ```text
/// a(q + ε φ) − a(q − ε φ) = −2 ε ω² φ
/// ```
#[test]
fn forces_of_whole_drives_agree_with_their_modes() {
    for name in ["marine_engine_bare", "timing_drive", "industrial_16b"] {
        let mut parts = Scene::preset(name)
            .unwrap()
            .drive()
            .unwrap()
            .parts()
            .clone();
        for shaft in &mut parts.shafts {
            // A tooth that comes toward a roller at rest would push it by its damping too.
            if matches!(shaft.rotation, Rotation::Prescribed(_)) {
                shaft.rotation = Rotation::Prescribed(Motion::Held);
            }
        }
        let drive = Drive::new(parts).unwrap();
        let assembled = drive.assemble().unwrap();
        let found = assembled.modes().unwrap();
        let system = &assembled.system;
        let (dofs, rollers) = (assembled.q.len(), system.rollers());
        let bodies = system.free_dofs() - 2 * rollers;
        assert_eq!(found.modes.len(), system.free_dofs());
        let stride = (dofs - bodies) / 2;

        let still = vec![0.0; dofs];
        let accelerations = |shape: &[f64], by: f64| {
            let q: Vec<f64> = assembled
                .q
                .iter()
                .zip(shape)
                .map(|(q, s)| q + by * s)
                .collect();
            let at = Moment {
                t: 0.0,
                q: &q,
                v: &still,
                z: &[],
            };
            let mut a = vec![0.0; dofs];
            let mut rates = vec![0.0; system.quadratures()];
            system.evaluate(at, &mut a, &mut rates, &mut system.new_record());
            a
        };
        let highest = found.modes.last().unwrap().frequency;
        let mut worst = 0.0_f64;
        for mode in &found.modes {
            let mut shape = vec![0.0; dofs];
            for i in 0..stride {
                shape[i] = mode.roller_x[i % rollers];
                shape[stride + i] = mode.roller_y[i % rollers];
            }
            let free = drive.sprockets.iter().zip(&mode.sprocket_angle);
            let turns =
                |shaft: usize| matches!(drive.shafts[shaft].rotation, Rotation::Free { .. });
            let angles = free.filter(|(s, _)| turns(s.shaft));
            let moving = mode
                .tensioner_position
                .iter()
                .chain(angles.map(|(_, angle)| angle));
            for (i, moved) in moving.enumerate() {
                shape[2 * stride + i] = *moved;
            }
            let farthest = shape.iter().fold(0.0_f64, |m, s| m.max(s.abs()));
            let by = 1e-9 / farthest;
            let (ahead, behind) = (accelerations(&shape, by), accelerations(&shape, -by));
            let squared = (TAU * mode.frequency).powi(2).copysign(mode.frequency);
            for i in 0..dofs {
                let got = (ahead[i] - behind[i]) / (2.0 * by);
                let error = (got + squared * shape[i]).abs() / farthest;
                worst = worst.max(error / (TAU * highest).powi(2));
            }
        }
        eprintln!(
            "{name}: {} modes to {highest:.0} Hz, {worst:.1e}",
            found.modes.len()
        );
        eprintln!("   {:?}", &found.frequencies()[..8]);
        assert!(worst < 5e-6, "{name}: {worst:.1e}");
    }
}
