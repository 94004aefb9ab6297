//! Contacts: what a sprocket or guide says, completed by what holds for all.

use chaindrive_contact::dissipation::{Hysteresis, Viscous};
use chaindrive_contact::{Dissipation, Elastic, Film, Friction, Law};
use chaindrive_mechanics::Surface;

use super::Findings;
use super::film::{self, Strip};
use super::law::{Pair, elastic};
use crate::scene::defaults::{self, Default};
use crate::scene::schema::{self, Contact, Stack, Written};

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

/// Description of one contact in a scene: its own words at `path`, then what holds for all of its kind.
#[derive(Clone, Copy)]
pub(super) struct Said<'a> {
    pub(super) own: &'a Contact,
    pub(super) path: &'a str,
    pub(super) common: &'a Contact,
    pub(super) fallback: Fallback,
}

impl Said<'_> {
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
    pub(super) fn film_text(&self) -> Option<(&schema::Film, String)> {
        let own = self.own.film.as_ref().map(|film| (film, self.path));
        let common = self.common.film.as_ref();
        let found = own.or(common.map(|film| (film, self.fallback.path)));
        found.map(|(film, path)| (film, format!("{path}.film")))
    }

    /// Film of oil between the surfaces; none without a text, or with a refused one.
    pub(super) fn film(&self, strip: Strip, findings: &mut Findings<'_>) -> Option<Film> {
        let (text, path) = self.film_text()?;
        film::resolve(text, &path, strip, findings)
    }

    /// How it rubs.
    pub(super) fn friction(&self, findings: &mut Findings<'_>) -> Option<Friction> {
        let common = self.fallback.path;
        match (&self.own.friction, &self.common.friction) {
            (Some(text), _) => friction(text, self.path, Journal::default(), findings),
            (None, Some(text)) => friction(text, common, Journal::default(), findings),
            (None, None) => {
                findings.assume_kind(&format!("{common}.friction"), "none");
                Some(Friction::None)
            }
        }
    }

    /// How it pushes; `absent` as in [`Said::surface`].
    pub(super) fn law(
        &self,
        pair: Pair,
        findings: &mut Findings<'_>,
        absent: impl FnOnce(&mut Findings<'_>) -> Option<Elastic>,
    ) -> Option<Law> {
        let Self { own, common, .. } = self;
        let at = |path: &str| format!("{path}.law");
        let elastic = match (&own.law, &common.law) {
            (Some(law), _) => elastic(law, pair, &at(self.path), findings),
            (None, Some(law)) => elastic(law, pair, &at(self.fallback.path), findings),
            (None, None) => absent(findings),
        };
        let dissipation = self.dissipation(findings);
        let floor = own.onset_floor.or(common.onset_floor).map(|v| v.0);
        let place = format!("{}.onset_floor", self.fallback.path);
        let onset_floor = findings.or_default(floor, &place, &defaults::ONSET_FLOOR);
        Some(Law {
            elastic: elastic?,
            series: self.series().filter(|stiffness| *stiffness > 0.0),
            dissipation: dissipation?,
            onset_floor,
        })
    }

    /// Where the scene gives a law, if it does.
    pub(super) fn law_path(&self) -> Option<String> {
        let own = self.own.law.is_some().then_some(self.path);
        let common = self.common.law.is_some().then_some(self.fallback.path);
        own.or(common).map(|path| format!("{path}.law"))
    }

    /// Stiffness \[N/m\] of what lies behind, where the scene says something of it; zero is rigid.
    pub(super) fn series(&self) -> Option<f64> {
        let own_stack = self.own.stack.is_some();
        let common = self.common.series.filter(|_| !own_stack);
        let given = self.own.series.or(common);
        given.map(|stiffness| stiffness.0)
    }

    /// Parts that lie behind, where the scene asks for them, and the place where it does; refused beside a stiffness.
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
        let (said, place) = if says(own) {
            (own, path)
        } else {
            (common, fallback.path)
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
        let mut twice = |key: &str, other: &str| {
            let message = format!("`{other}` is given too");
            findings.refuse_once(&format!("{place}.{key}"), message, "keep one of them");
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
        let name = findings.or_chosen(
            name,
            &format!("{place}.dissipation"),
            &defaults::DISSIPATION,
        );
        let restitution = match name {
            Hysteresis::None => 1.0,
            _ => findings.or_default(
                said.restitution.or(common.restitution).map(|e| e.0),
                &format!("{place}.restitution"),
                fallback.restitution,
            ),
        };
        let dissipation = Dissipation::with_restitution(name, restitution);
        let sound = dissipation.check();
        let sound = sound.map_err(|error| findings.refuse_parameter(place, &error));
        sound.ok().map(|()| dissipation)
    }
}

/// Stiffness of a spring that holds what sticks, where the scene is silent.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spring {
    /// Unit of the multiple \[N/m\].
    pub(super) unit: f64,
    /// How many of them.
    pub(super) factor: &'static Default,
}

/// Measures of a pin in its bush: defaults of its friction.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Journal {
    pub(super) spring: Option<Spring>,
    /// Length \[m\].
    pub(super) length: Option<f64>,
    /// Radial clearance over the radius \[–\].
    pub(super) relative_clearance: Option<f64>,
}

/// The friction that a scene describes at `place`; what it leaves open of a pin in its bush is that of `journal`.
pub(super) fn friction(
    text: &Written<Friction>,
    place: &str,
    journal: Journal,
    findings: &mut Findings<'_>,
) -> Option<Friction> {
    let path = format!("{place}.friction");
    let mut keys = findings.completed(text.keys.clone(), "Friction", &path);
    let kind = text.word("kind");
    let lubricated = kind == "stribeck";
    if lubricated && keys.get("viscosity").is_none() {
        let path = format!("{path}.viscosity");
        keys["viscosity"] = findings.oil_dynamic_viscosity(&path)?.into();
    }
    let known = [
        ("length", journal.length, "give it, such as \"12 mm\""),
        (
            "relative_clearance",
            journal.relative_clearance,
            "give the radial clearance over the radius, such as 0.01",
        ),
    ];
    for (key, value, hint) in known {
        if lubricated && keys.get(key).is_none() {
            let path = format!("{path}.{key}");
            let Some(value) = value else {
                findings.refuse_once(&path, "missing", hint);
                return None;
            };
            findings.assume(&path, value, "that of the pin in its bush");
            keys[key] = value.into();
        }
    }
    if (lubricated || kind == "spring-slider") && keys.get("stiffness").is_none() {
        let path = format!("{path}.stiffness");
        let Some(spring) = journal.spring else {
            let hint = "give it, such as \"50 MN/m\"; it is known in joints of links whose pins and stiffness are";
            findings.refuse_once(&path, "missing", hint);
            return None;
        };
        keys["stiffness"] = findings
            .or_multiple(None, &path, spring.factor, spring.unit)
            .into();
    }
    findings.read(keys, &path, Friction::check)
}
