//! Scenes of rigid links and contact laws with mistakes: every one is found in its place, with a hint.

use chaindrive::scene::Scene;

use crate::mistakes::{Mistake, all_found, fails};

/// A scene without mistakes. The cases below change it and name the line of the mistake.
const GOOD: &str = r#"title = "Free rollers"
[chain]
pitch = "12.7 mm"
links = 78
model = "clearance-joints"
rollers = "free"
roller_diameter = "7.75 mm"
inner = { mass = "2.89 g", inertia = "1.28e-7 kg m^2" }
outer = { mass = "3.8 g", inertia = "1.64e-7 kg m^2" }
[chain.joint]
pin_diameter = "4.09 mm"
clearance = "0.025 mm"
length = "5.56 mm"
[chain.roller]
mass = "0.465 g"
inertia = "5.4e-9 kg m^2"
bush_diameter = "5.66 mm"
clearance = "0.05 mm"
length = "3.3 mm"
[contact.teeth]
restitution = 0.8
[contact.joints]
law = "cylindrical"
restitution = 0.7
friction = { coefficient = 0.1 }
[[sprockets]]
name = "driver"
teeth = 19
centre = ["0 mm", "0 mm"]
motion = { kind = "constant", speed = "300 rpm" }
[[sprockets]]
name = "driven"
teeth = 19
centre = ["374.65 mm", "0 mm"]
inertia = "0.05 kg m^2"
[route]
pretension = "60 N"
"#;

/// A chain of the catalogue; replaces the tables of the chain above.
const NAMED: &str = "[chain]\ntype = \"081\"\nlinks = 78\nmodel = \"clearance-joints\"\n";

#[rustfmt::skip]
const CASES: &[Mistake] = &[
    // Dimensions.
    ("clearance = \"0.025 mm\"", "clearance = \"-0.025 mm\"", "chain.joint.clearance", 12, "must be not negative [m]"),
    ("clearance = \"0.025 mm\"", "clearance = \"0 mm\"", "contact.joints.law", 23, "pins without play have no contact of their own"),
    ("clearance = \"0.025 mm\"", "clearance = \"1 µm\"", "contact.joints.law.clearance", 23, "in [5e-6, 0.01] [m] for the internal cylindrical law"),
    ("clearance = \"0.025 mm\"", "", "chain.joint.clearance", 10, "missing; give the radial clearance between pin and bush, such as"),
    ("pin_diameter = \"4.09 mm\"", "pin_diameter = \"5.7 mm\"", "chain.joint.pin_diameter", 11, "must be less; the bush around it has a diameter of 0.00566 m"),
    ("pin_diameter = \"4.09 mm\"", "pin_diameter = \"4.09 s\"", "chain.joint.pin_diameter", 11, "is a time, needed is a length"),
    ("pin_diameter", "pin_radius", "chain.joint.pin_radius", 11, "unknown key; known are pin_diameter, clearance, length"),
    ("bush_diameter = \"5.66 mm\"", "bush_diameter = \"7.7 mm\"", "chain.roller.bush_diameter", 17, "must be less; the roller around it"),
    ("bush_diameter = \"5.66 mm\"\n", "", "chain.roller.bush_diameter", 14, "missing; give the outer diameter of the bush"),
    ("length = \"5.56 mm\"\n", "", "contact.joints.law.length", 22, "missing; give the length of the contact"),
    ("length = \"3.3 mm\"\n", "", "chain.roller.length", 14, "give the length of the contact, or `contact.rollers.law`"),
    ("links = 78", "links = 77", "chain.links", 4, "needs an even number"),
    ("model = \"clearance-joints\"", "model = \"particles\"", "chain.inner.inertia", 8, "the particle chain has its masses at the joints"),
    // Masses.
    ("mass = \"0.465 g\"\n", "", "chain.roller.mass", 14, "missing; give the mass of a roller"),
    ("mass = \"0.465 g\"", "mass = \"0 g\"", "chain.roller.mass", 15, "0, must be positive [kg]"),
    ("mass = \"0.465 g\"", "mass = \"-1 g\"", "chain.roller.mass", 15, "must be not negative [kg]"),
    ("inertia = \"5.4e-9 kg m^2\"\n", "", "chain.roller.inertia", 14, "missing"),
    ("inner = { mass = \"2.89 g\", inertia", "inner = { inertia", "chain.inner.mass", 8, "missing; give the mass of an inner link"),
    (", inertia = \"1.64e-7 kg m^2\" }", " }", "chain.outer.inertia", 9, "missing; give the moment of inertia of an outer link"),
    ("outer = { mass = \"3.8 g\"", "outer = { mass = \"0 g\"", "chain.outer.mass", 9, "0, must be positive [kg]"),
    // Models.
    ("model = \"clearance-joints\"", "model = \"ideal\"", "chain.model", 5, "known are particles, bush-strands, ideal-joints"),
    ("model = \"clearance-joints\"\nrollers = \"free\"", "model = \"particles\"\nrollers = \"lumped\"", "chain.joint.clearance", 12, "only pins with clearance have one; take `model = \"clearance-joints\"`"),
    ("model = \"clearance-joints\"\nrollers = \"free\"", "model = \"particles\"\nrollers = \"lumped\"", "chain.rollers", 6, "the particle chain has none"),
    ("model = \"clearance-joints\"", "model = \"ideal-joints\"", "chain.joint.length", 13, "only pins with clearance have one"),
    ("rollers = \"free\"", "rollers = \"none\"", "chain.roller", 14, "this chain has no rollers"),
    ("rollers = \"free\"", "rollers = \"loose\"", "chain.rollers", 6, "known are lumped, free, none"),
    ("links = 78", "links = 78\nmass = \"3 g\"", "chain.mass", 5, "rigid links have none; give `chain.inner.mass`"),
    ("links = 78", "links = 78\ndamping_ratio = 0.03", "chain.damping_ratio", 5, "only contacts damp them"),
    ("links = 78", "links = 78\nscatter = { mass = 0.01 }", "chain.scatter.mass", 5, "only lengths can scatter"),
    // Contacts.
    ("restitution = 0.7", "restitution = 1.2", "contact.joints.restitution", 24, "1.2, must be at most 1"),
    ("restitution = 0.7", "restitution = 0\ndissipation = \"flores\"", "contact.joints.restitution", 24, "at 0 the factor is infinite"),
    ("restitution = 0.7", "restitution = 0.7\ndissipation = \"flores-2\"", "contact.joints.dissipation", 25, "did you mean `flores`?"),
    ("restitution = 0.7", "restitution = 0.7\ndissipation = \"none\"", "contact.joints.restitution", 24, "`dissipation = \"none\"` is given too"),
    ("restitution = 0.7", "damping = \"10 N s/m\"\ndissipation = \"exact\"", "contact.joints.damping", 24, "`dissipation` is given too; keep one of them"),
    ("law = \"cylindrical\"", "law = { kind = \"cylindrical\", radius = \"2 mm\" }", "contact.joints.law.radius", 23, "the radii are those of the chain"),
    ("law = \"cylindrical\"", "law = \"cylindircal\"", "contact.joints.law", 23, "did you mean `cylindrical`?"),
    ("restitution = 0.8", "restitution = 0.8\nlaw = { kind = \"cylindrical\", clearance = \"2 µm\" }", "contact.teeth.law.clearance", 22, "or take another law"),
    ("restitution = 0.8", "restitution = 0.8\nlaw = { kind = \"cylindrical\", other_radius = \"0.1 mm\" }", "contact.teeth.law.radius", 22, "summed, for the external cylindrical law"),
    ("restitution = 0.8", "restitution = 0.8\nlaw = { kind = \"esdu-78035\", other_radius = \"-1 mm\" }", "contact.teeth.law.other_radius", 22, "a hollow wider than"),
    ("restitution = 0.8", "restitution = 0.8\nfriction = { kind = \"bengisu-akay\", static_coefficient = 0.1, coefficient = 0.2, decay = \"500 s/m\" }", "contact.teeth.friction.static_coefficient", 22, "at least the coefficient of sliding"),
    ("friction = { coefficient = 0.1 }", "friction = { kind = \"lugre\", coefficient = 0.1 }", "contact.joints.friction.static_coefficient", 25, "missing"),
    ("friction = { coefficient = 0.1 }", "friction = { kind = \"viscous\", coefficient = 0.1 }", "contact.joints.friction.kind", 25, "known are none, coulomb, ambrosio"),
    ("friction = { coefficient = 0.1 }", "friction = { coeficient = 0.1 }", "contact.joints.friction.coeficient", 25, "did you mean `coefficient`?"),
    ("friction = { coefficient = 0.1 }", "friction = { kind = \"ambrosio\", coefficient = 0.1, lower_speed = \"2 mm/s\", upper_speed = \"1 mm/s\" }", "contact.joints.friction.upper_speed", 25, "must be"),
    // The catalogue.
    ("pitch = \"12.7 mm\"", "type = \"17B-1\"", "chain.type", 3, "no chain of the catalogue is named `17B-1`; did you mean"),
    ("pitch = \"12.7 mm\"", "type = \"bicycle\"", "chain.type", 3, "known are 04B-1"),
    ("[route]", "[run]\nevents = [\"tooth\"]\n[route]", "run.events[0]", 37, "did you mean `teeth`?"),
];

fn named(change: &str) -> String {
    let (_, rest) = GOOD.split_once("[contact.teeth]").expect("it is there");
    format!("{NAMED}{change}[contact.teeth]{rest}")
}

#[test]
fn the_scene_without_mistakes_is_accepted() {
    for text in [GOOD, &named("")] {
        let scene = Scene::from_text(text, "test.toml").unwrap_or_else(|error| panic!("{error}"));
        scene.drive().unwrap_or_else(|error| panic!("{error}"));
    }
}

#[test]
fn every_mistake_is_found_in_its_place() {
    all_found(
        GOOD,
        CASES,
        |found, expected| found.starts_with(expected),
        // Eight keys of rigid links, and what particles know in their place.
        9,
    );
}

#[test]
fn what_the_catalogue_lacks_is_asked_for() {
    for (old, new, path, fragment) in [
        (
            "081",
            "520",
            "chain.joint.clearance",
            "which the catalogue does not have for 520",
        ),
        (
            "081",
            "428",
            "chain.inner.mass",
            "which the catalogue does not have for 428",
        ),
        (
            "links = 78\n",
            "rollers = \"free\"\n",
            "chain.roller.clearance",
            "such as \"0.05 mm\"",
        ),
        (
            "links = 78\nmodel = \"clearance-joints\"",
            "links = 78\nmodel = \"particles\"\nouter_first = true",
            "chain.outer_first",
            "the particle chain has none",
        ),
    ] {
        let error = fails(&named("").replacen(old, new, 1));
        let found = error
            .problems
            .iter()
            .any(|problem| problem.path == path && problem.to_string().contains(fragment));
        assert!(found, "{new}: {path}: {fragment}\n{error}");
    }
    // What the catalogue lacks is told before the number of links, which nothing asks for yet.
    let error = fails("chain = \"219H\"");
    assert!(error.to_string().contains("chain.mass: missing"), "{error}");
}
