//! Contact terms of the static balance, from the scalar form of the profiles.

use chaindrive_geometry::Vector;
use chaindrive_integrate::Moment;

use crate::System;
use crate::bodies::{Bodies, RailContact, RailSupport, Wheel, WheelSupport};
use crate::contact::{Contacts, Frame, PlateContact};
use crate::profile::Probe;
use crate::seam::{Moving, Sum, Way};
use crate::system::Member;

/// State entries that place a body: its angle, and what moves its centre.
#[derive(Clone, Default)]
pub(super) struct Mount {
    /// The entry, and how far the body turns with it.
    pub(super) angle: Option<(usize, f64)>,
    pub(super) centre: Vec<Way>,
}

/// Adds the energies of all closed contacts.
pub(super) fn add_contacts(system: &System, q: &[f64], sum: &mut Sum<'_>) {
    let still = vec![0.0; q.len()];
    let at = Moment::stateless(system.begin, q, &still);
    let bodies = &system.bodies;
    for member in &system.chains {
        for on in &member.contacts.teeth {
            let wheel = &bodies.wheels[on.wheel];
            let (frame, mount) = wheel_mount(bodies, wheel, at);
            let closed = add_circles(member, &on.contacts, &frame, &mount, q, sum);
            sum.balance.contacts[on.wheel] += closed;
        }
        for on in &member.contacts.rails {
            let frame = bodies.rail_frame(on.rail, at);
            let mount = rail_mount(bodies, on.rail, &frame, at);
            match &on.contact {
                RailContact::Circles(contacts) => {
                    add_circles(member, contacts, &frame, &mount, q, sum);
                }
                RailContact::Plates(plates) => add_plates(member, plates, &frame, &mount, q, sum),
            }
        }
    }
}

pub(super) fn wheel_mount(bodies: &Bodies, wheel: &Wheel, at: Moment<'_>) -> (Frame, Mount) {
    let kinematics = wheel.kinematics(at.t, at.q, at.v);
    let (origin, _, _) = wheel.centre_kinematics(at.t, at.q, at.v, &bodies.slides);
    let turn = [kinematics.position.cos(), kinematics.position.sin()];
    let frame = Frame {
        origin,
        eccentric: wheel.eccentric(turn),
        turn,
        velocity: Vector::zeros(),
        spin: 0.0,
    };
    let mut mount = Mount {
        angle: wheel.turn.turned_by(),
        ..Mount::default()
    };
    match &wheel.support {
        WheelSupport::Springs { dof, .. } => {
            let ways = Moving::free(origin, [*dof, dof + 1]);
            mount.centre = ways.ways().to_vec();
        }
        WheelSupport::Carried(index) => {
            let slide = &bodies.slides[*index];
            let way = slide.way(slide.pose(at.q, at.v), origin);
            mount.centre.extend(way);
        }
        WheelSupport::Fixed | WheelSupport::Prescribed { .. } => {}
    }
    (frame, mount)
}

fn rail_mount(bodies: &Bodies, rail: usize, frame: &Frame, at: Moment<'_>) -> Mount {
    let mut mount = Mount::default();
    if let RailSupport::Carried(index) = &bodies.rails[rail].support {
        let slide = &bodies.slides[*index];
        let way = slide.way(slide.pose(at.q, at.v), frame.origin);
        mount.centre.extend(way);
        mount.angle = slide.turn();
    }
    mount
}

fn add_circles(
    member: &Member,
    contacts: &Contacts,
    frame: &Frame,
    mount: &Mount,
    q: &[f64],
    sum: &mut Sum<'_>,
) -> usize {
    let own = &q[member.entries.clone()];
    let mut closed = 0;
    contacts.for_each_slot(|_, roller| {
        let moving = member.chain.roller_moving(own, roller);
        let circle = moving.behind(member.entries.start);
        for probe in contacts.probes(frame, roller, circle.place) {
            if probe.gap < 0.0 {
                closed += 1;
                let law = &contacts.surface.law;
                let mut push = Push {
                    force: law.elastic_force(-probe.gap),
                    stiffness: law.stiffness(-probe.gap),
                };
                if let Some(flank) = &contacts.flank {
                    let share = flank.share(probe.beyond);
                    let mix = |a: f64, b: f64| (1.0 - share) * a + share * b;
                    let depth = -probe.gap;
                    let law = flank.law(&contacts.surface);
                    push.force = mix(push.force, law.elastic_force(depth));
                    push.stiffness = mix(push.stiffness, law.stiffness(depth));
                }
                add_one(
                    &circle,
                    circle.place - frame.origin,
                    &probe,
                    push,
                    mount,
                    sum,
                );
            }
        }
    });
    closed
}

fn add_plates(
    member: &Member,
    plates: &PlateContact,
    frame: &Frame,
    mount: &Mount,
    q: &[f64],
    sum: &mut Sum<'_>,
) {
    let own = &q[member.entries.clone()];
    for link in 0..member.chain.links() {
        let pins = [0, 1].map(|end| {
            let pin = member.chain.pin_moving(own, link, end);
            pin.behind(member.entries.start)
        });
        let [a, b] = pins.map(|pin| frame.local(pin.place, plates.reference));
        let mut point = plates.nearest(a, b);
        if point.probe.gap >= 0.0 {
            continue;
        }
        let law = &plates.surface.law;
        let push = Push {
            force: point.weight * law.elastic_force(-point.probe.gap),
            stiffness: point.weight * law.stiffness(-point.probe.gap),
        };
        point.probe.normal = frame.outward(point.probe.normal);
        let d = (pins[0].place - frame.origin) * (1.0 - point.share)
            + (pins[1].place - frame.origin) * point.share;
        if point.share > 0.0 && point.share < 1.0 {
            let edge = Edge {
                pins,
                share: point.share,
                d,
            };
            add_edge(&edge, &point.probe, push, mount, sum);
        } else {
            let eye = &pins[usize::from(point.share > 0.5)];
            add_one(eye, d, &point.probe, push, mount, sum);
        }
    }
}

/// One state entry: how it moves the touching point, the line and the frame.
struct Move {
    entry: usize,
    shift: Vector,
    relative: Vector,
    line_turn: f64,
    frame_turn: f64,
}

/// A plate that touches a rail between its pins.
struct Edge {
    pins: [Moving; 2],
    share: f64,
    /// Touching point on the pin line, from the frame's origin.
    d: Vector,
}

/// Adds the contact of a straight edge that rolls on a bulging face.
///
/// ```text
/// D = distance of the pin line from the arc's centre, dφ its rotation, P the touching point
/// d²D = −2 dφ (u·dP) − D dφ²,     u along the line, ẑ × u = n
/// ```
///
/// A frame that turns by dθ adds 2 dθ (ẑ×n)·dP − dθ² n·d to the second variation.
fn add_edge(edge: &Edge, probe: &Probe, push: Push, mount: &Mount, sum: &mut Sum<'_>) {
    let normal = probe.normal;
    let u = Vector::new(normal.y, -normal.x);
    let across = Vector::new(-normal.y, normal.x);
    let distance = 1.0 / probe.bend;
    let line = edge.pins[1].place - edge.pins[0].place;
    let length = line.norm();
    let perpendicular = Vector::new(-line.y, line.x) / (length * length);
    let around = Vector::new(-edge.d.y, edge.d.x);
    let shares = [1.0 - edge.share, edge.share];

    let mut moves = Vec::new();
    for (k, (pin, share)) in edge.pins.iter().zip(shares).enumerate() {
        for way in pin.ways() {
            let turn = perpendicular.dot(&way.first) * if k == 0 { -1.0 } else { 1.0 };
            moves.push(Move {
                entry: way.entry,
                shift: way.first * share,
                relative: way.first * share,
                line_turn: turn,
                frame_turn: 0.0,
            });
        }
    }
    for way in &mount.centre {
        moves.push(Move {
            entry: way.entry,
            shift: -way.first,
            relative: -way.first,
            line_turn: 0.0,
            frame_turn: 0.0,
        });
    }
    if let Some((entry, ratio)) = mount.angle {
        moves.push(Move {
            entry,
            shift: Vector::zeros(),
            relative: -around * ratio,
            line_turn: -ratio,
            frame_turn: ratio,
        });
    }
    for a in &moves {
        // δ = −g: a motion along the normal opens the gap
        let slope = -normal.dot(&a.relative);
        sum.force(a.entry, push.force * slope);
        for b in &moves {
            let gap = -(a.line_turn * u.dot(&b.relative) + b.line_turn * u.dot(&a.relative))
                - distance * a.line_turn * b.line_turn
                + a.frame_turn * across.dot(&b.shift)
                + b.frame_turn * across.dot(&a.shift)
                - a.frame_turn * b.frame_turn * normal.dot(&edge.d);
            let other = -normal.dot(&b.relative);
            sum.stiffen(
                a.entry,
                b.entry,
                push.stiffness * slope * other - push.force * gap,
            );
        }
    }
    for (pin, share) in edge.pins.iter().zip(shares) {
        for way in pin.ways().iter().filter(|way| way.bends()) {
            let opening = normal.dot(&way.second) * share;
            sum.stiffen(way.entry, way.entry, -push.force * opening);
        }
    }
    for way in &mount.centre {
        sum.stiffen(way.entry, way.entry, push.force * normal.dot(&way.second));
    }
}

/// Elastic force and tangent stiffness of one contact.
#[derive(Clone, Copy)]
struct Push {
    force: f64,
    stiffness: f64,
}

/// Adds one contact: g(δ) J Jᵀ′ and the geometric terms.
///
/// ```text
/// J = ∂δ/∂(x, y, θ, c) = (m, −m·(ẑ×d), −m),    m = −n
/// H = k J Jᵀ + F S,   S_xx = κ t tᵀ,   S_xθ = ẑ×m − κ (t·ẑ×d) t,   S_θθ = κ (t·ẑ×d)² − m·d
/// ```
fn add_one(
    circle: &Moving,
    d: Vector,
    probe: &Probe,
    push: Push,
    mount: &Mount,
    sum: &mut Sum<'_>,
) {
    let m = -probe.normal;
    let t = Vector::new(-m.y, m.x);
    let kappa = -probe.bend;
    let around = Vector::new(-d.y, d.x);
    let lever = t.dot(&around);

    // Entries that move the contact: gradient of δ, and coefficients of (x, θ) for the geometry.
    let mut moves: Vec<(usize, f64, Vector, f64)> = Vec::new();
    for way in circle.ways() {
        moves.push((way.entry, m.dot(&way.first), way.first, 0.0));
    }
    for way in &mount.centre {
        moves.push((way.entry, -m.dot(&way.first), -way.first, 0.0));
    }
    if let Some((entry, ratio)) = mount.angle {
        moves.push((entry, -m.dot(&around) * ratio, Vector::zeros(), ratio));
    }
    let mixed = t * (1.0 - kappa * lever);
    let twice = kappa * lever * lever - m.dot(&d);
    for (entry, slope, shift, turn) in &moves {
        sum.force(*entry, push.force * slope);
        for (other, other_slope, other_shift, other_turn) in &moves {
            let geometry = kappa * t.dot(shift) * t.dot(other_shift)
                + mixed.dot(shift) * other_turn
                + mixed.dot(other_shift) * turn
                + twice * turn * other_turn;
            sum.stiffen(
                *entry,
                *other,
                push.stiffness * slope * other_slope + push.force * geometry,
            );
        }
    }
    for way in circle.ways().iter().filter(|way| way.bends()) {
        sum.stiffen(way.entry, way.entry, push.force * m.dot(&way.second));
    }
    for way in &mount.centre {
        sum.stiffen(way.entry, way.entry, -push.force * m.dot(&way.second));
    }
}
