//! What yields behind the teeth where a scene asks for it, printed and felt.

use std::f64::consts::PI;

use chaindrive::describe::Description;
use chaindrive::precision::{Promise, Quantity, choose};
use chaindrive::{Drive, Run, Scene, Simulation};

use crate::mistakes::{Mistake, all_found};

/// Half a scene: one link of 56B, hardly stiff along itself, falls onto the teeth of a wheel that stands still, in the direction of a gap.
fn falling(contact: &str, sprocket: &str) -> String {
    format!(
        r#"
settle = false
gravity = [0, 0]
[chain]
type = "56B-1"
links = 1
stiffness = "1 N/m"
damping_ratio = 0
ends = ["free", "free"]
[chain.start]
kind = "points"
positions = [["0 m", "260 mm"], ["0 m", "348.9 mm"]]
velocities = [["0 m/s", "-1.06 m/s"], ["0 m/s", "-1.06 m/s"]]
[contact.teeth]
law = {{ kind = "power", stiffness = "6e11 N/m^1.5", exponent = 1.5 }}
restitution = 1
{contact}
[[sprockets]]
name = "locked"
teeth = 18
centre = ["0 m", "0 m"]
motion = "held"
{sprocket}
[run]
until = "16 ms"
"#
    )
}

fn drive(text: &str) -> Drive {
    let drive = Scene::from_text(text, "seat.toml").and_then(|scene| scene.drive());
    drive.unwrap_or_else(|error| panic!("{error}"))
}

const RIM: &str = r#"rim = "80 mm""#;

/// Greatest force by ½ m v² = ∫ F dδ: F = K x^1.5 on the surfaces and a spring behind them.
fn by_energy(mass: f64, speed: f64, series: f64) -> f64 {
    let energy = |force: f64| {
        let depth = (force / 6e11).powf(2.0 / 3.0);
        0.4 * force * depth + 0.5 * force * force / series
    };
    let (mut low, mut high) = (0.0, 1e6);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if energy(middle) < 0.5 * mass * speed * speed {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

/// The first impact, at the step that an accuracy of impacts chooses, has the force that follows from the printed stiffness and mass.
#[test]
fn a_blow_has_the_force_of_the_printed_stack() {
    for (contact, sprocket) in [
        ("stack = {}", ""),
        ("stack = { pin_ends = \"clamped\" }", RIM),
    ] {
        let drive = drive(&falling(contact, sprocket));
        let run = Run {
            until: 16e-3,
            every: 1e-3,
            ..Run::default()
        };
        let start = drive.assemble().unwrap();
        let accuracy = (0.02, Quantity::Impacts);
        let choice = choose(&start, &run, accuracy, &|| false).unwrap();
        assert!(
            choice.kept && choice.promise == Promise::Impacts,
            "{choice}"
        );
        let run = choice.run;
        let told = Description::of(&drive, &run).unwrap();
        let [stack] = told.stacks.as_slice() else {
            panic!("{:?}", told.stacks)
        };
        let printed = told.to_string();
        assert!(
            printed.contains("behind the teeth       locked: ")
                && printed.contains("bending of the pin"),
            "{printed}"
        );
        let mut simulation = Simulation::start(&drive, &run).unwrap();
        let mut impacts = Vec::new();
        while simulation.next_sample().unwrap().is_some() {
            impacts.extend_from_slice(simulation.impacts());
        }
        let first = impacts.first().unwrap();
        assert!((first.speed - 1.06).abs() < 1e-3, "{first:?}");
        let known = by_energy(stack.lumped_mass, first.speed, stack.stiffness.unwrap());
        assert!(
            (first.peak_force / known - 1.0).abs() < 0.05,
            "{} N, not {known} N",
            first.peak_force
        );
        let dry = by_energy(stack.lumped_mass, 1.0, stack.stiffness.unwrap());
        assert!((stack.dry_blow / dry - 1.0).abs() < 1e-6);
    }
}

/// The parts of 56B by hand: steel of 207 GPa, roller 53.98 mm, bush 39.41 mm on 34.37 mm, pin 34.32 mm, 53.34 mm between plates of 13.5 mm.
#[test]
fn terms_follow_from_the_catalogue() {
    let drive = drive(&falling("stack = {}", RIM));
    let stack = drive.sprockets[0].stack.clone().unwrap();
    let (modulus, width) = (207e9_f64, 53.34e-3_f64);
    let length = width + 27e-3;
    let shear = modulus / 2.6;
    let second = |outer: f64, inner: f64| PI / 64.0 * (outer.powi(4) - inner.powi(4));
    let area = |outer: f64, inner: f64| PI / 4.0 * (outer.powi(2) - inner.powi(2));
    let pin = length.powi(3) / (120.0 * modulus * second(34.32e-3, 0.0))
        + 8.8 / 7.8 * length / (12.0 * shear * area(34.32e-3, 0.0));
    let squared = (34.37_f64 / 39.41).powi(2);
    let shape = (8.8 * (1.0 + squared).powi(2) + 23.6 * squared) / (7.8 * (1.0 + squared).powi(2));
    let bush = width.powi(3) / (720.0 * modulus * second(39.41e-3, 34.37e-3))
        + shape * width / (12.0 * shear * area(39.41e-3, 34.37e-3));
    let rim = 2.0 / (PI * modulus * 0.95 * width) * (80.0_f64 / 26.99).ln();
    let joint = 0.4208 + 0.5 * (2.161 + 3.359);
    for (part, compliance, share) in [
        ("bending of the pin", pin, 0.5 * 3.359 / joint),
        ("bending of the bush", bush, 0.5 * 2.161 / joint),
        ("rim of the sprocket", rim, 1.0),
    ] {
        let term = stack.terms.iter().find(|it| it.part == part).unwrap();
        assert!(
            (term.compliance / compliance - 1.0).abs() < 1e-6,
            "{term:?}"
        );
        assert!((term.share / share - 1.0).abs() < 1e-9, "{term:?}");
    }
    let series = drive.sprockets[0].surface.law.series.unwrap();
    let sum: f64 = stack
        .terms
        .iter()
        .map(|it| it.share.powi(2) * it.compliance)
        .sum();
    assert!((series * sum - 1.0).abs() < 1e-12);
    // Walls are stiff beside the rest, which they have to be for a column to do.
    let walls = stack.terms.iter().filter(|it| it.part.starts_with("wall"));
    let walls: f64 = walls.map(|it| it.share.powi(2) * it.compliance).sum();
    assert!((0.02..0.1).contains(&(walls / sum)), "{}", walls / sum);
}

/// A part that the model moves by itself is not in the stack.
#[test]
fn parts_that_move_are_left_out() {
    let parts = |chain: &str| {
        let scene = Scene::from_text(
            &format!(
                r#"
[chain]
type = "56B-1"
links = 80
{chain}
[contact.teeth]
law = {{ kind = "johnson", length = "50 mm", clearance = "0.3 mm" }}
stack = {{}}
[[sprockets]]
name = "driver"
teeth = 30
rim = "80 mm"
centre = ["0 m", "0 m"]
motion = {{ kind = "constant", speed = "100 rpm" }}
[[sprockets]]
name = "driven"
teeth = 30
centre = ["2.2225 m", "0 m"]
inertia = "50 kg m^2"
[route]
pretension = "15 kN"
"#
            ),
            "parts.toml",
        );
        let drive = scene.and_then(|scene| scene.drive());
        let drive = drive.unwrap_or_else(|error| panic!("{error}"));
        let stack = drive.sprockets[0].stack.as_ref().unwrap();
        stack.terms.iter().map(|it| it.part).collect::<Vec<_>>()
    };
    let roller = [
        "wall of the roller",
        "roller on bush",
        "bending of the bush",
    ];
    let pin = ["wall of the bush", "bush on pin", "bending of the pin"];
    let rim = ["rim of the sprocket"];
    assert_eq!(parts(""), [&roller[..], &pin, &rim].concat());
    let clearance = "model = \"clearance-joints\"";
    assert_eq!(parts(clearance), [&roller[..], &rim].concat());
    let free = "rollers = \"free\"\nroller = { clearance = \"50 um\" }";
    assert_eq!(parts(free), rim);
    assert_eq!(
        parts("model = \"bush-strands\"\nstrands = 2"),
        [&roller[2..], &pin, &rim].concat()
    );
}

/// A scene in full asks for the same stack; one that asks for none has the stiffness that it had.
#[test]
fn scenes_in_full_keep_their_stack() {
    let asked = Scene::from_text(&falling("stack = {}", RIM), "seat.toml").unwrap();
    let full = asked.resolved().unwrap();
    let [stack, again] = [&asked, &full].map(|it| it.drive().unwrap().sprockets[0].stack.clone());
    assert_eq!(stack, again);
    let text = full.text();
    assert!(
        text.contains("pin_ends") && text.contains("assumed"),
        "{text}"
    );
    let silent = drive(&falling("", ""));
    assert_eq!(silent.sprockets[0].stack, None);
    let told = Description::of(
        &silent,
        &Run {
            until: 1e-3,
            ..Run::default()
        },
    )
    .unwrap();
    let left_out = "bending of pins and bushes behind the teeth";
    assert!(
        told.model.absent.contains(&left_out),
        "{:?}",
        told.model.absent
    );
    // Roller on bush and bush on pin with all of the force.
    let series = silent.sprockets[0].surface.law.series.unwrap();
    assert!((series / 4.37e9 - 1.0).abs() < 1e-2, "{series}");
}

/// Stacks that cannot be are refused in their place.
#[test]
fn stacks_that_cannot_be_are_refused() {
    const STACK: &str = "stack = {}";
    const CASES: &[Mistake] = &[
        (
            STACK,
            "stack = {}\nseries = \"2 GN/m\"",
            "contact.teeth.stack",
            17,
            "`series` is given too",
        ),
        (
            STACK,
            "[contact.guides]\nstack = {}",
            "contact.guides.stack",
            18,
            "only teeth",
        ),
        (
            STACK,
            "rolling = 1\nstack = {}",
            "contact.teeth.rolling",
            17,
            "unknown",
        ),
        (STACK, "", "sprockets[0].rim", 23, "without a `stack`"),
        (
            "law = { kind = \"power\", stiffness = \"6e11 N/m^1.5\", exponent = 1.5 }",
            "",
            "contact.teeth.stack",
            17,
            "without a `law`",
        ),
        (
            "type = \"56B-1\"",
            "type = \"04B-1\"",
            "chain.joint.clearance",
            4,
            "radial clearance",
        ),
        (
            "stack = {}",
            "stack = { load = 0 }",
            "contact.teeth.stack.load",
            17,
            "must be",
        ),
    ];
    let good = falling(STACK, RIM);
    drive(&good);
    all_found(&good, CASES, |found, path| found == path, 4);
}
