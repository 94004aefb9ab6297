//! Bodies that a tensioner carries, for its drawing.

use crate::carriers::CarriedBodies;
use crate::drive::{GuideSupport, Parts, Support};

/// Sprockets and guides of a tensioner where they were laid.
pub(super) fn by(parts: &Parts, tensioner: usize) -> CarriedBodies<'_> {
    let sprockets = parts.sprockets.iter();
    let guides = parts.guides.iter();
    CarriedBodies {
        sprockets: sprockets
            .filter(|it| it.support == Support::Tensioner(tensioner))
            .map(|it| (it.centre, it.gap.tip_radius))
            .collect(),
        faces: guides
            .filter(|it| it.support == GuideSupport::Tensioner(tensioner))
            .map(|it| &it.face)
            .collect(),
    }
}
