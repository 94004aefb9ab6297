//! Arrows of forces on centres and carriers.

use chaindrive_geometry::{ArcSpline, GeometryError, Piece, Point, Segment};

use super::carried_bodies;
use super::places::entries;
use super::{Body, BodyKind, Figure, Instant, MissingChannel, Placement};
use crate::Forces;
use crate::drive::Parts;

/// Length of an arrow over the radius of the tips of its sprocket, and that of a carrier in pitches; that of the head over it: for the eye.
const BEYOND: f64 = 1.3;
const PITCHES: f64 = 5.0;
const HEAD: [f64; 2] = [0.18, 0.07];

/// The arrows of all bodies on which forces of the scene act.
pub(super) fn arrows(parts: &Parts, pitch: f64) -> Result<Vec<Body>, GeometryError> {
    let sprockets = parts.sprockets.iter();
    let sprockets = sprockets.map(|it| (&it.name, &it.forces, BEYOND * it.gap.tip_radius, false));
    let tensioners = parts.tensioners.iter();
    let tensioners = tensioners.map(|it| (&it.name, &it.forces, PITCHES * pitch, true));
    let forced = sprockets.chain(tensioners);
    let forced = forced.filter(|(_, forces, ..)| !forces.is_empty());
    forced
        .map(|(name, _, length, on_carrier)| {
            Ok(Body {
                name: name.clone(),
                kind: BodyKind::Force { on_carrier },
                outlines: arrow(length)?,
                backing: Vec::new(),
            })
        })
        .collect()
}

/// An arrow along x, from the origin.
fn arrow(length: f64) -> Result<Vec<ArcSpline>, GeometryError> {
    let tip = Point::new(length, 0.0);
    let [back, aside] = HEAD.map(|share| share * length);
    let barb = |side: f64| Point::new(length - back, side * aside);
    let line = |from: Point, to: Point| Piece::from(Segment::new(from, to));
    Ok(vec![
        ArcSpline::open(&[line(Point::origin(), tip)])?,
        ArcSpline::open(&[line(barb(1.0), tip), line(tip, barb(-1.0))])?,
    ])
}

impl Figure {
    /// Where the arrow of a force is.
    pub(super) fn force_arrow(
        &self,
        body: &Body,
        on_carrier: bool,
        at: &Instant<'_>,
    ) -> Result<Placement, MissingChannel> {
        let placed = |[x, y]: [f64; 2], [fx, fy]: [f64; 2]| Placement {
            x,
            y,
            angle: fy.atan2(fx),
        };
        if on_carrier {
            let index = self.tensioner(body);
            let tensioner = &self.parts.tensioners[index];
            let s = self.coordinate(index, at)?;
            let known = [at.carrier_force_x, at.carrier_force_y];
            let count = self.parts.tensioners.len();
            let force = force(known, (index, count), &tensioner.forces, at.time);
            // A slider is pushed where the first thing is that it carries.
            let carried = carried_bodies::by(&self.parts, index);
            let middle = |face: &&ArcSpline| face.point_at(0.5 * face.length());
            let first = carried.sprockets.first().map(|(centre, _)| *centre);
            let first = first.or_else(|| carried.faces.first().map(middle));
            let point = tensioner.forced_at.or(first).unwrap_or_else(Point::origin);
            return Ok(placed(tensioner.carrier.carry(s, point).0.into(), force));
        }
        let mut names = self.parts.sprockets.iter();
        let index = names.position(|it| it.name == body.name).unwrap_or(0);
        let known = [at.centre_force_x, at.centre_force_y];
        let count = self.parts.sprockets.len();
        let forces = &self.parts.sprockets[index].forces;
        let force = force(known, (index, count), forces, at.time);
        Ok(placed(self.centre(index, at)?.into(), force))
    }
}

/// The force that was recorded, or else that of the scene at this time where no shaft has turned.
fn force(
    known: [Option<&[f64]>; 2],
    (index, count): (usize, usize),
    forces: &Forces,
    time: f64,
) -> [f64; 2] {
    let [x, y] = known.map(|values| entries(values, "", count).ok().map(|it| it[index]));
    match (x, y) {
        (Some(x), Some(y)) => [x, y],
        _ => forces.unturned(time),
    }
}
