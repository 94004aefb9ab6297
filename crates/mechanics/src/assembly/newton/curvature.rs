//! Second derivatives of the energy at a static state, and the conditions that ideal joints set.

use chaindrive_geometry::Vector;
use nalgebra::{DMatrix, DVector};

use super::{Unknowns, balance};
use crate::System;
use crate::seam::{Load, Moving};

/// Second derivatives of the energy at a state under full gravity and load.
#[derive(Clone, Debug)]
pub(crate) struct Curvature {
    /// State entry of every row.
    pub(crate) entries: Vec<usize>,
    /// ∂²(E − λ·c)/∂q², rows and columns as in `entries`.
    pub(crate) hessian: DMatrix<f64>,
    /// J = ∂c/∂q, one row for every direction of an ideal joint.
    pub(crate) conditions: DMatrix<f64>,
    /// Largest force out of balance, relative to the largest tension.
    pub(crate) residual: f64,
}

/// The Hessian with which [`settle`](super::settle) iterates, dense, whatever the chains are made of.
///
/// ```text
/// c = P_pin − P_hole = 0 in ideal joints,   ∇E = Jᵀ λ,   K = ∇²E − Σ λ ∇²c
/// ```
pub(crate) fn curvature(system: &System, q: &[f64]) -> Curvature {
    let unknowns = Unknowns::new(system);
    let mut balance = balance::balance(system, &unknowns, q, Load::FULL);
    let count = unknowns.count;
    let mut hessian = DMatrix::zeros(count, count);
    for &(i, j, value) in &balance.entries {
        hessian[(i, j)] += value;
    }
    let still = vec![0.0; q.len()];
    let z = system.settled_states(q);
    for slide in &system.bodies.slides {
        let row = slide.dof.and_then(|dof| unknowns.row[dof]);
        if let Some(row) = row {
            // Vibrations leave a state, such as the oil in a chamber, no time to flow.
            hessian[(row, row)] += slide
                .slopes(slide.pose(q, &still), slide.state(&z))
                .stiffness;
        }
    }
    let hinges = hinges(system, q);
    let mut conditions = DMatrix::zeros(2 * hinges.len(), count);
    for (index, hinge) in hinges.iter().enumerate() {
        each_way(hinge, &unknowns, |row, first, _| {
            for axis in 0..2 {
                conditions[(2 * index + axis, row)] += first[axis];
            }
        });
    }
    if !hinges.is_empty() {
        let forces = multipliers(&conditions, &balance.gradient, &unknowns);
        balance.gradient -= conditions.transpose() * &forces;
        for (index, hinge) in hinges.iter().enumerate() {
            let force = Vector::new(forces[2 * index], forces[2 * index + 1]);
            balance.tensions.push(force.norm());
            each_way(hinge, &unknowns, |row, _, second| {
                hessian[(row, row)] -= force.dot(&second);
            });
        }
    }
    let mut entries = vec![0; count];
    for (entry, row) in unknowns.row.iter().enumerate() {
        if let Some(row) = row {
            entries[*row] = entry;
        }
    }
    Curvature {
        entries,
        hessian,
        conditions,
        residual: balance::residual(system, &unknowns, q, &balance),
    }
}

/// Hole and pin of all ideal joints, with entries of the state.
fn hinges(system: &System, q: &[f64]) -> Vec<[Moving; 2]> {
    let mut hinges = Vec::new();
    for member in &system.chains {
        let own = &q[member.entries.clone()];
        member.chain.each_hinge(own, |sides| {
            hinges.push(sides.map(|side| side.behind(member.entries.start)));
        });
    }
    hinges
}

/// Visits (row, first, second derivative) of the pin seen from its hole.
fn each_way(
    [hole, pin]: &[Moving; 2],
    unknowns: &Unknowns,
    mut visit: impl FnMut(usize, Vector, Vector),
) {
    for (side, sign) in [(hole, -1.0), (pin, 1.0)] {
        for way in side.ways() {
            if let Some(row) = unknowns.row[way.entry] {
                visit(row, way.first * sign, way.second * sign);
            }
        }
    }
}

/// λ that comes nearest to ∇E = Jᵀ λ, lengths and angles weighed by their levers.
fn multipliers(
    conditions: &DMatrix<f64>,
    gradient: &DVector<f64>,
    unknowns: &Unknowns,
) -> DVector<f64> {
    let levers = unknowns.scale.iter().map(|lever| 1.0 / lever.sqrt());
    let scale = DVector::from_iterator(unknowns.count, levers);
    let mut rows = conditions.transpose();
    for mut column in rows.column_iter_mut() {
        column.component_mul_assign(&scale);
    }
    let right = gradient.component_mul(&scale);
    let largest = rows.amax();
    let svd = rows.svd(true, true);
    // Both factors were asked for.
    svd.solve(&right, 1e-12 * largest)
        .unwrap_or_else(|_| DVector::zeros(conditions.nrows()))
}
