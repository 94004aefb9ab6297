//! Eight numbers at a time.
//!
//! Plain arrays with inlined loops: compiled inside a dispatched function they become vector
//! instructions of whatever width the processor has, and give the same bits on all of them,
//! because no operation is fused or reordered.

use std::ops::{Add, AddAssign, BitAnd, Mul, Neg, Sub};

/// Number of lanes.
pub(crate) const LANES: usize = 8;

/// `n` rounded up to whole lanes.
pub(crate) const fn padded(n: usize) -> usize {
    n.div_ceil(LANES) * LANES
}

/// Eight numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lane(pub(crate) [f64; LANES]);

/// Eight truth values, all bits set where true.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mask([u64; LANES]);

impl Lane {
    #[inline(always)]
    pub(crate) fn splat(value: f64) -> Self {
        Self([value; LANES])
    }

    /// The eight numbers from `start` on.
    #[inline(always)]
    pub(crate) fn load(slice: &[f64], start: usize) -> Self {
        let mut lane = [0.0; LANES];
        lane.copy_from_slice(&slice[start..start + LANES]);
        Self(lane)
    }

    #[inline(always)]
    pub(crate) fn store(self, slice: &mut [f64], start: usize) {
        slice[start..start + LANES].copy_from_slice(&self.0);
    }

    #[inline(always)]
    fn map(self, f: impl Fn(f64) -> f64) -> Self {
        let mut out = self.0;
        for value in &mut out {
            *value = f(*value);
        }
        Self(out)
    }

    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        let mut out = self.0;
        for (value, o) in out.iter_mut().zip(other.0) {
            *value = f(*value, o);
        }
        Self(out)
    }

    #[inline(always)]
    pub(crate) fn sqrt(self) -> Self {
        self.map(f64::sqrt)
    }

    #[inline(always)]
    pub(crate) fn abs(self) -> Self {
        self.map(f64::abs)
    }

    #[inline(always)]
    pub(crate) fn recip(self) -> Self {
        self.map(|v| 1.0 / v)
    }

    #[inline(always)]
    pub(crate) fn max(self, other: Self) -> Self {
        self.zip(other, |a, b| if a > b { a } else { b })
    }

    #[inline(always)]
    pub(crate) fn min(self, other: Self) -> Self {
        self.zip(other, |a, b| if a < b { a } else { b })
    }

    #[inline(always)]
    pub(crate) fn greater(self, other: Self) -> Mask {
        let mut mask = [0; LANES];
        for i in 0..LANES {
            mask[i] = if self.0[i] > other.0[i] { u64::MAX } else { 0 };
        }
        Mask(mask)
    }

    /// Sum of the lanes, always in the same order.
    #[inline(always)]
    pub(crate) fn sum(self) -> f64 {
        let [a, b, c, d, e, f, g, h] = self.0;
        ((a + e) + (c + g)) + ((b + f) + (d + h))
    }

    /// Largest lane.
    #[inline(always)]
    pub(crate) fn largest(self) -> f64 {
        self.0
            .iter()
            .fold(f64::NEG_INFINITY, |m, &v| if v > m { v } else { m })
    }
}

impl Mask {
    /// True in the first `count` lanes.
    #[inline(always)]
    pub(crate) fn first(count: usize) -> Self {
        let mut mask = [0; LANES];
        for (i, value) in mask.iter_mut().enumerate() {
            *value = if i < count { u64::MAX } else { 0 };
        }
        Self(mask)
    }

    #[inline(always)]
    pub(crate) fn select(self, yes: Lane, no: Lane) -> Lane {
        let mut out = no.0;
        for i in 0..LANES {
            out[i] = if self.0[i] != 0 { yes.0[i] } else { no.0[i] };
        }
        Lane(out)
    }

    #[inline(always)]
    pub(crate) fn any(self) -> bool {
        self.0.iter().fold(0, |any, &v| any | v) != 0
    }
}

impl BitAnd for Mask {
    type Output = Self;

    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        let mut out = self.0;
        for i in 0..LANES {
            out[i] &= other.0[i];
        }
        Self(out)
    }
}

macro_rules! elementwise {
    ($trait:ident, $method:ident, $op:tt) => {
        impl $trait for Lane {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.zip(other, |a, b| a $op b)
            }
        }
    };
}

elementwise!(Add, add, +);
elementwise!(Sub, sub, -);
elementwise!(Mul, mul, *);

impl Neg for Lane {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        self.map(|v| -v)
    }
}

impl AddAssign for Lane {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}
