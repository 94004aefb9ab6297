//! Compliance behind a tooth that no moving body models: roller on bush, bush on pin and, where a scene asks, all parts that yield.
//!
//! ```text
//! 1/k_s = δ_roller(F)/F + δ_pin(F)/F,   F: a stated share of the breaking load
//! ```

mod terms;

use chaindrive_contact::Elastic;
use chaindrive_contact::elastic::{CylinderLaw, Cylinders, ElasticLaw};
use chaindrive_mechanics::ChainModel;

use super::Findings;
use super::law::steel;
use crate::catalogue::{CatalogueChain, Number};
use crate::scene::defaults;
use crate::scene::schema::{self, Contact, Rollers, SceneText};

/// Stiffness of roller on bush and bush on pin in series, zero where neither counts, and its source in words.
#[derive(Clone, Debug)]
pub(super) struct SeriesStiffness {
    pub(super) stiffness: f64,
    pub(super) remark: String,
}

/// Parts behind a tooth: dimensions as the scene has them, or the catalogue, of one strand.
#[derive(Clone, Debug)]
pub(super) struct Parts {
    of_type: Option<&'static CatalogueChain>,
    text: schema::Chain,
    /// Unity of roller and bush, and of bush and pin, in the model.
    fused: [bool; 2],
    /// Rollers as bodies of their own.
    free_rollers: bool,
    strands: f64,
    /// Mean mass at a joint \[kg\], all strands together.
    mass: f64,
}

/// Radius of the inner part, clearance and length of two cylinders \[m\].
type Fit = [f64; 3];

impl Parts {
    /// `text` is the chain completed from the catalogue, `masses` are those at the joints \[kg\].
    pub(super) fn new(text: &schema::Chain, model: &ChainModel, masses: &[f64]) -> Self {
        let of_type = text.of_type.as_deref().and_then(CatalogueChain::named);
        let [roller, pin] = model.fused();
        Self {
            of_type,
            text: text.clone(),
            // A chain that the catalogue knows as a bush chain has been completed without rollers.
            fused: [roller && text.rollers != Some(Rollers::None), pin],
            free_rollers: model.free_roller().is_some(),
            strands: model.strands().len().max(1) as f64,
            mass: masses.iter().sum::<f64>() / masses.len() as f64,
        }
    }

    /// Default compliance behind the teeth, for chains of the catalogue.
    pub(super) fn behind(&self) -> Option<SeriesStiffness> {
        let chain = self.of_type?;
        let default = &defaults::BEHIND_TEETH;
        let share = default.value;
        let load = chain.number(Number::BreakingLoad).map(|it| share * it);
        let compliance = load.and_then(|load| self.contacts(load));
        Some(SeriesStiffness {
            stiffness: compliance.map_or(0.0, f64::recip),
            remark: format!("at {share} {}, {}", default.unit, default.basis.remark()),
        })
    }

    /// 1/k_s \[m/N\] of the contacts, where something lies behind and all dimensions are known.
    fn contacts(&self, load: f64) -> Option<f64> {
        if load <= 0.0 {
            return None;
        }
        let [on_bush, on_pin] = self.fused;
        let mut compliance = 0.0;
        if on_bush {
            compliance += yields(self.roller_on_bush()?, load)?;
        }
        if on_pin {
            compliance += yields(self.bush_on_pin()?, load)?;
        }
        // Strands side by side yield together.
        compliance /= self.strands;
        (compliance > 0.0).then_some(compliance)
    }

    /// A length as the scene has it, or the catalogue \[m\].
    fn number(&self, given: Option<impl Into<f64>>, of: Number) -> Option<f64> {
        let given = given.map(Into::into);
        given.or_else(|| self.of_type?.number(of))
    }

    /// Radial clearance of the pin in its bush \[m\].
    fn play(&self) -> Option<f64> {
        let given = self.text.joint.as_ref().and_then(|it| it.clearance);
        let given = given.map(f64::from).filter(|play| *play > 0.0);
        given.or_else(|| self.of_type?.joint_clearance())
    }

    fn bush_diameter(&self) -> Option<f64> {
        let given = self.text.roller.as_ref().and_then(|it| it.bush_diameter);
        self.number(given, Number::BushDiameter)
    }

    fn pin_diameter(&self) -> Option<f64> {
        let given = self.text.joint.as_ref().and_then(|it| it.pin_diameter);
        self.number(given, Number::PinDiameter)
    }

    /// Length of the bush \[m\].
    fn joint_length(&self) -> Option<f64> {
        let given = self.text.joint.as_ref().and_then(|it| it.length);
        given
            .map(f64::from)
            .or_else(|| self.of_type?.joint_length())
    }

    /// Length of a roller \[m\]: they fill the space between the inner plates.
    fn roller_length(&self) -> Option<f64> {
        let given = self.text.roller.as_ref().and_then(|it| it.length);
        // That of strands is the length of them all.
        let of_strand = given.map(|it| it.0 / self.strands);
        self.number(of_strand, Number::InnerWidth)
    }

    /// Radial clearance of the roller on its bush \[m\]: not in the catalogue, so that of the pin.
    fn roller_play(&self) -> Option<f64> {
        let given = self.text.roller.as_ref().and_then(|it| it.clearance);
        given.map(f64::from).or_else(|| self.play())
    }

    fn roller_on_bush(&self) -> Option<Fit> {
        let radius = 0.5 * self.bush_diameter()?;
        Some([radius, self.roller_play()?, self.roller_length()?])
    }

    fn bush_on_pin(&self) -> Option<Fit> {
        let radius = 0.5 * self.pin_diameter()?;
        Some([radius, self.play()?, self.joint_length()?])
    }
}

/// Refuses a stack anywhere but behind teeth: joints, rollers and guides have none.
pub(super) fn refuse_elsewhere(scene: &SceneText, findings: &mut Findings<'_>) {
    let common = &scene.contact;
    let mut places: Vec<(String, &Contact)> = vec![
        ("contact.guides".into(), &common.guides),
        ("contact.joints".into(), &common.joints),
        ("contact.rollers".into(), &common.rollers),
    ];
    for (index, guide) in scene.guides.iter().enumerate() {
        places.push((format!("guides[{index}].contact"), &guide.contact));
    }
    let only = scene.chain.iter().map(|it| ("chain".to_owned(), it));
    let several = scene.chains.iter().enumerate();
    let several = several.map(|(index, it)| (format!("chains[{index}]"), &it.chain));
    for (place, chain) in only.chain(several) {
        let joint = chain.joint.as_ref().map(|it| &it.contact);
        let roller = chain.roller.as_ref().map(|it| &it.contact);
        places.extend(joint.map(|it| (format!("{place}.joint.contact"), it)));
        places.extend(roller.map(|it| (format!("{place}.roller.contact"), it)));
    }
    for (path, contact) in places {
        if contact.stack.is_some() {
            let hint = "leave it out, or give `series`";
            let message = "only teeth have a stack behind them";
            findings.refuse_with(&format!("{path}.stack"), message, hint);
        }
    }
}

/// δ/F \[m/N\] of something round in a bore that is wider, under a load \[N\].
fn yields([radius, play, length]: Fit, load: f64) -> Option<f64> {
    let steel = steel();
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
