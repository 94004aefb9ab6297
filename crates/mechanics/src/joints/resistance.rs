//! Resistance of the joints of a chain: torques between neighbouring links, on lanes.
//!
//! ```text
//! ω = ω_after − ω_before,   M = r f(N, r ω) − c ω       on the link after the joint, and −M on the one before it
//! ```
//!
//! Joint i lies between the links i − 1 and i. What the turning ω and the normal force N are, the member says. Joints
//! with clearance have their friction in the contact of pin and bush, and only c here.

use chaindrive_contact::Friction;
use chaindrive_integrate::Array;
use pulp::Simd;
use serde::{Deserialize, Serialize};

use crate::MemoryError;
use crate::articulation::Articulation;
use crate::contact::{LaneFriction, LaneSpring, Sweep};
use crate::lanes::{Lane, Wide, padded};

/// The joints in flat arrays, and what their friction remembers.
#[derive(Clone, Debug)]
pub(crate) struct Joints {
    friction: LaneFriction,
    /// Radius r of what slides \[m\], whole lanes; zero where no two links meet.
    radius: Array,
    /// Viscous damping c \[N m s/rad\], likewise.
    damping: Array,
    /// Largest r² \[m²\] and c \[N m s/rad\].
    largest: [f64; 2],
    pub(crate) memory: Stick,
}

/// State of the friction in all joints at an accepted moment.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Stick {
    time: f64,
    state: Array,
    /// Stiffness σ \[N m/rad\] and damping −∂M/∂ω \[N m s/rad\] of the stiffest joint.
    slopes: [f64; 2],
}

/// Results of one evaluation in the joints.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Resistance {
    /// Torque of every joint on the link after it \[N m\], and whole lanes behind.
    #[serde(skip)]
    pub(crate) torque: Array,
    /// Normal forces and slips, for laws that are asked for all joints at once.
    #[serde(skip)]
    normal: Array,
    #[serde(skip)]
    slip: Array,
    stick: Stick,
    /// Energy in the springs of friction that holds \[J\].
    pub(crate) stored: f64,
    /// As [`Stick`] has them.
    pub(crate) slopes: [f64; 2],
}

impl Joints {
    /// The joints of a chain of so many links, in so many entries; none where nothing resists.
    pub(crate) fn new(
        articulation: Option<Articulation>,
        (links, closed): (usize, bool),
        entries: usize,
    ) -> Option<Self> {
        let Articulation {
            friction,
            radius,
            damping,
        } = articulation?;
        let meet = |joint: usize| joint < links && (joint > 0 || closed);
        let at_joints = |value: f64| {
            let each = |joint| if meet(joint) { value } else { 0.0 };
            (0..entries).map(each).collect::<Array>()
        };
        let resists = friction != Friction::None || damping > 0.0;
        resists.then(|| Self {
            friction: LaneFriction::new(friction),
            radius: at_joints(radius),
            damping: at_joints(damping),
            largest: [radius * radius, damping],
            memory: Stick {
                time: 0.0,
                state: Array::zeros(entries),
                slopes: [0.0; 2],
            },
        })
    }

    /// σ and damping of the stiffest joint at the accepted state.
    pub(crate) fn slopes(&self) -> [f64; 2] {
        self.memory.slopes
    }

    /// Says when the memory is of.
    pub(crate) fn set_clock(&mut self, t: f64) {
        self.memory.time = t;
    }

    /// Whether the normal force matters.
    pub(crate) fn rub(&self) -> bool {
        self.friction.acts()
    }

    /// Takes the accepted state of the friction.
    pub(crate) fn commit(&mut self, found: &mut Resistance) {
        std::mem::swap(&mut self.memory, &mut found.stick);
        self.memory.slopes = found.slopes;
    }

    /// Goes on from what other joints remembered.
    fn remember(&mut self, memory: Stick) -> Result<(), MemoryError> {
        MemoryError::unless("joints", memory.state.len(), self.radius.len())?;
        self.memory = memory;
        Ok(())
    }

    /// Finds the torques; returns the power \[W\] that goes into the joints.
    #[inline(always)]
    pub(crate) fn resist<S: Simd>(
        &self,
        w: Wide<S>,
        t: f64,
        found: &mut Resistance,
        turns: &impl Turns<S>,
    ) -> f64 {
        let n = self.radius.len();
        let dt = t - self.memory.time;
        found.stick.time = t;
        if found.stick.state.len() != n {
            found.stick.state.resize(n, 0.0);
        }
        if found.torque.len() <= n {
            found.torque.resize(padded(n + 1), 0.0);
        }
        // The law that most have gets a loop of its own.
        if let LaneFriction::SpringSlider(spring) = &self.friction {
            let sums = self.sweep::<S, true, false>(w, dt, found, turns, *spring);
            // What the spring resists within a step is in its stiffness already.
            found.slopes = [self.largest[0] * spring.stiffness, self.largest[1]];
            found.stored = 0.5 * spring.stiffness * sums.squares.sum();
            return sums.power.sum();
        }
        if let LaneFriction::Bristles(law) = &self.friction {
            let [power, largest] = self.gather(w, found, turns);
            let before = &self.memory.state;
            let [lost, held, steepest] = w.call(Sweep {
                law,
                dt,
                normal: &found.normal,
                slip: &found.slip,
                lever: &self.radius,
                before,
                now: &mut found.stick.state,
                torque: &mut found.torque[..n],
                beside: &self.damping,
            });
            found.slopes = [self.largest[0] * self.friction.stiffness(largest), steepest];
            found.stored = held;
            return power + lost;
        }
        let spring = LaneSpring::default();
        let sums = if self.friction.is_long() {
            self.sweep::<S, false, true>(w, dt, found, turns, spring)
        } else {
            self.sweep::<S, false, false>(w, dt, found, turns, spring)
        };
        found.slopes = [0.0, sums.steepest.largest()];
        found.stored = 0.0;
        sums.power.sum()
    }

    /// Writes down normal forces, slips, and the torques of what is viscous; the power that goes into these, and the largest normal
    /// force.
    #[inline(always)]
    fn gather<S: Simd>(
        &self,
        w: Wide<S>,
        found: &mut Resistance,
        turns: &impl Turns<S>,
    ) -> [f64; 2] {
        let n = self.radius.len();
        for values in [&mut found.normal, &mut found.slip] {
            values.resize(n, 0.0);
        }
        let zero = w.splat(0.0);
        let radius = w.lanes(&self.radius);
        let damping = w.lanes(&self.damping);
        let mut normals = Wide::<S>::lanes_mut(&mut found.normal);
        let mut slips = Wide::<S>::lanes_mut(&mut found.slip);
        let mut moments = Wide::<S>::lanes_mut(&mut found.torque[..n]);
        let [mut power, mut largest] = [zero; 2];
        for i in 0..n / Wide::<S>::COUNT {
            let (r, c) = (radius.get(i), damping.get(i));
            let [rate, normal] = turns.at(w, i);
            let normal = r.greater(zero).select(normal, zero);
            let drag = c * rate;
            normals.set(i, normal);
            slips.set(i, r * rate);
            moments.set(i, -drag);
            power += drag * rate;
            largest = largest.max(normal);
        }
        [power.sum(), largest.largest()]
    }

    /// All joints once; without closures, since those that are not inlined are compiled for the oldest processor.
    #[inline(always)]
    fn sweep<S: Simd, const SPRING: bool, const LONG: bool>(
        &self,
        w: Wide<S>,
        dt: f64,
        found: &mut Resistance,
        turns: &impl Turns<S>,
        spring: LaneSpring,
    ) -> Sums<S> {
        let n = self.radius.len();
        let zero = w.splat(0.0);
        let radius = w.lanes(&self.radius);
        let damping = w.lanes(&self.damping);
        let before = w.lanes(&self.memory.state);
        let mut now = Wide::<S>::lanes_mut(&mut found.stick.state);
        let mut moments = Wide::<S>::lanes_mut(&mut found.torque[..n]);
        let mut sums = Sums {
            power: zero,
            squares: zero,
            steepest: zero,
        };
        for i in 0..n / Wide::<S>::COUNT {
            let (r, c) = (radius.get(i), damping.get(i));
            let [rate, normal] = turns.at(w, i);
            let normal = r.greater(zero).select(normal, zero);
            let slip = r * rate;
            let rubbing = if SPRING {
                let (rubbing, state) = spring.rub(w, dt, normal, slip, before.get(i));
                now.set(i, state);
                sums.squares = sums.squares.plus(state, state);
                rubbing
            } else {
                // The laws that have a state went other ways.
                let (rubbing, _) =
                    self.friction
                        .rub::<S, LONG>(w, dt, [normal, normal], slip, zero);
                sums.steepest = sums.steepest.max(r * r * rubbing.steepest + c);
                rubbing
            };
            // M = r f − c ω
            let drag = c * rate;
            moments.set(i, (-drag).plus(r, rubbing.force));
            sums.power = sums.power.plus(drag, rate).minus(rubbing.force, slip);
        }
        sums
    }
}

/// How the links of a member turn against each other.
pub(crate) trait Turns<S: Simd> {
    /// ω \[rad/s\] and N \[N\] of a lane of joints.
    fn at(&self, w: Wide<S>, lane: usize) -> [Lane<S>; 2];
}

/// Sums of a sweep over the joints.
struct Sums<S: Simd> {
    /// Power that goes into the joints \[W\].
    power: Lane<S>,
    /// Squares of the deflections of springs \[m²\].
    squares: Lane<S>,
    /// Steepest −∂M/∂ω \[N m s/rad\], of laws without a spring.
    steepest: Lane<S>,
}

/// Goes on from what the joints of another chain remembered; there must be some in both or in none.
pub(crate) fn remember(
    joints: Option<&mut Joints>,
    memory: Option<Stick>,
) -> Result<(), MemoryError> {
    match (joints, memory) {
        (Some(joints), Some(memory)) => joints.remember(memory),
        (None, None) => Ok(()),
        (Some(_), None) | (None, Some(_)) => Err(MemoryError::Model),
    }
}
