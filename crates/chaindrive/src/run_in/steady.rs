//! When the motion is steady: a run-in that ends by itself.
//!
//! The drive is moved block by block, each a whole number of periods of its [slowest forcing](Assembled::slowest_forcing) and two and a half teeth at least, and
//! its state at the end of each is kept. After every block all that may be the beginning of the steady state are tried, the earliest first: from
//! there on
//!
//! ```text
//! n − d ≥ d,  20 teeth,  three periods,  8 blocks,  three times c/k of every tensioner,  the record
//! |Δ| ≤ max(chance, ½ %)               mean of the tension of every span; its standard deviation σ: 2 % of σ
//! |Δ| + chance ≤ max(½ %, 2 % · N/100)   over N teeth; of σ: 2 %, 20 % · N/100
//! |T_∞ − T|, |∂T/∂s (s_∞ − s)| ≤ ½ %,   s_∞ − s = (C − B) r/(1 − r),   r = (C − B)/(B − A);   |σ_∞ − σ| ≤ 2 % of σ
//! ```
//!
//! Δ is the change from one half of the blocks to the other along their straight line, and chance what the scatter about that line makes of
//! it. Chance excuses no more than what the second line allows: twenty teeth of a motion that is not regular say nothing, however little they
//! drift. The more teeth are examined, the more is excused, as a chaotic motion never says more. States that creep are the places of tensioners and the speeds of shafts: A, B, C are their means over thirds, which die out like an
//! exponential, and the slope is that of tension over state in all blocks so far. Per cent are of the span's own mean, or of a tenth of the tight
//! span's.

use std::collections::VecDeque;

use chaindrive_mechanics::{Assembled, EventKinds, Observation};

use super::{MOST_CIRCUITS, Onlooker};
use crate::simulate::Sample;
use crate::summary::drift;
use crate::{Channel, Run, RunIn, Simulation, SimulationError};

/// Teeth of a block at least, looks a tooth, and what has to be steady at least: teeth, and periods of the forcing and times of tensioners.
const BLOCK: f64 = 2.5;
const LOOKS: f64 = 16.0;
const TEETH: f64 = 20.0;
const PERIODS: f64 = 3.0;
/// Share of the longest run-in up to which all of the record is examined.
const RECORD: f64 = 0.25;
/// Blocks that have to be steady at least.
const FEWEST: usize = 8;
/// Beginnings that are kept at most, and a few more.
const MOST_STARTS: usize = 32;
/// Steps of the first stretch of a run-up, and of all of it at most, *assumed*; and looks a stretch.
const RUN_UP: [f64; 2] = [512.0, 2e6];
const RUN_UP_LOOKS: u32 = 64;
/// Share of the scale that may drift, or be left to creep. *Assumed*: half of what a verdict speaks against.
const DRIFT: f64 = 0.005;
/// Share of a standard deviation that may drift, and of the scale from which on it counts. *Assumed*.
const SWINGS: f64 = 0.02;
const LEAST: f64 = 2e-4;
/// Share of the scale, and of a standard deviation, that may be uncertain after so many teeth. *Assumed*, by the coverage of intervals behind
/// run-ins: see `docs/precision.md`.
const UNCERTAIN: [f64; 2] = [0.02, 0.2];
const UNCERTAIN_AFTER: f64 = 100.0;
/// Beginnings in the first quarter of the blocks so far are tried no more.
const EARLIEST: usize = 4;
/// Room \[bytes\] for samples that may become the record; a record that needs more begins later.
const ROOM: usize = 256 << 20;

/// Where the record begins.
pub(super) struct Settled {
    /// The drive there.
    pub(super) start: Assembled,
    /// Whether it is steady; else the longest run-in that is tried is over.
    pub(super) is_steady: bool,
    /// The simulation at its end, behind those samples that it took from there on.
    pub(super) simulation: Simulation,
}

/// Means over the blocks so far, of one quantity.
type Series = Vec<f64>;

/// Sums over a block.
#[derive(Clone, Copy, Default)]
struct Sums {
    count: f64,
    sum: f64,
    squares: f64,
}

impl Sums {
    fn push(&mut self, value: f64) {
        // A span without a tension says nothing.
        if value.is_finite() {
            self.count += 1.0;
            self.sum += value;
            self.squares += value * value;
        }
    }

    fn mean(&self) -> f64 {
        self.sum / self.count
    }

    fn deviation(&self) -> f64 {
        (self.squares / self.count - self.mean().powi(2))
            .max(0.0)
            .sqrt()
    }
}

/// Moves a drive until it is steady; one that stands, for torques to turn, first runs up.
///
/// What was simulated becomes the record: it begins at the first state from the steady one on from which the drive has not been moved for longer than the
/// record is to last.
pub(super) fn settle(
    start: &Assembled,
    run: &Run,
    onlooker: &dyn Onlooker,
) -> Result<Settled, SimulationError> {
    if stands(start) {
        let moving = run_up(start, run, onlooker)?;
        return settle(&moving, run, onlooker);
    }
    let Extent {
        tooth,
        block,
        looks,
        longest,
        least,
    } = Extent::of(start, run)?;
    let mut course = Course::default();
    let stop = || onlooker.stop();
    let mut taken = Taken::new(start, run, &stop)?;
    loop {
        let begun = start.time + course.count as f64 * block;
        let (mut spans, mut states) = (Vec::new(), Vec::new());
        for look in 1..=looks {
            let time = begun + look as f64 / looks as f64 * block;
            let seen = match taken.look(time) {
                Ok(seen) => seen,
                Err(SimulationError::Interrupted) => return Err(SimulationError::Interrupted),
                Err(failure) => return taken.failed(failure),
            };
            note(&mut spans, seen.span_tension.iter().copied());
            note(&mut states, creeping(seen));
            onlooker.see_run_in(((time - start.time) / longest).min(1.0));
            if stop() {
                return Err(SimulationError::Interrupted);
            }
        }
        course.push(&spans, &states);
        let n = course.count;
        taken.starts.push(None);
        // Beginnings in the first quarter have had their turn.
        let earliest = n / EARLIEST;
        taken.forget(earliest);
        let mut candidates = (earliest..n).take_while(|d| n - d >= least.max(*d));
        let is_steady = |d: usize| course.is_steady_from(d, (n - d) as f64 * block / tooth);
        let found = candidates.find(|d| taken.starts[*d].is_some() && is_steady(*d));
        if found.is_some() || (n + 1) as f64 * block > longest {
            return taken.recorded_from(found.unwrap_or(earliest), found.is_some());
        }
    }
}

/// How long a run-in by itself may last.
struct Extent {
    /// Period of the slowest tooth \[s\].
    tooth: f64,
    /// Length of a block \[s\], and looks in it.
    block: f64,
    looks: usize,
    /// Time after which it gives up \[s\].
    longest: f64,
    /// Blocks that have to be steady at least.
    least: usize,
}

impl Extent {
    fn of(start: &Assembled, run: &Run) -> Result<Self, SimulationError> {
        let circuit = circuit(start)?;
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
        let looks = counted(LOOKS * block / tooth);
        let pushes = start.drive.tensioners.iter().map(|it| it.push.relaxation());
        let slowest = pushes.fold(0.0, f64::max);
        let longest = f64::from(MOST_CIRCUITS) * circuit;
        // What becomes the record has to be steady throughout.
        let record = run.until.min(RECORD * longest);
        let least = (TEETH * tooth)
            .max(PERIODS * period.max(slowest))
            .max(record);
        let least = counted(least / block).max(FEWEST);
        Ok(Self {
            tooth,
            block,
            looks,
            longest,
            least,
        })
    }

    /// Blocks after which the first beginning may be found steady: those in the first quarter are not tried.
    fn fewest(&self) -> usize {
        let is_enough = |n: &usize| n - n / EARLIEST >= self.least;
        (self.least..=2 * self.least)
            .find(is_enough)
            .unwrap_or(self.least)
    }
}

/// Times \[s\] that a run-in by itself simulates at least, where all is steady from the start, and at most; what becomes the record included.
///
/// # Errors
/// As a run-in by itself.
pub(super) fn bounds(start: &Assembled, run: &Run) -> Result<[f64; 2], SimulationError> {
    let extent = Extent::of(start, run)?;
    let shortest = extent.fewest() as f64 * extent.block;
    Ok([shortest.min(extent.longest), extent.longest])
}

/// A drive at rest with closed chains, for torques to turn.
pub(super) fn stands(start: &Assembled) -> bool {
    start.slowest_circuit().is_infinite() && start.slowest_tooth() > 0.0
}

/// Moves a drive from rest until torques and what resists them have brought it to its speed: in times that double, until the mean speeds of all sprockets
/// over the last half are those of the quarter before, to the share that may drift.
fn run_up(
    start: &Assembled,
    run: &Run,
    onlooker: &dyn Onlooker,
) -> Result<Assembled, SimulationError> {
    let plain = Run {
        run_in: RunIn::None,
        events: EventKinds::default(),
        ..run.clone()
    };
    let mut moving = Simulation::from_assembled(start.clone(), &plain)?;
    let mut stretch = RUN_UP[0] * moving.method().step();
    let longest = RUN_UP[1] * moving.method().step();
    let stop = || onlooker.stop();
    let mut before = Vec::new();
    while moving.time() < longest {
        let begun = moving.time();
        let mut speeds = Vec::new();
        for look in 1..=RUN_UP_LOOKS {
            let time = begun + f64::from(look) / f64::from(RUN_UP_LOOKS) * stretch;
            note(
                &mut speeds,
                moving.look(time, &stop)?.sprocket_speed.iter().copied(),
            );
            onlooker.see_run_in(time / longest);
            if stop() {
                return Err(SimulationError::Interrupted);
            }
        }
        let speeds: Vec<f64> = speeds.iter().map(Sums::mean).collect();
        let is_same = |(now, before): (&f64, &f64)| (now - before).abs() <= DRIFT * now.abs();
        let come = moving.as_start();
        let has_turned = come.slowest_circuit() <= stretch;
        if has_turned && !before.is_empty() && speeds.iter().zip(&before).all(is_same) {
            return Ok(come);
        }
        before = speeds;
        // As long as all before.
        stretch = moving.time();
    }
    Err(refused(
        "no torque brings this drive to a steady speed: give a time",
    ))
}

/// What has been simulated, as far as it may become the record.
struct Taken<'a> {
    simulation: Simulation,
    run: &'a Run,
    stop: &'a dyn Fn() -> bool,
    /// Time of the first sample \[s\].
    from: f64,
    /// By block: the drive at its beginning, and the number of the sample there. Of many some are enough, and each takes room.
    starts: Vec<Option<(Assembled, usize)>>,
    /// The last samples, and how many were taken before them.
    samples: VecDeque<Sample>,
    before: usize,
    /// Samples that are kept at most.
    most: usize,
}

impl<'a> Taken<'a> {
    fn new(
        start: &Assembled,
        run: &'a Run,
        stop: &'a dyn Fn() -> bool,
    ) -> Result<Self, SimulationError> {
        let plain = Run {
            run_in: RunIn::None,
            ..run.clone()
        };
        let from = start.time;
        let mut simulation = Simulation::from_assembled(start.clone(), &plain)?;
        let mut taken = Self {
            samples: VecDeque::from([simulation.take_sample(from, false, stop)?.0]),
            run,
            stop,
            from,
            starts: vec![Some((start.clone().recorded_from(from), 0))],
            before: 0,
            most: 0,
            simulation,
        };
        let channels = Channel::ALL.iter();
        let numbers = channels.map(|it| taken.simulation.channel(*it).len());
        let bytes = size_of::<f64>() * numbers.sum::<usize>();
        let wanted = counted(run.until / run.every + 1.0);
        taken.most = wanted.min(ROOM / bytes.max(1)).max(1);
        Ok(taken)
    }

    /// Reads everything off the drive at a time \[s\], with the samples before it on the way.
    fn look(&mut self, time: f64) -> Result<&Observation, SimulationError> {
        while self.next() < time {
            self.take()?;
        }
        self.simulation.look(time, self.stop)
    }

    /// Time of the next sample \[s\].
    fn next(&self) -> f64 {
        self.from + (self.before + self.samples.len()) as f64 * self.run.every
    }

    fn take(&mut self) -> Result<(), SimulationError> {
        let number = self.before + self.samples.len();
        let time = self.next();
        let due = self.starts.last().is_some_and(Option::is_none);
        let (sample, start) = self.simulation.take_sample(time, due, self.stop)?;
        if let (Some(start), Some(last)) = (start, self.starts.last_mut()) {
            *last = Some((start.recorded_from(time), number));
        }
        self.samples.push_back(sample);
        if self.samples.len() > self.most {
            self.samples.pop_front();
            self.before += 1;
        }
        Ok(())
    }

    /// Forgets beginnings before a block, and some of many behind it.
    fn forget(&mut self, earliest: usize) {
        let last = self.starts.len() - 1;
        self.starts[..earliest].fill(None);
        let apart = (last / MOST_STARTS).next_power_of_two();
        for between in (earliest..last).filter(|d| d % apart != 0) {
            self.starts[between] = None;
        }
    }

    /// Ends a run-in that cannot go on with what there is of the record: that fails as well.
    fn failed(mut self, failure: SimulationError) -> Result<Settled, SimulationError> {
        while self.starts.last().is_some_and(Option::is_none) {
            self.starts.pop();
        }
        let last = self.starts.last().and_then(Option::as_ref);
        let reached = self.simulation.time();
        if last.is_none_or(|(start, _)| start.zero + self.run.until < reached) {
            return Err(failure);
        }
        self.recorded_from(0, false)
    }

    /// Ends the run-in with the first beginning from a block on that is near enough to the end.
    fn recorded_from(mut self, block: usize, is_steady: bool) -> Result<Settled, SimulationError> {
        while self.starts.last().is_some_and(Option::is_none) {
            self.take()?;
        }
        let (time, before) = (self.simulation.time(), self.before);
        let is_near = |(start, number): &(Assembled, usize)| {
            time - start.zero <= self.run.until && *number >= before
        };
        let mut known: Vec<_> = self.starts.drain(block..).flatten().collect();
        // The last one is at the end, whatever is shorter than a step.
        let first = known.iter().position(is_near);
        let (start, number) = known.swap_remove(first.unwrap_or(known.len() - 1));
        let ahead = self.samples.drain(number - before..);
        Ok(Settled {
            simulation: self.simulation.begun_at(start.clone(), self.run, ahead),
            start,
            is_steady,
        })
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

/// States that may creep: places of tensioners and speeds of sprockets.
fn creeping(seen: &Observation) -> impl Iterator<Item = f64> {
    let tensioners = seen.tensioner_position.iter();
    tensioners.chain(&seen.sprocket_speed).copied()
}

fn note(sums: &mut Vec<Sums>, values: impl Iterator<Item = f64>) {
    for (place, value) in values.enumerate() {
        if place == sums.len() {
            sums.push(Sums::default());
        }
        sums[place].push(value);
    }
}

/// Means and deviations of the blocks so far.
#[derive(Default)]
struct Course {
    count: usize,
    /// By span: means, and deviations within a block.
    means: Vec<Series>,
    deviations: Vec<Series>,
    /// By state that creeps: means.
    states: Vec<Series>,
}

impl Course {
    fn push(&mut self, spans: &[Sums], states: &[Sums]) {
        self.count += 1;
        for (to, values) in [
            (
                &mut self.means,
                spans.iter().map(Sums::mean).collect::<Vec<_>>(),
            ),
            (
                &mut self.deviations,
                spans.iter().map(Sums::deviation).collect(),
            ),
            (&mut self.states, states.iter().map(Sums::mean).collect()),
        ] {
            to.resize_with(values.len(), Vec::new);
            for (series, value) in to.iter_mut().zip(values) {
                series.push(value);
            }
        }
    }

    /// Whether nothing that counts changes from a block on, over so many teeth.
    fn is_steady_from(&self, first: usize, teeth: f64) -> bool {
        let average = |series: &[f64]| series.iter().sum::<f64>() / series.len() as f64;
        let means = self.means.iter().map(|it| average(&it[first..]).abs());
        let means: Vec<f64> = means.collect();
        let tight = means.iter().copied().fold(0.0, f64::max);
        let spans = self.means.iter().zip(&self.deviations).zip(means);
        spans.into_iter().all(|((tension, deviation), mean)| {
            let scale = mean.max(0.1 * tight);
            let allowed = DRIFT * scale;
            // A swing dies out unseen beside a mean that is many times as large.
            let sigma = average(&deviation[first..]);
            let swing = (SWINGS * sigma).clamp(LEAST * scale, allowed);
            let [of_scale, of_sigma] = UNCERTAIN.map(|share| share * teeth / UNCERTAIN_AFTER);
            let holds = |series: &Series, allowed: f64, uncertain: f64| {
                let series = &series[first..];
                let (drift, doubt) = drift(series);
                // A span that no roller held in some block has no drift to speak of.
                drift.is_nan()
                    || (drift.abs() <= doubt.max(allowed)
                        && drift.abs() + doubt <= uncertain.max(allowed)
                        && left(series).abs() <= allowed)
            };
            let crept = |state: &Series| (slope(state, tension) * left(&state[first..])).abs();
            holds(tension, allowed, of_scale * scale)
                && holds(deviation, swing, of_sigma * sigma)
                && self.states.iter().all(|state| {
                    let crept = crept(state);
                    crept <= allowed || crept.is_nan()
                })
        })
    }
}

/// How far a state still goes that dies out like an exponential; 0 where its drift is no more than chance.
fn left(state: &[f64]) -> f64 {
    let (drift, doubt) = drift(state);
    let third = state.len() / 3;
    if drift.abs() <= doubt || third == 0 {
        return 0.0;
    }
    let mean = |part: usize| {
        let part = &state[state.len() - (3 - part) * third..][..third];
        part.iter().sum::<f64>() / third as f64
    };
    let [a, b, c] = [0, 1, 2].map(mean);
    let ratio = (c - b) / (b - a);
    if (0.0..1.0).contains(&ratio) {
        (c - b) * ratio / (1.0 - ratio)
    } else {
        // It does not die out: all of it may come again.
        c - a
    }
}

/// Slope of the line through values over another quantity.
fn slope(over: &[f64], values: &[f64]) -> f64 {
    let n = values.len() as f64;
    let mean = |of: &[f64]| of.iter().sum::<f64>() / n;
    let (x, y) = (mean(over), mean(values));
    let pairs = over.iter().zip(values);
    let products: f64 = pairs.map(|(a, b)| (a - x) * (b - y)).sum();
    products / over.iter().map(|a| (a - x).powi(2)).sum::<f64>()
}

fn refused(why: &str) -> SimulationError {
    SimulationError::RunIn {
        reason: format!("auto: {why}"),
    }
}

/// Time \[s\] of a circuit of the slowest chain; refused where none runs around sprockets.
pub(super) fn circuit(start: &Assembled) -> Result<f64, SimulationError> {
    let circuit = start.slowest_circuit();
    if circuit.is_finite() {
        return Ok(circuit);
    }
    Err(refused(
        "no chain runs around sprockets here, so nothing says when to stop: give a time",
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dying(from: f64, blocks: usize) -> Vec<f64> {
        (0..blocks)
            .map(|i| from * (-(i as f64) / 4.0).exp())
            .collect()
    }

    /// s = 8 exp(−i/4) at the end of 12 blocks: means of thirds of 4 blocks fall by 1/e, and what is left is C/(e − 1) · (e − 1)/1.
    #[test]
    fn what_is_left_to_creep_is_that_of_the_exponential() {
        let state = dying(8.0, 12);
        let last: f64 = state[8..].iter().sum::<f64>() / 4.0;
        assert!((left(&state) + last).abs() < 1e-9, "{}", left(&state));
        assert!(left(&[1.0; 12]).abs() < 1e-12);
    }

    /// Tension that follows a state which creeps is not steady while it does.
    #[test]
    fn a_state_that_creeps_is_waited_for() {
        let blocks = |blocks: usize| {
            let state = dying(1.0, blocks);
            let tension: Vec<f64> = state.iter().map(|s| 100.0 + 20.0 * s).collect();
            Course {
                count: blocks,
                deviations: vec![vec![5.0; blocks]],
                means: vec![tension],
                states: vec![state],
            }
        };
        assert!(!blocks(12).is_steady_from(0, 30.0) && !blocks(12).is_steady_from(6, 15.0));
        assert!(blocks(40).is_steady_from(20, 50.0));
    }

    /// Swings that beat while they die out, by a quarter within a hundred teeth, are not steady, however much of it may be chance; beats alone are, once
    /// they have been seen often enough.
    #[test]
    fn chance_excuses_no_more_than_was_examined() {
        let beating = |dying: f64| {
            let beat =
                |i: usize| 10.0 * (1.0 - dying * i as f64) * (1.0 + 0.2 * (1.2 * i as f64).sin());
            Course {
                count: 40,
                means: vec![vec![400.0; 40]],
                deviations: vec![(0..40).map(beat).collect()],
                states: Vec::new(),
            }
        };
        let (dying, steady) = (beating(0.25 / 40.0), beating(0.0));
        let (drift, doubt) = drift(&dying.deviations[0]);
        assert!(
            drift.abs() < doubt,
            "{drift}, {doubt}: else nothing is excused"
        );
        assert!(!dying.is_steady_from(0, 100.0) && !steady.is_steady_from(32, 20.0));
        assert!(steady.is_steady_from(0, 100.0));
    }
}
