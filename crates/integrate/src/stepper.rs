//! One accepted step after the other: try, inspect, perhaps retry, commit.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::finite::Watch;
use crate::method::Kernel;
use crate::outcome::Outcome;
use crate::state::{Size, Snapshot, State};
use crate::step_size::{Controller, FLOOR, Fixed, first_step, shortened};
use crate::{
    Array, Continuity, InstructionSet, IntegrationError, Method, Moment, SecondOrderSystem,
    StateQuantity, Statistics, Verdict,
};

/// An accepted step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Time \[s\] it began.
    pub from: f64,
    /// Time \[s\] it ended.
    pub to: f64,
    /// Candidates rejected on the way, by the system or by the error control.
    pub rejections: u32,
}

/// Carries a state of one system forward. Made by [`Method::start`].
pub struct Stepper<S: SecondOrderSystem> {
    method: Method,
    pub(crate) kernel: Kernel,
    pub(crate) pace: Pace,
    candidate: Snapshot,
    pub(crate) record: S::Record,
    pub(crate) statistics: Statistics,
    /// Time of the next event \[s\]: no step goes beyond.
    pub(crate) event: f64,
}

impl<S: SecondOrderSystem<Record: Clone>> Clone for Stepper<S> {
    fn clone(&self) -> Self {
        Self {
            kernel: self.kernel.clone(),
            candidate: self.candidate.clone(),
            record: self.record.clone(),
            ..*self
        }
    }
}

impl<S: SecondOrderSystem> fmt::Debug for Stepper<S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Stepper")
            .field("method", &self.method)
            .field("pace", &self.pace)
            .field("statistics", &self.statistics)
            .finish_non_exhaustive()
    }
}

impl Method {
    /// Starts a run: evaluates the accelerations of the state and commits it.
    ///
    /// # Errors
    /// A parameter out of range, an implicit method for a system that cannot solve, a state of the wrong shape, a
    /// step above [`longest_step`](Self::longest_step), accelerations that are not finite, or an instruction set asked for in vain
    /// ([`InstructionSet::in_use`]).
    pub fn start<S: SecondOrderSystem>(
        &self,
        system: &mut S,
        state: &mut State,
    ) -> Result<Stepper<S>, IntegrationError> {
        self.check()?;
        InstructionSet::in_use()?;
        if self.is_implicit() && !system.can_solve() {
            let method = self.name();
            return Err(IntegrationError::Unsupported { method });
        }
        Stepper::start(*self, system, state)
    }
}

/// Control of the step length.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) enum Pace {
    Fixed(Fixed),
    Controlled(Controller),
}

/// Share of the longest step below which an adaptive method gives up.
const LEAST_SHARE: f64 = 1e-12;

impl<S: SecondOrderSystem> Stepper<S> {
    /// See [`Method::start`].
    pub(crate) fn start(
        method: Method,
        system: &mut S,
        state: &mut State,
    ) -> Result<Self, IntegrationError> {
        state.fit(system)?;
        let size = Size::of(system);
        let mut stepper = Self {
            method,
            kernel: method.kernel(size),
            pace: Pace::Fixed(Fixed::new(0.0)),
            candidate: Snapshot::new(size),
            record: system.new_record(),
            statistics: Statistics::default(),
            event: f64::INFINITY,
        };
        stepper.evaluate(system, state)?;
        let State { t, q, v, .. } = state;
        if system.commit(*t, q, v, &mut stepper.record) == Continuity::Jump {
            stepper.statistics.jumps += 1;
            stepper.evaluate(system, state)?;
        }
        state.forget();
        state.interpolation = method.interpolation();
        stepper.kernel.restart(state);
        stepper.pace = first_pace(method, method.time_scale(system), state)?;
        stepper.look_ahead(system, state);
        Ok(stepper)
    }

    /// Takes one step: on return the state is the accepted one and the system has committed it.
    ///
    /// The end of the step is the method's choice; sample in between with [`State::at`].
    ///
    /// # Errors
    /// [`IntegrationError::NotFinite`] if the motion or a force ceases to be a number,
    /// [`IntegrationError::StepUnderflow`] if stability or accuracy ask for vanishing steps, or if an implicit step cannot
    /// be solved even with a thousandth of the nominal length. State and system stay at the last accepted state; the run cannot go on.
    pub fn advance(&mut self, system: &mut S, state: &mut State) -> Result<Step, IntegrationError> {
        let from = state.t;
        let nominal = self.next_step();
        // The clock cannot tell an event that is nearer than its last places.
        let left = self.event - from;
        let floor = FLOOR * nominal;
        let longest = match &self.pace {
            Pace::Fixed(_) => 0.0,
            Pace::Controlled(controller) => controller.max_step,
        };
        let least = (4.0 * f64::EPSILON * from.abs()).max(LEAST_SHARE * longest);
        // As long as the method wants, but not beyond the next event.
        let (mut h, mut rejections, mut retries, mut cut_short) =
            (nominal.min(left), 0, 0, left < nominal);
        let error = loop {
            // Below this the clock would stand still, or the end never come into sight.
            if h <= least && h < left {
                return Err(IntegrationError::StepUnderflow { t: from, step: h });
            }
            // The record of the accepted state survives until the first candidate.
            let fresh = rejections == 0;
            // A candidate whose equations were not solved is tried again with half the step.
            let Some(error) = self.attempt(system, state, h, fresh)? else {
                if h <= floor * (1.0 + 1e-9) {
                    return Err(IntegrationError::StepUnderflow { t: from, step: h });
                }
                h = (0.5 * h).max(floor);
                rejections += 1;
                cut_short = true;
                continue;
            };
            // One whose error is too large with what the control proposes.
            if error > 1.0 {
                rejections += 1;
                self.statistics.error_rejections += 1;
                if let Pace::Controlled(controller) = &mut self.pace {
                    h = controller.rejected(h, error);
                }
                continue;
            }
            // One that the system refuses, as a contact that begins too deep, with what that asks for.
            match system.inspect(h, &self.record) {
                Verdict::Retry { at_most } if h > floor * (1.0 + 1e-9) => {
                    h = shortened(h, at_most, retries, floor);
                    retries += 1;
                    rejections += 1;
                    cut_short = true;
                    self.statistics.rejections += 1;
                }
                Verdict::Accept | Verdict::Retry { .. } => break error,
            }
        };
        if let Pace::Controlled(controller) = &mut self.pace {
            controller.accepted(h, error, cut_short);
        }
        self.accept(system, state, h)?;
        Ok(Step {
            from,
            to: state.t,
            rejections,
        })
    }

    /// Length \[s\] that the next step has at most.
    pub fn next_step(&self) -> f64 {
        match &self.pace {
            Pace::Fixed(fixed) => fixed.step(),
            Pace::Controlled(controller) => controller.proposal,
        }
    }

    /// Asks the system for its next event, after somebody has planned one.
    pub fn look_ahead(&mut self, system: &S, state: &State) {
        self.event = system.next_event(state.t + slack(state.t));
    }

    /// Takes note that forces jump at the present state: the next step begins with what they are from now on.
    ///
    /// # Errors
    /// [`IntegrationError::NotFinite`].
    pub fn jump(&mut self, system: &S, state: &mut State) -> Result<(), IntegrationError> {
        self.statistics.jumps += 1;
        state.jump();
        self.evaluate(system, state)?;
        self.kernel.restart(state);
        if let Pace::Controlled(controller) = &mut self.pace {
            controller.jumped();
        }
        Ok(())
    }

    /// Counts so far.
    pub fn statistics(&self) -> &Statistics {
        &self.statistics
    }

    /// The method at work.
    pub fn method(&self) -> Method {
        self.method
    }

    /// Makes a candidate; returns its error in units of the tolerance, zero without error control, or nothing if
    /// the equations of the step were not solved. `fresh`: the record belongs to the accepted state.
    fn attempt(
        &mut self,
        system: &S,
        state: &State,
        h: f64,
        fresh: bool,
    ) -> Result<Option<f64>, IntegrationError> {
        let (to, record) = (&mut self.candidate, &mut self.record);
        let counts = &mut self.statistics;
        let outcome = match &mut self.kernel {
            Kernel::Verlet(kernel) => {
                counts.evaluations += 1;
                Outcome::of(kernel.attempt(system, state, h, to, record))
            }
            Kernel::RungeKutta(kernel) => {
                counts.evaluations += kernel.cost();
                Outcome::of(kernel.attempt(system, state, h, to, record))
            }
            Kernel::ImplicitDamping(kernel) => {
                kernel.attempt(system, state, h, fresh, to, record, counts)
            }
            Kernel::GeneralizedAlpha(kernel) => {
                kernel.attempt(system, state, h, to, record, counts)
            }
        };
        match outcome {
            Outcome::Done => {}
            Outcome::NotFinite => return Err(culprit(to)),
            Outcome::NoSolution => {
                counts.newton_failures += 1;
                return Ok(None);
            }
        }
        Ok(Some(match (&self.kernel, &self.pace) {
            (Kernel::RungeKutta(kernel), Pace::Controlled(controller)) => {
                kernel.error(state, h, to, controller.tolerance)
            }
            _ => 0.0,
        }))
    }

    /// Makes the candidate the state, commits it, and looks at the stability of what comes next.
    fn accept(
        &mut self,
        system: &mut S,
        state: &mut State,
        h: f64,
    ) -> Result<(), IntegrationError> {
        state.accept(&mut self.candidate);
        self.kernel.accept();
        self.statistics.accept(h);
        let State { t, q, v, .. } = &mut *state;
        if system.commit(*t, q, v, &mut self.record) == Continuity::Jump {
            self.jump(system, state)?;
        }
        if state.t + slack(state.t) >= self.event {
            self.look_ahead(system, state);
        }
        // What was committed may be stiffer than before: a fixed step that is no longer stable is shortened.
        if let Pace::Fixed(fixed) = &mut self.pace {
            let limit = self.method.longest_step(self.method.time_scale(system));
            let Some(shortened) = fixed.adapt(limit) else {
                let (t, step) = (state.t, fixed.step());
                return Err(IntegrationError::StepUnderflow { t, step });
            };
            self.statistics.reductions += u64::from(shortened);
        }
        Ok(())
    }

    /// Accelerations and rates of the state itself.
    fn evaluate(&mut self, system: &S, state: &mut State) -> Result<(), IntegrationError> {
        let at = Moment {
            t: state.t,
            q: &state.q,
            v: &state.v,
            z: &state.z,
        };
        system.evaluate(at, &mut state.a, &mut state.rates, &mut self.record);
        self.statistics.evaluations += 1;
        let parts = [&state.q, &state.v, &state.a, &state.rates, &state.z];
        // A state that is not finite is told at once, with the first number that is not.
        let mut watch = Watch::default();
        for part in parts {
            watch.see_all(part);
        }
        if watch.all_finite() {
            Ok(())
        } else {
            Err(first_not_finite(state.t, parts))
        }
    }
}

/// Times \[s\] that are the same to the clock at t: a few last places.
pub fn slack(t: f64) -> f64 {
    8.0 * f64::EPSILON * t.abs()
}

/// The pace a run begins with.
fn first_pace(method: Method, time_scale: f64, state: &State) -> Result<Pace, IntegrationError> {
    let step = method.step();
    match method.tolerances() {
        None => {
            let limit = method.longest_step(time_scale);
            if step <= limit {
                Ok(Pace::Fixed(Fixed::new(step)))
            } else {
                let method = method.name();
                Err(IntegrationError::StepTooLarge {
                    step,
                    limit,
                    method,
                })
            }
        }
        Some(tolerance) => {
            let longest = step.min(time_scale);
            let first = first_step(tolerance, longest, state);
            let order = method.order();
            let controller = Controller::new(tolerance, step, first, order);
            Ok(Pace::Controlled(controller))
        }
    }
}

/// Names the first degree of freedom of a candidate that is not finite; accelerations first, since they infect the rest.
fn culprit(candidate: &Snapshot) -> IntegrationError {
    let Snapshot {
        t,
        q,
        v,
        z,
        a,
        quadratures,
        ..
    } = candidate;
    first_not_finite(*t, [q, v, a, quadratures, z])
}

/// Names the first entry that is not finite of positions, velocities, accelerations, quadratures and states.
fn first_not_finite(t: f64, [q, v, a, quadratures, z]: [&Array; 5]) -> IntegrationError {
    let parts = [
        (StateQuantity::Acceleration, a),
        (StateQuantity::Position, q),
        (StateQuantity::Velocity, v),
        (StateQuantity::State, z),
        (StateQuantity::Quadrature, quadratures),
    ];
    let found = parts.into_iter().find_map(|(quantity, part)| {
        let dof = part.iter().position(|value| !value.is_finite())?;
        Some((quantity, dof))
    });
    let (quantity, dof) = found.unwrap_or((StateQuantity::Velocity, 0));
    IntegrationError::NotFinite { t, dof, quantity }
}
