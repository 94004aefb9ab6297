//! Scenes with mistakes: every one is found, in its place, with a hint, and none makes the program panic.

use chaindrive::scene::{Problem, Scene, presets};
use chaindrive::{Run, Simulation};

use crate::mistakes::{Mistake, all_found, fails};

/// A scene without mistakes. The cases below change it and name the line of the mistake.
const GOOD: &str = r#"title = "Two sprockets"
gravity = ["0 m/s^2", "-9.81 m/s^2"]
[chain]
pitch = "25.4 mm"
links = 78
mass = "68.8 g"
stiffness = "161 MN/m"
damping_ratio = 0.03
roller_diameter = "15.88 mm"
[contact.teeth]
law = { kind = "power", stiffness = "6e11 N/m^1.5", exponent = 1.5 }
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
mass = "4 kg"
support = { kind = "tensioner", name = "slide" }
[[guides]]
name = "bar"
face = { kind = "bar", start = ["0.2 m", "-0.12 m"], end = ["0.5 m", "-0.12 m"] }
[[tensioners]]
name = "slide"
carrier = { kind = "slider", direction = [1, 0], mass = "1 kg" }
push = { kind = "spring", preload = "2 kN", stiffness = "10 kN/m" }
[route]
stops = ["driver", "driven"]
pretension = "1 kN"
"#;

#[rustfmt::skip]
const CASES: &[Mistake] = &[
    // Keys.
    ("links = 78", "link = 78", "chain.link", 5, "unknown key; did you mean `links`?"),
    ("teeth = 19\ncentre = [\"0 mm\"", "teath = 19\ncentre = [\"0 mm\"", "sprockets[0].teath", 15, "did you mean `teeth`?"),
    ("[route]", "[rout]", "rout", 33, "did you mean `route`?"),
    ("restitution = 0.8", "xyzzy = 0.8", "contact.teeth.xyzzy", 12, "known are law, series, restitution, damping"),
    ("pitch = \"25.4 mm\"\n", "", "chain.pitch", 3, "missing; give the nominal pitch"),
    ("mass = \"68.8 g\"\n", "", "chain.mass", 3, "missing"),
    ("stiffness = \"161 MN/m\"\n", "", "chain.stiffness", 3, "or `stiffnesses` as a list"),
    ("roller_diameter = \"15.88 mm\"\n", "", "chain.roller_diameter", 3, "missing; give the roller diameter"),
    ("name = \"driver\"\n", "", "sprockets[0].name", 13, "missing"),
    ("inertia = \"0.05 kg m^2\"\n", "", "sprockets[1].inertia", 18, "missing; give the moment of inertia of what turns with the sprocket"),
    ("mass = \"4 kg\"\n", "", "sprockets[1].mass", 18, "the centre can move"),
    (", mass = \"1 kg\" }", " }", "tensioners[0].carrier.mass", 31, "missing"),
    ("speed = \"300 rpm\"", "sped = \"300 rpm\"", "sprockets[0].motion.sped", 17, "a `constant` has no `sped`; did you mean `speed`?"),
    ("preload = \"2 kN\", ", "", "tensioners[0].push.preload", 32, "missing"),
    // Types.
    ("links = 78", "links = 78.5", "chain.links", 5, "found the number 78.5, needed is a whole number"),
    ("links = 78", "links = \"many\"", "chain.links", 5, "found the text \"many\""),
    ("links = 78", "links = 1979-05-27", "chain.links", 5, "found a date"),
    ("title = \"Two sprockets\"", "title = 3", "title", 1, "found the number 3, needed is a text"),
    ("title = \"Two sprockets\"", "settle = \"no\"", "settle", 1, "needed is true or false"),
    ("pitch = \"25.4 mm\"", "pitch = [1]", "chain.pitch", 4, "found a list, needed is a length such as \"88.9 mm\""),
    ("[chain]\n", "[chain.x]\n", "chain.x", 3, "unknown key"),
    ("centre = [\"0 mm\", \"0 mm\"]", "centre = [\"0 mm\"]", "sprockets[0].centre", 16, "1 values, needed are 2"),
    ("centre = [\"0 mm\", \"0 mm\"]", "centre = \"0 mm\"", "sprockets[0].centre", 16, "needed is a list"),
    ("load = [{", "load = [3, {", "sprockets[1].load[0]", 23, "needed is a table with a `kind`"),
    ("stops = [\"driver\", \"driven\"]", "stops = \"driver\"", "route.stops", 34, "needed is a list"),
    // Quantities.
    ("300 rpm", "12 mm", "sprockets[0].motion.speed", 17, "`12 mm` is a length, needed is an angular speed; such as \"1500 rpm\""),
    ("300 rpm", "5 1/s", "sprockets[0].motion.speed", 17, "1/s and Hz count events"),
    ("25.4 mm", "1 zoll", "chain.pitch", 4, "unknown unit `zoll`"),
    ("25.4 mm", "1 mil", "chain.pitch", 4, "write \"0.0254 mm\" for a thousandth of an inch"),
    ("\"68.8 g\"", "\"2.71 kg/m\"", "chain.mass", 6, "a mass per length, needed is a mass; that of a link is this times the pitch"),
    ("\"-40 N m\"", "\"-40 lb ft\"", "sprockets[1].load[0].torque", 23, "write \"10 lbf ft\""),
    ("25.4 mm", "25,4 mm", "chain.pitch", 4, "decimals are written with a point"),
    ("25.4 mm", "25.4", "chain.pitch", 4, "`25.4` has no unit"),
    ("\"25.4 mm\"", "nan", "chain.pitch", 4, "NaN is not a finite number"),
    ("\"161 MN/m\"", "inf", "chain.stiffness", 7, "inf is not a finite number"),
    ("\"161 MN/m\"", "\"1e999 N/m\"", "chain.stiffness", 7, "beyond what a double holds"),
    ("161 MN/m", "-161 MN/m", "chain.stiffness", 7, "-161000000, must be positive [N/m]"),
    ("25.4 mm", "0 mm", "chain.pitch", 4, "0, must be positive [m]"),
    ("6e11 N/m^1.5", "6e11 N/m", "contact.teeth.law.stiffness", 11, "with exponent = 1.5 the unit is N/m^1.5"),
    ("161 MN/m", "161 MN/m s", "chain.stiffness", 7, "what stands under `/`"),
    ("pretension = \"1 kN\"", "pretension = \"-1 kN\"", "route.pretension", 35, "must be not negative [N]"),
    ("restitution = 0.8", "restitution = 1.4", "contact.teeth.restitution", 12, "1.4, must be at most 1"),
    ("exponent = 1.5", "exponent = 7", "contact.teeth.law.exponent", 11, "7, must be at most 3"),
    ("-9.81 m/s^2", "-9.81 m/s", "gravity[1]", 2, "is a speed, needed is an acceleration"),
    // Forces.
    ("mass = \"4 kg\"", "mass = \"4 kg\"\nforce_x = [{ kind = \"constant\", force = nan }]", "sprockets[1].force_x[0].force", 25, "NaN is not a finite number"),
    ("mass = \"4 kg\"", "mass = \"4 kg\"\nforce_x = [{ kind = \"constant\", force = \"5 N m\" }]", "sprockets[1].force_x[0].force", 25, "needed is a force; such as"),
    ("mass = \"4 kg\"", "mass = \"4 kg\"\nforce_x = [{ kind = \"constant\", torque = \"5 N m\" }]", "sprockets[1].force_x[0].torque", 25, "a `constant` has no `torque`"),
    ("mass = \"4 kg\"", "mass = \"4 kg\"\nforce_x = [{ kind = \"resistance\", linear = 1 }]", "sprockets[1].force_x[0].kind", 25, "unknown kind `resistance`; known are constant, ramp, harmonic, orders"),
    ("mass = \"4 kg\"", "mass = \"4 kg\"\nforce_x = [{ kind = \"orders\", times = [0, 1], terms = [{ order = 2, amplitude = \"5 N\" }] }]", "sprockets[1].force_x[0].times", 25, "has no `times`"),
    ("mass = \"4 kg\"", "mass = \"4 kg\"\nforce_x = [{ kind = \"orders\", of = \"drver\", terms = [{ order = 2, amplitude = \"5 N\" }] }]", "sprockets[1].force_x[0].of", 25, "no shaft or sprocket is named `drver`; did you mean `driver`?"),
    ("mass = \"4 kg\"", "mass = \"4 kg\"\nforce_x = [{ kind = \"angle-table\", angles = [0, \"360 deg\"], forces = [0, \"5 N\"] }]", "sprockets[1].force_x[0].forces", 25, "the force jumps from 5 to 0 N where it repeats; give the same force"),
    ("mass = \"4 kg\"", "mass = \"4 kg\"\nforce_x = [{ kind = \"ramp\", force = \"5 N\", duration = 0 }]", "sprockets[1].force_x[0].duration", 25, "0, must be positive [s]"),
    ("name = \"slide\"\ncarrier", "name = \"slide\"\nforce_y = [{ kind = \"harmonic\", order = 2, amplitude = \"5 N\" }]\ncarrier", "tensioners[0].force_y[0].of", 31, "a tensioner has no shaft of its own; name in `of`"),
    ("name = \"slide\"\ncarrier", "name = \"slide\"\nforce_at = [0, 0]\ncarrier", "tensioners[0].force_at", 31, "a force on a slider needs no point; leave it out"),
    // Ranges of counts.
    ("links = 78", "links = 0", "chain.links", 5, "0, must be at least 1"),
    ("links = 78", "links = 2", "chain.links", 5, "at least 3 in a closed chain"),
    ("links = 78", "links = -4", "chain.links", 5, "-4, must be at least 1"),
    ("links = 78", "links = 99999999999", "chain.links", 5, "must be at most 100000"),
    ("teeth = 19\ncentre = [\"0 mm\"", "teeth = 1000\ncentre = [\"0 mm\"", "sprockets[0].teeth", 15, "1000, must be at most 600"),
    ("teeth = 19\ncentre = [\"0 mm\"", "teeth = 3\ncentre = [\"0 mm\"", "sprockets[0].teeth", 15, "3, must be at least 5"),
    ("15.88 mm", "30 mm", "chain.roller_diameter", 9, "smaller than the pitch"),
    // Kinds.
    ("kind = \"constant\", speed", "kind = \"constnt\", speed", "sprockets[0].motion.kind", 17, "unknown kind `constnt`; did you mean `constant`?"),
    ("kind = \"power\"", "kind = \"quantum\"", "contact.teeth.law.kind", 11, "known are linear, power, hertz, johnson, conformal"),
    ("kind = \"spring\"", "kind = 3", "tensioners[0].push.kind", 32, "needed is a text"),
    ("kind = \"spring\", ", "", "tensioners[0].push.kind", 32, "missing; the kinds are locked, spring"),
    ("push = { kind = \"spring\", preload = \"2 kN\", stiffness = \"10 kN/m\" }", "push = \"lokced\"", "tensioners[0].push", 32, "did you mean `locked`?"),
    ("push = { kind = \"spring\", preload = \"2 kN\", stiffness = \"10 kN/m\" }", "push = \"spring\"", "tensioners[0].push.preload", 32, "missing"),
    ("name = \"bar\"", "name = \"bar\"\ntouches = \"pins\"", "guides[0].touches", 28, "unknown value `pins`; known are rollers, eyes, plates"),
    ("pretension = \"1 kN\"", "tighten = \"loose\"", "route.tighten", 35, "known are rest-length, travel"),
    // Names.
    ("name = \"driven\"", "name = \"driver\"", "sprockets[1].name", 19, "`driver` is taken; names must differ"),
    ("name = \"bar\"", "name = \"driven\"", "guides[0].name", 27, "`driven` is taken"),
    ("name = \"bar\"", "name = \"\"", "guides[0].name", 27, "the name is empty"),
    ("name = \"bar\"", "name = \"a.b\"", "guides[0].name", 27, "has a point or a bracket"),
    ("[\"driver\", \"driven\"]", "[\"driver\", \"drivn\"]", "route.stops[1]", 34, "no sprocket or guide is named `drivn`; did you mean `driven`?"),
    ("[\"driver\", \"driven\"]", "[\"driver\", \"driven\", \"driver\"]", "route.stops[2]", 34, "`driver` stands twice"),
    ("[\"driver\", \"driven\"]", "[\"driver\"]", "route.stops", 34, "1 stops, but a closed chain has at least two"),
    ("[\"driver\", \"driven\"]", "[\"bar\", \"driven\"]", "route.stops[0]", 34, "the first stop must be a sprocket"),
    ("name = \"slide\" }", "name = \"slider\" }", "sprockets[1].support.name", 25, "no tensioner is named `slider`; did you mean `slide`?"),
    ("support = { kind = \"tensioner\", name = \"slide\" }\n", "", "tensioners[0]", 28, "`slide` carries nothing"),
    // Parts that do not go together.
    ("749.3 mm", "150 mm", "sprockets[1].centre", 21, "overlaps sprocket `driver` by"),
    ("damping_ratio = 0.03", "damping_ratio = 0.03\ndamping = \"1 kN s/m\"", "chain.damping_ratio", 8, "`damping` is given too; keep one of them"),
    ("restitution = 0.8", "restitution = 0.8\ndamping = \"1 kN s/m\"", "contact.teeth.damping", 13, "`restitution` is given too"),
    ("inertia = \"0.05 kg m^2\"", "motion = \"held\"", "sprockets[1].load", 23, "`motion` is given too"),
    ("support = {", "support = \"fixed\"\nsupport = {", "", 26, "duplicate key"),
    ("mass = \"68.8 g\"", "masses = [1, 2]", "chain.masses", 6, "2 values, needed are 78, one for every roller"),
    ("pitch = \"25.4 mm\"", "pitch = \"25.4 mm\"\npitches = [1]", "chain.pitches", 5, "1 values, needed are 78"),
    ("links = 78", "links = 79\ninner_pitch = \"25.5 mm\"", "chain.links", 5, "needs an even number"),
    ("links = 78", "links = 78\nends = [\"fixed\", \"free\"]", "chain.start", 3, "missing; say where an open strand lies"),
    ("links = 78", "links = 78\nends = [\"fixed\"]", "chain.ends", 6, "1 values, needed are 2"),
    ("links = 78", "links = 78\nstart = { kind = \"ring\" }", "route", 34, "lays the chain already"),
    ("links = 78", "links = 78\nstart = { kind = \"line\", from = [0, 0], to = [1, 0] }", "chain.start", 6, "only an open strand can lie so"),
    ("links = 78", "links = 78\nstart = { kind = \"points\", positions = [[0, 0]] }", "chain.start.positions", 6, "1 values, needed are 78"),
    ("kind = \"constant\", speed = \"300 rpm\"", "kind = \"table\", times = [0, 1, 1], values = [0, 1, 2]", "sprockets[0].motion.times", 17, "times must increase, but entry 2 does not"),
    ("kind = \"constant\", speed = \"300 rpm\"", "kind = \"table\", times = [0, 1, 2], values = [0, 1]", "sprockets[0].motion.times", 17, "3 times and 2 values"),
    ("kind = \"constant\", torque = \"-40 N m\"", "kind = \"angle-table\", angles = [\"0 deg\", \"90 deg\"], torques = [0, 1]", "sprockets[1].load[0].angles", 23, "let it run from 0 to 360 deg"),
    ("kind = \"constant\", torque = \"-40 N m\"", "kind = \"angle-table\", turns = 2, angles = [\"0 deg\", \"360 deg\"], torques = [1, 1]", "sprockets[1].load[0].angles", 23, "let it run from 0 to 720 deg"),
    ("kind = \"constant\", torque = \"-40 N m\"", "kind = \"angle-table\", turns = 3, angles = [\"0 deg\", \"360 deg\"], torques = [1, 1]", "sprockets[1].load[0].turns", 23, "at most 2"),
    ("kind = \"constant\", torque = \"-40 N m\"", "kind = \"angle-table\", angles = [\"0 deg\", \"360 deg\"], torques = [1, 2]", "sprockets[1].load[0].torques", 23, "give the same torque at both ends"),
    ("kind = \"constant\", torque = \"-40 N m\"", "kind = \"angle-table\", of = \"drivr\", angles = [\"0 deg\", \"360 deg\"], torques = [1, 1]", "sprockets[1].load[0].of", 23, "did you mean `driver`?"),
    ("kind = \"constant\", torque = \"-40 N m\"", "kind = \"orders\", of = \"bar\", terms = [{ order = 2, amplitude = 1 }]", "sprockets[1].load[0].of", 23, "no shaft or sprocket is named `bar`"),
    ("kind = \"constant\", torque = \"-40 N m\"", "kind = \"orders\", terms = [{ order = 0, amplitude = 1 }]", "sprockets[1].load[0].terms[0].order", 23, "0, must be positive; the mean is no order: give that of a motion as its `speed`"),
    ("kind = \"constant\", speed = \"300 rpm\"", "kind = \"orders\", speed = 3, terms = [{ order = 0, amplitude = 0.1 }]", "sprockets[0].motion.terms[0].order", 17, "that of a torque or force as one of the kind `constant` in the same list"),
    ("kind = \"constant\", torque = \"-40 N m\"", "kind = \"orders\", terms = [{ order = 2, amplitude = \"3 mm\" }]", "sprockets[1].load[0].terms[0].amplitude", 23, "torque"),
    ("kind = \"constant\", speed = \"300 rpm\"", "kind = \"orders\", terms = [{ order = 2, amplitude = 0.1 }]", "sprockets[0].motion.speed", 17, "give the mean speed, or in `of`"),
    ("kind = \"constant\", speed = \"300 rpm\"", "kind = \"orders\", of = \"driven\", terms = [{ order = 2, amplitude = 0.1 }]", "sprockets[0].motion.of", 17, "`driven` has no mean speed"),
    ("kind = \"constant\", speed = \"300 rpm\"", "kind = \"orders\", speed = 3, terms = [{ order = 2, frequency = 3, amplitude = 0.1 }]", "sprockets[0].motion.terms[0].frequency", 17, "unknown key"),
    ("support = { kind = \"tensioner\", name = \"slide\" }", "support = { kind = \"prescribed\", x = \"held\", y = { kind = \"orders\", terms = [{ order = 1, amplitude = \"1 mm\" }] } }", "sprockets[1].support.y.of", 25, "name the shaft whose turns count"),
    ("direction = [1, 0]", "direction = [0, 0]", "tensioners[0].carrier.direction", 31, "must not be zero"),
    ("kind = \"slider\", direction = [1, 0], mass = \"1 kg\"", "kind = \"arm\", pivot = [0, 0], inertia = \"1 kg m^2\"", "tensioners[0].push", 32, "give the arm a `plunger`"),
    ("kind = \"spring\", preload = \"2 kN\", stiffness = \"10 kN/m\"", "kind = \"hydraulic\", preload = \"2 kN\"", "tensioners[0].push.leak", 32, "or `oil`, from which they follow"),
    ("kind = \"spring\", preload = \"2 kN\", stiffness = \"10 kN/m\"", "kind = \"hydraulic\", preload = \"2 kN\", extending = 200, relieving = 150, oil = { diameter = \"12 mm\", length = \"25 mm\", gap = \"25 µm\", viscosity = \"10 mPa s\", relief = \"3 MPa\", bulk_modulus = \"1 GPa\", air = \"1 %\" }", "tensioners[0].push.oil.volume", 32, "needs `bulk_modulus`, `volume` and `air`"),
    ("kind = \"spring\", preload = \"2 kN\", stiffness = \"10 kN/m\"", "kind = \"hydraulic\", preload = \"2 kN\", relieving = 150, oil = { diameter = \"12 mm\", length = \"25 mm\", gap = \"25 µm\", viscosity = \"10 mPa s\", relief = \"3 MPa\", bulk_modulus = \"1 GPa\", volume = \"4 cm^3\", air = \"1 %\" }", "tensioners[0].push.extending", 32, "needs a valve with a resistance"),
    ("kind = \"spring\", preload = \"2 kN\", stiffness = \"10 kN/m\"", "kind = \"hydraulic\", preload = \"2 kN\", extending = 200, relieving = 150, oil = { diameter = \"12 mm\", length = \"25 mm\", gap = \"25 µm\", viscosity = \"10 mPa s\", relief = \"3 MPa\", bulk_modulus = \"1 GPa\", volume = \"4 cm\", air = \"1 %\" }", "tensioners[0].push.oil.volume", 32, "needed is a volume"),
    ("kind = \"spring\", preload = \"2 kN\", stiffness = \"10 kN/m\"", "kind = \"hydraulic\", preload = \"2 kN\", extending = 200, relieving = 150, oil = { diameter = \"12 mm\", length = \"25 mm\", gap = \"25 µm\", viscosity = \"10 mPa s\", relief = \"3 MPa\", bulk_modulus = nan, volume = \"4 cm^3\", air = \"1 %\" }", "tensioners[0].push.oil.bulk_modulus", 32, "finite"),
    ("pretension = \"1 kN\"", "tighten = \"travel\"", "route.tighten", 35, "nothing is there to travel"),
    ("pretension = \"1 kN\"", "adjust = { kind = \"arm\", name = \"slide\", within = \"1 deg\" }", "route.adjust.name", 35, "`slide` is of the kind slider; take `kind = \"slider\"`"),
    ("end = [\"0.5 m\", \"-0.12 m\"]", "end = [\"0.2 m\", \"-0.12 m\"]", "guides[0].face", 28, "coincide"),
    ("end = [\"0.5 m\", \"-0.12 m\"]", "end = [\"0.5 m\", \"-0.12 m\"], end_angle = \"200 deg\"", "guides[0].face", 28, "must be in (0, π]"),
    ("teeth = 19\ncentre = [\"0 mm\"", "teeth = 19\ntooth = { kind = \"circular\", seat_radius = \"5 mm\" }\ncentre = [\"0 mm\"", "sprockets[0].tooth", 16, "at least the roller radius"),
    ("teeth = 19\ncentre = [\"0 mm\"", "teeth = 19\ntooth = { kind = \"iso606\", gap = \"wide\" }\ncentre = [\"0 mm\"", "sprockets[0].tooth.gap", 16, "does not begin with a number"),
    // Syntax.
    ("links = 78", "links = = 78", "", 5, "not TOML"),
    ("links = 78", "links = 78\nlinks = 80", "", 6, "not TOML: duplicate key"),
    ("[chain]", "[chain", "", 3, "not TOML"),
];

#[test]
fn the_scene_without_mistakes_is_accepted() {
    let scene = Scene::from_text(GOOD, "test.toml").unwrap_or_else(|error| panic!("{error}"));
    scene.drive().unwrap_or_else(|error| panic!("{error}"));
}

#[test]
fn every_mistake_is_found_in_its_place() {
    all_found(GOOD, CASES, |found, expected| found == expected, usize::MAX);
}

#[test]
fn one_mistake_makes_one_problem() {
    let chatty: Vec<_> = CASES
        .iter()
        .map(|(old, new, ..)| (new, fails(&GOOD.replacen(old, new, 1))))
        .filter(|(_, error)| error.problems.len() > 3)
        .map(|(new, error)| format!("{new}\n{error}"))
        .collect();
    assert!(chatty.is_empty(), "{}", chatty.join("\n\n"));
}

#[test]
fn all_problems_are_reported_at_once_in_the_order_of_the_text() {
    let text = GOOD
        .replace("25.4 mm", "25.4 rpm")
        .replace("links = 78", "links = 0")
        .replace("restitution = 0.8", "restitutoin = 0.8")
        .replace("300 rpm", "300 rpn")
        .replace("kind = \"spring\"", "kind = \"string\"");
    let error = fails(&text);
    let paths: Vec<_> = error
        .problems
        .iter()
        .map(|problem| problem.path.as_str())
        .collect();
    let expected = [
        "chain.pitch",
        "chain.links",
        "contact.teeth.restitutoin",
        "sprockets[0].motion.speed",
        "tensioners[0].push.kind",
    ];
    assert_eq!(paths, expected, "{error}");
    assert_eq!(error.to_string().lines().count(), 5);
    assert!(
        error
            .to_string()
            .starts_with("test.toml:4:9: chain.pitch: `25.4 rpm` is")
    );
}

#[test]
fn problems_of_the_whole_drive_are_reported_at_once_too() {
    let text = GOOD
        .replace("name = \"driven\"", "name = \"driver\"")
        .replace("name = \"slide\" }", "name = \"slid\" }")
        .replace("\"driven\"]", "\"xyzzy\"]");
    let error = fails(&text);
    assert!(error.problems.len() >= 3, "{error}");
}

#[test]
fn texts_that_are_no_scene() {
    for (text, fragment) in [
        ("", "chain: missing"),
        ("   \n\n", "chain: missing"),
        ("# nothing but a comment", "chain: missing"),
        ("{}", "chain: missing"),
        ("{\"chain\": [}", "not JSON"),
        ("{\"chain\": null}", "chain: missing"),
        ("{\"chain\": {\"pitch\": NaN}}", "not JSON"),
        (
            "{\"chain\": {\"pitch\": 1e999}}",
            "not JSON: number out of range",
        ),
        ("[1, 2]", "not TOML"),
        ("null", "not TOML"),
        ("\0\u{1}\u{2}", "not TOML"),
        ("chain = 3", "chain: found the number 3, needed is a table"),
        ("chain = []", "chain: found a list, needed is a table"),
        ("[[chain]]", "chain: found a list, needed is a table"),
        (
            "[chain]\npitch = 1\nlinks = 4\nmass = 1\nstiffness = 1",
            "0 sprockets, but a closed chain runs around at least two",
        ),
    ] {
        let error = fails(text);
        assert!(error.to_string().contains(fragment), "{text:?}\n{error}");
    }
    let deep = format!("x = {}", "[".repeat(100_000));
    assert!(fails(&deep).to_string().contains("nested deeper"));
    let deep = format!("{{\"x\": {}", "[".repeat(100_000));
    assert!(fails(&deep).to_string().contains("nested deeper"));
}

#[test]
fn problems_in_json_have_places() {
    let text = "\n{\"chain\": {\"title\": null,\n  \"pitch\": \"3 rpm\", \"links\": 4}}";
    let error = fails(text);
    let line = "test.toml:3:12: chain.pitch: `3 rpm` is an angular speed, needed is a length; such as \"88.9 mm\"";
    assert_eq!(error.to_string(), line);
    let excerpt = "\n  3 |   \"pitch\": \"3 rpm\", \"links\": 4}}\n    |            ^^^^^^^";
    assert_eq!(format!("{error:#}"), format!("{line}{excerpt}"));
    // Unknown keys are shown themselves, whatever is written with escapes before them.
    let error = fails(r#"{"title": "µ \u00b5", "chain": {"type": "16B-1", "linkz": 4}}"#);
    let place = error.problems[0].place.expect("it stands in the text");
    assert_eq!(place.columns, Some([50, 57]), "{error}");
    let error = Scene::from_data(text, "mine").unwrap_err();
    assert!(
        error.to_string().starts_with("mine: chain.pitch: `3 rpm`"),
        "{error}"
    );
}

#[test]
fn a_key_of_json_stands_once() {
    let error = fails("{\"chain\": {\"links\": 4,\n \"links\": 6}}");
    let text = "test.toml:2:2: the key `links` stands twice in this table; keep one of them";
    assert_eq!(error.to_string(), text);
    let error = fails(r#"{"chain": {"links": 4}, "chain": {"pitch": 3}}"#);
    assert!(
        error.to_string().contains("the key `chain` stands twice"),
        "{error}"
    );
    // An entry that is null is absent, not another one.
    fails(r#"{"chain": {"links": 4, "mass": null}, "title": null}"#);
}

/// A table of measured values may stand on one line, and something else after it.
#[test]
fn long_lines_are_read_at_once() {
    let pairs = "[0.5, 1.5], ".repeat(150_000);
    let pairs = pairs.trim_end_matches(", ");
    for text in [
        format!("chain = {{ x = [{pairs}], 'µ' = 1, links = 4 }}"),
        format!("{{\"chain\": {{\"x\": [{pairs}], \"µ\": 1, \"links\": 4}}}}"),
    ] {
        let error = fails(&text);
        let column = text.find('µ').map(|at| at + 1);
        // With its quotation marks or without them.
        let starts = error
            .problems
            .iter()
            .filter_map(|it| Some(it.place?.columns?[0]));
        let near = starts.filter(|start| column.is_some_and(|at| at - 1 <= *start && *start <= at));
        assert_eq!(near.count(), 1, "{error}");
    }
}

#[test]
fn files_that_are_no_scene() {
    let folder = std::env::temp_dir().join(format!("chaindrive-scenes-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let write = |name: &str, bytes: &[u8]| {
        let path = folder.join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    };
    let huge = folder.join("huge.toml");
    std::fs::File::create(&huge)
        .unwrap()
        .set_len(17 << 20)
        .unwrap();
    for (path, fragment) in [
        (
            folder.join("missing.toml"),
            "missing.toml: there is no such file",
        ),
        (folder.clone(), "this is a folder"),
        (write("empty.toml", b""), "empty.toml:1: chain: missing"),
        (
            write("binary.toml", b"title = '\xff\xfe'"),
            "byte 9 is not UTF-8",
        ),
        (
            write("picture.toml", b"\x89PNG\r\n\x1a\n\0\0"),
            "byte 0 is not UTF-8",
        ),
        (huge, "larger than 16 MiB"),
    ] {
        let error = Scene::read(&path).unwrap_err();
        assert!(error.to_string().contains(fragment), "{error}");
    }
    let good = write(
        "good.toml",
        format!("\u{feff}{}", GOOD.replace('\n', "\r\n")).as_bytes(),
    );
    Scene::read(good)
        .unwrap_or_else(|error| panic!("{error}"))
        .drive()
        .unwrap();
    std::fs::remove_dir_all(&folder).unwrap();
}

/// Numbers for the mutations below, the same every time.
struct Dice(u64);

impl Dice {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        usize::try_from(self.0 >> 33).expect("31 bits") % n.max(1)
    }
}

/// Random damage to the embedded scenes: characters and words changed, lines moved, texts cut.
#[test]
fn damaged_scenes_never_panic() {
    let (accepted, refused) = damage(1, 120, |_, _| {});
    assert!(
        accepted > 50 && refused > 500,
        "{accepted} accepted, {refused} refused"
    );
}

/// Two thousand mutants, each of them brought as far as it goes: resolved, assembled, run for some steps, in
/// bounded time and without a panic.
#[test]
#[ignore = "takes minutes; `make validation` runs it"]
fn two_thousand_mutants_run_or_are_refused() {
    let slowest = std::cell::Cell::new(std::time::Duration::ZERO);
    let (accepted, refused) = damage(2, 2000 / presets().len() + 1, |scene, text| {
        let begin = std::time::Instant::now();
        // What `resolved` says is a scene, and the same drive.
        let full = scene.resolved().unwrap_or_else(|e| panic!("{e}\n{text}"));
        let drive = scene.drive().expect("it was one");
        let again = full.drive().unwrap_or_else(|e| panic!("{e}\n{text}"));
        assert_eq!(format!("{again:?}"), format!("{drive:?}"), "{text}");
        // A mutant may have a hundred thousand links.
        if drive.chains[0].chain.links() < 500
            && let Ok(assembled) = drive.assemble()
        {
            let run = Run {
                until: 1e-5,
                every: 1e-5,
                step: Some(1e-6),
                ..Run::default()
            };
            if let Ok(mut simulation) = Simulation::from_assembled(assembled, &run) {
                while let Ok(Some(_)) = simulation.next_sample() {}
            }
        }
        slowest.set(slowest.get().max(begin.elapsed()));
    });
    assert!(accepted + refused >= 2000);
    assert!(slowest.get().as_secs() < 60, "{:?}", slowest.get());
}

/// Numbers of damaged scenes that are drives, each handed to `use_it`, and that are not.
fn damage(seed: u64, each: usize, use_it: impl Fn(&Scene, &str)) -> (usize, usize) {
    const WORDS: [&str; 24] = [
        "nan",
        "inf",
        "-1",
        "0",
        "1e308",
        "-1e-308",
        "\"\"",
        "\"1e300 km\"",
        "[]",
        "{}",
        "true",
        "=",
        "\n",
        "[x]",
        "[[chain]]",
        "'mm'",
        "kind = 'table'",
        "links = 1",
        "99999999999999999999",
        "\u{fffd}",
        "µ",
        "[[sprockets]]\n",
        "3 rpm",
        "1979-05-27",
    ];
    let mut dice = Dice(seed);
    let (mut accepted, mut refused) = (0, 0);
    for (name, _) in presets() {
        let text = Scene::preset(name)
            .expect("it is embedded")
            .text()
            .to_owned();
        for _ in 0..each {
            let mut damaged: Vec<char> = text.chars().collect();
            for _ in 0..=dice.below(4) {
                let at = dice.below(damaged.len());
                match dice.below(6) {
                    0 => drop(damaged.drain(at..(at + dice.below(30)).min(damaged.len()))),
                    1 => damaged.truncate(at.max(200)),
                    2 => damaged
                        .splice(at..at, WORDS[dice.below(WORDS.len())].chars())
                        .for_each(drop),
                    3 => {
                        // The value of some line.
                        let word = WORDS[dice.below(WORDS.len())];
                        if let Some(start) = damaged[at..].iter().position(|c| *c == '=') {
                            let start = at + start + 1;
                            let end = damaged[start..]
                                .iter()
                                .position(|c| *c == '\n')
                                .map_or(damaged.len(), |n| start + n);
                            damaged.splice(start..end, word.chars()).for_each(drop);
                        }
                    }
                    4 => {
                        let end = (at + dice.below(200)).min(damaged.len());
                        let copy: Vec<char> = damaged[at..end].to_vec();
                        let to = dice.below(damaged.len());
                        damaged.splice(to..to, copy).for_each(drop);
                    }
                    _ => {
                        let other = dice.below(damaged.len());
                        let last = damaged.len() - 1;
                        damaged.swap(at.min(last), other);
                    }
                }
            }
            let damaged: String = damaged.into_iter().collect();
            let scene = Scene::from_text(&damaged, "damaged");
            match scene.and_then(|scene| scene.drive().map(|_| scene)) {
                Ok(scene) => {
                    accepted += 1;
                    use_it(&scene, &damaged);
                }
                Err(error) => {
                    assert!(
                        !error.problems.is_empty() && !error.to_string().contains("bug"),
                        "{error}"
                    );
                    refused += 1;
                }
            }
        }
    }
    (accepted, refused)
}

/// What was put in the place of an entry of a list stands on no line of the text that was read.
#[test]
fn what_was_changed_in_a_list_has_no_line() {
    let scene = Scene::preset("marine_two_sprockets").unwrap();
    let error = scene.replace("sprockets[1].teeth", "2").unwrap_err();
    let nowhere = |it: &Problem| it.place.is_none() && it.excerpt.is_none();
    assert!(error.problems.iter().all(nowhere), "{error}");
}
