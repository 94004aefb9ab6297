//! Where the links and rollers of a linkage are, and how they move.

use chaindrive_geometry::{Point, Vector};
use chaindrive_integrate::Moment;

use super::bearing::Part;
use super::element::turned;
use super::{Linkage, Mate};
use crate::End;

/// One joint end of a link.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tip {
    /// Place \[m\].
    pub(crate) place: Point,
    /// Velocity \[m/s\].
    pub(crate) velocity: Vector,
    /// From the centre of mass \[m\].
    pub(crate) arm: Vector,
}

impl Default for Tip {
    fn default() -> Self {
        Self {
            place: Point::origin(),
            velocity: Vector::zeros(),
            arm: Vector::zeros(),
        }
    }
}

/// Places and velocities that follow from the coordinates.
#[derive(Clone, Debug, Default)]
pub(crate) struct Posture {
    /// Both ends of every link.
    pub(crate) tips: Vec<[Tip; 2]>,
    /// Centres of the circles that run on the teeth, (stride,), and their velocities; behind the last
    /// roller of a closed chain stand copies of the first ones.
    pub(crate) x: Vec<f64>,
    pub(crate) y: Vec<f64>,
    pub(crate) vx: Vec<f64>,
    pub(crate) vy: Vec<f64>,
}

impl Linkage {
    /// Works out the posture of a state.
    pub(crate) fn pose(&self, at: Moment<'_>, posture: &mut Posture) {
        posture.tips.resize(self.links, [Tip::default(); 2]);
        for (link, tips) in posture.tips.iter_mut().enumerate() {
            let body = &self.bodies[link];
            let [x, y, angle] = [0, 1, 2].map(|k| at.q[3 * link + k]);
            let [vx, vy, spin] = [0, 1, 2].map(|k| at.v[3 * link + k]);
            let (s, c) = angle.sin_cos();
            for (tip, arm) in tips.iter_mut().zip(&body.arms) {
                // P = r + R(φ) s,   Ṗ = ṙ + ω ẑ × R s
                let arm = Vector::new(c * arm.x - s * arm.y, s * arm.x + c * arm.y);
                *tip = Tip {
                    place: Point::new(x + arm.x, y + arm.y),
                    velocity: Vector::new(vx, vy) + turned(arm) * spin,
                    arm,
                };
            }
        }
        for values in [
            &mut posture.x,
            &mut posture.y,
            &mut posture.vx,
            &mut posture.vy,
        ] {
            values.resize(self.stride, 0.0);
        }
        for joint in 0..self.stride {
            let roller = if joint < self.joints.len() {
                let part = self.roller(joint, at, posture);
                [part.place.x, part.place.y, part.velocity.x, part.velocity.y]
            } else if self.closed {
                let k = joint % self.joints.len();
                [posture.x[k], posture.y[k], posture.vx[k], posture.vy[k]]
            } else {
                // Behind a strand stand still points one pitch apart.
                [
                    posture.x[joint - 1] + self.pitch,
                    posture.y[joint - 1],
                    0.0,
                    0.0,
                ]
            };
            [
                posture.x[joint],
                posture.y[joint],
                posture.vx[joint],
                posture.vy[joint],
            ] = roller;
        }
    }

    /// The circle at a joint that runs on the teeth.
    pub(crate) fn roller(&self, joint: usize, at: Moment<'_>, posture: &Posture) -> Part {
        match self.free_rollers.as_ref().and_then(|free| free.body[joint]) {
            Some(body) => free_part(body, at),
            None => self.part(self.joints[joint].carrier, at, posture),
        }
    }

    /// One side of a joint.
    #[inline]
    pub(crate) fn part(&self, mate: Mate, at: Moment<'_>, posture: &Posture) -> Part {
        match mate {
            Mate::Link { link, end } => {
                let tip = &posture.tips[link][end];
                Part {
                    body: Some(link),
                    place: tip.place,
                    velocity: tip.velocity,
                    arm: tip.arm,
                    spin: at.v[3 * link + 2],
                }
            }
            Mate::Ground(end) => {
                let held = &self.ends[end];
                let (shift, velocity) = match &held.end {
                    End::Driven { x, y } => {
                        let (x, y) = (x.at(at.t), y.at(at.t));
                        (
                            Vector::new(x.position, y.position),
                            Vector::new(x.rate, y.rate),
                        )
                    }
                    End::Free | End::Fixed | End::Pulled { .. } => {
                        (Vector::zeros(), Vector::zeros())
                    }
                };
                Part {
                    body: None,
                    place: held.place + shift,
                    velocity,
                    arm: Vector::zeros(),
                    spin: 0.0,
                }
            }
        }
    }
}

/// A free roller, whose circle is about its centre of mass.
pub(crate) fn free_part(body: usize, at: Moment<'_>) -> Part {
    let [x, y, vx, vy] = [
        at.q[3 * body],
        at.q[3 * body + 1],
        at.v[3 * body],
        at.v[3 * body + 1],
    ];
    Part {
        body: Some(body),
        place: Point::new(x, y),
        velocity: Vector::new(vx, vy),
        arm: Vector::zeros(),
        spin: at.v[3 * body + 2],
    }
}
