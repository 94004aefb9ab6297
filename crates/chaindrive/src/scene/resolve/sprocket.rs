//! Sprockets.

use chaindrive_contact::Elastic;
use chaindrive_geometry::{Side, ToothGap};
use chaindrive_mechanics::{Forces, Sprocket, Support, Surface, Tolerance, ToothStack};

use serde_json::json;

use super::chain::ResolvedChain;
use super::cursor::Cursor;
use super::film::Strip;
use super::law::{cylindrical, linear, steel};
use super::scatter::Normal;
use super::{Findings, Names, contact, flank, loss, motion, point, tooth};
use crate::scene::defaults;
use crate::scene::schema::{self, SceneText};

/// All sprockets, each with the chain that it belongs to; their shafts are found elsewhere.
pub(super) fn resolve_all<'c>(
    scene: &SceneText,
    names: &Names<'_>,
    findings: &mut Findings<'_>,
    chain_of: impl Fn(usize) -> &'c ResolvedChain,
) -> Option<Vec<Sprocket>> {
    let sprockets = scene.sprockets.iter().enumerate();
    let sprockets: Vec<_> = sprockets
        .map(|(i, text)| {
            let at = findings.at(format!("sprockets[{i}]"));
            resolve(text, scene, names, chain_of(i), at)
        })
        .collect();
    sprockets.into_iter().collect()
}

fn resolve(
    text: &schema::Sprocket,
    scene: &SceneText,
    names: &Names<'_>,
    chain: &ResolvedChain,
    mut at: Cursor<'_, '_>,
) -> Option<Sprocket> {
    let (pitch, roller_diameter) = (chain.chain.pitch, chain.chain.roller_diameter);
    let form = tooth::form(text.tooth.as_ref(), pitch, roller_diameter, at.key("tooth"));
    let gap = form.and_then(|form| {
        let gap = ToothGap::new(text.teeth, pitch, roller_diameter, &form);
        let place = text.tooth.as_ref().map_or("teeth", |_| "tooth");
        at.key(place).keep(gap)
    });
    let support = support(text, scene, names, at.key("support"));
    let said = contact::ContactText {
        own: &text.contact,
        path: &format!("{}.contact", at.path),
        common: &scene.contact.teeth,
        fallback: contact::TEETH,
    };
    let strip = gap.as_ref();
    let strip = strip.map(|gap| Strip::in_seat(chain.roller(), gap));
    let mut surface = said.surface(chain.roller(), strip, at.findings, |findings| {
        law(
            gap.as_ref()?,
            chain,
            findings.at(format!("{}.law", said.path)),
        )
    });
    let stack = surface
        .as_mut()
        .and_then(|surface| behind(text, &said, surface, chain, at.again()));
    let flank = gap.as_ref();
    let flank = flank.and_then(|gap| flank::resolve(text, scene, gap, chain, at.again()));
    let tolerance = tolerance(text, at.key("gap_errors"));
    let loss = loss::resolve(text.bearing.as_ref(), text.drag.as_ref(), at.again());
    let support = support?;
    let moves = match &support {
        Support::Springs { .. } => true,
        Support::Tensioner(index) => scene.tensioners[*index].push.word("kind") != "locked",
        Support::Fixed | Support::Prescribed { .. } => false,
    };
    if moves && text.mass.is_none() {
        let hint = "give the mass, because the centre can move";
        at.key("mass").refuse("missing", hint);
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
        // Found where the shafts are known.
        forces: Forces::default(),
        inertia: text.inertia.map_or(0.0, f64::from),
        mass: text.mass.map_or(0.0, f64::from),
        surface: surface?,
        stack,
        flank,
        gap_angle: at.key("gap_angle").or(text.gap_angle, &defaults::GAP_ANGLE),
        tolerance: tolerance?,
        lateral: text.lateral.0,
        loss: loss?,
    })
}

/// Puts what lies behind the surface of the teeth into its law: the parts that a scene asks for, which are returned, or the default.
fn behind(
    text: &schema::Sprocket,
    said: &contact::ContactText<'_>,
    surface: &mut Surface,
    chain: &ResolvedChain,
    mut at: Cursor<'_, '_>,
) -> Option<ToothStack> {
    let asked = said.stack(at.findings);
    // The law that particles have where the scene gives none is that of the whole stack.
    let of_surfaces = chain.is_rigid() || said.law_path().is_some();
    if let Some((stack, place)) = asked {
        if !of_surfaces {
            let hint =
                "give a `law` of the surfaces too: the default of particles has the stack in it";
            at.findings.refuse_once(&place, "without a `law`", hint);
            return None;
        }
        let at = at.findings.at(place);
        let found = chain.behind_teeth.stack(stack, text.rim, at)?;
        let stiffness = found.stiffness();
        surface.law.series = stiffness.is_finite().then_some(stiffness);
        return Some(found);
    }
    if text.rim.is_some() {
        let hint =
            "ask for the parts behind the teeth, `contact.teeth.stack = {}`, or leave it out";
        at.key("rim").refuse("without a `stack`", hint);
    }
    if said.series().is_none()
        && let Some(behind) = chain.behind_teeth.behind()
    {
        let mut at = at.findings.at(format!("{}.series", said.path));
        if of_surfaces && behind.stiffness > 0.0 {
            surface.law.series = Some(behind.stiffness);
            at.assume(behind.stiffness, behind.remark);
        } else {
            at.assume(0.0, "nothing lies behind");
        }
    }
    None
}

/// Deviations of a sprocket from its drawing.
fn tolerance(text: &schema::Sprocket, mut at: Cursor<'_, '_>) -> Option<Tolerance> {
    let teeth = text.teeth;
    let gap_displacements = match &text.gap_errors {
        None => Vec::new(),
        Some(schema::GapErrors::List { displacements }) => {
            let count = displacements.len();
            if count != teeth as usize {
                let problem = format!("{count} values for {teeth} gaps");
                let hint = "give one displacement for every gap";
                at.key("displacements").refuse(problem, hint);
                return None;
            }
            displacements.iter().copied().map(f64::from).collect()
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
fn law(gap: &ToothGap, chain: &ResolvedChain, mut at: Cursor<'_, '_>) -> Option<Elastic> {
    if !chain.is_rigid() {
        let stiffness = chain.link_stiffness();
        return Some(linear(stiffness, &defaults::TEETH_STIFFNESS, at));
    }
    let roller = chain.roller();
    let steel = steel();
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
        at.assume(text, "follows from roller and seat");
    } else {
        let hint =
            "give a law, or `chain.roller.length`, with which it follows from roller and seat";
        at.findings
            .refuse_once("contact.teeth.law", "missing", hint);
    }
    seated
}

fn support(
    text: &schema::Sprocket,
    scene: &SceneText,
    names: &Names<'_>,
    mut at: Cursor<'_, '_>,
) -> Option<Support> {
    Some(match &text.support {
        None => {
            at.assume_kind("fixed");
            Support::Fixed
        }
        Some(schema::Support::Fixed) => Support::Fixed,
        Some(schema::Support::Prescribed { x, y }) => {
            let [x, y] = motion::shifts([x, y], scene, at)?;
            Support::Prescribed { x, y }
        }
        Some(schema::Support::Springs { stiffness, damping }) => Support::Springs {
            stiffness: stiffness.map(|k| k.0),
            damping: damping.map(|c| c.0),
        },
        Some(schema::Support::Tensioner { name }) => {
            Support::Tensioner(names.tensioner(name, at.key("name"))?)
        }
    })
}
