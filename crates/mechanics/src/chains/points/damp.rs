//! The contacts of every joint in an implicit step, joint by joint.
//!
//! ```text
//! D = c ∂F/∂δ̇ + k ∂F/∂δ of every contact:
//! m_r x_r + D₃ n₃ (n₃·x_r − x_w) − p₂ n₂ = m_r b_r       roller between tooth and bush
//! m_b x_b + p₂ n₂ − p₁ n₁ = m_b b_b,   p₂ = D₂ n₂·(x_b − x_r)
//! m_p x_p + p₁ n₁ = m_p b_p,           p₁ = D₁ n₁·(x_p − x_b)
//! ```
//!
//! The roller is eliminated first, as a matrix of two by two, then p₂, then p₁. Links are not in the matrix: methods take
//! them explicitly. Nor is the way in which wheels yield: contacts see wheels as they would move under the forces at the beginning, and
//! wheels receive exactly what the contacts lose, so that momentum is kept.

use chaindrive_contact::Friction;
use chaindrive_geometry::{Point, Vector};
use chaindrive_integrate::{Array, Moment, Weights, kernel};
use nalgebra::{DMatrix, DVector};
use pulp::Simd;
use serde::{Deserialize, Serialize};

use super::{AFTER, BEFORE, Points, ROLLERS, Work};
use crate::bodies::{GroupBodies, RailContact, Surroundings};
use crate::chains::makeup::{Makeup, Statics};
use crate::contact::{Contacts, Frame, Touch};
use crate::dense::solve_dense;
use crate::joints::{Mount, rail_mount, turned, wheel_mount};
use crate::lanes::{LANES, Lane, Mask, Wide, padded};
use crate::seam::Loads;

/// One direction of a closed contact between a roller and a wheel or rail.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct ClosedContact {
    joint: usize,
    /// Number of the wheel or rail among those of the chain.
    pub(super) mount: usize,
    /// Unit vector e: the contact resists e·x_r + Σ c_j x_j.
    along: Vector,
    /// ∂F/∂δ \[N/m\] and ∂F/∂δ̇ \[N s/m\].
    stiffness: f64,
    pub(super) damping: f64,
    /// c_j of the coordinates that the wheel or rail moves with.
    shares: [f64; 3],
    /// Σ c_j x_j as it would be without the contact, and D.
    beside: f64,
    weight: f64,
}

/// Σ D e eᵀ of every roller, and −Σ D e (Σ c_j x_j), whole lanes.
#[derive(Clone, Debug, Default)]
pub(super) struct RollerBlocks {
    matrix: [Array; 3],
    right: [Array; 2],
}

/// The equations of the bodies by themselves, kept for the next step.
#[derive(Clone, Debug, Default)]
pub(super) struct BodyEquations {
    matrix: DMatrix<f64>,
    right: DVector<f64>,
}

impl Points {
    /// Writes down the closed contacts of rollers with wheels and rails.
    pub(super) fn list_touching(
        &self,
        around: Surroundings<'_>,
        at: Moment<'_>,
        loads: &Loads,
        found: &mut Work,
    ) {
        let Surroundings {
            bodies,
            first,
            contacts,
            ..
        } = around;
        found.touching.clear();
        found.mounts.clear();
        for (i, on) in contacts.teeth.iter().enumerate() {
            let mount = wheel_mount(first, &bodies.wheels[on.wheel], loads.ways[i]);
            let surface = (&on.contacts, &*loads.teeth[i], &loads.frames[i]);
            self.list(surface, i, &mount, at, found);
        }
        for (i, on) in contacts.rails.iter().enumerate() {
            let RailContact::Circles(circles) = &on.contact else {
                found.mounts.push([0; 3]);
                continue;
            };
            let number = contacts.teeth.len() + i;
            let support = &bodies.rails[on.rail].support;
            let mount = rail_mount((bodies, first), support, loads.ways[number]);
            let surface = (circles, &*loads.rails[i], &loads.frames[number]);
            self.list(surface, number, &mount, at, found);
        }
    }

    fn list(
        &self,
        (contacts, touch, frame): (&Contacts, &Touch, &Frame),
        number: usize,
        mount: &Mount,
        at: Moment<'_>,
        found: &mut Work,
    ) {
        // One entry along the normal of every closed contact, and one across it where it rubs.
        let rubs = contacts.surface.friction != Friction::None;
        found.mounts.push(coordinates(mount));
        let moves = moves(mount);
        for side in 0..contacts.sides() {
            for (lane, run) in contacts.runs.iter().enumerate() {
                let slots = side * contacts.slots + lane * LANES;
                for k in (0..LANES).filter(|k| touch.state.is_closed(slots + k)) {
                    let (faces, index) = (&touch.faces, slots + k);
                    let joint = (run.start + k) % self.series.rollers;
                    let arm =
                        Point::new(at.q[joint], at.q[self.series.stride + joint]) - frame.origin;
                    let along = Vector::new(faces.normal_x[index], faces.normal_y[index]);
                    let normal = ClosedContact {
                        joint,
                        mount: number,
                        along,
                        stiffness: faces.stiffness[index],
                        damping: faces.damping[index],
                        shares: shares(&moves, along, arm, 0.0),
                        beside: 0.0,
                        weight: 0.0,
                    };
                    found.touching.push(normal);
                    if rubs {
                        let across = turned(along);
                        found.touching.push(ClosedContact {
                            along: across,
                            stiffness: 0.0,
                            // A secant: a step cannot carry the slip beyond zero.
                            damping: faces.secant[index],
                            shares: shares(&moves, across, arm, contacts.radius),
                            ..normal
                        });
                    }
                }
            }
        }
    }

    /// x ← (M + c C + k K)⁻¹ M x of the chain and, after it, the bodies, at the state that the record was left by.
    pub(super) fn implicit_step(
        &self,
        bodies: GroupBodies<'_>,
        weights: Weights,
        found: &mut Work,
        x: &mut [f64],
    ) -> bool {
        let (own, beside) = x.split_at_mut(self.coordinates());
        found.pressed.collect(
            &mut found.touching,
            &found.mounts,
            weights,
            beside,
            padded(self.series.rollers),
        );
        let registers = self.series.registers;
        registers.dispatch(joints(self, weights, found, own));
        self.copy_ghosts(own);
        // M x: what the contacts lose, the bodies receive.
        let inertias = bodies.inertias();
        for touching in &found.touching {
            let moved = self.point(own, ROLLERS, touching.joint).coords;
            let push = touching.weight * (touching.along.dot(&moved) + touching.beside);
            for (j, share) in found.mounts[touching.mount]
                .into_iter()
                .zip(touching.shares)
            {
                if share != 0.0 {
                    beside[j] -= share * push / inertias[j];
                }
            }
        }
        // What bodies have by themselves, such as the springs of supports, is solved after the contacts, and only where there is any.
        let mut alone = true;
        bodies.each_own(weights, |_, weighted| alone &= weighted == 0.0);
        alone || found.own.solve(bodies, weights, beside)
    }
}

impl BodyEquations {
    /// (M + c C + k K) x = M b of the bodies by themselves, in the place of b; false if a pivot vanishes.
    fn solve(&mut self, bodies: GroupBodies<'_>, weights: Weights, x: &mut [f64]) -> bool {
        let inertias = bodies.inertias();
        let Self { matrix, right } = self;
        if right.len() == inertias.len() {
            matrix.fill(0.0);
        } else {
            *matrix = DMatrix::zeros(inertias.len(), inertias.len());
            *right = DVector::zeros(inertias.len());
        }
        for (j, (x, inertia)) in x.iter().zip(inertias).enumerate() {
            matrix[(j, j)] = *inertia;
            right[j] = x * inertia;
        }
        bodies.each_own(weights, |[i, j], weighted| matrix[(i, j)] += weighted);
        let solved = solve_dense(matrix, right);
        if solved {
            x.copy_from_slice(right.as_slice());
        }
        solved
    }
}

/// Coordinates that move a wheel or rail, unused ones zero.
fn coordinates(mount: &Mount) -> [usize; 3] {
    let shift = |at: usize| mount.shifts[at].map_or(0, |(j, _)| j);
    [shift(0), shift(1), mount.turn.map_or(0, |(j, _)| j)]
}

/// The shifts and the rotation of a wheel or rail per unit of these coordinates, unused ones zero: what an absent one leaves in memory
/// may be numbers that take a hundred times as long.
fn moves(mount: &Mount) -> ([Vector; 2], f64) {
    let shift = |at: usize| match mount.shifts[at] {
        Some((_, shift)) => shift,
        None => Vector::zeros(),
    };
    let turn = match mount.turn {
        Some((_, ratio)) => ratio,
        None => 0.0,
    };
    ([shift(0), shift(1)], turn)
}

/// c_j of these coordinates: the surface goes along e with its frame, by −e·(ẑ × d) with the rotation, and a circle that does not turn
/// is passed by the lever.
fn shares((shifts, turn): &([Vector; 2], f64), along: Vector, arm: Vector, lever: f64) -> [f64; 3] {
    [
        -along.dot(&shifts[0]),
        -along.dot(&shifts[1]),
        (lever - along.dot(&turned(arm))) * turn,
    ]
}

impl RollerBlocks {
    fn collect(
        &mut self,
        touching: &mut [ClosedContact],
        mounts: &[[usize; 3]],
        weights: Weights,
        bodies: &[f64],
        count: usize,
    ) {
        // Sums over the contacts of each roller, whose bodies are taken where they would go without the chain.
        for values in self.matrix.iter_mut().chain(&mut self.right) {
            values.clear();
            values.resize(count, 0.0);
        }
        for contact in touching {
            contact.beside = 0.0;
            for (j, share) in mounts[contact.mount].into_iter().zip(contact.shares) {
                if share != 0.0 {
                    contact.beside += share * bodies[j];
                }
            }
            contact.weight =
                weights.damping * contact.damping + weights.stiffness * contact.stiffness;
            let (e, i, weight) = (contact.along, contact.joint, contact.weight);
            self.matrix[0][i] += weight * e.x * e.x;
            self.matrix[1][i] += weight * e.x * e.y;
            self.matrix[2][i] += weight * e.y * e.y;
            self.right[0][i] -= weight * contact.beside * e.x;
            self.right[1][i] -= weight * contact.beside * e.y;
        }
    }
}

kernel!(
    /// The equations of all joints.
    fn joints<'a, S: Simd>(
        w: Wide<S>,
        chain: &'a Points,
        weights: Weights,
        found: &'a Work,
        x: &'a mut [f64],
    ) {
        let count = padded(chain.series.rollers);
        let n = chain.series.stride;
        let Work {
            pins,
            bushes,
            pressed,
            ..
        } = found;
        let masses = w.lanes(&chain.masses[ROLLERS][..count]);
        let of_before = w.lanes(&chain.inverse_masses[BEFORE][..count]);
        let of_after = w.lanes(&chain.inverse_masses[AFTER][..count]);
        let bush_after = w.lanes(&chain.bush_after[..count]);
        let [matrix_xx, matrix_xy, matrix_yy] = [0, 1, 2].map(|k| w.lanes(&pressed.matrix[k]));
        let [right_x, right_y] = [0, 1].map(|axis| w.lanes(&pressed.right[axis]));
        let [pin_x, pin_y, pin_k, pin_d] = [
            &pins.normal_x,
            &pins.normal_y,
            &pins.stiffness,
            &pins.damping,
        ]
        .map(|values| w.lanes(values));
        let [bush_x, bush_y, bush_k, bush_d] = [
            &bushes.normal_x,
            &bushes.normal_y,
            &bushes.stiffness,
            &bushes.damping,
        ]
        .map(|values| w.lanes(values));
        let [c, k] = [weights.damping, weights.stiffness].map(|weight| w.splat(weight));
        let [zero, half, one] = [0.0, 0.5, 1.0].map(|number| w.splat(number));
        for i in 0..count / Wide::<S>::COUNT {
            let start = i * Wide::<S>::COUNT;
            // What is known of the roller and the ends before and after; of these one has the bush and the other the pin.
            let b_r = [w.load(x, start), w.load(x, n + start)];
            let before = [w.load(x, 2 * n + start), w.load(x, 3 * n + start)];
            let after = [w.load(x, 4 * n + start), w.load(x, 5 * n + start)];
            let is_after = bush_after.get(i).greater(half);
            let b_b = either(is_after, after, before);
            let b_p = either(is_after, before, after);
            let b_pin = [b_p[0] - b_b[0], b_p[1] - b_b[1]];
            let (im_before, im_after) = (of_before.get(i), of_after.get(i));
            let m_b = is_after.select(im_after, im_before);
            let m_p = is_after.select(im_before, im_after);
            // n₁ from bush to pin, n₂ from roller to bush
            let sense = is_after.select(-one, one);
            let n1 = [sense * pin_x.get(i), sense * pin_y.get(i)];
            let n2 = [bush_x.get(i), bush_y.get(i)];
            // D of pin in bush and bush in roller
            let d1 = c * pin_d.get(i) + k * pin_k.get(i);
            let d2 = c * bush_d.get(i) + k * bush_k.get(i);
            let (pressed_x, pressed_y) = (matrix_xx.get(i), matrix_yy.get(i));
            if !(d2 + pressed_x + pressed_y).greater(zero).any() {
                // Rollers that touch nothing, as those between sprockets mostly are: what is left is the pin in its bush.
                let p1 = pin_alone(one, d1, [m_p, m_b], dot(n1, b_pin));
                let of_before = p1 * is_after.select(-m_p, m_b);
                let of_after = p1 * is_after.select(m_b, -m_p);
                for axis in 0..2 {
                    let (at_before, at_after) = ((2 + axis) * n + start, (4 + axis) * n + start);
                    (before[axis] + of_before * n1[axis]).store(x, at_before);
                    (after[axis] + of_after * n1[axis]).store(x, at_after);
                }
                continue;
            }
            // y = A⁻¹ r,   A = m_r + Σ D e eᵀ
            let m_r = masses.get(i);
            let (xx, xy, yy) = (m_r + pressed_x, matrix_xy.get(i), m_r + pressed_y);
            let inverse = (xx * yy - xy * xy).recip();
            let right = [m_r * b_r[0] + right_x.get(i), m_r * b_r[1] + right_y.get(i)];
            let y = [
                (yy * right[0] - xy * right[1]) * inverse,
                (xx * right[1] - xy * right[0]) * inverse,
            ];
            let through = [
                (yy * n2[0] - xy * n2[1]) * inverse,
                (xx * n2[1] - xy * n2[0]) * inverse,
            ];
            // p₂ = E₂ (w₂ + c p₁),   E₂ = D₂/(1 + D₂ (1/m_b + n₂·A⁻¹ n₂)),   c = n₁·n₂/m_b
            let w2 = dot(n2, [b_b[0] - y[0], b_b[1] - y[1]]);
            let e2 = d2 * (one + d2 * (m_b + dot(n2, through))).recip();
            let cross = dot(n1, n2) * m_b;
            // p₁ = D₁ (w₁ + c E₂ w₂)/(1 + D₁ (1/m_p + 1/m_b − c² E₂))
            let w1 = dot(n1, b_pin) + cross * e2 * w2;
            let p1 = d1 * w1 * (one + d1 * (m_p + m_b - cross * cross * e2)).recip();
            let p2 = e2 * (w2 + cross * p1);
            (y[0] + through[0] * p2).store(x, start);
            (y[1] + through[1] * p2).store(x, n + start);
            let on_pin = [-(p1 * n1[0] * m_p), -(p1 * n1[1] * m_p)];
            let on_bush = [
                (p1 * n1[0] - p2 * n2[0]) * m_b,
                (p1 * n1[1] - p2 * n2[1]) * m_b,
            ];
            (before[0] + is_after.select(on_pin[0], on_bush[0])).store(x, 2 * n + start);
            (before[1] + is_after.select(on_pin[1], on_bush[1])).store(x, 3 * n + start);
            (after[0] + is_after.select(on_bush[0], on_pin[0])).store(x, 4 * n + start);
            (after[1] + is_after.select(on_bush[1], on_pin[1])).store(x, 5 * n + start);
        }
    }
);

/// p₁ = D₁ w₁/(1 + D₁ (1/m_p + 1/m_b)) of a pin in a bush that touches nothing else.
#[inline(always)]
fn pin_alone<S: Simd>(one: Lane<S>, d1: Lane<S>, [m_p, m_b]: [Lane<S>; 2], w1: Lane<S>) -> Lane<S> {
    d1 * w1 * (one + d1 * (m_p + m_b)).recip()
}

#[inline(always)]
fn either<S: Simd>(first: Mask<S>, yes: [Lane<S>; 2], no: [Lane<S>; 2]) -> [Lane<S>; 2] {
    [first.select(yes[0], no[0]), first.select(yes[1], no[1])]
}

#[inline(always)]
fn dot<S: Simd>(a: [Lane<S>; 2], b: [Lane<S>; 2]) -> Lane<S> {
    a[0] * b[0] + a[1] * b[1]
}
