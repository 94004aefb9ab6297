//! Resistance of the joints of any chain: friction of pin and bush, and viscous damping.

use chaindrive_contact::friction::SpringSlider;
use chaindrive_contact::{Friction, Law};
use chaindrive_mechanics::{Articulation, LateralRub};
use chaindrive_quantities::check;
use serde_json::json;

use super::contact::{Journal, Spring};
use super::contact_stiffness::stiffness_under_pretension;
use super::{Findings, contact};
use crate::catalogue::{CatalogueChain, Number};
use crate::scene::defaults;
use crate::scene::schema::{self, Route, SceneText};

/// The joints of a chain, as far as friction is concerned.
#[derive(Clone, Copy, Debug)]
pub(super) struct Joints<'a> {
    scene: &'a SceneText,
    text: &'a schema::Chain,
    of_type: Option<&'static CatalogueChain>,
    /// Stiffness of a link \[N/m\], where it is known.
    link_stiffness: Option<f64>,
}

impl<'a> Joints<'a> {
    /// `text` is the chain completed from the catalogue; links whose stiffness is not given have that of the catalogue.
    pub(super) fn new(
        scene: &'a SceneText,
        text: &'a schema::Chain,
        link_stiffness: Option<f64>,
    ) -> Self {
        let of_type = text.of_type.as_deref().and_then(CatalogueChain::named);
        let catalogued = || of_type?.number(Number::LinkStiffness);
        Self {
            scene,
            text,
            of_type,
            link_stiffness: link_stiffness.or_else(catalogued),
        }
    }

    /// Stiffness of a link \[N/m\], where it is known.
    pub(super) fn link_stiffness(&self) -> Option<f64> {
        self.link_stiffness
    }

    /// Radius of the pin \[m\]: as given, or that of the catalogue.
    fn pin(&self) -> Option<f64> {
        let given = self.text.joint.as_ref().and_then(|it| it.pin_diameter);
        let given = given.map(f64::from);
        let diameter = given.or_else(|| self.of_type?.number(Number::PinDiameter));
        diameter.map(|it| 0.5 * it)
    }

    /// Friction of pin and bush: as the chain says, or as all chains do; or the usual one where the catalogue knows the pin.
    pub(super) fn friction(&self, findings: &mut Findings<'_>) -> Option<Friction> {
        let joint = self.text.joint.as_ref();
        let own = joint.and_then(|it| it.contact.friction.as_ref());
        let journal = Journal {
            spring: self.spring(),
            unknown: if self.link_stiffness.is_none() {
                "; or give `chain.stiffness`, from which it follows"
            } else {
                "; or give `chain.joint.pin_diameter`, from which and from the stiffness of a link it follows"
            },
            length: self.length(),
            relative_clearance: self.relative_clearance(),
        };
        let mut said = |text, place: &str| contact::friction(text, journal, findings.at(place));
        let friction = match (own, &self.scene.contact.joints.friction) {
            (Some(text), _) => said(text, "chain.joint.contact.friction"),
            (None, Some(text)) => said(text, "contact.joints.friction"),
            (None, None) => Some(self.usual(journal.spring, findings)),
        };
        let factor = joint.map_or(1.0, |it| it.pressure_factor.0.0);
        let pressed = friction?.pressed(factor);
        let refused = |error| findings.at("chain.joint").sound(Err(error));
        pressed.map_err(refused).ok()
    }

    /// Length on which pin and bush touch \[m\]: as given, or that of the catalogue.
    fn length(&self) -> Option<f64> {
        let given = self.text.joint.as_ref().and_then(|it| it.length);
        given
            .map(f64::from)
            .or_else(|| self.of_type?.joint_length())
    }

    /// Radial clearance of the pin over its radius \[–\]: as given, or that of the catalogue.
    fn relative_clearance(&self) -> Option<f64> {
        let given = self.text.joint.as_ref().and_then(|it| it.clearance);
        let clearance = given
            .map(f64::from)
            .or_else(|| self.of_type?.joint_clearance());
        Some(clearance? / self.pin()?).filter(|it| *it > 0.0)
    }

    /// The spring of friction in the joints, if the stiffness of a link is known.
    fn spring(&self) -> Option<Spring> {
        let link = self.link_stiffness?;
        if self.text.model.has_play() {
            return Some(Spring {
                unit: link,
                factor: &defaults::PLAY_SPRING,
            });
        }
        self.turning_spring(link)
    }

    /// The spring of what holds where links of a stiffness \[N/m\] turn, if the pin is known.
    fn turning_spring(&self, link: f64) -> Option<Spring> {
        // k = 0.1 k_link (p/r)² on the surface is σ = 0.1 k_link p² in the joint.
        let lever = self.text.pitch?.0 / self.pin()?;
        Some(Spring {
            unit: link * lever * lever,
            factor: &defaults::JOINTS_SPRING,
        })
    }

    /// A spring without friction of its own, for seals and plates, where nothing else holds.
    fn bare_spring(&self, findings: &mut Findings<'_>) -> Option<Friction> {
        let given = || self.text.stiffness.map(f64::from);
        let link = self.link_stiffness.or_else(given);
        let Some(spring) = link.and_then(|link| self.turning_spring(link)) else {
            let hint = "give `stiffness` and `joint.pin_diameter`: seals and plates hold in proportion to the links";
            findings.refuse_with("chain.stiffness", "missing", hint);
            return None;
        };
        Some(Friction::SpringSlider(SpringSlider {
            coefficient: 0.0,
            stiffness: spring.factor.value * spring.unit,
        }))
    }

    /// Friction of plates between sprockets out of line.
    fn lateral(&self, plate_height: f64, findings: &mut Findings<'_>) -> Option<LateralRub> {
        let mut places = self.scene.sprockets.iter().map(|it| it.lateral.0);
        let first = places.next()?;
        if places.all(|place| (place - first).abs() <= 0.0) {
            return None;
        }
        let lever = defaults::LATERAL_LEVER.multiple(plate_height);
        let mut at = findings.at("chain.lateral");
        let mut keys = at.completed(&self.text.lateral);
        at.fill(&mut keys, "lever", Some(lever), "")?;
        at.read(keys, check::<LateralRub>)
    }

    fn usual(&self, spring: Option<Spring>, findings: &mut Findings<'_>) -> Friction {
        // What is common is that of the only chain.
        let common = "contact.joints.friction";
        let place = findings
            .chain
            .map_or(common, |_| "chain.joint.contact.friction");
        let coefficient = defaults::JOINTS_FRICTION.value;
        let knows_pin = |chain: &CatalogueChain| chain.number(Number::PinDiameter).is_some();
        let rubs = self.of_type.is_some_and(knows_pin);
        let Some(spring) = spring.filter(|_| rubs) else {
            findings.assume_kind(place, "none");
            return Friction::None;
        };
        let (stiffness, soft) = spring.factor.multiple(spring.unit);
        let law = SpringSlider {
            coefficient,
            stiffness,
        };
        let text = json!({
            "kind": "spring-slider",
            "coefficient": law.coefficient,
            "stiffness": law.stiffness,
        });
        let coefficient = defaults::JOINTS_FRICTION.basis.remark();
        let remark = format!("coefficient {coefficient}; stiffness {soft}");
        findings.assume(place, text, remark);
        Friction::SpringSlider(law)
    }

    /// Stiffness \[N/m\] of what yields in a link beside its joint with clearance, where that of the whole link is known and the joint
    /// alone is stiffer; or of the part of it that lies behind the pins, where links are springs.
    ///
    /// ```text
    /// 1/k_s = 1/k − 1/k_joint
    /// ```
    pub(super) fn plates(
        &self,
        joint: &Law,
        route: Option<&Route>,
        radius: f64,
        springs: bool,
        findings: &mut Findings<'_>,
    ) -> Option<f64> {
        let default = if springs {
            &defaults::PINS
        } else {
            &defaults::PLATES
        };
        let share = default.value;
        let compliance =
            1.0 / self.link_stiffness? - 1.0 / stiffness_under_pretension(joint, route, radius);
        let stiffness = 1.0 / (share * compliance);
        if !(stiffness > 0.0 && stiffness.is_finite()) {
            return None;
        }
        let common = "contact.joints.series";
        let place = findings
            .chain
            .map_or(common, |_| "chain.joint.contact.series");
        let remark = default.basis.remark();
        findings.assume(place, stiffness, &*remark);
        Some(stiffness)
    }

    /// The resistance; none where nothing resists. Pins with clearance rub in the contact with their bushes.
    pub(super) fn articulation(
        &self,
        plate_height: f64,
        findings: &mut Findings<'_>,
    ) -> Option<Articulation> {
        let joint = self.text.joint.as_ref();
        let damping = joint.map_or(0.0, |joint| joint.damping.0);
        let play = self.text.model.has_play();
        let seal = joint.map_or(0.0, |joint| joint.seal_torque.0);
        let lateral = self.lateral(plate_height, findings);
        let friction = if play {
            Friction::None
        } else {
            self.friction(findings)?
        };
        let friction = if friction == Friction::None && (seal > 0.0 || lateral.is_some()) {
            self.bare_spring(findings)?
        } else {
            friction
        };
        let rubs = friction != Friction::None;
        if !rubs && damping == 0.0 {
            return None;
        }
        let pin = self.pin();
        if rubs {
            let Some(pin) = pin else {
                let hint = "give the diameter of the pin, on which the joints slide";
                findings.refuse_with("chain.joint.pin_diameter", "missing", hint);
                return None;
            };
            let given = joint.is_some_and(|joint| joint.pin_diameter.is_some());
            if let (false, Some(chain)) = (given, self.of_type) {
                let remark = format!(
                    "{}: {}",
                    chain.name,
                    chain.status(Number::PinDiameter.status())
                );
                findings.assume("chain.joint.pin_diameter", 2.0 * pin, remark);
            }
        }
        Some(Articulation {
            friction,
            // Where nothing slides any radius will do.
            radius: pin.unwrap_or(0.5 * self.text.pitch?.0),
            damping,
            seal,
            lateral,
        })
    }
}

/// Joints without clearance have no play to describe, nor an impact.
pub(super) fn refuse_play(text: &schema::Chain, findings: &mut Findings<'_>) {
    let Some(joint) = &text.joint else {
        return;
    };
    let contact = &joint.contact;
    let given = [
        (
            "clearance",
            joint.clearance.is_some() && !text.model.has_strands(),
        ),
        ("length", joint.length.is_some()),
        ("contact.law", contact.law.is_some()),
        ("contact.series", contact.series.is_some()),
        ("contact.restitution", contact.restitution.is_some()),
        ("contact.damping", contact.damping.is_some()),
        ("contact.dissipation", contact.dissipation.is_some()),
        ("contact.onset_floor", contact.onset_floor.is_some()),
        ("contact.film", contact.film.is_some()),
    ];
    let hint = "take `model = \"clearance-joints\"` (of clearance 0: joints without play, links that yield), or leave it out";
    let message = "only pins with clearance have one";
    findings
        .at("chain.joint")
        .refuse_given(given, message, hint);
}
