//! What steps are watched for: the least and the greatest of forces, speeds and places, period by period, and the tensions of spans between.
//!
//! Everything is read off accepted steps. Samples have no part in it: whoever samples more or less finds the same numbers.

use chaindrive_integrate::slack;
use serde::{Deserialize, Serialize};

use crate::MemoryError;
use crate::kinematics::Kinematics;
use crate::order::Forcing;

/// Least and greatest value of a quantity, and when it had them \[s\].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Extremes {
    /// Least value; infinite where nothing was seen.
    pub least: f64,
    /// When.
    pub least_at: f64,
    /// Greatest value; minus infinite where nothing was seen.
    pub greatest: f64,
    /// When.
    pub greatest_at: f64,
}

impl Default for Extremes {
    fn default() -> Self {
        Self {
            least: f64::INFINITY,
            least_at: f64::NAN,
            greatest: f64::NEG_INFINITY,
            greatest_at: f64::NAN,
        }
    }
}

impl Extremes {
    /// Takes in a value at a time \[s\]; one that is not a number is neither.
    #[inline(always)]
    pub fn see(&mut self, value: f64, t: f64) {
        if value < self.least {
            (self.least, self.least_at) = (value, t);
        }
        if value > self.greatest {
            (self.greatest, self.greatest_at) = (value, t);
        }
    }

    /// Takes in what another has seen later.
    pub fn take(&mut self, later: &Self) {
        self.see(later.least, later.least_at);
        self.see(later.greatest, later.greatest_at);
    }

    /// Greatest less least value; negative infinite where nothing was seen.
    pub fn range(&self) -> f64 {
        self.greatest - self.least
    }
}

/// Extremes of a sprocket.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SprocketExtremes {
    /// Force of the chain, which its bearings bear \[N\].
    pub force: Extremes,
    /// Force of one roller on its teeth \[N\].
    pub contact: Extremes,
    /// Speed \[rad/s\].
    pub speed: Extremes,
    /// Angle beyond that of an exact ratio to the sprocket that leads its chain \[rad\]: the transmission error.
    pub lag: Extremes,
}

/// Extremes of everything that is watched.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DriveExtremes {
    /// Tension of the links of every chain \[N\].
    pub chains: Vec<Extremes>,
    /// Tension of every span \[N\].
    pub spans: Vec<Extremes>,
    /// Of every sprocket.
    pub sprockets: Vec<SprocketExtremes>,
    /// Force of the chain on every guide \[N\].
    pub guides: Vec<Extremes>,
    /// Coordinate of every tensioner \[m or rad\].
    pub tensioners: Vec<Extremes>,
}

impl DriveExtremes {
    /// Takes in what was seen later.
    pub fn take(&mut self, later: &Self) {
        for (own, later) in self.all_mut().zip(later.all()) {
            own.take(later);
        }
    }

    /// Tells its times from a zero of the clock on \[s\].
    pub fn count_from(&mut self, zero: f64) {
        for it in self.all_mut() {
            it.least_at -= zero;
            it.greatest_at -= zero;
        }
    }

    /// All of them, one after the other.
    pub fn all(&self) -> impl Iterator<Item = &Extremes> {
        let Self {
            chains,
            spans,
            sprockets,
            guides,
            tensioners,
        } = self;
        let sprockets = sprockets
            .iter()
            .flat_map(|it| [&it.force, &it.contact, &it.speed, &it.lag]);
        let before = chains.iter().chain(spans).chain(sprockets);
        before.chain(guides).chain(tensioners)
    }

    fn all_mut(&mut self) -> impl Iterator<Item = &mut Extremes> {
        let Self {
            chains,
            spans,
            sprockets,
            guides,
            tensioners,
        } = self;
        let sprockets = sprockets.iter_mut().flat_map(|it| {
            let SprocketExtremes {
                force,
                contact,
                speed,
                lag,
            } = it;
            [force, contact, speed, lag]
        });
        let before = chains.iter_mut().chain(spans).chain(sprockets);
        before.chain(guides).chain(tensioners)
    }
}

/// How a drive is watched.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WatchPlan {
    /// Time at which the first period begins \[s\].
    pub begin: f64,
    /// Length of a period \[s\]; infinite where nothing repeats.
    pub period: f64,
    /// Periods in which everything known repeats together; 1 also where that is not seen.
    pub together: u32,
    /// What repeats, as far as it is to be told from chance: with every reading of the spans comes the phase of each.
    pub forcings: Vec<Forcing>,
    /// Least time between two readings of the spans \[s\], positive.
    pub interval: f64,
    /// For every sprocket the one that its transmission error is measured from, and the exact ratio to it.
    pub leaders: Vec<(usize, f64)>,
    /// Share of the greatest span tension by which a link is pressed to count as pressed.
    pub pressed: f64,
}

/// The watch on a drive in motion.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Watch {
    pub(crate) plan: WatchPlan,
    /// Periods that have ended.
    passed: u64,
    pub(crate) current: DriveExtremes,
    /// Extremes of periods that ended and were not handed out, with their ends \[s\].
    ended: Vec<(f64, DriveExtremes)>,
    /// Time from which on the spans are read again, and found again where they begin and end \[s\].
    next: [f64; 2],
    /// Whether they have been found at all.
    pub(crate) is_looking: bool,
    /// Rollers between which each span lies, within its chain; none where one of its sprockets holds no roller.
    pub(crate) ends: Vec<Option<(usize, usize)>>,
    /// Readings that were not handed out: time, tension of every span, number of pressed links of every chain, phase of every forcing.
    pub(crate) readings: Vec<f64>,
    #[serde(skip)]
    pub(crate) work: WatchWork,
}

/// Work space.
#[derive(Clone, Debug, Default)]
pub(crate) struct WatchWork {
    pub(crate) tensions: Vec<f64>,
    pub(crate) turning: Vec<Kinematics>,
    pub(crate) seated: Vec<usize>,
    pub(crate) seats: Vec<Option<(usize, usize)>>,
}

/// Readings of the spans after which it is looked up again where they begin and end.
const READINGS_PER_LOOK: f64 = 4.0;

impl Watch {
    /// A watch on which nothing was seen yet; `sizes`: of chains, sprockets, guides and tensioners.
    pub(crate) fn new(
        plan: WatchPlan,
        spans: usize,
        [chains, sprockets, guides, tensioners]: [usize; 4],
    ) -> Self {
        let none = |count: usize| vec![Extremes::default(); count];
        let current = DriveExtremes {
            chains: none(chains),
            spans: none(spans),
            sprockets: vec![SprocketExtremes::default(); sprockets],
            guides: none(guides),
            tensioners: none(tensioners),
        };
        Self {
            next: [plan.begin; 2],
            plan,
            passed: 0,
            current,
            ended: Vec::new(),
            is_looking: false,
            ends: vec![None; spans],
            readings: Vec::new(),
            work: WatchWork::default(),
        }
    }

    /// End of the present period \[s\].
    fn mark(&self) -> f64 {
        self.plan.begin + (self.passed + 1) as f64 * self.plan.period
    }

    /// Ends the periods that are over at a time \[s\].
    pub(crate) fn pass(&mut self, t: f64) {
        while t > self.mark() + slack(t) {
            let none = self.current.emptied();
            let ended = std::mem::replace(&mut self.current, none);
            self.ended.push((self.mark(), ended));
            self.passed += 1;
        }
    }

    /// Whether spans are to be read at a time \[s\] (0), or to be found again (1).
    pub(crate) fn due(&mut self, what: usize, t: f64) -> bool {
        if t < self.next[what] {
            return false;
        }
        let interval = [1.0, READINGS_PER_LOOK][what] * self.plan.interval;
        let passed = ((t - self.plan.begin) / interval).floor();
        self.next[what] = self.plan.begin + (passed + 1.0) * interval;
        true
    }

    /// Extremes since the last period ended.
    pub(crate) fn current(&self) -> &DriveExtremes {
        &self.current
    }

    /// Periods that ended since the last call, with their ends \[s\].
    pub(crate) fn take_ended(&mut self) -> Vec<(f64, DriveExtremes)> {
        std::mem::take(&mut self.ended)
    }

    /// Moves the readings since the last call behind others.
    pub(crate) fn hand_out_readings(&mut self, to: &mut Vec<f64>) {
        to.append(&mut self.readings);
    }

    /// Refuses a memory of another drive.
    pub(crate) fn check(&self, own: &Self) -> Result<(), MemoryError> {
        let sizes = |it: &Self| it.current.all().count();
        MemoryError::unless("quantities that are watched", sizes(self), sizes(own))?;
        MemoryError::unless("spans that are watched", self.ends.len(), own.ends.len())
    }
}

impl DriveExtremes {
    /// The same quantities, of which nothing was seen.
    fn emptied(&self) -> Self {
        let none = |of: &[Extremes]| vec![Extremes::default(); of.len()];
        Self {
            chains: none(&self.chains),
            spans: none(&self.spans),
            sprockets: vec![SprocketExtremes::default(); self.sprockets.len()],
            guides: none(&self.guides),
            tensioners: none(&self.tensioners),
        }
    }
}

/// Values that are added side by side, so that no addition waits for the one before.
const SIDE_BY_SIDE: usize = 8;

/// Least and greatest of some values.
pub(crate) fn range_of(values: &[f64]) -> [f64; 2] {
    let mut least = [f64::INFINITY; SIDE_BY_SIDE];
    let mut greatest = [f64::NEG_INFINITY; SIDE_BY_SIDE];
    let blocks = values.chunks_exact(SIDE_BY_SIDE);
    let rest = blocks.remainder();
    for block in blocks {
        for (k, value) in block.iter().enumerate() {
            least[k] = if *value < least[k] { *value } else { least[k] };
            greatest[k] = if *value > greatest[k] {
                *value
            } else {
                greatest[k]
            };
        }
    }
    let low = least.iter().chain(rest).copied();
    let high = greatest.iter().chain(rest).copied();
    [
        low.fold(f64::INFINITY, f64::min),
        high.fold(f64::NEG_INFINITY, f64::max),
    ]
}

fn sum(values: &[f64]) -> f64 {
    let mut sums = [0.0; SIDE_BY_SIDE];
    let blocks = values.chunks_exact(SIDE_BY_SIDE);
    let rest: f64 = blocks.remainder().iter().sum();
    for block in blocks {
        for (sum, value) in sums.iter_mut().zip(block) {
            *sum += value;
        }
    }
    sums.iter().sum::<f64>() + rest
}

/// Mean tension of the links from one roller to another one after it \[N\]; links follow their rollers.
pub(crate) fn mean_between(tensions: &[f64], last: usize, next: usize) -> f64 {
    let (total, count) = if last <= next {
        (sum(&tensions[last..next.min(tensions.len())]), next - last)
    } else {
        let around = sum(&tensions[last..]) + sum(&tensions[..next]);
        (around, tensions.len() - last + next)
    };
    total / count.max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spans_wrap_around_the_first_link() {
        let tensions: Vec<f64> = (0..19).map(f64::from).collect();
        assert!((mean_between(&tensions, 3, 7) - 4.5).abs() < 1e-15);
        // 17, 18, 0, 1
        assert!((mean_between(&tensions, 17, 2) - 9.0).abs() < 1e-15);
        let [least, greatest] = range_of(&tensions);
        assert!(least.abs() < 1e-15 && (greatest - 18.0).abs() < 1e-15);
    }

    /// The first of two equal values counts, and what is not a number is none.
    #[test]
    fn extremes_know_when() {
        let mut seen = Extremes::default();
        for (value, t) in [
            (1.0, 0.0),
            (3.0, 1.0),
            (f64::NAN, 2.0),
            (3.0, 3.0),
            (-1.0, 4.0),
        ] {
            seen.see(value, t);
        }
        assert!((seen.greatest_at - 1.0).abs() < 1e-15 && (seen.least_at - 4.0).abs() < 1e-15);
        assert!((seen.range() - 4.0).abs() < 1e-15);
    }
}
