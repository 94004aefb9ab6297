//! Strength of the chains under the loads of a run.

use chaindrive_mechanics::{Chain, Drive, MissingRating};

use super::{Check, Limit};
use crate::rating::Rating;

/// Newtons a square millimetre in a pascal.
const PER_PASCAL: f64 = 1e-6;

/// Distance of the planes of two sprockets over that of their shafts that makers allow, and in fast drives: SEDIS, *Transmission chains*,
/// 0.2 % and 0.1 %. Which drive is fast they do not say.
pub(crate) const ALIGNED: f64 = 2e-3;
pub(crate) const ALIGNED_FAST: f64 = 1e-3;

/// Checks of the strength of every chain, in the order of the drive.
pub(super) fn strength_checks(ratings: &[Rating], drive: &Drive) -> Vec<Check> {
    let chains = ratings.iter().zip(&drive.chains);
    let mut checks: Vec<Check> = chains
        .flat_map(|(it, placed)| of_chain(it, &placed.chain))
        .collect();
    checks.extend(out_of_line(drive));
    checks
}

fn of_chain(rating: &Rating, chain: &Chain) -> Vec<Check> {
    let of = rating.chain.as_str();
    let known = |limit: Limit, value: Option<f64>, why: &str| match value {
        Some(value) => Check::of(limit, of, value),
        None => Check::not_judged(limit, of, why),
    };
    let no_load = "no breaking load is known: give chain.breaking_load";
    let pressure = rating.bearing_pressure.map(|it| PER_PASCAL * it);
    let mut checks = vec![
        known(Limit::StaticSafety, rating.static_safety, no_load),
        known(Limit::DynamicSafety, rating.dynamic_safety, no_load),
        known(
            Limit::BearingPressure,
            pressure,
            "pin and bush are not known: give chain.type, or chain.joint.length of clearance joints",
        ),
        worn(rating, chain, of),
    ];
    if rating.sprocket.is_some() {
        checks.push(power(rating, of));
        checks.push(Check::not_judged(Limit::Speed, of, Limit::Speed.source()));
    }
    checks
}

/// Power against the rating of the chain itself, or of its twin.
fn power(rating: &Rating, of: &str) -> Check {
    if let Some(share) = rating.utilisation() {
        let by = rating.governing().map_or("", |(by, _)| by.name());
        return Check::of(Limit::RatedPower, of, 100.0 * share).with(by);
    }
    let why = match &rating.limits {
        Err(why) => why.to_string(),
        Ok(_) => "nothing turns".to_owned(),
    };
    match (rating.twin, &rating.limits) {
        (Some(twin), Err(MissingRating::SourceMissing { .. })) => {
            let share = rating.service_factor * rating.carried / twin;
            Check::of(Limit::TwinPower, of, 100.0 * share)
        }
        _ => Check::not_judged(Limit::RatedPower, of, &why),
    }
}

/// Elongation of the chain as it is against what its use allows.
fn worn(rating: &Rating, chain: &Chain, of: &str) -> Check {
    let Some(limit) = rating.wear_limit else {
        return Check::not_judged(Limit::Wear, of, "the chain passes no sprocket");
    };
    let elongation = elongation(chain);
    // What rounding makes of a new chain is no wear.
    let elongation = if elongation > 1e-9 { elongation } else { 0.0 };
    let note = format!("{:.2} % of {limit}", 100.0 * elongation);
    Check::of(Limit::Wear, of, 100.0 * elongation / limit.elongation).with(&note)
}

/// Mean length of the links over the pitch, less one.
fn elongation(chain: &Chain) -> f64 {
    let mean = chain.lengths.iter().sum::<f64>() / chain.lengths.len() as f64;
    mean / chain.pitch - 1.0
}

/// The span that is most out of line, where planes are known.
fn out_of_line(drive: &Drive) -> Option<Check> {
    let spans = drive.out_of_line().into_iter();
    let spans = spans.map(|it| (it.offset / it.centres, it));
    let (share, worst) = spans.max_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(Check::of(Limit::OutOfLine, &worst.span, 100.0 * share))
}
