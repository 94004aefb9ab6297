//! Arrows that show which way sprockets turn.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_3};

use chaindrive_geometry::{Arc, Point, Vector};

use super::{BodyKind, Figure};
use crate::Parts;
use crate::drive::Rotation;

/// Radius of an arrow and length of the barbs of its head, over the pitch radius: for the eye.
const RADIUS: f64 = 0.62;
const BARB: f64 = 0.12;

/// An arrow about the centre of a sprocket, below it, in a frame that stays upright.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RotationArrow {
    /// From its tail to its tip \[m\].
    pub arc: Arc,
    /// A barb, the tip, the other barb \[m\].
    pub head: [Point; 3],
}

impl Figure {
    /// The arrow of a body; none where it is no sprocket, or stands still.
    pub fn rotation_arrow(&self, body: usize) -> Option<RotationArrow> {
        // Sprockets are the first of the bodies.
        let BodyKind::Sprocket { pitch_radius, .. } = self.bodies.get(body)?.kind else {
            return None;
        };
        let speed = *self.speeds.get(body)?;
        (speed != 0.0 && speed.is_finite()).then(|| RotationArrow::about(pitch_radius, speed))
    }
}

impl RotationArrow {
    fn about(pitch_radius: f64, speed: f64) -> Self {
        let way = speed.signum();
        let radius = RADIUS * pitch_radius;
        // A third of a half turn on either side of the lowest point.
        let arc = Arc {
            centre: Point::origin(),
            radius,
            start_angle: -FRAC_PI_2 - way * FRAC_PI_3,
            sweep: way * 2.0 * FRAC_PI_3,
        };
        let end = arc.start_angle + arc.sweep;
        let outwards = Vector::new(end.cos(), end.sin());
        let ahead = way * Vector::new(-end.sin(), end.cos());
        let tip = Point::origin() + radius * outwards;
        let barb = BARB * pitch_radius;
        let [outer, inner] = [0.6, -0.6].map(|aside| tip + barb * (aside * outwards - ahead));
        Self {
            arc,
            head: [outer, tip, inner],
        }
    }
}

/// Speeds of the sprockets whose shafts a motion turns \[rad/s\], of a drive that is not assembled; zero of others.
pub(super) fn given_speeds(parts: &Parts, begin: f64) -> Vec<f64> {
    let speed = |shaft: usize| match &parts.shafts[shaft].rotation {
        Rotation::Prescribed(motion) => motion.mean_rate(begin),
        Rotation::Free { .. } => 0.0,
    };
    parts.sprockets.iter().map(|it| speed(it.shaft)).collect()
}
