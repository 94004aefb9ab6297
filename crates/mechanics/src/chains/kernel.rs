//! The kernels of a chain as one call, compiled for every kind of processor.

use chaindrive_integrate::{Moment, kernel};
use pulp::Simd;

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
        let registers = self.series().registers;
        registers.dispatch(forces(self, around, at, a, rates, found));
    }
}

kernel!(
    fn forces<'a, S: Simd, C: Kernel>(
        w: Wide<S>,
        chain: &'a C,
        around: Surroundings<'a>,
        at: Moment<'a>,
        a: &'a mut [f64],
        rates: &'a mut [f64],
        found: (&'a mut Loads, &'a mut C::Work),
    ) {
        chain.forces(w, around, at, a, rates, found);
    }
);
