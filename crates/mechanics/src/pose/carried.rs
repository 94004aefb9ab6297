//! What a tensioner carries, as its drawing wants it.

use crate::carriers::Carried;
use crate::drive::{GuideSupport, Parts, Support};

/// Sprockets and guides of a tensioner where they were laid.
pub(super) fn by(parts: &Parts, tensioner: usize) -> Carried<'_> {
    let sprockets = parts.sprockets.iter();
    let guides = parts.guides.iter();
    Carried {
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
