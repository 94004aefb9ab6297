//! Chunks of a region: numbers and texts of its variants, where the arrays have them.

use super::layout::{Layout, Region};
use super::texts::{OPEN, TEXTS, blank};
use super::{Account, Entry, Outcome, ResultQuantity};

/// The chunks of a quantity in a region, each with its place: one, or several where the array is cut along time or labels.
///
/// Missing values are NaN. Stretches of time without any value are left out.
pub(super) fn numbers(
    layout: &Layout,
    region: &Region,
    quantity: ResultQuantity,
    outcomes: &[Outcome],
) -> Vec<(Vec<u64>, Vec<f64>)> {
    let axis = layout.axis(quantity);
    let labels = axis.map(|axis| axis.labels.as_slice());
    if quantity.along().is_some() && labels.is_none_or(<[_]>::is_empty) {
        return Vec::new();
    }
    let (width, wide) = axis.map_or((1, 1), |axis| (axis.labels.len(), axis.cut));
    let sampled = quantity.is_sampled();
    let samples = outcomes.iter().map(|outcome| match outcome {
        Outcome::Done(account) => account.time.len(),
        Outcome::Failed(_) | Outcome::Open => 0,
    });
    let (length, long) = if sampled {
        (samples.max().unwrap_or(0), layout.samples.max(1))
    } else {
        (1, 1)
    };
    let (along, across) = (length.div_ceil(long), width.div_ceil(wide));
    let chunk = |number: usize| {
        let mut place = region.place.clone();
        place.extend(sampled.then_some((number / across) as u64));
        place.extend(axis.map(|_| (number % across) as u64));
        (place, vec![f64::NAN; layout.block() * long * wide])
    };
    let mut chunks: Vec<_> = (0..along * across).map(chunk).collect();
    let mut rows = vec![f64::NAN; length * width];
    for ((_, local), outcome) in region.variants.iter().zip(outcomes) {
        let Outcome::Done(account) = outcome else {
            continue;
        };
        rows.fill(f64::NAN);
        fill(account, quantity, labels, &mut rows);
        for (row, values) in rows.chunks(width).enumerate() {
            for (column, values) in values.chunks(wide).enumerate() {
                let (_, chunk) = &mut chunks[row / long * across + column];
                let at = (local * long + row % long) * wide;
                chunk[at..at + values.len()].copy_from_slice(values);
            }
        }
    }
    chunks
}

/// Puts the entries of one account where their labels are.
fn fill(account: &Account, quantity: ResultQuantity, width: Option<&[String]>, to: &mut [f64]) {
    let mut entries = account.entries.iter();
    let Some(Entry { values, .. }) = entries.find(|entry| entry.quantity == quantity) else {
        return;
    };
    let (Some(along), Some(labels)) = (quantity.along(), width) else {
        to[..values.len()].copy_from_slice(values);
        return;
    };
    let own = account.labels_along(along).unwrap_or_default();
    if own.is_empty() {
        return;
    }
    let places: Vec<Option<usize>> = own
        .iter()
        .map(|label| labels.iter().position(|known| known == label))
        .collect();
    for (row, to) in values.chunks(own.len()).zip(to.chunks_mut(labels.len())) {
        for (value, place) in row.iter().zip(&places) {
            if let Some(place) = place {
                to[*place] = *value;
            }
        }
    }
}

/// The chunk of a text in a region.
pub(super) fn texts(
    layout: &Layout,
    region: &Region,
    name: &str,
    outcomes: &[Outcome],
) -> Vec<String> {
    let index = TEXTS.iter().position(|(known, _)| *known == name);
    let mut chunk = vec![blank(name).to_owned(); layout.block()];
    for ((_, local), outcome) in region.variants.iter().zip(outcomes) {
        let of_variant = match outcome {
            Outcome::Done(Account { verdict, .. }) => [
                &verdict.verdict,
                &verdict.reasons,
                &verdict.note,
                &verdict.chains.verdict,
                &verdict.chains.reasons,
                &verdict.chains.note,
                "",
            ],
            Outcome::Failed(message) => ["", "", "", "", "", "", message],
            Outcome::Open => ["", "", "", "", "", "", OPEN],
        };
        index
            .map_or("", |index| of_variant[index])
            .clone_into(&mut chunk[*local]);
    }
    chunk
}
