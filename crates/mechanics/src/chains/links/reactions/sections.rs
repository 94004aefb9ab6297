//! Blocks of two rows along a chain, eliminated in eight sections side by side.
//!
//! ```text
//! section:   rows 0 … m − 2  ─ eliminated on lanes ─►  its last row, coupled with the last rows of both neighbours
//! ```
//!
//! Every lane eliminates the rows of a section of its own, from its beginning to its end, and carries along what they have to do with
//! the last row of the section before. The last rows are left: a ring of eight blocks, or a row of them where the chain is open.

use chaindrive_geometry::Vector;
use chaindrive_integrate::Array;
use nalgebra::Matrix2;
use pulp::Simd;

use super::ring::Ring;
use crate::lanes::{LANES, Lane, Wide};

/// Entries (0, 0), (1, 0), (1, 1) of a symmetric block.
type Square<S> = [Lane<S>; 3];
/// Entries (0, 0), (0, 1), (1, 0), (1, 1).
type Block<S> = [Lane<S>; 4];

/// The same row of every section, side by side.
#[derive(Clone, Copy, Debug)]
struct Row {
    own: [[f64; LANES]; 3],
    /// Block (next row, this row) within the section.
    below: [[f64; LANES]; 4],
    /// Inverse of what the elimination leaves of the row's own block.
    pivot: [[f64; LANES]; 3],
    /// Block (this row, last row of the section before), as the elimination leaves it.
    beside: [[f64; LANES]; 4],
    right: [[f64; LANES]; 2],
}

/// The blocks, their factors, and a right-hand side that becomes the solution.
///
/// Shorter sections have one row less, and nothing in the place of their first one.
#[derive(Clone, Debug, Default)]
pub(in crate::chains::links) struct Sections {
    count: usize,
    /// Rows of the longest section.
    length: usize,
    /// Sections of that length.
    full: usize,
    rows: Vec<Row>,
    /// Blocks (first row, last row of the section before) of sections that begin in row 0, and in row 1.
    entering: [[[f64; LANES]; 4]; 2],
    ring: Ring,
}

impl Row {
    /// Where there is no row nothing couples.
    const NONE: Self = Self {
        own: [[1.0; LANES], [0.0; LANES], [1.0; LANES]],
        below: [[0.0; LANES]; 4],
        pivot: [[0.0; LANES]; 3],
        beside: [[0.0; LANES]; 4],
        right: [[0.0; LANES]; 2],
    };
}

impl Sections {
    /// Makes room for as many rows. Blocks are singular of which less than this share of their stiffest direction is left in another.
    pub(in crate::chains::links) fn lay_out(&mut self, count: usize, closed: bool, singular: f64) {
        self.ring.singular = singular;
        if self.count == count && self.ring.closed == closed {
            return;
        }
        self.count = count;
        self.length = count.div_ceil(LANES);
        self.full = count - LANES * (self.length - 1);
        self.rows.clear();
        self.rows.resize(self.length, Row::NONE);
        self.entering = [[[0.0; LANES]; 4]; 2];
        self.ring = Ring::new(count.min(LANES), closed, singular);
    }

    /// Rows of a section: its first place among those of the longest, and the joints.
    #[inline(always)]
    fn rows(&self, section: usize) -> (usize, std::ops::Range<usize>) {
        let shorter = usize::from(section >= self.full);
        let begin = section * (self.length - 1) + section.min(self.full);
        (shorter, begin..begin + self.length - shorter)
    }

    /// Takes in the blocks of all joints, and those between a joint and the next, which of the last one is the first.
    ///
    /// Like what else goes from joints to sections or back, it is kept out of line, and so compiled for the oldest processor: newer ones
    /// would gather and scatter, which takes several times as long as one by one.
    #[inline(never)]
    pub(in crate::chains::links) fn take_in(&mut self, own: [&[f64]; 3], coupling: &[Array; 4]) {
        let coupling = [0, 1, 2, 3].map(|k| &coupling[k][..self.count]);
        let own = own.map(|own| &own[..self.count]);
        for section in 0..self.ring.count {
            let (first, joints) = self.rows(section);
            let next = (section + 1) % self.ring.count;
            let entry = usize::from(next >= self.full);
            let last = joints.end - 1;
            for (row, joint) in self.rows[first..].iter_mut().zip(joints) {
                for (to, from) in row.own.iter_mut().zip(own) {
                    to[section] = from[joint];
                }
                for (to, from) in row.below.iter_mut().zip(coupling) {
                    to[section] = from[joint];
                }
            }
            for (to, from) in self.entering[entry].iter_mut().zip(coupling) {
                to[next] = from[last];
            }
        }
    }

    /// Factors the blocks; false if they are singular.
    #[inline(always)]
    pub(in crate::chains::links) fn factor<S: Simd>(&mut self, w: Wide<S>) -> bool {
        let mut sound = true;
        let mut corners = [[0.0; LANES]; 3];
        let Some((last, rows)) = self.rows.split_last_mut() else {
            return true;
        };
        for lane in (0..LANES).step_by(Wide::<S>::COUNT) {
            // The row whose turn it is, and what stands beside it.
            let mut own = rows.first().map_or(last.own, |row| row.own);
            let mut block = load(w, &own, lane);
            let mut beside = load(w, &self.entering[0], lane);
            let mut corner = [w.splat(0.0); 3];
            // Each row is eliminated into the next one of its section, and into the last row of the section before.
            let following = rows.len();
            for i in 0..following {
                let whole = load(w, &own, lane);
                own = rows.get(i + 1).map_or(last.own, |row| row.own);
                let row = &mut rows[i];
                let [a, b, d] = block;
                let determinant = a * d - b * b;
                // As `inverse_of` of the ring has it.
                let enough = w.splat(self.ring.singular) * (whole[0] + whole[2]) * (a + d);
                sound &= (determinant - enough).smallest() > 0.0;
                let inverse = determinant.recip();
                let pivot = [d * inverse, -(b * inverse), a * inverse];
                let below = load(w, &row.below, lane);
                // D′ − E P Eᵀ, and −E P F of what stands beside
                let scaled = times(&below, &pivot);
                block = minus(load(w, &own, lane), product(&scaled, &below));
                corner = plus(corner, square(&pivot, &beside));
                store(pivot, &mut row.pivot, lane);
                store(beside, &mut row.beside, lane);
                beside = negative_product(&scaled, &beside);
                if i == 0 {
                    beside = sum(beside, load(w, &self.entering[1], lane));
                }
            }
            // What is left of the last rows makes up the ring, one by one.
            let whole = load(w, &last.own, lane);
            let whole = (whole[0] + whole[2]).numbers();
            let [a, b, d] = block.map(Lane::numbers);
            let [e, f, g, h] = beside.map(Lane::numbers);
            for k in 0..Wide::<S>::COUNT {
                let section = lane + k;
                self.ring.whole[section] = whole[k];
                self.ring.diagonal[section] = Matrix2::new(a[k], b[k], b[k], d[k]);
                self.ring.below[(section + LANES - 1) % LANES] =
                    Matrix2::new(e[k], f[k], g[k], h[k]);
            }
            store(corner, &mut corners, lane);
        }
        // What the first rows of a section take from the last one before it.
        let count = self.ring.count;
        for section in 0..count {
            let [a, b, d] = [0, 1, 2].map(|k| corners[k][section]);
            let before = (section + count - 1) % count;
            self.ring.diagonal[before] -= Matrix2::new(a, b, b, d);
        }
        self.ring.below[count - 1] = self.ring.below[LANES - 1];
        sound && self.ring.eliminate().is_some()
    }

    /// Solves for one right-hand side in its place; after the last joint that of the first comes once more.
    #[inline(always)]
    pub(in crate::chains::links) fn solve<S: Simd>(&mut self, w: Wide<S>, values: &mut [Array; 2]) {
        self.spread(values);
        let Some((last, rows)) = self.rows.split_last_mut() else {
            return;
        };
        let mut corners = [[0.0; LANES]; 2];
        for lane in (0..LANES).step_by(Wide::<S>::COUNT) {
            // Forward: each row hands its share of the right-hand side on to the next, and to the last row of the section before.
            let mut right = [w.splat(0.0); 2];
            let mut corner = [w.splat(0.0); 2];
            for row in rows.iter_mut() {
                let [p, q, r] = load(w, &row.pivot, lane);
                let [a, b, c, d] = load(w, &row.below, lane);
                let [e, f, g, h] = load(w, &row.beside, lane);
                let known = load(w, &row.right, lane);
                let [x, y] = [known[0] - right[0], known[1] - right[1]];
                let [x, y] = [p * x + q * y, q * x + r * y];
                right = [a * x + b * y, c * x + d * y];
                corner = [corner[0] + (e * x + g * y), corner[1] + (f * x + h * y)];
                store([x, y], &mut row.right, lane);
            }
            let known = load(w, &last.right, lane);
            let right = [known[0] - right[0], known[1] - right[1]];
            store(right, &mut last.right, lane);
            store(corner, &mut corners, lane);
        }
        let count = self.ring.count;
        for section in 0..count {
            let [x, y] = [last.right[0][section], last.right[1][section]];
            self.ring.right[section] = Vector::new(x, y);
        }
        for section in 0..count {
            let before = (section + count - 1) % count;
            self.ring.right[before] -= Vector::new(corners[0][section], corners[1][section]);
        }
        // The last rows are known from here on; each stands at the end of its section and before the next one.
        self.ring.solve();
        let mut before = [[0.0; LANES]; 2];
        for section in 0..count {
            let found = self.ring.right[section];
            for (k, found) in [found.x, found.y].into_iter().enumerate() {
                last.right[k][section] = found;
                before[k][(section + 1) % count] = found;
            }
        }
        for lane in (0..LANES).step_by(Wide::<S>::COUNT) {
            // Backward: each row from the next one, and from the last row of the section before.
            let mut found = load(w, &last.right, lane);
            let before = load(w, &before, lane);
            for row in rows.iter_mut().rev() {
                let [p, q, r] = load(w, &row.pivot, lane);
                let [a, b, c, d] = load(w, &row.below, lane);
                let [e, f, g, h] = load(w, &row.beside, lane);
                let through = load(w, &row.right, lane);
                // x = P r − P (Eᵀ x′ + F x″)
                let [x, y] = found;
                let [s, t] = before;
                let x = [
                    (a * x + c * y) + (e * s + f * t),
                    (b * x + d * y) + (g * s + h * t),
                ];
                found = [
                    through[0] - (p * x[0] + q * x[1]),
                    through[1] - (q * x[0] + r * x[1]),
                ];
                store(found, &mut row.right, lane);
            }
        }
        self.collect(values);
    }

    #[inline(never)]
    fn spread(&mut self, values: &[Array; 2]) {
        for section in 0..self.ring.count {
            let (first, joints) = self.rows(section);
            let [x, y] = values;
            let known = x[joints.clone()].iter().zip(&y[joints]);
            for (row, (x, y)) in self.rows[first..].iter_mut().zip(known) {
                [row.right[0][section], row.right[1][section]] = [*x, *y];
            }
        }
    }

    #[inline(never)]
    fn collect(&self, values: &mut [Array; 2]) {
        for section in 0..self.ring.count {
            let (first, joints) = self.rows(section);
            let [x, y] = &mut *values;
            let found = x[joints.clone()].iter_mut().zip(&mut y[joints]);
            for (row, (x, y)) in self.rows[first..].iter().zip(found) {
                [*x, *y] = [row.right[0][section], row.right[1][section]];
            }
        }
        for values in values {
            values[self.count] = values[0];
        }
    }
}

#[inline(always)]
fn load<S: Simd, const N: usize>(
    w: Wide<S>,
    from: &[[f64; LANES]; N],
    lane: usize,
) -> [Lane<S>; N] {
    let mut block = [w.splat(0.0); N];
    for k in 0..N {
        block[k] = w.load(&from[k], lane);
    }
    block
}

#[inline(always)]
fn store<S: Simd, const N: usize>(block: [Lane<S>; N], to: &mut [[f64; LANES]; N], lane: usize) {
    for k in 0..N {
        block[k].store(&mut to[k], lane);
    }
}

/// A S of a block and a symmetric one.
#[inline(always)]
fn times<S: Simd>([a, b, c, d]: &Block<S>, [p, q, r]: &Square<S>) -> Block<S> {
    [
        *a * *p + *b * *q,
        *a * *q + *b * *r,
        *c * *p + *d * *q,
        *c * *q + *d * *r,
    ]
}

/// A Bᵀ of two blocks whose product is symmetric.
#[inline(always)]
fn product<S: Simd>([a, b, c, d]: &Block<S>, [e, f, g, h]: &Block<S>) -> Square<S> {
    [*a * *e + *b * *f, *c * *e + *d * *f, *c * *g + *d * *h]
}

/// −A B
#[inline(always)]
fn negative_product<S: Simd>([a, b, c, d]: &Block<S>, [e, f, g, h]: &Block<S>) -> Block<S> {
    [
        -(*a * *e + *b * *g),
        -(*a * *f + *b * *h),
        -(*c * *e + *d * *g),
        -(*c * *f + *d * *h),
    ]
}

/// Fᵀ P F
#[inline(always)]
fn square<S: Simd>([p, q, r]: &Square<S>, [e, f, g, h]: &Block<S>) -> Square<S> {
    let [x, y] = [*p * *e + *q * *g, *q * *e + *r * *g];
    let [s, t] = [*p * *f + *q * *h, *q * *f + *r * *h];
    [*e * x + *g * y, *f * x + *h * y, *f * s + *h * t]
}

#[inline(always)]
fn plus<S: Simd>([a, b, c]: Square<S>, [d, e, f]: Square<S>) -> Square<S> {
    [a + d, b + e, c + f]
}

#[inline(always)]
fn minus<S: Simd>([a, b, c]: Square<S>, [d, e, f]: Square<S>) -> Square<S> {
    [a - d, b - e, c - f]
}

#[inline(always)]
fn sum<S: Simd>([a, b, c, d]: Block<S>, [e, f, g, h]: Block<S>) -> Block<S> {
    [a + e, b + f, c + g, d + h]
}
