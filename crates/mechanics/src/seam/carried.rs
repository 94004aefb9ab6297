//! What the equations of a step add to the forces at its beginning.

use chaindrive_geometry::Vector;

/// Impulses and losses over the step that was solved last, beside those of the forces at its beginning.
#[derive(Clone, Debug, Default)]
pub(crate) struct Carried {
    /// Of the contacts with wheels, then with rails.
    pub(crate) mounts: Vec<CarriedByMount>,
    /// Energies lost along the normals \[J\]: of pins in bushes, and of bushes in rollers.
    pub(crate) joints: [f64; 2],
}

/// The same of the contacts with one wheel or rail.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CarriedByMount {
    /// Impulse on the wheel or rail \[N s\].
    pub(crate) push: Vector,
    /// Its moment about the origin of the frame \[N m s\].
    pub(crate) moment: f64,
    /// Energy lost along the normals \[J\].
    pub(crate) lost: f64,
}
