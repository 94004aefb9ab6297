//! (M + c C) x = M b in the space of the contacts: one unknown a row of J instead of three a body.
//!
//! ```text
//! y = c d J x,   x = b − M⁻¹ Jᵀ y     ⇒     (1/(c d) + J M⁻¹ Jᵀ) y = J b
//! ```
//!
//! Rows are the normals of closed contacts, and their tangents where they rub. In the order of the joints the
//! matrix is a narrow band: the rows at a joint share links with those of its neighbours only. The wheels and
//! tensioners stay unknowns of their own behind the band, with a negative diagonal; so do the rows of the
//! last joint of a closed chain, which also touch the first. Quasi-definite: no pivoting is needed.
//!
//! # Source
//! Quasi-definite systems: R. J. Vanderbei, *SIAM J. Optim.* **5**, 1995, 100–113.

use chaindrive_geometry::Vector;
use nalgebra::{DMatrix, DVector, Vector3};

use super::implicit::{Row, partner_row};
use super::{Element, Linkage, Play, cross};
use crate::System;

/// One row of J over the chain's bodies, with the partner's sign in it.
#[derive(Clone, Copy, Debug)]
struct Line {
    bodies: [(usize, Vector3<f64>); 2],
    /// The same rows times M⁻¹.
    mobile: [Vector3<f64>; 2],
    /// Entries over the wheels and tensioners, as they stand on the partner's side.
    border: [(usize, f64); 3],
    /// c d.
    weight: f64,
}

const NOBODY: usize = usize::MAX;

/// The rows of one step and their factors.
#[derive(Clone, Debug, Default)]
pub(crate) struct Impulses {
    lines: Vec<Line>,
    /// First line of every joint, and one more entry.
    starts: Vec<usize>,
    order: Vec<usize>,
    /// Band: entries of line i from column `first[i]` to i, at `offset[i]`.
    first: Vec<usize>,
    offset: Vec<usize>,
    band: Vec<f64>,
    beside: Vec<f64>,
    y: Vec<f64>,
    corner: DMatrix<f64>,
    right: DVector<f64>,
}

impl Linkage {
    /// x ← (M + c C)⁻¹ M x; false if a pivot vanishes.
    pub(crate) fn damp(&self, system: &System, c: f64, play: &mut Play, x: &mut [f64]) -> bool {
        let mut work = std::mem::take(&mut play.impulses);
        work.gather(self, c, play);
        let solved = work.solve(self, system, c, x);
        play.impulses = work;
        solved
    }
}

impl Impulses {
    /// Collects the rows and sorts them by joint.
    fn gather(&mut self, linkage: &Linkage, c: f64, play: &Play) {
        // Counting sort by joint.
        let joints = linkage.joints.len();
        self.starts.clear();
        self.starts.resize(joints + 1, 0);
        for element in &play.elements {
            self.starts[element.joint + 1] +=
                usize::from(element.damping > 0.0) + usize::from(element.secant > 0.0);
        }
        for joint in 0..joints {
            self.starts[joint + 1] += self.starts[joint];
        }
        self.order.clear();
        self.order.extend_from_slice(&self.starts[..joints]);
        self.lines.resize(self.starts[joints], Line::EMPTY);
        for element in &play.elements {
            let levers = [element.lever_a, element.lever_b];
            let rows = [
                (element.normal, [0.0; 2], element.damping),
                (element.tangent(), levers, element.secant),
            ];
            for (direction, levers, damping) in rows {
                if damping > 0.0 {
                    let place = &mut self.order[element.joint];
                    self.lines[*place].set(linkage, element, play, direction, levers);
                    self.lines[*place].weight = c * damping;
                    *place += 1;
                }
            }
        }
    }

    fn solve(&mut self, linkage: &Linkage, system: &System, c: f64, x: &mut [f64]) -> bool {
        let joints = linkage.joints.len();
        // Lines from here on belong to the last joint of a closed chain: they go behind the band.
        let row = if linkage.closed {
            self.starts[joints - 1]
        } else {
            self.lines.len()
        };
        let last = self.lines.len() - row;
        let wheels = x.len() - linkage.dofs();
        let border = last + wheels;
        self.fill(linkage, row, border, x);
        if self.corner.nrows() == border {
            self.corner.fill(0.0);
        } else {
            self.corner = DMatrix::zeros(border, border);
            self.right = DVector::zeros(border);
        }
        self.fill_corner(linkage, system, c, row, x);
        if !self.factor(row, border) {
            return false;
        }
        if border > 0 && !self.corner.clone().lu().solve_mut(&mut self.right) {
            return false;
        }
        self.substitute(row, border);
        for (i, line) in self.lines.iter().enumerate() {
            let y = if i < row {
                self.y[i]
            } else {
                self.right[i - row]
            };
            for ((body, _), mobile) in line.bodies.iter().zip(&line.mobile) {
                if *body != NOBODY {
                    for k in 0..3 {
                        x[3 * body + k] -= mobile[k] * y;
                    }
                }
            }
        }
        for j in 0..wheels {
            x[linkage.dofs() + j] = self.right[last + j];
        }
        true
    }

    /// The band, the columns beside it, and J b.
    fn fill(&mut self, linkage: &Linkage, row: usize, border: usize, x: &[f64]) {
        self.first.clear();
        self.offset.clear();
        self.band.clear();
        self.beside.clear();
        self.beside.resize(row * border, 0.0);
        self.y.clear();
        let last = self.lines.len() - row;
        let joints = linkage.joints.len();
        for joint in 0..joints {
            let (start, end) = (self.starts[joint], self.starts[joint + 1].min(row));
            let first = if joint > 0 { self.starts[joint - 1] } else { 0 };
            for i in start..end {
                let line = &self.lines[i];
                self.first.push(first);
                self.offset.push(self.band.len());
                for j in first..i {
                    self.band.push(line.times(&self.lines[j]));
                }
                self.band.push(1.0 / line.weight + line.times(line));
                self.y.push(line.applied(x));
                // The last joint's lines are neighbours of the first joint's and of the last but one's.
                if joint == 0 || joint + 2 == joints {
                    for k in 0..last {
                        self.beside[i * border + k] = line.times(&self.lines[row + k]);
                    }
                }
                for &(j, value) in &line.border {
                    if j != NOBODY {
                        self.beside[i * border + last + j] += value;
                    }
                }
            }
        }
    }

    fn fill_corner(&mut self, linkage: &Linkage, system: &System, c: f64, row: usize, x: &[f64]) {
        let last = self.lines.len() - row;
        for k in 0..last {
            let line = &self.lines[row + k];
            for m in 0..=k {
                let value = line.times(&self.lines[row + m]);
                self.corner[(k, m)] += value;
                if m < k {
                    self.corner[(m, k)] += value;
                }
            }
            self.corner[(k, k)] += 1.0 / line.weight;
            self.right[k] = line.applied(x);
            for &(j, value) in &line.border {
                if j != NOBODY {
                    self.corner[(k, last + j)] += value;
                    self.corner[(last + j, k)] += value;
                }
            }
        }
        for dof in linkage.dofs()..x.len() {
            let j = dof - linkage.dofs();
            let inertia = system.border_inertias[j];
            self.corner[(last + j, last + j)] = -inertia;
            self.right[last + j] = -inertia * x[dof];
        }
        let corner = &mut self.corner;
        system.each_support(|dof, _, damping| {
            let j = last + dof - linkage.dofs();
            corner[(j, j)] -= c * damping;
        });
    }

    /// L D Lᵀ in place; the corner and the right-hand sides are carried along.
    fn factor(&mut self, row: usize, border: usize) -> bool {
        for i in 0..row {
            let (first, offset) = (self.first[i], self.offset[i]);
            let here = |j: usize| offset + j - first;
            // Entries times D until the line is done: u_j = a_j − Σ u_k l_jk
            for j in first..i {
                let from = self.first[j].max(first);
                let there = self.offset[j] - self.first[j];
                let mut sum = self.band[here(j)];
                for k in from..j {
                    sum -= self.band[here(k)] * self.band[there + k];
                }
                self.band[here(j)] = sum;
            }
            let mut pivot = self.band[here(i)];
            for j in first..i {
                let scaled = self.band[here(j)];
                let factor = scaled / self.band[self.offset[j] + j - self.first[j]];
                pivot -= scaled * factor;
                self.band[here(j)] = factor;
                self.y[i] -= factor * self.y[j];
                for b in 0..border {
                    let value = self.beside[j * border + b];
                    self.beside[i * border + b] -= factor * value;
                }
            }
            if pivot.is_nan() || pivot <= 0.0 {
                return false;
            }
            self.band[here(i)] = pivot;
            // The border below: S −= cᵀ c / d
            let inverse = 1.0 / pivot;
            for b in 0..border {
                let value = self.beside[i * border + b];
                if value != 0.0 {
                    let scaled = value * inverse;
                    for other in 0..border {
                        self.corner[(b, other)] -= scaled * self.beside[i * border + other];
                    }
                    self.right[b] -= scaled * self.y[i];
                }
            }
        }
        true
    }

    /// Back through D and Lᵀ.
    fn substitute(&mut self, row: usize, border: usize) {
        for i in 0..row {
            let mut value = self.y[i];
            for b in 0..border {
                value -= self.beside[i * border + b] * self.right[b];
            }
            self.y[i] = value / self.band[self.offset[i] + i - self.first[i]];
        }
        for i in (0..row).rev() {
            let (first, offset) = (self.first[i], self.offset[i]);
            for j in first..i {
                self.y[j] -= self.band[offset + j - first] * self.y[i];
            }
        }
    }
}

impl Line {
    const EMPTY: Self = Self {
        bodies: [(NOBODY, Vector3::new(0.0, 0.0, 0.0)); 2],
        mobile: [Vector3::new(0.0, 0.0, 0.0); 2],
        border: [(NOBODY, 0.0); 3],
        weight: 0.0,
    };

    /// The row of an element along a direction.
    #[inline]
    fn set(
        &mut self,
        linkage: &Linkage,
        element: &Element,
        play: &Play,
        direction: Vector,
        levers: [f64; 2],
    ) {
        self.bodies = Self::EMPTY.bodies;
        self.border = Self::EMPTY.border;
        if let Some(body) = element.a {
            let turn = cross(element.arm_a, direction) + levers[0];
            self.bodies[0] = (body, Vector3::new(direction.x, direction.y, turn));
        }
        match partner_row(element, &play.mounts, direction, levers[1]) {
            Row::Nothing => {}
            Row::Body(body, row) => self.bodies[1] = (body, -row),
            Row::Border(entries) => {
                let skip = if linkage.closed { 3 } else { 0 };
                for (entry, (j, value)) in self.border.iter_mut().zip(entries) {
                    if j != usize::MAX {
                        *entry = (j - skip, value);
                    }
                }
            }
        }
        for (mobile, (body, row)) in self.mobile.iter_mut().zip(&self.bodies) {
            if *body != NOBODY {
                let b = &linkage.bodies[*body];
                *mobile = Vector3::new(row.x / b.mass, row.y / b.mass, row.z / b.inertia);
            }
        }
    }

    /// Jᵢ M⁻¹ Jⱼᵀ.
    #[inline]
    fn times(&self, other: &Self) -> f64 {
        let mut sum = 0.0;
        for ((body, _), mobile) in self.bodies.iter().zip(&self.mobile) {
            if *body == NOBODY {
                continue;
            }
            for (there, row) in &other.bodies {
                if body == there {
                    sum += mobile.dot(row);
                }
            }
        }
        sum
    }

    /// J b over the chain's bodies.
    #[inline]
    fn applied(&self, b: &[f64]) -> f64 {
        let mut sum = 0.0;
        for (body, row) in &self.bodies {
            if *body != NOBODY {
                sum += row.x * b[3 * body] + row.y * b[3 * body + 1] + row.z * b[3 * body + 2];
            }
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use chaindrive_integrate::Weights;

    use crate::linkage::held::Asked;
    use crate::linkage::tests::started;

    /// The bodies' own equations, block by block, give the same answer: two independent eliminations.
    #[test]
    fn agrees_with_the_equations_of_the_bodies() {
        for free_rollers in [false, true] {
            let (system, mut record, b) = started(free_rollers);
            let linkage = system.linkage.as_ref().unwrap();
            let c = 2e-6;
            let mut impulses = b.clone();
            assert!(linkage.damp(&system, c, &mut record.play, &mut impulses));
            let mut blocks = b.clone();
            let weights = Weights {
                damping: c,
                stiffness: 0.0,
            };
            assert!(linkage.eliminate(
                &system,
                weights,
                &mut record.play,
                &mut blocks,
                Asked::Kept
            ));
            let size = b.iter().fold(0.0_f64, |m, b| m.max(b.abs()));
            for (i, (found, exact)) in impulses.iter().zip(&blocks).enumerate() {
                let error = (found - exact).abs() / size;
                assert!(error < 1e-12, "{free_rollers}, {i}: {found} {exact}");
            }
            // And it is not the undamped answer.
            assert!(
                impulses
                    .iter()
                    .zip(&b)
                    .any(|(x, b)| (x - b).abs() > 1e-3 * size)
            );
        }
    }
}
