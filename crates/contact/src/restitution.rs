//! The restitution a hysteretic factor delivers, exactly.

/// Coefficient of restitution \[–\] of a free impact with the damping factor χ \[–\].
///
/// ```text
/// m v dv = −g(δ) (1 + χ v/v₀) dδ   ⇒   χ (1 + e) = ln[(1 + χ)/(1 − χ e)]
/// ```
///
/// The elastic law, the mass and the speed drop out: e depends on χ alone. Exact for χ ≥ 0; since
/// χe < 1 the force stays compressive until the surfaces part. e → 1 − ⅔χ for small χ, e → 1/χ for large.
///
/// # Example
///
/// ```
/// use chaindrive_contact::restitution::delivered;
///
/// let asked: f64 = 0.8; // of Lankarani and Nikravesh
/// let factor = 0.75 * (1.0 - asked.powi(2));
/// assert!((delivered(factor) - 0.847_102).abs() < 1e-6);
/// ```
///
/// # Source
/// Integration of the separable equation of motion; same content as Y. Gonthier et al.,
/// *Multibody Syst. Dyn.* **11**, 2004, 209–233.
pub fn delivered(factor: f64) -> f64 {
    let loss = logarithmic_excess(factor);
    if loss <= 0.0 {
        return 1.0;
    }
    // With y = χ e:  −y − ln(1 − y) = χ − ln(1 + χ).
    // Both bounds lie above the root and the left side is convex: Newton descends to it.
    let mut y = (2.0 * loss).sqrt().min(-(-(1.0 + loss)).exp_m1());
    if y >= 1.0 {
        return 1.0 / factor; // to rounding
    }
    for _ in 0..60 {
        let excess = logarithmic_excess(-y) - loss;
        let change = excess * (1.0 - y) / y;
        y -= change;
        if change.abs() <= 1e-16 * y {
            break;
        }
    }
    y / factor
}

/// x − ln(1 + x), without cancellation near zero.
fn logarithmic_excess(x: f64) -> f64 {
    if x.abs() > 0.02 {
        return x - x.ln_1p();
    }
    // x²/2 − x³/3 + x⁴/4 − …
    let mut sum = 0.0;
    for n in (2..=12).rev() {
        let sign = if n % 2 == 0 { 1.0 } else { -1.0 };
        sum = sum * x + sign / f64::from(n);
    }
    sum * x * x
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The defining equation, and both limits.
    #[test]
    fn satisfies_its_equation() {
        for factor in [1e-3, 0.1425, 0.5625, 0.75, 1.5, 4.919_17, 9.9, 40.0] {
            let e = delivered(factor);
            let left = factor * (1.0 + e);
            let right = ((1.0 + factor) / (1.0 - factor * e)).ln();
            let tolerance = 1e-9 + 1e-15 / (1.0 - factor * e);
            assert!((left / right - 1.0).abs() < tolerance, "χ = {factor}: {e}");
        }
        assert!((delivered(0.0) - 1.0).abs() < 1e-15);
        let small = 1e-6;
        assert!((delivered(small) - (1.0 - 2.0 / 3.0 * small)).abs() < 1e-11);
        assert!((delivered(50.0) * 50.0 - 1.0).abs() < 1e-12);
    }

    /// Series and logarithm meet.
    #[test]
    fn excess_is_continuous() {
        for x in [0.019_999_f64, -0.019_999] {
            let direct = x - x.ln_1p();
            assert!((logarithmic_excess(x) / direct - 1.0).abs() < 1e-12);
        }
    }
}
