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
    let mut forces = super::forces();
    for (value, count) in Vec::<(u64, u64)>::deserialize(from)? {
        forces.record_n(value, count).map_err(D::Error::custom)?;
    }
    Ok(forces)
}
