//! Stiffness and damping around every body, for the time scales: sums over the contacts that it has.
//!
//! ```text
//! S = M^(−½) Σ 2 k r rᵀ M^(−½):     λ ≤ m + 2 p,   m = tr/3,   p² = |S − m|²/6
//! ```

use chaindrive_geometry::Vector;
use chaindrive_integrate::{Array, kernel};
use pulp::Simd;

use super::{JointState, Linkage};
use crate::contact::BoreContact;
use crate::lanes::{LANES, Lane, Wide, padded};

/// What a sum is of.
#[derive(Clone, Copy)]
pub(super) enum Kind {
    Stiffness,
    Damping,
}

/// Entries (0, 0), (1, 1), (2, 2), (1, 0), (2, 0), (2, 1) of the sum of every body, whole lanes: of stiffness, of damping, and of the
/// springs that hold what sticks.
#[derive(Clone, Debug, Default)]
pub(crate) struct StiffnessSums {
    sums: [[Array; 6]; 3],
}

impl StiffnessSums {
    /// Those of pins in bushes; none of anything else.
    pub(super) fn begin(
        &mut self,
        linkage: &Linkage,
        joint_state: &JointState,
        bearing: Option<&BoreContact>,
    ) {
        let count = padded(linkage.bodies.len()) + LANES;
        for values in self.sums.as_flattened_mut() {
            values.clear();
            values.resize(count, 0.0);
        }
        if let Some(bearing) = bearing {
            let registers = linkage.series.registers;
            registers.dispatch(of_pins(self, linkage, joint_state, bearing));
        }
    }

    /// S += w r rᵀ of a body; r: along a direction, with the lever of its turning.
    pub(super) fn add(
        &mut self,
        linkage: &Linkage,
        kind: Kind,
        body: usize,
        (n, turn): (Vector, f64),
        weight: f64,
    ) {
        let [root, turning] = linkage.shapes.roots[body];
        let row = [n.x * root, n.y * root, turn * turning];
        let places = [(0, 0), (1, 1), (2, 2), (1, 0), (2, 0), (2, 1)];
        for (entry, (i, j)) in self.sums[kind as usize].iter_mut().zip(places) {
            entry[body] += row[i] * (row[j] * weight);
        }
    }

    /// The largest eigenvalues of all bodies, from above: of stiffness, damping, and stiffness with what sticks.
    pub(super) fn largest(&self, linkage: &Linkage) -> [f64; 3] {
        let mut most = [0.0_f64; 3];
        for body in 0..linkage.bodies.len() {
            let [stiffness, damping, sticking] = [0, 1, 2].map(|kind| {
                let sums: &[Array; 6] = &self.sums[kind];
                [0, 1, 2, 3, 4, 5].map(|k| sums[k][body])
            });
            let stuck = std::array::from_fn(|k| stiffness[k] + sticking[k]);
            for (most, sum) in most.iter_mut().zip([stiffness, damping, stuck]) {
                *most = most.max(largest(&sum));
            }
        }
        most
    }
}

kernel!(
    /// S of the links: of the joint at the beginning of each, and of that at its end.
    fn of_pins<'a, S: Simd>(
        w: Wide<S>,
        sums: &'a mut StiffnessSums,
        linkage: &'a Linkage,
        joint_state: &'a JointState,
        bearing: &'a BoreContact,
    ) {
        let JointState { pins, posture, .. } = joint_state;
        let (before, after, friction) = (&posture.before, &posture.after, &bearing.lanes.friction);
        let zero = w.splat(0.0);
        for start in (0..linkage.series.links).step_by(Wide::<S>::COUNT) {
            let mut found = [[zero; 6]; 3];
            let root = w.load(&linkage.shapes.mobility, start + 1).sqrt();
            let turning = w.load(&linkage.shapes.turning, start + 1).sqrt();
            for (side, joint) in [(0, start), (1, start + 1)] {
                let [arm_x, arm_y, turn] = match side {
                    0 => [&after.arm_x, &after.arm_y, &pins.turn_after],
                    _ => [&before.arm_x, &before.arm_y, &pins.turn_before],
                }
                .map(|all| w.load(all, joint));
                let [nx, ny, stiffness] =
                    [&pins.normal_x, &pins.normal_y, &pins.stiffness].map(|all| w.load(all, joint));
                let closed = stiffness.greater(zero);
                // What a spring resists within the step is in its stiffness already.
                let (drag, spring) = match friction.beside_spring() {
                    Some(dashpot) => (
                        closed.select(w.splat(dashpot), zero),
                        closed.select(w.splat(friction.stiffness(0.0)), zero),
                    ),
                    None => (w.load(&pins.drag, joint), zero),
                };
                let share = linkage.pairs.shares(w, joint);
                let along = products([nx * root, ny * root, turn * turning]);
                // ẑ × n, with arm·n and the lever of the friction
                let [tx, ty, pivot] = [-ny, nx, (arm_x * nx).plus(arm_y, ny)];
                let levers = bearing.lever_lanes(
                    w,
                    linkage.pairs.pins_after(w, joint),
                    -w.load(&pins.gap, joint),
                );
                let pivoting = products([tx * root, ty * root, pivot * turning]);
                let across = products([tx * root, ty * root, (pivot + levers[1 - side]) * turning]);
                let [stiffness, bent, damping] = [
                    stiffness,
                    w.load(&pins.across, joint),
                    w.load(&pins.damping, joint),
                ]
                .map(|value| share * value);
                let [drag, spring] = [share * drag, share * spring];
                for k in 0..6 {
                    found[0][k] = found[0][k]
                        .plus(stiffness, along[k])
                        .plus(bent, pivoting[k]);
                    found[1][k] = found[1][k].plus(damping, along[k]).plus(drag, across[k]);
                    found[2][k] = found[2][k].plus(spring, across[k]);
                }
            }
            for (sums, found) in sums.sums.iter_mut().zip(found) {
                for (sum, found) in sums.iter_mut().zip(found) {
                    found.store(sum, start);
                }
            }
        }
    }
);

/// Entries of r rᵀ, in the order of the sums.
#[inline(always)]
fn products<S: Simd>([x, y, turn]: [Lane<S>; 3]) -> [Lane<S>; 6] {
    [x * x, y * y, turn * turn, y * x, turn * x, turn * y]
}

/// Largest eigenvalue of a positive semidefinite matrix, from above.
fn largest([x, y, z, yx, zx, zy]: &[f64; 6]) -> f64 {
    let mean = (x + y + z) / 3.0;
    let off = yx * yx + zx * zx + zy * zy;
    let diagonal = [x, y, z].map(|value| (value - mean) * (value - mean));
    // Every entry beside the diagonal counts twice.
    let squared = diagonal.iter().sum::<f64>() + 2.0 * off;
    mean + 2.0 * (squared / 6.0).sqrt()
}
