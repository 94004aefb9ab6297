//! A run that is stopped or killed leaves a result that can be read.
#![cfg(unix)]
#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// A run that would take hours, into `out` of a folder.
fn start(folder: &Path, out: &str) -> (Child, PathBuf) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_chaindrive"));
    command
        .current_dir(folder)
        .args([
            "run",
            "spinning_ring",
            "--until",
            "1e4",
            "--every",
            "1 ms",
            "-o",
            out,
        ])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    (command.spawn().unwrap(), folder.join(out))
}

fn signal(child: &Child, name: &str) {
    let sent = Command::new("kill")
        .args([name, &child.id().to_string()])
        .status()
        .unwrap();
    assert!(sent.success());
}

fn attributes(store: &Path) -> Option<serde_json::Value> {
    let text = fs::read(store.join("zarr.json")).ok()?;
    // Whenever one looks, the document is whole.
    let group: serde_json::Value = serde_json::from_slice(&text).unwrap();
    Some(group["attributes"].clone())
}

/// Waits until samples are committed, and returns how many.
fn wait_for_samples(store: &Path) -> u64 {
    let begin = Instant::now();
    loop {
        let samples = attributes(store)
            .and_then(|a| a["samples"].as_u64())
            .unwrap_or(0);
        if samples > 0 {
            return samples;
        }
        assert!(
            begin.elapsed() < Duration::from_mins(1),
            "no sample was committed"
        );
        sleep(Duration::from_millis(20));
    }
}

#[test]
fn interrupted_it_ends_the_result_and_the_summary() {
    let folder = tempfile::tempdir().unwrap();
    let (child, store) = start(folder.path(), "long.zarr");
    let seen = wait_for_samples(&store);
    signal(&child, "-INT");
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130));
    assert!(
        String::from_utf8(output.stdout)
            .unwrap()
            .contains("The hardest pulled link")
    );
    assert_eq!(String::from_utf8(output.stderr).unwrap(), "interrupted\n");
    let attributes = attributes(&store).unwrap();
    assert_eq!(attributes["status"], "interrupted");
    assert_eq!(attributes["complete"], 0);
    assert!(attributes["samples"].as_u64().unwrap() >= seen);
}

#[test]
fn interrupted_it_closes_the_table() {
    let folder = tempfile::tempdir().unwrap();
    let (child, table) = start(folder.path(), "long.csv");
    let begin = Instant::now();
    while !fs::metadata(&table).is_ok_and(|file| file.len() > 0) {
        assert!(
            begin.elapsed() < Duration::from_mins(1),
            "no row was written"
        );
        sleep(Duration::from_millis(20));
    }
    signal(&child, "-INT");
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130));
    let text = fs::read_to_string(&table).unwrap();
    assert_eq!(text.lines().last(), Some("# incomplete: interrupted"));
}

#[test]
fn killed_it_leaves_what_was_committed() {
    let folder = tempfile::tempdir().unwrap();
    let (mut child, store) = start(folder.path(), "long.zarr");
    let seen = wait_for_samples(&store);
    child.kill().unwrap();
    child.wait().unwrap();
    let group: serde_json::Value =
        serde_json::from_slice(&fs::read(store.join("zarr.json")).unwrap()).unwrap();
    assert_eq!(group["attributes"]["status"], "running");
    let samples = group["attributes"]["samples"].as_u64().unwrap();
    assert!(samples >= seen);
    let arrays = group["consolidated_metadata"]["metadata"]
        .as_object()
        .unwrap();
    for (name, array) in arrays {
        if array["dimension_names"][0] == "time" {
            assert_eq!(array["shape"][0], samples, "{name}");
        }
    }
}
