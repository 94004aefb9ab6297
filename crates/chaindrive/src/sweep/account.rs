//! Account of one variant: statistics, and channels where they are asked for.

use std::sync::atomic::{AtomicBool, Ordering};

use chaindrive_mechanics::EventKinds;
use serde::{Deserialize, Serialize};

use super::Outcome;
use crate::channel::labels;
use crate::event::EventTable;
use crate::execute::execute_by;
use crate::precision::Choice;
use crate::record::Provenance;
use crate::statistic::{KIND, SPAN, SPROCKET, Statistic};
use crate::verdict::WrittenVerdict;
use crate::{
    Channel, End, Recording, Report, Request, RequestError, RunError, Scene, Settings, Simulation,
    SimulationError, Sink, Stepping, Stop, caught,
};

/// A statistic or a channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub enum ResultQuantity {
    /// One account of the whole run.
    Statistic(Statistic),
    /// One account a sample.
    Channel(Channel),
}

impl ResultQuantity {
    /// The quantity of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        let statistic = Statistic::ALL.iter().find(|known| known.name() == name);
        let channel = || Channel::ALL.iter().find(|known| known.name() == name);
        statistic
            .map(|&found| Self::Statistic(found))
            .or_else(|| channel().map(|&found| Self::Channel(found)))
    }

    /// Whichever of two readers is that of its kind.
    fn read<T>(self, of_statistic: fn(Statistic) -> T, of_channel: fn(Channel) -> T) -> T {
        match self {
            Self::Statistic(statistic) => of_statistic(statistic),
            Self::Channel(channel) => of_channel(channel),
        }
    }

    /// Name in results.
    pub fn name(self) -> &'static str {
        self.read(Statistic::name, Channel::name)
    }

    /// SI unit; of a channel whose unit depends on the drive, all that it may be.
    pub fn unit(self) -> &'static str {
        self.read(Statistic::unit, Channel::unit)
    }

    /// One line of description.
    pub fn description(self) -> &'static str {
        self.read(Statistic::description, Channel::description)
    }

    /// Whether it has an entry a sample.
    pub fn is_sampled(self) -> bool {
        matches!(self, Self::Channel(_))
    }

    /// Dimension of its entries beside time, if any.
    pub fn along(self) -> Option<&'static str> {
        self.read(Statistic::along, |channel| channel.axis().name())
    }
}

impl From<ResultQuantity> for String {
    fn from(quantity: ResultQuantity) -> Self {
        quantity.name().to_owned()
    }
}

impl TryFrom<String> for ResultQuantity {
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
    pub quantity: ResultQuantity,
    /// SI unit in the drive of the variant.
    pub unit: String,
    /// Values, (time, labels) or less, flat.
    pub values: Vec<f64>,
}

/// The channels that are kept beside the statistics, if any.
#[derive(Default)]
struct KeptChannels {
    wanted: bool,
    recording: Recording,
}

impl Sink for KeptChannels {
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

    fn keeps_attributes(&self) -> bool {
        false
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
    match caught(attempt) {
        Ok(Ok(Some(account))) => Outcome::Done(account),
        Ok(Ok(None)) => Outcome::Open,
        Ok(Err(message)) => Outcome::Failed(message),
        Err(fault) => Outcome::Failed(fault.to_string()),
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
        let mut memory = KeptChannels {
            wanted: !request.record.is_empty(),
            ..KeptChannels::default()
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
                (SPAN.into(), names.collect()),
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
                    quantity: ResultQuantity::Statistic(statistic),
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
                quantity: ResultQuantity::Channel(column.channel),
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
        let measured = |it: &&Entry| matches!(it.quantity, ResultQuantity::Statistic(statistic) if statistic.is_measured());
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
                message.contains("report this") && message.ends_with(words),
                "{message}"
            );
        }
    }
}
