//! Time scales of a linkage, and its plates as guides see them.

use chaindrive_geometry::Vector;
use nalgebra::Vector3;
use pulp::Simd;

use super::stiffness_sums::Kind;
use super::{Joining, JointState, Linkage, Posture};
use crate::bodies::Surroundings;
use crate::chains::links::Work;
use crate::contact::{OfPins, PinAccelerations, PlatePins};
use crate::joints::{Element, Joints, Partner, cross};
use crate::lanes::{Lane, Wide};
use crate::seam::Rates;

/// Shares of a contact between chain and wheel: 1 + ε and 1 + 1/ε with ε = 0.1.
const WHEEL_SHARE: f64 = 1.1;
const RIM_SHARE: f64 = 11.0;
/// How much longer than explicit ones steps are that carry the stiffness of contacts as inertia. Assumed, with regard to contacts that open
/// and close: the bicycle errs by 0.07 to 0.1 % in its tight span and by 0.3 to 0.6 % in its losses at 10 to 14 µs, where 15.8 µs are the limit that
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
        let bearing = match &self.joining {
            Joining::Clearance(bearing) => Some(&**bearing),
            Joining::Hinges(_) => None,
        };
        sums.begin(self, joint_state, bearing);
        for element in &joint_state.elements {
            let (share, other) = match element.b {
                Partner::Ground => (1.0, None),
                Partner::Body(body) => (2.0, Some(body)),
                Partner::Mount(_) => (WHEEL_SHARE, None),
            };
            let [n, t] = [element.normal, element.tangent()];
            // Each contact counts on the bodies of both sides, by the share that bounds what the two do together.
            for (body, arm, lever) in [
                (element.a, element.arm_a, element.lever_a),
                (other, element.arm_b, element.lever_b),
            ] {
                let Some(body) = body else { continue };
                let (along, pivoting) = ((n, cross(arm, n)), (t, cross(arm, t)));
                let across = (t, cross(arm, t) + lever);
                sums.add(
                    self,
                    Kind::Stiffness,
                    body,
                    along,
                    share * element.stiffness,
                );
                sums.add(
                    self,
                    Kind::Stiffness,
                    body,
                    pivoting,
                    share * element.across.max(0.0),
                );
                sums.add(self, Kind::Damping, body, along, share * element.damping);
                sums.add(self, Kind::Damping, body, across, share * element.drag);
            }
        }
        // The stiffest body: with what sticks held by springs, and with all of it sliding.
        let [mut sliding, mut damping, mut squared] = sums.largest(self);
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
