//! The equations of an implicit step, body by body: masses, contacts as rows, free rollers eliminated.

use chaindrive_geometry::Vector;
use chaindrive_integrate::Weights;
use nalgebra::{Matrix3, Vector3};

use super::free_rollers::FreeRollerEquations;
use super::{BorderedBlocks, Linkage};
use crate::bodies::GroupBodies;
use crate::chains::makeup::Makeup;
use crate::joints::{Element, Mount, Partner, Row, cross, partner_row};
use crate::seam::{Carried, CarriedByMount};

/// Position of a body's unknowns in the equations.
#[derive(Clone, Copy, PartialEq)]
enum BodyUnknowns {
    Link(usize),
    /// The last link of a closed chain, where it stands first in the border.
    Corner,
    Roller(usize),
}

/// The equations of the bodies, and the space for their solution.
#[derive(Clone, Debug, Default)]
pub(crate) struct Equations {
    pub(super) blocks: BorderedBlocks,
    pub(super) loose: Vec<FreeRollerEquations>,
    /// Weights of the contacts that are no joints in a step of one solution, normal and tangent, in their order.
    weights: Vec<[f64; 2]>,
}

/// The system under assembly.
pub(super) struct Sum<'a> {
    pub(super) linkage: &'a Linkage,
    pub(super) blocks: &'a mut BorderedBlocks,
    pub(super) loose: &'a mut [FreeRollerEquations],
    weights: &'a mut Vec<[f64; 2]>,
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
        let Equations {
            blocks,
            loose,
            weights,
        } = equations;
        weights.clear();
        let first = 3 * (linkage.series.links - row);
        let border = first + x.len() - linkage.coordinates();
        blocks.clear(row, border);
        loose.resize_with(
            linkage.bodies.len() - linkage.series.links,
            FreeRollerEquations::default,
        );
        loose.iter_mut().for_each(FreeRollerEquations::clear);
        Self {
            linkage,
            blocks,
            loose,
            weights,
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
                BodyUnknowns::Link(i) => {
                    self.blocks.diagonal[i] = Matrix3::from_diagonal(&mass);
                    self.blocks.right[i] = force;
                }
                BodyUnknowns::Corner => {
                    for k in 0..3 {
                        self.blocks.corner[(k, k)] = mass[k];
                        self.blocks.right_border[k] = force[k];
                    }
                }
                BodyUnknowns::Roller(i) => {
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
        let links = self.linkage.series.links;
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
            BodyUnknowns::Link(i) => self.blocks.right[i],
            BodyUnknowns::Corner | BodyUnknowns::Roller(_) => {
                Vector3::from_fn(|k, _| self.blocks.right_border[k])
            }
        }
    }

    fn place(&self, body: usize) -> BodyUnknowns {
        if body >= self.linkage.series.links {
            BodyUnknowns::Roller(body - self.linkage.series.links)
        } else if body < self.blocks.diagonal.len() {
            BodyUnknowns::Link(body)
        } else {
            BodyUnknowns::Corner
        }
    }

    /// Adds a contact; `b` is the change of velocities that the forces by themselves make.
    pub(super) fn add(&mut self, element: &Element, mounts: &[Mount], weights: Weights, b: &[f64]) {
        let tangent = element.tangent();
        let [along, across] = rows(element, mounts);
        if weights.once {
            // Of what does not rub no weight depends on it.
            let change = if element.rub.abs() > 0.0 {
                self.change(element.a, across, b)
            } else {
                0.0
            };
            let [normal, tangent] =
                element.step_weights(weights, self.linkage.soft(weights), change);
            self.weights.push([normal, tangent]);
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

    /// What the contacts but those of pins do in a step of length h \[s\] that takes one solution, beside their forces at its beginning;
    /// `x` is the solution.
    ///
    /// ```text
    /// w Δ                          impulse along every row: w its weight, Δ the change of closing or slip
    /// h d Δ (δ̇ + ½ (δ̇ + Δ))     lost along the normal
    /// ```
    ///
    /// A damper with R = d δ̇ at the beginning has R + d Δ over the step, at a speed of δ̇ + ½ Δ.
    pub(super) fn carry(
        &self,
        elements: &[Element],
        mounts: &[Mount],
        h: f64,
        x: &[f64],
        carried: &mut Carried,
    ) {
        let nothing = CarriedByMount {
            push: Vector::zeros(),
            moment: 0.0,
            lost: 0.0,
        };
        carried.mounts.clear();
        carried.mounts.resize(mounts.len(), nothing);
        carried.joints = [0.0; 2];
        for (element, weights) in elements.iter().zip(&*self.weights) {
            let [along, across] = rows(element, mounts);
            let change = self.change(element.a, along, x);
            let closing = element.closing + 0.5 * (element.closing + change);
            let lost = h * element.damping * change * closing;
            let Partner::Mount(mount) = element.b else {
                carried.joints[1] += lost;
                continue;
            };
            let normal = weights[0] * change;
            let rub = weights[1] * self.change(element.a, across, x);
            let push = element.normal * normal + element.tangent() * rub;
            let on = &mut carried.mounts[mount];
            on.push += push;
            on.moment += cross(element.arm_b, push) + element.lever_b * rub;
            on.lost += lost;
        }
    }

    /// Relative velocity of the two sides along a row under velocities `b`.
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

    /// Contribution of the force to the rotation of the bodies that it turns: −F n·arm, where that is positive.
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
            BodyUnknowns::Link(i) => self.blocks.diagonal[i][(2, 2)] += value,
            BodyUnknowns::Corner => self.blocks.corner[(2, 2)] += value,
            BodyUnknowns::Roller(i) => self.loose[i].own[(2, 2)] += value,
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

    fn diagonal(&mut self, place: BodyUnknowns, row: Vector3<f64>, weight: f64) {
        let block = row * row.transpose() * weight;
        match place {
            BodyUnknowns::Link(i) => self.blocks.diagonal[i] += block,
            BodyUnknowns::Corner => {
                for j in 0..3 {
                    for k in 0..=j {
                        self.blocks.corner[(j, k)] += block[(j, k)];
                    }
                }
            }
            BodyUnknowns::Roller(i) => self.loose[i].own += block,
        }
    }

    /// Adds w row otherᵀ at (place, there) and its mirror image.
    fn couple(
        &mut self,
        place: BodyUnknowns,
        row: Vector3<f64>,
        there: BodyUnknowns,
        other: Vector3<f64>,
        weight: f64,
    ) {
        match (place, there) {
            (BodyUnknowns::Link(i), BodyUnknowns::Link(j)) if i == j + 1 => {
                self.blocks.below[j] += row * other.transpose() * weight;
            }
            (BodyUnknowns::Link(i), BodyUnknowns::Link(j)) if j == i + 1 => {
                self.blocks.below[i] += other * row.transpose() * weight;
            }
            (BodyUnknowns::Link(i), BodyUnknowns::Corner) => {
                for k in 0..3 {
                    self.blocks.beside[i * self.border + k] += row * (weight * other[k]);
                }
            }
            (BodyUnknowns::Roller(i), BodyUnknowns::Link(_) | BodyUnknowns::Corner) => {
                self.loose[i].link = Some(self.index(there));
                self.loose[i].coupling += other * row.transpose() * weight;
            }
            // Of what is symmetric the other half is written.
            (BodyUnknowns::Corner, BodyUnknowns::Link(_))
            | (BodyUnknowns::Link(_) | BodyUnknowns::Corner, BodyUnknowns::Roller(_)) => {
                self.couple(there, other, place, row, weight);
            }
            // Other pairs never touch.
            (BodyUnknowns::Link(_), BodyUnknowns::Link(_))
            | (BodyUnknowns::Corner, BodyUnknowns::Corner)
            | (BodyUnknowns::Roller(_), BodyUnknowns::Roller(_)) => {}
        }
    }

    fn index(&self, place: BodyUnknowns) -> usize {
        match place {
            BodyUnknowns::Link(i) => i,
            BodyUnknowns::Corner => self.linkage.series.links - 1,
            BodyUnknowns::Roller(i) => self.linkage.series.links + i,
        }
    }

    fn beside(&mut self, place: BodyUnknowns, j: usize, row: Vector3<f64>) {
        match place {
            BodyUnknowns::Link(i) => self.blocks.beside[i * self.border + j] += row,
            BodyUnknowns::Corner => {
                for k in 0..3 {
                    self.blocks.corner[(j, k)] += row[k];
                }
            }
            BodyUnknowns::Roller(i) => self.loose[i].couple(j, row),
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

    /// Adds the equations of an eliminated roller to those of its link.
    fn pass_on(
        &mut self,
        roller: &FreeRollerEquations,
        inverse: &Matrix3<f64>,
        right: &Vector3<f64>,
    ) {
        let Some(link) = roller.link else { return };
        let place = self.place(link);
        let through = roller.coupling * inverse;
        let block = through * roller.coupling.transpose();
        let force = roller.coupling * right;
        match place {
            BodyUnknowns::Link(i) => {
                self.blocks.diagonal[i] -= block;
                self.blocks.right[i] -= force;
            }
            BodyUnknowns::Corner | BodyUnknowns::Roller(_) => {
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

/// Rows of a contact: its normal, and its tangent with the levers of the friction.
fn rows(element: &Element, mounts: &[Mount]) -> [(Vector3<f64>, Row); 2] {
    let row = |direction: Vector, levers: [f64; 2]| {
        let turn = cross(element.arm_a, direction) + levers[0];
        let own = Vector3::new(direction.x, direction.y, turn);
        (own, partner_row(element, mounts, direction, levers[1]))
    };
    [
        row(element.normal, [0.0; 2]),
        row(element.tangent(), [element.lever_a, element.lever_b]),
    ]
}
