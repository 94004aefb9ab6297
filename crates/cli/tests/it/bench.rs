//! `chaindrive bench`: what it prints and saves, what it refuses.
#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use std::fs;
use std::path::Path;
use std::process::Command;

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().unwrap()
}

/// Runs the command and returns exit code, stdout and stderr.
fn run(folder: &Path, arguments: &[&str]) -> (i32, String, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_chaindrive"));
    let output = command
        .current_dir(folder)
        .args(arguments)
        .output()
        .unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (
        output.status.code().unwrap(),
        text(output.stdout),
        text(output.stderr),
    )
}

#[test]
fn the_bench_prints_a_table_and_saves_it() {
    let folder = folder();
    let at = folder.path();
    let short = [
        "bench",
        "spinning_ring",
        "--until",
        "5 ms",
        "--repeats",
        "1",
    ];
    let methods = [
        "--methods",
        "verlet,rk4,generalized-alpha",
        "--steps",
        "4e-5,2e-5",
    ];
    let (code, out, err) = run(at, &[&short[..], &methods].concat());
    assert_eq!(code, 0, "{err}");
    assert!(
        out.contains("checked by               dormand-prince"),
        "{out}"
    );
    assert!(out.contains("verlet, step 40 µs"), "{out}");
    assert!(
        out.contains("choose verlet"),
        "a method that fails stays: {out}"
    );
    let csv = fs::read_to_string(at.join("work-precision.csv")).unwrap();
    assert!(csv.starts_with("method,step,tolerance,onset_depth,wall,cpu,"));
    assert_eq!(csv.lines().count(), 1 + 6 + 2);

    let (code, _, err) = run(at, &short);
    assert_eq!(code, 3, "{err}");
    assert!(err.contains("--overwrite"), "{err}");
    let (code, _, err) = run(
        at,
        &["bench", "spinning_ring", "--steps", "1e-5", "-o", "other"],
    );
    assert_eq!(code, 2);
    assert!(err.contains("--methods"), "{err}");
}

/// All of it is found before minutes of work.
#[test]
fn the_bench_refuses_what_it_cannot_run_or_write() {
    let folder = folder();
    let at = folder.path();
    fs::write(at.join("work-precision.csv"), "mine\n").unwrap();
    let cases: [(&[&str], i32, &str); 10] = [
        (
            &["--methods", "verlet", "--steps", "0"],
            2,
            "--steps: 0, must be positive",
        ),
        (
            &["--methods", "verlet", "--steps", "1 us,2 kg"],
            2,
            "--steps: `2 kg` is a mass",
        ),
        (
            &["--methods", "verlet", "--steps", "1e-300", "-o", "x"],
            2,
            "step = 1e-300, must be at least",
        ),
        (
            &["--methods", "rk4", "--onset-depth", "x"],
            2,
            "--onset-depth: `x`",
        ),
        (
            &["--methods", "verlet", "--tolerances", "1e-6"],
            2,
            "--tolerances is for dormand-prince",
        ),
        (
            &["--methods", "dormand-prince", "--steps", "1e-6"],
            2,
            "--steps is for a method",
        ),
        (
            &["--methods", "dormand-prince", "--tolerances", "2"],
            2,
            "at most 1",
        ),
        (
            &["--repeats", "0", "-o", "x"],
            2,
            "must be a whole number, 1 or more",
        ),
        (&["-o", "nowhere/bench"], 3, "nowhere/bench.csv"),
        (&[], 3, "--overwrite"),
    ];
    for (arguments, expected, words) in cases {
        let given = [&["bench", "spinning_ring", "--until", "1 ms"], arguments].concat();
        let (code, out, err) = run(at, &given);
        assert_eq!((code, out.as_str()), (expected, ""), "{arguments:?}: {err}");
        assert!(err.contains(words), "{arguments:?}: {err}");
    }
    let given = [
        "bench",
        "spinning_ring",
        "--until",
        "1 ms",
        "-o",
        "other",
        "--repeats",
        "1",
    ];
    let units = [
        "--methods",
        "verlet",
        "--steps",
        "20 us",
        "--onset-depth",
        "1 um",
    ];
    let (code, out, err) = run(at, &[&given[..], &units].concat());
    assert_eq!(code, 0, "{err}");
    assert!(
        out.contains("verlet, step 20 µs, onset depth 1e-6 m"),
        "{out}"
    );
}
