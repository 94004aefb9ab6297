//! A run-in that ends by itself, when the motion is steady.
//!
//! The drive is moved block by block, each a whole number of periods of its [slowest forcing](Assembled::slowest_forcing) and two and a half teeth at least, and
//! its state at the end of each is kept. After every block all that may be the beginning of the steady state are tried, the earliest first: from
//! there on
//!
//! ```text
//! n − d ≥ d,  20 teeth,  three periods,  8 blocks,  three times c/k of every tensioner,  the record     (schedule)
//! |Δ| ≤ max(chance, ½ %)               mean of the tension of every span; its standard deviation σ: 2 % of σ     (criterion)
//! |Δ| + chance ≤ max(½ %, 2 % · N/100)   over N teeth; of σ: 2 %, 20 % · N/100
//! |T_∞ − T|, |∂T/∂s (s_∞ − s)| ≤ ½ %,   s_∞ − s = (C − B) r/(1 − r),   r = (C − B)/(B − A);   |σ_∞ − σ| ≤ 2 % of σ
//! ```
//!
//! Δ is the change from one half of the blocks to the other along their straight line, and chance what the scatter about that line makes of
//! it. Chance excuses no more than what the second line allows: twenty teeth of a motion that is not regular say nothing, however little they
//! drift. The more teeth are examined, the more is excused, as a chaotic motion never says more. States that creep are the places of tensioners and the speeds of shafts: A, B, C are their means over thirds, which die out like an
//! exponential, and the slope is that of tension over state in all blocks so far. Per cent are of the span's own mean, or of a tenth of the tight
//! span's.

mod criterion;
mod record_buffer;
mod run_up;
mod schedule;
mod sums;

use chaindrive_mechanics::{Assembled, Observation, Sights};

use self::criterion::BlockSeries;
use self::record_buffer::RecordBuffer;
use self::schedule::{Schedule, earliest};
use self::sums::add;
use super::{Onlooker, RecordStart};
use crate::{Run, SimulationError};

pub(super) use self::schedule::{bounds, stands};

/// Moves a drive until it is steady; one that stands, for torques to turn, first runs up.
///
/// What was simulated becomes the record: it begins at the first state from the steady one on from which the drive has not been moved for longer than the
/// record is to last. Its samples have these sights.
pub(super) fn steady_start(
    start: &Assembled,
    run: &Run,
    sights: Sights,
    onlooker: &dyn Onlooker,
) -> Result<RecordStart, SimulationError> {
    if stands(start) {
        let moving = run_up::run_up(start, run, onlooker)?;
        return steady_start(&moving, run, sights, onlooker);
    }
    let schedule = Schedule::of(start, run)?;
    let stop = || onlooker.stop();
    let mut series = BlockSeries::default();
    let mut record = RecordBuffer::new(start, run, sights, &stop)?;
    loop {
        // One more block: tensions and creeping states are summed over looks at equal intervals.
        let begin = start.time + series.count as f64 * schedule.block;
        let (mut spans, mut states) = (Vec::new(), Vec::new());
        for look in 1..=schedule.looks {
            let time = begin + look as f64 / schedule.looks as f64 * schedule.block;
            let seen = match record.look(time) {
                Ok(seen) => seen,
                Err(SimulationError::Interrupted) => return Err(SimulationError::Interrupted),
                Err(failure) => return record.failed(failure),
            };
            add(&mut spans, seen.span_tension.iter().copied());
            add(&mut states, creeping(seen));
            onlooker.see_run_in(((time - start.time) / schedule.longest).min(1.0));
            if stop() {
                return Err(SimulationError::Interrupted);
            }
        }
        series.push(&spans, &states);
        record.end_block();
        // Blocks from d on are tried as the steady motion, where they are enough, and no fewer than those before.
        let n = series.count;
        let earliest = earliest(n);
        record.thin_out(earliest);
        let mut tried = (earliest..n).take_while(|d| n - d >= schedule.least.max(*d));
        let teeth_from = |d: usize| (n - d) as f64 * schedule.block / schedule.tooth;
        let steady =
            tried.find(|d| record.can_begin(*d) && series.is_steady_from(*d, teeth_from(*d)));
        if steady.is_some() || (n + 1) as f64 * schedule.block > schedule.longest {
            return record.begin_from(steady.unwrap_or(earliest), steady.is_some());
        }
    }
}

/// States that may creep: places of tensioners and speeds of sprockets.
fn creeping(seen: &Observation) -> impl Iterator<Item = f64> {
    let tensioners = seen.tensioner_position.iter();
    tensioners.chain(&seen.sprocket_speed).copied()
}

fn refused(why: &str) -> SimulationError {
    SimulationError::RunIn {
        reason: format!("auto: {why}"),
    }
}

/// A number, rounded up.
fn counted(number: f64) -> usize {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "some thousands at most"
    )]
    let count = number.ceil() as usize;
    count
}
