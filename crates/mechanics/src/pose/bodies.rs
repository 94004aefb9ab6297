//! Bodies of a figure: outlines in frames of their own.

use chaindrive_geometry::{ArcSpline, GeometryError, Piece, Point, Segment, Vector};

use super::{Body, BodyKind, backing, carried_bodies, forces};
use crate::drive::Parts;

/// Length of a drawn plunger in pitches: long enough to show which way it pushes.
const PLUNGER: f64 = 3.0;

/// The bodies of some parts, in the order of [`Figure::bodies`](super::Figure::bodies).
pub(super) fn of(parts: &Parts) -> Result<Vec<Body>, GeometryError> {
    let pitches = parts.chains.iter().map(|placed| placed.chain.pitch);
    let pitch = pitches.fold(0.0, f64::max);
    let mut bodies = Vec::new();
    for sprocket in &parts.sprockets {
        // The first gap of the outline lies on its y axis, that of the tolerance on its x axis.
        let [x, y] = sprocket.tolerance.eccentricity().into();
        let outline = sprocket.gap.outline()?;
        bodies.push(Body {
            name: sprocket.name.clone(),
            kind: BodyKind::Sprocket {
                teeth: sprocket.gap.teeth,
                pitch_radius: sprocket.gap.pitch_radius,
                tip_radius: sprocket.gap.tip_radius,
            },
            outlines: vec![seen_from(&outline, Point::new(y, -x))?],
            backing: Vec::new(),
        });
    }
    for guide in &parts.guides {
        let reference = parts.reference(&guide.support);
        let face = seen_from(&guide.face, reference)?;
        bodies.push(Body {
            name: guide.name.clone(),
            kind: BodyKind::Guide {
                touches: guide.touches,
            },
            backing: backing::behind(&face, pitch)?,
            outlines: vec![face],
        });
    }
    for (index, tensioner) in parts.tensioners.iter().enumerate() {
        let origin = tensioner.carrier.origin();
        let lines = tensioner
            .carrier
            .lines(&carried_bodies::by(parts, index), pitch);
        let lines = lines
            .into_iter()
            .map(|line| line.map(|p| p - origin.coords));
        let outlines: Result<_, _> = lines.filter_map(straight).collect();
        bodies.push(Body {
            name: tensioner.name.clone(),
            kind: BodyKind::Carrier {
                name: tensioner.carrier.name(),
                pivots: tensioner.carrier.turning() != 0.0,
            },
            outlines: outlines?,
            backing: Vec::new(),
        });
        if tensioner.carrier.plunger().is_some() {
            let rod = [Point::new(-PLUNGER * pitch, 0.0), Point::origin()];
            bodies.push(Body {
                name: tensioner.name.clone(),
                kind: BodyKind::Plunger,
                outlines: straight(rod).into_iter().collect::<Result<_, _>>()?,
                backing: Vec::new(),
            });
        }
    }
    bodies.extend(forces::arrows(parts, pitch)?);
    Ok(bodies)
}

/// A line seen from a point of its body.
fn seen_from(face: &ArcSpline, reference: Point) -> Result<ArcSpline, GeometryError> {
    if reference.coords == Vector::zeros() {
        return Ok(face.clone());
    }
    let pieces = face.pieces().iter();
    let pieces: Vec<_> = pieces
        .map(|piece| piece.translated(-reference.coords))
        .collect();
    if face.is_closed() {
        ArcSpline::closed(&pieces)
    } else {
        ArcSpline::open(&pieces)
    }
}

/// A straight line; none between points in one place.
fn straight([from, to]: [Point; 2]) -> Option<Result<ArcSpline, GeometryError>> {
    let apart = (to - from).norm() > 1e-9;
    apart.then(|| ArcSpline::open(&[Piece::from(Segment::new(from, to))]))
}
