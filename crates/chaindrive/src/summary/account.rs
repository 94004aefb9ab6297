//! The account of a run: works, impulses and extremes of its steps, by whole periods of the slowest forcing.
//!
//! Means are those of whole periods, where there is one; a rest of a period would be a part of it. Extremes are those of the whole record, and of
//! every period by itself: the greatest of a record grows with its length, the median of those of its periods does not.

use chaindrive_mechanics::{DriveExtremes, Extremes, Flow, Place};
use serde::{Deserialize, Serialize};

use super::ConfidenceInterval;
use crate::Period;

/// Periods at which neighbours are joined.
const MOST: usize = 1024;

/// Sums over the periods of a run.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct Account {
    /// Whole periods together.
    whole: Option<Period>,
    /// What came after the last of them, where the run has ended.
    rest: Option<Period>,
    /// Greatest of every quantity, period by period.
    greatest: Vec<Vec<f64>>,
    /// Periods that each of these rows is of, and those of the row that is not complete.
    joined: usize,
    open: usize,
}

impl Account {
    /// Takes in a whole period.
    pub(super) fn push(&mut self, period: &Period) {
        self.whole = Some(match &self.whole {
            Some(whole) => whole.and(period),
            None => period.clone(),
        });
        let row: Vec<f64> = period.extremes.all().map(|it| it.greatest).collect();
        self.joined = self.joined.max(1);
        match self.greatest.last_mut().filter(|_| self.open > 0) {
            Some(last) => *last = greater(last, &row),
            None => self.greatest.push(row),
        }
        self.open = (self.open + 1) % self.joined;
        if self.greatest.len() == MOST && self.open == 0 {
            let pairs = self.greatest.chunks_exact(2);
            self.greatest = pairs.map(|pair| greater(&pair[0], &pair[1])).collect();
            self.joined *= 2;
        }
    }

    /// Ends with what was not handed out: periods of a length \[s\], and the rest of one.
    pub(super) fn end(&mut self, outstanding: Vec<Period>, length: f64) {
        for period in outstanding {
            // A record that ends with a period has it whole, but for rounding.
            if period.length() > (1.0 - 1e-9) * length {
                self.push(&period);
            } else {
                self.rest = Some(period);
            }
        }
    }

    /// What means are those of: whole periods, or else all there is.
    pub(super) fn of_means(&self) -> Option<&Period> {
        self.whole.as_ref().or(self.rest.as_ref())
    }

    /// Extremes of the record.
    pub(super) fn extremes(&self) -> Option<DriveExtremes> {
        let mut periods = self.whole.iter().chain(&self.rest);
        let mut extremes = periods.next()?.extremes.clone();
        periods.for_each(|it| extremes.take(&it.extremes));
        Some(extremes)
    }

    /// Median of the greatest value of every period, by the place of the quantity among [all](DriveExtremes::all); none without a period.
    pub(super) fn usual_greatest(&self, place: usize) -> Option<ConfidenceInterval> {
        let complete = self.greatest.len() - usize::from(self.open > 0);
        let rows = self.greatest[..complete].iter();
        median(
            rows.map(|row| row[place])
                .filter(|it| it.is_finite())
                .collect(),
        )
    }
}

/// Energy that came in, went out and was lost in whole periods of the slowest forcing, or in all of a shorter record.
#[derive(Clone, Debug, PartialEq)]
pub struct Balance {
    /// How long \[s\].
    pub time: f64,
    /// Whether these are whole periods.
    pub is_whole: bool,
    /// Energy put in by those who put in more than they took \[J\].
    pub supplied: f64,
    /// Energy taken by those who took more \[J\].
    pub delivered: f64,
    /// Energy lost, by place, where there is any \[J\].
    pub losses: Vec<(Place, f64)>,
}

impl Balance {
    /// Energy lost everywhere \[J\].
    pub fn lost(&self) -> f64 {
        self.losses.iter().map(|(_, lost)| lost).sum()
    }

    /// Energy that stays in motion, height and springs, with what is unaccounted for \[J\].
    pub fn kept(&self) -> f64 {
        self.supplied - self.delivered - self.lost()
    }
}

impl Account {
    /// The energies of what means are those of; none before there is any.
    pub(super) fn balance(&self) -> Option<Balance> {
        let period = self.of_means()?;
        let [start, end] = &period.energy;
        let outside = Flow::ALL.iter().filter(|flow| !flow.is_loss());
        let works = || {
            outside
                .clone()
                .map(|flow| end.flow(*flow) - start.flow(*flow))
        };
        let losses = end.losses().into_iter().zip(start.losses());
        let losses = Place::ALL.into_iter().zip(losses);
        Some(Balance {
            time: period.length(),
            is_whole: self.whole.is_some(),
            supplied: works().filter(|work| *work > 0.0).sum(),
            delivered: -works().filter(|work| *work < 0.0).sum::<f64>(),
            losses: losses
                .map(|(place, (end, start))| (place, end - start))
                .filter(|(_, lost)| *lost != 0.0)
                .collect(),
        })
    }
}

/// Place of a quantity among [all](DriveExtremes::all) that are watched.
pub(super) fn place_of(all: &DriveExtremes, one: &Extremes) -> Option<usize> {
    all.all().position(|it| std::ptr::eq(it, one))
}

fn greater(one: &[f64], other: &[f64]) -> Vec<f64> {
    one.iter().zip(other).map(|(a, b)| a.max(*b)).collect()
}

/// The median of some values, with the half width of its 95 % interval, not a number where they are too few.
///
/// ```text
/// P(x₍ₗ₎ ≤ m ≤ x₍ₙ₋ₗ₊₁₎) = 1 − 2 Σ_{i<l} (n over i)/2ⁿ ≥ 0.95
/// ```
///
/// Whatever their distribution. The half width is that of the farther end.
///
/// # Source
/// W. R. Thompson, *Annals of Mathematical Statistics* **7**, 1936, 122–128.
fn median(mut values: Vec<f64>) -> Option<ConfidenceInterval> {
    values.sort_by(f64::total_cmp);
    let n = values.len();
    let middle = |k: usize| values.get(k).copied();
    let value = 0.5 * (middle(n.checked_sub(1)? / 2)? + middle(n / 2)?);
    // (n over i)/2ⁿ, one after the other, from the logarithm of the first.
    let mut log = -(n as f64) * std::f64::consts::LN_2;
    let (mut below, mut rank) = (log.exp(), 0);
    while below <= 0.025 && rank < n / 2 {
        rank += 1;
        log += ((n - rank + 1) as f64 / rank as f64).ln();
        below += log.exp();
    }
    let half_width = match rank.checked_sub(1) {
        Some(first) => (value - values[first]).max(values[n - 1 - first] - value),
        None => f64::NAN,
    };
    Some(ConfidenceInterval { value, half_width })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Published: ranks of 95 % intervals of a median, table A-33 of W. J. Conover, *Practical Nonparametric Statistics*: 6 values 1 and 6,
    /// 10 values 2 and 9, 20 values 6 and 15, 50 values 18 and 33.
    #[test]
    fn ranks_are_those_of_the_tables() {
        for (n, low) in [(6, 1), (8, 1), (9, 2), (10, 2), (20, 6), (50, 18)] {
            let values: Vec<f64> = (1..=n).map(f64::from).collect();
            let found = median(values).unwrap();
            let middle = 0.5 * f64::from(n + 1);
            assert!((found.value - middle).abs() < 1e-12);
            let first = middle - found.half_width;
            assert!((first - f64::from(low)).abs() < 1e-9, "{n}: {first}");
        }
        assert!(median(vec![1.0; 5]).unwrap().half_width.is_nan());
        assert!(median(Vec::new()).is_none());
    }
}
