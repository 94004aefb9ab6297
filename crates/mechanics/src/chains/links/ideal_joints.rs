//! Ideal joints in an implicit step: reactions that keep J x what it shall be.
//!
//! ```text
//! ⎡ D  Wᵀ  Jᵀ ⎤ ⎡x⎤   ⎡M b ⎤      D: blocks of the links, W: their couplings with the wheels, S: the wheels
//! ⎢ W  S      ⎥ ⎢z⎥ = ⎢M b ⎥      s: a share of J b, or what is given
//! ⎣ J         ⎦ ⎣λ⎦   ⎣ s  ⎦
//! ```
//!
//! Ideal joints are all that joins neighbouring links, so D has blocks on its diagonal only, and the reactions of given loads
//! on the links are found as they are in an evaluation, with D in place of M:
//!
//! ```text
//! P(r, s) = D⁻¹ (r − Jᵀ λ),   J D⁻¹ Jᵀ λ = J D⁻¹ r − s
//! (S − W P(Wᵀ, 0)) z = M b − W P(M b, s),   x = P(M b, s) − P(Wᵀ, 0) z
//! ```

use chaindrive_geometry::Vector;
use chaindrive_integrate::{Array, Weights, kernel};
use pulp::Simd;

use super::by_link::{ByLink, load};
use super::equations::Sum;
use super::posture::Posture;
use super::reactions::{Inertia, Reactions};
use super::{BorderedBlocks, JointState, Linkage};
use crate::bodies::GroupBodies;
use crate::joints::Mate;
use crate::lanes::Wide;

/// Prescribed value of J x at the hinges.
#[derive(Clone, Copy)]
pub(super) enum HingeTarget<'a> {
    /// This share of J b, with all contacts.
    Kept(f64),
    /// These values of P_pin − P_hole, by joint, with none.
    Given(&'a [Vector]),
}

/// Space for the answers of the links to what acts on them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Answers {
    /// b of the links.
    known: ByLink,
    /// s, by joint, of P_after − P_before.
    asked: [Array; 2],
    /// P(M b, s), then x.
    whole: ByLink,
    /// P(Wᵀ, 0), one a column.
    columns: Vec<ByLink>,
}

impl Linkage {
    /// x ← the x of the equations above, for b = x; false if there is none.
    pub(super) fn solve_held(
        &self,
        bodies: GroupBodies<'_>,
        weights: Weights,
        joint_state: &mut JointState,
        x: &mut [f64],
        asked: HingeTarget<'_>,
    ) -> bool {
        let mut equations = std::mem::take(&mut joint_state.equations);
        let mut sum = Sum::new(self, &mut equations, self.series.links, x);
        sum.add_masses(bodies, weights, x);
        if matches!(asked, HingeTarget::Kept(_)) {
            self.each_element(joint_state, |element| {
                sum.add(element, &joint_state.mounts, weights, x);
            });
            if weights.stiffness > 0.0 {
                sum.add_hinge_turns(joint_state, weights.stiffness);
            }
        }
        let JointState {
            reactions,
            answers,
            posture,
            ..
        } = joint_state;
        let mut held = JoinedLinks {
            linkage: self,
            posture,
            reactions,
        };
        let solved = sum.eliminate_rollers() && held.solve(sum.blocks, answers, x, asked);
        if solved {
            sum.read(x);
        }
        joint_state.equations = equations;
        solved
    }
}

/// Links that are held together.
struct JoinedLinks<'a> {
    linkage: &'a Linkage,
    posture: &'a Posture,
    reactions: &'a mut Reactions,
}

impl JoinedLinks<'_> {
    /// The right-hand sides become the solution.
    fn solve(
        &mut self,
        blocks: &mut BorderedBlocks,
        answers: &mut Answers,
        b: &[f64],
        asked: HingeTarget<'_>,
    ) -> bool {
        let linkage = self.linkage;
        let (links, border) = (linkage.series.links, blocks.right_border.len());
        let inverted = self.reactions.inverse.invert(linkage, &blocks.diagonal);
        let inertia = Inertia::OfBlocks;
        if !inverted || !self.reactions.factor(linkage, self.posture, inertia) {
            return false;
        }
        let kept = match asked {
            HingeTarget::Kept(share) => {
                let b = b[..3 * links].as_chunks::<3>().0;
                answers.known.read(linkage, b.iter().copied());
                Some(share)
            }
            HingeTarget::Given(given) => {
                answers.ask(linkage, given);
                None
            }
        };
        let right = blocks.right.iter();
        answers.whole.read(linkage, right.map(|r| [r.x, r.y, r.z]));
        answers.columns.resize_with(border, ByLink::default);
        for (j, column) in answers.columns.iter_mut().enumerate() {
            let beside = blocks.beside[j..].iter().step_by(border);
            column.read(linkage, beside.map(|r| [r.x, r.y, r.z]));
        }
        let registers = linkage.series.registers;
        registers.dispatch(all_answers(self, answers, kept));
        for (j, row) in answers.columns.iter().enumerate() {
            let beside = || blocks.beside[j..].iter().step_by(border);
            let through = |answer: &ByLink| -> f64 {
                let each = beside().zip(answer.each(links));
                each.map(|(r, [x, y, turn])| r.x * x + r.y * y + r.z * turn)
                    .sum()
            };
            blocks.right_border[j] -= through(&answers.whole);
            for (k, column) in answers.columns[..j].iter().chain([row]).enumerate() {
                blocks.corner[(j, k)] -= through(column);
            }
        }
        if !blocks.solve_border() {
            return false;
        }
        let found = blocks.right.iter_mut().zip(answers.whole.each(links));
        for (x, found) in found {
            *x = found.into();
        }
        for (column, z) in answers.columns.iter().zip(blocks.right_border.iter()) {
            for (x, [dx, dy, turn]) in blocks.right.iter_mut().zip(column.each(links)) {
                x.x -= dx * z;
                x.y -= dy * z;
                x.z -= turn * z;
            }
        }
        true
    }

    /// r ← P(r, s); without s for s = 0.
    #[inline(always)]
    fn answer<S: Simd>(&mut self, w: Wide<S>, r: &mut ByLink, asked: Option<&[Array; 2]>) {
        let (linkage, posture) = (self.linkage, self.posture);
        self.reactions.inverse.yield_to(w, linkage, r);
        self.reactions.set_opening(w, linkage, posture, r);
        if let Some(asked) = asked {
            for (right, asked) in self.reactions.right.iter_mut().zip(asked) {
                for (right, asked) in right.iter_mut().zip(asked) {
                    *right -= asked;
                }
            }
        }
        self.reactions.solve(w);
        for link in (0..linkage.series.links).step_by(Wide::<S>::COUNT) {
            let push = self.reactions.load(w, posture, link);
            let [x, y, turn] = self.reactions.inverse.yielding(w, link, push);
            let [r_x, r_y, r_turn] = load(w, r, link + 1);
            (r_x - x).store(&mut r.x, link + 1);
            (r_y - y).store(&mut r.y, link + 1);
            (r_turn - turn).store(&mut r.turn, link + 1);
        }
    }
}

impl Answers {
    /// Takes in what is given, by joint.
    fn ask(&mut self, linkage: &Linkage, given: &[Vector]) {
        for (k, asked) in self.asked.iter_mut().enumerate() {
            asked.resize(given.len(), 0.0);
            for (joint, (asked, given)) in asked.iter_mut().zip(given).enumerate() {
                *asked = match linkage.joints[joint].pair {
                    Some(_) if linkage.pairs.pin_after(joint) => given[k],
                    Some(_) => -given[k],
                    None => 0.0,
                };
            }
        }
    }
}

kernel!(
    /// All answers.
    fn all_answers<'a, 'b, S: Simd>(
        w: Wide<S>,
        held: &'a mut JoinedLinks<'b>,
        answers: &'a mut Answers,
        /// Share of J b that J x is to be, if it is.
        kept: Option<f64>,
    ) {
        let Answers {
            known,
            asked,
            whole,
            columns,
        } = answers;
        // What the joints open by under b, of which a share is to stay.
        if let Some(share) = kept {
            held.reactions
                .set_opening(w, held.linkage, held.posture, known);
            for (asked, right) in asked.iter_mut().zip(&held.reactions.right) {
                asked.resize(held.linkage.joints.len(), 0.0);
                for (asked, right) in asked.iter_mut().zip(&**right) {
                    *asked = share * right;
                }
            }
        }
        // The right-hand side with what is asked for; columns of the border keep the joints closed.
        held.answer(w, whole, Some(asked));
        for column in columns {
            held.answer(w, column, None);
        }
    }
);

/// One side of a joint: its link with place along it, or the frame.
pub(super) struct Limb {
    pub(super) body: Option<usize>,
    pub(super) arm: Vector,
    pub(super) sign: f64,
}

/// Hole and pin of a joint, with the sign of the joint force on them.
pub(super) fn limbs(mates: [Mate; 2], posture: &Posture) -> [Limb; 2] {
    [(mates[0], -1.0), (mates[1], 1.0)].map(|(mate, sign)| match mate {
        Mate::Link { link, end } => Limb {
            body: Some(link),
            arm: posture.arm(link, end),
            sign,
        },
        Mate::Ground(_) => Limb {
            body: None,
            arm: Vector::zeros(),
            sign,
        },
    })
}

impl Sum<'_> {
    /// Contribution of the joint forces to the rotation of the links: λ·arm, where that is positive.
    pub(super) fn add_hinge_turns(&mut self, joint_state: &JointState, weight: f64) {
        for (joint, force) in self.linkage.joints.iter().zip(&joint_state.hinge_forces) {
            let Some(mates) = joint.pair else { continue };
            for limb in limbs(mates, &joint_state.posture) {
                if let Some(link) = limb.body {
                    let along = limb.sign * force.dot(&limb.arm);
                    self.add_turn(link, weight * along.max(0.0));
                }
            }
        }
    }
}
