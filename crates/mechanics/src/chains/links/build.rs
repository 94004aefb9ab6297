//! From the settled particle chain to rigid links in the same place.

use std::ops::Range;

use chaindrive_geometry::{Point, Vector};
use chaindrive_integrate::Moment;

use super::model::{Joint, RigidLinks, RollerModel};
use super::{Body, FreeRollers, Hinges, Joining, JointState, Linkage, Shapes};
use crate::bodies::{Bodies, GroupBodies};
use crate::chains::ChainAsLaid;
use crate::chains::as_laid::length_through;
use crate::chains::makeup::{Makeup, Statics};
use crate::chains::particles::Particles;
use crate::contact::BoreContact;
use crate::joints::{JointMates, JointMemory, Mate, Pairs, turned};
use crate::lanes::padded;
use crate::{Chain, End};

/// A chain of rigid links in the place of laid particles, with its coordinates and velocities.
pub(crate) struct Replacement {
    pub(crate) linkage: Linkage,
    pub(crate) q: Vec<f64>,
    pub(crate) v: Vec<f64>,
}

/// Puts rigid links where the particles are; `at` is the whole state, in which the particles stand at `entries`.
pub(crate) fn replace(
    particles: &Particles,
    entries: Range<usize>,
    bodies: GroupBodies<'_>,
    laid: &ChainAsLaid<'_>,
    links: &RigidLinks,
    at: Moment<'_>,
) -> Replacement {
    let (q, v) = (&at.q[entries.clone()], &at.v[entries]);
    let n = particles.series.stride;
    let inward = bush_shifts(particles, (bodies.all, laid.sprockets), links, at, q);
    let place = |k: usize| Point::new(q[k], q[n + k]) + inward[k];
    let velocity = |k: usize| Vector::new(v[k], v[n + k]);
    let count = particles.series.rollers;
    let mut linkage = compile(particles, laid, links);
    let laid_at: Vec<Point> = (0..count).map(|k| particles.place(q, k)).collect();
    let places: Vec<Point> = (0..count).map(place).collect();
    // Bushes at the bottom of their rollers run on a smaller circle: so much shorter is the chain that is as tight there.
    let change = length_through(&places, linkage.series.links)
        - length_through(&laid_at, linkage.series.links);
    linkage.lengthen(change / linkage.series.links as f64);
    let after = |link: usize| (link + 1) % count;
    if links.joint == Joint::Ideal && laid.on_route {
        // The chain was settled with links that hardly stretch; what is left of that is theirs.
        for link in 0..linkage.series.links {
            let length = (place(after(link)) - place(link)).norm();
            linkage.bodies[link] = body(links, link, length, 0.0);
        }
        linkage.shapes = Shapes::of(
            &linkage.bodies,
            linkage.series.links,
            linkage.series.is_closed(),
        );
    }
    let mut chain_q = Vec::with_capacity(linkage.coordinates());
    for (link, body) in linkage.bodies[..linkage.series.links].iter().enumerate() {
        let ends = [place(link), place(after(link))];
        let line = ends[1] - ends[0];
        let angle = line.y.atan2(line.x);
        let centre = nalgebra::center(&ends[0], &ends[1]) - to_middle(body, angle);
        chain_q.extend([centre.x, centre.y, angle]);
    }
    if let Some(free) = &linkage.free_rollers {
        for (joint, body) in free.body.iter().enumerate() {
            if body.is_some() {
                chain_q.extend([q[joint], q[n + joint], 0.0]);
            }
        }
    }
    let mut chain_v = vec![0.0; linkage.coordinates()];
    let velocities: Vec<Vector> = (0..count).map(velocity).collect();
    linkage.move_with(&places, &velocities, &mut chain_v);
    if !laid.on_route {
        // Along a route the links have taken the lengths that they were laid with.
        let mut whole = [chain_q, vec![0.0; bodies.count]].concat();
        linkage.close_in_place(at.t, bodies, &pulls(particles, &places), &mut whole);
        whole.truncate(linkage.coordinates());
        chain_q = whole;
    }
    Replacement {
        linkage,
        q: chain_q,
        v: chain_v,
    }
}

/// From the centre of mass to the middle between the joints.
fn to_middle(body: &Body, angle: f64) -> Vector {
    let (s, c) = angle.sin_cos();
    let middle = (body.arms[0] + body.arms[1]) * 0.5;
    Vector::new(c * middle.x - s * middle.y, s * middle.x + c * middle.y)
}

impl Linkage {
    /// Gives every link the motion of the rollers at its ends, and free rollers their own.
    pub(super) fn move_with(&self, places: &[Point], velocities: &[Vector], v: &mut [f64]) {
        let after = |link: usize| (link + 1) % places.len();
        let links = v.as_chunks_mut::<3>().0.iter_mut();
        for (link, (v, body)) in links.zip(&self.bodies[..self.series.links]).enumerate() {
            let speeds = [velocities[link], velocities[after(link)]];
            let line = places[after(link)] - places[link];
            // ω = ẑ·(d × u)/d²
            let spin = turned(line).dot(&(speeds[1] - speeds[0])) / line.norm_squared();
            let to_middle = to_middle(body, line.y.atan2(line.x));
            let moving = (speeds[0] + speeds[1]) * 0.5 - turned(to_middle) * spin;
            *v = [moving.x, moving.y, spin];
        }
        if let Some(free) = &self.free_rollers {
            for (velocity, body) in velocities.iter().zip(&free.body) {
                if let Some(body) = body {
                    v[3 * body..3 * body + 3].copy_from_slice(&[velocity.x, velocity.y, 0.0]);
                }
            }
        }
    }

    /// Moves joints to where they carry what the particles carried that the chain was laid as; links keep their lengths.
    ///
    /// Ideal joints close. Pins that were laid pressed into their bushes are seated in the direction of the pull T, as deep as it
    /// presses them; others stay where they were laid, since their play is free. Where links of their length do not reach, as in a
    /// straight strand between two supports, all stay.
    ///
    /// ```text
    /// after − before = (c + δ(|T|)) T/|T|
    /// ```
    fn close_in_place(&self, begin: f64, bodies: GroupBodies<'_>, pulls: &[Vector], q: &mut [f64]) {
        let laid = q.to_vec();
        let mut joint_state = JointState {
            hinge_forces: vec![Vector::zeros(); self.joints.len()],
            ..JointState::default()
        };
        let offsets = self.offsets(begin, q, &mut joint_state);
        let seats = self.seats(&offsets, pulls);
        // Newton's method, from a few thousandths of a pitch at most: three passes leave rounding.
        for _ in 0..PASSES {
            let offsets = self.offsets(begin, q, &mut joint_state);
            let apart: Vec<Vector> = seats.iter().zip(&offsets).map(|(s, o)| s - o).collect();
            if apart.iter().all(|apart| *apart == Vector::zeros()) {
                return;
            }
            let Some(change) = self.nearest(bodies, &mut joint_state, &apart, q.len()) else {
                break;
            };
            for (q, change) in q.iter_mut().zip(&change) {
                *q += change;
            }
        }
        let offsets = self.offsets(begin, q, &mut joint_state);
        let mut apart = seats.iter().zip(&offsets).map(|(s, o)| (s - o).norm());
        let reached = apart.all(|apart| apart < 1e-9 * self.series.pitch);
        if !reached && self.has_play() {
            q.copy_from_slice(&laid);
        }
    }

    /// From the middle of every hole to its pin.
    fn offsets(&self, begin: f64, q: &[f64], joint_state: &mut JointState) -> Vec<Vector> {
        let still = vec![0.0; q.len()];
        let at = Moment::stateless(begin, q, &still);
        self.pose_links(at, &mut joint_state.posture);
        let offset = |joint: &JointMates| {
            joint.pair.map_or_else(Vector::zeros, |mates| {
                let [hole, pin] = mates.map(|mate| self.part(mate, at, &joint_state.posture).place);
                pin - hole
            })
        };
        self.joints.iter().map(offset).collect()
    }

    /// Offset of every pin from the centre of its hole, from the layout and the pull on its joint.
    fn seats(&self, offsets: &[Vector], pulls: &[Vector]) -> Vec<Vector> {
        let Joining::Clearance(bearing) = &self.joining else {
            return vec![Vector::zeros(); offsets.len()];
        };
        let joints = offsets.iter().zip(pulls).enumerate();
        let seat = |(joint, (offset, pull)): (usize, (&Vector, &Vector))| {
            let sense = if self.pairs.pin_after(joint) {
                1.0
            } else {
                -1.0
            };
            let force = pull.norm();
            let pressed = offset.norm() > bearing.clearance && offset.dot(pull) * sense > 0.0;
            if pressed {
                pull * (sense * (bearing.clearance + bearing.indentation(force)) / force)
            } else {
                *offset
            }
        };
        joints.map(seat).collect()
    }

    /// Velocities of the chain and, after it, the bodies brought to where no hinge opens: what the stabilisation would otherwise
    /// take out of the chain in its first milliseconds.
    pub(super) fn close_velocities(
        &self,
        begin: f64,
        bodies: GroupBodies<'_>,
        q: &[f64],
        v: &mut [f64],
    ) {
        if matches!(self.joining, Joining::Clearance(_)) {
            return;
        }
        let mut joint_state = JointState::default();
        let at = Moment::stateless(begin, q, v);
        self.pose_links(at, &mut joint_state.posture);
        joint_state.hinge_forces = vec![Vector::zeros(); self.joints.len()];
        let opening = self.joints.iter().map(|joint| {
            joint.pair.map_or_else(Vector::zeros, |mates| {
                let [hole, pin] =
                    mates.map(|mate| self.part(mate, at, &joint_state.posture).velocity);
                hole - pin
            })
        });
        let opening: Vec<Vector> = opening.collect();
        if let Some(change) = self.nearest(bodies, &mut joint_state, &opening, v.len()) {
            for (v, change) in v.iter_mut().zip(&change) {
                *v += change;
            }
        }
    }
}

/// Passes of [`Linkage::close_in_place`].
const PASSES: usize = 4;

/// Pull of the laid particles on the side after every joint, from the side before \[N\]: the mean of both links, and at the ends of a
/// strand that of the only one.
fn pulls(particles: &Particles, places: &[Point]) -> Vec<Vector> {
    let count = particles.links.count;
    let pull = |link: usize| {
        let line = places[(link + 1) % places.len()] - places[link];
        // T = k (ℓ − p)
        let tension = particles.links.stiffness[link] * (line.norm() - particles.links.rest[link]);
        line.normalize() * tension
    };
    let joint = |joint: usize| match (joint, particles.links.closed) {
        (0, false) => pull(0),
        (last, false) if last == count => pull(count - 1),
        (joint, _) => (pull((joint + count - 1) % count) + pull(joint)) * 0.5,
    };
    (0..places.len()).map(joint).collect()
}

/// Shift of every bush from its particle \[m\] that the clearance of free rollers allows: on a wheel bushes lie deeper, in a span rollers
/// hang.
fn bush_shifts(
    particles: &Particles,
    (bodies, sprockets): (&Bodies, &[usize]),
    links: &RigidLinks,
    at: Moment<'_>,
    q: &[f64],
) -> Vec<Vector> {
    let count = particles.series.rollers;
    let RollerModel::Free(roller) = &links.rollers else {
        return vec![Vector::zeros(); count];
    };
    let seats: Vec<Option<Vector>> = (0..count)
        .map(|joint| {
            let place = particles.place(q, joint);
            let d = sprockets.iter().find_map(|&index| {
                let wheel = &bodies.wheels[index];
                let d = place - bodies.wheel_centre(index, at);
                let seat = wheel.pitch_radius.hypot(0.5 * wheel.pitch);
                (d.norm() < 0.5 * (wheel.pitch_radius + seat)).then_some(d)
            })?;
            Some(-d.normalize() * roller.gap())
        })
        .collect();
    // Linear between the wheels, so that the spans stay straight.
    let look = |from: usize, step: usize| {
        (1..count).find_map(|k| seats[(from + k * step) % count].map(|shift| (k, shift)))
    };
    let shifts = (0..count).map(|joint| {
        seats[joint].unwrap_or_else(|| match (look(joint, count - 1), look(joint, 1)) {
            (Some((before, a)), Some((after, b))) => {
                let share = before as f64 / (before + after) as f64;
                a * (1.0 - share) + b * share
            }
            _ => Vector::zeros(),
        })
    });
    shifts.collect()
}

fn compile(particles: &Particles, laid: &ChainAsLaid<'_>, links: &RigidLinks) -> Linkage {
    let ChainAsLaid {
        chain, pretension, ..
    } = *laid;
    let count = chain.links();
    let joining = match &links.joint {
        Joint::Ideal => Joining::Hinges(Hinges {
            rate: stabilisation(laid.gravity, chain.pitch),
        }),
        Joint::Clearance(joint) => Joining::Clearance(Box::new(BoreContact::new(
            &joint.surface,
            joint.bore_radius,
            joint.pin_radius,
        ))),
    };
    let joint_state = match &joining {
        Joining::Hinges(_) => 0.0,
        // c + δ(T₀)
        Joining::Clearance(bearing) => bearing.clearance + bearing.indentation(pretension),
    };
    let has_play = matches!(joining, Joining::Clearance(_));
    let mut bodies: Vec<Body> = (0..count)
        .map(|link| {
            // p (1 + ε₀) under T₀
            let spacing = particles.links.rest[link] + pretension / particles.links.stiffness[link];
            body(links, link, spacing, joint_state)
        })
        .collect();
    let joints: Vec<JointMates> = (0..chain.rollers())
        .map(|joint| mates(chain, links, joint))
        .collect();
    let free_rollers = match &links.rollers {
        RollerModel::Free(roller) => {
            let body = joints
                .iter()
                .map(|mates| {
                    let Mate::Link { link, .. } = mates.carrier else {
                        return None;
                    };
                    links.is_inner(link).then(|| {
                        bodies.push(Body {
                            mass: roller.mass,
                            inertia: roller.inertia,
                            arms: [Vector::zeros(); 2],
                        });
                        bodies.len() - 1
                    })
                })
                .collect();
            Some(FreeRollers {
                bearing: BoreContact::new(&roller.surface, roller.bore_radius, roller.bush_radius),
                body,
            })
        }
        RollerModel::Lumped { .. } | RollerModel::Bush => None,
    };
    Linkage {
        series: particles.series.with_contacts(
            chain,
            padded(joints.len()),
            JointMemory::open(
                0.0,
                [
                    if has_play { padded(joints.len()) } else { 0 },
                    free_rollers.as_ref().map_or(0, |_| joints.len()),
                ],
            ),
        ),
        shapes: Shapes::of(&bodies, count, chain.is_closed()),
        bodies,
        pairs: Pairs::of(&joints),
        drag: chain.drag,
        joints,
        joining,
        free_rollers,
        bush_turns: links.rollers == RollerModel::Bush,
        elongation: particles.elongation(),
    }
}

/// Rate of the stabilisation \[1/s\]: fast against the swinging of links, slow against contacts.
fn stabilisation(gravity: Vector, pitch: f64) -> f64 {
    // 30 √(g/p) and not less than 1000/s
    let swinging = (gravity.norm() / pitch).sqrt();
    (30.0 * swinging).max(1e3)
}

/// One link of given roller spacing.
fn body(links: &RigidLinks, link: usize, spacing: f64, joint_state: f64) -> Body {
    let inner = links.is_inner(link);
    let (own, length) = if inner {
        (&links.inner, spacing)
    } else {
        (&links.outer, spacing - 2.0 * joint_state)
    };
    let half = Vector::new(0.5 * length, 0.0);
    let roller = match links.rollers {
        RollerModel::Lumped { mass } if inner => mass,
        RollerModel::Lumped { .. } | RollerModel::Free(_) | RollerModel::Bush => 0.0,
    };
    let mass = own.mass + 2.0 * roller;
    let centre = own.centre * (own.mass / mass);
    let arms = [-half - centre, half - centre];
    // Steiner: I + m d² + m_r (r₀² + r₁²)
    let inertia = own.inertia
        + own.mass * (own.centre - centre).norm_squared()
        + roller * (arms[0].norm_squared() + arms[1].norm_squared());
    Body {
        mass,
        inertia,
        arms,
    }
}

/// Which link has the bush at a joint, and which the pin.
fn mates(chain: &Chain, links: &RigidLinks, joint: usize) -> JointMates {
    let count = chain.links();
    let before = if joint > 0 {
        Some(joint - 1)
    } else {
        chain.is_closed().then(|| count - 1)
    };
    let after = (joint < count).then_some(joint);
    let end = |link: usize| Mate::Link {
        link,
        end: usize::from(Some(link) != after),
    };
    match (before, after) {
        (Some(a), Some(b)) => {
            // The bush is on the inner link; where two of a kind meet, on the second.
            let (bush, pin) = if links.is_inner(a) && !links.is_inner(b) {
                (a, b)
            } else {
                (b, a)
            };
            JointMates {
                pair: Some([end(bush), end(pin)]),
                carrier: end(bush),
            }
        }
        (only, None) | (None, only) => {
            let link = only.unwrap_or(0);
            let side = usize::from(joint != 0);
            let held = match &chain.ends {
                crate::Ends::Open(ends) => {
                    matches!(ends[side], End::Fixed | End::Driven { .. })
                }
                crate::Ends::Closed => false,
            };
            let pair = held.then(|| {
                if links.is_inner(link) {
                    [end(link), Mate::Ground(side)]
                } else {
                    [Mate::Ground(side), end(link)]
                }
            });
            JointMates {
                pair,
                carrier: end(link),
            }
        }
    }
}
