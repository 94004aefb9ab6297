//! The speed at which a contact began, from two accepted states.

/// Closing speed at zero gap \[m/s\], interpolated between two accepted states.
///
/// ```text
/// v = v_a + s (v_b − v_a),   s = g_a/(g_a − g_b)
/// ```
///
/// Gaps g \[m\] are positive before contact, rates \[m/s\] positive while closing. Sampling the
/// speed at the first state in contact instead would make every method of time stepping first order;
/// the interpolation is of second order. The rate now already bears what the contact has slowed it down by, so an
/// onset deep into a long step reads a little low.
///
/// s is held in \[0, 1\]: without a gap before (g_a ≤ 0: a contact present from the start) the answer is the
/// speed before, without contact now the speed now. Never negative, finite for finite arguments.
pub fn interpolated_onset(gap_before: f64, rate_before: f64, gap_now: f64, rate_now: f64) -> f64 {
    // s = g_a/(g_a − g_b)
    let s = if gap_before <= 0.0 {
        0.0
    } else if gap_now >= 0.0 {
        1.0
    } else {
        gap_before / (gap_before - gap_now)
    };
    // v = v_a + s (v_b − v_a)
    (rate_before + s * (rate_now - rate_before)).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// In free fall v² = v_a² + 2 g x holds exactly; the interpolation is off by the square of the step.
    #[test]
    fn second_order_in_free_fall() {
        let (gravity, speed, gap) = (9.806_65_f64, 0.5_f64, 1.3e-4);
        let exact = (speed * speed + 2.0 * gravity * gap).sqrt();
        let error = |h: f64| {
            // Start so that the surface is met at the same fraction of each step.
            let before = 0.3 * h * (speed + 0.15 * gravity * h);
            let at_before = (exact * exact - 2.0 * gravity * before).sqrt();
            let fallen = at_before * h + 0.5 * gravity * h * h;
            let now = at_before + gravity * h;
            (interpolated_onset(before, at_before, before - fallen, now) - exact).abs()
        };
        let order = (error(2e-4) / error(1e-4)).log2();
        assert!((order - 2.0).abs() < 0.05, "order {order}");
    }

    #[test]
    fn degenerate_pairs_of_states() {
        assert!((interpolated_onset(0.0, 0.3, 0.0, 0.4) - 0.3).abs() < 1e-15);
        assert!((interpolated_onset(-1e-6, 0.3, -2e-6, 0.4) - 0.3).abs() < 1e-15);
        assert!((interpolated_onset(1e-6, 0.3, 1e-7, 0.4) - 0.4).abs() < 1e-15);
        assert!(interpolated_onset(1e-6, -0.3, -1e-6, -0.4).abs() < 1e-15);
    }
}
