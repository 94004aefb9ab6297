//! Which libraries are a part of the identity of a build.

use std::collections::BTreeSet;
use std::process::Command;

use chaindrive::Build;

/// Libraries below the forces that carry numbers about and compute none.
const CARRIERS: &str = "aligned-vec allocator-api2 arrayvec bitflags bytemuck cfg-if downcast-rs dyn-clone either ena equator equivalent \
    foldhash hashbrown indexmap itoa log memchr num-integer pulp-wasm-simd-flag raw-cpuid rawpointer reborrow ref-cast safe_arch schemars serde \
    serde_core serde_json slab smallvec thiserror typenum zmij";

/// Libraries above the forces whose numbers get into results, or into the bytes of checkpoints.
const ABOVE: [&str; 2] = ["hdrhistogram", "postcard"];

/// A library that comes to the forces is either a part of the identity, or said to compute nothing.
#[test]
fn the_identity_names_all_libraries_that_compute() {
    let manifest = super::root().join("Cargo.toml");
    let mut tree = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    tree.args([
        "tree",
        "--offline",
        "--locked",
        "--prefix",
        "none",
        "--manifest-path",
    ]);
    tree.arg(manifest);
    tree.args([
        "--edges",
        "normal,no-proc-macro",
        "--package",
        "chaindrive-mechanics",
    ]);
    let told = tree.output().unwrap();
    assert!(
        told.status.success(),
        "{}",
        String::from_utf8_lossy(&told.stderr)
    );
    let told = String::from_utf8(told.stdout).unwrap();
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
