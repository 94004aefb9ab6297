//! Stores are a feature: without it nothing asks for their libraries, nor for a clock that a browser does not have.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::Command;

use super::{arrows, libraries, root, sources};

/// Libraries at most of `chaindrive` without stores, our own included.
const MOST: usize = 90;

/// Libraries of stores, threads and chance.
const OF_STORES: [&str; 10] = [
    "getrandom",
    "moka",
    "rayon",
    "rustix",
    "same-file",
    "sysinfo",
    "tempfile",
    "uuid",
    "zarrs",
    "zstd-sys",
];

/// Names of the libraries that a crate is compiled with on this system, its own among them.
fn compiled(selected: &[&str]) -> BTreeSet<String> {
    let told = libraries::tree(&[&["--edges", "normal"], selected].concat());
    let names = told.lines().filter_map(|it| it.split_whitespace().next());
    names.map(str::to_owned).collect()
}

/// Libraries of stores are part of the command, and of no core for browsers, replay or unit.
#[test]
fn libraries_of_stores_come_with_their_feature() {
    let core = compiled(&["--package", "chaindrive", "--no-default-features"]);
    assert!(core.len() <= MOST, "{} libraries: {core:?}", core.len());
    let of = |package: &str| compiled(&["--package", package]);
    let [replay, unit, command] =
        ["replay", "fmu", "cli"].map(|it| of(&format!("chaindrive-{it}")));
    for library in OF_STORES {
        let is_left_out = |names: &BTreeSet<String>| !names.contains(library);
        assert!(is_left_out(&core) && is_left_out(&replay), "{library}");
        // Couplings make identifiers of names, and pack units.
        let is_of_packages = ["getrandom", "uuid"].contains(&library);
        assert!(is_left_out(&unit) || is_of_packages, "{library}: {unit:?}");
        assert!(!is_left_out(&command), "{library}");
    }
}

/// The clock of the standard library panics in a browser: one file chooses, and all others ask there.
#[test]
fn one_file_asks_for_the_time() {
    let mut asking = Vec::new();
    for folder in ["chaindrive", "replay"] {
        let src = root().join("crates").join(folder).join("src");
        for path in sources(&src) {
            let code = arrows::code(&fs::read_to_string(&path).expect("sources are text"));
            let mut imports = code.split(';').filter(|it| it.contains("std::time"));
            if imports.any(|it| it.contains("Instant") || it.contains("SystemTime")) {
                asking.push(path.strip_prefix(&src).expect("inside").to_owned());
            }
        }
    }
    assert_eq!(asking, [Path::new("clock.rs")]);
}

/// The check is skipped without the target: `rustup target add wasm32-unknown-unknown` installs it.
#[test]
#[ignore = "compiles some eighty libraries; `make validation` runs it"]
fn the_core_compiles_for_browsers() {
    let target = "wasm32-unknown-unknown";
    let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let told = Command::new(rustc)
        .args(["--print", "target-libdir", "--target", target])
        .output()
        .expect("the compiler is there");
    let library = String::from_utf8(told.stdout).expect("the compiler writes UTF-8");
    if !Path::new(library.trim()).exists() {
        eprintln!("skipped: `rustup target add {target}` installs what this needs");
        return;
    }
    let checked = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
        .args(["check", "--profile", "quick", "--locked", "--quiet"])
        .args(["--package", "chaindrive", "--package", "chaindrive-replay"])
        .args(["--no-default-features", "--target", target])
        .current_dir(root())
        .output()
        .expect("Cargo, which runs the tests, is there");
    let problem = String::from_utf8_lossy(&checked.stderr);
    assert!(checked.status.success(), "{problem}");
}
