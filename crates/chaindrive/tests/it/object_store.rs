//! Sweeps in an object store: what is there is what a disk would hold, whoever writes at the same time, dies or begins anew.

use std::collections::BTreeMap;
use std::error::Error;
use std::io;
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;

use chaindrive::Scene;
use chaindrive::record::{Existing, Object, Objects, WriteError};
use chaindrive::sweep::{
    Answer, Coordinator, Go, Sample, Setting, Sweep, SweepError, SweepStore, Worker,
};

type Checked = Result<(), Box<dyn Error>>;

/// An object store in memory, which may refuse to take more.
#[derive(Debug)]
struct InMemory {
    held: Mutex<(BTreeMap<String, Object>, u64)>,
    /// Puts that it still takes.
    room: AtomicUsize,
}

impl InMemory {
    fn new() -> Arc<Self> {
        Arc::new(Self {
            held: Mutex::default(),
            room: AtomicUsize::new(usize::MAX),
        })
    }

    fn held(&self) -> MutexGuard<'_, (BTreeMap<String, Object>, u64)> {
        self.held.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Contents that are the same with every sweep: two times are measured, the group document has another account of them, and
    /// an identity is drawn by lot.
    fn contents(&self) -> BTreeMap<String, Vec<u8>> {
        let held = self.held();
        let same = held.0.iter().filter(|(key, _)| is_same(key));
        same.map(|(key, object)| (key.clone(), object.bytes.clone()))
            .collect()
    }

    fn attribute(&self, name: &str) -> Option<serde_json::Value> {
        let held = self.held();
        let group = held.0.get("zarr.json")?;
        let group: serde_json::Value = serde_json::from_slice(&group.bytes).ok()?;
        group["attributes"].get(name).cloned()
    }
}

fn is_same(key: &str) -> bool {
    let first = key.split('/').next().unwrap_or_default();
    ![
        "stepping_time",
        "real_time_factor",
        "identity",
        "layout.lock",
    ]
    .contains(&first)
        && key != "zarr.json"
}

impl Objects for InMemory {
    fn name(&self) -> String {
        "memory://sweep.zarr".to_owned()
    }

    fn get(&self, key: &str) -> io::Result<Option<Object>> {
        Ok(self.held().0.get(key).cloned())
    }

    fn size(&self, key: &str) -> io::Result<Option<u64>> {
        let held = self.held();
        Ok(held.0.get(key).map(|object| object.bytes.len() as u64))
    }

    fn put(&self, key: &str, bytes: &[u8]) -> io::Result<()> {
        let took = |room: usize| room.checked_sub(1);
        let room = self
            .room
            .fetch_update(Ordering::SeqCst, Ordering::SeqCst, took);
        room.map_err(|_| io::Error::other("this bucket takes no more"))?;
        let mut held = self.held();
        held.1 += 1;
        let (bytes, tag) = (bytes.to_vec(), held.1.to_string());
        held.0.insert(key.to_owned(), Object { bytes, tag });
        Ok(())
    }

    fn put_if(&self, key: &str, bytes: &[u8], tag: Option<&str>) -> io::Result<bool> {
        let mut held = self.held();
        if held.0.get(key).map(|object| object.tag.as_str()) != tag {
            return Ok(false);
        }
        held.1 += 1;
        let (bytes, tag) = (bytes.to_vec(), held.1.to_string());
        held.0.insert(key.to_owned(), Object { bytes, tag });
        Ok(true)
    }

    fn erase(&self, keys: &[String]) -> io::Result<()> {
        let mut held = self.held();
        for key in keys {
            held.0.remove(key);
        }
        Ok(())
    }

    fn list(&self, prefix: &str) -> io::Result<Vec<String>> {
        let held = self.held();
        let keys = held.0.keys().filter(|key| key.starts_with(prefix));
        Ok(keys.cloned().collect())
    }
}

/// Runs of unlike length, so that later ones make the layout grow.
fn sweep() -> Result<Sweep, Box<dyn Error>> {
    let scene = Scene::preset("spinning_ring")?;
    let texts = |values: &[&str]| {
        let settings = values.iter().map(|it| Setting::Text((*it).to_owned()));
        settings.collect::<Vec<_>>()
    };
    let vary = [
        (
            "run.until".to_owned(),
            texts(&["1 ms", "2 ms", "3 ms", "4 ms", "5 ms", "6 ms"]),
        ),
        ("chain.mass".to_owned(), texts(&["8 g", "9 g"])),
    ];
    Ok(Sweep::new(&scene, &vary, &["link_tension".to_owned()])?)
}

/// A task a variant.
fn sample(sweep: &Sweep) -> Sample {
    Sample {
        first: sweep.carry_out(0, &AtomicBool::new(false)),
        variants_per_task: 1,
        stopped: false,
    }
}

fn files(root: &Path) -> io::Result<BTreeMap<String, Vec<u8>>> {
    let mut found = BTreeMap::new();
    let mut left = vec![root.to_owned()];
    while let Some(folder) = left.pop() {
        for entry in std::fs::read_dir(folder)? {
            let path = entry?.path();
            if path.is_dir() {
                left.push(path);
            } else if let Ok(key) = path.strip_prefix(root) {
                let key = key.to_string_lossy().into_owned();
                if is_same(&key) {
                    found.insert(key, std::fs::read(&path)?);
                }
            }
        }
    }
    Ok(found)
}

/// All of a sweep in memory.
fn whole(sweep: &Sweep) -> Result<Arc<InMemory>, Box<dyn Error>> {
    let memory = InMemory::new();
    let objects: Arc<dyn Objects> = memory.clone();
    let mut store = SweepStore::begin(&objects, sweep, &sample(sweep), Existing::Keep)?;
    store.run(Some(2), &mut |_| Go::On)?;
    store.finish()?;
    Ok(memory)
}

#[test]
fn objects_hold_what_a_disk_holds() -> Checked {
    let sweep = sweep()?;
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("sweep.zarr");
    let mut store = SweepStore::begin(path.as_path(), &sweep, &sample(&sweep), Existing::Keep)?;
    // One after the other, so that the layout grows the same way.
    store.run(Some(1), &mut |_| Go::On)?;
    store.finish()?;
    let memory = InMemory::new();
    let objects: Arc<dyn Objects> = memory.clone();
    let mut store = SweepStore::begin(&objects, &sweep, &sample(&sweep), Existing::Keep)?;
    store.run(Some(1), &mut |_| Go::On)?;
    let (tally, _) = store.finish()?;
    assert_eq!(tally.finished, 12);
    assert_eq!(memory.attribute("status"), Some("complete".into()));
    let (found, known) = (memory.contents(), files(&path)?);
    assert_eq!(
        found.keys().collect::<Vec<_>>(),
        known.keys().collect::<Vec<_>>()
    );
    for (key, bytes) in &known {
        assert_eq!(found.get(key), Some(bytes), "{key}");
    }
    Ok(())
}

/// Six workers of their own, each with tasks that make the layout grow: none loses what another has put there.
#[test]
fn workers_grow_the_layout_together() -> Checked {
    let sweep = sweep()?;
    let memory = InMemory::new();
    let objects: Arc<dyn Objects> = memory.clone();
    let mut store = SweepStore::begin(&objects, &sweep, &sample(&sweep), Existing::Keep)?;
    let open = store.open_tasks()?;
    assert_eq!(open, (1..12).collect::<Vec<_>>());
    let answers = thread::scope(|scope| {
        let workers = (0..6).map(|first| {
            let (objects, open) = (&objects, &open);
            scope.spawn(move || -> Result<Vec<Answer>, WriteError> {
                let worker = Worker::open(objects)?;
                let tasks = open.iter().skip(first).step_by(6);
                let never = AtomicBool::new(false);
                let answers = tasks.map(|task| worker.carry_out(*task, &never));
                answers.map(|it| Ok(it?.unwrap_or_default())).collect()
            })
        });
        let workers: Vec<_> = workers.collect();
        let joined = workers.into_iter().map(thread::ScopedJoinHandle::join);
        joined.collect::<Result<Vec<_>, _>>()
    });
    for answers in answers.map_err(|_| "a worker panicked")? {
        answers?.into_iter().try_for_each(|it| store.take(it))?;
    }
    store.finish()?;
    assert_eq!(memory.attribute("status"), Some("complete".into()));
    let (found, known) = (memory.contents(), whole(&sweep)?.contents());
    assert_eq!(
        found.keys().collect::<Vec<_>>(),
        known.keys().collect::<Vec<_>>()
    );
    for (key, bytes) in known.iter().filter(|(key, _)| key.contains("/c/")) {
        assert_eq!(found.get(key), Some(bytes), "{key}");
    }
    Ok(())
}

/// A bucket that takes no more after any number of puts: what is there is told truly, and the sweep goes on with it to the same bytes.
#[test]
fn a_sweep_that_was_broken_off_goes_on() -> Checked {
    let sweep = sweep()?;
    let known = whole(&sweep)?.contents();
    for room in [3, 40, 80, 120, 160, 200, 240] {
        let memory = InMemory::new();
        let objects: Arc<dyn Objects> = memory.clone();
        memory.room.store(room, Ordering::SeqCst);
        let begun = SweepStore::begin(&objects, &sweep, &sample(&sweep), Existing::Keep);
        let broken = begun.map_err(SweepError::from).and_then(|mut store| {
            store.run(Some(2), &mut |_| Go::On)?;
            Ok(store.finish()?)
        });
        assert!(broken.is_err(), "{room} puts are enough for everything");
        assert_ne!(memory.attribute("status"), Some("complete".into()));
        memory.room.store(usize::MAX, Ordering::SeqCst);
        let mut store = match SweepStore::go_on(&objects, &sweep) {
            Ok(store) => store,
            // It had not been laid out: the place is free again.
            Err(WriteError::Foreign { .. }) => {
                assert!(objects.list("")?.is_empty());
                SweepStore::begin(&objects, &sweep, &sample(&sweep), Existing::Keep)?
            }
            Err(other) => return Err(other.into()),
        };
        store.run(Some(1), &mut |_| Go::On)?;
        let (tally, _) = store.finish()?;
        assert_eq!((tally.finished, tally.open), (12, 0));
        let found = memory.contents();
        for (key, bytes) in known.iter().filter(|(key, _)| key.contains("/c/")) {
            assert_eq!(found.get(key), Some(bytes), "{room} puts: {key}");
        }
    }
    Ok(())
}

/// Nobody can see whether another call of the same sweep lives: both hand out the same tasks, and store the same.
#[test]
fn two_calls_at_once_store_the_same() -> Checked {
    let sweep = sweep()?;
    let memory = InMemory::new();
    let objects: Arc<dyn Objects> = memory.clone();
    let first = SweepStore::begin(&objects, &sweep, &sample(&sweep), Existing::Keep)?;
    let second = SweepStore::go_on(&objects, &sweep)?;
    thread::scope(|scope| -> Checked {
        let both = [first, second].map(|mut store| {
            scope.spawn(move || {
                store.run(Some(2), &mut |_| Go::On)?;
                let (tally, _) = store.finish()?;
                Ok::<_, SweepError>(tally.finished)
            })
        });
        for call in both {
            assert_eq!(call.join().map_err(|_| "a call panicked")??, 12);
        }
        Ok(())
    })?;
    assert_eq!(memory.attribute("status"), Some("complete".into()));
    let (found, known) = (memory.contents(), whole(&sweep)?.contents());
    for (key, bytes) in known.iter().filter(|(key, _)| key.contains("/c/")) {
        assert_eq!(found.get(key), Some(bytes), "{key}");
    }
    Ok(())
}

/// A worker of a sweep that was replaced while it computed leaves the new one alone, and says why.
#[test]
fn a_worker_of_an_earlier_sweep_writes_no_more() -> Checked {
    let sweep = sweep()?;
    let memory = InMemory::new();
    let objects: Arc<dyn Objects> = memory.clone();
    let mut first = SweepStore::begin(&objects, &sweep, &sample(&sweep), Existing::Keep)?;
    let worker = Worker::open(&objects)?;
    let never = AtomicBool::new(false);
    let refused = SweepStore::begin(&objects, &sweep, &sample(&sweep), Existing::Keep);
    assert!(
        matches!(refused, Err(WriteError::Exists { .. })),
        "{refused:?}"
    );
    let vary = [(
        "chain.start.speed".to_owned(),
        ["300", "310"]
            .map(|it| Setting::Text(it.to_owned()))
            .to_vec(),
    )];
    let other = Sweep::new(&Scene::preset("spinning_ring")?, &vary, &[])?;
    let second = SweepStore::begin(&objects, &other, &sample(&other), Existing::Replace)?;
    let before = memory.contents();
    let outcome = sweep.carry_out(5, &never);
    let refused = worker.put(5, vec![outcome]);
    assert!(
        matches!(refused, Err(WriteError::Vanished { .. })),
        "{refused:?}"
    );
    // Nor does who hands out its tasks.
    let told = first.finish();
    assert!(matches!(told, Err(WriteError::Vanished { .. })));
    drop(first);
    assert_eq!(memory.contents(), before);
    assert_eq!(memory.attribute("status"), Some("running".into()));
    drop(second);
    assert_eq!(memory.attribute("status"), Some("failed".into()));
    Ok(())
}

/// Who died while it laid a sweep out has left an identity, and nobody but the user knows that it died.
#[test]
fn what_was_begun_and_not_laid_out_is_replaced_on_demand() -> Checked {
    let sweep = sweep()?;
    let memory = whole(&sweep)?;
    let objects: Arc<dyn Objects> = memory.clone();
    objects.erase(&["zarr.json".to_owned()])?;
    let again = SweepStore::begin(&objects, &sweep, &sample(&sweep), Existing::Keep);
    assert!(
        matches!(again, Err(WriteError::HalfBegun { .. })),
        "{again:?}"
    );
    let mut again = SweepStore::begin(&objects, &sweep, &sample(&sweep), Existing::Replace)?;
    again.run(Some(2), &mut |_| Go::On)?;
    let (tally, _) = again.finish()?;
    assert_eq!(tally.finished, 12);
    Ok(())
}

#[test]
fn a_sweep_that_was_copied_from_a_disk_goes_on() -> Checked {
    let sweep = sweep()?;
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("sweep.zarr");
    let store = SweepStore::begin(path.as_path(), &sweep, &sample(&sweep), Existing::Keep)?;
    drop(store);
    let memory = InMemory::new();
    let objects: Arc<dyn Objects> = memory.clone();
    for (key, bytes) in files(&path)? {
        objects.put(&key, &bytes)?;
    }
    objects.put("zarr.json", &std::fs::read(path.join("zarr.json"))?)?;
    let mut store = SweepStore::go_on(&objects, &sweep)?;
    assert_eq!(store.open_tasks()?.len(), 11);
    store.run(Some(2), &mut |_| Go::On)?;
    let (tally, _) = store.finish()?;
    assert_eq!(tally.finished, 12);
    assert_eq!(memory.attribute("status"), Some("complete".into()));
    Ok(())
}

#[test]
fn what_is_not_a_sweep_of_chaindrive_stays() -> Checked {
    let sweep = sweep()?;
    let memory = whole(&sweep)?;
    let objects: Arc<dyn Objects> = memory.clone();
    objects.put("thesis.tex", b"years of work")?;
    for existing in [Existing::Keep, Existing::Replace] {
        let refused = SweepStore::begin(&objects, &sweep, &sample(&sweep), existing);
        assert!(refused.is_err());
    }
    objects.erase(&["zarr.json".to_owned()])?;
    let refused = SweepStore::begin(&objects, &sweep, &sample(&sweep), Existing::Replace);
    assert!(
        matches!(refused, Err(WriteError::Foreign { .. })),
        "{refused:?}"
    );
    objects.put("identity", b"of somebody else")?;
    let refused = SweepStore::begin(&objects, &sweep, &sample(&sweep), Existing::Replace);
    assert!(
        matches!(refused, Err(WriteError::Foreign { .. })),
        "{refused:?}"
    );
    objects.erase(&["identity".to_owned()])?;
    let refused = SweepStore::begin(&objects, &sweep, &sample(&sweep), Existing::Replace);
    assert!(
        matches!(refused, Err(WriteError::Foreign { .. })),
        "{refused:?}"
    );
    assert!(objects.get("thesis.tex")?.is_some());
    Ok(())
}

#[test]
fn addresses_are_no_folders() -> Checked {
    let sweep = sweep()?;
    let refused = SweepStore::begin(
        Path::new("s3://bucket/sweep.zarr"),
        &sweep,
        &sample(&sweep),
        Existing::Keep,
    );
    assert!(
        matches!(refused, Err(WriteError::Address { .. })),
        "{refused:?}"
    );
    Ok(())
}
