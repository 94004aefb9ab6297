//! (M + c C + k K) x = M b: the linear system of an implicit step.
//!
//! ```text
//! C = Σ d Jₙᵀ Jₙ + Σ r J_sᵀ J_s,      K = Σ k Jₙᵀ Jₙ + Σ F/|e| J_tᵀ J_t + …
//! ```
//!
//! Jₙ, J_t and J_s give closing speed, motion of the circles' centres across, and slip from the velocities. C is
//! symmetric: that friction also follows the normal force is left to the explicit part. Free rollers touch
//! their bush and a wheel only; they are eliminated first and leave the links' pattern as it is.

use chaindrive_geometry::Vector;
use chaindrive_integrate::Weights;
use nalgebra::{Matrix3, Vector3};

use super::held::Prescribed;
use super::impulses::MOST_WHEELS;
use super::loose::Loose;
use super::{Blocks, Element, Joining, JointState, Linkage, Mount, Partner, cross, turned};
use crate::bodies::GroupBodies;
use crate::chains::Record;

/// Share of a link's mass that a step need not carry across a contact. *Assumed*.
const SOFT: f64 = 0.05;

/// A row over the unknowns of the partner.
#[derive(Clone, Copy)]
pub(super) enum Row {
    Nothing,
    Body(usize, Vector3<f64>),
    /// Coordinates of wheels and tensioners, unused ones `usize::MAX`.
    Border([(usize, f64); 3]),
}

/// Where a body's unknowns stand.
#[derive(Clone, Copy, PartialEq)]
enum Place {
    Link(usize),
    /// The last link of a closed chain, where it stands first in the border.
    Corner,
    Roller(usize),
}

impl Linkage {
    /// x ← (M + c C + k K)⁻¹ M x of the chain and, behind it, the bodies, at the state that the record was left by.
    pub(crate) fn solve(
        &self,
        bodies: GroupBodies<'_>,
        weights: Weights,
        record: &mut Record,
        x: &mut [f64],
    ) -> bool {
        let Record {
            joint_state,
            impulses,
            ..
        } = record;
        let weights = if weights.once && !self.carries() {
            Weights {
                stiffness: 0.0,
                ..weights
            }
        } else {
            weights
        };
        if matches!(self.joining, Joining::Hinges(_)) {
            return self.solve_held(bodies, weights, joint_state, x, Prescribed::Kept);
        }
        let few = x.len() - self.coordinates() <= MOST_WHEELS;
        if weights.once && few {
            return self.step(bodies, weights, joint_state, impulses, x);
        }
        self.eliminate(bodies, weights, joint_state, x)
    }

    /// Whether steps of one solution carry the stiffness of the contacts as inertia: in joints with play. Free rollers between two
    /// contacts, lighter than what they would have to carry, strike twice as hard then.
    pub(crate) fn carries(&self) -> bool {
        matches!(self.joining, Joining::Clearance(_)) && self.free_rollers.is_none()
    }

    /// Stiffness across a contact \[N/m\] up to which a step leaves it to the forces at its beginning, none below zero.
    ///
    /// ```text
    /// h²/4 k ≤ m/20   ⇒   ω h ≤ 0.45
    /// ```
    ///
    /// A mode that slow errs by a hundredth of its frequency either way, and the seat of a tooth holds a roller across with no more, which
    /// spares a row a tooth.
    pub(super) fn soft(&self, weights: Weights) -> f64 {
        SOFT * self.shapes.lightest[0] / weights.stiffness
    }

    /// The least change of coordinates or velocities, of which there are `count`, that moves every pin towards its hole by what is
    /// given; least in kinetic energy.
    pub(crate) fn nearest(
        &self,
        bodies: GroupBodies<'_>,
        joint_state: &mut JointState,
        towards: &[Vector],
        count: usize,
    ) -> Option<Vec<f64>> {
        let none = Weights {
            once: false,
            damping: 0.0,
            stiffness: 0.0,
        };
        let mut change = vec![0.0; count];
        let asked = Prescribed::Given(towards);
        self.solve_held(bodies, none, joint_state, &mut change, asked)
            .then_some(change)
    }

    pub(super) fn eliminate(
        &self,
        bodies: GroupBodies<'_>,
        weights: Weights,
        joint_state: &mut JointState,
        x: &mut [f64],
    ) -> bool {
        let mut equations = std::mem::take(&mut joint_state.equations);
        // The last link of a closed chain touches both ends of the row, and stands in the border.
        let row = self.links - usize::from(self.closed);
        let mut sum = Sum::new(self, &mut equations, row, x);
        sum.add_masses(bodies, weights, x);
        self.each_element(joint_state, |element| {
            sum.add(element, &joint_state.mounts, weights, x);
        });
        let solved = sum.eliminate_rollers() && sum.blocks.solve();
        if solved {
            sum.read(x);
        }
        joint_state.equations = equations;
        solved
    }
}

/// The equations of the bodies, and the space for their solution.
#[derive(Clone, Debug, Default)]
pub(crate) struct Equations {
    pub(super) blocks: Blocks,
    pub(super) loose: Vec<Loose>,
}

/// The system under assembly.
pub(super) struct Sum<'a> {
    pub(super) linkage: &'a Linkage,
    pub(super) blocks: &'a mut Blocks,
    pub(super) loose: &'a mut [Loose],
    /// Unknowns of the border.
    border: usize,
    /// Those of the wheels among them come last, from this one on.
    first: usize,
}

impl<'a> Sum<'a> {
    /// Makes room for as many links in a row as given; a last one stands in the border.
    pub(super) fn new(
        linkage: &'a Linkage,
        equations: &'a mut Equations,
        row: usize,
        x: &[f64],
    ) -> Self {
        let Equations { blocks, loose } = equations;
        let first = 3 * (linkage.links - row);
        let border = first + x.len() - linkage.coordinates();
        blocks.clear(row, border);
        loose.resize_with(linkage.bodies.len() - linkage.links, Loose::default);
        loose.iter_mut().for_each(Loose::clear);
        Self {
            linkage,
            blocks,
            loose,
            border,
            first,
        }
    }

    /// Inertia, M b on the right, and what the bodies have of their own.
    pub(super) fn add_masses(&mut self, bodies: GroupBodies<'_>, weights: Weights, b: &[f64]) {
        for (index, body) in self.linkage.bodies.iter().enumerate() {
            let mass = Vector3::new(body.mass, body.mass, body.inertia);
            let b = Vector3::new(b[3 * index], b[3 * index + 1], b[3 * index + 2]);
            let force = mass.component_mul(&b);
            match self.place(index) {
                Place::Link(i) => {
                    self.blocks.diagonal[i] = Matrix3::from_diagonal(&mass);
                    self.blocks.right[i] = force;
                }
                Place::Corner => {
                    for k in 0..3 {
                        self.blocks.corner[(k, k)] = mass[k];
                        self.blocks.right_border[k] = force[k];
                    }
                }
                Place::Roller(i) => {
                    self.loose[i].own = Matrix3::from_diagonal(&mass);
                    self.loose[i].right = force;
                }
            }
        }
        let b = &b[self.linkage.coordinates()..];
        for (j, (b, &inertia)) in b.iter().zip(bodies.inertias()).enumerate() {
            let j = self.first + j;
            self.blocks.corner[(j, j)] = inertia;
            self.blocks.right_border[j] = inertia * b;
        }
        bodies.each_own(weights, |[i, j], weighted| {
            // The lower half is kept.
            if i >= j {
                self.blocks.corner[(self.first + i, self.first + j)] += weighted;
            }
        });
    }

    /// Takes the solution out of the right-hand sides.
    pub(super) fn read(&self, x: &mut [f64]) {
        let links = self.linkage.links;
        for link in 0..links {
            let found = self.found(link);
            x[3 * link..3 * link + 3].copy_from_slice(found.as_slice());
        }
        for (i, roller) in self.loose.iter().enumerate() {
            // x_r = D_r⁻¹ (b_r − L_rᵀ x_l − W_rᵀ x_w)
            let mut right = roller.right;
            if let Some(link) = roller.link {
                right -= roller.coupling.transpose() * self.found(link);
            }
            for &(j, row) in &roller.beside {
                right -= row * self.blocks.right_border[j];
            }
            let found = roller.inverse * right;
            let index = links + i;
            x[3 * index..3 * index + 3].copy_from_slice(found.as_slice());
        }
        let wheels = self.blocks.right_border.iter().skip(self.first);
        for (x, found) in x[self.linkage.coordinates()..].iter_mut().zip(wheels) {
            *x = *found;
        }
    }

    fn found(&self, link: usize) -> Vector3<f64> {
        match self.place(link) {
            Place::Link(i) => self.blocks.right[i],
            Place::Corner | Place::Roller(_) => {
                Vector3::from_fn(|k, _| self.blocks.right_border[k])
            }
        }
    }

    fn place(&self, body: usize) -> Place {
        if body >= self.linkage.links {
            Place::Roller(body - self.linkage.links)
        } else if body < self.blocks.diagonal.len() {
            Place::Link(body)
        } else {
            Place::Corner
        }
    }

    /// Adds a contact; `b` is the change of velocities that the forces by themselves make.
    pub(super) fn add(&mut self, element: &Element, mounts: &[Mount], weights: Weights, b: &[f64]) {
        let tangent = element.tangent();
        let rows = |direction: Vector, levers: [f64; 2]| {
            let a = Vector3::new(
                direction.x,
                direction.y,
                cross(element.arm_a, direction) + levers[0],
            );
            (a, partner_row(element, mounts, direction, levers[1]))
        };
        let along = rows(element.normal, [0.0; 2]);
        let across = rows(tangent, [element.lever_a, element.lever_b]);
        if weights.once {
            let change = self.change(element.a, across, b);
            let [normal, tangent] =
                element.step_weights(weights, self.linkage.soft(weights), change);
            self.square(element.a, along.0, along.1, normal);
            self.square(element.a, across.0, across.1, tangent);
            return;
        }
        let normal = weights.damping * element.damping + weights.stiffness * element.stiffness;
        self.square(element.a, along.0, along.1, normal);
        self.square(
            element.a,
            across.0,
            across.1,
            weights.damping * element.drag,
        );
        if weights.stiffness > 0.0 {
            let pivoting = Element {
                arm_b: element.pivot_b,
                ..*element
            };
            let a = Vector3::new(tangent.x, tangent.y, cross(element.arm_a, tangent));
            let b = partner_row(&pivoting, mounts, tangent, 0.0);
            self.square(element.a, a, b, weights.stiffness * element.across.max(0.0));
            self.add_bend(&pivoting, mounts, weights.stiffness);
        }
    }

    /// How much velocities `b` move the two sides along a row past each other.
    fn change(&self, a: Option<usize>, (row, partner): (Vector3<f64>, Row), b: &[f64]) -> f64 {
        let of = |body: usize, row: Vector3<f64>| {
            row.x * b[3 * body] + row.y * b[3 * body + 1] + row.z * b[3 * body + 2]
        };
        let own = a.map_or(0.0, |body| of(body, row));
        let wheels = &b[self.linkage.coordinates()..];
        own - match partner {
            Row::Nothing => 0.0,
            Row::Body(body, row) => of(body, row),
            Row::Border(entries) => {
                let entries = entries.iter().filter(|(j, _)| *j != usize::MAX);
                entries.map(|(j, value)| value * wheels[*j]).sum()
            }
        }
    }

    /// What the force adds to the rotation of the bodies it turns: −F n·arm, where that holds them.
    fn add_bend(&mut self, element: &Element, mounts: &[Mount], weight: f64) {
        let own = -element.force * element.normal.dot(&element.arm_a);
        if let Some(body) = element.a {
            self.add_turn(body, weight * own.max(0.0));
        }
        let other = element.force * element.normal.dot(&element.arm_b);
        match element.b {
            Partner::Ground => {}
            Partner::Body(body) => self.add_turn(body, weight * other.max(0.0)),
            Partner::Mount(mount) => {
                if let Some((j, ratio)) = mounts[mount].turn {
                    let j = self.first + j;
                    self.blocks.corner[(j, j)] += weight * other.max(0.0) * ratio * ratio;
                }
            }
        }
    }

    pub(super) fn add_turn(&mut self, body: usize, value: f64) {
        match self.place(body) {
            Place::Link(i) => self.blocks.diagonal[i][(2, 2)] += value,
            Place::Corner => self.blocks.corner[(2, 2)] += value,
            Place::Roller(i) => self.loose[i].own[(2, 2)] += value,
        }
    }

    /// Adds w (a − b)ᵀ(a − b).
    pub(super) fn square(
        &mut self,
        a: Option<usize>,
        row: Vector3<f64>,
        partner: Row,
        weight: f64,
    ) {
        if weight <= 0.0 {
            return;
        }
        let place = a.map(|body| self.place(body));
        if let Some(place) = place {
            self.diagonal(place, row, weight);
        }
        match partner {
            Row::Nothing => {}
            Row::Body(body, other) => {
                let there = self.place(body);
                self.diagonal(there, other, weight);
                if let Some(place) = place {
                    self.couple(place, row, there, other, -weight);
                }
            }
            Row::Border(entries) => {
                for (k, &(j, value)) in entries.iter().enumerate() {
                    if j == usize::MAX {
                        continue;
                    }
                    for &(i, other) in &entries[..=k] {
                        if i == usize::MAX {
                            continue;
                        }
                        let [high, low] = [i.max(j), i.min(j)].map(|j| self.first + j);
                        self.blocks.corner[(high, low)] += weight * value * other;
                    }
                    if let Some(place) = place {
                        self.beside(place, self.first + j, row * (-weight * value));
                    }
                }
            }
        }
    }

    fn diagonal(&mut self, place: Place, row: Vector3<f64>, weight: f64) {
        let block = row * row.transpose() * weight;
        match place {
            Place::Link(i) => self.blocks.diagonal[i] += block,
            Place::Corner => {
                for j in 0..3 {
                    for k in 0..=j {
                        self.blocks.corner[(j, k)] += block[(j, k)];
                    }
                }
            }
            Place::Roller(i) => self.loose[i].own += block,
        }
    }

    /// Adds w row otherᵀ at (place, there) and its mirror image.
    fn couple(
        &mut self,
        place: Place,
        row: Vector3<f64>,
        there: Place,
        other: Vector3<f64>,
        weight: f64,
    ) {
        match (place, there) {
            (Place::Link(i), Place::Link(j)) if i == j + 1 => {
                self.blocks.below[j] += row * other.transpose() * weight;
            }
            (Place::Link(i), Place::Link(j)) if j == i + 1 => {
                self.blocks.below[i] += other * row.transpose() * weight;
            }
            (Place::Link(i), Place::Corner) => {
                for k in 0..3 {
                    self.blocks.beside[i * self.border + k] += row * (weight * other[k]);
                }
            }
            (Place::Corner, Place::Link(_)) => self.couple(there, other, place, row, weight),
            (Place::Roller(i), Place::Link(_) | Place::Corner) => {
                self.loose[i].link = Some(self.index(there));
                self.loose[i].coupling += other * row.transpose() * weight;
            }
            (Place::Link(_) | Place::Corner, Place::Roller(_)) => {
                self.couple(there, other, place, row, weight);
            }
            // Other pairs never touch.
            (Place::Link(_), Place::Link(_))
            | (Place::Corner, Place::Corner)
            | (Place::Roller(_), Place::Roller(_)) => {}
        }
    }

    fn index(&self, place: Place) -> usize {
        match place {
            Place::Link(i) => i,
            Place::Corner => self.linkage.links - 1,
            Place::Roller(i) => self.linkage.links + i,
        }
    }

    fn beside(&mut self, place: Place, j: usize, row: Vector3<f64>) {
        match place {
            Place::Link(i) => self.blocks.beside[i * self.border + j] += row,
            Place::Corner => {
                for k in 0..3 {
                    self.blocks.corner[(j, k)] += row[k];
                }
            }
            Place::Roller(i) => self.loose[i].couple(j, row),
        }
    }

    /// Schur complements of the free rollers.
    pub(super) fn eliminate_rollers(&mut self) -> bool {
        for index in 0..self.loose.len() {
            let Some(inverse) = self.loose[index].own.try_inverse() else {
                return false;
            };
            self.loose[index].inverse = inverse;
            let roller = std::mem::take(&mut self.loose[index]);
            let right = inverse * roller.right;
            for (k, &(j, row)) in roller.beside.iter().enumerate() {
                self.blocks.right_border[j] -= row.dot(&right);
                let through = inverse * row;
                for &(i, other) in &roller.beside[..=k] {
                    self.blocks.corner[(i.max(j), i.min(j))] -= other.dot(&through);
                }
            }
            self.pass_on(&roller, &inverse, &right);
            self.loose[index] = roller;
        }
        true
    }

    /// What an eliminated roller leaves with its link.
    fn pass_on(&mut self, roller: &Loose, inverse: &Matrix3<f64>, right: &Vector3<f64>) {
        let Some(link) = roller.link else { return };
        let place = self.place(link);
        let through = roller.coupling * inverse;
        let block = through * roller.coupling.transpose();
        let force = roller.coupling * right;
        match place {
            Place::Link(i) => {
                self.blocks.diagonal[i] -= block;
                self.blocks.right[i] -= force;
            }
            Place::Corner | Place::Roller(_) => {
                for j in 0..3 {
                    for k in 0..=j {
                        self.blocks.corner[(j, k)] -= block[(j, k)];
                    }
                    self.blocks.right_border[j] -= force[j];
                }
            }
        }
        for &(j, row) in &roller.beside {
            self.beside(place, j, -(through * row));
        }
    }
}

/// How the partner moves along a direction at the circle's centre, with a lever for its rotation.
pub(super) fn partner_row(
    element: &Element,
    mounts: &[Mount],
    direction: Vector,
    lever: f64,
) -> Row {
    match element.b {
        Partner::Ground => Row::Nothing,
        Partner::Body(body) => Row::Body(
            body,
            Vector3::new(
                direction.x,
                direction.y,
                cross(element.arm_b, direction) + lever,
            ),
        ),
        Partner::Mount(index) => {
            let mount = &mounts[index];
            let mut entries = [(usize::MAX, 0.0); 3];
            for (entry, shift) in entries.iter_mut().zip(&mount.shifts) {
                if let Some((j, shift)) = shift {
                    *entry = (*j, direction.dot(shift));
                }
            }
            if let Some((j, ratio)) = mount.turn {
                entries[2] = (j, (direction.dot(&turned(element.arm_b)) + lever) * ratio);
            }
            Row::Border(entries)
        }
    }
}
