//! The bridge to the parry collision library: the only place that names its types.
//!
//! Inside, everything is nalgebra. Parry's tree of boxes narrows every question about a whole profile, nearest points
//! and clearances alike, down to a few pieces; what is asked of a piece is exact.

mod tree;

pub(crate) use tree::Tree;

use parry2d_f64::math;

fn to_parry(p: crate::Point) -> math::Vector {
    math::Vector::new(p.x, p.y)
}
