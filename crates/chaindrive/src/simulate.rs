//! A drive in motion: step, read, set, sample.

mod ended_contacts;
mod live;
mod periods;
mod sample;
mod snapshot;
#[cfg(feature = "stores")]
mod step_many;
mod view;

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Duration;

use chaindrive_integrate::{Method, Moment, SecondOrderSystem, State, Statistics, Stepper};
use chaindrive_mechanics::{
    Assembled, ContactEvent, Energy, EventKinds, Flow, Impact, Observation, Record, Sights, System,
};

use crate::{Run, SimulationError};

/// A run in progress: ask it for one sample after the other.
///
/// Steps are chosen by the method alone; samples are interpolated between them, so recording
/// more or less does not change the motion. Whoever wants to look at any time of their own, or to act on the drive
/// while it moves, takes [`advance_to`](Self::advance_to) and [`set`](Self::set).
///
/// # Example
///
/// ```
/// use chaindrive::{Run, Scene, Simulation};
///
/// let drive = Scene::preset("spinning_ring")?.drive()?;
/// let run = Run { until: 0.01, every: 1e-3, ..Run::default() };
/// let mut simulation = Simulation::start(&drive, &run)?;
/// while let Some(sample) = simulation.next_sample()? {
///     assert!(sample.link_tension.iter().all(|tension| *tension > 0.0));
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Simulation {
    moving: Moving,
    /// Contacts that ended: handed out at the last reading, on the clock of the simulation, and since then, on that of the drive.
    ended: [Vec<ContactEvent>; 2],
    /// Impacts of rollers that came to a sprocket, likewise.
    struck: [Vec<Impact>; 2],
    /// Periods of the account that ended, and readings of the spans, likewise.
    periods: [Vec<Period>; 2],
    readings: [Vec<f64>; 2],
    /// Numbers in one of these readings.
    reading_length: usize,
    /// Where the last of the periods ended.
    period_end: PeriodEnd,
    /// The state before the last step, when that went beyond the time read: a change at that time begins from here.
    before: Option<Box<PreviousState>>,
    /// Samples that were taken before anybody asked for them.
    ahead: VecDeque<Box<Sample>>,
    /// Time of the last sample or reading \[s\].
    read: f64,
    assembled: Arc<Assembled>,
    until: f64,
    every: f64,
    /// Contacts that are logged.
    events: EventKinds,
    next: u64,
    observation: Observation,
    /// Readings that samples are made of.
    sights: Sights,
    record: Record,
    /// Coordinates, velocities, flows of energy and first-order states between steps.
    buffers: [Vec<f64>; 4],
    start_energy: Option<Energy>,
    stepping_time: f64,
}

/// Parts that a step changes.
#[derive(Clone, Debug)]
struct Moving {
    system: System,
    state: State,
    stepper: Stepper<System>,
}

impl Moving {
    fn step(&mut self) -> Result<(), SimulationError> {
        let step = self.system.advance(&mut self.stepper, &mut self.state);
        step.map(drop)
            .map_err(|error| SimulationError::stepping(error, &self.system))
    }
}

use live::Changes;
pub use live::Control;
pub(crate) use periods::PRESSED;
pub use periods::Period;
use periods::PeriodEnd;
pub(crate) use sample::Sample;
use snapshot::PreviousState;
pub use snapshot::{Snapshot, SnapshotError};
#[cfg(feature = "stores")]
pub use step_many::step_many;
pub use view::View;

/// Fastest that a chain may run at the start \[m/s\]: the speed of sound in steel.
///
/// Strain travels no faster. A chain beyond it would not know that it is pulled, and no step would ever end the run.
const FASTEST: f64 = 5000.0;

/// Refuses a chain faster than any force in it.
fn slow_enough(system: &System, state: &State) -> Result<(), SimulationError> {
    let fastest = system.fastest_roller(Moment {
        t: state.t,
        q: &state.q,
        v: &state.v,
        z: &state.z,
    });
    if fastest <= FASTEST {
        Ok(())
    } else {
        Err(SimulationError::TooFast {
            speed: fastest,
            fastest: FASTEST,
        })
    }
}

/// Steps between two looks at the clock.
const STEPS_PER_LOOK: usize = 64;

impl Simulation {
    /// Starts from a drive already assembled, and run in if it is to be.
    ///
    /// # Errors
    /// As [`Simulation::start`].
    pub fn from_assembled(assembled: Assembled, run: &Run) -> Result<Self, SimulationError> {
        run.check()?;
        let mut system = assembled.system.clone();
        let mut state = assembled.state();
        slow_enough(&system, &state)?;
        let method = run.method(&system);
        system.set_onset_depth(run.onset_depth);
        system.log_events(run.events);
        system.forget_impacts();
        system.watch(run.watched.then(|| periods::plan(&assembled, run)));
        // A run may be read at its very beginning.
        system.keep_forces_from(assembled.time);
        let stepper = method
            .start(&mut system, &mut state)
            .map_err(|error| SimulationError::starting(error, run.stepping))?;
        let (dofs, rollers) = (state.q.len(), system.rollers());
        let record = system.new_record();
        let reading_length = periods::reading_length(&system);
        let mut simulation = Self {
            buffers: [
                vec![0.0; dofs],
                vec![0.0; dofs],
                vec![0.0; Flow::ALL.len()],
                vec![0.0; state.z.len()],
            ],
            moving: Moving {
                system,
                state,
                stepper,
            },
            ended: Default::default(),
            struck: [(); 2].map(|()| Vec::with_capacity(rollers)),
            periods: Default::default(),
            readings: Default::default(),
            reading_length,
            period_end: PeriodEnd::default(),
            before: None,
            ahead: VecDeque::new(),
            read: assembled.time - assembled.zero,
            assembled: Arc::new(assembled),
            until: run.until,
            every: run.every,
            events: run.events,
            next: 0,
            observation: Observation::default(),
            sights: Sights::ALL,
            record,
            start_energy: None,
            stepping_time: 0.0,
        };
        simulation.open_account();
        Ok(simulation)
    }

    /// Advances to the next sample; `None` once the end is reached.
    ///
    /// # Errors
    /// [`SimulationError::Integration`] when the motion ceases to be finite. The samples taken
    /// so far stay valid.
    pub fn next_sample(&mut self) -> Result<Option<&Observation>, SimulationError> {
        // Counted, not summed: the thousandth sample is at 1000 Δt to the last bit.
        let time = self.next as f64 * self.every;
        if !self.has_sample(self.next) {
            return Ok(None);
        }
        if let Some(sample) = self.ahead.pop_front() {
            self.hand_out(*sample, time);
            return Ok(Some(&self.observation));
        }
        // Whoever has read beyond this sample cannot go back for it.
        if self.zero() + time < self.moving.state.interval().0 {
            return Err(SimulationError::Past {
                time,
                read: self.read,
            });
        }
        while !self.advance(Duration::MAX)? {}
        let sights = if self.is_at_last_sample() {
            Sights::ALL
        } else {
            self.sights
        };
        self.sample(sights, time);
        self.next += 1;
        Ok(Some(&self.observation))
    }

    /// Steps towards the next sample for at most about `budget` of wall time; tells whether the
    /// sample is reached, or the run at its end.
    ///
    /// For callers that look at something else in between, whatever the interval of the samples.
    ///
    /// # Errors
    /// As [`Simulation::next_sample`].
    pub fn advance(&mut self, budget: Duration) -> Result<bool, SimulationError> {
        if !self.ahead.is_empty() {
            return Ok(true);
        }
        let time = (self.next as f64 * self.every).min(self.until);
        self.step_towards(time, budget, Changes::None)
    }

    /// Goes on to another end \[s\], with samples at the same times.
    pub(crate) fn go_on_until(&mut self, until: f64) {
        self.until = until;
    }

    /// Has samples made of these readings alone, until others are named; contact forces, tensions of links and motions of bodies are always
    /// among them. The last sample of a run is read in full.
    pub(crate) fn sample_only(&mut self, sights: Sights) {
        self.sights = sights;
    }

    /// One sample is left at most.
    pub(crate) fn is_at_last_sample(&self) -> bool {
        !self.has_sample(self.next + 1)
    }

    /// Sample number k, counted from 0, lies within the record: k Δt ≤ end.
    fn has_sample(&self, number: u64) -> bool {
        number as f64 * self.every <= self.until * (1.0 + 1e-12)
    }

    /// Reads everything off the state at a time \[s\] within the last step.
    fn observe(&mut self, time: f64) {
        self.observe_some(Sights::ALL, time);
    }

    /// Reads these sights there.
    fn observe_some(&mut self, sights: Sights, time: f64) {
        self.read = time;
        let mut seen = std::mem::take(&mut self.observation);
        self.look_at(sights, &mut seen);
        self.observation = seen;
        if sights.has(Sights::ENERGIES) {
            self.start_energy.get_or_insert(self.observation.energy);
        }
    }

    /// Reads everything at the time of the last reading, where only [views](View) were read since.
    pub fn refresh(&mut self) {
        if self.observation.time.to_bits() != self.read.to_bits() {
            self.observe(self.read);
        }
    }

    /// Contacts that ended since the reading or sample before the last one, in the order of their
    /// ends; of the kinds that [`Run::events`] asks for.
    ///
    /// A reading leaves to the next one what ended in the step that came to its time: a change at this time may take the step back.
    pub fn events(&self) -> &[ContactEvent] {
        &self.ended[0]
    }

    /// Impacts of rollers that came to a sprocket, handed out as [`events`](Self::events) are.
    pub fn impacts(&self) -> &[Impact] {
        &self.struck[0]
    }

    /// Contacts that [`events`](Self::events) has not handed out: those that ended after the last
    /// reading or sample, and those that last, with an infinite end.
    pub fn outstanding_events(&self) -> Vec<ContactEvent> {
        let mut events = self.ended[1].clone();
        events.extend(self.moving.system.lasting_events());
        let zero = self.zero();
        for event in &mut events {
            ended_contacts::count_from(zero, event);
        }
        events
    }

    /// The last sample.
    pub fn observation(&self) -> &Observation {
        &self.observation
    }

    /// Energy unaccounted for at the last sample \[J\].
    pub fn energy_residual(&self) -> f64 {
        let start = self.start_energy.unwrap_or(self.observation.energy);
        self.observation.energy.residual(&start)
    }

    /// Share of the run that is done, 0 to 1.
    pub fn progress(&self) -> f64 {
        (self.time() / self.until).clamp(0.0, 1.0)
    }

    /// Time between two samples \[s\].
    pub fn every(&self) -> f64 {
        self.every
    }

    /// Time reached \[s\].
    pub fn time(&self) -> f64 {
        self.moving.state.t - self.zero()
    }

    /// Time \[s\] on the clock of the drive at which that of the simulation begins.
    fn zero(&self) -> f64 {
        self.assembled.zero
    }

    /// The drive at the end of the last step, open contacts included, as the start of another simulation.
    pub(crate) fn as_start(&self) -> Assembled {
        let Moving { system, state, .. } = &self.moving;
        let mut system = system.clone();
        system.watch(None);
        self.assembled.come_to(system, state)
    }

    /// The system in its present state.
    pub fn system(&self) -> &System {
        &self.moving.system
    }

    /// The assembled drive that the simulation began with.
    pub fn assembled(&self) -> &Assembled {
        &self.assembled
    }

    /// Counts of the time stepping.
    pub fn statistics(&self) -> &Statistics {
        self.moving.stepper.statistics()
    }

    /// The method with its step or tolerances.
    pub fn method(&self) -> Method {
        self.moving.stepper.method()
    }

    /// Counts wall time that was spent on the same run before.
    pub(crate) fn has_spent(&mut self, time: Duration) {
        self.stepping_time += time.as_secs_f64();
    }

    /// Energy at the first reading; none before it.
    pub(crate) fn start_energy(&self) -> Option<Energy> {
        self.start_energy
    }

    /// Wall time spent in stepping, sampling not counted \[s\].
    pub fn stepping_time(&self) -> f64 {
        self.stepping_time
    }
}
