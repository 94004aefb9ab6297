//! Why a run cannot begin or go on.

use std::fmt;

use crate::InstructionSetError;

/// The quantity that is not finite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StateQuantity {
    /// A position.
    Position,
    /// A velocity.
    Velocity,
    /// An acceleration.
    Acceleration,
    /// A first-order state.
    State,
    /// A quantity integrated along with the motion, or its rate.
    Quadrature,
}

impl fmt::Display for StateQuantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Position => "position",
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
            Self::State => "first-order state",
            Self::Quadrature => "quadrature",
        })
    }
}

/// Why a run cannot begin or go on. The state is then the last accepted one.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "each message names its fields")]
pub enum IntegrationError {
    /// A parameter of the method is outside its range.
    #[error("{parameter} = {value}, must be {allowed}")]
    Parameter {
        parameter: &'static str,
        value: f64,
        allowed: &'static str,
    },

    /// The environment asks for an instruction set that cannot be used.
    #[error(transparent)]
    InstructionSet(#[from] &'static InstructionSetError),

    /// The state does not have the shape the system expects.
    #[error("the state has {found} {what}, the system {expected}")]
    Shape {
        what: &'static str,
        found: usize,
        expected: usize,
    },

    /// A memory of another method.
    #[error("the stepper goes by {expected}, and what it is to remember is of {found}")]
    OtherMethod {
        expected: &'static str,
        found: &'static str,
    },

    /// An implicit method for a system without [`solve`](crate::SecondOrderSystem::solve).
    #[error(
        "{method} is an implicit method, and this system does not solve the equations of an implicit \
         step; choose Verlet, Runge-Kutta 4 or Dormand-Prince 5(4)"
    )]
    Unsupported { method: &'static str },

    /// A fixed step that would be unstable from the start.
    #[error("a step of {step:.3e} s is unstable with {method}; choose at most {limit:.3e} s")]
    StepTooLarge {
        step: f64,
        limit: f64,
        method: &'static str,
    },

    /// Stability, accuracy or Newton's iteration asks for steps that lead nowhere.
    #[error(
        "at t = {t} s the step fell to {step:.3e} s; the forces are too stiff or discontinuous, \
         or the tolerances too tight"
    )]
    StepUnderflow { t: f64, step: f64 },

    /// An evaluation or a step produced infinity or NaN.
    #[error("at t = {t} s the {quantity} of degree of freedom {dof} is not finite")]
    NotFinite {
        t: f64,
        dof: usize,
        quantity: StateQuantity,
    },
}
