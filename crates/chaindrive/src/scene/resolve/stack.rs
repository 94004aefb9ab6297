//! The stack behind a tooth: the roller on its bush and the bush on its pin, where they do not move by themselves.
//!
//! ```text
//! 1/k_s = δ_roller(F)/F + δ_pin(F)/F,   F: a stated share of the breaking load
//! ```

use chaindrive_contact::Elastic;
use chaindrive_contact::elastic::{CylinderLaw, Cylinders, ElasticLaw};
use chaindrive_mechanics::ChainModel;

use super::Findings;
use super::law::steel;
use crate::catalogue::{CatalogueChain, Number};
use crate::scene::defaults;
use crate::scene::schema::{self, Rollers};

/// Stiffness of what lies behind the surface of a tooth, zero where that is nothing, and why.
#[derive(Clone, Debug)]
pub(super) struct Behind {
    pub(super) stiffness: f64,
    pub(super) remark: String,
}

impl Behind {
    /// Under a chain of the catalogue. `text` is the chain completed from the catalogue.
    pub(super) fn new(
        text: &schema::Chain,
        model: &ChainModel,
        findings: &Findings<'_>,
    ) -> Option<Self> {
        let chain = text.of_type.as_deref().and_then(CatalogueChain::named)?;
        let default = &defaults::BEHIND_TEETH;
        let share = default.value(findings.version);
        let compliance = compliance(chain, share, text, model, findings);
        Some(Self {
            stiffness: compliance.map_or(0.0, f64::recip),
            remark: format!("at {share} {}, {}", default.unit, default.basis.remark()),
        })
    }
}

/// 1/k_s \[m/N\], where something lies behind and all dimensions are known.
fn compliance(
    chain: &CatalogueChain,
    share: f64,
    text: &schema::Chain,
    model: &ChainModel,
    findings: &Findings<'_>,
) -> Option<f64> {
    let load = share * chain.number(Number::BreakingLoad)?;
    if load <= 0.0 {
        return None;
    }
    // A chain that the catalogue knows as a bush chain has been completed without rollers.
    let [roller, on_pin] = model.fused();
    let on_bush = roller && text.rollers != Some(Rollers::None);
    let number = |given: Option<f64>, of| given.or_else(|| chain.number(of));
    let joint = text.joint.clone().unwrap_or_default();
    let play = joint.clearance.map(|it| it.0).filter(|play| *play > 0.0);
    let play = play.or_else(|| chain.joint_clearance())?;
    let mut compliance = 0.0;
    if on_bush {
        let roller = text.roller.clone().unwrap_or_default();
        let bush = number(roller.bush_diameter.map(|it| it.0), Number::BushDiameter)?;
        let length = number(roller.length.map(|it| it.0), Number::InnerWidth)?;
        // The play of rollers is not in the catalogue: that of the pins.
        let play = roller.clearance.map_or(play, |it| it.0);
        compliance += yields([0.5 * bush, play, length], load, findings)?;
    }
    if on_pin {
        let pin = number(joint.pin_diameter.map(|it| it.0), Number::PinDiameter)?;
        let length = joint.length.map(|it| it.0);
        let length = length.or_else(|| chain.joint_length())?;
        compliance += yields([0.5 * pin, play, length], load, findings)?;
    }
    // Strands side by side yield together.
    compliance /= model.strands().len().max(1) as f64;
    (compliance > 0.0).then_some(compliance)
}

/// δ/F \[m/N\] of something round in a bore that is wider, under a load \[N\].
fn yields([radius, play, length]: [f64; 3], load: f64, findings: &Findings<'_>) -> Option<f64> {
    let steel = steel(findings.version);
    let pair = Cylinders::pin_in_hole(radius + play, radius, length, steel.composite(steel));
    let law: Elastic = CylinderLaw::Conformal.between(&pair).ok()?;
    // The law grows without bound: from a depth that is enough down to the rounding of a length.
    let (mut low, mut high) = (0.0, play);
    while law.force(high) < load {
        high *= 2.0;
    }
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if law.force(middle) < load {
            low = middle;
        } else {
            high = middle;
        }
    }
    Some(high / load)
}
