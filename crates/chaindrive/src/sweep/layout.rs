//! Layout of a sweep's arrays: what they have beside the variants, and how they are cut into tasks.
//!
//! In memory it is made of all outcomes at once. In a store it is a file that only grows. A worker whose variant has more samples, labels or quantities than any
//! before makes room for them under a lock, and what others have written stays where it is.

use serde::{Deserialize, Serialize};

use super::{Account, Coordinate, Outcome, ResultQuantity, Statistic, Sweep, places};
use crate::Axis;

/// Numbers in a chunk at most, about 1 MiB, unless a single sample of a single variant has more.
const NUMBERS_PER_CHUNK: usize = 1 << 17;

/// Contents of the file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Layout {
    /// Variants along each dimension of the sweep.
    pub(super) shape: Vec<usize>,
    /// Variants in a chunk along each: a chunk of every array is the task of one worker.
    pub(super) cuts: Vec<usize>,
    /// Samples of the longest run, as far as one knew at the beginning.
    pub(super) most_samples: usize,
    /// Samples in a chunk; 0 before there is a channel.
    pub(super) samples: usize,
    /// Sample times of the longest run so far \[s\].
    pub(super) time: Vec<f64>,
    /// Dimensions beside those of the sweep and time.
    pub(super) axes: Vec<LabelledAxis>,
    /// Names of the quantities, with their units.
    pub(super) quantities: Vec<(String, Vec<String>)>,
    /// Methods of time stepping that were used.
    pub(super) methods: Vec<String>,
}

/// A dimension with names or numbers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct LabelledAxis {
    pub(super) name: String,
    /// Entries in a chunk.
    pub(super) cut: usize,
    pub(super) labels: Vec<String>,
}

/// A dimension that a quantity has beside those of the sweep.
pub(super) struct ExtraDimension {
    pub(super) name: &'static str,
    /// Entries.
    pub(super) len: usize,
    /// Entries in a chunk.
    pub(super) cut: usize,
}

/// One chunk of every array: the variants in it, and where they are.
pub(super) struct Region {
    /// Place of the chunk along each dimension of the sweep.
    pub(super) place: Vec<u64>,
    /// Variants with their places within the chunk.
    pub(super) variants: Vec<(usize, usize)>,
}

impl Region {
    /// The variants, in their order.
    pub(super) fn variants(&self) -> impl Iterator<Item = usize> {
        self.variants.iter().map(|&(variant, _)| variant)
    }
}

impl LabelledAxis {
    /// Its labels, or numbers where they are numbered.
    pub(super) fn coordinate(&self) -> Coordinate {
        let mut known = Axis::ALL.iter();
        if known.any(|it| it.name() == Some(&self.name) && it.is_numbered()) {
            Coordinate::Whole((0..).take(self.labels.len()).collect())
        } else {
            Coordinate::Texts(self.labels.clone())
        }
    }
}

impl Layout {
    /// A layout without any account: what every run has.
    fn bare(sweep: &Sweep) -> Self {
        let shape = sweep.shape();
        Self {
            cuts: vec![1; shape.len()],
            shape,
            most_samples: sweep.most_samples(),
            quantities: Statistic::of_every_run()
                .map(|it| (it.name().to_owned(), vec![it.unit().to_owned()]))
                .collect(),
            ..Self::default()
        }
    }

    /// The layout of arrays that hold these outcomes, each in one chunk.
    pub(super) fn whole(sweep: &Sweep, outcomes: &[Outcome]) -> Self {
        let mut layout = Self::bare(sweep);
        layout.make_room_for(outcomes);
        layout.cuts.clone_from(&layout.shape);
        layout.samples = layout.time.len();
        for axis in &mut layout.axes {
            axis.cut = axis.labels.len();
        }
        layout
    }

    /// A layout for tasks of about so many variants, with room for one account, if there is one.
    pub(super) fn new(sweep: &Sweep, variants: usize, sample: Option<&Account>) -> Self {
        let mut layout = Self::bare(sweep);
        if let Some(account) = sample {
            layout.make_room(account);
        }
        let widest = layout.quantities.iter().map(|(name, _)| layout.width(name));
        let most = NUMBERS_PER_CHUNK / widest.fold(1, usize::max);
        let mut left = variants.clamp(1, most.max(1));
        // The last dimension varies fastest.
        for (cut, &size) in layout.cuts.iter_mut().zip(&layout.shape).rev() {
            // As even as whole numbers allow: 3 and 2 rather than 4 and 1.
            *cut = size.div_ceil(size.div_ceil(left));
            left = if *cut < size { 1 } else { left / *cut };
        }
        layout
    }

    /// Numbers of one variant in a chunk.
    fn width(&self, name: &str) -> usize {
        let Some(quantity) = ResultQuantity::from_name(name) else {
            return 1;
        };
        self.beside(quantity).iter().map(|it| it.cut).product()
    }

    /// The dimensions of a quantity beside those of the sweep.
    pub(super) fn beside(&self, quantity: ResultQuantity) -> Vec<ExtraDimension> {
        let time = quantity.is_sampled().then_some(ExtraDimension {
            name: "time",
            len: self.time.len(),
            cut: self.samples,
        });
        let labels = quantity.along().map(|name| {
            let axis = self.axis(quantity);
            ExtraDimension {
                name,
                len: axis.map_or(0, |axis| axis.labels.len()),
                cut: axis.map_or(1, |axis| axis.cut),
            }
        });
        time.into_iter().chain(labels).collect()
    }

    /// The axis of a quantity beside time.
    pub(super) fn axis(&self, quantity: ResultQuantity) -> Option<&LabelledAxis> {
        let along = quantity.along()?;
        self.axes.iter().find(|axis| axis.name == along)
    }

    /// Makes room for all that outcomes have; tells whether there was too little.
    pub(super) fn make_room_for(&mut self, outcomes: &[Outcome]) -> bool {
        let mut grown = false;
        for outcome in outcomes {
            if let Outcome::Done(account) = outcome {
                grown |= self.make_room(account);
            }
        }
        grown
    }

    /// Makes room for what an account has; tells whether there was too little.
    fn make_room(&mut self, account: &Account) -> bool {
        let mut grown = false;
        if account.time.len() > self.time.len() {
            self.time.clone_from(&account.time);
            grown = true;
        }
        for (name, labels) in &account.labels {
            let known = self.axes.iter().position(|axis| axis.name == *name);
            let index = known.unwrap_or_else(|| {
                self.axes.push(LabelledAxis {
                    name: name.clone(),
                    cut: labels.len().max(1),
                    labels: Vec::new(),
                });
                grown = true;
                self.axes.len() - 1
            });
            let axis = &mut self.axes[index];
            if axis.labels.starts_with(labels) {
                continue;
            }
            if axis.labels.is_empty() {
                // Nothing has been cut so far.
                axis.cut = labels.len();
            }
            for label in labels {
                if !axis.labels.contains(label) {
                    axis.labels.push(label.clone());
                    grown = true;
                }
            }
        }
        for entry in &account.entries {
            let name = entry.quantity.name();
            let known = self.quantities.iter().position(|(known, _)| known == name);
            let index = known.unwrap_or_else(|| {
                self.quantities.push((name.to_owned(), Vec::new()));
                grown = true;
                self.quantities.len() - 1
            });
            let units = &mut self.quantities[index].1;
            if !units.contains(&entry.unit) {
                units.push(entry.unit.clone());
                grown = true;
            }
        }
        if !account.method.is_empty() && !self.methods.contains(&account.method) {
            self.methods.push(account.method.clone());
            grown = true;
        }
        if self.samples == 0 && !account.time.is_empty() {
            self.samples = self.samples_per_chunk(account.time.len());
        }
        grown
    }

    /// As many samples as the widest channel allows; all arrays are cut at the same times, as `dask` wants it.
    fn samples_per_chunk(&self, samples: usize) -> usize {
        let channels = self.quantities.iter();
        let channels = channels.filter_map(|(name, _)| ResultQuantity::from_name(name));
        let channels = channels.filter(|it| it.is_sampled());
        let widths = channels.map(|it| self.axis(it).map_or(1, |axis| axis.cut));
        let widest = widths.fold(1, usize::max);
        (NUMBERS_PER_CHUNK / widest).clamp(1, self.most_samples.max(samples))
    }

    /// Chunks along each dimension of the sweep.
    fn counts(&self) -> Vec<usize> {
        let cuts = self.cuts.iter();
        let sizes = self.shape.iter().zip(cuts);
        sizes.map(|(size, cut)| size.div_ceil(*cut)).collect()
    }

    /// Number of tasks.
    pub(super) fn tasks(&self) -> usize {
        self.counts().iter().product()
    }

    /// Variants in a chunk, those beyond the edge of the arrays included.
    pub(super) fn block(&self) -> usize {
        self.cuts.iter().product()
    }

    /// The region of a task.
    pub(super) fn region(&self, task: usize) -> Region {
        let place = places(task, &self.counts());
        let variant = |local: usize| {
            let mut variant = 0;
            let within = places(local, &self.cuts);
            let along = place.iter().zip(&within).zip(&self.cuts).zip(&self.shape);
            for (((chunk, within), cut), size) in along {
                let at = chunk * cut + within;
                if at >= *size {
                    return None;
                }
                variant = variant * size + at;
            }
            Some((variant, local))
        };
        Region {
            variants: (0..self.block()).filter_map(variant).collect(),
            place: place.iter().map(|&chunk| chunk as u64).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Layout;

    /// Every variant belongs to one task and to one place in its chunk, whatever the cuts.
    #[test]
    fn regions_are_aligned_and_share_no_variant() {
        for (shape, cuts) in [
            (vec![7], vec![3]),
            (vec![5, 4], vec![1, 3]),
            (vec![5, 4], vec![2, 4]),
            (vec![2, 3, 5], vec![1, 2, 5]),
        ] {
            let layout = Layout {
                shape,
                cuts,
                ..Layout::default()
            };
            let all: usize = layout.shape.iter().product();
            let mut tasks = vec![0; all];
            for task in 0..layout.tasks() {
                let region = layout.region(task);
                assert!(!region.variants.is_empty());
                for (variant, local) in region.variants {
                    tasks[variant] += 1;
                    assert!(local < layout.block());
                }
            }
            assert_eq!(tasks, vec![1; all]);
        }
    }
}
