//! From the settled particle chain to rigid links in the same place.

use chaindrive_geometry::{Point, Vector};
use chaindrive_integrate::Moment;
use pulp::Arch;

use super::{
    Bearing, Body, FreeRollers, Hinges, Joining, JointMates, Linkage, Mate, Memory, Pairs, Play,
    Shapes, turned,
};
use crate::End;
use crate::chain::Chain;
use crate::contact::ContactMemory;
use crate::drive::{Layout, Parts};
use crate::lanes::padded;
use crate::rigid::{Joint, RigidLinks, RollerModel};
use crate::system::{RailContact, System, WheelRotation, WheelSupport};

/// Coordinates and velocities of a converted system.
pub(crate) struct Converted {
    pub(crate) system: System,
    pub(crate) q: Vec<f64>,
    pub(crate) v: Vec<f64>,
}

impl Converted {
    /// Brings the velocities to where no hinge opens: what the stabilisation would otherwise take out of the
    /// chain in its first milliseconds.
    pub(crate) fn close_in_motion(&mut self) {
        let Some(linkage) = &self.system.linkage else {
            return;
        };
        let mut play = Play::default();
        let at = Moment {
            t: 0.0,
            q: &self.q,
            v: &self.v,
        };
        linkage.pose(at, &mut play.posture);
        play.hinge_forces = vec![Vector::zeros(); linkage.joints.len()];
        let mut v = self.v.clone();
        if linkage.project(&self.system, at, &mut play, &mut v) {
            self.v = v;
        }
    }
}

/// Replaces the particle chain of an assembled system by its rigid links.
pub(crate) fn convert(
    mut system: System,
    parts: &Parts,
    links: &RigidLinks,
    q: &[f64],
    v: &[f64],
) -> Converted {
    let n = system.stride;
    let (inward, shorter) = bush_shifts(&system, links, q);
    let place = |k: usize| Point::new(q[k], q[n + k]) + inward[k];
    let velocity = |k: usize| Vector::new(v[k], v[n + k]);
    let count = system.rollers;
    let mut linkage = compile(&system, parts, links);
    linkage.lengthen(-shorter / linkage.links as f64);
    let after = |link: usize| (link + 1) % count;
    if links.joint == Joint::Ideal && matches!(parts.layout, Layout::Route { .. }) {
        // The chain was settled with links that hardly stretch; what is left of that is theirs.
        for link in 0..linkage.links {
            let length = (place(after(link)) - place(link)).norm();
            linkage.bodies[link] = body(links, link, length, 0.0);
        }
        linkage.shapes = Shapes::of(&linkage.bodies, linkage.links, linkage.closed);
    }
    let mut chain_q = Vec::with_capacity(linkage.dofs());
    let mut chain_v = Vec::with_capacity(linkage.dofs());
    for (link, body) in linkage.bodies[..linkage.links].iter().enumerate() {
        let ends = [place(link), place(after(link))];
        let speeds = [velocity(link), velocity(after(link))];
        let line = ends[1] - ends[0];
        let angle = line.y.atan2(line.x);
        let (s, c) = angle.sin_cos();
        // The middle of the link lies between its joints, the centre of mass beside it.
        let to_middle = (body.arms[0] + body.arms[1]) * 0.5;
        let to_middle = Vector::new(
            c * to_middle.x - s * to_middle.y,
            s * to_middle.x + c * to_middle.y,
        );
        let middle = nalgebra::center(&ends[0], &ends[1]);
        let centre = middle - to_middle;
        // ω = ẑ·(d × u)/d²
        let spin = turned(line).dot(&(speeds[1] - speeds[0])) / line.norm_squared();
        let moving = (speeds[0] + speeds[1]) * 0.5 - turned(to_middle) * spin;
        chain_q.extend([centre.x, centre.y, angle]);
        chain_v.extend([moving.x, moving.y, spin]);
    }
    if let Some(free) = &linkage.free_rollers {
        for (joint, body) in free.body.iter().enumerate() {
            if body.is_some() {
                chain_q.extend([q[joint], q[n + joint], 0.0]);
                chain_v.extend([v[joint], v[n + joint], 0.0]);
            }
        }
    }
    let old = 2 * n;
    let new = linkage.dofs();
    let inertias = system.inertias();
    system.border_inertias = inertias[old..].to_vec();
    shift_dofs(&mut system, old, new);
    chain_q.extend_from_slice(&q[old..]);
    chain_v.extend_from_slice(&v[old..]);
    system.dofs = chain_q.len();
    for wheel in &mut system.wheels {
        wheel.contacts.for_links = true;
    }
    for rail in &mut system.rails {
        if let RailContact::Circles(contacts) = &mut rail.contact {
            contacts.for_links = true;
        }
    }
    system.linkage = Some(linkage);
    Converted {
        system,
        q: chain_q,
        v: chain_v,
    }
}

/// Where free rollers let the bushes be: on a wheel they lie deeper by the clearance, in a span the rollers
/// hang. Returns the shift of every bush from the particle, and by how much their way around the
/// wheels is shorter \[m\].
fn bush_shifts(system: &System, links: &RigidLinks, q: &[f64]) -> (Vec<Vector>, f64) {
    let count = system.rollers;
    let RollerModel::Free(roller) = &links.rollers else {
        return (vec![Vector::zeros(); count], 0.0);
    };
    let still = vec![0.0; q.len()];
    let at = Moment {
        t: 0.0,
        q,
        v: &still,
    };
    let mut shorter = 0.0;
    let seats: Vec<Option<Vector>> = (0..count)
        .map(|joint| {
            let place = Point::new(q[joint], q[system.stride + joint]);
            let (wheel, d) = system.wheels.iter().find_map(|wheel| {
                let (frame, _, _) = system.wheel_frame(wheel, at);
                let d = place - frame.origin;
                let seat = wheel.pitch_radius.hypot(0.5 * wheel.pitch);
                (d.norm() < 0.5 * (wheel.pitch_radius + seat)).then_some((wheel, d))
            })?;
            shorter += roller.gap() * std::f64::consts::TAU / f64::from(wheel.teeth);
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
    (shifts.collect(), shorter)
}

/// Moves the degrees of freedom of wheels and tensioners behind another chain.
fn shift_dofs(system: &mut System, old: usize, new: usize) {
    let shift = |dof: &mut usize| *dof = *dof - old + new;
    for wheel in &mut system.wheels {
        if let WheelRotation::Free { dof, .. } = &mut wheel.rotation {
            shift(dof);
        }
        if let WheelSupport::Springs { dof, .. } = &mut wheel.support {
            shift(dof);
        }
    }
    for slide in &mut system.slides {
        if let Some(dof) = &mut slide.dof {
            shift(dof);
        }
    }
}

fn compile(system: &System, parts: &Parts, links: &RigidLinks) -> Linkage {
    let chain = &parts.chain;
    let count = chain.links();
    let pretension = match &parts.layout {
        Layout::Route { fit, .. } => fit.pretension,
        Layout::Points { .. } => 0.0,
    };
    let joining = match &links.joint {
        Joint::Ideal => Joining::Hinges(Hinges {
            rate: stabilisation(parts),
        }),
        Joint::Clearance(joint) => Joining::Clearance(Box::new(Bearing::new(
            &joint.surface,
            joint.bore_radius,
            joint.pin_radius,
        ))),
    };
    let play = match &joining {
        Joining::Hinges(_) => 0.0,
        // c + δ(T₀)
        Joining::Clearance(bearing) => bearing.clearance + bearing.indentation(pretension),
    };
    let mut bodies: Vec<Body> = (0..count)
        .map(|link| {
            // p (1 + ε₀) under T₀
            let spacing = system.links.rest[link] + pretension / system.links.stiffness[link];
            body(links, link, spacing, play)
        })
        .collect();
    let joints: Vec<JointMates> = (0..chain.rollers())
        .map(|joint| mates(chain, links, joint))
        .collect();
    let free_rollers = match &links.rollers {
        RollerModel::Free(roller) => {
            let mut link_of = Vec::new();
            let body = joints
                .iter()
                .map(|mates| {
                    let Mate::Link { link, .. } = mates.carrier else {
                        return None;
                    };
                    links.is_inner(link).then(|| {
                        link_of.push(link);
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
                bearing: Bearing::new(&roller.surface, roller.bore_radius, roller.bush_radius),
                body,
                link: link_of,
            })
        }
        RollerModel::Lumped { .. } | RollerModel::Bush => None,
    };
    Linkage {
        links: count,
        closed: chain.is_closed(),
        stride: system.stride,
        pitch: chain.pitch,
        shapes: Shapes::of(&bodies, count, chain.is_closed()),
        bodies,
        memory: Memory {
            time: 0.0,
            joints: ContactMemory::open(padded(joints.len())),
            bushes: ContactMemory::open(joints.len()),
        },
        pairs: Pairs::of(&joints),
        joints,
        joining,
        free_rollers,
        bush_turns: links.rollers == RollerModel::Bush,
        ends: system.ends.clone(),
        time_scales: [f64::INFINITY; 2],
        arch: Arch::new(),
    }
}

/// Rate of the stabilisation \[1/s\]: fast against the swinging of links, slow against contacts.
fn stabilisation(parts: &Parts) -> f64 {
    // 30 √(g/p) and not less than 1000/s
    let swinging = (parts.gravity.norm() / parts.chain.pitch).sqrt();
    (30.0 * swinging).max(1e3)
}

/// One link of given roller spacing.
fn body(links: &RigidLinks, link: usize, spacing: f64, play: f64) -> Body {
    let inner = links.is_inner(link);
    let (own, length) = if inner {
        (&links.inner, spacing)
    } else {
        (&links.outer, spacing - 2.0 * play)
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
