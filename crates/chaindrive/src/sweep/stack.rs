//! Stacks the accounts of all variants: one array a quantity, the swept dimensions first.

use super::layout::Layout;
use super::texts::{OPEN, TEXTS};
use super::{Account, Coordinate, Entry, Outcome, Quantity, Sweep};

/// One text of all variants.
#[derive(Clone, Debug, PartialEq)]
pub struct StackedText {
    /// Name in results.
    pub name: &'static str,
    /// One line of description.
    pub description: &'static str,
    /// The text of each variant, perhaps empty.
    pub texts: Vec<String>,
}

/// One quantity of all variants.
#[derive(Clone, Debug, PartialEq)]
pub struct StackedQuantity {
    /// Which.
    pub quantity: Quantity,
    /// SI unit; of several, where variants differ in it, all of them.
    pub unit: String,
    /// Names of all dimensions, the swept ones first.
    pub dims: Vec<String>,
    /// Entries along each.
    pub shape: Vec<usize>,
    /// Entries, the last dimension fastest; NaN where there is none.
    pub values: Vec<f64>,
}

/// A sweep as labelled arrays.
#[derive(Clone, Debug, PartialEq)]
pub struct Stacked {
    /// Variants along each of their dimensions.
    pub shape: Vec<usize>,
    /// Sample times \[s\], of the longest run; none without channels.
    pub time: Option<Vec<f64>>,
    /// Labels of the dimensions that are neither swept nor time.
    pub labels: Vec<(String, Coordinate)>,
    /// The quantities.
    pub quantities: Vec<StackedQuantity>,
    /// The verdict on every variant, and what went wrong.
    pub texts: Vec<StackedText>,
    /// Methods of time stepping that were used.
    pub methods: Vec<String>,
}

impl Sweep {
    /// Stacks the outcomes of all variants, in their order. Runs that sample longer than others, or have
    /// more links, decide about the size of the arrays; what the others do not have is NaN.
    pub fn stack(&self, outcomes: &[Outcome]) -> Stacked {
        let layout = Layout::of(self, outcomes);
        let stack = |(name, units): &(String, Vec<String>)| {
            let quantity = Quantity::from_name(name)?;
            let (mut dims, mut shape) = (self.dims(), layout.shape.clone());
            for beside in layout.beside(quantity) {
                dims.push(beside.name);
                shape.push(beside.len);
            }
            let labels = layout.axis(quantity).map(|axis| axis.labels.as_slice());
            let mut values = vec![f64::NAN; shape.iter().product()];
            let block = shape[layout.shape.len()..].iter().product::<usize>().max(1);
            for (outcome, to) in outcomes.iter().zip(values.chunks_mut(block)) {
                if let Outcome::Done(account) = outcome {
                    fill(account, quantity, labels, to);
                }
            }
            Some(StackedQuantity {
                quantity,
                unit: units.join(" or "),
                dims: dims.into_iter().map(str::to_owned).collect(),
                shape,
                values,
            })
        };
        let quantities: Vec<_> = layout.quantities.iter().filter_map(stack).collect();
        let axes = layout.axes.iter();
        let mut labels: Vec<_> = axes.map(|it| (it.name.clone(), it.coordinate())).collect();
        // Where no variant has a label, the dimension is there all the same.
        for along in quantities.iter().filter_map(|it| it.quantity.along()) {
            if labels.iter().all(|(name, _)| name != along) {
                labels.push((along.to_owned(), Coordinate::Texts(Vec::new())));
            }
        }
        let sampled = quantities.iter().any(|it| it.quantity.is_sampled());
        let of_variants = outcomes.iter().map(texts);
        let texts = TEXTS.iter().enumerate();
        let texts = texts.map(|(index, &(name, description))| StackedText {
            name,
            description,
            texts: of_variants.clone().map(|of| of[index].to_owned()).collect(),
        });
        Stacked {
            shape: layout.shape,
            time: sampled.then_some(layout.time),
            labels,
            quantities,
            texts: texts.collect(),
            methods: layout.methods,
        }
    }
}

/// The texts of one variant, in the order of [`TEXTS`].
pub(crate) fn texts(outcome: &Outcome) -> [&str; TEXTS.len()] {
    match outcome {
        Outcome::Done(Account { verdict, .. }) => {
            [&verdict.verdict, &verdict.reasons, &verdict.note, ""]
        }
        Outcome::Failed(message) => ["", "", "", message],
        Outcome::Open => ["", "", "", OPEN],
    }
}

/// Puts the entries of one account where their labels are in the stack.
pub(crate) fn fill(
    account: &Account,
    quantity: Quantity,
    width: Option<&[String]>,
    to: &mut [f64],
) {
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
