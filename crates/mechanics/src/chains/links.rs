//! The chain as rigid links: compiled, and its forces.
//!
//! ```text
//! q = [ x, y, φ of every link | x, y, φ of every free roller | sprockets, tensioners ]
//! ```
//!
//! x and y are those of the centres of mass. Joints and free rollers push through the contact of a pin in a
//! hole; ideal joints are held by the forces that keep their ends together. What wheels and guides
//! touch is the circle that runs on the teeth, as for the particle chain.

mod answers;
mod balance;
mod blocks;
pub(crate) mod build;
mod by_link;
mod drag;
mod equations;
mod free_rollers;
mod hinge;
mod ideal_joints;
mod implicit;
mod impulses;
mod inverse_blocks;
mod joint_torques;
mod meshing;
pub(crate) mod model;
mod observe;
mod posture;
pub(crate) mod rates;
mod reactions;
mod stiffness_sums;
mod tensions;
pub(crate) mod test_access;

use chaindrive_geometry::Vector;
use chaindrive_integrate::{Array, Moment};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

pub(crate) use blocks::BorderedBlocks;
pub(crate) use hinge::Hinges;
pub(crate) use impulses::Impulses;
pub(crate) use posture::{Posture, Shapes, free_part};

use crate::End;
use crate::bodies::Surroundings;
use crate::chains::series::Series;
use crate::contact::{BoreContact, ContactMemory, LaneTally, MemoryField, MemoryLanes, Tally};
use crate::energy::Flow;
use crate::joints::{
    Element, JointFindings, JointMates, JointMemory, Mate, Mount, Pairs, Part, Partner, Pins,
    contacts, cross, touch,
};
use crate::lanes::Wide;
use crate::seam::{Carried, Loads};

/// A body of the chain: a link, or a free roller.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Body {
    pub(crate) mass: f64,
    pub(crate) inertia: f64,
    /// Joint ends from the centre of mass, in the frame of the body \[m\].
    pub(crate) arms: [Vector; 2],
}

/// Rollers loose on their bushes.
#[derive(Clone, Debug)]
pub(crate) struct FreeRollers {
    pub(crate) bearing: BoreContact,
    /// Body of the roller at every joint.
    pub(crate) body: Vec<Option<usize>>,
}

/// Connection of neighbouring links.
#[derive(Clone, Debug)]
pub(crate) enum Joining {
    /// Ends held together.
    Hinges(Hinges),
    /// A pin in every bush.
    Clearance(Box<BoreContact>),
}

/// A chain of rigid links.
#[derive(Clone, Debug)]
pub(crate) struct Linkage {
    pub(crate) series: Series,
    pub(crate) bodies: Vec<Body>,
    /// The links among them, for lanes.
    pub(crate) shapes: Shapes,
    pub(crate) joints: Vec<JointMates>,
    pub(crate) pairs: Pairs,
    pub(crate) joining: Joining,
    /// Drag across the links per length \[N s/m²\].
    drag: f64,
    pub(crate) free_rollers: Option<FreeRollers>,
    /// Whether what runs on the teeth turns with its link: a bush.
    pub(crate) bush_turns: bool,
    /// Length without load, in nominal pitches a link.
    pub(crate) elongation: f64,
}

/// Roller arrays that the kernel of the teeth expects beside positions and velocities.
#[derive(Clone, Debug, Default)]
pub(crate) struct RollerArrays {
    /// Accelerations that it adds to, and inverse masses: of links neither is used.
    pub(crate) ax: Array,
    pub(crate) ay: Array,
    pub(crate) inverse_mass: Array,
    /// Angular speeds of the circles, where teeth rub \[rad/s\].
    pub(crate) spin: Array,
}

/// Joints, contacts and work space after one evaluation of a linkage.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct JointState {
    pub(crate) posture: Posture,
    /// Force and moment on every body \[N, N, N m\].
    pub(crate) forces: Vec<Vector3<f64>>,
    /// Pins in bushes with clearance.
    pub(crate) pins: Pins,
    /// Force on the pin of every ideal joint \[N\].
    pub(crate) hinge_forces: Vec<Vector>,
    /// All closed contacts, but those of pins in bushes.
    pub(crate) elements: Vec<Element>,
    pub(crate) mounts: Vec<Mount>,
    /// What the equations of the last step added to the forces.
    #[serde(skip)]
    pub(crate) carried: Carried,
    // Work space, filled anew before it is read.
    #[serde(skip)]
    pub(crate) equations: equations::Equations,
    #[serde(skip)]
    pub(crate) reactions: reactions::Reactions,
    #[serde(skip)]
    pub(crate) answers: ideal_joints::Answers,
    /// Forces on the links, and what ideal joints do to them.
    #[serde(skip)]
    pub(crate) loads: by_link::ByLink,
    /// Normal forces of pins in ideal joints without friction \[N\], whole lanes.
    #[serde(skip)]
    pub(crate) normal: Array,
    /// Stiffness, damping and springs of friction by body, for the time scales.
    #[serde(skip)]
    pub(crate) sums: stiffness_sums::StiffnessSums,
    /// Accelerations and inverse masses of particles, which the kernel of the teeth asks for and links have no use for.
    #[serde(skip)]
    pub(crate) idle: RollerArrays,
}

/// Findings and work space of an evaluation.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Work {
    pub(crate) joints: JointFindings,
    pub(crate) joint_state: JointState,
    #[serde(skip)]
    impulses: Impulses,
}

impl Linkage {
    /// Accelerations of the chain's bodies, and what wheels and rails feel.
    fn accelerate(
        &self,
        around: Surroundings<'_>,
        at: Moment<'_>,
        a: &mut [f64],
        rates: &mut [f64],
        (loads, work): (&mut Loads, &mut Work),
    ) {
        let Work {
            joints,
            joint_state,
            ..
        } = work;
        self.pose_links(at, &mut joint_state.posture);
        joint_state.elements.clear();
        joints.memory.time = at.t;
        joints.tallies = [
            self.joint_forces(at, rates, joint_state, &mut joints.memory.pins),
            Tally::new(),
        ];
        self.body_forces(around.bodies.gravity, joint_state);
        if self.drag > 0.0 {
            rates[Flow::DragLoss as usize] += self.drag_forces(joint_state);
        }
        self.roller_forces(at, rates, joint_state, joints);
        self.end_loads(rates, joint_state);
        self.mesh(around, at, rates, loads, joint_state);
        if matches!(self.joining, Joining::Hinges(_)) {
            Hinges::factor(self, joint_state);
        }
        if let Some(resisting) = &self.series.joints {
            self.resist(resisting, at, rates, joint_state, &mut joints.resistance);
        }
        if let Joining::Hinges(hinges) = &self.joining {
            hinges.hold(self, at, rates, joint_state);
        }
        let chain = a.chunks_exact_mut(3).zip(&joint_state.forces);
        for ((a, force), [mobility, turning]) in chain.zip(&self.shapes.mobilities) {
            a[0] = force.x * mobility;
            a[1] = force.y * mobility;
            a[2] = force.z * turning;
        }
    }

    /// Pins in their bushes; how contacts began.
    fn joint_forces(
        &self,
        at: Moment<'_>,
        rates: &mut [f64],
        joint_state: &mut JointState,
        memory: &mut ContactMemory,
    ) -> Tally {
        let Joining::Clearance(bearing) = &self.joining else {
            return Tally::new();
        };
        let dt = at.t - self.series.memory.time;
        let tally = self.series.registers.dispatch(contacts(
            joint_state.posture.sides(),
            &self.pairs,
            bearing,
            &self.series.memory.pins,
            memory,
            &mut joint_state.pins,
            dt,
        ));
        if self.series.is_closed() {
            joint_state.pins.close(self.series.links);
        } else {
            let push = |joint| joint_state.pins.push(joint);
            let part = |end| self.ground(end, at);
            // A push acts on what lies after its joint: on the chain at the first, on the support at the last.
            rates[Flow::Motions as usize] +=
                part(0).velocity.dot(&push(0)) - part(1).velocity.dot(&push(self.series.links));
        }
        rates[Flow::JointLoss as usize] += tally.normal_loss;
        rates[Flow::ArticulationLoss as usize] += tally.friction_loss;
        tally
    }

    /// Weight of all bodies, and what the pins do to the links.
    fn body_forces(&self, gravity: Vector, joint_state: &mut JointState) {
        joint_state.forces.clear();
        joint_state.forces.extend(
            self.bodies
                .iter()
                .map(|body| Vector3::new(body.mass * gravity.x, body.mass * gravity.y, 0.0)),
        );
        if matches!(self.joining, Joining::Clearance(_)) {
            let pins = &joint_state.pins;
            let pushes = pins.push_x.windows(2).zip(pins.push_y.windows(2));
            let moments = pins.moment_after.iter().zip(&pins.moment_before[1..]);
            let links = joint_state.forces[..self.series.links].iter_mut();
            for (force, ((x, y), (after, before))) in links.zip(pushes.zip(moments)) {
                force.x += x[0] - x[1];
                force.y += y[0] - y[1];
                force.z += after + before;
            }
        }
    }

    /// Bushes in their rollers.
    fn roller_forces(
        &self,
        at: Moment<'_>,
        rates: &mut [f64],
        joint_state: &mut JointState,
        found: &mut JointFindings,
    ) {
        let Some(free) = &self.free_rollers else {
            return;
        };
        let joints = self.joints.len();
        let (w, dt) = (Wide(pulp::Scalar), at.t - self.series.memory.time);
        let bushes = &mut found.memory.bushes;
        bushes.resize(joints);
        let mut memory = MemoryLanes::new(w, &self.series.memory.bushes, bushes, joints);
        let mut tally = LaneTally::new(w);
        for (index, joint) in self.joints.iter().enumerate() {
            let Some(body) = free.body[index] else {
                continue;
            };
            let bush = self.part(joint.carrier, at, &joint_state.posture);
            let roller = free_part(body, at);
            let parts = [&roller, &bush];
            let element = touch(
                &free.bearing,
                index,
                parts,
                &mut memory,
                index,
                dt,
                &mut tally,
            );
            if let Some(element) = element {
                joint_state.apply(&element, element.push());
            }
        }
        let tally = Tally::of(&tally);
        rates[Flow::RollerLoss as usize] += tally.normal_loss;
        rates[Flow::RollerFriction as usize] += tally.friction_loss;
        found.tallies[1] = tally;
    }

    /// Forces that pull at the ends of a strand.
    fn end_loads(&self, rates: &mut [f64], joint_state: &mut JointState) {
        for (index, held) in self.series.ends.iter().enumerate() {
            let End::Pulled { force } = &held.end else {
                continue;
            };
            let link = if index == 0 { 0 } else { self.series.links - 1 };
            let tip = joint_state.posture.tip(link, index);
            joint_state.forces[link] += Vector3::new(force.x, force.y, cross(tip.arm, *force));
            rates[Flow::DriveTorque as usize] += force.dot(&tip.velocity);
        }
    }

    /// Elastic energy of the joints \[J\].
    pub(crate) fn stored(&self, memory: &JointMemory) -> f64 {
        let registers = self.series.registers;
        let mut sum = 0.0;
        if let Joining::Clearance(bearing) = &self.joining {
            sum += bearing.stored(&memory.pins, registers);
        }
        if let Some(free) = &self.free_rollers {
            let gaps = memory.bushes.each(MemoryField::Gap);
            let closed = gaps.filter(|gap| *gap < 0.0);
            sum += closed.map(|gap| free.bearing.law.energy(-gap)).sum::<f64>();
        }
        sum
    }

    /// Energy of the friction of pins that stick in their bushes \[J\].
    pub(crate) fn stuck(&self, memory: &JointMemory) -> f64 {
        let Joining::Clearance(bearing) = &self.joining else {
            return 0.0;
        };
        let friction = &bearing.lanes.friction;
        let joints = &memory.pins;
        let state = |joint| {
            [MemoryField::Gap, MemoryField::Force, MemoryField::Stick]
                .map(|it| joints.get(it, joint))
        };
        let closed = (0..joints.len()).map(state).filter(|[gap, ..]| *gap < 0.0);
        // U = ½ k z²
        closed
            .map(|[_, force, z]| 0.5 * friction.stiffness(force) * z * z)
            .sum()
    }

    /// All closed contacts, those of pins in bushes first.
    pub(crate) fn each_element(&self, joint_state: &JointState, mut visit: impl FnMut(&Element)) {
        if let Joining::Clearance(bearing) = &self.joining {
            for joint in 0..self.joints.len() {
                let sides = joint_state.posture.sides();
                let pins = &joint_state.pins;
                let element = pins.element(joint, &self.joints[joint], bearing, sides);
                element.iter().for_each(&mut visit);
            }
        }
        joint_state.elements.iter().for_each(visit);
    }

    /// Force on the pin of a joint \[N\].
    pub(crate) fn pin_force(&self, joint_state: &JointState, joint: usize) -> Vector {
        match &self.joining {
            Joining::Hinges(_) => joint_state.hinge_forces[joint],
            Joining::Clearance(_) if self.pairs.pin_after(joint) => joint_state.pins.push(joint),
            Joining::Clearance(_) => -joint_state.pins.push(joint),
        }
    }
}

/// Power that a support moved in time puts into the chain \[W\].
fn supplied(mates: &[Mate; 2], push: Vector, hole: &Part, pin: &Part) -> f64 {
    let by = |mate: Mate, part: &Part, force: Vector| match mate {
        Mate::Ground(_) => force.dot(&part.velocity),
        Mate::Link { .. } => 0.0,
    };
    // The hole pushes the pin, and the pin the hole.
    by(mates[0], hole, push) + by(mates[1], pin, -push)
}

impl JointState {
    /// Applies a contact to the bodies it joins and keeps it for the implicit system.
    #[inline]
    pub(crate) fn apply(&mut self, element: &Element, push: Vector) {
        if let Some(body) = element.a {
            self.forces[body] += Vector3::new(push.x, push.y, element.moment_a(push));
        }
        if let Partner::Body(body) = element.b {
            self.forces[body] -= Vector3::new(push.x, push.y, -element.moment_b(push));
        }
        self.elements.push(*element);
    }
}
