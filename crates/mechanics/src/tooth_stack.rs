//! The parts behind the surface of a tooth, which yield when a roller strikes, and the mass that strikes.
//!
//! Nothing here is read in motion: the spring behind the law of the surfaces is the sum, and those who describe a drive tell the terms.

mod beam;
mod blow;
mod rim;
mod striking;
mod wall;

pub use beam::{Beam, BeamEnds};
pub use blow::dry_blow;
pub use rim::rim_compliance;
pub use striking::JointMasses;
pub use wall::wall_compliance;

/// Compliance of what lies behind the surface of the teeth of a sprocket.
///
/// ```text
/// 1/k_s = Σ f² c
/// ```
///
/// c is the compliance of a part and f the share of the force that passes it: at equal forces on the tooth the parts store the same energy
/// as a spring k_s. The spring has no mass, so the inertia that a part would have beside the lumped one is left out.
#[derive(Clone, Debug, PartialEq)]
pub struct ToothStack {
    /// Force on the tooth \[N\] at which contacts were made springs, all strands together.
    pub load: f64,
    /// The parts that yield, from the roller inwards.
    pub terms: Vec<StackTerm>,
    /// Mass that strikes.
    pub striking: StrikingMass,
}

impl ToothStack {
    /// Stiffness of all parts k_s \[N/m\]; infinite where nothing yields.
    pub fn stiffness(&self) -> f64 {
        // 1/k_s = Σ f² c
        1.0 / self.terms.iter().map(StackTerm::in_series).sum::<f64>()
    }
}

/// A part that yields.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StackTerm {
    /// Its name, such as "bending of the pin".
    pub part: &'static str,
    /// Compliance under the force that passes it c \[m/N\].
    pub compliance: f64,
    /// Share of the force on the tooth that passes it f \[–\].
    pub share: f64,
}

impl StackTerm {
    /// Its part of 1/k_s \[m/N\]: f² c.
    pub fn in_series(&self) -> f64 {
        self.share * self.share * self.compliance
    }
}

/// Mass that strikes at a joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrikingMass {
    /// Of a roller with half of each link \[kg\].
    pub lumped: f64,
    /// Of links that turn about their joints \[kg\]; absent where their inertia is not known.
    pub hinged: Option<f64>,
}
