//! `chaindrive bench`: what it prints and saves, what it refuses.

use std::fs;

use crate::command_line::{folder, run, words};

#[test]
fn the_bench_prints_a_table_and_saves_it() {
    let folder = folder();
    let at = folder.path();
    let short = words("bench spinning_ring --until '5 ms' --repeats 1");
    let methods = words("--methods verlet,rk4,generalized-alpha --steps 4e-5,2e-5");
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
    let cases = [
        (
            "--methods verlet --steps 0",
            2,
            "--steps: 0, must be positive",
        ),
        (
            "--methods verlet --steps '1 us,2 kg'",
            2,
            "--steps: `2 kg` is a mass",
        ),
        (
            "--methods verlet --steps 1e-300 -o x",
            2,
            "step = 1e-300, must be at least",
        ),
        ("--methods rk4 --onset-depth x", 2, "--onset-depth: `x`"),
        (
            "--methods verlet --tolerances 1e-6",
            2,
            "--tolerances is for dormand-prince",
        ),
        (
            "--methods dormand-prince --steps 1e-6",
            2,
            "--steps is for a method",
        ),
        ("--methods dormand-prince --tolerances 2", 2, "at most 1"),
        ("--repeats 0 -o x", 2, "must be a whole number, 1 or more"),
        (
            "-o work-precision.csv/bench",
            3,
            "choose a place in a folder",
        ),
        ("", 3, "--overwrite"),
    ];
    for (arguments, expected, told) in cases {
        let line = format!("bench spinning_ring --until 1ms {arguments}");
        let (code, out, err) = run(at, &words(&line));
        assert_eq!((code, out.as_str()), (expected, ""), "{line}: {err}");
        assert!(err.contains(told), "{line}: {err}");
    }
    let given = words("bench spinning_ring --until '1 ms' -o other --repeats 1");
    let units = words("--methods verlet --steps '20 us' --onset-depth '1 um'");
    let (code, out, err) = run(at, &[&given[..], &units].concat());
    assert_eq!(code, 0, "{err}");
    assert!(
        out.contains("verlet, step 20 µs, onset depth 1e-6 m"),
        "{out}"
    );
}
