//! Forces from outside on single rollers.

use chaindrive_geometry::Vector;
use chaindrive_integrate::Moment;

use super::{Member, System};
use crate::energy::Flow;

impl System {
    /// The chain of a roller counted over all chains, and its number there.
    ///
    /// # Panics
    /// There are not so many rollers.
    pub(crate) fn member_with(&self, roller: usize) -> (&Member, usize) {
        let mut number = roller;
        for member in &self.chains {
            if number < member.chain.rollers() {
                return (member, number);
            }
            number -= member.chain.rollers();
        }
        panic!("roller {roller} of {}", self.rollers())
    }

    /// Adds what forces on rollers do to accelerations and powers.
    ///
    /// ```text
    /// q̈ += M⁻¹ Jᵀ F,   P = F · J q̇        J: derivatives of the centre of the roller by the coordinates of its chain
    /// ```
    pub(super) fn pull(&self, at: Moment<'_>, a: &mut [f64], rates: &mut [f64]) {
        for (roller, [x, y]) in self.bodies.inputs.roller_forces(at.t) {
            let force = Vector::new(x, y);
            if force == Vector::zeros() {
                continue;
            }
            let (member, number) = self.member_with(roller);
            let own = member.own(at);
            let a = &mut a[member.entries.clone()];
            let inertias = member.chain.inertias();
            for way in member.chain.roller_moving(own.q, number).ways() {
                let along = way.first.dot(&force);
                a[way.entry] += along / inertias[way.entry];
                rates[Flow::Forces as usize] += along * own.v[way.entry];
            }
            member.chain.copy_ghosts(a);
        }
    }
}
