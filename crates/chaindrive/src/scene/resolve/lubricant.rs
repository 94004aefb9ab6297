//! The oil of a scene.

use chaindrive_contact::Lubricant;
use chaindrive_mechanics::OilSupply;

use super::Findings;
use super::cursor::Cursor;
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
    let mut at = findings.at("lubricant");
    let index = text.viscosity_index;
    let index = at
        .key("viscosity_index")
        .or(index, &defaults::VISCOSITY_INDEX);
    let density = at.key("density").or(text.density, &defaults::OIL_DENSITY);
    let lubricant = Lubricant {
        viscosity_index: index,
        density,
        viscosity_40: viscosity_40?,
        temperature: text.temperature.0,
    };
    at.sound(lubricant.check())?;
    Some(OilSupply {
        lubricant,
        used_by: Vec::new(),
    })
}

impl Findings<'_> {
    /// The oil, for a parameter at `path` that the scene leaves open; none where no oil is described.
    fn lubricant(&mut self, path: &str) -> Option<Lubricant> {
        let (place, _) = self.tree.locate(&self.of_chain(path));
        let oil = self.oil.as_mut()?;
        if !oil.used_by.contains(&place) {
            oil.used_by.push(place);
        }
        Some(oil.lubricant)
    }
}

impl Cursor<'_, '_> {
    /// A viscosity of the oil, for the parameter here; refused where no oil is described.
    pub(super) fn of_oil(&mut self, viscosity: fn(&Lubricant) -> f64) -> Option<f64> {
        let Some(lubricant) = self.findings.lubricant(&self.path) else {
            // A lubricant that is refused has its own message.
            if self.findings.tree.find("lubricant").is_none() {
                let hint = "give it, or a `lubricant` for the whole drive";
                self.refuse("missing", hint);
            }
            return None;
        };
        let viscosity = viscosity(&lubricant);
        self.assume(viscosity, "of the lubricant at its temperature");
        Some(viscosity)
    }
}
