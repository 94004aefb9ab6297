//! Variables of a drive, as importers see them.

use std::ffi::CString;

/// A quantity of a drive; its value reference is its place in the list.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    /// Name, unique: that of a channel or of a method, and its entry in brackets, such as `span_tension[crank-cam]`.
    pub name: String,
    /// One line.
    pub description: String,
    /// Type, with its value at the start.
    pub kind: Kind,
    /// Direction.
    pub causality: Causality,
    pub(crate) role: Role,
}

/// Type of a variable, with its value at the start.
#[derive(Clone, Debug, PartialEq)]
pub enum Kind {
    /// A number with an SI unit; outputs and the time have no value at the start.
    Real {
        /// Unit, `1` for a ratio.
        unit: String,
        /// Value at the start.
        start: Option<f64>,
    },
    /// One of some choices, counted from 1.
    Choice {
        /// The choices.
        of: &'static Choices,
        /// Value at the start.
        start: i64,
    },
    /// A text.
    Text(CString),
}

/// Direction of a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Causality {
    /// The time.
    Independent,
    /// Set at every communication point.
    Input,
    /// Set before the start or between two steps.
    Tunable,
    /// Read at every communication point.
    Output,
    /// Known since the export.
    Constant,
}

/// An enumeration; its values count from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Choices {
    /// Name of the type.
    pub name: &'static str,
    /// One line.
    pub description: &'static str,
    /// Name and description of every value.
    pub items: &'static [(&'static str, &'static str)],
}

/// Choices of what turns a shaft.
pub(crate) const SHAFT_INPUT: Choices = Choices {
    name: "ShaftInput",
    description: "input that acts on a shaft",
    items: &[
        ("scene", "what the scene says; no input acts"),
        ("torque", "set_torque, beside the torques of the scene"),
        ("speed", "set_speed, by an ideal drive"),
        ("angle", "set_angle, by an ideal drive"),
    ],
};
pub(crate) const SCENE: i64 = 1;
pub(crate) const TORQUE: i64 = 2;
pub(crate) const SPEED: i64 = 3;
pub(crate) const ANGLE: i64 = 4;

/// Choices of how inputs go on between two communication points.
pub(crate) const EXTRAPOLATION: Choices = Choices {
    name: "Extrapolation",
    description: "course of inputs between two communication points",
    items: &[
        ("held", "as they were set"),
        ("linear", "on along the line through the last two values"),
    ],
};
pub(crate) const HELD: i64 = 1;
pub(crate) const LINEAR: i64 = 2;

/// Role of a variable: where its value is read or set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Role {
    Time,
    /// An input or tunable parameter, by its place among the signals.
    Signal(usize),
    /// The choice of a shaft, by its place among the shafts.
    Shaft(usize),
    Extrapolation,
    /// The wall time that a step may take.
    Patience,
    /// An output, by its place among all values that are read.
    Value(usize),
    /// Work of the inputs.
    Work,
    /// What of it has not arrived.
    WorkError,
    Constant,
}

impl Variable {
    /// Unit of a number; none for a ratio and for what is no number.
    pub fn unit(&self) -> Option<&str> {
        match &self.kind {
            Kind::Real { unit, .. } if unit != "1" => Some(unit),
            _ => None,
        }
    }
}
