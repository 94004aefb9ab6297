//! What a body answers to indentation, taken apart once into what lanes need.

use chaindrive_contact::dissipation::Action;
use chaindrive_contact::elastic::ElasticLaw;
use chaindrive_contact::{Elastic, Friction, Law};
use pulp::Simd;

use crate::drive::{Flank, Surface};
use crate::lanes::{FixedPower, Lane, Wide};

/// The laws of one body.
#[derive(Clone, Debug)]
pub(super) struct Answer {
    pub(super) elastic: LaneElastic,
    pub(super) numbers: LawNumbers,
    /// What is different on flanks.
    pub(super) flank: Option<LaneFlank>,
}

impl Answer {
    pub(super) fn new(surface: &Surface, flank: Option<Flank>) -> Self {
        Self {
            elastic: LaneElastic::new(&surface.law),
            numbers: LawNumbers::new(surface),
            flank: flank.map(|flank| LaneFlank {
                elastic: LaneElastic::new(&Law {
                    elastic: flank.elastic,
                    ..surface.law
                }),
                scale: 0.5 / flank.width,
            }),
        }
    }
}

/// The law, taken apart into what the kernel needs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LawNumbers {
    /// χ of a hysteretic law, otherwise zero.
    pub(crate) factor: f64,
    /// Viscous damping, otherwise zero \[N s/m\].
    pub(crate) damping: f64,
    /// Floor of the speed at touch \[m/s\], positive.
    pub(crate) floor: f64,
    /// Coefficient of Coulomb friction, zero with any other law.
    pub(crate) friction: f64,
    /// Slope of the friction force at rest per normal force, μ/v_s \[s/m\].
    pub(crate) friction_slope: f64,
    /// Square of the regularising slip speed \[m²/s²\].
    pub(crate) slip_speed_squared: f64,
    /// Any other friction law, asked lane by lane.
    pub(crate) general: Option<Friction>,
}

impl LawNumbers {
    pub(crate) fn new(surface: &Surface) -> Self {
        let (factor, damping) = match surface.law.dissipation.action() {
            Action::None => (0.0, 0.0),
            Action::Hysteretic { factor } => (factor, 0.0),
            Action::Viscous { damping } => (0.0, damping),
        };
        let (friction, slip_speed) = match surface.friction {
            Friction::Coulomb(coulomb) => (coulomb.coefficient, coulomb.slip_speed),
            _ => (0.0, 1.0),
        };
        let general = match surface.friction {
            Friction::None | Friction::Coulomb(_) => None,
            other => Some(other),
        };
        Self {
            factor,
            damping,
            floor: surface.floor(),
            friction,
            friction_slope: friction / slip_speed,
            slip_speed_squared: slip_speed * slip_speed,
            general,
        }
    }
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
    /// Any law, one lane after the other.
    General(Elastic),
}

/// A depth \[m\] that no power is taken below; the force there is nothing beside rounding.
const LEAST_DEPTH: f64 = 1e-30;

impl LaneElastic {
    fn new(law: &Law) -> Self {
        match law.prepared().power() {
            Some([stiffness, n]) if is(n, 1.0) => Self::Linear(stiffness),
            Some([stiffness, n]) if is(n, 1.5) => Self::Hertz(stiffness),
            Some([stiffness, n]) => Self::Power(stiffness, n, Box::new(FixedPower::new(n - 1.0))),
            None => Self::General(law.elastic),
        }
    }

    #[inline(always)]
    pub(super) fn force<S: Simd>(&self, w: Wide<S>, depth: Lane<S>) -> Lane<S> {
        match self {
            Self::Linear(stiffness) => w.splat(*stiffness) * depth,
            Self::Hertz(stiffness) => w.splat(*stiffness) * depth * depth.root(),
            Self::Power(stiffness, _, lower) => {
                w.splat(*stiffness) * depth * lower.of(w, depth.max(w.splat(LEAST_DEPTH)))
            }
            Self::General(law) => depth.one_by_one(|depth| general(*law, depth)),
        }
    }

    /// dg/dδ of lanes with a force g.
    #[inline(always)]
    pub(super) fn slope<S: Simd>(&self, w: Wide<S>, depth: Lane<S>, force: Lane<S>) -> Lane<S> {
        let exponent = match self {
            Self::Linear(_) => 1.0,
            Self::Hertz(_) => 1.5,
            Self::Power(_, n, _) => *n,
            Self::General(law) => return depth.one_by_one(|depth| slope(*law, depth)),
        };
        // k = n g/δ
        w.splat(exponent) * force * depth.max(w.splat(LEAST_DEPTH)).recip()
    }
}

/// Kept out of line: a general law is too long to be copied into every kernel.
#[inline(never)]
fn general(law: Elastic, depth: f64) -> f64 {
    if depth > 0.0 { law.force(depth) } else { 0.0 }
}

#[inline(never)]
fn slope(law: Elastic, depth: f64) -> f64 {
    law.stiffness(depth)
}

/// A flank on lanes.
#[derive(Clone, Debug)]
pub(super) struct LaneFlank {
    elastic: LaneElastic,
    /// 1/(2w) \[1/m\].
    scale: f64,
}

impl LaneFlank {
    /// Its law, and its share as [`Flank::share`](crate::Flank) has it.
    #[inline(always)]
    pub(super) fn elastic_and_share<S: Simd>(
        &self,
        w: Wide<S>,
        beyond: Lane<S>,
    ) -> (&LaneElastic, Lane<S>) {
        let x = beyond * w.splat(self.scale) + w.splat(0.5);
        let x = x.max(w.splat(0.0)).min(w.splat(1.0));
        (&self.elastic, x * x * (w.splat(3.0) - w.splat(2.0) * x))
    }
}

#[inline(always)]
#[expect(clippy::float_cmp, reason = "an exponent is chosen, not computed")]
fn is(exponent: f64, value: f64) -> bool {
    exponent == value
}
