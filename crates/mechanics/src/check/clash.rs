//! Bodies in each other's way, and chains that run through guides.
//!
//! Only what lies in one plane can clash: what some chain can touch both of. A sprocket takes the room that its tips sweep
//! in a turn. The face of a guide is a line whose material lies behind it, however thick: so what cuts into a guide is what
//! crosses its face.

use chaindrive_geometry::{ArcSpline, Piece, Point, Segment};

use crate::body_positions::BodyPositions;
use crate::drive::{GuideSupport, Parts, PlacedChain, Support, Touches};
use crate::{Clash, DriveError, Ends};

/// Overlaps below this \[m\] are touching: the scale of roughness and rounding.
const TOUCHING: f64 = 1e-6;

/// Everything in one another's way where the bodies stand so and the rollers of the chains lie there.
pub(crate) fn clashes(
    parts: &Parts,
    standing: &BodyPositions,
    rollers: &[Vec<Point>],
) -> Vec<Clash> {
    let centres = standing.sprockets.iter().map(|(centre, _)| *centre);
    let mut found = sprockets(parts, &centres.collect::<Vec<_>>());
    found.extend(teeth(parts, standing));
    found.extend(guides(parts, standing));
    for (index, placed) in parts.chains.iter().enumerate() {
        for &guide in &placed.guides {
            found.extend(through(
                parts,
                index,
                guide,
                &standing.faces[guide],
                &rollers[index],
            ));
        }
    }
    found
}

/// Sprockets as described whose teeth sweep through each other.
pub(super) fn overlaps(parts: &Parts) -> impl Iterator<Item = DriveError> {
    let centres: Vec<Point> = parts.sprockets.iter().map(|s| s.centre).collect();
    let found = sprockets(parts, &centres).into_iter();
    found.filter_map(|clash| match clash {
        Clash::Sprockets {
            first,
            second,
            depth,
            ..
        } => Some(DriveError::Overlap {
            first,
            second,
            overlap: depth,
        }),
        _ => None,
    })
}

/// Whether some chain can touch both bodies, or there is only one plane.
fn in_one_plane(parts: &Parts, both: impl Fn(&PlacedChain) -> bool) -> bool {
    parts.chains.len() <= 1 || parts.chains.iter().any(both)
}

fn sprockets(parts: &Parts, centres: &[Point]) -> Vec<Clash> {
    let mut found = Vec::new();
    for (i, first) in parts.sprockets.iter().enumerate() {
        for (j, second) in parts.sprockets.iter().enumerate().skip(i + 1) {
            let both =
                |chain: &PlacedChain| chain.sprockets.contains(&i) && chain.sprockets.contains(&j);
            let radii = [first.gap.tip_radius, second.gap.tip_radius];
            let away = centres[j] - centres[i];
            let depth = radii[0] + radii[1] - away.norm();
            if depth > 0.0 && in_one_plane(parts, both) {
                // Halfway between the two circles on the line of centres.
                let along = away.try_normalize(0.0).unwrap_or_default();
                found.push(Clash::Sprockets {
                    first: first.name.clone(),
                    second: second.name.clone(),
                    depth,
                    at: centres[i] + along * (radii[0] - 0.5 * depth),
                });
            }
        }
    }
    found
}

fn teeth(parts: &Parts, standing: &BodyPositions) -> Vec<Clash> {
    let mut found = Vec::new();
    for (j, guide) in parts.guides.iter().enumerate() {
        for (i, sprocket) in parts.sprockets.iter().enumerate() {
            let both =
                |chain: &PlacedChain| chain.sprockets.contains(&i) && chain.guides.contains(&j);
            let tips = sprocket.gap.tip_radius;
            let foot = standing.faces[j].nearest(standing.sprockets[i].0, tips);
            let depth = foot.map_or(0.0, |foot| tips - foot.distance.abs());
            if let Some(foot) = foot
                && depth > TOUCHING
                && in_one_plane(parts, both)
            {
                found.push(Clash::Teeth {
                    guide: guide.name.clone(),
                    sprocket: sprocket.name.clone(),
                    depth,
                    at: foot.point,
                    beside: guide.touches != Touches::Rollers,
                });
            }
        }
    }
    found
}

/// Fixed guides that cut into the teeth of sprockets in fixed bearings, and cannot pass beside them.
pub(crate) fn fixed_in_teeth(parts: &Parts, standing: &BodyPositions) -> Vec<Clash> {
    let stands = |clash: &Clash| {
        let Clash::Teeth {
            guide, sprocket, ..
        } = clash
        else {
            return false;
        };
        let mut guides = parts.guides.iter();
        let mut sprockets = parts.sprockets.iter();
        guides.any(|it| it.name == *guide && it.support == GuideSupport::Fixed)
            && sprockets.any(|it| it.name == *sprocket && it.support == Support::Fixed)
    };
    let found = teeth(parts, standing).into_iter();
    found.filter(|it| !it.may_pass() && stands(it)).collect()
}

/// Guides on the same support are one body, whose faces may cross.
fn guides(parts: &Parts, standing: &BodyPositions) -> Vec<Clash> {
    let mut found = Vec::new();
    for (i, first) in parts.guides.iter().enumerate() {
        for (j, second) in parts.guides.iter().enumerate().skip(i + 1) {
            let both = |chain: &PlacedChain| chain.guides.contains(&i) && chain.guides.contains(&j);
            if first.support == second.support || !in_one_plane(parts, both) {
                continue;
            }
            let faces = [&standing.faces[i], &standing.faces[j]];
            let ways = [[0, 1], [1, 0]];
            let depths = ways.map(|[face, line]| deepest_behind(faces[face], faces[line]));
            // Either would have to give way; the shallower cut says by how much.
            let least = depths
                .into_iter()
                .flatten()
                .min_by(|a, b| a.0.total_cmp(&b.0));
            if let Some((depth, at)) = least.filter(|(depth, _)| *depth > TOUCHING) {
                found.push(Clash::Guides {
                    first: first.name.clone(),
                    second: second.name.clone(),
                    depth,
                    at,
                });
            }
        }
    }
    found
}

/// How deep a line that crosses a face lies behind it, and where.
fn deepest_behind(face: &ArcSpline, line: &ArcSpline) -> Option<(f64, Point)> {
    let found = stretches(face, line);
    let clearances = found.filter_map(|[from, to]| {
        let clearance = face.clearance(&line.part(from, to)?, 0.0, TOUCHING)?;
        Some((-clearance.distance, clearance.point))
    });
    clearances.max_by(|a, b| a.0.total_cmp(&b.0))
}

/// Arc lengths \[m\] between which a line runs from one crossing with a face to the next, or to its end; nothing where it does
/// not cross.
fn stretches(face: &ArcSpline, line: &ArcSpline) -> impl Iterator<Item = [f64; 2]> {
    let crossings = line.crossings(face);
    let mut ends: Vec<f64> = crossings.iter().map(|crossing| crossing.along[0]).collect();
    if !ends.is_empty() {
        ends.insert(0, 0.0);
        ends.push(line.length());
    }
    let pairs: Vec<_> = ends.windows(2).map(|pair| [pair[0], pair[1]]).collect();
    pairs.into_iter()
}

/// The chain behind the face of a guide.
///
/// A roller whose centre lies behind the face is more than half inside: deeper than any law of contact is meant for.
fn through(
    parts: &Parts,
    index: usize,
    guide: usize,
    face: &ArcSpline,
    rollers: &[Point],
) -> Option<Clash> {
    let chain = &parts.chains[index].chain;
    let guide = &parts.guides[guide];
    let line = chain_line(rollers, chain.ends == Ends::Closed)?;
    let carries = match guide.touches {
        Touches::Rollers => 0.5 * chain.roller_diameter,
        Touches::Eyes | Touches::Plates => 0.5 * chain.plate_height,
    };
    let (behind, at) = match guide.touches {
        Touches::Plates => deepest_behind(face, &line)?,
        // Circles touch, and not the links between them.
        Touches::Rollers | Touches::Eyes => stretches(face, &line)
            .flat_map(|[from, to]| {
                let pieces = line.pieces().iter().enumerate();
                let starts = pieces.map(|(k, piece)| (line.arc_length(k, 0.0), piece.start()));
                starts.filter(move |(along, _)| (from..to).contains(along))
            })
            .filter_map(|(_, roller)| {
                let foot = face.nearest(roller, f64::INFINITY)?;
                (foot.distance < 0.0).then_some((-foot.distance, roller))
            })
            .max_by(|a, b| a.0.total_cmp(&b.0))?,
    };
    (behind > TOUCHING).then(|| Clash::Chain {
        chain: called(parts, index),
        guide: guide.name.clone(),
        depth: behind + carries,
        carries,
        at,
    })
}

/// A chain, as messages call it.
pub(crate) fn called(parts: &Parts, index: usize) -> String {
    if parts.chains.len() == 1 {
        "the chain".to_owned()
    } else {
        format!("chain {index}")
    }
}

/// The line through the centres of the rollers.
fn chain_line(rollers: &[Point], closed: bool) -> Option<ArcSpline> {
    let mut pieces: Vec<Piece> = Vec::new();
    let again = closed.then(|| rollers.first()).flatten();
    let mut last = *rollers.first()?;
    for &roller in rollers.iter().skip(1).chain(again) {
        // Rollers in one place make no piece.
        if (roller - last).norm() > TOUCHING {
            pieces.push(Segment::new(last, roller).into());
            last = roller;
        }
    }
    ArcSpline::open(&pieces).ok()
}
