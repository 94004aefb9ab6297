//! Resistance of the joints of a chain: torques between neighbouring links, on lanes.
//!
//! ```text
//! ω = ω_after − ω_before,   M = r f(N, r ω) − c ω       on the link after the joint, and −M on the one before it
//! ```
//!
//! Joint i lies between the links i − 1 and i. What the turning ω and the normal force N are, the member says. Joints
//! with clearance have their friction in the contact of pin and bush, and the rest here.
//!
//! Seals, and plates that are pressed sideways, hold and slide with the pin: they add to the limit of its spring,
//!
//! ```text
//! r |f| ≤ r μ N + M_seal + m N,   m = μ_s h tan γ
//! ```
//!
//! and what is lost is shared out as they share the limit.

use chaindrive_contact::Friction;
use chaindrive_integrate::Array;
use pulp::Simd;
use serde::{Deserialize, Serialize};

use crate::MemoryError;
use crate::articulation::Articulation;
use crate::contact::{Holding, LaneFriction, Sweep, swept};
use crate::energy::Flow;
use crate::lanes::{Lane, Wide, padded};

/// A deflection \[m\] that no power is divided by less than.
const LEAST_LIMIT: f64 = 1e-30;

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
    /// Resistance beside that of the pin; none where there is none.
    beside: Option<SealAndPlates>,
    pub(crate) memory: Stick,
}

/// Seal and plates, which resist beside the pin.
#[derive(Clone, Debug)]
struct SealAndPlates {
    /// Force of the seal on the surface of the pin, M_seal/r \[N\].
    seal: f64,
    /// Friction of plates over the normal force, on the surface of the pin, m/r \[–\], whole lanes.
    plates: Array,
}

/// Powers that go into the joints \[W\].
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct JointLosses {
    pins: f64,
    seals: f64,
    plates: f64,
}

impl JointLosses {
    /// Adds them to the powers of the drive.
    pub(crate) fn add_to(self, rates: &mut [f64]) {
        rates[Flow::ArticulationLoss as usize] += self.pins;
        rates[Flow::SealLoss as usize] += self.seals;
        rates[Flow::OffsetLoss as usize] += self.plates;
    }
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
    /// Torque of every joint on the link after it \[N m\], and whole lanes after.
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
            seal,
            lateral,
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
            beside: (seal > 0.0 || lateral.is_some()).then(|| SealAndPlates {
                seal: seal / radius,
                plates: Array::zeros(entries),
            }),
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

    /// Says how much the plates at every joint of the chain rub, m \[m\].
    pub(crate) fn press_sideways(&mut self, of: impl Fn(usize) -> f64) {
        let Some(beside) = &mut self.beside else {
            return;
        };
        let each = beside.plates.iter_mut().zip(self.radius.iter());
        for (joint, (plates, radius)) in each.enumerate() {
            *plates = if *radius > 0.0 {
                of(joint) / radius
            } else {
                0.0
            };
        }
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

    /// Finds the torques; returns the powers that go into the joints.
    #[inline(always)]
    pub(crate) fn resist<S: Simd>(
        &self,
        w: Wide<S>,
        t: f64,
        found: &mut Resistance,
        turns: &impl Turns<S>,
    ) -> JointLosses {
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
        match &self.friction {
            LaneFriction::SpringSlider(spring) => return self.slide(w, dt, found, turns, *spring),
            LaneFriction::Journal(journal) => return self.slide(w, dt, found, turns, *journal),
            _ => {}
        }
        if let LaneFriction::Bristles(law) = &self.friction {
            let [power, largest] = self.gather(w, found, turns);
            let before = &self.memory.state;
            let [lost, held, steepest] = w.call(swept(Sweep {
                law,
                dt,
                normal: &found.normal,
                slip: &found.slip,
                lever: &self.radius,
                before,
                now: &mut found.stick.state,
                torque: &mut found.torque[..n],
                beside: &self.damping,
            }));
            found.slopes = [self.largest[0] * self.friction.stiffness(largest), steepest];
            found.stored = held;
            return JointLosses {
                pins: power + lost,
                ..JointLosses::default()
            };
        }
        let [power, steepest] = if self.friction.is_long() {
            self.sweep::<S, true>(w, dt, found, turns)
        } else {
            self.sweep::<S, false>(w, dt, found, turns)
        };
        found.slopes = [0.0, steepest.largest()];
        found.stored = 0.0;
        JointLosses {
            pins: power.sum(),
            ..JointLosses::default()
        }
    }

    /// Laws of springs that slide.
    #[inline(always)]
    fn slide<S: Simd, L: Holding>(
        &self,
        w: Wide<S>,
        dt: f64,
        found: &mut Resistance,
        turns: &impl Turns<S>,
        law: L,
    ) -> JointLosses {
        let stiffness = law.spring().stiffness;
        // What the spring resists within a step is in its stiffness already.
        found.slopes = [
            self.largest[0] * stiffness,
            self.largest[1] + self.largest[0] * law.oil(),
        ];
        let [power, squares, seals, plates] = if let Some(beside) = &self.beside {
            self.hold::<S, L, true>(w, dt, found, turns, law, (beside.seal, &beside.plates))
        } else {
            self.hold::<S, L, false>(w, dt, found, turns, law, (0.0, &self.radius))
        };
        found.stored = 0.5 * stiffness * squares.sum();
        let [seals, plates] = [seals.sum(), plates.sum()];
        JointLosses {
            pins: power.sum() - seals - plates,
            seals,
            plates,
        }
    }

    /// All joints once, where springs hold: the power, the squares of the deflections \[m²\], and what of the power goes into seals and
    /// plates. Without closures, since those that are not inlined are compiled for the oldest processor.
    #[inline(always)]
    fn hold<S: Simd, L: Holding, const BESIDE: bool>(
        &self,
        w: Wide<S>,
        dt: f64,
        found: &mut Resistance,
        turns: &impl Turns<S>,
        law: L,
        (seal, plates): (f64, &[f64]),
    ) -> [Lane<S>; 4] {
        let n = self.radius.len();
        let zero = w.splat(0.0);
        let spring = law.spring();
        let [compliance, seal, oil] = [1.0 / spring.stiffness, seal, law.oil()].map(|x| w.splat(x));
        let radius = w.lanes(&self.radius);
        let damping = w.lanes(&self.damping);
        let plates = w.lanes(plates);
        let before = w.lanes(&self.memory.state);
        let mut now = Wide::<S>::lanes_mut(&mut found.stick.state);
        let mut moments = Wide::<S>::lanes_mut(&mut found.torque[..n]);
        let [mut power, mut squares, mut into_seals, mut into_plates] = [zero; 4];
        for i in 0..n / Wide::<S>::COUNT {
            let (r, c) = (radius.get(i), damping.get(i));
            let [rate, normal] = turns.at(w, i);
            let meets = r.greater(zero);
            let normal = meets.select(normal, zero);
            let slip = r * rate;
            let mut limit = law.limit(w, normal, slip);
            let [mut of_seal, mut of_plates] = [zero; 2];
            if BESIDE {
                of_seal = meets.select(seal * compliance, zero);
                of_plates = plates.get(i) * normal * compliance;
                limit = limit + of_seal + of_plates;
            }
            let (metal, state) = spring.slide(w, dt, limit, slip, before.get(i));
            now.set(i, state);
            squares = squares.plus(state, state);
            let mut force = metal.force;
            if L::OILED {
                force = force.minus(oil, slip);
            }
            // M = r f − c ω
            let drag = c * rate;
            moments.set(i, (-drag).plus(r, force));
            power = power.plus(drag, rate).minus(force, slip);
            if BESIDE {
                let whole = limit.max(w.splat(LEAST_LIMIT));
                let share = -(metal.force * slip) * whole.recip();
                into_seals = into_seals.plus(share, of_seal);
                into_plates = into_plates.plus(share, of_plates);
            }
        }
        [power, squares, into_seals, into_plates]
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

    /// All joints once, by laws without a state: the power \[W\] that goes into them, and the steepest −∂M/∂ω \[N m s/rad\].
    #[inline(always)]
    fn sweep<S: Simd, const LONG: bool>(
        &self,
        w: Wide<S>,
        dt: f64,
        found: &mut Resistance,
        turns: &impl Turns<S>,
    ) -> [Lane<S>; 2] {
        let n = self.radius.len();
        let zero = w.splat(0.0);
        let radius = w.lanes(&self.radius);
        let damping = w.lanes(&self.damping);
        let mut moments = Wide::<S>::lanes_mut(&mut found.torque[..n]);
        let [mut power, mut steepest] = [zero; 2];
        for i in 0..n / Wide::<S>::COUNT {
            let (r, c) = (radius.get(i), damping.get(i));
            let [rate, normal] = turns.at(w, i);
            let normal = r.greater(zero).select(normal, zero);
            let slip = r * rate;
            // The laws that have a state went other ways.
            let (rubbing, _) = self
                .friction
                .rub::<S, LONG>(w, dt, [normal, normal], slip, zero);
            steepest = steepest.max(r * r * rubbing.steepest + c);
            // M = r f − c ω
            let drag = c * rate;
            moments.set(i, (-drag).plus(r, rubbing.force));
            power = power.plus(drag, rate).minus(rubbing.force, slip);
        }
        [power, steepest]
    }
}

/// Relative rotation of the links of a member.
pub(crate) trait Turns<S: Simd> {
    /// ω \[rad/s\] and N \[N\] of a lane of joints.
    fn at(&self, w: Wide<S>, lane: usize) -> [Lane<S>; 2];
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
