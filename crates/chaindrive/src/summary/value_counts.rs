//! A histogram as the values that it counted, each with its number.

use hdrhistogram::Histogram;
use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Writes down (value, count) of every class that is not empty.
pub(super) fn serialize<S: Serializer>(of: &Histogram<u64>, to: S) -> Result<S::Ok, S::Error> {
    let classes = of.iter_recorded();
    let classes = classes.map(|it| (it.value_iterated_to(), it.count_at_value()));
    classes.collect::<Vec<(u64, u64)>>().serialize(to)
}

/// Counts them again, into the same classes.
pub(super) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Histogram<u64>, D::Error> {
    let mut forces = super::histogram();
    for (value, count) in Vec::<(u64, u64)>::deserialize(from)? {
        forces.record_n(value, count).map_err(D::Error::custom)?;
    }
    Ok(forces)
}

/// Counts a value, not negative, to three digits; less than one counts as one.
pub(super) fn note(histogram: &mut Histogram<u64>, value: f64) {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "positive, and far below 2^64"
    )]
    let count = value as u64;
    histogram.record(count.max(1)).ok();
}
