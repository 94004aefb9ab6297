//! Time scales of a linkage, and its plates as guides see them.

use chaindrive_geometry::Vector;
use nalgebra::Vector3;
use pulp::Simd;

use super::{Joining, JointState, Linkage, Posture};
use crate::bodies::Surroundings;
use crate::chains::links::Work;
use crate::contact::{OfPins, PinAccelerations, PlatePins};
use crate::joints::{Element, Joints, Partner, cross, turned};
use crate::lanes::{Lane, Wide};
use crate::seam::Rates;

/// Shares of a contact between chain and wheel: 1 + ε and 1 + 1/ε with ε = 0.1.
const WHEEL_SHARE: f64 = 1.1;
const RIM_SHARE: f64 = 11.0;
/// How much longer than explicit ones steps are that carry the stiffness of contacts as inertia. Assumed, with regard to contacts that open
/// and close: the bicycle errs by 0.07 to 0.1 % in its tight span and by 2 to 4 % in its losses at 10 to 13 µs, where 15.8 µs are the limit that
/// this leaves; from 16 µs on impacts that are shorter than a step bring energy in here and there, and at 20 µs everywhere.
const CARRIED: f64 = 2.4;
/// Depth at which contacts that are open now are reckoned with \[m\].
const SHALLOW: f64 = 1e-7;

impl Linkage {
    /// ω² and damping rate D of the stiffest mode.
    ///
    /// ```text
    /// k (a − b)² ≤ 2 k (a² + b²)   ⇒   ω² ≤ max over bodies of λ(S),   S = M^(−½) Σ 2 (k Jₙᵀ Jₙ + F/|e| J_tᵀ J_t) M^(−½)
    /// D alike with the damping
    /// ```
    ///
    /// λ is the largest eigenvalue of a three-by-three matrix. Against a wheel the contact is shared unevenly:
    /// 1.1 for the chain, 11 for the wheel, and 1 where the wheel does not answer. Friction counts as damping, but where springs hold what
    /// sticks: steps of one solution take these at their end.
    pub(super) fn stiffest_mode(&self, around: Surroundings<'_>, work: &mut Work) -> Rates {
        let joint_state = &mut work.joint_state;
        let mut sums = std::mem::take(&mut joint_state.sums);
        sums.clear();
        sums.resize(self.bodies.len(), [SymmetricMatrix::default(); 3]);
        self.add_joints(joint_state, &mut sums);
        for element in &joint_state.elements {
            let share = match element.b {
                Partner::Ground => 1.0,
                Partner::Body(_) => 2.0,
                Partner::Mount(_) => WHEEL_SHARE,
            };
            let [sides, [n, t]] = [
                [element.arm_a, element.arm_b],
                [element.normal, element.tangent()],
            ];
            let other = match element.b {
                Partner::Body(body) => Some(body),
                Partner::Ground | Partner::Mount(_) => None,
            };
            // Each contact counts on the bodies of both sides, by the share that bounds what the two do together.
            for (body, arm, lever) in [
                (element.a, sides[0], element.lever_a),
                (other, sides[1], element.lever_b),
            ] {
                let Some(body) = body else { continue };
                let along = self.scaled_row(body, n, cross(arm, n));
                let pivoting = self.scaled_row(body, t, cross(arm, t));
                let across = self.scaled_row(body, t, cross(arm, t) + lever);
                let sum = &mut sums[body];
                add_square(&mut sum[0], along, share * element.stiffness);
                add_square(&mut sum[0], pivoting, share * element.across.max(0.0));
                add_square(&mut sum[1], along, share * element.damping);
                add_square(&mut sum[1], across, share * element.drag);
            }
        }
        let sticks = self.sticks();
        // The stiffest body: with what sticks held by springs, and with all of it sliding.
        let [mut squared, mut damping, mut sliding] =
            sums.iter().fold([0.0_f64; 3], |[k, d, s], sum| {
                let own = largest(&sum[0]);
                let stuck = if sticks {
                    largest(&std::array::from_fn(|i| sum[0][i] + sum[2][i]))
                } else {
                    own
                };
                [k.max(stuck), d.max(largest(&sum[1])), s.max(own)]
            });
        joint_state.sums = sums;
        // What is beside the contacts: joints that close gently, wheels, torques in joints, drag, and ideal joints under tension.
        let mut stiffest = self.resting();
        for [rim, drag] in joint_state.wheel_rates(around) {
            stiffest = stiffest.max(RIM_SHARE * rim);
            damping = damping.max(RIM_SHARE * drag);
        }
        let [turning, drag] = self.joint_rates(work.joints.resistance.slopes);
        stiffest = stiffest.max(turning);
        damping = damping.max(drag + self.drag_rate());
        if let Joining::Hinges(hinges) = &self.joining {
            damping = damping.max(hinges.rate);
            stiffest = stiffest.max(self.pulled(joint_state));
        }
        squared = squared.max(stiffest);
        sliding = sliding.max(stiffest);
        // The stiffness that a step carries as inertia has no limit, but has to be resolved.
        let reach = if self.carries() { CARRIED } else { 1.0 };
        // What draws ideal joints together is a damper of rate 2 α.
        let drawing = match &self.joining {
            Joining::Hinges(hinges) => 2.0 * hinges.rate,
            Joining::Clearance(_) => 0.0,
        };
        Rates {
            carried: sliding / (reach * reach),
            predicted: damping.max(drawing),
            ..Rates::of([squared, damping])
        }
    }

    /// Whether springs hold what sticks in joints with play.
    fn sticks(&self) -> bool {
        match &self.joining {
            Joining::Hinges(_) => false,
            Joining::Clearance(bearing) => bearing.lanes.friction.beside_spring().is_some(),
        }
    }

    /// Frequency \[1/s\] of the stabilisation of ideal joints, of torques in joints and of drag, which every method takes explicitly.
    ///
    /// The stabilisation is a damper and a spring of rate α: symplectic Euler takes steps up to 0.83/α with it, and this is 0.41/α.
    /// Torques are reckoned with as explicit methods do, by D + √(D² + ω²).
    pub(super) fn explicit_rate(&self) -> f64 {
        let joints = self.series.joints.as_ref();
        let [squared, damping] = self.joint_rates(joints.map_or([0.0; 2], Joints::slopes));
        let damping = damping + self.drag_rate();
        let torques = damping + (damping * damping + squared).sqrt();
        match &self.joining {
            Joining::Hinges(hinges) => torques.max((1.0 + std::f64::consts::SQRT_2) * hinges.rate),
            Joining::Clearance(_) => torques,
        }
    }

    /// ω² of links that swing to and fro between ideal joints under tension: what limits the step of a strand that
    /// touches nothing.
    ///
    /// ```text
    /// ω² ≤ T p/I    every link turns about its centre of mass, against its neighbours
    /// ```
    fn pulled(&self, joint_state: &JointState) -> f64 {
        // Squares, of which one root is taken.
        let squares = || joint_state.hinge_forces.iter().map(Vector::norm_squared);
        let next = squares().skip(1).chain(squares().take(1));
        let links = self.shapes.swing.iter().zip(squares().zip(next));
        let largest = links.fold(0.0_f64, |largest, (swing, (at_first, at_second))| {
            largest.max(at_first.max(at_second) * swing)
        });
        largest.sqrt()
    }

    /// ω² of the lightest body on the joints when they close gently: what the first step has to respect.
    fn resting(&self) -> f64 {
        let mut stiffness = 0.0_f64;
        if let Joining::Clearance(bearing) = &self.joining
            && self.joints.iter().any(|joint| joint.pair.is_some())
        {
            stiffness = stiffness.max(bearing.stiffness(SHALLOW));
        }
        let [link, roller] = self.shapes.lightest;
        let mut squared = 4.0 * stiffness / link;
        if let Some(free) = &self.free_rollers {
            squared = squared.max(2.0 * free.bearing.stiffness(SHALLOW) / roller);
        }
        squared
    }

    /// Pins in bushes, straight from their arrays.
    fn add_joints(&self, joint_state: &JointState, sums: &mut [[SymmetricMatrix; 3]]) {
        let Joining::Clearance(bearing) = &self.joining else {
            return;
        };
        let (pins, posture) = (&joint_state.pins, &joint_state.posture);
        let friction = &bearing.lanes.friction;
        for joint in 0..self.joints.len() {
            let stiffness = pins.stiffness[joint];
            // What a spring resists within the step is in its stiffness already.
            let (drag, spring) = match friction.beside_spring() {
                Some(dashpot) if stiffness > 0.0 => {
                    (dashpot, friction.stiffness(pins.force[joint]))
                }
                Some(_) => (0.0, 0.0),
                None => (pins.drag[joint], 0.0),
            };
            if stiffness <= 0.0 && drag <= 0.0 {
                continue;
            }
            let n = pins.normal(joint);
            let t = turned(n);
            let before = match joint {
                0 => self.series.is_closed().then(|| self.series.links - 1),
                _ => Some(joint - 1),
            };
            let after = (joint < self.series.links).then_some(joint);
            let share = if before.is_some() && after.is_some() {
                2.0
            } else {
                1.0
            };
            let depth = -pins.gap[joint];
            let levers = bearing.side_levers(self.pairs.pin_after(joint), depth);
            for (body, side, lever) in [
                (before, &posture.before, levers[0]),
                (after, &posture.after, levers[1]),
            ] {
                let Some(body) = body else { continue };
                let arm = Vector::new(side.arm_x[joint], side.arm_y[joint]);
                let along = self.scaled_row(body, n, cross(arm, n));
                let pivoting = self.scaled_row(body, t, cross(arm, t));
                let sum = &mut sums[body];
                add_square(&mut sum[0], along, share * stiffness);
                add_square(&mut sum[0], pivoting, share * pins.across[joint]);
                add_square(&mut sum[1], along, share * pins.damping[joint]);
                if drag > 0.0 || spring > 0.0 {
                    let across = self.scaled_row(body, t, cross(arm, t) + lever);
                    add_square(&mut sum[2], across, share * spring);
                    add_square(&mut sum[1], across, share * drag);
                }
            }
        }
    }

    /// A row of J M^(−½).
    #[inline]
    fn scaled_row(&self, body: usize, direction: Vector, turn: f64) -> Vector3<f64> {
        let [root, turning] = self.shapes.roots[body];
        Vector3::new(direction.x * root, direction.y * root, turn * turning)
    }
}

/// A symmetric matrix of three rows: diagonal, then entries (1, 0), (2, 0), (2, 1).
pub(super) type SymmetricMatrix = [f64; 6];

/// S += w r rᵀ
#[inline]
fn add_square(sum: &mut SymmetricMatrix, row: Vector3<f64>, weight: f64) {
    let scaled = row * weight;
    for k in 0..3 {
        sum[k] += row[k] * scaled[k];
    }
    sum[3] += row[1] * scaled[0];
    sum[4] += row[2] * scaled[0];
    sum[5] += row[2] * scaled[1];
}

/// Largest eigenvalue of a positive semidefinite matrix, from above.
///
/// ```text
/// m = tr/3,  p² = |S − m|²/6:   λ ≤ m + 2 p
/// ```
fn largest(matrix: &SymmetricMatrix) -> f64 {
    let [x, y, z, yx, zx, zy] = matrix;
    let mean = (x + y + z) / 3.0;
    let off = yx * yx + zx * zx + zy * zy;
    let diagonal = [x, y, z].map(|value| (value - mean) * (value - mean));
    // Every entry beside the diagonal counts twice.
    let squared = diagonal.iter().sum::<f64>() + 2.0 * off;
    mean + 2.0 * (squared / 6.0).sqrt()
}

impl JointState {
    /// Sums of stiffness and damping at the rims, times the mobility of the wheels.
    fn wheel_rates(&self, around: Surroundings<'_>) -> impl Iterator<Item = [f64; 2]> {
        let Surroundings {
            bodies, contacts, ..
        } = around;
        contacts.teeth.iter().enumerate().map(move |(mount, on)| {
            let mobility = bodies.wheels[on.wheel].mobility;
            let here = |element: &&Element| element.b == Partner::Mount(mount);
            let sum = self.elements.iter().filter(here).fold([0.0; 2], |sum, at| {
                [sum[0] + at.stiffness, sum[1] + (at.damping + at.drag)]
            });
            sum.map(|sum| sum * mobility)
        })
    }
}

/// The link plates of a linkage.
pub(super) struct LinkPins<'a> {
    pub(super) joint_state: &'a mut JointState,
    pub(super) links: usize,
}

impl PlatePins for LinkPins<'_> {
    #[inline(always)]
    fn places<S: Simd>(&self, w: Wide<S>, link: usize) -> OfPins<S> {
        let Posture { before, after, .. } = &self.joint_state.posture;
        [
            [w.load(&after.x, link), w.load(&after.y, link)],
            [w.load(&before.x, link + 1), w.load(&before.y, link + 1)],
        ]
    }

    #[inline(always)]
    fn velocities<S: Simd>(&self, w: Wide<S>, link: usize) -> OfPins<S> {
        let Posture { before, after, .. } = &self.joint_state.posture;
        [
            [w.load(&after.vx, link), w.load(&after.vy, link)],
            [w.load(&before.vx, link + 1), w.load(&before.vy, link + 1)],
        ]
    }

    /// A link that is struck at its other end moves at once.
    #[inline(always)]
    fn drawn<S: Simd>(&self, _w: Wide<S>, _link: usize) -> Option<PinAccelerations<S>> {
        None
    }

    #[inline(always)]
    fn push<S: Simd>(&mut self, _w: Wide<S>, first: usize, forces: OfPins<S>) {
        let forces = forces.map(|force| force.map(Lane::numbers));
        let JointState {
            posture,
            forces: sum,
            ..
        } = &mut *self.joint_state;
        let behind = self.links.min(first + Wide::<S>::COUNT);
        for link in first..behind {
            for (end, [x, y]) in forces.iter().enumerate() {
                let force = Vector::new(x[link - first], y[link - first]);
                let arm = posture.arm(link, end);
                sum[link] += Vector3::new(force.x, force.y, cross(arm, force));
            }
        }
    }
}
