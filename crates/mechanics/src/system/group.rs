//! Groups of chains and bodies that nothing joins with others: an implicit step solves for one after the other.

use std::ops::Range;

use super::System;
use crate::bodies::GroupBodies;

/// Chains, and the coordinates of the bodies that have to do with them.
#[derive(Clone, Debug)]
pub(crate) struct Group {
    pub(crate) chains: Vec<usize>,
    /// Counted from the first coordinate of all bodies.
    pub(crate) bodies: Range<usize>,
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
            resisting: &[],
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
