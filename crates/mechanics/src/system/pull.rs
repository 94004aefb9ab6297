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

    /// Inertias that go with the coordinates of a roller, in their order \[kg or kg m²\].
    pub(super) fn inertias_of_roller(&self, roller: usize, q: &[f64]) -> Vec<f64> {
        let (member, number) = self.member_with(roller);
        let inertias = member.chain.inertias();
        let moving = member
            .chain
            .roller_moving(&q[member.entries.clone()], number);
        moving
            .ways()
            .iter()
            .map(|way| inertias[way.entry])
            .collect()
    }

    /// Adds accelerations and powers of the forces on rollers.
    ///
    /// ```text
    /// q̈ += M⁻¹ Jᵀ F,   P = F · J q̇        J: derivatives of the centre of the roller by the coordinates of its chain
    /// ```
    pub(super) fn pull(&self, at: Moment<'_>, a: &mut [f64], rates: &mut [f64]) {
        for pulled in self.bodies.inputs.roller_forces() {
            let force = Vector::from(pulled.at(at.t));
            if force == Vector::zeros() {
                continue;
            }
            let (member, number) = self.member_with(pulled.roller);
            let own = member.own(at);
            let a = &mut a[member.entries.clone()];
            let moving = member.chain.roller_moving(own.q, number);
            for (way, inertia) in moving.ways().iter().zip(&pulled.inertias) {
                let along = way.first.dot(&force);
                a[way.entry] += along / inertia;
                rates[Flow::Forces as usize] += along * own.v[way.entry];
            }
            member.chain.copy_ghosts(a);
        }
    }
}
