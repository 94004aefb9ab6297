//! Arrays that JavaScript reads in the memory of the module, without a copy.

use js_sys::{Float64Array, WebAssembly};
use wasm_bindgen::JsCast;

/// The numbers where they are. The view is of length 0 after the memory has grown, and of other numbers after these were dropped.
pub(crate) fn view(numbers: &[f64]) -> Float64Array {
    let memory: WebAssembly::Memory = wasm_bindgen::memory().unchecked_into();
    let begin = u32::try_from(numbers.as_ptr().addr()).expect("addresses have 32 bits");
    let length = u32::try_from(numbers.len()).expect("sizes have 32 bits");
    Float64Array::new_with_byte_offset_and_length(&memory.buffer(), begin, length)
}
