//! Guides.

use std::f64::consts::TAU;

use chaindrive_geometry::{Arc, ArcSpline, GeometryError, Piece, Point, bar, rail};
use chaindrive_mechanics::{Guide, GuideSupport, Sprocket, Touches};

use super::chain::ResolvedChain;
use super::cursor::Cursor;
use super::film::Strip;
use super::law::linear;
use super::on_span::{self, GuidedChain};
use super::{Findings, Names, contact, motion, point};
use crate::scene::defaults;
use crate::scene::schema::{self, Face, SceneText, TravelSide};
use chaindrive_quantities::{Angle, Length};

/// All guides, each with the chain that it belongs to.
pub(super) fn resolve_all<'c>(
    scene: &SceneText,
    names: &Names<'_>,
    findings: &mut Findings<'_>,
    sprockets: &[Sprocket],
    chain_of: impl Fn(usize) -> (&'c ResolvedChain, GuidedChain<'c>),
) -> Option<Vec<Guide>> {
    let guides = scene.guides.iter().enumerate();
    let guides: Vec<_> = guides
        .map(|(i, text)| {
            let passed = (chain_of(i), sprockets);
            resolve(
                text,
                scene,
                names,
                passed,
                findings.at(format!("guides[{i}]")),
            )
        })
        .collect();
    guides.into_iter().collect()
}

fn resolve(
    text: &schema::Guide,
    scene: &SceneText,
    names: &Names<'_>,
    ((chain, passing), sprockets): ((&ResolvedChain, GuidedChain<'_>), &[Sprocket]),
    mut at: Cursor<'_, '_>,
) -> Option<Guide> {
    let mut of_face = at.key("face");
    let face = match &text.face {
        Face::OnSpan { .. } => on_span(text, (chain, &passing, sprockets), of_face),
        face => {
            let face = placed(face, of_face.again());
            of_face.keep(face)
        }
    };
    let support = support(text, scene, names, at.key("support"));
    let at = at.key("contact");
    let said = contact::ContactText {
        own: &text.contact,
        path: &at.path,
        common: &scene.contact.guides,
        fallback: contact::GUIDES,
    };
    let strip = Some(Strip::on_guide(chain.roller()));
    let surface = said.surface(chain.roller(), strip, at.findings, |findings| {
        let at = findings.at(format!("{}.law", said.path));
        Some(linear(
            chain.link_stiffness(),
            &defaults::GUIDES_STIFFNESS,
            at,
        ))
    });
    Some(Guide {
        name: text.name.clone(),
        face: face?,
        support: support?,
        touches: text.touches,
        surface: surface?,
    })
}

/// Working face on a span.
fn on_span(
    guide: &schema::Guide,
    (chain, passing, sprockets): (&ResolvedChain, &GuidedChain<'_>, &[Sprocket]),
    mut at: Cursor<'_, '_>,
) -> Option<ArcSpline> {
    let Face::OnSpan {
        between,
        from,
        to,
        radius,
        bow,
        end_radius,
        end_angle,
        material,
        ..
    } = &guide.face
    else {
        return None;
    };
    let span = passing.span(guide, between.as_ref());
    let span = at.keep(span)?;
    if radius.is_none() {
        let Some(bow) = bow else {
            let hint =
                "say how far a straight face pushes the chain, less than zero where it keeps clear";
            at.key("bow").refuse("missing", hint);
            return None;
        };
        let side = on_span::side(*material);
        let across = span.away_from(side) * (bow.0 - on_span::above(guide.touches, passing.size));
        let ends = [from.0, to.0].map(|share| span.at(share) + across);
        let mut end_radius = *end_radius;
        if end_radius.is_none() && guide.touches == Touches::Rollers {
            let tips = passing.tips(guide, between.as_ref(), sprockets);
            let angle = end_angle.map_or(defaults::END_ANGLE.value, f64::from);
            let usual = defaults::END_RADIUS.value * (ends[1] - ends[0]).norm();
            if let Some((radius, name)) =
                shorter_ends(ends, (usual, angle, *material), &tips, passing.size[0])
            {
                let remark = format!("computed: clear of the teeth of `{name}`");
                at.key("end_radius").assume(radius, remark);
                end_radius = Some(Length(radius));
            }
        }
        let face = straight(ends, (end_radius, *end_angle, *material), at.again());
        return at.keep(face);
    }
    let bow = match bow {
        Some(bow) => bow.0,
        None if chain.uncounted.is_some() => {
            let phase = defaults::PHASE.value;
            let range = passing.pitches_by_bow(guide, phase).map(|[least, most]| {
                format!(": by its bow the route takes {least:.2} to {most:.2} links")
            });
            let range = range.unwrap_or_default();
            let hint = format!("give it, or the number of links from which it follows{range}");
            at.key("bow").refuse("missing", hint);
            return None;
        }
        None => {
            let links = chain.chain.links();
            // A drive is not another one for where it happens to stand.
            let phase = defaults::PHASE.value;
            let found = passing.closing_bow(guide, links, phase);
            let found = at.key("bow").keep(found)?;
            let remark = format!("computed: {links} links close without stress");
            at.key("bow").assume(found, remark);
            found
        }
    };
    let face = on_span::curved(guide, bow, passing.size)?.on(&span);
    let arc = at.keep(face)?;
    at.keep(ArcSpline::open(&[Piece::Arc(arc)]))
}

/// Halvings until a radius is found to rounding.
const HALVINGS: u32 = 60;
/// Share of the usual radius of ends below which they are edges.
const LEAST_END: f64 = 1e-3;

/// Radius \[m\] of curved ends that clear the teeth, and the sprocket that limits it, where ends of the usual radius would cut into teeth. None where those are clear, or
/// the straight part cuts into teeth itself.
///
/// The gap left is half a pitch, or half of that beside the straight part where this is less.
fn shorter_ends<'t>(
    ends: [Point; 2],
    (usual, angle, material): (f64, f64, TravelSide),
    tips: &'t [(String, Point, f64)],
    pitch: f64,
) -> Option<(f64, &'t str)> {
    // The sprocket whose teeth are nearest, and the gap to them.
    let nearest = |radius: f64| {
        let face = along_travel(ends, (radius, angle, material)).ok()?;
        let gap = |(name, centre, tip): &'t (String, Point, f64)| {
            let foot = face.nearest(*centre, f64::INFINITY)?;
            Some((foot.distance.abs() - tip, name.as_str()))
        };
        let gaps = tips.iter().filter_map(gap);
        gaps.min_by(|a, b| a.0.total_cmp(&b.0))
    };
    let (gap, mut name) = nearest(usual)?;
    let (beside, _) = nearest(LEAST_END * usual)?;
    if gap > 0.0 || beside <= 0.0 {
        return None;
    }
    let wanted = 0.5 * beside.min(pitch);
    let [mut fits, mut cuts] = [LEAST_END * usual, usual];
    for _ in 0..HALVINGS {
        let middle = 0.5 * (fits + cuts);
        match nearest(middle)? {
            (gap, _) if gap > wanted => fits = middle,
            (_, limiting) => (name, cuts) = (limiting, middle),
        }
    }
    Some((fits, name))
}

/// A straight face between two ends \[m\] in the order of travel, with curved ends.
fn along_travel(
    [start, end]: [Point; 2],
    (radius, angle, material): (f64, f64, TravelSide),
) -> Result<ArcSpline, GeometryError> {
    match material {
        TravelSide::Left => bar(start, end, radius, angle),
        TravelSide::Right => bar(end, start, radius, angle),
    }
}

/// A straight face between two ends \[m\] in the order of travel, with what a scene says of its curved ends.
fn straight(
    [start, end]: [Point; 2],
    (radius, angle, material): (Option<Length>, Option<Angle>, TravelSide),
    mut at: Cursor<'_, '_>,
) -> Result<ArcSpline, GeometryError> {
    let length = (end - start).norm();
    let radius = at
        .key("end_radius")
        .or_multiple(radius, &defaults::END_RADIUS, length);
    let angle = at.key("end_angle").or(angle, &defaults::END_ANGLE);
    along_travel([start, end], (radius, angle, material))
}

/// Working face in a place of its own, with its material on the left of travel.
fn placed(face: &Face, at: Cursor<'_, '_>) -> Result<ArcSpline, GeometryError> {
    match face {
        // The span is somebody else's.
        Face::OnSpan { .. } => Err(GeometryError::NoPieces),
        Face::Bar {
            start,
            end,
            end_radius,
            end_angle,
            material,
        } => {
            let ends = [point(*start), point(*end)];
            straight(ends, (*end_radius, *end_angle, *material), at)
        }
        Face::Points {
            points,
            radii,
            material,
        } => {
            let mut points: Vec<Point> = points.iter().copied().map(point).collect();
            let mut radii: Vec<f64> = radii.iter().copied().map(f64::from).collect();
            if *material == TravelSide::Right {
                points.reverse();
                radii.reverse();
            }
            rail(&points, &radii)
        }
        Face::Arc {
            centre,
            radius,
            from,
            to,
        } => {
            let sweep = (to.0 - from.0).rem_euclid(TAU);
            ArcSpline::open(&[Piece::Arc(Arc {
                centre: point(*centre),
                radius: radius.0,
                start_angle: from.0,
                sweep: if sweep == 0.0 { TAU } else { sweep },
            })])
        }
    }
}

fn support(
    text: &schema::Guide,
    scene: &SceneText,
    names: &Names<'_>,
    mut at: Cursor<'_, '_>,
) -> Option<GuideSupport> {
    Some(match &text.support {
        None => {
            at.assume_kind("fixed");
            GuideSupport::Fixed
        }
        Some(schema::GuideSupport::Fixed) => GuideSupport::Fixed,
        Some(schema::GuideSupport::Prescribed { x, y }) => {
            let [x, y] = motion::shifts([x, y], scene, at)?;
            GuideSupport::Prescribed { x, y }
        }
        Some(schema::GuideSupport::Tensioner { name }) => {
            GuideSupport::Tensioner(names.tensioner(name, at.key("name"))?)
        }
    })
}
