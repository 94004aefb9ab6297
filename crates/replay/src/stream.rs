//! Arrays as bytes: quantised, differenced, cut into planes and deflated.
//!
//! ```text
//! v ──► q = round((v − v₀) / quantum) ──► differences ──► zigzag ──► byte planes ──► deflate
//! ```
//!
//! Values come back within half a quantum. Differences of some order in time and across the columns are whole numbers
//! again, so nothing more is lost; the order that packs best is found by trying.

use std::io::Write;

use flate2::Compression;
use flate2::write::DeflateEncoder;
use serde::Serialize;

/// Quanta between zero and the largest magnitude of a channel that colours or arrows show.
pub(crate) const LEVELS: f64 = 400.0;

/// Quanta between the least and the largest value of a curve, whose scale is stretched to its range.
pub(crate) const LEVELS_OF_CURVES: f64 = 2000.0;

/// Filters to undo, and the position of the bytes.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Stream {
    name: String,
    rows: usize,
    columns: usize,
    quantum: f64,
    origin: f64,
    /// Order of the differences in time, and across columns.
    order: [u8; 2],
    /// Bytes of a number.
    planes: usize,
    /// The whole number that stands for what is no number, if there is any.
    missing: Option<i64>,
    /// Place in the packed bytes.
    at: usize,
    length: usize,
}

impl Stream {
    pub(crate) fn is_called(&self, name: &str) -> bool {
        self.name == name
    }
}

/// Packed arrays, one after the other.
#[derive(Debug, Default)]
pub(crate) struct Streams {
    pub(crate) index: Vec<Stream>,
    pub(crate) bytes: Vec<u8>,
}

impl Streams {
    /// Packs an array (rows, columns), so that values come back within half a quantum.
    pub(crate) fn push(&mut self, name: &str, values: &[f64], columns: usize, quantum: f64) {
        let rows = values.len().checked_div(columns).unwrap_or(0);
        let quantised = QuantisedSeries::new(values, quantum);
        let (mut best, mut least) = ([0, 0], usize::MAX);
        for order in [[0, 0], [1, 0], [2, 0], [0, 1], [1, 1], [2, 1]] {
            let (bytes, _) = planes(&differences(&quantised.whole, columns, order));
            let size = deflate(&bytes, Compression::fast()).len();
            if size < least {
                (best, least) = (order, size);
            }
        }
        let (bytes, planes) = planes(&differences(&quantised.whole, columns, best));
        let packed = deflate(&bytes, Compression::best());
        self.index.push(Stream {
            name: name.to_owned(),
            rows,
            columns,
            quantum: quantised.quantum,
            origin: quantised.origin,
            order: best,
            planes,
            missing: quantised.missing,
            at: self.bytes.len(),
            length: packed.len(),
        });
        self.bytes.extend(packed);
    }

    /// Packs a channel by the quantum of channels.
    pub(crate) fn push_channel(&mut self, name: &str, values: &[f64], columns: usize) {
        let finite = values.iter().filter(|value| value.is_finite());
        let largest = finite.fold(0.0_f64, |most, value| most.max(value.abs()));
        self.push(name, values, columns, largest / LEVELS);
    }

    /// Packs the values of one curve.
    pub(crate) fn push_curve(&mut self, name: &str, values: &[f64]) {
        let finite = || values.iter().copied().filter(|value| value.is_finite());
        let least = finite().fold(f64::INFINITY, f64::min);
        let most = finite().fold(f64::NEG_INFINITY, f64::max);
        let range = if least < most { most - least } else { 0.0 };
        // What varies by rounding alone is as good as constant, and keeps its digits.
        let floor = 1e-9 * least.abs().max(most.abs());
        let quantum = if floor.is_finite() {
            (range / LEVELS_OF_CURVES).max(floor)
        } else {
            0.0
        };
        self.push(name, values, 1, quantum);
    }
}

/// Values as whole multiples of a quantum about an origin.
struct QuantisedSeries {
    whole: Vec<i64>,
    origin: f64,
    quantum: f64,
    missing: Option<i64>,
}

impl QuantisedSeries {
    /// The origin lies in the middle of the values, where the numbers are smallest.
    fn new(values: &[f64], quantum: f64) -> Self {
        let finite = || values.iter().copied().filter(|value| value.is_finite());
        let least = finite().fold(f64::INFINITY, f64::min);
        let most = finite().fold(f64::NEG_INFINITY, f64::max);
        // An array of zeros has no largest value to take a share of.
        let quantum = if quantum > 0.0 { quantum } else { 1.0 };
        // A multiple of the quantum, so that zero and whole numbers stay what they are.
        let middle = if least <= most {
            0.5 * (least + most)
        } else {
            0.0
        };
        let origin = (middle / quantum).round() * quantum;
        #[expect(
            clippy::cast_possible_truncation,
            reason = "a range of values divided by a share of itself"
        )]
        let whole = |value: f64| ((value - origin) / quantum).round() as i64;
        let has_gaps = values.iter().any(|value| !value.is_finite());
        let missing = has_gaps.then(|| if least <= most { whole(least) - 1 } else { -1 });
        let quantised = |&value: &f64| match missing {
            Some(missing) if !value.is_finite() => missing,
            _ => whole(value),
        };
        Self {
            whole: values.iter().map(quantised).collect(),
            origin,
            quantum,
            missing,
        }
    }
}

/// Differences of an array (rows, columns), column by column.
fn differences(whole: &[i64], columns: usize, [in_time, across]: [u8; 2]) -> Vec<i64> {
    let rows = whole.len().checked_div(columns).unwrap_or(0);
    let mut turned = Vec::with_capacity(whole.len());
    for column in 0..columns {
        turned.extend((0..rows).map(|row| whole[row * columns + column]));
    }
    for _ in 0..across {
        for at in (rows..turned.len()).rev() {
            turned[at] -= turned[at - rows];
        }
    }
    for series in turned.chunks_mut(rows.max(1)) {
        for _ in 0..in_time {
            for at in (1..series.len()).rev() {
                series[at] -= series[at - 1];
            }
        }
    }
    turned
}

/// The bytes of the numbers, lowest first, each kind of byte by itself; signs go into the lowest bit.
fn planes(numbers: &[i64]) -> (Vec<u8>, usize) {
    // zigzag: 0, −1, 1, −2, … ↦ 0, 1, 2, 3, …
    let zigzag = |number: i64| ((number << 1) ^ (number >> 63)).cast_unsigned();
    let most = numbers.iter().map(|&it| zigzag(it)).max().unwrap_or(0);
    let count = (64 - most.leading_zeros() as usize).div_ceil(8).max(1);
    let plane = |place: usize| {
        numbers
            .iter()
            .map(move |&it| zigzag(it).to_le_bytes()[place])
    };
    ((0..count).flat_map(plane).collect(), count)
}

fn deflate(bytes: &[u8], level: Compression) -> Vec<u8> {
    let mut encoder = DeflateEncoder::new(Vec::new(), level);
    let written = encoder.write_all(bytes).and_then(|()| encoder.finish());
    written.expect("memory takes all that is written")
}

#[cfg(test)]
mod tests;
