//! When the motion is steady: how long a run-in has to be that ends by itself.

use chaindrive_mechanics::Assembled;

use super::Run;
use super::execute::Onlooker;
use super::run_in::{MOST_CIRCUITS, before};
use crate::SimulationError;
use crate::record::{Blocks, Steadiness};

/// Samples a circuit: enough for a dozen over the slowest swing of a span, which lasts a good part of one.
const SAMPLES: u32 = 256;

/// Time \[s\] after which the tension of every span is steady, and whether it is; else the longest that is tried.
///
/// The drive is moved for 2 circuits of its slowest chain, then on to 4, 8 and so on. Each time all samples so far say where
/// the steady part begins, by the minimum of the standard error of the mean of the rest (MSER; K. P. White, *Simulation*
/// **69**, 1997, 323–334), and whether the halves of the rest agree. The motion is steady once they do for every span, the
/// rest is long against what its samples remember, and all this holds twice in a row: a drift that hides in the scatter of a
/// short time shows in twice that.
pub(super) fn begins(
    start: &Assembled,
    run: &Run,
    onlooker: &dyn Onlooker,
) -> Result<(f64, bool), SimulationError> {
    let stop = &|| onlooker.stop();
    let circuit = circuit(start)?;
    let longest = f64::from(MOST_CIRCUITS) * circuit;
    let mut moving = before(&start.drive, longest, run, stop)?;
    let mut spans: Vec<Blocks> = Vec::new();
    let every = circuit / f64::from(SAMPLES);
    let period = start.slowest_forcing();
    let mut taken = 0;
    let mut circuits = 2;
    let mut was_steady = false;
    while circuits <= MOST_CIRCUITS {
        while taken < circuits * SAMPLES {
            taken += 1;
            let time = f64::from(taken) * circuit / f64::from(SAMPLES) - longest;
            let tensions = &moving.advance_to(time)?.span_tension;
            spans.resize_with(tensions.len(), || Blocks::new(every, period));
            for (span, tension) in spans.iter_mut().zip(tensions) {
                // A span without a tension says nothing.
                if tension.is_finite() {
                    span.push(time + longest, *tension);
                }
            }
            onlooker.see_run_in(f64::from(taken) / f64::from(MOST_CIRCUITS * SAMPLES));
            if stop() {
                return Err(SimulationError::Interrupted);
            }
        }
        let scale = spans
            .iter()
            .map(|span| span.mean().abs())
            .fold(0.0, f64::max);
        let of = |span: &Blocks| span.steadiness(span.mean().abs().max(0.1 * scale));
        let found: Option<Vec<_>> = spans.iter().map(of).collect();
        let found = found.filter(|all| {
            let known = |it: &Steadiness| it.is_steady && it.mean.half_width.is_finite();
            all.iter().all(known)
        });
        if let (Some(found), true) = (&found, was_steady) {
            let from = found.iter().map(|it| it.from).fold(0.0, f64::max);
            return Ok((from, true));
        }
        was_steady = found.is_some();
        circuits *= 2;
    }
    Ok((longest, false))
}

/// Time \[s\] of a circuit of the slowest chain; refused where none runs around sprockets.
pub(super) fn circuit(start: &Assembled) -> Result<f64, SimulationError> {
    let circuit = start.slowest_circuit();
    if circuit.is_finite() {
        return Ok(circuit);
    }
    let reason =
        "auto: no chain runs around sprockets here, so nothing says when to stop: give a time";
    Err(SimulationError::RunIn {
        reason: reason.to_owned(),
    })
}
