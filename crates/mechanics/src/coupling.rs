//! Couplings: torsional springs between shafts.

/// A torsional spring and damper between two shafts, without stress as assembled.
///
/// ```text
/// M = k φ + c φ̇,   φ = (θ₁ − θ₁(0)) − (θ₀ − θ₀(0)),   M on the first shaft, −M on the second
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Coupling {
    /// Name, unique among the couplings.
    pub name: String,
    /// The two shafts.
    pub shafts: [usize; 2],
    /// Stiffness k \[N m/rad\], not negative.
    pub stiffness: f64,
    /// Damping c \[N m s/rad\], not negative.
    pub damping: f64,
}
