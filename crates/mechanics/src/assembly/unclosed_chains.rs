//! Chains that do not close, laid as far as they reach: for pictures of what is wrong.

use std::fmt;

use chaindrive_geometry::{Closing, Point};

use super::layout::{laid_nothing, lay_one};
use super::wheels::wheels;
use crate::drive::Layout;
use crate::system::{LaidChain, LaidDrive};
use crate::{AssemblyError, Drive};

/// Gap of a chain that does not close: its two ends and the length missing.
#[derive(Clone, Debug, PartialEq)]
pub struct Gap {
    /// Index of the chain.
    pub chain: usize,
    /// End of its last link \[m\].
    pub end: Point,
    /// Its first roller, where the last link should end \[m\].
    pub start: Point,
    /// Length that is missing along the route \[m\]; negative where the chain is too long by so much.
    pub missing: f64,
}

impl fmt::Display for Gap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let length = self.missing.abs() * 1e3;
        if self.missing > 0.0 {
            write!(f, "{length:.1} mm are missing")
        } else {
            write!(f, "{length:.1} mm too long")
        }
    }
}

impl Drive {
    /// The drive with its chains laid, those that do not close from the first stop on, link by link on straight spans; and why.
    pub(crate) fn laid_part_way(&self) -> (LaidDrive, Vec<Gap>, Option<AssemblyError>) {
        let mut laid = laid_nothing(self);
        let (mut gaps, mut problem) = (Vec::new(), None);
        for index in 0..laid.parts.chains.len() {
            if let Err(error) = lay_one(&mut laid, index) {
                problem.get_or_insert(error);
                let reached = from_the_first_stop(&laid, index);
                // A route that goes around nothing leaves no chain to draw.
                let (chain, gap) = reached.unwrap_or_default();
                laid.chains.truncate(index);
                laid.chains.push(chain);
                gaps.extend(gap);
            }
        }
        (laid, gaps, problem)
    }
}

fn from_the_first_stop(laid: &LaidDrive, index: usize) -> Option<(LaidChain, Option<Gap>)> {
    let parts = &laid.parts;
    let placed = &parts.chains[index];
    let Layout::Route { stops, phase, .. } = &placed.layout else {
        return None;
    };
    let chain = &placed.chain;
    let links = chain.links();
    let pitch = chain.lengths.iter().sum::<f64>() / links as f64;
    let wheels = wheels(parts, chain, stops).ok()?;
    let closing = Closing::march(&wheels, pitch, *phase).ok()?;
    let places = closing.positions(&wheels, pitch).ok()?;
    let mut positions: Vec<Point> = places.into_iter().map(|place| place.position).collect();
    let start = *positions.first()?;
    // The last span with links of their own length, from its seat towards the first roller and beyond.
    let last = usize::try_from(*closing.spans.last()?).ok()?;
    positions.truncate(positions.len() + 1 - last.max(1));
    let seat = *positions.last()?;
    let along = (start - seat).try_normalize(0.0)?;
    let seated = positions.len() - 1;
    positions.extend((1..=links.saturating_sub(seated)).map(|k| seat + along * (k as f64 * pitch)));
    positions.truncate(links + 1);
    let end = *positions.last()?;
    let gap = Gap {
        chain: index,
        end,
        start,
        missing: closing.excess(u32::try_from(links).ok()?),
    };
    let route = Vec::new();
    Some((LaidChain { positions, route }, Some(gap)))
}
