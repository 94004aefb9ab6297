//! Mistakes at the command line and in scenes, each with its message and exit code, word for word.
//!
//! After a change that is meant: `INSTA_UPDATE=always cargo test -p chaindrive-cli --test it mistakes`, and look at what git shows.

use std::fmt::Write as _;
use std::fs;

use crate::command_line::{folder, run};

/// Mistakes of a command line.
const LINES: [&str; 41] = [
    "run nowhere.toml",
    "run marine_engin",
    "run 16b1",
    "run .",
    "run binary.toml",
    "check empty.toml",
    "run marine_two_sprockets --until -1ms",
    "run marine_two_sprockets --until=-1ms",
    "run marine_two_sprockets --until 1kg",
    "run marine_two_sprockets --until soon",
    "run marine_two_sprockets --until 1ms --every 0s",
    "run marine_two_sprockets --until 1ms --method verlt",
    "run marine_two_sprockets --until 1ms --method rk4 --accuracy 1%",
    "run marine_two_sprockets --until 1ms --accuracy-of torque",
    "run marine_two_sprockets --until 1ms --step 0s",
    "run marine_two_sprockets --until 1ms --record tension",
    "run marine_two_sprockets --until 1ms --events tooth",
    "run marine_two_sprockets --until 1ms --run-in never",
    "run marine_two_sprockets --until 1ms --set chain.pich=9mm",
    "run marine_two_sprockets --until 1ms --set links=80",
    "run marine_two_sprockets --until 1ms --set teeth=20",
    "run marine_two_sprockets --until 1ms --set chain.links",
    "run marine_two_sprockets --until 1ms --set chain.type=16b1",
    "run marine_two_sprockets --until 1ms --set sprockets.crnk.teeth=20",
    "run marine_two_sprockets --until 1ms --set sprockets.crank.teeth=0",
    "run marine_two_sprockets --until 1ms --set title.x=0",
    "run marine_two_sprockets --until 1ms -o result.txt",
    "run marine_two_sprockets --until 1ms -o empty.toml/result.csv",
    "run marine_two_sprockets --until 1ms -o foreign.csv",
    "run marine_two_sprockets --until 1ms --checkpoint-every 1ms",
    "run marine_two_sprockets --untl 1ms",
    "rnu marine_two_sprockets",
    "resume nothing.zarr",
    "sweep marine_two_sprockets --until 1ms",
    "sweep marine_two_sprockets --until 1ms --vary route.pretension=1kN..2kN",
    "sweep marine_two_sprockets --until 1ms --vary links=78,80",
    "sweep marine_two_sprockets --until 1ms --vary links=78..80/2",
    "catalogue 16b1",
    "design --sprockets 19,38 --chain 16b2 --links 80",
    "design --sprockets 19 --chain 16B-1 --links 80",
    "replay nothing.zarr",
];

/// A sound scene, which mistakes are made in.
const SOUND: &str = r#"title = "Two sprockets"
[chain]
type = "16B-1"
links = 78
[contact.teeth]
restitution = 0.8
[[sprockets]]
name = "driver"
teeth = 19
centre = ["0 mm", "0 mm"]
motion = { kind = "constant", speed = "300 rpm" }
[[sprockets]]
name = "driven"
teeth = 19
centre = ["749.3 mm", "0 mm"]
inertia = "0.05 kg m^2"
load = [{ kind = "constant", torque = "-40 N m" }]
[route]
stops = ["driver", "driven"]
pretension = "1 kN"
"#;

/// Texts of the sound scene, and what is written instead.
#[rustfmt::skip]
const SCENES: [(&str, &str); 28] = [
    ("type = \"16B-1\"", "type = \"16b1\""),
    ("type = \"16B-1\"", "tipe = \"16B-1\""),
    ("type = \"16B-1\"", "type = 16"),
    ("links = 78", "links = 78.5"),
    ("links = 78", "links = \"many\""),
    ("links = 78", "links = -4"),
    ("links = 78", "links = 2"),
    ("links = 78", "lynks = 78"),
    ("links = 78", "links = = 78"),
    ("[chain]\n", "links = 78\n[chain]\n"),
    ("[chain]\n", "[chan]\n"),
    ("restitution = 0.8", "restitution = 1.4"),
    ("restitution = 0.8", "restitution = \"often\""),
    ("restitution = 0.8", "friction = { kind = \"columb\" }"),
    ("restitution = 0.8", "law = { kind = \"power\", stiffness = \"6e11 N/m\", exponent = 1.5 }"),
    ("name = \"driven\"", "name = \"driver\""),
    ("name = \"driver\"\n", ""),
    ("centre = [\"0 mm\", \"0 mm\"]", "centre = [\"0 mm\"]"),
    ("centre = [\"0 mm\", \"0 mm\"]\n", ""),
    ("749.3 mm", "150 mm"),
    ("749.3 mm", "749.3"),
    ("749.3 mm", "749,3 mm"),
    ("300 rpm", "300 mm"),
    ("300 rpm", "300 rmp"),
    ("motion = { kind = \"constant\", speed", "speed = \"1 rpm\"\nmotion = { kind = \"constant\", sped"),
    ("\"driver\", \"driven\"]", "\"driver\", \"drivn\"]"),
    ("torque = \"-40 N m\"", "torque = \"-40 N m"),
    ("pretension = \"1 kN\"", "pretension = \"-1 kN\""),
];

#[test]
fn mistakes_of_command_lines() {
    let folder = folder();
    let write = |name: &str, bytes: &[u8]| fs::write(folder.path().join(name), bytes).unwrap();
    write("binary.toml", b"title = '\xff\xfe'");
    write("empty.toml", b"");
    write("foreign.csv", b"my,own,table\n");
    let mut told = String::new();
    for line in LINES {
        let arguments: Vec<&str> = line.split(' ').collect();
        let (code, out, err) = run(folder.path(), &arguments);
        assert_eq!(out, "", "{line}");
        assert!(code == 2 || code == 3, "{line}: {code}");
        writeln!(told, "$ chaindrive {line}\n{err}exit code {code}\n").unwrap();
    }
    insta::assert_snapshot!(told);
}

/// Every message has a place and an excerpt, and says what is allowed or what to do.
#[test]
fn mistakes_in_scenes() {
    let folder = folder();
    let mut told = String::new();
    for (old, new) in SCENES {
        assert!(SOUND.contains(old), "{old}");
        fs::write(
            folder.path().join("wrong.toml"),
            SOUND.replacen(old, new, 1),
        )
        .unwrap();
        let (code, out, err) = run(folder.path(), &["check", "wrong.toml"]);
        assert_eq!((code, out.as_str()), (2, ""), "{new}\n{err}");
        let (shown, carets) = (err.matches(" | ").count(), err.matches('^').count());
        assert!(
            err.starts_with("wrong.toml:") && shown >= 2 && carets > 0,
            "{new}\n{err}"
        );
        writeln!(told, "{}\n{err}", new.trim_end()).unwrap();
    }
    insta::assert_snapshot!(told);
}

/// The sound scene is sound, otherwise its mistakes would not be those that are meant.
#[test]
fn the_scene_without_mistakes_is_sound() {
    let folder = folder();
    fs::write(folder.path().join("sound.toml"), SOUND).unwrap();
    let (code, _, err) = run(folder.path(), &["check", "sound.toml"]);
    assert_eq!((code, err.as_str()), (0, ""));
}
