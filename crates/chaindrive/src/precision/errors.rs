//! Errors of a trace against a reference: at every moment up to the horizon, and in the statistics.

use super::compare::{Account, distances, rms};
use super::trace::{Strands, Trace};

/// Relative errors of a run \[–\]; NaN where there is nothing to compare.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// Tension of all spans at every moment up to the horizon: root mean square, over the mean tension.
    pub tension: f64,
    /// The same of the tightest span.
    pub tight_tension: f64,
    /// Force between every roller and the teeth up to the horizon: root mean square, over that of the force.
    pub force: f64,
    /// Rotation of the sprockets up to the horizon: root mean square, over the largest rotation.
    pub angle: f64,
    /// Mean tension over the whole window, of the span that differs most.
    pub mean: f64,
    /// Root mean square of the tension over the whole window, of the span that differs most.
    pub rms: f64,
    /// 50th, 90th and 99th percentile of the contact forces over the whole window.
    pub percentiles: [f64; 3],
    /// Amplitude of the tight span's tension at the frequency of the passing teeth.
    pub mesh: f64,
}

impl Errors {
    /// Of a trace against another, by some strands, pointwise up to `horizon` \[s\]; `period`: time in which a tooth
    /// passes \[s\].
    pub(super) fn of(
        trace: &Trace,
        from: &Trace,
        strands: Strands,
        horizon: f64,
        period: Option<f64>,
    ) -> Self {
        let samples = from.time.iter().take_while(|t| **t <= horizon).count();
        let distances = distances(trace, from, strands);
        let inside = &distances[..samples.min(distances.len())];
        let (own, exact) = (
            Account::of(trace, usize::MAX, strands),
            Account::of(from, usize::MAX, strands),
        );
        let tight = from.spans.tight();
        // Without the tension of a span there is no amplitude of it.
        let period = period.filter(|_| strands == Strands::Spans);
        let amplitude = |of: &Trace| period.map_or(f64::NAN, |period| mesh(of, tight, period));
        let exact_mesh = amplitude(from);
        Self {
            tension: rms(inside.iter().map(|d| d.all)),
            tight_tension: rms(inside.iter().map(|d| d.tight)),
            force: apart(&trace.force, &from.force, from, samples, false),
            angle: apart(&trace.angle, &from.angle, from, samples, true),
            mean: own.mean_apart(&exact),
            rms: own.rms_apart(&exact),
            percentiles: own.force_apart(&exact),
            mesh: (amplitude(trace) - exact_mesh).abs() / exact_mesh,
        }
    }

    /// The larger of both, number by number; for the spread of several replicates.
    pub(super) fn larger(self, other: &Self) -> Self {
        let [p50, p90, p99] = self.percentiles;
        Self {
            tension: self.tension.max(other.tension),
            tight_tension: self.tight_tension.max(other.tight_tension),
            force: self.force.max(other.force),
            angle: self.angle.max(other.angle),
            mean: self.mean.max(other.mean),
            rms: self.rms.max(other.rms),
            percentiles: [
                p50.max(other.percentiles[0]),
                p90.max(other.percentiles[1]),
                p99.max(other.percentiles[2]),
            ],
            mesh: self.mesh.max(other.mesh),
        }
    }

    /// Errors of something that was not compared.
    pub(super) fn none() -> Self {
        Self {
            tension: f64::NAN,
            tight_tension: f64::NAN,
            force: f64::NAN,
            angle: f64::NAN,
            mean: f64::NAN,
            rms: f64::NAN,
            percentiles: [f64::NAN; 3],
            mesh: f64::NAN,
        }
    }

    /// Name and value of every error, as columns of a table.
    pub fn columns(&self) -> [(&'static str, f64); 10] {
        let [p50, p90, p99] = self.percentiles;
        [
            ("tension", self.tension),
            ("tight_tension", self.tight_tension),
            ("contact_force", self.force),
            ("sprocket_angle", self.angle),
            ("tension_mean", self.mean),
            ("tension_rms", self.rms),
            ("contact_force_p50", p50),
            ("contact_force_p90", p90),
            ("contact_force_p99", p99),
            ("mesh_amplitude", self.mesh),
        ]
    }
}

/// Root mean square of differences up to a sample, over that of the values, or over the largest of them.
fn apart(of: &[f64], from: &[f64], trace: &Trace, samples: usize, largest: bool) -> f64 {
    let width = from.len() / trace.len().max(1);
    let count = (samples * width).min(of.len());
    let difference = rms(of[..count].iter().zip(from).map(|(a, b)| a - b));
    let scale = if largest {
        from[..count].iter().fold(0.0, |m: f64, a| m.max(a.abs()))
    } else {
        rms(from[..count].iter().copied())
    };
    difference / scale
}

/// Amplitude at the frequency of the passing teeth \[N\], over the whole periods at the end of the trace.
///
/// ```text
/// A = 2/N |Σ (T − T̄) exp(−2πi t/p)|
/// ```
fn mesh(trace: &Trace, strand: usize, period: f64) -> f64 {
    let end = trace.time.last().copied().unwrap_or(0.0);
    let whole = (end / period * (1.0 + 1e-9)).floor();
    if whole < 1.0 {
        return f64::NAN;
    }
    // Half a sample later, so that both ends of a period do not count twice.
    let begin = end - whole * period + 0.5 * end / trace.len() as f64;
    let tensions = trace.time.iter().copied().zip(trace.spans.of(strand));
    let values: Vec<(f64, f64)> = tensions.filter(|(time, _)| *time >= begin).collect();
    let n = values.len() as f64;
    let mean = values.iter().map(|(_, tension)| tension).sum::<f64>() / n;
    let (mut re, mut im) = (0.0, 0.0);
    for (t, tension) in values {
        let (s, c) = (std::f64::consts::TAU * t / period).sin_cos();
        re += (tension - mean) * c;
        im += (tension - mean) * s;
    }
    2.0 / n * re.hypot(im)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_amplitude_of_a_wave_is_found() {
        let time: Vec<f64> = (0..=256).map(|i| f64::from(i) * 1e-3).collect();
        let wave = |t: &f64| 5.0 + 3.0 * (std::f64::consts::TAU * t / 0.064 + 0.3).sin();
        let mut trace = Trace::default();
        trace.spans.values = time.iter().map(wave).collect();
        trace.spans.strands = 1;
        trace.time = time;
        assert!((mesh(&trace, 0, 0.064) - 3.0).abs() < 1e-9);
        assert!(mesh(&trace, 0, 0.032) < 1e-9);
        assert!(mesh(&trace, 0, 1.0).is_nan());
    }
}
