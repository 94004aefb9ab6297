//! Tooth forms.

use chaindrive_geometry::{
    Arc, GeometryError, Piece, Point, Seat, Segment, Tip, ToothForm, Turn, fit_arcs,
};

use serde_json::json;

use super::cursor::Cursor;
use super::point;
use crate::scene::defaults;
use crate::scene::schema::{self, PathPiece, TipForm, Tooth};
use chaindrive_quantities::Length;

/// The tooth form of a sprocket at `path`.
pub(super) fn form(
    tooth: Option<&Tooth>,
    pitch: f64,
    roller_diameter: f64,
    mut at: Cursor<'_, '_>,
) -> Option<ToothForm> {
    let mut tip = |form: TipForm, diameter: Option<Length>| match (form, diameter) {
        (TipForm::Mid, Some(diameter)) => Some(Tip::Diameter(diameter.0)),
        (_, Some(_)) => {
            at.key("tip_diameter")
                .refuse("`tip` is given too", "keep one of them");
            None
        }
        (TipForm::Min, None) => Some(Tip::Minimum),
        (TipForm::Mid, None) => Some(Tip::Mid),
        (TipForm::Max, None) => Some(Tip::Maximum),
    };
    let Some(tooth) = tooth else {
        let gap = defaults::GAP.value;
        let text = json!({"kind": "iso606", "gap": gap, "tip": "mid", "seat": "bottom"});
        at.assume(text, defaults::GAP.basis.remark());
        return Some(ToothForm::Iso606 {
            gap,
            tip: Tip::Mid,
            seat: Seat::Bottom,
        });
    };
    Some(match tooth {
        Tooth::Iso606 {
            gap,
            tip: form,
            tip_diameter,
            seat,
        } => ToothForm::Iso606 {
            gap: gap.0,
            tip: tip(*form, *tip_diameter)?,
            seat: seat_of(*seat),
        },
        Tooth::AsaTypeIi {
            tip: form,
            tip_diameter,
        } => ToothForm::AsaTypeII {
            tip: tip(*form, *tip_diameter)?,
        },
        Tooth::Circular {
            seat_radius,
            tip: form,
            tip_diameter,
            seat,
        } => ToothForm::Circular {
            tip: tip(*form, *tip_diameter)?,
            seat_radius: at.key("seat_radius").or_multiple(
                *seat_radius,
                &defaults::SEAT_RADIUS,
                roller_diameter,
            ),
            seat: seat_of(*seat),
        },
        Tooth::Path { from, pieces } => ToothForm::Path {
            pieces: path_of(point(*from), pieces, at.key("pieces"))?,
        },
        Tooth::Points { points, tolerance } => {
            let points: Vec<Point> = points.iter().copied().map(point).collect();
            let tolerance =
                at.key("tolerance")
                    .or_multiple(*tolerance, &defaults::TOLERANCE, pitch);
            let pieces = fit_arcs(&points, false, tolerance);
            ToothForm::Path {
                pieces: at.key("points").keep(pieces)?,
            }
        }
    })
}

fn seat_of(seat: schema::Seat) -> Seat {
    match seat {
        schema::Seat::Bottom => Seat::Bottom,
        schema::Seat::Pitch => Seat::Pitch,
    }
}

fn path_of(from: Point, pieces: &[PathPiece], mut at: Cursor<'_, '_>) -> Option<Vec<Piece>> {
    let mut start = from;
    let mut drawn = Vec::new();
    for (index, piece) in pieces.iter().enumerate() {
        let (end, next) = match piece {
            PathPiece::Line { to } => (point(*to), Ok(Segment::new(start, point(*to)).into())),
            PathPiece::Arc { to, radius } => (point(*to), arc(start, point(*to), radius.0)),
        };
        drawn.push(at.entry(index).keep(next)?);
        start = end;
    }
    Some(drawn)
}

/// The arc of less than a half turn with this signed radius.
fn arc(start: Point, end: Point, radius: f64) -> Result<Piece, GeometryError> {
    let chord = end - start;
    let height = radius * radius - 0.25 * chord.norm_squared();
    if height < 0.0 || radius == 0.0 {
        return Err(GeometryError::OutOfRange {
            what: "radius of an arc [m]",
            value: radius,
            allowed: "at least half the distance of its ends",
        });
    }
    let left = chord.try_normalize(0.0).unwrap_or_default();
    let left = chaindrive_geometry::Vector::new(-left.y, left.x);
    let turn = if radius > 0.0 {
        Turn::Left
    } else {
        Turn::Right
    };
    let centre = start + 0.5 * chord + left * (height.sqrt() * radius.signum());
    Arc::between(start, end, centre, turn).map(Piece::Arc)
}
