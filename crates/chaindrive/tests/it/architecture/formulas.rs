//! The index of formulas in `docs/physics.md` against the sources.

use std::fs;

use super::root;

/// Every row of the index names a file that has its formula. Whoever moves or rewrites one meets this test.
#[test]
fn formulas_stand_where_the_index_says() {
    let page = fs::read_to_string(root().join("docs/physics.md")).expect("the page of physics");
    let (_, index) = page
        .split_once("## Where each formula stands")
        .expect("the index");
    let rows = index.lines().filter(|line| line.contains(".rs` |"));
    let mut found = 0;
    for row in rows {
        // | what | `formula` | `file` |
        let mut spans = row.split('`').skip(1).step_by(2);
        let (Some(formula), Some(file)) = (spans.next(), spans.next()) else {
            panic!("a row of the index has a formula and a file: {row}");
        };
        let formula = formula.replace(r"\|", "|");
        let source = fs::read_to_string(root().join("crates").join(file))
            .unwrap_or_else(|error| panic!("{file}: {error}"));
        assert!(source.contains(&formula), "{file} lacks {formula}");
        found += 1;
    }
    assert!(found > 50, "few formulas: {found}");
}
