//! Extremes of the polygon action over one period, from its events and stationary points.

use std::f64::consts::FRAC_PI_2;

use super::{DrivenState, Linkage, PolygonAction};

impl PolygonAction {
    /// Least and greatest speed ratio ω₂/ω₁ over a period \[–\].
    pub fn ratio_extremes(&self) -> (f64, f64) {
        self.extremes(|state| state.ratio, |state| state.ratio_rate)
    }

    /// Peak-to-peak transmission error \[rad\], at the driven wheel.
    pub fn transmission_error_range(&self) -> f64 {
        let mean = self.mean_ratio();
        // The error is stationary where the ratio has its mean.
        let (least, most) = self.extremes(
            |state| {
                state.angle
                    - mean * (state.driver_seat + state.span_angle + FRAC_PI_2 - self.seated_driver)
            },
            |state| state.ratio - mean,
        );
        most - least
    }

    /// Extremes over a period of a quantity that is smooth between the events, `slope` having the sign of its rate.
    fn extremes(
        &self,
        quantity: impl Fn(&DrivenState) -> f64,
        slope: impl Fn(&DrivenState) -> f64,
    ) -> (f64, f64) {
        const PIECES: u32 = 32;
        let period = 2.0 * self.half()[0];
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        for (links, turned, from, to) in [
            (self.seated_links, 0.0, 0.0, self.lift_off),
            (
                self.seated_links + 1,
                2.0 * self.half()[1],
                self.lift_off,
                period,
            ),
        ] {
            let linkage = Linkage {
                links,
                driver: self.seated_driver,
                turned,
            };
            let state = |at| self.evaluate(&linkage, at);
            let mut note = |at| {
                let value = quantity(&state(at));
                (least, most) = (least.min(value), most.max(value));
            };
            for i in 0..PIECES {
                let at = |i| from + (to - from) * f64::from(i) / f64::from(PIECES);
                let (low, high) = (at(i), at(i + 1));
                note(low);
                note(high);
                let rate = |at| slope(&state(at));
                if rate(low) * rate(high) < 0.0 {
                    let rising = rate(low) < 0.0;
                    note(bisect(
                        low,
                        high,
                        |at| if rising { rate(at) } else { -rate(at) },
                    ));
                }
            }
        }
        (least, most)
    }
}

/// Root between two places of a function that rises through zero; an end if it does not.
pub(super) fn bisect(mut low: f64, mut high: f64, rising: impl Fn(f64) -> f64) -> f64 {
    if rising(low) >= 0.0 {
        return low;
    }
    if rising(high) <= 0.0 {
        return high;
    }
    loop {
        let middle = low.midpoint(high);
        if middle <= low || middle >= high {
            return middle;
        }
        if rising(middle) > 0.0 {
            high = middle;
        } else {
            low = middle;
        }
    }
}
