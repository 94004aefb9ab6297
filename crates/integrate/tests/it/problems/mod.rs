//! Problems with known solutions, shared by the tests of this crate.
#![allow(dead_code, reason = "every test uses some of the problems")]

pub(crate) mod bounce;
pub(crate) mod leaking;

use chaindrive_integrate::{Method, Moment, SecondOrderSystem, State, Weights};

/// A smooth motion whose end is known.
pub(crate) trait Smooth: SecondOrderSystem + Clone {
    fn start(&self) -> State;
    /// Duration of the test \[s\].
    fn duration(&self) -> f64;
    /// Positions at a time \[s\], from a closed form, or none.
    fn exact(&self, t: f64) -> Option<Vec<f64>>;
}

/// Steps of equal length, whatever the method does by nature.
pub(crate) fn fixed(method: Method, step: f64) -> Method {
    match method {
        Method::Verlet { .. } => Method::Verlet { step },
        Method::Rk4 { .. } => Method::Rk4 { step },
        Method::DormandPrince { .. } => Method::DormandPrince {
            relative: 0.0,
            absolute: f64::INFINITY,
            absolute_rate: f64::INFINITY,
            max_step: step,
        },
        Method::ImplicitDamping { .. } => Method::ImplicitDamping { step },
        Method::GeneralizedAlpha {
            spectral_radius, ..
        } => Method::GeneralizedAlpha {
            step,
            spectral_radius,
        },
    }
}

/// Every method, explicit and implicit.
pub(crate) fn all_methods(step: f64) -> Vec<Method> {
    let explicit = Method::specimens(step).into_iter();
    explicit.chain(Method::implicit_specimens(step)).collect()
}

/// The states at eight instants of a run in a number of equal steps.
pub(crate) fn run<P: Smooth>(problem: &P, method: Method, steps: u32) -> Vec<State> {
    let mut system = problem.clone();
    let mut state = problem.start();
    let step = problem.duration() / f64::from(steps);
    let mut stepper = fixed(method, step)
        .start(&mut system, &mut state)
        .expect("starts");
    let mut states = Vec::new();
    for n in 1..=steps {
        stepper.advance(&mut system, &mut state).expect("advances");
        if n % (steps / 8) == 0 {
            states.push(state.clone());
        }
    }
    states
}

/// x'' = −x, with the work of a fictitious damper as quadrature.
#[derive(Clone)]
pub(crate) struct Oscillator;

impl SecondOrderSystem for Oscillator {
    type Record = ();
    fn new_record(&self) {}
    fn dofs(&self) -> usize {
        1
    }
    fn evaluate(&self, at: Moment<'_>, a: &mut [f64], _: &mut [f64], (): &mut ()) {
        a[0] = -at.q[0];
    }
    fn time_scale(&self) -> f64 {
        1.0
    }
    fn can_solve(&self) -> bool {
        true
    }
    fn solve(&self, weights: Weights, (): &mut (), x: &mut [f64]) -> bool {
        x[0] /= 1.0 + weights.stiffness;
        true
    }
}

impl Smooth for Oscillator {
    fn start(&self) -> State {
        State::new(0.0, vec![1.0], vec![0.5])
    }
    fn duration(&self) -> f64 {
        5.0
    }
    fn exact(&self, t: f64) -> Option<Vec<f64>> {
        Some(vec![t.cos() + 0.5 * t.sin()])
    }
}

/// Two bodies, eccentricity 0.3, from perihelion.
#[derive(Clone)]
pub(crate) struct Kepler;

impl Kepler {
    pub(crate) const ECCENTRICITY: f64 = 0.3;

    pub(crate) fn energy(state: &State) -> f64 {
        let (q, v) = (&state.q, &state.v);
        0.5 * (v[0] * v[0] + v[1] * v[1]) - 1.0 / q[0].hypot(q[1])
    }
}

impl SecondOrderSystem for Kepler {
    /// The matrix K, symmetric: xx, xy, yy.
    type Record = [f64; 3];
    fn new_record(&self) -> [f64; 3] {
        [0.0; 3]
    }
    fn dofs(&self) -> usize {
        2
    }
    fn evaluate(&self, at: Moment<'_>, a: &mut [f64], _: &mut [f64], stiffness: &mut [f64; 3]) {
        let (x, y) = (at.q[0], at.q[1]);
        let r = x.hypot(y);
        let cube = r.powi(3);
        a[0] = -x / cube;
        a[1] = -y / cube;
        // K = I/r³ − 3 q qᵀ/r⁵
        let fifth = cube * r * r;
        *stiffness = [
            1.0 / cube - 3.0 * x * x / fifth,
            -3.0 * x * y / fifth,
            1.0 / cube - 3.0 * y * y / fifth,
        ];
    }
    fn can_solve(&self) -> bool {
        true
    }
    fn solve(&self, weights: Weights, stiffness: &mut [f64; 3], b: &mut [f64]) -> bool {
        let [xx, xy, yy] = stiffness.map(|entry| weights.stiffness * entry);
        let (xx, yy) = (1.0 + xx, 1.0 + yy);
        let determinant = xx * yy - xy * xy;
        let x = (yy * b[0] - xy * b[1]) / determinant;
        b[1] = (xx * b[1] - xy * b[0]) / determinant;
        b[0] = x;
        true
    }
}

impl Smooth for Kepler {
    fn start(&self) -> State {
        let e = Self::ECCENTRICITY;
        let speed = ((1.0 + e) / (1.0 - e)).sqrt();
        State::new(0.0, vec![1.0 - e, 0.0], vec![0.0, speed])
    }
    fn duration(&self) -> f64 {
        4.0
    }
    fn exact(&self, t: f64) -> Option<Vec<f64>> {
        let e = Self::ECCENTRICITY;
        // Kepler's equation: E − e sin E = t
        let mut anomaly = t;
        for _ in 0..50 {
            anomaly -= (anomaly - e * anomaly.sin() - t) / (1.0 - e * anomaly.cos());
        }
        Some(vec![
            anomaly.cos() - e,
            (1.0 - e * e).sqrt() * anomaly.sin(),
        ])
    }
}

/// A driven pendulum with damping that grows with the speed; its quadratures balance its energy.
#[derive(Clone)]
pub(crate) struct Driven;

impl Driven {
    const DAMPING: f64 = 0.1;

    fn drive(t: f64) -> f64 {
        0.8 * (1.3 * t).cos()
    }

    /// Energy minus the work of the drive plus what the damper took; constant.
    pub(crate) fn ledger(state: &State) -> f64 {
        0.5 * state.v[0] * state.v[0] + 1.0 - state.q[0].cos() - state.quadratures[0]
            + state.quadratures[1]
    }
}

impl SecondOrderSystem for Driven {
    /// Damping C and stiffness K.
    type Record = (f64, f64);
    fn new_record(&self) -> (f64, f64) {
        (0.0, 0.0)
    }
    fn dofs(&self) -> usize {
        1
    }
    fn quadratures(&self) -> usize {
        2
    }
    fn evaluate(&self, at: Moment<'_>, a: &mut [f64], rates: &mut [f64], linear: &mut (f64, f64)) {
        let (q, v) = (at.q[0], at.v[0]);
        *linear = (Self::DAMPING * (1.0 + 3.0 * v * v), q.cos());
        let damping = Self::DAMPING * v * (1.0 + v * v);
        a[0] = -q.sin() - damping + Self::drive(at.t);
        rates[0] = Self::drive(at.t) * v;
        rates[1] = damping * v;
    }
    fn can_solve(&self) -> bool {
        true
    }
    fn solve(&self, weights: Weights, (c, k): &mut (f64, f64), x: &mut [f64]) -> bool {
        x[0] /= 1.0 + weights.damping * *c + weights.stiffness * *k;
        true
    }
}

impl Smooth for Driven {
    fn start(&self) -> State {
        State::new(0.0, vec![1.2], vec![0.3])
    }
    fn duration(&self) -> f64 {
        12.0
    }
    fn exact(&self, _: f64) -> Option<Vec<f64>> {
        None
    }
}
