//! The methods of time stepping: their names, and the steps they take where none is given.

use chaindrive_integrate::{Method, SecondOrderSystem};
use chaindrive_mechanics::System;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A method of time stepping.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(rename = "Method")]
pub enum Stepping {
    /// The method that suits the chain: implicit damping for rigid links, Verlet for particles.
    #[default]
    Auto,
    /// Velocity Verlet, fixed step: fast and without energy drift.
    Verlet,
    /// The classical Runge–Kutta method of order 4, fixed step.
    Rk4,
    /// The Dormand–Prince pair of order 5(4), step under error control.
    DormandPrince,
    /// Damping implicit, stiffness explicit or carried as inertia, order 1, fixed step; for rigid links and free rollers.
    ImplicitDamping,
    /// The implicit generalized-α method of order 2, fixed step; for rigid links and free rollers.
    GeneralizedAlpha,
}

/// Default steps in units of 1/ω of the stiffest mode. Verlet is stable to 2; contacts stiffen
/// as they are pressed, and accuracy asks for a quarter of that anyway.
const VERLET_STEP: f64 = 0.5;
const RK4_STEP: f64 = 0.25;

/// The same without the damping: implicit damping has Verlet's limit on springs, and none on dampers. The bicycle drive errs by 0.02 %
/// in its tight span at this step of 2.3 µs; stopped within 0.1 ms, with 5 kN on its joints, it blows up at 4 µs and does not at 3.5. Where a
/// step carries stiffness it may be several times as long, which is for the automatic choice to try: impacts may be shorter.
const IMPLICIT_DAMPING_STEP: f64 = 0.8;

/// Longest step of Dormand–Prince in units of 1/ω of the stiffest mode at the start: error control alone has not been
/// seen to take more than 11 (bicycle drive), and longer ones run over contacts before it notices them.
const DORMAND_PRINCE_STEP: f64 = 16.0;

/// Generalized-α has no limit, but contacts open and close: at twice Verlet's step the stiffest mode is still followed.
const GENERALIZED_ALPHA_STEP: f64 = 1.0;

/// Share of its amplitude that a mode far beyond the step keeps per step. At 0.8 a hundredth is left after twenty
/// steps, while a mode with ωh = 1 loses 5e-4 of its amplitude per step and one with ωh = 0.1 loses 7e-8.
const SPECTRAL_RADIUS: f64 = 0.8;

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

    /// The method of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|method| method.name() == name)
    }

    /// The method for a system: itself, or what [`Stepping::Auto`] chooses.
    #[must_use]
    pub fn suited(self, system: &System) -> Self {
        match self {
            Self::Auto if system.prefers_implicit_damping() => Self::ImplicitDamping,
            Self::Auto => Self::Verlet,
            chosen => chosen,
        }
    }

    /// Whether it needs a chain that solves the equations of an implicit step, whatever the drive.
    pub fn is_implicit(self) -> bool {
        matches!(self, Self::ImplicitDamping | Self::GeneralizedAlpha)
    }

    /// Whether its step follows the estimated error: it has a tolerance, and its step is the longest it may take.
    pub fn is_adaptive(self) -> bool {
        matches!(self, Self::DormandPrince)
    }

    /// The time scale \[s\] of a system that limits the steps of the method.
    pub(crate) fn time_scale(self, system: &System) -> f64 {
        match self.suited(system) {
            Self::Auto | Self::Verlet => system.predicted_time_scale(),
            Self::Rk4 | Self::DormandPrince => system.time_scale(),
            Self::ImplicitDamping => system.carried_time_scale(),
            Self::GeneralizedAlpha => system.undamped_time_scale(),
        }
    }

    /// The method with its parameters for a system: a step \[s\], by default one that suits the system, and the relative
    /// tolerance of a method that has one.
    pub fn method(self, system: &System, given: Option<f64>, tolerance: f64) -> Method {
        let stepping = self.suited(system);
        let scale = stepping.time_scale(system);
        // What is recorded has no say in it: samples are interpolated.
        let step = |factor: f64| given.unwrap_or(factor * scale);
        match stepping {
            Self::Auto | Self::Verlet => Method::Verlet {
                step: step(VERLET_STEP),
            },
            Self::Rk4 => Method::Rk4 {
                step: step(RK4_STEP),
            },
            Self::DormandPrince => Method::DormandPrince {
                relative: tolerance,
                // At 1e-8: ten nanometres of a metre, 10 µm/s.
                absolute: tolerance,
                absolute_rate: tolerance * 1e3,
                max_step: step(DORMAND_PRINCE_STEP),
            },
            Self::ImplicitDamping => Method::ImplicitDamping {
                step: given.unwrap_or(IMPLICIT_DAMPING_STEP * system.undamped_time_scale()),
            },
            Self::GeneralizedAlpha => Method::GeneralizedAlpha {
                step: step(GENERALIZED_ALPHA_STEP),
                spectral_radius: SPECTRAL_RADIUS,
            },
        }
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
