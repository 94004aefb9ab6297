//! Stacks the accounts of all variants: one array a quantity, the swept dimensions first.

use super::{Account, Coordinate, Outcome, Quantity, Statistic, Sweep};
use crate::record::Axis;

/// What is said of a variant that was not carried out.
const OPEN: &str = "not carried out: the sweep was stopped";

/// One quantity of all variants.
#[derive(Clone, Debug, PartialEq)]
pub struct StackedQuantity {
    /// Which.
    pub quantity: Quantity,
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
    /// Variants along each of the swept dimensions.
    pub shape: Vec<usize>,
    /// Sample times \[s\], of the longest run; none without channels.
    pub time: Option<Vec<f64>>,
    /// Labels of the dimensions that are neither swept nor time.
    pub labels: Vec<(String, Coordinate)>,
    /// The quantities.
    pub quantities: Vec<StackedQuantity>,
    /// What went wrong, a variant; empty where nothing did.
    pub errors: Vec<String>,
    /// Methods of time stepping that were used.
    pub methods: Vec<String>,
}

impl Sweep {
    /// Stacks the outcomes of all variants, in their order. Runs that sample longer than others, or have
    /// more links, decide about the size of the arrays; what the others do not have is NaN.
    pub fn stack(&self, outcomes: &[Outcome]) -> Stacked {
        let shape: Vec<usize> = self.dimensions().iter().map(|d| d.values.len()).collect();
        let names: Vec<&str> = self.dimensions().iter().map(|d| d.name.as_str()).collect();
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
                dims,
                shape: sizes,
                values,
            }
        };
        let quantities: Vec<_> = quantities(&accounts).into_iter().map(stack).collect();
        let sampled = quantities.iter().any(|it| it.quantity.is_sampled());
        let error = |outcome: &Outcome| match outcome {
            Outcome::Done(_) => String::new(),
            Outcome::Failed(message) => message.clone(),
            Outcome::Open => OPEN.to_owned(),
        };
        Stacked {
            shape,
            time: sampled.then(|| time.to_vec()),
            labels: labels.into_iter().map(coordinate).collect(),
            quantities,
            errors: outcomes.iter().map(error).collect(),
            methods: methods(&accounts),
        }
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
    let always = Statistic::ALL
        .iter()
        .filter(|it| !it.is_of_logged_contacts() && !it.is_of_a_choice());
    let mut all: Vec<Quantity> = always.map(|&it| Quantity::Statistic(it)).collect();
    for (quantity, _) in accounts
        .iter()
        .flatten()
        .flat_map(|account| &account.values)
    {
        if !all.contains(quantity) {
            all.push(*quantity);
        }
    }
    all
}

/// Puts the entries of one account where their labels are in the stack.
fn fill(account: &Account, quantity: Quantity, width: Option<&[String]>, to: &mut [f64]) {
    let Some((_, values)) = account.values.iter().find(|(it, _)| *it == quantity) else {
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
