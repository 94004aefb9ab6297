//! What a body answers to indentation, taken apart once into what lanes need.

use chaindrive_contact::dissipation::Action;
use chaindrive_contact::elastic::ElasticLaw;
use chaindrive_contact::{Elastic, Friction};
use pulp::Simd;

use crate::drive::{Flank, Surface};
use crate::lanes::{Lane, Wide};

/// The laws of one body.
#[derive(Clone, Copy, Debug)]
pub(super) struct Answer {
    pub(super) elastic: LaneElastic,
    pub(super) numbers: LawNumbers,
    /// What is different on flanks.
    pub(super) flank: Option<LaneFlank>,
}

impl Answer {
    pub(super) fn new(surface: &Surface, flank: Option<Flank>) -> Self {
        Self {
            elastic: LaneElastic::new(surface.law.elastic),
            numbers: LawNumbers::new(surface),
            flank: flank.map(|flank| LaneFlank {
                elastic: LaneElastic::new(flank.elastic),
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
#[derive(Clone, Copy, Debug)]
pub(super) enum LaneElastic {
    /// g = K δ
    Linear(f64),
    /// g = K δ √δ
    Hertz(f64),
    /// Any law, one lane after the other.
    General(Elastic),
}

impl LaneElastic {
    fn new(law: Elastic) -> Self {
        match law {
            Elastic::Power(power) if is(power.exponent, 1.0) => Self::Linear(power.stiffness),
            Elastic::Power(power) if is(power.exponent, 1.5) => Self::Hertz(power.stiffness),
            law => Self::General(law),
        }
    }

    #[inline(always)]
    pub(super) fn force<S: Simd>(self, w: Wide<S>, depth: Lane<S>) -> Lane<S> {
        match self {
            Self::Linear(stiffness) => w.splat(stiffness) * depth,
            Self::Hertz(stiffness) => w.splat(stiffness) * depth * depth.root(),
            Self::General(law) => depth.one_by_one(|depth| general(law, depth)),
        }
    }
}

/// Kept out of line: a general law is too long to be copied into every kernel.
#[inline(never)]
fn general(law: Elastic, depth: f64) -> f64 {
    if depth > 0.0 { law.force(depth) } else { 0.0 }
}

/// A flank on lanes.
#[derive(Clone, Copy, Debug)]
pub(super) struct LaneFlank {
    elastic: LaneElastic,
    /// 1/(2w) \[1/m\].
    scale: f64,
}

impl LaneFlank {
    /// Its law, and its share as [`Flank::share`](crate::Flank) has it.
    #[inline(always)]
    pub(super) fn elastic_and_share<S: Simd>(
        self,
        w: Wide<S>,
        beyond: Lane<S>,
    ) -> (LaneElastic, Lane<S>) {
        let x = beyond * w.splat(self.scale) + w.splat(0.5);
        let x = x.max(w.splat(0.0)).min(w.splat(1.0));
        (self.elastic, x * x * (w.splat(3.0) - w.splat(2.0) * x))
    }
}

#[inline(always)]
#[expect(clippy::float_cmp, reason = "an exponent is chosen, not computed")]
fn is(exponent: f64, value: f64) -> bool {
    exponent == value
}
