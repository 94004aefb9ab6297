//! The oil of a scene.

use chaindrive_contact::Lubricant;
use chaindrive_mechanics::OilSupply;

use super::Findings;
use crate::scene::defaults;
use crate::scene::schema::SceneText;
use crate::scene::suggest::one_of;

/// The oil, before a part has asked for it.
pub(super) fn resolve(scene: &SceneText, findings: &mut Findings<'_>) -> Option<OilSupply> {
    let text = scene.lubricant.as_ref()?;
    let viscosity_40 = match (&text.grade, text.viscosity_40) {
        (Some(_), Some(_)) => {
            let hint = "keep one of them: a grade is a viscosity at 40 °C";
            findings.refuse_with("lubricant.viscosity_40", "`grade` is given too", hint);
            None
        }
        (None, Some(viscosity)) => Some(viscosity.0),
        (Some(name), None) => {
            let found = Lubricant::grade(name);
            if found.is_none() {
                let known: Vec<&str> = Lubricant::grades().collect();
                let message = format!("no grade is called `{name}`");
                findings.refuse_with("lubricant.grade", message, one_of(name, &known));
            }
            found
        }
        (None, None) => {
            let hint = "give a `grade` such as \"VG 150\", or `viscosity_40`";
            findings.refuse_with("lubricant.grade", "missing", hint);
            None
        }
    };
    let mut or_default = |given: Option<f64>, key: &str, default| {
        findings.or_default(given, &format!("lubricant.{key}"), default)
    };
    let index = text.viscosity_index.map(|it| it.0);
    let density = text.density.map(|it| it.0);
    let lubricant = Lubricant {
        viscosity_index: or_default(index, "viscosity_index", &defaults::VISCOSITY_INDEX),
        density: or_default(density, "density", &defaults::OIL_DENSITY),
        viscosity_40: viscosity_40?,
        temperature: text.temperature.0,
    };
    if let Err(error) = lubricant.check() {
        findings.refuse_parameter("lubricant", &error);
        return None;
    }
    Some(OilSupply {
        lubricant,
        used_by: Vec::new(),
    })
}

impl Findings<'_> {
    /// The oil, for a parameter at `path` that the scene leaves open; none where no oil is described.
    pub(super) fn lubricant(&mut self, path: &str) -> Option<Lubricant> {
        let (place, _) = self.tree.locate(&self.at(path));
        let oil = self.oil.as_mut()?;
        if !oil.used_by.contains(&place) {
            oil.used_by.push(place);
        }
        Some(oil.lubricant)
    }

    /// Kinematic viscosity of the oil \[m²/s\], for a parameter at `path`; refused where no oil is described.
    pub(super) fn oil_viscosity(&mut self, path: &str) -> Option<f64> {
        self.of_oil(path, Lubricant::kinematic_viscosity)
    }

    /// Its dynamic viscosity \[Pa s\].
    pub(super) fn oil_dynamic_viscosity(&mut self, path: &str) -> Option<f64> {
        self.of_oil(path, Lubricant::dynamic_viscosity)
    }

    fn of_oil(&mut self, path: &str, viscosity: fn(&Lubricant) -> f64) -> Option<f64> {
        let Some(lubricant) = self.lubricant(path) else {
            // A lubricant that is refused has its own message.
            if self.tree.find("lubricant").is_none() {
                let hint = "give it, or a `lubricant` for the whole drive";
                self.refuse_with(path, "missing", hint);
            }
            return None;
        };
        let viscosity = viscosity(&lubricant);
        self.assume(path, viscosity, "of the lubricant at its temperature");
        Some(viscosity)
    }
}
