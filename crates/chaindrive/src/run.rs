//! What to run: how long, how often to sample, by which method.

mod checkpoint;
pub(crate) mod execute;
mod patience;
mod request;
mod settings;

use chaindrive_integrate::{Method, SecondOrderSystem};
use chaindrive_mechanics::{EventKinds, System};
use serde::{Deserialize, Serialize};

use crate::SimulationError;
use crate::scene::RunDefaults;

pub use checkpoint::Checkpoint;
pub(crate) use execute::resume;
pub use execute::{End, Onlooker, Report, RunError, Sink, Stop, assemble, execute};
pub use patience::patiently;
pub use request::{Request, RequestError};
pub use settings::{Given, Settings};

/// Settings of one run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// End \[s\], positive.
    pub until: f64,
    /// Interval between samples \[s\], positive.
    pub every: f64,
    /// Method of time stepping.
    pub stepping: Stepping,
    /// Step \[s\] of the fixed-step methods; chosen from the stiffest mode when absent.
    pub step: Option<f64>,
    /// Relative tolerance of the adaptive method.
    pub tolerance: f64,
    /// Deepest penetration at which a contact may begin \[m\]; deeper steps are rejected and
    /// shortened. Absent: contacts begin wherever the step lands, but with implicit damping no deeper than
    /// an approach at 1 m/s takes them in a step.
    pub onset_depth: Option<f64>,
    /// Contacts to log; none cost nothing.
    pub events: EventKinds,
}

impl Default for Run {
    fn default() -> Self {
        Self {
            until: 1.0,
            every: 1e-3,
            stepping: Stepping::Auto,
            step: None,
            tolerance: 1e-8,
            onset_depth: None,
            events: EventKinds::default(),
        }
    }
}

/// Methods of time stepping.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Stepping {
    /// What suits the drive: implicit damping for those that solve the equations of an implicit step,
    /// else Verlet.
    #[default]
    Auto,
    /// Velocity Verlet: one evaluation a step, no drift; the workhorse.
    Verlet,
    /// The classical Runge–Kutta method: for reference runs on smooth stretches.
    Rk4,
    /// Dormand and Prince's embedded pair with error control.
    DormandPrince,
    /// Damping implicit, stiffness explicit: for damping far stiffer than the springs.
    ImplicitDamping,
    /// Generalized-α: implicit, stable with every step.
    GeneralizedAlpha,
}

impl Stepping {
    /// All methods.
    pub const ALL: [Self; 6] = [
        Self::Auto,
        Self::Verlet,
        Self::Rk4,
        Self::DormandPrince,
        Self::ImplicitDamping,
        Self::GeneralizedAlpha,
    ];

    /// Name in scene files, on the command line and in results.
    pub fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Verlet => "verlet",
            Self::Rk4 => "rk4",
            Self::DormandPrince => "dormand-prince",
            Self::ImplicitDamping => "implicit-damping",
            Self::GeneralizedAlpha => "generalized-alpha",
        }
    }

    /// The method for a system: itself, or what [`Stepping::Auto`] chooses.
    #[must_use]
    pub fn suited(self, system: &System) -> Self {
        match self {
            Self::Auto if system.can_solve() => Self::ImplicitDamping,
            Self::Auto => Self::Verlet,
            chosen => chosen,
        }
    }

    /// Whether it needs a chain that solves the equations of an implicit step, whatever the drive.
    pub fn is_implicit(self) -> bool {
        match self {
            Self::Auto | Self::Verlet | Self::Rk4 | Self::DormandPrince => false,
            Self::ImplicitDamping | Self::GeneralizedAlpha => true,
        }
    }

    /// The method of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|method| method.name() == name)
    }
}

impl From<Method> for Stepping {
    fn from(method: Method) -> Self {
        match method {
            Method::Verlet { .. } => Self::Verlet,
            Method::Rk4 { .. } => Self::Rk4,
            Method::DormandPrince { .. } => Self::DormandPrince,
            Method::ImplicitDamping { .. } => Self::ImplicitDamping,
            Method::GeneralizedAlpha { .. } => Self::GeneralizedAlpha,
        }
    }
}

/// Steps of a run at most: at a microsecond each they would take eleven days.
const MOST_STEPS: f64 = 1e12;

/// Default steps in units of 1/ω of the stiffest mode. Verlet is stable to 2; contacts stiffen
/// as they are pressed, and accuracy asks for a quarter of that anyway.
const VERLET_STEP: f64 = 0.5;
const RK4_STEP: f64 = 0.25;

/// The same without the damping: implicit damping has Verlet's limit on the springs, and none on the
/// dampers. The bicycle drive errs by 0.04 % in its tight span at this step.
const IMPLICIT_DAMPING_STEP: f64 = 1.4;

/// Speed of approach \[m/s\] up to which a contact may begin wherever a step of implicit damping lands.
///
/// A pin strikes its bush for three microseconds, hardly longer than a step. What it has gained in depth when it is
/// first seen inside is energy from nowhere; at the speeds of heavy impacts that feeds itself. The bicycle drive with a
/// slack chain at 100 rad/s overflows without this, and closes its ledger to 2 % with it, at the same cost.
const ONSET_SPEED: f64 = 1.0;

/// Longest step of Dormand–Prince in units of 1/ω of the stiffest mode at the start: error control alone has not been
/// seen to take more than 11 (bicycle drive), and longer ones run over contacts before it notices them.
const DORMAND_PRINCE_STEP: f64 = 16.0;

/// Generalized-α has no limit, but contacts open and close: at twice Verlet's step the stiffest mode is still followed.
const GENERALIZED_ALPHA_STEP: f64 = 1.0;

/// Share of its amplitude that a mode far beyond the step keeps per step. At 0.8 a hundredth is left after twenty
/// steps, while a mode with ωh = 1 loses 5e-4 of its amplitude per step and one with ωh = 0.1 loses 7e-8.
const SPECTRAL_RADIUS: f64 = 0.8;

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
            every: by.every.unwrap_or(default.every),
            stepping: by.method.and_then(Stepping::from_name).unwrap_or_default(),
            step: by.step,
            tolerance: by.tolerance.unwrap_or(default.tolerance),
            onset_depth: by.onset_depth,
            events: by.events,
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

    /// Deepest penetration at which a contact may begin \[m\], if there is a limit.
    pub fn onset_depth_with(&self, method: &Method) -> Option<f64> {
        match method {
            Method::ImplicitDamping { step } => self.onset_depth.or(Some(ONSET_SPEED * step)),
            _ => self.onset_depth,
        }
    }

    /// The method for a system, with a default step where none is given.
    pub fn method(&self, system: &System) -> Method {
        let stepping = self.stepping.suited(system);
        let scale = if stepping.is_implicit() {
            system.undamped_time_scale()
        } else {
            system.time_scale()
        };
        // What is recorded has no say in it: samples are interpolated.
        let step = |factor: f64| self.step.unwrap_or(factor * scale);
        match stepping {
            Stepping::Auto | Stepping::Verlet => Method::Verlet {
                step: step(VERLET_STEP),
            },
            Stepping::Rk4 => Method::Rk4 {
                step: step(RK4_STEP),
            },
            Stepping::DormandPrince => Method::DormandPrince {
                relative: self.tolerance,
                // At 1e-8: ten nanometres of a metre, 10 µm/s.
                absolute: self.tolerance,
                absolute_rate: self.tolerance * 1e3,
                max_step: step(DORMAND_PRINCE_STEP),
            },
            Stepping::ImplicitDamping => Method::ImplicitDamping {
                step: step(IMPLICIT_DAMPING_STEP),
            },
            Stepping::GeneralizedAlpha => Method::GeneralizedAlpha {
                step: step(GENERALIZED_ALPHA_STEP),
                spectral_radius: SPECTRAL_RADIUS,
            },
        }
    }
}
