//! Every method shows its order on every smooth problem.
#![allow(clippy::print_stdout, reason = "measured orders are worth a look")]

use crate::problems;

use chaindrive_integrate::{Method, State};
use problems::{Driven, Kepler, Oscillator, Smooth, all_methods, fixed, run};

/// Steps after which a method is in its asymptotic range and far from rounding.
fn coarsest(method: Method) -> u32 {
    match method {
        Method::Verlet { .. } => 400,
        Method::ImplicitDamping { .. } => 1600,
        Method::GeneralizedAlpha { .. } => 800,
        method if method.is_adaptive() => 240,
        _ => 160,
    }
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    let squares = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b));
    squares.sum::<f64>().sqrt()
}

/// Largest distance from the truth at eight instants; a single one may hide an error by chance.
fn assert_orders<P: Smooth>(name: &str, problem: &P) {
    for method in all_methods(1.0) {
        let precise = run(problem, Method::specimens(1.0)[2], 6400);
        let error = |n| {
            let pairs = run(problem, method, n).into_iter().zip(&precise);
            let errors = pairs.map(|(state, precise)| {
                let exact = problem.exact(state.t);
                distance(&state.q, exact.as_deref().unwrap_or(&precise.q))
            });
            errors.fold(0.0, f64::max)
        };
        let n = coarsest(method);
        let order = (error(n) / error(2 * n)).log2();
        println!(
            "{name}, {}: order {order:.3}, error {:.1e}",
            method.name(),
            error(2 * n)
        );
        let expected = f64::from(method.order());
        assert!(
            (order - expected).abs() < 0.15,
            "{name}, {}: order {order}",
            method.name()
        );
    }
}

#[test]
fn on_an_oscillator() {
    assert_orders("oscillator", &Oscillator);
}

#[test]
fn on_a_planet() {
    assert_orders("planet", &Kepler);
}

#[test]
fn on_a_driven_damped_pendulum() {
    assert_orders("driven pendulum", &Driven);
}

/// Work and dissipation, integrated along, close the energy at the order of the method.
#[test]
fn of_the_energy_ledger() {
    for method in all_methods(1.0) {
        let n = coarsest(method);
        let start = {
            let State { q, v, .. } = Driven.start();
            0.5 * v[0] * v[0] + 1.0 - q[0].cos()
        };
        let error = |n| {
            let states = run(&Driven, method, n);
            let errors = states
                .iter()
                .map(|state| (Driven::ledger(state) - start).abs());
            errors.fold(0.0, f64::max)
        };
        let order = (error(n) / error(2 * n)).log2();
        println!(
            "ledger, {}: order {order:.3}, error {:.1e}",
            method.name(),
            error(2 * n)
        );
        assert!(
            order > f64::from(method.order()) - 0.15,
            "{}: {order}",
            method.name()
        );
    }
}

/// Between accepted states the interpolation is as good as the states.
#[test]
fn between_the_steps() {
    for method in all_methods(1.0) {
        let error = |n: u32| {
            let (mut q, mut v) = ([0.0], [0.0]);
            let step = Oscillator.duration() / f64::from(n);
            let mut state = Oscillator.start();
            let mut stepper = fixed(method, step)
                .start(&mut Oscillator, &mut state)
                .unwrap();
            let mut worst: f64 = 0.0;
            for _ in 0..n {
                let step = stepper.advance(&mut Oscillator, &mut state).unwrap();
                for part in [0.25, 0.5, 0.7] {
                    let t = step.from + part * (step.to - step.from);
                    state.at(t, &mut q, &mut v);
                    worst = worst
                        .max((q[0] - (t.cos() + 0.5 * t.sin())).abs())
                        .max((v[0] - (0.5 * t.cos() - t.sin())).abs());
                }
            }
            worst
        };
        // Fewer steps than elsewhere: rounding of the positions, divided by the step, shows in the velocities.
        let n = coarsest(method).min(80);
        let order = (error(n) / error(2 * n)).log2();
        println!("interpolation, {}: order {order:.3}", method.name());
        assert!(
            order > f64::from(method.order()) - 0.15,
            "{}: {order}",
            method.name()
        );
    }
}

/// With error control the error follows the tolerance.
#[test]
fn error_follows_the_tolerance() {
    let reference = Kepler.exact(Kepler.duration()).unwrap();
    for exponent in [-6, -8, -10] {
        let tolerance = 10.0_f64.powi(exponent);
        let mut state = Kepler.start();
        let method = Method::DormandPrince {
            relative: tolerance,
            absolute: tolerance,
            absolute_rate: tolerance,
            max_step: 1.0,
        };
        let mut stepper = method.start(&mut Kepler, &mut state).unwrap();
        while state.t < Kepler.duration() {
            stepper.advance(&mut Kepler, &mut state).unwrap();
        }
        let (mut q, mut v) = ([0.0; 2], [0.0; 2]);
        state.at(Kepler.duration(), &mut q, &mut v);
        let error = distance(&q, &reference);
        let steps = stepper.statistics().steps;
        println!("tolerance {tolerance:e}: error {error:.1e}, {steps} steps");
        assert!(
            error < 30.0 * tolerance,
            "tolerance {tolerance:e}: error {error:e}"
        );
        assert!(
            error > 1e-3 * tolerance,
            "tolerance {tolerance:e}: error {error:e}"
        );
    }
}
