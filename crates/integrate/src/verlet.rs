//! Velocity Verlet with velocities predicted for the force evaluation.

use crate::finite::Watch;
use crate::kernel;
use crate::registers::Registers;
use crate::state::{Size, Snapshot, State};
use crate::{Moment, Prediction, SecondOrderSystem};

/// Limit of ωh.
pub(crate) const LIMIT: f64 = 2.0;

/// Work space of the method.
#[derive(Clone, Debug)]
pub(crate) struct Verlet {
    /// Predicted states.
    states: Vec<f64>,
    /// The processor's vector unit.
    registers: Registers,
}

impl Verlet {
    pub(crate) fn new(size: Size) -> Self {
        Self {
            states: vec![0.0; size.states],
            registers: Registers::in_use(),
        }
    }

    /// Makes a candidate h \[s\] ahead; false if a position or velocity is not finite.
    ///
    /// ```text
    /// q⁺ = q + h v + ½ h² a
    /// v* = v + h a                z* = z + h ż
    /// a⁺ = a(t + h, q⁺, v*, z*)
    /// v⁺ = v + ½ h (a + a⁺)       z⁺ = z + ½ h (ż + ż⁺)
    /// ```
    ///
    /// Of second order although a⁺ and ż⁺ belong to v* and z*: what is predicted is off by O(h²). With damping
    /// λ the scheme is stable for (ωh)²/4 + λh < 1, and a state that settles as e^(−λt) is for λh < 1. Damping that the system
    /// takes at v⁺ instead of v* does not limit the step, whatever its λ.
    ///
    /// # Source
    /// W. C. Swope et al., *J. Chem. Phys.* **76**, 1982, 637–649,
    /// <https://doi.org/10.1063/1.442716>; the prediction for dissipative forces after
    /// R. D. Groot and P. B. Warren, *J. Chem. Phys.* **107**, 1997, 4423–4435.
    pub(crate) fn attempt<S: SecondOrderSystem>(
        &mut self,
        system: &S,
        from: &State,
        h: f64,
        to: &mut Snapshot,
        record: &mut S::Record,
    ) -> bool {
        to.t = from.t + h;
        // What is predicted stands where the velocities will: every array less leaves the others nearer to the processor.
        // Infinity and NaN get into the velocities from wherever they arise: watching those is enough.
        self.registers
            .dispatch(drift(h, from, &mut to.q, &mut to.v));
        // States of first order are predicted as velocities are.
        let flow = from.flow();
        for ((predicted, z), flow) in self.states.iter_mut().zip(&from.z).zip(flow) {
            // z* = z + h ż
            *predicted = z + h * flow;
        }
        let end = Moment {
            t: to.t,
            q: &to.q,
            v: &to.v,
            z: &self.states,
        };
        // The system may take damping at the end of the step: for that it is told what velocities were predicted from.
        let prediction = Prediction {
            half_step: 0.5 * h,
            a: &from.a,
            flow,
        };
        system.evaluate_predicted(end, prediction, &mut to.a, &mut to.rates, record);
        // Quadratures go on as velocities do: y⁺ = y + ½ h (r + r⁺)
        let moved = kick(h, &from.v, [&from.a, &to.a], &mut to.v);
        let mut watch = self.registers.dispatch(moved);
        let rates = [&from.rates[..], &to.rates[..]];
        let counted = kick(h, &from.quadratures, rates, &mut to.quadratures);
        watch.take(self.registers.dispatch(counted));
        let flows = flow.iter().zip(&to.rates[to.quadratures.len()..]);
        for ((z, before), (r0, r1)) in to.z.iter_mut().zip(&from.z).zip(flows) {
            // z⁺ = z + ½ h (ż + ż⁺)
            *z = before + 0.5 * h * (r0 + r1);
            watch.see(*z);
        }
        watch.all_finite()
    }
}

kernel!(
    /// Positions and predicted velocities.
    fn drift<'a, S: Simd>(
        simd: S,
        h: f64,
        from: &'a State,
        q: &'a mut [f64],
        predicted: &'a mut [f64],
    ) {
        let n = q.len();
        let (q0, q1) = S::as_simd_f64s(&from.q[..n]);
        let (v0, v1) = S::as_simd_f64s(&from.v[..n]);
        let (a0, a1) = S::as_simd_f64s(&from.a[..n]);
        let (q, q_rest) = S::as_mut_simd_f64s(q);
        let (p, p_rest) = S::as_mut_simd_f64s(&mut predicted[..n]);
        let [step, half] = [h, 0.5 * h].map(|x| simd.splat_f64s(x));
        // Not fused: a processor without the instruction would call a function for it.
        let plus = |a, x, y| simd.add_f64s(simd.mul_f64s(a, x), y);
        for i in 0..q.len() {
            // q⁺ = q + h v + ½ h² a,   v* = v + h a
            q[i] = plus(step, plus(half, a0[i], v0[i]), q0[i]);
            p[i] = plus(step, a0[i], v0[i]);
        }
        for i in 0..q_rest.len() {
            q_rest[i] = q1[i] + h * (v1[i] + 0.5 * h * a1[i]);
            p_rest[i] = v1[i] + h * a1[i];
        }
    }
);

kernel!(
    /// Velocities by the trapezoidal rule, from their rates at both ends. Infinity and NaN show in the sum of 0 × everything.
    fn kick<'a, S: Simd>(
        simd: S,
        h: f64,
        from: &'a [f64],
        rates: [&'a [f64]; 2],
        v: &'a mut [f64],
    ) -> Watch {
        let n = v.len();
        let (v0, v1) = S::as_simd_f64s(&from[..n]);
        let [(a0, a1), (b0, b1)] = rates.map(|rates| S::as_simd_f64s(&rates[..n]));
        let (v, v_rest) = S::as_mut_simd_f64s(v);
        let [zero, half] = [0.0, 0.5 * h].map(|x| simd.splat_f64s(x));
        let plus = |a, x, y| simd.add_f64s(simd.mul_f64s(a, x), y);
        let mut seen = zero;
        for i in 0..v.len() {
            // v⁺ = v + ½ h (a + a⁺)
            v[i] = plus(half, simd.add_f64s(a0[i], b0[i]), v0[i]);
            seen = plus(v[i], zero, seen);
        }
        let mut watch = Watch::default();
        watch.see(simd.reduce_sum_f64s(seen));
        for i in 0..v_rest.len() {
            v_rest[i] = v1[i] + 0.5 * h * (a1[i] + b1[i]);
            watch.see(v_rest[i]);
        }
        watch
    }
);
