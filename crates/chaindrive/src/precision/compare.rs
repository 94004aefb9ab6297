//! Differences of two traces of one drive: at every moment, in statistics, losses and impacts.

use super::impacts::ImpactErrors;
use super::trace::{Strands, Trace};

/// Two traces of one drive: whoever compares runs asks here.
///
/// Relative differences are relative to the second trace.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair<'a> {
    of: &'a Trace,
    from: &'a Trace,
    strands: Strands,
    /// Samples that are looked at, of each trace as many as it has of them.
    samples: usize,
}

/// Distance of two traces at one sample, over the mean tension of the samples that both have.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Distance {
    /// Root mean square over the strands \[–\]; infinite where a tension is not a number.
    pub(super) all: f64,
    /// Of the tight strand alone \[–\].
    pub(super) tight: f64,
}

/// Percentiles of the contact forces that are compared.
const PERCENTILES: [f64; 3] = [0.5, 0.9, 0.99];

impl<'a> Pair<'a> {
    /// A trace, and the one that it is held against; by strands whose tensions both have.
    pub(super) fn of(of: &'a Trace, from: &'a Trace, strands: Strands) -> Self {
        Self {
            of,
            from,
            strands,
            samples: usize::MAX,
        }
    }

    /// Their first samples.
    pub(super) fn first(self, samples: usize) -> Self {
        Self { samples, ..self }
    }

    /// Distances at all samples that both traces have.
    ///
    /// ```text
    /// d = √(Σ (Tₖ − T′ₖ)² / n) / T̄′
    /// ```
    ///
    /// A tension that is not a number agrees with nothing, not even with another one: compare traces by [`Strands`]
    /// that all of them have. The mean is that of the samples compared: the tension may rise a hundredfold after them.
    pub(super) fn distances(&self) -> Vec<Distance> {
        let samples = self.both();
        self.distances_over(self.from.tensions(self.strands).mean_of_first(samples))
    }

    /// The same over another scale \[N\].
    pub(super) fn distances_over(&self, scale: f64) -> Vec<Distance> {
        let [of, from] = [self.of, self.from].map(|trace| trace.tensions(self.strands));
        let (n, tight) = (from.strands, from.tight());
        let at = |sample: usize| {
            let apart = |strand: usize| {
                let place = sample * n + strand;
                let apart = (of.values[place] - from.values[place]).abs();
                if apart.is_finite() {
                    apart
                } else {
                    f64::INFINITY
                }
            };
            Distance {
                all: rms((0..n).map(apart)) / scale,
                tight: if n > 0 { apart(tight) / scale } else { 0.0 },
            }
        };
        (0..self.both()).map(at).collect()
    }

    /// Root mean square difference of the tensions \[N\].
    pub(super) fn tension(&self) -> f64 {
        difference(self.values(|trace| &trace.tensions(self.strands).values))
    }

    /// Root mean square difference of the forces between rollers and teeth, over their root mean square \[–\].
    fn force(&self) -> f64 {
        let values = self.values(|trace| &trace.force);
        difference(values) / rms(values[1].iter().copied())
    }

    /// Root mean square difference of the rotations of sprockets, over the largest rotation \[–\].
    fn angle(&self) -> f64 {
        let values = self.values(|trace| &trace.angle);
        let largest = |most: f64, angle: &f64| most.max(angle.abs());
        difference(values) / values[1].iter().fold(0.0, largest)
    }

    /// Mean and root mean square of the tension, of the strand that differs most, over the mean of all \[–\]; infinite where
    /// one is not a number.
    pub(super) fn moments(&self) -> [f64; 2] {
        let of = |tensions: &mut [f64]| [mean(tensions), rms(tensions.iter().copied())];
        let [of, from] = [self.of, self.from].map(|trace| self.by_strand(trace, of));
        [0, 1].map(|k| {
            let scale = from.iter().map(|it| it[k].abs()).sum::<f64>() / from.len() as f64;
            largest(&of, &from, k, scale)
        })
    }

    /// The larger of these.
    pub(super) fn statistics(&self) -> f64 {
        let [mean, rms] = self.moments();
        mean.max(rms)
    }

    /// Standard deviation, 1st and 99th percentile of the tension, each of the strand that differs most, over the mean tension \[–\].
    pub(super) fn scatter(&self) -> [f64; 3] {
        let of = |tensions: &mut [f64]| {
            tensions.sort_unstable_by(f64::total_cmp);
            let mean = mean(tensions);
            let deviation = rms(tensions.iter().map(|tension| tension - mean));
            let [low, high] = [0.01, 0.99].map(|share| percentile(tensions, share));
            [deviation, low, high]
        };
        let [of, from] = [self.of, self.from].map(|trace| self.by_strand(trace, of));
        let tensions = self.from.tensions(self.strands);
        let scale = tensions.mean_of_first(self.samples.min(self.from.len()));
        [0, 1, 2].map(|k| largest(&of, &from, k, scale))
    }

    /// 50th, 90th and 99th percentile of the forces of closed contacts \[–\]; NaN without contacts.
    pub(super) fn percentiles(&self) -> [f64; 3] {
        let [of, from] = [self.of, self.from].map(|trace| {
            let rollers = trace.force.len() / trace.len().max(1);
            let forces = &trace.force[..self.samples.min(trace.len()) * rollers];
            let mut closed: Vec<f64> = forces.iter().copied().filter(|it| *it > 0.0).collect();
            closed.sort_unstable_by(f64::total_cmp);
            PERCENTILES.map(|share| percentile(&closed, share))
        });
        [0, 1, 2].map(|k| (of[k] - from[k]).abs() / from[k])
    }

    /// Amplitude of the tight span's tension at the frequency of the passing teeth \[–\]; `period`: time in which one passes \[s\].
    fn mesh(&self, period: f64) -> f64 {
        let tight = self.from.spans.tight();
        let [of, from] = [self.of, self.from].map(|trace| mesh(trace, tight, period));
        (of - from).abs() / from
    }

    /// Energy lost \[–\].
    pub(super) fn losses(&self) -> f64 {
        (self.of.energy.losses - self.from.energy.losses).abs() / self.from.energy.scale()
    }

    /// Impacts, of the sprocket that differs most \[–\], `factor` times; infinite where one run lacks them.
    pub(super) fn impacts(&self, names: &[String], factor: f64) -> f64 {
        let found = ImpactErrors::of(self.of, self.from, names, factor);
        ImpactErrors::largest_of(&found).unwrap_or(f64::INFINITY)
    }

    /// Number of samples that both have.
    fn both(&self) -> usize {
        self.samples.min(self.of.len()).min(self.from.len())
    }

    /// Values of both at the samples that both have.
    fn values(&self, part: impl Fn(&'a Trace) -> &'a [f64]) -> [&'a [f64]; 2] {
        let width = part(self.from).len() / self.from.len().max(1);
        let count = self.both() * width;
        [self.of, self.from].map(|trace| &part(trace)[..count])
    }

    /// Statistics of the tension of every strand \[N\].
    fn by_strand<const N: usize>(
        &self,
        trace: &Trace,
        statistics: impl Fn(&mut [f64]) -> [f64; N],
    ) -> Vec<[f64; N]> {
        let tensions = trace.tensions(self.strands);
        let of = |strand| {
            let mut values: Vec<f64> = tensions.of(strand).take(self.samples).collect();
            statistics(&mut values)
        };
        (0..tensions.strands).map(of).collect()
    }
}

fn difference([of, from]: [&[f64]; 2]) -> f64 {
    rms(of.iter().zip(from).map(|(a, b)| a - b))
}

/// Largest difference of one of several statistics of strands, over a scale.
fn largest<const N: usize>(of: &[[f64; N]], from: &[[f64; N]], k: usize, scale: f64) -> f64 {
    let apart = || of.iter().zip(from).map(|(a, b)| (a[k] - b[k]).abs());
    // `f64::max` forgets what is not a number.
    if apart().any(f64::is_nan) {
        return f64::INFINITY;
    }
    apart().fold(0.0, f64::max) / scale
}

/// Root mean square of values.
pub(super) fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for value in values {
        sum += value * value;
        count += 1.0;
    }
    f64::sqrt(sum / f64::max(count, 1.0))
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// The value below which a share of sorted values lies; NaN of none.
fn percentile(sorted: &[f64], share: f64) -> f64 {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a place in the list"
    )]
    let place = (share * sorted.len() as f64) as usize;
    let last = sorted.len().wrapping_sub(1);
    sorted.get(place.min(last)).copied().unwrap_or(f64::NAN)
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

/// A statistic of two runs, and of two runs that differ by nothing but chance.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Comparison {
    /// Relative difference between the run and its shadow \[–\]; NaN where there is nothing to compare.
    pub difference: f64,
    /// Relative difference between the run and its twin, which started 1e-12 m apart \[–\].
    pub spread: f64,
}

impl Comparison {
    /// A difference within the spread of equal runs.
    pub fn within_spread(&self) -> bool {
        self.difference <= self.spread
    }
}

/// A column of the table of a study.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Number {
    /// Name.
    pub name: &'static str,
    /// SI unit.
    pub unit: &'static str,
    /// Description, in a line.
    pub description: &'static str,
    /// Value; NaN where there is none.
    pub value: f64,
}

macro_rules! errors {
    ($($(#[$doc:meta])* $field:ident, $name:literal, $column:literal, $text:literal;)*) => {
        /// Relative errors of a run \[–\]; NaN where there is nothing to compare.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct Errors {
            $($(#[$doc])* pub $field: f64,)*
        }

        impl Errors {
            /// The larger of both, number by number; for the spread of several replicates.
            pub(super) fn larger(self, other: &Self) -> Self {
                Self { $($field: self.$field.max(other.$field),)* }
            }

            /// Errors of something that was not compared.
            pub(super) fn none() -> Self {
                Self { $($field: f64::NAN,)* }
            }

            /// Name and value of every error.
            pub fn columns(&self) -> [(&'static str, f64); 10] {
                [$(($name, self.$field)),*]
            }

            /// Every error as a column of the table of a study.
            pub fn numbers(&self) -> [Number; 10] {
                [$(Number { name: $column, unit: "1", description: $text, value: self.$field }),*]
            }
        }
    };
}

errors! {
    /// Tension of all spans at every moment up to the horizon: root mean square, over the mean tension.
    tension, "tension", "error_span_tension",
        "error of the span tensions up to the horizon, rms over the mean tension";
    /// The same of the tightest span.
    tight_tension, "tight_tension", "error_tight_span_tension",
        "error of the tightest span's tension up to the horizon, rms over the mean tension";
    /// Force between every roller and the teeth up to the horizon: root mean square, over that of the force.
    force, "contact_force", "error_contact_force",
        "error of the roller-tooth forces up to the horizon, rms over their rms";
    /// Rotation of the sprockets up to the horizon: root mean square, over the largest rotation.
    angle, "sprocket_angle", "error_sprocket_angle",
        "error of the sprockets' rotation up to the horizon, rms over the largest rotation";
    /// Mean tension over the whole window, of the span that differs most.
    mean, "tension_mean", "error_span_tension_mean",
        "error of the mean span tension over the window";
    /// Root mean square of the tension over the whole window, of the span that differs most.
    rms, "tension_rms", "error_span_tension_rms",
        "error of the root mean square of the span tension over the window";
    /// Median of the contact forces over the whole window.
    p50, "contact_force_p50", "error_contact_force_p50",
        "error of the median contact force over the window";
    /// 90th percentile of the contact forces over the whole window.
    p90, "contact_force_p90", "error_contact_force_p90",
        "error of the 90th percentile of the contact force over the window";
    /// 99th percentile of the contact forces over the whole window.
    p99, "contact_force_p99", "error_contact_force_p99",
        "error of the 99th percentile of the contact force over the window";
    /// Amplitude of the tight span's tension at the frequency of the passing teeth.
    mesh, "mesh_amplitude", "error_mesh_amplitude",
        "error of the tight span's amplitude at the frequency of the passing teeth";
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
        let pair = Pair::of(trace, from, strands);
        let samples = from.time.iter().take_while(|t| **t <= horizon).count();
        let distances = pair.distances();
        let inside = || distances.iter().take(samples);
        let [mean, rms_of_tension] = pair.moments();
        let [p50, p90, p99] = pair.percentiles();
        // Without the tension of a span there is no amplitude of it.
        let period = period.filter(|_| strands == Strands::Spans);
        Self {
            tension: rms(inside().map(|d| d.all)),
            tight_tension: rms(inside().map(|d| d.tight)),
            force: pair.first(samples).force(),
            angle: pair.first(samples).angle(),
            mean,
            rms: rms_of_tension,
            p50,
            p90,
            p99,
            mesh: period.map_or(f64::NAN, |period| pair.mesh(period)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Defect A3: a span that no roller holds agreed with everything.
    #[test]
    fn what_is_not_a_number_agrees_with_nothing() {
        let trace = |values: [f64; 4]| {
            let mut trace = Trace {
                time: vec![0.0, 1.0],
                ..Trace::default()
            };
            trace.spans.values = values.into();
            trace.spans.strands = 2;
            trace
        };
        let whole = trace([1.0, 2.0, 1.0, 2.0]);
        let torn = trace([1.0, 2.0, f64::NAN, 2.0]);
        for (of, from) in [(&whole, &torn), (&torn, &whole), (&torn, &torn)] {
            let pair = Pair::of(of, from, Strands::Spans);
            let found = pair.distances();
            assert!(found[0].all < 1e-12 && found[1].all.is_infinite());
            assert!(pair.moments().iter().all(|apart| *apart > 1e12));
        }
    }

    /// Twice the swing about the same mean: σ of 0, …, 100 is √((101² − 1)/12) = 29.15.
    #[test]
    fn scatter_is_compared_over_the_mean_tension() {
        let trace = |swing: f64| {
            let mut trace = Trace {
                time: (0..101).map(f64::from).collect(),
                ..Trace::default()
            };
            trace.spans.values = (0..101)
                .map(|i| 1000.0 + swing * f64::from(i - 50))
                .collect();
            trace.spans.strands = 1;
            trace
        };
        let [one, two] = [1.0, 2.0].map(trace);
        let [deviation, p1, p99] = Pair::of(&two, &one, Strands::Spans).scatter();
        assert!((deviation - 0.029_15).abs() < 1e-5, "{deviation}");
        assert!((p1 - 0.049).abs() < 1e-9 && (p99 - 0.049).abs() < 1e-9);
    }

    #[test]
    fn percentiles_of_a_hundred_numbers() {
        let sorted: Vec<f64> = (0..100).map(f64::from).collect();
        let found = PERCENTILES.map(|share| percentile(&sorted, share));
        assert!(
            found
                .iter()
                .zip([50.0, 90.0, 99.0])
                .all(|(a, b)| (a - b).abs() < 1e-12)
        );
        assert!(percentile(&[], 0.5).is_nan());
    }

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
