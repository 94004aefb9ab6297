//! Before t = 0: a run-in by time and by turns.
#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use std::cell::RefCell;
use std::f64::consts::PI;

use chaindrive::record::{Existing, StoppedRun, ZarrSink};
use chaindrive::{
    Assembled, Channel, Description, Memory, Onlooker, Report, Request, Run, RunError, RunIn,
    RunInReport, Scene, SettingValue, Settings, Simulation, SimulationError, execute, run_in,
};

use crate::judged::preset;

pub(crate) fn ran(scene: &Scene, settings: &[(&str, &str)]) -> (Report, Memory) {
    let settings = settings
        .iter()
        .fold(Settings::default(), |all, (key, text)| {
            let names = || text.split(',').map(str::to_owned).collect();
            let given = match *key {
                "record" => SettingValue::Names(names()),
                _ => SettingValue::Text((*text).to_owned()),
            };
            all.with(key, given)
        });
    let request = Request::new(scene, &settings).unwrap().without_estimate();
    let mut memory = Memory::default();
    let report = execute(&request, &mut memory, &|| false).unwrap();
    (report, memory)
}

/// Samples of a channel, in their order.
pub(crate) fn channel(memory: &Memory, channel: Channel) -> &[f64] {
    let mut columns = memory.recording.columns.iter();
    &columns.find(|it| it.channel == channel).unwrap().values
}

fn started(scene: &Scene, wanted: RunIn) -> Result<(Assembled, RunInReport), SimulationError> {
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
    let (_, whole) = with(&[("until", "40 ms"), ("run_in", "0 s")]);
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

#[test]
fn what_cannot_be_run_in_is_refused() {
    let drive = preset("marine_two_sprockets", &[]);
    let strand = preset("hanging_chain", &[]);
    let ramp = r#"{ kind = "ramp", from = "-100 rpm", to = "-120 rpm", start = "5 ms", duration = "10 ms" }"#;
    let ramp = preset("marine_two_sprockets", &[("sprockets.crank.motion", ramp)]);
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
        (
            &ramp,
            RunIn::Auto,
            "auto: there is a speed that changes at a time, whose times are those of the record: give a time",
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

/// The scene of a result simulates it again, to the last bit.
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

/// Sees how far the run-in is, and stops the run when it has heard of it so often.
#[derive(Default)]
struct Watching {
    seen: RefCell<Vec<f64>>,
    patience: Option<usize>,
}

impl Onlooker for Watching {
    fn stop(&self) -> bool {
        self.patience
            .is_some_and(|patience| self.seen.borrow().len() >= patience)
    }

    fn see_run_in(&self, share: f64) {
        self.seen.borrow_mut().push(share);
    }
}

/// Defect 10: whoever carried a run on waited for its run-in again.
#[test]
fn a_run_that_is_carried_on_is_not_run_in_again() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.zarr");
    let scene = preset("marine_two_sprockets", &[]);
    let wanted = |until: f64| {
        Settings::default()
            .with("until", SettingValue::Number(until))
            .with("every", SettingValue::Number(1e-3))
            .with("method", SettingValue::Text("verlet".to_owned()))
            .with("run_in", SettingValue::Number(0.02))
    };
    let request = |until| Request::new(&scene, &wanted(until)).unwrap();
    let every = SettingValue::Number(5e-3);
    let first = request(0.01).with_checkpoints(&every).unwrap();
    let watching = Watching::default();
    let mut store = ZarrSink::new(path.clone(), Existing::Keep);
    execute(&first, &mut store, &watching).unwrap();
    let seen = watching.seen.take();
    assert!(seen.iter().all(|share| (0.0..=1.0).contains(share)) && !seen.is_empty());

    let stopped = StoppedRun::open(&path, Some(&SettingValue::Number(0.02))).unwrap();
    let resumed = stopped.resume(&watching).unwrap();
    assert!(watching.seen.borrow().is_empty(), "run in again");
    let whole = execute(&request(0.02), &mut Memory::default(), &|| false).unwrap();
    let last = |report: &Report| report.simulation.observation().link_tension.clone();
    assert_eq!(last(&resumed), last(&whole));
    // The estimate begins where the record does, too.
    for name in ["run_in", "error_span_tension", "verdict_note"] {
        assert_eq!(resumed.attributes[name], whole.attributes[name], "{name}");
    }
    let summary = resumed.attributes["summary"].as_str().unwrap();
    assert!(
        summary.contains("The drive was run in for 20 ms before t = 0"),
        "{summary}"
    );
}

/// Both while a run-in looks for its end and while it is carried out.
#[test]
fn a_run_in_can_be_stopped() {
    for wanted in ["auto", "1000 s"] {
        let settings = Settings::default().with("run_in", SettingValue::Text(wanted.to_owned()));
        let scene = preset("marine_two_sprockets", &[]);
        let request = Request::new(&scene, &settings).unwrap().with_default_step();
        let watching = Watching {
            patience: Some(2),
            ..Watching::default()
        };
        let stopped = execute(&request, &mut Memory::default(), &watching);
        assert!(matches!(stopped, Err(RunError::Interrupted)), "{wanted}");
    }
}

/// The criterion stands with the time, and how it ended.
#[test]
fn the_summary_tells_of_the_run_in() {
    let told = |is_steady| {
        RunInReport {
            time: 0.5,
            is_steady,
            by_default: false,
            left_out: None,
        }
        .to_string()
    };
    assert!(told(None).ends_with("before t = 0, as asked."));
    assert!(told(Some(true)).ends_with("until the tension of every span was steady."));
    assert!(told(Some(false)).contains("not every span was steady"));
}

/// A run-in of 1e9 s would never end: what it costs stands in the description.
#[test]
fn what_a_run_in_costs_is_described() {
    let drive = preset("marine_two_sprockets", &[]).drive().unwrap();
    let described = |run_in: RunIn| {
        let run = Run {
            run_in,
            ..Run::default()
        };
        Description::of(&drive, &run).unwrap()
    };
    let endless = described(RunIn::Time(1e9));
    assert!(endless.cost.run_in_time > 1e6, "{:?}", endless.cost);
    assert!(
        endless
            .to_string()
            .contains("run-in                 1000000000 s before the record")
    );
    // What was asked for is neither less nor more.
    assert_eq!(
        endless.cost.run_in.to_bits(),
        endless.cost.run_in_least.to_bits()
    );
    // 112 links at 100 teeth a second, 32 circuits.
    let by_itself = described(RunIn::Auto);
    let most = by_itself.cost.run_in;
    assert!((most / (32.0 * 1.12) - 1.0).abs() < 1e-9, "{most}");
    // A record of 1 s that is steady from the start: 40 blocks of two and a half teeth, after the quarter that is not tried.
    let least = by_itself.cost.run_in_least;
    assert!((1.3..1.4).contains(&least), "{least}");
    let told = by_itself.to_string();
    assert!(
        told.contains("until the tensions are steady: 1.3"),
        "{told}"
    );
    assert!(told.contains("s simulated at least, about"), "{told}");
    assert!(told.contains("given up after 35.84 s"), "{told}");
    assert!(described(RunIn::None).cost.run_in.abs() < f64::MIN_POSITIVE);
}
