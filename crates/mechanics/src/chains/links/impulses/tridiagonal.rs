//! A block-tridiagonal matrix with a border, one block a joint.

use chaindrive_integrate::Array;
use std::cmp::Ordering;

use pulp::Simd;

use crate::chains::links::Linkage;
use crate::chains::links::reactions::Sections;
use crate::lanes::{LANES, Wide, padded};

/// Position of an unknown in the equations.
#[derive(Clone, Copy, Debug)]
pub(super) enum UnknownPlace {
    /// Joint, and row of it.
    Row(usize, usize),
    Border(usize),
}

/// Blocks of R rows, a border, and one right-hand side: B columns beside the blocks, fewer than the C around a link, which sees the
/// rows of two joints.
///
/// Single rows are eliminated one after the other: the last joint of a closed chain stands first in the border, before the wheels, and
/// the elimination begins at both ends and meets in the middle, since two recurrences at a time take as long as one. Two rows a joint
/// are eliminated in [`Sections`], where the last joint is as good as any, and the border after them, by one solution a column.
#[derive(Clone, Debug, Default)]
pub(super) struct Tridiagonal {
    /// Entries (p, o) of the joints' own blocks, o ≤ p, by joint; after the elimination of their inverses.
    own: [Array; 4],
    /// Entries of the blocks (joint + 1, joint): row p there, column o here; after the elimination of L.
    coupling: [Array; 4],
    right: [Array; 2],
    /// B columns for every row: the border, and the right-hand side after it.
    beside: Array,
    /// The border's own equations in the same columns.
    corner: Array,
    border: usize,
    /// Rows of a joint in the border.
    held: usize,
    /// Joints with blocks.
    count: usize,
    /// The unknowns of the border, once they are found.
    edge: Array,
    /// The unknowns of the joints, the first one of a closed chain once more after the last.
    found: [Array; 2],
    sections: Sections,
    /// Solutions of the sections for every column beside them.
    columns: Vec<[Array; 2]>,
}

/// Place of an entry of a block.
const fn entry(p: usize, o: usize) -> usize {
    2 * p + o
}

impl Tridiagonal {
    /// Makes room; entries of the blocks are written, not added, by the lanes.
    #[inline(always)]
    pub(super) fn clear<const R: usize, const B: usize>(
        &mut self,
        linkage: &Linkage,
        wheels: usize,
    ) {
        let joints = linkage.joints.len();
        self.held = usize::from(linkage.series.is_closed() && R == 1);
        self.border = self.held + wheels;
        self.count = joints - self.held;
        let lanes = padded(joints);
        if self.own[0].len() != lanes {
            for values in self
                .own
                .iter_mut()
                .chain(&mut self.coupling)
                .chain(&mut self.right)
            {
                values.resize(lanes, 0.0);
            }
            for values in &mut self.found {
                values.resize(lanes + LANES, 0.0);
            }
        }
        self.beside.clear();
        self.beside.resize(self.count * R * B, 0.0);
        self.corner.clear();
        self.corner.resize(self.border * B, 0.0);
        self.edge.resize(self.border, 0.0);
    }

    /// Entries (p, o) of the blocks of the joints.
    #[inline(always)]
    pub(super) fn own(&mut self, p: usize, o: usize) -> &mut [f64] {
        &mut self.own[entry(p, o)]
    }

    /// Entries of the blocks between a joint and the next: row p of that one, column o of this one.
    #[inline(always)]
    pub(super) fn coupling(&mut self, p: usize, o: usize) -> &mut [f64] {
        &mut self.coupling[entry(p, o)]
    }

    #[inline(always)]
    pub(super) fn right(&mut self, p: usize) -> &mut [f64] {
        &mut self.right[p]
    }

    /// Unknowns of the joints.
    #[inline(always)]
    pub(super) fn found(&self, p: usize) -> &[f64] {
        &self.found[p]
    }

    /// Place of the first wheel in the border.
    #[inline(always)]
    pub(super) fn first_wheel(&self) -> usize {
        self.held
    }

    /// Unknowns of the wheels and tensioners.
    #[inline(always)]
    pub(super) fn wheels(&self, wheels: usize) -> &[f64] {
        &self.edge[self.border - wheels..]
    }

    /// Moves right-hand sides, and the last joint of a closed chain, to where they are eliminated.
    #[inline(always)]
    pub(super) fn take_in<const R: usize, const B: usize>(&mut self) {
        for joint in 0..self.count {
            for p in 0..R {
                self.beside[(R * joint + p) * B + self.border] = self.right[p][joint];
            }
        }
        if self.held == 0 {
            return;
        }
        let last = self.count;
        for p in 0..R {
            self.add_right::<R, B>(UnknownPlace::Border(p), self.right[p][last]);
            for o in 0..R {
                if o <= p {
                    let value = self.own[entry(p, o)][last];
                    self.add::<R, B>(UnknownPlace::Border(p), UnknownPlace::Border(o), value);
                }
                // From the last joint back to the one before it, and on to the first.
                let value = self.coupling[entry(p, o)][last - 1];
                self.add::<R, B>(
                    UnknownPlace::Border(p),
                    UnknownPlace::Row(last - 1, o),
                    value,
                );
                let value = self.coupling[entry(p, o)][last];
                self.add::<R, B>(UnknownPlace::Row(0, p), UnknownPlace::Border(o), value);
            }
        }
    }

    /// Where a column stands that is counted from the rows of two joints on, over the wheels.
    #[inline(always)]
    fn place<const R: usize>(&self, joints: [usize; 2], column: usize) -> UnknownPlace {
        if column >= 2 * R {
            return UnknownPlace::Border(self.held + column - 2 * R);
        }
        let joint = joints[column / R];
        if joint < self.count {
            UnknownPlace::Row(joint, column % R)
        } else {
            UnknownPlace::Border(column % R)
        }
    }

    /// Subtracts a symmetric matrix over the rows of two neighbours, the wheels, and the right-hand side.
    #[inline(always)]
    pub(super) fn subtract<const R: usize, const C: usize, const B: usize>(
        &mut self,
        first: usize,
        second: usize,
        sum: &[[f64; C]; C],
    ) {
        // Columns: rows of the first joint, of the second, wheels, right-hand side.
        let wheels = self.border - self.held;
        let known = 2 * R + wheels;
        if first >= self.count || second >= self.count {
            // Beside the joint that closes the chain.
            for (x, sum) in sum[..known].iter().enumerate() {
                let place = self.place::<R>([first, second], x);
                for (y, value) in sum[..=x].iter().enumerate() {
                    let other = self.place::<R>([first, second], y);
                    self.add::<R, B>(place, other, -value);
                }
                self.add_right::<R, B>(place, -sum[known]);
            }
            return;
        }
        for p in 0..R {
            for o in 0..R {
                if o <= p {
                    self.own[entry(p, o)][first] -= sum[p][o];
                    self.own[entry(p, o)][second] -= sum[R + p][R + o];
                }
                self.coupling[entry(p, o)][first] -= sum[R + p][o];
            }
            for (joint, sum) in [(first, &sum[p]), (second, &sum[R + p])] {
                let from = (R * joint + p) * B + self.held;
                let beside = &mut self.beside[from..=from + wheels];
                for (beside, sum) in beside.iter_mut().zip(&sum[2 * R..]) {
                    *beside -= sum;
                }
            }
        }
        for (wheel, sum) in sum[2 * R..known].iter().enumerate() {
            let from = (self.held + wheel) * B + self.held;
            let corner = &mut self.corner[from..=from + wheels];
            for (corner, sum) in corner.iter_mut().zip(&sum[2 * R..]) {
                *corner -= sum;
            }
        }
    }

    /// The unknowns over the same columns with a negative sign, and one on the right-hand side.
    #[inline(always)]
    pub(super) fn around<const R: usize, const C: usize>(
        &self,
        first: usize,
        second: usize,
    ) -> [f64; C] {
        let mut around = [0.0; C];
        for p in 0..R {
            around[p] = -self.found[p][first];
            around[R + p] = -self.found[p][second];
        }
        let wheels = &self.edge[self.held..];
        for (around, found) in around[2 * R..].iter_mut().zip(wheels) {
            *around = -found;
        }
        around[2 * R + wheels.len()] = 1.0;
        around
    }

    /// Adds to an entry and to its mirror image.
    #[inline(always)]
    pub(super) fn add<const R: usize, const B: usize>(
        &mut self,
        a: UnknownPlace,
        b: UnknownPlace,
        value: f64,
    ) {
        match (a, b) {
            (UnknownPlace::Row(i, p), UnknownPlace::Row(j, o)) => {
                let entries = match i.cmp(&j) {
                    Ordering::Equal => &mut self.own[entry(p.max(o), p.min(o))],
                    Ordering::Greater => &mut self.coupling[entry(p, o)],
                    Ordering::Less => &mut self.coupling[entry(o, p)],
                };
                entries[i.min(j)] += value;
            }
            (UnknownPlace::Row(i, p), UnknownPlace::Border(j))
            | (UnknownPlace::Border(j), UnknownPlace::Row(i, p)) => {
                self.beside[(R * i + p) * B + j] += value;
            }
            (UnknownPlace::Border(i), UnknownPlace::Border(j)) => {
                self.corner[i * B + j] += value;
                if i != j {
                    self.corner[j * B + i] += value;
                }
            }
        }
    }

    /// Adds to a right-hand side.
    #[inline(always)]
    pub(super) fn add_right<const R: usize, const B: usize>(
        &mut self,
        place: UnknownPlace,
        value: f64,
    ) {
        match place {
            UnknownPlace::Row(i, p) => self.beside[(R * i + p) * B + self.border] += value,
            UnknownPlace::Border(i) => self.corner[i * B + self.border] += value,
        }
    }

    /// L D Lᵀ in place; border and right-hand sides are carried along. False if a pivot vanishes.
    #[inline(always)]
    pub(super) fn factor<S: Simd, const R: usize, const B: usize>(
        &mut self,
        w: Wide<S>,
        linkage: &Linkage,
    ) -> bool {
        let mut corner = [[0.0; B]; B];
        let sound = if R == 1 {
            self.eliminate_rows::<B>(&mut corner)
        } else {
            self.eliminate_sections::<S, B>(w, linkage, &mut corner)
        };
        for (i, sum) in corner[..self.border].iter().enumerate() {
            for (j, sum) in sum[..=self.border].iter().enumerate() {
                self.corner[i * B + j] -= sum;
            }
        }
        sound && self.factor_corner::<B>()
    }

    #[inline(always)]
    fn eliminate_rows<const B: usize>(&mut self, corner: &mut [[f64; B]; B]) -> bool {
        // Two eliminations towards the middle, by turns: neither waits for the other.
        let middle = self.count / 2;
        let mut sound = true;
        for k in 0..=middle {
            let behind = self.count - 1 - k;
            if k < middle {
                sound &= self.eliminate::<B>(k, Some((k + 1, k)), corner);
            }
            if behind > middle {
                sound &= self.eliminate::<B>(behind, Some((behind - 1, behind - 1)), corner);
            }
        }
        sound & self.eliminate::<B>(middle, None, corner)
    }

    /// Eliminates a joint into (neighbour, place of their coupling).
    #[inline(always)]
    fn eliminate<const B: usize>(
        &mut self,
        joint: usize,
        into: Option<(usize, usize)>,
        corner: &mut [[f64; B]; B],
    ) -> bool {
        // The pivot, which is positive in a quasi-definite matrix.
        let inverse = 1.0 / self.own[0][joint];
        if inverse.is_nan() || inverse <= 0.0 {
            return false;
        }
        self.own[0][joint] = inverse;
        let rows = self.beside.as_chunks_mut::<B>().0;
        let here = rows[joint];
        // D⁻¹ times everything beside.
        let scaled = here.map(|here| inverse * here);
        // The border loses what this row gives it.
        for (corner, own) in corner.iter_mut().zip(here) {
            for (corner, scaled) in corner.iter_mut().zip(scaled) {
                *corner += own * scaled;
            }
        }
        let Some((neighbour, coupling)) = into else {
            return true;
        };
        // So does the neighbour that is left, and its share of the border.
        let between = self.coupling[0][coupling];
        let factor = between * inverse;
        self.coupling[0][coupling] = factor;
        self.own[0][neighbour] -= factor * between;
        for (there, here) in rows[neighbour].iter_mut().zip(here) {
            *there -= factor * here;
        }
        true
    }

    /// All joints at once; what is left of the border is Wᵀ A⁻¹ W.
    #[inline(always)]
    fn eliminate_sections<S: Simd, const B: usize>(
        &mut self,
        w: Wide<S>,
        linkage: &Linkage,
        corner: &mut [[f64; B]; B],
    ) -> bool {
        // Quasi-definite: whatever is positive will do, since the rows of one joint may differ by any power of ten.
        self.sections
            .lay_out(self.count, linkage.series.is_closed(), 0.0);
        let [xx, _, yx, yy] = &self.own;
        self.sections
            .take_in([&xx[..], &yx[..], &yy[..]], &self.coupling);
        if !self.sections.factor(w) {
            return false;
        }
        // One solution for every column of the border and the right-hand side, and its product with all columns.
        let joints = self.beside.as_chunks::<B>().0.as_chunks::<2>().0;
        self.columns.resize_with(self.border + 1, Default::default);
        for (j, column) in self.columns.iter_mut().enumerate() {
            read_column::<B>(joints, j, column, self.found[0].len());
            self.sections.solve(w, column);
            let [x, y] = &*column;
            let mut sums = [[0.0; B]; 2];
            for ((x, y), beside) in x.iter().zip(y).zip(joints) {
                for ((sum, beside), found) in sums.iter_mut().zip(beside).zip([x, y]) {
                    for (sum, beside) in sum.iter_mut().zip(beside) {
                        *sum += beside * found;
                    }
                }
            }
            for (i, corner) in corner.iter_mut().enumerate() {
                corner[j] = sums[0][i] + sums[1][i];
            }
        }
        true
    }

    #[inline(always)]
    fn factor_corner<const B: usize>(&mut self) -> bool {
        let rows = self.corner.as_chunks_mut::<B>().0;
        for i in 0..self.border {
            let (done, rest) = rows.split_at_mut(i + 1);
            let here = &done[i];
            let inverse = 1.0 / here[i];
            if !inverse.is_finite() {
                return false;
            }
            for below in rest {
                let factor = below[i] * inverse;
                for (below, here) in below.iter_mut().zip(here) {
                    *below -= factor * here;
                }
            }
        }
        true
    }

    /// Back through the border, D and Lᵀ, from the middle outward.
    #[inline(always)]
    pub(super) fn substitute<const R: usize, const B: usize>(&mut self, linkage: &Linkage) {
        for i in (0..self.border).rev() {
            let row = &self.corner[i * B..(i + 1) * B];
            let known = row[i + 1..self.border].iter().zip(&self.edge[i + 1..]);
            let sum: f64 = known.map(|(a, x)| a * x).sum();
            self.edge[i] = (row[self.border] - sum) / row[i];
        }
        if R == 1 {
            self.substitute_rows::<B>(linkage);
            return;
        }
        let (wheels, right) = self.columns.split_at(self.border);
        for (p, found) in self.found.iter_mut().enumerate() {
            found.copy_from_slice(&right[0][p]);
            for (column, edge) in wheels.iter().zip(&self.edge) {
                for (found, column) in found.iter_mut().zip(&column[p]) {
                    *found -= column * edge;
                }
            }
        }
    }

    #[inline(always)]
    fn substitute_rows<const B: usize>(&mut self, linkage: &Linkage) {
        let mut edge = [0.0; B];
        for (edge, found) in edge.iter_mut().zip(&self.edge) {
            *edge = -found;
        }
        edge[self.border] = 1.0;
        let middle = self.count / 2;
        self.find::<B>(middle, None, &edge);
        for k in (0..middle).rev() {
            self.find::<B>(k, Some((k + 1, k)), &edge);
            let behind = self.count - 1 - k;
            if behind > middle {
                self.find::<B>(behind, Some((behind - 1, behind - 1)), &edge);
            }
        }
        if linkage.series.is_closed() {
            self.found[0][self.count] = self.edge[0];
            self.found[0][linkage.series.links] = self.found[0][0];
        }
    }

    /// y = D⁻¹ (r − beside·edge) − Lᵀ y of the neighbour
    #[inline(always)]
    fn find<const B: usize>(
        &mut self,
        joint: usize,
        from: Option<(usize, usize)>,
        edge: &[f64; B],
    ) {
        let here = self.beside.as_chunks::<B>().0[joint];
        let right: f64 = here.iter().zip(edge).map(|(a, x)| a * x).sum();
        let mut value = self.own[0][joint] * right;
        if let Some((neighbour, coupling)) = from {
            value -= self.coupling[0][coupling] * self.found[0][neighbour];
        }
        self.found[0][joint] = value;
    }
}

/// Takes a column apart by the rows of the joints; out of line, as [`Sections`] goes from joints to sections.
#[inline(never)]
fn read_column<const B: usize>(
    joints: &[[[f64; B]; 2]],
    j: usize,
    column: &mut [Array; 2],
    length: usize,
) {
    for values in &mut *column {
        values.resize(length, 0.0);
    }
    let [x, y] = column;
    for ((x, y), beside) in x.iter_mut().zip(y).zip(joints) {
        [*x, *y] = [beside[0][j], beside[1][j]];
    }
}
