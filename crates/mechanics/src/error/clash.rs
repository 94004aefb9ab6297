//! Bodies in each other's way, and chains where no guide holds them, in words.

use chaindrive_geometry::Point;

/// Two parts of a drive that take the same room, or that part where one should carry the other.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[expect(
    missing_docs,
    reason = "each message names its fields; depth and place are in metres"
)]
pub enum Clash {
    /// The teeth of two sprockets sweep through each other.
    #[error("sprockets `{first}` and `{second}` overlap by {}; move the centres apart", told(*.depth, .at))]
    Sprockets {
        first: String,
        second: String,
        depth: f64,
        at: Point,
    },

    /// The teeth of a sprocket sweep over the face of a guide.
    #[error(
        "guide `{guide}` cuts into the teeth of `{sprocket}` by {}; {}", told(*.depth, .at),
        if *.beside { "it must pass beside them, or be moved back or shortened" } else { "move it back, shorten its face, or give its ends a smaller radius" }
    )]
    Teeth {
        guide: String,
        sprocket: String,
        depth: f64,
        at: Point,
        /// Whether the guide carries link plates, and so may lie beside the teeth.
        beside: bool,
    },

    /// The faces of two guides that move against each other cross.
    #[error(
        "guides `{first}` and `{second}` cut into each other by {}; move them apart, shorten one, or let the same support hold both",
        told(*.depth, .at)
    )]
    Guides {
        first: String,
        second: String,
        depth: f64,
        at: Point,
    },

    /// A chain lies behind the face of a guide that should carry it.
    #[error(
        "{chain} runs {} deep through guide `{guide}`, and a contact carries what is no deeper than {:.1} mm; move the guide back, or make it a stop of the route",
        told(*.depth, .at), .carries * 1e3
    )]
    Chain {
        chain: String,
        guide: String,
        depth: f64,
        carries: f64,
        at: Point,
    },

    /// The face of a guide on the route ends before the chain has turned as far as it is led.
    #[error(
        "{chain} bends over the end of guide `{guide}` where it runs {}: it turns by {:.1}° there, and the face ends {:.1}° too early, at ({:.1}, {:.1}) mm; make the face {:.1} mm longer, or let the guide press less on the chain",
        if *.off { "off" } else { "on" }, .wrap.to_degrees(), .short.to_degrees(), .at.x * 1e3, .at.y * 1e3, .missing * 1e3
    )]
    Overrun {
        chain: String,
        guide: String,
        /// Angle \[rad\] by which the taut chain turns over the guide.
        wrap: f64,
        /// Angle \[rad\] of it for which there is no face.
        short: f64,
        /// The same along the face.
        missing: f64,
        /// Whether the face ends where the chain runs off, and not where it runs on.
        off: bool,
        at: Point,
    },
}

impl Clash {
    /// Whether a drive can run so all the same: rails that carry link plates can leave room for teeth between them, and a chain bends
    /// over the edge of a face, if not for long.
    pub fn may_pass(&self) -> bool {
        matches!(
            self,
            Self::Teeth { beside: true, .. } | Self::Overrun { .. }
        )
    }

    /// Where the two take the same room, or the face ends \[m\].
    pub fn place(&self) -> Point {
        match self {
            Self::Sprockets { at, .. }
            | Self::Teeth { at, .. }
            | Self::Guides { at, .. }
            | Self::Chain { at, .. }
            | Self::Overrun { at, .. } => *at,
        }
    }

    /// How deep they overlap, or how much of the face is missing \[m\].
    pub fn depth(&self) -> f64 {
        match self {
            Self::Sprockets { depth, .. }
            | Self::Teeth { depth, .. }
            | Self::Guides { depth, .. }
            | Self::Chain { depth, .. } => *depth,
            Self::Overrun { missing, .. } => *missing,
        }
    }
}

/// Depth and place, as messages tell them.
fn told(depth: f64, at: &Point) -> String {
    format!(
        "{:.1} mm at ({:.1}, {:.1}) mm",
        depth * 1e3,
        at.x * 1e3,
        at.y * 1e3
    )
}
