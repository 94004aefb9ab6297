//! Texts and paths that are too deep, too long or wrong a thousand times: refused soon, and in few words.
#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use std::fmt::Write as _;
use std::io::Read;
use std::time::{Duration, Instant};

use chaindrive::scene::{Scene, SceneError};

fn ring() -> Scene {
    Scene::preset("spinning_ring").unwrap()
}

#[track_caller]
fn too_deep<T: std::fmt::Debug>(result: Result<T, SceneError>) {
    let message = result.unwrap_err().to_string();
    assert!(message.contains("nested deeper than"), "{message}");
    assert!(message.len() < 300, "{message}");
}

#[test]
fn deep_paths_and_texts_are_refused_before_they_are_built() {
    let deep = "a.".repeat(15_000);
    let json = Scene::from_json(
        r#"{"chain": {"pitch": 0.01, "links": 8, "mass": 0.01, "stiffness": 1e6, "start": "ring"}}"#,
        "ring.json",
    );
    for scene in [ring(), json.unwrap()] {
        too_deep(scene.replace(&format!("chain.{deep}x"), "1"));
        too_deep(scene.replace(&format!("sprockets{}", "[0]".repeat(15_000)), "1"));
        too_deep(scene.replace_json(&format!("chain.{deep}x"), &1.into()));
        too_deep(scene.replace("chain.links", &format!("{{ {deep}x = 1 }}")));
        too_deep(scene.replace("gravity", &("[".repeat(15_000) + &"]".repeat(15_000))));
        assert!(scene.without(&format!("chain.{deep}x")).is_ok());
        assert_eq!(scene.datum(&format!("chain.{deep}x")), None);
    }
    too_deep(Scene::from_toml(&format!("chain.{deep}x = 1"), "deep"));
    too_deep(Scene::from_toml(&format!("[chain.{deep}x]"), "deep"));
    too_deep(Scene::from_text(
        &(r#"{"chain": "#.to_owned() + &"[".repeat(15_000)),
        "deep",
    ));
}

#[test]
fn the_number_of_problems_told_is_bounded_and_the_rest_is_counted() {
    let mut text = String::new();
    for key in 0..100_000 {
        writeln!(text, "a{key} = 1").unwrap();
    }
    let start = Instant::now();
    let error = Scene::from_toml(&text, "keys").unwrap_err();
    // Quadratic in the keys it took minutes.
    assert!(start.elapsed() < Duration::from_secs(10));
    assert_eq!((error.problems.len(), error.omitted), (100, 99_901));
    let message = error.to_string();
    assert_eq!(message.lines().count(), 11);
    assert!(
        message.ends_with("keys: and 99991 more problems"),
        "{}",
        message.lines().last().unwrap()
    );
}

/// Defect: 56 kB for a hundred keys.
#[test]
fn many_unknown_keys_are_told_in_few_words() {
    let keys = |count: usize| (0..count).map(|key| format!("zq{key} = 1"));
    let lines = keys(100).collect::<Vec<_>>().join("\n");
    let one_line = keys(200_000).collect::<Vec<_>>().join(", ");
    for text in [
        lines.clone(),
        format!("[chain]\n{lines}"),
        format!("chain = {{ {one_line} }}"),
    ] {
        let error = Scene::from_toml(&text, "keys").unwrap_err();
        let message = format!("{error:#}");
        assert!(message.len() < 4000, "{}:\n{message}", message.len());
        assert!(error.to_string().len() < 2000, "{error}");
        assert!(
            message.contains("zq0: unknown key; known are "),
            "{message}"
        );
    }
}

#[test]
fn equal_names_are_found_in_linear_time() {
    let sprockets = |count: usize| {
        let one = "[[sprockets]]\nname = 's'\nteeth = 20\ncentre = [0, 0]\ninertia = 1\n";
        format!("chain = '16B-1'\n{}", one.repeat(count))
    };
    let error = Scene::from_toml(&sprockets(900), "equal").unwrap();
    let error = error.drive().unwrap_err();
    assert!(error.problems[0].message.contains("is taken"), "{error}");
    assert!(error.problems.len() <= 100 && error.omitted >= 799);
    let error = Scene::from_toml(&sprockets(20_000), "many").unwrap_err();
    assert!(
        error.to_string().contains("20000 values, at most 1000"),
        "{error}"
    );
}

/// Sixteen megabytes of zeros took 3.6 GB.
#[test]
fn a_list_of_millions_is_refused_before_it_is_built() {
    let zeros = "0,".repeat(4_000_000);
    for text in [
        format!("gravity = [{zeros}0]"),
        format!("{{\"gravity\": [{zeros}0]}}"),
    ] {
        let error = Scene::from_text(&text, "zeros").unwrap_err();
        assert!(
            error.to_string().contains("more than 1000000 values"),
            "{error}"
        );
    }
    let error = Scene::from_text(&format!("gravity = [{}0]", "0,".repeat(1000)), "zeros");
    let error = error.unwrap_err();
    assert!(
        error.to_string().contains("1001 values, needed are 2"),
        "{error}"
    );
}

#[test]
fn a_source_that_never_ends_is_refused() {
    for source in [b'#', b'\n', 0xff] {
        let error = Scene::read_from(std::io::repeat(source), "stdin").unwrap_err();
        assert!(error.to_string().contains("larger than 16 MiB"), "{error}");
    }
    let text = ring().text().to_owned();
    let read = Scene::read_from(text.as_bytes().take(1 << 20), "stdin").unwrap();
    assert_eq!(read.text(), text);
}

#[track_caller]
fn told(text: &str, words: &[&str]) {
    let error = Scene::from_toml(text, "text").and_then(|scene| scene.drive());
    let error = error.unwrap_err().to_string();
    for words in words {
        assert!(error.contains(words), "{words}:\n{error}");
    }
}

/// The number of links follows from the route, and what is wrong with the route is told, not that they are missing.
#[test]
fn links_that_cannot_be_counted_do_not_hide_the_reason() {
    let scene = |b: &str, more: &str| {
        format!(
            "chain = '16B-1'\n[[sprockets]]\nname = 'a'\nteeth = 19\ncentre = [0, 0]\nmotion = 'held'\n\
             [[sprockets]]\nname = 'b'\nteeth = 57\ninertia = 1\n{b}\n{more}"
        )
    };
    told(
        &scene("centre = [0.2, 0]", ""),
        &["sprockets[1].centre: overlaps sprocket `a`"],
    );
    told(
        &scene("centre = [1, 0]", "[route]\nstops = ['a', 'c']"),
        &["route.stops[1]: no sprocket or guide is named `c`"],
    );
    told(
        &scene("centre = [1, 0]", "[route]\nstops = ['a']"),
        &["route.stops: 1 stops, but a closed chain has at least two"],
    );
    told(
        &scene("centre = [1, 0]\nside = 'right'", ""),
        &[
            "chain.links: missing; the taut chain turns",
            "at `b` it would wrap",
        ],
    );
    told(
        &scene(
            "centre = [1, 0]\nsupport = { kind = 'tensioner', name = 'x' }",
            "",
        ),
        &["no tensioner is named `x`"],
    );
    told(
        &scene("centre = [1, 0]\nteath = 3", ""),
        &["sprockets[1].teath: unknown key"],
    );
}

/// A chain that nothing tightens is not too short, so that no link is stretched.
#[test]
fn the_number_of_links_found_is_enough() {
    let mut refused = 0;
    for tenth_of_pitch in 0..40 {
        let distance = 1.0 + 2.54e-3 * f64::from(tenth_of_pitch);
        let text = format!(
            "chain = '16B-1'\nsettle = false\n[[sprockets]]\nname = 'a'\nteeth = 19\ncentre = [0, 0]\nmotion = 'held'\n\
             [[sprockets]]\nname = 'b'\nteeth = 21\ninertia = 1\ncentre = [{distance:?}, 0]"
        );
        let drive = match Scene::from_toml(&text, "text").unwrap().drive() {
            Ok(drive) => drive,
            Err(error) => {
                let error = error.to_string();
                assert!(error.contains("links are too few and"), "{error}");
                refused += 1;
                continue;
            }
        };
        let fitting = drive.assemble().unwrap().fittings.remove(0).unwrap();
        assert!(fitting.strain < 2e-4, "{distance} m: {}", fitting.strain);
        assert!(drive.chains[0].chain.links().is_multiple_of(2));
    }
    assert!((15..=27).contains(&refused), "{refused}");
}

#[test]
fn messages_name_sprockets_and_are_english() {
    let text = Scene::preset("industrial_16b").unwrap();
    let apart = text.replace("sprockets[1].side", "right").unwrap();
    let error = apart.drive().unwrap().assemble().unwrap_err().to_string();
    assert!(!error.contains("wheel "), "{error}");
    assert!(error.contains("at `"), "{error}");
    told("title = 'x'", &["chain: missing; give the chain"]);
    told(
        "[chain]\nlinks = 3\npitch = 1\n[[tensioners]]\nname = 'x'",
        &[
            "tensioners[0].carrier: missing; say how it moves",
            "tensioners[0].push: missing; give its push",
        ],
    );
    let error = Scene::read("marine_engine.toml").unwrap_err().to_string();
    assert!(
        error.contains("`marine_engine` is an embedded scene"),
        "{error}"
    );
    let error = Scene::read("nowhere/at_all.toml").unwrap_err().to_string();
    assert!(error.contains("`chaindrive scenes` lists"), "{error}");
}

/// Two sprockets and a chain by its words.
fn around_two(chain: &str) -> String {
    format!(
        "{chain}\n[[sprockets]]\nname = 'a'\nteeth = 19\ncentre = [0, 0]\nmotion = 'held'\n\
         [[sprockets]]\nname = 'b'\nteeth = 57\ninertia = 1\ncentre = [1.029929958, 0]\n"
    )
}

#[test]
fn an_unknown_chain_is_told_with_all_other_mistakes() {
    let unknown = "no chain of the catalogue is named `16C-1`; did you mean `16B-1`?";
    // Beside words that are none.
    let misspelt = around_two("chain = '16C-1'").replace("teeth = 57", "teath = 57");
    told(&misspelt, &[unknown, "sprockets[1].teath: unknown key"]);
    // Beside parts that do not go together.
    let mut scene = around_two("chain = '16C-1'");
    scene += "[route]\nstops = ['a', 'c']\n";
    told(&scene, &[unknown, "no sprocket or guide is named `c`"]);
    // Alone it is the only one, whatever the other chain would bring about.
    let error = Scene::from_text(&around_two("chain = '16C-1'"), "test")
        .unwrap()
        .drive()
        .unwrap_err();
    assert_eq!(error.problems.len(), 1, "{error}");
    assert_eq!(error.problems[0].path, "chain.type");
}

#[test]
fn links_of_any_chain_are_counted_along_the_route() {
    let chain = "[chain]\npitch = '1 in'\nroller_diameter = '5/8 in'\nmass = '68 g'\nstiffness = '161 MN/m'";
    let scene = Scene::from_text(&around_two(chain), "test").unwrap();
    assert_eq!(scene.drive().unwrap().chains[0].chain.links(), 120);
    // Strands have no route that could tell.
    told(
        &format!(
            "{chain}\nends = ['fixed', 'free']\nstart = {{ kind = 'line', from = [0, 0], to = [1, 0] }}"
        ),
        &["chain.links: missing; give the number of links"],
    );
}

#[test]
fn routes_that_turn_wrongly_are_told_which_sides_would_do() {
    let scene = |order: &str, side: &str| {
        let sprocket = |name: &str, x: f64, y: f64| {
            format!(
                "[[sprockets]]\nname = '{name}'\nteeth = 19\ncentre = [{x}, {y}]\ninertia = 1\n"
            )
        };
        format!(
            "chain = '16B-1'\n{}{}{}[route]\nstops = [{order}]\n",
            sprocket("a", 0.0, 0.0),
            sprocket("b", 1.0, 0.0) + side,
            sprocket("c", 0.0, 1.0)
        )
    };
    told(
        &scene("'a', 'b', 'c'", "side = 'right'\n"),
        &[
            "follow one another counter-clockwise: those inside the chain lie on its `left`, all others on its `right`",
        ],
    );
    told(
        &scene("'a', 'c', 'b'", ""),
        &[
            "follow one another clockwise: those inside the chain lie on its `right`, all others on its `left`",
        ],
    );
}

#[test]
fn a_rigid_pendulum_is_asked_for_what_it_has() {
    let scene = "[chain]\npitch = '200 mm'\nlinks = 1\nmodel = 'ideal-joints'\n\
        inner = { mass = '1 kg', inertia = '1e-3 kgm^2' }\nouter = { mass = '1 kg', inertia = '1e-3 kgm^2' }\n\
        ends = ['fixed', 'free']\nstart = { kind = 'line', from = [0, 0], to = [0.2, 0] }\n";
    let scene = Scene::from_text(scene, "test").unwrap();
    let drive = scene.drive().unwrap();
    let resolved = scene.resolved().unwrap();
    assert!(
        resolved.text().contains("rollers = \"none\""),
        "{}",
        resolved.text()
    );
    drive.assemble().unwrap();
}

#[test]
fn an_open_bow_without_links_is_told_what_it_can_reach() {
    let mut scene = around_two("chain = '16B-1'");
    scene += "[[guides]]\nname = 'shoe'\nface = { kind = 'on-span', from = '20 %', to = '80 %', radius = '1.5 m' }\n\
        [route]\nstops = ['a', 'shoe', 'b']\n";
    told(
        &scene,
        &[
            "face.bow: missing; give it, or the number of links from which it follows: by its bow the route takes 120.0",
        ],
    );
}

/// Ends of a quarter of the length of a long rail reach into the teeth: those that nobody gave are as large as leave half a pitch, or half of the gap
/// beside the straight part.
#[test]
fn the_ends_of_a_long_rail_clear_the_teeth() {
    let rail = |more: &str| {
        let mut scene = around_two("chain = '16B-1'");
        scene += "[[guides]]\nname = 'rail'\nface = { kind = 'on-span', between = ['b', 'a'], bow = '0 mm', material = 'left', ";
        scene += "from = '10 %', to = '92 %'";
        scene += more;
        scene += " }\n";
        let drive = Scene::from_text(&scene, "test").unwrap().drive().unwrap();
        let gap = |index: usize| {
            let it = &drive.sprockets[index];
            let foot = drive.guides[0].face.nearest(it.centre, 10.0).unwrap();
            foot.distance.abs() - it.gap.tip_radius
        };
        let gaps = [gap(0), gap(1)];
        (gaps, drive)
    };
    // Edges instead of ends: the gaps beside the straight part.
    let ([a, b], _) = rail(", end_radius = '1 um'");
    let wanted = 0.5 * a.min(b).min(25.4e-3);
    let ([a, b], _) = rail("");
    assert!((a.min(b) - wanted).abs() < 2e-5, "{a}, {b}, {wanted}");
    // A quarter of the length, when asked for.
    let ([a, b], drive) = rail(", end_radius = '211 mm'");
    assert!(a.min(b) < 0.0, "{a}, {b}");
    let message = drive.assemble().unwrap_err().to_string();
    assert!(
        message.contains("guide `rail` cuts into the teeth of `")
            && message.contains("or give its ends a smaller radius")
            && !message.contains("deep through"),
        "{message}"
    );
}
