//! Scenes with several chains and shafts that do not go together: refused, with line, place and hint.
#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use chaindrive::scene::Scene;

/// The first problem of a text, as it is told.
fn problem(text: &str) -> String {
    let scene = Scene::from_toml(text, "test");
    let error = scene.and_then(|scene| scene.drive().map(drop)).unwrap_err();
    error.to_string()
}

#[test]
#[expect(clippy::too_many_lines, reason = "a table of refusals")]
fn what_does_not_go_together_is_refused() {
    let good = Scene::preset("two_stage_timing").unwrap().text().to_owned();
    let insert = |before: &str, text: &str| good.replacen(before, &format!("{text}{before}"), 1);
    let replaced = |from: &str, to: &str| {
        assert!(good.contains(from), "{from}");
        good.replacen(from, to, 1)
    };
    let cases = [
        (
            insert("[[chains]]", "[chain]\npitch = 0.008\nlinks = 8\n\n"),
            ["chains: `chain` is given too", "keep one of them"],
        ),
        (
            insert("[[sprockets]]", "[route]\npretension = 3\n\n"),
            [
                "route: several chains have no common route",
                "[chains.route]",
            ],
        ),
        (
            replaced("stops = [\"pinion\"", "stops = [\"intermediate\""),
            [
                "chains[1].route.stops[0]: `intermediate` is on the route of `primary` too",
                "put two of them on one of the `[[shafts]]`",
            ],
        ),
        (
            replaced("\"upper rail\", \"camshaft\"", "\"camshaft\""),
            [
                "guides[2].chain: missing: no route passes it",
                "primary, secondary",
            ],
        ),
        (
            replaced(
                "name = \"camshaft\"\n",
                "name = \"camshaft\"\nchain = \"primary\"\n",
            ),
            [
                "sprockets[3].chain: the route of `secondary` passes it",
                "secondary",
            ],
        ),
        (
            replaced(
                "name = \"camshaft\"\n",
                "name = \"camshaft\"\nchain = \"third\"\n",
            ),
            ["sprockets[3].chain: no chain is named `third`", "primary"],
        ),
        (
            replaced("name = \"secondary\"", "name = \"primary\""),
            ["chains[1].name: `primary` is taken", "names must differ"],
        ),
        (
            replaced("links = 84\n", "links = 84\npitches = [0.008]\n"),
            [
                "chains[1].pitches: 1 values, needed are 84",
                "one for every link",
            ],
        ),
        (
            replaced("mass = \"1.6 g\"", "mass = \"1.6 mm\""),
            ["chains[0].mass: `1.6 mm` is a length", "needed is a mass"],
        ),
        (
            replaced(
                "inertia = \"4e-5 kg m^2\"",
                "inertia = \"4e-5 kg m^2\"\nmotion = { kind = \"constant\", speed = 1 } #",
            ),
            [
                "sprockets[2].motion: `pinion` turns with shaft `intermediate shaft`",
                "give it to `shafts.intermediate shaft`",
            ],
        ),
        (
            replaced(
                "\"intermediate\", \"pinion\"]",
                "\"intermediate\", \"pinon\"]",
            ),
            [
                "shafts[0].sprockets[1]: no sprocket is named `pinon`",
                "did you mean `pinion`?",
            ],
        ),
        (
            insert(
                "[[guides]]",
                "[[shafts]]\nname = \"other\"\nsprockets = [\"pinion\"]\n",
            ),
            [
                "shafts[1].sprockets[0]: `pinion` sits on shaft `intermediate shaft` already",
                "a sprocket sits on one shaft",
            ],
        ),
        (
            replaced("name = \"intermediate shaft\"", "name = \"crank\""),
            ["shafts[0].name: `crank` is taken", "names must differ"],
        ),
        (
            insert(
                "[[guides]]",
                "[[gears]]\nname = \"g\"\nbetween = [\"crank\", \"camshft\"]\nteeth = [20, 40]\n",
            ),
            [
                "gears[0].between[1]: no shaft or sprocket is named `camshft`",
                "did you mean `camshaft`?",
            ],
        ),
        (
            insert(
                "[[guides]]",
                "[[gears]]\nname = \"g\"\nbetween = [\"crank\", \"camshaft\"]\nteeth = [20, 40]\n\
                 [[gears]]\nname = \"h\"\nbetween = [\"camshaft\", \"pinion\"]\nteeth = [20, 40]\n\
                 [[gears]]\nname = \"i\"\nbetween = [\"intermediate\", \"crank\"]\nteeth = [20, 40]\n",
            ),
            ["gears[2]: closes a loop of gears", "leave one pair out"],
        ),
        (
            insert(
                "[[guides]]",
                "[[shafts]]\nname = \"motor\"\nmotion = { kind = \"constant\", speed = 3 }\n\
                 [[gears]]\nname = \"g\"\nbetween = [\"motor\", \"crank\"]\nteeth = [20, 40]\n",
            ),
            [
                "gears[0]: joins two shafts whose motions are both given",
                "leave one motion out",
            ],
        ),
        (
            insert(
                "[[guides]]",
                "[[couplings]]\nname = \"c\"\nbetween = [\"pinion\", \"intermediate\"]\nstiffness = 3\n",
            ),
            ["couplings[0]: joins a shaft with itself", ""],
        ),
        (
            insert(
                "[[guides]]",
                "[[couplings]]\nname = \"c\"\nbetween = [\"pinion\", \"crank\"]\n",
            ),
            [
                "couplings[0]: joins nothing without stiffness and damping",
                "give one of them",
            ],
        ),
        (
            replaced(
                "name = \"pinion\"\nteeth = 20\ncentre = [\"40 mm\", \"201.5 mm\"]",
                "name = \"pinion\"\nteeth = 20\ncentre = [\"41 mm\", \"201.5 mm\"]",
            ),
            [
                "sprockets[2].centre: `intermediate` and `pinion` share a shaft and so must have the same centre",
                "gears join shafts that stand apart",
            ],
        ),
        (
            insert("[[guides]]", "[[shafts]]\nname = \"idle\"\n"),
            ["shafts[1].inertia: 0, must be positive", ""],
        ),
    ];
    for (text, fragments) in cases {
        let told = problem(&text);
        for fragment in fragments {
            assert!(told.contains(fragment), "`{fragment}` is not in:\n{told}");
        }
        // Every problem says its line.
        assert!(
            told.starts_with("test:") && told.as_bytes()[5].is_ascii_digit(),
            "{told}"
        );
    }
}

#[test]
fn one_chain_has_no_name() {
    let text = Scene::preset("bicycle").unwrap().text().to_owned();
    let told = problem(&text.replacen("teeth = 44", "chain = \"a\"\nteeth = 44", 1));
    assert!(
        told.contains("sprockets[0].chain: there is one chain only, and it has no name"),
        "{told}"
    );
}
