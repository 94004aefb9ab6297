//! The command as a shell runs it, and what it leaves on disk.
#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use std::fs;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::Value;

/// Words of a line: spaces part them, single quotes hold them together.
pub(crate) fn words(line: &str) -> Vec<&str> {
    let parts = line.split('\'').enumerate();
    let words = parts.flat_map(|(k, part)| match k % 2 {
        0 => part.split_whitespace().collect(),
        _ => vec![part],
    });
    words.collect()
}

pub(crate) fn folder() -> tempfile::TempDir {
    tempfile::tempdir().unwrap()
}

pub(crate) fn chaindrive(at: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_chaindrive"));
    command.current_dir(at).args(arguments);
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

/// Exit code, stdout and stderr; of a process that was killed the code is −1.
pub(crate) fn told(output: Output) -> (i32, String, String) {
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    let code = output.status.code().unwrap_or(-1);
    (code, text(output.stdout), text(output.stderr))
}

/// Runs the command to its end.
pub(crate) fn run(at: &Path, arguments: &[&str]) -> (i32, String, String) {
    told(chaindrive(at, arguments).output().unwrap())
}

/// Exit code of a run to its end, and what was said on stderr.
pub(crate) fn answer(at: &Path, arguments: &[&str]) -> (i32, String) {
    let (code, _, err) = run(at, arguments);
    (code, err)
}

/// The same of a process that was started.
pub(crate) fn ended(child: Child) -> (i32, String) {
    let (code, _, err) = told(child.wait_with_output().unwrap());
    (code, err)
}

pub(crate) fn start(at: &Path, arguments: &[&str]) -> Child {
    chaindrive(at, arguments).spawn().unwrap()
}

pub(crate) fn signal(child: &Child, name: &str) {
    let id = child.id().to_string();
    let sent = Command::new("kill").args([name, &id]).status();
    assert!(sent.unwrap().success());
}

pub(crate) fn wait_for(what: &str, mut done: impl FnMut() -> bool) {
    let begin = Instant::now();
    while !done() {
        assert!(begin.elapsed() < Duration::from_mins(1), "{what}");
        sleep(Duration::from_millis(2));
    }
}

/// The group document of a store, as soon as there is one: whenever one looks, it is whole.
pub(crate) fn group(store: &Path) -> Option<Value> {
    let text = fs::read(store.join("zarr.json")).ok()?;
    Some(serde_json::from_slice(&text).unwrap())
}

pub(crate) fn attributes(store: &Path) -> Value {
    group(store).unwrap()["attributes"].clone()
}

/// Samples that a store holds so far.
pub(crate) fn samples(store: &Path) -> u64 {
    let held = |group: Value| group["attributes"]["samples"].as_u64();
    group(store).and_then(held).unwrap_or(0)
}
