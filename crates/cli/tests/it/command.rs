//! The verbs of the command, their exit codes, and what they leave on disk.

use std::fs;

use crate::command_line::{attributes, chaindrive, folder, group, run, words};

/// Options that make drives start with the kick of the polygons, without friction in their joints and compliance behind their contacts.
const BARE: &str = "--run-in 0 --set route.start=polygon --set route.pretension_at=phase \
    --set contact.teeth.series=0 --set contact.teeth.dissipation=lankarani-nikravesh \
    --set contact.joints.series=0 --set contact.joints.dissipation=lankarani-nikravesh \
    --set contact.joints.friction=none";

/// `check` and `describe` told of clashes, and the run that suffers from them did not.
#[test]
fn a_run_tells_of_bodies_in_each_others_way_once() {
    let folder = folder();
    let rail = "guides=[{name=\"rail\",touches=\"plates\",face={kind=\"bar\",start=[0.2,0.86],end=[-0.2,0.86],end_radius=0.02}}]";
    let run = ["run", "marine_two_sprockets", "--until", "1 ms"];
    // Started with a kick, so short a run loses enough to be judged by it.
    let arguments = [&run[..], &["--no-error", "--set", rail], &words(BARE)].concat();
    let (code, _, err) = self::run(folder.path(), &arguments);
    assert_eq!(code, 0, "{err}");
    let told =
        err.matches("warning: marine_two_sprockets: guide `rail` cuts into the teeth of `crank`");
    assert_eq!(told.count(), 1, "{err}");
    let (_, _, err) = self::run(folder.path(), &[&arguments[..], &["-q"]].concat());
    assert_eq!(err, "");
}

#[test]
fn a_run_writes_a_store_and_ends_with_a_summary() {
    let folder = folder();
    let at = folder.path();
    let (code, out, err) = run(
        at,
        &words("run spinning_ring --until '5 ms' --every 0.001 -o ring.zarr --numerics"),
    );
    assert_eq!(code, 0, "{err}");
    assert!(
        out.contains("\nenergy ") && out.contains("× real time"),
        "{out}"
    );
    assert_eq!(err, "", "nothing but errors in a pipe");
    let group = group(&at.join("ring.zarr")).unwrap();
    let attributes = &group["attributes"];
    assert_eq!(attributes["complete"], 1);
    assert_eq!(attributes["samples"], 6);
    let scene = attributes["scene"].as_str().unwrap();
    assert!(
        scene.contains("until = \"5 ms\""),
        "the text reproduces the run: {scene}"
    );
    assert_eq!(attributes["chaindrive_version"], env!("CARGO_PKG_VERSION"));
}

#[test]
fn a_run_writes_a_table() {
    let folder = folder();
    let at = folder.path();
    let arguments = words("run spinning_ring --until '2 ms' --every '1 ms' --step '10 us' -q");
    let record = ["--record", "energy_kinetic,link_tension", "-o", "ring.csv"];
    let (code, out, err) = run(at, &[arguments.as_slice(), &record].concat());
    assert_eq!((code, out.as_str(), err.as_str()), (0, "", ""));
    let table = fs::read_to_string(at.join("ring.csv")).unwrap();
    let lines: Vec<&str> = table.lines().collect();
    assert!(lines[0].starts_with("time [s],energy_kinetic [J],link_tension[0] [N],"));
    assert_eq!(lines.len(), 4);
    let row: Vec<f64> = lines[3]
        .split(',')
        .map(|cell| cell.parse().unwrap())
        .collect();
    assert_eq!(row.len(), 22);
    assert!(
        (row[0] - 2e-3).abs() < 1e-15 && (row[2] - 215.92).abs() < 0.1,
        "{row:?}"
    );
}

#[test]
fn changes_reach_the_run() {
    let folder = folder();
    let at = folder.path();
    let short = ["run", "spinning_ring", "--until", "1 ms", "--every", "1 ms"];
    let (code, ..) = run(
        at,
        &[
            &short[..],
            &words("--set chain.links=24 --record all -o ring.zarr"),
        ]
        .concat(),
    );
    assert_eq!(code, 0);
    let group = group(&at.join("ring.zarr")).unwrap();
    assert_eq!(group["attributes"]["links"], 24);
    let arrays = &group["consolidated_metadata"]["metadata"];
    assert_eq!(arrays["link_tension"]["shape"], serde_json::json!([2, 24]));
    assert_eq!(arrays["link_tension"]["attributes"]["units"], "N");

    let (code, _, err) = run(at, &[&short[..], &["--set", "chain.lynx=24"]].concat());
    assert_eq!(code, 2);
    assert!(err.contains("lynx"), "{err}");
    let (code, _, err) = run(at, &[&short[..], &["--set", "chain.links"]].concat());
    assert_eq!(code, 2);
    assert!(err.contains("such as chain.links=80"), "{err}");
}

#[test]
fn every_method_runs() {
    let folder = folder();
    for (method, name) in [
        ("verlet", "Verlet"),
        ("rk4", "Runge-Kutta 4"),
        ("dormand-prince", "Dormand-Prince 5(4)"),
    ] {
        let arguments = [
            "run",
            "spinning_ring",
            "--until",
            "1 ms",
            "--method",
            method,
            "--numerics",
        ];
        let (code, out, err) = run(folder.path(), &arguments);
        assert_eq!(code, 0, "{err}");
        assert!(out.contains(name), "{out}");
    }
}

#[test]
fn an_implicit_method_is_refused_by_the_particle_chain() {
    let folder = folder();
    for method in ["implicit-damping", "generalized-alpha"] {
        let arguments = ["run", "spinning_ring", "--method", method, "-o", "x.zarr"];
        let (code, _, err) = run(folder.path(), &arguments);
        assert_eq!(code, 2, "{err}");
        assert!(err.contains(method), "{err}");
        assert!(err.contains("choose verlet, rk4, dormand-prince"), "{err}");
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn bad_input_exits_2_and_leaves_nothing() {
    let folder = folder();
    let at = folder.path();
    fs::write(at.join("bad.toml"), "[chain]\npitch = \"12 rpm\"\n").unwrap();
    let wrong = [
        "run bad.toml -o x.zarr",
        "run missing.toml -o x.zarr",
        "run spinning_rng -o x.zarr",
        "run spinning_ring --until '1 mm' -o x.zarr",
        "run spinning_ring --until -1 -o x.zarr",
        "run spinning_ring --every 0 -o x.zarr",
        "run spinning_ring --record link_tensoin -o x.zarr",
        "run spinning_ring --step '1 s' -o x.zarr",
        "run spinning_ring --method leapfrog -o x.zarr",
        "run spinning_ring -o x.hdf5",
        "run",
        "check bad.toml",
        "describe bad.toml",
        "scenes nothing",
    ];
    for line in wrong {
        let (code, out, err) = run(at, &words(line));
        assert_eq!((code, out.as_str()), (2, ""), "{line}: {err}");
        assert!(
            !err.is_empty() && !err.contains("panicked"),
            "{line}: {err}"
        );
    }
    let left: Vec<_> = fs::read_dir(at)
        .unwrap()
        .map(|entry| entry.unwrap().file_name())
        .collect();
    assert_eq!(left, ["bad.toml"]);
}

#[test]
fn messages_name_file_line_and_place() {
    let folder = folder();
    let at = folder.path();
    fs::write(at.join("bad.toml"), "[chain]\npitch = \"12 rpm\"\n").unwrap();
    let (_, _, err) = run(at, &["check", "bad.toml"]);
    assert!(
        err.contains("bad.toml:2:9: chain.pitch: `12 rpm` is an angular speed"),
        "{err}"
    );
    let (_, _, err) = run(at, &["run", "spinning_ring", "--record", "link_tensoin"]);
    assert!(err.contains("did you mean `link_tension`?"), "{err}");
}

#[test]
fn results_are_not_overwritten_unasked() {
    let folder = folder();
    let at = folder.path();
    for name in ["ring.zarr", "ring.csv"] {
        let arguments = ["run", "spinning_ring", "--until", "1 ms", "-q", "-o", name];
        assert_eq!(run(at, &arguments).0, 0);
        let (code, _, err) = run(at, &arguments);
        assert_eq!(code, 3);
        assert!(err.contains("already a result"), "{err}");
        let (code, _, err) = run(at, &[&arguments[..], &["--overwrite"]].concat());
        assert_eq!(code, 0, "{err}");
    }
    fs::create_dir(at.join("notes.zarr")).unwrap();
    fs::write(at.join("notes.zarr/thesis.tex"), "three years").unwrap();
    fs::write(at.join("notes.csv"), "three,years\n").unwrap();
    for name in ["notes.zarr", "notes.csv"] {
        let arguments = [
            "run",
            "spinning_ring",
            "--until",
            "1 ms",
            "--overwrite",
            "-o",
            name,
        ];
        assert_eq!(run(at, &arguments).0, 3);
    }
    assert_eq!(
        fs::read_to_string(at.join("notes.csv")).unwrap(),
        "three,years\n"
    );
    assert!(at.join("notes.zarr/thesis.tex").exists());
}

/// The place of contacts follows from that of samples: another run's samples there stay.
#[test]
fn samples_in_the_place_of_contacts_stay() {
    let folder = folder();
    let at = folder.path();
    let ring = ["run", "spinning_ring", "--until", "1 ms", "-q", "-o"];
    assert_eq!(run(at, &[&ring[..], &["ring.events.csv"]].concat()).0, 0);
    let samples = fs::read(at.join("ring.events.csv")).unwrap();
    let (code, _, err) = run(at, &[&ring[..], &["ring.csv", "--overwrite"]].concat());
    assert_eq!(code, 3, "{err}");
    assert_eq!(fs::read(at.join("ring.events.csv")).unwrap(), samples);
}

/// Standard output leaves out contacts of the scene, and refuses those of an option.
#[test]
fn standard_output_has_samples_alone() {
    let folder = folder();
    let at = folder.path();
    let line =
        "run bicycle_slack --until 0.1ms --run-in 0 --no-error --set run.events=[\"teeth\"] -o -";
    let (code, out, err) = run(at, &words(line));
    assert_eq!(code, 0, "{err}");
    assert!(out.starts_with("time [s]"), "{out}");
    let (code, _, err) = run(at, &words(&format!("{line} --events teeth")));
    assert_eq!(code, 2);
    assert!(err.contains("one table"), "{err}");
}

/// A shaft under a torque that no machine has: the sample at t = 0 is all there is.
#[test]
fn a_failing_run_keeps_its_samples_and_exits_1() {
    let folder = folder();
    let at = folder.path();
    let load = "sprockets.camshaft.load=[{ kind = 'constant', torque = '1e200 N m' }]";
    for name in ["drive.zarr", "drive.csv"] {
        let scene = ["run", "marine_two_sprockets", "--until", "1 ms", "-o", name];
        let changes = ["--set", "settle=false", "--set", load];
        let (code, _, err) = run(at, &[&scene[..], &changes].concat());
        assert_eq!(code, 1, "{err}");
        assert!(err.contains("no longer finite"), "{err}");
    }
    let about = attributes(&at.join("drive.zarr"));
    assert_eq!(about["status"], "failed");
    assert_eq!(about["complete"], 0);
    assert_eq!(about["samples"], 1);
    assert!(
        about["failure"]
            .as_str()
            .unwrap()
            .contains("no longer finite")
    );
    let table = fs::read_to_string(at.join("drive.csv")).unwrap();
    assert_eq!(table.lines().count(), 3);
    assert!(
        table
            .lines()
            .last()
            .unwrap()
            .starts_with("# incomplete: at t = ")
    );
}

#[test]
fn a_place_that_cannot_be_written_exits_3() {
    let folder = folder();
    let at = folder.path();
    fs::write(at.join("file"), "").unwrap();
    for name in ["file/ring.zarr", "file/ring.csv", "file/none/ring.csv"] {
        let (code, out, err) = run(at, &["run", "spinning_ring", "--until", "1 ms", "-o", name]);
        assert_eq!(code, 3, "{err}");
        assert_eq!(out, "");
        assert!(err.starts_with(name), "{err}");
    }
}

#[test]
fn scenes_come_from_stdin_too() {
    let folder = folder();
    let (_, text, _) = run(folder.path(), &["scenes", "spinning_ring"]);
    let file = folder.path().join("ring.toml");
    fs::write(&file, text).unwrap();
    let output = chaindrive(folder.path(), &["check", "-"])
        .stdin(fs::File::open(&file).unwrap())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(0));
}

#[test]
fn the_lists() {
    let folder = folder();
    let at = folder.path();
    let (code, out, _) = run(at, &["scenes"]);
    assert!(code == 0 && out.contains("marine_engine"));
    let (code, out, _) = run(at, &["scenes", "hanging_chain"]);
    assert!(code == 0 && out.contains("[chain]"));
    let (code, out, _) = run(at, &["schema"]);
    let schema: serde_json::Value = serde_json::from_str(&out).unwrap();
    assert!(code == 0 && schema["properties"]["chain"].is_object());
    let (code, out, _) = run(at, &["channels"]);
    assert!(code == 0 && out.contains("span_tension") && out.contains("N m"));
    let (code, out, _) = run(at, &["catalogue"]);
    assert!(code == 0 && out.lines().count() > 40 && out.contains("16B-1"));
    let (code, out, _) = run(at, &["catalogue", "80"]);
    assert!(
        code == 0 && out.starts_with("16A-1") && out.contains("assumed:"),
        "{out}"
    );
    let (code, _, err) = run(at, &["catalogue", "17B"]);
    assert!(
        code == 2 && err.contains("no chain of the catalogue"),
        "{err}"
    );
    let (code, out, _) = run(at, &["--help"]);
    assert!(code == 0 && out.contains("130  interrupted"), "{out}");
}

#[test]
fn logged_contacts_are_counted_and_stored() {
    let folder = folder();
    let at = folder.path();
    let short = ["run", "bicycle", "--until", "3 ms", "-o", "bicycle.zarr"];
    let more = "--events teeth,joints --record joint_force --run-in 0 --numerics";
    let more: Vec<&str> = more.split(' ').collect();
    let (code, out, err) = run(at, &[&short[..], &more].concat());
    assert_eq!(code, 0, "{err}");
    for words in [
        "mean peak [N]",
        "  tooth ",
        "  joint ",
        "implicit damping with",
    ] {
        assert!(out.contains(words), "{words}:\n{out}");
    }
    let group = group(&at.join("bicycle.zarr")).unwrap();
    let arrays = &group["consolidated_metadata"]["metadata"];
    let events = arrays["event_start"]["shape"][0].as_u64().unwrap();
    assert!(events >= 104, "{events}: all joints are pressed");
    assert_eq!(arrays["event_kind"]["shape"][0], events);
    assert_eq!(arrays["joint_force"]["shape"], serde_json::json!([31, 104]));

    let (code, _, err) = run(at, &["run", "spinning_ring", "--record", "joint_force"]);
    assert_eq!(code, 2);
    assert!(err.contains("this chain has no `joint_force`"), "{err}");
    let (code, _, err) = run(at, &["run", "bicycle", "--events", "tooth"]);
    assert_eq!(code, 2);
    assert!(err.contains("no contacts are named `tooth`"), "{err}");
}

#[test]
fn every_preset_is_sound() {
    let folder = folder();
    let (_, names, _) = run(folder.path(), &["scenes"]);
    let names: Vec<&str> = names
        .lines()
        .filter_map(|line| line.split(' ').next())
        .collect();
    let (code, out, err) = run(folder.path(), &[&["check"], &names[..]].concat());
    assert_eq!((code, out.lines().count()), (0, names.len()), "{err}");
}

/// As `run` and `describe` do, for every scene that is named.
#[test]
fn what_is_set_is_checked() {
    let folder = folder();
    let scenes = ["check", "marine_two_sprockets", "industrial_16b", "--set"];
    let (code, out, _) = run(
        folder.path(),
        &[&scenes[..], &["route.pretension=2 kN"]].concat(),
    );
    assert_eq!((code, out.lines().count()), (0, 2), "{out}");
    let (code, _, err) = run(folder.path(), &[&scenes[..], &["chain.links=60"]].concat());
    assert_eq!(code, 2, "{err}");
    assert_eq!(err.matches("60 links do not close").count(), 2, "{err}");
    let (_, _, err) = run(folder.path(), &[&scenes[..], &["chain.lnks=60"]].concat());
    assert!(err.contains("--set chain.lnks"), "{err}");
}

#[test]
fn a_description_is_text_or_json() {
    let folder = folder();
    let (code, out, err) = run(folder.path(), &["describe", "marine_two_sprockets"]);
    assert_eq!(code, 0, "{err}");
    for word in [
        "wave speeds",
        "spans at rest",
        "statics",
        "polygon action",
        "run time",
    ] {
        assert!(out.contains(word), "{out}");
    }
    let (code, out, _) = run(
        folder.path(),
        &["describe", "marine_two_sprockets", "--json"],
    );
    let it: serde_json::Value = serde_json::from_str(&out).unwrap();
    assert_eq!(code, 0);
    assert_eq!(it["polygon"].as_array().unwrap().len(), 2);
    assert!(it["cost"]["steps"].as_f64().unwrap() > 0.0);
}

#[test]
fn the_marine_engine_runs() {
    let folder = folder();
    let at = folder.path();
    let (code, out, err) = run(
        at,
        &words("run marine_engine --until '0.02 s' -o engine.zarr --numerics"),
    );
    assert_eq!(code, 0, "{err}");
    for word in [
        "span tension [kN]",
        "Maximum link tension, of any link",
        "crank-camshaft",
        "contact force [N]",
        "ns per link",
    ] {
        assert!(out.contains(word), "{out}");
    }
    assert_eq!(attributes(&at.join("engine.zarr"))["samples"], 101);
}

// Costs: what chooses a method, and what estimates its error, repeat the run with shorter steps.
#[test]
fn a_run_says_how_exact_it_is_unless_told_not_to() {
    let folder = folder();
    let at = folder.path();
    let short = format!("run bicycle_slack {BARE} --until 6ms -o run.zarr --overwrite --numerics");
    let short = words(&short);
    let (code, out, err) = run(at, &short);
    assert_eq!(code, 0, "{err}");
    assert!(out.contains("method chosen            implicit-damping"));
    assert!(out.contains("numerical error          in the first"));
    let about = attributes(&at.join("run.zarr"));
    assert_eq!(about["error_estimate"], "made");
    assert_eq!(about["accuracy"], 0.05);
    assert!(out.starts_with("verdict: "), "{out}");
    let horizon = about["waveform_horizon"].as_f64().unwrap();
    let tension = attributes(&at.join("run.zarr").join("span_tension"));
    assert_eq!(tension["waveform_horizon"], horizon);
    assert_eq!(tension["waveform_horizon_of"], "span_tension");
    let angle = attributes(&at.join("run.zarr").join("sprocket_angle"));
    assert_eq!(angle["waveform_horizon_of"], "link_tension");
    let links = &about["waveform_horizon_link_tension"];
    assert_eq!(&angle["waveform_horizon"], links);

    let (code, out, err) = run(at, &[&short[..], &["--no-error"]].concat());
    assert_eq!(code, 0, "{err}");
    assert!(!out.contains("numerical error"), "{out}");
    let about = attributes(&at.join("run.zarr"));
    assert_eq!(about["error_estimate"], "switched off");
    assert!(about["error_span_tension"].is_null());
}

/// Defect A4: with `-q` a run with much of its energy missing ended without a word. Steps of 5 µs are too long for the motorcycle.
#[test]
fn a_result_that_contradicts_itself_is_told_of_even_quietly() {
    let folder = folder();
    let at = folder.path();
    let settings = "--every 1ms -q --no-error --run-in 0 -o run.zarr";
    let rough = format!("run motorcycle --step 5us --until 10ms {settings}");
    let (code, out, err) = run(at, &words(&rough));
    assert_eq!((code, out.as_str()), (0, ""));
    assert_eq!(err.lines().count(), 1, "{err}");
    assert!(
        err.starts_with("motorcycle: do not trust this run: "),
        "{err}"
    );
    let about = attributes(&at.join("run.zarr"));
    assert_eq!(about["verdict"], "distrusted");
    let reasons = about["reasons"].as_str().unwrap();
    assert!(reasons.contains("losses-wrong"), "{reasons}");

    // The same by the exit code, once the result is kept.
    let (code, _, err) = run(at, &words(&format!("{rough} --overwrite --strict")));
    assert_eq!(code, 4);
    assert!(
        err.ends_with("motorcycle: distrusted, and --strict was asked for\n"),
        "{err}"
    );
    assert_eq!(attributes(&at.join("run.zarr"))["status"], "complete");

    let sound =
        format!("run spinning_ring --until 3ms --method verlet {settings} --overwrite --strict");
    let (code, out, err) = run(at, &words(&sound));
    assert_eq!((code, out.as_str(), err.as_str()), (0, "", ""));
    let about = attributes(&at.join("run.zarr"));
    assert_eq!(about["verdict"], "caution");
    assert_eq!(about["reasons"], "not-estimated");
}

#[test]
fn the_method_is_chosen_unless_it_is_given() {
    let folder = folder();
    let at = folder.path();
    let short = ["run", "spinning_ring", "--until", "10 ms", "--numerics"];
    let (_, out, _) = run(at, &[&short[..], &["--accuracy", "0.001 %"]].concat());
    assert!(out.contains("within 0.001 %"), "{out}");
    let (_, out, _) = run(at, &[&short[..], &["--set", "run.accuracy=2 %"]].concat());
    assert!(out.contains("within 2.0 %"), "{out}");
    let (_, out, _) = run(at, &[&short[..], &["--step", "10 us"]].concat());
    assert!(!out.contains("method chosen"), "{out}");
    let both = ["--accuracy", "1%", "--method", "rk4"];
    let (code, _, err) = run(at, &[&short[..], &both].concat());
    assert_eq!(code, 2);
    assert!(err.contains("cannot be used with"), "{err}");
    let (code, _, err) = run(at, &[&short[..], &["--accuracy", "120 %"]].concat());
    assert_eq!(code, 2);
    assert!(err.contains("accuracy"), "{err}");
}
