//! Settings of a run: how long, how often to sample, by which method.

mod error;
mod request;
mod settings;

use chaindrive_integrate::Method;
use chaindrive_mechanics::{EventKinds, System};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value as Json};

use crate::scene::{EVERY, RunDefaults, RunIn, Scene, SceneError, TOLERANCE, UNTIL};
use crate::{SimulationError, Stepping};

pub use error::RequestError;
pub use request::Request;
pub use settings::{SettingValue, Settings};

/// Settings of one run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// End \[s\], positive.
    pub until: f64,
    /// Time simulated before t = 0.
    #[serde(default)]
    pub run_in: RunIn,
    /// Interval between samples \[s\], positive.
    pub every: f64,
    /// Method of time stepping.
    pub stepping: Stepping,
    /// Step \[s\] of the fixed-step methods; chosen from the stiffest mode when absent.
    pub step: Option<f64>,
    /// Relative tolerance of the adaptive method.
    pub tolerance: f64,
    /// Deepest penetration at which a contact may begin \[m\]; deeper steps are rejected and
    /// shortened. Absent: contacts begin wherever the step lands.
    pub onset_depth: Option<f64>,
    /// Contacts to log; none cost nothing.
    pub events: EventKinds,
    /// Whether steps are watched for the [periods](crate::Simulation::periods) of the account; if not, that costs nothing.
    #[serde(default)]
    pub watched: bool,
}

impl Default for Run {
    fn default() -> Self {
        Self {
            until: UNTIL,
            run_in: RunIn::None,
            every: EVERY,
            stepping: Stepping::Auto,
            step: None,
            tolerance: TOLERANCE,
            onset_depth: None,
            events: EventKinds::default(),
            watched: false,
        }
    }
}

/// Keys with a number, all of them positive.
const NUMBERS: [&str; 6] = [
    "until",
    "every",
    "step",
    "tolerance",
    "onset_depth",
    "accuracy",
];

/// Steps of a run at most: at a microsecond each they would take eleven days.
const MOST_STEPS: f64 = 1e12;

impl Run {
    /// A run of reference quality: RK4 at a quarter of 1/ω of the stiffest mode, with contacts that
    /// begin deeper than a micrometre approached again by shorter steps.
    ///
    /// Some ten times the cost of the default run; the energy ledger of the marine drive closes to
    /// better than 1e-5 of the energy supplied.
    pub fn reference(until: f64, every: f64) -> Self {
        Self {
            until,
            every,
            stepping: Stepping::Rk4,
            onset_depth: Some(1e-6),
            ..Self::default()
        }
    }

    /// The run that a scene suggests; what it leaves open is as in [`Run::default`].
    pub fn suggested(by: &RunDefaults) -> Self {
        let default = Self::default();
        Self {
            until: by.until.unwrap_or(default.until),
            run_in: by.run_in.clone(),
            every: by.every.unwrap_or(default.every),
            stepping: by.method.unwrap_or_default(),
            step: by.step,
            tolerance: by.tolerance.unwrap_or(default.tolerance),
            onset_depth: by.onset_depth,
            events: by.events,
            watched: false,
        }
    }

    /// Names the first setting out of range.
    ///
    /// # Errors
    /// [`SimulationError::Setting`].
    pub fn check(&self) -> Result<(), SimulationError> {
        let positive = |name: &'static str, value: f64| {
            if value > 0.0 && value.is_finite() {
                Ok(())
            } else {
                Err(SimulationError::Setting {
                    name,
                    value,
                    allowed: "positive",
                })
            }
        };
        positive("until", self.until)?;
        self.run_in.check()?;
        positive("every", self.every)?;
        positive("tolerance", self.tolerance)?;
        self.step.map_or(Ok(()), |step| positive("step", step))?;
        self.onset_depth
            .map_or(Ok(()), |depth| positive("onset_depth", depth))?;
        // Time would stand still: t + h = t.
        if self.step.is_some_and(|step| self.until / step > MOST_STEPS) {
            return Err(SimulationError::Setting {
                name: "step",
                value: self.step.unwrap_or_default(),
                allowed: "at least 1e-12 of `until`",
            });
        }
        if self.until / self.every > 1e9 {
            return Err(SimulationError::Setting {
                name: "every",
                value: self.every,
                allowed: "at least a billionth of `until`",
            });
        }
        Ok(())
    }

    /// The settings as a scene writes them in `[run]`, once the method is chosen; what the run leaves open is absent.
    pub(crate) fn table(&self, method: Method) -> Map<String, Json> {
        let mut table = Map::new();
        table.insert("until".into(), self.until.into());
        if self.run_in != RunIn::Usual {
            table.insert("run_in".into(), self.run_in.to_string().into());
        }
        table.insert("every".into(), self.every.into());
        table.insert("method".into(), Stepping::from(method).name().into());
        table.insert("step".into(), method.step().into());
        if let Some(tolerance) = method.tolerance() {
            table.insert("tolerance".into(), tolerance.into());
        }
        if let Some(depth) = self.onset_depth {
            table.insert("onset_depth".into(), depth.into());
        }
        table
    }

    /// The method for a system, with a default step where none is given.
    pub fn method(&self, system: &System) -> Method {
        self.stepping.method(system, self.step, self.tolerance)
    }
}

impl Scene {
    /// As [`resolved`](Self::resolved), with the settings of a run as they were in the end: what reproduces a result.
    ///
    /// # Errors
    /// As [`Scene::drive`].
    pub fn resolved_for(&self, run: &Run, method: Method) -> Result<Self, SceneError> {
        let (text, _) = self.resolved_text(run.table(method))?;
        Self::from_toml(&text, self.name())
    }
}

impl RunIn {
    /// Names what is out of range.
    fn check(&self) -> Result<(), SimulationError> {
        let (value, allowed) = match self {
            Self::None | Self::Auto | Self::Usual => return Ok(()),
            Self::Time(time) => (*time, "a time that is not negative"),
            Self::Turns { turns, .. } => (*turns, "a positive number of turns"),
        };
        if value > 0.0 && value.is_finite() {
            return Ok(());
        }
        Err(SimulationError::Setting {
            name: "run_in",
            value,
            allowed,
        })
    }
}
