//! Closing speeds that are only predicted, at the end of their step.
//!
//! ```text
//! w = 1/m + 1/M,   c = ∂F/∂δ̇
//! F⁺ = max(0, (F + ½ h c (w F₀ + b − b₀))/(1 + ½ h c w))
//! δ̇⁺ = δ̇ + ½ h (b − b₀ − w (F⁺ − F₀))
//! ```
//!
//! b is the acceleration towards the surface by all that is not this contact, m the mass of the circle or of the pins that share the force,
//! M the one by which the body yields to all that may press on it, and b₀ and F₀ belong to the beginning of the step. This is the implicit
//! trapezoidal rule for one contact, or for several that press alike. δ̇ is off by O(h²) only, so that other contacts of the same circle
//! may be left out, and w need not be exact. F is the law's force before it is kept from pulling. F⁺ is the force that brings about δ̇⁺,
//! which for the true w is the law's own, max(0, F + c (δ̇⁺ − δ̇)): so a w that is too large slows the correction, however stiff the
//! damping, where the law's force would swing by more from step to step. One that is too small lets it swing, so w is the largest that can be.

use pulp::Simd;

use super::memory::MemoryLanes;
use crate::lanes::{Lane, Mask, Wide};

/// A lane of contacts whose velocities are predicted.
pub(crate) struct PredictedLane<S: Simd> {
    /// b \[m/s²\].
    pub(super) thrust: Lane<S>,
    /// ½ h \[s\]; zero where velocities are what they are.
    pub(super) half_step: Lane<S>,
    /// w \[1/kg\].
    pub(super) mobility: Lane<S>,
}

impl<S: Simd> PredictedLane<S> {
    /// Change of the closing speeds, and the forces, of contacts that have these forces, pulling or pushing, and damping at the predicted ones.
    #[inline(always)]
    pub(super) fn change(
        self,
        w: Wide<S>,
        memory: &mut MemoryLanes<'_, S>,
        lane: usize,
        fresh: Mask<S>,
        [force, damping]: [Lane<S>; 2],
    ) -> [Lane<S>; 2] {
        let [force_before, thrust_before] = memory.pushed(lane);
        memory.keep_thrust(lane, self.thrust);
        // A contact that begins has felt nothing yet.
        let grown = fresh.select(w.splat(0.0), self.thrust - thrust_before);
        // ½ h c, and 1/(1 + ½ h c w)
        let lag = self.half_step * damping;
        let share = w.splat(1.0).plus(lag, self.mobility).recip();
        let ahead = force.plus(lag, grown.plus(self.mobility, force_before));
        let ahead = (ahead * share).max(w.splat(0.0));
        let change = self.half_step * grown.minus(ahead - force_before, self.mobility);
        [change, ahead]
    }
}
