//! The examples run.

use std::collections::BTreeSet;
use std::fs;

use super::architecture::root;

macro_rules! examples {
    ($($name:ident = $path:literal;)*) => {
        $(
            #[path = $path]
            mod $name;

            #[test]
            fn $name() -> Result<(), Box<dyn std::error::Error>> {
                $name::main()
            }
        )*

        /// Examples that a test runs.
        const RUN: &[&str] = &[$(stringify!($name)),*];
    };
}

examples! {
    accuracy = "../../examples/accuracy.rs";
    controller = "../../examples/controller.rs";
    drawing = "../../examples/drawing.rs";
    embedding = "../../examples/embedding.rs";
    impacts = "../../examples/impacts.rs";
    layout = "../../examples/layout.rs";
    modes = "../../examples/modes.rs";
    snapshot = "../../examples/snapshot.rs";
    sweep = "../../examples/sweep.rs";
}

/// Two run by hand: they take longer.
const LONG: [&str; 2] = ["estimates", "marine_engine"];

#[test]
fn every_example_is_run_and_listed() {
    let root = root();
    let page = fs::read_to_string(root.join("docs/api/rust.md")).expect("the page");
    let folder = fs::read_dir(root.join("crates/chaindrive/examples")).expect("the examples");
    let files = folder.map(|entry| entry.expect("a file").path());
    let names: BTreeSet<String> = files
        .filter_map(|path| Some(path.file_stem()?.to_string_lossy().into_owned()))
        .collect();
    let known: BTreeSet<String> = RUN.iter().chain(&LONG).map(ToString::to_string).collect();
    assert_eq!(names, known);
    for name in names {
        assert!(
            page.contains(&format!("| `{name}` |")),
            "docs/api/rust.md: {name}"
        );
    }
}
