//! Mistakes of first users: each mistake as the command answers it.
#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use std::fs;

use crate::command_line::{folder, words};

/// Runs the command with a scene beside it, and returns exit code, stdout and stderr.
fn run(scene: &str, arguments: &[&str]) -> (i32, String, String) {
    let folder = folder();
    fs::write(folder.path().join("scene.toml"), scene).unwrap();
    crate::command_line::run(folder.path(), arguments)
}

/// Message of a command that refuses a mistake.
fn refused(arguments: &[&str]) -> String {
    let (code, _, err) = run(TWO_SPROCKETS, arguments);
    assert_eq!(code, 2, "{arguments:?}: {err}");
    err
}

const TWO_SPROCKETS: &str = r#"chain = "16A-1"

[[sprockets]]
name = "driver"
teeth = 19
centre = ["0 mm", "0 mm"]
motion = { kind = "constant", speed = "300 rpm" }

[[sprockets]]
name = "driven"
teeth = 57
centre = ["749.3 mm", "0 mm"]
inertia = "0.4 kg m^2"
load = [{ kind = "constant", torque = "-90 N m" }]

[route]
adjust = { kind = "sprocket", name = "driven", direction = [1, 0], within = "30 mm" }
"#;

/// Radius of the shoe, and how far its top stands above the straight upper run \[mm\].
const SHOE: [f64; 2] = [100.0, 20.0];
/// Pitch of 08B and diameter of its rollers \[mm\].
const CHAIN: [f64; 2] = [12.7, 8.51];
/// Distance of the sprockets \[mm\], before the driven one is moved until the links close.
const DISTANCE: f64 = 300.0;

/// Half the angle \[°\] by which a chain turns over the shoe in the middle between two sprockets of 19 teeth.
///
/// ```text
/// φ = asin((ρ − R) / D) − atan(h / (L/2))      ρ: shoe with the rollers on it, its centre h below the line of centres
/// ```
fn half_wrap() -> f64 {
    let sprocket = 0.5 * CHAIN[0] / (std::f64::consts::PI / 19.0).sin();
    let ride = SHOE[0] + 0.5 * CHAIN[1];
    let below = ride - sprocket - SHOE[1];
    let away = below.hypot(0.5 * DISTANCE);
    let angle = ((ride - sprocket) / away).asin() - (below / (0.5 * DISTANCE)).atan();
    angle.to_degrees()
}

/// A shoe that bows the upper run out from inside of the loop, its face this long \[°\] on the right and on the left of the middle.
fn with_shoe(right: f64, left: f64) -> String {
    let sprocket = 0.5 * CHAIN[0] / (std::f64::consts::PI / 19.0).sin();
    let top = sprocket + SHOE[1] - 0.5 * CHAIN[1];
    format!(
        r#"
        chain = "08B-1"
        [[sprockets]]
        name = "driver"
        teeth = 19
        centre = ["0 mm", "0 mm"]
        motion = {{ kind = "constant", speed = "300 rpm" }}
        [[sprockets]]
        name = "driven"
        teeth = 19
        centre = ["{DISTANCE} mm", "0 mm"]
        inertia = "0.01 kg m^2"
        [[guides]]
        name = "shoe"
        face = {{ kind = "arc", centre = ["{} mm", "{} mm"], radius = "{} mm", from = "{} deg", to = "{} deg" }}
        [route]
        stops = ["driver", "driven", "shoe"]
        pretension = "100 N"
        adjust = {{ kind = "sprocket", name = "driven", direction = [1, 0], within = "15 mm" }}
        "#,
        0.5 * DISTANCE,
        top - SHOE[0],
        SHOE[0],
        90.0 - right,
        90.0 + left
    )
}

#[test]
fn a_shoe_shorter_than_its_wrap_is_told_of() {
    let half = half_wrap();
    assert!((7.0..9.0).contains(&half), "{half}");
    let (code, out, err) = run(&with_shoe(half + 2.0, half + 2.0), &["check", "scene.toml"]);
    assert_eq!((code, err.as_str()), (0, ""), "{out}");
    // The chain runs to the left over the shoe, and so off at its left end.
    for (right, left, way) in [(2.0, -3.0, "off"), (-3.0, 2.0, "on")] {
        let scene = with_shoe(half + right, half + left);
        let (code, _, err) = run(&scene, &["check", "scene.toml"]);
        assert_eq!(code, 0, "{err}");
        let begins = format!(
            "warning: scene.toml: the chain bends over the end of guide `shoe` where it runs {way}: "
        );
        assert!(err.starts_with(&begins), "{err}");
        assert_eq!(err.lines().count(), 1, "{err}");
        let short = err.split("the face ends ").nth(1).unwrap();
        let short: f64 = short.split('°').next().unwrap().parse().unwrap();
        // The driven sprocket is adjusted by half a pitch at most, which turns the spans by half a degree.
        assert!((short - 3.0).abs() < 0.5, "{err}");
        let (_, out, _) = run(&scene, &["describe", "scene.toml"]);
        assert!(out.contains("warning: the chain bends"), "{out}");
    }
    // Shorter at either end, it is told of twice.
    let (_, _, err) = run(&with_shoe(half - 3.0, half - 3.0), &["check", "scene.toml"]);
    assert_eq!(err.matches("over the end of guide").count(), 2, "{err}");
}

#[test]
fn numbers_in_texts_need_their_unit() {
    let speed = "sprockets.driver.motion.speed";
    let text = format!("{speed}=\"-900\"");
    let err = refused(&["describe", "scene.toml", "--set", &text]);
    assert!(
        err.contains("`-900` has no unit; write an angular speed such as \"1500 rpm\""),
        "{err}"
    );
    // On a command line everything is a text, so a number is one, in SI units; but that is said.
    let bare = format!("{speed}=-31.4");
    let (code, _, err) = run(TWO_SPROCKETS, &["describe", "scene.toml", "--set", &bare]);
    let note = format!("note: --set {speed}: -31.4 without a unit is -31.4 rad/s\n");
    assert_eq!((code, err), (0, note));
    let with_unit = [
        "describe",
        "scene.toml",
        "--set",
        &format!("{speed}=-300 rpm"),
    ];
    let (code, _, err) = run(TWO_SPROCKETS, &with_unit);
    assert_eq!((code, err.as_str()), (0, ""));
    let teeth = words("describe scene.toml --set sprockets.driver.teeth=20");
    let (_, _, err) = run(TWO_SPROCKETS, &teeth);
    assert_eq!(err, "");
}

#[test]
fn mistakes_in_options_name_the_option() {
    for (option, value, says) in [
        ("--until", "1x", "unknown unit `x` in `1x`"),
        ("--until", "-1 s", "-1, must be positive"),
        ("--until=-1", "", "-1, must be positive"),
        ("--every", "2 mm", "`2 mm` is a length, needed is a time"),
        ("--step", "soon", "`soon` does not begin with a number"),
        ("--accuracy", "120 %", "1.2, must be"),
        ("--run-in", "long", "does not begin with a number"),
    ] {
        let given = match value {
            "" => vec![option.to_owned()],
            value => vec![format!("{option}={value}")],
        };
        let given = given.iter().map(String::as_str);
        let arguments: Vec<&str> = ["run", "scene.toml"].into_iter().chain(given).collect();
        let err = refused(&arguments);
        let name = option.split('=').next().unwrap();
        assert!(err.starts_with(&format!("{name}: ")), "{option}: {err}");
        assert!(err.contains(says), "{option}: {err}");
    }
    let err = refused(&["describe", "scene.toml", "--set", "gravity=[0]"]);
    assert!(err.starts_with("--set gravity: gravity: "), "{err}");
}

/// Lines are those of the file; a value that an option gave stands in none.
#[test]
fn lines_are_those_of_the_file() {
    let lines = TWO_SPROCKETS.lines().count();
    // Both are found when the drive is made, after the text was changed and has become longer.
    let wrong = TWO_SPROCKETS.replace("name = \"driven\", dir", "name = \"drivn\", dir");
    let arguments = words("describe scene.toml --set 'sprockets.driver.mass=1 kg'");
    let more = ["--until", "1 s", "--every", "1 ms"];
    let (code, _, err) = run(&wrong, &[&arguments[..], &more].concat());
    assert_eq!(code, 2, "{err}");
    assert!(
        err.starts_with(&format!("scene.toml:{lines}:38: route.adjust.name")),
        "{err}"
    );
    let many = words("describe scene.toml --set route.start=\"sideways\"");
    let err = refused(&many);
    assert!(err.starts_with("--set route.start: route.start: "), "{err}");
}

#[test]
fn misspelt_keys_and_units_are_guessed() {
    let set = |change: &str| refused(&["describe", "scene.toml", "--set", change]);
    let err = set("sprockets.driver.tooth=5");
    assert!(
        err.contains("sprockets[0].tooth: found the number 5"),
        "{err}"
    );
    assert!(err.contains("did you mean `teeth`?"), "{err}");
    let err = set("sprocket.driver.teeth=5");
    assert!(err.contains("did you mean `sprockets`?"), "{err}");
    let err = set("sprockets.driven.inertia=0.4 kgms");
    assert!(err.contains("unknown unit `kgms`"), "{err}");
}

#[test]
fn descriptions_count_and_name_what_they_tell_of() {
    let (code, out, err) = run(TWO_SPROCKETS, &["describe", "scene.toml"]);
    assert_eq!(code, 0, "{err}");
    assert!(
        out.contains("1 free sprocket (1 driven), 0 tensioners"),
        "{out}"
    );
    let closing = out
        .lines()
        .find(|line| line.starts_with("  closing"))
        .unwrap();
    assert!(
        closing.contains("driven moved by ") && closing.ends_with(" mm"),
        "{closing}"
    );
    // The catalogue knows the pins of the chain, and they rub.
    assert!(out.contains("pins of 7.92 mm rub"), "{out}");
    let absent = out
        .lines()
        .find(|line| line.starts_with("  absent"))
        .unwrap();
    assert!(absent.contains("friction on teeth"), "{absent}");

    let (_, out, _) = run(TWO_SPROCKETS, &["check", "scene.toml"]);
    assert!(
        out.contains("2 sprockets, 0 guides, 0 tensioners, "),
        "{out}"
    );
    let (_, out, _) = run("", &["check", "timing_drive"]);
    assert!(out.contains("2 guides, 1 tensioner, "), "{out}");
    let (_, out, _) = run("", &["describe", "timing_drive"]);
    assert!(out.contains(", 1 tensioner\n"), "{out}");
    // Its arms are turned until the chains close: an angle, and not perhaps one.
    let (_, out, _) = run("", &["describe", "two_stage_timing"]);
    let closing = out.lines().filter(|line| line.starts_with("  closing"));
    let turned = closing.filter(|line| line.contains(" turned by ") && line.ends_with('°'));
    assert_eq!(turned.count(), 2, "{out}");
    let closes = "sprockets.driven.centre=[\"746.1175 mm\", \"0 mm\"]";
    let fixed = ["--set", closes, "--set", "route.adjust=nothing"];
    let (_, out, _) = run(
        TWO_SPROCKETS,
        &[
            &["describe", "scene.toml", "--set", "chain.links=98"][..],
            &fixed,
        ]
        .concat(),
    );
    assert!(out.contains("as laid, nothing adjusted"), "{out}");
}

/// Number 80, of one inch, whose plates limit it at this speed (theory; the formula itself is held against published tables where it stands):
///
/// ```text
/// P₁ = 0.004 · 19^1.08 · 300^0.9 · 745.7 W
/// ```
#[test]
fn the_rating_of_a_chain_is_told() {
    let horsepower = 0.004 * 19_f64.powf(1.08) * 300_f64.powf(0.9);
    let rated = horsepower * 0.7457;
    let (_, out, _) = run(TWO_SPROCKETS, &["describe", "scene.toml"]);
    let row = out
        .lines()
        .find(|line| line.contains("rated power"))
        .unwrap();
    assert!(
        row.contains(&format!(
            "{rated:.3} kW at the 19 teeth and 300.0 rpm of driver"
        )),
        "{row}"
    );
    let arguments = words("run scene.toml --until 20ms --run-in 0 --no-error --step 5us");
    let (code, out, err) = run(TWO_SPROCKETS, &arguments);
    assert_eq!(code, 0, "{err}");
    assert!(
        out.contains("that it is rated for by plates at the 19 teeth of driver"),
        "{out}"
    );
    // Of the B series no formula could be read.
    let (_, out, _) = run("", &["describe", "industrial_16b"]);
    assert!(out.contains("not rated: source missing"), "{out}");
}

/// A drive that nobody takes energy from has no efficiency, and says where the energy goes.
#[test]
fn a_drive_that_serves_nobody_has_no_efficiency() {
    let idle = TWO_SPROCKETS.replace("load = [{ kind = \"constant\", torque = \"-90 N m\" }]", "");
    let ramp = r#"sprockets.driver.motion={ kind = "ramp", from = "0 rpm", to = "300 rpm", duration = "10 ms" }"#;
    let arguments = words("run scene.toml --until 50ms --run-in 0 --no-error --step 5us");
    let (code, out, err) = run(&idle, &[&arguments[..], &["--set", ramp]].concat());
    assert_eq!(code, 0, "{err}");
    let row = out
        .lines()
        .find(|line| line.contains("Efficiency"))
        .unwrap();
    assert!(row.contains("none, nobody takes energy out"), "{row}");
    let (_, out, _) = run(TWO_SPROCKETS, &arguments);
    let row = out
        .lines()
        .find(|line| line.contains("Efficiency"))
        .unwrap();
    assert!(row.contains(" % ± "), "{row}");
}

#[test]
fn two_sprockets_are_laid_out_for_a_chain_of_the_catalogue() {
    let design = |more: &[&str]| {
        run(
            TWO_SPROCKETS,
            &[&["design", "--sprockets", "19,57"], more].concat(),
        )
    };
    let (code, named, err) = design(&["--chain", "16b", "--centre-distance", "1 m"]);
    assert_eq!(code, 0, "{err}");
    let (_, by_pitch, _) = design(&["--pitch", "25.4 mm", "--centre-distance", "1 m"]);
    assert_eq!(named, by_pitch);
    let (code, _, err) = design(&["--chain", "16C-1", "--links", "120"]);
    assert_eq!(code, 2);
    assert_eq!(
        err,
        "--chain: no chain of the catalogue is named `16C-1`; did you mean `16B-1`?\n"
    );
    let (code, _, err) = design(&["--chain", "16B-1", "--centre-distance", "400"]);
    assert_eq!(code, 2);
    assert_eq!(
        err,
        "--centre-distance: `400` has no unit; write \"400 mm\", or \"400 m\"\n"
    );
}

/// M9: nine teeth on 72 at 240 mm, by the rules of makers; 19 on 57 at a metre keeps them.
#[test]
fn a_layout_against_good_practice_is_told() {
    let design = |teeth: &str, distance: &str| {
        let arguments = ["--sprockets", teeth, "--centre-distance", distance];
        let (code, out, err) = run(
            TWO_SPROCKETS,
            &[&["design", "--pitch", "12.7 mm"], &arguments[..]].concat(),
        );
        assert_eq!(code, 0, "{err}");
        let told = out
            .lines()
            .filter_map(|it| it.strip_prefix("good practice: "));
        told.map(str::to_owned).collect::<Vec<_>>()
    };
    let told = design("9,72", "240 mm");
    for (word, remark) in ["9", "8", "wrap"].iter().zip(&told) {
        assert!(remark.to_lowercase().contains(word), "{told:?}");
    }
    assert_eq!(told.len(), 4, "teeth, ratio, wrap, centres: {told:?}");
    assert!(design("19,57", "500 mm").is_empty());
}
