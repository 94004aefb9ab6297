//! From places of rollers to flat arrays.

use chaindrive_geometry::{Point, Vector};

use super::drag::Drag;
use super::{Links, Particles};
use crate::chains::series::Series;
use crate::{Chain, End};

impl Particles {
    /// Point masses at `places`, and their coordinates.
    pub(crate) fn lay(chain: &Chain, places: &[Point]) -> (Self, Vec<f64>) {
        let links = Links::new(chain);
        let stride = links.stride();
        let rollers = chain.rollers();
        let series = Series::laid(chain, places, [stride, links.rest.len()]);
        let mut masses = chain.masses.clone();
        let mut inverse_masses: Vec<f64> = masses.iter().map(|m| 1.0 / m).collect();
        for held in &series.ends {
            if matches!(held.end, End::Fixed | End::Driven { .. }) {
                inverse_masses[held.roller] = 0.0;
            }
        }
        pad(&mut masses, stride, chain.is_closed());
        pad(&mut inverse_masses, stride, chain.is_closed());
        let q = coordinates(chain, places, stride);
        let particles = Self {
            lightest: inverse_masses.iter().copied().fold(0.0, f64::max),
            link_rates: link_rates(&links, &inverse_masses, rollers),
            drag: Drag::new(chain, links.rest.len()),
            links,
            masses: masses.into(),
            inverse_masses: inverse_masses.into(),
            series,
        };
        (particles, q)
    }
}

/// Masses after the last roller: those of the originals, or none.
fn pad(values: &mut Vec<f64>, stride: usize, closed: bool) {
    let count = values.len();
    for i in count..stride {
        values.push(if closed { values[i % count] } else { 0.0 });
    }
}

fn coordinates(chain: &Chain, places: &[Point], stride: usize) -> Vec<f64> {
    let count = chain.rollers();
    let mut q = vec![0.0; 2 * stride];
    for i in 0..stride {
        let place = if i < count {
            places[i]
        } else if chain.is_closed() {
            places[i % count]
        } else {
            // After a strand stand still points one pitch apart, so that no length is zero.
            places[count - 1] + Vector::x() * chain.pitch * (i + 1 - count) as f64
        };
        q[i] = place.x;
        q[stride + i] = place.y;
    }
    q
}

/// Largest Gershgorin row of M⁻¹K and of M⁻¹D over the rollers.
fn link_rates(links: &Links, inverse_masses: &[f64], rollers: usize) -> [f64; 2] {
    let row = |values: &[f64], roller: usize| {
        let before = match (roller, links.closed) {
            (0, true) => values[links.count - 1],
            (0, false) => 0.0,
            (i, _) => values[i - 1],
        };
        // (k₋ + k₊) on the diagonal and as much again beside it
        2.0 * (before + values[roller]) * inverse_masses[roller]
    };
    let largest = |values: &[f64]| (0..rollers).map(|i| row(values, i)).fold(0.0, f64::max);
    [largest(&links.stiffness), largest(&links.damping)]
}
