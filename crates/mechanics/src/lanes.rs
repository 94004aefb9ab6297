//! Several numbers at a time, as many as the processor's registers hold.
//!
//! A kernel is written once, generic over [`Simd`], and compiled for every kind of processor;
//! which one runs is decided when the system is built. A product and a sum are rounded once where the code says so and the
//! processor can, and sums are taken in a fixed order: the same machine gives the same bits.

mod decay;
mod logarithm;
mod octaves;
mod polynomial;
mod power;
mod turn;

use std::ops::{Add, AddAssign, BitAnd, Mul, Neg, Sub};

use pulp::{Simd, WithSimd};

pub(crate) use polynomial::Polynomial;
pub(crate) use power::FixedPower;

/// Largest number of lanes of any processor: what arrays are padded to.
pub(crate) const LANES: usize = 8;

/// Stands for zero under a root. Half of the smallest normal number would not be normal, and a hundred times slower.
const TINY: f64 = 1e-200;

/// The bit of the sign.
const SIGN: u64 = 1 << 63;

/// `n` rounded up to whole lanes.
pub(crate) const fn padded(n: usize) -> usize {
    n.div_ceil(LANES) * LANES
}

/// Says that the branch it is called in is rarely taken. What a call in there needs on the stack is put there in that branch, not before it.
#[cold]
#[inline(never)]
pub(crate) fn rarely() {}

/// The instructions of one kind of processor, for code that is compiled for that kind; seen when it is compiled.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn kind<S: Simd, Kind: Copy + 'static>(simd: S) -> Option<Kind> {
    (&simd as &dyn std::any::Any)
        .downcast_ref::<Kind>()
        .copied()
}

/// The processor's vector unit: makes lanes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wide<S: Simd>(pub(crate) S);

/// Numbers side by side.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lane<S: Simd> {
    simd: S,
    v: S::f64s,
}

/// An array seen lane by lane; what does not fill a lane is left out.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lanes<'a, S: Simd> {
    simd: S,
    whole: &'a [S::f64s],
}

/// An array written lane by lane.
#[derive(Debug)]
pub(crate) struct LanesMut<'a, S: Simd> {
    whole: &'a mut [S::f64s],
}

/// Truth values side by side.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mask<S: Simd> {
    simd: S,
    m: S::m64s,
}

impl<S: Simd> From<S> for Wide<S> {
    #[inline(always)]
    fn from(simd: S) -> Self {
        Self(simd)
    }
}

impl<S: Simd> Wide<S> {
    /// Number of lanes of this processor; divides [`LANES`].
    pub(crate) const COUNT: usize = S::F64_LANES;

    #[inline(always)]
    fn lane(self, v: S::f64s) -> Lane<S> {
        Lane { simd: self.0, v }
    }

    #[inline(always)]
    pub(crate) fn splat(self, value: f64) -> Lane<S> {
        self.lane(self.0.splat_f64s(value))
    }

    /// The numbers from `start` on.
    #[inline(always)]
    pub(crate) fn load(self, slice: &[f64], start: usize) -> Lane<S> {
        let (whole, _) = S::as_simd_f64s(&slice[start..start + Self::COUNT]);
        self.lane(whole[0])
    }

    /// Looks at an array once, for loops without further checks of its length.
    #[inline(always)]
    pub(crate) fn lanes(self, slice: &[f64]) -> Lanes<'_, S> {
        let (simd, (whole, _)) = (self.0, S::as_simd_f64s(slice));
        Lanes { simd, whole }
    }

    /// The same for writing.
    #[inline(always)]
    pub(crate) fn lanes_mut(slice: &mut [f64]) -> LanesMut<'_, S> {
        let (whole, _) = S::as_mut_simd_f64s(slice);
        LanesMut { whole }
    }

    /// Calls what shall not be part of the loop that calls it, compiled for the same kind of processor.
    #[inline(always)]
    pub(crate) fn call<Op: WithSimd>(self, op: Op) -> Op::Output {
        self.0.vectorize(op)
    }

    /// True in the first `count` lanes.
    #[inline(always)]
    pub(crate) fn first(self, count: usize) -> Mask<S> {
        const PLACES: [f64; LANES] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];
        self.splat(count as f64).greater(self.load(&PLACES, 0))
    }
}

impl<S: Simd> Lanes<'_, S> {
    #[inline(always)]
    pub(crate) fn get(&self, lane: usize) -> Lane<S> {
        Wide(self.simd).lane(self.whole[lane])
    }
}

impl<S: Simd> LanesMut<'_, S> {
    #[inline(always)]
    pub(crate) fn get(&self, w: Wide<S>, lane: usize) -> Lane<S> {
        w.lane(self.whole[lane])
    }

    #[inline(always)]
    pub(crate) fn set(&mut self, lane: usize, value: Lane<S>) {
        self.whole[lane] = value.v;
    }

    /// Adds to a lane.
    #[inline(always)]
    pub(crate) fn add(&mut self, lane: usize, value: Lane<S>) {
        let sum = Wide(value.simd).lane(self.whole[lane]) + value;
        self.whole[lane] = sum.v;
    }
}

impl<S: Simd> LanesMut<'_, S> {
    /// Adds a product to a lane.
    #[inline(always)]
    pub(crate) fn add_product(&mut self, lane: usize, a: Lane<S>, b: Lane<S>) {
        let sum = Wide(a.simd).lane(self.whole[lane]).plus(a, b);
        self.whole[lane] = sum.v;
    }
}

impl<S: Simd> Lane<S> {
    #[inline(always)]
    fn with(self, v: S::f64s) -> Self {
        Self { simd: self.simd, v }
    }

    #[inline(always)]
    pub(crate) fn store(self, slice: &mut [f64], start: usize) {
        let (whole, _) = S::as_mut_simd_f64s(&mut slice[start..start + Wide::<S>::COUNT]);
        whole[0] = self.v;
    }

    /// The numbers, and zeros after them.
    #[inline(always)]
    pub(crate) fn numbers(self) -> [f64; LANES] {
        let mut numbers = [0.0; LANES];
        self.store(&mut numbers, 0);
        numbers
    }

    #[inline(always)]
    pub(crate) fn sqrt(self) -> Self {
        self.with(self.simd.sqrt_f64s(self.v))
    }

    #[inline(always)]
    pub(crate) fn abs(self) -> Self {
        // The library's own is not always inlined, and is compiled for the oldest processor then.
        let but_sign = self.simd.splat_f64s(f64::from_bits(!SIGN));
        self.with(self.simd.and_f64s(but_sign, self.v))
    }

    #[inline(always)]
    pub(crate) fn recip(self) -> Self {
        let one = self.simd.splat_f64s(1.0);
        self.with(self.simd.div_f64s(one, self.v))
    }

    /// √x and 1/√x, to a few units in the last place, of numbers that are not negative.
    ///
    /// Processors with AVX-512 have an estimate y of 1/√x to 14 bits, which the binomial series makes whole in half of the
    /// time of a root and a division:
    ///
    /// ```text
    /// e = 1 − x y²,   1/√x = y (1 + ½ e + ⅜ e² + 5/16 e³ + …),   √x = x y (1 + …)
    /// ```
    #[inline(always)]
    pub(crate) fn roots(self) -> [Self; 2] {
        let x = self.max(Wide(self.simd).splat(TINY));
        if let Some(y) = x.estimate() {
            let [root, missing, curve] = y.series(x);
            [root.whole(missing, curve), y.whole(missing, curve)]
        } else {
            // Side by side, not one after the other: 1/√x = √x · 1/x.
            let root = x.sqrt();
            [root, root * x.recip()]
        }
    }

    /// 1/√x of positive numbers, to a few units in the last place.
    #[inline(always)]
    pub(crate) fn inverse_root(self) -> Self {
        match self.estimate() {
            Some(y) => {
                let [_, missing, curve] = y.series(self);
                y.whole(missing, curve)
            }
            None => self.sqrt() * self.recip(),
        }
    }

    /// √x alone.
    #[inline(always)]
    pub(crate) fn root(self) -> Self {
        let x = self.max(Wide(self.simd).splat(TINY));
        match x.estimate() {
            Some(y) => {
                let [_, missing, curve] = y.series(x);
                // Of zero, nothing.
                (self * y).whole(missing, curve)
            }
            None => self.sqrt(),
        }
    }

    /// 1/√x to 14 bits, where the processor has it.
    #[inline(always)]
    fn estimate(self) -> Option<Self> {
        #[cfg(target_arch = "x86_64")]
        if let Some(v4) = kind::<S, pulp::x86::V4>(self.simd) {
            let x: pulp::f64x8 = pulp::bytemuck::cast(self.v);
            let estimate: pulp::f64x8 = pulp::cast(v4.avx512f._mm512_rsqrt14_pd(pulp::cast(x)));
            return Some(self.with(pulp::bytemuck::cast(estimate)));
        }
        None
    }

    /// x y, e = 1 − x y² and ½ + ⅜ e of an estimate y of 1/√x.
    #[inline(always)]
    fn series(self, x: Self) -> [Self; 3] {
        let of = Wide(self.simd);
        let root = x * self;
        let missing = (-root).fused(self, of.splat(1.0));
        let curve = missing.fused(of.splat(0.375), of.splat(0.5));
        [root, missing, curve]
    }

    /// y + y e (½ + ⅜ e + 5/16 e²): what an estimate y stands for, or x y.
    #[inline(always)]
    fn whole(self, missing: Self, curve: Self) -> Self {
        let cubic = (missing * missing).fused(Wide(self.simd).splat(0.3125), curve);
        (self * missing).fused(cubic, self)
    }

    /// self · factor + term, rounded once where the processor has an instruction for it: elsewhere a function would be called.
    #[inline(always)]
    pub(crate) fn times_plus(self, factor: Self, term: Self) -> Self {
        #[cfg(target_arch = "x86_64")]
        if kind::<S, pulp::x86::V4>(self.simd).is_some()
            || kind::<S, pulp::x86::V3>(self.simd).is_some()
        {
            return self.fused(factor, term);
        }
        self * factor + term
    }

    /// self + a b, as [`times_plus`](Self::times_plus) has it.
    #[inline(always)]
    pub(crate) fn plus(self, a: Self, b: Self) -> Self {
        a.times_plus(b, self)
    }

    /// self − a b, likewise.
    #[inline(always)]
    pub(crate) fn minus(self, a: Self, b: Self) -> Self {
        (-a).times_plus(b, self)
    }

    /// self · factor + term, rounded once: for processors with the instruction.
    #[inline(always)]
    fn fused(self, factor: Self, term: Self) -> Self {
        self.with(self.simd.mul_add_f64s(self.v, factor.v, term.v))
    }

    #[inline(always)]
    pub(crate) fn max(self, other: Self) -> Self {
        self.with(self.simd.max_f64s(self.v, other.v))
    }

    #[inline(always)]
    pub(crate) fn min(self, other: Self) -> Self {
        self.with(self.simd.min_f64s(self.v, other.v))
    }

    #[inline(always)]
    pub(crate) fn greater(self, other: Self) -> Mask<S> {
        Mask {
            simd: self.simd,
            m: self.simd.greater_than_f64s(self.v, other.v),
        }
    }

    /// The lanes one further on: first the last of `before`, then all but the last of `self`.
    #[inline(always)]
    pub(crate) fn after(self, before: Self) -> Self {
        // One or two instructions where the processor has them: the library rotates both, and puts them together.
        #[cfg(target_arch = "x86_64")]
        {
            if let Some(v4) = kind::<S, pulp::x86::V4>(self.simd) {
                let [here, there] = [self.v, before.v].map(|v| {
                    let eight: pulp::f64x8 = pulp::bytemuck::cast(v);
                    pulp::cast(eight)
                });
                let shifted = v4.avx512f._mm512_alignr_epi64::<7>(here, there);
                let shifted: pulp::f64x8 = pulp::cast(shifted);
                return self.with(pulp::bytemuck::cast(shifted));
            }
            if let Some(v3) = kind::<S, pulp::x86::V3>(self.simd) {
                let [here, there] = [self.v, before.v].map(|v| {
                    let four: pulp::f64x4 = pulp::bytemuck::cast(v);
                    pulp::cast(four)
                });
                // The last two before and the first two here; then each with the one after it.
                let middle = v3.avx._mm256_permute2f128_pd::<0x21>(there, here);
                let shifted = v3.avx._mm256_shuffle_pd::<0b0101>(middle, here);
                let shifted: pulp::f64x4 = pulp::cast(shifted);
                return self.with(pulp::bytemuck::cast(shifted));
            }
        }
        // Not a closure over both: one that is not inlined is compiled for the oldest processor.
        let here = self.with(self.simd.rotate_right_f64s(self.v, 1));
        let there = self.with(self.simd.rotate_right_f64s(before.v, 1));
        Wide(self.simd).first(1).select(there, here)
    }

    /// Applies a function to one lane after the other.
    #[inline(always)]
    pub(crate) fn one_by_one(self, f: impl Fn(f64) -> f64) -> Self {
        let mut numbers = self.numbers();
        for value in &mut numbers[..Wide::<S>::COUNT] {
            *value = f(*value);
        }
        Wide(self.simd).load(&numbers, 0)
    }

    /// Sum of the lanes.
    #[inline(always)]
    pub(crate) fn sum(self) -> f64 {
        self.simd.reduce_sum_f64s(self.v)
    }

    /// Smallest lane.
    #[inline(always)]
    pub(crate) fn smallest(self) -> f64 {
        self.simd.reduce_min_f64s(self.v)
    }

    /// Largest lane.
    #[inline(always)]
    pub(crate) fn largest(self) -> f64 {
        self.simd.reduce_max_f64s(self.v)
    }
}

impl<S: Simd> Mask<S> {
    #[inline(always)]
    pub(crate) fn select(self, yes: Lane<S>, no: Lane<S>) -> Lane<S> {
        yes.with(self.simd.select_f64s(self.m, yes.v, no.v))
    }

    #[inline(always)]
    pub(crate) fn any(self) -> bool {
        // Masks of one byte have a bit a lane, which the library counts from the other end.
        if size_of::<S::m64s>() == 1 {
            let [bits] = pulp::bytemuck::cast::<S::m64s, [u8; 1]>(self.m);
            return bits != 0;
        }
        // AVX2 collects the signs of its lanes in one instruction; the library looks at one after the other.
        #[cfg(target_arch = "x86_64")]
        if let Some(v3) = kind::<S, pulp::x86::V3>(self.simd) {
            let lanes: pulp::f64x4 = pulp::bytemuck::cast(self.m);
            return v3.avx._mm256_movemask_pd(pulp::cast(lanes)) != 0;
        }
        self.simd.first_true_m64s(self.m) < Wide::<S>::COUNT
    }
}

impl<S: Simd> BitAnd for Mask<S> {
    type Output = Self;

    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self {
            simd: self.simd,
            m: self.simd.and_m64s(self.m, other.m),
        }
    }
}

macro_rules! elementwise {
    ($trait:ident, $method:ident, $operation:ident) => {
        impl<S: Simd> $trait for Lane<S> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.with(self.simd.$operation(self.v, other.v))
            }
        }
    };
}

elementwise!(Add, add, add_f64s);
elementwise!(Sub, sub, sub_f64s);
elementwise!(Mul, mul, mul_f64s);

impl<S: Simd> Neg for Lane<S> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        // As with `abs`.
        let sign = self.simd.splat_f64s(f64::from_bits(SIGN));
        self.with(self.simd.xor_f64s(sign, self.v))
    }
}

impl<S: Simd> AddAssign for Lane<S> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

#[cfg(test)]
#[expect(
    clippy::float_cmp,
    reason = "what is only moved about stays what it was"
)]
mod tests {
    use chaindrive_integrate::{InstructionSet, Registers, kernel};
    use chaindrive_validation::run_again;
    use pulp::Scalar128b;

    use super::*;

    fn check<S: Simd>(simd: S) {
        let w = Wide(simd);
        let n = Wide::<S>::COUNT;
        let x: Vec<f64> = (0..n).map(|i| 1.5 + i as f64).collect();
        let lane = w.load(&x, 0);
        let out = |lane: Lane<S>| {
            let mut out = vec![0.0; n];
            lane.store(&mut out, 0);
            out
        };
        for count in 0..=n {
            let mask = w.first(count);
            assert_eq!(mask.any(), count > 0, "{count} of {n}");
            let chosen = out(mask.select(lane, -lane));
            for i in 0..n {
                assert_eq!(chosen[i], if i < count { x[i] } else { -x[i] });
            }
            for other in 0..=n {
                let both = out((mask & w.first(other)).select(w.splat(1.0), w.splat(0.0)));
                assert_eq!(both.iter().sum::<f64>(), count.min(other) as f64);
            }
        }
        for i in 0..n {
            // One lane alone.
            let mut one = vec![0.0; n];
            one[i] = 1.0;
            assert!(w.load(&one, 0).greater(w.splat(0.5)).any(), "{i} of {n}");
        }
        assert_eq!(lane.largest(), x[n - 1]);
        assert_eq!(lane.smallest(), x[0]);
        assert!((lane.sum() - x.iter().sum::<f64>()).abs() < 1e-12);
        assert_eq!(out((-lane).abs()), x);
        let [root, inverse] = lane.roots().map(out);
        for i in 0..n {
            assert!((root[i] / x[i].sqrt() - 1.0).abs() < 3e-16);
            assert!((inverse[i] * x[i].sqrt() - 1.0).abs() < 1e-15);
            assert!((out(lane.inverse_root())[i] * x[i].sqrt() - 1.0).abs() < 1e-15);
            assert!((out(lane.root())[i] / x[i].sqrt() - 1.0).abs() < 1e-15);
        }
        assert_eq!(out(w.splat(0.0).root()), vec![0.0; n]);
        // Both are next to the nearest number, or next but one.
        let many: Vec<f64> = (0..8192).map(|i| 1e-3 * 1.003_f64.powi(i)).collect();
        let rows = w.lanes(&many);
        for (i, part) in many.chunks(n).enumerate() {
            let found = rows.get(i).roots().map(out);
            for (k, x) in part.iter().enumerate() {
                let exact = [x.sqrt(), 1.0 / x.sqrt()];
                for (found, exact) in found.iter().zip(exact) {
                    let off = (found[k] - exact).abs();
                    assert!(off <= 2.0 * f64::EPSILON * exact, "{x}: {off:e}");
                }
            }
        }
        // Shifted by one.
        let mut shifted = vec![0.0; n];
        Wide::<S>::lanes_mut(&mut shifted).set(0, lane.after(-lane));
        let before = [&[-x[n - 1]], &x[..n - 1]].concat();
        assert_eq!(shifted, before);
    }

    kernel!(
        fn checked<S: Simd>(simd: S) {
            check(simd);
        }
    );

    #[test]
    fn lanes_of_any_width_compute_alike() {
        check(pulp::Scalar);
        check(Scalar128b);
        check(pulp::Scalar512b);
        Registers::in_use().dispatch(checked());
    }

    /// Lanes, and all kernels that are held against their laws, on the next narrower set of registers.
    #[test]
    fn kernels_hold_on_narrower_registers() {
        on_narrower(&["lanes", "contact::", "blocks"], 1);
    }

    #[test]
    #[ignore = "a study: all tests of this program on all sets"]
    fn kernels_hold_on_all_narrower_registers() {
        on_narrower(&[], usize::MAX);
    }

    fn on_narrower(only: &[&str], most: usize) {
        let sets = InstructionSet::narrower().take(most);
        let names = sets.map(InstructionSet::name);
        run_again(only, "narrower_registers", InstructionSet::VARIABLE, names);
    }
}
