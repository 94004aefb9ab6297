//! How far a step of Newton's method may go, and the way that it goes.
//!
//! A step is straight, and would lead a roller out of its seat by R φ²/2 where its sprocket turns by φ. So rollers near a sprocket ride
//! on it along a circle, and their way over the teeth is the rest of their step:
//!
//! ```text
//! x⁺ = c + R(φ) (x − c) + s − φ ẑ × (x − c)     s: the step of the roller, c: centre of the sprocket
//! ```

use chaindrive_geometry::{Point, Vector};
use chaindrive_integrate::Moment;

use super::Newton;
use super::contact::wheel_mount;
use crate::system::Member;

/// Longest step of a roller over a surface near it, in radii of the smallest that touches teeth.
const SLIP: f64 = 0.2;

/// Angle \[rad\] by which a step may turn a sprocket or a link. *Assumed*: the strain of a link that turns by φ across its line is φ²/2,
/// which the linear step does not know of.
const TURN: f64 = 0.2;

/// Motion of a sprocket in a step, and the rollers near it.
struct Ride {
    wheel: usize,
    centre: Point,
    shift: Vector,
    /// Angle \[rad\].
    turn: f64,
    /// Rollers near it.
    rollers: Vec<usize>,
}

impl Ride {
    /// Straight step of a roller that rides along.
    fn straight(&self, place: Point) -> Vector {
        let arm = place - self.centre;
        self.shift + Vector::new(-arm.y, arm.x) * self.turn
    }

    /// From the end of the straight way to that of the circle, after a share of the step.
    fn round(&self, place: Point, share: f64) -> Vector {
        let arm = place - self.centre;
        let turn = share * self.turn;
        arm * (turn.cos() - 1.0) + Vector::new(-arm.y, arm.x) * (turn.sin() - turn)
    }
}

impl Newton<'_> {
    /// Longest way \[m\] of anything since the contact windows were laid.
    pub(super) fn moved(&self, q: &[f64]) -> f64 {
        let unknowns = self.unknowns;
        let both = q.iter().zip(&self.looked).zip(&unknowns.row);
        let moved = both.filter_map(|((now, then), row)| {
            row.map(|row| (now - then).abs() * unknowns.scale[row].sqrt())
        });
        moved.fold(0.0, f64::max)
    }

    /// Share of a step from `q`, at most all of it, that leads nothing too far, or farther than a part of that.
    ///
    /// Rollers near a body go no farther over it than a fifth of a radius, others half of their way to the nearest body, and no link or
    /// sprocket turns by more than [`TURN`]: a long span reaches its sag in a few steps.
    pub(super) fn share(&self, q: &[f64], step: &[f64], part: f64) -> f64 {
        let unknowns = self.unknowns;
        let (longest, turn) = (part * self.longest(), part * TURN);
        // By how many times anything goes too far.
        let mut over = 1.0_f64;
        for (row, step) in step.iter().enumerate().skip(unknowns.turns) {
            over = over.max(if row < unknowns.places {
                step.abs() / turn
            } else {
                step.abs() * unknowns.scale[row].sqrt() / longest
            });
        }
        let still = vec![0.0; q.len()];
        let at = Moment::stateless(self.system.begin, q, &still);
        for member in &self.system.chains {
            over = over.max(self.over(member, at, step, [longest, turn]));
        }
        1.0 / over
    }

    /// By how many times the rollers and links of a chain go too far.
    fn over(
        &self,
        member: &Member,
        at: Moment<'_>,
        step: &[f64],
        [longest, turn]: [f64; 2],
    ) -> f64 {
        let mut over = 0.0_f64;
        let moves = self.moves(member, at.q, step);
        let mut ridden = vec![None; moves.len()];
        for ride in self.rides(member, at, step) {
            over = over.max(ride.turn.abs() / turn);
            for &roller in &ride.rollers {
                let (place, shift) = moves[roller];
                over = over.max((shift - ride.straight(place)).norm() / longest);
                ridden[roller] = Some(ride.wheel);
            }
        }
        // Rollers that go far, and their room to the nearest body that they do not ride on.
        let far = (0..moves.len()).filter(|&roller| moves[roller].1.norm() > longest);
        let mut far: Vec<_> = far.map(|roller| (roller, f64::INFINITY)).collect();
        if !far.is_empty() {
            let bodies = &self.system.bodies;
            member.contacts.each_room(bodies, at, |wheel, room| {
                for (roller, least) in &mut far {
                    if wheel.is_none() || wheel != ridden[*roller] {
                        *least = least.min(room(moves[*roller].0));
                    }
                }
            });
        }
        for (roller, room) in far {
            over = over.max(moves[roller].1.norm() / longest.max(0.5 * room));
        }
        for link in 0..member.chain.links() {
            let across = moves[(link + 1) % moves.len()].1 - moves[link].1;
            over = over.max(across.norm() / (turn * member.chain.pitch()));
        }
        over
    }

    /// Goes a share of a step, on circles where rollers ride on sprockets.
    pub(super) fn go(&self, q: &mut [f64], step: &[f64], share: f64) {
        let still = vec![0.0; q.len()];
        let at = Moment::stateless(self.system.begin, q, &still);
        let mut bends = Vec::new();
        for member in &self.system.chains {
            let (own, first) = (&q[member.entries.clone()], member.entries.start);
            for ride in self.rides(member, at, step) {
                for &roller in &ride.rollers {
                    let moving = member.chain.roller_moving(own, roller).behind(first);
                    let round = ride.round(moving.place, share);
                    let ways = moving.ways().iter();
                    bends.extend(ways.map(|way| (way.entry, way.first.dot(&round))));
                }
            }
        }
        let straight = self.unknowns.row.iter().enumerate();
        for (entry, row) in straight.filter_map(|(entry, row)| Some((entry, (*row)?))) {
            q[entry] += share * step[row];
        }
        for (entry, bend) in bends {
            q[entry] += bend;
        }
    }

    /// Longest way of a roller over a surface near it \[m\].
    fn longest(&self) -> f64 {
        let teeth = self.system.chains.iter().flat_map(|m| &m.contacts.teeth);
        let smallest = teeth.map(|on| on.contacts.radius).reduce(f64::min);
        SLIP * smallest.unwrap_or_else(|| self.system.pitch())
    }

    /// Places of the rollers, and their steps.
    fn moves(&self, member: &Member, q: &[f64], step: &[f64]) -> Vec<(Point, Vector)> {
        let (own, first) = (&q[member.entries.clone()], member.entries.start);
        let rollers = (0..member.chain.rollers()).map(|roller| {
            let moving = member.chain.roller_moving(own, roller).behind(first);
            let ways = moving.ways().iter();
            let shift = ways.map(|way| way.first * self.of(step, way.entry)).sum();
            (moving.place, shift)
        });
        rollers.collect()
    }

    /// Motions of the sprockets of a chain.
    fn rides(&self, member: &Member, at: Moment<'_>, step: &[f64]) -> Vec<Ride> {
        let bodies = &self.system.bodies;
        let teeth = member.contacts.teeth.iter().map(|on| {
            let (frame, mount) = wheel_mount(bodies, &bodies.wheels[on.wheel], at);
            let centre = mount.centre.iter();
            let mut rollers = Vec::with_capacity(on.contacts.candidates);
            on.contacts.for_each_slot(|_, roller| rollers.push(roller));
            Ride {
                wheel: on.wheel,
                centre: frame.origin,
                shift: centre.map(|way| way.first * self.of(step, way.entry)).sum(),
                turn: mount
                    .angle
                    .map_or(0.0, |(entry, ratio)| ratio * self.of(step, entry)),
                rollers,
            }
        });
        teeth.collect()
    }

    /// Part of a step that an entry of the state takes; those that are held take none.
    fn of(&self, step: &[f64], entry: usize) -> f64 {
        self.unknowns.row[entry].map_or(0.0, |row| step[row])
    }
}
