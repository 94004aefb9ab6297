//! Natural frequencies and mode shapes of a drive at its static state.

use std::f64::consts::TAU;

use chaindrive_geometry::Vector;
use nalgebra::{DMatrix, DVector, SymmetricEigen};

use crate::bodies::{Wheel, WheelSupport};
use crate::{Assembled, AssemblyError, assembly};

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
/// drive at rest, and near those of a slow one as long as no contact opens or closes. Oil in tensioners is trapped, and its
/// column a spring.
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
            conditions,
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
        let kept = DMatrix::from_fn(conditions.nrows(), entries.len(), |i, j| {
            conditions[(i, j)] / root[j]
        });
        let modes = free_modes(scaled, &kept);
        let shape = |mode: &DVector<f64>| {
            let mut shape = vec![0.0; system.dofs];
            for (row, &entry) in entries.iter().enumerate() {
                shape[entry] = mode[row] / root[row];
            }
            shape
        };
        Ok(Modes {
            modes: modes
                .iter()
                .map(|(frequency, vector)| self.mode(*frequency, &shape(vector)))
                .collect(),
        })
    }

    /// A shape in the order of the state, told by the parts that move.
    fn mode(&self, frequency: f64, shape: &[f64]) -> Mode {
        let bodies = &self.system.bodies;
        let wheels = &bodies.wheels;
        let centre = |axis: usize| {
            let part = move |wheel: &Wheel| match wheel.support {
                WheelSupport::Springs { dof, .. } => shape[dof + axis],
                _ => 0.0,
            };
            wheels.iter().map(part).collect()
        };
        let angle = |wheel: &Wheel| {
            let turned = wheel.turn.turned_by();
            turned.map_or(0.0, |(dof, ratio)| ratio * shape[dof])
        };
        let mut rollers = Vec::new();
        for member in &self.system.chains {
            let own = member.entries.clone();
            let (q, shape) = (&self.q[own.clone()], &shape[own]);
            rollers.extend((0..member.chain.rollers()).map(|roller| {
                let moving = member.chain.roller_moving(q, roller);
                let ways = moving.ways().iter();
                ways.map(|way| way.first * shape[way.entry]).sum::<Vector>()
            }));
        }
        Mode {
            frequency,
            roller_x: rollers.iter().map(|shift| shift.x).collect(),
            roller_y: rollers.iter().map(|shift| shift.y).collect(),
            sprocket_angle: wheels.iter().map(angle).collect(),
            sprocket_x: centre(0),
            sprocket_y: centre(1),
            tensioner_position: bodies
                .slides
                .iter()
                .map(|slide| slide.dof.map_or(0.0, |dof| shape[dof]))
                .collect(),
        }
    }
}

/// Frequencies \[Hz\] and eigenvectors of a symmetric matrix where the conditions are kept, ascending.
///
/// ```text
/// C y = 0   ⇒   y = N z,   Nᵀ K N z = ω² z,   the columns of N span what C leaves free
/// ```
fn free_modes(matrix: DMatrix<f64>, conditions: &DMatrix<f64>) -> Vec<(f64, DVector<f64>)> {
    if matrix.is_empty() {
        return Vec::new();
    }
    let size = matrix.nrows();
    let basis = (conditions.nrows() > 0).then(|| free_directions(conditions));
    let matrix = match &basis {
        Some(basis) => {
            let reduced = basis.transpose() * matrix * basis;
            (&reduced + reduced.transpose()) * 0.5
        }
        None => matrix,
    };
    if matrix.is_empty() {
        return Vec::new();
    }
    let eigen = SymmetricEigen::new(matrix);
    let values = &eigen.eigenvalues;
    let rounding = f64::EPSILON * size as f64 * values.amax();
    let mut order: Vec<usize> = (0..values.len()).collect();
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
            let vector = eigen.eigenvectors.column(index).into_owned();
            let vector = basis
                .as_ref()
                .map_or(vector.clone(), |basis| basis * vector);
            (frequency, vector)
        })
        .collect()
}

/// Orthonormal columns that span the null space of the conditions.
fn free_directions(conditions: &DMatrix<f64>) -> DMatrix<f64> {
    let eigen = SymmetricEigen::new(conditions.transpose() * conditions);
    let bound = eigen.eigenvalues.amax() * f64::EPSILON * conditions.ncols() as f64;
    let free: Vec<usize> = (0..conditions.ncols())
        .filter(|&i| eigen.eigenvalues[i] <= bound)
        .collect();
    eigen.eigenvectors.select_columns(&free)
}
