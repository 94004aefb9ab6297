//! Sprockets and rollers that are not as drawn: run-out, places of tooth gaps, diameters of rollers.

use std::f64::consts::TAU;

use chaindrive::{Description, Run, Scene};
use chaindrive_mechanics::BodyKind;

use crate::dynamics::{run, run_open};
use crate::two_sprockets::{TwoSprockets, steady};

/// Teeth, and turns of the driver after which all is as it was: of the driven sprocket two.
const TEETH: [f64; 2] = [20.0, 30.0];
const TURNS: f64 = 3.0;
/// Speed of the driver \[1/s\].
const SPEED: f64 = 2.0;
const PITCH: f64 = 25.4e-3;

/// Pitch radius \[m\].
fn radius(teeth: f64) -> f64 {
    0.5 * PITCH / (0.5 * TAU / teeth).sin()
}

/// What both drives have in common.
const DRIVE: TwoSprockets<'_> = TwoSprockets {
    pitch: PITCH,
    mass: 0.07,
    stiffness: 20e6,
    roller: 15.88e-3,
    chain: "drag = \"20 N s/m^2\"",
    contact: 100e6,
    teeth_keys: "restitution = 0.5",
    ..TwoSprockets::NOTHING
};

/// A slow drive under a torque for some turns. The return strand hangs so low that a run-out does not change its pull.
fn slack_return(driver: &str, driven: &str, turns: f64) -> String {
    let every = 0.25e-3;
    TwoSprockets {
        before: "gravity = [0, -9.81]",
        links: 86.0,
        damping_ratio: 0.1,
        teeth: TEETH,
        centre: [-0.766, 0.0],
        driver: &format!("{}\n{driver}", steady(TAU * SPEED)),
        inertia: 0.02,
        driven: &format!("load = [{{ kind = \"constant\", torque = \"-150 N m\" }}]\n{driven}"),
        until: turns / SPEED - every,
        every,
        run: "run_in = \"0.5 s\"",
        ..DRIVE
    }
    .text()
}

/// Angle \[rad\] of the driven sprocket less what that of the driver asks for, over time.
fn transmission_error(text: &str) -> Vec<(f64, f64)> {
    let mut found = Vec::new();
    run_open(text, |seen| {
        let [driver, driven] = seen.sprocket_angle[..] else {
            panic!("two sprockets");
        };
        found.push((seen.time, driven - driver * TEETH[0] / TEETH[1]));
    });
    found
}

/// Amplitude at a number of periods in all samples, which span whole periods.
fn amplitude(samples: &[(f64, f64)], periods: f64) -> f64 {
    let count = samples.len() as f64;
    let mean = samples.iter().map(|(_, x)| x).sum::<f64>() / count;
    let [re, im] = samples
        .iter()
        .enumerate()
        .fold([0.0; 2], |[re, im], (i, (_, x))| {
            let (sine, cosine) = (TAU * periods * i as f64 / count).sin_cos();
            [re + (x - mean) * cosine, im + (x - mean) * sine]
        });
    2.0 * re.hypot(im) / count
}

/// Where the return strand is slack, each sprocket shows its own run-out in the angle of the driven one.
///
/// ```text
/// e₁/R₂ at the order of the driver,   e₂/R₂ at that of the driven sprocket
/// ```
///
/// # Source
/// A centre beside the axis carries the strand along by the component of e along it; by hand.
#[test]
fn run_out_is_a_transmission_error_of_its_own_order() {
    let large = radius(TEETH[1]);
    let moved = transmission_error(&slack_return(
        "eccentricity = \"60 um\"\neccentricity_angle = \"40 deg\"",
        "eccentricity = \"90 um\"",
        TURNS,
    ));
    for (periods, eccentricity) in [(TURNS, 60e-6), (2.0, 90e-6)] {
        let expected = eccentricity / large;
        let found = amplitude(&moved, periods);
        println!("{periods}: {found:.4e} {expected:.4e}");
        assert!((found / expected - 1.0).abs() < 0.02, "{found} {expected}");
    }
}

/// An error of gaps that goes round once moves the strand by the mean of the loaded gaps, and makes sidebands of the tooth order. Without it
/// nothing has the order of either sprocket. Sidebands are microradians: they ask for two long runs.
#[test]
fn gaps_out_of_place_make_sidebands() {
    let still = transmission_error(&slack_return("", "", TURNS));
    let waves = r#"gap_errors = { kind = "orders", waves = [{ order = 1, amplitude = "60 um" }] }"#;
    let moved = transmission_error(&slack_return(waves, "", TURNS));
    let expected = 60e-6 / radius(TEETH[1]);
    let found = amplitude(&moved, TURNS);
    println!("{found:.4e} {expected:.4e}");
    for periods in [TURNS, 2.0] {
        let before = amplitude(&still, periods);
        assert!(before < 0.02 * expected, "{before} without");
    }
    assert!(
        (0.75..1.0).contains(&(found / expected)),
        "{found} {expected}"
    );
    for side in [-1.0, 1.0] {
        let periods = TURNS * (TEETH[0] + side);
        let [before, found] = [&still, &moved].map(|of| amplitude(of, periods));
        println!("z {side:+}: {before:.3e} {found:.3e}");
        assert!(found > 3.0 * before, "{before} {found}");
    }
}

/// A loop of two equal sprockets that is taut all round, for some turns. `apart`: how much farther than drawn.
fn taut_loop(apart: f64, driver: &str, turns: f64) -> String {
    TwoSprockets {
        before: "gravity = [0, 0]",
        links: 40.0,
        damping_ratio: 0.2,
        teeth: [20.0; 2],
        centre: [10.0 * PITCH + 0.762e-3 + apart, 0.0],
        driver: &format!("{}\n{driver}", steady(0.5 * TAU)),
        inertia: 0.01,
        until: 2.0 * turns - 1e-3,
        every: 1e-3,
        run: "run_in = \"0.2 s\"",
        ..DRIVE
    }
    .text()
}

/// Where both strands are taut, a run-out along the line of centres is a stretch of both, and one across it none.
///
/// ```text
/// T = T₀ + k e cos ωt,   k = dT/dC by two centre distances
/// ```
#[test]
fn run_out_stretches_a_taut_loop() {
    let tension = |text: &str| {
        let mut found = Vec::new();
        run(text, |seen| {
            found.push((
                seen.time,
                0.5 * (seen.span_tension[0] + seen.span_tension[1]),
            ));
        });
        found
    };
    let mean = |of: &[(f64, f64)]| of.iter().map(|(_, x)| x).sum::<f64>() / of.len() as f64;
    let apart = 200e-6;
    // Means of four teeth.
    let [near, far] = [-apart, apart].map(|apart| mean(&tension(&taut_loop(apart, "", 0.2))));
    let stiffness = (far - near) / (2.0 * apart);
    let moved = tension(&taut_loop(0.0, "eccentricity = \"200 um\"", 1.0));
    let found = amplitude(&moved, 1.0);
    let expected = stiffness * apart;
    println!("{found:.2} {expected:.2} N of {:.1}", mean(&moved));
    assert!((found / expected - 1.0).abs() < 0.02, "{found} {expected}");
}

/// The ledger closes to the error of the step with run-out, displaced gaps and unlike rollers; a drawing shows the centre of the teeth.
#[test]
fn all_of_it_is_seen_and_conserves_energy() {
    let driver = r#"eccentricity = "0.2 mm"
        eccentricity_angle = "30 deg"
        gap_errors = { kind = "random", deviation = "30 um", seed = 3 }"#;
    let text = slack_return(driver, "", 0.1).replace(
        "damping_ratio = 0.1",
        "damping_ratio = 0.1\nscatter = { roller_diameter = 0.002, seed = 5 }",
    );
    run(&text.replace("0.5 s", "0.02 s"), |_| {});
    let scene = Scene::from_text(&text, "case.toml").unwrap();
    let drive = scene.drive().unwrap();
    let chain = &drive.chains[0].chain;
    let deviations = &chain.roller_deviations;
    assert_eq!(deviations.len(), 86);
    let square = deviations.iter().map(|it| it * it).sum::<f64>() / 86.0;
    assert!((square.sqrt() / (0.002 * 15.88e-3) - 1.0).abs() < 0.25);
    let gaps = &drive.sprockets[0].tolerance.gap_displacements;
    let square = gaps.iter().map(|it| it * it).sum::<f64>() / 20.0;
    assert!((square.sqrt() / 30e-6 - 1.0).abs() < 0.4, "{square}");
    let told = Description::of(&drive, &Run::default())
        .unwrap()
        .to_string();
    let unlike = "driver: run-out 400.0 µm, gaps out of place by up to ";
    assert!(
        told.contains(unlike) && told.contains("roller diameters"),
        "{told}"
    );
    assert!(!told.contains("run-out and pitch errors"), "{told}");
    let figure = drive.assemble().unwrap().figure().unwrap();
    let sprocket = &figure.bodies[0];
    assert!(matches!(sprocket.kind, BodyKind::Sprocket { .. }));
    let outline = &sprocket.outlines[0];
    assert!(outline.is_closed());
    let middle = outline.aabb();
    let middle = nalgebra::center(&middle.min, &middle.max);
    // The first gap lies on the y axis of the frame: 30° from there, counter-clockwise.
    let exact = [
        -0.2e-3 * f64::sin(TAU / 12.0),
        0.2e-3 * f64::cos(TAU / 12.0),
    ];
    for (found, exact) in [middle.x, middle.y].into_iter().zip(exact) {
        assert!((found - exact).abs() < 1e-9, "{found} {exact}");
    }
}

/// Every mistake is found where it stands.
#[test]
fn mistakes_in_tolerances_are_told() {
    let text = |driver: &str| slack_return(driver, "", TURNS);
    let cases = [
        (
            r#"gap_errors = { kind = "list", displacements = ["10 um"] }"#,
            "sprockets[0].gap_errors.displacements",
            "one displacement for every gap",
        ),
        (
            r#"eccentricity = "3 mm""#,
            "sprockets[0].eccentricity",
            "below a tenth of the pitch",
        ),
        (
            r#"eccentricity = "-1 um""#,
            "sprockets[0].eccentricity",
            "not negative",
        ),
    ];
    for (driver, path, told) in cases {
        let error = Scene::from_text(&text(driver), "case.toml")
            .and_then(|scene| scene.drive())
            .unwrap_err()
            .to_string();
        assert!(error.contains(path) && error.contains(told), "{error}");
    }
}
