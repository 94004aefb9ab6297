//! The stack behind teeth and pins, as scenes describe it: lumped under the teeth, or points of their own.
#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use std::f64::consts::PI;

use chaindrive::Scene;
use chaindrive_contact::elastic::ElasticLaw;

use crate::mistakes::{Mistake, all_found};

/// Two sprockets of a chain of the catalogue, and what else is said of it.
fn scene(chain: &str) -> String {
    format!(
        r#"
[chain]
type = "56B-1"
links = 80
{chain}
[contact.teeth]
law = {{ kind = "johnson", length = "50 mm", clearance = "0.3 mm" }}
[[sprockets]]
name = "driver"
teeth = 30
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
    )
}

fn read(text: &str) -> Scene {
    Scene::from_text(text, "stack").unwrap()
}

fn behind_teeth(scene: &Scene) -> Option<f64> {
    scene.drive().unwrap().sprockets[0].surface.law.series
}

/// δ/F \[m/N\] of the conformal law under a load: δ/ΔR = q [ln(4/q) − 1] + 2.5964 q²/(1 + 0.9753 q), q = F/(π E* L ΔR).
fn yields(play: f64, length: f64, load: f64) -> f64 {
    let modulus = 0.5 * 207e9 / (1.0 - 0.3 * 0.3);
    let q = load / (PI * modulus * length * play);
    let depth = q * ((4.0 / q).ln() - 1.0) + 2.5964 * q * q / (1.0 + 0.9753 * q);
    depth * play / load
}

/// Roller on bush and bush on pin of 56B at a tenth of its breaking load, both with the play of the pin, 25 µm; less where a part
/// moves by itself.
#[test]
fn teeth_have_the_stack_of_the_catalogue_behind_them() {
    let load = 0.1 * 850e3;
    let on_bush = yields(25e-6, 53.34e-3, load);
    let on_pin = yields(25e-6, 53.34e-3 + 2.0 * 13.5e-3, load);
    let free = "roller = { clearance = \"50 um\" }\nrollers = \"free\"";
    for (chain, compliance) in [
        (String::new(), Some(on_bush + on_pin)),
        ("model = \"clearance-joints\"".into(), Some(on_bush)),
        ("model = \"ideal-joints\"".into(), Some(on_bush + on_pin)),
        (free.into(), None),
        (format!("{free}\nmodel = \"clearance-joints\""), None),
    ] {
        let found = behind_teeth(&read(&scene(&chain)));
        match (found, compliance) {
            (Some(found), Some(known)) => {
                assert!((found * known - 1.0).abs() < 1e-6, "{chain}: {found}");
            }
            (found, known) => assert_eq!(found, known, "{chain}"),
        }
    }
    let plain = scene("");
    // The law that particles have by default is that of the whole stack.
    let law = "law = { kind = \"johnson\", length = \"50 mm\", clearance = \"0.3 mm\" }";
    assert_eq!(behind_teeth(&read(&plain.replace(law, ""))), None);
    let given = plain.replace(law, &format!("{law}\nseries = \"2 GN/m\""));
    assert_eq!(behind_teeth(&read(&given)), Some(2e9));
    // Nothing lies behind where a scene says so, and a scene in full says so.
    let rigid = plain.replace(law, &format!("{law}\nseries = 0"));
    assert_eq!(behind_teeth(&read(&rigid)), None);
    assert_eq!(behind_teeth(&read(&rigid).resolved().unwrap()), None);
}

/// Half of what the stiffness of a link leaves beside its joint lies behind the pin, and a scene that is written out in full has it too.
#[test]
fn pins_of_points_bend() {
    let scene = read(&scene(
        "roller = { clearance = \"50 um\" }\nrollers = \"free\"",
    ));
    let drive = scene.drive().unwrap();
    let law = drive.chains[0].chain.model.clearance().unwrap().surface.law;
    let (mut low, mut high) = (0.0, 1e-3);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if law.elastic.force(middle) < 15e3 {
            low = middle;
        } else {
            high = middle;
        }
    }
    // 1/k_s = ½ (1/k − 1/k_joint), k_joint under the pretension
    let compliance = 0.5 * (1.0 / 815e6 - 1.0 / law.elastic.stiffness(low));
    let series = law.series.unwrap();
    assert!((series * compliance - 1.0).abs() < 1e-6, "{series}");
    let again = scene.resolved().unwrap().drive().unwrap();
    assert_eq!(again.chains[0].chain, drive.chains[0].chain);
}

/// Keys without a meaning for free rollers of particles are told in their place.
#[test]
fn free_rollers_of_particles_are_refused_where_they_cannot_be() {
    const FREE: &str = "rollers = \"free\"";
    const CASES: &[Mistake] = &[
        (
            FREE,
            "rollers = \"free\"\nends = [{ kind = \"fixed\" }, { kind = \"fixed\" }]",
            "chain.rollers",
            6,
            "need a closed chain",
        ),
        (
            "links = 80",
            "links = 81",
            "chain.links",
            4,
            "needs an even number",
        ),
        (
            "[contact.teeth]",
            "[contact.rollers]\nfriction = { coefficient = 0.1 }\n[contact.teeth]",
            "contact.rollers.friction",
            8,
            "do not turn",
        ),
        (
            FREE,
            "rollers = \"free\"\njoint = { clearance = \"0 mm\" }",
            "chain.joint.clearance",
            7,
            "need pins with play",
        ),
        (
            FREE,
            "rollers = \"lumped\"",
            "chain.rollers",
            6,
            "the particle chain has none",
        ),
    ];
    let good = scene("roller = { clearance = \"50 um\" }\nrollers = \"free\"");
    all_found(&good, CASES, |found, path| found == path, 3);
}
