//! A motion whose speed goes along straight lines between given times.

use crate::DriveError;
use crate::kinematics::Kinematics;
use crate::table::Table;

/// Speeds (tᵢ, vᵢ) joined by straight lines, held beyond the ends; the coordinate is their integral, counted from t = 0.
///
/// ```text
/// v = v₀ + a (t − t₀),   x = x₀ + v₀ (t − t₀) + ½ a (t − t₀)²,   a = (v₁ − v₀)/(t₁ − t₀)
/// ```
///
/// It never overshoots, as a [`Table`] of positions does: where two neighbouring speeds are zero the coordinate stands still. Accelerations jump
/// at the times, speeds do not.
#[derive(Clone, Debug, PartialEq)]
pub struct SpeedTable {
    speeds: Table,
    /// Way from the first time to each \[m or rad\].
    ways: Vec<f64>,
}

impl SpeedTable {
    /// Joins `speeds` \[m/s or rad/s\] at `times` \[s\].
    ///
    /// # Errors
    /// Those of [`Table::new`].
    pub fn new(times: Vec<f64>, speeds: Vec<f64>) -> Result<Self, DriveError> {
        let pieces = times.windows(2).zip(speeds.windows(2));
        let mut ways = vec![0.0];
        for (t, v) in pieces {
            // ½ (v₀ + v₁) (t₁ − t₀)
            let way = v[0].midpoint(v[1]) * (t[1] - t[0]);
            ways.push(ways.last().copied().unwrap_or(0.0) + way);
        }
        let speeds = Table::new(times, speeds)?;
        Ok(Self { speeds, ways })
    }

    /// Position counted from t = 0, rate and acceleration at time `t` \[s\].
    pub(crate) fn at(&self, t: f64) -> Kinematics {
        let there = self.since_first(t);
        Kinematics {
            position: there.position - self.since_first(0.0).position,
            ..there
        }
    }

    /// The first of its times after t.
    pub(crate) fn next_knot(&self, t: f64) -> Option<f64> {
        self.speeds.next_knot(t)
    }

    /// The same with the position counted from the first time.
    fn since_first(&self, t: f64) -> Kinematics {
        let times = self.speeds.arguments();
        let last = times.len() - 1;
        let begun = times.partition_point(|&knot| knot <= t);
        let piece = begun.saturating_sub(1);
        let (since, first) = (times[piece], self.speeds.polyline(times[piece]));
        let acceleration = if begun == 0 || piece == last {
            0.0
        } else {
            (self.speeds.polyline(times[piece + 1]) - first) / (times[piece + 1] - since)
        };
        let after = t - since;
        // x = x₀ + v₀ τ + ½ a τ²
        Kinematics {
            position: self.ways[piece] + (first + 0.5 * acceleration * after) * after,
            rate: first + acceleration * after,
            acceleration,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A centre that stands, moves by 3 mm within a second, and stands again; it never leaves the way between.
    fn held_moved_held() -> SpeedTable {
        SpeedTable::new(vec![1.0, 1.5, 2.0], vec![0.0, 6e-3, 0.0]).expect("times increase")
    }

    #[test]
    fn what_is_held_stands_still() {
        let table = held_moved_held();
        for (t, position) in [
            (-1.0, 0.0),
            (0.0, 0.0),
            (1.0, 0.0),
            (1.5, 1.5e-3),
            (2.0, 3e-3),
            (9.0, 3e-3),
        ] {
            assert!((table.at(t).position - position).abs() < 1e-17, "{t}");
        }
        let mut before = 0.0;
        for place in 0..300 {
            let now = table.at(0.01 * f64::from(place)).position;
            assert!((before..=3e-3 + 1e-17).contains(&now));
            before = now;
        }
    }

    /// Slopes by central differences, exact for parabolas but for rounding.
    #[test]
    fn rates_are_the_slopes_of_positions() {
        let table =
            SpeedTable::new(vec![-0.5, 0.25, 1.0], vec![2.0, -1.0, 4.0]).expect("times increase");
        for t in [-0.7, -0.2, 0.1, 0.6, 1.3] {
            let [before, now, after] = [-1e-5, 0.0, 1e-5].map(|away| table.at(t + away));
            assert!(
                ((after.position - before.position) / 2e-5 - now.rate).abs() < 1e-9,
                "{t}"
            );
            assert!(
                ((after.rate - before.rate) / 2e-5 - now.acceleration).abs() < 1e-9,
                "{t}"
            );
        }
        assert_eq!(
            [-0.6, 0.25, 1.0].map(|t| table.next_knot(t)),
            [Some(-0.5), Some(1.0), None]
        );
    }
}
