//! Running a scene text, and what the dynamic validation cases ask of its samples.
#![allow(dead_code, reason = "every test uses its part")]

use std::f64::consts::TAU;
use std::fmt::Write as _;

use chaindrive::{Observation, Run, Scene, Simulation};

/// A simulation of a scene text, run as the text says.
pub(crate) fn start(text: &str) -> Simulation {
    let scene = Scene::from_text(text, "case.toml").unwrap_or_else(|error| panic!("{error}"));
    let drive = scene.drive().unwrap_or_else(|error| panic!("{error}"));
    let run = Run::suggested(&scene.run_defaults());
    Simulation::start(&drive, &run).unwrap_or_else(|error| panic!("{error}"))
}

/// Runs a scene text to its end, and shows every sample.
pub(crate) fn run(text: &str, mut see: impl FnMut(&Observation)) -> Simulation {
    let mut simulation = start(text);
    loop {
        match simulation.next_sample() {
            Ok(Some(sample)) => see(sample),
            Ok(None) => return simulation,
            Err(error) => panic!("{error}"),
        }
    }
}

/// Points or velocities as a scene lists them.
pub(crate) fn pairs(values: impl IntoIterator<Item = [f64; 2]>) -> String {
    let mut text = String::from("[");
    for [x, y] in values {
        write!(text, "[{x:?}, {y:?}], ").expect("a text grows");
    }
    text + "]"
}

/// Numbers as a scene lists them.
pub(crate) fn numbers(values: impl IntoIterator<Item = f64>) -> String {
    let values: Vec<f64> = values.into_iter().collect();
    format!("{values:?}")
}

/// Kinetic and potential energy \[J\].
pub(crate) fn energy(sample: &Observation) -> f64 {
    sample.energy.kinetic() + sample.energy.stored()
}

pub(crate) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Largest less smallest.
pub(crate) fn range(values: &[f64]) -> f64 {
    let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    most - values.iter().copied().fold(f64::INFINITY, f64::min)
}

/// Slope of the straight line through points, by least squares.
pub(crate) fn slope(points: &[(f64, f64)]) -> f64 {
    let n = points.len() as f64;
    let (x, y) = points
        .iter()
        .fold((0.0, 0.0), |sum, p| (sum.0 + p.0 / n, sum.1 + p.1 / n));
    let (above, below) = points.iter().fold((0.0, 0.0), |sum, p| {
        (sum.0 + (p.0 - x) * (p.1 - y), sum.1 + (p.0 - x) * (p.0 - x))
    });
    above / below
}

/// Amplitude of the sine of frequency `f` \[Hz\] in a signal sampled every `dt` \[s\], under a
/// Hann window.
pub(crate) fn amplitude(signal: &[f64], dt: f64, f: f64) -> f64 {
    let n = signal.len() as f64;
    let average = mean(signal);
    let (mut cosine, mut sine) = (0.0, 0.0);
    for (i, value) in signal.iter().enumerate() {
        let window = 1.0 - (TAU * (i as f64 + 0.5) / n).cos();
        let (s, c) = (TAU * f * dt * i as f64).sin_cos();
        cosine += window * (value - average) * c;
        sine += window * (value - average) * s;
    }
    2.0 * cosine.hypot(sine) / n
}

/// Frequency \[Hz\] between two bounds at which a signal is strongest.
pub(crate) fn strongest(signal: &[f64], dt: f64, (low, high): (f64, f64)) -> f64 {
    let (mut low, mut high) = (low, high);
    for _ in 0..6 {
        let step = (high - low) / 40.0;
        let place = |i: i32| low + step * f64::from(i);
        let best = (0..=40)
            .max_by(|&a, &b| {
                amplitude(signal, dt, place(a)).total_cmp(&amplitude(signal, dt, place(b)))
            })
            .map_or(low, place);
        (low, high) = (best - step, best + step);
    }
    0.5 * (low + high)
}

/// Errors as one prints them.
pub(crate) fn brief(values: &[f64]) -> String {
    let values: Vec<String> = values.iter().map(|x| format!("{x:.1e}")).collect();
    format!("[{}]", values.join(", "))
}
