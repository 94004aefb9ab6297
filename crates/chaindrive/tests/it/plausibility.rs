//! Implausible inputs are told, and presets have none.
#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use std::cell::RefCell;
use std::collections::BTreeSet;

use chaindrive::plausibility::{PLAUSIBILITY_RULES, implausible};
use chaindrive::scene::presets;
use chaindrive::{Memory, Onlooker, Request, Scene, SettingValue, Settings, execute};

const SCENE: &str = r#"
gravity = [0, "-9.81 m/s^2"]
[chain]
links = 80
pitch = "12.7 mm"
mass = "9 g"
stiffness = "20 MN/m"
damping_ratio = 0.02
roller_diameter = "7.92 mm"
plate_height = "11.8 mm"
[[sprockets]]
name = "driver"
teeth = 20
centre = [0, 0]
motion = { kind = "constant", speed = "60 rpm" }
[[sprockets]]
name = "driven"
teeth = 20
centre = ["381 mm", 0]
inertia = "0.01 kg m^2"
[[guides]]
name = "rail"
face = { kind = "bar", start = ["300 mm", "36.5 mm"], end = ["100 mm", "36.5 mm"] }
[contact.teeth]
law = { kind = "linear", stiffness = "0.1 GN/m" }
friction = { kind = "coulomb", coefficient = 0.1 }
film = { thickness = "20 µm", viscosity = "0.05 Pa s", length = "5 mm" }
"#;

/// Names of the rules that a scene is told.
fn told(text: &str, run_time: f64) -> Vec<&'static str> {
    let drive = Scene::from_text(text, "test.toml").unwrap();
    let drive = drive.drive().unwrap_or_else(|error| panic!("{error}"));
    let notes = implausible(&drive, Some(run_time));
    let rules: BTreeSet<_> = notes.iter().map(|it| it.rule).collect();
    rules.into_iter().collect()
}

/// Every rule by a value on either side of its limit, and nothing else by that.
#[test]
fn every_rule_tells_what_is_beyond_its_limit() {
    assert!(told(SCENE, 60.0).is_empty(), "{:?}", told(SCENE, 60.0));
    let mut seen = BTreeSet::new();
    // c = p √(k/m): 5.12 km/s at 123 mg. k/(1.5 E h): 1 at 3.646 GN/m for plates of 11.8 mm. J = 2π ρ a² R³, R = 40.6 mm: 6.8e-7 kg m².
    for (rule, from, within, beyond) in [
        ("wave-speed", "\"9 g\"", "\"130 mg\"", "\"120 mg\""),
        (
            "damping-ratio",
            "ratio = 0.02",
            "ratio = 0.99",
            "ratio = 1.01",
        ),
        ("plate-height", "11.8 mm", "6.4 mm", "6.3 mm"),
        ("plate-height", "11.8 mm", "15.2 mm", "15.3 mm"),
        ("contact-stiffness", "0.1 GN/m", "26 GN/m", "27 GN/m"),
        (
            "friction",
            "coefficient = 0.1",
            "coefficient = 1.49",
            "coefficient = 1.51",
        ),
        ("inertia", "0.01 kg m^2", "7e-7 kg m^2", "6.6e-7 kg m^2"),
        ("gravity", "-9.81 m/s^2", "0 m/s^2", "9.81 m/s^2"),
        ("viscosity", "0.05 Pa s", "99 Pa s", "101 Pa s"),
        ("viscosity", "0.05 Pa s", "0.31 mPa s", "0.29 mPa s"),
        ("guide-distance", "36.5 mm", "166 mm", "169 mm"),
    ] {
        assert!(SCENE.contains(from), "{from}");
        let [kept, broken] = [within, beyond].map(|to| told(&SCENE.replace(from, to), 60.0));
        assert!(kept.is_empty(), "{rule} {within}: {kept:?}");
        assert_eq!(broken, [rule], "{beyond}");
        seen.insert(rule);
    }
    // As heavy as makes the waves slow.
    let stiff = |stiffness: &str| {
        let heavy = SCENE.replace("\"9 g\"", "\"1000 kg\"");
        told(&heavy.replace("20 MN/m", stiffness), 60.0)
    };
    assert!(stiff("3.6 GN/m").is_empty());
    assert_eq!(stiff("3.7 GN/m"), ["link-stiffness"]);
    seen.insert("link-stiffness");
    assert!(told(SCENE, 3590.0).is_empty());
    assert_eq!(told(SCENE, 3610.0), ["run-time"]);
    seen.insert("run-time");
    let rules: BTreeSet<_> = PLAUSIBILITY_RULES.iter().map(|it| it.name).collect();
    assert_eq!(seen, rules);
}

#[test]
fn presets_are_told_nothing() {
    for (name, _) in presets() {
        let drive = Scene::preset(name).unwrap().drive().unwrap();
        let notes = implausible(&drive, None);
        assert!(notes.is_empty(), "{name}: {}", notes[0]);
    }
}

/// A note has the place, the value, the limit and its source.
#[test]
fn a_note_tells_value_limit_and_source() {
    let text = SCENE.replace("coefficient = 0.1", "coefficient = 50");
    let drive = Scene::from_text(&text, "test.toml").unwrap();
    let notes = implausible(&drive.drive().unwrap(), None);
    let note = notes[0].to_string();
    assert!(
        note.starts_with("coefficient of friction (driver): 49.9"),
        "{note}"
    );
}

/// The table of the documentation is that of the program.
#[test]
fn the_rules_are_documented() {
    let docs = include_str!("../../../../docs/verdict.md");
    for rule in PLAUSIBILITY_RULES {
        let row = format!("| `{}` | {} |", rule.name, rule.label);
        let line = docs.lines().find(|line| line.starts_with(&row));
        let line = line.unwrap_or_else(|| panic!("no row of {}", rule.name));
        assert!(line.ends_with(&format!("| {} |", rule.source)), "{line}");
    }
}

/// Listens until it is told how long a run takes, and stops it then.
#[derive(Default)]
struct Listener(RefCell<Option<String>>);

impl Onlooker for Listener {
    fn stop(&self) -> bool {
        self.0.borrow().is_some()
    }

    fn asks_for_time(&self) -> bool {
        true
    }

    fn foretell(&self, sentence: &str) {
        self.0.replace(Some(sentence.to_owned()));
    }
}

/// What a run says of its time before it begins.
fn foretold(until: f64) -> Option<String> {
    let settings = Settings::default()
        .with("until", SettingValue::Number(until))
        .with("every", SettingValue::Number(0.1 * until));
    let request = Request::new(&Scene::preset("spinning_ring").unwrap(), &settings).unwrap();
    let listener = Listener::default();
    // A run that is stopped is a report or an error, as far as it came.
    execute(&request, &mut Memory::default(), &listener).ok();
    listener.0.into_inner()
}

#[test]
fn a_long_run_says_so_before_it_begins() {
    let sentence = foretold(1e6).unwrap_or_default();
    assert!(
        sentence.starts_with("the run will take about"),
        "{sentence}"
    );
    assert_eq!(foretold(1e-2), None);
}
