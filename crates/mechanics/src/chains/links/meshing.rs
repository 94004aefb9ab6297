//! Rollers of a linkage on teeth and guides.

use chaindrive_contact::{Approach, Friction, Law, Prepared, Response, interpolated_onset};
use chaindrive_geometry::{Point, Vector};
use chaindrive_integrate::Moment;
use pulp::{Simd, WithSimd};

use super::{Element, Linkage, Mount, Part, Partner, Play, Tally, turned};
use crate::chains::{Loads, Rollers, Surroundings};
use crate::contact::{Contacts, Frame, Touch, Wrench};
use crate::energy::Flow;
use crate::lanes::{Wide, dispatch};
use crate::system::{Bodies, RailContact, RailSupport, Wheel, WheelRotation, WheelSupport};
use crate::{Carrier, Flank};

impl Linkage {
    /// Contacts with wheels and rails.
    pub(super) fn mesh(
        &self,
        around: Surroundings<'_>,
        at: Moment<'_>,
        rates: &mut [f64],
        loads: &mut Loads,
        play: &mut Play,
    ) {
        let Surroundings { bodies, contacts } = around;
        play.mounts.clear();
        for (i, on) in contacts.teeth.iter().enumerate() {
            let frame = loads.frames[i];
            let mount = self.wheel_mount(bodies, &bodies.wheels[on.wheel], &frame);
            play.mounts.push(mount);
            let touch = &mut loads.teeth[i];
            let wrench = self.roll(&on.contacts, &frame, i, at, touch, play);
            rates[Flow::ToothLoss as usize] += wrench.normal_loss;
            rates[Flow::FrictionLoss as usize] += wrench.friction_loss;
            loads.wheel_wrenches[i] = wrench;
        }
        for (i, on) in contacts.rails.iter().enumerate() {
            let number = contacts.teeth.len() + i;
            let frame = loads.frames[number];
            let mount = self.rail_mount(bodies, &bodies.rails[on.rail].support);
            play.mounts.push(mount);
            let wrench = match &on.contact {
                RailContact::Circles(contacts) => {
                    let touch = &mut loads.circles[i];
                    self.roll(contacts, &frame, number, at, touch, play)
                }
                RailContact::Plates(plates) => {
                    let mut pins = super::rates::LinkPins(play);
                    plates.act(at.t, &frame, &mut pins, self.links, &mut loads.plates[i])
                }
            };
            rates[Flow::GuideLoss as usize] += wrench.normal_loss;
            rates[Flow::FrictionLoss as usize] += wrench.friction_loss;
            loads.rail_wrenches[i] = wrench;
        }
    }

    fn wheel_mount(&self, bodies: &Bodies, wheel: &Wheel, frame: &Frame) -> Mount {
        let border = |dof: usize| self.border(bodies, dof);
        let turn = match wheel.rotation {
            WheelRotation::Free { dof, .. } => Some(border(dof)),
            WheelRotation::Prescribed(_) => None,
        };
        let shifts = match &wheel.support {
            WheelSupport::Fixed | WheelSupport::Prescribed { .. } => [None; 2],
            WheelSupport::Springs { dof, .. } => [
                Some((border(*dof), Vector::x())),
                Some((border(dof + 1), Vector::y())),
            ],
            WheelSupport::Carried(index) => {
                let slide = &bodies.slides[*index];
                let shift = match &slide.carrier {
                    Carrier::Slider { direction } => *direction,
                    Carrier::Arm { pivot, .. } => turned(frame.origin - pivot),
                };
                [slide.dof.map(|dof| (border(dof), shift)), None]
            }
        };
        Mount { shifts, turn }
    }

    fn rail_mount(&self, bodies: &Bodies, support: &RailSupport) -> Mount {
        let mut mount = Mount {
            shifts: [None; 2],
            turn: None,
        };
        if let RailSupport::Carried(index) = support {
            let slide = &bodies.slides[*index];
            if let Some(dof) = slide.dof {
                match &slide.carrier {
                    Carrier::Slider { direction } => {
                        mount.shifts[0] = Some((self.border(bodies, dof), *direction));
                    }
                    // The frame of a rail on an arm has the pivot as its origin.
                    Carrier::Arm { .. } => mount.turn = Some(self.border(bodies, dof)),
                }
            }
        }
        mount
    }
}

/// The contacts of one wheel or rail as one call that is compiled for every kind of processor.
struct Touching<'a> {
    contacts: &'a Contacts,
    frame: &'a Frame,
    t: f64,
    rollers: Rollers<'a>,
    touch: &'a mut Touch,
}

impl WithSimd for Touching<'_> {
    type Output = Wrench;

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) -> Wrench {
        self.contacts.act(
            Wide(simd),
            self.t,
            self.frame,
            &mut self.rollers,
            self.touch,
        )
    }
}

impl Linkage {
    /// All contacts of the rollers with one wheel or rail.
    fn roll(
        &self,
        contacts: &Contacts,
        frame: &Frame,
        mount: usize,
        at: Moment<'_>,
        touch: &mut Touch,
        play: &mut Play,
    ) -> Wrench {
        if contacts.surface.friction == Friction::None {
            self.roll_freely(contacts, frame, mount, at, touch, play)
        } else {
            self.roll_and_rub(contacts, frame, mount, at, touch, play)
        }
    }

    /// Without friction: all rollers at once.
    fn roll_freely(
        &self,
        contacts: &Contacts,
        frame: &Frame,
        mount: usize,
        at: Moment<'_>,
        touch: &mut Touch,
        play: &mut Play,
    ) -> Wrench {
        let posture = &play.posture;
        let [ax, ay, inverse_mass] = &mut play.idle;
        for values in [&mut *ax, ay, inverse_mass] {
            values.resize(posture.x.len(), 0.0);
        }
        let wrench = dispatch(
            self.arch,
            Touching {
                contacts,
                frame,
                t: at.t,
                rollers: Rollers {
                    x: &posture.x,
                    y: &posture.y,
                    vx: &posture.vx,
                    vy: &posture.vy,
                    ax,
                    ay,
                    inverse_mass,
                },
                touch,
            },
        );
        contacts.for_each_slot(|slot, joint| {
            for side in 0..contacts.sides() {
                let index = side * contacts.slots + slot;
                if touch.inverse_onset[index] <= 0.0 {
                    continue;
                }
                let faces = &touch.faces;
                let d = Point::new(play.posture.x[joint], play.posture.y[joint]) - frame.origin;
                let (body, arm) = self.bearer(joint, &play.posture);
                // Elements look from the surface's material outward through the roller: n = −n_surface.
                let normal = -Vector::new(faces.normal_x[index], faces.normal_y[index]);
                let (force, bend) = (touch.force[index], faces.bend[index]);
                let element = Element {
                    joint: joint % self.joints.len(),
                    a: body,
                    b: Partner::Mount(mount),
                    arm_a: arm,
                    arm_b: d,
                    pivot_b: pivot(d, normal, bend),
                    lever_a: 0.0,
                    lever_b: contacts.radius,
                    normal,
                    force,
                    rub: 0.0,
                    stiffness: faces.stiffness[index],
                    damping: faces.damping[index],
                    drag: 0.0,
                    secant: 0.0,
                    // −F × bend of the gap's level line: a seat holds a roller, a bulge sheds it.
                    across: -force * bend,
                };
                play.apply(&element, normal * -force);
            }
        });
        wrench
    }

    /// With friction, one roller after the other.
    fn roll_and_rub(
        &self,
        contacts: &Contacts,
        frame: &Frame,
        mount: usize,
        at: Moment<'_>,
        touch: &mut Touch,
        play: &mut Play,
    ) -> Wrench {
        let slots = contacts.slots;
        touch.open(slots * contacts.sides());
        let law = ToothLaw::new(contacts);
        let floor = contacts.surface.floor();
        let mut wrench = Wrench {
            first_share: 1.0,
            ..Wrench::default()
        };
        let mut tally = Tally::new();
        contacts.for_each_slot(|slot, joint| {
            let place = Point::new(play.posture.x[joint], play.posture.y[joint]);
            let faces = contacts.faces(frame, slot, place);
            for (side, probe) in faces.into_iter().enumerate() {
                let Some(probe) = probe else { continue };
                let index = side * slots + slot;
                let part = self.roller(joint, at, &play.posture);
                let d = place - frame.origin;
                // u = v − v_o − ω ẑ × d
                let relative = part.velocity - frame.velocity - turned(d) * frame.spin;
                // Elements look from the surface's material outward through the roller: n = −n_surface.
                let normal = -probe.normal;
                let closing = normal.dot(&relative);
                touch.gap[index] = probe.gap;
                touch.closing[index] = closing;
                if probe.gap >= 0.0 {
                    continue;
                }
                let depth = -probe.gap;
                let memory = &contacts.memory;
                let mut inverse = memory.inverse_onset[index];
                if inverse <= 0.0 {
                    let (gap, rate) = (memory.gap[index], memory.closing[index]);
                    let onset = interpolated_onset(gap, rate, probe.gap, closing);
                    inverse = 1.0 / onset.max(floor);
                    tally.began(gap, depth);
                }
                touch.inverse_onset[index] = inverse;
                let approach = Approach {
                    penetration: depth,
                    rate: closing,
                    onset_rate: 1.0 / inverse,
                };
                let answer = law.respond(approach, probe.beyond, &mut touch.share[index]);
                touch.force[index] = answer.force;
                tally.normal_loss += (answer.force - answer.elastic) * closing;
                let spins = self.spins(&part);
                let radius = contacts.radius;
                let mut element = Element {
                    joint: joint % self.joints.len(),
                    a: part.body,
                    b: Partner::Mount(mount),
                    arm_a: part.arm,
                    arm_b: d,
                    pivot_b: pivot(d, normal, probe.bend),
                    lever_a: if spins { radius } else { 0.0 },
                    lever_b: radius,
                    normal,
                    force: answer.force,
                    rub: 0.0,
                    stiffness: answer.stiffness,
                    damping: answer.damping,
                    drag: 0.0,
                    secant: 0.0,
                    // −F × bend of the gap's level line: a seat holds a roller, a bulge sheds it.
                    across: -answer.force * probe.bend,
                };
                let friction = &contacts.surface.friction;
                if *friction != Friction::None {
                    let slip = turned(normal).dot(&relative) + element.lever_a * part.spin
                        - element.lever_b * frame.spin;
                    let before = memory.stick[index];
                    let rub = friction.rub(answer.force, slip, before, at.t - contacts.accepted);
                    touch.stick[index] = rub.state;
                    element.rub(friction, rub, slip);
                    tally.friction_loss -= rub.force * slip;
                }
                let push = element.push();
                wrench.force[0] -= push.x;
                wrench.force[1] -= push.y;
                wrench.moment += element.moment_b(push);
                wrench.depth = wrench.depth.max(depth);
                wrench.damping = wrench.damping.max(answer.damping + element.drag);
                play.apply(&element, push);
            }
        });
        wrench.normal_loss = tally.normal_loss;
        wrench.friction_loss = tally.friction_loss;
        wrench.first_depth = tally.first_depth;
        wrench.first_share = tally.first_share;
        wrench
    }

    /// Whether the circle on the teeth turns with its body: a free roller, or a bush.
    fn spins(&self, part: &Part) -> bool {
        let free = part.body.is_some_and(|body| body >= self.links);
        free || self.bush_turns
    }
}

/// The law of a seat, and of the flank behind it.
struct ToothLaw {
    seat: Prepared,
    flank: Option<(Flank, Prepared)>,
}

impl ToothLaw {
    fn new(contacts: &Contacts) -> Self {
        let seat = contacts.surface.law;
        let flank = contacts.flank.map(|flank| {
            let law = Law {
                elastic: flank.elastic,
                ..seat
            };
            (flank, law.prepared())
        });
        Self {
            seat: seat.prepared(),
            flank,
        }
    }

    /// Answer at a distance beyond the end of the hollow; writes down the flank's share.
    #[inline]
    fn respond(&self, approach: Approach, beyond: f64, share: &mut f64) -> Response {
        let Some((flank, law)) = &self.flank else {
            return self.seat.respond(approach);
        };
        *share = flank.share(beyond);
        // Between the two there is little way; most contacts need one law only.
        if *share <= 0.0 {
            self.seat.respond(approach)
        } else if *share >= 1.0 {
            law.respond(approach)
        } else {
            between(self.seat.respond(approach), law.respond(approach), *share)
        }
    }
}

/// Part of one answer and part of another.
fn between(seat: Response, flank: Response, share: f64) -> Response {
    let mix = |a: f64, b: f64| (1.0 - share) * a + share * b;
    Response {
        force: mix(seat.force, flank.force),
        elastic: mix(seat.elastic, flank.elastic),
        stiffness: mix(seat.stiffness, flank.stiffness),
        damping: mix(seat.damping, flank.damping),
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chains::links::tests::{kinds, of, set_off};

    /// Without friction both ways must find the same contacts.
    #[test]
    fn all_at_once_is_as_one_by_one() {
        for (kind, parts) in kinds()
            .into_iter()
            .filter(|(kind, _)| kind.ends_with("rollers, smooth"))
        {
            let (system, mut record, q, v) = set_off(parts);
            let linkage = of(&system);
            let at = Moment {
                t: 0.0,
                q: &q,
                v: &v,
            };
            let mut play = record.chains[0].play.clone();
            for (i, on) in system.chains[0].contacts.teeth.iter().enumerate() {
                let frame = system.bodies.wheel_frame(on.wheel, &on.anchor, at);
                let mut found = |freely: bool| {
                    play.elements.clear();
                    let touch = &mut record.chains[0].loads.teeth[i];
                    let contacts = &on.contacts;
                    let wrench = if freely {
                        linkage.roll_freely(contacts, &frame, i, at, touch, &mut play)
                    } else {
                        linkage.roll_and_rub(contacts, &frame, i, at, touch, &mut play)
                    };
                    play.elements.sort_by_key(|element| element.joint);
                    (wrench, play.elements.clone())
                };
                let (wrench, elements) = found(true);
                let (other, others) = found(false);
                assert!(elements.len() > 4, "{kind}, {i}");
                assert_eq!(elements.len(), others.len(), "{kind}, {i}");
                let size = elements.iter().fold(0.0_f64, |m, e| m.max(e.force));
                let near = |a: f64, b: f64, size: f64| (a - b).abs() <= 1e-11 * size.max(b.abs());
                assert!(
                    near(wrench.moment, other.moment, 1e-2 * size),
                    "{kind}, {i}"
                );
                assert!(near(wrench.depth, other.depth, 0.0), "{kind}, {i}");
                for (a, b) in elements.iter().zip(&others) {
                    assert_eq!((a.joint, a.a, a.b), (b.joint, b.a, b.b));
                    for (a, b, size) in [
                        (a.force, b.force, size),
                        (a.stiffness, b.stiffness, 0.0),
                        (a.damping, b.damping, 0.0),
                        (a.across, b.across, 0.0),
                        (a.normal.x, b.normal.x, 1.0),
                        (a.normal.y, b.normal.y, 1.0),
                        (a.pivot_b.x, b.pivot_b.x, 1.0),
                        (a.pivot_b.y, b.pivot_b.y, 1.0),
                    ] {
                        assert!(near(a, b, size), "{kind}, {i}: {a} {b}");
                    }
                }
            }
        }
    }
}
