//! The accepted state and the one before it.

use std::mem::swap;

use serde::{Deserialize, Serialize};

use crate::dense::{Interpolation, Interval};
use crate::{Array, IntegrationError, Moment, SecondOrderSystem};

/// The accepted state, with the interval that led to it.
///
/// Fields are open for reading and for setting up a run. [`Method::start`](crate::Method::start) fills in the rest;
/// change a state between steps and it has to be started again.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Time t \[s\].
    pub t: f64,
    /// Positions q `(dofs)`.
    pub q: Array,
    /// Velocities q̇ `(dofs)`.
    pub v: Array,
    /// First-order states z `(states)`.
    pub z: Array,
    /// Accelerations q̈ `(dofs)` the next step begins with; Verlet's are those at the predicted velocities.
    pub a: Array,
    /// Quantities integrated along with the motion `(quadratures)`.
    pub quadratures: Array,
    /// Rates of the quadratures, and of the states after them, the next step begins with.
    pub(crate) rates: Array,
    /// The accepted state before this one.
    pub(crate) previous: Snapshot,
    /// Accelerations and rates at the end of the last step, if a jump has replaced them.
    pub(crate) before_jump: (Array, Array),
    /// Whether a jump has replaced them.
    pub(crate) jumped: bool,
    /// Interpolation between the accepted states, as the method wants it.
    pub(crate) interpolation: Interpolation,
}

/// Buffers of one state: a candidate, or the accepted state before the present one.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Snapshot {
    pub(crate) t: f64,
    pub(crate) q: Array,
    pub(crate) v: Array,
    pub(crate) z: Array,
    pub(crate) a: Array,
    pub(crate) quadratures: Array,
    pub(crate) rates: Array,
}

impl Snapshot {
    pub(crate) fn new(size: Size) -> Self {
        let Size {
            dofs,
            quadratures,
            states,
        } = size;
        Self {
            t: 0.0,
            q: Array::zeros(dofs),
            v: Array::zeros(dofs),
            z: Array::zeros(states),
            a: Array::zeros(dofs),
            quadratures: Array::zeros(quadratures),
            rates: Array::zeros(quadratures + states),
        }
    }

    /// Evaluates the system at the candidate.
    pub(crate) fn evaluate<S: SecondOrderSystem>(&mut self, system: &S, record: &mut S::Record) {
        let Self {
            t,
            q,
            v,
            z,
            a,
            rates,
            ..
        } = self;
        let at = Moment { t: *t, q, v, z };
        system.evaluate(at, a, rates, record);
    }

    /// Rates ż of the states.
    pub(crate) fn flow(&self) -> &[f64] {
        &self.rates[self.quadratures.len()..]
    }

    /// Quadratures of a candidate h \[s\] after a state, by the trapezoidal rule.
    pub(crate) fn trapezoidal(&mut self, from: &State, h: f64) {
        for (i, y) in self.quadratures.iter_mut().enumerate() {
            // y⁺ = y + ½ h (r + r⁺)
            *y = from.quadratures[i] + 0.5 * h * (from.rates[i] + self.rates[i]);
        }
    }
}

/// Numbers of coordinates, states and quadratures.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Size {
    pub(crate) dofs: usize,
    pub(crate) quadratures: usize,
    pub(crate) states: usize,
}

impl Size {
    pub(crate) fn of<S: SecondOrderSystem>(system: &S) -> Self {
        Self {
            dofs: system.dofs(),
            quadratures: system.quadratures(),
            states: system.states(),
        }
    }
}

impl State {
    /// A state at time t \[s\] with positions and velocities `(dofs)`.
    pub fn new(t: f64, q: Vec<f64>, v: Vec<f64>) -> Self {
        Self {
            t,
            q: q.into(),
            v: v.into(),
            ..Self::default()
        }
    }

    /// The same with first-order states z `(states)`.
    #[must_use]
    pub fn with_states(self, z: Vec<f64>) -> Self {
        Self {
            z: z.into(),
            ..self
        }
    }

    /// Rates ż of the states.
    pub(crate) fn flow(&self) -> &[f64] {
        &self.rates[self.quadratures.len()..]
    }

    /// Beginning and end \[s\] of the interval [`at`](Self::at) covers: the last accepted step.
    pub fn interval(&self) -> (f64, f64) {
        (self.previous.t, self.t)
    }

    /// Positions and velocities `(dofs)` at a time \[s\] within the last accepted step.
    ///
    /// ```text
    /// q(t) = the polynomial of fifth degree with q, q̇ and q̈ of both ends;  v = dq/dt
    /// ```
    ///
    /// Position to sixth order in the step for a smooth motion and at least to the order of the method.
    /// Implicit methods leave the accelerations out, since a stiff mode they damp is not resolved:
    /// generalized-α is read by the cubic with q and q̇ of both ends, implicit damping by straight lines, q and q̇ each
    /// by its own, since its q̇ is the mean of the step before and makes any curve through both overshoot.
    /// Times outside the [`interval`](Self::interval) are taken to its nearer end.
    pub fn at(&self, t: f64, q: &mut [f64], v: &mut [f64]) {
        let past = &self.previous;
        let a = if self.jumped {
            &self.before_jump.0
        } else {
            &self.a
        };
        let interval = Interval::new(past.t, self.t, t);
        let weights = self.interpolation.weights(interval);
        // Rows of one length: the compiler drops the checks of places, and takes several coordinates at a time.
        let n = self.q.len();
        let ends = [&past.q, &self.q, &past.v, &self.v, &past.a, a].map(|row| &row[..n]);
        let (q, v) = (&mut q[..n], &mut v[..n]);
        for i in 0..n {
            (q[i], v[i]) = weights.apply(ends.map(|row| row[i]));
        }
    }

    /// Quadratures at a time \[s\] within the last accepted step.
    ///
    /// ```text
    /// the cubic with value and rate of both ends
    /// ```
    pub fn quadratures_at(&self, t: f64, quadratures: &mut [f64]) {
        let ends = [&self.previous.quadratures, &self.quadratures];
        self.along(t, ends, 0, quadratures);
    }

    /// First-order states z `(states)` at a time \[s\] within the last accepted step, read as quadratures are.
    pub fn states_at(&self, t: f64, z: &mut [f64]) {
        let ends = [&self.previous.z, &self.z];
        self.along(t, ends, self.quadratures.len(), z);
    }

    /// Cubics through the values at both ends; their rates stand from `first` on.
    fn along(&self, t: f64, [from, to]: [&Array; 2], first: usize, values: &mut [f64]) {
        let past = &self.previous;
        let rates = if self.jumped {
            &self.before_jump.1
        } else {
            &self.rates
        };
        let interval = Interval::new(past.t, self.t, t);
        for (i, value) in values.iter_mut().enumerate() {
            let [before, after] = [past.rates[first + i], rates[first + i]];
            *value = interval.cubic(from[i], to[i], before, after);
        }
    }

    /// Brings all buffers to the size of the system.
    pub(crate) fn fit<S: SecondOrderSystem>(&mut self, system: &S) -> Result<(), IntegrationError> {
        let Size {
            dofs,
            quadratures,
            states,
        } = Size::of(system);
        if self.quadratures.is_empty() {
            self.quadratures.resize(quadratures, 0.0);
        }
        self.check(system)?;
        self.a.resize(dofs, 0.0);
        self.rates.resize(quadratures + states, 0.0);
        self.before_jump = (Array::zeros(dofs), Array::zeros(quadratures + states));
        self.jumped = false;
        Ok(())
    }

    /// Refuses a state that is not of the system's size.
    pub(crate) fn check<S: SecondOrderSystem>(&self, system: &S) -> Result<(), IntegrationError> {
        let Size {
            dofs,
            quadratures,
            states,
        } = Size::of(system);
        for (what, found, expected) in [
            ("positions", self.q.len(), dofs),
            ("velocities", self.v.len(), dofs),
            ("quadratures", self.quadratures.len(), quadratures),
            ("first-order states", self.z.len(), states),
        ] {
            if found != expected {
                return Err(IntegrationError::Shape {
                    what,
                    found,
                    expected,
                });
            }
        }
        Ok(())
    }

    /// Makes the present state its own predecessor: the interval has no length.
    pub(crate) fn forget(&mut self) {
        self.previous = Snapshot {
            t: self.t,
            q: self.q.clone(),
            v: self.v.clone(),
            z: self.z.clone(),
            a: self.a.clone(),
            quadratures: self.quadratures.clone(),
            rates: self.rates.clone(),
        };
        self.jumped = false;
    }

    /// Makes a candidate the present state and the present one the previous; buffers change hands, nothing is copied.
    pub(crate) fn accept(&mut self, candidate: &mut Snapshot) {
        swap(&mut self.previous, candidate);
        // The candidate now waits in `previous`; exchange it with the present state.
        let past = &mut self.previous;
        swap(&mut self.t, &mut past.t);
        swap(&mut self.q, &mut past.q);
        swap(&mut self.v, &mut past.v);
        swap(&mut self.z, &mut past.z);
        swap(&mut self.a, &mut past.a);
        swap(&mut self.quadratures, &mut past.quadratures);
        swap(&mut self.rates, &mut past.rates);
        self.jumped = false;
    }

    /// Keeps the accelerations of the step's end for interpolation and makes room for fresh ones.
    pub(crate) fn jump(&mut self) {
        if self.jumped {
            // What led here is kept already.
            return;
        }
        swap(&mut self.a, &mut self.before_jump.0);
        swap(&mut self.rates, &mut self.before_jump.1);
        self.jumped = true;
    }
}
