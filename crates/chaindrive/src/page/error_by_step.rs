//! Errors by the step: how far a sharper run is off the run of the page.

use crate::figure::{duration, percent, with_digits};
use crate::precision::{Estimate, ImpactErrors, Judgement, Strands};

/// Errors of the statistics of tensions.
pub(super) fn of_tensions(judgement: Option<&Judgement>) -> String {
    let Some(estimate) = judgement.and_then(Judgement::estimate) else {
        return "Errors by the step are not estimated. Run it without --no-error, to its end."
            .to_owned();
    };
    if estimate.tension.is_nan() {
        return "Errors by the step are not estimated: the chain carries no tension.".to_owned();
    }
    let of = match estimate.strands {
        Strands::Spans => "",
        Strands::Links => " of link tensions",
    };
    let [deviation, low, high] = estimate.scatter;
    let all = [estimate.mean, deviation, low, high];
    let [mean, std, p1, p99] = all.map(|it| percent(it.difference));
    let by_chance = all.iter().filter(|it| it.within_spread());
    let by_chance = by_chance.map(|it| it.spread).fold(0.0, f64::max);
    let chance = if by_chance > 0.0 {
        format!(" Chance alone moves them by up to {}.", percent(by_chance))
    } else {
        String::new()
    };
    let shadow = estimate.shadow;
    let shadow = shadow[..1].to_uppercase() + &shadow[1..];
    format!(
        "{shadow} moves means{of} by {mean}, std by {std}, p1 by {p1} and p99 by {p99} of the mean tension, over the first {}.{chance}",
        duration(estimate.window)
    )
}

/// Errors of the impacts on a sprocket.
pub(super) fn of_impacts<'a>(estimate: &'a Estimate, sprocket: &str) -> Option<&'a ImpactErrors> {
    estimate.impacts.iter().find(|it| it.sprocket == sprocket)
}

/// An error in per cent, without the sign.
pub(super) fn cell(error: Option<f64>) -> String {
    let known = error.filter(|it| it.is_finite());
    known.map_or_else(|| "unknown".to_owned(), |it| with_digits(100.0 * it, 2))
}

/// Errors of impulses and closing speeds, the largest of all sprockets.
pub(super) fn of_impulses(estimate: &Estimate) -> Option<String> {
    let largest = |of: fn(&ImpactErrors) -> f64| {
        let known = estimate.impacts.iter().map(of);
        known.filter(|it| it.is_finite()).reduce(f64::max)
    };
    let (impulse, speed) = (largest(|it| it.impulse)?, largest(|it| it.speed)?);
    Some(format!(
        "By {}, impulses are off by up to {}, closing speeds by up to {}.",
        estimate.shadow,
        percent(impulse),
        percent(speed)
    ))
}
