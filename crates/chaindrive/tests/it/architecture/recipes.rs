//! The cost of one more member of a family, counted for a specimen: the files of code that name it.

use std::collections::BTreeSet;
use std::fs;

use super::{arrows, root, sources};

/// A family of `docs/extending.md`, words by which code names a specimen of it, the folder that is the specimen's own, and the files that name it
/// outside of that.
struct Recipe {
    family: &'static str,
    words: &'static [&'static str],
    own: &'static str,
    files: &'static [&'static str],
}

const RECIPES: [Recipe; 7] = [
    Recipe {
        family: "elastic law",
        words: &["Radzimovsky"],
        own: "",
        files: &[
            "contact/src/elastic/mod.rs",
            "contact/src/elastic/radzimovsky.rs",
        ],
    },
    Recipe {
        family: "friction law",
        words: &["Threlfall"],
        own: "",
        files: &[
            "contact/src/friction/mod.rs",
            "contact/src/friction/threlfall.rs",
        ],
    },
    Recipe {
        family: "Runge–Kutta pair",
        words: &["DormandPrince", "DORMAND_PRINCE"],
        own: "",
        files: &[
            "chaindrive/src/precision/variant.rs",
            "chaindrive/src/stepping.rs",
            "integrate/src/method.rs",
            "integrate/src/tableau.rs",
        ],
    },
    Recipe {
        family: "tensioner push",
        words: &["Hydraulic"],
        own: "",
        files: &[
            "chaindrive/src/scene/resolve/tensioner.rs",
            "mechanics/src/tensioner/pushes.rs",
            "mechanics/src/tensioner/pushes/hydraulic.rs",
        ],
    },
    Recipe {
        family: "tensioner carrier",
        words: &["Slider"],
        own: "",
        files: &[
            // Two of them for the key `adjust` of routes, which takes up length by a slider.
            "chaindrive/src/scene/resolve/route.rs",
            "chaindrive/src/scene/schema/route.rs",
            "mechanics/src/tensioner/carriers.rs",
            "mechanics/src/tensioner/carriers/slider.rs",
        ],
    },
    Recipe {
        family: "chain model",
        words: &["RigidLinks", "Rigid", "IdealJoints"],
        own: "mechanics/src/chains/links",
        files: &[
            "chaindrive/src/scene/resolve/links.rs",
            "chaindrive/src/scene/schema/links.rs",
            "mechanics/src/chains.rs",
            "mechanics/src/chains/model.rs",
        ],
    },
    Recipe {
        family: "channel",
        words: &["OilPressure", "oil_pressure"],
        own: "",
        files: &[
            "chaindrive/src/channel.rs",
            "mechanics/src/observe.rs",
            "mechanics/src/seam/observation.rs",
        ],
    },
];

/// Whoever makes a member cost more files, or fewer, changes the list here and the count in `docs/extending.md`.
#[test]
fn a_member_costs_the_files_that_its_recipe_says() {
    let crates = root().join("crates");
    let page = fs::read_to_string(root().join("docs/extending.md")).expect("the page of recipes");
    let mut code = Vec::new();
    for folder in fs::read_dir(&crates).expect("the crates") {
        for path in sources(&folder.expect("a crate").path().join("src")) {
            let inside = path.strip_prefix(&crates).expect("a source of a crate");
            let name = inside.to_string_lossy().replace('\\', "/");
            if !name.ends_with("tests.rs") && !name.contains("/validation_") {
                let text = fs::read_to_string(&path).expect("sources are text");
                code.push((name, arrows::code(&text)));
            }
        }
    }
    let mut problems = Vec::new();
    for Recipe {
        family,
        words,
        own,
        files,
    } in RECIPES
    {
        let names = |text: &str| {
            let mut found = text.split(|c: char| !(c.is_alphanumeric() || c == '_'));
            found.any(|word| words.contains(&word))
        };
        let outside = |name: &str| own.is_empty() || !name.starts_with(own);
        let naming = code
            .iter()
            .filter(|(name, text)| outside(name) && names(text));
        let found: BTreeSet<&str> = naming.map(|(name, _)| name.as_str()).collect();
        let known: BTreeSet<&str> = files.iter().copied().collect();
        for new in found.difference(&known) {
            problems.push(format!("{family}: {new} names {words:?} too"));
        }
        for gone in known.difference(&found) {
            problems.push(format!("{family}: {gone} does not name {words:?} any more"));
        }
        let folder = if own.is_empty() { "" } else { "its folder + " };
        let row = format!("| {family} | {folder}{} |", found.len());
        if !page.contains(&row) {
            problems.push(format!(
                "docs/extending.md lacks the row that begins `{row}`"
            ));
        }
    }
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}
