//! The particle chain set in motion.

use chaindrive_geometry::{Point, Vector};

use super::Particles;

impl Particles {
    /// Gives the rollers their velocities, and those of the originals to the copies behind the last one.
    pub(crate) fn set_off(&self, _places: &[Point], velocities: &[Vector], v: &mut [f64]) {
        for (i, velocity) in velocities.iter().enumerate() {
            v[i] = velocity.x;
            v[self.stride + i] = velocity.y;
        }
        self.copy_ghosts(v);
    }
}
