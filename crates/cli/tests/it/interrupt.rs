//! A run that is stopped or killed leaves a result that can be read.
#![cfg(unix)]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Child;

use crate::command_line::{attributes, samples, signal, wait_for, words};

/// A run that would take hours, into `out` of a folder.
fn start(folder: &Path, out: &str) -> (Child, PathBuf) {
    let long = words("run spinning_ring --until 1e4 --every '1 ms' -o");
    let child = crate::command_line::start(folder, &[&long[..], &[out]].concat());
    (child, folder.join(out))
}

/// Waits until samples are committed, and returns how many.
fn wait_for_samples(store: &Path) -> u64 {
    wait_for("no sample was committed", || samples(store) > 0);
    samples(store)
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
            .contains("Maximum link tension, of any link")
    );
    assert_eq!(String::from_utf8(output.stderr).unwrap(), "interrupted\n");
    let about = attributes(&store);
    assert_eq!(about["status"], "interrupted");
    assert_eq!(about["complete"], 0);
    assert!(about["samples"].as_u64().unwrap() >= seen);
}

/// The note on a long run stands in the JSON answer, and nowhere with `--quiet`.
#[test]
fn notes_do_not_stand_beside_errors() {
    let folder = tempfile::tempdir().unwrap();
    for (option, told) in [("--json", true), ("--quiet", false)] {
        let store = folder.path().join(option).with_extension("zarr");
        let line = format!("run spinning_ring --until 1e6 --every 0.1s --no-error {option} -o");
        let arguments = [&words(&line)[..], &[store.to_str().unwrap()]].concat();
        let child = crate::command_line::start(folder.path(), &arguments);
        wait_for_samples(&store);
        signal(&child, "-INT");
        let output = child.wait_with_output().unwrap();
        let err = String::from_utf8(output.stderr).unwrap();
        assert!(!err.contains("note:"), "{err}");
        let out = String::from_utf8(output.stdout).unwrap();
        assert_eq!(out.contains("note: the run will take about"), told, "{out}");
    }
}

#[test]
fn interrupted_it_closes_the_table() {
    let folder = tempfile::tempdir().unwrap();
    let (child, table) = start(folder.path(), "long.csv");
    wait_for("no row was written", || {
        fs::metadata(&table).is_ok_and(|file| file.len() > 0)
    });
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
