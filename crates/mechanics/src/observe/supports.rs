//! Forces from outside on centres and carriers, and what the supports of the centres bear.

use chaindrive_geometry::Vector;
use chaindrive_integrate::Moment;

use crate::bodies::{Wheel, WheelSupport};
use crate::seam::Observation;
use crate::system::System;

impl System {
    /// `accelerations`: of all coordinates, where the laws were asked at this state.
    pub(super) fn observe_supports(
        &self,
        at: Moment<'_>,
        accelerations: Option<&[f64]>,
        out: &mut Observation,
    ) {
        for values in [
            &mut out.centre_force_x,
            &mut out.centre_force_y,
            &mut out.support_force_x,
            &mut out.support_force_y,
            &mut out.carrier_force_x,
            &mut out.carrier_force_y,
        ] {
            values.clear();
        }
        let bodies = &self.bodies;
        for (index, wheel) in bodies.wheels.iter().enumerate() {
            let [x, y] = bodies.centre_force(index, at).unwrap_or_default();
            out.centre_force_x.push(x);
            out.centre_force_y.push(y);
            let chain = Vector::new(out.sprocket_force_x[index], out.sprocket_force_y[index]);
            let loads = (chain, Vector::new(x, y));
            let force = self.support_force(wheel, loads, at, accelerations);
            out.support_force_x.push(force.x);
            out.support_force_y.push(force.y);
        }
        for index in 0..bodies.slides.len() {
            let [x, y] = bodies.carrier_force(index, at).unwrap_or_default();
            out.carrier_force_x.push(x);
            out.carrier_force_y.push(y);
        }
    }

    /// Force of its support on the centre of a wheel \[N\].
    ///
    /// ```text
    /// S = m a − F_chain − F_outside − m g;   of springs S = −k x − c ẋ
    /// ```
    fn support_force(
        &self,
        wheel: &Wheel,
        (chain, outside): (Vector, Vector),
        at: Moment<'_>,
        accelerations: Option<&[f64]>,
    ) -> Vector {
        let bodies = &self.bodies;
        let (centre, velocity, given) = wheel.centre_kinematics(at.t, at.q, at.v, &bodies.slides);
        let acceleration = match &wheel.support {
            WheelSupport::Fixed | WheelSupport::Prescribed { .. } => given,
            WheelSupport::Springs {
                stiffness, damping, ..
            } => {
                let away = centre - wheel.centre;
                let along =
                    |axis: usize| -stiffness[axis] * away[axis] - damping[axis] * velocity[axis];
                return Vector::new(along(0), along(1));
            }
            WheelSupport::Carried(index) => {
                let slide = &bodies.slides[*index];
                let pose = slide.pose(at.q, at.v);
                match (slide.way(pose, centre), accelerations) {
                    // a = ∂x/∂s s̈ + ∂²x/∂s² ṡ²
                    (Some(way), Some(a)) => {
                        way.first * a[way.entry] + way.second * pose.rate.powi(2)
                    }
                    (Some(_), None) => return Vector::repeat(f64::NAN),
                    (None, _) => Vector::zeros(),
                }
            }
        };
        (acceleration - bodies.gravity) * wheel.mass - chain - outside
    }
}
