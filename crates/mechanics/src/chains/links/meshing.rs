//! Rollers of a linkage on teeth and guides.

use chaindrive_contact::Friction;
use chaindrive_geometry::{Point, Vector};
use chaindrive_integrate::{Array, Moment, kernel};

use super::rates::LinkPins;
use super::{JointState, Linkage, Posture};
use crate::bodies::{RailContact, Surroundings};
use crate::contact::{Contacts, Frame, MemoryField, Rollers, Touch, Wrench, pressing};
use crate::energy::Flow;
use crate::joints::{Element, Partner, rail_mount, wheel_mount};
use crate::lanes::Wide;
use crate::seam::Loads;

impl Linkage {
    /// Contacts with wheels and rails.
    pub(super) fn mesh(
        &self,
        around: Surroundings<'_>,
        at: Moment<'_>,
        rates: &mut [f64],
        loads: &mut Loads,
        joint_state: &mut JointState,
    ) {
        let Surroundings {
            bodies,
            first,
            contacts,
            ..
        } = around;
        joint_state.mounts.clear();
        for (i, on) in contacts.teeth.iter().enumerate() {
            let frame = loads.frames[i];
            let wheel = &bodies.wheels[on.wheel];
            let mount = wheel_mount(first, wheel, loads.ways[i]);
            joint_state.mounts.push(mount);
            let touch = &mut loads.teeth[i];
            let wrench = self.roll(&on.contacts, &frame, i, at, touch, joint_state);
            rates[Flow::ToothLoss as usize] += wrench.normal_loss;
            rates[Flow::ToothFriction as usize] += wrench.friction_loss;
            loads.wheel_wrenches[i] = wrench;
        }
        for (i, on) in contacts.rails.iter().enumerate() {
            let number = contacts.teeth.len() + i;
            let frame = loads.frames[number];
            let support = &bodies.rails[on.rail].support;
            let mount = rail_mount((bodies, first), support, loads.ways[number]);
            joint_state.mounts.push(mount);
            let wrench = match &on.contact {
                RailContact::Circles(contacts) => {
                    let touch = &mut loads.rails[i];
                    self.roll(contacts, &frame, number, at, touch, joint_state)
                }
                RailContact::Plates(plates) => {
                    let touch = &mut loads.rails[i];
                    let links = self.series.links;
                    let pins = &mut LinkPins { joint_state, links };
                    let registers = self.series.registers;
                    registers.dispatch(pressing(plates, at.t, frame, pins, 0.0, touch))
                }
            };
            rates[Flow::GuideLoss as usize] += wrench.normal_loss;
            rates[Flow::GuideFriction as usize] += wrench.friction_loss;
            loads.rail_wrenches[i] = wrench;
        }
    }
}

kernel!(
    /// The contacts of one wheel or rail.
    fn touching<'a, S: Simd>(
        w: Wide<S>,
        contacts: &'a Contacts,
        frame: &'a Frame,
        t: f64,
        rollers: Rollers<'a>,
        touch: &'a mut Touch,
    ) -> Wrench {
        let (mut rollers, mut wrench) = (rollers, Wrench::default());
        contacts.act(w, t, frame, &mut rollers, None, touch, &mut wrench);
        wrench
    }
);

impl Linkage {
    /// All contacts of the rollers with one wheel or rail.
    fn roll(
        &self,
        contacts: &Contacts,
        frame: &Frame,
        mount: usize,
        at: Moment<'_>,
        touch: &mut Touch,
        joint_state: &mut JointState,
    ) -> Wrench {
        let rubs = contacts.surface.friction != Friction::None;
        let posture = &joint_state.posture;
        let idle = &mut joint_state.idle;
        for values in [&mut idle.ax, &mut idle.ay, &mut idle.inverse_mass] {
            values.resize(posture.x.len(), 0.0);
        }
        if rubs {
            self.spin_of_circles(at, posture, &mut idle.spin);
        } else {
            idle.spin.clear();
        }
        let rollers = Rollers {
            x: &posture.x,
            y: &posture.y,
            vx: &posture.vx,
            vy: &posture.vy,
            ax: &mut idle.ax,
            ay: &mut idle.ay,
            inverse_mass: &idle.inverse_mass,
            spin: &idle.spin,
            half_step: 0.0,
        };
        let registers = self.series.registers;
        let wrench = registers.dispatch(touching(contacts, frame, at.t, rollers, touch));
        contacts.for_each_slot(|slot, joint| {
            for side in 0..contacts.sides() {
                let index = side * contacts.slots + slot;
                // Every closed contact becomes an element between the body that bears the circle and the wheel or rail.
                if !touch.state.is_closed(index) {
                    continue;
                }
                let faces = &touch.faces;
                let d = Point::new(joint_state.posture.x[joint], joint_state.posture.y[joint])
                    - frame.origin;
                let (body, arm) = self.bearer(joint, &joint_state.posture);
                // Elements look from the surface's material outward through the roller: n = −n_surface.
                let normal = -Vector::new(faces.normal_x[index], faces.normal_y[index]);
                let (force, bend) = (
                    touch.state.get(MemoryField::Force, index),
                    faces.bend[index],
                );
                let radius = contacts.radius;
                let mut element = Element {
                    joint: joint % self.joints.len(),
                    a: body,
                    b: Partner::Mount(mount),
                    arm_a: arm,
                    arm_b: d,
                    pivot_b: pivot(d, normal, bend),
                    lever_a: if self.spins(body) { radius } else { 0.0 },
                    lever_b: radius,
                    normal,
                    force,
                    rub: 0.0,
                    stiffness: faces.stiffness[index],
                    damping: faces.damping[index],
                    drag: 0.0,
                    secant: 0.0,
                    // −F × bend of the gap's level line: a seat holds a roller, a bulge sheds it.
                    across: -force * bend,
                    closing: touch.state.get(MemoryField::Closing, index),
                };
                if rubs {
                    // Its tangent turns with the normal.
                    element.rub = -faces.rub[index];
                    element.drag = faces.drag[index];
                    element.secant = faces.secant[index];
                }
                joint_state.apply(&element, element.push());
            }
        });
        wrench
    }

    /// Angular speeds of the circles on the teeth \[rad/s\], zero where they do not turn with their body.
    fn spin_of_circles(&self, at: Moment<'_>, posture: &Posture, spin: &mut Array) {
        spin.clear();
        spin.resize(posture.x.len(), 0.0);
        for (joint, spin) in spin.iter_mut().enumerate() {
            if let (Some(body), _) = self.bearer(joint, posture)
                && self.spins(Some(body))
            {
                *spin = at.v[3 * body + 2];
            }
        }
    }

    /// Whether the circle on the teeth turns with its body: a free roller, or a bush.
    fn spins(&self, body: Option<usize>) -> bool {
        let free = body.is_some_and(|body| body >= self.series.links);
        free || self.bush_turns
    }
}

/// Centre of the arc that a roller at `d` faces, from the origin of the frame.
fn pivot(d: Vector, normal: Vector, bend: f64) -> Vector {
    if bend.abs() > 0.0 {
        d + normal / bend
    } else {
        d
    }
}
