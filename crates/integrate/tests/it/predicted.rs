//! Damping and states that a system takes at the end of a step for which they were predicted.
#![allow(clippy::print_stdout, reason = "measured orders are worth a look")]

use chaindrive_integrate::{
    IntegrationError, Method, Moment, Prediction, SecondOrderSystem, State, Step,
};

/// A mass on a spring, with a damper whose force is known for every velocity, and a state that follows the mass.
///
/// ```text
/// q̈ = −q − λ q̇,   ż = κ (q − z)
/// ```
struct Mass {
    /// λ \[1/s\].
    damping: f64,
    /// κ \[1/s\].
    settling: f64,
    /// Part of the damping and settling that it does not reckon with: others may press as well.
    caution: f64,
}

impl Mass {
    fn run(&mut self, step: f64, until: f64) -> Result<Vec<State>, IntegrationError> {
        let mut state = State::new(0.0, vec![1.0], vec![0.0]);
        state.z = vec![1.0].into();
        let mut stepper = Method::Verlet { step }.start(self, &mut state)?;
        let mut states = vec![state.clone()];
        while state.t < until - 0.5 * step {
            let Step { .. } = stepper.advance(self, &mut state)?;
            states.push(state.clone());
        }
        Ok(states)
    }
}

impl SecondOrderSystem for Mass {
    type Record = ();
    fn new_record(&self) {}
    fn dofs(&self) -> usize {
        1
    }
    fn states(&self) -> usize {
        1
    }
    fn quadratures(&self) -> usize {
        1
    }
    fn evaluate(&self, at: Moment<'_>, a: &mut [f64], rates: &mut [f64], (): &mut ()) {
        let (q, v) = (at.q[0], at.v[0]);
        a[0] = -q - self.damping * v;
        rates[0] = self.damping * v * v;
        rates[1] = self.settling * (q - at.z[0]);
    }
    fn evaluate_predicted(
        &self,
        at: Moment<'_>,
        prediction: Prediction<'_>,
        a: &mut [f64],
        rates: &mut [f64],
        record: &mut (),
    ) {
        self.evaluate(at, a, rates, record);
        // ẋ⁺ = ẋ₀ + (ẋ − ẋ₀)/(1 + ½ h λ): x⁺ = x + ½ h (ẋ⁺ − ẋ₀) follows
        let half = prediction.half_step;
        let ahead = |rate: f64, before: f64, damping: f64| {
            before + (rate - before) / (1.0 + half * self.caution * damping)
        };
        a[0] = ahead(a[0], prediction.a[0], self.damping);
        rates[1] = ahead(rates[1], prediction.flow[0], self.settling);
        let v = at.v[0] + half * (a[0] - prediction.a[0]);
        rates[0] = self.damping * v * v;
    }
    fn time_scale(&self) -> f64 {
        1.0 / (self.damping + self.damping.hypot(1.0)).max(self.settling)
    }
    fn predicted_time_scale(&self) -> f64 {
        1.0
    }
}

/// The last state of runs with `n` and 2 n steps errs by a quarter: second order, whatever the caution.
#[test]
fn of_second_order() {
    for caution in [1.0, 1.5] {
        let end = |n: u32| {
            let mut mass = Mass {
                damping: 2.5,
                settling: 3.0,
                caution,
            };
            let states = mass.run(4.0 / f64::from(n), 4.0).expect("runs");
            let last = states.last().expect("states").clone();
            [last.q[0], last.v[0], last.z[0], last.quadratures[0]]
        };
        let exact = end(50_000);
        let error = |n: u32| {
            let found = end(n);
            [0, 1, 2, 3].map(|k| (found[k] - exact[k]).abs())
        };
        let (coarse, fine) = (error(800), error(1600));
        for k in 0..4 {
            let order = (coarse[k] / fine[k]).log2();
            println!("caution {caution}, {k}: order {order:.3}");
            assert!(
                (order - 2.0).abs() < 0.15,
                "caution {caution}, {k}: {order}"
            );
        }
        // q(4) of q̈ + 2.5 q̇ + q = 0 from rest at 1: λ = −½, −2 give (4 e^(−t/2) − e^(−2t))/3.
        let q = (4.0 * (-2.0_f64).exp() - (-8.0_f64).exp()) / 3.0;
        assert!((exact[0] - q).abs() < 1e-7);
    }
}

/// Nothing grows, however stiff: the step is that of the spring. Without the look ahead the method refuses it.
#[test]
fn does_not_limit_the_step() {
    for caution in [1.0, 1.2, 1.5] {
        for stiff in [1.0, 30.0, 1e3, 1e6] {
            let mut mass = Mass {
                damping: stiff,
                settling: stiff,
                caution,
            };
            let states = mass.run(1.5, 3e4).expect("runs");
            let largest = states
                .iter()
                .map(|state| state.q[0].abs().max(state.z[0].abs()));
            let largest = largest.fold(0.0, f64::max);
            assert!(largest < 3.0, "{stiff}, {caution}: {largest}");
            // The energy lost is what there was, up to what is left of the motion.
            let last = states.last().expect("states");
            let left = 0.5 * (last.q[0].powi(2) + last.v[0].powi(2));
            assert!(left <= 0.5 * 1.0001, "{stiff}, {caution}: {left}");
        }
    }
    let step = 1.5;
    let mut state = State::new(0.0, vec![1.0], vec![0.0]);
    state.z = vec![1.0].into();
    let mut mass = Mass {
        damping: 30.0,
        settling: 30.0,
        caution: 1.0,
    };
    let refused = Method::Rk4 { step }.start(&mut mass, &mut state);
    assert!(matches!(
        refused,
        Err(IntegrationError::StepTooLarge { .. })
    ));
}
