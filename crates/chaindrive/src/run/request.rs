//! Request of a run.

use super::{RequestError, Run, SettingValue, Settings};
use crate::scene::Quantity;
use crate::{Channel, Scene, SimulationError};

/// A scene with its settings merged, ready to be carried out.
#[derive(Clone, Debug, PartialEq)]
pub struct Request {
    /// The scene, settings included: its text reproduces the run.
    pub scene: Scene,
    /// Settings of the run, before method and step are chosen for an accuracy.
    pub run: Run,
    /// Names of the channels to record; empty for the default ones.
    pub record: Vec<String>,
    /// Accuracy \[–\] that method, step and onset depth are to be chosen for.
    pub accuracy: Option<f64>,
    /// The quantity that it is one of.
    pub accuracy_of: Quantity,
    /// Whether the run ends with an estimate of its numerical error.
    pub estimate: bool,
    /// Simulated time \[s\] between two checkpoints, for results that can be carried on; none without.
    pub checkpoint_every: Option<f64>,
}

impl Request {
    /// Merges settings into a scene; see [`Settings`] for what goes before what.
    ///
    /// Where neither names method, step, tolerance, onset depth or accuracy, they are chosen for
    /// [usual one](Quantity::usual_accuracy).
    ///
    /// # Errors
    /// [`RequestError`]: a setting out of range, a channel that does not exist.
    pub fn new(scene: &Scene, settings: &Settings) -> Result<Self, RequestError> {
        let scene = settings.put(scene)?;
        let wanted = scene.run_defaults();
        let run = Run {
            watched: true,
            ..Run::suggested(&wanted)
        };
        run.check()?;
        Channel::check(&wanted.record)?;
        let accuracy = wanted.chosen_accuracy();
        Ok(Self {
            scene,
            run,
            record: wanted.record,
            accuracy,
            accuracy_of: wanted.accuracy_of,
            estimate: true,
            checkpoint_every: None,
        })
    }

    /// The request without trials that nobody asked for: method and step are chosen only where the scene or a setting
    /// names an accuracy.
    #[must_use]
    pub fn with_default_step(self) -> Self {
        Self {
            accuracy: self.scene.run_defaults().accuracy,
            ..self
        }
    }

    /// The request without the estimate of the numerical error at its end.
    #[must_use]
    pub fn without_estimate(self) -> Self {
        Self {
            estimate: false,
            ..self
        }
    }

    /// The request with a checkpoint at the first sample after every so much simulated time: a run that is killed goes
    /// on from the last one. What is simulated stays the same to the last bit.
    ///
    /// # Errors
    /// A text that is no time, or a time that is not positive.
    pub fn with_checkpoints(self, every: &SettingValue) -> Result<Self, RequestError> {
        let name = "checkpoint_every";
        let time = every.time(&self.scene, name)?;
        if !(time > 0.0 && time.is_finite()) {
            return Err(RequestError::Setting(SimulationError::Setting {
                name,
                value: time,
                allowed: "positive",
            }));
        }
        Ok(Self {
            checkpoint_every: Some(time),
            ..self
        })
    }
}
