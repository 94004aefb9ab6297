//! The stops of a route as wheels, at rest and moved.

use chaindrive_geometry::{ArcSpline, Piece, Point, Side, Vector, Wheel, WheelKind};

use crate::drive::{Adjust, Guide, GuideSupport, Layout, Parts, Stop, Support, Touches};
use crate::{AssemblyError, Chain, Drive};

impl Drive {
    /// The stops of a chain's route as wheels, with a body moved by `travel` \[m, or rad for an arm\] from where it is described.
    ///
    /// None for a chain that lies along no route. What earlier chains adjust stands where it is described.
    ///
    /// # Errors
    /// A guide on the route that has no bulging arc.
    ///
    /// # Panics
    /// There is no such chain.
    pub fn wheels(
        &self,
        chain: usize,
        moved: &Adjust,
        travel: f64,
    ) -> Result<Option<Vec<Wheel>>, AssemblyError> {
        let placed = &self.parts().chains[chain];
        let Layout::Route { stops, .. } = &placed.layout else {
            return Ok(None);
        };
        let parts = shifted(self.parts(), moved, travel)?;
        wheels(&parts, &placed.chain, stops).map(Some)
    }
}

impl Touches {
    /// Radius \[m\] of the circle that the centres of the rollers ride on over an arc of radius `face` \[m\]; `size`: pitch, roller
    /// diameter and plate height of the chain \[m\].
    ///
    /// ```text
    /// rollers R + d/2        eyes R + h/2        plates √((R + h/2)² + (p/2)²)
    /// ```
    pub fn ride(self, face: f64, [pitch, roller_diameter, plate_height]: [f64; 3]) -> f64 {
        match self {
            Self::Rollers => face + 0.5 * roller_diameter,
            Self::Eyes => face + 0.5 * plate_height,
            // R_v = √((R + h/2)² + (p/2)²): the straight edge touches between the eyes.
            Self::Plates => (face + 0.5 * plate_height).hypot(0.5 * pitch),
        }
    }
}

/// The stops as wheels of the route.
pub(super) fn wheels(
    parts: &Parts,
    chain: &Chain,
    stops: &[Stop],
) -> Result<Vec<Wheel>, AssemblyError> {
    let centre = |stop: &Stop| match stop {
        Stop::Sprocket(i) => parts.sprockets[*i].centre,
        Stop::Guide(i) => {
            let pieces = parts.guides[*i].face.pieces();
            pieces[pieces.len() / 2].point(0.5)
        }
    };
    stops
        .iter()
        .enumerate()
        .map(|(place, stop)| match stop {
            Stop::Sprocket(index) => {
                let sprocket = &parts.sprockets[*index];
                Ok(Wheel {
                    centre: sprocket.centre,
                    radius: sprocket.gap.pitch_radius,
                    side: sprocket.side,
                    kind: WheelKind::Toothed {
                        teeth: sprocket.gap.teeth,
                    },
                })
            }
            Stop::Guide(index) => {
                let before = centre(&stops[(place + stops.len() - 1) % stops.len()]);
                let after = centre(&stops[(place + 1) % stops.len()]);
                guide_wheel(&parts.guides[*index], chain, after - before)
            }
        })
        .collect()
}

/// The longest bulging arc of a guide as a smooth wheel of the route.
fn guide_wheel(guide: &Guide, chain: &Chain, travel: Vector) -> Result<Wheel, AssemblyError> {
    let arcs = guide.face.pieces().iter().filter_map(|piece| match piece {
        Piece::Arc(arc) if arc.sweep > 0.0 => Some(arc),
        _ => None,
    });
    let longest = arcs.max_by(|a, b| (a.radius * a.sweep).total_cmp(&(b.radius * b.sweep)));
    let arc = longest.ok_or_else(|| AssemblyError::Guide {
        guide: guide.name.clone(),
        problem: "has no bulging arc that a chain could follow; give its face one, or take it off the route".into(),
    })?;
    let size = [chain.pitch, chain.roller_diameter, chain.plate_height];
    let radius = guide.touches.ride(arc.radius, size);
    let middle = arc.start_angle + 0.5 * arc.sweep;
    let normal = Vector::new(middle.cos(), middle.sin());
    // The chain passes on the side of the normal: the wheel lies left where that is the right.
    let normal_is_left = travel.x * normal.y - travel.y * normal.x > 0.0;
    Ok(Wheel {
        centre: arc.centre,
        radius,
        side: if normal_is_left {
            Side::Right
        } else {
            Side::Left
        },
        kind: WheelKind::Smooth,
    })
}

/// The parts with the adjusted body, and all it carries, moved by `travel`.
pub(super) fn shifted(parts: &Parts, adjust: &Adjust, travel: f64) -> Result<Parts, AssemblyError> {
    let mut parts = parts.clone();
    match adjust {
        Adjust::Nothing => {}
        Adjust::Sprocket {
            sprocket,
            direction,
            ..
        } => {
            parts.sprockets[*sprocket].centre += direction.normalize() * travel;
        }
        Adjust::Tensioner { tensioner, .. } => {
            let carrier = parts.tensioners[*tensioner].carrier;
            for sprocket in &mut parts.sprockets {
                if sprocket.support == Support::Tensioner(*tensioner) {
                    sprocket.centre = carrier.carry(travel, sprocket.centre).0;
                }
            }
            for guide in &mut parts.guides {
                if guide.support == GuideSupport::Tensioner(*tensioner) {
                    guide.face = carrier.carry_face(travel, &guide.face)?;
                }
            }
            let own = &mut parts.tensioners[*tensioner];
            own.carrier = carrier.assembled_at(travel);
            own.forced_at = own.forced_at.map(|at| carrier.carry(travel, at).0);
        }
    }
    Ok(parts)
}

/// The parts where a frame that grows by `growth` takes them, about the origin.
///
/// ```text
/// x ← x (1 + g)      centres of sprockets, pivots of arms, middles of guides
/// ```
///
/// Bodies keep their shapes, for they do not grow with the frame: what an arm or a slide carries moves with its pivot, or as its first body does.
pub(super) fn grown(parts: &Parts, growth: f64) -> Result<Parts, AssemblyError> {
    let mut parts = parts.clone();
    let way = |place: Point| place.coords * growth;
    let middle = |face: &ArcSpline| face.point_at(0.5 * face.length());
    let carried_by = |index: usize| {
        let mut sprockets = parts.sprockets.iter();
        let sprocket = sprockets.find(|it| it.support == Support::Tensioner(index));
        let mut guides = parts.guides.iter();
        let guide = guides.find(|it| it.support == GuideSupport::Tensioner(index));
        let first = sprocket.map(|it| it.centre);
        first.or_else(|| guide.map(|it| middle(&it.face)))
    };
    let carriers = parts.tensioners.iter().enumerate();
    let carriers: Vec<Vector> = carriers
        .map(|(index, it)| it.carrier.pivot().or_else(|| carried_by(index)))
        .map(|place| place.map_or_else(Vector::zeros, way))
        .collect();
    for sprocket in &mut parts.sprockets {
        sprocket.centre += match sprocket.support {
            Support::Tensioner(index) => carriers[index],
            _ => way(sprocket.centre),
        };
    }
    for guide in &mut parts.guides {
        let by = match guide.support {
            GuideSupport::Tensioner(index) => carriers[index],
            _ => way(middle(&guide.face)),
        };
        let pieces = guide.face.pieces().iter().map(|it| it.translated(by));
        guide.face = ArcSpline::open(&pieces.collect::<Vec<_>>())?;
    }
    for (tensioner, by) in parts.tensioners.iter_mut().zip(carriers) {
        tensioner.carrier = tensioner.carrier.translated(by);
        tensioner.forced_at = tensioner.forced_at.map(|at| at + by);
    }
    Ok(parts)
}
