//! The kernels of a chain as one call, compiled for every kind of processor.

use chaindrive_integrate::Moment;
use pulp::{Simd, WithSimd};

use super::makeup::Makeup;
use crate::bodies::Surroundings;
use crate::lanes::Wide;
use crate::seam::Loads;

/// A chain whose forces are computed on lanes.
pub(super) trait Kernel: Makeup {
    /// Accelerations of the chain, its powers, and what the bodies feel of it. Marked to be inlined: a call would be compiled for the oldest
    /// processor only.
    fn forces<S: Simd>(
        &self,
        w: Wide<S>,
        around: Surroundings<'_>,
        at: Moment<'_>,
        a: &mut [f64],
        rates: &mut [f64],
        found: (&mut Loads, &mut Self::Work),
    );

    /// The same on the registers of the chain.
    fn dispatch(
        &self,
        around: Surroundings<'_>,
        at: Moment<'_>,
        a: &mut [f64],
        rates: &mut [f64],
        found: (&mut Loads, &mut Self::Work),
    ) where
        Self: Sized,
    {
        self.series().registers.dispatch(Forces {
            chain: self,
            around,
            at,
            a,
            rates,
            found,
        });
    }
}

struct Forces<'a, C: Kernel> {
    chain: &'a C,
    around: Surroundings<'a>,
    at: Moment<'a>,
    a: &'a mut [f64],
    rates: &'a mut [f64],
    found: (&'a mut Loads, &'a mut C::Work),
}

impl<C: Kernel> WithSimd for Forces<'_, C> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self {
            chain,
            around,
            at,
            a,
            rates,
            found,
        } = self;
        chain.forces(Wide(simd), around, at, a, rates, found);
    }
}
