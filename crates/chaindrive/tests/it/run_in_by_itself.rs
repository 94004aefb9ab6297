//! Run-ins that end by themselves: where the motion is steady.

use std::cell::Cell;

use chaindrive::record::{Existing, StoppedRun, ZarrSink};
use chaindrive::{
    Channel, MOST_CIRCUITS, Memory, Onlooker, Reason, Report, Request, RunError, SettingValue,
    Settings, Simulation, execute,
};

use crate::judged::preset;
use crate::run_in::{channel, ran};
use crate::two_sprockets::{SOFT, TwoSprockets};

/// A drive that rubs comes to rest in its tensions, and says when; one that nothing damps does not.
#[test]
fn a_run_in_ends_where_the_tensions_are_steady() {
    let (report, _) = ran(&SOFT.scene(), &[("until", "0.5 s"), ("run_in", "auto")]);
    assert_eq!(report.attributes["run_in_steady"], 1, "{}", report.verdict);
    let names: Vec<_> = report.verdict.reasons.iter().map(Reason::name).collect();
    assert!(
        !names.contains(&"not-run-in") && !names.contains(&"start-counts"),
        "{names:?}"
    );
}

/// A load that repeats every fifty turns only: the longest run-in that is tried does not see three periods.
#[test]
fn a_run_in_that_gives_up_says_so() {
    let slow = r#"[{ kind = "harmonic", amplitude = "1 kN m", order = 0.02 }, { kind = "constant", torque = "10 kN m" }]"#;
    let scene = preset(
        "marine_two_sprockets",
        &[
            ("sprockets.camshaft.load", slow),
            ("sprockets.crank.motion.speed", "-300 rpm"),
        ],
    );
    let settings = [("until", "10 ms"), ("method", "verlet"), ("run_in", "auto")];
    let (report, _) = ran(&scene, &settings);
    assert_eq!(report.attributes["run_in_steady"], 0, "{}", report.verdict);
    let longest = f64::from(MOST_CIRCUITS) * report.simulation.assembled().slowest_circuit();
    // Another fifty turns would be longer than that.
    let time = report.attributes["run_in"].as_f64().unwrap();
    let period = report.summary.slowest_forcing();
    assert!(
        time + 0.01 <= longest && longest < time + 0.01 + period,
        "{time} s of {longest} s"
    );
    let reasons: Vec<_> = report.verdict.reasons.iter().map(Reason::name).collect();
    assert!(reasons.contains(&"not-run-in"), "{reasons:?}");
}

/// A run-in that ends by itself is the one of that time: its record goes on from the state that was found steady, on a clock that begins there.
#[test]
fn a_run_in_by_itself_is_that_of_its_time() {
    let scene = SOFT.scene();
    let with = |run_in: &str| {
        let settings = [
            ("method", "verlet"),
            ("step", "20 us"),
            ("until", "20 ms"),
            ("every", "1 ms"),
            ("run_in", run_in),
            ("record", "span_tension,sprocket_angle"),
        ];
        ran(&scene, &settings)
    };
    let (found, by_itself) = with("auto");
    let time = found.attributes["run_in"].as_f64().unwrap();
    assert!(time > 0.0, "{time} s");
    let (_, given) = with(&format!("{time} s"));
    for name in [Channel::SpanTension, Channel::SprocketAngle] {
        let [by_itself, given] = [&by_itself, &given].map(|it| channel(it, name));
        let scale = given.iter().fold(0.0_f64, |most, t| most.max(t.abs()));
        let apart = by_itself.iter().zip(given).map(|(a, b)| (a - b).abs());
        let apart = apart.fold(0.0, f64::max);
        assert!(apart < 1e-6 * scale, "{name:?}: {apart} of {scale}");
    }
}

/// No time is simulated twice: what was examined is the record, as far as that reaches. Its samples are those that a simulation takes that goes on from the
/// first of them by itself.
#[test]
fn what_a_run_in_examined_becomes_the_record() {
    let scene = SOFT.scene();
    for [until, kept] in [[2.0, 1.0], [0.5, 1.0], [2e-3, 0.0]] {
        let settings = Settings::default()
            .with("until", SettingValue::Number(until))
            .with("every", SettingValue::Number(1e-3))
            .with("method", SettingValue::Text("verlet".to_owned()))
            .with("run_in", SettingValue::Text("auto".to_owned()));
        let request = Request::new(&scene, &settings).unwrap().without_estimate();
        let mut memory = Memory::default();
        let report = execute(&request, &mut memory, &|| false).unwrap();
        let found = report.ran_in.unwrap();
        assert_eq!(found.is_steady, Some(true));
        let statistics = report.simulation.statistics();
        let simulated = statistics.steps as f64 * statistics.largest_step;
        assert!(
            simulated < found.time + until + 2.0 * statistics.largest_step,
            "{simulated} s for {found:?} and {until} s"
        );

        let mut alone =
            Simulation::from_assembled(report.simulation.assembled().clone(), &report.run).unwrap();
        let tensions = channel(&memory, Channel::SpanTension);
        for (number, told) in tensions.chunks(2).enumerate().take(10) {
            let Some(sample) = alone.next_sample().unwrap() else {
                break;
            };
            assert!((sample.time - number as f64 * 1e-3).abs() < 1e-15);
            // A method that begins anew sees no step before: what that makes of the state grows from roller to roller.
            let near = if number < 2 { 1e-6 } else { 1e-3 };
            for (alone, told) in sample.span_tension.iter().zip(told) {
                assert!(
                    (alone - told).abs() < near * told.abs(),
                    "{until}: {number}"
                );
            }
        }
        let impacts: u64 = report.summary.impacts().iter().map(|it| it.count).sum();
        assert!(kept == 0.0 || impacts > 10, "{impacts}");
        let moved = report.summary.energy_moved();
        assert!(report.simulation.energy_residual().abs() < 1e-3 * moved);
    }
}

/// Stopped in the run-in, before the samples that it took are handed out, or in the record, and carried on: the same bits.
#[test]
fn a_run_in_by_itself_is_carried_on_to_the_same_bits() {
    let settings = Settings::default()
        .with("until", SettingValue::Number(0.5))
        .with("every", SettingValue::Number(5e-3))
        .with("events", SettingValue::Names(vec!["teeth".to_owned()]))
        .with("accuracy", SettingValue::Number(0.02));
    let request = Request::new(&SOFT.scene(), &settings).unwrap();
    let request = request
        .with_checkpoints(&SettingValue::Number(0.05))
        .unwrap();
    let mut whole = Memory::default();
    let report = execute(&request, &mut whole, &|| false).unwrap();
    for stopped_in in [
        StoppedIn::RunIn,
        StoppedIn::Record(3),
        StoppedIn::Record(90),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("run.zarr");
        let mut store = ZarrSink::new(path.clone(), Existing::Keep);
        let seen = Stopping(stopped_in, Cell::new(0));
        let ended = execute(&request, &mut store, &seen);
        let is_in_run_in = matches!(ended, Err(RunError::Interrupted));
        assert_eq!(is_in_run_in, stopped_in == StoppedIn::RunIn);
        let stopped = StoppedRun::open(&path, None).unwrap();
        let resumed = stopped.resume(&|| false).unwrap();
        let last = |report: &Report| report.simulation.observation().link_tension.clone();
        assert_eq!(last(&resumed), last(&report), "{stopped_in:?}");
        let told = |report: &Report| {
            let names = [
                "run_in",
                "samples",
                "impact_count_driver",
                "error_span_tension",
                "verdict_note",
                "error_evaluations",
            ];
            let attributes = names.map(|it| report.attributes[it].clone());
            (attributes, report.summary.spans.clone())
        };
        assert_eq!(told(&resumed), told(&report), "{stopped_in:?}");
        let sentences = [&resumed, &report].map(|it| it.ran_in.as_ref().unwrap().to_string());
        assert_eq!(sentences[0], sentences[1]);
        assert!(sentences[0].ends_with("--run-in 0 leaves it out."));
    }
}

/// Stops a run in its run-in, or after so many samples.
struct Stopping(StoppedIn, Cell<u64>);

#[derive(Clone, Copy, Debug, PartialEq)]
enum StoppedIn {
    RunIn,
    Record(u64),
}

impl Onlooker for Stopping {
    fn stop(&self) -> bool {
        match self.0 {
            StoppedIn::RunIn => self.1.get() == u64::MAX,
            StoppedIn::Record(samples) => self.1.get() > samples,
        }
    }

    fn see(&self, _: &Simulation) {
        self.1.set(self.1.get() + 1);
    }

    fn see_run_in(&self, share: f64) {
        if self.0 == StoppedIn::RunIn && share > 0.005 {
            self.1.set(u64::MAX);
        }
    }
}

/// Open chains, starts from rest and functions of time are not run in unless somebody asks; the result says why.
#[test]
fn only_what_repeats_is_run_in_by_itself() {
    let ramp = r#"{ kind = "ramp", from = "-100 rpm", to = "-120 rpm", start = "5 ms", duration = "10 ms" }"#;
    let swings = r#"{ kind = "prescribed", x = { kind = "harmonics", terms = [{ amplitude = "0.1 mm", frequency = "7 Hz" }] } }"#;
    let pushed = r#"[{ kind = "constant", torque = "1 kN m" }]"#;
    let two = "marine_two_sprockets";
    for (name, changes, why) in [
        ("hanging_chain", vec![], "a chain has ends"),
        (
            "spinning_ring",
            vec![],
            "where torques do, take --run-in auto",
        ),
        (
            two,
            vec![("sprockets.crank.motion", ramp)],
            "a speed that changes at a time",
        ),
        (
            two,
            vec![("sprockets.crank.support", swings)],
            "a motion by frequencies",
        ),
        (two, vec![("run.run_in", "0 s")], ""),
    ] {
        let (report, _) = ran(
            &preset(name, &changes),
            &[("until", "1 ms"), ("method", "verlet")],
        );
        let told = report.ran_in.map(|it| it.to_string()).unwrap_or_default();
        assert!(
            told.trim_end_matches('.').ends_with(why) && told.is_empty() == why.is_empty(),
            "{name}: {told}"
        );
    }
    let free = preset(
        two,
        &[("sprockets.crank.load", pushed), ("settle", "false")],
    );
    let free = free.without("sprockets.crank.motion").unwrap();
    let free = free
        .replace("sprockets.crank.inertia", "10 kg m^2")
        .unwrap();
    let (report, _) = ran(&free, &[("until", "1 ms"), ("method", "verlet")]);
    let told = report.ran_in.unwrap().to_string();
    assert!(
        told.ends_with("where torques do, take --run-in auto."),
        "{told}"
    );
}

/// Where the tensions creep with a plunger, the run-in lasts until they do no more; its steady mean, from four seconds on, is 659.8 to 660.7 N
/// for other beginnings (`route.phase` 0 to 0.71).
// Costs: tensions creep for more than a second of the timing drive.
#[test]
fn a_run_in_waits_for_a_plunger_that_creeps() {
    let (report, _) = ran(
        &preset("timing_drive", &[]),
        &[("run_in", "auto"), ("method", "verlet")],
    );
    assert_eq!(report.attributes["run_in_steady"], 1, "{}", report.verdict);
    let known = report.summary.steadiness()[0].unwrap();
    let apart = (known.mean.value - 660.3).abs();
    assert!(
        apart < known.mean.half_width + 0.5 && apart < 0.005 * 660.0,
        "{known:?}"
    );
    let names: Vec<_> = report.verdict.reasons.iter().map(Reason::name).collect();
    assert_eq!(names, ["not-estimated"], "{}", report.verdict);
}

/// From rest, where 20 N m on one sprocket run into 0.4 N m s ω of the other: ω = 50 rad/s, less what joints and drag take.
#[test]
fn a_drive_from_rest_runs_up_before_it_is_run_in() {
    let free = TwoSprockets {
        before: "settle = false",
        driver: "inertia = 0.05\nload = [{ kind = \"constant\", torque = 20 }]",
        driven: "load = [{ kind = \"resistance\", linear = 0.4 }]",
        ..SOFT
    };
    let settings = [
        ("until", "0.5 s"),
        ("method", "verlet"),
        ("run_in", "auto"),
        ("record", "sprocket_speed"),
    ];
    let (report, memory) = ran(&free.scene(), &settings);
    assert_eq!(report.attributes["run_in_steady"], 1, "{}", report.verdict);
    let speeds = channel(&memory, Channel::SprocketSpeed);
    let driven = speeds[1..].iter().step_by(2);
    let found = driven.sum::<f64>() / (speeds.len() / 2) as f64;
    assert!((45.0..50.0).contains(&found), "{found} rad/s");
    let drift = speeds[speeds.len() - 1] / speeds[1] - 1.0;
    assert!(drift.abs() < 0.02, "{drift}");
}
