//! The equations of an implicit step, group by group and chain by chain.
//!
//! ```text
//! ⎡ A₀      B₀ ⎤ ⎡x₀⎤   ⎡M b₀⎤
//! ⎢     A₁  B₁ ⎥ ⎢x₁⎥ = ⎢M b₁⎥        D: the bodies by themselves, Eₖ: what chain k adds to them
//! ⎣ B₀ᵀ B₁ᵀ  S ⎦ ⎣z ⎦   ⎣M b ⎦        S = D + E₀ + E₁
//! ```
//!
//! A chain solves these equations for itself and the bodies as if there were no other. Several chains of a group are joined by what
//! their answers say about the bodies: with Zₖ the answer to unit loads on the bodies, and zₖ that to the chain's own load,
//!
//! ```text
//! (Σ Zₖ⁻¹ − (K − 1) M⁻¹ D) z = b + Σ Zₖ⁻¹ zₖ
//! ```
//!
//! after which every chain is solved once more, with such loads on the bodies that they move by z. It takes as many solutions a chain as
//! bodies have coordinates, and two more.

use chaindrive_integrate::Weights;
use nalgebra::{DMatrix, DVector};

use super::{Record, System};
use crate::bodies::{Bodies, GroupBodies};
use crate::tensioner::Slopes;

impl System {
    /// x ← (M + c C + k K)⁻¹ M x; false if there is no solution.
    /// States stand after the coordinates; a push has one at most, and it is eliminated first.
    ///
    /// ```text
    /// y = (y₀ + k ∂ż/∂q x)/(1 − c ∂ż/∂z)
    /// (M + c C + k K − c k ∂f/∂z ∂ż/∂q/(1 − c ∂ż/∂z)) x = M x₀ + c ∂f/∂z y₀/(1 − c ∂ż/∂z)
    /// ```
    pub(super) fn solve_step(&self, weights: Weights, record: &mut Record, x: &mut [f64]) -> bool {
        let (x, y) = x.split_at_mut(self.dofs);
        let c = weights.damping;
        // Lent to the bodies, and put back below.
        let pushes = std::mem::take(&mut record.pushes);
        let resisting = std::mem::take(&mut record.resisting);
        for (state, dof, slopes) in self.bodies.each_state(&pushes) {
            let inertia = self.bodies.inertias[dof - self.bodies.first];
            y[state] /= 1.0 + c * slopes.settling;
            x[dof] += c * slopes.by_state * y[state] / inertia;
        }
        let solved = if let [member] = self.chains.as_slice() {
            let bodies = self.group_bodies(0).with(&pushes, &resisting);
            member
                .chain
                .solve(bodies, weights, &mut record.chains[0], x)
        } else {
            let mut groups = 0..self.groups.len();
            groups.all(|group| {
                let bodies = self.group_bodies(group).with(&pushes, &resisting);
                self.solve_group(group, bodies, weights, record, x)
                    .is_some()
            })
        };
        for (state, dof, slopes) in self.bodies.each_state(&pushes) {
            y[state] += weights.stiffness * slopes.flow * x[dof] / (1.0 + c * slopes.settling);
        }
        record.pushes = pushes;
        record.resisting = resisting;
        solved
    }

    fn solve_group(
        &self,
        group: usize,
        bodies: GroupBodies<'_>,
        weights: Weights,
        record: &mut Record,
        x: &mut [f64],
    ) -> Option<()> {
        let chains = &self.groups[group].chains;
        let right = DVector::from_column_slice(&x[bodies.range()]);
        let count = bodies.count;
        if chains.len() == 1 || count == 0 {
            // Nothing that moves joins the chains.
            for &index in chains {
                let entries = self.chains[index].entries.clone();
                let own = x[entries.clone()].to_vec();
                let (found, moved) = self.answer(index, bodies, weights, record, &own, &right)?;
                x[entries].copy_from_slice(&found);
                x[bodies.range()].copy_from_slice(moved.as_slice());
            }
            return Some(());
        }
        // (K − 1) M⁻¹ D
        let others = (chains.len() - 1) as f64;
        let mut matrix = bodies.matrix(weights) * -others;
        for (mut row, inertia) in matrix.row_iter_mut().zip(bodies.inertias()) {
            row /= *inertia;
        }
        let mut sum = right;
        let mut answers = Vec::new();
        for &index in chains {
            let own = x[self.chains[index].entries.clone()].to_vec();
            let still = vec![0.0; own.len()];
            let mut columns = Vec::new();
            for unit in 0..count {
                let mut load = DVector::zeros(count);
                load[unit] = 1.0;
                let answer = self.answer(index, bodies, weights, record, &still, &load)?;
                columns.push(answer.1);
            }
            let none = DVector::zeros(count);
            let (_, by_itself) = self.answer(index, bodies, weights, record, &own, &none)?;
            let inverse = DMatrix::from_columns(&columns).try_inverse()?;
            sum += &inverse * &by_itself;
            matrix += &inverse;
            answers.push((own, by_itself, inverse));
        }
        let moved = matrix.lu().solve(&sum)?;
        for (&index, (own, by_itself, inverse)) in chains.iter().zip(answers) {
            let load = inverse * (&moved - by_itself);
            let (found, _) = self.answer(index, bodies, weights, record, &own, &load)?;
            x[self.chains[index].entries.clone()].copy_from_slice(&found);
        }
        x[bodies.range()].copy_from_slice(moved.as_slice());
        Some(())
    }

    /// Answer of one chain for itself and for the bodies.
    fn answer(
        &self,
        index: usize,
        bodies: GroupBodies<'_>,
        weights: Weights,
        record: &mut Record,
        own: &[f64],
        load: &DVector<f64>,
    ) -> Option<(Vec<f64>, DVector<f64>)> {
        let mut x = [own, load.as_slice()].concat();
        let chain = &self.chains[index].chain;
        let record = &mut record.chains[index];
        let solved = chain.solve(bodies, weights, record, &mut x);
        let bodies = DVector::from_column_slice(&x[own.len()..]);
        x.truncate(own.len());
        solved.then_some((x, bodies))
    }
}

impl GroupBodies<'_> {
    /// M + c C + k K of the bodies by themselves.
    fn matrix(&self, weights: Weights) -> DMatrix<f64> {
        let mut matrix = DMatrix::from_diagonal(&DVector::from_column_slice(self.inertias()));
        self.each_own(weights, |[i, j], weighted| {
            matrix[(i, j)] += weighted;
        });
        matrix
    }
}

impl Bodies {
    /// Pushes with a state: its place, the coordinate that moves with it, the slopes at the last evaluation.
    fn each_state<'a>(
        &'a self,
        pushes: &'a [Slopes],
    ) -> impl Iterator<Item = (usize, usize, Slopes)> + 'a {
        let pushes = self.slides.iter().zip(pushes);
        pushes.filter_map(|(slide, slopes)| Some((slide.state?, slide.dof?, *slopes)))
    }
}
