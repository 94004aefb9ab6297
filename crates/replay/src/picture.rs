//! A drive as pages show it: outlines that stay the same, and their places at an instant.

use std::f64::consts::TAU;

use chaindrive::{
    BodyKind, Figure, FigureChain, Instant, MissingChannel, Placement, PlateShape, Pose,
};
use chaindrive_geometry::{ArcSpline, GeometryError, Point};

use crate::animation::{Body, Chain, Outline};

/// Largest distance of chords from outlines, in pitches: a tenth of a pixel where a pitch fills the window.
const CHORDS: f64 = 1e-4;

/// A figure drawn with chords, at one instant after the other.
#[derive(Clone, Debug)]
pub struct Picture {
    /// Sprockets, guides, arms: all that has an outline.
    pub bodies: Vec<Body>,
    /// The chains, in the order of their rollers.
    pub chains: Vec<Chain>,
    figure: Figure,
    /// Place \[m\] and angle \[rad\] of every body, (body, 3).
    placements: Vec<f64>,
    /// Directions in which teeth press on rollers \[rad\], (roller,): normals of the teeth where they are nearest.
    directions: Vec<f64>,
}

impl Picture {
    /// The picture of a figure, at its start.
    ///
    /// # Errors
    /// An outline that is none, which figures of checked drives do not have.
    pub fn of(figure: Figure) -> Result<Self, GeometryError> {
        let pitches = figure.chains.iter().map(|chain| chain.pitch);
        let chords = CHORDS * pitches.fold(f64::INFINITY, f64::min);
        let bodies = figure.bodies.iter().map(|body| shown_body(body, chords));
        let chains: Vec<Chain> = figure.chains.iter().map(shown_chain).collect();
        let rollers = chains.iter().map(|chain| chain.rollers).sum();
        let mut picture = Self {
            bodies: bodies.collect::<Result<_, _>>()?,
            chains,
            placements: Vec::new(),
            directions: vec![0.0; rollers],
            figure,
        };
        let start = picture.figure.start();
        picture.place(&start);
        Ok(picture)
    }

    /// Moves bodies and arrows to where they are at an instant; `forces`: of teeth on rollers \[N\], (roller,).
    ///
    /// # Errors
    /// The instant lacks a channel.
    pub fn move_to(
        &mut self,
        at: &Instant<'_>,
        forces: Option<&[f64]>,
    ) -> Result<(), MissingChannel> {
        let pose = self.figure.pose(at)?;
        self.place(&pose);
        if let Some(forces) = forces {
            self.turn_arrows(&pose, forces);
        }
        Ok(())
    }

    /// The figure that it shows.
    pub fn figure(&self) -> &Figure {
        &self.figure
    }

    /// Place \[m\] and angle \[rad\] of every body, (body, 3).
    pub fn placements(&self) -> &[f64] {
        &self.placements
    }

    /// Directions in which teeth press on rollers \[rad\], (roller,); where nothing presses, the last one before.
    pub fn directions(&self) -> &[f64] {
        &self.directions
    }

    fn place(&mut self, pose: &Pose) {
        self.placements.clear();
        let placed = pose.placements.iter();
        self.placements
            .extend(placed.flat_map(|it| [it.x, it.y, it.angle]));
    }

    fn turn_arrows(&mut self, pose: &Pose, forces: &[f64]) {
        let mut roller = 0;
        for (chain, places) in self.figure.chains.iter().zip(&pose.rollers) {
            for &place in places {
                if forces.get(roller).is_some_and(|force| *force > 0.0) {
                    let nearest = chain.sprockets.iter().filter_map(|&sprocket| {
                        let reach = chain.roller_diameter;
                        normal(
                            &self.figure.bodies[sprocket],
                            &pose.placements[sprocket],
                            place,
                            reach,
                        )
                    });
                    let found = nearest.min_by(|a, b| a.0.total_cmp(&b.0));
                    let last = &mut self.directions[roller];
                    if let Some((_, direction)) = found {
                        // The turn that is nearest to the last direction, so that few numbers change.
                        *last += (direction - *last + 0.5 * TAU).rem_euclid(TAU) - 0.5 * TAU;
                    }
                }
                roller += 1;
            }
        }
    }
}

fn shown_body(body: &chaindrive::Body, chords: f64) -> Result<Body, GeometryError> {
    let line = |curve: &ArcSpline, is_closed: bool| {
        let points = curve.polyline(chords)?;
        let points = points.iter().map(|point| [point.x, point.y]).collect();
        Ok(Outline { points, is_closed })
    };
    let is_sprocket = matches!(body.kind, BodyKind::Sprocket { .. });
    let mut outlines = Vec::new();
    if !body.backing.is_empty() {
        outlines.push(Outline {
            points: body
                .backing
                .iter()
                .map(|point| [point.x, point.y])
                .collect(),
            is_closed: true,
        });
    }
    for outline in &body.outlines {
        outlines.push(line(outline, is_sprocket)?);
    }
    Ok(Body {
        name: body.name.clone(),
        kind: body.kind.name().to_owned(),
        outlines,
    })
}

fn shown_chain(chain: &FigureChain) -> Chain {
    Chain {
        name: chain.name.clone().unwrap_or_default(),
        rollers: chain.rollers,
        links: chain.links,
        pitch: chain.pitch,
        roller_radius: 0.5 * chain.roller_diameter,
        plate_height: chain.plate_height,
        is_waisted: chain.plates == PlateShape::Waisted,
        is_outer_first: chain.outer_first,
    }
}

/// Distance of the teeth of a sprocket, and the direction of their normal there.
fn normal(
    body: &chaindrive::Body,
    placement: &Placement,
    place: Point,
    reach: f64,
) -> Option<(f64, f64)> {
    let BodyKind::Sprocket { tip_radius, .. } = body.kind else {
        return None;
    };
    let away = place - Point::new(placement.x, placement.y);
    if away.norm() > tip_radius + reach {
        return None;
    }
    let (sin, cos) = placement.angle.sin_cos();
    let own = Point::new(cos * away.x + sin * away.y, cos * away.y - sin * away.x);
    let feet = body.outlines.iter().filter_map(|it| it.nearest(own, reach));
    let foot = feet.min_by(|a, b| a.distance.total_cmp(&b.distance))?;
    Some((
        foot.distance,
        foot.normal.y.atan2(foot.normal.x) + placement.angle,
    ))
}
