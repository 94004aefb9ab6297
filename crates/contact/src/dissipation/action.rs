//! Action of a dissipation on the elastic force, whichever law supplied its constants.

/// Closing speed, in units of the speed at onset, beyond which hysteretic damping grows no further.
///
/// A free impact closes at most as fast as it began: its ratio stays in \[−1, 1\], and a limit of 4
/// leaves it untouched even if the speed at onset was estimated at half or a quarter of the true one. What
/// the limit is for are contacts that begin gently and are then driven together hard, where
/// an unlimited factor would multiply the elastic force at will.
pub const RATIO_LIMIT: f64 = 4.0;

/// Action of a dissipation on an elastic force g, its constants worked out.
///
/// The contact never pulls, and an open one (g = 0) carries no force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Action {
    /// Nothing.
    None,
    /// Damping in proportion to the elastic force.
    ///
    /// ```text
    /// F = g clamp(1 + χ δ̇/v, 0, 1 + 4χ)
    /// ```
    ///
    /// v is the speed at which the contact began, or the floor of the law. The force is continuous when
    /// a contact opens or closes. The restitution of a free impact depends on χ only, see
    /// [`restitution`](crate::restitution).
    Hysteretic {
        /// Damping factor χ \[–\].
        factor: f64,
    },
    /// Damping beside the elastic force.
    ///
    /// ```text
    /// F = max(0, g + c δ̇)   while δ > 0
    /// ```
    ///
    /// The force jumps to c δ̇ when a contact begins: no method keeps its order across the jump.
    Viscous {
        /// Damping c \[N s/m\].
        damping: f64,
    },
}

impl Action {
    /// Force F \[N\] from the elastic force g \[N\], the closing speed and the speed at onset \[m/s\].
    #[inline]
    pub fn force(self, elastic: f64, rate: f64, onset: f64) -> f64 {
        match self {
            Self::None => elastic,
            Self::Hysteretic { factor } => {
                // F = g clamp(1 + χ δ̇/v, 0, 1 + 4χ)
                let ratio = (rate / onset).min(RATIO_LIMIT);
                elastic * (1.0 + factor * ratio).max(0.0)
            }
            Self::Viscous { damping } => {
                if elastic > 0.0 {
                    // F = max(0, g + c δ̇)
                    (elastic + damping * rate).max(0.0)
                } else {
                    0.0
                }
            }
        }
    }

    /// Force \[N\], stiffness ∂F/∂δ \[N/m\] at constant rate and damping ∂F/∂δ̇ \[N s/m\] from the elastic
    /// force \[N\] and its slope \[N/m\]; a derivative is zero where a limit holds the force against it.
    #[inline]
    pub fn respond(self, elastic: f64, slope: f64, rate: f64, onset: f64) -> [f64; 3] {
        match self {
            Self::None => [elastic, slope, 0.0],
            Self::Hysteretic { factor } => {
                // F = g D,   ∂F/∂δ = k D,   ∂F/∂δ̇ = χ g/v,   D = clamp(1 + χ δ̇/v, 0, 1 + 4χ)
                let inverse = 1.0 / onset;
                let ratio = rate * inverse;
                let share = (1.0 + factor * ratio.min(RATIO_LIMIT)).max(0.0);
                let free = ratio < RATIO_LIMIT && share > 0.0;
                let damping = if free {
                    factor * elastic * inverse
                } else {
                    0.0
                };
                [elastic * share, slope * share, damping]
            }
            Self::Viscous { damping } => {
                // F = max(0, g + c δ̇)
                let force = elastic + damping * rate;
                if elastic > 0.0 && force > 0.0 {
                    [force, slope, damping]
                } else {
                    [0.0, 0.0, 0.0]
                }
            }
        }
    }

    /// Slope ∂F/∂δ̇ \[N s/m\] at the same arguments; zero where a limit holds the force.
    #[inline]
    pub fn slope(self, elastic: f64, rate: f64, onset: f64) -> f64 {
        match self {
            Self::None => 0.0,
            Self::Hysteretic { factor } => {
                let ratio = rate / onset;
                if ratio < RATIO_LIMIT && 1.0 + factor * ratio > 0.0 {
                    // ∂F/∂δ̇ = χ g/v
                    factor * elastic / onset
                } else {
                    0.0
                }
            }
            Self::Viscous { damping } => {
                if elastic > 0.0 && elastic + damping * rate > 0.0 {
                    damping
                } else {
                    0.0
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_hold_at_both_ends() {
        let action = Action::Hysteretic { factor: 0.5 };
        let force = |ratio: f64| action.force(10.0, ratio * 0.2, 0.2);
        assert!((force(1.0) - 15.0).abs() < 1e-12);
        assert!((force(-1.0) - 5.0).abs() < 1e-12);
        assert!(force(-3.0).abs() < f64::MIN_POSITIVE, "never pulls");
        assert!((force(100.0) - 30.0).abs() < 1e-12, "1 + 4χ");
        assert!(action.slope(10.0, 100.0, 0.2).abs() < f64::MIN_POSITIVE);
    }
}
