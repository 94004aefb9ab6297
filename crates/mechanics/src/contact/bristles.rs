//! Bristles that bend, on lanes: the law of [`Lugre`], whose comments say where the equations come from.
//!
//! ```text
//! γ = μ_c + (μ_s − μ_c) exp[−(v/v_s)²],   a = σ₀ |v| h/γ
//! z′ = z + (z_∞ − z) (1 − e⁻ᵃ),   z_∞ = γ sgn(v)/σ₀,   ż = v − σ₀ |v| z′/γ
//! f = −N (σ₀ z′ + σ₁ ż + σ₂ v)
//! ```

use chaindrive_contact::friction::Lugre;
use chaindrive_integrate::kernel;
use pulp::Simd;

use super::rubbing::Rubbing;
use crate::lanes::{Lane, Wide};

/// The law with its constants worked out.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bristles {
    /// μ_c, and μ_s − μ_c \[–\].
    coefficient: f64,
    surplus: f64,
    /// 1/v_s \[s/m\].
    slowness: f64,
    /// σ₀ \[1/m\], and 1/σ₀.
    pub(super) stiffness: f64,
    compliance: f64,
    /// σ₁ and σ₂ \[s/m\].
    damping: f64,
    viscosity: f64,
    /// Whether the law has viscous friction, σ₂ > 0.
    flows: bool,
}

impl Bristles {
    pub(super) fn new(law: Lugre) -> Self {
        Self {
            coefficient: law.coefficient,
            surplus: law.static_coefficient - law.coefficient,
            slowness: 1.0 / law.slip_speed,
            stiffness: law.stiffness,
            compliance: 1.0 / law.stiffness,
            damping: law.damping,
            viscosity: law.viscosity,
            flows: law.damping > 0.0 || law.viscosity > 0.0,
        }
    }

    /// Slope of the steady state at rest under normal forces \[N s/m\].
    #[inline(always)]
    pub(super) fn at_rest<S: Simd>(&self, w: Wide<S>, normal: Lane<S>) -> Lane<S> {
        w.splat(self.viscosity) * normal
    }

    /// Friction after `dt` at constant normal force and slip, and the deflection then; none where the first number is not positive.
    #[inline(always)]
    pub(super) fn rub<S: Simd>(
        &self,
        w: Wide<S>,
        dt: f64,
        contact: [Lane<S>; 2],
        slip: Lane<S>,
        before: Lane<S>,
    ) -> (Rubbing<S>, Lane<S>) {
        let [force, drag, deflection] = self.bend(w, dt, contact, slip, before);
        // It sticks by itself, and its slope knows how: the secant is no steeper.
        let rubbing = Rubbing {
            force,
            drag,
            secant: drag,
            steepest: drag,
        };
        (rubbing, deflection)
    }

    /// The same as force, slope and deflection.
    #[inline(always)]
    fn bend<S: Simd>(
        &self,
        w: Wide<S>,
        dt: f64,
        [touching, normal]: [Lane<S>; 2],
        slip: Lane<S>,
        before: Lane<S>,
    ) -> [Lane<S>; 3] {
        let (zero, one) = (w.splat(0.0), w.splat(1.0));
        // Open contacts have no normal force, and their bristles are straight.
        let touching = touching.greater(zero);
        let normal = touching.select(normal, zero);
        let [stiffness, compliance] = [self.stiffness, self.compliance].map(|x| w.splat(x));
        let speed = slip.abs();
        let moves = speed.greater(zero);
        let sign = moves.select(slip.greater(zero).select(one, -one), zero);
        // γ and dγ/dv, over γ
        let share = slip * w.splat(self.slowness);
        let surplus = w.splat(self.surplus) * (one + (share * share).decay());
        let level = w.splat(self.coefficient) + surplus;
        let inverse = level.recip();
        let slope = w.splat(-2.0 * self.slowness) * share * surplus;
        let bending = slope * inverse;
        // σ₀/γ
        let stiff = stiffness * inverse;
        let bound = stiff * speed;
        let left = (bound * w.splat(dt)).decay();
        // 1 − e⁻ᵃ: the share of the way to the steady deflection that has passed.
        let passed = -left;
        let deflection = before.plus(sign * level * compliance - before, passed);
        // As the law has it: dz′/dv.
        let pulled = sign.minus(stiff, before) * sign.minus(speed, bending);
        let swing = w.splat(dt) * moves.select(pulled, one);
        let bend = (passed * sign * slope * compliance).plus(one + left, swing);
        // f/N, and −df/dv of it
        let mut force = stiffness * deflection;
        let mut drag = stiffness * bend;
        if self.flows {
            let [damping, viscosity] = [self.damping, self.viscosity].map(|x| w.splat(x));
            // ż, and dż/dv
            let rate = slip.minus(bound, deflection);
            let moved = (sign * deflection).plus(speed, bend.minus(deflection, bending));
            let change = one.minus(stiff, moved);
            force = force.plus(damping, rate).plus(viscosity, slip);
            drag = (drag + viscosity).plus(damping, change);
        }
        let drag = (normal * drag).max(zero);
        [-(normal * force), drag, touching.select(deflection, zero)]
    }
}

/// The bristles of many contacts, all in whole lanes.
pub(crate) struct Sweep<'a> {
    pub(crate) law: &'a Bristles,
    /// Since the accepted state \[s\].
    pub(crate) dt: f64,
    /// Normal forces \[N\], zero where there is no contact, and slips \[m/s\].
    pub(crate) normal: &'a [f64],
    pub(crate) slip: &'a [f64],
    /// Levers of the contacts \[m\].
    pub(crate) lever: &'a [f64],
    /// Deflections at the accepted state, and now.
    pub(crate) before: &'a [f64],
    pub(crate) now: &'a mut [f64],
    /// Torques \[N m\] that those of the friction are added to, and slopes −∂M/∂ω that the steepest is looked for with.
    pub(crate) torque: &'a mut [f64],
    pub(crate) beside: &'a [f64],
}

kernel!(
    /// Friction power \[W\], energy stored in the bristles \[J\], and the steepest slope −∂M/∂ω \[N m s/rad\].
    pub(crate) fn swept<'a, S: Simd>(w: Wide<S>, contacts: Sweep<'a>) -> [f64; 3] {
        let Sweep { law, dt, .. } = contacts;
        let mut sums = [w.splat(0.0); 3];
        let half = w.splat(0.5 * law.stiffness);
        let [normals, slips, levers] =
            [contacts.normal, contacts.slip, contacts.lever].map(|all| w.lanes(all));
        let [before, beside] = [contacts.before, contacts.beside].map(|all| w.lanes(all));
        let mut now = Wide::<S>::lanes_mut(contacts.now);
        let mut torque = Wide::<S>::lanes_mut(contacts.torque);
        for i in 0..contacts.normal.len() / Wide::<S>::COUNT {
            let (normal, slip, lever) = (normals.get(i), slips.get(i), levers.get(i));
            let [force, drag, deflection] = law.bend(w, dt, [normal, normal], slip, before.get(i));
            now.set(i, deflection);
            torque.add(i, lever * force);
            sums[0] += -(force * slip);
            // U = ½ σ₀ N z²
            sums[1] += half * normal * (deflection * deflection);
            sums[2] = sums[2].max(lever * lever * drag + beside.get(i));
        }
        let [power, held, steepest] = sums;
        [power.sum(), held.sum(), steepest.largest()]
    }
);

#[cfg(test)]
mod tests {
    use chaindrive_integrate::Registers;
    use pulp::WithSimd;

    use super::*;
    use crate::lanes::LANES;

    kernel!(
        fn checked<S: Simd>(w: Wide<S>, law: Lugre) {
            let lanes = Bristles::new(law);
            let limit = law.static_coefficient / law.stiffness;
            for dt in [0.0, 1e-9, 1e-6, 1e-4, 1e-2] {
                for i in -60_i32..=60 {
                    let speed = 10.0_f64.powf(-12.0 + 0.23 * f64::from(i.abs()));
                    let slip = f64::from(i.signum()) * speed;
                    for state in [-1.0, -0.4, 0.0, 0.7, 1.0] {
                        let (normal, state) = (321.0, state * limit);
                        let exact = law.rub(normal, slip, state, dt);
                        let [normal, slip_lane] = [normal, slip].map(|x| w.splat(x));
                        let touching = [w.splat(1e-6), normal];
                        let before = w.splat(state);
                        let (found, after) = lanes.rub(w, dt, touching, slip_lane, before);
                        let scale = law.stiffness * limit * 321.0;
                        let steep = 321.0 * (law.damping + law.viscosity + law.stiffness * dt);
                        for (found, exact, scale) in [
                            (found.force, exact.force, scale.max(exact.force.abs())),
                            (found.drag, exact.damping, steep.max(exact.damping)),
                            (after, exact.state, limit),
                        ] {
                            let found: [f64; LANES] = found.numbers();
                            let error = (found[0] - exact).abs();
                            // The error of rounding grows with σ₁ σ₀ |v| z/γ, which cancels v.
                            assert!(error <= 1e-13 * scale, "{slip} {state} {dt}: {error:e}");
                        }
                        let open = [w.splat(0.0), normal];
                        let (none, after) = lanes.rub(w, dt, open, slip_lane, before);
                        let sum = none.force.abs() + none.drag + after.abs();
                        assert!(sum.sum().abs() <= 0.0);
                    }
                }
            }
        }
    );

    /// As the law itself, over all slips and steps.
    #[test]
    fn lanes_find_what_the_law_says() {
        let dry = Lugre {
            static_coefficient: 0.2,
            coefficient: 0.1,
            slip_speed: 0.01,
            stiffness: 1e5,
            damping: 0.0,
            viscosity: 0.0,
        };
        let damped = Lugre {
            damping: 30.0,
            viscosity: 0.4,
            stiffness: 1e6,
            ..dry
        };
        for law in [dry, damped] {
            checked(law).with_simd(pulp::Scalar);
            Registers::in_use().dispatch(checked(law));
        }
    }
}
