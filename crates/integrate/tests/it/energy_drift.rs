//! Long-time behaviour of the energy, and its order in the step.

use crate::problems;

use chaindrive_integrate::Method;
use problems::{Kepler, Smooth, all_methods, fixed};

/// Largest error of the energy over a number of orbits.
fn drift(method: Method, step: f64, orbits: f64) -> f64 {
    let mut state = Kepler.start();
    let energy = Kepler::energy(&state);
    let mut stepper = fixed(method, step)
        .start(&mut Kepler, &mut state)
        .expect("starts");
    let mut worst: f64 = 0.0;
    while state.t < orbits * std::f64::consts::TAU {
        stepper.advance(&mut Kepler, &mut state).expect("advances");
        worst = worst.max((Kepler::energy(&state) - energy).abs());
    }
    worst
}

/// The error falls with the step at the order of the method or faster.
#[test]
fn falls_with_the_step() {
    let steps = [0.02, 0.04, 0.04, 0.01, 0.02];
    for (method, step) in all_methods(1.0).into_iter().zip(steps) {
        let errors: Vec<f64> = (0..4)
            .map(|i| drift(method, step * 0.5_f64.powi(i), 3.0))
            .collect();
        let slope = (errors[0] / errors[3]).log2() / 3.0;
        println!("{}: slope {slope:.2}, errors {errors:?}", method.name());
        assert!(
            slope > f64::from(method.order()) - 0.3,
            "{}: {slope}",
            method.name()
        );
    }
}

/// Verlet's error stays where it is: a thousand orbits are no worse than ten.
#[test]
fn stays_bounded_with_verlet() {
    let method = Method::Verlet { step: 0.02 };
    let (ten, thousand) = (drift(method, 0.02, 10.0), drift(method, 0.02, 1000.0));
    println!("after 10 orbits {ten:.3e}, after 1000 {thousand:.3e}");
    assert!(thousand < 1.02 * ten);
}
