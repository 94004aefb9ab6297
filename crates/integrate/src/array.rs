//! Numbers that begin with a line of the processor's cache.

use std::ops::{Deref, DerefMut};

use aligned_vec::{AVec, ConstAlign};
use serde::{Deserialize, Serialize};

/// Bytes of a line of the processor's cache, and of its widest registers.
const LINE: usize = 64;

/// An array of numbers, used as a slice.
///
/// A register of eight numbers that is read from elsewhere than the beginning of a line takes two lines: for arrays that a
/// [`Vec`] puts where it likes that is most of them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Array(AVec<f64, ConstAlign<LINE>>);

impl Array {
    /// As many zeros.
    pub fn zeros(count: usize) -> Self {
        let mut zeros = Self::default();
        zeros.resize(count, 0.0);
        zeros
    }

    /// Makes it as long, with a value in new places.
    #[inline]
    pub fn resize(&mut self, count: usize, value: f64) {
        // Most are as long already, step after step.
        if self.0.len() != count {
            self.0.resize(count, value);
        }
    }

    /// Leaves nothing in it.
    pub fn clear(&mut self) {
        self.0.clear();
    }
}

impl Default for Array {
    fn default() -> Self {
        Self(AVec::new(LINE))
    }
}

impl From<&[f64]> for Array {
    fn from(numbers: &[f64]) -> Self {
        Self(AVec::from_slice(LINE, numbers))
    }
}

impl From<Vec<f64>> for Array {
    fn from(numbers: Vec<f64>) -> Self {
        numbers.as_slice().into()
    }
}

impl FromIterator<f64> for Array {
    fn from_iter<I: IntoIterator<Item = f64>>(numbers: I) -> Self {
        Self(AVec::from_iter(LINE, numbers))
    }
}

impl Deref for Array {
    type Target = [f64];

    #[inline]
    fn deref(&self) -> &[f64] {
        &self.0
    }
}

impl DerefMut for Array {
    #[inline]
    fn deref_mut(&mut self) -> &mut [f64] {
        &mut self.0
    }
}

impl<'a> IntoIterator for &'a Array {
    type Item = &'a f64;
    type IntoIter = std::slice::Iter<'a, f64>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

impl<'a> IntoIterator for &'a mut Array {
    type Item = &'a mut f64;
    type IntoIter = std::slice::IterMut<'a, f64>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter_mut()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Arrays begin with a line of the cache however they came about.
    #[test]
    fn arrays_begin_with_a_line() {
        let mut grown = Array::default();
        for count in 0..100 {
            grown.resize(count, 1.5);
            let copied = Array::from(vec![1.5; count]);
            let collected = copied.iter().copied().collect();
            for array in [&grown, &grown.clone(), &copied, &collected] {
                assert_eq!(array.len(), count);
                assert!(count == 0 || array.as_ptr().addr().is_multiple_of(LINE));
            }
            assert_eq!(grown, copied);
        }
    }
}
