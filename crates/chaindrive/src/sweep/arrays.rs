//! Stacks the accounts of all variants: one array a quantity, the swept dimensions first.

use super::layout::Layout;
use super::texts::TEXTS;
use super::{Coordinate, Outcome, ResultQuantity, Sweep, chunks};

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
    pub quantity: ResultQuantity,
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
pub struct SweepArrays {
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
    pub fn stack(&self, outcomes: &[Outcome]) -> SweepArrays {
        let layout = Layout::whole(self, outcomes);
        let region = layout.region(0);
        let stack = |(name, units): &(String, Vec<String>)| {
            let quantity = ResultQuantity::from_name(name)?;
            let (mut dims, mut shape) = (self.dims(), layout.shape.clone());
            for beside in layout.beside(quantity) {
                dims.push(beside.name);
                shape.push(beside.len);
            }
            let chunk = chunks::numbers(&layout, &region, quantity, outcomes).pop();
            let values = chunk.map_or_else(Vec::new, |(_, values)| values);
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
        let texts = TEXTS.iter().map(|&(name, description)| StackedText {
            name,
            description,
            texts: chunks::texts(&layout, &region, name, outcomes),
        });
        let texts = texts.collect();
        SweepArrays {
            shape: layout.shape,
            time: sampled.then_some(layout.time),
            labels,
            quantities,
            texts,
            methods: layout.methods,
        }
    }
}
