//! Which libraries are a part of the identity of a build, and which features they have.

use std::collections::BTreeSet;
use std::process::Command;

use chaindrive::Build;

/// Libraries below the forces that carry numbers about and compute none.
const CARRIERS: &str = "aligned-vec allocator-api2 arrayvec bitflags bytemuck cfg-if downcast-rs dyn-clone either ena equator equivalent \
    foldhash hashbrown indexmap itoa log memchr num-integer pulp-wasm-simd-flag raw-cpuid rawpointer reborrow ref-cast safe_arch schemars serde \
    serde_core serde_json slab smallvec thiserror typenum zmij";

/// Libraries above the forces whose numbers get into results, or into the bytes of checkpoints.
const ABOVE: [&str; 2] = ["hdrhistogram", "postcard"];

/// What `cargo tree` tells of the workspace, a line a package.
pub(super) fn tree(arguments: &[&str]) -> String {
    let output = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
        .args(["tree", "--offline", "--locked", "--prefix", "none"])
        .arg("--manifest-path")
        .arg(super::root().join("Cargo.toml"))
        .args(arguments)
        .output()
        .expect("Cargo, which runs the tests, is there");
    let problem = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{problem}");
    String::from_utf8(output.stdout).expect("Cargo writes UTF-8")
}

/// Packages of a selection and their features, along the given kinds of dependencies, without the example of laws.
fn features(selected: &str, edges: &str) -> BTreeSet<String> {
    let how = ["--edges", edges, "--format", "{p} {f}"].into_iter();
    let told = tree(&how.chain(selected.split(' ')).collect::<Vec<_>>());
    let lines = told.lines().map(|line| line.trim_end_matches(" (*)"));
    let found: BTreeSet<String> = lines
        .filter(|line| !line.starts_with("own-laws "))
        .map(str::to_owned)
        .collect();
    assert!(found.len() > 100, "{found:?}");
    found
}

/// The example of laws asks nothing of a library that the others do not: otherwise the tests would compile it twice.
#[test]
fn the_example_of_laws_adds_no_feature() {
    let edges = "normal,build,dev";
    let with = features("--workspace", edges);
    let without = features("--workspace --exclude own-laws", edges);
    let more: Vec<_> = with.symmetric_difference(&without).collect();
    assert!(more.is_empty(), "{more:?}");
}

/// The tests reuse every crate of the installed package: both builds have the same features, down to the name `default`.
#[test]
fn tests_compile_nothing_again_that_is_installed() {
    let installed = features(
        "--package chaindrive-python --package chaindrive-fmu",
        "normal",
    );
    let here = features("--workspace", "normal,dev");
    let again: Vec<_> = installed.difference(&here).collect();
    assert!(again.is_empty(), "{again:?}");
}

/// A library that comes to the forces is either a part of the identity, or said to compute nothing.
#[test]
fn the_identity_names_all_libraries_that_compute() {
    let told = tree(&[
        "--edges",
        "normal,no-proc-macro",
        "--package",
        "chaindrive-mechanics",
    ]);
    let names = told
        .lines()
        .filter_map(|line| line.split_whitespace().next());
    let below: BTreeSet<&str> = names
        .filter(|name| !name.starts_with("chaindrive"))
        .collect();
    let libraries = Build::here().libraries.split(' ');
    let identity: BTreeSet<&str> = libraries.filter_map(|it| it.split('=').next()).collect();
    let carriers: BTreeSet<&str> = CARRIERS.split_whitespace().collect();
    assert!(identity.is_disjoint(&carriers));
    let known: BTreeSet<&str> = identity.union(&carriers).copied().collect();
    let expected: BTreeSet<&str> = below.iter().copied().chain(ABOVE).collect();
    assert_eq!(
        known, expected,
        "build.rs names those that compute, CARRIERS here the others"
    );
}
