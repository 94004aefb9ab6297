//! The rules of `docs/architecture.md` that a machine can check.

mod arrows;
mod circles;
mod formulas;
mod layers;
mod libraries;
mod recipes;
mod stores;

use std::fs;
use std::path::{Path, PathBuf};

pub(super) fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let Ok(entries) = fs::read_dir(folder) else {
        return found;
    };
    for entry in entries.flatten() {
        let path = entry.path();
        if path.is_dir() {
            found.extend(sources(&path));
        } else if path.extension().is_some_and(|e| e == "rs" || e == "py") {
            found.push(path);
        }
    }
    found
}

fn project_files() -> Vec<PathBuf> {
    ["crates", "python", "tests", "examples"]
        .iter()
        .flat_map(|folder| sources(&root().join(folder)))
        .filter(|path| !path.components().any(|part| part.as_os_str() == "target"))
        .collect()
}

/// Which crates of the workspace each crate may name.
#[test]
fn arrows_point_down() {
    let allowed: [(&str, &[&str]); 12] = [
        ("validation", &[]),
        ("geometry", &[]),
        ("quantities", &[]),
        ("contact", &["quantities"]),
        ("integrate", &[]),
        (
            "mechanics",
            &["quantities", "geometry", "contact", "integrate"],
        ),
        (
            "chaindrive",
            &[
                "quantities",
                "geometry",
                "contact",
                "integrate",
                "mechanics",
            ],
        ),
        ("replay", &["geometry", "mechanics", "chaindrive"]),
        ("lab", &["replay"]),
        ("couple", &["mechanics", "chaindrive"]),
        ("fmu", &["couple"]),
        ("cli", &["chaindrive", "couple", "lab", "replay"]),
    ];
    // `validation` judges, so nothing but tests may ask for it: it stands in nobody's list.
    for (folder, may) in allowed {
        let manifest = fs::read_to_string(root().join("crates").join(folder).join("Cargo.toml"))
            .expect("every crate has a manifest");
        let dependencies = manifest
            .split("[dependencies]")
            .nth(1)
            .map_or("", |rest| rest.split("\n[").next().unwrap_or(rest));
        for line in dependencies.lines() {
            let Some(name) = line.split(['.', ' ', '=']).next() else {
                continue;
            };
            let short = match name {
                "chaindrive" => "chaindrive",
                _ => match name.strip_prefix("chaindrive-") {
                    Some(short) => short,
                    None => continue,
                },
            };
            assert!(may.contains(&short), "{folder} must not depend on {short}");
        }
    }
}

/// A row that a test compares by itself would be missing in the report.
#[test]
fn validation_cases_are_read_in_one_place() {
    let place = root().join("crates/validation");
    for path in sources(&root().join("crates")) {
        if path.starts_with(&place)
            || path == root().join("crates/chaindrive/tests/it/architecture.rs")
        {
            continue;
        }
        let text = fs::read_to_string(&path).expect("sources are text");
        assert!(
            !text.contains("reference.json") && !text.contains("tests/validation\""),
            "{} reads a validation case by itself: use `chaindrive_validation::Case`",
            path.display()
        );
    }
}

#[test]
fn parry_stays_in_its_adapter() {
    for path in sources(&root().join("crates")) {
        let text = fs::read_to_string(&path).expect("sources are text");
        let inside = path.components().any(|part| {
            let part = part.as_os_str().to_string_lossy();
            part.starts_with("parry") || part == "tests" || part == "benches"
        });
        assert!(
            inside || !text.contains("parry2d_f64::"),
            "{}",
            path.display()
        );
    }
}

#[test]
fn mechanics_reads_no_file_clock_or_chance() {
    for path in sources(&root().join("crates/mechanics/src")) {
        let text = fs::read_to_string(&path).expect("sources are text");
        let text = arrows::code(&text);
        for forbidden in [
            "std::fs",
            "std::time",
            "std::thread",
            "rand::",
            "println!",
            "static mut",
        ] {
            assert!(
                !text.contains(forbidden),
                "{} in {}",
                forbidden,
                path.display()
            );
        }
    }
}

/// A page that names a file which has moved leads nobody anywhere. `NAME` stands for a file to be written.
#[test]
fn files_that_pages_name_are_there() {
    let others = ["benchmarks", "docs"].map(|folder| sources(&root().join(folder)));
    let known: Vec<String> = project_files()
        .iter()
        .chain(others.iter().flatten())
        .map(|path| path.to_string_lossy().replace("/src/", "/"))
        .collect();
    let mut pages = vec![root().join("README.md"), root().join("CONTRIBUTING.md")];
    let docs = fs::read_dir(root().join("docs")).expect("there are pages");
    pages.extend(docs.flatten().map(|entry| entry.path()));
    pages.retain(|path| path.extension().is_some_and(|it| it == "md"));
    let mut named = 0;
    for page in pages {
        let text = fs::read_to_string(&page).expect("pages are text");
        for name in text.split('`').skip(1).step_by(2) {
            let is_source = [".rs", ".py"].iter().any(|end| name.ends_with(end));
            let is_path = name
                .chars()
                .all(|c| c.is_alphanumeric() || "/_.".contains(c));
            if !is_source || !is_path || name.contains("NAME") || !name.contains('/') {
                continue;
            }
            named += 1;
            let place = format!("/{}", name.replace("/src/", "/"));
            assert!(
                known.iter().any(|path| path.ends_with(&place)),
                "{} names `{name}`, which is not there",
                page.display()
            );
        }
    }
    assert!(named > 50, "only {named} files were found on the pages");
}

/// A method is asked for its step, tolerance and parameters; only its own table, the table of names and the usual variants of a study
/// tell methods apart.
#[test]
fn pairs_under_error_control_are_named_where_they_are_listed() {
    let listed = [
        "crates/integrate/src/method.rs",
        "crates/chaindrive/src/stepping.rs",
        "crates/chaindrive/src/precision/variant.rs",
    ];
    for folder in ["integrate", "mechanics", "chaindrive", "cli", "python"] {
        for path in sources(&root().join("crates").join(folder).join("src")) {
            let list = listed.iter().any(|list| path == root().join(list));
            if list || path.ends_with("tests.rs") {
                continue;
            }
            let text = fs::read_to_string(&path).expect("sources are text");
            assert!(
                !arrows::code(&text).contains("DormandPrince"),
                "{} names a method: ask it `is_adaptive`, `step` or `parameters`",
                path.display()
            );
        }
    }
}

/// The chains are a family: outside its folder and its table of contents nobody knows which members there are. Scenes have one place
/// that makes a member of what is written, and one that lists what may be written.
#[test]
fn no_member_of_the_chain_family_is_named_outside() {
    let inside = [
        "mechanics/src/chains",
        "mechanics/src/chains.rs",
        // What users of the crate describe chains with.
        "mechanics/src/lib.rs",
        "chaindrive/src/scene/resolve/links.rs",
        "chaindrive/src/scene/resolve/strands.rs",
        "chaindrive/src/scene/schema/links.rs",
        // The door of the schema.
        "chaindrive/src/scene/schema/mod.rs",
    ];
    let members = [
        "BushStrands",
        "Linkage",
        "Particles",
        "PointJoints",
        "RigidLinks",
        "RollerModel",
    ];
    let paths = [
        "ChainModel::",
        "chains::links",
        "chains::particles",
        "chains::points",
        "chains::strands",
    ];
    let crates = root().join("crates");
    let mut looked_at = 0;
    for part in [
        "mechanics",
        "chaindrive",
        "cli",
        "couple",
        "python",
        "replay",
    ] {
        for path in sources(&crates.join(part).join("src")) {
            let within = inside.iter().any(|it| path.starts_with(crates.join(it)));
            if within || path.ends_with("tests.rs") {
                continue;
            }
            looked_at += 1;
            let text = arrows::code(&fs::read_to_string(&path).expect("sources are text"));
            let mut words = text.split(|c: char| !(c.is_alphanumeric() || c == '_'));
            let path_of = paths.into_iter().find(|path| text.contains(path));
            let named = words.find(|word| members.contains(word)).or(path_of);
            assert!(
                named.is_none(),
                "{} in {}: ask the chain instead",
                named.unwrap_or_default(),
                path.display()
            );
        }
    }
    assert!(looked_at > 100, "few sources: {looked_at}");
}

/// Constants of a law, such as the factor of an exact dissipation that Newton's method finds, are worked out when a drive is built:
/// who asks a law for forces has prepared it in the same file.
#[test]
fn laws_are_prepared_before_they_are_asked() {
    let mut asking = 0;
    for path in sources(&root().join("crates/mechanics/src")) {
        let text = arrows::code(&fs::read_to_string(&path).expect("sources are text"));
        if path.ends_with("tests.rs") || !text.contains("Approach {") {
            continue;
        }
        asking += 1;
        let prepares = text.contains(".prepared()") && text.contains("Prepared");
        let at_once = text.contains("law.prepared().") || text.contains("surface.law.respond");
        assert!(prepares && !at_once, "{}", path.display());
    }
    assert!(asking > 0, "nobody asks a law, or not like this");
}

/// Chains borrow the bodies, never the system that holds them all.
#[test]
fn chains_do_not_know_the_system() {
    for path in sources(&root().join("crates/mechanics/src/chains")) {
        let text = fs::read_to_string(&path).expect("sources are text");
        let own = text.split("#[cfg(test)]").next().unwrap_or_default();
        let words = own
            .lines()
            .filter(|line| !line.trim_start().starts_with("//"))
            .flat_map(|line| line.split(|c: char| !c.is_alphanumeric() && c != '_'));
        let test = path.ends_with("tests.rs");
        let named = words.filter(|word| *word == "System").count();
        assert!(test || named == 0, "{}", path.display());
    }
}

#[test]
fn modules_open_with_a_line_and_fit_one_sitting() {
    let drawers = [
        "utils", "util", "common", "helpers", "helper", "misc", "manager",
    ];
    for path in project_files() {
        let text = fs::read_to_string(&path).expect("sources are text");
        let name = path
            .file_stem()
            .map(|s| s.to_string_lossy().into_owned())
            .unwrap_or_default();
        assert!(
            !drawers.contains(&name.as_str()),
            "{} is a drawer",
            path.display()
        );
        let lines = text.lines().count();
        assert!(lines <= 600, "{} has {lines} lines", path.display());
        if path.extension().is_some_and(|e| e == "rs") {
            assert!(
                text.starts_with("//!"),
                "{} does not say what it is",
                path.display()
            );
        }
    }
}
