//! Waves of known forcings in a record, told from its mean.
//!
//! A record that ends within a period of a wave has a mean that errs by up to A/(π m) after m periods. What is known to repeat is no chance: the amplitudes of
//! its cosine and sine are fitted, along the phase that the drive itself had, to all readings of the record by least squares, and the mean is the
//! constant of that fit.
//!
//! ```text
//! x = μ + Σ aₖ (hₖ − h̄ₖ) + Σ aₖ h̄ₖ + r,   ∫ r² dt least:   M a = b,   M = ∫ (h − h̄)(h − h̄)ᵀ dt,   b = ∫ (x − x̄)(h − h̄) dt
//! μ = x̄ − Σ aₖ h̄ₖ
//! ```

use nalgebra::{Cholesky, DMatrix, DVector};
use serde::{Deserialize, Serialize};

/// Periods that a record has of a wave at least before it is fitted.
const PERIODS: f64 = 3.0;
/// Least eigenvalue of M over its time, which is ½ for waves that a record tells apart. *Assumed*: below, amplitudes would be known worse by √5.
const APART: f64 = 0.1;

/// Integrals of harmonics, of their products with one another and with a quantity.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct WaveSums {
    /// ∫ hᵢ dt, ∫ x hᵢ dt.
    own: Vec<f64>,
    with: Vec<f64>,
    /// ∫ hᵢ hⱼ dt, j ≤ i, row by row.
    products: Vec<f64>,
}

impl WaveSums {
    /// Takes in a value that stands for a time \[s\], with its harmonics.
    pub(super) fn push(&mut self, value: f64, time: f64, harmonics: &[f64]) {
        let count = harmonics.len();
        if self.own.len() != count {
            self.own.resize(count, 0.0);
            self.with.resize(count, 0.0);
            self.products.resize(count * (count + 1) / 2, 0.0);
        }
        let mut products = self.products.iter_mut();
        for (i, h) in harmonics.iter().enumerate() {
            let weighed = time * h;
            self.own[i] += weighed;
            self.with[i] += weighed * value;
            for (other, product) in harmonics[..=i].iter().zip(&mut products) {
                *product += weighed * other;
            }
        }
    }

    /// With those of another, or without.
    pub(super) fn combined(&self, other: &Self, sign: f64) -> Self {
        let each = |own: &[f64], other: &[f64]| {
            if own.is_empty() {
                other.iter().map(|it| sign * it).collect()
            } else if other.is_empty() {
                own.to_vec()
            } else {
                let pairs = own.iter().zip(other);
                pairs.map(|(a, b)| a + sign * b).collect()
            }
        };
        Self {
            own: each(&self.own, &other.own),
            with: each(&self.with, &other.with),
            products: each(&self.products, &other.products),
        }
    }

    /// Mean of waves of some amplitudes over a time \[s\].
    pub(super) fn mean_of(&self, amplitudes: &[f64], time: f64) -> f64 {
        let parts = amplitudes.iter().zip(&self.own);
        parts.map(|(a, h)| a * h).sum::<f64>() / time
    }

    /// M of some harmonics.
    fn matrix(&self, of: &[usize], time: f64) -> DMatrix<f64> {
        DMatrix::from_fn(of.len(), of.len(), |i, j| {
            let (low, high) = (of[i].min(of[j]), of[i].max(of[j]));
            let product = self.products[high * (high + 1) / 2 + low];
            product - self.own[low] * self.own[high] / time
        })
    }
}

/// Which harmonics a record tells from its mean and from one another.
#[derive(Clone, Debug)]
pub(super) struct WaveFit {
    told: Vec<usize>,
}

/// What waves make of a record.
pub(super) struct Waves {
    /// What they add to its mean.
    pub(super) shift: f64,
    /// Variance that they explain there, and what they have in whole periods.
    pub(super) explained: f64,
    pub(super) power: f64,
    /// Amplitude of every harmonic.
    pub(super) amplitudes: Vec<f64>,
}

impl WaveFit {
    /// No waves.
    pub(super) fn none() -> Self {
        Self { told: Vec::new() }
    }

    /// Those of forcings with these periods \[s\] that a record of a time \[s\] tells apart.
    pub(super) fn of(sums: &WaveSums, time: f64, periods: &[f64]) -> Self {
        let mut told: Vec<usize> = Vec::new();
        if sums.own.len() == 2 * periods.len() {
            for (k, period) in periods.iter().enumerate() {
                if time < PERIODS * period {
                    continue;
                }
                let mut more = told.clone();
                more.extend([2 * k, 2 * k + 1]);
                let eigenvalues = sums.matrix(&more, time).symmetric_eigenvalues();
                if eigenvalues.min() > APART * time {
                    told = more;
                }
            }
        }
        Self { told }
    }

    /// Fits them to a record of a time \[s\] and a mean.
    pub(super) fn fit(&self, sums: &WaveSums, time: f64, mean: f64) -> Waves {
        let mut waves = Waves {
            shift: 0.0,
            explained: 0.0,
            power: 0.0,
            amplitudes: vec![0.0; sums.own.len()],
        };
        if self.told.is_empty() {
            return waves;
        }
        let right = self
            .told
            .iter()
            .map(|k| sums.with[*k] - mean * sums.own[*k]);
        let right = DVector::from_iterator(self.told.len(), right);
        // Without one block of three the others may not tell them apart: then they stay in the mean.
        let Some(factored) = Cholesky::new(sums.matrix(&self.told, time)) else {
            return waves;
        };
        let found = factored.solve(&right);
        for (k, amplitude) in self.told.iter().zip(&found) {
            waves.amplitudes[*k] = *amplitude;
        }
        waves.shift = sums.mean_of(&waves.amplitudes, time);
        waves.explained = found.dot(&right) / time;
        waves.power = 0.5 * found.norm_squared();
        waves
    }
}
