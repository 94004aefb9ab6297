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

/// Damping factor χ \[–\] with which a free impact delivers the restitution e \[–\]; the inverse of [`delivered`].
///
/// ```text
/// χ (1 + e) = ln[(1 + χ)/(1 − χ e)]
/// ```
///
/// Zero for e ≥ 1, infinite for e ≤ 0; relative error below 1e-15/(1 − e).
///
/// # Example
///
/// ```
/// use chaindrive_contact::restitution::{delivered, factor_for};
///
/// let factor = factor_for(0.7);
/// assert!((factor - 0.634_83).abs() < 1e-5);
/// assert!((delivered(factor) - 0.7).abs() < 1e-14);
/// ```
pub fn factor_for(restitution: f64) -> f64 {
    let e = restitution;
    if e >= 1.0 {
        return 0.0;
    }
    if e <= 0.0 {
        return f64::INFINITY;
    }
    // A start within 1 %, right in both limits: χ → 1/e for small e, 3(1 − e)/2 for e near 1.
    let numerator = 1.0 + e * (0.731_936 + e * (0.707_291 * e - 1.875_356));
    let mut factor = (1.0 - e) / e * numerator / (1.0 - 0.624_086 * e);
    for _ in 0..30 {
        let change = if e < 0.3 {
            // χ e = 1 − (1 + χ) E,   E = exp[−χ (1 + e)]: here 1 − χe itself is lost to rounding
            let decay = (-factor * (1.0 + e)).exp();
            let excess = factor * e - 1.0 + (1.0 + factor) * decay;
            excess / (e + decay * (1.0 - (1.0 + factor) * (1.0 + e)))
        } else {
            // −χe − ln(1 − χe) = χ − ln(1 + χ)
            let y = factor * e;
            let excess = logarithmic_excess(-y) - logarithmic_excess(factor);
            excess / (e * y / (1.0 - y) - factor / (1.0 + factor))
        };
        factor -= change;
        if change.abs() <= 1e-15 * factor {
            break;
        }
    }
    factor
}

/// x − ln(1 + x), without cancellation near zero.
pub(crate) fn logarithmic_excess(x: f64) -> f64 {
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

    /// There and back, from almost plastic to almost elastic, and both limits.
    #[test]
    fn inverse_of_the_inverse() {
        for i in 1..1000 {
            let e = 1e-3 * f64::from(i);
            let factor = factor_for(e);
            let error = delivered(factor) - e;
            assert!(error.abs() < 2e-14, "e = {e}: {factor}, {error:e}");
        }
        for tiny in [1e-300, 1e-9, 1e-3] {
            assert!((factor_for(tiny) * tiny - 1.0).abs() < 1e-15);
        }
        let loss = 1e-6;
        let series = 1.5 * loss;
        assert!((factor_for(1.0 - loss) / series - 1.0).abs() < 1e-5);
        assert!(factor_for(1.0).abs() < f64::MIN_POSITIVE);
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
