//! Contacts of rollers with gaps of any shape: how many, how continuous, and what becomes of the energy.

mod film;
mod plates;

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use chaindrive_contact::dissipation::Viscous;
use chaindrive_contact::elastic::{ElasticLaw, Power};
use chaindrive_contact::friction::Lugre;
use chaindrive_contact::{Dissipation, Elastic, Friction, Law};
use chaindrive_geometry::{Arc, ArcSpline, Foot, Piece, Point, Segment, Vector};

use super::*;
use crate::lanes::{LANES, Wide};

const RADIUS: f64 = 0.01;
const STIFFNESS: f64 = 1e8;

/// Numbers that look random and are the same every time.
struct Dice(u64);

impl Dice {
    fn next(&mut self) -> f64 {
        // splitmix64
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }
}

/// Draws pieces one after the other.
struct Pen {
    at: Point,
    heading: f64,
    pieces: Vec<Piece>,
}

impl Pen {
    fn arc(&mut self, radius: f64, sweep: f64) {
        // The centre lies to the left of travel where the arc turns left.
        let side = sweep.signum();
        let across = |heading: f64| Vector::new(-heading.sin(), heading.cos()) * (side * radius);
        let centre = self.at + across(self.heading);
        let start_angle = self.heading - side * FRAC_PI_2;
        self.heading += sweep;
        self.at = centre - across(self.heading);
        self.pieces.push(Piece::Arc(Arc {
            centre,
            radius,
            start_angle,
            sweep,
        }));
    }

    fn line(&mut self, length: f64) {
        let end = self.at + Vector::new(self.heading.cos(), self.heading.sin()) * length;
        self.pieces.push(Piece::Segment(Segment::new(self.at, end)));
        self.at = end;
    }
}

/// One side of a gap, from its bottom to the left: a hollow of some radii, a flank, a tip.
fn side(bottom: Point, tilt: f64, radii: &[f64], flank: f64, shape: [f64; 2]) -> Vec<Piece> {
    let mut pen = Pen {
        at: bottom,
        heading: PI + tilt,
        pieces: Vec::new(),
    };
    let turn = pen.heading - (FRAC_PI_2 + flank);
    for radius in radii {
        pen.arc(*radius, -turn / radii.len() as f64);
    }
    pen.line(shape[0]);
    pen.arc(shape[1], 0.3);
    pen.arc(0.4 * RADIUS, 0.7);
    pen.pieces
}

/// Kinds of tooth gap.
#[derive(Clone, Copy, Debug)]
enum Kind {
    Symmetric,
    Asymmetric,
    /// Hollows of several radii, like those fitted to a measured gap.
    Measured,
    /// A hollow of exactly the roller's radius.
    Snug,
    /// A hollow narrower than the roller.
    Narrow,
}

const KINDS: [Kind; 5] = [
    Kind::Symmetric,
    Kind::Asymmetric,
    Kind::Measured,
    Kind::Snug,
    Kind::Narrow,
];

/// A random gap, from its right tip to its left one.
fn gap(kind: Kind, dice: &mut Dice) -> Vec<Piece> {
    let bottom = Point::new(0.0, 0.06);
    let mut half = |tilt: f64| {
        let radii: Vec<f64> = match kind {
            Kind::Symmetric | Kind::Asymmetric => vec![RADIUS * dice.between(1.002, 1.3)],
            Kind::Measured => (0..4).map(|_| RADIUS * dice.between(1.002, 1.2)).collect(),
            Kind::Snug => vec![RADIUS],
            Kind::Narrow => vec![RADIUS * dice.between(0.7, 0.95)],
        };
        let flank = dice.between(0.2, 0.5);
        let shape = [
            RADIUS * dice.between(0.05, 0.3),
            RADIUS * dice.between(1.5, 4.0),
        ];
        side(bottom, tilt, &radii, flank, shape)
    };
    let tilt = match kind {
        Kind::Symmetric => 0.0,
        _ => 0.1,
    };
    let left = half(tilt);
    let right = match kind {
        Kind::Symmetric => left.clone(),
        _ => half(-tilt),
    };
    let mirrored = right.iter().rev();
    let right = mirrored.map(|piece| piece.mirrored_x().reversed());
    right.chain(left).collect()
}

fn surface(friction: Friction) -> Surface {
    Surface {
        law: Law {
            series: None,
            elastic: Elastic::Power(Power::linear(STIFFNESS)),
            dissipation: Dissipation::None,
            onset_floor: 0.01,
        },
        friction,
        film: None,
    }
}

/// One gap of a wheel that has so few that no roller comes to the next.
fn one_gap(pieces: &[Piece]) -> Contacts {
    let (tan_half, turn) = (10.0, TAU / 3.0);
    Contacts::new(
        Shape::Teeth(Teeth {
            face: GapFace::new(pieces, RADIUS),
            count: 3,
            tan_half,
            pitch_turn: [turn.cos(), turn.sin()],
            tip_radius: 0.2,
            errors: Vec::new(),
        }),
        surface(Friction::None),
        None,
        RADIUS,
    )
}

/// A rail along the x axis.
fn flat_rail(surface: Surface) -> Contacts {
    let line = Segment::new(Point::new(1.0, 0.0), Point::new(-1.0, 0.0));
    let shape = Shape::Rail {
        face: RailFace::new(&[Piece::Segment(line)]),
        reference: Point::origin(),
        bounds: [line.end, line.start],
    };
    Contacts::new(shape, surface, None, RADIUS)
}

/// A roller beside a body, step by step.
struct Roller {
    contacts: Contacts,
    frame: Frame,
    touch: Box<Touch>,
    /// Half of the step \[s\] at whose end velocities are predicted, and not what they are.
    half_step: f64,
    /// Power lost along the normal \[W\].
    losing: f64,
}

impl Roller {
    fn new(contacts: Contacts, at: Point) -> Self {
        let mut roller = Self {
            contacts,
            frame: Frame {
                // The gap axis of a wheel's first gap is its x axis.
                turn: [0.0, 1.0],
                ..Frame::fixed()
            },
            touch: Box::default(),
            half_step: 0.0,
            losing: 0.0,
        };
        // Moved at will, a roller must be looked at every time.
        roller.contacts.writes_faces = true;
        if let Shape::Rail { .. } = roller.contacts.shape {
            roller.frame = Frame::fixed();
        }
        let places = Places {
            x: &[at.x],
            y: &[at.y],
            count: 1,
        };
        roller.contacts.renew(&roller.frame, places, 1.0);
        roller
    }

    /// Force \[N\] at a place, the state there being accepted.
    fn force(&mut self, t: f64, at: Point, velocity: Vector) -> Vector {
        let lane = |value: f64| vec![value; LANES];
        let (mut ax, mut ay) = (lane(0.0), lane(0.0));
        let (x, y) = (lane(at.x), lane(at.y));
        let (vx, vy) = (lane(velocity.x), lane(velocity.y));
        let mut rollers = Rollers {
            x: &x,
            y: &y,
            vx: &vx,
            vy: &vy,
            ax: &mut ax,
            ay: &mut ay,
            inverse_mass: &lane(1.0),
            spin: &[],
            half_step: self.half_step,
        };
        let w = Wide(pulp::Scalar);
        let yielding = (self.half_step > 0.0).then_some(0.0);
        let (touch, wrench) = (&mut self.touch, &mut Wrench::default());
        self.contacts
            .act(w, t, &self.frame, &mut rollers, yielding, touch, wrench);
        self.losing = wrench.normal_loss;
        std::mem::swap(&mut self.contacts.memory, &mut self.touch);
        self.contacts.accepted = t;
        Vector::new(ax[0], ay[0])
    }

    fn closed(&self) -> usize {
        let onsets = self.contacts.memory.state.each(MemoryField::InverseOnset);
        onsets.filter(|onset| *onset > 0.0).count()
    }

    fn stored(&self) -> f64 {
        self.contacts.stored(&self.contacts.memory)
    }
}

/// Rollers are moved along the face of random gaps, pressed into it more and less. There are as many contacts as the outline
/// has places that are locally nearest, the force is the gradient of the energy, and neither jumps.
#[test]
fn forces_are_those_of_the_exact_outline() {
    let mut dice = Dice(7);
    for kind in KINDS {
        let (mut compared, mut doubles) = (0, 0);
        for _ in 0..12 {
            let pieces = gap(kind, &mut dice);
            let outline = ArcSpline::open(&pieces).unwrap();
            let length = outline.length();
            let mut roller = Roller::new(one_gap(&pieces), Point::new(0.0, 0.06));
            let (steps, waves) = (40_000_u32, dice.between(20.0, 40.0));
            let mut last: Option<(Point, Vector, f64, f64)> = None;
            let mut feet: Vec<Foot> = Vec::new();
            for step in 0..steps {
                let share = f64::from(step) / f64::from(steps);
                let foot = outline
                    .nearest(outline.point_at(length * (0.03 + 0.94 * share)), 1.0)
                    .unwrap();
                // Up to 3 µm deep, and again as far off.
                let depth = 3e-6 * (waves * TAU * share).sin();
                let at = foot.point + foot.normal * (RADIUS - depth);
                outline.local_minima_by_exhaustion(at, RADIUS + 1e-5, &mut feet);
                let deepest = feet.iter().fold(0.0_f64, |m, f| m.max(RADIUS - f.distance));
                if deepest > 5e-6 {
                    // Places that the roller cannot reach.
                    last = None;
                    continue;
                }
                let force = roller.force(f64::from(step), at, Vector::zeros());
                let stored = roller.stored();
                let touching = |margin: f64| {
                    let inside = feet.iter().filter(|foot| foot.distance < RADIUS + margin);
                    inside.count()
                };
                let counts = [touching(-1e-12), touching(1e-12)];
                assert!(
                    (counts[0]..=counts[1]).contains(&roller.closed()),
                    "{kind:?} at {share}: {} of {feet:?}",
                    roller.closed()
                );
                let exact: f64 = feet
                    .iter()
                    .map(|foot| 0.5 * STIFFNESS * (RADIUS - foot.distance).max(0.0).powi(2))
                    .sum();
                assert!((stored - exact).abs() < 1e-12, "{kind:?}: {stored} {exact}");
                doubles += usize::from(roller.closed() > 1);
                compared += 1;
                if let Some((before, pushed, energy, _)) = last {
                    let way = at - before;
                    // dU = −F·dq, to the third order in the way; K of two contacts bounds the change.
                    let work = 0.5 * (force + pushed).dot(&way) + stored - energy;
                    let bound = STIFFNESS * way.norm_squared();
                    assert!(work.abs() < bound + 1e-12, "{kind:?} at {share}: {work}");
                    let jump = (force - pushed).norm();
                    // Pressed by 3 µm the normal turns by no more than the way over the radius of its level line.
                    let turn = 300.0 * way.norm() / 1e-6_f64.max(nearness(&feet));
                    assert!(
                        jump < 3.0 * STIFFNESS * way.norm() + turn,
                        "{kind:?} at {share}: {jump}"
                    );
                }
                last = Some((at, force, stored, share));
            }
        }
        assert!(compared > 100_000, "{kind:?}: {compared}");
        // Only a narrow hollow bears a roller on two sides, in the short way between its ends.
        let twice = matches!(kind, Kind::Narrow);
        assert!(
            if twice { doubles > 20 } else { doubles == 0 },
            "{kind:?}: {doubles}"
        );
    }
}

/// Least distance \[m\] of a roller's centre from the centre of an arc: the radius of the level line there.
fn nearness(feet: &[Foot]) -> f64 {
    let radii = feet.iter().map(|foot| match foot.curvature {
        bend if bend.abs() > 0.0 => (foot.distance + 1.0 / bend).abs(),
        _ => f64::INFINITY,
    });
    radii.fold(f64::INFINITY, f64::min)
}

/// A roller dropped into random gaps keeps its energy: the error is that of the time stepping, of second order.
#[test]
fn a_roller_bouncing_in_a_gap_keeps_its_energy() {
    let (mass, gravity) = (0.05, Vector::new(0.0, -500.0));
    let mut dice = Dice(3);
    for kind in KINDS {
        let mut worst = [0.0_f64; 2];
        for _ in 0..6 {
            let pieces = gap(kind, &mut dice);
            let outline = ArcSpline::open(&pieces).unwrap();
            let mut start = Point::new(dice.between(-3e-4, 3e-4), 0.06 + RADIUS);
            while outline.nearest(start, 1.0).unwrap().distance < 1.03 * RADIUS {
                start.y += 1e-4;
            }
            for (worst, refined) in worst.iter_mut().zip([1_u32, 2]) {
                let step = 1e-6 / f64::from(refined);
                let mut roller = Roller::new(one_gap(&pieces), start);
                let (mut at, mut velocity) = (start, Vector::zeros());
                let height = |at: Point| -mass * gravity.dot(&at.coords);
                let (zero, mut t) = (height(at), 0.0);
                let mut a = gravity + roller.force(t, at, velocity) / mass;
                for _ in 0..20_000 * refined {
                    velocity += a * (0.5 * step);
                    at += velocity * step;
                    t += step;
                    a = gravity + roller.force(t, at, velocity) / mass;
                    velocity += a * (0.5 * step);
                    let kinetic = 0.5 * mass * velocity.norm_squared();
                    let error = kinetic + height(at) + roller.stored() - zero;
                    *worst = worst.max(error.abs());
                }
            }
        }
        // Some 10 mJ fall to the bottom.
        assert!(
            worst[0] < 1e-4 && worst[1] < 0.5 * worst[0],
            "{kind:?}: {worst:?}"
        );
    }
}

/// A roller that is carried over the tip of a tooth keeps its contact, also where gaps have two stretches.
#[test]
fn a_contact_is_carried_over_the_tip() {
    // Straight flanks that meet in an edge at the bottom, and tips that are round.
    let (teeth, mut bottom) = (24_u32, 0.06);
    let axis = PI / f64::from(teeth);
    let draw = |bottom: f64| {
        let mut pen = Pen {
            at: Point::new(0.0, bottom),
            heading: 0.75 * PI,
            pieces: Vec::new(),
        };
        pen.line(1.2 * RADIUS);
        pen.arc(0.5 * RADIUS, FRAC_PI_2);
        match pen.pieces[1] {
            Piece::Arc(tip) => (pen.pieces, tip),
            Piece::Segment(_) => panic!("the tip is an arc"),
        }
    };
    // At such a height that the centre of the tip lies on the tooth's centre line.
    let (_, tip) = draw(bottom);
    bottom += -tip.centre.x / axis.tan() - tip.centre.y;
    let (left, tip) = draw(bottom);
    let right = left.iter().rev().map(|p| p.mirrored_x().reversed());
    let pieces: Vec<Piece> = right.chain(left.iter().copied()).collect();
    let face = GapFace::new(&pieces, RADIUS);
    assert_eq!(face.stretches.len(), 2);
    let turn = 2.0 * axis;
    let contacts = Contacts::new(
        Shape::Teeth(Teeth {
            face,
            count: teeth,
            tan_half: axis.tan(),
            pitch_turn: [turn.cos(), turn.sin()],
            tip_radius: 0.2,
            errors: Vec::new(),
        }),
        surface(Friction::None),
        None,
        RADIUS,
    );
    for way in [-1.0, 1.0] {
        let place = |share: f64| {
            let lean = -way * share * 0.5;
            let centre = Point::new(way * tip.centre.x, tip.centre.y);
            let up = centre.coords.normalize();
            let [c, s] = [lean.cos(), lean.sin()];
            let out = Vector::new(c * up.x - s * up.y, s * up.x + c * up.y);
            centre + out * (tip.radius + RADIUS - 1e-6)
        };
        let mut roller = Roller::new(contacts.clone(), place(-1.0));
        roller.force(0.0, place(-1.0), Vector::zeros());
        assert_eq!(roller.closed(), 1);
        let state = &mut roller.contacts.memory.state;
        for contact in 0..state.len() {
            if state.is_closed(contact) {
                state.set(MemoryField::InverseOnset, contact, 42.0);
            }
        }
        for step in -99..=99_i32 {
            let at = place(0.01 * f64::from(step));
            let force = roller.force(f64::from(step + 100), at, Vector::zeros());
            assert!(
                (force.norm() - 100.0).abs() < 1e-3,
                "{way}, {step}: {force:?}"
            );
            let onsets = roller.contacts.memory.state.each(MemoryField::InverseOnset);
            let closed: Vec<f64> = onsets.filter(|v| *v > 0.0).collect();
            assert_eq!(closed, [42.0], "{way}, {step}");
            if step % 7 == 0 {
                // Windows are renewed, and with them the gap that is remembered.
                let places = Places {
                    x: &[at.x],
                    y: &[at.y],
                    count: 1,
                };
                let frame = roller.frame;
                roller.contacts.renew(&frame, places, 1.0);
            }
        }
    }
}

/// Bristles that were bent in one contact are straight in the next (defect A2).
#[test]
fn a_contact_begins_without_bristles() {
    let friction = Friction::Lugre(Lugre {
        static_coefficient: 0.2,
        coefficient: 0.1,
        slip_speed: 0.01,
        stiffness: 1e5,
        damping: 0.0,
        viscosity: 0.0,
    });
    let rail = || flat_rail(surface(friction));
    let [pressed, off] = [-1e-6, 1e-3].map(|gap| Point::new(0.0, RADIUS + gap));
    let slip = Vector::new(1.0, 0.0);
    let mut fresh = Roller::new(rail(), off);
    fresh.force(0.0, off, slip);
    let expected = fresh.force(1e-9, pressed, slip);
    let mut used = Roller::new(rail(), off);
    for t in [0.0, 1e-3] {
        let force = used.force(t, pressed, slip);
        assert!(force.x.abs() > 5.0 || t < 1e-4, "{force:?}");
    }
    // Two buffers change hands: whatever is left must not come back from either.
    for lifted in 1..5_u32 {
        let mut again = Roller {
            contacts: used.contacts.clone(),
            frame: used.frame,
            touch: used.touch.clone(),
            half_step: 0.0,
            losing: 0.0,
        };
        for step in 1..=lifted {
            again.force(1e-3 + 1e-9 * f64::from(step), off, slip);
        }
        let force = again.force(1e-3 + 1e-9 * f64::from(lifted + 1), pressed, slip);
        assert!(
            (force - expected).norm() < 1e-6,
            "{lifted}: {force:?} {expected:?}"
        );
    }
}

/// At the end of a step the force is the law's at the speed that this very force brings about, and a damper that would pull does not
/// push instead. The circle has 1 kg, the rail does not yield, and nothing else acts.
#[test]
fn a_force_ahead_is_that_of_the_law_at_the_end_of_the_step() {
    let (damping, depth, half_step) = (1e4, 1e-6, 1e-4);
    let mut damped = surface(Friction::None);
    damped.law.dissipation = Dissipation::Viscous(Viscous { damping });
    let mut parted = 0;
    for closing in [-0.2, -0.05, -0.015, -0.01, 0.0, 0.01, 0.2] {
        let at = Point::new(0.0, RADIUS - depth);
        let mut roller = Roller::new(flat_rail(damped), at);
        let before = roller.force(0.0, at, Vector::zeros()).y;
        assert!(before > 0.0);
        roller.half_step = half_step;
        let force = roller
            .force(2.0 * half_step, at, Vector::new(0.0, -closing))
            .y;
        // δ̇⁺ = δ̇ − ½ h (F − F₀)/m,   F = max(0, k δ + c δ̇⁺)
        let ahead = closing - half_step * (force - before);
        let law = (STIFFNESS * depth + damping * ahead).max(0.0);
        assert!(
            (force - law).abs() < 1e-9 * STIFFNESS * depth,
            "{closing}: {force} {law}"
        );
        parted += u32::from(force == 0.0);
    }
    assert!((1..6).contains(&parted), "{parted}");
}

/// Pushed from the seat over to the flank at one depth, a roller meets no step in the force.
#[test]
fn the_law_changes_continuously_from_seat_to_flank() {
    let flank = Flank {
        elastic: Elastic::Power(Power::linear(4e7)),
        width: 4e-4,
    };
    let seat = Power::linear(1e8);
    let force = |beyond: f64| {
        let share = flank.share(beyond);
        (1.0 - share) * seat.force(1e-6) + share * flank.elastic.force(1e-6)
    };
    let mut last = force(-1e-3);
    assert!((last - 100.0).abs() < 1e-9 && (force(1e-3) - 40.0).abs() < 1e-9);
    for step in 1..=2000 {
        let next = force(-1e-3 + 1e-6 * f64::from(step));
        // The steepest part of the smooth step has a slope of 3/(4 w).
        assert!(next <= last && last - next <= 60.0 * 0.75 / 4e-4 * 1e-6 * 1.0001);
        last = next;
    }
}
