//! Oil between two surfaces, on lanes: the law of [`Film`], whose comments say where the equations come from.
//!
//! ```text
//! open ──► in film, 0 < e < h_t ──► closed, e = h_t          e: what has been squeezed out of the film h_t at touch
//!
//! δ = −g − e,   ė = v(F(δ), h),   h = h_t − e + h_r          g: gap between the outer faces of film and roughness
//! e′ = e + h [(1 − θ) v + θ v′],   θ = ½ + ½ z/(z + 6),   z = h ∂v/∂e
//! ```
//!
//! Steps are longer than the time in which a thick film answers, and shorter than that of a thin one. θ follows the exponential of either:
//! where z is small this is the trapezoidal rule, and where it is large the implicit one. e′ is found by Newton's method, which
//! comes up to it from e. A film between parted surfaces is as thick as they let it be; it comes there in its time of refill.

use std::sync::LazyLock;

use chaindrive_contact::Film;
use chaindrive_contact::film::{BOUNDS, Shape, THICKENING};
use pulp::Simd;

use super::memory::{FAR, MemoryLanes};
use crate::lanes::{Lane, Polynomial, Wide};

/// Coefficients of the polynomials of t: the speed errs by 3e-4, what pressure takes from it by 2e-3 at most.
const TERMS: usize = 8;
const FEW: usize = 6;

/// The quantities of a [`Shape`] over 2 t − 1; the same for all films that do not leak.
static SHAPES: LazyLock<Shapes> = LazyLock::new(|| {
    let at = |u: f64| Shape::of(0.5 * (u + 1.0));
    Shapes {
        mobility: Polynomial::through(|u| at(u).mobility),
        peak: Polynomial::through(|u| at(u).peak),
        flatness: Polynomial::through(|u| at(u).flatness),
    }
});

#[derive(Clone, Debug)]
struct Shapes {
    mobility: Polynomial<TERMS>,
    peak: Polynomial<TERMS>,
    flatness: Polynomial<FEW>,
}

/// Change of e that is the last one: over what the whole step changes, and over h_t. What is left is at most a tenth of it, for the shape is
/// taken as constant, and mostly its square.
const FOUND: f64 = 1e-4;
const NOTHING: f64 = 1e-9;

/// Steps of Newton's method at most; it comes to an end after one to five.
const MOST: usize = 40;

/// P that is not divided by less.
const LEAST_PRESSING: f64 = 1e-30;

/// Least share of the seat, which has the film.
const LEAST_SHARE: f64 = 1e-9;

/// The law behind a film.
pub(super) trait ElasticBacking {
    /// Forces and stiffness \[N/m\] at some depths \[m\] in contacts of which the flank has this share.
    fn elastic<S: Simd>(
        &self,
        w: Wide<S>,
        depth: Lane<S>,
        share: Option<Lane<S>>,
    ) -> (LaneResponse<S>, Lane<S>);
}

/// Answer of elastic laws to a lane of depths, of whole contacts.
#[derive(Clone, Copy)]
pub(super) struct LaneResponse<S: Simd> {
    /// Force of the seat's law, and of seat and flank together \[N\].
    pub(super) on_seat: Lane<S>,
    pub(super) force: Lane<S>,
    /// ∂F/∂δ of both \[N/m\], where it has been asked for.
    pub(super) slope: Option<Lane<S>>,
}

/// A film, prepared.
#[derive(Clone, Debug)]
pub(crate) struct LaneFilm {
    film: Film,
    /// b/√(2R) \[√m\]
    reach: f64,
    /// 1/(8 η₀ L b³) \[1/(N s m²)\]
    mobility: f64,
    /// α/(L b) \[1/N\]
    pressing: f64,
    /// W/λ, Y/λ and the place between the limits.
    shapes: Shapes,
}

/// Gap that the elastic law sees through the film.
#[derive(Clone, Copy)]
pub(crate) struct FilmGap<S: Simd> {
    /// Gap that the law sees \[m\], negative where it presses.
    pub(crate) gap: Lane<S>,
    /// Speed at which the film drains \[m/s\].
    pub(super) draining: Lane<S>,
    /// Forces of the law, and the stiffness of law and film, if they are known: the law is not asked again.
    pub(super) elastic: Option<LaneResponse<S>>,
}

/// v, ∂v/∂F and −∂v/∂e of a lane.
struct LaneDraining<S: Simd> {
    speed: Lane<S>,
    by_force: Lane<S>,
    by_film: Lane<S>,
}

impl LaneFilm {
    pub(super) fn new(film: Film) -> Self {
        let strip = film.length * film.half_width;
        let leaking = |u: f64| {
            let shape = Shape {
                mobility: SHAPES.mobility.at(u),
                peak: SHAPES.peak.at(u),
                flatness: SHAPES.flatness.at(u),
            };
            (shape, film.leakage(0.5 * (u + 1.0), shape))
        };
        let over_leakage = |of: fn(Shape) -> f64| {
            Polynomial::through(|u| {
                let (shape, leakage) = leaking(u);
                of(shape) / leakage
            })
        };
        Self {
            film,
            reach: film.half_width / (2.0 * film.radius).sqrt(),
            mobility: 1.0 / (8.0 * film.viscosity * strip * film.half_width.powi(2)),
            pressing: film.pressure_coefficient / strip,
            shapes: Shapes {
                mobility: over_leakage(|it| it.mobility),
                peak: over_leakage(|it| it.peak),
                flatness: SHAPES.flatness,
            },
        }
    }

    /// Thickness at touch \[m\], by which contacts begin earlier.
    pub(crate) fn thickness(&self) -> f64 {
        self.film.thickness
    }

    /// Drain speeds of films \[m\] under forces \[N\], in contacts whose flank has this share.
    #[inline(always)]
    fn drain<S: Simd>(
        &self,
        w: Wide<S>,
        force: Lane<S>,
        film: Lane<S>,
        share: Option<Lane<S>>,
    ) -> LaneDraining<S> {
        let one = w.splat(1.0);
        // With a = √h and B = b/√(2R): s = B/a, t = B/(a + B)
        let root = film.sqrt();
        let both = root + w.splat(self.reach);
        let inverse = both.recip();
        let u = w.splat(2.0 * self.reach) * inverse - one;
        // v of Reynolds' equation without the effect of pressure: its mobility grows with the cube of a (a + B).
        let cube = root * both;
        let cube = cube * cube * cube;
        let mut mobility = w.splat(self.mobility) * cube * self.shapes.mobility.of(w, u);
        if let Some(share) = share {
            // On the flank, which bulges, there is next to no film.
            mobility = mobility * (one - share).max(w.splat(LEAST_SHARE)).recip();
        }
        // How much pressure thickens the oil, P, from the peak of the pressure.
        let inverse_root = root.recip();
        let pressing = w.splat(self.pressing) * both * inverse_root * self.shapes.peak.of(w, u);
        let pressing = (pressing * force).max(w.splat(LEAST_PRESSING));
        let flatness = self.shapes.flatness.of(w, u);
        let inverse_pressing = pressing.recip();
        // What the pressure leaves of the speed, m/P, and of its change with the force, between their two limits.
        let [mut level, mut slope] = [w.splat(0.0); 2];
        let weights = [one - flatness, flatness];
        for ((bound, [a, b, c]), weight) in BOUNDS.into_iter().zip(THICKENING).zip(weights) {
            let bound = w.splat(bound);
            let p = pressing.min(bound);
            let [a, b, c] = [a, b, c].map(|it| w.splat(it));
            // m/P and dm/dP
            let of_level = one - p * (a - p * (b - p * c));
            level = level.plus(weight, of_level * p * inverse_pressing);
            let [two, three, four] = [2.0, 3.0, 4.0].map(|it| w.splat(it));
            let of_slope = one - p * (two * a - p * (three * b - p * four * c));
            let of_slope = bound.greater(pressing).select(of_slope, w.splat(0.0));
            slope = slope.plus(weight, of_slope);
        }
        let speed = mobility * force * level;
        // ∂ ln v/∂h = 3 (2a + B)/(2 h (a + B)), the shape's own change apart.
        let steeper = w.splat(1.5) * (root + both) * inverse * inverse_root * inverse_root;
        LaneDraining {
            speed,
            by_force: mobility * slope,
            by_film: speed * steeper,
        }
    }

    /// Squeezes the films of a lane of contacts with these gaps, from the last accepted state until `dt` later.
    #[inline(always)]
    #[expect(
        clippy::too_many_arguments,
        reason = "lanes are handed on by value, and the rest is what they are reckoned with"
    )]
    pub(super) fn squeeze<S: Simd>(
        &self,
        w: Wide<S>,
        memory: &mut MemoryLanes<'_, S>,
        lane: usize,
        gap: Lane<S>,
        dt: f64,
        share: Option<Lane<S>>,
        behind: &impl ElasticBacking,
    ) -> FilmGap<S> {
        let (zero, one) = (w.splat(0.0), w.splat(1.0));
        let thickness = w.splat(self.film.thickness);
        let roughness = w.splat(self.film.roughness);
        let room = (-gap).max(zero).min(thickness);
        // A contact not tracked before starts open; at the start of a run the film is already squeezed to the room that the surfaces leave.
        let [gap_before, squeezed, draining] = memory.squeezed(lane);
        let known = w.splat(FAR).greater(gap_before);
        let begins = if dt > 0.0 { zero } else { room };
        let before = known.select(squeezed, begins);
        let rate_before = known.select(draining, zero);
        // Beyond rounding: a film that follows the surfaces is as thick as they let it be.
        let nothing = w.splat(NOTHING * self.film.thickness);
        let pressed = (-gap - nothing).greater(before);
        // A film between parted surfaces comes back to what they leave room for.
        let refill = self.film.refill_time;
        let parted = if refill > 0.0 {
            room.plus(before - room, w.splat(refill / (refill + dt)))
        } else {
            room
        };
        let step = w.splat(dt);
        // It goes on as it did, unless nothing would press then.
        let onwards = before.plus(step, rate_before).min(thickness);
        let onwards = (-gap).greater(onwards).select(onwards, before);
        let mut e = pressed.select(onwards, parted);
        let (mut rate, mut elastic) = (zero, None);
        // Newton's method for e′ of all lanes at once: a lane that has arrived stays, others go on.
        if pressed.any() {
            let mut theta = one;
            for round in 0..MOST {
                let depth = (-gap - e).max(zero);
                let (forces, stiffness) = behind.elastic(w, depth, share);
                let found = self.drain(w, forces.force, thickness - e + roughness, share);
                let steep = step * found.by_film.plus(found.by_force, stiffness);
                if round == 0 {
                    theta = share_of_end(w, steep);
                }
                rate = found.speed;
                // r = e′ − e − h [(1 − θ) v + θ v′],   dr/de′ = 1 + θ z
                let mean = rate_before.plus(theta, rate - rate_before);
                let excess = (e - before).minus(step, mean);
                let slope = one.plus(theta, steep);
                let next = (e - excess * slope.recip()).max(before).min(room);
                let change = pressed.select(next - e, zero);
                // k (1 + θ h ∂v/∂h)/(1 + θ z): as stiff as the law, less what the film drains more under more force.
                let softer = one.plus(theta * step, found.by_film) * slope.recip();
                // Of the last round, which changes nothing, they are those of e.
                elastic = Some(LaneResponse {
                    slope: Some(thickness.greater(e).select(stiffness * softer, stiffness)),
                    ..forces
                });
                let small = nothing.plus(w.splat(FOUND), (next - before).abs());
                let moves = change.abs().greater(small);
                e = moves.select(next, e);
                if !moves.any() {
                    break;
                }
            }
        }
        // Metal on metal drains nothing.
        let filmed = pressed & thickness.greater(e);
        let rate = filmed.select(rate, zero);
        memory.keep_squeezed(lane, e, rate);
        let seen = gap + e;
        FilmGap {
            gap: pressed.select(seen, seen.max(zero)),
            draining: rate,
            elastic,
        }
    }

    /// Speed \[m/s\] and its change with the force \[m/s/N\], one at a time.
    #[cfg(test)]
    pub(super) fn draining(&self, force: f64, film: f64) -> [f64; 2] {
        let w = Wide(pulp::Scalar);
        let found = self.drain(w, w.splat(force), w.splat(film), None);
        [found.speed.sum(), found.by_force.sum()]
    }
}

/// θ of z.
#[inline(always)]
fn share_of_end<S: Simd>(w: Wide<S>, z: Lane<S>) -> Lane<S> {
    let half = w.splat(0.5);
    half.plus(half * z, (z + w.splat(6.0)).recip())
}
