//! The energy ledger of a state.

use chaindrive_integrate::Moment;

use crate::bodies::{RailContact, WheelSupport};
use crate::energy::{Energy, Flow, Store};
use crate::system::{Record, System};
use crate::tensioner::ReducedInertia;

impl System {
    /// The energy ledger of a state that `record` was evaluated at.
    pub(super) fn energy(&self, at: Moment<'_>, flows: &[f64], record: &Record) -> Energy {
        let mut energy = Energy::default();
        energy.flows.copy_from_slice(&flows[..Flow::ALL.len()]);
        let bodies = &self.bodies;
        for (flow, jumps) in [Flow::Driver, Flow::DriveTorque]
            .into_iter()
            .zip(bodies.inputs.jumps)
        {
            energy.flows[flow as usize] += jumps.until(at.t);
        }
        for (member, record) in self.chains.iter().zip(&record.chains) {
            let own = member.own(at);
            member
                .chain
                .energies(own, bodies.gravity, record, &mut energy);
        }
        let mut add = |store: Store, value: f64| energy.stores[store as usize] += value;
        for wheel in &bodies.wheels {
            let kinematics = wheel.kinematics(at.t, at.q, at.v);
            let (centre, velocity, _) = wheel.centre_kinematics(at.t, at.q, at.v, &bodies.slides);
            let moves = !matches!(wheel.support, WheelSupport::Fixed);
            if wheel.inertia > 0.0 {
                add(
                    Store::Sprockets,
                    0.5 * wheel.inertia * kinematics.rate * kinematics.rate,
                );
            }
            // What a tensioner carries is in the tensioner's inertia and weights.
            if moves && !matches!(wheel.support, WheelSupport::Carried(_)) {
                add(Store::Sprockets, 0.5 * wheel.mass * velocity.norm_squared());
                add(
                    Store::Gravity,
                    -wheel.mass * bodies.gravity.dot(&centre.coords),
                );
            }
            if let WheelSupport::Springs { stiffness, .. } = &wheel.support {
                for axis in 0..2 {
                    let away = centre[axis] - wheel.centre[axis];
                    add(Store::Supports, 0.5 * stiffness[axis] * away * away);
                }
            }
        }
        for (member, record) in self.chains.iter().zip(&record.chains) {
            for (on, touch) in member.contacts.teeth.iter().zip(&record.loads.teeth) {
                add(Store::Teeth, on.contacts.stored(touch));
            }
            for (i, on) in member.contacts.rails.iter().enumerate() {
                let stored = match &on.contact {
                    RailContact::Circles(contacts) => contacts.stored(&record.loads.rails[i]),
                    RailContact::Plates(plates) => {
                        let frame = bodies.rail_frame(on.rail, at);
                        let own = member.own(at);
                        let found = (plates, &*record.loads.rails[i]);
                        member.chain.plate_energy(own, found, &frame, record)
                    }
                };
                add(Store::Guides, stored);
            }
        }
        for shaft in bodies.shafts.iter().filter(|shaft| shaft.inertia > 0.0) {
            let rate = shaft.turn.kinematics(at.t, at.q, at.v).rate;
            add(Store::Sprockets, 0.5 * shaft.inertia * rate * rate);
        }
        for coupling in &bodies.couplings {
            let [twist, _] = bodies.twist(coupling, at);
            // U = ½ k φ²
            add(Store::Supports, 0.5 * coupling.stiffness * twist * twist);
        }
        for slide in &bodies.slides {
            let pose = slide.pose(at.q, at.v);
            let ReducedInertia { inertia, .. } = slide.reduced(pose);
            add(Store::Carriers, 0.5 * inertia * pose.rate * pose.rate);
            add(Store::Tensioners, slide.stored(pose, at.z));
            if slide.dof.is_some() {
                for (mass, place) in slide.weights() {
                    let (place, _) = slide.carry(pose, place);
                    add(Store::Gravity, -mass * bodies.gravity.dot(&place.coords));
                }
            }
        }
        energy
    }
}
