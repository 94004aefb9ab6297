//! The forces of the links on the rollers.

use chaindrive_geometry::{Point, Vector};
use pulp::Simd;

use crate::Chain;
use crate::lanes::{LANES, Wide, padded};
use crate::system::Rollers;

/// The links in flat arrays, padded to whole lanes with links of no stiffness.
#[derive(Clone, Debug)]
pub(crate) struct Links {
    /// Number of links.
    pub(crate) count: usize,
    /// Whether the last link returns to roller 0.
    pub(crate) closed: bool,
    /// Unstressed lengths \[m\].
    pub(crate) rest: Vec<f64>,
    /// Stiffness \[N/m\].
    pub(crate) stiffness: Vec<f64>,
    /// Damping \[N s/m\].
    pub(crate) damping: Vec<f64>,
}

/// Work space: the pulls of the links, shifted by one so that entry i is the link before roller i.
#[derive(Clone, Debug, Default)]
pub(crate) struct Pulls {
    x: Vec<f64>,
    y: Vec<f64>,
}

impl Links {
    pub(crate) fn new(chain: &Chain) -> Self {
        let count = chain.links();
        let size = padded(count + 1);
        let pad = |values: &[f64], fill: f64| {
            let mut values = values.to_vec();
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

    /// Number of entries that roller arrays need: whole lanes of links, and the roller behind them.
    pub(crate) fn stride(&self) -> usize {
        self.rest.len() + LANES
    }

    pub(crate) fn pulls(&self) -> Pulls {
        Pulls {
            x: vec![0.0; self.stride()],
            y: vec![0.0; self.stride()],
        }
    }

    /// Sets the accelerations of the rollers to gravity and the links' pulls, and returns the
    /// power \[W\] lost in the dampers.
    #[inline(always)]
    pub(crate) fn act<S: Simd>(
        &self,
        w: Wide<S>,
        rollers: &mut Rollers<'_>,
        pulls: &mut Pulls,
        gravity: [f64; 2],
    ) -> f64 {
        let mut loss = w.splat(0.0);
        for i in (0..self.rest.len()).step_by(Wide::<S>::COUNT) {
            let dx = w.load(rollers.x, i + 1) - w.load(rollers.x, i);
            let dy = w.load(rollers.y, i + 1) - w.load(rollers.y, i);
            let ux = w.load(rollers.vx, i + 1) - w.load(rollers.vx, i);
            let uy = w.load(rollers.vy, i + 1) - w.load(rollers.vy, i);
            let square = dx * dx + dy * dy;
            let inverse = square.inverse_root();
            let length = square * inverse;
            // ℓ̇ = d·u/ℓ
            let rate = (dx * ux + dy * uy) * inverse;
            let drag = w.load(&self.damping, i) * rate;
            // T = k (ℓ − p) + d ℓ̇
            let tension = w.load(&self.stiffness, i) * (length - w.load(&self.rest, i)) + drag;
            let scale = tension * inverse;
            (scale * dx).store(&mut pulls.x, i + 1);
            (scale * dy).store(&mut pulls.y, i + 1);
            loss += drag * rate;
        }
        pulls.x[0] = if self.closed {
            pulls.x[self.count]
        } else {
            0.0
        };
        pulls.y[0] = if self.closed {
            pulls.y[self.count]
        } else {
            0.0
        };
        for i in (0..self.rest.len()).step_by(Wide::<S>::COUNT) {
            // m a = T₊ u₊ − T₋ u₋ + m g
            let inverse_mass = w.load(rollers.inverse_mass, i);
            let fx = w.load(&pulls.x, i + 1) - w.load(&pulls.x, i);
            let fy = w.load(&pulls.y, i + 1) - w.load(&pulls.y, i);
            (fx * inverse_mass + w.splat(gravity[0])).store(rollers.ax, i);
            (fy * inverse_mass + w.splat(gravity[1])).store(rollers.ay, i);
        }
        loss.sum()
    }

    /// Tension of one link between two pins with their velocities \[N\].
    pub(crate) fn tension(&self, link: usize, pins: [(Point, Vector); 2]) -> f64 {
        let d = pins[1].0 - pins[0].0;
        let u = pins[1].1 - pins[0].1;
        let length = d.norm();
        // T = k (ℓ − p) + d ℓ̇
        self.stiffness[link] * (length - self.rest[link]) + self.damping[link] * d.dot(&u) / length
    }

    /// Elastic energy of all links \[J\].
    pub(crate) fn stored(&self, rollers: &Rollers<'_>) -> f64 {
        (0..self.count)
            .map(|link| {
                let stretch =
                    (rollers.place(link + 1) - rollers.place(link)).norm() - self.rest[link];
                // U = ½ k (ℓ − p)²
                0.5 * self.stiffness[link] * stretch * stretch
            })
            .sum()
    }
}
