//! Plane curves of straight segments and circular arcs, and what is nearest to them.
//!
//! Sprocket teeth, guide rails and chain routes are built from the same two pieces, a [`Segment`]
//! and an [`Arc`], kept exact: a facetted tooth would put noise into every contact force.
//!
//! # Conventions
//!
//! - Lengths in metres, angles in radians, counter-clockwise positive.
//! - A curve has a direction of travel, and the **material lies on its left**. A closed solid
//!   therefore runs counter-clockwise.
//! - The outward normal points out of the material, to the right of travel: n = (t_y, −t_x).
//! - A signed distance is positive in the void and negative inside the material.
//! - A signed curvature is positive where the material is convex (a counter-clockwise arc),
//!   negative in a concave seat (a clockwise arc), zero on a segment.
//!
//! # Example
//!
//! A roller resting in the gap of a 25-tooth sprocket for a 16B chain:
//!
//! ```
//! use chaindrive_geometry::{ArcSpline, Point, Seat, Tip, ToothForm, ToothGap};
//!
//! # fn main() -> Result<(), chaindrive_geometry::GeometryError> {
//! let form = ToothForm::Iso606 { gap: 0.5, tip: Tip::Mid, seat: Seat::Bottom };
//! let gap = ToothGap::new(25, 25.4e-3, 15.88e-3, &form)?;
//! let face = ArcSpline::open(gap.pieces())?;
//!
//! let roller = Point::new(0.0, gap.pitch_radius);
//! let foot = face.nearest(roller, f64::INFINITY).expect("nothing is out of reach");
//! assert!((foot.distance - 0.5 * gap.roller_diameter).abs() < 1e-15);
//! # Ok(())
//! # }
//! ```

/// A position in the plane \[m\].
pub type Point = nalgebra::Point2<f64>;
/// A displacement or a direction in the plane.
pub type Vector = nalgebra::Vector2<f64>;

// Curves, teeth and rails.
mod arc;
mod arc_spline;
mod area;
mod bulges;
mod clearance;
mod closest;
mod crossings;
mod error;
mod fit;
mod parry;
mod piece;
mod polyline;
mod rail;
mod segment;
mod tooth;

pub use arc::{Arc, Turn};
pub use arc_spline::{ArcSpline, Corner};
pub use area::AreaMoments;
pub use clearance::Clearance;
pub use closest::Foot;
pub use crossings::Crossing;
pub use error::{GeometryError, Remedy};
pub use fit::{biarc, fit_arcs};
pub use piece::{BoundingBox, Piece};
pub use rail::{bar, rail};
pub use segment::Segment;
pub use tooth::{Seat, Tip, ToothForm, ToothGap};

// Routes, link counts and polygonal kinematics.
mod closing;
mod on_span;
mod plan;
mod polygon_action;
mod rearranged;
mod route;
mod two_wheels;

pub use closing::{
    Closing, LinkCounts, RollerPlace, Search, Seating, close_by_motion, close_by_strain,
    close_nearest, close_with_slack, closing_strains,
};
pub use on_span::{CurvedGuide, IdlerByWrap};
pub use plan::{Plan, Station};
pub use polygon_action::{
    ChordalAction, DrivenState, PolygonAction, PressureAngles, SeatingVelocity, mesh_frequency,
};
pub use rearranged::{Rearranged, rearrangements};
pub use route::{Route, Side, Span, Wheel, WheelKind};
pub use two_wheels::TwoWheels;

/// Hash of the sources of this crate, a part of the identity of a build.
#[doc(hidden)]
pub const SOURCES: &str = env!("CHAINDRIVE_SOURCES");
