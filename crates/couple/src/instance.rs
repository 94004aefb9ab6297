//! One drive among others: phases, values, steps, saved states.

mod step;

use std::ffi::CStr;
use std::sync::Arc;

use chaindrive::{SealError, SealedValue, Simulation, Snapshot, View, opened, sealed};
use serde::{Deserialize, Serialize};

use crate::fault::Fault;
use crate::model::Model;
use crate::signal::{InputState, Signal};
use crate::variable::{Causality, EXTRAPOLATION, HELD, Kind, Role, SCENE, SHAFT_INPUT, Variable};

/// Phases of an instance, as the standard has them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Phase {
    /// Values at the start may be set.
    Instantiated,
    /// Between the start of the initialization and its end.
    Initialization,
    /// From one communication point to the next.
    Stepping,
    /// At its end.
    Terminated,
    /// Its motion cannot go on.
    Failed,
}

/// A drive that an importer moves.
///
/// # Example
///
/// ```
/// use std::sync::Arc;
/// use chaindrive::{Request, Scene, Settings};
/// use chaindrive_couple::{Export, Instance, Model};
///
/// let scene = Scene::preset("marine_two_sprockets")?;
/// let request = Request::new(&scene, &Settings::default())?;
/// let model = Arc::new(Model::new(Export::new(&request, "drive"))?);
/// let torque = model.reference("set_torque[camshaft]").unwrap();
/// let speed = model.reference("sprocket_speed[camshaft]").unwrap();
/// let mut drive = Instance::new(model);
/// drive.enter_initialization(0.0)?;
/// drive.exit_initialization()?;
/// let before = drive.real(speed)?;
/// drive.set_real(torque, 2e5)?;
/// drive.step(0.0, 1e-3)?;
/// assert!(drive.real(speed)? > before + 0.1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Instance {
    model: Arc<Model>,
    simulation: Simulation,
    view: View,
    /// Values that were read last, and whether they are those of the present.
    values: Vec<f64>,
    fresh: bool,
    at: InstanceState,
}

/// An instance as it was at a communication point: read back by the build that wrote it alone.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SavedInstance {
    token: String,
    snapshot: Snapshot,
    at: InstanceState,
}

/// All that an instance knows beside its drive.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct InstanceState {
    phase: Phase,
    /// Time of the importer at the start of the drive \[s\].
    begin: f64,
    /// Communication point \[s\], and the step that ended there.
    time: f64,
    step: f64,
    signals: Vec<InputState>,
    shafts: Vec<i64>,
    extrapolation: i64,
    /// Work of the inputs before the last step, and what of all work has not arrived \[J\].
    work: f64,
    error: f64,
    /// Wall time that a step may take \[s\]; zero: any.
    patience: f64,
    /// Energy missing that was told last \[J\].
    told: f64,
}

impl SealedValue for SavedInstance {
    const KIND: &'static str = "state of a unit";
}

impl SavedInstance {
    /// The state as bytes.
    pub fn to_bytes(&self) -> Vec<u8> {
        sealed(self)
    }

    /// The state that was written down.
    ///
    /// # Errors
    /// [`SealError`]: something else, damaged, or of another build.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, SealError> {
        opened(bytes)
    }
}

impl Instance {
    /// A drive before its start.
    ///
    /// # Panics
    /// Never: the channels of the ports are those of the drive.
    pub fn new(model: Arc<Model>) -> Self {
        let mut simulation = model.begin.clone();
        let view = simulation.view(&model.ports.channels);
        let view = view.expect("the ports have channels of this drive");
        let signals = model.ports.signals.iter();
        let at = InstanceState {
            phase: Phase::Instantiated,
            begin: 0.0,
            time: 0.0,
            step: 0.0,
            signals: signals
                .map(|signal| InputState::new(signal.start))
                .collect(),
            shafts: model.ports.shafts.clone(),
            extrapolation: HELD,
            work: 0.0,
            error: 0.0,
            patience: 0.0,
            told: 0.0,
        };
        Self {
            model,
            simulation,
            view,
            values: Vec::new(),
            fresh: false,
            at,
        }
    }

    /// Its model.
    pub fn model(&self) -> &Arc<Model> {
        &self.model
    }

    /// Its phase.
    pub fn phase(&self) -> Phase {
        self.at.phase
    }

    /// Communication point \[s\].
    pub fn time(&self) -> f64 {
        self.at.time
    }

    /// Value of a number.
    ///
    /// # Errors
    /// [`Fault`]: no variable has this reference, or it is no number.
    pub fn real(&mut self, reference: u32) -> Result<f64, Fault> {
        let variable = self.variable(reference)?;
        let Kind::Real { start, .. } = variable.kind else {
            return Err(mistaken(variable, "no number"));
        };
        Ok(match variable.role {
            Role::Time => self.at.time,
            Role::Signal(index) => self.at.signals[index].value,
            Role::Value(index) => {
                self.refresh();
                self.values[index]
            }
            Role::Work => {
                self.refresh();
                self.at.work + self.work_of_the_last_step()
            }
            Role::Patience => self.at.patience,
            Role::WorkError => self.at.error,
            Role::Shaft(_) | Role::Extrapolation | Role::Constant => start.unwrap_or(f64::NAN),
        })
    }

    /// Value of a choice.
    ///
    /// # Errors
    /// [`Fault`]: no variable has this reference, or it is no choice.
    pub fn choice(&self, reference: u32) -> Result<i64, Fault> {
        let variable = self.variable(reference)?;
        match variable.role {
            Role::Shaft(index) => Ok(self.at.shafts[index]),
            Role::Extrapolation => Ok(self.at.extrapolation),
            _ => Err(mistaken(variable, "no enumeration")),
        }
    }

    /// A text.
    ///
    /// # Errors
    /// [`Fault`]: no variable has this reference, or it is no text.
    pub fn text(&self, reference: u32) -> Result<&CStr, Fault> {
        match &self.variable(reference)?.kind {
            Kind::Text(text) => Ok(text),
            _ => Err(mistaken(self.variable(reference)?, "no text")),
        }
    }

    /// Sets an input or a tunable parameter, from the present communication point on.
    ///
    /// # Errors
    /// [`Fault`]: no such input, a value that is not finite, or not the time for it.
    pub fn set_real(&mut self, reference: u32, value: f64) -> Result<(), Fault> {
        if self.variable(reference)?.role == Role::Patience {
            self.may_set()?;
            if !(value >= 0.0 && value.is_finite()) {
                let refused = format!("step_patience: {value} s: it must be zero or positive");
                return Err(Fault::new(refused));
            }
            self.at.patience = value;
            return Ok(());
        }
        let signal = self.signal(reference)?;
        if !value.is_finite() {
            let name = &self.variable(reference)?.name;
            return Err(Fault::new(format!(
                "{name}: {value} is not finite; the value before it stays"
            )));
        }
        self.at.signals[signal].value = value;
        Ok(())
    }

    /// Gives the slope of an input in the next step, whatever the extrapolation is.
    ///
    /// # Errors
    /// As [`set_real`](Self::set_real).
    pub fn set_slope(&mut self, reference: u32, slope: f64) -> Result<(), Fault> {
        let signal = self.signal(reference)?;
        if !slope.is_finite() {
            let name = &self.variable(reference)?.name;
            return Err(Fault::new(format!(
                "{name}: its slope {slope} is not finite"
            )));
        }
        self.at.signals[signal].slope = Some(slope);
        Ok(())
    }

    /// Sets a choice, from the present communication point on.
    ///
    /// # Errors
    /// [`Fault`]: no such parameter, no such choice, or not the time for it.
    pub fn set_choice(&mut self, reference: u32, value: i64) -> Result<(), Fault> {
        self.may_set()?;
        let variable = self.variable(reference)?;
        let (name, role) = (variable.name.clone(), variable.role);
        let of = match role {
            Role::Shaft(_) => SHAFT_INPUT,
            Role::Extrapolation => EXTRAPOLATION,
            _ => return Err(mistaken(variable, "no enumeration that is set")),
        };
        let place = usize::try_from(value).ok().and_then(|it| it.checked_sub(1));
        let Some((chosen, _)) = place.and_then(|place| of.items.get(place)) else {
            let items = of.items.iter().enumerate();
            let known: Vec<_> = items
                .map(|(i, (item, _))| format!("{} {item}", i + 1))
                .collect();
            return Err(Fault::new(format!(
                "{name}: {value} is none of {}",
                known.join(", ")
            )));
        };
        match role {
            Role::Shaft(index) if self.at.shafts[index] != value => {
                if value == SCENE && self.at.phase == Phase::Stepping {
                    let what = "what the scene says does not come back once the drive moves";
                    return Err(Fault::new(format!(
                        "{name}: {chosen}: {what}; set torque, speed or angle"
                    )));
                }
                self.at.shafts[index] = value;
                let own = |signal: &Signal| signal.shaft == Some((index, value));
                for (signal, held) in self.model.ports.signals.iter().zip(&mut self.at.signals) {
                    if own(signal) {
                        held.begin();
                    }
                }
            }
            Role::Extrapolation => self.at.extrapolation = value,
            _ => {}
        }
        Ok(())
    }

    /// Says at which time of the importer \[s\] the drive starts.
    ///
    /// # Errors
    /// [`Fault`]: not the time for it, or no time.
    pub fn start_at(&mut self, start: f64) -> Result<(), Fault> {
        self.require(
            &[Phase::Instantiated],
            "the initialization begins once, after the instantiation",
        )?;
        if !start.is_finite() {
            return Err(Fault::new(format!("the start time {start} is not finite")));
        }
        self.at.begin = start;
        self.at.time = start;
        Ok(())
    }

    /// Begins the initialization, at a time of the importer \[s\].
    ///
    /// # Errors
    /// [`Fault`]: not the time for it, or no time.
    pub fn enter_initialization(&mut self, start: f64) -> Result<(), Fault> {
        self.start_at(start)?;
        self.at.phase = Phase::Initialization;
        Ok(())
    }

    /// Ends the initialization.
    ///
    /// # Errors
    /// [`Fault`]: not the time for it.
    pub fn exit_initialization(&mut self) -> Result<(), Fault> {
        self.require(&[Phase::Initialization], "enter the initialization first")?;
        self.at.phase = Phase::Stepping;
        Ok(())
    }

    /// Ends the simulation; its values can still be read.
    ///
    /// # Errors
    /// [`Fault`]: not the time for it.
    pub fn terminate(&mut self) -> Result<(), Fault> {
        self.require(&[Phase::Stepping], "it ends once, after the initialization")?;
        self.at.phase = Phase::Terminated;
        Ok(())
    }

    /// Goes back to where it was instantiated, values included.
    pub fn reset(&mut self) {
        *self = Self::new(Arc::clone(&self.model));
    }

    /// The instance as it is.
    ///
    /// # Errors
    /// [`Fault`]: its motion has failed.
    pub fn save(&self) -> Result<SavedInstance, Fault> {
        if self.at.phase == Phase::Failed {
            return Err(Fault::new(
                "its motion has failed: there is no state to keep; reset it, or set an earlier one",
            ));
        }
        Ok(SavedInstance {
            token: self.model.token().to_owned(),
            snapshot: self.simulation.snapshot(),
            at: self.at.clone(),
        })
    }

    /// Goes back, or on, to a saved state.
    ///
    /// # Errors
    /// [`Fault`]: it is of another unit. Nothing is changed then.
    pub fn restore(&mut self, saved: &SavedInstance) -> Result<(), Fault> {
        if saved.token != self.model.token() || saved.at.signals.len() != self.at.signals.len() {
            return Err(Fault::new("the state is of another unit"));
        }
        let restored = self.simulation.restore(&saved.snapshot);
        restored.map_err(|error| Fault::new(error.to_string()))?;
        self.at = saved.at.clone();
        self.fresh = false;
        Ok(())
    }

    /// Reads all channels at the communication point.
    fn refresh(&mut self) {
        if self.fresh {
            return;
        }
        self.simulation.read_into(&mut self.view);
        self.values.clear();
        for channel in 0..self.view.channels().len() {
            self.values.extend(self.view.values(channel));
        }
        self.fresh = true;
    }

    fn variable(&self, reference: u32) -> Result<&Variable, Fault> {
        let variables = self.model.variables();
        let found = usize::try_from(reference)
            .ok()
            .and_then(|it| variables.get(it));
        found.ok_or_else(|| {
            let count = variables.len();
            Fault::new(format!(
                "no variable has the value reference {reference}; there are {count}, from 0 on"
            ))
        })
    }

    /// The input or parameter of a reference, if it may be set now.
    fn signal(&self, reference: u32) -> Result<usize, Fault> {
        self.may_set()?;
        let variable = self.variable(reference)?;
        match (variable.role, variable.causality) {
            (Role::Signal(index), _) => Ok(index),
            (_, Causality::Output) => Err(mistaken(variable, "an output, which is only read")),
            (_, Causality::Constant) => Err(mistaken(variable, "a constant, which is only read")),
            _ => Err(mistaken(variable, "no number that is set")),
        }
    }

    fn may_set(&self) -> Result<(), Fault> {
        let phases = [Phase::Instantiated, Phase::Initialization, Phase::Stepping];
        self.require(&phases, "nothing is set any more; reset the instance")
    }

    fn require(&self, phases: &[Phase], hint: &str) -> Result<(), Fault> {
        let phase = self.at.phase;
        if phases.contains(&phase) {
            return Ok(());
        }
        let is = match phase {
            Phase::Instantiated => "instantiated, and not yet initialized",
            Phase::Initialization => "being initialized",
            Phase::Stepping => "initialized",
            Phase::Terminated => "terminated",
            Phase::Failed => "failed: its motion cannot go on",
        };
        Err(Fault::new(format!("the instance is {is}: {hint}")))
    }
}

fn mistaken(variable: &Variable, what: &str) -> Fault {
    Fault::new(format!("{} is {what}", variable.name))
}
