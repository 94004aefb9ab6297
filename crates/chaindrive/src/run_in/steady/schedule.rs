//! Blocks of a run-in, and how many of them it takes at least and at most.

use chaindrive_mechanics::Assembled;

use super::{counted, refused};
use crate::run_in::MOST_CIRCUITS;
use crate::{Run, SimulationError};

/// Teeth that have to be steady at least, *assumed*.
const TEETH: f64 = 20.0;
/// Blocks that have to be steady at least: chance is judged by their scatter about a line.
const FEWEST: usize = 8;
/// Teeth of a block at least: the fewest blocks have the fewest teeth.
const BLOCK: f64 = TEETH / FEWEST as f64;
/// Looks a tooth, *assumed*: enough for the standard deviation of what teeth do.
const LOOKS: f64 = 16.0;
/// Periods of the forcing that have to be steady at least, as for an interval, and times c/k of tensioners, after which a twentieth, e⁻³, is left
/// of what dies out.
const PERIODS: f64 = 3.0;
/// Share of the longest run-in up to which all of the record is examined: the rest is for the time before it.
const RECORD: f64 = 0.25;
/// Beginnings in the first of so many parts of the blocks so far are tried no more: they were while the rest grew from as long as the time
/// before them to three times that.
const EARLIEST: usize = 4;

/// Blocks of a run-in.
pub(super) struct Schedule {
    /// Period of the slowest tooth \[s\].
    pub(super) tooth: f64,
    /// Length of a block \[s\], and looks in it.
    pub(super) block: f64,
    pub(super) looks: usize,
    /// Time after which it gives up \[s\].
    pub(super) longest: f64,
    /// Blocks that have to be steady at least.
    pub(super) least: usize,
}

impl Schedule {
    /// # Errors
    /// No chain runs around sprockets, something acts at times of the record, or what repeats stands still.
    pub(super) fn of(start: &Assembled, run: &Run) -> Result<Self, SimulationError> {
        let circuit = start.slowest_circuit();
        if !circuit.is_finite() {
            return Err(refused(
                "no chain runs around sprockets here, so nothing says when to stop: give a time",
            ));
        }
        if let Some(what) = start.function_of_time() {
            return Err(refused(&format!(
                "there is {what}, whose times are those of the record: give a time"
            )));
        }
        let (tooth, period) = (start.slowest_tooth(), start.slowest_forcing());
        if !period.is_finite() {
            return Err(refused(
                "a shaft whose turns something follows stands still: give a time",
            ));
        }
        let block = period * (BLOCK * tooth / period).ceil();
        let longest = f64::from(MOST_CIRCUITS) * circuit;
        let pushes = start.drive.tensioners.iter().map(|it| it.push.relaxation());
        let slowest = pushes.fold(0.0, f64::max);
        // What becomes the record has to be steady throughout.
        let record = run.until.min(RECORD * longest);
        let least = (TEETH * tooth)
            .max(PERIODS * period.max(slowest))
            .max(record);
        Ok(Self {
            tooth,
            block,
            looks: counted(LOOKS * block / tooth),
            longest,
            least: counted(least / block).max(FEWEST),
        })
    }

    /// Blocks after which the first beginning may be found steady.
    fn fewest(&self) -> usize {
        fewest(self.least)
    }
}

/// The fewest blocks n that leave so many, at least one, from the [earliest](earliest) beginning on: n − ⌊n/4⌋ ≥ least.
fn fewest(least: usize) -> usize {
    // A soft and thick dashpot asks for 10²⁰ blocks.
    least.saturating_add((least - 1) / (EARLIEST - 1))
}

/// The first block from which a motion of some blocks may still be found steady.
pub(super) fn earliest(blocks: usize) -> usize {
    blocks / EARLIEST
}

/// Times \[s\] that a run-in by itself simulates at least, where all is steady from the start, and at most; what becomes the record included.
///
/// # Errors
/// As a run-in by itself.
pub(in crate::run_in) fn bounds(start: &Assembled, run: &Run) -> Result<[f64; 2], SimulationError> {
    let schedule = Schedule::of(start, run)?;
    let shortest = schedule.fewest() as f64 * schedule.block;
    Ok([shortest.min(schedule.longest), schedule.longest])
}

/// A drive at rest with closed chains, for torques to turn.
pub(in crate::run_in) fn stands(start: &Assembled) -> bool {
    start.slowest_circuit().is_infinite() && start.slowest_tooth() > 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fewest_blocks_are_those_that_a_search_finds() {
        for least in 1..200 {
            let found = (least..2 * least + 2).find(|n| n - earliest(*n) >= least);
            assert_eq!(Some(fewest(least)), found);
        }
        assert_eq!(fewest(usize::MAX), usize::MAX);
    }
}
