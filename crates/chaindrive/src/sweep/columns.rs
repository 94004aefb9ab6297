//! Figures of a variant that the report of a sweep has.

use super::{Account, ResultQuantity};
use crate::figure::with_digits;
use crate::statistic::Statistic;

/// A figure of a variant.
pub(super) struct Column {
    pub(super) heading: &'static str,
    pub(super) read: fn(&Account) -> f64,
}

macro_rules! columns {
    ($($heading:literal, $read:expr;)*) => {
        /// The columns of the table.
        pub(super) const COLUMNS: [Column; 6] = [$(Column { heading: $heading, read: $read }),*];
    };
}

columns! {
    "span max [N]", |it| it.largest(Statistic::SpanTensionMax);
    "span std [N]", |it| it.largest(Statistic::SpanTensionStd);
    "contact max [N]", |it| it.largest(Statistic::ContactForceMax);
    "dissipated [J]", |it| it.largest(Statistic::EnergyDissipated);
    "unaccounted [J]", |it| it.largest(Statistic::EnergyResidualMax).abs();
    "× real time", |it| it.largest(Statistic::RealTimeFactor);
}

impl Account {
    /// Whether no method of the list kept the accuracy asked for.
    pub(super) fn misses(&self) -> bool {
        self.largest(Statistic::AccuracyKept) < 1.0
    }

    /// The largest entry of a statistic; NaN when there is none.
    fn largest(&self, statistic: Statistic) -> f64 {
        let quantity = ResultQuantity::Statistic(statistic);
        let found = self.entries.iter().find(|it| it.quantity == quantity);
        let values = found.map_or(&[] as &[f64], |entry| &entry.values);
        values.iter().copied().fold(f64::NAN, f64::max)
    }
}

/// Five digits.
pub(super) fn short(number: f64) -> String {
    with_digits(number, 5)
}
