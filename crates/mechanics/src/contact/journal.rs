//! A lubricated journal, on lanes: the law of [`Stribeck`], whose comments say where the equations come from.
//!
//! ```text
//! |z′| ≤ μ N/[1 + (S/S_t)²]/k,   S/S_t = (2 η L/S_t) |v|/N
//! f = −k z′ − 2 π η L v/ψ
//! ```

use chaindrive_contact::friction::Stribeck;
use pulp::Simd;

use super::rubbing::Rubbing;
use super::stick_slip::{Holding, LaneSpring};
use crate::lanes::{Lane, Wide};

/// The law with its constants worked out.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LaneJournal {
    spring: LaneSpring,
    /// 2 η L/S_t \[N s/m\]
    fading: f64,
    /// 2 π η L/ψ \[N s/m\]
    oil: f64,
}

/// A normal force \[N\] that nothing is divided by less than.
const LEAST_FORCE: f64 = 1e-12;

impl LaneJournal {
    pub(super) fn new(law: Stribeck) -> Self {
        Self {
            spring: LaneSpring::new(law.coefficient, law.stiffness),
            fading: law.fading(),
            oil: law.oil(),
        }
    }

    /// Friction after `dt` at constant normal force and slip, and the deflection then; none where the first number is not positive.
    #[inline(always)]
    pub(super) fn rub<S: Simd>(
        &self,
        w: Wide<S>,
        dt: f64,
        [touching, normal]: [Lane<S>; 2],
        slip: Lane<S>,
        before: Lane<S>,
    ) -> (Rubbing<S>, Lane<S>) {
        let zero = w.splat(0.0);
        let touching = touching.greater(zero);
        let normal = touching.select(normal, zero);
        let limit = self.limit(w, normal, slip);
        let (metal, deflection) = self.spring.slide(w, dt, limit, slip, before);
        let oil = touching.select(w.splat(self.oil), zero);
        let rubbing = Rubbing {
            force: metal.force.minus(oil, slip),
            drag: metal.drag + oil,
            secant: metal.secant + oil,
            steepest: metal.steepest + oil,
        };
        (rubbing, deflection)
    }
}

impl Holding for LaneJournal {
    const OILED: bool = true;

    #[inline(always)]
    fn spring(&self) -> LaneSpring {
        self.spring
    }

    #[inline(always)]
    fn oil(&self) -> f64 {
        self.oil
    }

    #[inline(always)]
    fn limit<S: Simd>(&self, w: Wide<S>, normal: Lane<S>, slip: Lane<S>) -> Lane<S> {
        // 1/(1 + x²) = 1 − u²/(N² + u²),   u = x N = (2 η L/S_t) v: without oil nothing fades.
        let load = normal.max(w.splat(LEAST_FORCE));
        let speed = w.splat(self.fading) * slip;
        let square = speed * speed;
        let left = w.splat(1.0).minus(square, square.plus(load, load).recip());
        self.spring.limit(w, normal, slip) * left
    }
}

#[cfg(test)]
mod tests {
    use chaindrive_integrate::{Registers, kernel};
    use pulp::WithSimd;

    use super::*;
    use crate::lanes::LANES;

    kernel!(
        fn checked<S: Simd>(w: Wide<S>, law: Stribeck) {
            let lanes = LaneJournal::new(law);
            for dt in [0.0, 1e-7, 1e-4] {
                for i in -60_i32..=60 {
                    let speed = 10.0_f64.powf(-9.0 + 0.16 * f64::from(i.abs()));
                    let slip = f64::from(i.signum()) * speed;
                    for (normal, state) in [(321.0, -1e-7), (321.0, 0.0), (0.0, 2e-7), (9e3, 3e-8)]
                    {
                        let exact = law.rub(normal, slip, state, dt);
                        let [force, slip_lane, before] = [normal, slip, state].map(|x| w.splat(x));
                        let (found, after) =
                            lanes.rub(w, dt, [w.splat(1e-6), force], slip_lane, before);
                        let limit = law.coefficient * normal;
                        for (found, exact, scale) in [
                            (found.force, exact.force, limit),
                            (found.drag, exact.damping, 0.0),
                            (after, exact.state, limit / law.stiffness),
                        ] {
                            let found: [f64; LANES] = found.numbers();
                            let error = (found[0] - exact).abs();
                            assert!(
                                error <= 1e-13 * exact.abs().max(scale),
                                "{normal} {slip} {dt}: {error:e}"
                            );
                        }
                        let (none, after) =
                            lanes.rub(w, dt, [w.splat(0.0), force], slip_lane, before);
                        let sum = none.force.abs() + none.drag + after.abs();
                        assert!(sum.sum().abs() <= 0.0);
                    }
                }
            }
        }
    );

    /// As the law itself, over all slips and loads.
    #[test]
    fn lanes_find_what_the_law_says() {
        let law = Stribeck {
            coefficient: 0.12,
            transition: 1e-6,
            viscosity: 0.05,
            length: 0.02,
            relative_clearance: 0.01,
            stiffness: 1e8,
        };
        checked(law).with_simd(pulp::Scalar);
        Registers::in_use().dispatch(checked(law));
    }
}
