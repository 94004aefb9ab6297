//! Outcome of an attempt to make a candidate.

/// Outcome of an attempt to make a candidate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// A candidate to judge.
    Done,
    /// Infinity or NaN.
    NotFinite,
    /// The equations of the step were not solved.
    NoSolution,
}

impl Outcome {
    /// A candidate, if it is finite.
    pub(crate) fn of(finite: bool) -> Self {
        if finite { Self::Done } else { Self::NotFinite }
    }
}
