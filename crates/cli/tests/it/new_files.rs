//! Files that verbs make in one piece: the old one or the new one, whole, and nothing beside it, whatever befalls them.
#![cfg(target_os = "linux")]
#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use std::collections::BTreeSet;
use std::fs;
use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::Child;
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::command_line::{chaindrive, ended, folder, run, signal, words};
use crate::store_faults::{names, on_a_full_disk};

/// A verb, the file that it makes, and how it ends when it is whole.
struct Maker {
    line: &'static str,
    file: &'static str,
    end: &'static [u8],
}

const BENCH: &str = "bench spinning_ring --until '0.1 ms' --repeats 1 --replicates 1 --methods verlet --steps 4e-5 -o new";

const MAKERS: [Maker; 4] = [
    Maker {
        line: "draw spinning_ring -o new.svg",
        file: "new.svg",
        end: b"</svg>\n",
    },
    Maker {
        line: "replay ring.zarr -q -o new.html",
        file: "new.html",
        end: b"</html>\n",
    },
    Maker {
        line: "fmu spinning_ring --no-run -q --library ring.zarr/zarr.json -o new.fmu",
        file: "new.fmu",
        // The end of an archive, without a comment.
        end: &[0, 0],
    },
    Maker {
        line: BENCH,
        file: "new.csv",
        end: b"\n",
    },
];

const OLD: &str = "time,old\n";

impl Maker {
    fn arguments(&self, overwrite: bool) -> Vec<&'static str> {
        let mut words = words(self.line);
        words.extend(overwrite.then_some("--overwrite"));
        words
    }

    fn is_whole(&self, content: &[u8]) -> bool {
        content.len() > 200 && content.ends_with(self.end)
    }
}

/// A folder with a result to make pages of.
fn workplace() -> tempfile::TempDir {
    let folder = folder();
    let result = "run spinning_ring --until 1ms --no-error -q --run-in 0 -o ring.zarr";
    let (code, _, err) = run(folder.path(), &words(result));
    assert_eq!(code, 0, "{err}");
    folder
}

/// The file and the result, and nothing else but what is named.
fn only(at: &Path, files: &[&str]) {
    let expected: BTreeSet<_> = files.iter().chain(&["ring.zarr"]).copied().collect();
    let found = names(at);
    assert_eq!(
        found.iter().map(String::as_str).collect::<BTreeSet<_>>(),
        expected
    );
}

/// What cannot be written is told before anything is simulated, with the code of results that cannot be written.
#[test]
fn a_place_that_cannot_be_written_is_refused_at_once() {
    let folder = workplace();
    let at = folder.path();
    for maker in &MAKERS {
        let file = maker.file;
        let refused = |overwrite, arguments: &[&str], said: &str| {
            let line = [&maker.arguments(overwrite)[..], arguments].concat();
            let (code, out, err) = run(at, &line);
            assert_eq!((code, out.as_str()), (3, ""), "{line:?}: {err}");
            assert!(err.contains(file) && err.contains(said), "{line:?}: {err}");
        };
        fs::write(at.join(file), OLD).unwrap();
        refused(false, &[], "pass --overwrite");
        fs::rename(at.join(file), at.join("victim")).unwrap();
        symlink("victim", at.join(file)).unwrap();
        refused(true, &[], "symbolic link to victim");
        assert_eq!(fs::read_to_string(at.join("victim")).unwrap(), OLD);
        fs::remove_file(at.join("victim")).unwrap();
        refused(false, &[], "symbolic link");
        fs::remove_file(at.join(file)).unwrap();
        fs::create_dir(at.join(file)).unwrap();
        refused(true, &[], "a folder here");
        only(at, &[file]);
        fs::remove_dir(at.join(file)).unwrap();
        // Not even the super-user writes below a file, or among the processes.
        for place in ["ring.zarr/zarr.json/", "/proc/1/none/"] {
            let mut line = maker.arguments(true);
            let last = line.iter().position(|it| *it == "-o").unwrap() + 1;
            let moved = format!("{place}{}", line[last]);
            line[last] = &moved;
            let (code, out, err) = run(at, &line);
            assert_eq!((code, out.as_str()), (3, ""), "{line:?}: {err}");
        }
        only(at, &[]);
    }
}

/// Folders that are missing are made, and are gone again where nothing comes of it.
#[test]
fn missing_folders_are_made_as_for_stores() {
    let folder = workplace();
    let at = folder.path();
    for maker in &MAKERS {
        let mut line = maker.arguments(false);
        let last = line.iter().position(|it| *it == "-o").unwrap() + 1;
        let moved = format!("a/b/{}", line[last]);
        line[last] = &moved;
        let (code, _, err) = run(at, &line);
        assert_eq!(code, 0, "{line:?}: {err}");
        assert!(maker.is_whole(&fs::read(at.join("a/b").join(maker.file)).unwrap()));
        assert_eq!(names(&at.join("a/b")), [maker.file]);
        fs::remove_dir_all(at.join("a")).unwrap();
    }
    let line = words("draw marine_engine --set chain.links=1 -o a/b/new.svg");
    let (code, _, err) = run(at, &line);
    assert_eq!(code, 2, "{err}");
    let line = words("run spinning_ring --until 1ms --no-error -q --run-in 0 -o a/b/new.csv");
    let (code, _, err) = run(at, &line);
    assert_eq!(code, 0, "{err}");
    assert_eq!(names(&at.join("a/b")), ["new.csv"]);
}

/// A table of a run follows no link either.
#[test]
fn the_table_of_a_run_is_not_written_through_a_link() {
    let folder = folder();
    let at = folder.path();
    fs::write(at.join("victim"), OLD).unwrap();
    symlink("victim", at.join("new.csv")).unwrap();
    let line = words("run spinning_ring --until 1ms --no-error -q -o new.csv --overwrite");
    let (code, _, err) = run(at, &line);
    assert_eq!(code, 3, "{err}");
    assert!(err.contains("symbolic link"), "{err}");
    assert_eq!(fs::read_to_string(at.join("victim")).unwrap(), OLD);
}

/// Writes what a full disk cannot hold, at some of the blocks of the whole file.
fn fill_the_disk(maker: &Maker, at: &Path, blocks: impl Fn(u64) -> Vec<u64>) {
    let file = at.join(maker.file);
    let (code, _, err) = run(at, &maker.arguments(false));
    assert_eq!(code, 0, "{err}");
    let whole = fs::metadata(&file).unwrap().len();
    for block in blocks(whole / 4096) {
        if 4096 * block >= whole {
            continue;
        }
        fs::write(&file, OLD).unwrap();
        let (code, err) = on_a_full_disk(4096 * block, at, &maker.arguments(true));
        assert_eq!(code, 3, "{block}: {err}");
        assert!(err.contains("make room"), "{err}");
        assert_eq!(fs::read_to_string(&file).unwrap(), OLD);
        fs::remove_file(&file).unwrap();
        let (code, err) = on_a_full_disk(4096 * block, at, &maker.arguments(false));
        assert_eq!(code, 3, "{block}: {err}");
        only(at, &[]);
    }
}

#[test]
fn on_a_full_disk_the_old_file_stays() {
    let folder = workplace();
    let at = folder.path();
    for maker in &MAKERS[..3] {
        fill_the_disk(maker, at, |last| vec![0, last]);
        let _ = fs::remove_file(at.join(maker.file));
    }
}

/// Kills a verb at a moment; whatever is there is whole, and beside it is at most a file in the making.
fn killed(maker: &Maker, at: &Path, after: Duration, overwrite: bool) {
    let file = at.join(maker.file);
    if overwrite {
        fs::write(&file, OLD).unwrap();
    }
    let child: Child = chaindrive(at, &maker.arguments(overwrite)).spawn().unwrap();
    sleep(after);
    signal(&child, "-9");
    let _ = child.wait_with_output().unwrap();
    match fs::read(&file) {
        Ok(content) if overwrite && content == OLD.as_bytes() => {}
        Ok(content) => assert!(maker.is_whole(&content), "{} bytes", content.len()),
        Err(error) => assert!(!overwrite, "{error}"),
    }
    for name in names(at) {
        let expected = name == maker.file || name == "ring.zarr";
        if !expected {
            assert!(name.starts_with(".chaindrive-"), "{name}");
            fs::remove_file(at.join(name)).unwrap();
        }
    }
    let _ = fs::remove_file(&file);
}

/// Time that a verb takes here and now.
fn taken(maker: &Maker, at: &Path) -> Duration {
    let begin = Instant::now();
    assert_eq!(run(at, &maker.arguments(true)).0, 0);
    let taken = begin.elapsed();
    fs::remove_file(at.join(maker.file)).unwrap();
    taken
}

#[test]
fn killed_a_verb_leaves_the_old_file_or_the_new_one() {
    let folder = workplace();
    let at = folder.path();
    for maker in &MAKERS[..3] {
        let taken = taken(maker, at);
        for moment in 0..4_u32 {
            killed(maker, at, taken * (7 + moment) / 10, moment % 2 == 0);
        }
    }
}

/// Two at once: with `--overwrite` both, without it at least one.
#[test]
fn writers_at_once_do_no_harm() {
    let folder = workplace();
    let at = folder.path();
    for maker in &MAKERS[..3] {
        for overwrite in [true, false] {
            let arguments = maker.arguments(overwrite);
            let writers = [(); 3].map(|()| chaindrive(at, &arguments).spawn().unwrap());
            let codes = writers.map(|it| ended(it).0);
            let sound = |code: &i32| *code == 0 || (!overwrite && *code == 3);
            assert!(codes.iter().all(sound) && codes.contains(&0), "{codes:?}");
            assert!(maker.is_whole(&fs::read(at.join(maker.file)).unwrap()));
            only(at, &[maker.file]);
            fs::remove_file(at.join(maker.file)).unwrap();
        }
    }
}

#[test]
#[ignore = "a study: every block of every file, and twenty moments of every verb with and without --overwrite"]
fn whatever_the_moment_and_the_block() {
    let folder = workplace();
    let at = folder.path();
    for maker in &MAKERS {
        fill_the_disk(maker, at, |last| (0..=last).collect());
        let _ = fs::remove_file(at.join(maker.file));
        let taken = taken(maker, at);
        for moment in 0..40_u32 {
            // Low-discrepancy moments: multiples of the golden section, from the start to a little after the end.
            let share = 1.1 * (f64::from(moment) * 0.618_034).fract();
            killed(maker, at, taken.mul_f64(share), moment % 2 == 0);
        }
    }
}

/// Nothing is simulated for a run-in that counts the turns of what the drive has not.
#[test]
fn names_are_looked_at_before_the_work() {
    let folder = folder();
    let at = folder.path();
    let line = words("fmu marine_engine --run-in '8 turns of crank-' -o new.fmu");
    let (code, _, err) = run(at, &line);
    assert_eq!(code, 2, "{err}");
    assert!(err.contains("turns of crank-: there are crank"), "{err}");
    // A run that would take days.
    let line = words("fmu marine_engine --until 1e5 --library nowhere -o new.fmu");
    let (code, _, err) = run(at, &line);
    assert_eq!(code, 2, "{err}");
    assert!(err.contains("nowhere: the library"), "{err}");
    assert!(names(at).is_empty());
}
