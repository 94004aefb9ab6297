//! Free rollers in the equations of the bodies: each touches its link and the border only.

use nalgebra::{Matrix3, Vector3};

/// A free roller's own equations.
#[derive(Clone, Debug)]
pub(crate) struct FreeRollerEquations {
    pub(super) own: Matrix3<f64>,
    pub(super) inverse: Matrix3<f64>,
    pub(super) right: Vector3<f64>,
    /// The link it sits on, and the block (link, roller).
    pub(super) link: Option<usize>,
    pub(super) coupling: Matrix3<f64>,
    /// Couplings with the border.
    pub(super) beside: Vec<(usize, Vector3<f64>)>,
}

impl Default for FreeRollerEquations {
    fn default() -> Self {
        Self {
            own: Matrix3::zeros(),
            inverse: Matrix3::zeros(),
            right: Vector3::zeros(),
            link: None,
            coupling: Matrix3::zeros(),
            beside: Vec::new(),
        }
    }
}

impl FreeRollerEquations {
    /// Empties the equations but keeps their space.
    pub(super) fn clear(&mut self) {
        let beside = std::mem::take(&mut self.beside);
        *self = Self {
            beside,
            ..Self::default()
        };
        self.beside.clear();
    }

    /// Adds to the coupling with one unknown of the border.
    pub(super) fn couple(&mut self, j: usize, row: Vector3<f64>) {
        match self.beside.iter_mut().find(|(known, _)| *known == j) {
            Some((_, sum)) => *sum += row,
            None => self.beside.push((j, row)),
        }
    }
}
