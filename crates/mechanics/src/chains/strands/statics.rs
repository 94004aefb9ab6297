//! A chain of strands in equilibrium: its joints are those of particles, its links share loads.

use chaindrive_geometry::Vector;

use super::Strands;
use crate::chains::makeup::Statics;
use crate::seam::{Load, Moving, Sum, Unknown};

impl Statics for Strands {
    fn unknowns(&self) -> Vec<Unknown> {
        self.chain.unknowns()
    }

    fn roller_moving(&self, q: &[f64], roller: usize) -> Moving {
        self.chain.roller_moving(q, roller)
    }

    fn pin_moving(&self, q: &[f64], link: usize, end: usize) -> Moving {
        self.chain.pin_moving(q, link, end)
    }

    fn stiffest_spring(&self) -> f64 {
        self.chain.stiffest_spring()
    }

    fn weights(&self) -> [f64; 2] {
        self.chain.weights()
    }

    /// Adds E = Σ Σ ½ k_s e_s² − Σ m g·x − Σ F·x.
    fn add_balance(&self, q: &[f64], gravity: Vector, load: Load, sum: &mut Sum<'_>) {
        let law = |link, length| self.pack.answer(&self.chain.links, link, length);
        self.chain.add_balance_of(q, gravity, load, sum, law);
    }

    fn lengthen(&mut self, change: f64) {
        self.chain.lengthen(change);
    }

    fn imbalance(&self, a: &[f64]) -> f64 {
        self.chain.imbalance(a)
    }

    fn reach(&self, step: &[f64]) -> f64 {
        self.chain.reach(step)
    }

    fn elongation(&self) -> f64 {
        self.chain.elongation()
    }

    fn nudge(&self, q: &mut [f64], shift: impl FnMut() -> f64) {
        self.chain.nudge(q, shift);
    }

    fn copy_ghosts(&self, values: &mut [f64]) {
        self.chain.copy_ghosts(values);
    }
}
