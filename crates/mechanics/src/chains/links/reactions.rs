//! Reactions of joints that hold the ends of links together: two unknowns a joint.
//!
//! ```text
//! J A⁻¹ Jᵀ λ = r,     J x = P_after − P_before of every joint,   λ: force on the side after
//! ```
//!
//! A has one block a link: its mass and inertia, or what an implicit step makes of them. Neighbours are coupled through the
//! link between them: a cyclic block-tridiagonal system, factored once for all right-hand sides. Joints without a second side have
//! rows that say λ = 0.

mod ring;
mod sections;

use chaindrive_geometry::Vector;
use chaindrive_integrate::{Array, kernel};
use pulp::Simd;

use super::by_link::{ByLink, load};
use super::inverse_blocks::InverseBlocks;
use super::posture::Posture;
use super::{Linkage, Shapes};
use crate::lanes::{LANES, Lane, Wide, padded};

pub(super) use sections::Sections;

/// Share of its stiffest direction below which a block counts as singular: a strand that is straight between two
/// supports to within 1e-6 of its length.
const SINGULAR: f64 = 1e-12;

/// The factors, and a right-hand side that becomes the solution.
#[derive(Clone, Debug, Default)]
pub(crate) struct Reactions {
    /// Entries (0, 0), (1, 0), (1, 1) of the joints' own blocks, whole lanes.
    own: [Array; 3],
    /// Entries (0, 0), (0, 1), (1, 0), (1, 1) of the blocks (joint + 1, joint).
    coupling: [Array; 4],
    sections: Sections,
    /// Whether there are forces that keep the joints together.
    sound: bool,
    /// Inverses of the blocks of A.
    pub(super) inverse: InverseBlocks,
    /// r, then λ, by joint; after the last joint of a closed chain comes the first once more.
    pub(super) right: [Array; 2],
}

/// Inertia that A is made of.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Inertia {
    /// Masses and inertias of the links.
    OfLinks,
    /// The blocks that were inverted last.
    OfBlocks,
}

/// A⁻¹ of a lane of links.
#[derive(Clone, Copy)]
enum InverseInertia<S: Simd> {
    /// 1/m and 1/I.
    Free([Lane<S>; 2]),
    Held([Lane<S>; 6]),
}

impl Reactions {
    /// Sets up J A⁻¹ Jᵀ and factors it; false if it is singular.
    pub(super) fn factor(
        &mut self,
        linkage: &Linkage,
        posture: &Posture,
        inertia: Inertia,
    ) -> bool {
        let lanes = padded(linkage.joints.len());
        if self.own[0].len() != lanes {
            for values in self.own.iter_mut().chain(&mut self.coupling) {
                values.resize(lanes, 0.0);
            }
            for values in &mut self.right {
                values.resize(lanes + LANES, 0.0);
            }
        }
        self.sections
            .lay_out(linkage.joints.len(), linkage.series.is_closed(), SINGULAR);
        let registers = linkage.series.registers;
        self.sound = registers.dispatch(factored(self, linkage, posture, inertia));
        self.sound
    }

    /// λ of the right-hand side, in its place.
    #[inline(always)]
    pub(super) fn solve<S: Simd>(&mut self, w: Wide<S>) {
        self.sections.solve(w, &mut self.right);
        if !self.sound {
            // No forces keep these joints together: whoever asks for them learns that they are not numbers.
            self.right
                .iter_mut()
                .for_each(|values| values.fill(f64::NAN));
        }
    }

    /// Force on the side after a joint \[N\].
    pub(super) fn force(&self, joint: usize) -> Vector {
        Vector::new(self.right[0][joint], self.right[1][joint])
    }

    /// r ← P_after − P_before for links that move like that.
    #[inline(always)]
    pub(super) fn set_opening<S: Simd>(
        &mut self,
        w: Wide<S>,
        linkage: &Linkage,
        posture: &Posture,
        moved: &ByLink,
    ) {
        let [right_x, right_y] = &mut self.right;
        for start in (0..linkage.joints.len()).step_by(Wide::<S>::COUNT) {
            let [bx, by, ax, ay] = arms(w, posture, start);
            // Link i − 1 ends at joint i, and link i begins there; links are counted from one on.
            let before = load(w, moved, start);
            let after = load(w, moved, start + 1);
            // P = r + φ ẑ × arm
            let x = (after[0] - after[2] * ay) - (before[0] - before[2] * by);
            let y = (after[1] + after[2] * ax) - (before[1] + before[2] * bx);
            let present = linkage.pairs.present(w, start);
            present.select(x, w.splat(0.0)).store(right_x, start);
            present.select(y, w.splat(0.0)).store(right_y, start);
        }
    }

    /// Forces and moments Jᵀ λ on the links from one on.
    #[inline(always)]
    pub(super) fn load<S: Simd>(&self, w: Wide<S>, posture: &Posture, link: usize) -> [Lane<S>; 3] {
        let [x, y] = &self.right;
        let [first_x, first_y] = [w.load(x, link), w.load(y, link)];
        let [second_x, second_y] = [w.load(x, link + 1), w.load(y, link + 1)];
        let [ax, ay] = [
            w.load(&posture.after.arm_x, link),
            w.load(&posture.after.arm_y, link),
        ];
        let [bx, by] = [
            w.load(&posture.before.arm_x, link + 1),
            w.load(&posture.before.arm_y, link + 1),
        ];
        [
            first_x - second_x,
            first_y - second_y,
            (ax * first_y - ay * first_x) - (bx * second_y - by * second_x),
        ]
    }
}

kernel!(
    /// The blocks of the joints and their factors; false if they are singular.
    fn factored<'a, S: Simd>(
        w: Wide<S>,
        reactions: &'a mut Reactions,
        linkage: &'a Linkage,
        posture: &'a Posture,
        inertia: Inertia,
    ) -> bool {
        match inertia {
            Inertia::OfLinks => reactions.fill::<S, true>(w, linkage, posture),
            Inertia::OfBlocks => reactions.fill::<S, false>(w, linkage, posture),
        }
        let [xx, yx, yy] = &reactions.own;
        let own = [&xx[..], &yx[..], &yy[..]];
        reactions.sections.take_in(own, &reactions.coupling);
        reactions.sections.factor(w)
    }
);

impl Reactions {
    #[inline(always)]
    fn fill<S: Simd, const FREE: bool>(
        &mut self,
        w: Wide<S>,
        linkage: &Linkage,
        posture: &Posture,
    ) {
        let (zero, one) = (w.splat(0.0), w.splat(1.0));
        for start in (0..linkage.joints.len()).step_by(Wide::<S>::COUNT) {
            let [bx, by, ax, ay] = arms(w, posture, start);
            let next = [
                w.load(&posture.before.arm_x, start + 1),
                w.load(&posture.before.arm_y, start + 1),
            ];
            // How the links before and after the joints give way: by their masses, or by what an implicit step has made of them.
            let (before, after) = if FREE {
                (
                    InverseInertia::free(w, &linkage.shapes, start),
                    InverseInertia::free(w, &linkage.shapes, start + 1),
                )
            } else {
                (
                    InverseInertia::Held(self.inverse.at(w, start)),
                    InverseInertia::Held(self.inverse.at(w, start + 1)),
                )
            };
            // At a joint both links give way; the link after it hands on what the next joint does.
            let first = before.between([bx, by], [bx, by]);
            let second = after.between([ax, ay], [ax, ay]);
            let across = after.between(next, [ax, ay]);
            let present = linkage.pairs.present(w, start);
            let both = linkage.pairs.both_present(w, start);
            // Rows of joints without a second side say λ = 0.
            for (own, (k, empty)) in self.own.iter_mut().zip([(0, one), (2, zero), (3, one)]) {
                present
                    .select(first[k] + second[k], empty)
                    .store(own, start);
            }
            for (coupling, across) in self.coupling.iter_mut().zip(across) {
                both.select(-across, zero).store(coupling, start);
            }
        }
    }
}

impl<S: Simd> InverseInertia<S> {
    #[inline(always)]
    fn free(w: Wide<S>, shapes: &Shapes, place: usize) -> Self {
        Self::Free([
            w.load(&shapes.mobility, place),
            w.load(&shapes.turning, place),
        ])
    }

    /// Velocity of a place on a link under an impulse at another, both relative to the centre of mass: entries (0, 0), (0, 1), (1, 0), (1,
    /// 1).
    #[inline(always)]
    fn between(&self, [px, py]: [Lane<S>; 2], [fx, fy]: [Lane<S>; 2]) -> [Lane<S>; 4] {
        match *self {
            // I/m + (ẑ × p)(ẑ × f)ᵀ/I
            Self::Free([mobility, turning]) => {
                let [x, y] = [turning * px, turning * py];
                [mobility + y * fy, -(y * fx), -(x * fy), mobility + x * fx]
            }
            // T_p G T_fᵀ,   T_p = [1 0 −p_y; 0 1 p_x]
            Self::Held([xx, yx, yy, tx, ty, tt]) => {
                let [first_t, second_t] = [tx - py * tt, ty + px * tt];
                [
                    (xx - py * tx) - fy * first_t,
                    (yx - py * ty) + fx * first_t,
                    (yx + px * tx) - fy * second_t,
                    (yy + px * ty) + fx * second_t,
                ]
            }
        }
    }
}

/// Arms of both sides of the joints from one on: before, then after.
#[inline(always)]
pub(super) fn arms<S: Simd>(w: Wide<S>, posture: &Posture, joint: usize) -> [Lane<S>; 4] {
    [
        w.load(&posture.before.arm_x, joint),
        w.load(&posture.before.arm_y, joint),
        w.load(&posture.after.arm_x, joint),
        w.load(&posture.after.arm_y, joint),
    ]
}

#[cfg(test)]
mod tests {
    use chaindrive_integrate::Registers;
    use nalgebra::{DMatrix, DVector};
    use pulp::{Scalar128b, WithSimd};

    use super::*;

    kernel!(
        fn solved<'a, S: Simd>(
            w: Wide<S>,
            sections: &'a mut Sections,
            right: &'a mut [Array; 2],
        ) -> bool {
            let sound = sections.factor(w);
            sections.solve(w, right);
            sound
        }
    );

    /// Rings and rows of two-by-two blocks, of any length, on lanes of any width, against the dense system.
    #[test]
    fn sections_are_solved_exactly() {
        let mut state = 0.4_f64;
        let mut next = || {
            state = (state * 997.13 + 0.123).fract();
            state - 0.5
        };
        let widths: [fn(&mut Sections, &mut [Array; 2]) -> bool; 3] = [
            |sections, right| solved(sections, right).with_simd(pulp::Scalar),
            |sections, right| solved(sections, right).with_simd(Scalar128b),
            |sections, right| Registers::in_use().dispatch(solved(sections, right)),
        ];
        let mut sections = Sections::default();
        for (count, closed) in (1..40).flat_map(|count| [(count, false), (count, true)]) {
            // No ring is shorter.
            if closed && count < 3 {
                continue;
            }
            let values = |next: &mut dyn FnMut() -> f64| {
                let mut values: Array = (0..count).map(|_| next()).collect();
                values.resize(padded(count) + LANES, 0.0);
                values
            };
            let mut own: [Array; 3] = std::array::from_fn(|_| values(&mut next));
            let mut coupling: [Array; 4] = std::array::from_fn(|_| values(&mut next));
            let right: [Array; 2] = std::array::from_fn(|_| values(&mut next));
            for k in [0, 2] {
                own[k].iter_mut().for_each(|own| *own += 3.0);
            }
            if !closed {
                for all in &mut coupling {
                    all[count - 1] = 0.0;
                }
            }
            let mut dense = DMatrix::<f64>::zeros(2 * count, 2 * count);
            for i in 0..count {
                for (p, o, k) in [(0, 0, 0), (1, 0, 1), (0, 1, 1), (1, 1, 2)] {
                    dense[(2 * i + p, 2 * i + o)] += own[k][i];
                }
                let after = (i + 1) % count;
                for (p, o, k) in [(0, 0, 0), (0, 1, 1), (1, 0, 2), (1, 1, 3)] {
                    if closed || i + 1 < count {
                        dense[(2 * after + p, 2 * i + o)] += coupling[k][i];
                        dense[(2 * i + o, 2 * after + p)] += coupling[k][i];
                    }
                }
            }
            let known = DVector::from_fn(2 * count, |i, _| right[i % 2][i / 2]);
            let exact = dense.lu().solve(&known).unwrap();
            for solve in widths {
                let mut found = right.clone();
                sections.lay_out(count, closed, SINGULAR);
                sections.take_in([&own[0], &own[1], &own[2]], &coupling);
                assert!(solve(&mut sections, &mut found));
                for i in 0..2 * count {
                    let error = (found[i % 2][i / 2] - exact[i]).abs();
                    assert!(error < 1e-13, "{count}, {closed}, {i}: {error:e}");
                }
                assert_eq!(found[0][count].to_bits(), found[0][0].to_bits());
            }
            // A row that says nothing.
            for all in &mut own {
                all[count / 2] = 0.0;
            }
            for all in &mut coupling {
                all.fill(0.0);
            }
            sections.take_in([&own[0], &own[1], &own[2]], &coupling);
            let mut right = right;
            assert!(!widths[2](&mut sections, &mut right), "{count}, {closed}");
        }
    }
}
