//! A program of tests that runs itself again.

use std::env;
use std::process::Command;

/// Runs other tests of this program again, with each value of a variable of the environment: those whose names contain one of `only`, or all,
/// if that is empty, and `but` not.
///
/// # Panics
/// If one of them fails, or none is run.
pub fn run_again<'a>(
    only: &[&str],
    but: &str,
    variable: &str,
    values: impl IntoIterator<Item = &'a str>,
) {
    for value in values {
        run_once(only, but, variable, value);
    }
}

fn run_once(only: &[&str], but: &str, variable: &str, value: &str) {
    let program = env::current_exe().expect("a test is a program");
    let again = Command::new(program)
        .env(variable, value)
        .args(only)
        .args(["--skip", but])
        .output()
        .expect("what runs here can be run");
    let told = String::from_utf8_lossy(&again.stdout);
    assert!(again.status.success(), "{variable}={value}: {told}");
    assert!(
        told.contains("test result: ok."),
        "{variable}={value}: {told}"
    );
    assert!(!told.contains(" 0 passed"), "{variable}={value}: {told}");
}
