//! A pin in its hole, joint by joint: the closed contact, and its energy in equilibrium.

use chaindrive_geometry::Vector;
use nalgebra::Matrix2;

use super::{Element, Part, Partner, turned};
use crate::contact::{BoreContact, CENTRED, LaneTally, MemoryLanes, RelativeMotion};
use crate::lanes::Wide;
use crate::seam::{Moving, Sum};

/// The contact of `pin` in `hole` at a joint, which the memory has in `lane`: one lane of one.
pub(crate) fn touch(
    bearing: &BoreContact,
    joint: usize,
    [hole, pin]: [&Part; 2],
    memory: &mut MemoryLanes<'_, pulp::Scalar>,
    lane: usize,
    dt: f64,
    tally: &mut LaneTally<pulp::Scalar>,
) -> Option<Element> {
    let w = Wide(pulp::Scalar);
    let lanes = |v: Vector| [w.splat(v.x), w.splat(v.y)];
    let all = w.first(1);
    let apart = RelativeMotion {
        offset: lanes(pin.place - hole.place),
        rate: lanes(pin.velocity - hole.velocity),
        spin: [w.splat(hole.spin), w.splat(pin.spin)],
        present: all,
        pin_after: all,
    };
    let grip = bearing.grip(w, memory, lane, &apart, dt, tally);
    let gap = grip.gap.sum();
    let [lever_pin, lever_hole] = bearing.levers(-gap);
    (gap < 0.0).then(|| Element {
        joint,
        a: pin.body,
        b: hole.body.map_or(Partner::Ground, Partner::Body),
        arm_a: pin.arm,
        arm_b: hole.arm,
        pivot_b: hole.arm,
        lever_a: lever_pin,
        lever_b: lever_hole,
        normal: Vector::new(grip.normal[0].sum(), grip.normal[1].sum()),
        force: grip.force.sum(),
        rub: grip.rub.sum(),
        stiffness: grip.stiffness.sum(),
        damping: grip.damping.sum(),
        drag: grip.drag.sum(),
        secant: grip.secant.sum(),
        across: grip.across.sum(),
        closing: grip.closing.sum(),
    })
}

/// Adds the energy of a pin in a hole.
///
/// ```text
/// ∂U/∂e = F n,   ∂²U/∂e² = k n nᵀ + F/|e| t tᵀ,   e = P_pin − P_hole
/// ```
pub(crate) fn add_joint(bearing: &BoreContact, [hole, pin]: [Moving; 2], sum: &mut Sum<'_>) {
    let offset = pin.place - hole.place;
    let eccentricity = offset.norm();
    let depth = eccentricity - bearing.clearance;
    if depth <= 0.0 || eccentricity < CENTRED {
        return;
    }
    let (n, answer) = (offset / eccentricity, bearing.at_rest(depth));
    let t = turned(n);
    let stiffness: Matrix2<f64> =
        n * n.transpose() * answer.stiffness + t * t.transpose() * (answer.elastic / eccentricity);
    sum.balance.tensions.push(answer.elastic);
    sum.stretch([&hole, &pin], n * answer.elastic, &stiffness);
}
