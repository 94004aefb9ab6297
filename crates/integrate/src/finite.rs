//! Watching for infinity and NaN at next to no cost.

/// Exponent bits of a double; all set in infinities and NaN, and only there.
const EXPONENT: u64 = 0x7ff0_0000_0000_0000;

/// One in the last place of the exponent.
const CARRY: u64 = 0x0010_0000_0000_0000;

/// Remembers whether any of the values it saw was not finite.
///
/// Integer operations without a branch or a comparison: loops that watch their results stay in lanes, on processors
/// without wide comparisons too.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Watch(u64);

impl Watch {
    /// Takes note of a value.
    #[inline(always)]
    pub(crate) fn see(&mut self, value: f64) {
        // A full exponent carries into the sign bit.
        self.0 |= (value.to_bits() & EXPONENT).wrapping_add(CARRY);
    }

    /// Takes note of all values.
    #[inline]
    pub(crate) fn see_all(&mut self, values: &[f64]) {
        for value in values {
            self.see(*value);
        }
    }

    /// Takes in what another saw.
    #[inline(always)]
    pub(crate) fn take(&mut self, other: Self) {
        self.0 |= other.0;
    }

    /// Whether all values seen were finite.
    #[inline]
    pub(crate) fn all_finite(self) -> bool {
        self.0 >> 63 == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn notices_exactly_what_is_not_finite() {
        for value in [0.0, -0.0, 1.0, -1e-300, 5e-324, f64::MAX, f64::MIN] {
            let mut watch = Watch::default();
            watch.see_all(&[1.0, value, 2.0]);
            assert!(watch.all_finite(), "{value}");
        }
        for value in [f64::NAN, -f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let mut watch = Watch::default();
            watch.see_all(&[1.0, value, 2.0]);
            assert!(!watch.all_finite(), "{value}");
        }
    }
}
