//! Completing a gap from its left half: the tip, and the mirror image.

use std::f64::consts::FRAC_PI_2;

use super::Wheel;
use crate::{Arc, GeometryError, Piece, Point, Segment, Vector};

/// The last curve of a flank, still without an end.
#[derive(Clone, Copy, Debug)]
pub(super) enum Flank {
    /// Convex arc about a centre \[m\] with a radius \[m\], from an angle \[rad\] onwards.
    Arc(Point, f64, f64),
    /// Straight line from a point \[m\] in a direction.
    Line(Point, Vector),
}

/// A flank cut off by the tip circle or, if it comes first, by the tooth's centre line.
pub(super) struct Tooth {
    /// The flank, and the half of the tip on this side if there is one.
    pub(super) pieces: Vec<Piece>,
    pub(super) tip_radius: f64,
    pub(super) pointed: bool,
}

/// Cuts off the left flank of a gap at a tip radius \[m\] or at the tooth's centre line.
pub(super) fn cut(wheel: &Wheel, flank: Flank, asked: f64) -> Result<Tooth, GeometryError> {
    let (sine, cosine) = wheel.half_angle.sin_cos();
    let tooth_axis = Vector::new(-sine, cosine);
    let start = flank.start();
    let least = start.coords.norm();
    if asked <= least {
        return Err(wheel.refuse(
            "the tip radius",
            asked,
            format!("above the start of the flank, {least} m"),
        ));
    }
    let point = flank.meets_axis(tooth_axis).unwrap_or(f64::INFINITY);
    if point <= least {
        return Err(wheel.refuse(
            "the radius at which the flanks meet",
            point,
            format!("above the start of the flank, {least} m"),
        ));
    }
    // So close below the point that the land would be too narrow to be a piece.
    let pointed = asked >= point * (1.0 - 1e-7);
    let tip_radius = if pointed { point } else { asked };
    let end = if pointed {
        Some(Point::from(tooth_axis * point))
    } else {
        flank.meets_circle(tip_radius)
    };
    // Angle from the gap axis to the end of the flank, and what is left of half a pitch.
    let land = |end: Point| wheel.half_angle - (-end.x).atan2(end.y);
    let end = end
        .filter(|&end| end.x < 0.0 && (pointed || land(end) > 0.0))
        .ok_or_else(|| wheel.refuse("the tip radius", asked, "within reach of the flank".into()))?;
    let mut pieces = vec![flank.up_to(end)];
    if !pointed {
        let tip = Arc {
            centre: Point::origin(),
            radius: tip_radius,
            start_angle: FRAC_PI_2 + wheel.half_angle - land(end),
            sweep: land(end),
        };
        pieces.push(tip.into());
    }
    Ok(Tooth {
        pieces,
        tip_radius,
        pointed,
    })
}

/// Seat arc about (0, height) from right to left, through an angle either side of straight down.
pub(super) fn seat_arc(height: f64, radius: f64, half_seat: f64) -> Piece {
    Piece::Arc(Arc {
        centre: Point::new(0.0, height),
        radius,
        start_angle: half_seat - FRAC_PI_2,
        sweep: -2.0 * half_seat,
    })
}

/// A whole gap from its seat and its left half, seat to tip.
pub(super) fn mirrored(seat: Piece, left: Vec<Piece>) -> Vec<Piece> {
    let right = left.iter().rev().map(|piece| piece.mirrored_x().reversed());
    let mut pieces: Vec<_> = right.chain(std::iter::once(seat)).collect();
    pieces.extend(left);
    pieces
}

impl Flank {
    fn start(&self) -> Point {
        match *self {
            Self::Arc(centre, radius, angle) => {
                centre + radius * Vector::new(angle.cos(), angle.sin())
            }
            Self::Line(start, _) => start,
        }
    }

    /// Distance from the wheel centre at which the flank meets a ray from it, if it does.
    fn meets_axis(&self, ray: Vector) -> Option<f64> {
        match *self {
            Self::Arc(centre, radius, _) => {
                // |s g − c| = r at its outer crossing: s = c·g + √(r² − (c × g)²)
                let half = radius * radius - centre.coords.perp(&ray).powi(2);
                (half >= 0.0).then(|| centre.coords.dot(&ray) + half.sqrt())
            }
            Self::Line(start, along) => {
                // (a + u t) × g = 0
                let distance = -start.coords.perp(&ray) / along.perp(&ray);
                (distance > 0.0).then(|| (start + along * distance).coords.dot(&ray))
            }
        }
    }

    /// Where the flank meets a circle about the wheel centre, nearest to the gap.
    fn meets_circle(&self, tip_radius: f64) -> Option<Point> {
        match *self {
            Self::Arc(centre, radius, _) => {
                // On the line of centres at a = (R² − r² + D²) / (2 D), off it by ±√(R² − a²)
                let between = centre.coords.norm();
                let along = centre.coords / between;
                let foot =
                    (tip_radius.powi(2) - radius * radius + between * between) / (2.0 * between);
                let off = tip_radius.powi(2) - foot * foot;
                let right = Vector::new(along.y, -along.x);
                (off >= 0.0).then(|| Point::from(along * foot + right * off.sqrt()))
            }
            Self::Line(start, along) => {
                // |a + u t|² = R², t > 0
                let b = start.coords.dot(&along);
                let root = b * b + tip_radius.powi(2) - start.coords.norm_squared();
                (root >= 0.0).then(|| start + along * (root.sqrt() - b))
            }
        }
    }

    fn up_to(&self, end: Point) -> Piece {
        match *self {
            Self::Arc(centre, radius, start_angle) => {
                let arc = Arc {
                    centre,
                    radius,
                    start_angle,
                    sweep: std::f64::consts::TAU,
                };
                Piece::Arc(Arc {
                    sweep: arc.parameter(end) * arc.sweep,
                    ..arc
                })
            }
            Self::Line(start, _) => Segment::new(start, end).into(),
        }
    }
}
