//! Sprockets.

use chaindrive_contact::Elastic;
use chaindrive_geometry::{Side, ToothGap};
use chaindrive_mechanics::{Sprocket, Support, Surface, Tolerance, ToothStack};

use serde_json::json;

use super::chain::Resolved;
use super::film::Strip;
use super::law::{cylindrical, linear, steel};
use super::scatter::Normal;
use super::{Findings, Names, contact, flank, loss, motion, point, stack, tooth};
use crate::scene::defaults;
use crate::scene::schema::{self, SceneText};

/// All sprockets, each with the chain that it belongs to; their shafts are found elsewhere.
pub(super) fn resolve_all<'c>(
    scene: &SceneText,
    names: &Names<'_>,
    findings: &mut Findings<'_>,
    chain_of: impl Fn(usize) -> &'c Resolved,
) -> Option<Vec<Sprocket>> {
    let sprockets: Vec<_> = scene
        .sprockets
        .iter()
        .enumerate()
        .map(|(i, text)| {
            resolve(
                text,
                &format!("sprockets[{i}]"),
                scene,
                names,
                chain_of(i),
                findings,
            )
        })
        .collect();
    sprockets.into_iter().collect()
}

fn resolve(
    text: &schema::Sprocket,
    path: &str,
    scene: &SceneText,
    names: &Names<'_>,
    chain: &Resolved,
    findings: &mut Findings<'_>,
) -> Option<Sprocket> {
    let form = tooth::form(
        text.tooth.as_ref(),
        chain.chain.pitch,
        chain.chain.roller_diameter,
        &format!("{path}.tooth"),
        findings,
    );
    let gap = form.and_then(|form| {
        let gap = ToothGap::new(
            text.teeth,
            chain.chain.pitch,
            chain.chain.roller_diameter,
            &form,
        );
        let place = if text.tooth.is_some() {
            "tooth"
        } else {
            "teeth"
        };
        findings.keep(&format!("{path}.{place}"), gap)
    });
    let support = support(text, path, scene, names, findings);
    let said = contact::Said {
        own: &text.contact,
        path: &format!("{path}.contact"),
        common: &scene.contact.teeth,
        fallback: contact::TEETH,
    };
    let strip = gap.as_ref();
    let strip = strip.map(|gap| Strip::in_seat(chain.roller(), gap));
    let mut surface = said.surface(chain.roller(), strip, findings, |findings| {
        let place = format!("{path}.contact.law");
        law(gap.as_ref()?, chain, &place, findings)
    });
    let stack = surface
        .as_mut()
        .and_then(|surface| behind(text, path, &said, surface, chain, findings));
    let flank = gap
        .as_ref()
        .and_then(|gap| flank::resolve(text, path, scene, gap, chain, findings));
    let tolerance = tolerance(text, path, findings);
    let loss = loss::resolve(text.bearing.as_ref(), text.drag.as_ref(), path, findings);
    let support = support?;
    let moves = match &support {
        Support::Springs { .. } => true,
        Support::Tensioner(index) => scene.tensioners[*index].push.word("kind") != "locked",
        Support::Fixed | Support::Prescribed { .. } => false,
    };
    if moves && text.mass.is_none() {
        let hint = "give the mass, because the centre can move";
        findings.refuse_with(&format!("{path}.mass"), "missing", hint);
    }
    Some(Sprocket {
        name: text.name.clone(),
        gap: gap?,
        side: match text.side {
            schema::Side::Left => Side::Left,
            schema::Side::Right => Side::Right,
        },
        centre: point(text.centre),
        shaft: 0,
        support,
        inertia: text.inertia.map_or(0.0, |inertia| inertia.0),
        mass: text.mass.map_or(0.0, |mass| mass.0),
        surface: surface?,
        stack,
        flank,
        gap_angle: findings.or_default(
            text.gap_angle.map(|angle| angle.0),
            &format!("{path}.gap_angle"),
            &defaults::GAP_ANGLE,
        ),
        tolerance: tolerance?,
        lateral: text.lateral.0,
        loss: loss?,
    })
}

/// Puts what lies behind the surface of the teeth into its law: the parts that a scene asks for, which are returned, or the default.
fn behind(
    text: &schema::Sprocket,
    path: &str,
    said: &contact::Said<'_>,
    surface: &mut Surface,
    chain: &Resolved,
    findings: &mut Findings<'_>,
) -> Option<ToothStack> {
    let asked = said.stack(findings);
    // The law that particles have where the scene gives none is that of the whole stack.
    let of_surfaces = chain.is_rigid() || said.law_path().is_some();
    if let Some((stack, place)) = asked {
        if !of_surfaces {
            let hint =
                "give a `law` of the surfaces too: the default of particles has the stack in it";
            findings.refuse_once(&place, "without a `law`", hint);
            return None;
        }
        let asked = stack::Asked {
            stack,
            path: &place,
            rim: text.rim.map(|it| it.0),
        };
        let found = chain.behind_teeth.stack(asked, findings)?;
        let stiffness = found.stiffness();
        surface.law.series = stiffness.is_finite().then_some(stiffness);
        return Some(found);
    }
    if text.rim.is_some() {
        let hint =
            "ask for the parts behind the teeth, `contact.teeth.stack = {}`, or leave it out";
        findings.refuse_with(&format!("{path}.rim"), "without a `stack`", hint);
    }
    if said.series().is_none()
        && let Some(behind) = chain.behind_teeth.behind(findings)
    {
        let place = format!("{path}.contact.series");
        if of_surfaces && behind.stiffness > 0.0 {
            surface.law.series = Some(behind.stiffness);
            findings.assume(&place, behind.stiffness, &*behind.remark);
        } else {
            findings.assume(&place, 0.0, "nothing lies behind");
        }
    }
    None
}

/// Deviations of a sprocket from its drawing.
fn tolerance(
    text: &schema::Sprocket,
    path: &str,
    findings: &mut Findings<'_>,
) -> Option<Tolerance> {
    let teeth = text.teeth;
    let gap_displacements = match &text.gap_errors {
        None => Vec::new(),
        Some(schema::GapErrors::List { displacements }) => {
            let count = displacements.len();
            if count != teeth as usize {
                let problem = format!("{count} values for {teeth} gaps");
                let hint = "give one displacement for every gap";
                findings.refuse_with(&format!("{path}.gap_errors.displacements"), problem, hint);
                return None;
            }
            displacements.iter().map(|it| it.0).collect()
        }
        Some(schema::GapErrors::Orders { waves }) => (0..teeth)
            .map(|gap| {
                let around = std::f64::consts::TAU * f64::from(gap) / f64::from(teeth);
                // Δᵢ = Σ a cos(n 2π i/z − φ)
                let wave = |it: &schema::GapWave| {
                    it.amplitude.0 * libm::cos(f64::from(it.order) * around - it.phase.0)
                };
                waves.iter().map(wave).sum()
            })
            .collect(),
        Some(schema::GapErrors::Random { deviation, seed }) => {
            let mut normal = Normal::new(*seed, 4);
            (0..teeth).map(|_| deviation.0 * normal.next()).collect()
        }
    };
    Some(Tolerance {
        eccentricity: text.eccentricity.0,
        eccentricity_angle: text.eccentricity_angle.0,
        gap_displacements,
    })
}

/// Elastic law of teeth that the scene leaves open.
fn law(
    gap: &ToothGap,
    chain: &Resolved,
    path: &str,
    findings: &mut Findings<'_>,
) -> Option<Elastic> {
    if !chain.is_rigid() {
        let default = &defaults::TEETH_STIFFNESS;
        return Some(linear(chain.link_stiffness(), path, default, findings));
    }
    let roller = chain.roller();
    let steel = steel(findings.version);
    let seated = roller
        .length
        .and_then(|length| cylindrical(roller, gap.seat_clearance, length, steel).ok());
    if seated.is_some() {
        let text = json!({
            "kind": "cylindrical",
            "length": roller.length,
            "modulus": steel.modulus,
            "poisson": steel.poisson,
            "radius": roller.radius,
            "clearance": gap.seat_clearance,
        });
        findings.assume(path, text, "follows from roller and seat");
    } else {
        let hint =
            "give a law, or `chain.roller.length`, with which it follows from roller and seat";
        findings.refuse_once("contact.teeth.law", "missing", hint);
    }
    seated
}

fn support(
    text: &schema::Sprocket,
    path: &str,
    scene: &SceneText,
    names: &Names<'_>,
    findings: &mut Findings<'_>,
) -> Option<Support> {
    let path = format!("{path}.support");
    Some(match &text.support {
        None => {
            findings.assume_kind(&path, "fixed");
            Support::Fixed
        }
        Some(schema::Support::Fixed) => Support::Fixed,
        Some(schema::Support::Prescribed { x, y }) => {
            let x = motion::shift(x, &format!("{path}.x"), scene, findings);
            let y = motion::shift(y, &format!("{path}.y"), scene, findings);
            Support::Prescribed { x: x?, y: y? }
        }
        Some(schema::Support::Springs { stiffness, damping }) => Support::Springs {
            stiffness: stiffness.map(|k| k.0),
            damping: damping.map(|c| c.0),
        },
        Some(schema::Support::Tensioner { name }) => {
            Support::Tensioner(names.tensioner(name, &format!("{path}.name"), findings)?)
        }
    })
}
