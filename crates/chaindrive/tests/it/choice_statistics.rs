//! Beyond the chaos horizon a run is to be read by its statistics: are they right, with the accuracy it has by default?
//!
//! Two ensembles of runs that start nanometres apart and part within tenths of a second: by the method chosen for 1 %, and
//! by the reference, RK4 at a quarter of 1/ω with contacts that begin at most a micrometre deep.
#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use std::thread::scope;

use chaindrive::precision::{ACCURACY, choose};
use chaindrive::{Assembled, Run, Simulation};

use crate::judged::bare;

/// Statistics of the tension of a span.
const NAMES: [&str; 7] = ["mean", "rms", "p1", "p10", "p50", "p90", "p99"];

/// Runs of an ensemble.
const RUNS: usize = 6;

/// The start-up transient, and the end of the runs \[s\].
const SETTLED: f64 = 0.3;
const UNTIL: f64 = 1.1;

/// Standard errors that a difference of two means of so few runs may reach by chance: Student's t with ten
/// degrees of freedom exceeds four once in four hundred times.
const CHANCE: f64 = 4.0;

/// Statistics of a span \[N\].
type Statistics = [f64; NAMES.len()];

/// Statistics of the tension of every span, (spans,).
fn statistics(start: &Assembled, run: &Run) -> Vec<Statistics> {
    let mut simulation = Simulation::from_assembled(start.clone(), run).unwrap();
    let mut spans: Vec<Vec<f64>> = Vec::new();
    while let Some(sample) = simulation.next_sample().unwrap() {
        spans.resize(sample.span_tension.len(), Vec::new());
        if sample.time >= SETTLED {
            for (span, tension) in spans.iter_mut().zip(&sample.span_tension) {
                span.push(*tension);
            }
        }
    }
    spans.iter_mut().map(|span| sums(span)).collect()
}

fn sums(span: &mut [f64]) -> Statistics {
    let count = span.len();
    let mean = |of: fn(f64) -> f64| span.iter().map(|t| of(*t)).sum::<f64>() / count as f64;
    let (mean, rms) = (mean(|t| t), mean(|t| t * t).sqrt());
    span.sort_unstable_by(f64::total_cmp);
    let percentile = |p: usize| span[(count - 1) * p / 100];
    let [p1, p10, p50, p90, p99] = [1, 10, 50, 90, 99].map(percentile);
    [mean, rms, p1, p10, p50, p90, p99]
}

/// Runs that start apart, two at a time, (runs, spans).
fn ensemble(start: &Assembled, run: &Run) -> Vec<Vec<Statistics>> {
    let one = |k: usize| statistics(&start.nudged(1e-9 * (k + 1) as f64), run);
    scope(|scope| {
        let half = |first: usize| move || (first..RUNS).step_by(2).map(one).collect::<Vec<_>>();
        let threads = [scope.spawn(half(0)), scope.spawn(half(1))];
        let runs = threads.map(|thread| thread.join().unwrap());
        runs.concat()
    })
}

/// Mean over the runs of one statistic of one span, and the standard error of this mean \[N\].
fn over(runs: &[Vec<Statistics>], span: usize, index: usize) -> (f64, f64) {
    let values = || runs.iter().map(|run| run[span][index]);
    let count = runs.len() as f64;
    let mean = values().sum::<f64>() / count;
    let square = values().map(|it| (it - mean).powi(2)).sum::<f64>();
    (mean, (square / (count - 1.0) / count).sqrt())
}

/// The worst difference of the means of two ensembles, over what is allowed: the accuracy, and what chance makes of
/// ensembles of this size.
fn worst(found: &[Vec<Statistics>], replicates: &[Vec<Statistics>]) -> (f64, String) {
    let mut worst = (0.0, String::new());
    for span in 0..replicates[0].len() {
        for (index, name) in NAMES.iter().enumerate() {
            let (exact, error) = over(replicates, span, index);
            let (mean, own_error) = over(found, span, index);
            let allowed = CHANCE * error.hypot(own_error) + ACCURACY * exact;
            let ratio = (mean - exact).abs() / allowed;
            if ratio > worst.0 {
                let text =
                    format!("span {span}, {name}: {mean:.0} N, not {exact:.0} ± {allowed:.0} N");
                worst = (ratio, text);
            }
        }
    }
    worst
}

/// The drive under a torque on its camshaft.
fn drive(torque: &str) -> Assembled {
    // Without friction in the joints and with the kick of the polygons its twins part early.
    let scene = bare("marine_two_sprockets");
    let scene = scene.replace("sprockets.camshaft.load[0].torque", torque);
    scene.unwrap().drive().unwrap().assemble().unwrap()
}

/// What the choice promises of statistics is judged by `choice.rs` on shorter runs.
#[test]
#[ignore = "takes 20 s: an ensemble of sharp references"]
fn the_default_accuracy_has_the_statistics_of_a_sharp_reference() {
    let start = drive("5 kN m");
    let run = Run {
        until: UNTIL,
        every: 1e-4,
        ..Run::default()
    };
    let choice = choose(&start, &run, ACCURACY, &|| false).unwrap();
    let replicates = ensemble(&start, &Run::reference(UNTIL, 1e-4));
    // They have parted, or their scatter would say nothing.
    let (mean, error) = over(&replicates, 0, 0);
    assert!(error > 1e-4 * mean, "{error} N of {mean} N");

    let found = ensemble(&start, &choice.run);
    let (ratio, what) = worst(&found, &replicates);
    assert!(ratio <= 1.0, "{what}; {choice}");

    // The comparison is sharp enough to see a fifth more load.
    let heavier = ensemble(&drive("6 kN m"), &choice.run);
    let (ratio, what) = worst(&heavier, &replicates);
    assert!(ratio > 1.0, "{what}");
}
