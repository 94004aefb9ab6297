//! The bodies of a group, as an implicit step sees them.

use std::ops::Range;

use chaindrive_integrate::Weights;

use super::Bodies;
use crate::Coupling;
use crate::tensioner::Slopes;

/// The bodies of a group, as an implicit step sees them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GroupBodies<'a> {
    pub(crate) all: &'a Bodies,
    /// First coordinate in the state, and their number.
    pub(crate) first: usize,
    pub(crate) count: usize,
    /// Slopes of the pushes of all tensioners, where an implicit step is solved.
    pub(crate) pushes: &'a [Slopes],
    /// Damping of the losses of all shafts, there too.
    pub(crate) resisting: &'a [f64],
}

impl<'a> GroupBodies<'a> {
    /// The same with the slopes of the pushes and the damping of the losses at the last evaluation.
    pub(crate) fn with(self, pushes: &'a [Slopes], resisting: &'a [f64]) -> Self {
        Self {
            pushes,
            resisting,
            ..self
        }
    }
}

impl GroupBodies<'_> {
    /// Their coordinates in the state.
    pub(crate) fn range(&self) -> Range<usize> {
        self.first..self.first + self.count
    }

    /// Mass or inertia that goes with each coordinate \[kg or kg m²\].
    pub(crate) fn inertias(&self) -> &[f64] {
        let from = self.first - self.all.first;
        &self.all.inertias[from..from + self.count]
    }

    /// Visits (row and column, c C + k K) of what the bodies have of their own, both halves; rows are counted from the
    /// first coordinate of the group.
    pub(crate) fn each_own(&self, weights: Weights, mut visit: impl FnMut([usize; 2], f64)) {
        let range = self.range();
        self.all
            .each_support(weights, self.pushes, self.resisting, |dof, weighted| {
                if range.contains(&dof) {
                    let place = dof - self.first;
                    visit([place; 2], weighted);
                }
            });
        for coupling in &self.all.couplings {
            let Coupling {
                stiffness, damping, ..
            } = coupling;
            for (dof, share) in self.all.twisted_by(coupling) {
                for (other, other_share) in self.all.twisted_by(coupling) {
                    if range.contains(&dof) {
                        let places = [dof, other].map(|dof| dof - self.first);
                        let both = share * other_share;
                        let weighted = weights.stiffness * (stiffness * both)
                            + weights.damping * (damping * both);
                        visit(places, weighted);
                    }
                }
            }
        }
    }
}
