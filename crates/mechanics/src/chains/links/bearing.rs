//! A pin in a hole: the contact of two circles, one inside the other.
//!
//! ```text
//! e = P_pin − P_hole,  n = e/|e|,   δ = |e| − c,   c = R_hole − R_pin
//! ```

use chaindrive_contact::{Approach, Friction, Prepared, Response, interpolated_onset};
use chaindrive_geometry::{Point, Vector};

use super::element::{Element, Partner, turned};
use super::pins::PinLaw;
use crate::drive::Surface;

/// A bore and what turns in it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bearing {
    pub(crate) law: Prepared,
    /// The same for lanes.
    pub(crate) pins: PinLaw,
    /// Least speed at touch \[m/s\].
    pub(crate) floor: f64,
    pub(crate) friction: Friction,
    /// Radial clearance c \[m\].
    pub(crate) clearance: f64,
    /// Radius of what turns in the bore \[m\].
    pub(crate) radius: f64,
}

/// State of one contact at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PinTouch {
    /// Gap −δ \[m\], negative in contact.
    pub(crate) gap: f64,
    /// Closing speed δ̇ \[m/s\].
    pub(crate) closing: f64,
    /// Closing speed at touch \[m/s\]; zero while open.
    pub(crate) onset: f64,
    /// Normal force \[N\].
    pub(crate) force: f64,
    /// State of the friction law.
    pub(crate) stick: f64,
    /// Eccentricity: the pin seen from the centre of the hole \[m\].
    pub(crate) offset: Vector,
}

impl PinTouch {
    pub(crate) const OPEN: Self = Self {
        gap: 1.0,
        closing: 0.0,
        onset: 0.0,
        force: 0.0,
        stick: 0.0,
        offset: Vector::new(0.0, 0.0),
    };
}

/// One of the two sides of a joint.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Part {
    /// Body that it belongs to; none for the frame.
    pub(crate) body: Option<usize>,
    /// Centre of the circle \[m\].
    pub(crate) place: Point,
    /// Its velocity \[m/s\].
    pub(crate) velocity: Vector,
    /// From the body's centre of mass \[m\].
    pub(crate) arm: Vector,
    /// Angular speed of the body \[rad/s\].
    pub(crate) spin: f64,
}

/// What a contact costs, and how it began.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Tally {
    /// Power lost along the normal \[W\].
    pub(crate) normal_loss: f64,
    /// Power lost by friction \[W\].
    pub(crate) friction_loss: f64,
    /// Deepest penetration of a contact that opened this step \[m\].
    pub(crate) first_depth: f64,
    /// Smallest share of the step after which such a contact began.
    pub(crate) first_share: f64,
}

impl Tally {
    pub(crate) fn new() -> Self {
        Self {
            first_share: 1.0,
            ..Self::default()
        }
    }

    /// Takes note of a contact that began between two states.
    pub(crate) fn began(&mut self, gap_before: f64, depth: f64) {
        let opening = gap_before.max(0.0);
        self.first_depth = self.first_depth.max(depth);
        self.first_share = self.first_share.min(opening / (opening + depth));
    }
}

/// Eccentricity below which a pin has no direction \[m\].
pub(super) const CENTRED: f64 = 1e-12;

impl Bearing {
    pub(crate) fn new(surface: &Surface, bore: f64, radius: f64) -> Self {
        Self {
            law: surface.law.prepared(),
            pins: PinLaw::new(surface.law.prepared()),
            floor: surface.floor(),
            friction: surface.friction,
            clearance: bore - radius,
            radius,
        }
    }

    /// The contact of `pin` in `hole` at a joint, `dt` after the accepted state `before`.
    #[inline(always)]
    pub(crate) fn touch(
        &self,
        joint: usize,
        hole: &Part,
        pin: &Part,
        before: &PinTouch,
        dt: f64,
        tally: &mut Tally,
    ) -> (PinTouch, Option<Element>) {
        let offset = pin.place - hole.place;
        let relative = pin.velocity - hole.velocity;
        let eccentricity = offset.norm();
        let mut touch = PinTouch {
            gap: self.clearance - eccentricity,
            offset,
            ..PinTouch::OPEN
        };
        if eccentricity < CENTRED {
            return (touch, None);
        }
        let normal = offset / eccentricity;
        touch.closing = normal.dot(&relative);
        if touch.gap >= 0.0 {
            return (touch, None);
        }
        let depth = -touch.gap;
        touch.onset = before.onset;
        if before.onset <= 0.0 {
            touch.onset = interpolated_onset(before.gap, before.closing, touch.gap, touch.closing)
                .max(self.floor);
            tally.began(before.gap, depth);
        }
        let answer = self.law.respond(Approach {
            penetration: depth,
            rate: touch.closing,
            onset_rate: touch.onset,
        });
        touch.force = answer.force;
        tally.normal_loss += (answer.force - answer.elastic) * touch.closing;
        let [lever_pin, lever_hole] = self.levers(depth);
        let mut element = Element {
            joint,
            a: pin.body,
            b: hole.body.map_or(Partner::Ground, Partner::Body),
            arm_a: pin.arm,
            arm_b: hole.arm,
            pivot_b: hole.arm,
            lever_a: lever_pin,
            lever_b: lever_hole,
            normal,
            force: answer.force,
            rub: 0.0,
            stiffness: answer.stiffness,
            damping: answer.damping,
            drag: 0.0,
            secant: 0.0,
            across: answer.force / eccentricity,
        };
        if self.friction != Friction::None {
            let slip =
                turned(normal).dot(&relative) + lever_pin * pin.spin - lever_hole * hole.spin;
            let rub = self.friction.rub(answer.force, slip, before.stick, dt);
            touch.stick = rub.state;
            element.rub(&self.friction, rub, slip);
            tally.friction_loss -= rub.force * slip;
        }
        (touch, Some(element))
    }

    /// From the centres of pin and hole to where they touch \[m\].
    pub(super) fn levers(&self, depth: f64) -> [f64; 2] {
        // Both surfaces at the middle of the overlap: R_pin − δ/2 and R_hole + δ/2.
        [
            self.radius - 0.5 * depth,
            self.radius + self.clearance + 0.5 * depth,
        ]
    }

    /// Stored energy \[J\] of a contact with this gap \[m\].
    pub(crate) fn energy(&self, gap: f64) -> f64 {
        self.law.energy(-gap)
    }
}

impl Bearing {
    /// Answer of a contact that neither closes nor opens.
    pub(super) fn at_rest(&self, depth: f64) -> Response {
        self.law.respond(Approach {
            penetration: depth,
            rate: 0.0,
            onset_rate: 1.0,
        })
    }

    /// Tangent stiffness \[N/m\] at a penetration \[m\].
    pub(crate) fn stiffness(&self, depth: f64) -> f64 {
        self.at_rest(depth).stiffness
    }

    /// Penetration \[m\] at which the elastic force reaches `force` \[N\].
    pub(crate) fn indentation(&self, force: f64) -> f64 {
        if force <= 0.0 {
            return 0.0;
        }
        // Newton from the penetration of a linear spring; the laws are convex and grow without bound.
        let mut depth = force / self.stiffness(1e-6);
        for _ in 0..60 {
            let at_rest = self.at_rest(depth);
            let excess = at_rest.elastic - force;
            let next = (depth - excess / at_rest.stiffness).max(0.1 * depth);
            if (next - depth).abs() <= 1e-14 * depth {
                return next;
            }
            depth = next;
        }
        depth
    }
}
