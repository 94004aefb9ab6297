//! Parry queries between an arc spline and a ball.

use parry2d_f64::math::{Pose, Vector};
use parry2d_f64::query::{
    ClosestPoints, Contact, NonlinearRigidMotion, QueryDispatcher, ShapeCastHit, ShapeCastOptions,
    ShapeCastStatus, ShapeDistance, ShapeIntersection, Unsupported,
};
use parry2d_f64::shape::{Ball, Shape};

use super::shape::part;
use super::{direction_to_parry, from_parry, to_parry};
use crate::{ArcSpline, Foot};

/// Answers parry's queries between an [`ArcSpline`] and a ball, in either order.
///
/// Every other pair is `Unsupported`, so that the default dispatcher can be chained behind it.
/// As everywhere in parry a contact is the deepest one only; a roller in a gap has more, see
/// [`ArcSpline::local_minima`].
///
/// # Example
///
/// ```
/// use chaindrive_geometry::{ArcSpline, Point, RollerDispatcher, Segment};
/// use parry2d_f64::math::Pose;
/// use parry2d_f64::query::{DefaultQueryDispatcher, QueryDispatcher};
/// use parry2d_f64::shape::Ball;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let floor = Segment::new(Point::new(1.0, 0.0), Point::new(-1.0, 0.0));
/// let floor = ArcSpline::open(&[floor.into()])?;
/// let dispatcher = RollerDispatcher.chain(DefaultQueryDispatcher);
/// let above = Pose::translation(0.2, 0.5);
/// let gap = dispatcher.distance(&above, &floor, &Ball::new(0.3))?;
/// assert!((gap.distance - 0.2).abs() < 1e-15);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RollerDispatcher;

/// An arc spline with a ball beside it, in the frame of the spline.
struct Meeting<'a> {
    curve: &'a ArcSpline,
    centre: Vector,
    radius: f64,
    /// Whether the ball was the first of the two.
    swapped: bool,
    /// From the spline's frame to the ball's.
    to_ball: Pose,
}

impl<'a> Meeting<'a> {
    fn of(pos12: &Pose, g1: &'a dyn Shape, g2: &'a dyn Shape) -> Result<Self, Unsupported> {
        let (curve, ball, pose, swapped) =
            match (g1.as_shape::<ArcSpline>(), g2.as_shape::<ArcSpline>()) {
                (Some(curve), _) => (curve, g2, *pos12, false),
                (_, Some(curve)) => (curve, g1, pos12.inverse(), true),
                _ => return Err(Unsupported),
            };
        let ball = ball.as_shape::<Ball>().ok_or(Unsupported)?;
        Ok(Self {
            curve,
            centre: pose.translation,
            radius: ball.radius,
            swapped,
            to_ball: pose.inverse(),
        })
    }

    /// The nearest place on the spline to the ball's centre.
    fn foot(&self, reach: f64) -> Option<Foot> {
        self.curve.nearest(from_parry(self.centre), reach)
    }

    /// Touching geometry at a foot: points and normals, each in its own shape's frame.
    fn contact(&self, foot: &Foot) -> Contact {
        let normal1 = direction_to_parry(foot.normal);
        let normal2 = -(self.to_ball.rotation * normal1);
        let mut contact = Contact::new(
            to_parry(foot.point),
            normal2 * self.radius,
            normal1,
            normal2,
            foot.distance - self.radius,
        )
        .with_subshapes(part(foot.piece), 0);
        if self.swapped {
            contact.flip();
        }
        contact
    }

    /// First time in \[0, latest\] at which the moving ball is `margin` from the curve, and whether
    /// the search got there: it steps to the earliest time at which the gap could be closed.
    fn advance(&self, velocity: Vector, margin: f64, latest: f64) -> Option<(f64, Foot, bool)> {
        const STEPS: usize = 1000;
        let speed = velocity.length();
        let mut time = 0.0;
        for step in 1..=STEPS {
            let at = from_parry(self.centre + velocity * time);
            let foot = self.curve.nearest(at, f64::INFINITY)?;
            let gap = foot.distance - self.radius - margin;
            let closed = gap <= 1e-12 * (self.radius + margin + at.coords.norm());
            if closed || step == STEPS {
                return Some((time, foot, closed));
            }
            // |∇d| = 1, so the gap cannot close before gap / |v| has passed.
            time += gap / speed;
            if time.is_nan() || time > latest {
                return None;
            }
        }
        None
    }
}

impl QueryDispatcher for RollerDispatcher {
    fn intersection_test(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
    ) -> Result<ShapeIntersection, Unsupported> {
        let meeting = Meeting::of(pos12, g1, g2)?;
        let foot = meeting.foot(f64::INFINITY);
        let touching = foot.is_some_and(|foot| foot.distance <= meeting.radius);
        Ok(ShapeIntersection::new(touching))
    }

    /// Zero when the two overlap.
    fn distance(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
    ) -> Result<ShapeDistance, Unsupported> {
        let meeting = Meeting::of(pos12, g1, g2)?;
        let foot = meeting.foot(f64::INFINITY).ok_or(Unsupported)?;
        Ok(ShapeDistance::new(
            (foot.distance - meeting.radius).max(0.0),
        ))
    }

    fn contact(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
        prediction: f64,
    ) -> Result<Option<Contact>, Unsupported> {
        let meeting = Meeting::of(pos12, g1, g2)?;
        Ok(meeting
            .foot(f64::INFINITY)
            .filter(|foot| foot.distance - meeting.radius < prediction)
            .map(|foot| meeting.contact(&foot)))
    }

    fn closest_points(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
        max_dist: f64,
    ) -> Result<ClosestPoints, Unsupported> {
        let meeting = Meeting::of(pos12, g1, g2)?;
        let Some(foot) = meeting.foot(f64::INFINITY) else {
            return Ok(ClosestPoints::Disjoint);
        };
        let gap = foot.distance - meeting.radius;
        Ok(if gap <= 0.0 {
            ClosestPoints::Intersecting
        } else if gap <= max_dist {
            let contact = meeting.contact(&foot);
            ClosestPoints::WithinMargin(contact.point1, contact.point2)
        } else {
            ClosestPoints::Disjoint
        })
    }

    fn cast_shapes(
        &self,
        pos12: &Pose,
        local_vel12: Vector,
        g1: &dyn Shape,
        g2: &dyn Shape,
        options: ShapeCastOptions,
    ) -> Result<Option<ShapeCastHit>, Unsupported> {
        let meeting = Meeting::of(pos12, g1, g2)?;
        // The ball's velocity in the frame of the curve.
        let velocity = if meeting.swapped {
            -(pos12.rotation.inverse() * local_vel12)
        } else {
            local_vel12
        };
        let latest = options.max_time_of_impact;
        let Some((time, foot, closed)) = meeting.advance(velocity, options.target_distance, latest)
        else {
            return Ok(None);
        };
        let contact = meeting.contact(&foot);
        let apart = foot.distance - meeting.radius > options.target_distance;
        let leaving = direction_to_parry(foot.normal).dot(velocity) >= 0.0;
        if time <= 0.0 && leaving && !options.stop_at_penetration {
            return Ok(None);
        }
        let status = if !closed {
            ShapeCastStatus::OutOfIterations
        } else if time <= 0.0 && !apart {
            ShapeCastStatus::PenetratingOrWithinTargetDist
        } else {
            ShapeCastStatus::Converged
        };
        Ok(Some(ShapeCastHit {
            time_of_impact: time,
            witness1: contact.point1,
            witness2: contact.point2,
            normal1: contact.normal1,
            normal2: contact.normal2,
            status,
            subshape1: contact.subshape1,
            subshape2: contact.subshape2,
        }))
    }

    fn cast_shapes_nonlinear(
        &self,
        _motion1: &NonlinearRigidMotion,
        _g1: &dyn Shape,
        _motion2: &NonlinearRigidMotion,
        _g2: &dyn Shape,
        _start_time: f64,
        _end_time: f64,
        _stop_at_penetration: bool,
    ) -> Result<Option<ShapeCastHit>, Unsupported> {
        Err(Unsupported)
    }
}
