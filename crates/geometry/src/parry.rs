//! The bridge to the parry collision library: the only place that names its types.
//!
//! Inside, everything is nalgebra. Here parry's tree of boxes narrows a search down to a few
//! pieces, and an [`ArcSpline`](crate::ArcSpline) becomes one of parry's shapes.

mod dispatcher;
mod shape;
mod tree;

pub use dispatcher::RollerDispatcher;
pub(crate) use tree::Tree;

use parry2d_f64::math;

fn to_parry(p: crate::Point) -> math::Vector {
    math::Vector::new(p.x, p.y)
}

fn from_parry(p: math::Vector) -> crate::Point {
    crate::Point::new(p.x, p.y)
}

fn direction_to_parry(v: crate::Vector) -> math::Vector {
    math::Vector::new(v.x, v.y)
}

fn direction_from_parry(v: math::Vector) -> crate::Vector {
    crate::Vector::new(v.x, v.y)
}
