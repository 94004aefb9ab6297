//! The loop: step, sample, stop.

use std::time::{Duration, Instant};

use chaindrive_integrate::{Method, Moment, SecondOrderSystem, State, Statistics, Stepper};
use chaindrive_mechanics::{Assembled, ContactEvent, Drive, Energy, Observation, Record, System};

use crate::SimulationError;
use crate::run::Run;

/// A run in progress: ask it for one sample after the other.
///
/// Steps are chosen by the method alone; samples are interpolated between them, so recording
/// more or less does not change the motion.
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
#[derive(Debug)]
pub struct Simulation {
    system: System,
    state: State,
    stepper: Stepper<System>,
    assembled: Assembled,
    until: f64,
    every: f64,
    next: u64,
    observation: Observation,
    record: Record,
    buffers: [Vec<f64>; 3],
    start_energy: Option<Energy>,
    /// Contacts that ended before the last sample, and since then.
    ended: [Vec<ContactEvent>; 2],
    stepping_time: f64,
}

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
    /// Assembles the drive and starts the clock at t = 0.
    ///
    /// # Errors
    /// [`SimulationError`] when the drive does not assemble, a setting is out of range, the method is
    /// not for this chain, or the step asked for is unstable.
    pub fn start(drive: &Drive, run: &Run) -> Result<Self, SimulationError> {
        run.check()?;
        Self::from_assembled(drive.assemble()?, run)
    }

    /// Starts from a drive already assembled.
    ///
    /// # Errors
    /// As [`Simulation::start`].
    pub fn from_assembled(assembled: Assembled, run: &Run) -> Result<Self, SimulationError> {
        run.check()?;
        let mut system = assembled.system.clone();
        let mut state = State::new(0.0, assembled.q.clone(), assembled.v.clone());
        slow_enough(&system, &state)?;
        let method = run.method(&system);
        system.set_onset_depth(run.onset_depth_with(&method));
        system.log_events(run.events);
        let stepper = method
            .start(&mut system, &mut state)
            .map_err(|error| SimulationError::starting(error, run))?;
        let dofs = state.q.len();
        let record = system.new_record();
        Ok(Self {
            buffers: [
                vec![0.0; dofs],
                vec![0.0; dofs],
                vec![0.0; state.quadratures.len()],
            ],
            system,
            state,
            stepper,
            assembled,
            until: run.until,
            every: run.every,
            next: 0,
            observation: Observation::default(),
            record,
            start_energy: None,
            ended: [Vec::new(), Vec::new()],
            stepping_time: 0.0,
        })
    }

    /// Advances to the next sample; `None` once the end is reached.
    ///
    /// # Errors
    /// [`SimulationError::Integration`] when the motion ceases to be finite. The samples taken
    /// so far stay valid.
    pub fn next_sample(&mut self) -> Result<Option<&Observation>, SimulationError> {
        // Counted, not summed: the thousandth sample is at 1000 Δt to the last bit.
        let time = self.next as f64 * self.every;
        if time > self.until * (1.0 + 1e-12) {
            return Ok(None);
        }
        while !self.advance(Duration::MAX)? {}
        self.sample(time);
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
        let time = (self.next as f64 * self.every).min(self.until);
        let begin = Instant::now();
        while self.state.t < time && begin.elapsed() < budget {
            for _ in 0..STEPS_PER_LOOK {
                if self.state.t >= time {
                    break;
                }
                self.stepper
                    .advance(&mut self.system, &mut self.state)
                    .map_err(|error| SimulationError::stepping(error, &self.system))?;
            }
        }
        self.stepping_time += begin.elapsed().as_secs_f64();
        self.ended[1].append(&mut self.system.take_events());
        Ok(self.state.t >= time)
    }

    fn sample(&mut self, time: f64) {
        let [q, v, flows] = &mut self.buffers;
        self.state.at(time, q, v);
        self.state.quadratures_at(time, flows);
        let at = Moment { t: time, q, v };
        self.system
            .observe(at, flows, &mut self.record, &mut self.observation);
        self.start_energy.get_or_insert(self.observation.energy);
        self.ended.swap(0, 1);
        self.ended[1].clear();
    }

    /// Contacts that ended between the sample before the last and the last one, in the order of their
    /// ends; of the kinds that [`Run::events`] asks for.
    pub fn events(&self) -> &[ContactEvent] {
        &self.ended[0]
    }

    /// Contacts that [`events`](Self::events) has not handed out: those that ended after the last
    /// sample, and those that last, with an infinite end.
    pub fn outstanding_events(&self) -> Vec<ContactEvent> {
        let mut events = self.ended[1].clone();
        events.extend(self.system.lasting_events());
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
        (self.state.t / self.until).clamp(0.0, 1.0)
    }

    /// Time reached \[s\].
    pub fn time(&self) -> f64 {
        self.state.t
    }

    /// The system in its present state.
    pub fn system(&self) -> &System {
        &self.system
    }

    /// How the drive was assembled.
    pub fn assembled(&self) -> &Assembled {
        &self.assembled
    }

    /// Counts of the time stepping.
    pub fn statistics(&self) -> &Statistics {
        self.stepper.statistics()
    }

    /// The method with its step or tolerances.
    pub fn method(&self) -> Method {
        self.stepper.method()
    }

    /// Wall time spent in stepping, sampling not counted \[s\].
    pub fn stepping_time(&self) -> f64 {
        self.stepping_time
    }
}
