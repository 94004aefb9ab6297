//! The duty that a run asks of a drive: every reason of the verdict that speaks of it, with a run that brings it about and one that
//! does not; and the counts behind them.
#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use chaindrive::chain_verdict::{Check, Limit};
use chaindrive::rating::rated_power;
use chaindrive::record::SpanStatistics;
use chaindrive::{
    ChainVerdict, Channel, CheckOutcome, Description, EventKinds, Memory, Request, Run, Scene,
    SettingValue, Settings, Simulation, Summary, Trust, Verdict, execute,
};
use chaindrive_mechanics::{BodyImpacts, Energy};

use crate::judged::{finished, names, page, preset, run, verdict};

/// A chain of the catalogue around two sprockets of 19 teeth, the second of which is given this.
fn two_sprockets(second: &str) -> Scene {
    let text = format!(
        r#"
        chain = "16A-1"
        [[sprockets]]
        name = "driver"
        teeth = 19
        centre = ["0 mm", "0 mm"]
        motion = {{ kind = "constant", speed = "300 rpm" }}
        [[sprockets]]
        name = "driven"
        teeth = 19
        centre = ["749.3 mm", "0 mm"]
        {second}
        [route]
        pretension = "2 kN"
        "#
    );
    Scene::from_toml(&text, "two_sprockets").unwrap()
}

fn loaded(torque: &str) -> Scene {
    two_sprockets(&format!(
        r#"inertia = "0.5 kg m^2"
        load = [{{ kind = "constant", torque = "{torque}" }}]"#
    ))
}

fn driven(speed: &str) -> Scene {
    two_sprockets(&format!(
        r#"motion = {{ kind = "constant", speed = "{speed}" }}"#
    ))
}

/// Asserts that the first verdict has a reason of some name, and the second not.
fn tells_apart(reason: &str, with: &Verdict, without: &Verdict) {
    assert!(names(with).contains(&reason), "{with}");
    assert!(!names(without).contains(&reason), "{without}");
}

/// The catalogue knows what breaks a 56B, and a scene may say it itself.
#[test]
fn a_link_that_bears_more_than_breaks_the_chain_is_distrusted() {
    let breaks_at = |load: &str| preset("marine_two_sprockets", &[("chain.breaking_load", load)]);
    let weak = verdict(&breaks_at("15 kN"), &run(0.01, 100.0));
    tells_apart(
        "above-breaking-load",
        &weak,
        &verdict(&breaks_at("100 kN"), &run(0.01, 100.0)),
    );
    assert_eq!(weak.trust, Trust::Distrusted);
    assert!(weak.note().contains("breaks at 15.0 kN"), "{weak}");
    let known = preset("marine_two_sprockets", &[("chain.type", "56B-1")]);
    let strength = known.drive().unwrap().chains[0].chain.strength;
    assert_eq!(strength.breaking_load, Some(850e3));
    // Of chains of the B series no formula for the power could be read.
    let missing = "not rated: source missing";
    let rated = rated_power(&strength, 19, 31.4);
    assert_eq!(rated.unwrap_err().to_string(), missing);
}

/// A 16A on 19 teeth at 300 rpm is rated for 12.2 kW: 388 N m.
#[test]
fn more_power_than_a_chain_is_rated_for_fails() {
    let rated = |torque: &str| {
        let (simulation, summary) = finished(&loaded(torque), &run(0.05, 100.0));
        power_check(&summary, &simulation)
    };
    let over = rated("-600 N m");
    assert_eq!(over.outcome, CheckOutcome::Fail, "{over}");
    // 600 N m at 31.4 rad/s are 18.85 kW.
    assert!(
        (over.value.unwrap() / (100.0 * 18.85 / 12.16) - 1.0).abs() < 0.02,
        "{over}"
    );
    assert_eq!(rated("-300 N m").outcome, CheckOutcome::Pass);
}

/// What is said of the power of the chain.
fn power_check(summary: &Summary, simulation: &Simulation) -> Check {
    let chains = ChainVerdict::of(summary, simulation, &[]);
    let of_power = |it: &Check| matches!(it.limit, Limit::RatedPower | Limit::TwinPower);
    chains.checks.into_iter().find(of_power).unwrap()
}

/// Two strands bear 1.7 times, and a service factor counts with what is carried: 600 N m are 18.8 kW, over 12.2 and under 20.7 kW.
#[test]
fn strands_and_service_factor_serve_the_rating_only() {
    let run = run(0.05, 100.0);
    let changed = |torque: &str, path: &str, value: &str| {
        finished(&loaded(torque).replace(path, value).unwrap(), &run)
    };
    let judged = |of: &(Simulation, Summary)| power_check(&of.1, &of.0);
    let one = changed("-600 N m", "chain.strands", "1");
    let two = changed("-600 N m", "chain.strands", "2");
    assert_eq!(judged(&one).outcome, CheckOutcome::Fail);
    assert_eq!(judged(&two).outcome, CheckOutcome::Pass);
    let rough = changed("-300 N m", "chain.service_factor", "1.5");
    let smooth = changed("-300 N m", "chain.service_factor", "1");
    assert_eq!(judged(&rough).outcome, CheckOutcome::Fail);
    assert_eq!(judged(&smooth).outcome, CheckOutcome::Pass);
    for (changed, plain) in [(&two, &one), (&rough, &smooth)] {
        let residual = |of: &(Simulation, Summary)| of.1.residual.to_bits();
        assert_eq!(residual(changed), residual(plain), "the motion is another");
    }
    for wrong in ["0", "7"] {
        assert!(loaded("-300 N m").replace("chain.strands", wrong).is_err());
    }
}

/// A chain of the B series is rated by what its maker says; else it is held against its twin, which warns and never fails it.
#[test]
fn a_chain_that_nobody_rates_is_held_against_its_twin() {
    let rated = |changes: &[(&str, &str)]| {
        let scene = preset("industrial_16b", changes);
        let (simulation, summary) = finished(&scene, &run(0.05, 100.0));
        power_check(&summary, &simulation)
    };
    let silent = rated(&[]);
    assert_eq!(
        (silent.limit, silent.outcome),
        (Limit::TwinPower, CheckOutcome::Warning)
    );
    for (power, outcome) in [
        ("\"13 kW\"", CheckOutcome::Fail),
        ("\"18 kW\"", CheckOutcome::Pass),
    ] {
        let by_maker = rated(&[("chain.rated_power", power)]);
        assert_eq!(
            (by_maker.limit, by_maker.outcome),
            (Limit::RatedPower, outcome)
        );
        assert_eq!(by_maker.note, "maker");
    }
}

/// Both shafts bear the tensions of both spans, drawn towards each other: the mean forces are equal and opposite, and along the centres.
#[test]
fn shafts_bear_the_chain_towards_each_other() {
    let (_, summary) = finished(&loaded("-300 N m"), &run(0.05, 100.0));
    let ratings = summary.ratings();
    let [rating] = ratings.as_slice() else {
        panic!("{ratings:?}");
    };
    let [driver, driven] = rating.shaft_loads.as_slice() else {
        panic!("{rating:?}");
    };
    let tensions: f64 = summary.spans.iter().map(SpanStatistics::mean).sum();
    for load in [driver, driven] {
        assert!(
            (load.force / tensions - 1.0).abs() < 0.05,
            "{load:?} {tensions}"
        );
    }
    assert!(driver.angle.to_degrees().abs() < 3.0, "{driver:?}");
    assert!(driven.angle.to_degrees().abs() > 177.0, "{driven:?}");
    let utilised = rating.utilisation().unwrap();
    assert!((utilised / (9425.0 / 12.16e3) - 1.0).abs() < 0.05);
    let greatest = summary
        .spans
        .iter()
        .map(SpanStatistics::mean)
        .fold(0.0, f64::max);
    // F_u of a 16A is 56.7 kN; d b = 7.92 mm (15.75 + 2 · 3.25) mm.
    assert!((rating.dynamic_safety.unwrap() * greatest / 56.7e3 - 1.0).abs() < 1e-9);
    let pressure = greatest / (7.92e-3 * 22.25e-3);
    assert!((rating.bearing_pressure.unwrap() / pressure - 1.0).abs() < 1e-9);
    assert!(rating.static_safety.unwrap() <= rating.dynamic_safety.unwrap());
}

/// A pin that falls through its play at a weight, by the law that ends at half of it.
fn dropped(gravity: &str, law: &str) -> Verdict {
    let law = format!("\"{law}\"");
    let gravity = format!(r#"["0 m/s^2", "{gravity}"]"#);
    let changes = [
        ("gravity", gravity.as_str()),
        ("contact.joints.law", &law),
        // Plates are rigid.
        ("contact.joints.series", "0"),
    ];
    let run = Run {
        step: Some(2e-7),
        ..run(8e-3, 100.0)
    };
    verdict(&preset("pin_in_bush", &changes), &run)
}

/// √(2 g · 0.2 mm) is 63 mm/s on earth, and 20 m/s where things weigh a hundred thousand times as much.
#[test]
fn contacts_beyond_their_laws_are_a_caution() {
    let gently = dropped("-9.81 m/s^2", "johnson");
    let hard = dropped("-1e6 m/s^2", "johnson");
    tells_apart("deep-contact", &hard, &gently);
    tells_apart("fast-impact", &hard, &gently);
    assert!(hard.note().contains("pins in bushes"), "{hard}");
    // A power goes on.
    let endless = dropped("-1e6 m/s^2", "cylindrical");
    tells_apart("deep-contact", &hard, &endless);
    tells_apart("fast-impact", &endless, &gently);
}

#[test]
fn a_load_that_drives_is_a_caution() {
    let (drives, resists) = (loaded("300 N m"), loaded("-300 N m"));
    let drives = verdict(&drives, &run(0.05, 100.0));
    tells_apart(
        "load-drives",
        &drives,
        &verdict(&resists, &run(0.05, 100.0)),
    );
    // A torque that swings about what it takes puts nothing in.
    let swings = two_sprockets(
        r#"inertia = "0.5 kg m^2"
        load = [
            { kind = "constant", torque = "-20 N m" },
            { kind = "harmonic", amplitude = "200 N m", order = 20 },
        ]"#,
    );
    tells_apart("load-drives", &drives, &verdict(&swings, &run(0.05, 100.0)));
}

/// Teeth pass at 95 Hz.
#[test]
fn samples_too_rare_for_the_mesh_are_a_caution_where_they_are_kept() {
    let with = |every: f64, kept: bool| {
        let settings = Settings::default()
            .with("until", SettingValue::Number(0.1))
            .with("every", SettingValue::Number(every));
        let request = Request::new(&loaded("-300 N m"), &settings).unwrap();
        let request = request.with_default_step().without_estimate();
        if kept {
            return execute(&request, &mut Memory::default(), &|| false)
                .unwrap()
                .verdict;
        }
        verdict(&request.scene, &request.run)
    };
    let rare = with(8e-3, true);
    tells_apart("samples-rare", &rare, &with(4e-3, true));
    tells_apart("samples-rare", &rare, &with(8e-3, false));
    assert!(rare.note().contains("--every \"5.3 ms\""), "{rare}");
}

/// 19 teeth at 330 rpm against 300: a tooth and a half in 0.16 s.
#[test]
fn motions_that_fight_are_distrusted_and_told_before_the_run() {
    let fighting = driven("330 rpm");
    let fought = verdict(&fighting, &run(0.16, 100.0));
    tells_apart(
        "motions-fight",
        &fought,
        &verdict(&driven("300 rpm"), &run(0.16, 100.0)),
    );
    assert_eq!(fought.trust, Trust::Distrusted);
    // Before the chain is a tooth longer nothing is said.
    tells_apart(
        "motions-fight",
        &fought,
        &verdict(&fighting, &run(0.05, 100.0)),
    );
    let warnings = |scene: &Scene, until| {
        let drive = scene.drive().unwrap();
        Description::of(&drive, &run(until, 100.0))
            .unwrap()
            .warnings
    };
    let told = warnings(&fighting, 0.16);
    assert!(told[0].contains("1.5 teeth of chain apart"), "{told:?}");
    assert!(warnings(&fighting, 0.05).is_empty());
}

/// Means of transients, of a start that counts, and of a swing that is too slow: each in a run of its own.
#[test]
fn means_that_are_not_those_of_a_steady_state_are_a_caution() {
    let growing = r#"[{ kind = "time-table", times = [0, 0.1], torques = [5e3, 1e5] }]"#;
    let growing = preset(
        "marine_two_sprockets",
        &[
            ("sprockets.camshaft.load", growing),
            ("route.pretension", "150 kN"),
        ],
    );
    let growing = verdict(&growing, &run(0.1, 100.0));
    let bare = preset("marine_engine_bare", &[]);
    let of = |until| {
        let run = Run {
            every: 2e-4,
            ..run(until, 100.0)
        };
        verdict(&bare, &run)
    };
    let [unknown, wide, known] = [0.02, 0.07, 1.0].map(of);
    tells_apart("not-steady", &growing, &wide);
    tells_apart("statistics-unknown", &unknown, &wide);
    tells_apart("means-uncertain", &wide, &known);
    assert!(unknown.note().contains("--until \"30 ms\""), "{unknown}");
}

/// Impacts counted without a log are those of the log.
#[test]
fn impacts_are_counted_as_they_are_logged() {
    let logged = Run {
        step: Some(2e-7),
        events: EventKinds {
            joints: true,
            ..EventKinds::default()
        },
        ..run(0.05, 100.0)
    };
    let (simulation, summary) = finished(&preset("pin_in_bush", &[]), &logged);
    let kinds = summary.contacts(&simulation);
    let events: u64 = kinds.iter().map(|kind| kind.count).sum();
    let struck = simulation.system().struck();
    let [BodyImpacts { impacts, floor, .. }] = struck.as_slice() else {
        panic!("{struck:?}");
    };
    assert!(
        events > 3 && impacts.count == events,
        "{events}, {impacts:?}"
    );
    // v = √(2 g · 2 c)
    assert!((impacts.fastest - 62.6e-3).abs() < 0.1e-3, "{impacts:?}");
    assert_eq!((impacts.gentle, *floor), (0, 1e-3));
    let report = page(&summary, &simulation);
    assert!(report.contains("0 % below 0.001 m/s"), "{report}");

    let gentle = preset("pin_in_bush", &[("contact.joints.onset_floor", "0.06 m/s")]);
    let (simulation, _) = finished(&gentle, &logged);
    let impacts = simulation.system().struck()[0].impacts;
    assert_eq!(impacts.gentle, impacts.count - 1, "{impacts:?}");
}

/// The cams of an engine take nearly as much as they give back, and its crank swings: the efficiency is that of the mean powers, by what goes in and
/// out but for what the stores keep, and the same wherever within a swing the record ends.
#[test]
fn an_efficiency_is_one_of_mean_powers() {
    let drive = preset("timing_drive", &[]).drive().unwrap();
    let mut simulation = Simulation::start(&drive, &run(0.107, 535.0)).unwrap();
    let mut summary = Summary::new(&simulation);
    let mut found = Vec::new();
    while simulation.next_sample().unwrap().is_some() {
        summary.push(simulation.observation());
        // Swings last 10 ms.
        if ![501, 516, 536].contains(&summary.samples) {
            continue;
        }
        let ledger = summary.ledger();
        let [efficiency, uncertain] = ledger.efficiency().unwrap();
        let stored = (ledger.supplied - ledger.delivered - ledger.losses).abs();
        let by_powers = ledger.delivered / ledger.supplied;
        assert!((efficiency - by_powers).abs() <= stored / ledger.supplied + 1e-12);
        found.push([efficiency, uncertain]);
    }
    assert_eq!(found.len(), 3);
    for [efficiency, uncertain] in &found {
        let apart = (efficiency - found[0][0]).abs();
        assert!(apart < uncertain + found[0][1], "{found:?}");
    }
    let told = format!("lost: {:.1} % ± ", 100.0 * found[2][0]);
    let page = page(&summary, &simulation);
    assert!(
        page.contains(&told) && page.contains("to and fro"),
        "{page}"
    );
}

/// Teeth, rail, arm and joints that rub: every place has its part, and together they are what is lost.
#[test]
fn losses_by_place_add_up() {
    let friction = "{ coefficient = 0.1 }";
    let load = r#"[{ kind = "constant", torque = "8 N m" }]"#;
    let scene = preset(
        "timing_drive",
        &[
            ("contact.teeth.friction", friction),
            ("contact.guides.friction", friction),
            // An even crank and even camshafts: little goes to and fro within 4 ms.
            (
                "sprockets.crank.motion",
                r#"{ kind = "constant", speed = "-3000 rpm" }"#,
            ),
            ("sprockets.exhaust.load", load),
            ("sprockets.intake.load", load),
        ],
    );
    let (simulation, summary) = finished(&scene, &run(4e-3, 100.0));
    let lost = summary.losses();
    let names: Vec<_> = lost.iter().map(|(place, _)| place.name()).collect();
    for place in ["joints", "teeth", "guides", "tensioners"] {
        assert!(names.contains(&place), "{names:?}");
    }
    let sum: f64 = lost.iter().map(|(_, lost)| lost).sum();
    let all = summary.energy_dissipated();
    assert!((sum - all).abs() < 1e-12 * all, "{sum} J of {all} J");
    let (mut by_place, mut whole) = (Vec::new(), Vec::new());
    let (sample, start) = (simulation.observation(), Energy::default());
    Channel::EnergyLosses.read(sample, &start, &mut by_place);
    Channel::EnergyDissipated.read(sample, &start, &mut whole);
    assert!((by_place.iter().sum::<f64>() - whole[0]).abs() < 1e-12 * whole[0]);
    let report = page(&summary, &simulation);
    assert!(
        report.contains("share") && report.contains("\n  guides "),
        "{report}"
    );
    let [efficiency, uncertain] = summary.ledger().efficiency().unwrap();
    assert!(
        efficiency < 1.0 && uncertain > 0.0,
        "{efficiency} ± {uncertain}"
    );
}
