//! The family of methods.
//!
//! A Runge–Kutta method is one constant in `tableau.rs`; anything else is one file with an
//! `attempt`. Enter it here and in `Kernel`; the compiler asks for the arms.

use serde::{Deserialize, Serialize};

use crate::dense::Interpolation;
use crate::generalized_alpha::GeneralizedAlpha;
use crate::implicit_damping::{self, ImplicitDamping};
use crate::runge_kutta::{self, RungeKutta};
use crate::state::{Size, State};
use crate::tableau::{DORMAND_PRINCE, RK4};
use crate::tolerance::Tolerance;
use crate::verlet::{self, Verlet};
use crate::{IntegrationError, SecondOrderSystem};

/// Share of the stability limit a fixed step may use.
const SAFETY: f64 = 0.9;

/// A method of time stepping with its parameters.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Method {
    /// Velocity Verlet: second order, one evaluation per step.
    Verlet {
        /// Step h \[s\].
        step: f64,
    },
    /// The classical Runge–Kutta method: fourth order, four evaluations per step.
    Rk4 {
        /// Step h \[s\].
        step: f64,
    },
    /// The pair 5(4) of Dormand and Prince: the step follows the estimated error.
    ///
    /// A coordinate, or a first-order state, may err by `absolute + relative |q|` in a step, a velocity by
    /// `absolute_rate + relative |v|`; the worst coordinate decides. Penetrations are small differences of large
    /// coordinates: a relative tolerance of 1e-8 on a metre is 10 nm.
    DormandPrince {
        /// Relative tolerance \[–\].
        relative: f64,
        /// Absolute tolerance of positions, in their unit.
        absolute: f64,
        /// Absolute tolerance of velocities, in their unit.
        absolute_rate: f64,
        /// Largest step \[s\]; with infinite tolerances the method takes this step throughout.
        max_step: f64,
    },
    /// Damping implicit, stiffness explicit or carried as inertia: first order, one evaluation and one solution of linear equations per step.
    ///
    /// For damping far stiffer than the springs. Without damping it is the symplectic Euler method, with the masses that carry stiffness
    /// where the system does that; its energy does not drift.
    ImplicitDamping {
        /// Step h \[s\].
        step: f64,
    },
    /// Generalized-α: implicit, second order, stable with every step on linear problems.
    ///
    /// Two evaluations and solutions of linear equations per step, more for forces that are not linear. A step that
    /// Newton's iteration does not solve is tried again with half the length.
    GeneralizedAlpha {
        /// Step h \[s\].
        step: f64,
        /// Share ρ of its amplitude that a mode with ωh → ∞ keeps per step, 0 to 1 \[–\].
        spectral_radius: f64,
    },
}

/// Work space of a method.
#[derive(Clone, Debug)]
pub(crate) enum Kernel {
    Verlet(Verlet),
    RungeKutta(RungeKutta),
    ImplicitDamping(ImplicitDamping),
    GeneralizedAlpha(GeneralizedAlpha),
}

impl Kernel {
    /// Takes note that the candidate is accepted.
    pub(crate) fn accept(&mut self) {
        if let Self::GeneralizedAlpha(kernel) = self {
            kernel.accept();
        }
    }

    /// Takes note of accelerations that do not follow from the step before.
    pub(crate) fn restart(&mut self, state: &State) {
        if let Self::GeneralizedAlpha(kernel) = self {
            kernel.restart(state);
        }
    }

    /// Goes on from what it carried.
    pub(crate) fn carry_on(&mut self, carried: &[f64]) {
        if let Self::GeneralizedAlpha(kernel) = self {
            kernel.carry_on(carried);
        }
    }

    /// Accelerations and rates that it carries from one step to the next, beside those of the state.
    pub(crate) fn carried(&self) -> &[f64] {
        match self {
            Self::GeneralizedAlpha(kernel) => kernel.carried(),
            Self::Verlet(_) | Self::RungeKutta(_) | Self::ImplicitDamping(_) => &[],
        }
    }

    /// Whether a step begins with the record that the last one left.
    pub(crate) fn needs_record(&self) -> bool {
        matches!(self, Self::ImplicitDamping(_))
    }
}

impl Method {
    /// Name for messages and recordings.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Verlet { .. } => "Verlet",
            Self::Rk4 { .. } => "Runge-Kutta 4",
            Self::DormandPrince { .. } => "Dormand-Prince 5(4)",
            Self::ImplicitDamping { .. } => "implicit damping",
            Self::GeneralizedAlpha { .. } => "generalized alpha",
        }
    }

    /// Order of convergence on smooth problems.
    pub fn order(&self) -> u32 {
        match self {
            Self::ImplicitDamping { .. } => 1,
            Self::Verlet { .. } | Self::GeneralizedAlpha { .. } => 2,
            Self::Rk4 { .. } => RK4.order,
            Self::DormandPrince { .. } => DORMAND_PRINCE.order,
        }
    }

    /// Step \[s\]; under error control the longest.
    pub fn step(&self) -> f64 {
        match *self {
            Self::Verlet { step }
            | Self::Rk4 { step }
            | Self::ImplicitDamping { step }
            | Self::GeneralizedAlpha { step, .. }
            | Self::DormandPrince { max_step: step, .. } => step,
        }
    }

    /// Relative tolerance \[–\] of a method under error control.
    pub fn tolerance(&self) -> Option<f64> {
        self.tolerances().map(|tolerance| tolerance.relative)
    }

    /// Whether the step follows the estimated error.
    pub fn is_adaptive(&self) -> bool {
        self.tolerances().is_some()
    }

    /// Every parameter by its name in recordings, in SI units.
    pub fn parameters(&self) -> Vec<(&'static str, f64)> {
        let Some(tolerance) = self.tolerances() else {
            let mut all = vec![("step", self.step())];
            if let Self::GeneralizedAlpha {
                spectral_radius, ..
            } = *self
            {
                all.push(("spectral_radius", spectral_radius));
            }
            return all;
        };
        vec![
            ("relative_tolerance", tolerance.relative),
            ("absolute_tolerance", tolerance.absolute),
            ("absolute_rate_tolerance", tolerance.absolute_rate),
            ("max_step", self.step()),
        ]
    }

    /// Error that a step may make, where the step follows the error.
    pub(crate) fn tolerances(&self) -> Option<Tolerance> {
        match *self {
            Self::DormandPrince {
                relative,
                absolute,
                absolute_rate,
                ..
            } => Some(Tolerance {
                relative,
                absolute,
                absolute_rate,
            }),
            Self::Verlet { .. }
            | Self::Rk4 { .. }
            | Self::ImplicitDamping { .. }
            | Self::GeneralizedAlpha { .. } => None,
        }
    }

    /// Whether the method needs a system that can [`solve`](SecondOrderSystem::solve).
    pub fn is_implicit(&self) -> bool {
        match self {
            Self::Verlet { .. } | Self::Rk4 { .. } | Self::DormandPrince { .. } => false,
            Self::ImplicitDamping { .. } | Self::GeneralizedAlpha { .. } => true,
        }
    }

    /// The time scale τ \[s\] of a system that limits the steps of this method.
    pub fn time_scale<S: SecondOrderSystem>(&self, system: &S) -> f64 {
        match self {
            Self::Verlet { .. } => system.predicted_time_scale(),
            Self::Rk4 { .. } | Self::DormandPrince { .. } => system.time_scale(),
            Self::ImplicitDamping { .. } => system.carried_time_scale(),
            Self::GeneralizedAlpha { .. } => system.undamped_time_scale(),
        }
    }

    /// Largest stable h/τ of a fixed step, without reserve; none with error control or without a limit.
    pub fn stability_limit(&self) -> Option<f64> {
        match self {
            Self::Verlet { .. } => Some(verlet::LIMIT),
            Self::Rk4 { .. } => Some(runge_kutta::RK4_LIMIT),
            Self::ImplicitDamping { .. } => Some(implicit_damping::LIMIT),
            Self::DormandPrince { .. } | Self::GeneralizedAlpha { .. } => None,
        }
    }

    /// Longest step \[s\] a run accepts at the [time scale](Self::time_scale) τ \[s\]: 0.9 of the stability limit; infinite without one.
    pub fn longest_step(&self, time_scale: f64) -> f64 {
        match self.stability_limit() {
            Some(limit) => SAFETY * limit * time_scale,
            None => f64::INFINITY,
        }
    }

    /// Refuses parameters outside their range.
    ///
    /// # Errors
    /// [`IntegrationError::Parameter`] names the first one.
    pub fn check(&self) -> Result<(), IntegrationError> {
        let fixed = |step: f64| {
            let allowed = step > 0.0 && step.is_finite();
            require(allowed, "step", step, "positive [s]")
        };
        match *self {
            Self::Verlet { step } | Self::Rk4 { step } | Self::ImplicitDamping { step } => {
                fixed(step)
            }
            Self::GeneralizedAlpha {
                step,
                spectral_radius: radius,
            } => {
                fixed(step)?;
                let allowed = (0.0..=1.0).contains(&radius);
                require(allowed, "spectral_radius", radius, "between 0 and 1")
            }
            Self::DormandPrince {
                relative,
                absolute,
                absolute_rate,
                max_step,
            } => {
                require(relative >= 0.0, "relative", relative, "zero or positive")?;
                require(absolute > 0.0, "absolute", absolute, "positive")?;
                let rate = absolute_rate;
                require(rate > 0.0, "absolute_rate", rate, "positive")?;
                let allowed = max_step > 0.0 && max_step.is_finite();
                require(allowed, "max_step", max_step, "positive [s]")
            }
        }
    }

    /// Every explicit method, for tests; all take steps of about the same length \[s\].
    pub fn specimens(step: f64) -> [Self; 3] {
        [
            Self::Verlet { step },
            Self::Rk4 { step },
            Self::DormandPrince {
                relative: 1e-9,
                absolute: 1e-9,
                absolute_rate: 1e-9,
                max_step: step,
            },
        ]
    }

    /// Every implicit method, for tests; all take steps of the same length \[s\].
    pub fn implicit_specimens(step: f64) -> [Self; 2] {
        [
            Self::ImplicitDamping { step },
            Self::GeneralizedAlpha {
                step,
                spectral_radius: 0.8,
            },
        ]
    }

    /// Interpolation between the states that it accepts.
    pub(crate) fn interpolation(&self) -> Interpolation {
        match self {
            Self::Verlet { .. } | Self::Rk4 { .. } | Self::DormandPrince { .. } => {
                Interpolation::Quintic
            }
            Self::ImplicitDamping { .. } => Interpolation::Linear,
            Self::GeneralizedAlpha { .. } => Interpolation::Cubic,
        }
    }

    /// Work space for a system of this size.
    pub(crate) fn kernel(&self, size: Size) -> Kernel {
        match self {
            Self::Verlet { .. } => Kernel::Verlet(Verlet::new(size)),
            Self::Rk4 { .. } => Kernel::RungeKutta(RungeKutta::new(&RK4, size)),
            Self::DormandPrince { .. } => {
                Kernel::RungeKutta(RungeKutta::new(&DORMAND_PRINCE, size))
            }
            Self::ImplicitDamping { .. } => Kernel::ImplicitDamping(ImplicitDamping::new(size)),
            Self::GeneralizedAlpha {
                spectral_radius, ..
            } => Kernel::GeneralizedAlpha(GeneralizedAlpha::new(*spectral_radius, size)),
        }
    }
}

/// Lets a parameter pass or names it.
fn require(
    condition: bool,
    parameter: &'static str,
    value: f64,
    allowed: &'static str,
) -> Result<(), IntegrationError> {
    if condition {
        Ok(())
    } else {
        Err(IntegrationError::Parameter {
            parameter,
            value,
            allowed,
        })
    }
}
