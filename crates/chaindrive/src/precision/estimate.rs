//! The numerical error of a run, by shadow runs with half and with a quarter of the step.

use chaindrive_mechanics::Assembled;

use super::Watch;
use super::choice::Promise;
use super::compare::{Comparison, Distance, Pair, rms};
use super::horizon::{Divergence, Horizon, LIMIT};
use super::impacts::ImpactErrors;
use super::short_runs::{ShortRunStart, ShortRuns};
use super::trace::{Gap, Strands, Trace};
use super::window::{Window, pinned, sharper};
use crate::{Channel, Run, SimulationError};

/// Estimate of the numerical error of a run.
///
/// ```text
/// run      the beginning of the run, over the window
/// twin     the same, started 1e-12 m apart                         → chaos horizon, spread of the statistics
/// shadow   half the step, over half of the longest window          → difference d
/// second   a quarter of the step, over a quarter of it             → difference d₂ from the shadow, factor c
///
/// e = max(c d, d + d₂), where there is a d₂, and c d behind it
/// ```
///
/// Where a method shows its order p, c = 1/(1 − 2⁻ᵖ); contacts that open and close take the order away, and c is what
/// the two shadows say of their first samples. At moments where chance brings a run near to its first shadow, as
/// when a roller lets go in the second one only, the distances along the way say more. A difference of statistics that does not exceed the spread of equal
/// runs says only that the error is no larger than that.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// Time over which run and shadow were compared \[s\]: beyond, nothing was examined.
    pub window: f64,
    /// Time in which a tooth passes \[s\]; none without a chain that runs over sprockets.
    pub period: Option<f64>,
    /// The setting by which the shadow is better than the run.
    pub shadow: &'static str,
    /// The tensions that were compared.
    pub strands: Strands,
    /// Why links were compared and not spans, if a span had no tension for some time.
    pub gap: Option<Gap>,
    /// Error over the difference from the shadow \[–\].
    pub factor: f64,
    /// Error of the tensions within window and horizon, root mean square over strands and time, over the mean
    /// tension \[–\].
    pub tension: f64,
    /// The same of the tightest strand alone.
    pub tight_tension: f64,
    /// Mean tension, that of the strand that differs most.
    pub mean: Comparison,
    /// Root mean square of the tension, that of the strand that differs most.
    pub rms: Comparison,
    /// Standard deviation, 1st and 99th percentile of the tension, over the mean tension, those of the strand that differs most.
    pub scatter: [Comparison; 3],
    /// 50th, 90th and 99th percentile of the contact forces.
    pub force: [Comparison; 3],
    /// Impacts of rollers, by sprocket; none where no roller came to one.
    pub impacts: Vec<ImpactErrors>,
    /// Time for which two almost equal runs stay together.
    pub horizon: Horizon,
    /// Time from which on the waveform of the tensions compared differs from the exact one by 1 % \[s\]: when the
    /// error does, root mean square over the last tooth that passed, or the chaos horizon, whichever comes first.
    pub waveform: Option<f64>,
    /// The same of the tensions of the links, root mean square over all of them.
    pub link_waveform: Option<f64>,
    /// Evaluations of the accelerations that the estimate took.
    pub evaluations: u64,
    /// End of the run \[s\].
    pub until: f64,
}

/// When the waveform of a channel ceases to mean anything.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChannelHorizon {
    /// Time \[s\].
    pub at: f64,
    /// The channel on whose errors it was found.
    pub found_on: Channel,
}

/// Share of the longest window over which the first shadow is followed.
const SHADOWS: f64 = 0.5;
/// Share over which the second is followed, which costs as much as all others, and tells the factor: farther on, chaos would.
const EARLY: f64 = 0.25;

/// The largest factor: three runs that hardly come closer to each other say no more than that.
const LARGEST: f64 = 3.0;

/// Estimates the error of a run from its beginning.
///
/// Costs some 10 000 evaluations for most runs with the step of a choice, and the more the shorter the step, whatever the
/// length of the run: see [`Window`].
///
/// # Errors
/// [`SimulationError`] when one of the short runs fails, [`SimulationError::Interrupted`] when `watch`
/// says so.
pub fn estimate(
    start: &Assembled,
    run: &Run,
    watch: Watch<'_>,
) -> Result<Estimate, SimulationError> {
    estimate_with(&mut ShortRuns::default(), start, run, watch)
}

/// The same, going on with short runs from the same start.
pub(crate) fn estimate_with(
    short_runs: &mut ShortRuns,
    start: &Assembled,
    run: &Run,
    watch: Watch<'_>,
) -> Result<Estimate, SimulationError> {
    let before = short_runs.evaluations();
    let run = pinned(start, run);
    let window = Window::of(start, &run).finely(start, &run);
    let (better, shadow_words) = sharper(start, &run);
    let (best, _) = sharper(start, &better);
    let mut take =
        |from, run: &Run, share| short_runs.take(start, from, run, &window.first(share), watch);
    let places = [
        take(ShortRunStart::Start, &run, 1.0)?,
        take(ShortRunStart::Apart, &run, 1.0)?,
        take(ShortRunStart::Start, &better, SHADOWS)?,
        take(ShortRunStart::Start, &best, EARLY)?,
    ];
    let traces = places.map(|place| short_runs.trace(place));
    let [base, twin, shadow, second] = traces;
    let strands = Strands::of(traces);
    let expected = expected_ratio(start, &run);
    let of_order = 1.0 / (1.0 - 1.0 / expected);
    let found = |strands: Strands| {
        let early = window.first(EARLY).samples();
        let factor = factor([base, shadow, second], strands, early, expected);
        let near = Pair::of(shadow, base, strands).distances().into_iter();
        // Of one scale, though the tension may rise after the last sample of the second.
        let scale = base.tensions(strands).mean_of_first(shadow.len());
        let further = Pair::of(second, shadow, strands)
            .distances_over(scale)
            .into_iter();
        let beyond = std::iter::repeat(Distance::default());
        let errors: Vec<[f64; 2]> = near
            .zip(further.chain(beyond))
            .map(|(near, further)| {
                let [near, further] = [near, further].map(|it| [it.all, it.tight]);
                [0, 1].map(|k| (factor * near[k]).max(near[k] + further[k]))
            })
            .collect();
        let horizon = Horizon::of(base, twin, strands);
        let all: Vec<f64> = errors.iter().map(|[all, _]| *all).collect();
        let over = window
            .period
            .map_or(1, |period| window.samples_of(period).max(1));
        let waveform = waveform(&base.time, &moving(&all, over), &horizon);
        (factor, errors, horizon, waveform)
    };
    let (factor, errors, horizon, waveform) = found(strands);
    let link_waveform = match strands {
        Strands::Links => waveform,
        Strands::Spans => found(Strands::Links).3,
    };

    let within = horizon.all.time().unwrap_or(f64::INFINITY);
    let inside = || {
        let pairs = errors.iter().zip(&base.time);
        pairs.filter(|(_, time)| **time <= within).map(|(e, _)| e)
    };
    let [by_step, by_chance] =
        [shadow, twin].map(|other| Pair::of(other, base, strands).first(shadow.len()));
    let [mean, rms_of_tension] = compared(by_step.moments(), by_chance.moments());
    Ok(Estimate {
        window: shadow.time.last().copied().unwrap_or(0.0),
        period: window.period,
        shadow: shadow_words,
        strands,
        gap: traces.iter().find_map(|trace| trace.gap.clone()),
        factor,
        tension: rms(inside().map(|[all, _]| *all)),
        tight_tension: rms(inside().map(|[_, tight]| *tight)),
        mean,
        rms: rms_of_tension,
        scatter: compared(by_step.scatter(), by_chance.scatter()),
        force: compared(by_step.percentiles(), by_chance.percentiles()),
        impacts: ImpactErrors::of(base, shadow, &start.system.sprocket_names(), of_order),
        horizon,
        waveform,
        link_waveform,
        evaluations: short_runs.evaluations() - before,
        until: run.until,
    })
}

impl Estimate {
    /// Error \[–\] of the promise of a choice, beyond chance; none for losses, which are not estimated.
    pub fn of(&self, promise: Promise) -> Option<f64> {
        match promise {
            Promise::Waveform => Some(self.tight_tension),
            Promise::Statistics => Some(self.statistics()),
            Promise::Impacts => ImpactErrors::largest_of(&self.impacts),
            Promise::Losses | Promise::Nothing => None,
        }
    }

    /// Error \[–\] of means and root mean squares of the tensions, beyond chance.
    pub fn statistics(&self) -> f64 {
        let beyond = |it: &Comparison| (it.difference - it.spread).max(0.0);
        beyond(&self.mean).max(beyond(&self.rms))
    }

    /// End of the meaning of the waveforms compared \[s\], if it is within the run.
    pub fn waveform_ends_within(&self) -> Option<f64> {
        self.waveform.filter(|time| *time < self.until)
    }

    /// A comparison with the shadow up to the end of the run.
    pub fn examined_throughout(&self) -> bool {
        // Samples are counted, their times multiplied.
        self.window >= self.until * (1.0 - 1e-9)
    }

    /// The channel whose tensions were compared.
    pub fn compared_channel(&self) -> Channel {
        match self.strands {
            Strands::Spans => Channel::SpanTension,
            Strands::Links => Channel::LinkTension,
        }
    }

    /// When the waveform of a channel ceases to mean anything, if that is within the run.
    ///
    /// Span tensions have the horizon that was found on them. All other channels have that of the link tensions, the
    /// worst that is examined: forces of single contacts may err sooner.
    pub fn horizon_of(&self, channel: Channel) -> Option<ChannelHorizon> {
        let (at, found_on) = if channel == Channel::SpanTension {
            (self.waveform, self.compared_channel())
        } else {
            (self.link_waveform, Channel::LinkTension)
        };
        let at = at.filter(|at| *at < self.until)?;
        Some(ChannelHorizon { at, found_on })
    }
}

/// Differences of statistics beside those of equal runs.
fn compared<const N: usize>(difference: [f64; N], spread: [f64; N]) -> [Comparison; N] {
    std::array::from_fn(|k| Comparison {
        difference: difference[k],
        spread: spread[k],
    })
}

/// Ratio of the differences of three runs, each sharper than the one before, where the method shows its order.
///
/// ```text
/// |u(h) − u(h/2)| / |u(h/2) − u(h/4)| = 2ᵖ;   10 for tenths of a tolerance
/// ```
fn expected_ratio(start: &Assembled, run: &Run) -> f64 {
    let method = run.method(&start.system);
    if method.is_adaptive() {
        10.0
    } else {
        f64::from(2_u32.pow(method.order()))
    }
}

/// Root mean square of every value and those before it, `over` of them where there are as many.
///
/// ```text
/// ē(t) = √(1/p ∫ e² dt) over the last tooth, from t − p to t
/// ```
fn moving(values: &[f64], over: usize) -> Vec<f64> {
    let last = 1..=values.len();
    let window = |last: usize| &values[last.saturating_sub(over)..last];
    last.map(|last| rms(window(last).iter().copied())).collect()
}

/// When the error becomes 1 %, or the twins part.
fn waveform(time: &[f64], errors: &[f64], horizon: &Horizon) -> Option<f64> {
    let measured = errors.iter().position(|d| *d >= LIMIT);
    let of_error = match (measured, horizon.all) {
        (Some(first), _) => Some(time[first]),
        // E grows as the distance of twins does: E = E_end exp((t − t_end)/t_L)
        (None, Divergence::Extrapolated { lyapunov, .. }) => {
            let late = &errors[errors.len() / 2..];
            let last = late.iter().copied().fold(0.0, f64::max);
            let end = time[errors.len() - 1];
            (last > 0.0).then(|| end + lyapunov * (LIMIT / last).ln())
        }
        (None, _) => None,
    };
    match (of_error, horizon.all.time()) {
        (Some(a), Some(b)) => Some(a.min(b)),
        (a, b) => a.or(b),
    }
}

/// Error of a run over its difference from a sharper one, by a third that is sharper still.
///
/// ```text
/// r = |u₁ − u₂| / |u₂ − u₃|,   e₁ = |u₁ − u| = |u₁ − u₂| (1 + 1/r + 1/r² + …) = |u₁ − u₂| / (1 − 1/r)
/// ```
///
/// r is that of the first samples, and `expected` where the method shows its order. It is hardly ever larger, and never believed to be: differences
/// of different sign can cancel.
fn factor(
    [first, second, third]: [&Trace; 3],
    strands: Strands,
    samples: usize,
    expected: f64,
) -> f64 {
    let apart = |of, from| Pair::of(of, from, strands).first(samples).tension();
    let ratio = apart(second, first) / apart(third, second);
    extrapolated(ratio, expected)
}

/// 1/(1 − 1/r) with r between what the order promises and what is too close to 1 to be extrapolated.
fn extrapolated(ratio: f64, expected: f64) -> f64 {
    let least = LARGEST / (LARGEST - 1.0);
    if ratio.is_nan() {
        // Nothing moves, or nothing is a number: no error to be multiplied.
        return 1.0 / (1.0 - 1.0 / expected);
    }
    1.0 / (1.0 - 1.0 / ratio.min(expected).max(least))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: f64, b: f64) -> bool {
        (a - b).abs() < 1e-12
    }

    #[test]
    fn the_factor_is_that_of_the_order_seen() {
        assert!(close(extrapolated(4.0, 4.0), 4.0 / 3.0));
        assert!(close(extrapolated(2.0, 4.0), 2.0));
        assert!(close(extrapolated(9.0, 4.0), 4.0 / 3.0), "cancelled");
        assert!(close(extrapolated(0.5, 4.0), LARGEST), "not converging");
        assert!(close(extrapolated(f64::NAN, 2.0), 2.0));
    }
}
