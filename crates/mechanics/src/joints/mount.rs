//! Wheels and rails as the other side of a contact: the coordinates that they move with.

use chaindrive_geometry::Vector;
use serde::{Deserialize, Serialize};

use crate::bodies::{Bodies, RailSupport, Wheel, WheelSupport};
use crate::seam::Way;

/// Coordinates that move a wheel or rail: those that shift its frame, and the one that turns it, counted from the first.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct Mount {
    /// (coordinate, shift of the frame's origin per unit); unused ones have none.
    pub(crate) shifts: [Option<(usize, Vector)>; 2],
    /// Coordinate of the rotation, and how far the frame turns with it.
    pub(crate) turn: Option<(usize, f64)>,
}

/// How a wheel can move.
pub(crate) fn wheel_mount(first: usize, wheel: &Wheel, way: Option<Way>) -> Mount {
    let border = |dof: usize| dof - first;
    let turned = wheel.turn.turned_by();
    let turn = turned.map(|(dof, ratio)| (border(dof), ratio));
    let shifts = match &wheel.support {
        WheelSupport::Fixed | WheelSupport::Prescribed { .. } => [None; 2],
        WheelSupport::Springs { dof, .. } => [
            Some((border(*dof), Vector::x())),
            Some((border(dof + 1), Vector::y())),
        ],
        WheelSupport::Carried(_) => [way.map(|way| (border(way.entry), way.first)), None],
    };
    Mount { shifts, turn }
}

/// How a rail can move.
pub(crate) fn rail_mount(
    (bodies, first): (&Bodies, usize),
    support: &RailSupport,
    way: Option<Way>,
) -> Mount {
    let border = |dof: usize| dof - first;
    let turn = match support {
        RailSupport::Carried(index) => bodies.slides[*index].turn(),
        RailSupport::Fixed | RailSupport::Prescribed { .. } => None,
    };
    Mount {
        shifts: [way.map(|way| (border(way.entry), way.first)), None],
        turn: turn.map(|(dof, ratio)| (border(dof), ratio)),
    }
}
