//! Groups of chains and bodies that nothing joins with others: an implicit step solves for one after the other.

use std::ops::Range;

use chaindrive_integrate::Weights;

use super::{Bodies, System};
use crate::Coupling;
use crate::tensioner::Slopes;

/// Chains, and the coordinates of the bodies that have to do with them.
#[derive(Clone, Debug)]
pub(crate) struct Group {
    pub(crate) chains: Vec<usize>,
    /// Counted from the first coordinate of all bodies.
    pub(crate) bodies: Range<usize>,
}

/// The bodies of a group, as an implicit step sees them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GroupBodies<'a> {
    pub(crate) all: &'a Bodies,
    /// First coordinate in the state, and their number.
    pub(crate) first: usize,
    pub(crate) count: usize,
    /// Slopes of the pushes of all tensioners, where an implicit step is solved.
    pub(crate) pushes: &'a [Slopes],
}

impl<'a> GroupBodies<'a> {
    /// The same with the slopes of the pushes at the last evaluation.
    pub(crate) fn with(self, pushes: &'a [Slopes]) -> Self {
        Self { pushes, ..self }
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
            .each_support(weights, self.pushes, |dof, weighted| {
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

impl System {
    /// The bodies of a group.
    pub(crate) fn group_bodies(&self, group: usize) -> GroupBodies<'_> {
        let bodies = &self.groups[group].bodies;
        GroupBodies {
            all: &self.bodies,
            first: self.bodies.first + bodies.start,
            count: bodies.len(),
            pushes: &[],
        }
    }

    /// The group of a chain.
    pub(crate) fn group_of(&self, chain: usize) -> usize {
        let mut groups = self.groups.iter();
        // Every chain has one.
        groups
            .position(|group| group.chains.contains(&chain))
            .unwrap_or(0)
    }

    /// Tells the chains where the bodies of their groups are.
    pub(crate) fn refer_to_groups(&mut self) {
        for index in 0..self.chains.len() {
            let group = self.group_of(index);
            self.chains[index].first_body = self.groups[group].bodies.start;
        }
    }
}
