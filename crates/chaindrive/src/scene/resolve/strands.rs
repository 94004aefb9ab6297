//! Strands side by side: what a chain of them has as a whole, and how they share its load.

use chaindrive_mechanics::BushStrands;

use super::{Findings, catalogue};
use crate::catalogue::CatalogueChain;
use crate::scene::schema::{self, Rollers};
use chaindrive_quantities::{Damping, Force, Length, Mass, Ratio, Stiffness};

/// One value for each of so many strands, `default` where none are written; nothing where their number is another.
fn listed<T: Copy + Into<f64>>(
    given: Option<&Vec<T>>,
    count: usize,
    default: f64,
) -> Option<Vec<f64>> {
    let values = given.map_or(vec![default; count], |all| {
        all.iter().map(|value| (*value).into()).collect()
    });
    (values.len() == count).then_some(values)
}

/// Lengths and stiffnesses of the strands in those that are written \[–\]; none where some are missing.
fn each(text: &schema::Chain) -> Option<[Vec<f64>; 2]> {
    let count = text.strands? as usize;
    let elongations = listed(text.strand_elongations.as_ref(), count, 0.0)?;
    let stiffnesses = listed(text.strand_stiffnesses.as_ref(), count, 1.0)?;
    let lengths = elongations.iter().map(|elongation| 1.0 + elongation);
    Some([lengths.collect(), stiffnesses])
}

/// Names what a chain cannot have with its strands, or without any.
pub(super) fn refuse(text: &schema::Chain, findings: &mut Findings<'_>) {
    let lists = [
        (
            "strand_elongations",
            text.strand_elongations.as_ref().map(Vec::len),
        ),
        (
            "strand_stiffnesses",
            text.strand_stiffnesses.as_ref().map(Vec::len),
        ),
    ];
    if !text.model.has_strands() {
        for (key, _) in lists.iter().filter(|(_, length)| length.is_some()) {
            let hint = "take `model = \"bush-strands\"`, or leave it out";
            let message = "only bush strands share loads";
            findings.refuse_with(&format!("chain.{key}"), message, hint);
        }
        return;
    }
    let Some(count) = text.strands else {
        let hint = "give the number of strands, such as 2";
        findings.refuse_with("chain.strands", "missing", hint);
        return;
    };
    for (key, length) in lists {
        if let Some(length) = length.filter(|length| *length != count as usize) {
            let message = format!("{length} values, needed are {count}, one a strand");
            findings.refuse(&format!("chain.{key}"), message);
        }
    }
    let roller = text.roller.clone().unwrap_or_default();
    let only_long = schema::Roller {
        length: roller.length,
        ..schema::Roller::default()
    };
    let given = [
        (
            "rollers",
            text.rollers.is_some_and(|it| it != Rollers::None),
        ),
        ("roller", roller != only_long),
        ("inner", text.inner.is_some()),
        ("outer", text.outer.is_some()),
    ];
    let message = "a chain of bush strands has none";
    let mut at = findings.at("chain");
    at.refuse_given(given, message, "leave it out");
}

/// The strands of a chain as one: masses and lengths of contact are so many times those of a strand, stiffness and damping the sums, the
/// length without load is that at which all together pull nothing.
///
/// `text` is the chain completed from the catalogue, where it has this type.
pub(super) fn as_one(text: &schema::Chain, of_type: Option<&CatalogueChain>) -> schema::Chain {
    let mut text = text.clone();
    let Some([lengths, stiffnesses]) = each(&text).filter(|_| text.model.has_strands()) else {
        return text;
    };
    let count = lengths.len() as f64;
    let (_, [length, stiffness]) = BushStrands::together(&lengths, &stiffnesses);
    text.breaking_load = breaking_load(&text, &lengths, &stiffnesses).map(Force);
    text.mass = text.mass.map(|mass| Mass(count * mass.0));
    for mass in text.masses.iter_mut().flatten() {
        mass.0 *= count;
    }
    text.stiffness = text.stiffness.map(|own| Stiffness(stiffness * own.0));
    for own in text.stiffnesses.iter_mut().flatten() {
        own.0 *= stiffness;
    }
    text.damping = text.damping.map(|own| Damping(stiffness * own.0));
    // (1 + ε) λ − 1, such that λ = 1 leaves ε to the last bit.
    text.elongation = Ratio(text.elongation.0 * length + (length - 1.0));
    let given = text.roller.as_ref().and_then(|roller| roller.length);
    let long = given.or_else(|| of_type.and_then(catalogue::roller_length).map(Length));
    if let Some(long) = long {
        text.roller.get_or_insert_default().length = Some(Length(count * long.0));
    }
    text
}

/// Tension of a link \[N\] under which the first of its strands bears what it breaks at.
///
/// ```text
/// F = min over s of Σ_j k_j max(ℓ − p_j, 0),   ℓ = p_s + F₁/k_s
/// ```
fn breaking_load(text: &schema::Chain, lengths: &[f64], stiffnesses: &[f64]) -> Option<f64> {
    let single = text.breaking_load?.0;
    let listed = text.stiffnesses.iter().flatten().map(|it| it.0);
    let stiffness = text.stiffness.map(f64::from).or(listed.reduce(f64::min))?;
    let pitch = text.pitch?.0;
    let strands = || lengths.iter().zip(stiffnesses);
    let breaks = strands().map(|(own, factor)| {
        let length = own * pitch + single / (factor * stiffness);
        let all =
            strands().map(|(own, factor)| factor * stiffness * (length - own * pitch).max(0.0));
        all.sum::<f64>()
    });
    breaks.reduce(f64::min)
}

/// Load sharing of the strands of a chain.
pub(super) fn model(text: &schema::Chain) -> Option<BushStrands> {
    let [lengths, stiffnesses] = each(text)?;
    let joint = text.joint.as_ref();
    let (strands, _) = BushStrands::together(&lengths, &stiffnesses);
    Some(BushStrands {
        strands,
        clearance: joint.and_then(|it| it.clearance).map_or(0.0, |it| it.0),
        outer_first: text.outer_first,
    })
}
