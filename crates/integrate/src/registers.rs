//! Loops over whole states on the widest registers of the processor.

use pulp::{Arch, Scalar128b, WithSimd};

/// Runs a loop on the widest registers; SSE2, which every x86-64 has and the library does not name, has two lanes.
#[inline]
pub(crate) fn dispatch<Op: WithSimd>(arch: Arch, op: Op) -> Op::Output {
    match arch {
        Arch::Scalar => op.with_simd(Scalar128b),
        wide => wide.dispatch(op),
    }
}
