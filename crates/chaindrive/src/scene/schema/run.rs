//! `[run]`: what a front end runs and records by default.

use chaindrive_mechanics::EventKinds;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value as Json;

use crate::Stepping;
use crate::scene::accuracy::Quantity;
use crate::scene::run_in::RunIn;
use chaindrive_quantities::{Length, Ratio, Time};

/// End of a run \[s\]. *Assumed*.
pub(crate) const UNTIL: f64 = 1.0;

/// Interval between samples \[s\]. *Assumed*.
pub(crate) const EVERY: f64 = 1e-3;

/// Relative tolerance \[–\] of a method under error control. *Assumed*.
pub(crate) const TOLERANCE: f64 = 1e-8;

/// Keys of `[run]` that say how to step, each in place of an accuracy that would choose.
pub(crate) const STEPPING_KEYS: [&str; 4] = ["method", "step", "tolerance", "onset_depth"];

/// Settings of a run and channels to record, unless the caller gives others.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[expect(clippy::struct_field_names, reason = "a run-in is called so in scenes")]
pub(crate) struct Run {
    /// Duration of the run [s].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) until: Option<Time>,
    /// Time simulated before t = 0, so that the record begins where the motion is steady: seconds [s], turns of a
    /// sprocket ("5 turns" of the first one, "5 turns of camshaft"), or "auto"; absent: "auto" for closed chains that a motion drives and whose inputs
    /// repeat, else nothing.
    #[serde(default)]
    #[schemars(with = "Json", extend(
        "type" = ["number", "string"],
        "minimum" = 0,
        "x-run-in" = true,
        "examples" = ["auto", "0.5 s", "5 turns of camshaft"],
    ))]
    pub(crate) run_in: Option<RunInText>,
    /// Time between two samples of the recording [s].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) every: Option<Time>,
    /// Time stepping.
    pub(crate) method: Option<Stepping>,
    /// Step of a method with a fixed step [s].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) step: Option<Time>,
    /// Relative tolerance of a method under error control [–].
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1))]
    pub(crate) tolerance: Option<Ratio>,
    /// Deepest penetration at which a contact may begin [m]: deeper steps are shortened; absent:
    /// contacts begin wherever the step lands.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) onset_depth: Option<Length>,
    /// Relative error of the tension, or of the losses, that method, step and onset depth are chosen for, 0 to 1; it takes the
    /// place of what is said about them. Absent: 0.01 of tensions, 0.05 of losses and impacts, unless one of them or a tolerance is given.
    #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 1))]
    pub(crate) accuracy: Option<Ratio>,
    /// Quantity that the accuracy is one of; absent: the tension.
    #[serde(default)]
    pub(crate) accuracy_of: Quantity,
    /// Channels to record.
    pub(crate) record: Option<Vec<String>>,
    /// Contacts to log, each from touch to parting; absent: none.
    #[serde(default)]
    pub(crate) events: Vec<Events>,
}

/// A run-in as scenes have it: a number of seconds, or a text.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize)]
#[serde(try_from = "Written", into = "Written")]
pub(crate) struct RunInText(pub(crate) RunIn);

/// A run-in as a scene writes it.
#[derive(Deserialize, Serialize)]
#[serde(untagged)]
enum Written {
    Seconds(f64),
    Text(String),
}

impl TryFrom<Written> for RunInText {
    type Error = String;

    fn try_from(written: Written) -> Result<Self, String> {
        Ok(Self(match written {
            Written::Seconds(0.0) => RunIn::None,
            Written::Seconds(time) => RunIn::Time(time),
            Written::Text(text) => text.parse()?,
        }))
    }
}

impl From<RunInText> for Written {
    fn from(RunInText(run_in): RunInText) -> Self {
        match run_in {
            RunIn::None => Self::Seconds(0.0),
            RunIn::Time(time) => Self::Seconds(time),
            RunIn::Turns { .. } | RunIn::Auto | RunIn::Usual => Self::Text(run_in.to_string()),
        }
    }
}

/// Contacts that can be logged.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Events {
    /// Rollers on teeth.
    Teeth,
    /// Rollers and plates on guides.
    Guides,
    /// Pins in bushes, and bushes in free rollers.
    Joints,
}

impl Run {
    /// The same in SI units.
    pub(crate) fn suggestions(&self) -> RunDefaults {
        RunDefaults {
            until: self.until.map(|time| time.0),
            run_in: self.run_in.clone().map_or(RunIn::Usual, |it| it.0),
            every: self.every.map(|time| time.0),
            method: self.method,
            step: self.step.map(|time| time.0),
            tolerance: self.tolerance.map(|ratio| ratio.0),
            onset_depth: self.onset_depth.map(|depth| depth.0),
            accuracy: self.accuracy.map(|ratio| ratio.0),
            accuracy_of: self.accuracy_of,
            record: self.record.clone().unwrap_or_default(),
            events: events(&self.events),
        }
    }
}

/// Settings and channels that a scene suggests.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RunDefaults {
    /// Duration of the run \[s\].
    pub until: Option<f64>,
    /// Time simulated before t = 0.
    pub run_in: RunIn,
    /// Time between two samples \[s\].
    pub every: Option<f64>,
    /// Method of time stepping.
    pub method: Option<Stepping>,
    /// Step of a method with a fixed step \[s\].
    pub step: Option<f64>,
    /// Relative tolerance of a method under error control \[–\].
    pub tolerance: Option<f64>,
    /// Deepest penetration at which a contact may begin \[m\].
    pub onset_depth: Option<f64>,
    /// Relative error that method and step are to be chosen for \[–\].
    pub accuracy: Option<f64>,
    /// Of what.
    pub accuracy_of: Quantity,
    /// Channels to record; empty when the scene leaves them open.
    pub record: Vec<String>,
    /// Contacts to log.
    pub events: EventKinds,
}

impl RunDefaults {
    /// The accuracy \[–\] that method and step are chosen for: what is asked for, or
    /// [usual](Quantity::usual_accuracy) where method, step, tolerance and onset depth are all left open.
    pub fn chosen_accuracy(&self) -> Option<f64> {
        let open = self.method.is_none()
            && self.step.is_none()
            && self.tolerance.is_none()
            && self.onset_depth.is_none();
        self.accuracy
            .or_else(|| open.then_some(self.accuracy_of.usual_accuracy()))
    }
}

fn events(named: &[Events]) -> EventKinds {
    EventKinds {
        teeth: named.contains(&Events::Teeth),
        guides: named.contains(&Events::Guides),
        joints: named.contains(&Events::Joints),
    }
}
