//! Many drives at once: variants of a scene, run on all cores and stacked into labelled arrays.
//!
//! Parallelism is across runs and nowhere else: a variant is computed by one thread, so its numbers are
//! those of a run on its own, bit for bit, whatever the number of threads.

mod account;
mod answer;
mod arrays;
mod attributes;
mod blocks;
mod choices;
mod chunks;
mod columns;
mod coordinator;
mod design;
mod dimension;
mod layout;
mod report;
mod sample;
mod sink;
mod store;
mod tally;
mod texts;
mod threads;
mod worker;

use std::sync::atomic::AtomicBool;
use std::sync::{Arc, OnceLock};

use serde::{Deserialize, Serialize};

pub use crate::statistic::Statistic;
pub use account::{Account, Entry, ResultQuantity};
pub use answer::{Answer, VariantCounts};
pub use arrays::{StackedQuantity, StackedText, SweepArrays};
use blocks::SweepBlocks;
use choices::{Choices, SharedChoice};
pub use coordinator::{Coordinator, SweepMemory, Watch};
pub use design::Recipe;
pub use dimension::{Arrangement, Coordinate, Dimension, Setting};
pub use report::Report;
pub use sample::Sample;
pub use store::{StoreLocation, SweepStore};
pub use tally::Tally;
pub(crate) use texts::{OPEN, TEXTS};
pub use worker::Worker;

use crate::record::WriteError;
use crate::scene::SceneError;
use crate::{Scene, SimulationError};

/// Why a sweep cannot begin.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "each message names its fields")]
pub enum SweepError {
    /// A path or a value is not of a scene.
    #[error(transparent)]
    Scene(#[from] SceneError),

    /// A channel that does not exist.
    #[error(transparent)]
    Channel(#[from] SimulationError),

    /// Nothing to do.
    #[error(
        "nothing is varied; give a path and its values, such as route.pretension = 10 kN, 15 kN"
    )]
    Nothing,

    /// A path within another that is put in later.
    #[error(
        "`{path}` is varied, and then replaced by the values of `{by}`; name `{by}` first, or leave out one of them"
    )]
    Covered { path: String, by: String },

    /// A setting that a varied path replaces.
    #[error("`{path}` is varied, and given as `{given}` as well; give one of them")]
    Given { path: String, given: String },

    /// A method or step that an accuracy chooses.
    #[error(
        "`{path}` is varied, but `run.accuracy` asks for an accuracy, and method and step are chosen for it; leave out one of them"
    )]
    Chosen { path: String },

    /// A path without values.
    #[error("`{path}` has no values; give at least one")]
    Empty { path: String },

    /// Values that go together in no variant.
    #[error(
        "no variant is a drive, of {tried} that were tried; mend this, or vary something else. The first ({variant}): {source}"
    )]
    NoDrive {
        tried: usize,
        variant: String,
        source: SceneError,
    },

    /// Columns of a table that do not go together.
    #[error(
        "`{path}` has {rows} values, `{first}` has {others}; a table has a value of each in every row"
    )]
    Uneven {
        path: String,
        rows: usize,
        first: String,
        others: usize,
    },

    /// Two paths to one place.
    #[error("`{path}` is varied twice; give all of its values at once")]
    Twice { path: String },

    /// Two entries of a dimension are equal.
    #[error("`{path}`: the value {value} stands twice; give each value once")]
    Repeated { path: String, value: String },

    /// A range that gives no values.
    #[error("`{path}` = {range}: {reason}")]
    Range {
        path: String,
        range: String,
        reason: String,
    },

    /// More variants than memory could hold.
    #[error("the sweep has more than {most} variants; split it")]
    TooMany { most: usize },

    /// Channels of runs whose samples are not at the same times.
    #[error(
        "channels cannot be stacked when the interval between samples is varied (`{path}`); record none, or leave `run.every` alone"
    )]
    Intervals { path: String },

    /// The system refuses threads.
    #[error("the threads cannot be started: {0}; ask for fewer")]
    Threads(#[from] std::io::Error),

    /// A worker of another build, or on another instruction set.
    #[error("a worker cannot take part in the sweep: {refusal}")]
    Origin { refusal: String },

    /// The store of the sweep.
    #[error(transparent)]
    Write(#[from] WriteError),
}

/// Outcome of a variant.
#[expect(
    clippy::large_enum_variant,
    reason = "most variants of a sweep are done"
)]
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub enum Outcome {
    /// Not yet, or not at all because the sweep was stopped.
    #[default]
    Open,
    /// At its end.
    Done(Account),
    /// With this message.
    Failed(String),
}

/// A sweep in progress.
#[derive(Clone, Copy, Debug)]
pub struct Progress<'a> {
    /// One outcome a variant; none where a store keeps them.
    pub outcomes: &'a [Outcome],
    /// Variants that are no longer open.
    pub finished: usize,
    /// All variants.
    pub variants: usize,
}

/// Answer of an observer: go on, or stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Go {
    /// With the next variants.
    On,
    /// No further; variants in work are given up.
    NoFurther,
}

/// Variants of a scene: every combination of some values, or the rows of a table.
///
/// # Example
///
/// ```
/// use chaindrive::sweep::{Coordinate, Go, Outcome, Setting, Sweep};
/// use chaindrive::Scene;
///
/// let scene = Scene::preset("spinning_ring")?.replace("run.until", "2 ms")?;
/// let speeds = ["300 rad/s", "400 rad/s"].map(|speed| Setting::Text(speed.into()));
/// let vary = [("chain.start.speed".to_owned(), speeds.to_vec())];
/// let sweep = Sweep::new(&scene, &vary, &[])?;
/// assert_eq!(sweep.dimensions()[0].name, "speed");
/// assert_eq!(sweep.dimensions()[0].values, Coordinate::Numbers(vec![300.0, 400.0]));
///
/// let outcomes = sweep.run(None, |_| Go::On)?;
/// assert!(outcomes.iter().all(|outcome| matches!(outcome, Outcome::Done(_))));
/// let stacked = sweep.stack(&outcomes);
/// assert_eq!(stacked.shape, [2]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Sweep {
    scene: Scene,
    arrangement: Arrangement,
    dimensions: Arc<[Dimension]>,
    record: Vec<String>,
    len: usize,
    /// Samples of the longest run among those that were looked at; 0 when no channel is kept.
    most_samples: usize,
    /// Filled when somebody asks.
    blocks: Arc<OnceLock<SweepBlocks>>,
    choices: Arc<Choices>,
}

/// Variants at most: at a second each they would take a week and a half.
const MOST: usize = 1_000_000;

/// Dimension of the rows of a table.
const VARIANT: &str = "variant";

/// Settings that an accuracy chooses, whatever the scene says about them.
const CHOSEN: [&str; 4] = ["run.method", "run.step", "run.tolerance", "run.onset_depth"];

impl Sweep {
    /// Refuses settings that a varied path would silently replace: pairs of the path in the scene, into which they
    /// have been put, and of what the user calls them.
    ///
    /// # Errors
    /// [`SweepError::Given`] for the first one.
    pub fn check_given(&self, given: &[(String, String)]) -> Result<(), SweepError> {
        for (path, name) in given {
            let chosen = CHOSEN.contains(&self.scene.place(path).as_str());
            let replaces = |varied: &str| {
                let accuracy = chosen && self.scene.place(varied) == "run.accuracy";
                accuracy || self.scene.encloses(varied, path)
            };
            let mut varied = self.dimensions.iter().map(|dimension| &dimension.path);
            if let Some(varied) = varied.find(|varied| replaces(varied)) {
                return Err(SweepError::Given {
                    path: varied.clone(),
                    given: name.clone(),
                });
            }
        }
        Ok(())
    }

    /// The scene that is varied.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Whether the values are combined, or are the columns of a table.
    pub fn arrangement(&self) -> Arrangement {
        self.arrangement
    }

    /// Names of the dimensions that results have for the variants.
    pub fn dims(&self) -> Vec<&str> {
        match self.arrangement {
            Arrangement::Grid => self.dimensions.iter().map(|it| it.name.as_str()).collect(),
            Arrangement::Table => vec![VARIANT],
        }
    }

    /// Variants along each of them.
    pub fn shape(&self) -> Vec<usize> {
        match self.arrangement {
            Arrangement::Grid => self.dimensions.iter().map(|it| it.settings.len()).collect(),
            Arrangement::Table => vec![self.len],
        }
    }

    /// The varied values: dimensions of a grid, columns of a table.
    pub fn dimensions(&self) -> &[Dimension] {
        &self.dimensions
    }

    /// Names of the channels that are kept.
    pub fn record(&self) -> &[String] {
        &self.record
    }

    /// Number of variants.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there is no variant; always false.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The scene of a variant.
    ///
    /// # Errors
    /// Values that do not go together.
    pub fn variant(&self, index: usize) -> Result<Scene, SceneError> {
        let dimensions = self.dimensions.iter().zip(self.indices(index));
        let edits = dimensions.map(|(it, at)| it.settings[at].edit(&self.scene, &it.path));
        self.scene.put(&edits.collect::<Result<Vec<_>, _>>()?)
    }

    /// A variant in words: `speed = 300 rad/s, pretension = 10000 N`; numbers have five digits.
    pub fn label(&self, index: usize) -> String {
        let dimensions = self.dimensions.iter().zip(self.indices(index));
        let parts = dimensions.map(|(it, at)| {
            let unit = it.unit.filter(|unit| *unit != "1");
            let unit = unit.map_or_else(String::new, |unit| format!(" {unit}"));
            format!("{} = {}{unit}", it.name, it.values.short(at))
        });
        parts.collect::<Vec<_>>().join(", ")
    }

    /// Place of a variant in the values of each path.
    pub fn indices(&self, index: usize) -> Vec<usize> {
        match self.arrangement {
            Arrangement::Grid => places(index, &self.shape()),
            Arrangement::Table => vec![index; self.dimensions.len()],
        }
    }

    fn blocks(&self) -> &SweepBlocks {
        self.blocks.get_or_init(|| SweepBlocks::of(self))
    }

    /// Runs one variant on the calling thread, until it ends or `stop` is set.
    pub fn carry_out(&self, index: usize, stop: &AtomicBool) -> Outcome {
        // In memory nothing refuses.
        let answer = Worker::alone(self).carry_out(index, stop).ok().flatten();
        let outcome = answer.and_then(|answer| answer.outcomes.into_iter().next());
        outcome.map_or(Outcome::Open, |(_, outcome)| outcome)
    }

    /// The same by a choice.
    fn carry_out_by(&self, shared: &SharedChoice, index: usize, stop: &AtomicBool) -> Outcome {
        account::outcome(|| {
            let scene = self.variant(index).map_err(|error| error.to_string())?;
            let request =
                account::request(&scene, &self.record).map_err(|error| error.to_string())?;
            Account::attempt(&request, shared.as_deref(), stop)
        })
    }

    /// Runs all variants on `jobs` threads, as many as there are cores if absent, and returns their
    /// outcomes in the order of the variants.
    ///
    /// `watch` is called on the calling thread whenever a variant has ended, and every 50 ms.
    ///
    /// # Errors
    /// [`SweepError::Threads`] when the system refuses threads. Variants that fail are outcomes.
    pub fn run(
        &self,
        jobs: Option<usize>,
        mut watch: impl FnMut(Progress<'_>) -> Go,
    ) -> Result<Vec<Outcome>, SweepError> {
        let mut memory = SweepMemory::new(self, 1);
        memory.run(jobs, &mut watch)?;
        Ok(memory.into_outcomes())
    }
}

/// Place along each dimension of an entry of an array; the last dimension varies fastest.
pub(crate) fn places(index: usize, shape: &[usize]) -> Vec<usize> {
    let mut left = index;
    let mut places = vec![0; shape.len()];
    for (place, &size) in places.iter_mut().zip(shape).rev() {
        *place = left % size;
        left /= size;
    }
    places
}
