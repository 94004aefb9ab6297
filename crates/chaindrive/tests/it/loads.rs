//! Loads as engines have them: orders of any shaft in motions and torques, and what the tension shows of them.

use std::f64::consts::{PI, TAU};

use crate::dynamics;

use chaindrive::scene::Scene;
use chaindrive::{Run, RunIn, Simulation};
use chaindrive_mechanics::{Motion, Rotation, Support};

/// Two equal sprockets; `crank` and `driven` take what turns them.
fn pair(crank: &str, driven: &str) -> String {
    format!(
        r#"
[chain]
type = "16B-1"
links = 60
[[sprockets]]
name = "crank"
teeth = 20
centre = [0, 0]
{crank}
[[sprockets]]
name = "driven"
teeth = 20
centre = ["0.508 m", 0]
inertia = "5e-3 kg m^2"
{driven}
[route]
pretension = "1 kN"
"#
    )
}

fn scene(text: &str) -> Scene {
    Scene::from_text(text, "test.toml").unwrap_or_else(|error| panic!("{error}"))
}

fn motion_of(rotation: &Rotation) -> &Motion {
    match rotation {
        Rotation::Prescribed(motion) => motion,
        Rotation::Free { .. } => panic!("the motion is given"),
    }
}

/// ```text
/// θ = ω t + Σ A (sin(n Ω t + φ) − sin φ),   Ω the mean speed of the shaft whose turns count
/// ```
#[test]
fn motions_by_orders_are_their_closed_forms() {
    let speed = -13.0;
    let text = pair(
        r#"motion = { kind = "orders", speed = "-13 rad/s", terms = [
            { order = 6, amplitude = "0.01 rad" }, { order = 0.5, amplitude = "0.02 rad", phase = "40 deg" }] }"#,
        r#"motion = { kind = "orders", speed = "-26 rad/s", of = "crank", terms = [
            { order = 3, amplitude = "0.01 rad", phase = 1 }] }
support = { kind = "prescribed", x = "held", y = { kind = "orders", of = "crank", terms = [
            { order = 1.5, amplitude = "1 mm", phase = -2 }] } }"#,
    );
    let drive = scene(&text)
        .drive()
        .unwrap_or_else(|error| panic!("{error}"));
    let parts = drive.parts();
    let Support::Prescribed { y, .. } = &parts.sprockets[1].support else {
        panic!("the centre moves");
    };
    let forty = 40.0 * PI / 180.0;
    let cases = [
        (
            motion_of(&parts.shafts[0].rotation),
            speed,
            vec![(6.0, 0.01, 0.0), (0.5, 0.02, forty)],
        ),
        (
            motion_of(&parts.shafts[1].rotation),
            2.0 * speed,
            vec![(3.0, 0.01, 1.0)],
        ),
        (y, 0.0, vec![(1.5, 1e-3, -2.0)]),
    ];
    for (motion, mean, terms) in cases {
        for i in 0..50 {
            let t = 0.031 * f64::from(i);
            let found = motion.at(t);
            let mut expected = [mean * t, mean, 0.0];
            for &(order, amplitude, phase) in &terms {
                let rate: f64 = order * speed;
                let (sine, cosine) = (rate * t + phase).sin_cos();
                expected[0] += amplitude * (sine - f64::sin(phase));
                expected[1] += amplitude * rate * cosine;
                expected[2] -= amplitude * rate * rate * sine;
            }
            let found = [found.position, found.rate, found.acceleration];
            for (found, expected) in found.into_iter().zip(expected) {
                let allowed = 1e-12 * expected.abs().max(1.0);
                assert!(
                    (found - expected).abs() < allowed,
                    "{found}, not {expected}"
                );
            }
        }
    }
}

/// Tensions of all spans from `from` on, every millisecond.
fn tensions(scene: &Scene, from: f64, until: f64) -> Vec<(f64, Vec<f64>)> {
    let drive = scene.drive().unwrap_or_else(|error| panic!("{error}"));
    let run = Run {
        until,
        every: 1e-3,
        ..Run::default()
    };
    let mut simulation = Simulation::start(&drive, &run).expect("the drive is sound");
    let mut found = Vec::new();
    while let Some(sample) = simulation.next_sample().expect("the motion stays finite") {
        if sample.time >= from {
            found.push((sample.time, sample.span_tension.clone()));
        }
    }
    found
}

/// Amplitude at an order of a shaft that turns at `speed` \[1/s\]: the samples span whole turns.
fn at_order(samples: &[(f64, f64)], order: f64, speed: f64) -> f64 {
    let mean = samples.iter().map(|(_, x)| x).sum::<f64>() / samples.len() as f64;
    let [re, im] = samples.iter().fold([0.0; 2], |[re, im], (t, x)| {
        let (sine, cosine) = (TAU * order * speed * t).sin_cos();
        [re + (x - mean) * cosine, im + (x - mean) * sine]
    });
    2.0 * re.hypot(im) / samples.len() as f64
}

/// A torque on the driven shaft by orders of the crank, far below any resonance: M/R between the spans, at these orders.
#[test]
fn the_tension_shows_the_orders_of_a_torque() {
    let torque = |of: &str| {
        let driven = format!(
            r#"load = [{{ kind = "constant", torque = "-100 N m" }},
            {{ kind = "orders", {of} terms = [{{ order = 1.5, amplitude = "20 N m" }}, {{ order = 4, amplitude = "10 N m", phase = 1 }}] }},
            {{ kind = "angle-table", {of} turns = 2, angles = {{ unit = "deg", values = [0, 180, 360, 540, 720] }}, torques = [0, 8, 0, -8, 0] }}]"#
        );
        scene(&pair(
            r#"motion = { kind = "constant", speed = "300 rpm" }"#,
            &driven,
        ))
    };
    for of in ["", "of = \"crank\","] {
        let found = tensions(&torque(of), 0.4, 1.2 - 0.5e-3);
        let difference: Vec<(f64, f64)> = found
            .iter()
            .map(|(t, spans)| (*t, spans[0] - spans[1]))
            .collect();
        let radius = 0.0254 / (2.0 * (PI / 20.0).sin());
        // The triangle of the table has 8/π² of its height at its first order, half a turn, and nothing at even multiples of it.
        for (order, torque, allowed) in [
            (0.5, 8.0 * 8.0 / (PI * PI), 0.7),
            (1.5, 20.0, 1.5),
            (4.0, 10.0, 0.7),
        ] {
            let amplitude = at_order(&difference, order, 5.0) * radius;
            assert!(
                (amplitude - torque).abs() < allowed,
                "{amplitude} N m at order {order} with `{of}`, not {torque}"
            );
        }
        for order in [1.0, 2.0, 3.0] {
            let amplitude = at_order(&difference, order, 5.0) * radius;
            assert!(amplitude < 0.7, "{amplitude} N m at order {order}");
        }
    }
}

/// Under its loads no span of the engine goes slack, and the tension follows the orders of cams, crank and teeth.
#[test]
fn the_marine_engine_follows_its_loads() {
    let turn = 60.0 / 127.0;
    let found = tensions(
        &Scene::preset("marine_engine").unwrap(),
        0.3,
        0.3 + 4.0 * turn,
    );
    let least = found.iter().flat_map(|(_, spans)| spans.iter().copied());
    let least = least.fold(f64::INFINITY, f64::min);
    assert!(least > 1e3, "{least} N");
    let tight: Vec<(f64, f64)> = found.iter().map(|(t, spans)| (*t, spans[0])).collect();
    let after_tensioner: Vec<(f64, f64)> = found.iter().map(|(t, spans)| (*t, spans[2])).collect();
    let lines = [
        (&tight, 4.0),
        (&tight, 7.0),
        (&tight, 14.0),
        (&tight, 21.0),
        (&after_tensioner, 48.0),
    ];
    for (samples, order) in lines {
        let line = at_order(samples, order, 1.0 / turn);
        let around = [-1.5, -0.75, 0.75, 1.5].map(|off| at_order(samples, order + off, 1.0 / turn));
        let hash = around.iter().sum::<f64>() / 4.0;
        println!("order {order}: {line:.0} N, around it {hash:.0} N");
        assert!(
            line > 2.0 * hash,
            "order {order}: {line} N, around it {hash} N"
        );
    }
}

/// With loads held constant the tension scatters by at most 13 % in the span of highest mean, and 20 % in the others.
#[test]
fn the_marine_engine_runs_quietly_under_constant_loads() {
    let scene = Scene::preset("marine_engine")
        .and_then(|scene| {
            scene.replace(
                "sprockets.camshaft.load",
                r#"[{ kind = "constant", torque = "5 kN m" }]"#,
            )
        })
        .and_then(|scene| {
            scene.replace(
                "sprockets.crank.motion",
                r#"{ kind = "constant", speed = "-127 rpm" }"#,
            )
        })
        .unwrap_or_else(|error| panic!("{error}"));
    let found = tensions(&scene, 0.5, 2.0);
    for (span, allowed) in [(0, 0.13), (1, 0.2), (2, 0.2), (3, 0.2)] {
        let n = found.len() as f64;
        let mean = found.iter().map(|(_, spans)| spans[span]).sum::<f64>() / n;
        let squares = found.iter().map(|(_, spans)| (spans[span] - mean).powi(2));
        let scatter = (squares.sum::<f64>() / n).sqrt() / mean;
        println!("span {span}: {mean:.0} N, {:.1} %", 100.0 * scatter);
        assert!(scatter < allowed, "{scatter} in span {span}");
    }
}

/// Drives under orders of all kinds; what repeats slowest takes two turns of the crank.
fn ordered_drives() -> Vec<(&'static str, String)> {
    let crank = |speed: &str| {
        format!(
            r#"motion = {{ kind = "orders", speed = "{speed}", terms = [
                {{ order = 4, amplitude = "2 mrad" }}, {{ order = 1.5, amplitude = "3 mrad", phase = 1 }}] }}"#
        )
    };
    let steady = r#"motion = { kind = "constant", speed = "-300 rpm" }"#;
    let load = |of: &str, order: f64| {
        format!(
            r#"load = [{{ kind = "constant", torque = "100 N m" }}, {{ kind = "orders", {of}
                terms = [{{ order = {order}, amplitude = "40 N m", phase = 0.5 }}] }}]"#
        )
    };
    let table = r#"load = [{ kind = "constant", torque = "100 N m" }, { kind = "angle-table", of = "crank", turns = 2,
        angles = { unit = "deg", values = [0, 90, 360, 450, 720] }, torques = [0, 60, 0, -20, 0] }]"#;
    let shaking = r#"support = { kind = "prescribed", x = { kind = "orders", of = "crank", terms = [
        { order = 1.5, amplitude = "0.02 mm" }, { order = 4, amplitude = "0.02 mm", phase = 2 }] }, y = "held" }"#;
    let geared = r#"
        [[shafts]]
        name = "pump"
        [[gears]]
        name = "timing"
        between = ["crank", "pump"]
        teeth = [20, 40]
        "#;
    let shaken_by_pump = shaking.replace("crank", "pump").replace("1.5", "3");
    let own = load("", 4.0);
    let by_crank = load(r#"of = "crank","#, 4.0);
    vec![
        ("crank and load", pair(&crank("-300 rpm"), &by_crank)),
        (
            "the other way",
            pair(&crank("300 rpm"), &own.replace("100 N m", "-100 N m")),
        ),
        ("table over two turns", pair(&crank("-300 rpm"), table)),
        (
            "shaking centre",
            pair(steady, &format!("{by_crank}\n{shaking}")),
        ),
        (
            "geared",
            pair(
                &crank("-300 rpm"),
                &format!("{}\n{shaken_by_pump}", load(r#"of = "pump","#, 8.0)),
            ) + geared,
        ),
    ]
}

/// Defect: orders of a motion counted from t = 0 and torques from the assembly, so that every length of the run-in made another
/// drive: the tension's standard deviation moved by up to 17 %.
#[test]
fn the_length_of_the_run_in_makes_no_other_drive() {
    let drives = ordered_drives();
    let kinds = ["crank and load", "shaking centre", "geared"];
    run_ins_agree(
        drives.into_iter().filter(|it| kinds.contains(&it.0)),
        &[2.07],
    );
}

#[test]
#[ignore = "a study: every drive and six lengths"]
fn no_length_of_the_run_in_makes_another_drive() {
    run_ins_agree(ordered_drives(), &[2.05, 2.07, 2.1, 2.125, 2.25, 3.0]);
}

/// Holds drives that are run in for some turns against the same run in for two.
fn run_ins_agree(drives: impl IntoIterator<Item = (&'static str, String)>, lengths: &[f64]) {
    for (what, text) in drives {
        let scene = scene(&text);
        let drive = scene
            .drive()
            .unwrap_or_else(|error| panic!("{what}: {error}"));
        let of = |turns: f64| {
            let run = Run {
                run_in: RunIn::Turns {
                    turns,
                    sprocket: None,
                },
                // Two turns at 300 rpm, less the last sample.
                until: 0.4 - 1e-4,
                every: 1e-4,
                ..Run::default()
            };
            let mut simulation =
                Simulation::start(&drive, &run).unwrap_or_else(|error| panic!("{what}: {error}"));
            let mut tight = Vec::new();
            while let Some(sample) = simulation.next_sample().expect("the motion stays finite") {
                tight.push(sample.span_tension[0].max(sample.span_tension[1]));
            }
            let n = tight.len() as f64;
            let mean = tight.iter().sum::<f64>() / n;
            let std = (tight.iter().map(|t| (t - mean).powi(2)).sum::<f64>() / n).sqrt();
            let most = tight.iter().copied().fold(0.0, f64::max);
            [mean, std, most]
        };
        let reference = of(2.0);
        for &turns in lengths {
            let found = of(turns);
            let apart = [0, 1, 2].map(|k| found[k] / reference[k] - 1.0);
            let told = dynamics::brief(&apart);
            assert!(apart[1].abs() < 0.005, "{what}, {turns} turns: {told}");
            assert!(apart[2].abs() < 0.02, "{what}, {turns} turns: {told}");
        }
    }
}

/// ```text
/// ω = ω̄ (1 + Σ n A cos(n α + φ)),   α = ω̄ (t − t₀), t₀ the begin of the run-in
/// ```
#[test]
fn orders_count_from_where_the_simulation_began() {
    let mean = -300.0 * PI / 30.0;
    let text = &ordered_drives()[0].1;
    let drive = scene(text)
        .drive()
        .unwrap_or_else(|error| panic!("{error}"));
    let run_in = 0.0437;
    let run = Run {
        run_in: RunIn::Time(run_in),
        until: 0.01,
        every: 1e-3,
        ..Run::default()
    };
    let mut simulation = Simulation::start(&drive, &run).expect("the drive is sound");
    while let Some(sample) = simulation.next_sample().expect("the motion stays finite") {
        let angle = mean * (sample.time + run_in);
        let orders = [(4.0, 2e-3, 0.0), (1.5, 3e-3, 1.0)];
        let swing = orders.map(|(n, a, phase): (f64, f64, f64)| n * a * (n * angle + phase).cos());
        let speed = mean * (1.0 + swing.iter().sum::<f64>());
        assert!((sample.sprocket_speed[0] - speed).abs() < 1e-12 * mean.abs());
        let turned = orders.map(|(n, a, phase)| a * ((n * angle + phase).sin() - phase.sin()));
        let turned = angle + turned.iter().sum::<f64>();
        assert!((sample.sprocket_angle[0] - turned).abs() < 1e-12);
    }
}

/// Turns are those of the mean speed: with orders the crank sets off 1.2 % faster, or slower.
#[test]
fn turns_are_turns_at_the_mean_speed() {
    for (what, text) in ordered_drives() {
        let drive = scene(&text)
            .drive()
            .unwrap_or_else(|error| panic!("{error}"));
        let start = drive
            .assemble()
            .unwrap_or_else(|error| panic!("{what}: {error}"));
        for (speed, mean) in start.mean_speeds().into_iter().zip([10.0 * PI; 2]) {
            assert!(
                (speed.abs() / mean - 1.0).abs() < 1e-14,
                "{what}: {speed} rad/s"
            );
        }
        let circuit = start.slowest_circuit();
        // 60 links, 20 teeth, 5 turns a second.
        assert!(
            (circuit - 60.0 / 20.0 / 5.0).abs() < 1e-12,
            "{what}: {circuit} s"
        );
    }
}
