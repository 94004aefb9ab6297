//! Ideal joints in an implicit step: reactions that keep J x what it shall be.
//!
//! ```text
//! ⎡ D  Wᵀ  Jᵀ ⎤ ⎡x⎤   ⎡M b ⎤      D: blocks of the links, W: their couplings with the wheels, S: the wheels
//! ⎢ W  S      ⎥ ⎢z⎥ = ⎢M b ⎥      s: J b, or what is given
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
use chaindrive_integrate::Weights;
use nalgebra::{Matrix2x3, Matrix3, Vector3};

use super::implicit::Sum;
use super::posture::Posture;
use super::reactions::{Limb, Reactions};
use super::{Blocks, JointState, Linkage};
use crate::system::GroupBodies;

/// Prescribed value of J x at the hinges.
#[derive(Clone, Copy)]
pub(super) enum Prescribed<'a> {
    /// That of J b, with all contacts.
    Kept,
    /// These values, by joint, with none.
    Given(&'a [Vector]),
}

/// Space for the answers of the links to what acts on them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Answers {
    /// s.
    asked: Vec<Vector>,
    /// P(Wᵀ, 0), one column behind the other.
    columns: Vec<Vector3<f64>>,
}

impl Linkage {
    /// x ← the x of the equations above, for b = x; false if there is none.
    pub(super) fn solve_held(
        &self,
        bodies: GroupBodies<'_>,
        weights: Weights,
        joint_state: &mut JointState,
        x: &mut [f64],
        asked: Prescribed<'_>,
    ) -> bool {
        let mut equations = std::mem::take(&mut joint_state.equations);
        let mut sum = Sum::new(self, &mut equations, self.links, x);
        sum.add_masses(bodies, weights, x);
        if matches!(asked, Prescribed::Kept) {
            self.each_element(joint_state, |element| {
                sum.add(element, &joint_state.mounts, weights);
            });
            sum.add_hinge_turns(joint_state, weights.stiffness);
        }
        let JointState {
            reactions,
            answers,
            posture,
            ..
        } = joint_state;
        let mut held = Held {
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
struct Held<'a> {
    linkage: &'a Linkage,
    posture: &'a Posture,
    reactions: &'a mut Reactions,
}

impl Held<'_> {
    /// The right-hand sides become the solution.
    fn solve(
        &mut self,
        blocks: &mut Blocks,
        answers: &mut Answers,
        b: &[f64],
        asked: Prescribed<'_>,
    ) -> bool {
        let (linkage, posture) = (self.linkage, self.posture);
        if !blocks.invert() {
            return false;
        }
        let inverse = &blocks.inverse;
        let sound = self
            .reactions
            .factor(linkage, posture, |link, place, force| {
                at_place(place) * inverse[link] * at_place(force).transpose()
            });
        if !sound {
            return false;
        }
        let Answers {
            asked: values,
            columns,
        } = answers;
        values.clear();
        let each = self.reactions.each(linkage, posture);
        values.extend(each.map(|(_, joint, limbs)| match asked {
            Prescribed::Kept => opening(&limbs, |body| {
                Vector3::from_column_slice(&b[3 * body..3 * body + 3])
            }),
            Prescribed::Given(given) => given[joint],
        }));
        self.answer(inverse, &mut blocks.right, Some(values));
        let (links, border) = (linkage.links, blocks.right_border.len());
        columns.clear();
        for j in 0..border {
            columns.extend((0..links).map(|i| blocks.beside[i * border + j]));
            self.answer(inverse, &mut columns[links * j..], None);
        }
        for j in 0..border {
            for i in 0..links {
                let row = blocks.beside[i * border + j];
                blocks.right_border[j] -= row.dot(&blocks.right[i]);
                for k in 0..=j {
                    blocks.corner[(j, k)] -= row.dot(&columns[links * k + i]);
                }
            }
        }
        if !blocks.solve_border() {
            return false;
        }
        for j in 0..border {
            let z = blocks.right_border[j];
            let column = &columns[links * j..links * (j + 1)];
            for (x, column) in blocks.right.iter_mut().zip(column) {
                *x -= column * z;
            }
        }
        true
    }

    /// r ← P(r, s); without s for s = 0.
    fn answer(
        &mut self,
        inverse: &[Matrix3<f64>],
        r: &mut [Vector3<f64>],
        asked: Option<&[Vector]>,
    ) {
        for (r, inverse) in r.iter_mut().zip(inverse) {
            *r = inverse * *r;
        }
        for (row, _, limbs) in self.reactions.each(self.linkage, self.posture) {
            let asked = asked.map_or_else(Vector::zeros, |asked| asked[row]);
            self.reactions.right[row] = opening(&limbs, |body| r[body]) - asked;
        }
        self.reactions.solve();
        for (row, _, limbs) in self.reactions.each(self.linkage, self.posture) {
            for limb in &limbs {
                if let Some(body) = limb.body {
                    r[body] -= inverse[body] * limb.load(self.reactions.right[row]);
                }
            }
        }
    }
}

/// How a place on a body moves with the body.
fn at_place(arm: Vector) -> Matrix2x3<f64> {
    let turn = super::turned(arm);
    Matrix2x3::from_columns(&[Vector::x(), Vector::y(), turn])
}

/// J u of one joint.
fn opening(limbs: &[Limb; 2], moved: impl Fn(usize) -> Vector3<f64>) -> Vector {
    let sides = limbs.iter().filter_map(|limb| {
        let body = limb.body?;
        Some(at_place(limb.arm) * moved(body) * limb.sign)
    });
    sides.sum()
}

impl Sum<'_> {
    /// What the joint forces add to the rotation of the links: λ·arm, where it holds them.
    fn add_hinge_turns(&mut self, joint_state: &JointState, weight: f64) {
        for (joint, force) in self.linkage.joints.iter().zip(&joint_state.hinge_forces) {
            let Some(mates) = joint.pair else { continue };
            for limb in super::reactions::limbs(mates, &joint_state.posture) {
                if let Some(link) = limb.body {
                    let along = limb.sign * force.dot(&limb.arm);
                    self.add_turn(link, weight * along.max(0.0));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::*;
    use crate::chains::links::implicit::Equations;
    use crate::chains::links::tests::{bicycle, free_rollers, links, of, started, strand, whole};
    use crate::{ChainModel, Joint, Parts, RollerModel, Support};

    fn kinds() -> Vec<(&'static str, Parts)> {
        let ideal = |rollers: RollerModel| -> ChainModel { links(Joint::Ideal, rollers) };
        let lumped = bicycle(ideal(RollerModel::Lumped { mass: 0.453e-3 }));
        let mut sprung = lumped.clone();
        sprung.sprockets[1].support = Support::Springs {
            stiffness: [1e7; 2],
            damping: [1e3; 2],
        };
        vec![
            ("lumped rollers", lumped.clone()),
            ("free rollers", bicycle(ideal(free_rollers()))),
            ("sprung wheel", sprung),
            ("strand", strand(lumped, 0.0)),
        ]
    }

    /// Contacts, bodies and joints as one dense system that is solved with pivots: an elimination of its own.
    #[test]
    fn agrees_with_the_whole_system() {
        for (kind, parts) in kinds() {
            for stiffness in [0.0, 1e-9] {
                let (system, mut record, b) = started(parts.clone());
                let weights = Weights {
                    damping: 2e-6,
                    stiffness,
                };
                let linkage = of(&system);
                let joint_state = &mut record.chains[0].joint_state;
                let exact = dense(linkage, whole(&system), weights, joint_state, &b);
                let mut x = b.clone();
                let kept = Prescribed::Kept;
                assert!(linkage.solve_held(whole(&system), weights, joint_state, &mut x, kept));
                let size = exact.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
                let mut change = 0.0_f64;
                for (i, (x, exact)) in x.iter().zip(&exact).enumerate() {
                    let error = (x - exact).abs() / size;
                    assert!(error < 1e-11, "{kind}, {i}: {x} {exact}");
                    change = change.max((x - b[i]).abs() / size);
                }
                assert!(change > 1e-3 || kind == "strand", "{kind}: {change}");
                // J x = J b
                for (joint, mates) in linkage.joints.iter().enumerate() {
                    let Some(mates) = mates.pair else { continue };
                    let limbs = super::super::reactions::limbs(mates, &joint_state.posture);
                    let [now, before] = [&x, &b].map(|x| {
                        opening(&limbs, |body| {
                            Vector3::from_column_slice(&x[3 * body..3 * body + 3])
                        })
                    });
                    let left = (now - before).norm();
                    assert!(left < 1e-12 * size, "{kind}, {joint}: {left}");
                }
            }
        }
    }

    fn dense(
        linkage: &Linkage,
        bodies: GroupBodies<'_>,
        weights: Weights,
        joint_state: &JointState,
        b: &[f64],
    ) -> Vec<f64> {
        let mut equations = Equations::default();
        let mut sum = Sum::new(linkage, &mut equations, linkage.links, b);
        sum.add_masses(bodies, weights, b);
        linkage.each_element(joint_state, |element| {
            sum.add(element, &joint_state.mounts, weights);
        });
        sum.add_hinge_turns(joint_state, weights.stiffness);
        let Equations { blocks, loose } = equations;
        let (links, chain) = (linkage.links, linkage.coordinates());
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
        for i in 0..links {
            for k in 0..3 {
                right[3 * i + k] = blocks.right[i][k];
                (0..=k).for_each(|l| set(3 * i + k, 3 * i + l, blocks.diagonal[i][(k, l)]));
                for j in 0..border {
                    set(chain + j, 3 * i + k, blocks.beside[i * border + j][k]);
                }
            }
        }
        for (i, roller) in loose.iter().enumerate() {
            for k in 0..3 {
                let row = 3 * (links + i) + k;
                right[row] = roller.right[k];
                (0..=k).for_each(|l| set(row, 3 * (links + i) + l, roller.own[(k, l)]));
                if let Some(link) = roller.link {
                    (0..3).for_each(|l| set(row, 3 * link + l, roller.coupling[(l, k)]));
                }
                for (j, beside) in &roller.beside {
                    set(chain + j, row, beside[k]);
                }
            }
        }
        for j in 0..border {
            right[chain + j] = blocks.right_border[j];
            (0..=j).for_each(|k| set(chain + j, chain + k, blocks.corner[(j, k)]));
        }
        for (joint, mates) in linkage.joints.iter().enumerate() {
            let rows = b.len() + 2 * joint;
            let Some(mates) = mates.pair else {
                (0..2).for_each(|k| set(rows + k, rows + k, 1.0));
                continue;
            };
            for limb in super::super::reactions::limbs(mates, &joint_state.posture) {
                let Some(body) = limb.body else { continue };
                let row = at_place(limb.arm) * limb.sign;
                for k in 0..2 {
                    for l in 0..3 {
                        set(rows + k, 3 * body + l, row[(k, l)]);
                        right[rows + k] += row[(k, l)] * b[3 * body + l];
                    }
                }
            }
        }
        let found = matrix.lu().solve(&right).expect("a solution");
        found.as_slice()[..b.len()].to_vec()
    }
}
