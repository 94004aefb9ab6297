//! The layers of every crate, from the ground up: a module names modules of lower layers only.

use std::collections::BTreeSet;

use super::{arrows, root};

/// A crate, its modules by layers from the ground up, and the arrows that point up all the same, each with its reason.
struct Storeys {
    folder: &'static str,
    layers: &'static [&'static [&'static str]],
    exceptions: &'static [(&'static str, &'static str, &'static str)],
}

const CRATES: [Storeys; 7] = [
    Storeys {
        folder: "mechanics",
        layers: &[
            &[
                "accounts",
                "applied",
                "dense",
                "energy",
                "error",
                "kinematics",
                "lanes",
            ],
            &["engagement", "order", "table"],
            &["action", "course", "shaft_loss", "speed_table", "watch"],
            &["force"],
            &[
                "articulation",
                "coupling",
                "motion",
                "profile",
                "tooth_stack",
                "strength",
                "surface",
                "tensioner",
                "tolerance",
            ],
            &["contact", "torque"],
            &["seam"],
            &["bodies"],
            &["joints"],
            &["chains"],
            &["drive"],
            &["alignment", "groups", "warming"],
            &["trains"],
            &["system"],
            &["events", "observe", "body_positions", "body_impacts"],
            &["check", "motion_conflicts"],
            &["assembly"],
            &["forcing", "inside", "modes", "twin_start", "pose"],
        ],
        exceptions: &[],
    },
    Storeys {
        folder: "chaindrive",
        layers: &[
            &[
                "clock",
                "figure",
                "laws",
                "terminal_text",
                "rainflow",
                "sheet",
                "stepping",
            ],
            &["identity"],
            &["net", "story"],
            &["catalogue", "design", "draw", "rating", "seal"],
            &["error", "scene"],
            &["channel", "interruptible"],
            &["event", "run", "zarr"],
            &["new_file", "simulate"],
            &["summary"],
            &["run_in"],
            &["precision"],
            &["chain_verdict", "plausibility", "statistic"],
            &["verdict"],
            &["describe"],
            &["page"],
            &["record"],
            &["execute"],
            &["sweep"],
        ],
        exceptions: &[],
    },
    Storeys {
        folder: "couple",
        layers: &[
            &["export", "fault", "signal", "variable"],
            &["ports"],
            &["model"],
            &["description", "instance"],
            &["package"],
        ],
        exceptions: &[],
    },
    Storeys {
        folder: "fmu",
        layers: &[
            &["logger", "pointers"],
            &["units"],
            &["calls"],
            &["states", "versions"],
            &["fmi3"],
            &["fmi2"],
            &["misuse"],
        ],
        exceptions: &[],
    },
    Storeys {
        folder: "cli",
        layers: &[
            &["failure", "suggested_values"],
            &["complaint", "csv", "progress", "request", "terminal"],
            &["answer", "stream"],
            &["commands"],
        ],
        exceptions: &[],
    },
    Storeys {
        folder: "python",
        layers: &[
            &["errors"],
            &[
                "cycles",
                "drawing",
                "kinematics",
                "law",
                "new_file",
                "signals",
                "unit",
            ],
            &["friction", "profile"],
            &["drive"],
            &["design", "run"],
            &["fmu", "lab", "live", "precision", "replay", "sweep"],
        ],
        exceptions: &[],
    },
    Storeys {
        folder: "wasm",
        layers: &[
            &["memory", "thrown"],
            &["drive", "library"],
            &["run", "simulation"],
            &["picture", "recorder"],
            &["film"],
        ],
        exceptions: &[],
    },
];

/// Whoever draws a new arrow upward meets this test: turn it round, or put the reason into the table. An exception that is no
/// longer needed must leave the table, so that it cannot come back unseen.
#[test]
fn modules_name_modules_of_lower_layers() {
    let mut problems = Vec::new();
    for Storeys {
        folder,
        layers,
        exceptions,
    } in CRATES
    {
        let layer_of = |module: &str| layers.iter().position(|layer| layer.contains(&module));
        let arrows = arrows::of(&root().join("crates").join(folder).join("src"));
        let mut upward = BTreeSet::new();
        for (from, uses) in &arrows {
            let Some(own) = layer_of(from) else {
                problems.push(format!("{folder}: `{from}` stands in no layer"));
                continue;
            };
            for to in uses {
                if layer_of(to).is_none_or(|layer| layer >= own) {
                    upward.insert((from.as_str(), to.as_str()));
                }
            }
        }
        let known: BTreeSet<_> = exceptions
            .iter()
            .map(|(from, to, _)| (*from, *to))
            .collect();
        for (from, to) in upward.difference(&known) {
            problems.push(format!("{folder}: `{from}` must not name `{to}`"));
        }
        for (from, to) in known.difference(&upward) {
            problems.push(format!(
                "{folder}: `{from}` no longer names `{to}`: strike the exception"
            ));
        }
        let named = layers.iter().flat_map(|layer| layer.iter());
        for absent in named.filter(|module| !arrows.contains_key(**module)) {
            problems.push(format!("{folder}: there is no module `{absent}`"));
        }
    }
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

/// The reader of arrows sees what imports look like: lists, nested lists, new names, `super`, re-exports; no comments and no tests.
#[test]
fn arrows_are_read_off_the_sources() {
    let folder = std::env::temp_dir().join(format!("chaindrive-arrows-{}", std::process::id()));
    let write = |name: &str, text: &str| {
        let path = folder.join(name);
        std::fs::create_dir_all(path.parent().expect("inside")).expect("a folder");
        std::fs::write(path, text).expect("a file");
    };
    write(
        "lib.rs",
        "mod a;\nmod b;\nmod c;\nmod d;\nmod e;\npub use b::{Bee, inner::Queen as Regent};\npub use d::Dee;\npub type Alias = u8;\n",
    );
    write(
        "a.rs",
        "use crate::{Alias, Regent,\n    c::{x, y}};\n// crate::e::Not\n#[cfg(test)]\nmod tests {\n    use crate::e::Neither;\n}\n",
    );
    write("a/deep.rs", "use super::super::d::Dee;\nuse super::own;\n");
    write(
        "b.rs",
        "fn f() { crate::c::g() }\n#[cfg(test)]\nmod tests;\nuse super::d;\n",
    );
    write("b/tests.rs", "use crate::e;\n");
    write("c/mod.rs", "use super::e;\n");
    write("d.rs", "");
    write("e.rs", "use crate::Dee;\n");
    let found = arrows::of(&folder);
    std::fs::remove_dir_all(&folder).expect("it was there");
    let expected = [
        ("a", vec!["b", "c", "d"]),
        ("b", vec!["c", "d"]),
        ("c", vec!["e"]),
        ("d", vec![]),
        ("e", vec!["d"]),
    ];
    let plain: Vec<(&str, Vec<&str>)> = found
        .iter()
        .map(|(from, uses)| (from.as_str(), uses.iter().map(String::as_str).collect()))
        .collect();
    assert_eq!(plain, expected);
}
