//! Contacts: what a sprocket or guide says, completed by what holds for all.

use chaindrive_contact::dissipation::{
    Exact, Flores, Gonthier, HerbertMcWhannell, HuGuo, HuntCrossley, LankaraniNikravesh, LeeWang,
    Viscous, ZhiyingQishao,
};
use chaindrive_contact::{Dissipation, Elastic, Friction, Law};
use chaindrive_mechanics::Surface;
use serde::Deserialize;
use serde_json::json;

use super::Findings;
use super::law::{Pair, elastic};
use crate::scene::defaults::{self, Default};
use crate::scene::schema::{self, Contact};

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
    /// How it pushes and rubs; `absent` knows the elastic law where the scene names none.
    pub(super) fn surface(
        &self,
        pair: Pair,
        findings: &mut Findings<'_>,
        absent: impl FnOnce(&mut Findings<'_>) -> Option<Elastic>,
    ) -> Option<Surface> {
        let law = self.law(pair, findings, absent);
        let friction = self.friction(findings);
        Some(Surface {
            law: law?,
            friction: friction?,
        })
    }

    /// How it rubs.
    pub(super) fn friction(&self, findings: &mut Findings<'_>) -> Option<Friction> {
        let common = self.fallback.path;
        match (self.own.friction, self.common.friction) {
            (Some(text), _) => friction(text, self.path, None, findings),
            (None, Some(text)) => friction(text, common, None, findings),
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
        let given = self.own.series.or(self.common.series);
        given.map(|stiffness| stiffness.0)
    }

    fn dissipation(&self, findings: &mut Findings<'_>) -> Option<Dissipation> {
        use schema::Dissipation as Name;
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
            .or(common.dissipation.filter(|name| *name != Name::None));
        if name == Some(Name::None) && said.restitution.is_some() {
            twice("restitution", "dissipation = \"none\"");
            return None;
        }
        let name = findings.or_chosen(
            name,
            &format!("{place}.dissipation"),
            &defaults::DISSIPATION,
        );
        let restitution = match name {
            Name::None => 1.0,
            _ => findings.or_default(
                said.restitution.or(common.restitution).map(|e| e.0),
                &format!("{place}.restitution"),
                fallback.restitution,
            ),
        };
        let dissipation = match name {
            Name::None => Dissipation::None,
            Name::Exact => Dissipation::Exact(Exact { restitution }),
            Name::HuntCrossley => Dissipation::HuntCrossley(HuntCrossley { restitution }),
            Name::LankaraniNikravesh => {
                Dissipation::LankaraniNikravesh(LankaraniNikravesh { restitution })
            }
            Name::LeeWang => Dissipation::LeeWang(LeeWang { restitution }),
            Name::HerbertMcWhannell => {
                Dissipation::HerbertMcWhannell(HerbertMcWhannell { restitution })
            }
            Name::Gonthier => Dissipation::Gonthier(Gonthier { restitution }),
            Name::ZhiyingQishao => Dissipation::ZhiyingQishao(ZhiyingQishao { restitution }),
            Name::Flores => Dissipation::Flores(Flores { restitution }),
            Name::HuGuo => Dissipation::HuGuo(HuGuo { restitution }),
        };
        let sound = dissipation.check().map_err(|error| {
            let message = format!("{}, must be {}", error.value, error.allowed);
            findings.refuse_once(&format!("{place}.{}", error.parameter), message, "");
        });
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

/// The friction that a scene describes at `place`; a spring of unknown stiffness is that of `spring`.
pub(super) fn friction(
    text: schema::Friction,
    place: &str,
    spring: Option<Spring>,
    findings: &mut Findings<'_>,
) -> Option<Friction> {
    // Kinds and parameters are called the same in a scene and in the law, in SI units here: a law of its own needs nothing else.
    let mut parameters = json!(text);
    // What may stay open, whichever law has it.
    for (key, default) in [
        ("slip_speed", &defaults::SLIP_SPEED),
        ("transition_force", &defaults::TRANSITION_FORCE),
    ] {
        if let Some(value) = parameters.get_mut(key).filter(|value| value.is_null()) {
            let path = format!("{place}.friction.{key}");
            *value = findings.or_default(None, &path, default).into();
        }
    }
    if let Some(value) = parameters
        .get_mut("stiffness")
        .filter(|value| value.is_null())
    {
        let path = format!("{place}.friction.stiffness");
        let Some(spring) = spring else {
            let hint = "give it, such as \"50 MN/m\"; it is known in joints of links whose pins and stiffness are";
            findings.refuse_once(&path, "missing", hint);
            return None;
        };
        *value = findings
            .or_multiple(None, &path, spring.factor, spring.unit)
            .into();
    }
    let friction = Friction::deserialize(parameters)
        .map_err(|error| findings.refuse_once(&format!("{place}.friction"), error.to_string(), ""))
        .ok()?;
    let sound = friction.check().map_err(|error| {
        let path = format!("{place}.friction.{}", error.parameter);
        let message = format!("{}, must be {}", error.value, error.allowed);
        findings.refuse_once(&path, message, "");
    });
    sound.ok().map(|()| friction)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A law that scenes cannot write, or write otherwise, would fail here.
    #[test]
    fn scenes_know_every_friction() {
        for law in Friction::specimens() {
            let text = schema::Friction::deserialize(json!(law)).unwrap();
            assert_eq!(Friction::deserialize(json!(text)).unwrap(), law);
        }
    }
}
