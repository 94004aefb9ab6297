//! Memory that a recording may take.

/// Memory that this program can still have \[bytes\], limits of its control group included; without bounds where the
/// system does not say.
#[cfg(feature = "stores")]
pub(super) fn free_memory() -> f64 {
    let mut system = sysinfo::System::new();
    system.refresh_memory();
    let group = system.cgroup_limits().map(|limits| limits.free_memory);
    let free = system.available_memory();
    match group.map_or(free, |group| group.min(free)) {
        0 => f64::INFINITY,
        bytes => bytes as f64,
    }
}

/// The most that one list can have \[bytes\]: nobody asks the system.
#[cfg(not(feature = "stores"))]
pub(super) fn free_memory() -> f64 {
    isize::MAX as f64
}
