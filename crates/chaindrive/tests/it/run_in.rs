//! Before t = 0: a run-in by time, by turns, and until the motion is steady.
#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use std::f64::consts::PI;

use chaindrive::{
    Assembled, Channel, Given, MOST_CIRCUITS, Memory, RanIn, Reason, Report, Request, Run, RunIn,
    Scene, Settings, Simulation, SimulationError, execute, run_in,
};

fn preset(name: &str, changes: &[(&str, &str)]) -> Scene {
    let scene = Scene::preset(name).unwrap();
    changes.iter().fold(scene, |scene, (path, value)| {
        scene.replace(path, value).unwrap()
    })
}

fn ran(scene: &Scene, settings: &[(&str, &str)]) -> (Report, Memory) {
    let settings = settings
        .iter()
        .fold(Settings::default(), |all, (key, text)| {
            let names = || text.split(',').map(str::to_owned).collect();
            let given = match *key {
                "record" => Given::Names(names()),
                _ => Given::Text((*text).to_owned()),
            };
            all.with(key, given)
        });
    let request = Request::new(scene, &settings).unwrap().without_estimate();
    let mut memory = Memory::default();
    let report = execute(&request, &mut memory, &|| false).unwrap();
    (report, memory)
}

/// Samples of a channel, in their order.
fn channel(memory: &Memory, channel: Channel) -> &[f64] {
    let mut columns = memory.recording.columns.iter();
    &columns.find(|it| it.channel == channel).unwrap().values
}

fn started(scene: &Scene, wanted: RunIn) -> Result<(Assembled, RanIn), SimulationError> {
    let start = scene.drive().unwrap().assemble().unwrap();
    let run = Run {
        run_in: wanted,
        ..Run::default()
    };
    run_in(start, &run, &|| false).map(|(start, ran_in)| (start, ran_in.unwrap()))
}

fn turns(turns: f64, sprocket: Option<&str>) -> RunIn {
    let sprocket = sprocket.map(str::to_owned);
    RunIn::Turns { turns, sprocket }
}

/// Only the clock is another: with the same steps a run-in and what follows are one run, to the rounding of its times.
#[test]
fn a_run_that_was_run_in_is_the_rest_of_a_longer_run() {
    let scene = preset("marine_two_sprockets", &[]);
    let with = |settings: &[(&str, &str)]| {
        let fixed = [
            ("method", "verlet"),
            ("step", "4 us"),
            ("every", "1 ms"),
            ("record", "span_tension"),
        ];
        ran(&scene, &[&fixed, settings].concat())
    };
    let (_, whole) = with(&[("until", "40 ms")]);
    let (report, rest) = with(&[("until", "20 ms"), ("run_in", "20 ms")]);
    let [whole, rest] = [&whole, &rest].map(|it| channel(it, Channel::SpanTension));
    let behind = &whole[whole.len() - rest.len()..];
    let scale = whole.iter().fold(0.0_f64, |most, t| most.max(t.abs()));
    let apart = behind.iter().zip(rest).map(|(a, b)| (a - b).abs());
    let apart = apart.fold(0.0, f64::max);
    assert!(apart < 1e-6 * scale, "{apart} N of {scale} N");
    assert_eq!(report.attributes["run_in"], 0.02);
    assert_eq!(report.attributes["samples"], 21);
    // The ledger is that of the record.
    let moved = report.summary.energy_moved();
    assert!(report.simulation.energy_residual().abs() < 1e-3 * moved);
}

/// t = n 2π/ω: 100 turns a minute of the crank, 150 of the camshaft with two thirds of its teeth.
#[test]
fn turns_are_those_of_the_sprocket() {
    let scene = preset("marine_two_sprockets", &[]);
    for (wanted, time) in [
        (turns(0.05, None), 0.03),
        (turns(0.05, Some("crank")), 0.03),
        (turns(0.05, Some("camshaft")), 0.02),
    ] {
        let (start, ran_in) = started(&scene, wanted).unwrap();
        assert!((ran_in.time - time).abs() < 1e-12, "{}", ran_in.time);
        assert!(start.time.abs() < f64::MIN_POSITIVE, "{}", start.time);
        assert_eq!(ran_in.is_steady, None);
    }
}

/// A centre that swings is where its motion has it: at t = 0 where it was drawn.
#[test]
fn what_moves_in_time_is_where_its_time_has_it() {
    let motion = |phase: &str| {
        let swings = format!(
            r#"{{ kind = "prescribed", x = {{ kind = "harmonics", terms = [{{ amplitude = "0.1 mm", frequency = "7 Hz", phase = "{phase}" }}] }} }}"#
        );
        preset(
            "marine_two_sprockets",
            &[("sprockets.crank.support", &swings)],
        )
    };
    for phase in ["0 rad", "1 rad"] {
        let scene = motion(phase);
        let (start, _) = started(&scene, RunIn::Time(0.033)).unwrap();
        let run = Run::default();
        let mut plain = Simulation::start(&scene.drive().unwrap(), &run).unwrap();
        let mut late = Simulation::from_assembled(start, &run).unwrap();
        for time in [0.0, 0.01, 0.02] {
            let [plain, late] = [&mut plain, &mut late].map(|it| {
                it.advance_to(time).unwrap();
                it.channel(Channel::SprocketX)[0]
            });
            assert!(
                (plain - late).abs() < 1e-15,
                "{phase}: {plain} m, {late} m at {time} s"
            );
        }
    }
}

/// A ramp of the speed begins when the record does, however long the drive was run in.
#[test]
fn a_ramp_begins_with_the_record() {
    let ramp = r#"{ kind = "ramp", from = "-100 rpm", to = "-120 rpm", start = "5 ms", duration = "10 ms" }"#;
    let scene = preset("marine_two_sprockets", &[("sprockets.crank.motion", ramp)]);
    let settings = [
        ("until", "20 ms"),
        ("every", "5 ms"),
        ("run_in", "30 ms"),
        ("record", "sprocket_speed"),
    ];
    let (_, memory) = ran(&scene, &settings);
    let crank: Vec<f64> = channel(&memory, Channel::SprocketSpeed)
        .iter()
        .step_by(2)
        .copied()
        .collect();
    let rpm = crank.iter().map(|speed| (speed * 30.0 / PI).round());
    assert_eq!(
        rpm.collect::<Vec<_>>(),
        [-100.0, -100.0, -110.0, -120.0, -120.0]
    );
}

/// A drive that rubs comes to rest in its tensions, and says when; one that nothing damps does not.
#[test]
fn a_run_in_ends_where_the_tensions_are_steady() {
    let settled = preset("marine_two_sprockets", &[("chain.type", "56B-1")]);
    let (report, _) = ran(&settled, &[("until", "0.5 s"), ("run_in", "auto")]);
    assert_eq!(report.attributes["run_in_steady"], 1, "{}", report.verdict);
    let names: Vec<_> = report.verdict.reasons.iter().map(Reason::name).collect();
    assert!(
        !names.contains(&"not-run-in") && !names.contains(&"start-counts"),
        "{names:?}"
    );
}

/// Under a load that grows all the time the tension never is steady.
#[test]
fn a_run_in_that_gives_up_says_so() {
    let growing = r#"[{ kind = "time-table", times = [-13, 0], torques = [1e4, 1.5e5] }]"#;
    let scene = preset(
        "marine_two_sprockets",
        &[
            ("sprockets.camshaft.load", growing),
            ("route.pretension", "200 kN"),
            ("sprockets.crank.motion.speed", "-300 rpm"),
        ],
    );
    let settings = [("until", "10 ms"), ("method", "verlet"), ("run_in", "auto")];
    let (report, _) = ran(&scene, &settings);
    assert_eq!(report.attributes["run_in_steady"], 0, "{}", report.verdict);
    let longest = f64::from(MOST_CIRCUITS) * report.simulation.assembled().slowest_circuit();
    let time = report.attributes["run_in"].as_f64().unwrap();
    assert!(
        (time / longest - 1.0).abs() < 0.01,
        "{time} s of {longest} s"
    );
    let reasons: Vec<_> = report.verdict.reasons.iter().map(Reason::name).collect();
    assert!(reasons.contains(&"not-run-in"), "{reasons:?}");
}

#[test]
fn what_cannot_be_run_in_is_refused() {
    let drive = preset("marine_two_sprockets", &[]);
    let strand = preset("hanging_chain", &[]);
    for (scene, wanted, message) in [
        (
            &drive,
            turns(1.0, Some("cam")),
            "`run_in`: turns of cam: there are crank, camshaft",
        ),
        (
            &strand,
            turns(1.0, None),
            "`run_in`: turns of a sprocket: the drive has none: give a time",
        ),
        (
            &strand,
            RunIn::Auto,
            "`run_in`: auto: no chain runs around sprockets here",
        ),
        (&drive, RunIn::Time(-1.0), "-1, must be"),
        (
            &drive,
            turns(f64::NAN, None),
            "NaN, must be a positive number of turns",
        ),
    ] {
        let error = started(scene, wanted).unwrap_err().to_string();
        assert!(error.contains(message), "{error}");
    }
    let wrong = Scene::preset("marine_two_sprockets").unwrap();
    let error = wrong
        .replace("run.run_in", "five turns")
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("run.run_in") && error.contains("no number of turns"),
        "{error}"
    );
}

/// What a result carries simulates it again, to the last bit.
#[test]
fn the_resolved_scene_is_run_in_alike() {
    let scene = preset("marine_two_sprockets", &[]);
    let (report, first) = ran(
        &scene,
        &[
            ("until", "5 ms"),
            ("run_in", "0.02 turns"),
            ("record", "span_tension"),
        ],
    );
    let resolved = report.attributes["resolved_scene"].as_str().unwrap();
    let again = Scene::from_toml(resolved, "resolved").unwrap();
    let (_, second) = ran(&again, &[("record", "span_tension")]);
    let [first, second] = [&first, &second].map(|it| {
        let values = channel(it, Channel::SpanTension).iter();
        values.map(|value| value.to_bits()).collect::<Vec<_>>()
    });
    assert_eq!(first, second);
}
