//! One roller at a time: what a chain of bodies uses instead of the lanes.

use chaindrive_geometry::{Point, Vector};

use super::{Contacts, Frame, Shape, Teeth};
use crate::profile::Probe;

/// The surfaces that one roller faces: one, or both halves of a narrow gap.
pub(crate) type Faces = [Option<Probe>; 2];

impl Contacts {
    /// What the roller in `slot` at `place` faces, with normals in the world.
    ///
    /// Like the lanes it starts from the gap remembered for the slot, and turns by one pitch
    /// where the roller has passed the middle of a tooth.
    #[inline]
    pub(crate) fn faces(&self, frame: &Frame, slot: usize, place: Point) -> Faces {
        match &self.shape {
            Shape::Rail {
                profile, reference, ..
            } => {
                let mut probe = profile.probe(frame.local(place, *reference), self.radius);
                probe.normal = frame.outward(probe.normal);
                [Some(probe), None]
            }
            Shape::Teeth(teeth) => {
                let d = place - frame.origin;
                let reach = teeth.tip_radius + self.radius;
                if d.norm_squared() > reach * reach {
                    return [None; 2];
                }
                let axis = self.gap_axis(teeth, frame, slot, d);
                // x = d × a,   y = d · a
                let (x, y) = (d.x * axis.y - d.y * axis.x, d.dot(&axis));
                if teeth.halves.two_sided {
                    [(1.0, &teeth.halves.right), (-1.0, &teeth.halves.left)].map(|(side, half)| {
                        let probe = half.probe(Point::new(side * x, y), self.radius);
                        // A seat across the axis belongs to the right half alone.
                        let seat = probe.feature == 0 && half.features[0].sign < 0.0;
                        (!seat || side * x >= 0.0).then(|| in_world(probe, side, axis))
                    })
                } else {
                    let side = if x > 0.0 { 1.0 } else { -1.0 };
                    let half = &teeth.halves.right;
                    let probe = half.probe(Point::new(x.abs(), y), self.radius);
                    [Some(in_world(probe, side, axis)), None]
                }
            }
        }
    }

    /// Axis in the world of the gap that a roller at `d` from the wheel centre is nearest to.
    #[inline]
    fn gap_axis(&self, teeth: &Teeth, frame: &Frame, slot: usize, d: Vector) -> Vector {
        // a = R(θ) e
        let axis = frame.outward(Vector::new(self.axis_x[slot], self.axis_y[slot]));
        let (x, y) = (d.x * axis.y - d.y * axis.x, d.dot(&axis));
        if x.abs() <= y * teeth.tan_half {
            return axis;
        }
        let [c, s] = teeth.pitch_turn;
        let s = if x > 0.0 { s } else { -s };
        Vector::new(c * axis.x + s * axis.y, c * axis.y - s * axis.x)
    }
}

/// A probe of the half on `side`, its normal turned from the gap's frame into the world.
#[inline]
fn in_world(mut probe: Probe, side: f64, axis: Vector) -> Probe {
    // The gap's x axis is its y axis turned by −90°.
    let (nx, ny) = (side * probe.normal.x, probe.normal.y);
    probe.normal = Vector::new(nx * axis.y + ny * axis.x, ny * axis.y - nx * axis.x);
    probe
}
