//! Surfaces: how two bodies push and rub on each other.

use chaindrive_contact::{Elastic, Film, Friction, Law};

use crate::DriveError;

/// Contact of two surfaces: normal force, friction and film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// Normal force law.
    pub law: Law,
    /// Friction law.
    pub friction: Friction,
    /// Film of oil between the surfaces. What an impact leaves is a result then, so the law is to have no dissipation of its own.
    pub film: Option<Film>,
}

impl Surface {
    /// Names every parameter of its laws that is out of range.
    pub(crate) fn problems(&self, place: &str) -> Vec<DriveError> {
        let law = |source| DriveError::Law {
            path: format!("{place}.contact"),
            source,
        };
        let mut found = Vec::new();
        found.extend(self.law.check().map_err(law).err());
        found.extend(self.friction.check().map_err(law).err());
        if let Some(film) = self.film {
            found.extend(film.check().map_err(law).err());
        }
        found
    }
}

/// The flank of a tooth, where it does not answer like its seat.
///
/// ```text
/// g = (1 − s) g_seat(δ) + s g_flank(δ),   s: smooth step from 0 to 1 within ± w of the end of the hollow
/// ```
///
/// A roller in its seat has a counterpart little wider than itself; on the flank that bulges. The patch of
/// contact lies across the joint of the two while the roller passes it, so the law changes over an
/// arc and not at a point; w is about its half-width under load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flank {
    /// Elastic law beyond the hollow; dissipation and friction are those of the surface.
    pub elastic: Elastic,
    /// Half-width w of the passage \[m\], positive.
    pub width: f64,
}
