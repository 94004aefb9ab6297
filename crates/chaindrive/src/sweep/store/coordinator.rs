//! The coordinator of a sweep in a store: it begins the sweep, hands out its tasks, and notes its progress in the store.

use std::path::Path;
use std::time::Duration;

use serde_json::{Map, Value};
use zarrs::array::builder::ArrayBuilderFillValue;
use zarrs::array::{DataType, data_type};

use super::{Arrays, StoreLocation, StoreSink, every_chunk};
use crate::channel::unit_attribute;
use crate::clock::Instant;
use crate::story::{Ending, Story};
use crate::sweep::coordinator::{Coordinator, Watch, carry_out};
use crate::sweep::layout::Layout;
use crate::sweep::sink::Sink;
use crate::sweep::{
    Answer, Coordinate, Go, Outcome, Progress, Recipe, ResultQuantity, Sample, Sweep, SweepError,
    TEXTS, Tally, VariantCounts, Worker,
};
use crate::zarr::{
    Existing, Fault, LAYOUT, RECIPE, Store, StoredArray, WriteError, about, metadata,
    store_metadata,
};

/// Wall time between two accounts of a sweep in its store.
const TELL_EVERY: Duration = Duration::from_secs(5);

/// Tasks that are read back at a time.
const TASKS_AT_A_TIME: usize = 64;

/// The store of a sweep, claimed by the process that hands out its tasks.
pub struct SweepStore {
    store: Store,
    sweep: Sweep,
    sink: StoreSink,
    /// Layout by which the metadata of all arrays were written last, and these.
    told: Layout,
    arrays: Map<String, Value>,
    finished: VariantCounts,
    tasks: usize,
    last_told: Instant,
    /// Whether the store is in its place. An earlier result stays there until a task is stored.
    is_public: bool,
}

impl std::fmt::Debug for SweepStore {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("SweepStore")
            .field("path", &self.store.path())
            .field("finished", &self.finished)
            .finish_non_exhaustive()
    }
}

impl SweepStore {
    /// Goes on with a sweep where its store is, and begins it elsewhere once some variants have been timed for so many workers; as
    /// many as there are cores if absent. None where the watch stopped that.
    ///
    /// # Errors
    /// Those of [`begin`](Self::begin) and [`go_on`](Self::go_on), and of [`Sweep::time_sample`].
    pub fn open(
        place: impl Into<StoreLocation>,
        sweep: &Sweep,
        existing: Existing,
        workers: Option<usize>,
        watch: impl FnMut() -> Go,
    ) -> Result<Option<Self>, SweepError> {
        let place = place.into();
        let goes_on = || Ok::<_, WriteError>(existing == Existing::Keep && place.is_taken()?);
        if !goes_on()? {
            let sample = sweep.time_sample(workers, watch)?;
            if sample.stopped {
                return Ok(None);
            }
            match Self::begin(place.clone(), sweep, &sample, existing) {
                // The same sweep may have been begun by somebody else meanwhile.
                Err(_) if goes_on()? => {}
                begun => return Ok(Some(begun?)),
            }
        }
        Ok(Some(Self::go_on(place, sweep)?))
    }

    /// Begins a sweep, with tasks of the size that a sample suggests. Where it replaces an earlier result, that one stays until a
    /// task is stored, see [`start`](Coordinator::start); in an object store it is removed at once.
    ///
    /// # Errors
    /// [`WriteError`] when the place is taken or cannot be written.
    pub fn begin(
        place: impl Into<StoreLocation>,
        sweep: &Sweep,
        sample: &Sample,
        existing: Existing,
    ) -> Result<Self, WriteError> {
        let store = match place.into() {
            StoreLocation::Disk(path) => Store::begin(&path, existing)?,
            StoreLocation::Objects(objects) => Store::begin_in(&objects, existing)?,
        };
        let layout = Layout::new(sweep, sample.variants_per_task, sample.account());
        let files = [
            (RECIPE, serde_json::to_vec(&sweep.recipe())),
            (LAYOUT, serde_json::to_vec(&layout)),
        ];
        let mut files = files.into_iter();
        let put = files.try_for_each(|(name, bytes)| store.put(name, &bytes?));
        put.map_err(|fault| store.fault(fault))?;
        let mut begun = Self::on(store, sweep, false)?;
        begun.tell(&Ending::None)?;
        // What the sample had to choose serves the sweep.
        let mut made = sweep.choices.made().into_iter();
        made.try_for_each(|(block, choice)| begun.sink.keep(block, &choice))?;
        // A variant that is a task on its own need not be computed again.
        if begun.told.block() == 1 && sample.first != Outcome::Open {
            let answer = begun.sink.put(0, vec![sample.first.clone()])?;
            begun.take(answer)?;
        }
        begun.publish()?;
        Ok(begun)
    }

    /// Puts the store in its place once it has something, or nothing is there. Nobody may write in it meanwhile.
    fn publish(&mut self) -> Result<(), WriteError> {
        let has_something = self.finished.ended() > 0 || !self.store.place().exists();
        if !self.is_public && has_something {
            self.store.publish()?;
            self.store.share()?;
            self.sink = StoreSink::on(self.store.storage().clone(), self.store.path());
            self.is_public = true;
        }
        Ok(())
    }

    /// Goes on with a sweep that was stopped or killed, where it is this one.
    ///
    /// # Errors
    /// [`WriteError::OtherSweep`] where it is another one, [`WriteError::Exists`] where it is another result, and all others.
    pub fn go_on(place: impl Into<StoreLocation>, sweep: &Sweep) -> Result<Self, WriteError> {
        let mut store = match place.into() {
            StoreLocation::Disk(path) => Store::reopen_shared(&path)?,
            StoreLocation::Objects(objects) => Store::reopen_in(&objects)?,
        };
        let recipe = store.read(RECIPE).map_err(|fault| store.fault(fault))?;
        let Some(recipe) = recipe else {
            return Err(WriteError::Exists {
                path: store.path().to_owned(),
            });
        };
        let recipe: Result<Recipe, Fault> = serde_json::from_slice(&recipe).map_err(Fault::from);
        let recipe = recipe.map_err(|fault| store.fault(fault))?;
        if let Some(difference) = sweep.recipe().difference(&recipe) {
            return Err(WriteError::OtherSweep {
                path: store.path().to_owned(),
                difference,
            });
        }
        store.go_on()?;
        let mut left = Self::on(store, sweep, true)?;
        left.finished = left.read(|_, _| {})?.counts();
        left.tell(&Ending::None)?;
        Ok(left)
    }

    /// A store whose recipe and layout are there. The first that it tells are the arrays of the layout.
    fn on(store: Store, sweep: &Sweep, is_public: bool) -> Result<Self, WriteError> {
        let sink = StoreSink::on(store.storage().clone(), store.path());
        let read = sink.layout().and_then(|layout| {
            let arrays = put_coordinates(&store, sweep, &layout)?;
            Ok((layout.tasks(), arrays))
        });
        let (tasks, arrays) = read.map_err(|fault| store.fault(fault))?;
        Ok(Self {
            store,
            sweep: sweep.clone(),
            sink,
            told: Layout::default(),
            arrays,
            finished: VariantCounts::default(),
            tasks,
            last_told: Instant::now(),
            is_public,
        })
    }

    /// Where the store is, symbolic links followed: the path for workers.
    pub fn place(&self) -> &Path {
        self.store.place()
    }

    /// Number of the open file that holds the claim, which processes that are forked inherit: they must close it. There is none in
    /// object stores.
    #[cfg(unix)]
    pub fn descriptor(&self) -> Option<i32> {
        self.store.descriptor()
    }

    fn read(&self, mut take: impl FnMut(usize, Outcome)) -> Result<Tally, WriteError> {
        let mut tally = Tally::default();
        let layout = self.sink.layout();
        let read = layout.and_then(|layout| {
            let stored = self.sink.stored(&layout)?;
            let mut take = |variant, outcome| {
                tally.push(variant, &outcome);
                take(variant, outcome);
            };
            for task in (0..self.tasks).filter(|task| !stored.contains(task)) {
                let open = layout.region(task).variants.into_iter();
                open.for_each(|(variant, _)| take(variant, Outcome::Open));
            }
            // Some at a time, so that memory stays flat.
            let stored: Vec<usize> = stored.into_iter().collect();
            for tasks in stored.chunks(TASKS_AT_A_TIME) {
                let read = |task: &usize| self.sink.read_back(&layout, *task);
                let outcomes = self.store.storage().on_each(tasks, read)?;
                for (variant, outcome) in outcomes.into_iter().flatten() {
                    take(variant, outcome);
                }
            }
            Ok(())
        });
        read.map_err(|fault| self.store.fault(fault))?;
        Ok(tally)
    }

    fn tell(&mut self, ending: &Ending) -> Result<(), WriteError> {
        // In another's store nothing is laid.
        if let Some(what) = self.store.storage().missing() {
            let path = self.store.path().to_owned();
            return Err(WriteError::Vanished { path, what });
        }
        let layout = self.sink.layout();
        let layout = layout.map_err(|fault| self.store.fault(fault))?;
        if layout != self.told {
            let arrays = lay(&self.store, &self.sweep, &layout);
            let arrays = arrays.map_err(|fault| self.store.fault(fault))?;
            self.arrays.extend(arrays);
            self.told = layout;
        }
        let attributes = attributes(&self.sweep, &self.told, self.finished, ending);
        self.store.tell(attributes, self.arrays.clone(), ending)?;
        self.last_told = Instant::now();
        Ok(())
    }
}

/// Ends by saying in the store how: complete, failed where variants failed, or interrupted where some are open. The tally is read
/// from the store task by task.
impl Coordinator for SweepStore {
    fn sweep(&self) -> &Sweep {
        &self.sweep
    }

    fn worker(&self) -> Worker {
        Worker::of(&self.sweep, self.sink.clone())
    }

    fn open_tasks(&self) -> Result<Vec<usize>, WriteError> {
        let stored = self.sink.stored(&self.told);
        let stored = stored.map_err(|fault| self.store.fault(fault))?;
        let tasks = 0..self.tasks;
        Ok(tasks.filter(|task| !stored.contains(task)).collect())
    }

    /// Says in the store how far the sweep is, if it is time.
    fn take(&mut self, answer: Answer) -> Result<(), WriteError> {
        let first = self.finished.ended() == 0;
        self.finished += answer.finished;
        if first || self.last_told.elapsed() >= TELL_EVERY {
            self.tell(&Ending::None)?;
        }
        Ok(())
    }

    fn lose(&mut self, _task: usize, _reason: &str) {}

    fn progress(&self) -> Progress<'_> {
        Progress {
            outcomes: &[],
            finished: self.finished.ended(),
            variants: self.sweep.len(),
        }
    }

    fn is_public(&self) -> bool {
        self.is_public
    }

    /// Puts the store in its place. Where that replaces an earlier result, the first task is carried out before.
    fn start(&mut self, watch: &mut Watch<'_>) -> Result<Go, SweepError> {
        if self.is_public {
            return Ok(Go::On);
        }
        let first: Vec<usize> = self.open_tasks()?.into_iter().take(1).collect();
        let go = carry_out(self, &first, Some(1), watch)?;
        self.publish()?;
        Ok(go)
    }

    fn finish(&mut self) -> Result<(Tally, String), WriteError> {
        let few = self.sweep.has_a_line_each();
        let mut outcomes = vec![Outcome::Open; if few { self.sweep.len() } else { 0 }];
        let tally = self.read(|variant, outcome| {
            if let Some(place) = outcomes.get_mut(variant) {
                *place = outcome;
            }
        })?;
        self.finished = tally.counts();
        self.tell(&tally.ending())?;
        let report = if few {
            self.sweep.report(&outcomes).to_string()
        } else {
            tally.summary(&self.sweep)
        };
        Ok((tally, report))
    }
}

/// Writes the coordinates of the variants, which do not change.
fn put_coordinates(
    store: &Store,
    sweep: &Sweep,
    layout: &Layout,
) -> Result<Map<String, Value>, Fault> {
    let dims: Vec<String> = sweep.dims().into_iter().map(str::to_owned).collect();
    let arrays = Arrays {
        storage: store.storage(),
        layout,
        dims: Some(&dims),
    };
    let mut written = Map::new();
    // The rows of a table are numbered.
    let numbered = dims.len() == 1 && sweep.dimensions().iter().all(|it| it.name != dims[0]);
    if numbered {
        let rows = Coordinate::Whole((0..).take(sweep.len()).collect());
        let array = put_coordinate(&arrays, &dims[0], &dims[0], &rows, sweep.len(), Map::new())?;
        written.insert(dims[0].clone(), array);
    }
    for dimension in sweep.dimensions() {
        let mut about = Map::new();
        if let Some(unit) = dimension.unit {
            about.insert(unit_attribute(unit).into(), unit.into());
        }
        about.insert("long_name".into(), dimension.path.as_str().into());
        about.insert("path".into(), dimension.path.as_str().into());
        let (along, cut) = if numbered {
            (dims[0].as_str(), layout.cuts[0])
        } else {
            (dimension.name.as_str(), dimension.values.len())
        };
        let array = put_coordinate(
            &arrays,
            &dimension.name,
            along,
            &dimension.values,
            cut,
            about,
        )?;
        written.insert(dimension.name.clone(), array);
    }
    Ok(written)
}

fn put_coordinate(
    arrays: &Arrays<'_>,
    name: &str,
    along: &str,
    values: &Coordinate,
    cut: usize,
    about: Map<String, Value>,
) -> Result<Value, Fault> {
    let (dims, shape, chunk) = ([along], [values.len()], [cut]);
    let array = |kind: DataType, fill: ArrayBuilderFillValue| {
        arrays.array(name, &dims, &shape, &chunk, &kind, fill, about)
    };
    let array = match values {
        Coordinate::Numbers(numbers) => put_whole(
            array(data_type::float64(), f64::NAN.into())?,
            numbers.as_slice(),
        ),
        Coordinate::Whole(numbers) => {
            put_whole(array(data_type::int64(), 0_i64.into())?, numbers.as_slice())
        }
        Coordinate::Texts(texts) => {
            put_whole(array(data_type::string(), "".into())?, texts.clone())
        }
    }?;
    store_metadata(&array)?;
    metadata(&array)
}

/// Writes an array of one dimension.
fn put_whole<'a>(
    array: StoredArray,
    values: impl zarrs::array::IntoArrayBytes<'a>,
) -> Result<StoredArray, Fault> {
    if array.shape()[0] > 0 {
        array.store_array_subset_opt(&array.subset_all(), values, &every_chunk())?;
    }
    Ok(array)
}

/// Writes what a layout says of all arrays but the coordinates of the variants.
fn lay(store: &Store, sweep: &Sweep, layout: &Layout) -> Result<Map<String, Value>, Fault> {
    let dims: Vec<String> = sweep.dims().into_iter().map(str::to_owned).collect();
    let arrays = Arrays {
        storage: store.storage(),
        layout,
        dims: Some(&dims),
    };
    let mut written = Map::new();
    if !layout.time.is_empty() {
        let time = Coordinate::Numbers(layout.time.clone());
        let about = about("s", "time");
        let array = put_coordinate(&arrays, "time", "time", &time, layout.samples, about)?;
        written.insert("time".into(), array);
    }
    for axis in &layout.axes {
        let labels = axis.coordinate();
        let (name, cut) = (axis.name.as_str(), axis.cut);
        let array = put_coordinate(&arrays, name, name, &labels, cut, Map::new())?;
        written.insert(axis.name.clone(), array);
    }
    for (name, units) in &layout.quantities {
        if let Some(quantity) = ResultQuantity::from_name(name) {
            let about = about(&units.join(" or "), quantity.description());
            let array = arrays.quantity(quantity, about)?;
            store_metadata(&array)?;
            written.insert(name.clone(), metadata(&array)?);
        }
    }
    for (name, description) in TEXTS {
        let mut about = Map::new();
        about.insert("long_name".into(), description.into());
        let array = arrays.text(name, about)?;
        store_metadata(&array)?;
        written.insert(name.into(), metadata(&array)?);
    }
    Ok(written)
}

/// Attributes of the store: those of the sweep, and how the arrays are to be read.
fn attributes(
    sweep: &Sweep,
    layout: &Layout,
    finished: VariantCounts,
    ending: &Ending,
) -> Map<String, Value> {
    let mut story = Story(sweep.attributes(&layout.methods, finished, ending));
    // Readers take the columns of a table for coordinates.
    let columns = sweep.dimensions().iter().map(|d| d.name.as_str());
    let columns: Vec<&str> = columns
        .filter(|name| !sweep.dims().contains(name))
        .collect();
    if !columns.is_empty() {
        story.text("coordinates", &columns.join(" "));
    }
    story.count("variants_per_task", layout.block() as u64);
    story.0
}
