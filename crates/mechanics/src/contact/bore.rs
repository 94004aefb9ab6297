//! A pin in a hole: the contact of two circles, one inside the other.
//!
//! ```text
//! e = P_pin − P_hole,  n = e/|e|,   δ = |e| − c,   c = R_hole − R_pin
//! ```

use chaindrive_contact::{Approach, PreparedLaw, Response};
use chaindrive_integrate::{Registers, kernel};
use pulp::Simd;
use serde::{Deserialize, Serialize};

use super::{ContactMemory, FAR, LaneTally, MemoryField, MemoryLanes, Onsets, SurfaceLaw};
use crate::lanes::{Lane, Mask, Wide};
use crate::surface::Surface;

/// A bore and what turns in it.
#[derive(Clone, Debug)]
pub(crate) struct BoreContact {
    pub(crate) law: PreparedLaw,
    /// The same with the friction, for lanes.
    pub(crate) lanes: SurfaceLaw,
    /// Radial clearance c \[m\].
    pub(crate) clearance: f64,
    /// Radius of what turns in the bore \[m\].
    pub(crate) radius: f64,
}

/// Cost of a contact, and how it began.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Tally {
    /// Power lost along the normal \[W\].
    pub(crate) normal_loss: f64,
    /// Power lost by friction \[W\].
    pub(crate) friction_loss: f64,
    /// Deepest penetration of a contact that opened this step \[m\].
    pub(crate) first_depth: f64,
    /// Smallest share of the step after which such a contact began.
    pub(crate) first_share: f64,
    /// The contact that began in this step.
    pub(crate) begun: Onsets,
    /// Deepest penetration of all \[m\].
    pub(crate) depth: f64,
}

impl Tally {
    pub(crate) fn new() -> Self {
        Self {
            first_share: 1.0,
            ..Self::default()
        }
    }

    /// The sums of a tally by lanes.
    #[inline(always)]
    pub(crate) fn of<S: Simd>(lanes: &LaneTally<S>) -> Self {
        let [first_depth, first_share] = lanes.first();
        Self {
            normal_loss: lanes.normal_loss.sum(),
            friction_loss: lanes.friction_loss.sum(),
            first_depth,
            first_share,
            begun: lanes.begun(),
            depth: lanes.deepest(),
        }
    }
}

/// Relative motion of the two sides of the joints of a lane: the side after, seen from the side before.
pub(crate) struct RelativeMotion<S: Simd> {
    /// Eccentricity \[m\] and its rate \[m/s\].
    pub(crate) offset: [Lane<S>; 2],
    pub(crate) rate: [Lane<S>; 2],
    /// Angular speeds of the bodies before and after \[rad/s\]; nothing where nothing rubs.
    pub(crate) spin: [Lane<S>; 2],
    /// Lanes in which there is a pin in a bore.
    pub(crate) present: Mask<S>,
    /// Joints whose pin belongs to the side after.
    pub(crate) pin_after: Mask<S>,
}

/// Force on the side after; the side before bears the opposite.
///
/// ```text
/// −F n + R t,   t = ẑ × n,   slip = t·(v_after − v_before) + ℓ_after ω_after − ℓ_before ω_before
/// ```
pub(crate) struct Grip<S: Simd> {
    pub(crate) gap: Lane<S>,
    /// n, zero for concentric circles.
    pub(crate) normal: [Lane<S>; 2],
    /// Normal force F and friction R \[N\].
    pub(crate) force: Lane<S>,
    pub(crate) rub: Lane<S>,
    /// ∂F/∂δ \[N/m\] and ∂F/∂δ̇ \[N s/m\].
    pub(crate) stiffness: Lane<S>,
    pub(crate) damping: Lane<S>,
    /// −∂R/∂slip, and the secant |R/slip| \[N s/m\].
    pub(crate) drag: Lane<S>,
    pub(crate) secant: Lane<S>,
    /// Stiffness across, F/|e| \[N/m\].
    pub(crate) across: Lane<S>,
    /// δ̇ \[m/s\], and what of F resists it: all but the elastic force \[N\].
    pub(crate) closing: Lane<S>,
    pub(crate) resisting: Lane<S>,
    /// From the centres of the sides before and after along n to where they touch \[m\].
    pub(crate) levers: [Lane<S>; 2],
}

/// Eccentricity below which a pin has no direction \[m\].
pub(crate) const CENTRED: f64 = 1e-12;

impl BoreContact {
    pub(crate) fn new(surface: &Surface, bore: f64, radius: f64) -> Self {
        Self {
            law: surface.law.prepared(),
            lanes: SurfaceLaw::new(surface, None),
            clearance: bore - radius,
            radius,
        }
    }

    /// The contacts of a lane of joints, `dt` after the accepted state.
    #[inline(always)]
    pub(crate) fn grip<S: Simd>(
        &self,
        w: Wide<S>,
        memory: &mut MemoryLanes<'_, S>,
        lane: usize,
        apart: &RelativeMotion<S>,
        dt: f64,
        tally: &mut LaneTally<S>,
    ) -> Grip<S> {
        let zero = w.splat(0.0);
        let [ex, ey] = apart.offset;
        let [eccentricity, inverse] = (ex * ex + ey * ey).roots();
        let directed = apart.present & eccentricity.greater(w.splat(CENTRED));
        // Without a direction there is no contact, whatever the clearance.
        let clearance = w.splat(self.clearance - self.lanes.film_thickness());
        let gap = directed.select(clearance - eccentricity, clearance.max(zero));
        let gap = apart.present.select(gap, w.splat(FAR));
        let inverse = directed.select(inverse, zero);
        let [nx, ny] = [ex * inverse, ey * inverse];
        // δ̇ is the speed at which the centres part.
        let [ux, uy] = apart.rate;
        let closing = nx * ux + ny * uy;
        // Through the oil to the metal, as at every other contact. An open joint answers with nothing but its gap.
        let law = &self.lanes;
        let seen = law.see::<S, true>(w, memory, lane, gap, dt, None);
        let mut grip = Grip {
            gap: seen.gap,
            normal: [nx, ny],
            force: zero,
            rub: zero,
            stiffness: zero,
            damping: zero,
            drag: zero,
            secant: zero,
            across: zero,
            closing,
            resisting: zero,
            levers: [zero, zero],
        };
        let Some(pressed) =
            law.press::<S, true>(w, memory, lane, seen, closing, None, None, None, tally)
        else {
            return grip;
        };
        [grip.stiffness, grip.damping] = law.slopes::<S, true>(w, &pressed, None);
        grip.force = pressed.force;
        grip.resisting = pressed.resisting(w);
        // A force that keeps its direction along e resists what goes across it, as a pendulum does.
        grip.across = pressed.force * inverse;
        if law.friction.acts() {
            grip.levers = self.lever_lanes(w, apart.pin_after, pressed.depth);
            // The pin's slip along its own tangent is the same from either side.
            let slip =
                nx * uy - ny * ux + grip.levers[1] * apart.spin[1] - grip.levers[0] * apart.spin[0];
            let rubbing = law.rub::<S, true>(w, memory, lane, dt, &pressed, slip, tally);
            if let Some(oil) = law.friction.beside_spring() {
                // A spring that was stretched on the way has done the work of its mean force, not of the last one:
                // what it stores and what it loses is what moved it, to the last place.
                //     P = −½ (R₀ + R) v,   R₀ = −k z₀,   R = −k z
                let before = w.splat(law.friction.stiffness(0.0)) * memory.stick(w, lane);
                let now = -(rubbing.force.plus(w.splat(oil), slip));
                let stretched = pressed.closed.select(now - before, zero);
                tally.friction_loss = tally.friction_loss.minus(w.splat(0.5) * stretched, slip);
            }
            grip.rub = rubbing.force;
            grip.drag = rubbing.drag;
            grip.secant = rubbing.secant;
        }
        grip
    }

    pub(crate) fn rubs(&self) -> bool {
        self.lanes.friction.acts()
    }

    /// From the centres of pin and hole to where they touch \[m\].
    pub(crate) fn levers(&self, depth: f64) -> [f64; 2] {
        // Both surfaces at the middle of the overlap: R_pin − δ/2 and R_hole + δ/2.
        [
            self.radius - 0.5 * depth,
            self.radius + self.clearance + 0.5 * depth,
        ]
    }

    /// From the centres of the sides before and after along n to where they touch \[m\], of a lane of joints.
    #[inline(always)]
    pub(crate) fn lever_lanes<S: Simd>(
        &self,
        w: Wide<S>,
        pin_after: Mask<S>,
        depth: Lane<S>,
    ) -> [Lane<S>; 2] {
        // Both surfaces at the middle of the overlap: R_pin − δ/2 and R_hole + δ/2. Seen along n, that lies behind the
        // pin's centre if the pin is on the side before.
        let half = w.splat(0.5) * depth;
        let pin = w.splat(self.radius) - half;
        let hole = w.splat(self.radius + self.clearance) + half;
        [pin_after.select(hole, -pin), pin_after.select(pin, -hole)]
    }

    /// Energy stored in all closed contacts of a memory \[J\].
    pub(crate) fn stored(&self, memory: &ContactMemory, registers: Registers) -> f64 {
        registers
            .dispatch(energies(self, memory))
            .unwrap_or_else(|| {
                let gaps = memory.each(MemoryField::Gap);
                let closed = gaps.filter(|gap| *gap < 0.0);
                closed.map(|gap| self.law.energy(-gap)).sum()
            })
    }
}

kernel!(
    /// Energy stored in all closed contacts; none where the law has no form of it on lanes.
    fn energies<'a, S: Simd>(
        w: Wide<S>,
        bore: &'a BoreContact,
        memory: &'a ContactMemory,
    ) -> Option<f64> {
        let zero = w.splat(0.0);
        let mut sum = zero;
        for gaps in memory.eights(MemoryField::Gap) {
            for start in (0..gaps.len()).step_by(Wide::<S>::COUNT) {
                let depth = -w.load(gaps, start);
                let closed = depth.greater(zero);
                let energy = bore.lanes.energy(w, depth.max(zero))?;
                sum += closed.select(energy, zero);
            }
        }
        Some(sum.sum())
    }
);

impl BoreContact {
    /// Answer of a contact that neither closes nor opens.
    pub(crate) fn at_rest(&self, depth: f64) -> Response {
        self.law.respond(Approach {
            penetration: depth,
            rate: 0.0,
            onset_rate: 1.0,
        })
    }

    /// Tangent stiffness \[N/m\] at a penetration \[m\].
    pub(crate) fn stiffness(&self, depth: f64) -> f64 {
        self.at_rest(depth).stiffness
    }

    /// Penetration \[m\] at which the elastic force reaches `force` \[N\].
    pub(crate) fn indentation(&self, force: f64) -> f64 {
        if force <= 0.0 {
            return 0.0;
        }
        // Newton from the penetration of a linear spring; the laws are convex and grow without bound.
        let mut depth = force / self.stiffness(1e-6);
        for _ in 0..60 {
            let at_rest = self.at_rest(depth);
            let excess = at_rest.elastic - force;
            let next = (depth - excess / at_rest.stiffness).max(0.1 * depth);
            if (next - depth).abs() <= 1e-14 * depth {
                return next;
            }
            depth = next;
        }
        depth
    }
}
