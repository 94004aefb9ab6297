//! `chaindrive sweep`: what it writes, what it says, how it ends.

use std::fs;
use std::path::Path;
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::command_line::{attributes, folder, run, signal, start, told, wait_for, words};

/// Runs a sweep and returns exit code, stdout and stderr.
fn sweep(folder: &Path, arguments: &[&str]) -> (i32, String, String) {
    run(folder, &[&["sweep"], arguments].concat())
}

/// Crank speeds of the marine engine, as a range in turns, and its pretension, as a list.
#[test]
fn speeds_and_pretensions_of_the_marine_engine() {
    let folder = folder();
    let at = folder.path();
    let arguments = words(
        "marine_engine --vary 'sprockets.crank.motion.speed=-80 rpm..-140 rpm/3' --vary 'route.pretension=10 kN,20 kN' \
         --until '1 ms' --run-in 0 --record span_tension -j 2 -o marine.zarr",
    );
    let (code, out, err) = sweep(at, &arguments);
    assert_eq!(
        (code, err.as_str()),
        (0, ""),
        "nothing but errors in a pipe"
    );
    assert!(out.contains("speed [rad/s]  pretension [N]"), "{out}");
    assert!(out.ends_with("variants: 6 of 6 done\n"), "{out}");
    let about = attributes(&at.join("marine.zarr"));
    assert_eq!(about["status"], "complete");
    assert_eq!(about["method"], "verlet");
    assert_eq!(about["finished"], 6);
    let scene = about["scene"].as_str().unwrap();
    assert!(scene.contains("until = \"1 ms\""), "{scene}");
    let array = fs::read(at.join("marine.zarr/span_tension/zarr.json")).unwrap();
    let array: serde_json::Value = serde_json::from_slice(&array).unwrap();
    // (speed, pretension, time, span); samples every 0.2 ms.
    assert_eq!(array["shape"], serde_json::json!([3, 2, 6, 4]));
    assert_eq!(array["dimension_names"][0], "speed");

    // Nothing is left to be done.
    assert_eq!(sweep(at, &arguments), (0, out, String::new()));
    let other = [&arguments[..], &["--set", "gravity=[0, 0]"]].concat();
    let (code, _, err) = sweep(at, &other);
    assert_eq!(code, 3);
    assert!(err.contains("another sweep here"), "{err}");
    let again: Vec<&str> = arguments.into_iter().chain(["--overwrite", "-q"]).collect();
    assert_eq!(sweep(at, &again), (0, String::new(), String::new()));
}

/// A cell is read as a value of `--vary` is.
#[test]
fn the_rows_of_a_table_are_variants() {
    let folder = folder();
    let at = folder.path();
    let table = "chain.start.speed, chain.mass\n300 rad/s, 8 g\n400, 0.009\n300, 8 g\n";
    fs::write(at.join("points.csv"), table).unwrap();
    let table = words("spinning_ring --until '1 ms' -o ring.csv --design");
    let design = |name, more: &[&str]| sweep(at, &[&table[..], &[name], more].concat());
    let (code, out, err) = design("points.csv", &[]);
    assert_eq!((code, err.as_str()), (0, ""), "{out}");
    let rows = fs::read_to_string(at.join("ring.csv")).unwrap();
    let first = |row: &str| row.split(',').take(3).collect::<Vec<_>>().join(",");
    let rows: Vec<String> = rows.lines().map(first).collect();
    assert_eq!(rows[0], "variant,speed [rad/s],mass [kg]");
    assert_eq!(
        rows[1..],
        ["0,300.0,0.008", "1,400.0,0.009", "2,300.0,0.008"]
    );
    for (text, words) in [
        ("chain.mass\n8 g,9 g\n", "found record with 2 fields"),
        ("chain.mass\n", "no values"),
        ("chain.mas\n8 g\n", "mass"),
    ] {
        fs::write(at.join("points.csv"), text).unwrap();
        let (code, _, err) = design("points.csv", &[]);
        assert!(code == 2 && err.contains(words), "{code}: {err}");
    }
    assert_eq!(design("points.csv", &["--vary", "chain.mass=8 g"]).0, 2);
    let (code, _, err) = design("nowhere.csv", &[]);
    assert!(code == 2 && err.contains("nowhere.csv"), "{code}: {err}");
}

#[test]
fn variants_that_fail_are_listed_and_the_others_kept() {
    let folder = folder();
    let at = folder.path();
    let (code, out, err) = sweep(
        at,
        &words(
            "spinning_ring --vary 'chain.start.speed=300 rad/s,1e300 rad/s' --until '1 ms' -o ring.csv",
        ),
    );
    assert_eq!(code, 1, "{err}");
    assert!(out.contains("1 of 2 done, 1 failed"), "{out}");
    let lines: Vec<&str> = err.lines().collect();
    assert!(lines[0].starts_with("speed = 1.0e300 rad/s: "), "{err}");
    assert_eq!(lines[1], "1 of 2 variants failed");
    let table = fs::read_to_string(at.join("ring.csv")).unwrap();
    let rows: Vec<&str> = table.lines().collect();
    assert!(rows[0].starts_with("variant,speed [rad/s],"), "{table}");
    assert!(rows[0].ends_with(",error"), "{table}");
    assert!(
        rows[1].starts_with("0,300.0,") && rows[1].ends_with(','),
        "{table}"
    );
    assert!(
        rows[2].starts_with("1,1e300,NaN,") && rows[2].contains("flies apart"),
        "{table}"
    );
    assert_eq!(rows[3..], ["# incomplete: 1 of 2 variants failed"]);
    assert_eq!(fs::read_dir(at).unwrap().count(), 1);
}

#[test]
fn what_is_wrong_is_refused_before_anything_is_written() {
    let folder = folder();
    let at = folder.path();
    let cases = [
        ("", 2, "--vary"),
        ("--vary chain.links", 2, "a path and its values"),
        ("--vary chain.lnks=20,22", 2, "lnks"),
        ("--vary chain.links=20,20", 2, "stands twice"),
        ("--vary 'chain.mass=1 g..2 g'", 2, "FIRST..LAST/COUNT"),
        ("--vary chain.links=20 -j 0", 2, "--jobs"),
        (
            "--vary chain.links=20 --record link_tension -o a.csv",
            2,
            "take a .zarr store",
        ),
        (
            "--vary chain.links=20 -o notes.csv --overwrite",
            3,
            "not a table",
        ),
    ];
    fs::write(at.join("notes.csv"), "variants of last week\n").unwrap();
    for (arguments, expected, told) in cases {
        let (code, out, err) = sweep(at, &words(&format!("spinning_ring {arguments}")));
        assert_eq!((code, out.as_str()), (expected, ""), "{arguments}: {err}");
        assert!(err.contains(told), "{arguments}: {err}");
    }
    assert_eq!(fs::read_dir(at).unwrap().count(), 1);
}

/// Neither of two answers to one question wins silently.
#[test]
fn what_is_varied_is_not_given_as_well() {
    let folder = folder();
    let at = folder.path();
    let cases = [
        (
            "--vary 'run.until=1 ms,2 ms' --until 3ms",
            "`run.until` is varied, and given as `--until` as well; give one of them",
        ),
        (
            "--vary 'run . every=1 ms' --every 3ms",
            "given as `--every`",
        ),
        (
            "--vary run={method=\"rk4\"},{} --step 1us",
            "`run` is varied, and given as `--step`",
        ),
        (
            "--vary run.record=[\"link_tension\"] --record contacts",
            "given as `--record`",
        ),
        (
            "--vary run.events=[\"teeth\"],[] --events teeth",
            "given as `--events`",
        ),
        (
            "--vary 'chain.mass=1 g,2 g' --set 'chain.mass=3 g'",
            "given as `--set chain.mass`",
        ),
        (
            "--vary run.accuracy=1%,2% --method rk4",
            "`run.accuracy` is varied, and given as `--method`",
        ),
        (
            "--vary 'run.step=1 us,2 us' --accuracy 1%",
            "`run.accuracy` asks for an accuracy",
        ),
        (
            "--vary 'chain.mass=1 g,2 g' --vary chain=\"08B-1\"",
            "`chain.mass` is varied, and then replaced",
        ),
    ];
    for (arguments, told) in cases {
        let line = format!("spinning_ring -o a.zarr {arguments}");
        let (code, out, err) = sweep(at, &words(&line));
        assert_eq!((code, out.as_str()), (2, ""), "{line}: {err}");
        assert!(err.contains(told), "{line}: {err}");
    }
    assert_eq!(fs::read_dir(at).unwrap().count(), 0);
}

/// The command line speaks last, in a sweep as in a run.
#[test]
fn a_named_method_goes_before_the_accuracy_of_the_scene() {
    let folder = folder();
    let arguments = words(
        "spinning_ring --set run.accuracy=1% --vary chain.start.speed=300 --until 1ms -o a.zarr --method rk4",
    );
    let (code, _, err) = sweep(folder.path(), &arguments);
    assert_eq!((code, err.as_str()), (0, ""));
    let about = attributes(&folder.path().join("a.zarr"));
    assert_eq!(about["method"], "rk4");
    // The text reproduces what was done.
    let scene = about["scene"].as_str().unwrap();
    assert!(!scene.contains("accuracy"), "{scene}");
}

#[test]
fn the_help_says_that_a_choice_serves_many_variants() {
    let (code, out, _) = sweep(Path::new("."), &["--help"]);
    assert_eq!(code, 0);
    let out = out.split_whitespace().collect::<Vec<_>>().join(" ");
    for words in [
        "tried once for up to 32 variants",
        "--method auto takes the default step",
    ] {
        assert!(out.contains(words), "{words}: {out}");
    }
}

/// Waits until the result of the first variant is written.
#[cfg(unix)]
fn wait_for_a_variant(path: &Path) {
    wait_for("nothing was written", || {
        if path.join("zarr.json").exists() {
            attributes(path)["finished"].as_u64() > Some(0)
        } else {
            fs::metadata(path).is_ok_and(|file| file.is_file() && file.len() > 0)
        }
    });
}

/// The first variant ends at once, the others would take days.
#[cfg(unix)]
#[test]
fn interrupted_it_keeps_what_is_finished() {
    for out in ["long.zarr", "long.csv"] {
        let folder = folder();
        let long = words(
            "sweep spinning_ring --every 1ms -j 2 --vary 'run.until=1 ms,2e4 s,3e4 s,4e4 s' -o",
        );
        let child = start(folder.path(), &[&long[..], &[out]].concat());
        let path = folder.path().join(out);
        wait_for_a_variant(&path);
        signal(&child, "-INT");
        let (code, text, err) = told(child.wait_with_output().unwrap());
        assert_eq!((code, err.as_str()), (130, "interrupted\n"));
        assert!(
            text.ends_with("variants: 1 of 4 done, 3 not carried out\n"),
            "{text}"
        );
        if path.is_dir() {
            let about = attributes(&path);
            assert_eq!(about["status"], "interrupted");
            assert_eq!(about["finished"], 1);
        } else {
            let table = fs::read_to_string(path).unwrap();
            assert_eq!(table.lines().last(), Some("# incomplete: interrupted"));
            assert_eq!(table.matches("not carried out").count(), 3, "{table}");
        }
    }
}

/// Interrupted at moments drawn by lot, the store says how many variants it holds, and the same command goes on to the bytes of a
/// sweep that nobody interrupted.
#[cfg(unix)]
#[test]
fn interrupted_it_says_what_it_is_and_goes_on() {
    let folder = folder();
    let common = ["spinning_ring", "--vary", "chain.start.speed=300..400/40"];
    let run = ["--until", "20 ms", "--every", "1 ms", "-q", "-j", "2", "-o"];
    let arguments = |out| [&common[..], &run[..], &[out]].concat();
    let begin = Instant::now();
    assert_eq!(sweep(folder.path(), &arguments("whole.zarr")).0, 0);
    let took = begin.elapsed();
    let path = folder.path().join("broken.zarr");
    for share in [0.5, 0.3, 0.1, 0.6] {
        let again = [&["sweep"], &arguments("broken.zarr")[..]].concat();
        let mut child = start(folder.path(), &again);
        sleep(took.mul_f64(share));
        signal(&child, "-INT");
        let code = child.wait().unwrap().code();
        if !path.exists() {
            assert_eq!(code, Some(130));
            continue;
        }
        let about = attributes(&path);
        let chunks = fs::read_dir(path.join("error/c")).map_or(0, Iterator::count) as u64;
        let stored = (chunks * about["variants_per_task"].as_u64().unwrap()).min(40);
        assert_eq!(about["finished"].as_u64(), Some(stored));
        let (status, expected) = if stored < 40 {
            ("interrupted", 130)
        } else {
            ("complete", 0)
        };
        assert_eq!(
            (about["status"].as_str(), code),
            (Some(status), Some(expected))
        );
    }
    assert_eq!(sweep(folder.path(), &arguments("broken.zarr")).0, 0);
    assert_eq!(attributes(&path)["status"], "complete");
    for array in ["energy_residual_max", "steps", "error"] {
        for chunk in fs::read_dir(folder.path().join("whole.zarr").join(array).join("c")).unwrap() {
            let chunk = chunk.unwrap();
            let other = path.join(array).join("c").join(chunk.file_name());
            let bytes = [chunk.path(), other.clone()].map(|it| fs::read(it).unwrap());
            assert_eq!(bytes[0], bytes[1], "{}", other.display());
        }
    }
}

/// The first variant in the place of the earlier result would take days.
#[cfg(unix)]
#[test]
fn interrupted_before_it_has_anything_it_leaves_the_earlier_result() {
    let long: Vec<String> = (1..16).map(|it| format!("{it}e4 s")).collect();
    // A store is laid out once the first variant has been timed; two of these make a task.
    let stored = ["1 ms"]
        .into_iter()
        .chain(long.iter().map(String::as_str))
        .collect::<Vec<_>>();
    for (out, values) in [
        ("ring.zarr", format!("run.until={}", stored.join(","))),
        ("ring.csv", format!("run.until={}", long.join(","))),
    ] {
        let folder = folder();
        let common = ["spinning_ring", "--every", "1 ms", "-j", "1", "-o", out];
        let earlier = ["--vary", "run.until=1 ms,2 ms", "-q"];
        let (code, _, err) = sweep(folder.path(), &[&common[..], &earlier].concat());
        assert_eq!(code, 0, "{err}");
        let path = folder.path().join(out);
        let last = |path: &Path| {
            fs::read(if path.is_dir() {
                path.join("zarr.json")
            } else {
                path.to_owned()
            })
            .unwrap()
        };
        let kept = last(&path);

        let over = ["--vary", &values, "--overwrite", "-q"];
        let child = start(folder.path(), &[&["sweep"], &common[..], &over].concat());
        let begun = folder.path().join(format!(".{out}.writing/lock"));
        wait_for("it does not begin", || begun.exists());
        // Long enough to lay out the new store.
        sleep(Duration::from_millis(200));
        assert_eq!(last(&path), kept, "{out}");
        signal(&child, "-INT");
        assert_eq!(told(child.wait_with_output().unwrap()).0, 130);
        assert_eq!(last(&path), kept, "{out}");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}

#[test]
fn values_that_no_variant_can_have_are_refused_before_it_begins() {
    let folder = folder();
    let damping = words("spinning_ring --vary 'chain.damping=10 N s/m,20 N s/m,30 N s/m'");
    let both = ["--vary", "chain.damping_ratio=0.01,0.02", "-o", "ring.csv"];
    let (code, out, err) = sweep(folder.path(), &[&damping[..], &both].concat());
    assert_eq!((code, out.as_str()), (2, ""), "{err}");
    assert!(
        err.contains("no variant is a drive, of 6 that were tried"),
        "{err}"
    );
    assert!(err.contains("keep one of them"), "{err}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}
