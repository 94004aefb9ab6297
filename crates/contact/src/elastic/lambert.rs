//! The lower branch of Lambert's function in the form logarithmic contact laws need.

/// Solves u − ln u = 1 + t for the root u > 1.
///
/// ```text
/// u = −W₋₁(−e^{−1−t}),   t ≥ 0.1
/// ```
///
/// A starting value good to four digits, fitted in √(2t) up to t = 10 and asymptotic beyond, and one step of fourth
/// order that needs one logarithm. Relative error below 1e-15 for t ≥ 0.1; written for
/// t = ln(δ_max/δ), which stays above 0.105.
///
/// # Source
/// F. N. Fritsch, R. E. Shafer and W. P. Crowley, *Commun. ACM* **16**(2), 1973, 123–124,
/// <https://doi.org/10.1145/361952.361970>; the fit is ours.
#[inline]
pub(super) fn minus_w_lower(t: f64) -> f64 {
    let u = if t < 10.0 {
        // Near the branch point u = 1 + y + y²/3 + y³/36 − …,   y = √(2t); coefficients fitted on [0.1, 10].
        let y = (2.0 * t).sqrt();
        let tail = 0.024_068_864 + y * (y * 0.000_119_520_23 - 0.002_462_398_6);
        1.000_806_5 + y * (0.996_552_72 + y * (0.338_586_8 + y * tail))
    } else {
        // u = s + l + l/s + l (2 − l)/(2 s²) + …,   s = 1 + t,   l = ln s
        let s = 1.0 + t;
        let l = s.ln();
        s + l + l / s * (1.0 + (1.0 - 0.5 * l) / s)
    };
    // z = u − ln u − (1 + t),   w = 1 − u,   q = 2 w (w + ⅔ z)
    let z = (u - 1.0) - u.ln() - t;
    let w = 1.0 - u;
    let q = 2.0 * w * (w + 2.0 / 3.0 * z);
    // u ← u [1 + (z/w) (q − z)/(q − 2z)]
    u + u * z * (q - z) / (w * (q - 2.0 * z))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The residual of the defining equation, over the whole range of double precision.
    #[test]
    fn solves_its_equation() {
        let mut t: f64 = 0.1;
        while t < 720.0 {
            let u = minus_w_lower(t);
            let residual = (u - 1.0) - u.ln() - t;
            // A change du of the root changes the residual by (1 − 1/u) du.
            let error = residual / (1.0 - 1.0 / u) / u;
            assert!(error.abs() < 3e-15, "t = {t}: relative error {error:e}");
            t *= 1.003;
        }
    }

    /// Where the two starting values meet.
    #[test]
    fn branches_meet() {
        let (below, above) = (minus_w_lower(10.0 - 1e-12), minus_w_lower(10.0));
        assert!((above - below).abs() < 1e-11);
    }
}
