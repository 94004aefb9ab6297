//! The short account that ends every run.

mod account;
mod blocks;
mod bodies;
mod chain_duties;
mod impacts;
mod ledger;
mod steadiness;
mod value_counts;
mod waves;

use std::sync::OnceLock;

use chaindrive_mechanics::{ContactEvent, Energy, Extremes, Flow, Impact, Observation, Place};
use hdrhistogram::Histogram;
use serde::{Deserialize, Serialize};

use crate::Simulation;
use crate::event::{EventTable, kind};
use crate::rating::{Load, Rating};
use account::Account;
pub use account::Balance;
use blocks::Blocks;
use bodies::BodyNames;
pub use bodies::{Bodies, ForceRecord, SprocketStatistics, TensionerStatistics};
use chain_duties::ChainDuties;
pub use impacts::ImpactStatistics;
pub use ledger::Ledger;
use ledger::Turnover;
pub use steadiness::{ConfidenceInterval, Steadiness};
pub(crate) use steadiness::{DRIFT, drift};

/// Collects statistics of a [watched](crate::Run::watched) run, in bounded memory.
///
/// Means of work and extremes are those of steps; statistics of span tensions those of readings between steps that the tooth of the fastest
/// sprocket sets. None of them knows the interval of the samples. Energies are those of samples.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Summary {
    /// Spans of the route.
    pub spans: Vec<SpanStatistics>,
    /// Period of the slowest forcing \[s\]; infinite where nothing repeats.
    period: f64,
    /// Time in which a tooth of the slowest chain passes \[s\]; 0 without sprockets, infinite where it stands.
    tooth: f64,
    /// How long the drive had moved before the record, and time in which the slowest tensioner comes nearer to its place by e \[s\].
    run_in: f64,
    settling: f64,
    /// Time of the first sample, and of the first reading of the spans \[s\]; how long they have been read.
    began: Option<f64>,
    first_reading: Option<f64>,
    reading: f64,
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
    names: BodyNames,
    account: Account,
    /// Cosine and sine of every forcing at the last reading of the spans.
    harmonics: Vec<f64>,
    /// Time of the last sample \[s\].
    ended: f64,
    /// Statistics of the spans, once somebody has asked for them: they are told in several places, and take long.
    #[serde(skip)]
    known: OnceLock<Vec<Option<Steadiness>>>,
}

/// Tension of one span over the run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpanStatistics {
    /// Name, "from-to".
    pub name: String,
    blocks: Blocks,
    /// The last reading: since when it counts, when it was, and the tension; counted from the first reading.
    pending: Option<[f64; 3]>,
    /// Readings, and those without a tension, because no roller holds the span.
    pub readings: u64,
    /// See `readings`.
    pub missing: u64,
}

impl SpanStatistics {
    /// Time mean \[N\], of whole periods of the slowest forcing where there are three of them; NaN without a sample.
    pub fn mean(&self) -> f64 {
        self.blocks.mean()
    }

    /// Takes in the tension at a time \[s\] counted from the first reading. A reading stands for the time from half-way after the one before it to
    /// half-way before the next; `last`: cosine and sine of every forcing at the one before.
    fn push(&mut self, time: f64, tension: f64, last: &[f64]) {
        self.readings += 1;
        self.missing += u64::from(!tension.is_finite());
        let mut since = time;
        if let Some([from, read, before]) = self.pending {
            since = 0.5 * (read + time);
            if before.is_finite() {
                self.blocks.push([from, since], before, last);
            }
        }
        self.pending = Some([since, time, tension]);
    }

    /// The last reading stands for the time up to the end \[s\], counted from the first.
    fn end(&mut self, time: f64, last: &[f64]) {
        if let Some([from, _, tension]) = self.pending.take().filter(|it| it[2].is_finite()) {
            self.blocks.push([from, time.max(from)], tension, last);
        }
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

/// Relaxations of a tensioner in which it comes nearer to its place by e, and what is left of its start at the start, as a share of the scale. *Assumed*,
/// by the preset `timing_drive`: its tensions settle within 0.2 s where c/k is 0.1 s, and begin 8 % too high.
const SETTLING: f64 = 2.0;
const LEFT_OF_START: f64 = 0.15;

/// Forces are counted in millinewtons, to three digits.
const COUNTS_PER_NEWTON: f64 = 1e3;

/// Nothing yet.
fn histogram() -> Histogram<u64> {
    Histogram::new(3).expect("three digits are between one and five")
}

impl Summary {
    /// Share of the greatest span tension by which a link has to be pressed to count as pressed. *Assumed*: less is the swing of its own mass.
    pub const PRESSED: f64 = crate::simulate::PRESSED;

    /// An empty summary for a run.
    pub fn new(simulation: &Simulation) -> Self {
        let plan = simulation.system().watch_plan();
        let forcing = || simulation.assembled().slowest_forcing();
        let period = plan.map_or_else(forcing, |plan| plan.period);
        let interval = plan.map_or(f64::INFINITY, |plan| plan.interval);
        let together = plan.map_or(1, |plan| plan.together as usize);
        let forcings: Vec<f64> = plan.map_or_else(Vec::new, |plan| {
            plan.forcings.iter().map(|it| it.period).collect()
        });
        let span = |name| SpanStatistics {
            name,
            blocks: Blocks::new(interval, period, together, &forcings),
            pending: None,
            readings: 0,
            missing: 0,
        };
        let assembled = simulation.assembled();
        let tensioners = assembled.drive.tensioners.iter();
        let relaxation = tensioners.map(|it| it.push.relaxation());
        Self {
            period,
            tooth: assembled.slowest_tooth(),
            run_in: assembled.moved_for(),
            settling: SETTLING * relaxation.fold(0.0, f64::max),
            began: None,
            first_reading: None,
            reading: 0.0,
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
            names: BodyNames::new(&simulation.assembled().drive),
            account: Account::default(),
            harmonics: Vec::new(),
            ended: f64::NAN,
            known: OnceLock::new(),
        }
    }

    /// Takes in a sample, and what steps have ended since the one before.
    pub fn take(&mut self, simulation: &Simulation) {
        self.push(simulation.observation());
        self.count(simulation.events());
        self.strike(simulation.impacts());
        for reading in simulation.span_readings() {
            self.read(reading);
        }
        for period in simulation.periods() {
            self.account.push(period);
        }
    }

    /// Ends with what steps have ended since the last sample, up to the end of the run or as far as it has come.
    pub fn end(&mut self, simulation: &Simulation) {
        for reading in simulation.outstanding_span_readings() {
            self.read(&reading);
        }
        let end = simulation.time() - self.first_reading.unwrap_or_default();
        for span in &mut self.spans {
            span.end(end, &self.harmonics);
        }
        self.reading = end;
        self.known.take();
        let periods = simulation.outstanding_periods();
        for period in &periods {
            // The last sample stands before the end where the interval of samples does not go into the run.
            if self.ended.is_nan() || period.time[1] > self.ended {
                self.balance_at(period.time[1], period.energy[1]);
            }
        }
        self.account.end(periods, self.period);
    }

    /// Takes in the energy at a time \[s\].
    fn balance_at(&mut self, time: f64, energy: Energy) {
        let before = self.start.map_or(energy, |_| self.last);
        let start = *self.start.get_or_insert(energy);
        self.turnover.push(&start, &before, &energy);
        let residual = energy.residual(&start);
        if residual.abs() > self.residual.abs() || residual.is_nan() {
            self.residual = residual;
        }
        self.last = energy;
        self.ended = time;
    }

    /// Takes in a reading of the spans: time \[s\], tension of every span \[N\], number of pressed links of every chain, phases of forcings \[rad\].
    pub fn read(&mut self, reading: &[f64]) {
        let (time, rest) = (reading[0], &reading[1..]);
        let (tensions, rest) = rest.split_at(self.spans.len());
        let (pressed, phases) = rest.split_at(self.carried.chains());
        let first = *self.first_reading.get_or_insert(time);
        self.reading = time - first;
        self.known.take();
        for (span, tension) in self.spans.iter_mut().zip(tensions) {
            span.push(time - first, *tension, &self.harmonics);
        }
        self.harmonics.clear();
        let waves = phases.iter().map(|phase| phase.sin_cos());
        self.harmonics.extend(waves.flat_map(|(s, c)| [c, s]));
        self.carried.push(pressed);
    }

    /// Takes in one sample alone: its forces and energies.
    pub fn push(&mut self, sample: &Observation) {
        self.began.get_or_insert(sample.time);
        let mut numbers = sample.link_tension.iter().chain(&sample.contact_force);
        if !numbers.all(|number| number.is_finite()) {
            self.not_finite += 1;
        }
        for &force in sample.contact_force.iter().filter(|force| **force > 0.0) {
            self.largest_force = self.largest_force.max(force);
            value_counts::note(&mut self.forces, force * COUNTS_PER_NEWTON);
        }
        self.balance_at(sample.time, sample.energy);
        self.samples += 1;
    }

    /// Statistics of the tension of every span, with their intervals; none of a span that no roller held in any sample.
    ///
    /// A tensioner that oil holds comes to its place so slowly that a short record shows nothing of it. Means and quantiles take in what may be left of
    /// the start in the middle of the record:
    ///
    /// ```text
    /// s = 15 % exp(−(t_run-in + T/2)/(2 c/k))     of the scale; c/k: relaxation of the slowest tensioner
    /// ```
    pub fn steadiness(&self) -> Vec<Option<Steadiness>> {
        let find = || {
            let middle = self.run_in + 0.5 * self.reading;
            let left = LEFT_OF_START * (-middle / self.settling.max(f64::MIN_POSITIVE)).exp();
            let spans = self.spans.iter().zip(self.scales());
            spans
                .map(|(span, scale)| {
                    let known = span.blocks.steadiness(scale)?;
                    Some(known.and_start(left * scale))
                })
                .collect()
        };
        self.known.get_or_init(find).clone()
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

    /// Energy put in by drivers, motions, driving torques and forces from outside since the start \[J\].
    pub fn energy_supplied(&self) -> f64 {
        let start = self.start.unwrap_or_default();
        [Flow::Driver, Flow::Motions, Flow::DriveTorque, Flow::Forces]
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
            teeth: self.duration().max(0.0) / self.tooth,
        }
    }

    /// Energies of whole periods of the slowest forcing, or of all of a shorter record; none before the run has [ended](Self::end).
    pub fn balance(&self) -> Option<Balance> {
        self.account.balance()
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

    /// Time from the first sample to the last, or to the [end](Self::end) \[s\]; NaN without one.
    pub fn duration(&self) -> f64 {
        self.ended - self.began.unwrap_or(f64::NAN)
    }

    /// Loads of the bodies that the chains touch; none before the run has [ended](Self::end).
    pub fn bodies(&self) -> Bodies {
        self.names.bodies(&self.account)
    }

    /// Greatest force of one roller on teeth over all steps \[N\]; zero where nothing touched.
    pub fn greatest_contact(&self) -> f64 {
        let extremes = self.account.extremes().unwrap_or_default();
        let contacts = extremes.sprockets.iter().map(|it| it.contact.greatest);
        contacts.fold(0.0, f64::max)
    }

    /// Least and greatest tension of a link of any chain over all steps \[N\].
    pub fn link_tension(&self) -> Extremes {
        let extremes = self.account.extremes().unwrap_or_default();
        let mut all = Extremes::default();
        extremes.chains.iter().for_each(|it| all.take(it));
        all
    }

    /// Least and greatest tension of every span over all steps \[N\], where a roller held it.
    pub fn span_extremes(&self) -> Vec<Extremes> {
        let seen = self.account.extremes().map(|it| it.spans);
        seen.unwrap_or_else(|| vec![Extremes::default(); self.spans.len()])
    }

    /// Duty of each chain.
    pub fn carried(&self) -> Vec<Load> {
        let extremes = self.account.extremes().unwrap_or_default();
        self.carried
            .loads(&self.spans, &self.bodies().sprockets, &extremes.chains)
    }

    /// Ratings of the chains, beside the loads of the run.
    pub fn ratings(&self) -> Vec<Rating> {
        self.carried().iter().map(Rating::of).collect()
    }

    /// Greatest frequency at which rollers seat on a sprocket, in the mean over the run \[Hz\].
    pub fn mesh_frequency(&self) -> f64 {
        self.bodies().mesh_frequency()
    }
}
