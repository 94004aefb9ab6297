//! Account of one variant: statistics, and channels where they are asked for.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};

use chaindrive_mechanics::EventKinds;
use serde::{Deserialize, Serialize};

use super::Outcome;
use crate::channel::labels;
use crate::event::EventTable;
use crate::execute::execute_by;
use crate::precision::{Choice, Promise};
use crate::record::Provenance;
use crate::summary::{ContactStatistics, ImpactStatistics, SpanStatistics, Steadiness};
use crate::verdict::WrittenVerdict;
use crate::{
    Channel, End, Recording, Report, Request, RequestError, RunError, Scene, Settings, Simulation,
    SimulationError, Sink, Stepping, Stop, Summary,
};

macro_rules! statistics {
    ($($variant:ident, $name:literal, $unit:literal, $along:expr, $text:literal;)*) => {
        /// A number, or a number a span or kind of contact, that sums up a run.
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

            /// Dimension of its entries, if it has more than one.
            pub fn along(self) -> Option<&'static str> {
                match self { $(Self::$variant => $along),* }
            }

            /// One line of description.
            pub fn description(self) -> &'static str {
                match self { $(Self::$variant => $text),* }
            }
        }
    };
}

/// Dimension of statistics by kind of contact, see [`EventTable::KINDS`].
const KIND: &str = "contact_kind";

/// Dimension of statistics by sprocket.
const SPROCKET: &str = "sprocket";

statistics! {
    SpanTensionMean, "span_tension_mean", "N", Some("span"), "mean of the span tension over whole periods of the slowest forcing";
    SpanTensionHalfWidth, "span_tension_half_width", "N", Some("span"), "half width of the 95 % interval of the mean; NaN below three periods";
    SpanTensionStd, "span_tension_std", "N", Some("span"), "standard deviation of the span tension";
    SpanTensionStdHalfWidth, "span_tension_std_half_width", "N", Some("span"), "half width of the 95 % interval of the standard deviation; NaN below three periods";
    SpanTensionP1, "span_tension_p1", "N", Some("span"), "tension that the span has less of in 1 % of the time";
    SpanTensionP1HalfWidth, "span_tension_p1_half_width", "N", Some("span"), "half width of its 95 % interval; NaN below three periods, and where they are too few to tell it";
    SpanTensionP99, "span_tension_p99", "N", Some("span"), "tension that the span has less of in 99 % of the time";
    SpanTensionP99HalfWidth, "span_tension_p99_half_width", "N", Some("span"), "half width of its 95 % interval; NaN below three periods, and where they are too few to tell it";
    SpanTensionMin, "span_tension_min", "N", Some("span"), "least sample of the span tension";
    SpanTensionMax, "span_tension_max", "N", Some("span"), "greatest sample of the span tension";
    ContactForceP50, "contact_force_p50", "N", None, "median of the forces of loaded rollers on teeth";
    ContactForceP90, "contact_force_p90", "N", None, "90th percentile of the forces of loaded rollers on teeth";
    ContactForceP99, "contact_force_p99", "N", None, "99th percentile of the forces of loaded rollers on teeth";
    ContactForceMax, "contact_force_max", "N", None, "largest sample of the forces of rollers on teeth";
    ImpactCount, "impact_count", "1", Some(SPROCKET), "number of impacts of rollers that came to the sprocket";
    ImpactForceP50, "impact_force_p50", "N", Some(SPROCKET), "median of the largest forces of impacts";
    ImpactForceP99, "impact_force_p99", "N", Some(SPROCKET), "99th percentile of the largest forces of impacts; NaN below 100 impacts";
    ImpactForceMax, "impact_force_max", "N", Some(SPROCKET), "largest force of all impacts";
    ImpactImpulse, "impact_impulse", "N s", Some(SPROCKET), "median of the impulses of impacts";
    ImpactSpeed, "impact_speed", "m/s", Some(SPROCKET), "median of the closing speeds of impacts, along the normal of the tooth";
    EnergySupplied, "energy_supplied_total", "J", None, "energy put in by drivers, motions and torques";
    EnergyDissipated, "energy_dissipated_total", "J", None, "energy lost";
    EnergyResidualMax, "energy_residual_max", "J", None, "largest energy unaccounted for, with its sign";
    ContactCount, "contact_count", "1", Some(KIND), "number of contacts logged";
    ContactPeakMean, "contact_peak_mean", "N", Some(KIND), "mean of the largest forces of the contacts logged";
    ContactPeakMax, "contact_peak_max", "N", Some(KIND), "largest force of the contacts logged";
    ContactDuration, "contact_duration", "s", Some(KIND), "sum of the durations of the contacts logged";
    AccuracyError, "accuracy_error", "1", None, "bound of the error found when method and step were chosen for an accuracy, on one of up to 32 variants that are alike";
    AccuracyKept, "accuracy_kept", "1", None, "1 where the accuracy asked for is kept, 0 where no method on the list keeps it";
    StepChosen, "step_chosen", "s", None, "step of the method that was chosen for an accuracy";
    Samples, "samples", "1", None, "number of samples";
    Steps, "steps", "1", None, "number of steps";
    Rejections, "rejections", "1", None, "number of steps that were rejected";
    Evaluations, "evaluations", "1", None, "number of evaluations of the forces";
    TimeReached, "time_reached", "s", None, "end of the run";
    SteppingTime, "stepping_time", "s", None, "wall time spent in stepping";
    RealTimeFactor, "real_time_factor", "1", None, "time simulated over wall time";
}

impl Statistic {
    /// The statistics that every run has.
    pub fn of_every_run() -> impl Iterator<Item = Self> {
        let all = Self::ALL.iter().copied();
        all.filter(|it| !it.is_of_logged_contacts() && !it.is_of_a_choice())
    }

    /// Whether it belongs to contacts that have to be logged.
    pub fn is_of_logged_contacts(self) -> bool {
        self.along() == Some(KIND)
    }

    /// Whether it belongs to an accuracy that has to be asked for.
    pub fn is_of_a_choice(self) -> bool {
        matches!(
            self,
            Self::AccuracyError | Self::AccuracyKept | Self::StepChosen
        )
    }

    /// Whether it is a measurement of the machine: all others are the same with every run.
    pub fn is_measured(self) -> bool {
        matches!(self, Self::SteppingTime | Self::RealTimeFactor)
    }

    fn read(self, simulation: &Simulation, summary: &Summary, choice: Option<&Choice>) -> Vec<f64> {
        let spans = |of: fn(&SpanStatistics) -> f64| {
            let values = summary.spans.iter().map(of);
            // A span without a single finite sample has neither a least nor a greatest one.
            values
                .map(|value| if value.is_finite() { value } else { f64::NAN })
                .collect()
        };
        let known = |of: fn(&Steadiness) -> f64| {
            let spans = summary.steadiness().into_iter();
            spans.map(|it| it.as_ref().map_or(f64::NAN, of)).collect()
        };
        let contacts = |of: fn(&ContactStatistics) -> f64| {
            summary.contacts(simulation).iter().map(of).collect()
        };
        let impacts = |of: fn(&ImpactStatistics) -> f64| summary.impacts().iter().map(of).collect();
        let counts = simulation.statistics();
        let number = match self {
            Self::SpanTensionMean => return known(|it| it.mean.value),
            Self::SpanTensionHalfWidth => return known(|it| it.mean.half_width),
            Self::SpanTensionStd => return known(|it| it.deviation.value),
            Self::SpanTensionStdHalfWidth => return known(|it| it.deviation.half_width),
            Self::SpanTensionP1 => return known(|it| it.p1.value),
            Self::SpanTensionP1HalfWidth => return known(|it| it.p1.half_width),
            Self::SpanTensionP99 => return known(|it| it.p99.value),
            Self::SpanTensionP99HalfWidth => return known(|it| it.p99.half_width),
            Self::SpanTensionMin => return spans(|span| span.least),
            Self::SpanTensionMax => return spans(|span| span.greatest),
            Self::ContactCount => return contacts(|kind| kind.count as f64),
            Self::ContactPeakMean => return contacts(ContactStatistics::mean),
            Self::ContactPeakMax => return contacts(|kind| kind.greatest),
            Self::ContactDuration => return contacts(|kind| kind.duration),
            Self::ImpactCount => return impacts(|it| it.count as f64),
            Self::ImpactForceP50 => return impacts(|it| it.columns()[0].1),
            Self::ImpactForceP99 => return impacts(|it| it.columns()[1].1),
            Self::ImpactForceMax => return impacts(|it| it.columns()[2].1),
            Self::ImpactImpulse => return impacts(|it| it.columns()[3].1),
            Self::ImpactSpeed => return impacts(|it| it.columns()[4].1),
            Self::ContactForceP50 => summary.forces().p50,
            Self::ContactForceP90 => summary.forces().p90,
            Self::ContactForceP99 => summary.forces().p99,
            Self::ContactForceMax => summary.forces().max,
            Self::EnergySupplied => summary.energy_supplied(),
            Self::EnergyDissipated => summary.energy_dissipated(),
            Self::EnergyResidualMax => summary.residual,
            Self::AccuracyError => choice.map_or(f64::NAN, |choice| choice.error),
            Self::AccuracyKept => match choice {
                Some(choice) if choice.promise != Promise::Nothing => f64::from(choice.kept),
                _ => f64::NAN,
            },
            Self::StepChosen => simulation.method().step(),
            Self::Samples => summary.samples as f64,
            Self::Steps => counts.steps as f64,
            Self::Rejections => {
                (counts.rejections + counts.error_rejections + counts.newton_failures) as f64
            }
            Self::Evaluations => counts.evaluations as f64,
            Self::TimeReached => simulation.time(),
            Self::SteppingTime => simulation.stepping_time(),
            Self::RealTimeFactor => simulation.time() / simulation.stepping_time(),
        };
        vec![number]
    }
}

/// A statistic or a channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub enum Quantity {
    /// One account of the whole run.
    Statistic(Statistic),
    /// One account a sample.
    Channel(Channel),
}

impl Quantity {
    /// The quantity of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        let statistic = Statistic::ALL.iter().find(|known| known.name() == name);
        let channel = || Channel::ALL.iter().find(|known| known.name() == name);
        statistic
            .map(|&found| Self::Statistic(found))
            .or_else(|| channel().map(|&found| Self::Channel(found)))
    }

    /// Name in results.
    pub fn name(self) -> &'static str {
        match self {
            Self::Statistic(statistic) => statistic.name(),
            Self::Channel(channel) => channel.name(),
        }
    }

    /// SI unit; of a channel whose unit depends on the drive, all that it may be.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Statistic(statistic) => statistic.unit(),
            Self::Channel(channel) => channel.unit(),
        }
    }

    /// One line of description.
    pub fn description(self) -> &'static str {
        match self {
            Self::Statistic(statistic) => statistic.description(),
            Self::Channel(channel) => channel.description(),
        }
    }

    /// Whether it has an entry a sample.
    pub fn is_sampled(self) -> bool {
        matches!(self, Self::Channel(_))
    }

    /// Dimension of its entries beside time, if any.
    pub fn along(self) -> Option<&'static str> {
        match self {
            Self::Statistic(statistic) => statistic.along(),
            Self::Channel(channel) => channel.axis().name(),
        }
    }
}

impl From<Quantity> for String {
    fn from(quantity: Quantity) -> Self {
        quantity.name().to_owned()
    }
}

impl TryFrom<String> for Quantity {
    type Error = String;

    fn try_from(name: String) -> Result<Self, String> {
        Self::from_name(&name).ok_or_else(|| format!("no quantity is named `{name}`"))
    }
}

/// Account of a run that reached its end.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Account {
    /// Method of time stepping, as chosen.
    pub method: String,
    /// Sample times of the channels \[s\]; empty without channels.
    pub time: Vec<f64>,
    /// Labels of every dimension that the entries have beside time.
    pub labels: Vec<(String, Vec<String>)>,
    /// Values that are kept.
    pub entries: Vec<Entry>,
    /// Whether the numbers can be trusted.
    pub verdict: WrittenVerdict,
}

/// A quantity of one variant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Entry {
    /// Which.
    pub quantity: Quantity,
    /// SI unit in the drive of the variant.
    pub unit: String,
    /// Values, (time, labels) or less, flat.
    pub values: Vec<f64>,
}

/// The channels that are kept beside the statistics, if any.
#[derive(Default)]
struct Kept {
    wanted: bool,
    recording: Recording,
}

impl Sink for Kept {
    type Error = SimulationError;

    fn begin(
        &mut self,
        simulation: &Simulation,
        channels: &[Channel],
        provenance: &Provenance,
    ) -> Result<(), SimulationError> {
        // Where no channel is kept there is nothing that a long run could fill the memory with.
        if self.wanted {
            self.recording = Recording::of_run(channels, simulation.system(), &provenance.run)?;
        }
        Ok(())
    }

    fn keeps_samples(&self) -> bool {
        self.wanted
    }

    fn push(&mut self, simulation: &Simulation) -> Result<(), SimulationError> {
        if self.wanted {
            self.recording.push(simulation.observation());
        }
        Ok(())
    }

    fn end(&mut self, _: &End<'_>) -> Result<(), SimulationError> {
        Ok(())
    }
}

/// Whatever goes wrong is the outcome, a panic included: the other variants are not its fault.
pub(super) fn outcome(attempt: impl FnOnce() -> Result<Option<Account>, String>) -> Outcome {
    match catch_unwind(AssertUnwindSafe(attempt)) {
        Ok(Ok(Some(account))) => Outcome::Done(account),
        Ok(Ok(None)) => Outcome::Open,
        Ok(Err(message)) => Outcome::Failed(message),
        Err(panic) => {
            let text = panic.downcast_ref::<String>().map(String::as_str);
            let text = text.or_else(|| panic.downcast_ref::<&str>().copied());
            Outcome::Failed(format!(
                "the program failed, please report this as a bug: {}",
                text.unwrap_or("without a message")
            ))
        }
    }
}

/// A scene as it suggests to be run, with channels of these names.
pub(super) fn request(scene: &Scene, record: &[String]) -> Result<Request, RequestError> {
    let request = Request::new(scene, &Settings::default())?.without_estimate();
    Ok(Request {
        record: record.to_vec(),
        ..request
    })
}

/// A failure of method or step: others might have carried the run through.
fn is_of_the_step(error: &RunError<SimulationError>) -> bool {
    let (RunError::Start(error) | RunError::Sink(error)) = error else {
        return false;
    };
    matches!(
        error,
        SimulationError::Integration(_)
            | SimulationError::NotFinite { .. }
            | SimulationError::Implicit { .. }
            | SimulationError::Setting { .. }
    )
}

impl Account {
    /// Carries out a request by the choice of its block: the account, `None` if it was told to stop, or what went wrong. A variant
    /// that refuses the choice makes its own.
    pub(super) fn attempt(
        request: &Request,
        shared: Option<&Choice>,
        stop: &AtomicBool,
    ) -> Result<Option<Self>, String> {
        let mut tried = Self::run(request, shared, stop);
        if shared.is_some() && tried.as_ref().is_err_and(is_of_the_step) {
            tried = Self::run(request, None, stop);
        }
        match tried {
            Ok(account) => Ok(Some(account)),
            Err(RunError::Interrupted) => Ok(None),
            Err(error) => Err(error.to_string()),
        }
    }

    fn run(
        request: &Request,
        shared: Option<&Choice>,
        stop: &AtomicBool,
    ) -> Result<Self, RunError<SimulationError>> {
        let mut memory = Kept {
            wanted: !request.record.is_empty(),
            ..Kept::default()
        };
        let stopped = || stop.load(Ordering::Relaxed);
        let report = execute_by(shared, request, &mut memory, &stopped)?;
        match report.stop {
            Stop::End => Ok(Self::close(&report, memory.recording)),
            Stop::Interrupted => Err(RunError::Interrupted),
            Stop::Failed(error) => Err(RunError::Start(error)),
        }
    }

    fn close(report: &Report, recording: Recording) -> Self {
        let (simulation, summary) = (&report.simulation, &report.summary);
        let (run, choice) = (&report.run, report.choice.as_ref());
        let names = summary.spans.iter().map(|span| span.name.clone());
        let mut account = Self {
            method: Stepping::from(simulation.method()).name().to_owned(),
            time: recording.time,
            labels: vec![
                ("span".into(), names.collect()),
                (SPROCKET.into(), simulation.system().sprocket_names()),
            ],
            entries: Vec::new(),
            verdict: report.verdict.written(),
        };
        let logged = run.events != EventKinds::default();
        if logged {
            let kinds = EventTable::KINDS.map(str::to_owned);
            account.labels.push((KIND.into(), kinds.into()));
        }
        for &statistic in Statistic::ALL {
            let wanted = (logged || !statistic.is_of_logged_contacts())
                && (choice.is_some() || !statistic.is_of_a_choice());
            if wanted {
                account.entries.push(Entry {
                    quantity: Quantity::Statistic(statistic),
                    unit: statistic.unit().to_owned(),
                    values: statistic.read(simulation, summary, choice),
                });
            }
        }
        for column in recording.columns {
            let axis = column.channel.axis();
            if let (Some(name), Some(labels)) = (axis.name(), labels(axis, simulation.system()))
                && account.labels_along(name).is_none()
            {
                account.labels.push((name.into(), labels));
            }
            account.entries.push(Entry {
                quantity: Quantity::Channel(column.channel),
                unit: column.channel.unit_in(simulation.system()),
                values: column.values,
            });
        }
        account
    }

    /// Labels of a dimension.
    pub fn labels_along(&self, dimension: &str) -> Option<&[String]> {
        let found = self.labels.iter().find(|(name, _)| name == dimension);
        found.map(|(_, labels)| labels.as_slice())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::execute::choice;

    /// Particles solve no equations of an implicit step: the variant is as if nobody had chosen for it.
    #[test]
    fn a_variant_that_refuses_a_choice_makes_its_own() {
        let scene = Scene::preset("marine_two_sprockets").unwrap();
        let short = [("run.until", "1 ms"), ("run.run_in", "0 s")];
        let scene = short.iter().fold(scene, |scene, (path, value)| {
            scene.replace(path, value).unwrap()
        });
        let request = request(&scene, &["link_tension".to_owned()]).unwrap();
        let never = AtomicBool::new(false);
        let own = Account::attempt(&request, None, &never).unwrap().unwrap();
        let mut choice = choice(&request, &|| false).unwrap().unwrap();
        choice.run.stepping = Stepping::GeneralizedAlpha;
        let refused = Account::run(&request, Some(&choice), &never).unwrap_err();
        assert!(is_of_the_step(&refused), "{refused}");
        let again = Account::attempt(&request, Some(&choice), &never)
            .unwrap()
            .unwrap();
        let measured = |it: &&Entry| matches!(it.quantity, Quantity::Statistic(statistic) if statistic.is_measured());
        for (one, other) in own.entries.iter().zip(&again.entries) {
            let bits = |entry: &Entry| {
                entry
                    .values
                    .iter()
                    .map(|it| it.to_bits())
                    .collect::<Vec<_>>()
            };
            assert!(measured(&one) || bits(one) == bits(other), "{one:?}");
        }
    }

    #[test]
    fn a_panic_is_an_outcome() {
        for (panicking, words) in [
            (outcome(|| panic!("roller {}", 7)), "roller 7"),
            (outcome(|| panic!("roller")), "roller"),
            (outcome(|| std::panic::panic_any(7)), "without a message"),
        ] {
            let Outcome::Failed(message) = panicking else {
                panic!("a panic has passed for {panicking:?}");
            };
            assert!(
                message.contains("bug") && message.ends_with(words),
                "{message}"
            );
        }
    }
}
