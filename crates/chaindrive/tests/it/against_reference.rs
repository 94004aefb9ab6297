//! True errors of runs: against a reference method that has no part in any estimate. Tests of single drives and
//! `examples/estimates.rs`, the table of forty, share it.

use chaindrive::{Assembled, Run, Simulation, SimulationError, Stepping};
use chaindrive_integrate::SecondOrderSystem;

/// Error at which a horizon lies \[–\].
pub(crate) const HORIZON: f64 = 0.01;

/// Runge–Kutta of fourth order with steps that follow the damping and contacts that begin at most ten nanometres deep; step and
/// depth times `factor`.
pub(crate) fn reference(start: &Assembled, factor: f64) -> Run {
    let particles = !start.system.prefers_implicit_damping();
    let steps = if particles { 0.0625 } else { 0.5 };
    Run {
        stepping: Stepping::Rk4,
        step: Some(factor * steps * start.system.time_scale()),
        onset_depth: particles.then_some(factor * 1e-8),
        ..Run::default()
    }
}

/// Tensions of spans and of links, sample by sample \[N\].
pub(crate) fn tensions(
    start: &Assembled,
    run: &Run,
) -> Result<[Vec<Vec<f64>>; 2], SimulationError> {
    let mut simulation = Simulation::from_assembled(start.clone(), run)?;
    let [mut spans, mut links] = [Vec::new(), Vec::new()];
    while let Some(sample) = simulation.next_sample()? {
        spans.push(sample.span_tension.clone());
        links.push(sample.link_tension.clone());
    }
    Ok([spans, links])
}

/// Root mean square over the strands, over the mean tension of the first samples, sample by sample \[–\].
pub(crate) fn errors(of: &[Vec<f64>], exact: &[Vec<f64>], first: usize) -> Vec<f64> {
    let all = exact[..first].concat();
    let mean = all.iter().map(|tension| tension.abs()).sum::<f64>() / all.len() as f64;
    let pairs = of.iter().zip(exact);
    let pairs = pairs.map(|(a, b)| rms(a.iter().zip(b).map(|(a, b)| a - b)) / mean);
    pairs.collect()
}

/// The first sample at which the error, root mean square over that sample and those before it, so many in all, is that of a horizon.
pub(crate) fn horizon(errors: &[f64], over: f64) -> Option<usize> {
    (1..=errors.len()).position(|last| {
        let window = errors[..last].iter().rev().enumerate();
        let window = window.take_while(|(back, _)| *back == 0 || ((*back + 1) as f64) <= over);
        rms(window.map(|(_, error)| *error)) >= HORIZON
    })
}

pub(crate) fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| {
        (sum + value * value, count + 1.0)
    });
    f64::sqrt(sum / f64::max(count, 1.0))
}
