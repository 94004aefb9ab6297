//! Means and standard deviations of quantities over some looks.

/// Sums over the looks at one quantity.
#[derive(Clone, Copy, Default)]
pub(super) struct Sums {
    count: f64,
    sum: f64,
    squares: f64,
}

impl Sums {
    fn push(&mut self, value: f64) {
        // A span without a tension says nothing.
        if value.is_finite() {
            self.count += 1.0;
            self.sum += value;
            self.squares += value * value;
        }
    }

    pub(super) fn mean(&self) -> f64 {
        self.sum / self.count
    }

    pub(super) fn deviation(&self) -> f64 {
        (self.squares / self.count - self.mean().powi(2))
            .max(0.0)
            .sqrt()
    }
}

/// Adds a look at all quantities of a kind.
pub(super) fn add(sums: &mut Vec<Sums>, values: impl Iterator<Item = f64>) {
    for (place, value) in values.enumerate() {
        if place == sums.len() {
            sums.push(Sums::default());
        }
        sums[place].push(value);
    }
}
