//! The same request gives the same bits and the same attributes, from the command line and from Rust, in memory and on
//! disk.
#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use chaindrive::record::{Existing, ZarrSink};
use chaindrive::scene::presets;
use chaindrive::{Memory, Request, Scene, SettingValue, Settings, Stop, execute};
use serde_json::Value;

use crate::command_line::{attributes, run, words};

/// Wall times: the only attributes that two runs of one request do not share.
const WALL: [&str; 4] = [
    "stepping_time",
    "real_time_factor",
    "ns_per_link_step",
    "wall_time",
];

/// Key in `[run]`, option of the command line, and value.
type Choice = (&'static str, &'static str, &'static str);

const CASES: [(&str, &[Choice]); 6] = [
    ("default", &[]),
    ("method", &[("method", "--method", "rk4")]),
    ("step", &[("step", "--step", "40 ns")]),
    ("accuracy", &[("accuracy", "--accuracy", "5%")]),
    ("events", &[("events", "--events", "teeth,joints")]),
    ("record all", &[("record", "--record", "all")]),
];

fn request(preset: &str, case: &[Choice]) -> Request {
    let always = [("until", "", "400 us"), ("every", "", "100 us")];
    let settings = always.iter().chain(case);
    let settings = settings.fold(Settings::default(), |all, (key, _, value)| {
        let names = || value.split(',').map(str::to_owned).collect();
        all.with(
            key,
            match *key {
                "events" | "record" => SettingValue::Names(names()),
                _ => SettingValue::Text((*value).to_owned()),
            },
        )
    });
    Request::new(&Scene::preset(preset).unwrap(), &settings).unwrap()
}

/// Every file of a store, but for the group document and what a run goes on from.
pub(crate) fn files(store: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut folders = vec![store.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else {
                let name = path.strip_prefix(store).unwrap().display().to_string();
                if name != "zarr.json" && name != "checkpoint" {
                    found.insert(name, fs::read(&path).unwrap());
                }
            }
        }
    }
    found
}

/// Attributes without what a clock had a say in.
pub(crate) fn timeless(attributes: &Value) -> serde_json::Map<String, Value> {
    let mut attributes = attributes.as_object().unwrap().clone();
    for name in WALL {
        assert!(attributes.remove(name).is_some(), "{name}");
    }
    let numerics = attributes["numerics"].as_str().unwrap().to_owned();
    let lines = numerics.lines().filter(|line| !line.starts_with("speed"));
    attributes["numerics"] = lines.collect::<Vec<_>>().join("\n").into();
    attributes
}

fn hold(preset: &str, name: &str, case: &[Choice]) {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let line = format!("run {preset} --until '400 us' --every '100 us' -q -o command.zarr");
    let options = case.iter().flat_map(|(_, option, value)| [*option, *value]);
    let arguments: Vec<&str> = words(&line).into_iter().chain(options).collect();
    assert_eq!(run(folder.path(), &arguments).0, 0);

    let request = request(preset, case);
    let mut store = ZarrSink::new(at("rust.zarr"), Existing::Keep);
    execute(&request, &mut store, &|| false).unwrap();
    let mut memory = Memory::default();
    let report = execute(&request, &mut memory, &|| false).unwrap();
    assert!(matches!(report.stop, Stop::End));

    let [command, rust] = ["command.zarr", "rust.zarr"].map(at);
    assert_eq!(files(&command), files(&rust), "{preset}, {name}");
    let [command, rust] = [&command, &rust].map(|store| timeless(&attributes(store)));
    assert_eq!(command, rust, "{preset}, {name}");
    // Numbers of the store have passed through text, those of memory have not.
    let memory = serde_json::to_string(&report.attributes).unwrap();
    let memory: Value = serde_json::from_str(&memory).unwrap();
    assert_eq!(timeless(&memory), rust, "{preset}, {name}");
    for needed in [
        "summary",
        "page",
        "numerics",
        "status",
        "method_order",
        "links",
        "energy_supplied",
        "energy_moved",
        "contact_force_largest",
    ] {
        assert!(rust.contains_key(needed), "{needed}");
    }
}

#[test]
fn the_command_and_rust_do_the_same() {
    for (name, case) in CASES {
        hold("spinning_ring", name, case);
    }
    let joints = [
        ("events", "--events", "joints"),
        ("run_in", "--run-in", "0 s"),
    ];
    hold("bicycle", "events", &joints);
    let run_in = [("run_in", "--run-in", "50 ms")];
    hold("marine_two_sprockets", "run in", &run_in);
}

#[test]
#[ignore = "takes minutes; `make validation` runs it"]
fn the_command_and_rust_do_the_same_with_every_preset() {
    for (preset, _) in presets() {
        for (name, case) in CASES {
            hold(preset, name, case);
        }
    }
}

/// A request that a clock or a channel has no say in: the motion does not depend on what is recorded.
#[test]
fn recording_does_not_change_the_motion() {
    for method in ["verlet", "dormand-prince", "rk4"] {
        let ends = ["10 ms", "1 ms", "20 us"].map(|every| {
            let settings = [("until", "10 ms"), ("every", every), ("method", method)];
            let settings = settings
                .iter()
                .fold(Settings::default(), |all, (key, value)| {
                    all.with(key, SettingValue::Text((*value).to_owned()))
                });
            let scene = Scene::preset("spinning_ring").unwrap();
            let request = Request::new(&scene, &settings).unwrap().without_estimate();
            let mut memory = Memory::default();
            let report = execute(&request, &mut memory, &|| false).unwrap();
            let last = report.simulation.observation();
            let places = last.roller_x.iter().chain(&last.roller_y);
            let places: Vec<u64> = places.map(|x| x.to_bits()).collect();
            (*report.simulation.statistics(), places)
        });
        assert_eq!(ends[0], ends[1], "{method}");
        assert_eq!(ends[1], ends[2], "{method}");
    }
}
