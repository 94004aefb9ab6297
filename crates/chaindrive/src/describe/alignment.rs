//! Spans whose sprockets are not in one plane.

use std::fmt;

use chaindrive_mechanics::Parts;
use schemars::JsonSchema;
use serde::Serialize;

use crate::chain_verdict::{ALIGNED, ALIGNED_FAST};

/// A span out of line.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct AlignmentFacts {
    /// Its name.
    pub span: String,
    /// Distance of the planes of its sprockets \[m\].
    pub offset: f64,
    /// Its length \[m\].
    pub length: f64,
    /// Offset over the distance of the shafts \[–\], which makers limit.
    pub of_centres: f64,
}

impl fmt::Display for AlignmentFacts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "span {}: {:.2} mm out of line on {:.1} mm, {:.2} % of the centre distance (makers allow {} %, {} % in fast drives)",
            self.span,
            self.offset * 1e3,
            self.length * 1e3,
            self.of_centres * 100.0,
            ALIGNED * 100.0,
            ALIGNED_FAST * 100.0
        )
    }
}

/// The spans that are out of line.
pub(super) fn of(parts: &Parts) -> Vec<AlignmentFacts> {
    let spans = parts.out_of_line().into_iter();
    let facts = spans.map(|it| AlignmentFacts {
        of_centres: it.offset / it.centres,
        span: it.span,
        offset: it.offset,
        length: it.length,
    });
    facts.collect()
}
