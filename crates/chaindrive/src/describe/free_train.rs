//! Shafts that no motion turns: what their torques do to them.

use std::f64::consts::TAU;
use std::fmt;

use chaindrive_mechanics::{Assembled, FreeTrain};
use schemars::JsonSchema;
use serde::Serialize;

use crate::figure::{Measure, figure};

/// Shafts that chains, gears and couplings join and no motion turns, at the start.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct FreeTrainFacts {
    /// Names of its shafts, or of the only sprockets on them.
    pub shafts: Vec<String>,
    /// Speed of the first one \[rad/s\].
    pub speed: f64,
    /// Sum of all torques at that speed, as one on the first shaft \[N m\].
    pub torque: f64,
    /// Acceleration of the first shaft \[rad/s²\], the mass of the chains left aside.
    pub acceleration: f64,
    /// Speed of the first one at which the torques balance \[rad/s\]; absent where they never do.
    pub working_point: Option<f64>,
}

/// The trains of a drive that torques turn.
pub(super) fn of(assembled: &Assembled) -> Vec<FreeTrainFacts> {
    let parts = assembled.drive.parts();
    let is_turned = |train: &FreeTrain| {
        let mut shafts = train.shafts.iter();
        shafts.any(|(index, _)| parts.shafts[*index].is_turned())
    };
    let trains = assembled.free_trains().into_iter().filter(is_turned);
    let facts = |train: FreeTrain| FreeTrainFacts {
        acceleration: train.acceleration(),
        shafts: train.names(parts),
        speed: train.speed,
        torque: train.torque,
        working_point: train.working_point,
    };
    trains.map(facts).collect()
}

impl fmt::Display for FreeTrainFacts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rpm = |speed: f64| speed * 60.0 / TAU;
        let first = &self.shafts[0];
        write!(f, "{}: ", self.shafts.join(", "))?;
        if self.speed == 0.0 {
            write!(f, "at rest")?;
        } else {
            write!(f, "{first} at {:.2} rpm", rpm(self.speed))?;
        }
        let balances = self
            .working_point
            .is_some_and(|it| (it - self.speed).abs() <= 1e-6 * it.abs());
        if balances {
            return write!(f, ", where the torques balance");
        }
        write!(
            f,
            ", torques of {} on {first} speed it up by {} rad/s²; ",
            Measure::Torque.told(self.torque),
            figure(self.acceleration)
        )?;
        match self.working_point {
            Some(speed) => write!(
                f,
                "they balance at {:.2} rpm: to start there, give {first}.speed = \"working-point\"",
                rpm(speed)
            ),
            None => write!(f, "they balance at no speed"),
        }
    }
}
