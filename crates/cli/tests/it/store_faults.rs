//! Whatever befalls a run, what is on disk says truly what it is.
#![cfg(unix)]
#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use crate::command_line::{
    answer as run, chaindrive, ended, folder, group, samples, signal, start, wait_for, words,
};

const SHORT: &str = "run spinning_ring --until '5 ms' --no-error -q";
/// A run that would take minutes, less than what is foretold.
const LONG: &str = "run spinning_ring --until 2e3 --every '1 ms' --no-error -q";

/// Removes a folder into which another process writes: a file that it puts where the last one was
/// just taken away makes the removal fail, and it is asked for again.
fn remove_under_way(folder: &Path) {
    wait_for("the folder was never removed", || {
        matches!(
            fs::remove_dir_all(folder).map_err(|error| error.kind()),
            Ok(()) | Err(io::ErrorKind::NotFound)
        )
    });
}

pub(crate) fn status(store: &Path) -> String {
    let group = group(store).unwrap();
    group["attributes"]["status"].as_str().unwrap().to_owned()
}

fn last_line(table: &Path) -> String {
    let text = fs::read_to_string(table).unwrap();
    assert!(text.ends_with('\n'), "{text}");
    text.lines().last().unwrap().to_owned()
}

/// All files below a folder with their contents.
fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(files(&path));
        } else {
            found.insert(path.clone(), fs::read(path).unwrap());
        }
    }
    found
}

pub(crate) fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let name = |entry: fs::DirEntry| entry.file_name().into_string().unwrap();
    let mut names: Vec<String> = entries.map(|entry| name(entry.unwrap())).collect();
    names.sort();
    names
}

/// Moments from before the take-over to well after it.
#[test]
fn killed_while_it_replaces_a_result_it_leaves_the_old_or_the_new_one() {
    let folder = folder();
    let at = folder.path();
    let store = at.join("ring.zarr");
    let replace = ["-o", "ring.zarr", "--overwrite"];
    assert_eq!(run(at, &[&words(SHORT)[..], &replace].concat()).0, 0);
    let mut old = files(&store);
    assert!(old.len() > 20, "{}", old.len());
    let (mut kept, mut replaced) = (0, 0);
    for moment in 0..200 {
        // A busy machine takes longer to come to the take-over.
        if moment >= 24 && replaced > 0 {
            break;
        }
        let mut child = start(at, &[&words(LONG)[..], &replace].concat());
        let lock = at.join(".ring.zarr.writing/lock");
        let claimed = format!("process {}", child.id());
        wait_for("no claim was made", || {
            fs::read_to_string(&lock).is_ok_and(|text| text == claimed)
        });
        // From 0 to 40 ms in uneven steps, and further if need be.
        sleep(Duration::from_micros(moment * moment * 75));
        child.kill().unwrap();
        child.wait().unwrap();
        if status(&store) == "complete" {
            assert_eq!(files(&store), old, "the old one is whole");
            kept += 1;
        } else {
            assert_eq!(status(&store), "running");
            let group = group(&store).unwrap();
            let arrays = group["consolidated_metadata"]["metadata"]
                .as_object()
                .unwrap();
            for name in arrays.keys() {
                assert!(store.join(name).join("zarr.json").exists(), "{name}");
            }
            replaced += 1;
            // Left behind by a dead process, it stands in nobody's way.
            let (code, err) = run(at, &[&words(SHORT)[..], &replace].concat());
            assert_eq!((code, err.as_str()), (0, ""));
            assert_eq!(names(at), ["ring.zarr"]);
            old = files(&store);
        }
    }
    assert!(replaced > 0, "{kept} kept, {replaced} replaced");
}

#[test]
fn begun_and_killed_it_gives_way_to_a_plain_run() {
    let folder = folder();
    let at = folder.path();
    let store = at.join("ring.zarr");
    let mut child = start(at, &[&words(LONG)[..], &["-o", "ring.zarr"]].concat());
    wait_for("nothing was begun", || store.exists());
    child.kill().unwrap();
    child.wait().unwrap();
    assert_eq!((status(&store).as_str(), samples(&store)), ("running", 0));
    let (code, err) = run(at, &[&words(SHORT)[..], &["-o", "ring.zarr"]].concat());
    assert_eq!((code, err.as_str()), (0, ""));
    assert_eq!(status(&store), "complete");
}

#[test]
fn a_result_has_one_writer() {
    for name in ["ring.zarr", "ring.csv"] {
        let folder = folder();
        let at = folder.path();
        let first = start(at, &[&words(LONG)[..], &["-o", name]].concat());
        wait_for("nothing was begun", || at.join(name).exists());
        for flags in [&["-o", name][..], &["-o", name, "--overwrite"]] {
            let (code, err) = run(at, &[&words(SHORT)[..], flags].concat());
            assert_eq!(code, 3);
            let said = format!("{name}: process {} is writing a result here", first.id());
            assert!(err.starts_with(&said), "{err}");
        }
        signal(&first, "-TERM");
        let (code, err) = ended(first);
        assert_eq!((code, err.as_str()), (130, "interrupted\n"));
        assert_eq!(names(at), [name]);
    }
}

#[test]
fn every_signal_that_asks_for_an_end_is_heard() {
    for (name, number) in [
        ("ring.zarr", "-TERM"),
        ("ring.zarr", "-HUP"),
        ("ring.csv", "-HUP"),
    ] {
        if number == "-HUP" && hang_up_is_ignored() {
            // As under `nohup`: programs that it starts are not to hear it either.
            continue;
        }
        let folder = folder();
        let at = folder.path();
        let path = at.join(name);
        let child = start(at, &[&words(LONG)[..], &["-o", name]].concat());
        wait_for("nothing was begun", || path.exists());
        signal(&child, number);
        let (code, err) = ended(child);
        assert_eq!((code, err.as_str()), (130, "interrupted\n"));
        if path.is_dir() {
            assert_eq!(status(&path), "interrupted");
        } else {
            assert_eq!(last_line(&path), "# incomplete: interrupted");
        }
    }
}

/// Whether this process, and so what it starts, ignores the end of its terminal; SIGHUP is signal 1.
fn hang_up_is_ignored() -> bool {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok())
        .is_some_and(|mask| mask & 1 == 1)
}

/// As `nohup` does it.
#[cfg(target_os = "linux")]
#[test]
fn a_run_that_is_not_to_hear_the_terminal_close_goes_on() {
    let folder = folder();
    let at = folder.path();
    let store = at.join("ring.zarr");
    let plain = chaindrive(at, &[&words(LONG)[..], &["-o", "ring.zarr"]].concat());
    let child = wrapped("trap '' HUP", &plain).spawn().unwrap();
    wait_for("nothing was begun", || store.exists());
    signal(&child, "-HUP");
    wait_for("nothing was committed after the signal", || {
        samples(&store) > 0
    });
    signal(&child, "-TERM");
    assert_eq!(child.wait_with_output().unwrap().status.code(), Some(130));
}

/// A command in a shell that has made some settings first.
pub(crate) fn wrapped(settings: &str, plain: &Command) -> Command {
    let mut command = Command::new("sh");
    command
        .current_dir(plain.get_current_dir().unwrap())
        .args(["-c", &format!("{settings}; exec \"$@\""), "sh"])
        .arg(plain.get_program())
        .args(plain.get_args())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    command
}

#[test]
fn removed_under_way_it_is_not_made_anew() {
    for name in ["ring.zarr", "ring.csv"] {
        let folder = folder();
        let at = folder.path();
        let path = at.join(name);
        let child = start(at, &[&words(LONG)[..], &["-o", name]].concat());
        wait_for("nothing was begun", || path.exists());
        if path.is_dir() {
            wait_for("nothing was committed", || samples(&path) > 0);
            remove_under_way(&path);
        } else {
            fs::remove_file(&path).unwrap();
        }
        let (code, err) = ended(child);
        assert_eq!(code, 3, "{err}");
        // A folder goes piece by piece: what the writer misses first may be a part of it.
        let missed =
            err.starts_with(&format!("{name}: `")) && path.extension() == Some("zarr".as_ref());
        assert!(
            (missed && err.contains("was removed or moved"))
                || err.starts_with(&format!("{name}: the result was removed or moved")),
            "{err}"
        );
        assert!(names(at).is_empty(), "{:?}", names(at));
    }
}

#[test]
fn with_a_part_removed_it_says_that_it_failed() {
    let folder = folder();
    let at = folder.path();
    let store = at.join("ring.zarr");
    let child = start(at, &[&words(LONG)[..], &["-o", "ring.zarr"]].concat());
    wait_for("nothing was committed", || samples(&store) > 0);
    remove_under_way(&store.join("span"));
    signal(&child, "-INT");
    let (code, err) = ended(child);
    assert_eq!(code, 3, "{err}");
    assert!(err.contains("`span/"), "{err}");
    assert_eq!(status(&store), "failed");
}

/// A limit on the size of files \[bytes\] stands for a disk that is full; its signal would kill the program.
#[cfg(target_os = "linux")]
pub(crate) fn on_a_full_disk(limit: u64, at: &Path, arguments: &[&str]) -> (i32, String) {
    let settings = format!("trap '' XFSZ; prlimit --pid $$ --fsize={limit}");
    let plain = chaindrive(at, arguments);
    ended(wrapped(&settings, &plain).spawn().unwrap())
}

#[cfg(target_os = "linux")]
#[test]
fn on_a_full_disk_it_keeps_what_was_written() {
    let folder = folder();
    let at = folder.path();
    // The chunks of 20 numbers a sample outgrow the limit, the group document does not.
    let long = words("run spinning_ring --until 300 --every '10 us' --no-error -q");
    let record = ["--record", "roller_x,roller_vy", "-o"];

    let (code, err) = on_a_full_disk(
        200 << 10,
        at,
        &[&long[..], &record, &["ring.zarr"]].concat(),
    );
    assert_eq!(code, 3, "{err}");
    assert!(err.starts_with("ring.zarr: File too large"), "{err}");
    let store = at.join("ring.zarr");
    let group = group(&store).unwrap();
    let about = &group["attributes"];
    assert_eq!(
        (&about["status"], &about["complete"]),
        (&"failed".into(), &0.into())
    );
    let said = about["failure"].as_str().unwrap();
    assert!(
        said.starts_with("the result could not be written: File too large"),
        "{said}"
    );
    let length = &group["consolidated_metadata"]["metadata"]["roller_x"]["shape"][0];
    assert_eq!(length, &about["samples"]);

    // A table that grows until the disk is full under it.
    let (code, err) = on_a_full_disk(200 << 10, at, &[&long[..], &record, &["ring.csv"]].concat());
    assert_eq!(code, 3, "{err}");
    assert!(err.starts_with("ring.csv: File too large"), "{err}");
    let table = at.join("ring.csv");
    assert!(last_line(&table).starts_with("# incomplete: "));
    let text = fs::read_to_string(&table).unwrap();
    let cells: Vec<usize> = text.lines().map(|line| line.split(',').count()).collect();
    assert!(
        cells[..cells.len() - 1].iter().all(|&count| count == 41),
        "{cells:?}"
    );
    assert_eq!(names(at), ["ring.csv", "ring.zarr"]);
}

/// The disk is full at every place of a row in the middle, and at every place from the last row to after the line that
/// says that the table is not at its end. All rows that leave room for a closing line are kept.
#[cfg(target_os = "linux")]
#[test]
fn wherever_the_disk_is_full_whole_rows_and_a_closing_line_stay() {
    let folder = folder();
    let at = folder.path();
    let plain = words(
        "run spinning_ring --until '1 ms' --every '10 us' --no-error -q --record energy_kinetic -o",
    );
    assert_eq!(run(at, &[&plain[..], &["whole.csv"]].concat()).0, 0);
    let whole = fs::read_to_string(at.join("whole.csv")).unwrap();
    let ends: Vec<usize> = whole.match_indices('\n').map(|(at, _)| at + 1).collect();
    let shortest = "# incomplete: failed\n".len();
    let longest = "# incomplete: running\n".len();
    let rows = ends.len();
    assert!(rows > 90, "{rows}");
    let middle = ends[rows / 2]..ends[rows / 2 + 1];
    let last = ends[rows - 2]..ends[rows - 1] + longest;
    for limit in middle.chain(last) {
        let csv = ["ring.csv", "--overwrite"];
        let (code, err) = on_a_full_disk(limit as u64, at, &[&plain[..], &csv].concat());
        assert_eq!(code, 3, "{err}");
        assert!(err.starts_with("ring.csv: File too large"), "{err}");
        let kept = ends.iter().rfind(|&&end| end + shortest <= limit).unwrap();
        let text = fs::read_to_string(at.join("ring.csv")).unwrap();
        let (rows, closing) = text.split_at(*kept);
        assert_eq!(rows, &whole[..*kept], "{limit}");
        assert!(
            closing.starts_with("# incomplete: ") && closing.lines().count() == 1,
            "{limit}: {closing}"
        );
        assert!(closing.ends_with('\n'), "{limit}: {closing}");
    }
}

/// The limit refuses the checkpoint itself, which for two hundred links with play is longer than all else.
#[cfg(target_os = "linux")]
#[test]
fn a_checkpoint_that_does_not_fit_ends_the_run_and_leaves_nothing_half_written() {
    let folder = folder();
    let at = folder.path();
    let scene = words("run bicycle --until '0.2 ms' --run-in 0 --method implicit-damping");
    let longer = [
        "--set",
        "chain.links=200",
        "--set",
        "sprockets.rear.centre=['-1.070144624366 m', '0 m']",
    ];
    let to = words("--no-error -q --record span_tension -o run.zarr --checkpoint-every '50 us'");
    let (code, err) = on_a_full_disk(130 << 10, at, &[&scene[..], &longer, &to].concat());
    assert_eq!(code, 3, "{err}");
    let store = at.join("run.zarr");
    assert_eq!(status(&store), "failed");
    let left = names(&store);
    assert!(
        left.iter().all(|name| !name.starts_with("checkpoint")),
        "{left:?}"
    );
    let (code, err) = run(at, &["resume", "run.zarr"]);
    assert_eq!(code, 2, "{err}");
    assert!(err.contains("File too large"), "{err}");
}

#[cfg(target_os = "linux")]
#[test]
fn a_sweep_on_a_full_disk_leaves_nothing_half_done() {
    let folder = folder();
    let at = folder.path();
    let sweep = words("sweep spinning_ring --until '1 ms' -q -o s.csv --vary");
    let few = [&sweep[..], &["chain.mass=8 g,9 g"]].concat();
    assert_eq!(run(at, &few).0, 0);
    let old = fs::read_to_string(at.join("s.csv")).unwrap();
    let (code, err) = on_a_full_disk(512, at, &[&few[..], &["--overwrite"]].concat());
    assert_eq!(code, 3, "{err}");
    assert_eq!(fs::read_to_string(at.join("s.csv")).unwrap(), old);
    assert_eq!(names(at), ["s.csv"]);
}

#[test]
fn a_link_to_a_store_is_followed_and_one_to_nowhere_is_refused() {
    let folder = folder();
    let at = folder.path();
    fs::create_dir(at.join("big")).unwrap();
    let name = "ring.zarr";
    std::os::unix::fs::symlink(Path::new("big").join(name), at.join(name)).unwrap();
    let to = [&words(SHORT)[..], &["-o", name]].concat();
    let (code, err) = run(at, &to);
    assert_eq!(code, 3);
    assert!(err.contains("symbolic link to big/ring."), "{err}");
    let real = format!("big/{name}");
    assert_eq!(run(at, &[&words(SHORT)[..], &["-o", &real]].concat()).0, 0);
    assert_eq!(run(at, &[&to[..], &["--overwrite"]].concat()).0, 0);
    assert!(at.join(name).is_symlink());
    assert_eq!(names(&at.join("big")), [name]);
}

#[test]
fn tables_name_units_and_contacts_have_one_of_their_own() {
    let folder = folder();
    let at = folder.path();
    let run_with = |more: &[&str]| {
        let plain = words("run marine_two_sprockets --until '2 ms' --every '1 ms'");
        let rest = ["--no-error", "-q", "-o", "drive.csv"];
        let (code, err) = run(at, &[&plain[..], &rest, more].concat());
        assert_eq!(code, 0, "{err}");
    };
    run_with(&words(
        "--events teeth --record sprocket_speed,contacts,energy_kinetic",
    ));
    let table = fs::read_to_string(at.join("drive.csv")).unwrap();
    assert_eq!(
        table.lines().next().unwrap(),
        "time [s],sprocket_speed[crank] [rad/s],sprocket_speed[camshaft] [rad/s],contacts[crank] [1],\
         contacts[camshaft] [1],energy_kinetic [J]"
    );
    assert_eq!(table.lines().count(), 4);
    let contacts = fs::read_to_string(at.join("drive.events.csv")).unwrap();
    let mut lines = contacts.lines();
    assert_eq!(
        lines.next().unwrap(),
        "event_kind,event_body,event_roller,event_start [s],event_end [s],event_onset_speed [m/s],\
         event_peak_force [N],event_impulse [N s]"
    );
    assert!(lines.all(|line| line.starts_with("tooth,c") && line.split(',').count() == 8));
    assert!(
        contacts.contains(",inf,"),
        "contacts that last are there too"
    );
    // Contacts of an earlier run do not stay beside the samples of a later one.
    run_with(&["--overwrite"]);
    assert_eq!(names(at), ["drive.csv"]);
}
