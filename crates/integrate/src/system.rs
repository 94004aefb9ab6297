//! Questions that a system answers in order to be stepped through time.

/// Time and state at which an evaluation happens.
#[derive(Clone, Copy, Debug)]
pub struct Moment<'a> {
    /// Time t \[s\].
    pub t: f64,
    /// Positions q `(dofs)`.
    pub q: &'a [f64],
    /// Velocities q̇ `(dofs)`.
    pub v: &'a [f64],
    /// First-order states z `(states)`.
    pub z: &'a [f64],
}

impl<'a> Moment<'a> {
    /// A moment of a system without first-order states, or of which nobody asks for them.
    #[inline]
    pub fn stateless(t: f64, q: &'a [f64], v: &'a [f64]) -> Self {
        Self { t, q, v, z: &[] }
    }
}

/// Predicted velocities of a moment, for forces that look ahead.
///
/// ```text
/// v⁺ = v + ½ h (a⁺ − a),   v = v₀ + h a
/// z⁺ = z + ½ h (ż⁺ − ż),   z = z₀ + h ż
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Prediction<'a> {
    /// ½ h \[s\].
    pub half_step: f64,
    /// Accelerations at the beginning of the step `(dofs)`.
    pub a: &'a [f64],
    /// Rates of the states there `(states)`.
    pub flow: &'a [f64],
}

/// Weights of damping and stiffness in the matrix of an implicit step; first-order states have the weight of the damping.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights {
    /// Weight c of the damping \[s\].
    pub damping: f64,
    /// Weight k of the stiffness \[s²\].
    pub stiffness: f64,
    /// Whether one solution makes the whole step. Friction then takes the secant, so that no step carries a slip beyond zero; Newton's
    /// iteration wants the slope. Stiffness may be left out, which [`carried_time_scale`](SecondOrderSystem::carried_time_scale) has to
    /// know.
    pub once: bool,
}

/// Judgement on a candidate step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Verdict {
    /// The step may be taken.
    Accept,
    /// The step went too far.
    Retry {
        /// Estimate of the longest acceptable step \[s\].
        ///
        /// A hint: the next try is no longer than 0.9 of the last, from the third on no
        /// longer than half of it, and never below a thousandth of the nominal step, where every
        /// step is accepted. Anything that is not a positive number counts as zero.
        at_most: f64,
    },
}

/// Whether the accelerations of an accepted state survive its commit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Continuity {
    /// They do: the next step uses them as they are.
    Smooth,
    /// They do not: the next step begins with a fresh evaluation.
    Jump,
}

/// A system of second order with memory, and with states of first order where something flows, settles or controls.
///
/// ```text
/// q̈ = a(t, q, q̇, z; memory),   ż = f(t, q, q̇, z; memory)
/// ```
///
/// Memory is whatever the forces depend on besides t, q, q̇ and z: the speed at which a contact
/// began, the gap a roller sits in. It is constant during a step and advances in
/// [`commit`](Self::commit) only. Constraints, if any, are already satisfied by a.
pub trait SecondOrderSystem {
    /// Results of one evaluation for [`inspect`](Self::inspect) and [`commit`](Self::commit): work space, gaps and rates of contacts.
    type Record;

    /// A record large enough for every evaluation of this system.
    fn new_record(&self) -> Self::Record;

    /// Number of degrees of freedom.
    fn dofs(&self) -> usize;

    /// Number of scalar quantities integrated along with the motion, such as the work of a motor.
    fn quadratures(&self) -> usize {
        0
    }

    /// Number of first-order states z.
    ///
    /// Error control holds a state to the tolerance of a position: give it in a unit for which that makes sense.
    fn states(&self) -> usize {
        0
    }

    /// Accelerations a `(dofs)`, and the rates of the quadratures with those of the states after them
    /// `(quadratures + states)`, at a moment.
    ///
    /// Pure: called several times a step, on trial states too. Must write every entry of `a` and `rates`, and may
    /// leave anything in the record. Verlet asks with velocities and states predicted to first order.
    fn evaluate(&self, at: Moment<'_>, a: &mut [f64], rates: &mut [f64], record: &mut Self::Record);

    /// The same at the end of a step with velocities and states that are only predicted.
    ///
    /// A system may take stiff damping, and states that settle fast, at the velocities and states to which the new rates lead, as the
    /// implicit trapezoidal rule does: its steps are then limited by [`predicted_time_scale`](Self::predicted_time_scale) alone.
    fn evaluate_predicted(
        &self,
        at: Moment<'_>,
        prediction: Prediction<'_>,
        a: &mut [f64],
        rates: &mut [f64],
        record: &mut Self::Record,
    ) {
        let _ = prediction;
        self.evaluate(at, a, rates, record);
    }

    /// Judges a candidate step of size h \[s\] by the evaluation at its end.
    fn inspect(&self, h: f64, end: &Self::Record) -> Verdict {
        let _ = (h, end);
        Verdict::Accept
    }

    /// Takes an accepted state and the record of its evaluation.
    ///
    /// The only method that changes memory; it may swap with the record, and may project q and v. Called
    /// once for the initial state, then once after each accepted step, never for a rejected one. Values it writes must be
    /// finite; if they move the state by more than rounding the answer is [`Continuity::Jump`].
    fn commit(
        &mut self,
        t: f64,
        q: &mut [f64],
        v: &mut [f64],
        end: &mut Self::Record,
    ) -> Continuity {
        let _ = (t, q, v, end);
        Continuity::Smooth
    }

    /// Time \[s\] of the first event after t: where a given force or motion has a kink or a jump. A step lands there, and
    /// none goes beyond.
    ///
    /// Forces that jump need a [`commit`](Self::commit) there that answers [`Continuity::Jump`]. Asked at the start and
    /// after every event.
    fn next_event(&self, t: f64) -> f64 {
        let _ = t;
        f64::INFINITY
    }

    /// Time scale τ \[s\] of the fastest mode in the present state; infinity when unknown.
    ///
    /// ```text
    /// τ = 1/ω                    undamped mode of frequency ω
    /// τ = 1/(λ + √(λ² + ω²))     mode with damping λ = c/m
    /// ```
    ///
    /// h = 2τ is then the exact limit of Verlet, which lags the velocity and tolerates half the
    /// damping other methods do, and a safe one for Runge–Kutta. A state that settles as e^(−λt) counts like damping of that
    /// rate. Asked after each accepted step: keep it a field.
    fn time_scale(&self) -> f64 {
        f64::INFINITY
    }

    /// Time scale τ \[s\] of the fastest mode, without the damping and settling that
    /// [`evaluate_predicted`](Self::evaluate_predicted) takes at the end of a step.
    ///
    /// Asked after each accepted step: keep it a field.
    fn predicted_time_scale(&self) -> f64 {
        self.time_scale()
    }

    /// Time scale 1/ω \[s\] of the fastest mode without its damping, for methods that treat damping and states implicitly.
    ///
    /// Asked after each accepted step: keep it a field.
    fn undamped_time_scale(&self) -> f64 {
        self.time_scale()
    }

    /// Time scale \[s\] that limits steps of one solution: 1/ω of the fastest mode whose stiffness [`solve`](Self::solve) leaves out
    /// there, or a longer one that the system asks carried contacts to be resolved with.
    ///
    /// Asked after each accepted step: keep it a field.
    fn carried_time_scale(&self) -> f64 {
        self.undamped_time_scale()
    }

    /// Whether [`solve`](Self::solve) is there: implicit methods need it.
    fn can_solve(&self) -> bool {
        false
    }

    /// Solves the linear equations of an implicit step in place; false if there is no solution.
    ///
    /// ```text
    /// x ← (M + c C + k K)⁻¹ M x,   C = −∂f/∂q̇,   K = −∂f/∂q,   f = M a
    ///
    /// with states, whose right-hand sides y stand after those of the coordinates, x `(dofs + states)`:
    /// ⎡ M + c C + k K   −c ∂f/∂z     ⎤ ⎡x⎤   ⎡M x⎤
    /// ⎣ −c ∂ż/∂q̇ − k ∂ż/∂q   1 − c ∂ż/∂z ⎦ ⎣y⎦ ← ⎣ y ⎦
    /// ```
    ///
    /// `weights.once` tells that no iteration follows. C and K are those at the moment `record` was last evaluated at. Work space and factors may be
    /// kept in the record; what [`inspect`](Self::inspect) and [`commit`](Self::commit) read there must stay, and a
    /// commit that swaps with the record must leave C and K in it. Approximate C and K are allowed: Newton's
    /// iteration then converges more slowly.
    fn solve(&self, weights: Weights, record: &mut Self::Record, x: &mut [f64]) -> bool {
        let _ = (weights, record, x);
        false
    }

    /// Adds to the quadratures what the forces that [`solve`](Self::solve) has just added do in the step of one solution that it makes.
    ///
    /// ```text
    /// f − (c C + k K) Δv/h      over the step, where an evaluation knows of f only
    /// ```
    ///
    /// What moves by itself bears these forces in its motion. What is moved bears them too: its work and its impulses are theirs as well.
    fn add_solved(&self, record: &Self::Record, quadratures: &mut [f64]) {
        let _ = (record, quadratures);
    }
}
