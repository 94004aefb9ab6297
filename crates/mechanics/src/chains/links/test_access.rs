//! Equations and contacts of joints, as plain numbers: for tests that compare two ways to compute them.

use chaindrive_geometry::Vector;
use chaindrive_integrate::{Moment, Registers, Weights};
use nalgebra::{DMatrix, DVector, Matrix2x3};

use super::equations::{Equations, Sum};
use super::ideal_joints::{HingeTarget, limbs};
use super::{Impulses, Joining, JointState, Linkage};
use crate::bodies::GroupBodies;
use crate::chains::makeup::Makeup;
use crate::chains::{Chain, Record};
use crate::contact::{ContactMemory, LaneTally, MemoryField, MemoryLanes, Tally};
use crate::joints::{Element, Pins, contacts, touch, turned};
use crate::lanes::Wide;

/// A chain of rigid links with its state, and the bodies beside it.
pub struct Inside<'a> {
    linkage: &'a Linkage,
    bodies: GroupBodies<'a>,
    joint_state: &'a mut JointState,
}

impl std::fmt::Debug for Inside<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Inside").finish_non_exhaustive()
    }
}

impl<'a> Inside<'a> {
    /// None if the chain is made of anything else.
    pub(crate) fn of(
        chain: &'a Chain,
        record: &'a mut Record,
        bodies: GroupBodies<'a>,
    ) -> Option<Self> {
        let Chain::Links(linkage) = chain else {
            return None;
        };
        Some(Self {
            linkage,
            bodies,
            joint_state: &mut record.links.joint_state,
        })
    }

    /// The equations of a step for b, with two rows at the end for each joint, J x = J b: as a dense system.
    pub fn equations(&self, weights: Weights, b: &[f64]) -> (DMatrix<f64>, DVector<f64>) {
        let (linkage, joint_state) = (self.linkage, &*self.joint_state);
        let mut equations = Equations::default();
        let (links, chain) = (linkage.series.links, linkage.coordinates());
        // The last link of a closed chain touches both ends of the row, and stands in the border.
        let row = links - usize::from(linkage.series.is_closed());
        let mut sum = Sum::new(linkage, &mut equations, row, b);
        sum.add_masses(self.bodies, weights, b);
        linkage.each_element(joint_state, |element| {
            sum.add(element, &joint_state.mounts, weights, b);
        });
        sum.add_hinge_turns(joint_state, weights.stiffness);
        let Equations { blocks, loose, .. } = equations;
        let size = b.len() + 2 * linkage.joints.len();
        let mut matrix = DMatrix::zeros(size, size);
        let mut right = DVector::zeros(size);
        let mut set = |i: usize, j: usize, value: f64| {
            matrix[(i, j)] += value;
            if i != j {
                matrix[(j, i)] += value;
            }
        };
        let border = blocks.right_border.len();
        let last = 3 * (links - row);
        let place = |j: usize| {
            if j < last {
                3 * row + j
            } else {
                chain + j - last
            }
        };
        for i in 0..row {
            for k in 0..3 {
                right[3 * i + k] = blocks.right[i][k];
                (0..=k).for_each(|l| set(3 * i + k, 3 * i + l, blocks.diagonal[i][(k, l)]));
                if i > 0 {
                    let before = &blocks.below[i - 1];
                    (0..3).for_each(|l| set(3 * i + k, 3 * (i - 1) + l, before[(k, l)]));
                }
                for j in 0..border {
                    set(place(j), 3 * i + k, blocks.beside[i * border + j][k]);
                }
            }
        }
        for (i, roller) in loose.iter().enumerate() {
            for k in 0..3 {
                let own = 3 * (links + i) + k;
                right[own] = roller.right[k];
                (0..=k).for_each(|l| set(own, 3 * (links + i) + l, roller.own[(k, l)]));
                if let Some(link) = roller.link {
                    (0..3).for_each(|l| set(own, 3 * link + l, roller.coupling[(l, k)]));
                }
                for (j, beside) in &roller.beside {
                    set(place(*j), own, beside[k]);
                }
            }
        }
        for j in 0..border {
            right[place(j)] = blocks.right_border[j];
            (0..=j).for_each(|k| set(place(j), place(k), blocks.corner[(j, k)]));
        }
        for (joint, mates) in linkage.joints.iter().enumerate() {
            let rows = b.len() + 2 * joint;
            let Some(mates) = mates.pair else {
                (0..2).for_each(|k| set(rows + k, rows + k, 1.0));
                continue;
            };
            for limb in limbs(mates, &joint_state.posture) {
                let Some(body) = limb.body else { continue };
                // How a place on a body moves with the body.
                let columns = [Vector::x(), Vector::y(), turned(limb.arm)];
                let row = Matrix2x3::from_columns(&columns) * limb.sign;
                for k in 0..2 {
                    for l in 0..3 {
                        set(rows + k, 3 * body + l, row[(k, l)]);
                        right[rows + k] += row[(k, l)] * b[3 * body + l];
                    }
                }
            }
        }
        (matrix, right)
    }

    /// The answer of a step whose ideal joints hold; none if there is none.
    pub fn held(&mut self, weights: Weights, b: &[f64]) -> Option<Vec<f64>> {
        let mut x = b.to_vec();
        let bodies = self.bodies;
        self.linkage
            .solve_held(
                bodies,
                weights,
                self.joint_state,
                &mut x,
                HingeTarget::Kept(1.0),
            )
            .then_some(x)
    }

    /// The answer of a step by the impulses in joints with clearance; none if there is none.
    pub fn by_impulses(&mut self, weights: Weights, b: &[f64]) -> Option<Vec<f64>> {
        let mut x = b.to_vec();
        let mut work = Impulses::default();
        self.linkage
            .step(self.bodies, weights, self.joint_state, &mut work, &mut x)
            .then_some(x)
    }

    /// The answer of a step by the equations of the bodies, block by block; none if there is none.
    pub fn by_blocks(&mut self, weights: Weights, b: &[f64]) -> Option<Vec<f64>> {
        let mut x = b.to_vec();
        self.linkage
            .eliminate(self.bodies, weights, self.joint_state, &mut x)
            .then_some(x)
    }

    /// The contacts of pins in bushes, all at once on some registers.
    ///
    /// # Panics
    /// If the joints have no clearance.
    pub fn joints_at_once(&self, registers: Registers) -> Joints {
        let linkage = self.linkage;
        let Joining::Clearance(bearing) = &linkage.joining else {
            panic!("the joints have no clearance");
        };
        let posture = &self.joint_state.posture;
        let (mut memory, mut pins) = (ContactMemory::default(), Pins::default());
        let tally = registers.dispatch(contacts(
            posture.sides(),
            &linkage.pairs,
            bearing,
            &linkage.series.memory.pins,
            &mut memory,
            &mut pins,
            0.0,
        ));
        let closed = (0..linkage.joints.len()).map(|joint| {
            let element = pins.element(joint, &linkage.joints[joint], bearing, posture.sides());
            element.as_ref().map(Contact::of)
        });
        Joints::new(closed.collect(), &memory, &tally)
    }

    /// The same one by one, as free rollers and their bushes are looked at.
    ///
    /// # Panics
    /// If the joints have no clearance.
    pub fn joints_one_by_one(&self, at: Moment<'_>) -> Joints {
        let linkage = self.linkage;
        let Joining::Clearance(bearing) = &linkage.joining else {
            panic!("the joints have no clearance");
        };
        let posture = &self.joint_state.posture;
        let w = Wide(pulp::Scalar);
        let count = linkage.joints.len();
        let mut memory = ContactMemory::open(count);
        let mut lanes = MemoryLanes::new(w, &linkage.series.memory.pins, &mut memory, count);
        let mut sum = LaneTally::new(w);
        let mut closed = Vec::new();
        for (joint, mates) in linkage.joints.iter().enumerate() {
            closed.push(mates.pair.and_then(|mates| {
                let [hole, pin] = mates.map(|mate| linkage.part(mate, at, posture));
                let element = touch(
                    bearing,
                    joint,
                    [&hole, &pin],
                    &mut lanes,
                    joint,
                    0.0,
                    &mut sum,
                );
                element.as_ref().map(Contact::of)
            }));
        }
        Joints::new(closed, &memory, &Tally::of(&sum))
    }
}

/// Contacts of pins in their bushes.
#[derive(Clone, Debug, Default)]
pub struct Joints {
    /// Contact in every joint; none where it is open.
    pub closed: Vec<Option<Contact>>,
    /// Gap \[m\] and 1/onset speed \[s/m\] of every joint.
    pub kept: Vec<[f64; 2]>,
    /// Power lost along the normals and by friction \[W\].
    pub losses: [f64; 2],
}

/// A closed contact of pin and bush.
#[derive(Clone, Copy, Debug)]
pub struct Contact {
    /// Normal force \[N\].
    pub force: f64,
    /// Friction \[N\].
    pub rub: f64,
    /// Friction over slip \[N s/m\].
    pub secant: f64,
    /// Stiffness, damping, stiffness across, normal, levers.
    pub others: [f64; 7],
}

impl Contact {
    fn of(it: &Element) -> Self {
        Self {
            force: it.force,
            rub: it.rub,
            secant: it.secant,
            others: [
                it.stiffness,
                it.damping,
                it.across,
                it.normal.x,
                it.normal.y,
                it.lever_a,
                it.lever_b,
            ],
        }
    }
}

impl Joints {
    fn new(closed: Vec<Option<Contact>>, memory: &ContactMemory, tally: &Tally) -> Self {
        let kept = [MemoryField::Gap, MemoryField::InverseOnset];
        Self {
            kept: (0..closed.len())
                .map(|joint| kept.map(|what| memory.get(what, joint)))
                .collect(),
            closed,
            losses: [tally.normal_loss, tally.friction_loss],
        }
    }
}
