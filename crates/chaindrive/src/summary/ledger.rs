//! The energy of a run: what came in, went out, was lost, and what is unaccounted for.

use chaindrive_mechanics::{Energy, Flow};
use serde::{Deserialize, Serialize};

/// The energy of a run, and what of it is unaccounted for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ledger {
    /// Largest residual in magnitude \[J\].
    pub residual: f64,
    /// Energy lost \[J\].
    pub losses: f64,
    /// Energy that has changed its form or owner \[J\].
    pub moved: f64,
    /// Energy that drivers, motions, torques and loads have put in, those that took some out left aside \[J\].
    pub supplied: f64,
    /// Energy that those have taken out that took more than they put in \[J\].
    pub delivered: f64,
    /// The most that those who put it in had taken back of it at any moment \[J\].
    pub supplied_back: f64,
    /// The most that those who took it out had given back of it at any moment \[J\].
    pub delivered_back: f64,
    /// Energy that they have put in and taken out again, added up without regard to direction \[J\].
    pub exchanged: f64,
    /// Energy that loads have put in, those that took some out counted against it \[J\].
    pub by_loads: f64,
    /// Energy that loads have put in and taken out, added up without regard to direction \[J\].
    pub loads_exchanged: f64,
    /// Largest kinetic energy \[J\].
    pub kinetic: f64,
    /// Residual that rounding may leave \[J\].
    pub rounding: f64,
    /// Teeth of the slowest chain that have passed \[–\]; infinite without sprockets.
    pub teeth: f64,
}

/// Uncertainty of an efficiency, by where within a swing the record ends, beyond which there is none. *Assumed*.
const TO_AND_FRO: f64 = 0.1;
/// Share of the energy supplied that somebody has to take out before the rest of it is an efficiency. *Assumed*: less is rounding and
/// the run-up, and what a drive that serves nobody keeps in its motion is not its use.
const TAKEN: f64 = 1e-6;
/// Teeth that have to pass before there is an efficiency. *Assumed*: losses are those of meshes, and springs in which friction stands
/// take and give until the first of them is over.
const LEAST_TEETH: f64 = 3.0;

impl Ledger {
    /// Share of the energy supplied that is not lost, and how uncertain it is; none where [`unknown`](Self::unknown) says why.
    ///
    /// ```text
    /// η = 1 − D/E ± (|R| + B D/E)/E       D: losses, R: residual, E: energy supplied, B: what its suppliers had taken back at most
    /// ```
    ///
    /// E is a net: what the springs of valves give back over the cams, and a crank takes back, has not been supplied, and what it costs to move it
    /// to and fro is lost. A record that ends within a swing has up to B more or less in E.
    pub fn efficiency(&self) -> Option<[f64; 2]> {
        let share = |of: f64| of / self.supplied;
        self.unknown().is_none().then(|| {
            let uncertain = share(self.residual.abs()) + self.by_swings();
            [1.0 - share(self.losses), uncertain]
        })
    }

    /// Uncertainty of the efficiency by what its suppliers take back and put in anew: B D/E².
    fn by_swings(&self) -> f64 {
        self.supplied_back / self.supplied * self.losses / self.supplied
    }

    /// Why there is no efficiency, in words; none where there is one.
    pub fn unknown(&self) -> Option<&'static str> {
        // What a spring takes and gives back is not taken out, wherever the record ends.
        let swings = self.by_swings() > TO_AND_FRO || self.delivered_back > self.delivered;
        if self.supplied <= 0.0 {
            Some("nobody puts energy in")
        } else if self.idles() {
            Some("nobody takes energy out")
        } else if self.teeth < LEAST_TEETH {
            Some("fewer than three teeth have passed: take a longer record")
        } else if self.losses < -self.rounding {
            Some(
                "springs in which friction stands gave back more than was lost: take a longer record",
            )
        } else if self.kept() > self.delivered {
            Some(
                "more energy went into or came out of motion, height and springs than was taken out: run it in, or take a longer record",
            )
        } else if swings {
            Some("too much energy goes to and fro for this record: take a longer one")
        } else {
            None
        }
    }

    /// Energy that came into motion, height and springs, or out of them, in magnitude \[J\].
    fn kept(&self) -> f64 {
        (self.supplied - self.delivered - self.losses).abs()
    }

    /// Whether nothing takes energy out: all that is supplied is lost, or stays in motion, height and springs.
    fn idles(&self) -> bool {
        self.delivered <= TAKEN * self.supplied
    }
}

/// Energy that a run has moved about.
///
/// Net work is no measure for that: a driver that reverses takes back what it gave, and a chain that
/// swings or spins freely is given nothing at all.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct Turnover {
    /// Σ |ΔW| over all flows and samples \[J\].
    pub(super) flowed: f64,
    /// The same over flows that are no losses \[J\].
    pub(super) exchanged: f64,
    /// The same over loads alone \[J\].
    pub(super) loads: f64,
    /// Work of every flow that is no loss.
    pub(super) works: Vec<Swing>,
    /// Least and greatest kinetic and stored energy \[J\].
    pub(super) ranges: Option<[[f64; 2]; 2]>,
}

/// Work since the start, and how much of it has gone back.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct Swing {
    /// The work now, and its least and greatest value so far \[J\].
    pub(super) work: f64,
    pub(super) least: f64,
    pub(super) greatest: f64,
    /// The most that it has been below the greatest and above the least value before \[J\].
    pub(super) fall: f64,
    pub(super) rise: f64,
}

impl Swing {
    pub(super) fn push(&mut self, work: f64) {
        self.work = work;
        self.least = self.least.min(work);
        self.greatest = self.greatest.max(work);
        self.fall = self.fall.max(self.greatest - work);
        self.rise = self.rise.max(work - self.least);
    }
}

impl Turnover {
    pub(super) fn push(&mut self, start: &Energy, before: &Energy, now: &Energy) {
        let worked = |flow: &Flow| (now.flow(*flow) - before.flow(*flow)).abs();
        self.flowed += Flow::ALL.iter().map(worked).sum::<f64>();
        let outside = Flow::ALL.iter().filter(|flow| !flow.is_loss());
        self.exchanged += outside.clone().map(worked).sum::<f64>();
        self.works.resize(outside.clone().count(), Swing::default());
        for (swing, &flow) in self.works.iter_mut().zip(outside) {
            swing.push(now.flow(flow) - start.flow(flow));
        }
        self.loads += worked(&Flow::Load);
        let stores = [now.kinetic(), now.stored()];
        let ranges = self.ranges.get_or_insert(stores.map(|energy| [energy; 2]));
        for (range, energy) in ranges.iter_mut().zip(stores) {
            *range = [range[0].min(energy), range[1].max(energy)];
        }
    }

    /// Half the flows, for what comes in goes out again, or the greatest change of a store \[J\].
    pub(super) fn moved(&self) -> f64 {
        let ranges = self.ranges.unwrap_or_default();
        ranges
            .iter()
            .map(|[least, greatest]| greatest - least)
            .fold(0.5 * self.flowed, f64::max)
    }

    /// Largest kinetic energy \[J\].
    pub(super) fn kinetic(&self) -> f64 {
        let [[_, greatest], _] = self.ranges.unwrap_or_default();
        greatest
    }

    /// Residual that rounding may leave \[J\].
    pub(super) fn rounding(&self) -> f64 {
        let ranges = self.ranges.unwrap_or_default();
        let largest = ranges
            .iter()
            .flatten()
            .fold(0.0, |m: f64, e| m.max(e.abs()));
        ROUNDING * largest
    }
}

/// Share of the energy present below which a residual is taken for rounding. *Assumed*: the last digits of many steps add up.
const ROUNDING: f64 = 1e-9;
