//! Roller, bush and pin in the place of the particles that a chain was laid as.

use chaindrive_contact::Friction;
use chaindrive_geometry::{Point, Vector};
use chaindrive_integrate::{Array, Moment};

use super::{AFTER, BEFORE, PointJoints, Points, ROLLERS};
use crate::chains::ChainAsLaid;
use crate::chains::as_laid::length_through;
use crate::chains::makeup::{Makeup, Statics};
use crate::chains::particles::Particles;
use crate::contact::BoreContact;
use crate::joints::JointMemory;
use crate::lanes::padded;
use crate::surface::Surface;

/// Depth at which contacts that are open now are reckoned with \[m\].
const SHALLOW: f64 = 1e-7;

/// Share of the stiffness of a link that its joint may take away: the plates count as ten times as stiff at most.
const MOST_OF_THE_JOINT: f64 = 0.9;

/// Net pull of the links on a joint, in weights of the joint, from which on it counts as pressed on a tooth or guide.
const PRESSED: f64 = 4.0;

impl Points {
    /// In the place of `particles`, which stand at `at`; the chain's coordinates and velocities beside it.
    ///
    /// Under the pretension T₀ the rollers are a pitch apart, and links and joints together as stiff as the links were:
    ///
    /// ```text
    /// 1/k_s = 1/k − 1/k_joint(T₀)
    /// from bush to bush: ℓ = p′ + T₀/k − T₀/k_s,   from pin to pin: the same − 2 (c + δ(T₀)),   p′: as it was laid
    /// ```
    pub(in crate::chains) fn replace(
        particles: &Particles,
        laid: &ChainAsLaid<'_>,
        points: &PointJoints,
        at: Moment<'_>,
    ) -> (Self, [Vec<f64>; 2]) {
        let count = particles.series.rollers;
        let stride = particles.series.stride;
        let smooth = |surface: &Surface| Surface {
            friction: Friction::None,
            ..*surface
        };
        let joint = &points.joint;
        let pin = BoreContact::new(&smooth(&joint.surface), joint.bore_radius, joint.pin_radius);
        let roller = &points.roller;
        let bush = BoreContact::new(
            &smooth(&roller.surface),
            roller.bore_radius,
            roller.bush_radius,
        );

        let mut links = particles.links.clone();
        let play = pin.clearance + pin.indentation(laid.pretension);
        let yields = 1.0 / pin.stiffness(pin.indentation(laid.pretension).max(1e-6));
        for link in 0..count {
            let whole = links.stiffness[link];
            let plates = whole / (1.0 - (whole * yields).min(MOST_OF_THE_JOINT));
            links.stiffness[link] = plates;
            links.rest[link] += laid.pretension * (1.0 / whole - 1.0 / plates);
            if !points.is_inner(link) {
                links.rest[link] -= 2.0 * play;
            }
        }

        let bush_after: Array = (0..padded(count + 1))
            .map(|joint| f64::from(u8::from(points.is_inner(joint % count))))
            .collect();
        let share = points.inner / (points.inner + points.outer);
        let mut masses = [ROLLERS, BEFORE, AFTER].map(|_| Vec::with_capacity(stride));
        for ghost in 0..stride {
            let joint = ghost % count;
            let left = particles.masses[joint] - roller.mass;
            let (bush, pin) = (share * left, (1.0 - share) * left);
            let [before, after] = if points.is_inner(joint) {
                [pin, bush]
            } else {
                [bush, pin]
            };
            for (masses, mass) in masses.iter_mut().zip([roller.mass, before, after]) {
                masses.push(mass);
            }
        }
        let inverse = |masses: &Vec<f64>| masses.iter().map(|mass| 1.0 / mass).collect();
        let inverse_masses: [Array; 3] = [
            inverse(&masses[ROLLERS]),
            inverse(&masses[BEFORE]),
            inverse(&masses[AFTER]),
        ];
        let lightest = [ROLLERS, BEFORE, AFTER].map(|block| {
            let all = inverse_masses[block].iter().copied();
            all.fold(0.0, f64::max)
        });
        let mut chain = Self {
            series: particles.series.with_contacts(
                laid.chain,
                links.rest.len(),
                JointMemory::open(at.t, [padded(count); 2]),
            ),
            link_rates: [0.0; 2],
            shallow: [pin.stiffness(SHALLOW), bush.stiffness(SHALLOW)],
            links,
            pin,
            bush,
            bush_after,
            masses: masses.map(Array::from),
            inverse_masses,
            lightest,
        };
        chain.link_rates = chain.rates_of_links();
        let q = chain.seat(particles, laid, at);
        let velocities: Vec<Vector> = (0..count).map(|i| particles.pin(at, i).1).collect();
        let mut v = vec![0.0; chain.coordinates()];
        chain.set_off(&[], &velocities, &mut v);
        (chain, [q, v])
    }

    /// Places the points: bushes pressed into rollers that are pressed on something, other rollers hanging, and every link with the tension
    /// that it was laid with.
    fn seat(&mut self, particles: &Particles, laid: &ChainAsLaid<'_>, at: Moment<'_>) -> Vec<f64> {
        let count = self.series.rollers;
        let place = |i: usize| particles.place(at.q, i % count);
        let direction = |i: usize| (place(i + 1) - place(i)).normalize();
        let tension = |i: usize| {
            let pins = [particles.pin(at, i), particles.pin(at, (i + 1) % count)];
            particles.links.tension(i, pins)
        };
        let tensions: Vec<f64> = (0..count).map(tension).collect();
        let mut rollers: Vec<Point> = (0..count).map(place).collect();
        let mut bushes = rollers.clone();
        for i in 0..count {
            let before = (i + count - 1) % count;
            let pull = direction(i) * tensions[i] - direction(before) * tensions[before];
            let weight = laid.gravity * self.masses[ROLLERS][i];
            let whole = laid.gravity * particles.masses[i];
            if pull.norm() > (PRESSED * whole.norm()).max(f64::MIN_POSITIVE) {
                let depth = self.bush.indentation(pull.norm());
                bushes[i] += pull.normalize() * (self.bush.clearance + depth);
            } else if weight.norm() > 0.0 {
                let depth = self.bush.indentation(weight.norm());
                rollers[i] += weight.normalize() * (self.bush.clearance + depth);
            }
        }
        // Bushes at the bottom of their rollers run on a smaller circle: so much shorter is the chain that is as tight there.
        if laid.on_route {
            let laid_at: Vec<Point> = (0..count).map(place).collect();
            let change =
                (length_through(&bushes, count) - length_through(&laid_at, count)) / count as f64;
            self.lengthen(change);
        }
        let mut q = vec![0.0; self.coordinates()];
        let mut put = |block: usize, joint: usize, at: Point| {
            let [x, y] = self.entries(block, joint % count);
            (q[x], q[y]) = (at.x, at.y);
        };
        for (i, roller) in rollers.iter().enumerate() {
            put(ROLLERS, i, *roller);
        }
        for i in 0..count {
            let ends = [bushes[i], bushes[(i + 1) % count]];
            let middle = nalgebra::center(&ends[0], &ends[1]);
            let along = (ends[1] - ends[0]).normalize();
            let half = 0.5 * (self.links.rest[i] + tensions[i] / self.links.stiffness[i]);
            put(AFTER, i, middle - along * half);
            put(BEFORE, i + 1, middle + along * half);
        }
        self.copy_ghosts(&mut q);
        q
    }
}
