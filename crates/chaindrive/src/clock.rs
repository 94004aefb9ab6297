//! Clocks of the machine that computes: on the wall, and of a thread on its processor.
//!
//! No other file asks the system for a time: that of the standard library panics in a browser.

#[cfg(not(all(target_family = "wasm", target_os = "unknown")))]
pub(crate) use std::time::Instant;
#[cfg(all(target_family = "wasm", target_os = "unknown"))]
pub(crate) use web_time::Instant;

/// Time of this thread on its processor \[s\]; NaN where the system's is not asked for.
#[cfg(all(feature = "stores", any(target_os = "linux", target_vendor = "apple")))]
pub(crate) fn on_processor() -> f64 {
    use rustix::time::{ClockId, clock_gettime};
    let time = clock_gettime(ClockId::ThreadCPUTime);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}

#[cfg(not(all(feature = "stores", any(target_os = "linux", target_vendor = "apple"))))]
pub(crate) fn on_processor() -> f64 {
    f64::NAN
}
