//! (M + c C + k K) x = M b of a step of one solution in the space of the contacts: one unknown a row of J instead of three a body.
//!
//! ```text
//! y = w J x,   x = b − M⁻¹ Jᵀ y     ⇒     (1/w + J M⁻¹ Jᵀ) y = J b
//! ```
//!
//! w is the weight of a row: [`Element::step_weights`](super::Element::step_weights). Every joint has a row for its normal, and one for
//! its tangent where pins rub or stiffness counts; joints share a link with their
//! neighbours only. Whatever else touches a link, or the free rollers on it, is eliminated first: it couples the two joints of
//! that link, and the wheels. What is left is tridiagonal, with a border of wheels and tensioners, and where there is one row a joint
//! the last joint of a closed chain. Wheels have a negative diagonal. Quasi-definite: no pivoting is needed.
//!
//! # Source
//! Quasi-definite systems: R. J. Vanderbei, *SIAM J. Optim.* **5**, 1995, 100–113.

mod local;
mod rows;
mod tridiagonal;

use chaindrive_integrate::{Weights, kernel};
use pulp::Simd;

use local::Local;
use rows::Rows;
use tridiagonal::{Tridiagonal, UnknownPlace};

use super::by_link::ByLink;
use super::reactions::load;
use super::{Joining, JointState, Linkage};
use crate::bodies::GroupBodies;
use crate::chains::makeup::Makeup;
use crate::contact::BoreContact;
use crate::lanes::Wide;

/// The rows of one step and their factors.
#[derive(Clone, Debug, Default)]
pub(crate) struct Impulses {
    /// Normals of the joints, and tangents.
    rows: [Rows; 2],
    /// b of the links, then what changes of it.
    known: ByLink,
    joints: Tridiagonal,
    local: Local,
}

/// Unknowns of wheels, shafts and tensioners that this elimination has room for: 24 columns less two joints of two rows and the
/// right-hand side. Beyond, [`Linkage::implicit_step`] asks the blocks of the bodies.
pub(super) const MOST_WHEELS: usize = 19;

impl Linkage {
    /// x ← (M + c C + k K)⁻¹ M x; false if a pivot vanishes.
    pub(crate) fn step(
        &self,
        bodies: GroupBodies<'_>,
        weights: Weights,
        joint_state: &JointState,
        work: &mut Impulses,
        x: &mut [f64],
    ) -> bool {
        let Joining::Clearance(bearing) = &self.joining else {
            return false;
        };
        let wheels = x.len() - self.coordinates();
        let step = Step {
            linkage: self,
            bearing,
            bodies,
            weights,
            joint_state,
        };
        // Around a link there are its two joints, the wheels, and the right-hand side; beside a joint only the one that closes the
        // chain instead of two. Columns that are always empty cost as much as others: with friction and one wheel, some 30 % of the step.
        match (bearing.rubs() || weights.stiffness > 0.0, wheels) {
            (false, ..=1) => work.solve::<1, 4, 4>(step, x),
            (false, 2..=5) => work.solve::<1, 8, 8>(step, x),
            (true, ..=1) => work.solve::<2, 8, 4>(step, x),
            (true, 2..=3) => work.solve::<2, 8, 8>(step, x),
            (_, ..=MOST_WHEELS) => work.solve::<2, 24, 24>(step, x),
            _ => false,
        }
    }
}

/// Inputs of the solution of one step.
#[derive(Clone, Copy)]
pub(super) struct Step<'a> {
    pub(super) linkage: &'a Linkage,
    pub(super) bearing: &'a BoreContact,
    pub(super) bodies: GroupBodies<'a>,
    pub(super) weights: Weights,
    pub(super) joint_state: &'a JointState,
}

impl Impulses {
    /// With R rows a joint, and room for C columns around a link and B beside the joints.
    pub(super) fn solve<const R: usize, const C: usize, const B: usize>(
        &mut self,
        step: Step<'_>,
        x: &mut [f64],
    ) -> bool {
        let registers = step.linkage.series.registers;
        registers.dispatch(solution::<R, C, B>(self, step, x))
    }

    #[inline(always)]
    fn solve_on<S: Simd, const R: usize, const C: usize, const B: usize>(
        &mut self,
        w: Wide<S>,
        step: Step<'_>,
        x: &mut [f64],
    ) -> bool {
        let Step {
            linkage,
            bearing,
            bodies,
            weights,
            joint_state,
        } = step;
        // Rows of J at the joints, from what the links do under the forces alone, b.
        let wheels = x.len() - linkage.coordinates();
        let b = x[..3 * linkage.series.links].as_chunks::<3>().0;
        self.known.read(linkage, b.iter().copied());
        self.rows[0].set_normals(w, joint_state, weights);
        if R == 2 {
            self.rows[1].set_tangents(w, linkage, bearing, joint_state, &self.known, weights);
        }
        // The matrix over joints and wheels: joints on lanes, wheels one by one, and all else that touches links eliminated into it.
        self.joints.clear::<R, B>(linkage, wheels);
        self.fill::<S, R, B>(w, linkage);
        self.fill_wheels::<R, B>(linkage, bodies, weights, x);
        self.local.gather(linkage, weights, joint_state, x);
        let condensed = self
            .local
            .condense::<R, C, B>(linkage, &self.rows, &mut self.joints, x);
        if !condensed || !self.joints.factor::<S, R, B>(w, linkage) {
            return false;
        }
        // Back from the impulses to the velocities: joints, contacts, wheels.
        self.joints.substitute::<R, B>(linkage);
        self.apply::<S, R>(w, linkage, x);
        self.local.apply::<R, C>(linkage, &self.joints, x);
        x[linkage.coordinates()..].copy_from_slice(self.joints.wheels(wheels));
        true
    }

    /// The rows of the joints among themselves, and J b.
    #[inline(always)]
    fn fill<S: Simd, const R: usize, const B: usize>(&mut self, w: Wide<S>, linkage: &Linkage) {
        let shapes = &linkage.shapes;
        let rows = &self.rows;
        let one = w.splat(1.0);
        let zero = w.splat(0.0);
        let joints = linkage.joints.len();
        for start in (0..joints).step_by(Wide::<S>::COUNT) {
            let [before, after] = [start, start + 1];
            // The links before and after the joint, and for the coupling with the next joint the latter.
            let mass = [before, after].map(|at| w.load(&shapes.mobility, at));
            let inertia = [before, after].map(|at| w.load(&shapes.turning, at));
            let b = [load(w, &self.known, before), load(w, &self.known, after)];
            // Entries of 1/w + J M⁻¹ Jᵀ: of a joint with itself, through the links before and after it, and with the next, through the link
            // between them.
            for p in 0..R {
                let row = rows[p].load(w, start);
                let next = rows[p].load(w, start + 1);
                for o in 0..R {
                    let other = rows[o].load(w, start);
                    if o <= p {
                        let mut value = (mass[0] + mass[1]) * row.dot(&other)
                            + inertia[0] * row.turn_before * other.turn_before
                            + inertia[1] * row.turn_after * other.turn_after;
                        if o == p {
                            let weight = w.load(&rows[p].weight, start);
                            let present = weight.greater(zero);
                            let inverse = present.select(weight, one).recip();
                            value += inverse;
                        }
                        value.store(self.joints.own(p, o), start);
                    }
                    let value = -(mass[1] * next.dot(&other)
                        + inertia[1] * next.turn_before * other.turn_after);
                    value.store(self.joints.coupling(p, o), start);
                }
                // J b: how the sides of the joint part along the row.
                let right = row.x * (b[1][0] - b[0][0])
                    + row.y * (b[1][1] - b[0][1])
                    + row.turn_after * b[1][2]
                    - row.turn_before * b[0][2];
                right.store(self.joints.right(p), start);
            }
        }
        self.joints.take_in::<R, B>();
    }

    #[inline(always)]
    fn fill_wheels<const R: usize, const B: usize>(
        &mut self,
        linkage: &Linkage,
        bodies: GroupBodies<'_>,
        weights: Weights,
        b: &[f64],
    ) {
        // Wheels stand in the border, with a negative sign: their unknowns are velocities, not impulses.
        let first = self.joints.first_wheel();
        for (j, &inertia) in bodies.inertias().iter().enumerate() {
            let place = UnknownPlace::Border(first + j);
            self.joints.add::<R, B>(place, place, -inertia);
            self.joints
                .add_right::<R, B>(place, -inertia * b[linkage.coordinates() + j]);
        }
        bodies.each_own(weights, |places, weighted| {
            let [i, j] = places.map(|place| UnknownPlace::Border(first + place));
            // Both halves are one.
            if places[0] >= places[1] {
                self.joints.add::<R, B>(i, j, -weighted);
            }
        });
    }

    /// x ← b − M⁻¹ Jᵀ y of the joints.
    #[inline(always)]
    fn apply<S: Simd, const R: usize>(&mut self, w: Wide<S>, linkage: &Linkage, x: &mut [f64]) {
        let shapes = &linkage.shapes;
        for start in (0..linkage.series.links).step_by(Wide::<S>::COUNT) {
            // A link is pushed by the joint at its beginning, and back by the one at its end.
            let mut impulse = [w.splat(0.0); 3];
            for p in 0..R {
                let (row, next) = (self.rows[p].load(w, start), self.rows[p].load(w, start + 1));
                let found = self.joints.found(p);
                let (y, z) = (w.load(found, start), w.load(found, start + 1));
                impulse[0] += row.x * y - next.x * z;
                impulse[1] += row.y * y - next.y * z;
                impulse[2] += row.turn_after * y - next.turn_before * z;
            }
            let (mass, inertia) = (
                w.load(&shapes.mobility, start + 1),
                w.load(&shapes.turning, start + 1),
            );
            (impulse[0] * mass).store(&mut self.known.x, start + 1);
            (impulse[1] * mass).store(&mut self.known.y, start + 1);
            (impulse[2] * inertia).store(&mut self.known.turn, start + 1);
        }
        self.known.subtract_from(&mut x[..3 * linkage.series.links]);
    }
}

kernel!(
    /// The solution; false if the equations are singular.
    fn solution<'a, const R: usize, const C: usize, const B: usize, S: Simd>(
        w: Wide<S>,
        work: &'a mut Impulses,
        step: Step<'a>,
        x: &'a mut [f64],
    ) -> bool {
        work.solve_on::<S, R, C, B>(w, step, x)
    }
);
