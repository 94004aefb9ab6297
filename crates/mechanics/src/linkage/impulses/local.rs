//! What touches one link, or the free rollers on it: eliminated before the joints.
//!
//! ```text
//! [ L  C ] [y]   [r]
//! [ Cᵀ S ] [z] = [s]     ⇒     (S − Cᵀ L⁻¹ C) z = s − Cᵀ L⁻¹ r
//! ```
//!
//! y belong to these contacts, z to the two joints of the link and to the wheels.

use chaindrive_geometry::Vector;
use nalgebra::Vector3;

use super::band::{Band, Place};
use super::{JointRow, Linkage, Play};
use crate::linkage::implicit::{Row, partner_row};
use crate::linkage::{Element, Partner, cross};

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

/// The rows by link, and their factors.
#[derive(Clone, Debug, Default)]
pub(super) struct Local {
    lines: Vec<Line>,
    /// First line of every link, and one more entry.
    starts: Vec<usize>,
    order: Vec<usize>,
    /// L D Lᵀ of one link behind that of another, whole squares.
    factors: Vec<f64>,
    /// Couplings of every line with what is around it, eliminated as far as the factors are, right-hand sides behind.
    around: Vec<f64>,
}

/// Where the couplings of a link's lines lead to: its joints, then the wheels.
fn places<const R: usize>(linkage: &Linkage, band: &Band, link: usize) -> impl Fn(usize) -> Place + use<R> {
    let next = if linkage.closed && link + 1 == linkage.links {
        0
    } else {
        link + 1
    };
    let joints: [[Place; R]; 2] =
        [link, next].map(|joint| std::array::from_fn(|p| band.place::<R>(joint, p)));
    let first = if linkage.closed { R } else { 0 };
    move |column| match column {
        column if column < R => joints[0][column],
        column if column < 2 * R => joints[1][column - R],
        column => Place::Border(first + column - 2 * R),
    }
}

impl Local {
    /// Collects the rows and sorts them by link.
    pub(super) fn gather(&mut self, linkage: &Linkage, c: f64, play: &Play) {
        // Counting sort by link.
        self.starts.clear();
        self.starts.resize(linkage.links + 1, 0);
        for element in &play.elements {
            self.starts[linkage.home(element) + 1] +=
                usize::from(element.damping > 0.0) + usize::from(element.secant > 0.0);
        }
        for link in 0..linkage.links {
            self.starts[link + 1] += self.starts[link];
        }
        self.order.clear();
        self.order.extend_from_slice(&self.starts[..linkage.links]);
        self.lines.resize(self.starts[linkage.links], Line::EMPTY);
        for element in &play.elements {
            let levers = [element.lever_a, element.lever_b];
            let rows = [
                (element.normal, [0.0; 2], element.damping),
                (element.tangent(), levers, element.secant),
            ];
            for (direction, levers, damping) in rows {
                if damping > 0.0 {
                    let place = &mut self.order[linkage.home(element)];
                    self.lines[*place].set(linkage, element, play, direction, levers);
                    self.lines[*place].weight = c * damping;
                    *place += 1;
                }
            }
        }
    }

    /// Eliminates all rows; false if a pivot vanishes.
    pub(super) fn condense<const R: usize>(
        &mut self,
        linkage: &Linkage,
        rows: &[JointRow],
        band: &mut Band,
        b: &[f64],
    ) -> bool {
        let wheels = b.len() - linkage.dofs();
        let width = 2 * R + wheels + 1;
        self.factors.clear();
        self.around.clear();
        for link in 0..linkage.links {
            let lines = &self.lines[self.starts[link]..self.starts[link + 1]];
            if lines.is_empty() {
                continue;
            }
            let count = lines.len();
            let (factors, around) = (self.factors.len(), self.around.len());
            for (i, line) in lines.iter().enumerate() {
                for (j, other) in lines.iter().enumerate() {
                    let own = if i == j { 1.0 / line.weight } else { 0.0 };
                    // The upper half is never looked at.
                    self.factors
                        .push(if j <= i { line.times(other) + own } else { 0.0 });
                }
                self.around.resize(self.around.len() + width, 0.0);
                let last = self.around.len() - width;
                line.look_around::<R>(linkage, rows, link, b, &mut self.around[last..]);
            }
            let factors = &mut self.factors[factors..];
            let around = &mut self.around[around..];
            let place = places::<R>(linkage, band, link);
            for i in 0..count {
                let pivot = factors[i * count + i];
                if pivot.is_nan() || pivot <= 0.0 {
                    return false;
                }
                let inverse = 1.0 / pivot;
                let (done, rest) = around.split_at_mut((i + 1) * width);
                let here = &done[i * width..];
                for (k, below) in rest.chunks_exact_mut(width).enumerate() {
                    let k = i + 1 + k;
                    let factor = factors[k * count + i] * inverse;
                    for j in i + 1..=k {
                        factors[k * count + j] -= factor * factors[j * count + i];
                    }
                    for (below, here) in below.iter_mut().zip(here) {
                        *below -= factor * here;
                    }
                }
                for k in i + 1..count {
                    factors[k * count + i] *= inverse;
                }
                for (x, &value) in here[..width - 1].iter().enumerate() {
                    if value == 0.0 {
                        continue;
                    }
                    let scaled = value * inverse;
                    for (y, other) in here[..=x].iter().enumerate() {
                        band.add(place(x), place(y), -scaled * other);
                    }
                    band.add_right(place(x), -scaled * here[width - 1]);
                }
            }
        }
        true
    }

    /// x ← x − M⁻¹ Jᵀ y of these rows.
    pub(super) fn apply<const R: usize>(&mut self, linkage: &Linkage, band: &Band, x: &mut [f64]) {
        let wheels = x.len() - linkage.dofs();
        let width = 2 * R + wheels + 1;
        let (mut factors, mut around) = (0, 0);
        for link in 0..linkage.links {
            let lines = &self.lines[self.starts[link]..self.starts[link + 1]];
            let count = lines.len();
            if count == 0 {
                continue;
            }
            let place = places::<R>(linkage, band, link);
            for i in (0..count).rev() {
                let here = around + i * width;
                let mut value = self.around[here + width - 1];
                for column in 0..width - 1 {
                    value -= self.around[here + column] * band.at(place(column));
                }
                value /= self.factors[factors + i * count + i];
                for k in i + 1..count {
                    value -= self.factors[factors + k * count + i]
                        * self.around[around + k * width + width - 1];
                }
                self.around[here + width - 1] = value;
                lines[i].apply(value, x);
            }
            factors += count * count;
            around += count * width;
        }
    }
}

impl Linkage {
    /// The link that a contact is eliminated with.
    fn home(&self, element: &Element) -> usize {
        let body = match (element.a, element.b) {
            (Some(body), _) | (None, Partner::Body(body)) => body,
            (None, Partner::Ground | Partner::Mount(_)) => 0,
        };
        match &self.free_rollers {
            Some(free) if body >= self.links => free.link[body - self.links],
            _ => body,
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

    /// Jᵢ M⁻¹ Jⱼᵀ with the rows of the two joints of a link, entries over the wheels, and J b.
    #[inline]
    fn look_around<const R: usize>(
        &self,
        linkage: &Linkage,
        rows: &[JointRow],
        link: usize,
        b: &[f64],
        out: &mut [f64],
    ) {
        let next = if linkage.closed && link + 1 == linkage.links {
            0
        } else {
            link + 1
        };
        for ((body, _), mobile) in self.bodies.iter().zip(&self.mobile) {
            if *body != link {
                continue;
            }
            for p in 0..R {
                let (row, other) = (&rows[R * link + p], &rows[R * next + p]);
                if row.weight > 0.0 {
                    let [x, y] = row.direction;
                    out[p] += mobile.x * x + mobile.y * y + mobile.z * row.turn_after;
                }
                if other.weight > 0.0 {
                    let [x, y] = other.direction;
                    out[R + p] -= mobile.x * x + mobile.y * y + mobile.z * other.turn_before;
                }
            }
        }
        for &(j, value) in &self.border {
            if j != NOBODY {
                out[2 * R + j] += value;
            }
        }
        out[out.len() - 1] = self.applied(b);
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

