//! Motions of sprockets that cannot both be on one chain.

use std::f64::consts::TAU;
use std::fmt;

use crate::drive::{Drive, Rotation, Stop};
use crate::trains::trains;
use crate::{Layout, Motion};

/// Two sprockets of one chain whose motions are given and take it different ways.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionConflict {
    /// The sprockets.
    pub sprockets: [String; 2],
    /// Teeth of chain that the first moves on more than the second \[–\].
    pub teeth: f64,
}

impl fmt::Display for MotionConflict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [first, second] = &self.sprockets;
        write!(
            f,
            "the motions of `{first}` and `{second}` fight, {:.1} teeth of chain apart in the end: give one of them a load, or speeds in the ratio of the teeth",
            self.teeth.abs()
        )
    }
}

/// Teeth of chain by which motions may be apart: springs and slack take up less than that, and a chain skips for more.
const APART: f64 = 1.0;

impl Drive {
    /// Sprockets of one chain whose motions, those by gears included, take it more than a tooth apart from one time to another \[s\].
    ///
    /// ```text
    /// n = ± z (θ(t₁) − θ(t₀))/2π       teeth of chain that a sprocket moves on
    /// ```
    pub fn fights(&self, from: f64, to: f64) -> Vec<MotionConflict> {
        let trains = trains(&self.parts);
        let turned = |motion: &Motion| motion.at(to).position - motion.at(from).position;
        let passed = |index: usize| {
            let sprocket = &self.sprockets[index];
            let train = trains[sprocket.shaft];
            match &self.shafts[train.leader].rotation {
                Rotation::Free { .. } => None,
                Rotation::Prescribed(motion) => {
                    let teeth = f64::from(sprocket.gap.teeth) * sprocket.side.sense();
                    Some(teeth * train.ratio * turned(motion) / TAU)
                }
            }
        };
        let mut found = Vec::new();
        for placed in &self.chains {
            let Layout::Route { stops, .. } = &placed.layout else {
                continue;
            };
            let mut given = stops.iter().filter_map(|stop| match stop {
                Stop::Sprocket(index) => Some((*index, passed(*index)?)),
                Stop::Guide(_) => None,
            });
            let Some((first, by_first)) = given.next() else {
                continue;
            };
            for (other, by_other) in given {
                let teeth = by_first - by_other;
                if teeth.abs() > APART {
                    let sprockets = [first, other].map(|it| self.sprockets[it].name.clone());
                    found.push(MotionConflict { sprockets, teeth });
                }
            }
        }
        found
    }
}
