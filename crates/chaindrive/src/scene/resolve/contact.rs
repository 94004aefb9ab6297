//! Contacts: the keys of a sprocket or guide, completed by those that hold for all of its kind.

use chaindrive_contact::dissipation::{Hysteresis, Viscous};
use chaindrive_contact::{Dissipation, Elastic, Film, Friction, Law, Lubricant};
use chaindrive_mechanics::Surface;

use super::Findings;
use super::cursor::Cursor;
use super::film::{self, Strip};
use super::law::{Pair, elastic};
use crate::scene::defaults::{self, Default};
use crate::scene::schema::{Contact, Stack, Written};

/// Values on which a contact falls back.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fallback {
    /// Place of the contact that holds for all.
    path: &'static str,
    restitution: &'static Default,
}

/// Teeth of steel.
pub(super) const TEETH: Fallback = Fallback {
    path: "contact.teeth",
    restitution: &defaults::TEETH_RESTITUTION,
};

/// Guides lined with rubber or plastic.
pub(super) const GUIDES: Fallback = Fallback {
    path: "contact.guides",
    restitution: &defaults::GUIDES_RESTITUTION,
};

/// Pins of steel in oiled bushes.
pub(super) const JOINTS: Fallback = Fallback {
    path: "contact.joints",
    restitution: &defaults::JOINTS_RESTITUTION,
};

/// Bushes of steel in oiled rollers.
pub(super) const ROLLERS: Fallback = Fallback {
    path: "contact.rollers",
    restitution: &defaults::ROLLERS_RESTITUTION,
};

/// A contact as a scene describes it: its own keys at `path`, completed by those that hold for all of its kind.
#[derive(Clone, Copy)]
pub(super) struct ContactText<'a> {
    pub(super) own: &'a Contact,
    pub(super) path: &'a str,
    pub(super) common: &'a Contact,
    pub(super) fallback: Fallback,
}

impl<'a> ContactText<'a> {
    /// The text under a key and its place: that of the contact, or else that for all.
    fn text<T>(&self, key: &str, under: fn(&Contact) -> Option<&T>) -> Option<(&'a T, String)> {
        let own = under(self.own).map(|text| (text, self.path));
        let common = || Some((under(self.common)?, self.fallback.path));
        let (text, path) = own.or_else(common)?;
        Some((text, format!("{path}.{key}")))
    }

    /// Normal force, friction and film; `absent` gives the elastic law of a scene without one.
    pub(super) fn surface(
        &self,
        pair: Pair,
        strip: Option<Strip>,
        findings: &mut Findings<'_>,
        absent: impl FnOnce(&mut Findings<'_>) -> Option<Elastic>,
    ) -> Option<Surface> {
        let law = self.law(pair, findings, absent);
        let friction = self.friction(findings);
        let film = self.film(strip?, findings);
        Some(Surface {
            law: law?,
            friction: friction?,
            film,
        })
    }

    /// Text of the film, and its path.
    pub(super) fn film_text(&self) -> Option<(&'a Written<Film>, String)> {
        self.text("film", |contact| contact.film.as_ref())
    }

    /// Film of oil between the surfaces; none without a text, or with a refused one.
    pub(super) fn film(&self, strip: Strip, findings: &mut Findings<'_>) -> Option<Film> {
        let (text, path) = self.film_text()?;
        film::resolve(text, strip, findings.at(path))
    }

    /// Its friction law.
    pub(super) fn friction(&self, findings: &mut Findings<'_>) -> Option<Friction> {
        if let Some((text, path)) = self.text("friction", |contact| contact.friction.as_ref()) {
            return friction(text, Journal::default(), findings.at(path));
        }
        findings.assume_kind(&format!("{}.friction", self.fallback.path), "none");
        Some(Friction::None)
    }

    /// Its normal force; `absent` as in [`ContactText::surface`].
    pub(super) fn law(
        &self,
        pair: Pair,
        findings: &mut Findings<'_>,
        absent: impl FnOnce(&mut Findings<'_>) -> Option<Elastic>,
    ) -> Option<Law> {
        let elastic = match self.text("law", |contact| contact.law.as_ref()) {
            Some((law, path)) => elastic(law, pair, findings.at(path)),
            None => absent(findings),
        };
        let dissipation = self.dissipation(findings);
        let floor = self.own.onset_floor.or(self.common.onset_floor);
        let mut common = findings.at(self.fallback.path);
        Some(Law {
            onset_floor: common.key("onset_floor").or(floor, &defaults::ONSET_FLOOR),
            elastic: elastic?,
            series: self.series().filter(|stiffness| *stiffness > 0.0),
            dissipation: dissipation?,
        })
    }

    /// Path at which the scene gives a law, if it does.
    pub(super) fn law_path(&self) -> Option<String> {
        let (_, path) = self.text("law", |contact| contact.law.as_ref())?;
        Some(path)
    }

    /// Stiffness \[N/m\] behind the surfaces, if the scene gives one; zero is rigid.
    pub(super) fn series(&self) -> Option<f64> {
        let own_stack = self.own.stack.is_some();
        let common = self.common.series.filter(|_| !own_stack);
        self.own.series.or(common).map(f64::from)
    }

    /// Parts that yield behind the surfaces, with the path at which the scene asks for them; refused beside a stiffness.
    pub(super) fn stack(&self, findings: &mut Findings<'_>) -> Option<(Stack, String)> {
        let own = (self.own, self.path);
        let common = (self.common, self.fallback.path);
        for (text, path) in [own, common] {
            if text.stack.is_some() && text.series.is_some() {
                let hint = "keep one of them";
                findings.refuse_once(&format!("{path}.stack"), "`series` is given too", hint);
                return None;
            }
        }
        let says = |text: &Contact| text.stack.is_some() || text.series.is_some();
        let (text, path) = if says(self.own) { own } else { common };
        text.stack.map(|stack| (stack, format!("{path}.stack")))
    }

    fn dissipation(&self, findings: &mut Findings<'_>) -> Option<Dissipation> {
        let Self {
            own,
            path,
            common,
            fallback,
        } = *self;
        let says = |text: &Contact| {
            text.restitution.is_some() || text.damping.is_some() || text.dissipation.is_some()
        };
        if let Some((_, film)) = self.film_text() {
            for (text, place) in [(own, path), (common, fallback.path)] {
                if says(text) {
                    let message =
                        format!("beside a {place} with a restitution, damping or dissipation");
                    let hint = "keep one of them: what an impact leaves follows from the film";
                    findings.refuse_once(&film, message, hint);
                    return None;
                }
            }
            return Some(Dissipation::None);
        }
        let (said, place) = if says(own) {
            (own, path)
        } else {
            (common, fallback.path)
        };
        let mut at = findings.at(place);
        let mut twice = |key: &str, other: &str| {
            let message = format!("`{other}` is given too");
            at.key(key).refuse_once(message, "keep one of them");
        };
        if let Some(damping) = said.damping {
            if said.restitution.is_some() {
                twice("damping", "restitution");
                return None;
            }
            if said.dissipation.is_some() {
                twice("damping", "dissipation");
                return None;
            }
            return Some(Dissipation::Viscous(Viscous { damping: damping.0 }));
        }
        let name = said
            .dissipation
            .or(common.dissipation.filter(|name| *name != Hysteresis::None));
        if name == Some(Hysteresis::None) && said.restitution.is_some() {
            twice("restitution", "dissipation = \"none\"");
            return None;
        }
        let name = at
            .key("dissipation")
            .or_chosen(name, &defaults::DISSIPATION);
        let restitution = match name {
            Hysteresis::None => 1.0,
            _ => at.key("restitution").or(
                said.restitution.or(common.restitution),
                fallback.restitution,
            ),
        };
        let dissipation = Dissipation::with_restitution(name, restitution);
        at.sound(dissipation.check())?;
        Some(dissipation)
    }
}

/// Spring that holds a sticking contact, where the scene gives none.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spring {
    /// Unit of the multiple \[N/m\].
    pub(super) unit: f64,
    /// Multiple of that unit.
    pub(super) factor: &'static Default,
}

/// Measures of a pin in its bush: defaults of its friction.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Journal {
    pub(super) spring: Option<Spring>,
    /// What would make the spring known, as the end of a sentence.
    pub(super) unknown: &'static str,
    /// Length \[m\].
    pub(super) length: Option<f64>,
    /// Radial clearance over the radius \[–\].
    pub(super) relative_clearance: Option<f64>,
}

/// The friction that a scene describes; what it leaves open of a pin in its bush is that of `journal`.
pub(super) fn friction(
    text: &Written<Friction>,
    journal: Journal,
    mut at: Cursor<'_, '_>,
) -> Option<Friction> {
    let mut keys = at.completed(text);
    let kind = text.word("kind");
    let lubricated = kind == "stribeck";
    if lubricated {
        at.fill_viscosity(&mut keys, Lubricant::dynamic_viscosity)?;
        let of_pin = Some("that of the pin in its bush");
        let length = journal.length.zip(of_pin);
        let clearance = journal.relative_clearance.zip(of_pin);
        let hint = "give the radial clearance over the radius, such as 0.01";
        at.fill(&mut keys, "length", length, "give it, such as \"12 mm\"")?;
        at.fill(&mut keys, "relative_clearance", clearance, hint)?;
    }
    if lubricated || kind == "spring-slider" {
        let spring = journal.spring;
        let spring = spring.map(|it| it.factor.multiple(it.unit));
        let hint = format!("give it, such as \"50 MN/m\"{}", journal.unknown);
        at.fill(&mut keys, "stiffness", spring, &hint)?;
    }
    at.read(keys, Friction::check)
}
