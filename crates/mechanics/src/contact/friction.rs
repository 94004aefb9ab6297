//! Laws of friction on lanes.

use chaindrive_contact::{Friction, Rub};
use pulp::Simd;

use super::bristles::Bristles;
use super::journal::LaneJournal;
use super::rubbing::Rubbing;
use super::stick_slip::{Holding as _, LaneSpring};
use crate::lanes::{LANES, Lane, Wide};

/// A friction law on lanes.
#[derive(Clone, Copy, Debug)]
pub(crate) enum LaneFriction {
    None,
    Coulomb {
        /// μ \[–\]
        coefficient: f64,
        /// Square of the regularising slip speed \[m²/s²\].
        slip_speed_squared: f64,
        /// Slope at rest per normal force, μ/v_s \[s/m\].
        slope: f64,
    },
    /// A spring and a slider.
    SpringSlider(LaneSpring),
    /// Bristles that bend.
    Bristles(Bristles),
    /// A lubricated journal.
    Journal(LaneJournal),
    /// Any other law, one lane after the other.
    General(Friction),
}

impl LaneFriction {
    pub(crate) fn new(friction: Friction) -> Self {
        match friction {
            Friction::None => Self::None,
            Friction::Coulomb(coulomb) => Self::Coulomb {
                coefficient: coulomb.coefficient,
                slip_speed_squared: coulomb.slip_speed * coulomb.slip_speed,
                slope: coulomb.coefficient / coulomb.slip_speed,
            },
            Friction::SpringSlider(spring) => {
                Self::SpringSlider(LaneSpring::new(spring.coefficient, spring.stiffness))
            }
            Friction::Lugre(law) => Self::Bristles(Bristles::new(law)),
            Friction::Stribeck(law) => Self::Journal(LaneJournal::new(law)),
            other => Self::General(other),
        }
    }

    /// Slope at rest under normal forces \[N s/m\].
    #[inline(always)]
    pub(super) fn at_rest<S: Simd>(&self, w: Wide<S>, force: Lane<S>) -> Lane<S> {
        match self {
            Self::None | Self::SpringSlider(_) => w.splat(0.0),
            Self::Coulomb { slope, .. } => w.splat(*slope) * force,
            Self::Bristles(bristles) => bristles.at_rest(w, force),
            Self::Journal(journal) => w.splat(journal.oil()),
            Self::General(friction) => force.one_by_one(|force| friction.damping(force, 0.0)),
        }
    }

    /// Friction under these normal forces at these slip speeds, `dt` after the accepted state, and its state then. There is
    /// a contact where the first number is positive.
    #[inline(always)]
    pub(crate) fn rub<S: Simd, const LONG: bool>(
        &self,
        w: Wide<S>,
        dt: f64,
        [touching, normal]: [Lane<S>; 2],
        slip: Lane<S>,
        before: Lane<S>,
    ) -> (Rubbing<S>, Lane<S>) {
        let zero = w.splat(0.0);
        match self {
            Self::None => (Rubbing::none(w), zero),
            Self::Coulomb {
                coefficient,
                slip_speed_squared,
                slope,
            } => {
                // f = −μ F v/√(v² + v_s²),   −∂f/∂v = μ F v_s²/√(v² + v_s²)³
                let regular = w.splat(*slip_speed_squared);
                let inverse = regular.plus(slip, slip).inverse_root();
                let limit = w.splat(*coefficient) * normal;
                let secant = limit * inverse;
                let rubbing = Rubbing {
                    force: -(limit * slip * inverse),
                    drag: secant * regular * inverse * inverse,
                    secant,
                    steepest: w.splat(*slope) * normal,
                };
                (rubbing, zero)
            }
            Self::SpringSlider(spring) => {
                spring.slide(w, dt, spring.limit(w, normal, slip), slip, before)
            }
            // As with elastic laws.
            _ if !LONG => (Rubbing::unknown(w), zero),
            Self::Bristles(bristles) => bristles.rub(w, dt, [touching, normal], slip, before),
            Self::Journal(journal) => journal.rub(w, dt, [touching, normal], slip, before),
            Self::General(friction) => one_by_one(w, friction, [touching, normal], slip),
        }
    }

    /// Whether the law is long: see [`SurfaceLaw::is_long`](super::SurfaceLaw::is_long).
    pub(crate) fn is_long(&self) -> bool {
        matches!(
            self,
            Self::Bristles(_) | Self::Journal(_) | Self::General(_)
        )
    }

    /// Dashpot \[N s/m\] beside the spring that alone holds what sticks; none for other laws.
    pub(crate) fn beside_spring(&self) -> Option<f64> {
        match self {
            Self::SpringSlider(_) => Some(0.0),
            Self::Journal(journal) => Some(journal.oil()),
            _ => None,
        }
    }

    /// Whether it has a state.
    #[inline(always)]
    pub(super) fn remembers(&self) -> bool {
        matches!(
            self,
            Self::SpringSlider(_) | Self::Bristles(_) | Self::Journal(_)
        )
    }

    /// Stiffness along the surface of what sticks under a normal force \[N/m\].
    pub(crate) fn stiffness(&self, normal: f64) -> f64 {
        match self {
            Self::None | Self::Coulomb { .. } | Self::General(_) => 0.0,
            Self::SpringSlider(spring) => spring.stiffness,
            Self::Journal(journal) => journal.spring().stiffness,
            Self::Bristles(bristles) => bristles.stiffness * normal,
        }
    }

    #[inline(always)]
    pub(crate) fn acts(&self) -> bool {
        !matches!(self, Self::None)
    }
}

/// Friction of any law without a state.
#[inline(always)]
fn one_by_one<S: Simd>(
    w: Wide<S>,
    friction: &Friction,
    [touching, normal]: [Lane<S>; 2],
    slip: Lane<S>,
) -> (Rubbing<S>, Lane<S>) {
    let [mut rub, mut drag, mut secant] = [[0.0; LANES]; 3];
    normal.store(&mut rub, 0);
    slip.store(&mut drag, 0);
    // In the place of the answer: what says where there is a contact.
    touching.store(&mut secant, 0);
    rub_one_by_one(
        friction,
        [&mut rub, &mut drag, &mut secant].map(|lane| &mut lane[..Wide::<S>::COUNT]),
    );
    let drag = w.load(&drag, 0);
    let rubbing = Rubbing {
        force: w.load(&rub, 0),
        drag,
        secant: w.load(&secant, 0),
        steepest: drag,
    };
    (rubbing, w.splat(0.0))
}

/// Turns normal forces into friction forces and slips into slopes; kept out of line like the laws.
#[inline(never)]
fn rub_one_by_one(friction: &Friction, lanes: [&mut [f64]; 3]) {
    let [force, slip, secant] = lanes;
    for ((force, slip), secant) in force.iter_mut().zip(slip).zip(secant) {
        if *secant <= 0.0 {
            (*force, *slip, *secant) = (0.0, 0.0, 0.0);
            continue;
        }
        let Rub {
            force: rub,
            damping,
            ..
        } = friction.rub(*force, *slip, 0.0, 0.0);
        *secant = if slip.abs() < f64::MIN_POSITIVE {
            damping
        } else {
            damping.max(-rub / *slip)
        };
        (*force, *slip) = (rub, damping);
    }
}
