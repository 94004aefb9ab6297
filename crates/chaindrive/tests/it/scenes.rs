//! The embedded scenes, the shipped schema, and changes to scenes.

use chaindrive::Stepping;
use chaindrive::scene::{Scene, presets, schema};

#[test]
fn every_preset_becomes_a_drive() {
    for (name, description) in presets() {
        let scene = Scene::preset(name).unwrap_or_else(|error| panic!("{error}"));
        assert!(
            !scene.title().is_empty() && !description.is_empty(),
            "{name}"
        );
        let run = scene.run_defaults();
        assert!(run.until.is_some() && run.every.is_some(), "{name}");
        scene.drive().unwrap_or_else(|error| panic!("{error}"));
    }
}

#[test]
fn the_shipped_schema_is_current() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/chaindrive.schema.json");
    let current = format!("{:#}\n", schema());
    if std::env::var_os("UPDATE_SCHEMA").is_some() {
        std::fs::write(path, &current).unwrap();
    }
    let shipped = std::fs::read_to_string(path).unwrap_or_default();
    assert_eq!(
        serde_json::from_str::<serde_json::Value>(&shipped).ok(),
        Some(schema()),
        "run this test with UPDATE_SCHEMA=1 to write the schema anew"
    );
}

#[test]
fn a_preset_that_does_not_exist_names_its_neighbour() {
    let error = Scene::preset("marine").unwrap_err();
    assert!(error.to_string().contains("known are"), "{error}");
    let error = Scene::preset("timing_dirve").unwrap_err();
    assert!(
        error.to_string().contains("did you mean `timing_drive`?"),
        "{error}"
    );
}

#[test]
fn the_marine_preset_is_what_its_source_says() {
    let drive = Scene::preset("marine_engine_bare")
        .unwrap()
        .drive()
        .unwrap();
    assert_eq!(drive.chains[0].chain.links(), 122);
    assert!((drive.chains[0].chain.stiffness[7] - 815e6).abs() < 1e-3);
    // c = 2 ζ √(k m) = 2.97 kN s/m
    assert!((drive.chains[0].chain.damping[7] - 2.97e3).abs() < 5.0);
    assert!((drive.sprockets[0].gap.pitch_radius - 0.679_631_089_876_26).abs() < 1e-14);
    assert_eq!(drive.guides.len(), 3);
}

#[test]
fn values_are_replaced_by_name_and_by_index() {
    let scene = Scene::preset("marine_engine").unwrap();
    let inertia = |scene: &Scene| scene.drive().unwrap().sprockets[1].inertia;
    assert!((inertia(&scene) - 251.0).abs() < 1e-12);
    for path in [
        "sprockets.camshaft.inertia",
        "sprockets.1.inertia",
        "sprockets[1].inertia",
    ] {
        let other = scene.replace(path, "300 kg m^2").unwrap();
        assert!((inertia(&other) - 300.0).abs() < 1e-12);
        let other = scene.replace_json(path, &serde_json::json!(300)).unwrap();
        assert!((inertia(&other) - 300.0).abs() < 1e-12);
    }
}

#[test]
fn the_text_of_a_changed_scene_reproduces_it_and_keeps_its_comments() {
    let scene = Scene::preset("marine_engine_bare").unwrap();
    let other = scene
        .replace("chain.damping_ratio", "0.01")
        .and_then(|scene| scene.replace("run.method", "verlet"))
        .and_then(|scene| scene.replace("sprockets.idler.contact.friction.coefficient", "0.1"))
        .and_then(|scene| scene.replace("tensioners.tightener.push", "locked"))
        .and_then(|scene| scene.replace("sprockets.camshaft.load", "[]"))
        .and_then(|scene| scene.replace("sprockets.crank.motion.speed", "-100 rpm"))
        .unwrap_or_else(|error| panic!("{error}"));
    assert!(
        other.text().contains("damping_ratio = 0.01 # assumed"),
        "{}",
        other.text()
    );
    assert!(other.text().contains("# Reconstructed: teeth"));
    assert_eq!(other.run_defaults().method, Some(Stepping::Verlet));
    let drive = other.drive().unwrap_or_else(|error| panic!("{error}"));
    assert!((drive.chains[0].chain.damping[0] - 990.5).abs() < 1.0);
    let again = Scene::from_text(other.text(), other.name()).unwrap();
    assert_eq!(again, other);
}

#[test]
fn a_scene_in_json_stays_json() {
    let text = r#"{"chain": {"pitch": "10 mm", "links": 8, "mass": 0.01, "stiffness": 1e6,
        "start": {"kind": "ring", "speed": "100 rad/s"}}, "gravity": [0, 0]}"#;
    let scene = Scene::from_text(text, "ring.json").unwrap();
    let other = scene.replace("chain.links", "12").unwrap();
    let other = other.replace("chain.start.speed", "900 rpm").unwrap();
    assert!(other.text().starts_with('{'));
    assert_eq!(other.drive().unwrap().chains[0].chain.links(), 12);
}

#[test]
fn a_value_is_left_out_and_the_rest_of_the_text_stays() {
    let scene = Scene::preset("marine_engine_bare").unwrap();
    let asking = scene.replace("run.accuracy", "0.1 %").unwrap();
    assert_eq!(asking.run_defaults().accuracy, Some(1e-3));
    let again = asking.without("run.accuracy").unwrap();
    assert_eq!(again.text(), scene.text());
    // What is not there is not missed.
    assert_eq!(scene.without("run.accuracy").unwrap(), scene);
    let idle = scene.without("sprockets.camshaft.load").unwrap();
    assert!(!idle.text().contains("camshaft load"), "{}", idle.text());
    assert!(idle.datum("sprockets.camshaft.load[0].torque").is_none());
    let json = r#"{"chain": {"pitch": "10 mm", "links": 8, "mass": 0.01, "stiffness": 1e6,
        "start": {"kind": "ring", "speed": "100 rad/s"}}, "run": {"step": 1e-6, "accuracy": 0.01}}"#;
    let ring = Scene::from_text(json, "ring.json").unwrap();
    let ring = ring.without("run.accuracy").unwrap();
    assert_eq!(ring.run_defaults().accuracy, None);
    assert_eq!(ring.run_defaults().step, Some(1e-6));
    for (path, words) in [
        ("chain.pitch", "chain.pitch: missing"),
        ("sprockets[0]", "nothing can be left out here"),
    ] {
        let error = scene.without(path).unwrap_err().to_string();
        assert!(error.contains(words), "{path}: {error}");
    }
}

#[test]
fn replacements_that_lead_nowhere() {
    let scene = Scene::preset("marine_engine").unwrap();
    for (path, value, fragment) in [
        (
            "sprockets.idle.inertia",
            "1",
            "there is no `idle` in a list of 4; did you mean `idler`?",
        ),
        (
            "chain.link",
            "1",
            "chain.link: unknown key; did you mean `links`?",
        ),
        ("", "1", "the path is empty"),
        ("chain.links.x", "1", "nothing can be put here"),
        ("sprockets.9.teeth", "12", "there is no `9`"),
        ("chain.links", "0", "must be at least 1"),
        ("chain.links", "many", "needed is a whole number"),
        ("chain.pitch", "12 rpm", "needed is a length"),
    ] {
        let error = scene.replace(path, value).unwrap_err();
        assert!(error.to_string().contains(fragment), "{path}: {error}");
    }
    assert!(
        scene
            .replace_json("chain.links", &serde_json::Value::Null)
            .is_err()
    );
}

#[test]
fn lists_may_share_a_unit() {
    let scene = Scene::preset("industrial_16b").unwrap();
    let motion = "{ kind = 'table', times = { unit = 'ms', values = [0, 20, 50.5] }, values = { unit = 'deg', values = [0, 10, 30] } }";
    let shared = scene.replace("sprockets.driver.motion", motion).unwrap();
    let spelt = "{ kind = 'table', times = ['0 ms', '20 ms', '50.5 ms'], values = ['0 deg', '10 deg', '30 deg'] }";
    let spelt = scene.replace("sprockets.driver.motion", spelt).unwrap();
    let rotation = |scene: &Scene| scene.drive().unwrap().shafts[0].rotation.clone();
    assert_eq!(rotation(&shared), rotation(&spelt));
}

#[test]
fn scatter_is_the_same_every_time_and_follows_the_seed() {
    let scene = Scene::preset("spinning_ring").unwrap();
    let lengths = |seed: &str| {
        let scatter = format!("{{ pitch = '0.05 %', mass = '1 %', seed = {seed} }}");
        scene
            .replace("chain.scatter", &scatter)
            .unwrap()
            .drive()
            .unwrap()
            .chains[0]
            .chain
            .lengths
            .clone()
    };
    assert_eq!(lengths("1"), lengths("1"));
    assert_ne!(lengths("1"), lengths("2"));
    assert!(
        lengths("3")
            .iter()
            .all(|length| (length / 0.0127 - 1.0).abs() < 0.003)
    );
}

/// A spinning ring is laid where its tension holds it (theory: l = k p/(k − m ω²/(4 sin²(π/N)))).
#[test]
fn starts_lie_where_they_should() {
    use chaindrive_mechanics::Layout;
    let points = |name: &str| {
        let drive = Scene::preset(name).unwrap().drive().unwrap();
        match &drive.chains[0].layout {
            Layout::Points {
                positions,
                velocities,
            } => (positions.clone(), velocities.clone()),
            Layout::Route { .. } => panic!("{name} has a route"),
        }
    };
    let (ring, speeds) = points("spinning_ring");
    assert!((ring[3].coords.norm() - 0.047_493_36).abs() < 1e-8);
    assert!((speeds[5].norm() - 18.997_344).abs() < 1e-6);
    let (strand, _) = points("hanging_chain");
    assert_eq!(strand.len(), 21);
    assert!(
        strand
            .windows(2)
            .all(|pair| ((pair[1] - pair[0]).norm() - 0.0127).abs() < 1e-12)
    );
    assert!((strand[20].x - 0.251_46).abs() < 1e-12 && strand[20].y.abs() < 1e-12);
    assert!((strand[10].y + 0.0155).abs() < 3e-4, "{}", strand[10]);
}

/// Smallest and largest link tension \[N\] in the last static state of a scene.
fn settled_tensions(name: &str) -> (f64, f64) {
    let drive = Scene::preset(name).and_then(|scene| scene.drive());
    let drive = drive.unwrap_or_else(|error| panic!("{error}"));
    let assembled = drive
        .assemble()
        .unwrap_or_else(|error| panic!("{name}: {error}"));
    let strain = assembled.fittings[0]
        .as_ref()
        .map_or(0.0, |fitting| fitting.strain);
    let slack = ["bicycle_slack", "motorcycle"].contains(&name);
    assert!(
        strain.abs() < 1e-5 || (slack && strain < 0.0),
        "{name} closes with a strain of {strain}"
    );
    let tensions = assembled.statics.last().map(|state| state.tensions.clone());
    let tensions = tensions.unwrap_or_default();
    let least = tensions.iter().copied().fold(f64::INFINITY, f64::min);
    (
        least,
        tensions.iter().copied().fold(f64::NEG_INFINITY, f64::max),
    )
}

#[test]
fn every_preset_assembles() {
    for (name, _) in presets() {
        let (least, _) = settled_tensions(name);
        assert!(least > 0.0, "{name} has a slack link: {least} N");
    }
}

/// The horizontal pull of 20 hinged links (theory: discrete catenary, H = 3.507 N).
#[test]
fn the_hanging_chain_pulls_as_a_catenary_does() {
    let (least, _) = settled_tensions("hanging_chain");
    assert!((least / 3.507 - 1.0).abs() < 2e-3, "{least} N");
}

/// 5 kN m on a camshaft of 0.68 m make a difference of 7.4 kN between the strands beside it.
#[test]
fn the_tensioner_of_the_marine_engine_holds_its_chain() {
    let (least, most) = settled_tensions("marine_engine_bare");
    assert!((12.5e3..13.2e3).contains(&least), "{least} N");
    assert!((20.2e3..21.2e3).contains(&most), "{most} N");
}
