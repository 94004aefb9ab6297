//! The chain: completed from the catalogue, then lengths, masses, stiffness and damping, link by link.

use chaindrive_mechanics::{Capacity, Chain, ChainModel, End, Ends, MissingRating, Strength};

use super::articulation::{self, Joints};
use super::body::Body;
use super::chains::ChainDescription;
use super::law::Pair;
use super::scatter::Normal;
use super::stack::Parts;
use super::{Findings, catalogue, link_count, links, motion, strands};
use crate::catalogue::{CatalogueChain, Number};
use crate::scene::defaults;
use crate::scene::schema::{self, SceneText};

/// The chain, with the dimensions that its contacts need.
#[derive(Debug)]
pub(super) struct ResolvedChain {
    pub(super) chain: Chain,
    /// Length of the rollers on the teeth \[m\], where it is known.
    pub(super) roller_length: Option<f64>,
    /// Parts behind the surfaces of teeth.
    pub(super) behind_teeth: Parts,
    /// Why the number of links is a guess that must not be used; the other parts are looked at with it.
    pub(super) uncounted: Option<String>,
}

impl ResolvedChain {
    /// A roller before it meets a surface.
    pub(super) fn roller(&self) -> Pair {
        Pair {
            radius: 0.5 * self.chain.roller_diameter,
            bore: None,
            length: self.roller_length,
        }
    }

    /// Whether the links are rigid.
    pub(super) fn is_rigid(&self) -> bool {
        !self.chain.model.has_springs()
    }

    /// Mean stiffness of the links \[N/m\].
    pub(super) fn link_stiffness(&self) -> f64 {
        self.chain.stiffness.iter().sum::<f64>() / self.chain.links() as f64
    }
}

/// Pitch \[m\] from which one around sprockets is taken for millimetres. *Assumed*: the longest in catalogues has half of it.
const METRES: f64 = 2.0;

/// Excess of a pitch over that of its type \[–\] which is wear and no other chain. *Assumed*: chains are scrapped at 3 %.
const WORN: std::ops::Range<f64> = 1e-3..0.05;

/// That a type would give what is missing, where none is named.
fn or_type(text: &schema::Chain) -> &'static str {
    if text.of_type.is_none() {
        "; or name a `type`, such as \"16B-1\""
    } else {
        ""
    }
}

/// Names the keys of other models of a chain, and what its own knows.
fn refuse_keys(written: &schema::Chain, findings: &mut Findings<'_>) {
    let before = findings.problems.count();
    if written.model.has_springs() {
        links::refuse_on_particles(written, findings);
    } else {
        links::refuse_of_particles(written, findings);
    }
    if !written.model.has_play() && !written.is_of_points() {
        articulation::refuse_play(written, findings);
    }
    if findings.problems.count() > before + 1 {
        let hint = "one scene serves all models, as in a sweep over `chain.model`, where `type` names a chain of the catalogue and these keys are left out";
        findings.refuse_with("chain.model", written.model.knows(written.rollers), hint);
    }
}

/// The pitch \[m\]; one that is that of a worn chain, or in millimetres, is refused.
fn pitch(
    text: &schema::Chain,
    of_type: Option<&CatalogueChain>,
    touches: bool,
    findings: &mut Findings<'_>,
) -> Option<f64> {
    let Some(pitch) = text.pitch.map(f64::from) else {
        findings.refuse_with("chain.pitch", "missing", "give the nominal pitch");
        return None;
    };
    if let Some(own) = of_type.and_then(|chain| chain.number(Number::Pitch))
        && WORN.contains(&(pitch / own - 1.0))
    {
        let elongation = (pitch / own - 1.0) * 100.0;
        let message = format!("{pitch} m, and the pitch of its type is {own} m");
        let hint = format!(
            "sprockets are cut for the nominal pitch: leave it out, and for a worn chain give `elongation = \"{elongation:.2} %\"`"
        );
        findings.refuse_with("chain.pitch", message, hint);
        return None;
    }
    if touches && pitch >= METRES {
        let message = format!("{pitch} m, and no chain on sprockets has such a pitch");
        let hint = format!("a bare number is in metres: write \"{pitch} mm\"");
        findings.refuse_with("chain.pitch", message, hint);
        return None;
    }
    Some(pitch)
}

pub(super) fn resolve(
    scene: &SceneText,
    described: &ChainDescription<'_>,
    findings: &mut Findings<'_>,
) -> Option<ResolvedChain> {
    let written = described.text;
    // The roller diameter matters where there is a sprocket or guide.
    let touched = !(described.sprockets.is_empty() && described.guides.is_empty());
    let of_type = written.of_type.as_ref();
    let of_type = of_type.map(|name| catalogue::named(name, findings));
    strands::refuse(written, findings);
    refuse_keys(written, findings);
    let text = &match of_type {
        Some(chain) => catalogue::completed(written, chain, findings),
        None => written.clone(),
    };
    let text = &strands::as_one(text, of_type);
    let own = of_type.filter(|_| written.pitch.is_some());
    let pitch = pitch(text, own, !described.sprockets.is_empty(), findings)?;
    let link_count::Count {
        links: number,
        uncounted,
    } = link_count::links(scene, described, text, pitch, findings)?;
    let lengths = lengths(text, pitch, number, findings);
    let roller_diameter = match text.roller_diameter {
        Some(diameter) => diameter.0,
        None if touched => {
            let hint = format!(
                "give the roller diameter, from which teeth and guides follow{}",
                or_type(written)
            );
            findings.refuse_with("chain.roller_diameter", "missing", hint);
            if text.model.has_springs() {
                let _ = springs(text, number, findings);
            }
            return None;
        }
        None => {
            let default = &defaults::ROLLER_DIAMETER;
            findings
                .at("chain.roller_diameter")
                .or_multiple(None::<f64>, default, pitch)
        }
    };
    if !described.sprockets.is_empty() && are_too_large(roller_diameter, pitch, findings) {
        return None;
    }
    let roller_length = text.roller.as_ref().and_then(|roller| roller.length);
    let roller_length = roller_length.map(f64::from);
    let roller_length = roller_length.or(of_type.and_then(catalogue::roller_length));
    let ends = ends(text, scene, findings);
    let widths = (roller_diameter, roller_length);
    let body = body((scene, described.route), text, number, widths, findings);

    let scatter = text.scatter.clone().unwrap_or_default();
    let vary = |values: Vec<f64>, deviation: f64, stream: u32, scale: Option<f64>| -> Vec<f64> {
        let mut normal = Normal::new(scatter.seed, stream);
        let varied = values
            .into_iter()
            .map(|v| v + deviation * scale.unwrap_or(v) * normal.next());
        varied.collect()
    };
    let lengths = vary(lengths?, scatter.pitch.0, 0, Some(pitch));
    let Body {
        masses,
        stiffness,
        model,
    } = body?;
    let masses = vary(masses, scatter.mass.0, 1, None);
    let stiffness = vary(stiffness, scatter.stiffness.0, 2, None);
    let deviation = scatter.roller_diameter.0;
    let alike = vec![0.0; if deviation > 0.0 { masses.len() } else { 0 }];
    let roller_deviations = vary(alike, deviation, 3, Some(roller_diameter));
    let mean = stiffness.iter().sum::<f64>() / stiffness.len() as f64;
    let joints = Joints::new(scene, text, model.has_springs().then_some(mean));
    let plate_height = findings.at("chain.plate_height").or_multiple(
        text.plate_height,
        &defaults::PLATE_HEIGHT,
        roller_diameter,
    );
    let articulation = joints.articulation(plate_height, findings);
    let damping = damping(text, &stiffness, &masses, &model, findings);
    let behind_teeth = Parts::new(text, &model, &masses);
    let chain = Chain {
        pitch,
        lengths,
        stiffness,
        damping,
        masses,
        roller_diameter,
        roller_deviations,
        plate_height,
        articulation,
        drag: text.drag.map_or(0.0, f64::from),
        ends: ends?,
        model,
        strength: strength(text, of_type, pitch, findings),
    };
    Some(ResolvedChain {
        chain,
        roller_length,
        behind_teeth,
        uncounted,
    })
}

/// Refuses rollers as large as the pitch, before anything is laid: a route of a wrong pitch takes millions of links.
fn are_too_large(roller_diameter: f64, pitch: f64, findings: &mut Findings<'_>) -> bool {
    let refused = roller_diameter >= pitch;
    if refused {
        let message = format!("{roller_diameter:e} m, must be smaller than the pitch, {pitch:e} m");
        findings.refuse_with(
            "chain.roller_diameter",
            message,
            "look at the units of both",
        );
    }
    refused
}

/// Strength and rating of the chain. Strands and service factor count where it can be rated, and are assumed there only.
fn strength(
    text: &schema::Chain,
    of_type: Option<&CatalogueChain>,
    pitch: f64,
    findings: &mut Findings<'_>,
) -> Strength {
    let given = text.rated_power.map(|power| Capacity::Given(power.0));
    let of_type_or_none = of_type.map(|chain| catalogue::capacity(chain, pitch));
    let capacity = given.or(of_type_or_none).unwrap_or_default();
    let is_rated = !matches!(capacity, Capacity::Unknown(MissingRating::NoType));
    let default = Strength::default();
    let service_factor = match text.service_factor {
        None if is_rated => findings
            .at("chain.service_factor")
            .or(None::<f64>, &defaults::SERVICE_FACTOR),
        given => given.map_or(default.service_factor, f64::from),
    };
    let strands = text.strands.unwrap_or(default.strands);
    if text.strands.is_none() && is_rated {
        let remark = defaults::STRANDS.basis.remark();
        findings.assume("chain.strands", strands, remark);
    }
    Strength {
        breaking_load: text.breaking_load.map(f64::from),
        bearing_area: catalogue::bearing_area(text, of_type),
        pin_radius: catalogue::pin_diameter(text, of_type).map(|diameter| 0.5 * diameter),
        strands,
        service_factor,
        capacity,
    }
}

/// Parts between the joints, by the model that a text names.
fn body(
    all: (&SceneText, Option<&schema::Route>),
    text: &schema::Chain,
    links: usize,
    (roller_diameter, roller_length): (f64, Option<f64>),
    findings: &mut Findings<'_>,
) -> Option<Body> {
    if !text.model.has_springs() {
        return links::resolve(all, text, links, roller_diameter, roller_length, findings);
    }
    let body = springs(text, links, findings);
    let model = links::of_springs(all, text, roller_diameter, roller_length, findings);
    let ([masses, stiffness], model) = body.zip(model)?;
    Some(Body {
        masses,
        stiffness,
        model,
    })
}

/// Damping of every link \[N s/m\].
fn damping(
    text: &schema::Chain,
    stiffness: &[f64],
    masses: &[f64],
    model: &ChainModel,
    findings: &mut Findings<'_>,
) -> Vec<f64> {
    if let Some(damping) = text.damping {
        return vec![damping.0; stiffness.len()];
    }
    let default = &defaults::DAMPING_RATIO;
    let ratio = if model.has_springs() {
        findings
            .at("chain.damping_ratio")
            .or(text.damping_ratio, default)
    } else {
        // Rigid links are laid, not damped: whatever damping belongs to the laying stiffness.
        text.damping_ratio.map_or(default.value, f64::from)
    };
    // c = 2 ζ √(k m)
    let pairs = stiffness.iter().zip(masses);
    pairs
        .map(|(k, m)| 2.0 * ratio * (k * m).max(0.0).sqrt())
        .collect()
}

/// Masses at the joints \[kg\] and stiffness of the links \[N/m\].
fn springs(
    text: &schema::Chain,
    links: usize,
    findings: &mut Findings<'_>,
) -> Option<[Vec<f64>; 2]> {
    let rollers = links + usize::from(text.ends.is_some());
    let masses = each(
        ("mass", "masses"),
        (text.mass, text.masses.as_ref()),
        rollers,
        findings,
    );
    let stiffness = each(
        ("stiffness", "stiffnesses"),
        (text.stiffness, text.stiffnesses.as_ref()),
        links,
        findings,
    );
    if text.damping.is_some() && text.damping_ratio.is_some() {
        let message = "`damping` is given too";
        findings.refuse_with("chain.damping_ratio", message, "keep one of them");
    }
    Some([masses?, stiffness?])
}

fn lengths(
    text: &schema::Chain,
    pitch: f64,
    links: usize,
    findings: &mut Findings<'_>,
) -> Option<Vec<f64>> {
    let worn = 1.0 + text.elongation.0;
    if let Some(pitches) = &text.pitches {
        for (key, given) in [
            ("inner_pitch", text.inner_pitch),
            ("outer_pitch", text.outer_pitch),
        ] {
            if given.is_some() {
                let path = format!("chain.{key}");
                findings.refuse_with(&path, "`pitches` is given too", "keep one of them");
            }
        }
        let found = pitches.len();
        if found != links {
            let message = format!("{found} values, needed are {links}, one for every link");
            findings.refuse("chain.pitches", message);
            return None;
        }
        return Some(pitches.iter().map(|pitch| pitch.0 * worn).collect());
    }
    let inner = text.inner_pitch.map_or(pitch, f64::from);
    let outer = text.outer_pitch.map_or(pitch, f64::from);
    let alternating = text.alternates() || text.inner_pitch.is_some() || text.outer_pitch.is_some();
    if alternating && text.ends.is_none() && links % 2 == 1 {
        let message = format!("{links} links, but inner and outer links alternate");
        let hint = "a closed chain of both needs an even number";
        findings.refuse_with("chain.links", message, hint);
        return None;
    }
    let of = |i: usize| {
        if i.is_multiple_of(2) == text.outer_first {
            outer
        } else {
            inner
        }
    };
    Some((0..links).map(|i| of(i) * worn).collect())
}

/// One value for all, or a value for each.
fn each<T: Copy + Into<f64>>(
    (one, many): (&str, &str),
    (single, list): (Option<T>, Option<&Vec<T>>),
    count: usize,
    findings: &mut Findings<'_>,
) -> Option<Vec<f64>> {
    match (single, list) {
        (Some(value), None) => Some(vec![value.into(); count]),
        (None, Some(values)) if values.len() == count => {
            Some(values.iter().map(|value| (*value).into()).collect())
        }
        (None, Some(values)) => {
            let part = if many == "masses" { "roller" } else { "link" };
            let message = format!(
                "{} values, needed are {count}, one for every {part}",
                values.len()
            );
            findings.refuse(&format!("chain.{many}"), message);
            None
        }
        (Some(_), Some(_)) => {
            let message = format!("`{one}` is given too");
            findings.refuse_with(&format!("chain.{many}"), message, "keep one of them");
            None
        }
        (None, None) => {
            let hint = format!("give the {one} of one link, or `{many}` as a list");
            findings.refuse_with(&format!("chain.{one}"), "missing", hint);
            None
        }
    }
}

fn ends(text: &schema::Chain, scene: &SceneText, findings: &mut Findings<'_>) -> Option<Ends> {
    let Some([first, last]) = &text.ends else {
        return Some(Ends::Closed);
    };
    let mut resolve = |index: usize, end: &schema::End| {
        let at = findings.at(format!("chain.ends[{index}]"));
        Some(match end {
            schema::End::Free => End::Free,
            schema::End::Fixed => End::Fixed,
            schema::End::Driven { x, y } => {
                let [x, y] = motion::shifts([x, y], scene, at)?;
                End::Driven { x, y }
            }
            schema::End::Pulled { force: [x, y] } => End::Pulled {
                force: chaindrive_geometry::Vector::new(x.0, y.0),
            },
        })
    };
    let (first, last) = (resolve(0, first), resolve(1, last));
    Some(Ends::Open([first?, last?]))
}
