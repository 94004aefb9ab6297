//! Values over times, or over other arguments, joined by a spline or by straight lines.

use crate::DriveError;
use crate::kinematics::Kinematics;

/// A natural cubic spline through (tᵢ, xᵢ): twice continuously differentiable.
///
/// Outside its times the coordinate goes on at the rate of the nearest end.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    times: Vec<f64>,
    values: Vec<f64>,
    /// Second derivatives at the knots.
    curvatures: Vec<f64>,
}

impl Table {
    /// Joins `values` \[m or rad\] at `times` \[s\].
    ///
    /// # Errors
    /// Fewer than two points, lengths that differ, times that do not increase, or numbers that
    /// are not finite.
    pub fn new(times: Vec<f64>, values: Vec<f64>) -> Result<Self, DriveError> {
        let n = times.len();
        if n < 2 || n != values.len() {
            return Err(DriveError::Table {
                problem: format!(
                    "{n} times and {} values; give at least two of each, and as many",
                    values.len()
                ),
            });
        }
        if let Some(i) = (0..n).find(|&i| !(times[i].is_finite() && values[i].is_finite())) {
            return Err(DriveError::Table {
                problem: format!("entry {i} is not finite"),
            });
        }
        if let Some(i) = (1..n).find(|&i| times[i] <= times[i - 1]) {
            return Err(DriveError::Table {
                problem: format!("times must increase, but entry {i} does not"),
            });
        }
        let curvatures = natural_spline(&times, &values);
        Ok(Self {
            times,
            values,
            curvatures,
        })
    }

    /// The curve at `t`, not shifted.
    pub fn value(&self, t: f64) -> Kinematics {
        let n = self.times.len();
        let (first, last) = (self.times[0], self.times[n - 1]);
        if t < first || t > last {
            let edge = self.value(t.clamp(first, last));
            let beyond = t - t.clamp(first, last);
            return Kinematics {
                position: edge.position + edge.rate * beyond,
                rate: edge.rate,
                acceleration: 0.0,
            };
        }
        let i = self
            .times
            .partition_point(|&knot| knot <= t)
            .clamp(1, n - 1);
        let width = self.times[i] - self.times[i - 1];
        let b = (t - self.times[i - 1]) / width;
        let a = 1.0 - b;
        let (x0, x1) = (self.values[i - 1], self.values[i]);
        let (m0, m1) = (self.curvatures[i - 1], self.curvatures[i]);
        // x = a x₀ + b x₁ + ((a³ − a) m₀ + (b³ − b) m₁) w²/6
        Kinematics {
            position: a * x0
                + b * x1
                + ((a * a * a - a) * m0 + (b * b * b - b) * m1) * width * width / 6.0,
            rate: (x1 - x0) / width
                + ((3.0 * b * b - 1.0) * m1 - (3.0 * a * a - 1.0) * m0) * width / 6.0,
            acceleration: a * m0 + b * m1,
        }
    }

    /// Straight lines between the points, the end values beyond the ends.
    pub fn polyline(&self, t: f64) -> f64 {
        let last = self.times.len() - 1;
        let i = self.times.partition_point(|&knot| knot <= t).clamp(1, last);
        let share = (t - self.times[i - 1]) / (self.times[i] - self.times[i - 1]);
        let share = share.clamp(0.0, 1.0);
        // x = (1 − s) x₀ + s x₁
        (1.0 - share) * self.values[i - 1] + share * self.values[i]
    }

    /// Its times, or other arguments.
    pub(crate) fn arguments(&self) -> &[f64] {
        &self.times
    }

    /// Mean of the straight lines between its ends.
    pub(crate) fn polyline_mean(&self) -> f64 {
        let pieces = self.times.windows(2).zip(self.values.windows(2));
        // Σ ½ (x₀ + x₁) w / Σ w
        let area: f64 = pieces
            .map(|(times, values)| 0.5 * (values[0] + values[1]) * (times[1] - times[0]))
            .sum();
        area / (self.times[self.times.len() - 1] - self.times[0])
    }

    /// The first of its times after t.
    pub(crate) fn next_knot(&self, t: f64) -> Option<f64> {
        let next = self.times.partition_point(|&knot| knot <= t);
        self.times.get(next).copied()
    }

    /// The curve counted from where it is at t = 0.
    pub(crate) fn at(&self, t: f64) -> Kinematics {
        let kinematics = self.value(t);
        Kinematics {
            position: kinematics.position - self.value(0.0).position,
            ..kinematics
        }
    }
}

/// Second derivatives of the natural spline, by the tridiagonal recurrence.
fn natural_spline(times: &[f64], values: &[f64]) -> Vec<f64> {
    let n = times.len();
    let mut curvature = vec![0.0; n];
    let mut upper = vec![0.0; n];
    for i in 1..n - 1 {
        let (w0, w1) = (times[i] - times[i - 1], times[i + 1] - times[i]);
        // w₀ m₋ + 2 (w₀ + w₁) m + w₁ m₊ = 6 (Δ₊/w₁ − Δ₋/w₀)
        let jump = 6.0 * ((values[i + 1] - values[i]) / w1 - (values[i] - values[i - 1]) / w0);
        let pivot = 2.0 * (w0 + w1) - w0 * upper[i - 1];
        upper[i] = w1 / pivot;
        curvature[i] = (jump - w0 * curvature[i - 1]) / pivot;
    }
    for i in (1..n - 1).rev() {
        curvature[i] -= upper[i] * curvature[i + 1];
    }
    curvature
}
