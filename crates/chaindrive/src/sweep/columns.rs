//! Figures of a variant that the report of a sweep has.

use super::{Account, Quantity, Statistic};
use crate::figure::with_digits;

/// A figure of a variant.
pub(super) struct Column {
    pub(super) heading: &'static str,
    pub(super) read: fn(&Account) -> f64,
}

/// The columns of the table.
pub(super) const COLUMNS: [Column; 6] = [
    Column {
        heading: "span max [N]",
        read: |account| account.largest(Statistic::SpanTensionMax),
    },
    Column {
        heading: "span std [N]",
        read: |account| account.largest(Statistic::SpanTensionStd),
    },
    Column {
        heading: "contact max [N]",
        read: |account| account.largest(Statistic::ContactForceMax),
    },
    Column {
        heading: "dissipated [J]",
        read: |account| account.largest(Statistic::EnergyDissipated),
    },
    Column {
        heading: "unaccounted [J]",
        read: |account| account.largest(Statistic::EnergyResidualMax).abs(),
    },
    Column {
        heading: "× real time",
        read: |account| account.largest(Statistic::RealTimeFactor),
    },
];

impl Account {
    /// Whether no method on the list kept the accuracy that was asked for.
    pub(super) fn misses(&self) -> bool {
        self.largest(Statistic::AccuracyKept) < 1.0
    }

    /// The largest entry of a statistic; NaN when there is none.
    fn largest(&self, statistic: Statistic) -> f64 {
        let quantity = Quantity::Statistic(statistic);
        let found = self.entries.iter().find(|it| it.quantity == quantity);
        let values = found.map_or(&[] as &[f64], |entry| &entry.values);
        values.iter().copied().fold(f64::NAN, f64::max)
    }
}

/// Five digits.
pub(super) fn short(number: f64) -> String {
    with_digits(number, 5)
}
