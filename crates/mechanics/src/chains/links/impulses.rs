//! (M + c C + k K) x = M b of a step of one solution: one unknown a row of the joints instead of three a link.
//!
//! ```text
//! ⎡ D  Wᵀ  Jᵀ  ⎤ ⎡x⎤   ⎡M b⎤      D: blocks of the links, W: their couplings with the wheels, S: the wheels
//! ⎢ W  S       ⎥ ⎢z⎥ = ⎢M b⎥      J: rows of the joints,   w: their weights,   y = w J x: impulses
//! ⎣ J     −1/w ⎦ ⎣y⎦   ⎣ 0 ⎦
//!
//! P(r) = D⁻¹ (r − Jᵀ y),   (1/w + J D⁻¹ Jᵀ) y = J D⁻¹ r
//! (S − W P(Wᵀ)) z = M b − W P(M b),   x = P(M b) − P(Wᵀ) z
//! ```
//!
//! w is the weight of a row: [`Element::step_weights`](super::Element::step_weights). Every joint has a row for its normal and one for
//! its tangent; joints share a link with their neighbours only, so that the matrix over their rows has blocks of two rows beside its diagonal. All other contacts stand in the blocks of the links
//! and wheels; free rollers are eliminated first.

mod rows;

use chaindrive_integrate::{Array, Weights, kernel};
use pulp::Simd;

use rows::{RowLane, Rows};

use super::by_link::{ByLink, load};
use super::equations::Sum;
use super::inverse_blocks::InverseBlocks;
use super::reactions::Sections;
use super::{BorderedBlocks, Joining, JointState, Linkage};
use crate::bodies::GroupBodies;
use crate::contact::BoreContact;
use crate::joints::Pins;
use crate::lanes::{LANES, Lane, Wide, padded};

/// The rows of one step and their factors.
#[derive(Clone, Debug, Default)]
pub(crate) struct Impulses {
    /// Normals of the joints, and tangents.
    rows: [Rows; 2],
    /// b of the links.
    known: ByLink,
    /// D⁻¹
    inverse: InverseBlocks,
    /// Entries (0, 0), (1, 0), (1, 1) of the joints' own blocks, whole lanes.
    own: [Array; 3],
    /// Entries (0, 0), (0, 1), (1, 0), (1, 1) of the blocks (joint + 1, joint).
    coupling: [Array; 4],
    sections: Sections,
    /// Of every unknown of a wheel, and of the right-hand side after them.
    columns: Vec<Column>,
    /// W P(Wᵀ), and W P(M b) in the last column, row by row.
    products: Vec<f64>,
    /// Whether there are factors.
    sound: bool,
}

/// A load on the links, and how they answer.
#[derive(Clone, Debug, Default)]
struct Column {
    /// r
    load: ByLink,
    /// D⁻¹ r, then P(r).
    answer: ByLink,
    /// J D⁻¹ r, then y, by joint.
    impulses: [Array; 2],
}

impl Linkage {
    /// x ← (M + c C + k K)⁻¹ M x; false if there is none.
    pub(crate) fn step(
        &self,
        bodies: GroupBodies<'_>,
        weights: Weights,
        joint_state: &mut JointState,
        work: &mut Impulses,
        x: &mut [f64],
    ) -> bool {
        let Joining::Clearance(bearing) = &self.joining else {
            return false;
        };
        let mut equations = std::mem::take(&mut joint_state.equations);
        let links = self.series.links;
        let mut sum = Sum::new(self, &mut equations, links, x);
        sum.add_masses(bodies, weights, x);
        for element in &joint_state.elements {
            sum.add(element, &joint_state.mounts, weights, x);
        }
        let sound = sum.eliminate_rollers() && work.inverse.invert(self, &sum.blocks.diagonal);
        if sound {
            // What stands beside the blocks, taken apart for lanes.
            let blocks = &mut *sum.blocks;
            let border = blocks.right_border.len();
            let b = x[..3 * links].as_chunks::<3>().0;
            work.known.read(self, b.iter().copied());
            work.columns.resize_with(border + 1, Column::default);
            for (j, column) in work.columns[..border].iter_mut().enumerate() {
                let beside = blocks.beside.chunks_exact(border).map(|row| row[j]);
                column.load.read(self, beside.map(|r| [r.x, r.y, r.z]));
            }
            let right = blocks.right.iter().map(|r| [r.x, r.y, r.z]);
            work.columns[border].load.read(self, right);
            let step = Step {
                linkage: self,
                bearing,
                weights,
                joint_state,
            };
            self.series.registers.dispatch(answers(work, step));
        }
        let solved = sound && work.find(sum.blocks, links);
        if solved {
            sum.read(x);
            let JointState {
                elements,
                mounts,
                carried,
                ..
            } = &mut *joint_state;
            sum.carry(elements, mounts, weights.damping, x, carried);
            let found = Found {
                linkage: self,
                pins: &joint_state.pins,
                h: weights.damping,
            };
            joint_state.carried.joints[0] = self.series.registers.dispatch(lost(work, found));
        }
        joint_state.equations = equations;
        solved
    }
}

/// Inputs of the solution of one step.
#[derive(Clone, Copy)]
struct Step<'a> {
    linkage: &'a Linkage,
    bearing: &'a BoreContact,
    weights: Weights,
    joint_state: &'a JointState,
}

kernel!(
    /// The answers of the links to all loads, and the products of loads and answers; the factors, where they are singular, are left without.
    fn answers<'a, S: Simd>(w: Wide<S>, work: &'a mut Impulses, step: Step<'a>) {
        let Step {
            linkage,
            bearing,
            weights,
            joint_state,
        } = step;
        work.resize(linkage);
        work.rows[0].set_normals(w, joint_state, weights);
        work.rows[1].set_tangents(w, linkage, bearing, joint_state, &work.known, weights);
        work.fill(w, linkage);
        // Quasi-definite: whatever is positive will do, since the rows of one joint may differ by any power of ten.
        let (joints, closed) = (linkage.joints.len(), linkage.series.is_closed());
        work.sections.lay_out(joints, closed, 0.0);
        let [xx, yx, yy] = &work.own;
        work.sections
            .take_in([&xx[..], &yx[..], &yy[..]], &work.coupling);
        work.sound = work.sections.factor(w);
        let mut columns = std::mem::take(&mut work.columns);
        for column in &mut columns {
            work.answer(w, linkage, column);
        }
        let border = columns.len() - 1;
        work.products.resize(border * columns.len(), 0.0);
        for (j, row) in work.products.chunks_exact_mut(columns.len()).enumerate() {
            let load = &columns[j].load;
            for (product, column) in row.iter_mut().zip(&columns) {
                *product = times(w, linkage, load, &column.answer);
            }
        }
        work.columns = columns;
    }
);

/// Joints and links after the solution of a step of length h \[s\].
#[derive(Clone, Copy)]
struct Found<'a> {
    linkage: &'a Linkage,
    pins: &'a Pins,
    h: f64,
}

kernel!(
    /// Energy \[J\] that the joints lose along their normals in a step, beside what their forces at its beginning do at the speeds then.
    ///
    /// ```text
    /// h (½ R Δ + d Δ (δ̇ + ½ Δ))     R: what of the force resists, R + d Δ over the step at a speed of δ̇ + ½ Δ
    /// ```
    fn lost<'a, S: Simd>(w: Wide<S>, work: &'a mut Impulses, found: Found<'a>) -> f64 {
        let Found { linkage, pins, h } = found;
        let Some(whole) = work.columns.last_mut() else {
            return 0.0;
        };
        let (answer, rows) = (&mut whole.answer, &work.rows[0]);
        answer.close(linkage);
        let half = w.splat(0.5);
        let (joints, mut sum) = (linkage.joints.len(), w.splat(0.0));
        for start in (0..joints).step_by(Wide::<S>::COUNT) {
            let (before, after) = (load(w, answer, start), load(w, answer, start + 1));
            let change = parting(rows.load(w, start), &before, &after);
            let [damping, closing, resisting] =
                [&pins.damping, &pins.closing, &pins.resisting].map(|all| w.load(all, start));
            let speed = closing.plus(half, change);
            let lost = change * (half * resisting).plus(damping, speed);
            sum += w.first(joints - start).select(lost, w.splat(0.0));
        }
        h * sum.sum()
    }
);

/// How the sides of joints part along a row.
#[inline(always)]
fn parting<S: Simd>(row: RowLane<S>, before: &[Lane<S>; 3], after: &[Lane<S>; 3]) -> Lane<S> {
    let along = (row.x * (after[0] - before[0])).plus(row.y, after[1] - before[1]);
    along
        .plus(row.turn_after, after[2])
        .minus(row.turn_before, before[2])
}

impl Impulses {
    fn resize(&mut self, linkage: &Linkage) {
        let lanes = padded(linkage.joints.len());
        for values in self.own.iter_mut().chain(&mut self.coupling) {
            values.resize(lanes, 0.0);
        }
        for column in &mut self.columns {
            for values in &mut column.impulses {
                values.resize(lanes + LANES, 0.0);
            }
        }
    }

    /// The rows of the joints among themselves: 1/w + J D⁻¹ Jᵀ.
    #[inline(always)]
    fn fill<S: Simd>(&mut self, w: Wide<S>, linkage: &Linkage) {
        let (zero, one) = (w.splat(0.0), w.splat(1.0));
        let rows = &self.rows;
        for start in (0..linkage.joints.len()).step_by(Wide::<S>::COUNT) {
            // How the links before and after the joints give way to impulses along their rows.
            let (before, after) = (self.inverse.at(w, start), self.inverse.at(w, start + 1));
            let (normal, tangent) = (rows[0].load(w, start), rows[1].load(w, start));
            let along = given(&before, &after, normal);
            let across = given(&before, &after, tangent);
            let compliance = |rows: &Rows| {
                let weight = w.load(&rows.weight, start);
                weight.greater(zero).select(weight, one).recip()
            };
            let [xx, yx, yy] = &mut self.own;
            (back(normal, &along) + compliance(&rows[0])).store(xx, start);
            back(tangent, &along).store(yx, start);
            (back(tangent, &across) + compliance(&rows[1])).store(yy, start);
            // The link after a joint hands on what the next joint does.
            let next = (rows[0].load(w, start + 1), rows[1].load(w, start + 1));
            let [nn, nt, tn, tt] = &mut self.coupling;
            handed_on(next.0, &along[1]).store(nn, start);
            handed_on(next.0, &across[1]).store(nt, start);
            handed_on(next.1, &along[1]).store(tn, start);
            handed_on(next.1, &across[1]).store(tt, start);
        }
    }

    /// P(r) of a column.
    #[inline(always)]
    fn answer<S: Simd>(&mut self, w: Wide<S>, linkage: &Linkage, column: &mut Column) {
        let Column {
            load: given,
            answer,
            impulses,
        } = column;
        answer.resize(linkage);
        for link in (0..linkage.series.links).step_by(Wide::<S>::COUNT) {
            let moved = self.inverse.yielding(w, link, load(w, given, link + 1));
            answer.put(link, moved);
        }
        answer.close(linkage);
        // J x: how the sides of the joints part along the rows.
        for start in (0..linkage.joints.len()).step_by(Wide::<S>::COUNT) {
            let (before, after) = (load(w, answer, start), load(w, answer, start + 1));
            for (rows, to) in self.rows.iter().zip(&mut *impulses) {
                parting(rows.load(w, start), &before, &after).store(to, start);
            }
        }
        self.sections.solve(w, impulses);
        // A link is pushed by the joint at its beginning, and back by the one at its end.
        let [along, across] = impulses;
        for link in (0..linkage.series.links).step_by(Wide::<S>::COUNT) {
            // Row by row and not in a loop, whose sums would be put down in memory between its turns.
            let normal = pushed(w, &self.rows[0], along, link);
            let tangent = pushed(w, &self.rows[1], across, link);
            let push = [
                normal[0] + tangent[0],
                normal[1] + tangent[1],
                normal[2] + tangent[2],
            ];
            let held = self.inverse.yielding(w, link, push);
            let free = load(w, answer, link + 1);
            answer.put(
                link,
                [free[0] - held[0], free[1] - held[1], free[2] - held[2]],
            );
        }
    }

    /// The unknowns of the wheels, and the links in the place of their right-hand sides; false if there are none.
    fn find(&mut self, blocks: &mut BorderedBlocks, links: usize) -> bool {
        let Some((whole, columns)) = self.columns.split_last_mut() else {
            return false;
        };
        for (j, products) in self.products.chunks_exact(columns.len() + 1).enumerate() {
            blocks.right_border[j] -= products[columns.len()];
            for (k, product) in products[..=j].iter().enumerate() {
                blocks.corner[(j, k)] -= product;
            }
        }
        if !self.sound || !blocks.solve_border() {
            return false;
        }
        for (column, z) in columns.iter().zip(blocks.right_border.iter()) {
            whole.answer.subtract(&column.answer, *z);
        }
        for (x, found) in blocks.right.iter_mut().zip(whole.answer.each(links)) {
            *x = found.into();
        }
        true
    }
}

/// What impulses along one row of the joints do to the links from one on.
#[inline(always)]
fn pushed<S: Simd>(w: Wide<S>, rows: &Rows, impulses: &[f64], link: usize) -> [Lane<S>; 3] {
    let (row, next) = (rows.load(w, link), rows.load(w, link + 1));
    let (y, z) = (w.load(impulses, link), w.load(impulses, link + 1));
    [
        (row.x * y).minus(next.x, z),
        (row.y * y).minus(next.y, z),
        (row.turn_after * y).minus(next.turn_before, z),
    ]
}

/// The product of a block and three numbers of each link.
#[inline(always)]
fn yielded<S: Simd>(
    [xx, yx, yy, tx, ty, tt]: &[Lane<S>; 6],
    [x, y, turn]: [Lane<S>; 3],
) -> [Lane<S>; 3] {
    [
        (*xx * x).plus(*yx, y).plus(*tx, turn),
        (*yx * x).plus(*yy, y).plus(*ty, turn),
        (*tx * x).plus(*ty, y).plus(*tt, turn),
    ]
}

#[inline(always)]
fn dot<S: Simd>([x, y, turn]: [Lane<S>; 3], other: &[Lane<S>; 3]) -> Lane<S> {
    (x * other[0]).plus(y, other[1]).plus(turn, other[2])
}

/// How the links before and after the joints give way to impulses along a row.
#[inline(always)]
fn given<S: Simd>(
    before: &[Lane<S>; 6],
    after: &[Lane<S>; 6],
    row: RowLane<S>,
) -> [[Lane<S>; 3]; 2] {
    [
        yielded(before, [row.x, row.y, row.turn_before]),
        yielded(after, [row.x, row.y, row.turn_after]),
    ]
}

/// How the next joints part along a row, under what the links after these ones do.
#[inline(always)]
fn handed_on<S: Simd>(next: RowLane<S>, after: &[Lane<S>; 3]) -> Lane<S> {
    -dot([next.x, next.y, next.turn_before], after)
}

/// How the sides of joints part along a row, under what the links before and after do.
#[inline(always)]
fn back<S: Simd>(row: RowLane<S>, [before, after]: &[[Lane<S>; 3]; 2]) -> Lane<S> {
    let first = dot([row.x, row.y, row.turn_before], before);
    first + dot([row.x, row.y, row.turn_after], after)
}

/// Sum of the products of two triples over the links.
#[inline(always)]
fn times<S: Simd>(w: Wide<S>, linkage: &Linkage, one: &ByLink, other: &ByLink) -> f64 {
    let mut sum = w.splat(0.0);
    for link in (0..linkage.series.links).step_by(Wide::<S>::COUNT) {
        // After the last link of a closed chain the first stands once more.
        let own = w.first(linkage.series.links - link);
        let product = dot(load(w, one, link + 1), &load(w, other, link + 1));
        sum += own.select(product, w.splat(0.0));
    }
    sum.sum()
}
