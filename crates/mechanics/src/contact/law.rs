//! Contact laws of two surfaces on lanes: force from gap, closing speed and slip.
//!
//! ```text
//! gap ─► film ─► onset ─► normal force ─► friction ─► tally
//!  [`SurfaceLaw::see`]  [`SurfaceLaw::press`]   [`SurfaceLaw::rub`]
//! ```
//!
//! Rollers on teeth and rails, plates on guides, pins in bushes and bushes in rollers find the gap, the
//! closing speed and the slip each by its own geometry; from there on they are one. A law that has no form on lanes is
//! asked for one lane after the other, in the same place.

use chaindrive_contact::dissipation::{Action, RATIO_LIMIT};
use chaindrive_contact::{Approach, Law, PreparedLaw};
use pulp::Simd;

use super::LEAST_DEPTH;
use super::film::{ElasticBacking, FilmGap, LaneFilm, LaneResponse};
use super::friction::LaneFriction;
use super::logarithm::Logarithm;
use super::memory::MemoryLanes;
use super::power_on_spring::PowerOnSpring;
use super::predicted::PredictedLane;
use super::rubbing::Rubbing;
use super::wrench::LaneTally;
use crate::lanes::{FixedPower, LANES, Lane, Mask, Wide, rarely};
use crate::surface::{Flank, Surface};

/// The laws of one pair of surfaces, taken apart once into what lanes need.
#[derive(Clone, Debug)]
pub(crate) struct SurfaceLaw {
    elastic: LaneElastic,
    /// Differences on flanks.
    pub(super) flank: Option<LaneFlank>,
    /// Oil between the surfaces.
    pub(crate) film: Option<Box<LaneFilm>>,
    /// χ of a hysteretic law, otherwise zero.
    factor: f64,
    /// Viscous damping, otherwise zero \[N s/m\].
    damping: f64,
    /// Floor of the speed at touch \[m/s\], positive.
    floor: f64,
    pub(crate) friction: LaneFriction,
}

/// An elastic law on lanes, chosen once per body; the depth is not negative.
#[derive(Clone, Debug)]
pub(super) enum LaneElastic {
    /// g = K δ
    Linear(f64),
    /// g = K δ √δ
    Hertz(f64),
    /// g = K δ δⁿ⁻¹: K, n, and the power.
    Power(f64, f64, Box<FixedPower>),
    /// A power with a spring behind it.
    Stacked(Box<PowerOnSpring>),
    /// A logarithm, which may have a spring behind it.
    Logarithm(Box<Logarithm>),
    /// Any law, one lane after the other.
    General(Box<PreparedLaw>),
}

/// A flank on lanes.
#[derive(Clone, Debug)]
pub(super) struct LaneFlank {
    elastic: LaneElastic,
    /// 1/(2w) \[1/m\].
    scale: f64,
}

/// A lane of contacts of which some are closed.
pub(crate) struct PressedLane<S: Simd> {
    pub(crate) closed: Mask<S>,
    pub(crate) depth: Lane<S>,
    closing: Lane<S>,
    /// 1/v of the closed ones, zero elsewhere \[s/m\].
    inverse_onset: Lane<S>,
    /// min(δ̇/v, 4)
    ratio: Lane<S>,
    elastic: LaneResponse<S>,
    /// −∂F/∂ġ without the limits \[N s/m\], of whole contacts; means something where closed.
    steepest: Lane<S>,
    /// Normal force \[N\], zero where open.
    pub(crate) force: Lane<S>,
}

impl<S: Simd> PressedLane<S> {
    /// What of the force of a whole contact is not elastic \[N\].
    #[inline(always)]
    pub(crate) fn resisting(&self, w: Wide<S>) -> Lane<S> {
        let resisting = self.force - self.elastic.force;
        self.closed.select(resisting, w.splat(0.0))
    }
}

impl SurfaceLaw {
    pub(crate) fn new(surface: &Surface, flank: Option<Flank>) -> Self {
        let (factor, damping) = match surface.law.dissipation.action() {
            Action::None => (0.0, 0.0),
            Action::Hysteretic { factor } => (factor, 0.0),
            Action::Viscous { damping } => (0.0, damping),
        };
        Self {
            elastic: LaneElastic::new(&surface.law),
            flank: flank.map(|flank| LaneFlank {
                elastic: LaneElastic::new(&flank.law(surface)),
                scale: 0.5 / flank.width,
            }),
            film: surface.film.map(|film| Box::new(LaneFilm::new(film))),
            factor,
            damping,
            floor: surface.floor(),
            friction: LaneFriction::new(surface.friction),
        }
    }

    /// Thickness of the film at touch \[m\], zero without one.
    pub(crate) fn film_thickness(&self) -> f64 {
        self.film.as_ref().map_or(0.0, |film| film.thickness())
    }

    /// Whether one of the laws takes so many operations or calls that it would slow down kernels without it: kernels are compiled with long
    /// laws and without.
    #[inline]
    pub(crate) fn is_long(&self) -> bool {
        let flank = self.flank.as_ref();
        self.elastic.is_long()
            || self.film.is_some()
            || flank.is_some_and(|flank| flank.elastic.is_long())
            || self.friction.is_long()
    }

    /// Gap that the law sees in a lane of contacts: through the film of oil, if there is one, which drains until `dt` after the accepted
    /// state.
    ///
    /// The gap is that between the surfaces, less the thickness of the film at touch. The memory of the film is kept.
    #[inline(always)]
    pub(crate) fn see<S: Simd, const LONG: bool>(
        &self,
        w: Wide<S>,
        memory: &mut MemoryLanes<'_, S>,
        lane: usize,
        gap: Lane<S>,
        dt: f64,
        share: Option<Lane<S>>,
    ) -> FilmGap<S> {
        match &self.film {
            Some(film) if LONG => film.squeeze(w, memory, lane, gap, dt, share, self),
            _ => FilmGap {
                gap,
                draining: w.splat(0.0),
                elastic: None,
            },
        }
    }

    /// Onset and normal force of a lane of contacts seen so, with these closing speeds; none if all are open.
    ///
    /// Contacts are closed where the gap is negative. `share` is that of the flank's law, and `weight` the part of every contact
    /// that is counted here: at an eye two plates bear a half each.
    #[inline(always)]
    #[expect(
        clippy::too_many_arguments,
        reason = "lanes are handed on by value, and the rest is what they are reckoned with"
    )]
    pub(crate) fn press<S: Simd, const LONG: bool>(
        &self,
        w: Wide<S>,
        memory: &mut MemoryLanes<'_, S>,
        lane: usize,
        seen: FilmGap<S>,
        closing: Lane<S>,
        share: Option<Lane<S>>,
        weight: Option<Lane<S>>,
        ahead: Option<PredictedLane<S>>,
        tally: &mut LaneTally<S>,
    ) -> Option<PressedLane<S>> {
        let zero = w.splat(0.0);
        let gap = seen.gap;
        memory.look(lane, gap, closing);
        // A contact is closed where surfaces overlap. A lane of open ones is over here.
        let depth = (-gap).max(zero);
        let closed = depth.greater(zero);
        if !closed.any() {
            memory.open(w, lane);
            return None;
        }
        // Of contacts that begin now the approach speed v is found once, and kept while they last.
        let before = memory.inverse_onset(lane);
        let mut inverse_onset = closed.select(before, zero);
        let fresh = closed & w.splat(f64::MIN_POSITIVE).greater(before);
        if fresh.any() {
            rarely();
            let onset = memory.onset(w, lane, depth, closing);
            let inverse = onset.speed.max(w.splat(self.floor)).recip();
            inverse_onset = fresh.select(inverse, inverse_onset);
            tally.began(w, fresh, depth, &onset, self.floor);
        }
        memory.keep_onset(lane, inverse_onset);

        // F = max(0, g + χ g min(δ̇/v, 4) + c δ̇)
        let elastic = match seen.elastic {
            Some(elastic) if LONG => elastic,
            _ => self.force::<S, LONG>(w, depth, share),
        };
        if let (Some(_), Some(share)) = (&self.flank, share) {
            memory.keep_share(lane, share);
        }
        // What the surfaces store, and what its dissipation adds to that.
        let stored = elastic.force;
        let [one, factor, damping] = [1.0, self.factor, self.damping].map(|x| w.splat(x));
        let ratio_at = |closing: Lane<S>| (closing * inverse_onset).min(w.splat(RATIO_LIMIT));
        let (mut closing, mut ratio) = (closing, ratio_at(closing));
        let mut raw = (stored * one.plus(factor, ratio)).plus(damping, closing);
        // −∂F/∂ġ = χ g/v + c
        let steepest = damping.plus(stored, factor * inverse_onset);
        let mut steep = steepest;
        let mut returned = stored;
        // A part of the contact alone is counted: a half at an eye.
        if let Some(weight) = weight {
            raw = weight * raw;
            steep = weight * steep;
            returned = weight * returned;
        }
        let mut force = closed.select(raw.max(zero), zero);
        // Where velocities are predicted, the force is that of the closing speed at the end of the step.
        if let Some(ahead) = ahead {
            let raw = closed.select(raw, zero);
            let [change, ahead] = ahead.change(w, memory, lane, fresh, [raw, steep]);
            closing += change;
            ratio = ratio_at(closing);
            force = closed.select(ahead, zero);
        }
        memory.keep_force(lane, force);
        // What is open has a depth of zero, and returns nothing.
        tally.normal_loss = (tally.normal_loss).plus(force - returned, closing);
        if LONG && self.film.is_some() {
            tally.normal_loss = tally.normal_loss.plus(force, seen.draining);
        }
        // The deepest contact decides about steps.
        tally.depth = tally.depth.max(depth);
        Some(PressedLane {
            closed,
            depth,
            closing,
            inverse_onset,
            ratio,
            elastic,
            steepest,
            force,
        })
    }

    /// Friction of a lane at some slip speeds, `dt` after the accepted state.
    #[inline(always)]
    #[expect(
        clippy::too_many_arguments,
        reason = "lanes are handed on by value, and the rest is what they are reckoned with"
    )]
    pub(crate) fn rub<S: Simd, const LONG: bool>(
        &self,
        w: Wide<S>,
        memory: &mut MemoryLanes<'_, S>,
        lane: usize,
        dt: f64,
        pressed: &PressedLane<S>,
        slip: Lane<S>,
        tally: &mut LaneTally<S>,
    ) -> Rubbing<S> {
        // Friction that sticks goes on from its deflection at the last accepted state.
        let before = if self.friction.remembers() {
            memory.stick(w, lane)
        } else {
            w.splat(0.0)
        };
        let (rubbing, stick) =
            self.friction
                .rub::<S, LONG>(w, dt, [pressed.depth, pressed.force], slip, before);
        if self.friction.remembers() {
            memory.keep_stick(w, lane, pressed.closed, stick);
        }
        tally.friction_loss = tally.friction_loss.minus(rubbing.force, slip);
        rubbing
    }

    /// −∂F/∂ġ without the limits \[N s/m\], for the choice of explicit steps.
    #[inline(always)]
    pub(super) fn steepest<S: Simd>(w: Wide<S>, pressed: &PressedLane<S>) -> Lane<S> {
        pressed.closed.select(pressed.steepest, w.splat(0.0))
    }

    /// ∂F/∂δ \[N/m\] and ∂F/∂δ̇ \[N s/m\]; both are zero where a limit holds the force.
    #[inline(always)]
    pub(crate) fn slopes<S: Simd, const LONG: bool>(
        &self,
        w: Wide<S>,
        pressed: &PressedLane<S>,
        share: Option<Lane<S>>,
    ) -> [Lane<S>; 2] {
        let zero = w.splat(0.0);
        let slope = match pressed.elastic.slope {
            Some(slope) if LONG => slope,
            _ => self.slope::<S, LONG>(w, pressed.depth, share, &pressed.elastic),
        };
        // ∂F/∂δ = k (1 + χ min(δ̇/v, 4)),   ∂F/∂δ̇ = χ g/v + c
        let factor = w.splat(self.factor);
        // A force that a limit holds does not change with depth or speed.
        let pushes = pressed.force.greater(zero);
        let free = w
            .splat(RATIO_LIMIT)
            .greater(pressed.closing * pressed.inverse_onset);
        let hysteresis = factor * pressed.elastic.force * pressed.inverse_onset;
        let damping = free.select(hysteresis, zero) + w.splat(self.damping);
        let stiffness = slope * (w.splat(1.0) + factor * pressed.ratio);
        [pushes.select(stiffness, zero), pushes.select(damping, zero)]
    }

    /// Elastic forces in contacts of which the flank has this share.
    #[inline(always)]
    fn force<S: Simd, const LONG: bool>(
        &self,
        w: Wide<S>,
        depth: Lane<S>,
        share: Option<Lane<S>>,
    ) -> LaneResponse<S> {
        let on_seat = self.elastic.force::<S, LONG>(w, depth);
        let mut force = on_seat;
        if let (Some(flank), Some(share)) = (&self.flank, share) {
            // g = (1 − s) g_seat + s g_flank
            force = force.plus(share, flank.elastic.force::<S, LONG>(w, depth) - force);
        }
        LaneResponse {
            on_seat,
            force,
            slope: None,
        }
    }

    /// ∂F/∂δ where these are the forces.
    #[inline(always)]
    fn slope<S: Simd, const LONG: bool>(
        &self,
        w: Wide<S>,
        depth: Lane<S>,
        share: Option<Lane<S>>,
        forces: &LaneResponse<S>,
    ) -> Lane<S> {
        let slope = (self.elastic).slope::<S, LONG>(w, depth, forces.on_seat);
        let (Some(flank), Some(share)) = (&self.flank, share) else {
            return slope;
        };
        let force = flank.elastic.force::<S, LONG>(w, depth);
        let other = flank.elastic.slope::<S, LONG>(w, depth, force);
        slope + share * (other - slope)
    }

    /// Energy stored by contacts without a flank or oil at some depths \[J\]; none for laws that have no form of it on lanes.
    #[inline(always)]
    pub(crate) fn energy<S: Simd>(&self, w: Wide<S>, depth: Lane<S>) -> Option<Lane<S>> {
        self.elastic.energy(w, depth)
    }

    /// The flank's share where rollers are so far beyond the hollow, as [`Flank::share`](crate::Flank) has it.
    #[inline(always)]
    pub(super) fn share<S: Simd>(&self, w: Wide<S>, beyond: Lane<S>) -> Option<Lane<S>> {
        match &self.flank {
            Some(flank) => {
                // s = x² (3 − 2x),   x = (ξ + w)/(2w)
                let x = beyond * w.splat(flank.scale) + w.splat(0.5);
                let x = x.max(w.splat(0.0)).min(w.splat(1.0));
                Some(x * x * (w.splat(3.0) - w.splat(2.0) * x))
            }
            None => None,
        }
    }
}

impl ElasticBacking for SurfaceLaw {
    #[inline(always)]
    fn elastic<S: Simd>(
        &self,
        w: Wide<S>,
        depth: Lane<S>,
        share: Option<Lane<S>>,
    ) -> (LaneResponse<S>, Lane<S>) {
        let forces = self.force::<S, true>(w, depth, share);
        let slope = self.slope::<S, true>(w, depth, share, &forces);
        (forces, slope)
    }
}

impl LaneElastic {
    fn new(law: &Law) -> Self {
        let prepared = law.prepared();
        match prepared.power() {
            Some([stiffness, n]) if is(n, 1.0) => Self::Linear(stiffness),
            Some([stiffness, n]) if is(n, 1.5) => Self::Hertz(stiffness),
            Some([stiffness, n]) => Self::Power(stiffness, n, Box::new(FixedPower::new(n - 1.0))),
            None => {
                if let Some([stiffness, n, series]) = prepared.power_and_series() {
                    return Self::Stacked(Box::new(PowerOnSpring::new(stiffness, n, series)));
                }
                match Logarithm::of(law) {
                    Some(law) => Self::Logarithm(Box::new(law)),
                    None => Self::General(Box::new(prepared)),
                }
            }
        }
    }

    /// Energy stored at some depths \[J\]; none for laws that have no form of it on lanes.
    #[inline(always)]
    fn energy<S: Simd>(&self, w: Wide<S>, depth: Lane<S>) -> Option<Lane<S>> {
        let force = self.force::<S, true>(w, depth);
        // U = g δ/(n + 1)
        let exponent = match self {
            Self::Linear(_) => 1.0,
            Self::Hertz(_) => 1.5,
            Self::Power(_, n, _) => *n,
            Self::Stacked(stack) => return Some(stack.energy(w, depth, force)),
            Self::Logarithm(_) | Self::General(_) => return None,
        };
        Some(force * depth * w.splat(1.0 / (exponent + 1.0)))
    }

    /// Whether the law is long: see [`SurfaceLaw::is_long`].
    fn is_long(&self) -> bool {
        !matches!(self, Self::Linear(_) | Self::Hertz(_))
    }

    #[inline(always)]
    fn force<S: Simd, const LONG: bool>(&self, w: Wide<S>, depth: Lane<S>) -> Lane<S> {
        match self {
            Self::Linear(stiffness) => w.splat(*stiffness) * depth,
            Self::Hertz(stiffness) => w.splat(*stiffness) * depth * depth.root(),
            // No number, should a kernel without long laws be asked for one: a run does not go on with it.
            _ if !LONG => w.splat(f64::NAN),
            Self::Power(stiffness, _, lower) => {
                w.splat(*stiffness) * depth * lower.of(w, depth.max(w.splat(LEAST_DEPTH)))
            }
            Self::Stacked(stack) => stack.force(w, depth),
            Self::Logarithm(law) => law.force(w, depth),
            Self::General(law) => general(w, law, depth, Part::Force),
        }
    }

    /// dg/dδ of lanes with a force g.
    #[inline(always)]
    fn slope<S: Simd, const LONG: bool>(
        &self,
        w: Wide<S>,
        depth: Lane<S>,
        force: Lane<S>,
    ) -> Lane<S> {
        let exponent = match self {
            Self::Linear(stiffness) => return w.splat(*stiffness),
            Self::Hertz(_) => 1.5,
            _ if !LONG => f64::NAN,
            Self::Power(_, n, _) => *n,
            Self::Stacked(stack) => return stack.slope(w, depth, force),
            Self::Logarithm(law) => return law.slope(w, depth, force),
            Self::General(law) => return general(w, law, depth, Part::Slope),
        };
        // k = n g/δ
        w.splat(exponent) * force * depth.max(w.splat(LEAST_DEPTH)).recip()
    }
}

/// The part of a general law that is asked for.
#[derive(Clone, Copy)]
enum Part {
    Force,
    Slope,
}

#[inline(always)]
fn general<S: Simd>(w: Wide<S>, law: &PreparedLaw, depth: Lane<S>, part: Part) -> Lane<S> {
    let mut numbers = [0.0; LANES];
    depth.store(&mut numbers, 0);
    respond_one_by_one(law, part, &mut numbers[..Wide::<S>::COUNT]);
    w.load(&numbers, 0)
}

/// Kept out of line: a general law is too long to be copied into every kernel.
#[inline(never)]
fn respond_one_by_one(law: &PreparedLaw, part: Part, numbers: &mut [f64]) {
    for number in numbers {
        let response = law.respond(Approach {
            penetration: *number,
            rate: 0.0,
            onset_rate: 1.0,
        });
        *number = match part {
            Part::Force => response.elastic,
            Part::Slope => response.stiffness,
        };
    }
}

#[inline(always)]
#[expect(clippy::float_cmp, reason = "an exponent is chosen, not computed")]
fn is(exponent: f64, value: f64) -> bool {
    exponent == value
}
