//! Contacts of one link, or of the free rollers on it: eliminated before the joints.
//!
//! ```text
//! [ L  C ] [y]   [r]
//! [ Cᵀ S ] [z] = [s]     ⇒     (S − Cᵀ L⁻¹ C) z = s − Cᵀ L⁻¹ r
//! ```
//!
//! y belong to these contacts, z to the two joints of the link and to the wheels.

use chaindrive_geometry::Vector;
use chaindrive_integrate::Weights;
use nalgebra::Vector3;

use super::rows::Rows;
use super::tridiagonal::Tridiagonal;
use super::{JointState, Linkage};
use crate::chains::makeup::Makeup;
use crate::joints::{Element, Partner, Row, cross, partner_row};

/// One row of J over the chain's bodies, with the partner's sign in it.
#[derive(Clone, Copy, Debug)]
struct Line {
    bodies: [(usize, Vector3<f64>); 2],
    /// The same rows times M⁻¹.
    mobile: [Vector3<f64>; 2],
    /// Entries over the wheels and tensioners, as they stand on the partner's side.
    border: [(usize, f64); 3],
    /// J b over the chain's bodies.
    right: f64,
    /// Weight of the row.
    weight: f64,
}

const NOBODY: usize = usize::MAX;
/// Weight of a row that does nothing.
const NOTHING: f64 = 1e-100;

/// Whether the normal and the tangent of a contact can have a weight, however its slip changes.
fn may_weigh(element: &Element, weights: Weights, soft: f64) -> [bool; 2] {
    let stiff = weights.stiffness > 0.0;
    [
        element.damping > 0.0 || stiff && element.stiffness > 0.0,
        element.drag > 0.0 || element.secant > 0.0 || element.stiffly_across(soft) > 0.0,
    ]
}

/// The rows by link, and their factors.
#[derive(Clone, Debug, Default)]
pub(super) struct Local {
    lines: Vec<Line>,
    /// First line of every link, and one more entry.
    starts: Vec<usize>,
    order: Vec<usize>,
    /// L and the inverse of D of one link after those of the one before, whole squares.
    factors: Vec<f64>,
    /// Couplings of every line with what is around it, eliminated as far as the factors are, right-hand sides after.
    around: Vec<f64>,
}

impl Local {
    /// Collects the rows and sorts them by link.
    pub(super) fn gather(
        &mut self,
        linkage: &Linkage,
        weights: Weights,
        joint_state: &JointState,
        b: &[f64],
    ) {
        let soft = linkage.soft(weights);
        // Counting sort by link.
        self.starts.clear();
        self.starts.resize(linkage.series.links + 1, 0);
        for element in &joint_state.elements {
            self.starts[linkage.home(element) + 1] += may_weigh(element, weights, soft)
                .into_iter()
                .filter(|may| *may)
                .count();
        }
        for link in 0..linkage.series.links {
            self.starts[link + 1] += self.starts[link];
        }
        self.order.clear();
        self.order
            .extend_from_slice(&self.starts[..linkage.series.links]);
        self.lines
            .resize(self.starts[linkage.series.links], Line::EMPTY);
        // Every contact into the place of its link, as a row along its normal and one along its tangent.
        for element in &joint_state.elements {
            let levers = [element.lever_a, element.lever_b];
            let rows = [(element.normal, [0.0; 2]), (element.tangent(), levers)];
            let may = may_weigh(element, weights, soft);
            for (of, (direction, levers)) in rows.into_iter().enumerate() {
                if may[of] {
                    let place = &mut self.order[linkage.home(element)];
                    let line = &mut self.lines[*place];
                    line.set(linkage, element, joint_state, direction, levers);
                    line.right = line.applied(b);
                    let change = line.change(&b[linkage.coordinates()..]);
                    // One of nothing still stands in its place.
                    line.weight = element.step_weights(weights, soft, change)[of].max(NOTHING);
                    *place += 1;
                }
            }
        }
    }

    /// Eliminates all rows, with at most C columns around them; false if a pivot vanishes.
    #[inline(always)]
    pub(super) fn condense<const R: usize, const C: usize, const B: usize>(
        &mut self,
        linkage: &Linkage,
        rows: &[Rows; 2],
        joints: &mut Tridiagonal,
        b: &[f64],
    ) -> bool {
        let columns = 2 * R + b.len() - linkage.coordinates();
        let known = columns;
        self.factors.clear();
        self.around.clear();
        self.around.resize(self.lines.len() * C, 0.0);
        let mut around = self.around.as_chunks_mut::<C>().0;
        for link in 0..linkage.series.links {
            let lines = &self.lines[self.starts[link]..self.starts[link + 1]];
            if lines.is_empty() {
                continue;
            }
            let count = lines.len();
            let begin = self.factors.len();
            self.factors.resize(begin + count * count, 0.0);
            let factors = &mut self.factors[begin..];
            let (here, rest) = around.split_at_mut(count);
            around = rest;
            // L, and C with the right-hand side behind it.
            for (i, line) in lines.iter().enumerate() {
                for (j, other) in lines[..=i].iter().enumerate() {
                    factors[i * count + j] = line.times(other);
                }
                factors[i * count + i] += 1.0 / line.weight;
                line.look_around::<R>(linkage, rows, link, &mut here[i]);
                here[i][known] = line.right;
            }
            // A roller in its gap has a normal and a tangent. Where the compiler knows their number it needs no loops.
            let mut sum = [[0.0; C]; C];
            let eliminated = match count {
                1 => eliminate(1, known, factors, here, &mut sum),
                2 => eliminate(2, known, factors, here, &mut sum),
                _ => eliminate(count, known, factors, here, &mut sum),
            };
            if !eliminated {
                return false;
            }
            joints.subtract::<R, C, B>(link, linkage.joint_behind(link), &sum);
        }
        true
    }

    /// x ← x − M⁻¹ Jᵀ y of these rows.
    #[inline(always)]
    pub(super) fn apply<const R: usize, const C: usize>(
        &mut self,
        linkage: &Linkage,
        joints: &Tridiagonal,
        x: &mut [f64],
    ) {
        let columns = 2 * R + x.len() - linkage.coordinates();
        let mut factors = &self.factors[..];
        let mut around = self.around.as_chunks_mut::<C>().0;
        for link in 0..linkage.series.links {
            let lines = &self.lines[self.starts[link]..self.starts[link + 1]];
            let count = lines.len();
            if count == 0 {
                continue;
            }
            // What joints and wheels have come to gives the impulses of the contacts, and these push the bodies.
            let found = joints.around::<R, C>(link, linkage.joint_behind(link));
            let (here, rest) = around.split_at_mut(count);
            around = rest;
            match count {
                1 => substitute(1, columns, factors, here, &found),
                2 => substitute(2, columns, factors, here, &found),
                _ => substitute(count, columns, factors, here, &found),
            }
            for (line, here) in lines.iter().zip(here).rev() {
                line.apply(here[columns], x);
            }
            factors = &factors[count * count..];
        }
    }
}

/// L and the inverse of D in place of `count` rows; adds what these rows give to the columns around them. False if a pivot vanishes.
#[inline(always)]
fn eliminate<const C: usize>(
    count: usize,
    known: usize,
    factors: &mut [f64],
    here: &mut [[f64; C]],
    sum: &mut [[f64; C]; C],
) -> bool {
    let (factors, here) = (&mut factors[..count * count], &mut here[..count]);
    for i in 0..count {
        // Row by row: the pivot, the rows below it, and what the row gives to the columns around.
        let pivot = factors[i * count + i];
        if pivot.is_nan() || pivot <= 0.0 {
            return false;
        }
        let inverse = 1.0 / pivot;
        let own = here[i];
        for k in i + 1..count {
            let factor = factors[k * count + i] * inverse;
            for j in i + 1..=k {
                factors[k * count + j] -= factor * factors[j * count + i];
            }
            for (below, own) in here[k].iter_mut().zip(own) {
                *below -= factor * own;
            }
        }
        for k in i + 1..count {
            factors[k * count + i] *= inverse;
        }
        factors[i * count + i] = inverse;
        // Not all of them: where their number is known, whole columns are gathered and scattered side by side.
        for (sum, value) in sum[..known].iter_mut().zip(own) {
            let scaled = value * inverse;
            for (sum, own) in sum.iter_mut().zip(own) {
                *sum += scaled * own;
            }
        }
    }
    true
}

/// y of `count` rows in the column `columns`, from what is known around them.
#[inline(always)]
fn substitute<const C: usize>(
    count: usize,
    columns: usize,
    factors: &[f64],
    here: &mut [[f64; C]],
    found: &[f64; C],
) {
    let (factors, here) = (&factors[..count * count], &mut here[..count]);
    for i in (0..count).rev() {
        let known: f64 = here[i].iter().zip(found).map(|(a, z)| a * z).sum();
        let mut value = known * factors[i * count + i];
        for k in i + 1..count {
            value -= factors[k * count + i] * here[k][columns];
        }
        here[i][columns] = value;
    }
}

impl Linkage {
    /// The joint at the end of a link.
    pub(super) fn joint_behind(&self, link: usize) -> usize {
        if self.series.is_closed() && link + 1 == self.series.links {
            0
        } else {
            link + 1
        }
    }

    /// The link that a contact is eliminated with.
    fn home(&self, element: &Element) -> usize {
        let body = match (element.a, element.b) {
            (Some(body), _) | (None, Partner::Body(body)) => body,
            (None, Partner::Ground | Partner::Mount(_)) => 0,
        };
        match &self.free_rollers {
            Some(free) if body >= self.series.links => free.link[body - self.series.links],
            _ => body,
        }
    }
}

impl Line {
    const EMPTY: Self = Self {
        bodies: [(NOBODY, Vector3::new(0.0, 0.0, 0.0)); 2],
        mobile: [Vector3::new(0.0, 0.0, 0.0); 2],
        border: [(NOBODY, 0.0); 3],
        right: 0.0,
        weight: 0.0,
    };

    /// The row of an element along a direction.
    #[inline]
    fn set(
        &mut self,
        linkage: &Linkage,
        element: &Element,
        joint_state: &JointState,
        direction: Vector,
        levers: [f64; 2],
    ) {
        self.bodies = Self::EMPTY.bodies;
        self.border = Self::EMPTY.border;
        if let Some(body) = element.a {
            let turn = cross(element.arm_a, direction) + levers[0];
            self.bodies[0] = (body, Vector3::new(direction.x, direction.y, turn));
        }
        match partner_row(element, &joint_state.mounts, direction, levers[1]) {
            Row::Nothing => {}
            Row::Body(body, row) => self.bodies[1] = (body, -row),
            Row::Border(entries) => self.border = entries,
        }
        for (mobile, (body, row)) in self.mobile.iter_mut().zip(&self.bodies) {
            if *body != NOBODY {
                let [mobility, turning] = linkage.shapes.mobilities[*body];
                *mobile = Vector3::new(row.x * mobility, row.y * mobility, row.z * turning);
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

    /// Jᵢ M⁻¹ Jⱼᵀ with the rows of the two joints of a link, and entries over the wheels.
    #[inline]
    fn look_around<const R: usize>(
        &self,
        linkage: &Linkage,
        rows: &[Rows; 2],
        link: usize,
        out: &mut [f64],
    ) {
        let next = linkage.joint_behind(link);
        for ((body, _), mobile) in self.bodies.iter().zip(&self.mobile) {
            if *body != link {
                continue;
            }
            for p in 0..R {
                let [x, y, _, turn] = rows[p].at(link);
                out[p] += mobile.x * x + mobile.y * y + mobile.z * turn;
                let [x, y, turn, _] = rows[p].at(next);
                out[R + p] -= mobile.x * x + mobile.y * y + mobile.z * turn;
            }
        }
        for &(j, value) in &self.border {
            if j != NOBODY {
                out[2 * R + j] += value;
            }
        }
    }

    /// x ← x − M⁻¹ Jᵀ y
    #[inline]
    fn apply(&self, y: f64, x: &mut [f64]) {
        for ((body, _), mobile) in self.bodies.iter().zip(&self.mobile) {
            if *body != NOBODY {
                for k in 0..3 {
                    x[3 * body + k] -= mobile[k] * y;
                }
            }
        }
    }

    /// J b, that of the wheels included.
    fn change(&self, wheels: &[f64]) -> f64 {
        let border = self.border.iter().filter(|(j, _)| *j != NOBODY);
        self.right - border.map(|(j, value)| value * wheels[*j]).sum::<f64>()
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
