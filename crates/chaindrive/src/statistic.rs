//! Statistics: the numbers that sum up a run, each a line of one table with its name, unit, reader and description.

use chaindrive_mechanics::Extremes;

use crate::precision::{Choice, Promise};
use crate::summary::{ContactStatistics, ImpactStatistics, SprocketStatistics, Steadiness};
use crate::{Simulation, Summary};

/// Dimension of statistics by span.
pub(crate) const SPAN: &str = "span";

/// Dimension of statistics by sprocket.
pub(crate) const SPROCKET: &str = "sprocket";

/// Dimension of statistics by kind of contact, see [`EventTable::KINDS`](crate::event::EventTable::KINDS).
pub(crate) const KIND: &str = "contact_kind";

/// How a statistic is read, and so what it has an entry of.
enum Reader {
    /// A number of the run.
    Run(fn(&Simulation, &Summary) -> f64),
    /// A number of the choice of method and step.
    Choice(fn(&Simulation, &Choice) -> f64),
    /// One a span, of all steps.
    SpanSteps(fn(&Extremes) -> f64),
    /// One a span whose tension is known.
    Known(fn(&Steadiness) -> f64),
    /// One a sprocket, of the impacts on it.
    Sprocket(fn(&ImpactStatistics) -> f64),
    /// One a sprocket.
    Body(fn(&SprocketStatistics) -> f64),
    /// One a kind of contact that is logged.
    Kind(fn(&ContactStatistics) -> f64),
}

macro_rules! statistics {
    ($($variant:ident, $name:literal, $unit:literal, $axis:ident($read:expr), $text:literal;)*) => {
        /// A number, or a number a span, sprocket or kind of contact, that sums up a run.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Statistic {
            $(#[doc = $text] $variant,)*
        }

        impl Statistic {
            /// All statistics.
            pub const ALL: &'static [Self] = &[$(Self::$variant),*];

            /// Name in results.
            pub fn name(self) -> &'static str {
                match self { $(Self::$variant => $name),* }
            }

            /// SI unit.
            pub fn unit(self) -> &'static str {
                match self { $(Self::$variant => $unit),* }
            }

            /// One line of description.
            pub fn description(self) -> &'static str {
                match self { $(Self::$variant => $text),* }
            }

            fn reader(self) -> Reader {
                match self { $(Self::$variant => Reader::$axis($read)),* }
            }
        }
    };
}

statistics! {
    SpanTensionMean, "span_tension_mean", "N", Known(|it| it.mean.value), "mean of the span tension over whole periods of the slowest forcing";
    SpanTensionHalfWidth, "span_tension_half_width", "N", Known(|it| it.mean.half_width), "half width of the 95 % interval of the mean; NaN below three periods";
    SpanTensionStd, "span_tension_std", "N", Known(|it| it.deviation.value), "standard deviation of the span tension";
    SpanTensionStdHalfWidth, "span_tension_std_half_width", "N", Known(|it| it.deviation.half_width), "half width of the 95 % interval of the standard deviation; NaN below three periods";
    SpanTensionP1, "span_tension_p1", "N", Known(|it| it.p1.value), "tension that the span has less of in 1 % of the time";
    SpanTensionP1HalfWidth, "span_tension_p1_half_width", "N", Known(|it| it.p1.half_width), "half width of its 95 % interval; NaN below three periods, and where they are too few to tell it";
    SpanTensionP99, "span_tension_p99", "N", Known(|it| it.p99.value), "tension that the span has less of in 99 % of the time";
    SpanTensionP99HalfWidth, "span_tension_p99_half_width", "N", Known(|it| it.p99.half_width), "half width of its 95 % interval; NaN below three periods, and where they are too few to tell it";
    SpanTensionMin, "span_tension_min", "N", SpanSteps(|it| it.least), "least tension of the span over all steps";
    SpanTensionMax, "span_tension_max", "N", SpanSteps(|it| it.greatest), "greatest tension of the span over all steps";
    ContactForceP50, "contact_force_p50", "N", Run(|_, it| it.forces().p50), "median of the forces of loaded rollers on teeth";
    ContactForceP90, "contact_force_p90", "N", Run(|_, it| it.forces().p90), "90th percentile of the forces of loaded rollers on teeth";
    ContactForceP99, "contact_force_p99", "N", Run(|_, it| it.forces().p99), "99th percentile of the forces of loaded rollers on teeth";
    ContactForceMax, "contact_force_max", "N", Run(|_, it| it.greatest_contact()), "greatest force of a roller on teeth over all steps";
    LinkTensionMax, "link_tension_max", "N", Run(|_, it| it.link_tension().greatest), "maximum link tension, over all steps";
    LinkTensionMaxTime, "link_tension_max_time", "s", Run(|_, it| it.link_tension().greatest_at), "time at which a link had it";
    LinkTensionMin, "link_tension_min", "N", Run(|_, it| it.link_tension().least), "least link tension, over all steps; negative where a link was pressed";
    SprocketSpeedMean, "sprocket_speed_mean", "rad/s", Body(|it| it.speed), "mean speed of the sprocket: angle over time, of whole periods of the slowest forcing";
    SprocketTorqueMean, "sprocket_torque_mean", "N m", Body(|it| it.torque), "mean torque of the chain on the sprocket: impulse over time";
    SprocketPowerMean, "sprocket_power_mean", "W", Body(|it| it.power), "mean power of the chain on the sprocket: work over time";
    BearingForceMean, "bearing_force_mean", "N", Body(|it| it.force.mean_polar()[0]), "mean shaft load: magnitude of the mean force of the chain on the sprocket";
    BearingForceMax, "bearing_force_max", "N", Body(|it| it.force.extremes.greatest), "greatest shaft load: force of the chain on the sprocket, over all steps";
    BearingForceMaxTime, "bearing_force_max_time", "s", Body(|it| it.force.extremes.greatest_at), "time at which the sprocket had it";
    SpeedIrregularity, "speed_irregularity", "1", Body(|it| it.speeds.range() / it.speed.abs()), "greatest less least speed of the sprocket over all steps, over the mean";
    TransmissionErrorRange, "transmission_error_range", "rad", Body(|it| it.lag.range()), "greatest less least transmission error of the sprocket over all steps";
    ImpactCount, "impact_count", "1", Sprocket(|it| it.count as f64), "number of impacts of rollers that came to the sprocket";
    ImpactForceP50, "impact_force_p50", "N", Sprocket(|it| it.of_any(it.force(0.5))), "median of the largest forces of impacts";
    ImpactForceP99, "impact_force_p99", "N", Sprocket(ImpactStatistics::p99), "99th percentile of the largest forces of impacts; NaN below 100 impacts";
    ImpactForceMax, "impact_force_max", "N", Sprocket(|it| it.of_any(it.greatest)), "largest force of all impacts";
    ImpactImpulse, "impact_impulse", "N s", Sprocket(|it| it.of_any(it.impulse(0.5))), "median of the impulses of impacts";
    ImpactSpeed, "impact_speed", "m/s", Sprocket(|it| it.of_any(it.speed(0.5))), "median of the closing speeds of impacts, along the normal of the tooth";
    EnergySupplied, "energy_supplied_total", "J", Run(|_, it| it.energy_supplied()), "energy put in by drivers, motions, torques and forces from outside";
    EnergyDissipated, "energy_dissipated_total", "J", Run(|_, it| it.energy_dissipated()), "energy lost";
    EnergyResidualMax, "energy_residual_max", "J", Run(|_, it| it.residual), "largest energy unaccounted for, with its sign";
    ContactCount, "contact_count", "1", Kind(|it| it.count as f64), "number of contacts logged";
    ContactPeakMean, "contact_peak_mean", "N", Kind(ContactStatistics::mean), "mean of the largest forces of the contacts logged";
    ContactPeakMax, "contact_peak_max", "N", Kind(|it| it.greatest), "largest force of the contacts logged";
    ContactDuration, "contact_duration", "s", Kind(|it| it.duration), "sum of the durations of the contacts logged";
    AccuracyError, "accuracy_error", "1", Choice(|_, it| it.error), "bound of the error found when method and step were chosen for an accuracy, on one of up to 32 variants that are alike";
    AccuracyKept, "accuracy_kept", "1", Choice(|_, it| kept(it)), "1 where the accuracy asked for is kept, 0 where no method on the list keeps it";
    StepChosen, "step_chosen", "s", Choice(|run, _| run.method().step()), "step of the method that was chosen for an accuracy";
    Samples, "samples", "1", Run(|_, it| it.samples as f64), "number of samples";
    Steps, "steps", "1", Run(|run, _| run.statistics().steps as f64), "number of steps";
    Rejections, "rejections", "1", Run(|run, _| run.statistics().rejected() as f64), "number of steps that were rejected";
    Evaluations, "evaluations", "1", Run(|run, _| run.statistics().evaluations as f64), "number of evaluations of the forces";
    TimeReached, "time_reached", "s", Run(|run, _| run.time()), "end of the run";
    SteppingTime, "stepping_time", "s", Run(|run, _| run.stepping_time()), "wall time spent in stepping";
    RealTimeFactor, "real_time_factor", "1", Run(|run, _| run.time() / run.stepping_time()), "time simulated over wall time";
}

/// 1 for an accuracy that is kept, 0 for one that is not; NaN where there was nothing to compare.
fn kept(choice: &Choice) -> f64 {
    match choice.promise {
        Promise::Nothing => f64::NAN,
        _ => f64::from(choice.kept),
    }
}

impl Statistic {
    /// The statistics that every run has.
    pub fn of_every_run() -> impl Iterator<Item = Self> {
        let all = Self::ALL.iter().copied();
        all.filter(|it| !it.is_of_logged_contacts() && !it.is_of_a_choice())
    }

    /// Dimension of its entries, if it has more than one.
    pub fn along(self) -> Option<&'static str> {
        match self.reader() {
            Reader::Run(_) | Reader::Choice(_) => None,
            Reader::SpanSteps(_) | Reader::Known(_) => Some(SPAN),
            Reader::Sprocket(_) | Reader::Body(_) => Some(SPROCKET),
            Reader::Kind(_) => Some(KIND),
        }
    }

    /// Whether it belongs to contacts that have to be logged.
    pub fn is_of_logged_contacts(self) -> bool {
        matches!(self.reader(), Reader::Kind(_))
    }

    /// Whether it belongs to an accuracy that has to be asked for.
    pub fn is_of_a_choice(self) -> bool {
        matches!(self.reader(), Reader::Choice(_))
    }

    /// Whether it is a measurement of the machine: all others are the same with every run.
    pub fn is_measured(self) -> bool {
        matches!(self, Self::SteppingTime | Self::RealTimeFactor)
    }

    /// Its entries in a run.
    pub(crate) fn read(
        self,
        simulation: &Simulation,
        summary: &Summary,
        choice: Option<&Choice>,
    ) -> Vec<f64> {
        // A span without a single finite sample has neither a least nor a greatest one.
        let finite = |value: f64| if value.is_finite() { value } else { f64::NAN };
        match self.reader() {
            Reader::Run(of) => vec![of(simulation, summary)],
            Reader::Choice(of) => vec![choice.map_or(f64::NAN, |it| of(simulation, it))],
            Reader::SpanSteps(of) => summary
                .span_extremes()
                .iter()
                .map(|it| finite(of(it)))
                .collect(),
            Reader::Body(of) => {
                let sprockets = summary.bodies().sprockets;
                sprockets.iter().map(|it| finite(of(it))).collect()
            }
            Reader::Known(of) => {
                let spans = summary.steadiness().into_iter();
                spans.map(|it| it.map_or(f64::NAN, |it| of(&it))).collect()
            }
            Reader::Sprocket(of) => summary.impacts().iter().map(of).collect(),
            Reader::Kind(of) => summary.contacts(simulation).iter().map(of).collect(),
        }
    }

    /// Names and values of the statistics of the impacts on one sprocket.
    pub(crate) fn of_impacts(struck: &ImpactStatistics) -> impl Iterator<Item = (Self, f64)> {
        let all = Self::ALL.iter().copied();
        all.filter_map(|it| match it.reader() {
            Reader::Sprocket(of) => Some((it, of(struck))),
            _ => None,
        })
    }
}
