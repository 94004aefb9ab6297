//! The straight piece.

use crate::{GeometryError, Point, Vector};

/// A straight segment, travelled from start to end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// Where it starts \[m\].
    pub start: Point,
    /// Where it ends \[m\].
    pub end: Point,
}

impl Segment {
    /// Segment between two points \[m\].
    pub fn new(start: Point, end: Point) -> Self {
        Self { start, end }
    }

    /// Refuses coordinates that are not finite.
    ///
    /// # Errors
    /// [`GeometryError::NotFinite`] names the first coordinate that is not.
    pub fn check(&self) -> Result<(), GeometryError> {
        GeometryError::finite("segment start x", self.start.x)?;
        GeometryError::finite("segment start y", self.start.y)?;
        GeometryError::finite("segment end x", self.end.x)?;
        GeometryError::finite("segment end y", self.end.y)
    }

    /// Length \[m\].
    pub fn length(&self) -> f64 {
        (self.end - self.start).norm()
    }

    /// Unit direction of travel; zero for a segment without length.
    pub fn tangent(&self) -> Vector {
        (self.end - self.start)
            .try_normalize(0.0)
            .unwrap_or_default()
    }

    /// Point at a fraction of the length, 0 at the start and 1 at the end \[m\].
    pub fn point(&self, parameter: f64) -> Point {
        self.start + (self.end - self.start) * parameter
    }

    /// Fraction of the length at which the perpendicular from `p` meets the segment, if inside.
    pub fn foot(&self, p: Point) -> Option<f64> {
        let along = self.end - self.start;
        // s = (p − a)·(b − a) / |b − a|²
        let s = (p - self.start).dot(&along) / along.norm_squared();
        (s > 0.0 && s < 1.0).then_some(s)
    }
}
