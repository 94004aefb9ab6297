//! How much larger the error of a run is than its difference from a run with half the step.

use super::compare::difference;
use super::trace::{Strands, Trace};

/// The largest factor: three runs that hardly come closer to each other say no more than that.
const LARGEST: f64 = 3.0;

/// Error of a run over its difference from a sharper one, by a third that is sharper still.
///
/// ```text
/// r = |u₁ − u₂| / |u₂ − u₃|,   e₁ = |u₁ − u| = |u₁ − u₂| (1 + 1/r + 1/r² + …) = |u₁ − u₂| / (1 − 1/r)
/// ```
///
/// r is that of the first samples, and `expected` where the method shows its order. It is hardly ever larger, and never believed to be: differences
/// of different sign can cancel.
pub(super) fn factor(
    [first, second, third]: [&Trace; 3],
    strands: Strands,
    samples: usize,
    expected: f64,
) -> f64 {
    let apart = |of: &Trace, from: &Trace| difference(of, from, strands, samples);
    let ratio = apart(second, first) / apart(third, second);
    extrapolated(ratio, expected)
}

/// 1/(1 − 1/r) with r between what the order promises and what is too close to 1 to be extrapolated.
fn extrapolated(ratio: f64, expected: f64) -> f64 {
    let least = LARGEST / (LARGEST - 1.0);
    if ratio.is_nan() {
        // Nothing moves, or nothing is a number: no error to be multiplied.
        return 1.0 / (1.0 - 1.0 / expected);
    }
    1.0 / (1.0 - 1.0 / ratio.min(expected).max(least))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: f64, b: f64) -> bool {
        (a - b).abs() < 1e-12
    }

    #[test]
    fn the_factor_is_that_of_the_order_seen() {
        assert!(close(extrapolated(4.0, 4.0), 4.0 / 3.0));
        assert!(close(extrapolated(2.0, 4.0), 2.0));
        assert!(close(extrapolated(9.0, 4.0), 4.0 / 3.0), "cancelled");
        assert!(close(extrapolated(0.5, 4.0), LARGEST), "not converging");
        assert!(close(extrapolated(f64::NAN, 2.0), 2.0));
    }
}
