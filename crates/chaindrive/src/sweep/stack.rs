//! Stacks the accounts of all variants: one array a quantity, the swept dimensions first.

use super::texts::{OPEN, TEXTS};
use super::{Account, Coordinate, Entry, Outcome, Quantity, Statistic, Sweep};
use crate::Axis;

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
        let (shape, names) = (self.shape(), self.dims());
        let accounts: Vec<Option<&Account>> = outcomes
            .iter()
            .map(|outcome| match outcome {
                Outcome::Done(account) => Some(account),
                Outcome::Failed(_) | Outcome::Open => None,
            })
            .collect();
        let time = longest(&accounts);
        let labels = all_labels(&accounts);
        let stack = |quantity: Quantity| {
            let width = quantity.along().map(|along| {
                let found = labels.iter().find(|(name, _)| name == along);
                found.map_or(&[] as &[String], |(_, labels)| labels.as_slice())
            });
            let mut dims: Vec<String> = names.iter().map(|&name| name.to_owned()).collect();
            let mut sizes = shape.clone();
            if quantity.is_sampled() {
                dims.push("time".into());
                sizes.push(time.len());
            }
            if let (Some(along), Some(labels)) = (quantity.along(), width) {
                dims.push(along.to_owned());
                sizes.push(labels.len());
            }
            let mut values = vec![f64::NAN; sizes.iter().product()];
            let block = sizes[shape.len()..].iter().product::<usize>().max(1);
            for (account, to) in accounts.iter().zip(values.chunks_mut(block)) {
                if let Some(account) = account {
                    fill(account, quantity, width, to);
                }
            }
            StackedQuantity {
                quantity,
                unit: unit(&accounts, quantity),
                dims,
                shape: sizes,
                values,
            }
        };
        let quantities: Vec<_> = quantities(&accounts).into_iter().map(stack).collect();
        let sampled = quantities.iter().any(|it| it.quantity.is_sampled());
        let of_variants = outcomes.iter().map(texts);
        let texts = TEXTS.iter().enumerate();
        let texts = texts.map(|(index, &(name, description))| StackedText {
            name,
            description,
            texts: of_variants.clone().map(|of| of[index].to_owned()).collect(),
        });
        Stacked {
            shape,
            time: sampled.then(|| time.to_vec()),
            labels: labels.into_iter().map(coordinate).collect(),
            quantities,
            texts: texts.collect(),
            methods: methods(&accounts),
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

/// The unit of a quantity in all accounts; where they differ, every one of them.
fn unit(accounts: &[Option<&Account>], quantity: Quantity) -> String {
    let mut units: Vec<&str> = Vec::new();
    let entries = accounts.iter().flatten().flat_map(|it| &it.entries);
    for entry in entries.filter(|entry| entry.quantity == quantity) {
        if !units.contains(&entry.unit.as_str()) {
            units.push(&entry.unit);
        }
    }
    if units.is_empty() {
        quantity.unit().to_owned()
    } else {
        units.join(" or ")
    }
}

fn longest<'a>(accounts: &[Option<&'a Account>]) -> &'a [f64] {
    let times = accounts.iter().flatten().map(|account| &account.time);
    times
        .max_by_key(|time| time.len())
        .map_or(&[], Vec::as_slice)
}

fn methods(accounts: &[Option<&Account>]) -> Vec<String> {
    let mut all: Vec<String> = Vec::new();
    for account in accounts.iter().flatten() {
        if !all.contains(&account.method) {
            all.push(account.method.clone());
        }
    }
    all
}

/// The labels of all accounts, each once, in the order of their appearance.
fn all_labels(accounts: &[Option<&Account>]) -> Vec<(String, Vec<String>)> {
    let mut all: Vec<(String, Vec<String>)> = vec![("span".into(), Vec::new())];
    for (name, labels) in accounts
        .iter()
        .flatten()
        .flat_map(|account| &account.labels)
    {
        let known = all.iter().position(|(known, _)| known == name);
        let index = known.unwrap_or_else(|| {
            all.push((name.clone(), Vec::new()));
            all.len() - 1
        });
        let known = &mut all[index].1;
        if !known.starts_with(labels) {
            for label in labels {
                if !known.contains(label) {
                    known.push(label.clone());
                }
            }
        }
    }
    all
}

fn coordinate((name, labels): (String, Vec<String>)) -> (String, Coordinate) {
    let numbered = Axis::ALL
        .iter()
        .any(|axis| axis.name() == Some(&name) && axis.is_numbered());
    let coordinate = if numbered {
        Coordinate::Whole((0..).take(labels.len()).collect())
    } else {
        Coordinate::Texts(labels)
    };
    (name, coordinate)
}

/// The quantities that any of the accounts has; those of a run without channels in any case.
fn quantities(accounts: &[Option<&Account>]) -> Vec<Quantity> {
    let mut all: Vec<Quantity> = Statistic::of_every_run().map(Quantity::Statistic).collect();
    for entry in accounts
        .iter()
        .flatten()
        .flat_map(|account| &account.entries)
    {
        if !all.contains(&entry.quantity) {
            all.push(entry.quantity);
        }
    }
    all
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
