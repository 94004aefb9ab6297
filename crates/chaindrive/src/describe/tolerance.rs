//! Sprockets that are not as drawn.

use std::fmt;

use chaindrive_mechanics::Parts;
use schemars::JsonSchema;
use serde::Serialize;

/// Errors of a sprocket.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct ToleranceFacts {
    /// Its name.
    pub sprocket: String,
    /// Run-out as a dial shows it, twice the eccentricity \[m\].
    pub run_out: f64,
    /// Greatest distance of a gap from its place \[m\].
    pub gap_error: f64,
}

impl fmt::Display for ToleranceFacts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [run_out, gap_error] = [self.run_out, self.gap_error].map(|it| it * 1e6);
        write!(
            f,
            "{}: run-out {run_out:.1} µm, gaps out of place by up to {gap_error:.1} µm",
            self.sprocket
        )
    }
}

/// The sprockets that have errors.
pub(super) fn of(parts: &Parts) -> Vec<ToleranceFacts> {
    let unlike = parts.sprockets.iter().filter(|it| !it.tolerance.is_none());
    let facts = unlike.map(|sprocket| {
        let displacements = sprocket.tolerance.gap_displacements.iter();
        ToleranceFacts {
            sprocket: sprocket.name.clone(),
            run_out: 2.0 * sprocket.tolerance.eccentricity,
            gap_error: displacements.fold(0.0, |most, it| most.max(it.abs())),
        }
    });
    facts.collect()
}
