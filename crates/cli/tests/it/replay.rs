//! `chaindrive replay`: pages of results, and what it refuses.
#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use std::fs;
use std::path::Path;
use std::process::Command;

/// Runs the command and returns exit code and stderr.
fn run(folder: &Path, arguments: &[&str]) -> (i32, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_chaindrive"));
    let output = command
        .current_dir(folder)
        .args(arguments)
        .output()
        .unwrap();
    let told = String::from_utf8(output.stderr).unwrap();
    (output.status.code().unwrap(), told)
}

#[test]
fn a_result_becomes_a_page_once() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let short = [
        "run",
        "spinning_ring",
        "--until",
        "5 ms",
        "--no-error",
        "-q",
    ];
    let (code, told) = run(at, &[&short[..], &["-o", "ring.zarr"]].concat());
    assert_eq!(code, 0, "{told}");

    let (code, told) = run(at, &["replay", "ring.zarr"]);
    assert_eq!(code, 0, "{told}");
    assert!(
        told.starts_with("ring.html: 51 frames, every sample"),
        "{told}"
    );
    let page = fs::read_to_string(at.join("ring.html")).unwrap();
    assert!(page.starts_with("<!DOCTYPE html>") && page.trim_end().ends_with("</html>"));
    assert!(!page.contains("{{"), "nothing is left to fill in");

    let (code, told) = run(at, &["replay", "ring.zarr"]);
    assert_eq!(code, 3);
    assert!(told.contains("pass --overwrite"), "{told}");
    let (code, _) = run(at, &["replay", "ring.zarr", "--overwrite", "-q"]);
    assert_eq!(code, 0);
}

/// The movie's whereabouts, the channels to record, and results that are none.
#[test]
fn refusals_say_what_to_try() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let short = [
        "run",
        "spinning_ring",
        "--until",
        "1 ms",
        "--no-error",
        "-q",
    ];
    let still = ["--record", "energy_kinetic", "-o", "still.zarr"];
    assert_eq!(run(at, &[&short[..], &still].concat()).0, 0);
    for (arguments, code, hint) in [
        (&["still.zarr"][..], 2, "--record roller_x,roller_y"),
        (
            &["still.zarr", "--mp4"],
            2,
            "pip install 'chaindrive[movie]'",
        ),
        (
            &["still.zarr", "-o", "x.gif"],
            2,
            "pip install 'chaindrive[movie]'",
        ),
        (&["still.zarr", "-o", "x.pdf"], 2, "must end in .html"),
        (&["still.zarr", "--frames", "0"], 2, "1 or more"),
        (&["gone.zarr"], 2, "nothing of this name"),
        (&[".", "-o", "x.html"], 2, "not a result of chaindrive"),
    ] {
        let (found, told) = run(at, &[&["replay"], arguments].concat());
        assert!(
            found == code && told.contains(hint),
            "{arguments:?}: {found}, {told}"
        );
    }
    assert!(!at.join("still.html").exists());
}
