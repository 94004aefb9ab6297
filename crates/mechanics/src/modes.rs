//! Natural frequencies and mode shapes of a drive at its static state.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector, SymmetricEigen};

use crate::system::{WheelRotation, WheelSupport};
use crate::{Assembled, AssemblyError, System, assembly};

/// Small free vibrations of a drive about its static state, in ascending order.
///
/// ```text
/// K φ = ω² M φ,   M^(−1/2) K M^(−1/2) y = ω² y,   φ = M^(−1/2) y,   φᵀ M φ = 1
/// ```
///
/// K is the Hessian with which the static state was found, M the diagonal of the masses and
/// inertias. Contacts count as they stand: closed ones with their tangent stiffness, open ones not
/// at all. Damping, friction, the speed of the chain, and torques that change with the angle are
/// left out; prescribed motions and held ends stand still. So the modes are those of the
/// drive at rest, and near those of a slow one as long as no contact opens or closes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Modes {
    /// The modes, as many as the drive has degrees of freedom.
    pub modes: Vec<Mode>,
}

/// One mode: its frequency, and how far everything moves, with unit modal mass.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mode {
    /// Frequency f \[Hz\].
    ///
    /// Zero where no stiffness beyond rounding opposes the motion, such as across a slack link.
    /// Negative where the state is unstable: the motion then grows as e^(2π|f|t).
    pub frequency: f64,
    /// Displacements of the rollers along x and y \[m/√kg\], (rollers,) each; zero at held ends.
    pub roller_x: Vec<f64>,
    /// See `roller_x`.
    pub roller_y: Vec<f64>,
    /// Rotations \[rad/√kg\], (sprockets,); zero where prescribed.
    pub sprocket_angle: Vec<f64>,
    /// Displacements of the centres on bearing springs \[m/√kg\], (sprockets,) each; others zero.
    pub sprocket_x: Vec<f64>,
    /// See `sprocket_x`.
    pub sprocket_y: Vec<f64>,
    /// Coordinates of the tensioners \[m/√kg or rad/√kg\], (tensioners,); zero where locked.
    pub tensioner_position: Vec<f64>,
}

/// Largest force out of balance, relative to the chain tension, that still counts as static.
const STATIC: f64 = 1e-6;

impl Modes {
    /// Frequencies \[Hz\], (modes,), ascending.
    pub fn frequencies(&self) -> Vec<f64> {
        self.modes.iter().map(|mode| mode.frequency).collect()
    }

    /// Whether no motion grows by itself.
    pub fn is_stable(&self) -> bool {
        self.modes.iter().all(|mode| mode.frequency >= 0.0)
    }
}

impl Assembled {
    /// Natural frequencies and mode shapes about the static state.
    ///
    /// Dense: some hundredths of a second for 250 degrees of freedom, growing with their cube.
    ///
    /// # Errors
    /// [`AssemblyError::NotStatic`] when forces are out of balance, because the drive was not
    /// settled or is a chain in free motion.
    pub fn modes(&self) -> Result<Modes, AssemblyError> {
        let system = &self.system;
        let assembly::Curvature {
            entries,
            hessian,
            residual,
        } = assembly::curvature(system, &self.q);
        if residual >= STATIC || residual.is_nan() {
            return Err(AssemblyError::NotStatic { residual });
        }
        let inertias = system.inertias();
        let root = DVector::from_iterator(
            entries.len(),
            entries.iter().map(|&entry| inertias[entry].sqrt()),
        );
        let scaled = DMatrix::from_fn(entries.len(), entries.len(), |i, j| {
            // The two halves differ by rounding.
            0.5 * (hessian[(i, j)] + hessian[(j, i)]) / (root[i] * root[j])
        });
        Ok(Modes {
            modes: solve(scaled, &root, &entries, system),
        })
    }
}

fn solve(
    matrix: DMatrix<f64>,
    root: &DVector<f64>,
    entries: &[usize],
    system: &System,
) -> Vec<Mode> {
    if entries.is_empty() {
        return Vec::new();
    }
    let eigen = SymmetricEigen::new(matrix);
    let values = &eigen.eigenvalues;
    let rounding = f64::EPSILON * entries.len() as f64 * values.amax();
    let mut order: Vec<usize> = (0..entries.len()).collect();
    order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
    order
        .into_iter()
        .map(|index| {
            let squared = values[index];
            let frequency = if squared.abs() <= rounding {
                0.0
            } else {
                squared.abs().sqrt().copysign(squared) / TAU
            };
            let mut shape = vec![0.0; system.dofs];
            for (row, &entry) in entries.iter().enumerate() {
                shape[entry] = eigen.eigenvectors[(row, index)] / root[row];
            }
            mode(frequency, &shape, system)
        })
        .collect()
}

/// A shape in the order of the state, told by the parts that move.
fn mode(frequency: f64, shape: &[f64], system: &System) -> Mode {
    let (n, count) = (system.stride, system.rollers);
    let wheels = &system.wheels;
    let centre = |axis: usize| {
        let part = move |wheel: &crate::system::Wheel| match wheel.support {
            WheelSupport::Springs { dof, .. } => shape[dof + axis],
            _ => 0.0,
        };
        wheels.iter().map(part).collect()
    };
    let angle = |wheel: &crate::system::Wheel| match wheel.rotation {
        WheelRotation::Free { dof, .. } => shape[dof],
        WheelRotation::Prescribed(_) => 0.0,
    };
    Mode {
        frequency,
        roller_x: shape[..count].to_vec(),
        roller_y: shape[n..n + count].to_vec(),
        sprocket_angle: wheels.iter().map(angle).collect(),
        sprocket_x: centre(0),
        sprocket_y: centre(1),
        tensioner_position: system
            .slides
            .iter()
            .map(|slide| slide.dof.map_or(0.0, |dof| shape[dof]))
            .collect(),
    }
}

impl System {
    /// Mass or inertia that goes with every entry of the state \[kg or kg m²\].
    pub(crate) fn inertias(&self) -> Vec<f64> {
        let n = self.stride;
        let mut inertias = vec![0.0; self.dofs];
        inertias[..n].copy_from_slice(&self.masses);
        inertias[n..2 * n].copy_from_slice(&self.masses);
        for wheel in &self.wheels {
            if let WheelRotation::Free { dof, .. } = wheel.rotation {
                inertias[dof] = wheel.inertia;
            }
            if let WheelSupport::Springs { dof, .. } = wheel.support {
                inertias[dof] = wheel.mass;
                inertias[dof + 1] = wheel.mass;
            }
        }
        for slide in &self.slides {
            if let Some(dof) = slide.dof {
                inertias[dof] = slide.inertia;
            }
        }
        inertias
    }
}
