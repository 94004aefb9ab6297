//! Losses of shafts.

use chaindrive_contact::Lubricant;
use chaindrive_mechanics::{Bearing, Series, ShaftDrag, ShaftLoss};
use chaindrive_quantities::check;

use super::cursor::Cursor;
use crate::scene::schema::Written;
use crate::scene::suggest::one_of;

/// The losses of a shaft or sprocket.
pub(super) fn resolve(
    bearing: Option<&Written<Bearing>>,
    drag: Option<&Written<ShaftDrag>>,
    mut at: Cursor<'_, '_>,
) -> Option<ShaftLoss> {
    let bearing = bearing.map(|text| of_bearing(text, at.key("bearing")));
    let drag = drag.map(|text| {
        let mut at = at.key("drag");
        let keys = at.completed(text);
        at.read(keys, check::<ShaftDrag>)
    });
    Some(ShaftLoss {
        bearing: bearing.map_or(Some(None), |it| it.map(Some))?,
        drag: drag.map_or(Some(None), |it| it.map(Some))?,
    })
}

fn of_bearing(text: &Written<Bearing>, mut at: Cursor<'_, '_>) -> Option<Bearing> {
    let mut keys = at.completed(text);
    if text.word("kind") == "skf" {
        let name = text.word("series");
        let series = Series::named(name);
        if series.is_none() {
            let message = format!("no deep-groove series is called `{name}`");
            at.key("series")
                .refuse(message, one_of(name, &Series::names()));
        }
        if keys.get("feed").is_none() {
            at.key("feed").assume("bath", "not given");
        }
        at.fill_viscosity(&mut keys, Lubricant::kinematic_viscosity)?;
        series?;
    }
    at.read(keys, Bearing::check)
}
