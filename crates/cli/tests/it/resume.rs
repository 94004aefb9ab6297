//! Runs that are killed, stopped and carried on are the runs that were not, to the last bit.
#![cfg(unix)]
#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use std::collections::HashSet;
use std::fs;
use std::path::Path;
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::command_line::{
    answer as run, attributes, chaindrive, ended, folder, group, signal, start, wait_for, words,
};
use crate::same_run::{files, timeless};
use crate::store_faults;
use crate::store_faults::{names, status};

/// A scene, how it is changed, and the simulated time between two checkpoints.
struct Case {
    name: &'static str,
    scene: &'static str,
    checkpoint_every: &'static str,
    /// Moments at which the long test kills it.
    kills: u32,
}

const fn case(
    name: &'static str,
    scene: &'static str,
    checkpoint_every: &'static str,
    kills: u32,
) -> Case {
    Case {
        name,
        scene,
        checkpoint_every,
        kills,
    }
}

/// Particles with guides and a tensioner, pins with play and without, bristles, and error control.
#[rustfmt::skip]
const CASES: [Case; 6] = [
    case("particles", "marine_engine --until 10ms --method verlet", "0.5 ms", 20),
    case("a hydraulic arm", "timing_drive --until 1ms --method dormand-prince", "25 us", 6),
    case("clearance joints", "bicycle --until 3ms --method implicit-damping", "0.2 ms", 20),
    case("ideal joints", "bicycle --set chain.model=ideal-joints --until 0.3ms --method auto", "20 us", 6),
    case("bristles", "bicycle --set 'contact.joints.friction={ kind = \"lugre\", static_coefficient = 0.15, coefficient = 0.1, \
                      slip_speed = 0.01, stiffness = 1e5 }' --until 3ms --method implicit-damping", "0.2 ms", 20),
    case("generalized alpha", "bicycle --until 1ms --method generalized-alpha", "20 us", 6),
];

impl Case {
    fn arguments(&self) -> Vec<&'static str> {
        let recorded = words("--every '10 us' --record all --events teeth,guides,joints");
        let of_bristles = self.name == "bristles";
        let run_in = ["--run-in", if of_bristles { "0.5 ms" } else { "0" }];
        let quiet = ["--no-error", "-q", "-o"];
        [&["run"], &words(self.scene)[..], &run_in, &recorded, &quiet].concat()
    }

    /// Whole and never stopped, without checkpoints; and how long it took.
    fn whole(&self, at: &Path) -> Duration {
        let begin = Instant::now();
        let (code, err) = run(at, &[&self.arguments()[..], &["whole.zarr"]].concat());
        assert_eq!(code, 0, "{}: {err}", self.name);
        begin.elapsed()
    }

    fn with_checkpoints(&self) -> Vec<&'static str> {
        let checkpoints = ["run.zarr", "--checkpoint-every", self.checkpoint_every];
        [&self.arguments()[..], &checkpoints].concat()
    }

    /// Runs again over what was killed before its first sample: there is nothing to go on from, and nothing in the way.
    fn begins_anew(&self, at: &Path) {
        let (code, err) = run(at, &self.with_checkpoints());
        assert_eq!(code, 0, "{}: {err}", self.name);
        self.holds(at);
    }

    /// Carries the run on until it is complete, and compares it with the one that was never stopped.
    fn holds(&self, at: &Path) {
        if status(&at.join("run.zarr")) != "complete" {
            let (code, err) = run(at, &["resume", "run.zarr", "-q"]);
            assert_eq!(code, 0, "{}: {err}", self.name);
        }
        let [whole, carried] = ["whole.zarr", "run.zarr"].map(|name| at.join(name));
        let stories = [&whole, &carried].map(|store| group(store).unwrap());
        let told = [&stories[0], &stories[1]].map(|story| timeless(&story["attributes"]));
        assert_eq!(told[0], told[1], "{}", self.name);
        let key = "consolidated_metadata";
        assert_eq!(stories[0][key], stories[1][key], "{}", self.name);
        let (whole, carried) = (files(&whole), files(&carried));
        let all: Vec<_> = whole.keys().collect();
        assert_eq!(all, carried.keys().collect::<Vec<_>>(), "{}", self.name);
        for (name, bytes) in &whole {
            assert!(carried[name] == *bytes, "{}: {name} differs", self.name);
        }
    }
}

/// The same moments whenever the test runs: Weyl's sequence, between 0 and 1.
fn moments(count: u32) -> impl Iterator<Item = f64> {
    let golden = 0.618_033_988_749_894_9;
    (1..=count).map(move |k| (f64::from(k) * golden).fract())
}

/// Kills a process some time after it was started, and after it has begun a result.
fn kill_after(at: &Path, arguments: &[&str], delay: Duration) {
    let mut child = start(at, arguments);
    sleep(delay);
    // It may be through.
    child.kill().ok();
    child.wait().unwrap();
}

/// Kills a process once its result is there and so many checkpoints of it were seen, each with a time of its own.
fn kill_at(at: &Path, arguments: &[&str], checkpoints: usize) {
    let mut child = start(at, arguments);
    let store = at.join("run.zarr");
    let mut seen = HashSet::new();
    wait_for("too few checkpoints", || {
        if let Ok(written) = fs::metadata(store.join("checkpoint")).and_then(|it| it.modified()) {
            seen.insert(written);
        }
        let through = child.try_wait().unwrap().is_some();
        assert!(!through, "it ended before it was killed");
        store.exists() && seen.len() >= checkpoints
    });
    child.kill().unwrap();
    child.wait().unwrap();
}

/// Killed when its result was begun, after its first checkpoint, and after a later one from which it goes on to be killed again: particles in
/// all states, links with play in the last. What a checkpoint holds of other chains is held by the snapshots of the library. It takes its time
/// for ten processes that store all channels.
#[test]
fn killed_in_any_state_a_run_goes_on_as_if_nothing_had_happened() {
    for (case, states) in [(&CASES[0], &[0, 1, 4][..]), (&CASES[2], &[4])] {
        let folder = folder();
        let at = folder.path();
        case.whole(at);
        let store = at.join("run.zarr");
        for &checkpoints in states {
            kill_at(at, &case.with_checkpoints(), checkpoints);
            if checkpoints > 1 {
                kill_at(at, &["resume", "run.zarr", "-q"], checkpoints);
            }
            if store.join("checkpoint").exists() {
                case.holds(at);
            } else {
                assert_eq!(checkpoints, 0, "{}", case.name);
                case.begins_anew(at);
            }
            fs::remove_dir_all(&store).unwrap();
        }
        assert_eq!(names(at), ["whole.zarr"], "{}", case.name);
    }
}

/// Killed at moments from the first milliseconds to the end, every third time once more while it goes on.
#[test]
#[ignore = "a study: every kind of run, killed at many moments"]
fn killed_at_any_moment_a_run_goes_on_as_if_nothing_had_happened() {
    let (mut carried, mut anew) = (0, 0);
    for case in CASES {
        let folder = folder();
        let at = folder.path();
        let takes = case.whole(at);
        for (k, moment) in moments(case.kills).enumerate() {
            kill_after(at, &case.with_checkpoints(), takes.mul_f64(moment));
            let store = at.join("run.zarr");
            if k % 3 == 0 && store.join("checkpoint").exists() {
                kill_after(
                    at,
                    &["resume", "run.zarr", "-q"],
                    takes.mul_f64(0.3 * moment),
                );
            }
            if store.join("checkpoint").exists() {
                carried += 1;
                case.holds(at);
            } else {
                anew += 1;
                case.begins_anew(at);
            }
            fs::remove_dir_all(store).unwrap();
        }
        assert_eq!(names(at), ["whole.zarr"], "{}", case.name);
    }
    assert!(carried > 0, "{anew} were killed before their first sample");
}

/// A checkpoint with every sample: most of the time one is being written.
#[test]
#[ignore = "a study: a checkpoint with every sample"]
fn killed_while_a_checkpoint_is_written_the_one_before_holds() {
    let scene = "marine_engine --until 3ms --method verlet";
    let case = case("a checkpoint with every sample", scene, "10 us", 10);
    let folder = folder();
    let at = folder.path();
    case.whole(at);
    let begin = Instant::now();
    assert_eq!(run(at, &case.with_checkpoints()).0, 0);
    let takes = begin.elapsed();
    case.holds(at);
    let store = at.join("run.zarr");
    fs::remove_dir_all(&store).unwrap();
    let mut carried = 0;
    for moment in moments(case.kills) {
        kill_after(at, &case.with_checkpoints(), takes.mul_f64(moment));
        if store.join("checkpoint").exists() {
            carried += u32::from(status(&store) == "running");
            case.holds(at);
        }
        fs::remove_dir_all(&store).ok();
    }
    assert!(carried > 4, "{carried}");
}

#[test]
fn stopped_by_a_signal_it_goes_on_and_leaves_no_checkpoint_behind() {
    for name in ["-INT", "-TERM"] {
        let case = &CASES[2];
        let folder = folder();
        let at = folder.path();
        let store = at.join("run.zarr");
        case.whole(at);
        let to = [&case.arguments()[..], &["run.zarr"]].concat();
        let child = start(at, &to);
        wait_for("nothing was begun", || store.exists());
        signal(&child, name);
        assert_eq!(ended(child).0, 130);
        assert_eq!(status(&store), "interrupted");
        case.holds(at);
        assert!(!store.join("checkpoint").exists());
    }
}

/// The estimate goes on with short runs of the choice, which a process that was killed took with it.
#[test]
fn carried_on_it_tells_of_its_choice_and_error_what_it_would_have_told() {
    let folder = folder();
    let at = folder.path();
    let run_to = |store, more: &[&'static str]| {
        let plain = words("run marine_two_sprockets --until 0.1s -q --every 20us -o");
        [&plain[..], &[store], more].concat()
    };
    let (code, err) = run(at, &run_to("whole.zarr", &[]));
    assert_eq!(code, 0, "{err}");
    let mut child = start(at, &run_to("run.zarr", &["--checkpoint-every", "1 ms"]));
    let store = at.join("run.zarr");
    wait_for("there is no checkpoint", || {
        store.join("checkpoint").exists() && status(&store) == "running"
    });
    child.kill().unwrap();
    child.wait().unwrap();
    assert_eq!(status(&store), "running");
    let (code, err) = run(at, &["resume", "run.zarr", "-q"]);
    assert_eq!(code, 0, "{err}");
    let told = ["whole.zarr", "run.zarr"].map(|name| timeless(&attributes(&at.join(name))));
    assert_eq!(told[0], told[1]);
    for (name, least) in [("accuracy_evaluations", 1e3), ("error_evaluations", 1e3)] {
        assert!(told[0][name].as_f64().unwrap() > least, "{name}");
    }
}

/// To a later end, and once more after a kill on the way there.
#[test]
fn a_complete_run_goes_on_to_a_later_end() {
    let folder = folder();
    let at = folder.path();
    let short =
        "run marine_two_sprockets --method verlet --every 40us --run-in 0 --no-error -q --until";
    for rest in [
        "80ms -o whole.zarr",
        "1ms -o run.zarr --checkpoint-every 1ms",
    ] {
        assert_eq!(run(at, &words(&format!("{short} {rest}"))).0, 0);
    }
    let on = ["resume", "run.zarr", "-q", "--until", "80 ms"];
    let store = at.join("run.zarr");
    let child = start(at, &on);
    wait_for("it does not go on", || status(&store) == "running");
    signal(&child, "-KILL");
    child.wait_with_output().unwrap();
    let (code, err) = run(at, &["resume", "run.zarr", "-q"]);
    assert_eq!((code, err.as_str()), (0, ""));
    let [whole, carried] = ["whole.zarr", "run.zarr"].map(|name| files(&at.join(name)));
    assert!(whole == carried);
    let (code, err) = run(at, &["resume", "run.zarr", "--until", "70 ms"]);
    assert_eq!(code, 2);
    assert!(err.contains("until = 0.07 s is past"), "{err}");
}

#[test]
fn what_cannot_go_on_is_refused() {
    let folder = folder();
    let at = folder.path();
    let store = at.join("run.zarr");
    let plain = ["run", "spinning_ring", "--no-error", "-q", "-o", "run.zarr"];
    let refused = |code: i32, said: &str| {
        let (found, err) = run(at, &["resume", "run.zarr"]);
        assert_eq!(found, code, "{err}");
        assert!(
            err.starts_with("run.zarr: ") && err.contains(said),
            "{said}: {err}"
        );
    };
    refused(2, "nothing of this name");
    fs::create_dir(&store).unwrap();
    refused(3, "not a result of chaindrive");
    fs::remove_dir(&store).unwrap();

    let (code, err) = run(at, &[&plain[..], &["--until", "2 ms"]].concat());
    assert_eq!((code, err.as_str()), (0, ""));
    refused(
        2,
        "the run is complete, and was not asked to keep checkpoints",
    );

    let often = words("--overwrite --until '2 ms' --checkpoint-every '1 ms'");
    assert_eq!(run(at, &[&plain[..], &often].concat()).0, 0);
    refused(2, "the run is complete, up to 0.002 s");

    // Damaged, cut off, of another version, of another scene, of something else.
    let document = fs::read_to_string(store.join("zarr.json")).unwrap();
    fs::write(
        store.join("zarr.json"),
        document.replace("\"complete\"", "\"running\""),
    )
    .unwrap();
    let file = store.join("checkpoint");
    let whole = fs::read(&file).unwrap();
    let mut damaged = whole.clone();
    *damaged.last_mut().unwrap() ^= 1;
    let line = whole.iter().position(|byte| *byte == b'\n').unwrap();
    let heading = String::from_utf8(whole[..line].to_vec()).unwrap();
    let other = heading.replace("build ", "build 9");
    let other = [other.as_bytes(), &whole[line..]].concat();
    for (bytes, said) in [
        (damaged.as_slice(), "the checkpoint is damaged"),
        (&whole[..whole.len() / 2], "the checkpoint is damaged"),
        (&other, "is of chaindrive 90."),
        (b"nothing", "this is no checkpoint of chaindrive"),
        (b"", "this is no checkpoint of chaindrive"),
    ] {
        fs::write(&file, bytes).unwrap();
        refused(2, said);
    }
    fs::write(&file, &whole).unwrap();
    let scene = document.replace("\"complete\"", "\"running\"");
    let scene = scene.replace("pitch = ", "pitch  = ");
    let kept = fs::read(store.join("zarr.json")).unwrap();
    fs::write(store.join("zarr.json"), scene).unwrap();
    refused(2, "of another scene");
    fs::write(store.join("zarr.json"), kept).unwrap();
    assert_eq!(run(at, &["resume", "run.zarr", "-q"]).0, 0);

    // While somebody writes there.
    let long = words("--overwrite --until 1e4 --checkpoint-every '1 ms'");
    let child = start(at, &[&plain[..], &long].concat());
    wait_for("nothing was begun", || status(&store) == "running");
    refused(3, "is writing a result here");
    signal(&child, "-KILL");
    child.wait_with_output().unwrap();

    // A run that has failed would fail again.
    let load = "sprockets.camshaft.load=[{ kind = 'constant', torque = '1e200 N m' }]";
    let hopeless = words("run marine_two_sprockets --until 1ms --set settle=false --set");
    let to = words("-q -o run.zarr --overwrite --checkpoint-every '10 us'");
    assert_eq!(run(at, &[&hopeless[..], &[load], &to].concat()).0, 1);
    refused(2, "the run failed, and was left without one: at t = ");
}

#[test]
fn places_that_cannot_be_carried_on_are_refused() {
    let folder = folder();
    let at = folder.path();
    for (more, said) in [
        (
            "1ms -o run.csv",
            "run.csv: a table cannot be carried on; give a Zarr store",
        ),
        ("1ms", "nothing is written; give a Zarr store"),
        ("'1 mm' -o run.zarr", "checkpoint_every: `1 mm` is a length"),
        ("0 -o run.zarr", "checkpoint_every = 0, must be positive"),
    ] {
        let every = format!("run spinning_ring --until 1ms --checkpoint-every {more}");
        let (code, err) = run(at, &words(&every));
        assert_eq!(code, 2, "{err}");
        assert!(err.contains(said), "{err}");
    }
    assert!(names(at).is_empty());
}

/// The limit on the size of files refuses a chunk after some checkpoints: the run says why it stopped, and goes on where
/// there is space.
#[cfg(target_os = "linux")]
#[test]
fn on_a_full_disk_the_last_checkpoint_holds() {
    let case = &CASES[0];
    let folder = folder();
    let at = folder.path();
    let whole = [&case.arguments()[..], &["whole.zarr"]].concat();
    assert_eq!(run(at, &whole).0, 0);
    let (code, err) = store_faults::on_a_full_disk(400 << 10, at, &case.with_checkpoints());
    assert_eq!(code, 3, "{err}");
    let store = at.join("run.zarr");
    assert_eq!(status(&store), "failed");
    let failure = attributes(&store)["failure"].clone();
    assert!(
        failure.as_str().unwrap().contains("File too large"),
        "{failure}"
    );
    let left: Vec<_> = names(&store);
    assert!(left.iter().all(|name| !name.contains('#')), "{left:?}");
    case.holds(at);
    assert_eq!(names(at), ["run.zarr", "whole.zarr"]);
}

/// Every verb lets go of a pipe that nobody writes into, and of standard input that never ends.
#[cfg(target_os = "linux")]
#[test]
fn waiting_for_a_scene_it_hears_the_signal() {
    let folder = folder();
    let at = folder.path();
    let made = std::process::Command::new("mkfifo")
        .arg(at.join("pipe.toml"))
        .status();
    assert!(made.unwrap().success());
    for verb in [
        &["run"][..],
        &["check"],
        &["describe"],
        &["resolve"],
        &["bench"],
        &["sweep", "--vary", "chain.mass=8 g,9 g"],
        &["diff", "spinning_ring"],
    ] {
        for scene in ["pipe.toml", "-"] {
            let mut command = chaindrive(at, &[verb, &[scene]].concat());
            let child = command.stdin(std::process::Stdio::piped()).spawn().unwrap();
            stops(child, &format!("{verb:?} {scene}"));
        }
    }
}

/// Thousands of links whose pins have play settle for a long time.
#[cfg(target_os = "linux")]
#[test]
fn settling_it_hears_the_signal() {
    let folder = folder();
    let at = folder.path();
    let centre = "sprockets.rear.centre=['-25.200144624366 m', '0 m']";
    let scene = ["bicycle", "--set", "chain.links=4000", "--set", centre];
    for verb in [
        &["run"][..],
        &["describe"],
        &["bench"],
        &["sweep", "--vary", "gravity=[0, 0],[0, -9.81]"],
    ] {
        stops(start(at, &[verb, &scene].concat()), &format!("{verb:?}"));
    }
}

/// Waits until a process listens, lets it begin, and sees that it stops when it is told to.
#[cfg(target_os = "linux")]
fn stops(mut child: std::process::Child, what: &str) {
    let listens = || {
        let path = format!("/proc/{}/status", child.id());
        let status = fs::read_to_string(path).unwrap_or_default();
        let caught = status.lines().find_map(|line| line.strip_prefix("SigCgt:"));
        let mask = caught.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
        mask.is_some_and(|mask| mask >> 1 & 1 == 1)
    };
    wait_for(what, listens);
    sleep(Duration::from_millis(200));
    assert!(child.try_wait().unwrap().is_none(), "{what} is through");
    signal(&child, "-INT");
    // With its input still open.
    let input = child.stdin.take();
    wait_for(&format!("{what} does not stop"), || {
        child.try_wait().unwrap().is_some()
    });
    drop(input);
    assert_eq!(child.wait().unwrap().code(), Some(130), "{what}");
}
