//! Guides.

use std::f64::consts::TAU;

use chaindrive_geometry::{Arc, ArcSpline, GeometryError, Piece, Point, bar, rail};
use chaindrive_mechanics::{Guide, GuideSupport};

use super::chain::Resolved;
use super::law::linear;
use super::{Findings, Names, contact, motion, point};
use crate::scene::defaults;
use crate::scene::schema::{self, Face, SceneText, TravelSide};

/// All guides, each with the chain that it belongs to.
pub(super) fn resolve_all<'c>(
    scene: &SceneText,
    names: &Names<'_>,
    findings: &mut Findings<'_>,
    chain_of: impl Fn(usize) -> &'c Resolved,
) -> Option<Vec<Guide>> {
    let guides: Vec<_> = scene
        .guides
        .iter()
        .enumerate()
        .map(|(i, text)| {
            let path = format!("guides[{i}]");
            resolve(text, &path, scene, names, chain_of(i), findings)
        })
        .collect();
    guides.into_iter().collect()
}

fn resolve(
    text: &schema::Guide,
    path: &str,
    scene: &SceneText,
    names: &Names<'_>,
    chain: &Resolved,
    findings: &mut Findings<'_>,
) -> Option<Guide> {
    let place = format!("{path}.face");
    let face = face(&text.face, &place, findings);
    let face = findings.keep(&place, face);
    let support = support(text, path, scene, names, findings);
    let said = contact::Said {
        own: &text.contact,
        path: &format!("{path}.contact"),
        common: &scene.contact.guides,
        fallback: contact::GUIDES,
    };
    let surface = said.surface(chain.roller(), findings, |findings| {
        let place = format!("{path}.contact.law");
        let stiffness = chain.link_stiffness();
        let default = &defaults::GUIDES_STIFFNESS;
        Some(linear(stiffness, &place, default, findings))
    });
    Some(Guide {
        name: text.name.clone(),
        face: face?,
        support: support?,
        touches: text.touches,
        surface: surface?,
    })
}

/// Working face with its material on the left of travel.
fn face(face: &Face, path: &str, findings: &mut Findings<'_>) -> Result<ArcSpline, GeometryError> {
    match face {
        Face::Bar {
            start,
            end,
            end_radius,
            end_angle,
            material,
        } => {
            let (start, end) = match material {
                TravelSide::Left => (point(*start), point(*end)),
                TravelSide::Right => (point(*end), point(*start)),
            };
            let radius = end_radius.map(|radius| radius.0);
            let place = format!("{path}.end_radius");
            let straight = (end - start).norm();
            let radius = findings.or_multiple(radius, &place, &defaults::END_RADIUS, straight);
            let angle = end_angle.map(|angle| angle.0);
            let place = format!("{path}.end_angle");
            let angle = findings.or_default(angle, &place, &defaults::END_ANGLE);
            bar(start, end, radius, angle)
        }
        Face::Points {
            points,
            radii,
            material,
        } => {
            let mut points: Vec<Point> = points.iter().copied().map(point).collect();
            let mut radii: Vec<f64> = radii.iter().map(|radius| radius.0).collect();
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
    path: &str,
    scene: &SceneText,
    names: &Names<'_>,
    findings: &mut Findings<'_>,
) -> Option<GuideSupport> {
    let path = format!("{path}.support");
    Some(match &text.support {
        None => {
            findings.assume_kind(&path, "fixed");
            GuideSupport::Fixed
        }
        Some(schema::GuideSupport::Fixed) => GuideSupport::Fixed,
        Some(schema::GuideSupport::Prescribed { x, y }) => {
            let x = motion::shift(x, &format!("{path}.x"), scene, findings);
            let y = motion::shift(y, &format!("{path}.y"), scene, findings);
            GuideSupport::Prescribed { x: x?, y: y? }
        }
        Some(schema::GuideSupport::Tensioner { name }) => {
            GuideSupport::Tensioner(names.tensioner(name, &format!("{path}.name"), findings)?)
        }
    })
}
