//! Faults that must stop a run, and oddities that must not.

use crate::problems;

use chaindrive_integrate::{
    Continuity, IntegrationError, Method, Moment, SecondOrderSystem, State, StateQuantity,
};
use problems::{Oscillator, Smooth};

/// A force of one degree of freedom becomes NaN at t = 1.
struct Breaking;

impl SecondOrderSystem for Breaking {
    type Record = ();
    fn new_record(&self) {}
    fn dofs(&self) -> usize {
        3
    }
    fn evaluate(&self, at: Moment<'_>, a: &mut [f64], _: &mut [f64], (): &mut ()) {
        a.fill(0.1);
        if at.t >= 1.0 {
            a[1] = (1.0 - at.t - 1e-12).sqrt();
        }
    }
}

#[test]
fn a_nan_stops_the_run_and_says_where() {
    for method in Method::specimens(0.01) {
        let mut state = State::new(0.0, vec![0.0; 3], vec![1.0; 3]);
        let mut stepper = method.start(&mut Breaking, &mut state).unwrap();
        let error = loop {
            if let Err(error) = stepper.advance(&mut Breaking, &mut state) {
                break error;
            }
            assert!(state.t < 1.0, "{}: slipped through", method.name());
        };
        let IntegrationError::NotFinite { t, dof, quantity } = error else {
            panic!("{error}");
        };
        assert!((1.0..1.02).contains(&t), "{t}");
        assert_eq!((dof, quantity), (1, StateQuantity::Acceleration));
        assert!(state.q.iter().chain(&state.v).all(|x| x.is_finite()));
        println!("{error}");
    }
}

#[test]
fn a_nan_at_the_start_is_refused() {
    for method in Method::specimens(0.01) {
        let mut state = State::new(0.0, vec![0.0], vec![f64::NAN]);
        let error = method.start(&mut Oscillator, &mut state).unwrap_err();
        let quantity = StateQuantity::Velocity;
        let expected = |t| IntegrationError::NotFinite {
            t,
            dof: 0,
            quantity,
        };
        assert_eq!(error, expected(0.0));
    }
}

#[test]
fn a_step_too_large_is_refused_at_the_start() {
    for (method, limit) in [
        (Method::Verlet { step: 1.85 }, 1.8),
        (Method::Rk4 { step: 2.6 }, 0.9 * 2.78),
    ] {
        let error = method
            .start(&mut Oscillator, &mut Oscillator.start())
            .unwrap_err();
        let IntegrationError::StepTooLarge { limit: found, .. } = error else {
            panic!("{error}");
        };
        assert!((found - limit).abs() < 1e-12);
        println!("{error}");
    }
}

#[test]
fn parameters_and_shapes_are_checked() {
    let start = |method: Method| {
        method
            .start(&mut Oscillator, &mut Oscillator.start())
            .map(|_| ())
    };
    for step in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(
            start(Method::Verlet { step }),
            Err(IntegrationError::Parameter {
                parameter: "step",
                ..
            })
        ));
    }
    let mut state = State::new(0.0, vec![0.0; 2], vec![0.0]);
    let error = Method::Rk4 { step: 0.1 }
        .start(&mut Oscillator, &mut state)
        .unwrap_err();
    assert_eq!(error.to_string(), "the state has 2 positions, the system 1");
}

/// A spring that becomes a hundred times stiffer for a while, and says so.
struct Stiffening {
    frequency: f64,
}

impl SecondOrderSystem for Stiffening {
    type Record = ();
    fn new_record(&self) {}
    fn dofs(&self) -> usize {
        1
    }
    fn evaluate(&self, at: Moment<'_>, a: &mut [f64], _: &mut [f64], (): &mut ()) {
        a[0] = -self.frequency * self.frequency * at.q[0];
    }
    fn commit(&mut self, t: f64, _: &mut [f64], _: &mut [f64], (): &mut ()) -> Continuity {
        let stiff = (1.0..2.0).contains(&t);
        let frequency = if stiff { 100.0 } else { 1.0 };
        let changed = (frequency - self.frequency).abs() > 1.0;
        self.frequency = frequency;
        if changed {
            Continuity::Jump
        } else {
            Continuity::Smooth
        }
    }
    fn time_scale(&self) -> f64 {
        1.0 / self.frequency
    }
}

#[test]
fn a_step_too_large_is_shortened_during_a_run_and_restored() {
    for method in [Method::Verlet { step: 0.1 }, Method::Rk4 { step: 0.1 }] {
        let mut system = Stiffening { frequency: 1.0 };
        let mut state = State::new(0.0, vec![1.0], vec![0.0]);
        let mut stepper = method.start(&mut system, &mut state).unwrap();
        let mut last = 0.0;
        while state.t < 3.0 {
            let step = stepper.advance(&mut system, &mut state).unwrap();
            last = step.to - step.from;
            assert!(state.q[0].abs() < 100.0, "{}: unstable", method.name());
        }
        let counts = stepper.statistics();
        println!("{}: {counts:?}", method.name());
        assert_eq!((counts.reductions, counts.jumps), (1, 2));
        // ωh = 10 comes below ¾ of 1.8 after 15 rungs of 2^(−1/5), below ¾ of 2.5 after thirteen.
        let rungs = if method.order() == 2 { 15.0 } else { 13.0 };
        let shortest = 0.1 * (-0.2_f64 * rungs).exp2();
        assert!((counts.smallest_step - shortest).abs() < 1e-15);
        assert!((last - 0.1).abs() < 1e-12, "back at the nominal step");
    }
}

/// A spring with a damper, stepped at a given share of the documented limit.
struct Damped {
    damping: f64,
}

impl SecondOrderSystem for Damped {
    type Record = ();
    fn new_record(&self) {}
    fn dofs(&self) -> usize {
        1
    }
    fn evaluate(&self, at: Moment<'_>, a: &mut [f64], _: &mut [f64], (): &mut ()) {
        a[0] = -at.q[0] - self.damping * at.v[0];
    }
}

/// τ = 1/(λ + √(λ² + ω²)) marks the edge of stability of Verlet, and is safe for Runge–Kutta.
#[test]
fn documented_time_scale_is_the_edge_of_stability() {
    let grows = |damping: f64, method: Method| {
        let mut system = Damped { damping };
        let mut state = State::new(0.0, vec![1.0], vec![0.0]);
        let mut stepper = method.start(&mut system, &mut state).unwrap();
        for _ in 0..20_000 {
            stepper.advance(&mut system, &mut state).unwrap();
            if state.q[0].abs() > 1e6 {
                return true;
            }
        }
        false
    };
    for damping in [0.05, 0.2, 1.0, 3.0, 30.0] {
        let scale = 1.0 / (damping + (damping * damping + 1.0_f64).sqrt());
        let verlet = |share: f64| Method::Verlet {
            step: share * 2.0 * scale,
        };
        assert!(!grows(damping, verlet(0.99)), "λ = {damping}: stable below");
        assert!(
            grows(damping, verlet(1.01)),
            "λ = {damping}: unstable above"
        );
        let step = 0.99 * 2.78 * scale;
        assert!(!grows(damping, Method::Rk4 { step }), "λ = {damping}");
    }
}
