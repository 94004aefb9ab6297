//! The forces of the links on the rollers.

use chaindrive_geometry::{Point, Vector};
use chaindrive_integrate::{Array, kernel};
use pulp::Simd;

use crate::Chain;
use crate::contact::Rollers;
use crate::lanes::{LANES, Lane, Lanes, Wide, padded};
use crate::watch::range_of;

/// The links in flat arrays, padded to whole lanes with links of no stiffness.
#[derive(Clone, Debug)]
pub(crate) struct Links {
    /// Number of links.
    pub(crate) count: usize,
    /// Whether the last link returns to roller 0.
    pub(crate) closed: bool,
    /// Unstressed lengths \[m\].
    pub(crate) rest: Array,
    /// Stiffness \[N/m\].
    pub(crate) stiffness: Array,
    /// Damping \[N s/m\].
    pub(crate) damping: Array,
}

/// The law by which links pull, on lanes.
pub(in crate::chains) trait Pulls<S: Simd> {
    /// Tension \[N\] of a lane of links that are longer than without load by `stretch` \[m\], with the force of their dampers \[N\].
    fn tension(&self, w: Wide<S>, lane: usize, stretch: Lane<S>, drag: Lane<S>) -> Lane<S>;
}

/// Stiffness of the links \[N/m\].
struct Springs<'a, S: Simd>(Lanes<'a, S>);

impl<S: Simd> Pulls<S> for Springs<'_, S> {
    #[inline(always)]
    fn tension(&self, _w: Wide<S>, lane: usize, stretch: Lane<S>, drag: Lane<S>) -> Lane<S> {
        // T = k (ℓ − p) + d ℓ̇
        drag.plus(self.0.get(lane), stretch)
    }
}

/// Lengths, directions and tensions of the links: work space, filled anew by every evaluation.
#[derive(Clone, Debug, Default)]
pub(crate) struct Turning {
    /// Turning of the links \[rad/s\], from entry [`LANES`] on; where joints resist.
    pub(in crate::chains) rate: Array,
    /// Tension of the links \[N\], likewise.
    pub(in crate::chains) tension: Array,
    /// 1/ℓ of the links \[1/m\].
    pub(in crate::chains) inverse: Array,
    /// n/ℓ of the links \[1/m\], where joints resist, as turning and tension.
    pub(in crate::chains) across: [Array; 2],
}

impl Turning {
    /// Room for the links to write into.
    pub(in crate::chains) fn make_room(&mut self, links: &Links) {
        let n = links.rest.len();
        if self.across[0].len() == n {
            return;
        }
        for values in [&mut self.rate, &mut self.tension] {
            values.resize(n + LANES, 0.0);
        }
        for values in &mut self.across {
            values.resize(n, 0.0);
        }
    }
}

impl Links {
    pub(crate) fn new(chain: &Chain) -> Self {
        let count = chain.links();
        let size = padded(count + 1);
        let pad = |values: &[f64], fill: f64| {
            let mut values = Array::from(values);
            values.resize(size, fill);
            values
        };
        Self {
            count,
            closed: chain.is_closed(),
            rest: pad(&chain.lengths, chain.pitch),
            stiffness: pad(&chain.stiffness, 0.0),
            damping: pad(&chain.damping, 0.0),
        }
    }

    /// Number of entries that roller arrays need: whole lanes of links, and the roller after them.
    pub(crate) fn stride(&self) -> usize {
        self.rest.len() + LANES
    }

    /// Sets the accelerations of the rollers to gravity and the links' pulls, and returns the
    /// power \[W\] lost in the dampers. Links write down how long they are; where joints resist, how they turn and pull.
    #[inline(always)]
    pub(crate) fn act<S: Simd, const ARTICULATED: bool>(
        &self,
        w: Wide<S>,
        rollers: &mut Rollers<'_>,
        gravity: [f64; 2],
        turning: &mut Turning,
    ) -> f64 {
        // As long as the other rows, so that no index is checked in the loop.
        let law = Springs(w.lanes(&self.stiffness[..self.rest.len()]));
        self.act_by::<S, ARTICULATED>(w, &law, rollers, gravity, turning)
    }

    /// The same with a law of their own.
    #[inline(always)]
    pub(in crate::chains) fn act_by<S: Simd, const ARTICULATED: bool>(
        &self,
        w: Wide<S>,
        law: &impl Pulls<S>,
        rollers: &mut Rollers<'_>,
        gravity: [f64; 2],
        turning: &mut Turning,
    ) -> f64 {
        // All rows of one length: the compiler drops the checks of places in the loop.
        let n = self.rest.len();
        let [rest, damping, inverse_mass] =
            [&self.rest, &self.damping, rollers.inverse_mass].map(|values| w.lanes(&values[..n]));
        // Link i begins at roller i and ends at the next: its second end is the same row, read one entry later.
        let columns = [rollers.x, rollers.y, rollers.vx, rollers.vy];
        let [x, y, vx, vy] = columns.map(|values| w.lanes(&values[..n]));
        let [x_next, y_next, vx_next, vy_next] = columns.map(|values| w.lanes(&values[1..=n]));
        let mut ax = Wide::<S>::lanes_mut(&mut rollers.ax[..n]);
        let mut ay = Wide::<S>::lanes_mut(&mut rollers.ay[..n]);
        let [gx, gy] = gravity.map(|g| w.splat(g));
        let zero = w.splat(0.0);
        let (mut loss, mut before) = (zero, [zero; 2]);
        turning.inverse.resize(n, 0.0);
        // Joints that resist ask for the turning and the tension of every link; other chains write none of it.
        let written = if ARTICULATED {
            turning.make_room(self);
            n
        } else {
            0
        };
        let [turns, pulls] = [&mut turning.rate, &mut turning.tension].map(|values| {
            if ARTICULATED {
                &mut values[LANES..]
            } else {
                &mut []
            }
        });
        let (mut turns, mut pulls) = (Wide::<S>::lanes_mut(turns), Wide::<S>::lanes_mut(pulls));
        let mut inverses = Wide::<S>::lanes_mut(&mut turning.inverse);
        let [across_x, across_y] = &mut turning.across;
        let mut across =
            [across_x, across_y].map(|values| Wide::<S>::lanes_mut(&mut values[..written]));
        // Lane by lane of links. The pull of the last link of a lane is carried on to the first roller of the next.
        for i in 0..n / Wide::<S>::COUNT {
            let dx = x_next.get(i) - x.get(i);
            let dy = y_next.get(i) - y.get(i);
            let ux = vx_next.get(i) - vx.get(i);
            let uy = vy_next.get(i) - vy.get(i);
            // Length by one estimate of the inverse root, which the pull needs as well.
            let square = (dx * dx).plus(dy, dy);
            let inverse = square.inverse_root();
            inverses.set(i, inverse);
            let length = square * inverse;
            // ℓ̇ = d·u/ℓ
            let rate = (dx * ux).plus(dy, uy) * inverse;
            let drag = damping.get(i) * rate;
            let tension = law.tension(w, i, length - rest.get(i), drag);
            let scale = tension * inverse;
            let pull = [scale * dx, scale * dy];
            loss = loss.plus(drag, rate);
            if ARTICULATED {
                let inverse_square = inverse * inverse;
                // ω = d × u/ℓ²
                turns.set(i, (dx * uy).minus(dy, ux) * inverse_square);
                pulls.set(i, tension);
                across[0].set(i, -dy * inverse_square);
                across[1].set(i, dx * inverse_square);
            }
            // m a = T₊ u₊ − T₋ u₋ + m g
            let fx = pull[0] - pull[0].after(before[0]);
            let fy = pull[1] - pull[1].after(before[1]);
            ax.set(i, gx.plus(fx, inverse_mass.get(i)));
            ay.set(i, gy.plus(fy, inverse_mass.get(i)));
            before = pull;
        }
        if self.closed {
            // The roller after the last link is the first one again, and what pulls there is missing here.
            rollers.ax[0] += rollers.ax[self.count] - gravity[0];
            rollers.ay[0] += rollers.ay[self.count] - gravity[1];
        }
        loss.sum()
    }

    /// Tension of every link \[N\], whole lanes, and the least and the greatest of them; x, y and their rates are rows of the rollers, which are where the last evaluation
    /// found them.
    #[inline(always)]
    fn pull<S: Simd>(
        &self,
        w: Wide<S>,
        columns: [&[f64]; 4],
        turning: &Turning,
        tensions: &mut [f64],
    ) -> [f64; 2] {
        let n = self.rest.len();
        let own = [&self.rest, &self.stiffness, &self.damping];
        let [rest, stiffness, damping] = own.map(|values| w.lanes(&values[..n]));
        let [x, y, vx, vy] = columns.map(|values| w.lanes(&values[..n]));
        let [x_next, y_next, vx_next, vy_next] = columns.map(|values| w.lanes(&values[1..=n]));
        let inverses = w.lanes(&turning.inverse[..n]);
        let mut pulls = Wide::<S>::lanes_mut(&mut tensions[..n]);
        let whole = self.count / Wide::<S>::COUNT;
        let (mut least, mut greatest) = (w.splat(f64::INFINITY), w.splat(f64::NEG_INFINITY));
        for i in 0..n / Wide::<S>::COUNT {
            let [dx, dy] = [x_next.get(i) - x.get(i), y_next.get(i) - y.get(i)];
            let [ux, uy] = [vx_next.get(i) - vx.get(i), vy_next.get(i) - vy.get(i)];
            let square = (dx * dx).plus(dy, dy);
            let inverse = inverses.get(i);
            // T = k (ℓ − p) + d ℓ̇
            let stretch = square * inverse - rest.get(i);
            let drag = damping.get(i) * (dx * ux).plus(dy, uy) * inverse;
            let tension = drag.plus(stiffness.get(i), stretch);
            pulls.set(i, tension);
            // Behind the last link stand others of no stiffness.
            if i < whole {
                (least, greatest) = (least.min(tension), greatest.max(tension));
            }
        }
        let [low, high] = range_of(&tensions[whole * Wide::<S>::COUNT..self.count]);
        [low.min(least.smallest()), high.max(greatest.largest())]
    }

    /// Tension of one link between two pins with their velocities \[N\].
    #[inline(always)]
    pub(crate) fn tension(&self, link: usize, pins: [(Point, Vector); 2]) -> f64 {
        let d = pins[1].0 - pins[0].0;
        let u = pins[1].1 - pins[0].1;
        let length = d.norm();
        // T = k (ℓ − p) + d ℓ̇
        self.stiffness[link] * (length - self.rest[link]) + self.damping[link] * d.dot(&u) / length
    }

    /// Elastic energy of a link of some length \[J\].
    pub(crate) fn stored(&self, link: usize, length: f64) -> f64 {
        let stretch = length - self.rest[link];
        // U = ½ k (ℓ − p)²
        0.5 * self.stiffness[link] * stretch * stretch
    }
}

kernel!(
    /// Tension of every link: see [`Links::pull`].
    pub(super) fn pulls<'a, S: Simd>(
        w: Wide<S>,
        links: &'a Links,
        columns: [&'a [f64]; 4],
        turning: &'a Turning,
        tensions: &'a mut [f64],
    ) -> [f64; 2] {
        links.pull(w, columns, turning, tensions)
    }
);
