//! Forces and stiffness of the static balance, and how far from balanced it is.

use chaindrive_integrate::Moment;
use nalgebra::DVector;

use super::{ACCEPTED, Unknowns, contact, rounding};
use crate::System;
use crate::bodies::WheelSupport;
use crate::seam::{Balance, Load, Sum};
use crate::tensioner::Extension;

/// Derivatives of the energy at a state.
pub(super) fn balance(system: &System, unknowns: &Unknowns, q: &[f64], load: Load) -> Balance {
    let mut sum = Sum {
        row: &unknowns.row,
        first: 0,
        balance: Balance {
            gradient: DVector::zeros(unknowns.count),
            // A link of two free rollers has sixteen, four for every unknown, and twice that with its neighbour.
            entries: Vec::with_capacity(10 * unknowns.count),
            contacts: vec![0; system.bodies.wheels.len()],
            tensions: Vec::with_capacity(system.links()),
        },
    };
    for member in &system.chains {
        sum.first = member.entries.start;
        let own = &q[member.entries.clone()];
        member
            .chain
            .add_balance(own, system.bodies.gravity, load, &mut sum);
    }
    sum.first = 0;
    add_bodies(system, q, load, &mut sum);
    contact::add_contacts(system, q, &mut sum);
    sum.balance
}

fn add_bodies(system: &System, q: &[f64], load: Load, sum: &mut Sum<'_>) {
    let (bodies, begin) = (&system.bodies, system.begin);
    let still = vec![0.0; q.len()];
    for shaft in &bodies.shafts {
        if let Some((dof, ratio)) = shaft.turn.turned_by() {
            let kinematics = shaft.turn.kinematics(begin, q, &still);
            let of =
                |torques| bodies.torque(torques, kinematics, Moment::stateless(begin, q, &still));
            let torque = of(&shaft.drive) + of(&shaft.load);
            sum.force(dof, -load.torque * (ratio * torque));
        }
    }
    let at = Moment::stateless(begin, q, &still);
    for (index, wheel) in bodies.wheels.iter().enumerate() {
        if let WheelSupport::Springs { dof, stiffness, .. } = &wheel.support {
            if let Some(force) = bodies.centre_force(index, at) {
                for axis in 0..2 {
                    sum.force(dof + axis, -load.torque * force[axis]);
                }
            }
            for axis in 0..2 {
                let away = q[dof + axis] - wheel.centre[axis];
                let weight = load.gravity * wheel.mass * bodies.gravity[axis];
                sum.force(dof + axis, stiffness[axis] * away - weight);
                sum.stiffen(dof + axis, dof + axis, stiffness[axis]);
            }
        }
    }
    for coupling in &bodies.couplings {
        let [twist, _] = bodies.twist(coupling, Moment::stateless(begin, q, &still));
        for (entry, share) in bodies.twisted_by(coupling) {
            sum.force(entry, coupling.stiffness * twist * share);
            for (other, other_share) in bodies.twisted_by(coupling) {
                sum.stiffen(entry, other, coupling.stiffness * share * other_share);
            }
        }
    }
    for (index, slide) in bodies.slides.iter().enumerate() {
        let Some(dof) = slide.dof else { continue };
        let s = q[dof];
        let Extension { length, lever } = slide.carrier.extension(s);
        let push = slide.push.relaxed();
        let force = push.force(length, 0.0, 0.0).elastic;
        let h = 1e-6;
        // The lever of a plunger changes slowly with the angle of its arm.
        let [behind, ahead] = [s - h, s + h].map(|s| slide.carrier.extension(s).lever);
        let bend = (ahead - behind) / (2.0 * h);
        sum.force(dof, -force * lever);
        sum.stiffen(
            dof,
            dof,
            push.stiffness(length) * lever * lever - force * bend,
        );
        let pose = slide.pose(q, &still);
        for (mass, at_rest) in slide.weights() {
            let weight = bodies.gravity * (mass * load.gravity);
            let (place, _) = slide.carry(pose, at_rest);
            let Some(way) = slide.way(pose, place) else {
                continue;
            };
            sum.force(dof, -way.first.dot(&weight));
            if way.bends() {
                // ∂²(−m g·x)/∂s² = −m g·∂²x/∂s²
                sum.stiffen(dof, dof, -weight.dot(&way.second));
            }
        }
        bodies.each_force_on(index, pose, at, |force| {
            sum.force(dof, -load.torque * force.along);
            // ∂²(−F·x)/∂s² = −F·∂²x/∂s²
            sum.stiffen(dof, dof, -load.torque * force.bend);
        });
    }
}

/// Largest force out of balance, relative to the largest tension.
pub(super) fn residual(system: &System, unknowns: &Unknowns, q: &[f64], balance: &Balance) -> f64 {
    let tension = balance.tensions.iter().fold(0.0_f64, |m, t| m.max(t.abs()));
    let gravity = system.bodies.gravity.norm();
    // What rounding leaves in an unloaded chain is accepted.
    let (mut mass, mut floor) = (0.0_f64, 1e-9_f64);
    for member in &system.chains {
        mass = mass.max(member.chain.weights()[1]);
        floor = floor.max(rounding(member, q) / ACCEPTED);
    }
    let forced = system.bodies.largest_force(system.begin);
    let scale = tension.max(mass * gravity).max(floor).max(forced);
    let scaled = balance.gradient.iter().zip(&unknowns.scale);
    scaled
        .map(|(g, lever)| (g / lever.sqrt()).abs())
        .fold(0.0, f64::max)
        / scale
}
