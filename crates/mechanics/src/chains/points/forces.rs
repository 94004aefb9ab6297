//! One evaluation of a chain of points: links, joints, teeth, guides.

use chaindrive_integrate::Moment;
use pulp::Simd;

use super::{AFTER, BEFORE, Ends, JointContacts, Points, ROLLERS};
use crate::bodies::{RailContact, Surroundings};
use crate::chains::kernel::Kernel;
use crate::chains::makeup::Statics;
use crate::chains::particles::articulation;
use crate::chains::particles::forces::{plate_forces, touch_bodies};
use crate::chains::particles::springs::Turning;
use crate::chains::points::Work;
use crate::contact::{Grip, LaneTally, MemoryLanes, RelativeMotion, Rollers, Tally};
use crate::energy::Flow;
use crate::lanes::{LANES, Lane, Wide, padded};
use crate::seam::Loads;

/// Steps take the damping of bodies by the contacts explicitly, and shall be at most so long in units of its time.
const OF_BODIES: f64 = 4.0;

impl Points {
    pub(super) fn accelerate(
        &self,
        around: Surroundings<'_>,
        at: Moment<'_>,
        a: &mut [f64],
        rates: &mut [f64],
        (loads, work): (&mut Loads, &mut Work),
    ) {
        work.joints.memory.time = at.t;
        self.dispatch(around, at, a, rates, (&mut *loads, &mut *work));
        self.list_touching(around, at, loads, work);
        self.copy_ghosts(a);
    }

    /// One coordinate of a block.
    #[inline(always)]
    fn column<'a>(&self, values: &'a [f64], block: usize, axis: usize) -> &'a [f64] {
        let first = (2 * block + axis) * self.series.stride;
        &values[first..first + self.series.stride]
    }

    /// Sets all accelerations to gravity and the pull of the links; returns the power \[W\] lost in their dampers.
    #[inline(always)]
    fn pull<S: Simd>(
        &self,
        w: Wide<S>,
        at: Moment<'_>,
        a: &mut [f64],
        gravity: [f64; 2],
        turning: &mut Turning,
    ) -> f64 {
        let links = &self.links;
        let n = links.rest.len();
        let articulated = self.series.joints.is_some();
        if articulated {
            turning.make_room(links);
        }
        let [rest, stiffness, damping] =
            [&links.rest, &links.stiffness, &links.damping].map(|values| w.lanes(values));
        // A link goes from the end after its first joint to the end before its second.
        let first = |values| [0, 1].map(|axis| w.lanes(&self.column(values, AFTER, axis)[..n]));
        let second = |values| [0, 1].map(|axis| w.lanes(&self.column(values, BEFORE, axis)[1..=n]));
        let ([x, y], [vx, vy]) = (first(at.q), first(at.v));
        let ([x_next, y_next], [vx_next, vy_next]) = (second(at.q), second(at.v));
        let im_before = w.lanes(&self.inverse_masses[BEFORE][..n]);
        let im_after = w.lanes(&self.inverse_masses[AFTER][..n]);
        // Links do not pull at rollers, which begin with their weight alone.
        let (on_rollers, ends) = a.split_at_mut(2 * self.series.stride);
        for (column, g) in on_rollers.chunks_exact_mut(self.series.stride).zip(gravity) {
            column.fill(g);
        }
        let mut columns = ends.chunks_exact_mut(self.series.stride);
        let mut next = || Wide::<S>::lanes_mut(&mut columns.next().unwrap_or_default()[..n]);
        let (mut bx, mut by, mut ax, mut ay) = (next(), next(), next(), next());
        let [gx, gy] = gravity.map(|g| w.splat(g));
        let zero = w.splat(0.0);
        let [turns, pulls] = [&mut turning.rate, &mut turning.tension].map(|values| {
            if articulated {
                &mut values[LANES..]
            } else {
                &mut []
            }
        });
        let (mut turns, mut pulls) = (Wide::<S>::lanes_mut(turns), Wide::<S>::lanes_mut(pulls));
        let [across_x, across_y] = &mut turning.across;
        let (mut across_x, mut across_y) = (
            Wide::<S>::lanes_mut(across_x),
            Wide::<S>::lanes_mut(across_y),
        );
        let (mut loss, mut before) = (zero, [zero; 2]);
        for i in 0..n / Wide::<S>::COUNT {
            let (dx, dy) = (x_next.get(i) - x.get(i), y_next.get(i) - y.get(i));
            let (ux, uy) = (vx_next.get(i) - vx.get(i), vy_next.get(i) - vy.get(i));
            // 1/ℓ, and ℓ = ℓ²/ℓ
            let square = dx * dx + dy * dy;
            let inverse = square.inverse_root();
            // ℓ̇ = d·u/ℓ
            let rate = (dx * ux + dy * uy) * inverse;
            let drag = damping.get(i) * rate;
            // T = k (ℓ − p) + d ℓ̇
            let tension = stiffness.get(i) * (square * inverse - rest.get(i)) + drag;
            let scale = tension * inverse;
            let pull = [scale * dx, scale * dy];
            loss += drag * rate;
            if articulated {
                let inverse_square = inverse * inverse;
                // ω = d × u/ℓ²
                turns.set(i, (dx * uy - dy * ux) * inverse_square);
                pulls.set(i, tension);
                across_x.set(i, -dy * inverse_square);
                across_y.set(i, dx * inverse_square);
            }
            // The first end is drawn on and the second back; the pull at the first end of the next lane is carried on.
            let (im_a, im_b) = (im_after.get(i), im_before.get(i));
            ax.set(i, pull[0] * im_a + gx);
            ay.set(i, pull[1] * im_a + gy);
            bx.set(i, gx - pull[0].after(before[0]) * im_b);
            by.set(i, gy - pull[1].after(before[1]) * im_b);
            before = pull;
        }
        // The joint after the last link is the first one.
        for axis in [2 * BEFORE, 2 * BEFORE + 1] {
            let column = &mut a[axis * self.series.stride..(axis + 1) * self.series.stride];
            column[0] = column[links.count];
        }
        loss.sum()
    }

    /// Turns the torques on the links into forces at their ends.
    #[inline(always)]
    fn turn<S: Simd>(&self, w: Wide<S>, a: &mut [f64], torque: &[f64], turning: &Turning) {
        let n = self.links.rest.len();
        let (here, next) = (w.lanes(&torque[..n]), w.lanes(&torque[1..=n]));
        let (across_x, across_y) = (w.lanes(&turning.across[0]), w.lanes(&turning.across[1]));
        let im_before = w.lanes(&self.inverse_masses[BEFORE][..n]);
        let im_after = w.lanes(&self.inverse_masses[AFTER][..n]);
        let ends = &mut a[2 * self.series.stride..];
        // The entry after the last link is the first joint of a closed chain: what is added there is handed on below.
        let count = self.links.count;
        let behind = [ends[count], ends[self.series.stride + count]];
        let mut columns = ends.chunks_exact_mut(self.series.stride);
        let mut next_column = || Wide::<S>::lanes_mut(&mut columns.next().unwrap_or_default()[..n]);
        let (mut bx, mut by) = (next_column(), next_column());
        let (mut ax, mut ay) = (next_column(), next_column());
        let zero = w.splat(0.0);
        let mut before: [Lane<S>; 2] = [zero; 2];
        for i in 0..n / Wide::<S>::COUNT {
            // F = (M_i − M_{i+1}) n/ℓ at the second end, −F at the first
            let couple = here.get(i) - next.get(i);
            let push = [couple * across_x.get(i), couple * across_y.get(i)];
            ax.add(i, -push[0] * im_after.get(i));
            ay.add(i, -push[1] * im_after.get(i));
            bx.add(i, push[0].after(before[0]) * im_before.get(i));
            by.add(i, push[1].after(before[1]) * im_before.get(i));
            before = push;
        }
        for (axis, behind) in behind.into_iter().enumerate() {
            let first = axis * self.series.stride;
            ends[first] += ends[first + count] - behind;
        }
    }

    /// Pins in bushes and bushes in rollers.
    #[inline(always)]
    fn bear<S: Simd>(
        &self,
        w: Wide<S>,
        at: Moment<'_>,
        a: &mut [f64],
        found: &mut Work,
    ) -> [Tally; 2] {
        let count = padded(self.series.rollers);
        let dt = at.t - self.series.memory.time;
        let Work {
            joints,
            pins,
            bushes,
            ..
        } = found;
        let memory = &mut joints.memory;
        memory.pins.resize(count);
        memory.bushes.resize(count);
        // Two contacts a joint: the pin in its bush, and the bush in its roller.
        let mut of_pins = MemoryLanes::new(w, &self.series.memory.pins, &mut memory.pins, count);
        let mut of_bushes =
            MemoryLanes::new(w, &self.series.memory.bushes, &mut memory.bushes, count);
        let (mut pins, mut bushes) = (Grips::new(w, pins, count), Grips::new(w, bushes, count));
        let (mut in_bushes, mut in_rollers) = (LaneTally::new(w), LaneTally::new(w));
        let block = |values, block| {
            let column = |axis| w.lanes(&self.column(values, block, axis)[..count]);
            (column(0), column(1))
        };
        let ((rx, ry), (rvx, rvy)) = (block(at.q, ROLLERS), block(at.v, ROLLERS));
        let ((bx, by), (bvx, bvy)) = (block(at.q, BEFORE), block(at.v, BEFORE));
        let ((ax, ay), (avx, avy)) = (block(at.q, AFTER), block(at.v, AFTER));
        let inverse = |block: usize| w.lanes(&self.inverse_masses[block][..count]);
        let (im_roller, im_before, im_after) = (inverse(ROLLERS), inverse(BEFORE), inverse(AFTER));
        let bush_after = w.lanes(&self.bush_after[..count]);
        let mut columns = a.chunks_exact_mut(self.series.stride);
        let mut next = || Wide::<S>::lanes_mut(&mut columns.next().unwrap_or_default()[..count]);
        let (mut on_rx, mut on_ry) = (next(), next());
        let (mut on_bx, mut on_by) = (next(), next());
        let (mut on_ax, mut on_ay) = (next(), next());
        let zero = w.splat(0.0);
        let half = w.splat(0.5);
        for i in 0..count / Wide::<S>::COUNT {
            // Lanes beyond the last joint hold nothing.
            let present = w.first(self.series.rollers.saturating_sub(i * Wide::<S>::COUNT));
            let (before_x, before_y) = (bx.get(i), by.get(i));
            let (before_vx, before_vy) = (bvx.get(i), bvy.get(i));
            let (after_x, after_y) = (ax.get(i), ay.get(i));
            let (after_vx, after_vy) = (avx.get(i), avy.get(i));
            // Pin in bush: the offset of the end after the joint from the end before it, whichever has the pin.
            let apart = RelativeMotion {
                offset: [after_x - before_x, after_y - before_y],
                rate: [after_vx - before_vx, after_vy - before_vy],
                spin: [zero, zero],
                present,
                pin_after: present,
            };
            let grip = self
                .pin
                .grip(w, &mut of_pins, i, &apart, dt, &mut in_bushes);
            let (pin_x, pin_y) = (grip.force * grip.normal[0], grip.force * grip.normal[1]);
            pins.set(i, &grip);

            // Bush in roller: the bush belongs to the inner link, on this or that side of the joint.
            let is_after = bush_after.get(i).greater(half);
            let apart = RelativeMotion {
                offset: [
                    is_after.select(after_x, before_x) - rx.get(i),
                    is_after.select(after_y, before_y) - ry.get(i),
                ],
                rate: [
                    is_after.select(after_vx, before_vx) - rvx.get(i),
                    is_after.select(after_vy, before_vy) - rvy.get(i),
                ],
                spin: [zero, zero],
                present,
                pin_after: present,
            };
            let grip = self
                .bush
                .grip(w, &mut of_bushes, i, &apart, dt, &mut in_rollers);
            let (bush_x, bush_y) = (grip.force * grip.normal[0], grip.force * grip.normal[1]);
            bushes.set(i, &grip);

            // Every contact pushes its two bodies apart: the end before gets +F₁ of the pin, the end after −F₁, the roller +F₂ of the bush,
            // and the end that has the bush −F₂.
            let (m_r, m_b, m_a) = (im_roller.get(i), im_before.get(i), im_after.get(i));
            let after_bush_x = is_after.select(bush_x, zero);
            let after_bush_y = is_after.select(bush_y, zero);
            on_rx.add(i, bush_x * m_r);
            on_ry.add(i, bush_y * m_r);
            on_bx.add(i, (pin_x - (bush_x - after_bush_x)) * m_b);
            on_by.add(i, (pin_y - (bush_y - after_bush_y)) * m_b);
            on_ax.add(i, -((pin_x + after_bush_x) * m_a));
            on_ay.add(i, -((pin_y + after_bush_y) * m_a));
        }
        pins.finish();
        bushes.finish();
        [Tally::of(&in_bushes), Tally::of(&in_rollers)]
    }

    /// ω² and D as estimated from the links, the contacts in the joints, the deepest contact with a body, and the damping.
    ///
    /// ```text
    ///     ⎡ (k₂ + k₃)/m_r   −k₂/√(m_r m)                 ⎤     k₁, k₂, k₃: pin in bush, bush in roller, roller on tooth,
    /// ω²: ⎢ −k₂/√(m_r m)    (k₁ + k₂)/m + ℓ   −k₁/m      ⎥     all along one line, where they act together most
    ///     ⎣                 −k₁/m             k₁/m + ℓ   ⎦     ℓ: largest 2 k/m of links, which bounds what they add
    /// ```
    ///
    /// The part that implicit steps take explicitly (dampers of links, viscous joints, and what contacts do to the bodies) counts as
    /// frequency too.
    pub(super) fn stiffest_mode(
        &self,
        around: Surroundings<'_>,
        loads: &Loads,
        found: &Work,
    ) -> [f64; 2] {
        let Surroundings {
            bodies, contacts, ..
        } = around;
        let bear = |shallow: f64, held: &JointContacts| [held.stiffest.max(shallow), held.damped];
        let [pin, bush] = [
            bear(self.shallow[0], &found.pins),
            bear(self.shallow[1], &found.bushes),
        ];
        let (mut tooth, mut of_bodies) = ([0.0_f64; 2], 0.0_f64);
        for (mount, (on, wrench)) in contacts.teeth.iter().zip(&loads.wheel_wrenches).enumerate() {
            let mobility = bodies.wheels[on.wheel].mobility;
            let here = found
                .touching
                .iter()
                .filter(|touching| touching.mount == mount);
            let (seated, damped) = here.fold((0.0, 0.0), |(seated, damped), touching| {
                (seated + 1.0, damped + touching.damping)
            });
            of_bodies = of_bodies.max(damped * mobility);
            // As if the mass of the roller were less by what the body yields.
            let share = 1.0 + mobility * seated / self.lightest[ROLLERS];
            tooth[0] = tooth[0].max(on.contacts.surface.stiffness(wrench.depth) * share);
            tooth[1] = tooth[1].max(wrench.damping * share);
        }
        let mut plates = [0.0_f64; 2];
        for (on, wrench) in contacts.rails.iter().zip(&loads.rail_wrenches) {
            let stiffness = on.contact.surface().stiffness(wrench.depth);
            if matches!(on.contact, RailContact::Plates(_)) {
                plates = [plates[0].max(stiffness), plates[1].max(wrench.damping)];
            } else {
                tooth[0] = tooth[0].max(stiffness);
                tooth[1] = tooth[1].max(wrench.damping);
            }
        }
        let lightest_end = self.lightest[BEFORE].max(self.lightest[AFTER]);
        let along = |k: usize| {
            let (roller, link) = (self.lightest[ROLLERS], self.link_rates[k]);
            let between = (roller * lightest_end).sqrt();
            largest(
                [
                    (bush[k] + tooth[k]) * roller,
                    (pin[k] + bush[k]) * lightest_end + link,
                    pin[k] * lightest_end + link,
                ],
                [bush[k] * between, pin[k] * lightest_end],
            )
        };
        let [contacts, damping] = [along(0), along(1) + lightest_end * plates[1]];
        let turns =
            |slope: f64| 8.0 * slope * lightest_end / (self.series.pitch * self.series.pitch);
        let [across, drag] = found.joints.resistance.slopes.map(turns);
        let explicit = self.link_rates[1] + drag + lightest_end * plates[1];
        // ω = D + √(D² + ω²) of what damps explicitly
        let stiff = contacts + lightest_end * plates[0] + across;
        let frequency = explicit + (explicit * explicit + stiff).sqrt();
        let frequency = frequency.max(OF_BODIES * of_bodies);
        [frequency * frequency, damping + drag]
    }

    /// Largest Gershgorin row of M⁻¹K and of M⁻¹D over the ends of the links.
    pub(super) fn rates_of_links(&self) -> [f64; 2] {
        let links = &self.links;
        [&links.stiffness, &links.damping].map(|values| {
            let row = |link: usize| {
                let lighter =
                    self.inverse_masses[AFTER][link].max(self.inverse_masses[BEFORE][link + 1]);
                2.0 * values[link] * lighter
            };
            (0..links.count).map(row).fold(0.0, f64::max)
        })
    }
}

/// Largest eigenvalue of a symmetric tridiagonal matrix with this diagonal and these numbers beside it, by Newton's method from above: that
/// of the characteristic polynomial comes down to it and does not pass.
///
/// ```text
/// p = (λ − a₀)((λ − a₁)(λ − a₂) − b₁²) − b₀² (λ − a₂)
/// ```
fn largest([a0, a1, a2]: [f64; 3], [b0, b1]: [f64; 2]) -> f64 {
    // Begins at the bound of Gershgorin, which is above all eigenvalues.
    let rows = [a0 + b0, a1 + b0 + b1, a2 + b1];
    let mut value = rows.into_iter().fold(0.0, f64::max);
    for _ in 0..6 {
        let (x, y, z) = (value - a0, value - a1, value - a2);
        let inner = y * z - b1 * b1;
        let polynomial = x * inner - b0 * b0 * z;
        let slope = inner + x * (y + z) - b0 * b0;
        if slope <= 0.0 {
            break;
        }
        value -= polynomial / slope;
    }
    value
}

/// Writes what joints of one kind exert, lane by lane.
struct Grips<'a, S: Simd> {
    normal: [crate::lanes::LanesMut<'a, S>; 2],
    force: crate::lanes::LanesMut<'a, S>,
    stiffness: crate::lanes::LanesMut<'a, S>,
    damping: crate::lanes::LanesMut<'a, S>,
    /// Of any lane so far: stiffness and damping.
    greatest: [Lane<S>; 2],
    of_all: [&'a mut f64; 2],
}

impl<'a, S: Simd> Grips<'a, S> {
    #[inline(always)]
    fn new(w: Wide<S>, held: &'a mut JointContacts, count: usize) -> Self {
        held.resize(count);
        Self {
            normal: [
                Wide::<S>::lanes_mut(&mut held.normal_x),
                Wide::<S>::lanes_mut(&mut held.normal_y),
            ],
            force: Wide::<S>::lanes_mut(&mut held.force),
            stiffness: Wide::<S>::lanes_mut(&mut held.stiffness),
            damping: Wide::<S>::lanes_mut(&mut held.damping),
            greatest: [w.splat(0.0); 2],
            of_all: [&mut held.stiffest, &mut held.damped],
        }
    }

    #[inline(always)]
    fn set(&mut self, i: usize, grip: &Grip<S>) {
        self.normal[0].set(i, grip.normal[0]);
        self.normal[1].set(i, grip.normal[1]);
        self.force.set(i, grip.force);
        self.stiffness.set(i, grip.stiffness);
        self.damping.set(i, grip.damping);
        let [stiffness, damping] = self.greatest;
        self.greatest = [stiffness.max(grip.stiffness), damping.max(grip.damping)];
    }

    #[inline(always)]
    fn finish(self) {
        for (value, greatest) in self.of_all.into_iter().zip(self.greatest) {
            *value = greatest.largest();
        }
    }
}

impl Kernel for Points {
    #[inline(always)]
    fn forces<S: Simd>(
        &self,
        w: Wide<S>,
        around: Surroundings<'_>,
        at: Moment<'_>,
        a: &mut [f64],
        rates: &mut [f64],
        (loads, work): (&mut Loads, &mut Work),
    ) {
        let gravity = [around.bodies.gravity.x, around.bodies.gravity.y];
        rates[Flow::LinkLoss as usize] += self.pull(w, at, a, gravity, &mut work.turning);
        if let Some(joints) = &self.series.joints {
            let Work {
                turning,
                joints: found,
                ..
            } = &mut *work;
            let resistance = &mut found.resistance;
            articulation::torques(joints, w, at.t, &self.links, turning, resistance).add_to(rates);
            self.turn(w, a, &resistance.torque, turning);
        }
        // Then what joints do to links and rollers, and at last what stands around the chain.
        let tallies = self.bear(w, at, a, work);
        rates[Flow::JointLoss as usize] += tallies[0].normal_loss;
        rates[Flow::RollerLoss as usize] += tallies[1].normal_loss;
        work.joints.tallies = tallies;
        let n = self.series.stride;
        let (ax, rest) = a.split_at_mut(n);
        let mut rollers = Rollers {
            x: &at.q[..n],
            y: &at.q[n..2 * n],
            vx: &at.v[..n],
            vy: &at.v[n..2 * n],
            ax,
            ay: &mut rest[..n],
            inverse_mass: &self.inverse_masses[ROLLERS],
            spin: &[],
            half_step: 0.0,
        };
        touch_bodies(w, around, at.t, &mut rollers, rates, loads);
        // The joint after the last link is the first one again, and has to be where plates push it.
        let behind = [2 * BEFORE, 2 * BEFORE + 1].map(|column| column * n);
        let before = behind.map(|column| a[column]);
        for (column, before) in behind.into_iter().zip(before) {
            a[column + self.links.count] = before;
        }
        let mut ends = Ends {
            chain: self,
            q: at.q,
            v: at.v,
            a: &mut *a,
        };
        plate_forces(w, around, at.t, &mut ends, rates, loads);
        for (column, before) in behind.into_iter().zip(before) {
            a[column] += a[column + self.links.count] - before;
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Matrix3;

    use super::*;

    /// Against a dense solver, and never below: it bounds steps.
    #[test]
    fn largest_eigenvalue_is_found_from_above() {
        for i in 0..500 {
            let number = |k: i32| 10.0_f64.powf(3.0 * (f64::from(17 * i + k)).sin().abs() + 8.0);
            let [k1, k2, k3, link] = [1, 2, 3, 4].map(number);
            let (roller, end) = (number(5) * 1e-6, number(6) * 1e-7);
            let diagonal = [(k2 + k3) * roller, (k1 + k2) * end + link, k1 * end + link];
            let beside = [k2 * (roller * end).sqrt(), k1 * end];
            let mut matrix = Matrix3::from_diagonal(&diagonal.into());
            for j in 0..2 {
                (matrix[(j, j + 1)], matrix[(j + 1, j)]) = (-beside[j], -beside[j]);
            }
            let expected = matrix.symmetric_eigenvalues().max();
            let share = largest(diagonal, beside) / expected - 1.0;
            assert!((-1e-12..0.02).contains(&share), "{i}: {share}");
        }
    }
}
