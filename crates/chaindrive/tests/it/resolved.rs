//! Scenes in full: the same drive to the last bit, with nothing left open; and what differs between two.
#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use chaindrive::scene::{Scene, diff, presets};
use chaindrive::{
    Channel, Memory, Recording, Request, Run, SettingValue, Settings, Simulation, execute,
};
use proptest::prelude::*;

/// Every number of a drive, in the shortest digits that tell it from all others.
fn told(scene: &Scene) -> String {
    let drive = scene.drive().unwrap_or_else(|error| panic!("{error}"));
    format!("{drive:?}")
}

/// Lines of a text in full whose value was not written by anybody.
fn left_open(text: &str) -> usize {
    let marks = ["assumed", "follows", "not given", "that of the roller"];
    let open = |line: &&str| marks.iter().any(|mark| line.contains(mark));
    text.lines().filter(open).count()
}

/// The full scene makes the same drive, and has no more to fill in.
#[track_caller]
fn full(scene: &Scene) -> Scene {
    let full = scene.resolved().unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(told(scene), told(&full), "{}", full.text());
    let twice = full.resolved().unwrap();
    let differences = diff(&full, &twice).unwrap();
    assert!(differences.is_empty(), "{differences:?}");
    let filled = twice.text().lines().count();
    assert_eq!(filled, full.text().lines().count(), "{}", twice.text());
    full
}

#[test]
fn every_preset_in_full_is_the_same_drive() {
    for (name, _) in presets() {
        let scene = Scene::preset(name).unwrap();
        let full = full(&scene);
        let text = full.text();
        assert!(
            text.starts_with("format = \"0.3\"\ndefaults = \"0.3\"\n"),
            "{text}"
        );
        assert!(left_open(text) > 3, "{name}\n{text}");
        let differences = diff(&scene, &full).unwrap();
        assert!(differences.is_empty(), "{name}: {differences:?}");
    }
}

/// With all that rigid links leave open: joints, rollers, flanks, stiffness, all from the catalogue.
#[test]
fn what_follows_from_other_values_is_written_too() {
    let text = |more: &str| {
        format!(
            "chain = {{ type = '16B-1', model = 'clearance-joints'{more} }}
             [[sprockets]]
             name = 'a'\nteeth = 19\ncentre = [0, 0]
             motion = {{ kind = 'constant', speed = '100 rpm' }}
             [[sprockets]]
             name = 'b'\nteeth = 57\ncentre = ['1.03 m', 0]\ninertia = 1
             contact = {{ restitution = 0.6, friction = {{ coefficient = 0.1 }} }}"
        )
    };
    for more in [", roller = { clearance = '0.05 mm' }, rollers = 'free'", ""] {
        let scene = Scene::from_toml(&text(more), "16B").unwrap();
        let full = full(&scene);
        for line in [
            "links = 120 # follows from the taut route",
            "[sprockets.flank.law]",
            "[contact.joints.law]",
            "slip_speed = 0.05 # [m/s] assumed",
            "pin_diameter = 0.00828 # [m] 16B-1",
            "restitution = 0.8 # assumed: teeth of steel",
        ] {
            assert!(full.text().contains(line), "{line}\n{}", full.text());
        }
    }
    let ideal = text("").replace("clearance-joints", "ideal-joints");
    full(&Scene::from_toml(&ideal, "16B").unwrap());
}

#[test]
fn a_run_of_the_full_scene_has_the_same_bits() {
    let scene = Scene::preset("industrial_16b").unwrap();
    let tensions = |scene: &Scene| {
        let run = Run {
            until: 2e-3,
            every: 1e-4,
            ..Run::suggested(&scene.run_defaults())
        };
        let mut simulation = Simulation::start(&scene.drive().unwrap(), &run).unwrap();
        let mut recording = Recording::new(&[Channel::LinkTension], simulation.system());
        while let Some(sample) = simulation.next_sample().unwrap() {
            recording.push(sample);
        }
        let method = simulation.method();
        let bits: Vec<u64> = recording.columns[0]
            .values
            .iter()
            .map(|x| x.to_bits())
            .collect();
        (bits, scene.resolved_for(&run, method).unwrap())
    };
    let (bits, full) = tensions(&scene);
    assert!(full.text().contains("method = \"verlet\" # as it was run"));
    assert_eq!(tensions(&full).0, bits);
    // As it was run: nothing is left to choose.
    assert_eq!(full.run_defaults().chosen_accuracy(), None);
}

#[test]
fn the_source_of_what_was_written_stays() {
    let text = Scene::preset("marine_engine_bare")
        .unwrap()
        .resolved()
        .unwrap();
    let text = text.text();
    assert!(text.contains("pitch = 0.0889 # [m] 88.9 mm"), "{text}");
    assert!(text.contains("damping_ratio = 0.015 # assumed") || text.contains("# assumed"));
}

#[test]
fn differences_are_named_by_place_and_value() {
    let scene = Scene::preset("marine_engine").unwrap();
    let other = scene
        .replace("sprockets.camshaft.inertia", "300 kg m^2")
        .and_then(|scene| scene.replace("gravity", "[0, -9.81]"))
        .and_then(|scene| scene.replace("chain.damping", "1 kN s/m"))
        .and_then(|scene| scene.without("chain.damping_ratio"))
        .unwrap();
    let told: Vec<String> = diff(&scene, &other)
        .unwrap()
        .iter()
        .map(ToString::to_string)
        .collect();
    assert!(
        told.contains(&"sprockets.camshaft.inertia: 251.0 kg m^2 | 300.0 kg m^2".to_owned()),
        "{told:?}"
    );
    assert!(
        told.contains(&"chain.damping: – | 1000.0 N s/m".to_owned()),
        "{told:?}"
    );
    assert!(
        told.iter().all(|line| !line.starts_with("gravity")),
        "{told:?}"
    );
    assert_eq!(told.len(), 3, "{told:?}");
}

#[test]
fn versions_that_nobody_knows_are_refused_with_a_hint() {
    let ring = Scene::preset("spinning_ring").unwrap();
    let text = format!("format = \"0.3\"\ndefaults = \"0.3\"\n{}", ring.text());
    let scene = Scene::from_toml(&text, "ring").unwrap();
    assert_eq!(told(&scene), told(&ring));
    for (line, words) in [
        (
            "format = \"9.0\"\nstrange = 1",
            "format: `9.0` is not a known version; chaindrive",
        ),
        ("format = 0.3", "a version is a text: \"0.3\""),
        ("format = \"0.2\"", "knows 0.3; take a newer one"),
        ("defaults = \"0.1\"", "knows 0.3; take a newer one"),
        ("format = []", "format: `a list` is not a known version"),
    ] {
        let error = Scene::from_toml(&format!("{line}\n{}", ring.text()), "ring");
        let error = error.unwrap_err();
        assert!(error.to_string().contains(words), "{error}");
        let line = error.problems[0].place.map(|place| place.line);
        assert_eq!((error.problems.len(), line), (1, Some(1)));
    }
}

/// The scene of a result is read from its folder.
#[test]
fn a_result_is_a_scene() {
    let folder = tempfile::tempdir().unwrap();
    let ring = Scene::preset("spinning_ring").unwrap();
    let group = serde_json::json!({"attributes": {"scene": ring.text()}});
    std::fs::write(folder.path().join("zarr.json"), group.to_string()).unwrap();
    let read = Scene::read(folder.path()).unwrap();
    assert!(diff(&read, &ring).unwrap().is_empty());
    std::fs::write(folder.path().join("zarr.json"), "{}").unwrap();
    let error = Scene::read(folder.path()).unwrap_err();
    assert!(error.to_string().contains("this is a folder"), "{error}");
}

/// A law of an open scene, or nothing.
fn law() -> impl Strategy<Value = &'static str> {
    prop::sample::select(vec![
        "",
        "law = { kind = 'linear', stiffness = '300 MN/m' }",
        "law = { kind = 'power', stiffness = 6e11, exponent = 1.5 }",
        "law = { kind = 'johnson', length = '17 mm' }",
        "law = 'hertz'",
        "law = 'cylindrical'\nrestitution = 0.4",
        "dissipation = 'exact'",
        "damping = '2 kN s/m'",
        "dissipation = 'none'",
        "friction = { coefficient = 0.05 }",
        "friction = { kind = 'lugre', static_coefficient = 0.2, coefficient = 0.1, stiffness = 1e5 }",
        "friction = { kind = 'brown_mcphee', static_coefficient = 0.2, coefficient = 0.1 }",
    ])
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, failure_persistence: None, ..ProptestConfig::default() })]

    /// Whatever a scene says and leaves open: in full it is the same drive, and is read back as itself.
    #[test]
    fn scenes_in_full_are_the_same_drives(
        teeth in (11_u32..60, 11_u32..60),
        tenths in 354_u32..551,
        model in prop::sample::select(vec!["particles", "ideal-joints", "clearance-joints"]),
        laws in (law(), law(), law()),
        tooth in prop::sample::select(vec!["", "tooth = 'iso606'", "tooth = 'asa-type-ii'", "tooth = 'circular'",
            "tooth = { kind = 'iso606', gap = 'min', tip = 'max', seat = 'pitch' }"]),
        route in prop::sample::select(vec!["", "[route]\npretension = '500 N'", "[route]\nphase = 0.3",
            "[route]\nadjust = { kind = 'sprocket', name = 'b', direction = [1, 0], within = '30 mm' }"]),
        load in -40.0_f64..40.0,
        guided in any::<bool>(),
    ) {
        let distance = 2.54e-3 * f64::from(tenths);
        let guide = "[[guides]]\nname = 'bar'\nface = { kind = 'bar', start = [0.3, -0.4], end = [0.6, -0.4] }\n";
        let text = format!(
            "chain = {{ type = '16B-1', model = '{model}' }}\n[contact.teeth]\n{}\n[contact.joints]\n{}\n\
             [[sprockets]]\nname = 'a'\nteeth = {}\ncentre = [0, 0]\n{tooth}\nmotion = 'held'\n\
             [[sprockets]]\nname = 'b'\nteeth = {}\ncentre = [{distance:?}, 0]\ninertia = '0.1 kg m^2'\n\
             load = [{{ kind = 'constant', torque = {load:?} }}]\n[sprockets.contact]\n{}\n{}{route}\n",
            laws.0, laws.1, teeth.0, teeth.1, laws.2, if guided { guide } else { "" },
        );
        let scene = Scene::from_toml(&text, "random").unwrap_or_else(|error| panic!("{error}\n{text}"));
        // Some laws have no room in these gaps; those scenes are refused in full as well.
        if scene.drive().is_err() {
            prop_assert!(scene.resolved().is_err());
            return Ok(());
        }
        let full = scene.resolved().unwrap_or_else(|error| panic!("{error}\n{text}"));
        prop_assert_eq!(told(&full), told(&scene), "{}", full.text());
        let again = Scene::from_text(full.text(), full.name()).unwrap();
        prop_assert_eq!(&again, &full);
        let twice = full.resolved().unwrap();
        for (first, second) in [(&full, &twice), (&scene, &full)] {
            let differences = diff(first, second).unwrap();
            prop_assert!(differences.is_empty(), "{:?}", differences);
        }
    }
}

/// The scene and settings of a result reproduce it: same bits, with nothing left to choose.
#[test]
fn every_result_carries_what_reproduces_it() {
    for name in ["spinning_ring", "pin_in_bush", "industrial_16b"] {
        let settings = Settings::default()
            .with("until", SettingValue::Number(5e-4))
            .with("every", SettingValue::Number(1e-4));
        let scene = Scene::preset(name).unwrap();
        let carried_out = |scene: &Scene, settings: &Settings| {
            let request = Request::new(scene, settings).unwrap().without_estimate();
            let mut memory = Memory::default();
            let report = execute(&request, &mut memory, &|| false).unwrap();
            let text = report.attributes["resolved_scene"].as_str().unwrap();
            let columns = memory.recording.columns.iter();
            let bits: Vec<u64> = columns
                .flat_map(|column| column.values.iter().map(|x| x.to_bits()))
                .collect();
            (bits, text.to_owned())
        };
        let (bits, text) = carried_out(&scene, &settings);
        let full = Scene::from_toml(&text, name).unwrap();
        let (again, text_again) = carried_out(&full, &Settings::default());
        assert_eq!(bits, again, "{name}\n{text}");
        let full_again = Scene::from_toml(&text_again, name).unwrap();
        let differences = diff(&full, &full_again).unwrap();
        assert!(differences.is_empty(), "{name}: {differences:?}");
    }
}

#[test]
fn a_recording_beyond_all_memory_is_refused_with_its_size() {
    let scene = Scene::preset("industrial_16b").unwrap();
    let settings = Settings::default()
        .with("until", SettingValue::Number(900.0))
        .with("every", SettingValue::Number(1e-6))
        .with("method", SettingValue::Text("verlet".into()));
    let request = Request::new(&scene, &settings).unwrap();
    let error = execute(&request, &mut Memory::default(), &|| false).unwrap_err();
    let message = error.to_string();
    for words in [
        "GB, more than the memory holds",
        "`record`",
        "`every`",
        "`output`",
    ] {
        assert!(message.contains(words), "{message}");
    }
}
