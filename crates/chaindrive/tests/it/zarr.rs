//! Results on disk hold what a recording in memory holds, bit for bit.
#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use std::fs;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use chaindrive::record::{
    Claim, Ending, Existing, Provenance, WriteError, ZarrWriter, is_being_written,
};
use chaindrive::{Channel, EventTable, Recording, Run, Scene, Simulation};
use zarrs::array::{Array, ArrayMetadata};
use zarrs::group::Group;
use zarrs::storage::store::MemoryStore;
use zarrs::storage::{ReadableStorageTraits, WritableStorageTraits};
use zarrs_filesystem::FilesystemStore;

type Reader = Arc<dyn ReadableStorageTraits>;

fn reader(path: &Path) -> Reader {
    Arc::new(FilesystemStore::new(path).unwrap())
}

fn numbers(store: &Reader, name: &str) -> (Vec<u64>, Vec<f64>) {
    let array = Array::open(store.clone(), &format!("/{name}")).unwrap();
    let values = array.retrieve_array_subset(&array.subset_all()).unwrap();
    (array.shape().to_vec(), values)
}

fn attribute(store: &Reader, name: &str) -> serde_json::Value {
    let group = Group::open(store.clone(), "/").unwrap();
    group.attributes().get(name).cloned().unwrap_or_default()
}

fn ring(until: f64) -> (Scene, Run, Simulation) {
    let scene = Scene::preset("spinning_ring").unwrap();
    let run = Run {
        until,
        every: 1e-5,
        ..Run::default()
    };
    let simulation = Simulation::start(&scene.drive().unwrap(), &run).unwrap();
    (scene, run, simulation)
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|value| value.to_bits()).collect()
}

/// Both scalars of 16 384 samples a chunk and arrays of 6 553 go over the end of a chunk.
#[test]
fn what_is_stored_is_what_was_sampled() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("ring.zarr");
    let (scene, run, mut simulation) = ring(0.17);
    let channels = Channel::chosen(&["all"], simulation.system()).unwrap();
    let mut recording = Recording::new(&channels, simulation.system());
    let provenance = Provenance::of(&scene, &run);
    let mut writer =
        ZarrWriter::create(&path, &simulation, &channels, provenance, Existing::Keep).unwrap();
    while let Some(sample) = simulation.next_sample().unwrap() {
        recording.push(sample);
        writer.push(&simulation).unwrap();
        // Partial chunks that are written again and again.
        if recording.len().is_multiple_of(5000) {
            writer.flush(&simulation).unwrap();
        }
    }
    writer.finish(&simulation, &Ending::Complete).unwrap();

    let store = reader(&path);
    let samples = recording.len() as u64;
    assert_eq!(samples, 17_001);
    assert_eq!(numbers(&store, "time"), (vec![samples], recording.time));
    for column in &recording.columns {
        let (shape, values) = numbers(&store, column.channel.name());
        assert_eq!(shape[0], samples);
        assert_eq!(
            bits(&values),
            bits(&column.values),
            "{}",
            column.channel.name()
        );
    }
    assert_eq!(attribute(&store, "complete"), 1);
    assert_eq!(attribute(&store, "samples"), samples);
    assert_eq!(attribute(&store, "scene"), scene.text());
    assert_eq!(attribute(&store, "steps"), simulation.statistics().steps);
}

/// A reader never sees arrays of different lengths, whenever it looks.
#[test]
fn the_group_document_holds_all_lengths() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("ring.zarr");
    let (scene, run, mut simulation) = ring(1e-3);
    let channels = [Channel::LinkTension, Channel::EnergyKinetic];
    let provenance = Provenance::of(&scene, &run);
    let mut writer =
        ZarrWriter::create(&path, &simulation, &channels, provenance, Existing::Keep).unwrap();
    let lengths = || -> Vec<u64> {
        let text = fs::read(path.join("zarr.json")).unwrap();
        let group: serde_json::Value = serde_json::from_slice(&text).unwrap();
        let arrays = &group["consolidated_metadata"]["metadata"];
        let length = |name: &str| arrays[name]["shape"][0].as_u64().unwrap();
        ["time", "link_tension", "energy_kinetic"]
            .map(length)
            .to_vec()
    };
    assert_eq!(lengths(), [0, 0, 0]);
    for _ in 0..10 {
        simulation.next_sample().unwrap();
        writer.push(&simulation).unwrap();
    }
    assert_eq!(
        lengths(),
        [0, 0, 0],
        "nothing is seen before it is committed"
    );
    writer.flush(&simulation).unwrap();
    assert_eq!(lengths(), [10, 10, 10]);

    // A run that is killed here leaves ten samples and says that it was running; so does one whose writer
    // never gets a word in.
    assert!(is_being_written(&path).unwrap());
    std::mem::forget(writer);
    let store = reader(&path);
    assert_eq!(attribute(&store, "status"), "running");
    assert_eq!(attribute(&store, "complete"), 0);
    let (_, energy) = numbers(&store, "energy_kinetic");
    assert!(energy.iter().all(|value| value.is_finite()));
}

/// The program may leave before the end for reasons of its own.
#[test]
fn a_writer_that_is_dropped_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("ring.zarr");
    let (scene, run, mut simulation) = ring(1e-3);
    let provenance = Provenance::of(&scene, &run);
    let channels = [Channel::LinkTension];
    let mut writer =
        ZarrWriter::create(&path, &simulation, &channels, provenance, Existing::Keep).unwrap();
    simulation.next_sample().unwrap();
    writer.push(&simulation).unwrap();
    writer.flush(&simulation).unwrap();
    drop(writer);
    let store = reader(&path);
    assert_eq!(attribute(&store, "status"), "failed");
    assert_eq!(attribute(&store, "samples"), 1);
    assert!(!is_being_written(&path).unwrap());
    let left: Vec<_> = fs::read_dir(folder.path()).unwrap().collect();
    assert_eq!(left.len(), 1, "{left:?}");
}

/// Where two folders cannot exchange their names, the old one is moved aside first.
#[test]
fn a_result_moved_aside_is_put_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("ring.zarr");
    let aside = folder.path().join(".ring.zarr.writing/old");
    fs::create_dir_all(&aside).unwrap();
    fs::write(aside.join("zarr.json"), "old").unwrap();
    fs::write(folder.path().join(".ring.zarr.writing/reserve"), "").unwrap();
    let claim = Claim::take(&path).unwrap();
    assert_eq!(fs::read_to_string(path.join("zarr.json")).unwrap(), "old");
    assert!(matches!(Claim::take(&path), Err(WriteError::Busy { .. })));
    drop(claim);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

/// Demand of `dask` on a dataset: all arrays are cut at the same times.
#[test]
fn all_arrays_have_the_same_samples_in_a_chunk() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("ring.zarr");
    let (scene, run, simulation) = ring(1e-3);
    let channels = Channel::chosen(&["all"], simulation.system()).unwrap();
    let provenance = Provenance::of(&scene, &run);
    ZarrWriter::create(&path, &simulation, &channels, provenance, Existing::Keep).unwrap();
    let text = fs::read(path.join("zarr.json")).unwrap();
    let group: serde_json::Value = serde_json::from_slice(&text).unwrap();
    let arrays = group["consolidated_metadata"]["metadata"]
        .as_object()
        .unwrap();
    let over_time = arrays
        .values()
        .filter(|it| it["dimension_names"][0] == "time");
    let mut cuts: Vec<&serde_json::Value> = over_time
        .map(|array| &array["chunk_grid"]["configuration"]["chunk_shape"][0])
        .collect();
    assert!(cuts.len() > 20);
    cuts.dedup();
    assert_eq!(cuts, [6241], "2^17 numbers for 21 flows of energy");
}

/// A travel and an angle have different units, and so have a force and a torque.
#[test]
fn units_of_tensioners_are_those_of_their_carriers() {
    let units = |scene: &Scene| {
        let drive = scene.drive().unwrap();
        let system = drive.assemble().unwrap().system;
        [Channel::TensionerPosition, Channel::TensionerForce].map(|it| it.unit_in(&system))
    };
    assert_eq!(units(&Scene::preset("marine_engine").unwrap()), ["m", "N"]);
    let timing = Scene::preset("timing_drive").unwrap();
    assert_eq!(units(&timing), ["rad", "N"]);
    let bare = timing.text().lines().map(|line| {
        match line.split_once(", plunger = ") {
            Some((carrier, _)) => format!("{carrier} }}\n"),
            None if line.starts_with("push = ") => {
                "push = { kind = 'torsion-spring', preload = '-9 N m', stiffness = '100 N m/rad', damping = '1 N m s' }\n".into()
            }
            None => format!("{line}\n"),
        }
    });
    let bare = Scene::from_text(
        &format!("settle = false\n{}", bare.collect::<String>()),
        "bare arm",
    )
    .unwrap();
    assert_eq!(units(&bare), ["rad", "N m"]);
    // Where nothing is measured, the unit is one all the same.
    let none = Scene::preset("spinning_ring").unwrap();
    assert_eq!(units(&none), ["m", "N"]);
    for channel in Channel::ALL {
        let unit = channel.unit();
        assert!(!unit.contains(" or ") && !unit.contains(','), "{unit}");
    }
}

/// Readers such as pint take `units` for one unit.
#[test]
fn units_that_differ_are_told_entry_by_entry() {
    let arms = Scene::preset("two_stage_timing").unwrap();
    let slider = "{ kind = 'slider', direction = [1, 0], mass = '0.2 kg' }";
    let mixed = arms
        .replace("tensioners.upper arm.carrier", slider)
        .unwrap();
    let adjust = "{ kind = 'slider', name = 'upper arm', within = '5 mm' }";
    let mixed = mixed
        .replace("chains.secondary.route.adjust", adjust)
        .unwrap();
    let mixed = mixed.replace("settle", "false").unwrap();
    let told = |scene: &Scene| {
        let system = scene.drive().unwrap().assemble().unwrap().system;
        Channel::TensionerPosition.unit_attribute(&system)
    };
    assert_eq!(
        told(&arms.replace("settle", "false").unwrap()),
        ("units", "rad".into())
    );
    assert_eq!(told(&mixed), ("entry_units", "rad, m".into()));
}

/// Lengths and values as one document tells them, while another thread commits without a pause.
#[test]
fn a_reader_at_any_time_sees_whole_samples() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("ring.zarr");
    let (scene, run, mut simulation) = ring(0.1);
    let channels = [Channel::LinkTension, Channel::EnergyKinetic];
    let provenance = Provenance::of(&scene, &run);
    let mut writer =
        ZarrWriter::create(&path, &simulation, &channels, provenance, Existing::Keep).unwrap();
    let done = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let looks = scope.spawn(|| {
            let (mut looks, mut longest) = (0, 0);
            while !done.load(Ordering::Relaxed) {
                longest = look(&path).max(longest);
                looks += 1;
            }
            (looks, longest)
        });
        for _ in 0..60 {
            for _ in 0..50 {
                simulation.next_sample().unwrap();
                writer.push(&simulation).unwrap();
            }
            writer.flush(&simulation).unwrap();
        }
        done.store(true, Ordering::Relaxed);
        let (looks, longest) = looks.join().unwrap();
        assert!(
            looks > 5 && longest > 0,
            "{looks} looks, at most {longest} samples"
        );
    });
    assert_eq!(look(&path), 3_000);
}

/// Opens the store as xarray does, by the group document alone; returns the number of samples.
///
/// Every file is opened once: the store of `reader` asks for the size of a file first, and
/// may then find another file.
fn look(path: &Path) -> u64 {
    let text = fs::read(path.join("zarr.json")).unwrap();
    let group: serde_json::Value = serde_json::from_slice(&text).unwrap();
    let samples = group["attributes"]["samples"].as_u64().unwrap();
    for name in ["time", "link_tension", "energy_kinetic"] {
        let metadata = &group["consolidated_metadata"]["metadata"][name];
        assert_eq!(metadata["shape"][0], samples, "{name}");
        let metadata: ArrayMetadata = serde_json::from_value(metadata.clone()).unwrap();
        let store = Arc::new(MemoryStore::new());
        let array = Array::new_with_metadata(store.clone(), &format!("/{name}"), metadata).unwrap();
        for chunk in 0..array.chunk_grid_shape()[0] {
            let key = array.chunk_key(&[chunk, 0][..array.dimensionality()]);
            let bytes = fs::read(path.join(key.as_str())).unwrap();
            store.set(&key, bytes.into()).unwrap();
        }
        let values: Vec<f64> = array.retrieve_array_subset(&array.subset_all()).unwrap();
        assert!(
            values.iter().all(|value| value.is_finite()),
            "{name} of {samples} samples"
        );
    }
    samples
}

#[test]
fn only_results_are_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("ring.zarr");
    let (scene, run, simulation) = ring(1e-3);
    let create = |existing| {
        let channels = [Channel::LinkTension];
        ZarrWriter::create(
            &path,
            &simulation,
            &channels,
            Provenance::of(&scene, &run),
            existing,
        )
    };
    create(Existing::Keep).unwrap();
    assert!(matches!(
        create(Existing::Keep),
        Err(WriteError::Exists { .. })
    ));
    // What a killed run may leave behind does not stand in the way.
    fs::write(path.join("zarr.json#1"), "{").unwrap();
    // What is to be replaced stays until there is something in its place.
    let writer = create(Existing::Replace).unwrap();
    assert!(path.join("zarr.json#1").exists());
    drop(writer);
    assert!(path.join("zarr.json#1").exists());
    let mut writer = create(Existing::Replace).unwrap();
    writer.push(&simulation).unwrap();
    writer.flush(&simulation).unwrap();
    assert!(!path.join("zarr.json#1").exists());
    drop(writer);

    fs::write(path.join("thesis.tex"), "three years").unwrap();
    let refused = create(Existing::Replace).unwrap_err();
    assert!(
        refused
            .to_string()
            .contains("`thesis.tex` in this folder is not of chaindrive")
    );
    assert!(path.join("time/zarr.json").exists(), "nothing was touched");

    fs::remove_file(path.join("zarr.json")).unwrap();
    assert!(matches!(
        create(Existing::Replace),
        Err(WriteError::Foreign { .. })
    ));
    fs::remove_dir_all(&path).unwrap();
    fs::write(&path, "a file").unwrap();
    assert!(matches!(
        create(Existing::Replace),
        Err(WriteError::Foreign { .. })
    ));
    assert_eq!(fs::read_to_string(&path).unwrap(), "a file");
}

/// Contacts are appended while the run goes on; what lasts is appended at the end, and no row changes.
#[test]
fn contacts_are_stored_as_they_were_logged() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("pin.zarr");
    let scene = Scene::preset("pin_in_bush").unwrap();
    let run = Run::suggested(&scene.run_defaults());
    let mut simulation = Simulation::start(&scene.drive().unwrap(), &run).unwrap();
    let mut table = EventTable::new(simulation.system());
    let provenance = Provenance::of(&scene, &run);
    let channels = [Channel::JointForce];
    let mut writer =
        ZarrWriter::create(&path, &simulation, &channels, provenance, Existing::Keep).unwrap();
    let store = reader(&path);
    assert_eq!(numbers(&store, "event_start").0, [0]);
    while simulation.next_sample().unwrap().is_some() {
        for event in simulation.events() {
            table.push(event);
        }
        writer.push(&simulation).unwrap();
        if simulation.time() > 0.05 {
            writer.flush(&simulation).unwrap();
            let (shape, ends) = numbers(&store, "event_end");
            assert_eq!(shape, [table.len() as u64]);
            assert_eq!(ends, table.end);
        }
    }
    for event in simulation.outstanding_events() {
        table.push(&event);
    }
    writer.finish(&simulation, &Ending::Complete).unwrap();
    assert!(table.len() > 10, "{}", table.len());
    for (name, expected) in [
        ("event_start", &table.start),
        ("event_onset_speed", &table.onset_speed),
        ("event_peak_force", &table.peak_force),
        ("event_impulse", &table.impulse),
    ] {
        let (_, found) = numbers(&store, name);
        assert_eq!(bits(&found), bits(expected), "{name}");
    }
    let texts = |name: &str| -> Vec<String> {
        let array = Array::open(store.clone(), &format!("/{name}")).unwrap();
        array.retrieve_array_subset(&array.subset_all()).unwrap()
    };
    assert_eq!(texts("event_kind"), table.kind);
    assert_eq!(texts("event_body"), table.body);
}
