//! The equations of an implicit step, chain by chain.
//!
//! ```text
//! ⎡ A₀      B₀ ⎤ ⎡x₀⎤   ⎡M b₀⎤
//! ⎢     A₁  B₁ ⎥ ⎢x₁⎥ = ⎢M b₁⎥        D: the bodies by themselves, Eₖ: what chain k adds to them
//! ⎣ B₀ᵀ B₁ᵀ  S ⎦ ⎣z ⎦   ⎣M b ⎦        S = D + E₀ + E₁
//! ```
//!
//! A chain solves these equations for itself and the bodies as if there were no other. Several chains are joined by what their answers say
//! about the bodies: with Zₖ the answer to unit loads on the bodies, and zₖ that to the chain's own load,
//!
//! ```text
//! (Σ Zₖ⁻¹ − (K − 1) M⁻¹ D) z = b + Σ Zₖ⁻¹ zₖ
//! ```
//!
//! after which every chain is solved once more, with such loads on the bodies that they move by z. It takes as many solutions a chain as
//! bodies have coordinates, and two more.

use chaindrive_integrate::Weights;
use nalgebra::{DMatrix, DVector};

use super::{Bodies, Record, System};

impl System {
    /// x ← (M + c C + k K)⁻¹ M x; false if there is no solution.
    pub(super) fn solve_step(&self, weights: Weights, record: &mut Record, x: &mut [f64]) -> bool {
        if let [member] = self.chains.as_slice() {
            let bodies = &self.bodies;
            return member
                .chain
                .solve(bodies, weights, &mut record.chains[0], x);
        }
        self.solve_joined(weights, record, x).is_some()
    }

    fn solve_joined(&self, weights: Weights, record: &mut Record, x: &mut [f64]) -> Option<()> {
        let first = self.bodies.first;
        let count = self.dofs - first;
        let inertias = &self.bodies.inertias;
        let right = DVector::from_column_slice(&x[first..]);
        // (K − 1) M⁻¹ D
        let others = (self.chains.len() - 1) as f64;
        let mut matrix = self.bodies.matrix(weights) * -others;
        for (mut row, inertia) in matrix.row_iter_mut().zip(inertias) {
            row /= *inertia;
        }
        let mut sum = right.clone();
        let mut answers = Vec::new();
        for index in 0..self.chains.len() {
            let own = x[self.chains[index].entries.clone()].to_vec();
            let still = vec![0.0; own.len()];
            let mut columns = Vec::new();
            for unit in 0..count {
                let mut load = DVector::zeros(count);
                load[unit] = 1.0;
                columns.push(self.answer(index, weights, record, &still, &load)?.1);
            }
            let (alone, by_itself) =
                self.answer(index, weights, record, &own, &DVector::zeros(count))?;
            let inverse = if count == 0 {
                DMatrix::zeros(0, 0)
            } else {
                DMatrix::from_columns(&columns).try_inverse()?
            };
            sum += &inverse * &by_itself;
            matrix += &inverse;
            answers.push((own, alone, by_itself, inverse));
        }
        let moved = if count == 0 {
            sum
        } else {
            matrix.lu().solve(&sum)?
        };
        for (index, (own, alone, by_itself, inverse)) in answers.into_iter().enumerate() {
            let found = if count == 0 {
                alone
            } else {
                let load = inverse * (&moved - by_itself);
                self.answer(index, weights, record, &own, &load)?.0
            };
            x[self.chains[index].entries.clone()].copy_from_slice(&found);
        }
        x[first..].copy_from_slice(moved.as_slice());
        Some(())
    }

    /// What one chain says of itself and of the bodies.
    fn answer(
        &self,
        index: usize,
        weights: Weights,
        record: &mut Record,
        own: &[f64],
        load: &DVector<f64>,
    ) -> Option<(Vec<f64>, DVector<f64>)> {
        let mut x = [own, load.as_slice()].concat();
        let chain = &self.chains[index].chain;
        let record = &mut record.chains[index];
        let solved = chain.solve(&self.bodies, weights, record, &mut x);
        let bodies = DVector::from_column_slice(&x[own.len()..]);
        x.truncate(own.len());
        solved.then_some((x, bodies))
    }
}

impl Bodies {
    /// M + c C + k K of the bodies by themselves.
    fn matrix(&self, weights: Weights) -> DMatrix<f64> {
        let mut matrix = DMatrix::from_diagonal(&DVector::from_column_slice(&self.inertias));
        self.each_support(|dof, stiffness, damping| {
            let i = dof - self.first;
            matrix[(i, i)] += weights.stiffness * stiffness + weights.damping * damping;
        });
        for coupling in &self.couplings {
            let weight = weights.stiffness * coupling.stiffness + weights.damping * coupling.damping;
            for (dof, share) in self.twisted_by(coupling) {
                for (other, other_share) in self.twisted_by(coupling) {
                    matrix[(dof - self.first, other - self.first)] += weight * share * other_share;
                }
            }
        }
        matrix
    }
}
