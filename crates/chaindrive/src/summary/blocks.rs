//! Samples of a quantity over time, in blocks of whole periods, in bounded memory.
//!
//! A record of a motion that repeats is a whole number of its periods and a rest. Statistics over the rest would be those of a part of a
//! period: a mean over m + ½ periods of amplitude A errs by A/(π m), where the mean over m periods does not err at all. So samples go into
//! blocks of whole periods, and what fills none is left out once there are three. When there are many blocks, neighbours are joined.
//!
//! What repeats in another time than the slowest is no whole number of periods in a block. Where all of it [together](Blocks::together) repeats in some
//! blocks, those are one, if there are three such. Where it does not, its [waves](super::waves) are told from the mean.
//!
//! A value stands for some time. Where a block ends within, both get their share.

use serde::{Deserialize, Serialize};

use super::waves::{WaveFit, WaveSums, Waves};

/// Blocks at which neighbours are joined.
pub(super) const MOST: usize = 24;
/// Blocks below which nothing is said of how well statistics are known.
pub(super) const LEAST: usize = 3;
/// Samples below which a block is not a period but several.
const SAMPLES: f64 = 4.0;
/// Bins of the values that occur: half of them at least are in use.
const BINS: usize = 256;

/// Samples of one quantity, in blocks of equal length.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Blocks {
    /// Time between two values, about, and length of a block \[s\].
    every: f64,
    length: f64,
    full: Vec<Block>,
    open: Block,
    /// Number of blocks closed, those included that were joined since, at the present length.
    closed: u64,
    /// Blocks in which all that is known repeats; 1 where they have been joined.
    together: usize,
    /// Blocks at which neighbours are joined.
    most: usize,
    /// Periods of what does not repeat in a block \[s\].
    forcings: Vec<f64>,
    /// Origin of the sums: the first value. Squares of small differences keep their digits.
    origin: Option<f64>,
    grid: Grid,
}

/// Sums over the samples of one block, each weighted by the time \[s\] that it stands for there.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Block {
    pub(super) time: f64,
    sum: f64,
    squares: f64,
    waves: WaveSums,
    /// Time in every bin of the grid.
    bins: Vec<f32>,
}

/// Equal bins from a multiple of their width on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Grid {
    width: f64,
    first: f64,
}

/// Statistics of the samples of some blocks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Moments {
    /// Mean, standard deviation, and the values below which 1 % and 99 % of the time are.
    pub(super) values: [f64; 4],
    /// By how much the latter two differ from those of one sample more or less.
    pub(super) grain: [f64; 2],
}

impl Blocks {
    /// Empty statistics for samples at an interval \[s\]; `period` \[s\] of the slowest forcing, infinite where nothing repeats, and the number of
    /// them in which everything repeats together; the periods of `forcings` \[s\] whose waves are to be told from the mean.
    pub(crate) fn new(every: f64, period: f64, together: usize, forcings: &[f64]) -> Self {
        let periods = (SAMPLES * every / period).ceil().max(1.0);
        // Blocks of several periods are of all that repeats in them.
        let together = if periods > 1.0 { 1 } else { together.max(1) };
        Self {
            together,
            // Of an even number of blocks pairs can be made, time and again.
            most: together * MOST.div_ceil(together).max(LEAST).next_multiple_of(2),
            forcings: forcings.to_vec(),
            every,
            length: periods * period,
            full: Vec::new(),
            open: Block::default(),
            closed: 0,
            origin: None,
            grid: Grid::default(),
        }
    }

    /// Takes in a value that stands for a time \[s\], counted from the first, with cosine and sine of every forcing then.
    pub(crate) fn push(&mut self, [mut from, to]: [f64; 2], value: f64, harmonics: &[f64]) {
        let origin = *self.origin.get_or_insert(value);
        let value = value - origin;
        while let Some(joined) = self.grid.without_room(value) {
            let blocks = self.full.iter_mut().chain([&mut self.open]);
            blocks.for_each(|block| block.rebin(&self.grid, &joined));
            self.grid = joined;
        }
        loop {
            let edge = (self.closed + 1) as f64 * self.length;
            let until = to.min(edge);
            let time = (until - from).max(0.0);
            self.open.push(&self.grid, value, time);
            self.open.waves.push(value, time, harmonics);
            if to < edge {
                return;
            }
            from = edge;
            self.full.push(std::mem::take(&mut self.open));
            self.closed += 1;
            if self.full.len() == self.most {
                self.join();
            }
        }
    }

    /// Joins neighbours: those that repeat together, and then pairs.
    fn join(&mut self) {
        let count = if self.together > 1 { self.together } else { 2 };
        self.full = self.full.chunks_exact(count).map(sum).collect();
        self.length *= count as f64;
        self.closed /= count as u64;
        self.together = 1;
    }

    /// Blocks of whole periods that have samples, where that is possible of all that repeats; too few of them where most of the time has none. With
    /// their length \[s\].
    pub(super) fn whole(&self) -> (Vec<Block>, f64) {
        let count = if self.full.len() >= LEAST * self.together {
            self.together
        } else {
            1
        };
        let length = count as f64 * self.length;
        let joined = self.full.chunks_exact(count).map(sum);
        let held = joined.filter(|block| block.time > 0.5 * length);
        (held.collect(), length)
    }

    /// Statistics of whole periods where there are some, else of all samples; none without one.
    pub(super) fn statistics(&self) -> Option<Moments> {
        let (whole, _) = self.whole();
        if whole.len() >= LEAST {
            let all = sum(&whole);
            return self.moments(&all, &self.told(&all));
        }
        let mut all = self.full.clone();
        all.push(self.open.clone());
        self.moments(&sum(&all), &WaveFit::none())
    }

    /// Which waves some blocks tell from their mean.
    pub(super) fn told(&self, block: &Block) -> WaveFit {
        WaveFit::of(&block.waves, block.time, &self.forcings)
    }

    /// Their mean; NaN without a sample.
    pub(crate) fn mean(&self) -> f64 {
        self.statistics().map_or(f64::NAN, |it| it.values[0])
    }

    /// Greatest less least value in a block, or a sum of some, to a bin.
    pub(super) fn range(&self, block: &Block) -> f64 {
        self.grid.quantile(block, 1.0) - self.grid.quantile(block, 0.0)
    }

    /// Statistics of a block, or a sum of some, with these waves told from the mean; none without a sample.
    ///
    /// ```text
    /// x = μ + Σ aₖ hₖ + r,   σ² = ⟨r²⟩ + ½ Σ aₖ²     hₖ: cosines and sines of the forcings
    /// ```
    pub(super) fn moments(&self, block: &Block, told: &WaveFit) -> Option<Moments> {
        let origin = self.origin?;
        if block.time <= 0.0 {
            return None;
        }
        let mean = block.sum / block.time;
        let waves = block.waves(told);
        // ⟨x²⟩ − x̄² with what the waves have in whole periods, instead of what they have here.
        let variance = block.squares / block.time - mean * mean - waves.explained + waves.power;
        let share = self.every / block.time;
        let at = |share: f64| self.grid.quantile(block, share);
        let grain = |p: f64| {
            let here = at(p);
            (at(p + share) - here).max(here - at(p - share))
        };
        Some(Moments {
            values: [
                origin + mean - waves.shift,
                variance.max(0.0).sqrt(),
                origin + at(0.01),
                origin + at(0.99),
            ],
            grain: [grain(0.01), grain(0.99)],
        })
    }
}

/// All blocks as one.
pub(super) fn sum(blocks: &[Block]) -> Block {
    let none = Block::default();
    blocks.iter().fold(none, |sum, block| sum.with(block))
}

impl Block {
    fn push(&mut self, grid: &Grid, value: f64, time: f64) {
        self.time += time;
        self.sum += time * value;
        self.squares += time * value * value;
        if self.bins.is_empty() {
            self.bins.resize(BINS, 0.0);
        }
        #[expect(clippy::cast_possible_truncation, reason = "a share of a time")]
        let time = time as f32;
        self.bins[grid.bin(value)] += time;
    }

    fn with(&self, other: &Self) -> Self {
        self.combined(other, 1.0)
    }

    /// Waves that are told from its mean.
    pub(super) fn waves(&self, told: &WaveFit) -> Waves {
        told.fit(&self.waves, self.time, self.sum / self.time)
    }

    /// Mean without some waves, from the origin of the sums on.
    pub(super) fn mean_without(&self, waves: &Waves) -> f64 {
        self.sum / self.time - self.waves.mean_of(&waves.amplitudes, self.time)
    }

    /// A sum of blocks without one of them.
    pub(super) fn without(&self, other: &Self) -> Self {
        self.combined(other, -1.0)
    }

    fn combined(&self, other: &Self, sign: f64) -> Self {
        #[expect(clippy::cast_possible_truncation, reason = "a sign")]
        let of_bins = sign as f32;
        let bins = match (self.bins.is_empty(), other.bins.is_empty()) {
            (true, _) => other.bins.clone(),
            (_, true) => self.bins.clone(),
            _ => {
                let pairs = self.bins.iter().zip(&other.bins);
                pairs.map(|(a, b)| (a + of_bins * b).max(0.0)).collect()
            }
        };
        Self {
            time: self.time + sign * other.time,
            sum: self.sum + sign * other.sum,
            squares: self.squares + sign * other.squares,
            waves: self.waves.combined(&other.waves, sign),
            bins,
        }
    }

    /// Moves what is counted from one grid to one that is twice as wide.
    fn rebin(&mut self, from: &Grid, to: &Grid) {
        if self.bins.is_empty() {
            return;
        }
        let mut bins = vec![0.0; BINS];
        for (bin, time) in self.bins.iter().enumerate() {
            if *time > 0.0 {
                bins[to.bin(from.middle(bin))] += time;
            }
        }
        self.bins = bins;
    }
}

impl Grid {
    /// The next wider grid, where a value has no bin.
    fn without_room(&self, value: f64) -> Option<Self> {
        if self.width == 0.0 {
            // The first value is the origin, the second one tells the scale.
            let width = if value == 0.0 {
                f64::MIN_POSITIVE
            } else {
                (value.abs() / BINS as f64).log2().ceil().exp2()
            };
            return Some(Self {
                width,
                first: -(BINS as f64 / 2.0),
            });
        }
        let place = (value / self.width).floor() - self.first;
        if (0.0..BINS as f64).contains(&place) {
            return None;
        }
        // Pairs of bins become one; the room that is gained lies on the side of the value.
        let first = (self.first / 2.0).floor();
        let half = BINS as f64 / 2.0;
        Some(Self {
            width: 2.0 * self.width,
            first: if value < 0.0 {
                first - half + 1.0
            } else {
                first
            },
        })
    }

    fn bin(&self, value: f64) -> usize {
        let place = (value / self.width).floor() - self.first;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "the number of a bin"
        )]
        let bin = place.clamp(0.0, BINS as f64 - 1.0) as usize;
        bin
    }

    fn middle(&self, bin: usize) -> f64 {
        (self.first + bin as f64 + 0.5) * self.width
    }

    /// The value below which a share of the time is, on a straight line within its bin.
    fn quantile(&self, block: &Block, share: f64) -> f64 {
        let wanted =
            share.clamp(0.0, 1.0) * block.bins.iter().map(|it| f64::from(*it)).sum::<f64>();
        let mut below = 0.0;
        let mut last = 0.0;
        for (bin, time) in block.bins.iter().enumerate() {
            let time = f64::from(*time);
            if time <= 0.0 {
                continue;
            }
            let lower = self.middle(bin) - 0.5 * self.width;
            if below + time >= wanted {
                return lower + (wanted - below) / time * self.width;
            }
            below += time;
            last = lower + self.width;
        }
        last
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    /// The time that a sample stands for.
    fn around(time: f64, every: f64) -> [f64; 2] {
        [(time - 0.5 * every).max(0.0), time + 0.5 * every]
    }

    fn wave(periods: f64, samples: u32) -> Blocks {
        let every = periods / f64::from(samples);
        let mut blocks = Blocks::new(every, 1.0, 1, &[]);
        for i in 0..=samples {
            let time = f64::from(i) * every;
            blocks.push(
                around(time, every),
                100.0 + 10.0 * (TAU * time + 0.4).sin(),
                &[],
            );
        }
        blocks
    }

    /// A sine of amplitude 10 about 100: σ = 10/√2, quantiles 100 ∓ 10 cos(π/100). Its rest of a period counts for nothing.
    #[test]
    fn statistics_are_those_of_whole_periods() {
        for (periods, samples) in [(4.37, 187), (11.5, 801), (90.49, 6000)] {
            let found = wave(periods, samples).statistics().unwrap();
            let tail = 10.0 * (TAU / 200.0).cos();
            let expected = [100.0, 10.0 / 2_f64.sqrt(), 100.0 - tail, 100.0 + tail];
            for (k, (found, expected)) in found.values.iter().zip(expected).enumerate() {
                let apart = (found - expected).abs();
                assert!(apart < 0.06, "{periods} periods, {k}: {found}, {expected}");
            }
            assert!((found.values[0] - 100.0).abs() < 3e-3, "{found:?}");
        }
    }

    #[test]
    fn memory_is_bounded_and_blocks_stay_whole_periods() {
        let blocks = wave(1000.3, 30_000);
        assert!(blocks.full.len() < MOST && blocks.full.len() >= MOST / 2);
        assert!((blocks.length.log2() - blocks.length.log2().round()).abs() < 1e-12);
        let time: f64 = blocks.full.iter().map(|block| block.time).sum();
        let length = blocks.length * blocks.full.len() as f64;
        assert!((time - length).abs() < 1e-9 * length, "{time}, {length}");
    }

    #[test]
    fn values_of_any_size_and_sign_find_a_bin() {
        for values in [
            vec![0.0, 0.0, 1e-3, -1e9, 5.0],
            vec![-3e4, -3e4, -2.9e4, -3.2e4],
            vec![1e-200, 2e-200, 3.0],
            vec![7.0; 9],
        ] {
            let mut blocks = Blocks::new(1.0, f64::INFINITY, 1, &[]);
            for (i, value) in values.iter().enumerate() {
                blocks.push(around(i as f64, 1.0), *value, &[]);
            }
            let [mean, _, p1, p99] = blocks.statistics().unwrap().values;
            let least = values.iter().copied().fold(f64::INFINITY, f64::min);
            let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let bin = (most - least) / 64.0;
            assert!(least <= mean && mean <= most, "{values:?}: {mean}");
            assert!(
                p1 >= least - bin && p99 <= most + bin,
                "{values:?}: {p1}, {p99}"
            );
        }
    }

    #[test]
    fn nothing_is_said_of_nothing() {
        assert!(Blocks::new(1.0, 2.0, 1, &[]).statistics().is_none());
    }
}
