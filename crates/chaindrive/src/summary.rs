//! The short account that ends every run.

mod blocks;
mod bodies;
mod chain_duties;
mod impacts;
mod steadiness;
mod value_counts;

use chaindrive_mechanics::{ContactEvent, Energy, Flow, Impact, Observation, Place};
use hdrhistogram::Histogram;
use serde::{Deserialize, Serialize};

use crate::Simulation;
use crate::event::{EventTable, kind};
use crate::rating::{Load, Rating};
use blocks::Blocks;
pub use bodies::{BearingForce, Bodies, SampleStatistics, SprocketStatistics};
use chain_duties::ChainDuties;
pub use impacts::ImpactStatistics;
pub use steadiness::{ConfidenceInterval, Steadiness};
pub(crate) use steadiness::{DRIFT, drift};

/// Collects statistics sample by sample, in bounded memory.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Summary {
    /// Spans of the route.
    pub spans: Vec<SpanStatistics>,
    /// Period of the slowest forcing \[s\]; infinite where nothing repeats.
    period: f64,
    /// Time of the first sample \[s\].
    began: Option<f64>,
    #[serde(with = "value_counts")]
    forces: Histogram<u64>,
    largest_force: f64,
    impacts: Vec<ImpactStatistics>,
    contacts: [ContactStatistics; EventTable::KINDS.len()],
    start: Option<Energy>,
    last: Energy,
    turnover: Turnover,
    /// Largest energy residual in magnitude \[J\]; NaN if ever one was not a number.
    pub residual: f64,
    /// Samples with a link tension or contact force that is not a number.
    pub not_finite: u64,
    /// Samples seen.
    pub samples: u64,
    /// Whether the samples are kept; otherwise only the summary is made of them.
    pub kept: bool,
    carried: ChainDuties,
    bodies: Bodies,
    /// Time of the last sample \[s\].
    ended: f64,
}

/// Tension of one span over the run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpanStatistics {
    /// Name, "from-to".
    pub name: String,
    /// Least and greatest sample \[N\].
    pub least: f64,
    /// See `least`.
    pub greatest: f64,
    blocks: Blocks,
    /// Samples without a tension, because no roller holds the span.
    pub missing: u64,
}

impl SpanStatistics {
    /// Time mean \[N\], of whole periods of the slowest forcing where there are three of them; NaN without a sample.
    pub fn mean(&self) -> f64 {
        self.blocks.mean()
    }
}

/// Percentiles of the roller-tooth forces of all closed contacts \[N\].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ForceStatistics {
    /// Median.
    pub p50: f64,
    /// 90th percentile.
    pub p90: f64,
    /// 99th percentile.
    pub p99: f64,
    /// Largest sample.
    pub max: f64,
}

/// Contacts of one kind over the run, those that last included.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ContactStatistics {
    /// Their number.
    pub count: u64,
    /// Sum of their largest forces \[N\].
    sum: f64,
    /// Largest force of all \[N\].
    pub greatest: f64,
    /// Sum of their durations \[s\].
    pub duration: f64,
}

impl ContactStatistics {
    fn push(&mut self, event: &ContactEvent, now: f64) {
        self.count += 1;
        self.sum += event.peak_force;
        self.greatest = self.greatest.max(event.peak_force);
        self.duration += event.end.min(now) - event.start;
    }

    /// Mean of their largest forces \[N\].
    pub fn mean(&self) -> f64 {
        self.sum / self.count as f64
    }
}

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
}

/// Uncertainty of an efficiency, by where within a swing the record ends, beyond which there is none. *Assumed*.
const TO_AND_FRO: f64 = 0.1;
/// Share of the energy supplied that somebody has to take out before the rest of it is an efficiency. *Assumed*: less is rounding and
/// the run-up, and what a drive that serves nobody keeps in its motion is not its use.
const TAKEN: f64 = 1e-6;

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
        } else if swings {
            Some("too much energy goes to and fro for this record: take a longer one")
        } else {
            None
        }
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
struct Turnover {
    /// Σ |ΔW| over all flows and samples \[J\].
    flowed: f64,
    /// The same over flows that are no losses \[J\].
    exchanged: f64,
    /// The same over loads alone \[J\].
    loads: f64,
    /// Work of every flow that is no loss.
    works: Vec<Swing>,
    /// Least and greatest kinetic and stored energy \[J\].
    ranges: Option<[[f64; 2]; 2]>,
}

/// Work since the start, and how much of it has gone back.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Swing {
    /// The work now, and its least and greatest value so far \[J\].
    work: f64,
    least: f64,
    greatest: f64,
    /// The most that it has been below the greatest and above the least value before \[J\].
    fall: f64,
    rise: f64,
}

impl Swing {
    fn push(&mut self, work: f64) {
        self.work = work;
        self.least = self.least.min(work);
        self.greatest = self.greatest.max(work);
        self.fall = self.fall.max(self.greatest - work);
        self.rise = self.rise.max(work - self.least);
    }
}

impl Turnover {
    fn push(&mut self, start: &Energy, before: &Energy, now: &Energy) {
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
    fn moved(&self) -> f64 {
        let ranges = self.ranges.unwrap_or_default();
        ranges
            .iter()
            .map(|[least, greatest]| greatest - least)
            .fold(0.5 * self.flowed, f64::max)
    }

    /// Largest kinetic energy \[J\].
    fn kinetic(&self) -> f64 {
        let [[_, greatest], _] = self.ranges.unwrap_or_default();
        greatest
    }

    /// Residual that rounding may leave \[J\].
    fn rounding(&self) -> f64 {
        let ranges = self.ranges.unwrap_or_default();
        let largest = ranges
            .iter()
            .flatten()
            .fold(0.0, |m: f64, e| m.max(e.abs()));
        ROUNDING * largest
    }
}

/// Forces are counted in millinewtons, to three digits.
const COUNTS_PER_NEWTON: f64 = 1e3;

/// Nothing yet.
fn histogram() -> Histogram<u64> {
    Histogram::new(3).expect("three digits are between one and five")
}

impl Summary {
    /// Share of the greatest span tension by which a link has to be pressed to count as pressed. *Assumed*: less is the swing of its own mass.
    pub const PRESSED: f64 = 0.05;

    /// An empty summary for a run.
    pub fn new(simulation: &Simulation) -> Self {
        let period = simulation.assembled().slowest_forcing();
        let span = |name| SpanStatistics {
            name,
            least: f64::INFINITY,
            greatest: f64::NEG_INFINITY,
            blocks: Blocks::new(simulation.every(), period),
            missing: 0,
        };
        Self {
            period,
            began: None,
            spans: simulation
                .system()
                .span_names()
                .into_iter()
                .map(span)
                .collect(),
            forces: histogram(),
            largest_force: 0.0,
            impacts: ImpactStatistics::of(simulation),
            contacts: Default::default(),
            start: None,
            last: Energy::default(),
            turnover: Turnover::default(),
            residual: 0.0,
            not_finite: 0,
            samples: 0,
            kept: false,
            carried: ChainDuties::new(simulation),
            bodies: Bodies::new(&simulation.assembled().drive),
            ended: f64::NAN,
        }
    }

    /// Takes in one sample.
    pub fn push(&mut self, sample: &Observation) {
        let time = sample.time - *self.began.get_or_insert(sample.time);
        for (span, &tension) in self.spans.iter_mut().zip(&sample.span_tension) {
            if tension.is_finite() {
                span.least = span.least.min(tension);
                span.greatest = span.greatest.max(tension);
                span.blocks.push(time, tension);
            } else {
                span.missing += 1;
            }
        }
        let mut numbers = sample.link_tension.iter().chain(&sample.contact_force);
        if !numbers.all(|number| number.is_finite()) {
            self.not_finite += 1;
        }
        for &force in sample.contact_force.iter().filter(|force| **force > 0.0) {
            self.largest_force = self.largest_force.max(force);
            value_counts::note(&mut self.forces, force * COUNTS_PER_NEWTON);
        }
        let before = self.start.map_or(sample.energy, |_| self.last);
        let start = *self.start.get_or_insert(sample.energy);
        self.turnover.push(&start, &before, &sample.energy);
        let residual = sample.energy.residual(&start);
        if residual.abs() > self.residual.abs() || residual.is_nan() {
            self.residual = residual;
        }
        self.last = sample.energy;
        self.carried.push(sample);
        self.bodies.push(sample);
        self.ended = sample.time;
        self.samples += 1;
    }

    /// Statistics of the tension of every span, with their intervals; none of a span that no roller held in any sample.
    pub fn steadiness(&self) -> Vec<Option<Steadiness>> {
        let scales = self.scales().into_iter();
        let spans = self.spans.iter().zip(scales);
        spans
            .map(|(span, scale)| span.blocks.steadiness(scale))
            .collect()
    }

    /// Scale of errors and drifts, by span \[N\]: the mean tension of the span, or a tenth of that of the tight span, whichever is more.
    pub fn scales(&self) -> Vec<f64> {
        let means: Vec<f64> = self.spans.iter().map(|span| span.mean().abs()).collect();
        let tight = means.iter().copied().fold(0.0, f64::max);
        means.iter().map(|mean| mean.max(0.1 * tight)).collect()
    }

    /// End \[s\] of a record that would tell how well its statistics are known, where this one does not.
    pub fn known_from(&self) -> Option<f64> {
        let short = |it: &Steadiness| it.mean.half_width.is_nan();
        let is_short = self.steadiness().iter().flatten().any(short);
        // Three periods, and a sample after them.
        let until = 3.05 * self.period;
        (is_short && until.is_finite()).then_some(until)
    }

    /// Period of the slowest forcing that is known \[s\]: teeth, orders, tables; infinite where nothing repeats.
    pub fn slowest_forcing(&self) -> f64 {
        self.period
    }

    /// Takes in contacts that ended.
    pub fn count(&mut self, events: &[ContactEvent]) {
        for event in events {
            self.contacts[kind(event.pair)].push(event, f64::INFINITY);
        }
    }

    /// Takes in impacts that ended.
    pub fn strike(&mut self, impacts: &[Impact]) {
        for impact in impacts {
            self.impacts[impact.sprocket].push(impact);
        }
    }

    /// Impacts of rollers that came to a sprocket, by sprocket.
    pub fn impacts(&self) -> &[ImpactStatistics] {
        &self.impacts
    }

    /// Contacts that have ended.
    pub(crate) fn ended(&self) -> u64 {
        self.contacts.iter().map(|contacts| contacts.count).sum()
    }

    /// Contacts by kind, see [`EventTable::KINDS`], with those that last.
    pub fn contacts(
        &self,
        simulation: &Simulation,
    ) -> [ContactStatistics; EventTable::KINDS.len()] {
        let mut contacts = self.contacts;
        for event in simulation.outstanding_events() {
            contacts[kind(event.pair)].push(&event, simulation.time());
        }
        contacts
    }

    /// Percentiles of the contact forces; zero when nothing touched.
    pub fn forces(&self) -> ForceStatistics {
        let quantile = |q: f64| self.forces.value_at_quantile(q) as f64 / COUNTS_PER_NEWTON;
        if self.forces.is_empty() {
            return ForceStatistics::default();
        }
        ForceStatistics {
            p50: quantile(0.5),
            p90: quantile(0.9),
            p99: quantile(0.99),
            max: self.largest_force,
        }
    }

    /// Energy put in by drivers, motions and driving torques since the start \[J\].
    pub fn energy_supplied(&self) -> f64 {
        let start = self.start.unwrap_or_default();
        [Flow::Driver, Flow::Motions, Flow::DriveTorque]
            .iter()
            .map(|&flow| (self.last.flow(flow) - start.flow(flow)).abs())
            .sum()
    }

    /// Energy that has changed its form or owner since the start \[J\], as the samples see it: what the
    /// residual is to be compared with.
    pub fn energy_moved(&self) -> f64 {
        self.turnover.moved()
    }

    /// The energy of the run so far.
    pub fn ledger(&self) -> Ledger {
        let start = self.start.unwrap_or_default();
        let works = &self.turnover.works;
        let supplies = || works.iter().filter(|it| it.work > 0.0);
        let takes = || works.iter().filter(|it| it.work < 0.0);
        Ledger {
            residual: self.residual,
            losses: self.energy_dissipated(),
            moved: self.energy_moved(),
            supplied: supplies().map(|it| it.work).sum(),
            delivered: -takes().map(|it| it.work).sum::<f64>(),
            supplied_back: supplies().map(|it| it.fall).sum(),
            delivered_back: takes().map(|it| it.rise).sum(),
            exchanged: self.turnover.exchanged,
            by_loads: self.last.flow(Flow::Load) - start.flow(Flow::Load),
            loads_exchanged: self.turnover.loads,
            kinetic: self.turnover.kinetic(),
            rounding: self.turnover.rounding(),
        }
    }

    /// Energy lost since the start \[J\].
    pub fn energy_dissipated(&self) -> f64 {
        self.last.dissipated() - self.start.unwrap_or_default().dissipated()
    }

    /// Energy lost since the start, by place, where there is any \[J\].
    pub fn losses(&self) -> Vec<(Place, f64)> {
        let start = self.start.unwrap_or_default().losses();
        let lost = self.last.losses().into_iter().zip(start);
        let lost = Place::ALL
            .into_iter()
            .zip(lost.map(|(now, then)| now - then));
        lost.filter(|(_, lost)| *lost != 0.0).collect()
    }

    /// Time from the first to the last sample \[s\]; NaN without one.
    pub fn duration(&self) -> f64 {
        self.ended - self.began.unwrap_or(f64::NAN)
    }

    /// Loads of the bodies that the chains touch.
    pub fn bodies(&self) -> &Bodies {
        &self.bodies
    }

    /// Duty of each chain.
    pub fn carried(&self) -> Vec<Load> {
        self.carried.loads(&self.spans, &self.bodies.sprockets)
    }

    /// Ratings of the chains, beside the loads of the run.
    pub fn ratings(&self) -> Vec<Rating> {
        self.carried().iter().map(Rating::of).collect()
    }

    /// Greatest frequency at which rollers seat on a sprocket, in the mean over the run \[Hz\].
    pub fn mesh_frequency(&self) -> f64 {
        self.bodies.mesh_frequency()
    }
}

/// Share of the energy present below which a residual is taken for rounding. *Assumed*: the last digits of many steps add up.
const ROUNDING: f64 = 1e-9;
