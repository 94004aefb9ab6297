//! Joints of a particle chain as points, as a drive describes them.

use crate::DriveError;
use crate::joints::{Clearance, FreeRoller};

/// Roller, bush and pin of every joint as point masses with play between them.
///
/// ```text
/// tooth ↔ roller ↔ bush ↔ pin,   inner links from bush to bush, outer links from pin to pin
/// ```
///
/// The masses of the chain are shared: the rollers have their own, and what is left at a joint is shared between its bush and its
/// pin as the masses of inner and outer links are. A link that is struck across at one end answers with half of its mass, since
/// bushes, pins and the eyes of the plates lie at the ends. Stiffnesses of links are those between their pins under the pretension,
/// what their joint yields included: what the law of the joint does not is in the links.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointJoints {
    /// Mass of an inner link without its rollers \[kg\], positive.
    pub inner: f64,
    /// Mass of an outer link \[kg\], positive.
    pub outer: f64,
    /// Whether link 0 is an outer one.
    pub outer_first: bool,
    /// Pins in their bushes; they rub as [`Chain::articulation`](crate::Chain::articulation) says.
    pub joint: Clearance,
    /// Rollers on their bushes. They do not turn: on teeth they slide as those of other particles.
    pub roller: FreeRoller,
}

impl PointJoints {
    /// Whether link `index` carries the bushes.
    pub(crate) fn is_inner(&self, index: usize) -> bool {
        index.is_multiple_of(2) != self.outer_first
    }

    /// Names every parameter out of range.
    pub(crate) fn problems(&self) -> Vec<DriveError> {
        let positive = |value: f64| value > 0.0 && value.is_finite();
        let masses = [
            ("chain.inner.mass", self.inner),
            ("chain.outer.mass", self.outer),
        ];
        let masses = masses.map(|(path, mass)| {
            DriveError::require(positive(mass), path, mass, "positive [kg]").err()
        });
        let mut problems: Vec<DriveError> = masses.into_iter().flatten().collect();
        problems.extend(self.joint.problems());
        let bore = self.joint.bore_radius;
        let play = DriveError::require(
            bore > self.joint.pin_radius,
            "chain.joint.bore_radius",
            bore,
            "larger than the pin, which is a point of its own [m]",
        );
        problems.extend(play.err());
        problems.extend(self.roller.problems());
        problems
    }
}
