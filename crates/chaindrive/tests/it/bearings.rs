//! Losses of shafts: friction of bearings, drag of oil and air.

use std::f64::consts::TAU;

use chaindrive::describe::spans_at_rest;
use chaindrive::{Observation, Scene};
use chaindrive_mechanics::{Bearing, BearingFeed, Flow, Series, SkfBearing};

use crate::dynamics::run;

/// Speed of the driver \[rad/s\].
const SPEED: f64 = 100.0;

/// A small drive; keys of both sprockets, of the driver's speed, and of the run.
fn scene([driver, driven]: [&str; 2], speed: f64, more: &str) -> String {
    format!(
        r#"
        gravity = [0, -9.81]
        [chain]
        type = "08B-1"
        links = 80
        [[sprockets]]
        name = "driver"
        teeth = 17
        centre = [0, 0]
        motion = {{ kind = "constant", speed = {speed} }}
        {driver}
        [[sprockets]]
        name = "driven"
        teeth = 25
        centre = ["-0.372 m", 0]
        inertia = "0.01 kg m^2"
        load = [{{ kind = "constant", torque = "-20 N m" }}]
        {driven}
        [route]
        stops = ["driver", "driven"]
        pretension = "100 N"
        adjust = {{ kind = "sprocket", name = "driven", direction = [1, 0], within = "20 mm" }}
        [run]
        until = "20 ms"
        every = "20 us"
        run_in = "0 s"
        {more}
        "#
    )
}

/// Samples of a run, and its residual \[J\].
fn samples(text: &str) -> (Vec<Observation>, f64) {
    let mut seen = Vec::new();
    let simulation = run(text, |sample| seen.push(sample.clone()));
    (seen, simulation.energy_residual())
}

/// Energy that a flow took from the first to the last sample \[J\].
fn lost(seen: &[Observation], flow: Flow) -> f64 {
    let last = seen.last().expect("there are samples");
    last.energy.flow(flow) - seen[0].energy.flow(flow)
}

/// W = M ∫ ω²/√(ω² + ω_c²) dt: of the driver, whose speed is given, and of the driven sprocket by its angle.
#[test]
fn a_stated_torque_takes_what_it_says() {
    let bearing = r#"bearing = { kind = "torque", torque = "0.5 N m" }"#;
    let (plain, open) = samples(&scene([""; 2], SPEED, ""));
    let time = plain.last().unwrap().time - plain[0].time;
    let (seen, residual) = samples(&scene([bearing, ""], SPEED, ""));
    let expected = 0.5 * SPEED * SPEED / SPEED.hypot(0.1) * time;
    let found = lost(&seen, Flow::BearingLoss);
    assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
    // The driver supplies it, and nothing else changes.
    let more = lost(&seen, Flow::Driver) - lost(&plain, Flow::Driver);
    assert!((more / expected - 1.0).abs() < 1e-6, "{more} {expected}");
    assert!(
        (residual - open).abs() < 1e-6 * expected,
        "{residual} {open}"
    );
    assert!(lost(&plain, Flow::BearingLoss) == 0.0);

    let (seen, residual) = samples(&scene(["", bearing], SPEED, ""));
    let turned = seen.last().unwrap().sprocket_angle[1] - seen[0].sprocket_angle[1];
    let found = lost(&seen, Flow::BearingLoss);
    assert!((found / (0.5 * turned) - 1.0).abs() < 1e-4, "{found}");
    assert!(residual.abs() < 2.0 * open.abs() + 1e-3 * found);
}

/// W = ∫ M(F, ω) ω dt under the recorded force of the chain and the weight.
#[test]
fn bearings_carry_chain_and_weight() {
    let weight = 3.0 * 9.81;
    let ball = SkfBearing {
        bore: 25e-3,
        outside_diameter: 52e-3,
        series: Series::named("62").unwrap(),
        viscosity: 30e-6,
        feed: BearingFeed::Bath,
        boundary_coefficient: 0.15,
        full_film_coefficient: 0.05,
        creep_speed: 0.1,
    };
    let by_half = Bearing::Coefficient {
        coefficient: 0.0015,
        diameter: 30e-3,
        creep_speed: 0.1,
    };
    for (text, law) in [
        (
            r#"kind = "coefficient", coefficient = "deep-groove", diameter = "30 mm""#,
            by_half,
        ),
        (
            r#"kind = "skf", series = "62", bore = "25 mm", outside_diameter = "52 mm", viscosity = "30 mm^2/s""#,
            Bearing::Skf(ball),
        ),
    ] {
        let keys = format!("mass = \"3 kg\"\nbearing = {{ {text} }}");
        let (seen, _) = samples(&scene([&keys, ""], SPEED, ""));
        let power = |it: &Observation| {
            let [x, y] = [it.sprocket_force_x[0], it.sprocket_force_y[0] - weight];
            law.torque(x.hypot(y), SPEED) * SPEED
        };
        let steps = seen.windows(2);
        let expected: f64 = steps
            .map(|pair| 0.5 * (power(&pair[0]) + power(&pair[1])) * (pair[1].time - pair[0].time))
            .sum();
        let found = lost(&seen, Flow::BearingLoss);
        assert!(
            (found / expected - 1.0).abs() < 0.01,
            "{text}: {found} {expected}"
        );
    }
}

/// SKF's model of a 6205 with 30 mm²/s under 1 kN, at rest, 300 and 1500 r/min: computed apart from this program, from the equations of the
/// catalogue.
#[test]
fn skf_model_by_hand() {
    let law = Bearing::Skf(SkfBearing {
        bore: 25e-3,
        outside_diameter: 52e-3,
        series: Series::named("62").unwrap(),
        viscosity: 30e-6,
        feed: BearingFeed::Bath,
        boundary_coefficient: 0.15,
        full_film_coefficient: 0.05,
        creep_speed: 0.1,
    });
    for (speed, expected) in [
        (0.0, 0.018_753_139_822_563),
        (300.0, 0.019_988_863_911_641),
        (1500.0, 0.019_055_907_999_194),
    ] {
        let found = law.torque(1000.0, speed * TAU / 60.0);
        assert!((found / expected - 1.0).abs() < 1e-9, "{speed}: {found}");
    }
    // The constant coefficient says 18.75 N mm.
    assert_eq!(Series::named("65"), None);
}

#[test]
fn drag_grows_with_the_square_of_the_speed() {
    let drag = r#"drag = { torque = "0.2 N m", speed = "50 rad/s" }"#;
    let [slow, fast] = [50.0, 100.0].map(|speed| {
        let (seen, _) = samples(&scene([drag, ""], speed, ""));
        let turned = seen.last().unwrap().sprocket_angle[0] - seen[0].sprocket_angle[0];
        lost(&seen, Flow::ShaftDragLoss) / turned
    });
    assert!((slow / 0.2 - 1.0).abs() < 1e-9, "{slow}");
    assert!((fast / slow - 4.0).abs() < 1e-9, "{fast}");
}

/// Losses of nothing leave every bit where it was.
#[test]
fn no_loss_is_no_change() {
    let none = r#"
        bearing = { kind = "torque", torque = 0 }
        drag = { torque = 0, speed = "50 rad/s" }"#;
    let [plain, idle] = ["", none].map(|keys| samples(&scene([keys; 2], SPEED, "")).0);
    for (plain, idle) in plain.iter().zip(&idle) {
        assert_eq!(plain.roller_x, idle.roller_x);
        assert_eq!(plain.sprocket_angle, idle.sprocket_angle);
        assert_eq!(plain.energy, idle.energy);
    }
}

/// A wheel by itself, and with a shaft on gears behind it, runs down evenly and stays: J α = −M, all its energy goes into the bearing.
#[test]
fn a_wheel_runs_down_and_stays() {
    for (model, method) in [
        ("particles", "verlet"),
        ("particles", "dormand-prince"),
        ("ideal-joints", "implicit-damping"),
        ("clearance-joints", "generalized-alpha"),
    ] {
        for (bearing, shafts, inertia, torque) in [
            (
                r#"bearing = { kind = "torque", torque = "1 N m" }"#,
                "",
                1e-3,
                1.0,
            ),
            (
                "",
                r#"
                [[shafts]]
                name = "behind"
                inertia = "2e-3 kg m^2"
                bearing = { kind = "torque", torque = "2 N m" }
                [[gears]]
                name = "pair"
                between = ["loose", "behind"]
                teeth = [10, 20]"#,
                // J + i² J₂ and i M of i = 1/2
                1.5e-3,
                1.0,
            ),
        ] {
            let more = format!(
                r#"
                method = "{method}"
                [[sprockets]]
                name = "loose"
                teeth = 15
                centre = ["1 m", "1 m"]
                inertia = "1e-3 kg m^2"
                speed = "10 rad/s"
                {bearing}
                {shafts}"#
            );
            let text = scene([""; 2], SPEED, &more);
            let chain = format!("links = 80\nmodel = \"{model}\"");
            let (seen, _) = samples(&text.replace("links = 80", &chain));
            for sample in &seen {
                let expected = (10.0 - torque / inertia * sample.time).max(0.0);
                let found = sample.sprocket_speed[2];
                // Near rest the torque fades over the creep speed.
                assert!(
                    (found - expected).abs() < 0.3,
                    "{method}: {found} {expected}"
                );
            }
            let last = seen.last().unwrap();
            assert!(last.sprocket_speed[2].abs() < 1e-2, "{method}");
            let found = lost(&seen, Flow::BearingLoss);
            let expected = 0.5 * inertia * 100.0;
            assert!((found / expected - 1.0).abs() < 0.01, "{method}: {found}");
        }
    }
}

/// 60 (150 − n)/7.5 N m of a motor balance 20 N m of load and 2 N m of bearings on a sprocket as large: n = 150 − 7.5 · 22/60.
#[test]
fn working_points_know_bearings() {
    let motor = r#"
        [[sprockets]]
        name = "motor"
        teeth = 17
        centre = [0, 0]
        inertia = 0.02
        speed = "working-point"
        drive = [{ kind = "speed-table", speeds = ["0 rpm", "142.5 rpm", "150 rpm", "165 rpm"], torques = [110, 60, 0, -120] }]"#;
    let text = format!(
        r#"
        [chain]
        type = "08B-1"
        {motor}
        [[sprockets]]
        name = "driven"
        teeth = 17
        centre = ["-600 mm", 0]
        inertia = 0.1
        load = [{{ kind = "constant", torque = -20 }}]
        bearing = {{ kind = "torque", torque = "2 N m" }}
        [route]
        pretension = "800 N"
        adjust = {{ kind = "sprocket", name = "motor", direction = [1, 0], within = "10 mm" }}
        "#
    );
    let drive = Scene::from_text(&text, "test.toml")
        .unwrap()
        .drive()
        .unwrap();
    let assembled = drive.assemble().unwrap();
    let trains = assembled.free_trains();
    let expected = 150.0 - 7.5 * 22.0 / 60.0;
    let found = trains[0].working_point.unwrap() * 60.0 / TAU;
    assert!((found - expected).abs() < 0.01, "{found} {expected}");
    // The chain pulls for both from the start: M = T₁ l₁ − T₂ l₂, and the lever of a span is between R cos(π/z) and R as the polygon stands.
    let spans = spans_at_rest(&drive, &assembled);
    let [slack, tight] = [f64::min, f64::max].map(|of| of(spans[0].tension, spans[1].tension));
    let radius = 0.5 * 12.7e-3 / (TAU / 34.0).sin();
    let shorter = 1.0 - (TAU / 34.0).cos();
    let beyond = tight - slack - 22.0 / radius;
    // The weight W of a span tilts its ends by W/2T, which moves the lever by R sin(π/z) W/2T at most: W/2 sin(π/z) a span.
    let masses = &drive.chains[0].chain.masses;
    let weight = 9.81 * masses[0] * 0.6 / 12.7e-3;
    let sag = (TAU / 34.0).sin() * weight;
    assert!(
        beyond > -slack * shorter - sag && beyond < tight * shorter + sag,
        "{beyond}: {slack} {tight}, {sag}"
    );
}

/// The viscosity of a bearing is that of the oil, and `describe` says who takes it.
#[test]
fn bearings_take_the_viscosity_of_the_oil() {
    let bearing =
        r#"bearing = { kind = "skf", series = "62", bore = "25 mm", outside_diameter = "52 mm" }"#;
    let oil = r#"
        [lubricant]
        grade = "VG 150"
        temperature = "60 degC""#;
    let described = |text: &str| {
        let scene = Scene::from_text(text, "test.toml").unwrap();
        let run = chaindrive::Run::suggested(&scene.run_defaults());
        let drive = scene.drive().unwrap();
        chaindrive::Description::of(&drive, &run).unwrap()
    };
    let with = described(&scene([bearing, ""], SPEED, oil));
    let facts = with.oil.clone().unwrap();
    assert_eq!(facts.used_by, ["sprockets[0].bearing.viscosity"]);
    assert!(
        with.to_string()
            .contains("kg/m³ at 60 °C; for sprockets[0].bearing.viscosity")
    );
    assert!(
        !with
            .model
            .absent
            .contains(&"friction of the bearings of shafts")
    );
    assert!(with.model.absent.contains(&"drag of oil and air on shafts"));
    let idle = described(&scene([""; 2], SPEED, oil)).to_string();
    assert!(idle.contains("no part of the drive asks for it"), "{idle}");
    let resolved = Scene::from_text(&scene([bearing, ""], SPEED, oil), "t.toml").unwrap();
    let resolved = resolved.resolved().unwrap();
    let resolved = resolved.text();
    assert!(
        resolved.contains("of the lubricant at its temperature"),
        "{resolved}"
    );
}

#[test]
fn bad_losses_are_named() {
    let refused = |keys: &str, more: &str| {
        let text = scene([keys, ""], SPEED, more);
        let scene = Scene::from_text(&text, "test.toml");
        let drive = scene.and_then(|scene| scene.drive());
        drive
            .err()
            .map(|error| error.to_string())
            .unwrap_or_default()
    };
    let skf = |keys: &str| format!(r#"bearing = {{ kind = "skf", bore = "25 mm", {keys} }}"#);
    for (keys, more, words) in [
        (
            r#"bearing = { kind = "torque", torque = "-1 N m" }"#.to_owned(),
            "",
            ["sprockets[0].bearing.torque", "not negative [N m]"],
        ),
        (
            r#"bearing = { kind = "coefficient", coefficient = "needle", diameter = "3 cm" }"#
                .to_owned(),
            "",
            ["sprockets[0].bearing.coefficient", "pure number"],
        ),
        (
            skf(r#"series = "65", outside_diameter = "52 mm", viscosity = "30 mm^2/s""#),
            "",
            ["sprockets[0].bearing.series", "`65`"],
        ),
        (
            skf(r#"series = "62", outside_diameter = "20 mm", viscosity = "30 mm^2/s""#),
            "",
            [
                "sprockets[0].bearing.outside_diameter",
                "more than the bore",
            ],
        ),
        (
            skf(r#"series = "62", outside_diameter = "52 mm""#),
            "",
            ["sprockets[0].bearing.viscosity", "`lubricant`"],
        ),
        (
            r#"drag = { torque = "1 N m", speed = "10 rad/s", exponent = 4 }"#.to_owned(),
            "",
            ["sprockets[0].drag.exponent", "at most 3"],
        ),
        (
            String::new(),
            "[lubricant]\ngrade = \"VG 151\"\ntemperature = \"60 degC\"",
            ["lubricant.grade", "did you mean"],
        ),
        (
            String::new(),
            "[lubricant]\ngrade = \"VG 150\"\ntemperature = 60",
            ["lubricant.temperature", "at least 233.15 [K]"],
        ),
        (
            String::new(),
            "[lubricant]\ntemperature = \"60 degC\"",
            ["lubricant.grade", "missing"],
        ),
        (
            String::new(),
            "[lubricant]\nviscosity_40 = \"3 mm^2/s\"\ntemperature = \"60 degC\"",
            ["lubricant.viscosity_40", "viscosity index"],
        ),
        (
            String::new(),
            "[[shafts]]\nname = \"s\"\ninertia = 1\nbearing = { kind = \"coefficient\", coefficient = 0.001, diameter = 0.1 }\n",
            ["shafts[0].bearing", "stated torque"],
        ),
    ] {
        let text = refused(&keys, more);
        for word in words {
            assert!(text.contains(word), "{keys}{more}: {text}");
        }
    }
}
