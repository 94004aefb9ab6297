//! Torques in the joints of the particle chain, turned into forces, on lanes.
//!
//! ```text
//! ω_i = (d_i × u_i)/ℓ_i²                    turning of link i
//! N_i = ½ (|T_{i−1}| + |T_i|)               joint i, between link i − 1 and link i
//! F   = ± (M_i − M_{i+1}) n_i/ℓ_i           couple at the ends of link i
//! ```
//!
//! Three sweeps: the links write down how they turn and pull (`springs.rs`), the joints find their torques (`joints.rs`), the
//! links pass them on to the rollers. The arrays of links begin one lane late, so that the joint before the first link finds its
//! neighbour there.

use chaindrive_integrate::Array;
use pulp::Simd;

use super::Particles;
use super::springs::{Links, Turning};
use crate::contact::Rollers;
use crate::joints::{JointLosses, Joints, Resistance, Turns};
use crate::lanes::{LANES, Lane, Lanes, Wide};

/// Adds what the joints do to the rollers, and returns the powers that go into them.
#[inline(always)]
pub(in crate::chains) fn act<S: Simd>(
    joints: &Joints,
    w: Wide<S>,
    t: f64,
    links: &Links,
    (turning, found): (&mut Turning, &mut Resistance),
    rollers: &mut Rollers<'_>,
) -> JointLosses {
    let count = links.count;
    let power = torques(joints, w, t, links, turning, found);
    // What acts on the roller after the last link is found by the difference to what stood there before.
    let behind = [rollers.ax[count], rollers.ay[count]];
    pass_on(w, &found.torque, &turning.across, rollers);
    if links.closed {
        // The roller after the last link is the first one again.
        rollers.ax[0] += rollers.ax[count] - behind[0];
        rollers.ay[0] += rollers.ay[count] - behind[1];
    }
    power
}

/// Finds the torques of all joints from how the links turn; returns the powers that go into the joints.
#[inline(always)]
pub(in crate::chains) fn torques<S: Simd>(
    joints: &Joints,
    w: Wide<S>,
    t: f64,
    links: &Links,
    turning: &mut Turning,
    found: &mut Resistance,
) -> JointLosses {
    let n = links.rest.len();
    let count = links.count;
    let Turning {
        rate,
        tension,
        across,
        ..
    } = turning;
    // The link before the first joint is the last one.
    if links.closed {
        for values in [&mut *rate, &mut *tension] {
            values[LANES - 1] = values[LANES - 1 + count];
        }
    }
    // Beyond the last link nothing is pushed: what stands there is of no link.
    for values in across.iter_mut() {
        values[count..].fill(0.0);
    }
    let neighbours = Neighbours {
        rate: w.lanes(&rate[LANES..LANES + n]),
        rate_before: w.lanes(&rate[LANES - 1..LANES - 1 + n]),
        tension: w.lanes(&tension[LANES..LANES + n]),
        tension_before: w.lanes(&tension[LANES - 1..LANES - 1 + n]),
    };
    let power = joints.resist(w, t, found, &neighbours);
    if links.closed {
        // After the last link is the first joint again.
        found.torque[count] = found.torque[0];
    }
    power
}

/// The links at every joint, and those before them.
struct Neighbours<'a, S: Simd> {
    rate: Lanes<'a, S>,
    rate_before: Lanes<'a, S>,
    tension: Lanes<'a, S>,
    tension_before: Lanes<'a, S>,
}

impl<S: Simd> Turns<S> for Neighbours<'_, S> {
    #[inline(always)]
    fn at(&self, w: Wide<S>, lane: usize) -> [Lane<S>; 2] {
        // ω = ω_i − ω_{i−1},   N = ½ (|T_{i−1}| + |T_i|)
        let rate = self.rate.get(lane) - self.rate_before.get(lane);
        let both = self.tension_before.get(lane).abs() + self.tension.get(lane).abs();
        [rate, w.splat(0.5) * both]
    }
}

impl Particles {
    /// Largest ω² and D that the joints add to the modes of the chain, see [`rates`](Self::rates).
    ///
    /// ```text
    /// ω² = 16 σ/(ℓ² m),   D = 16 c/(ℓ² m)
    /// ```
    ///
    /// Torques act on second differences of what is across, and their forces are second differences again: the row of the fourth
    /// difference is 1, −4, 6, −4, 1.
    pub(in crate::chains) fn joint_rates(&self, found: &Resistance) -> [f64; 2] {
        found
            .slopes
            .map(|value| 16.0 * value * self.lightest / (self.series.pitch * self.series.pitch))
    }
}

/// Turns the torques on the links into forces on the rollers at their ends.
#[inline(always)]
fn pass_on<S: Simd>(w: Wide<S>, torque: &[f64], across: &[Array; 2], rollers: &mut Rollers<'_>) {
    let n = across[0].len();
    let zero = w.splat(0.0);
    let (here, next) = (w.lanes(&torque[..n]), w.lanes(&torque[1..=n]));
    let inverse_mass = w.lanes(&rollers.inverse_mass[..n]);
    let (across_x, across_y) = (w.lanes(&across[0]), w.lanes(&across[1]));
    let mut ax = Wide::<S>::lanes_mut(&mut rollers.ax[..n]);
    let mut ay = Wide::<S>::lanes_mut(&mut rollers.ay[..n]);
    let mut before: [Lane<S>; 2] = [zero; 2];
    for i in 0..n / Wide::<S>::COUNT {
        // F = (M_i − M_{i+1}) n/ℓ at the second end, −F at the first
        let couple = here.get(i) - next.get(i);
        let push = [couple * across_x.get(i), couple * across_y.get(i)];
        let fx = push[0].after(before[0]) - push[0];
        let fy = push[1].after(before[1]) - push[1];
        ax.add_product(i, fx, inverse_mass.get(i));
        ay.add_product(i, fy, inverse_mass.get(i));
        before = push;
    }
}
