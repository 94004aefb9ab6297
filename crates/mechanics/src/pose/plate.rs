//! The outline of a link plate.

use std::f64::consts::{FRAC_PI_2, PI};

use chaindrive_geometry::{Arc, ArcSpline, GeometryError, Piece, Point, Segment};

use super::{FigureChain, PlateShape};

/// Height of the waist of a plate in that of its eyes: no scene says it, and nothing touches it.
const WAIST: f64 = 0.72;

impl FigureChain {
    /// Outline of a plate whose ends are `length` \[m\] apart: the first end at the origin, the second on the x axis.
    ///
    /// ```text
    /// waist: radius ρ about (ℓ/2, ± (w + ρ)), tangent to both eyes:   (ℓ/2)² + (w + ρ)² = (h/2 + ρ)²
    /// ```
    ///
    /// # Errors
    /// A length that is not positive.
    pub fn plate(&self, length: f64) -> Result<ArcSpline, GeometryError> {
        let eye = 0.5 * self.plate_height;
        let half = 0.5 * length;
        // Eyes that reach beyond the middle leave no room for a waist.
        let pieces = if self.plates == PlateShape::Waisted && eye < half {
            waisted(half, eye)
        } else {
            straight(length, eye)
        };
        ArcSpline::closed(&pieces)
    }
}

fn waisted(half: f64, eye: f64) -> [Piece; 4] {
    let waist = WAIST * eye;
    // ρ = ((ℓ/2)² + w² − (h/2)²) / (h − 2 w)
    let radius = (half * half + waist * waist - eye * eye) / (2.0 * (eye - waist));
    // Direction from an eye to the centre of the waist.
    let rise = (waist + radius).atan2(half);
    let arc = |x: f64, y: f64, radius: f64, start_angle: f64, sweep: f64| {
        Piece::Arc(Arc {
            centre: Point::new(x, y),
            radius,
            start_angle,
            sweep,
        })
    };
    let around = 2.0 * (PI - rise);
    let between = -(PI - 2.0 * rise);
    [
        arc(0.0, 0.0, eye, rise, around),
        arc(half, -(waist + radius), radius, PI - rise, between),
        arc(2.0 * half, 0.0, eye, rise - PI, around),
        arc(half, waist + radius, radius, -rise, between),
    ]
}

fn straight(length: f64, eye: f64) -> [Piece; 4] {
    let round = |x: f64, start_angle: f64| {
        Piece::Arc(Arc {
            centre: Point::new(x, 0.0),
            radius: eye,
            start_angle,
            sweep: PI,
        })
    };
    let edge = |from: f64, to: f64, y: f64| {
        Piece::from(Segment::new(Point::new(from, y), Point::new(to, y)))
    };
    [
        round(0.0, FRAC_PI_2),
        edge(0.0, length, -eye),
        round(length, -FRAC_PI_2),
        edge(length, 0.0, eye),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chain(plates: PlateShape) -> FigureChain {
        FigureChain {
            name: None,
            closed: true,
            rollers: 4,
            joints: 0,
            links: 4,
            pitch: 12.7e-3,
            roller_diameter: 7.75e-3,
            pin_diameter: None,
            plate_height: 11.8e-3,
            plates,
            outer_first: false,
            spans: Vec::new(),
            sprockets: Vec::new(),
            guides: Vec::new(),
        }
    }

    /// The eyes are circles of the plate height about the ends, and no edge of a straight plate is nearer than half of it.
    #[test]
    fn plates_have_the_height_that_guides_touch() {
        for plates in [PlateShape::Waisted, PlateShape::Straight] {
            for length in [12.7e-3, 13.1e-3] {
                let outline = chain(plates).plate(length).expect("a plate");
                for end in [Point::origin(), Point::new(length, 0.0)] {
                    let foot = outline.nearest(end, 1.0).expect("near");
                    assert!((foot.distance + 5.9e-3).abs() < 1e-12, "{plates:?}");
                }
                let middle = Point::new(0.5 * length, 0.0);
                let foot = outline.nearest(middle, 1.0).expect("near");
                let expected = match plates {
                    PlateShape::Waisted => WAIST * 5.9e-3,
                    PlateShape::Straight => 5.9e-3,
                };
                assert!((foot.distance + expected).abs() < 1e-12, "{plates:?}");
            }
        }
    }
}
