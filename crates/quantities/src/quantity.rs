//! The quantities of the format, one type each.
//!
//! A value is a number in SI units. The type puts its dimension into the schema of a key: `x-dimension`, `x-unit` and an example.

use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};

/// A kind of quantity.
#[derive(Debug)]
pub struct Dimension {
    /// Name with its article, as messages use it.
    pub name: &'static str,
    /// SI unit.
    pub unit: &'static str,
    /// A value as one would write it.
    pub example: &'static str,
    pub(crate) powers: [f64; 5],
    /// Whether radians count: they tell a speed of rotation from a frequency, but torques and
    /// rotational springs are written with and without.
    pub(crate) strict_angle: bool,
}

impl Dimension {
    /// The dimension called so in the schema.
    pub fn named(name: &str) -> Option<&'static Self> {
        DIMENSIONS.iter().find(|dimension| dimension.name == name)
    }
}

macro_rules! quantities {
    ($($(#[$doc:meta])* $type:ident, $name:literal, $unit:literal, $example:literal, $powers:expr, $strict:literal;)*) => {
        /// Every kind of quantity a scene knows.
        pub(crate) static DIMENSIONS: &[Dimension] = &[$(Dimension {
            name: $name,
            unit: $unit,
            example: $example,
            powers: $powers,
            strict_angle: $strict,
        }),*];
        $(
            $(#[$doc])*
            #[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Serialize)]
            #[serde(transparent)]
            pub struct $type(
                /// The value in SI units.
                pub f64,
            );

            impl From<f64> for $type {
                fn from(value: f64) -> Self {
                    Self(value)
                }
            }

            impl From<$type> for f64 {
                fn from(quantity: $type) -> Self {
                    quantity.0
                }
            }

            impl JsonSchema for $type {
                fn inline_schema() -> bool {
                    true
                }

                fn schema_name() -> Cow<'static, str> {
                    stringify!($type).into()
                }

                fn json_schema(_: &mut SchemaGenerator) -> Schema {
                    json_schema!({
                        "type": ["number", "string"],
                        "x-dimension": $name,
                        "x-unit": $unit,
                        "examples": [$example],
                    })
                }
            }
        )*
    };
}

quantities! {
    /// A length \[m\].
    Length, "a length", "m", "88.9 mm", [1.0, 0.0, 0.0, 0.0, 0.0], true;
    /// A mass \[kg\].
    Mass, "a mass", "kg", "3.01 kg", [0.0, 1.0, 0.0, 0.0, 0.0], true;
    /// A time \[s\].
    Time, "a time", "s", "20 ms", [0.0, 0.0, 1.0, 0.0, 0.0], true;
    /// A plane angle \[rad\].
    Angle, "an angle", "rad", "30 deg", [0.0, 0.0, 0.0, 1.0, 0.0], true;
    /// A pure number \[–\].
    Ratio, "a pure number", "1", "3 %", [0.0; 5], true;
    /// A speed \[m/s\].
    Speed, "a speed", "m/s", "0.05 m/s", [1.0, 0.0, -1.0, 0.0, 0.0], true;
    /// An acceleration \[m/s²\].
    Acceleration, "an acceleration", "m/s^2", "-9.81 m/s^2", [1.0, 0.0, -2.0, 0.0, 0.0], true;
    /// A speed of rotation \[rad/s\].
    AngularSpeed, "an angular speed", "rad/s", "1500 rpm", [0.0, 0.0, -1.0, 1.0, 0.0], true;
    /// A frequency \[Hz\].
    Frequency, "a frequency", "Hz", "95 Hz", [0.0, 0.0, -1.0, 0.0, 0.0], true;
    /// A force \[N\].
    Force, "a force", "N", "15 kN", [1.0, 1.0, -2.0, 0.0, 0.0], true;
    /// A stiffness \[N/m\].
    Stiffness, "a stiffness", "N/m", "815 MN/m", [0.0, 1.0, -2.0, 0.0, 0.0], true;
    /// A damping coefficient \[N s/m\].
    Damping, "a damping", "N s/m", "2.97 kN s/m", [0.0, 1.0, -1.0, 0.0, 0.0], true;
    /// A drag per length \[N s/m²\].
    Drag, "a drag per length", "N s/m^2", "0.5 N s/m^2", [-1.0, 1.0, -1.0, 0.0, 0.0], true;
    /// A moment of inertia \[kg m²\].
    Inertia, "a moment of inertia", "kg m^2", "251 kg m^2", [2.0, 1.0, 0.0, 0.0, 0.0], true;
    /// A torque \[N m\].
    Torque, "a torque", "N m", "5 kN m", [2.0, 1.0, -2.0, 0.0, 0.0], false;
    /// A power \[W\].
    Power, "a power", "W", "15 kW", [2.0, 1.0, -3.0, 0.0, 0.0], false;
    /// A rotational stiffness \[N m/rad\].
    AngularStiffness, "a rotational stiffness", "N m/rad", "40 N m/rad", [2.0, 1.0, -2.0, -1.0, 0.0], false;
    /// A rotational damping \[N m s/rad\].
    AngularDamping, "a rotational damping", "N m s", "2 N m s", [2.0, 1.0, -1.0, -1.0, 0.0], false;
    /// A torque over the square of an angular speed \[N m s²\].
    QuadraticDamping, "a quadratic rotational damping", "N m s^2", "0.1 N m s^2", [2.0, 1.0, 0.0, -2.0, 0.0], false;
    /// A pressure or an elastic modulus \[Pa\].
    Pressure, "a pressure", "Pa", "207 GPa", [-1.0, 1.0, -2.0, 0.0, 0.0], true;
    /// An area \[m²\].
    Area, "an area", "m^2", "1.1 cm^2", [2.0, 0.0, 0.0, 0.0, 0.0], true;
    /// A volume \[m³\].
    Volume, "a volume", "m^3", "4 cm^3", [3.0, 0.0, 0.0, 0.0, 0.0], true;
    /// A dynamic viscosity \[Pa s\].
    Viscosity, "a viscosity", "Pa s", "10 mPa s", [-1.0, 1.0, -1.0, 0.0, 0.0], true;
    /// Relative growth of a viscosity over the pressure \[1/Pa\].
    PressureCoefficient, "a pressure coefficient", "1/Pa", "20 1/GPa", [1.0, -1.0, 2.0, 0.0, 0.0], true;
    /// A kinematic viscosity \[m²/s\].
    KinematicViscosity, "a kinematic viscosity", "m^2/s", "150 mm^2/s", [2.0, 0.0, -1.0, 0.0, 0.0], true;
    /// A density \[kg/m³\].
    Density, "a density", "kg/m^3", "880 kg/m^3", [-3.0, 1.0, 0.0, 0.0, 0.0], true;
    /// A temperature \[K\]; in degrees Celsius it is written with `degC` or `°C`.
    Temperature, "a temperature", "K", "60 degC", [0.0, 0.0, 0.0, 0.0, 1.0], true;
    /// A difference of temperatures \[K\].
    TemperatureDifference, "a temperature difference", "K", "40 K", [0.0, 0.0, 0.0, 0.0, 1.0], true;
    /// A relative expansion over a difference of temperatures \[1/K\].
    ThermalExpansion, "a thermal expansion", "1/K", "11.5e-6 1/K", [0.0, 0.0, 0.0, 0.0, -1.0], true;
    /// The inverse of a length \[1/m\].
    PerLength, "an inverse length", "1/m", "1e5 1/m", [-1.0, 0.0, 0.0, 0.0, 0.0], true;
    /// The inverse of a speed \[s/m\].
    Slowness, "an inverse speed", "s/m", "500 s/m", [-1.0, 0.0, 1.0, 0.0, 0.0], true;
    /// Stiffness of a power law \[N/mⁿ\]; n is the `exponent` beside it.
    ContactStiffness, "a contact stiffness", "N/m^n", "6e11 N/m^1.5", [f64::NAN, 1.0, -2.0, 0.0, 0.0], true;
}
