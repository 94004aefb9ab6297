//! Drag of oil or air across the links of the particle chain, on lanes.
//!
//! ```text
//! d, u, w: from one end of a link to the other, difference and mean of their velocities, n = ẑ × d/ℓ
//! F = −b (½ d × w ± (d × u)/12) n       at the second (+) and first (−) end
//! P = b ((d × w)² + (d × u)²/12)/ℓ
//! ```
//!
//! That is −b v_n on every piece of the straight link, with the velocity linear between its ends.

use chaindrive_geometry::Vector;
use chaindrive_integrate::{Array, Moment};
use pulp::Simd;

use super::Particles;
use super::springs::Links;
use crate::Chain;
use crate::contact::Rollers;
use crate::lanes::{Lane, Wide};

/// Drag per length of every link \[N s/m²\], whole lanes; none after the last.
#[derive(Clone, Debug)]
pub(super) struct Drag(Array);

impl Drag {
    /// None where nothing drags; `entries` are those of the links.
    pub(super) fn new(chain: &Chain, entries: usize) -> Option<Self> {
        (chain.drag > 0.0).then(|| {
            let mut coefficients = Array::default();
            coefficients.resize(chain.links(), chain.drag);
            coefficients.resize(entries, 0.0);
            Self(coefficients)
        })
    }

    /// Adds the drag to what accelerates the rollers, and returns the power \[W\] lost by it.
    #[inline(always)]
    pub(super) fn act<S: Simd>(&self, w: Wide<S>, links: &Links, rollers: &mut Rollers<'_>) -> f64 {
        let n = self.0.len();
        let count = links.count;
        let behind = [rollers.ax[count], rollers.ay[count]];
        // Both ends of the links: the same rows, the second ones read one entry later.
        let columns = [rollers.x, rollers.y, rollers.vx, rollers.vy];
        let [x, y, vx, vy] = columns.map(|values| w.lanes(&values[..n]));
        let [x_next, y_next, vx_next, vy_next] = columns.map(|values| w.lanes(&values[1..=n]));
        let coefficient = w.lanes(&self.0);
        let inverse_mass = w.lanes(&rollers.inverse_mass[..n]);
        let mut ax = Wide::<S>::lanes_mut(&mut rollers.ax[..n]);
        let mut ay = Wide::<S>::lanes_mut(&mut rollers.ay[..n]);
        let (quarter, twelfth) = (w.splat(0.25), w.splat(1.0 / 12.0));
        let zero = w.splat(0.0);
        let mut loss = zero;
        let mut before: [Lane<S>; 2] = [zero; 2];
        for i in 0..n / Wide::<S>::COUNT {
            let (dx, dy) = (x_next.get(i) - x.get(i), y_next.get(i) - y.get(i));
            let (ux, uy) = (vx_next.get(i) - vx.get(i), vy_next.get(i) - vy.get(i));
            let (sx, sy) = (vx_next.get(i) + vx.get(i), vy_next.get(i) + vy.get(i));
            // b/ℓ
            let scale = coefficient.get(i) * (dx * dx + dy * dy).inverse_root();
            // ½ d × w, and (d × u)/12
            let moving = quarter * (dx * sy - dy * sx);
            let turn = dx * uy - dy * ux;
            let turning = twelfth * turn;
            let [first, second] = [scale * (moving - turning), scale * (moving + turning)];
            loss += scale * (w.splat(4.0) * moving * moving + turning * turn);
            // −n ℓ = (d_y, −d_x)
            let push = [second * dy, -(second * dx)];
            let fx = push[0].after(before[0]) + first * dy;
            let fy = push[1].after(before[1]) - first * dx;
            ax.add(i, fx * inverse_mass.get(i));
            ay.add(i, fy * inverse_mass.get(i));
            before = push;
        }
        if links.closed {
            // The roller after the last link is the first one again.
            rollers.ax[0] += rollers.ax[count] - behind[0];
            rollers.ay[0] += rollers.ay[count] - behind[1];
        }
        loss.sum()
    }

    /// Force of the drag of a link on the roller at its first (0) or second (1) end \[N\].
    pub(super) fn at_end(
        &self,
        chain: &Particles,
        at: Moment<'_>,
        [link, end]: [usize; 2],
    ) -> Vector {
        let [(from, v), (to, v_next)] = [link, link + 1].map(|roller| chain.pin(at, roller));
        let d = to - from;
        let turning = d.perp(&(v_next - v)) / 12.0;
        let side = if end == 0 { -turning } else { turning };
        let force = self.0[link] * (0.25 * d.perp(&(v + v_next)) + side) / d.norm();
        Vector::new(d.y, -d.x) * force
    }

    /// Damping rate D \[1/s\]: b ℓ/m.
    pub(super) fn rate(&self, links: &Links, lightest: f64) -> f64 {
        let each = self.0.iter().zip(&links.rest);
        each.map(|(b, length)| b * length * lightest)
            .fold(0.0, f64::max)
    }
}
