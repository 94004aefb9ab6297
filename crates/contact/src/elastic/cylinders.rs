//! Two parallel cylinders.

use serde::{Deserialize, Serialize};

use crate::ParameterError;
use crate::error::{require, require_positive};

/// A roller or pin and the surface it touches, both cylinders about parallel axes.
///
/// ```text
/// 1/R = 1/r + κ,   h = min(1/|κ|, cap),   ΔR = r h/R = h (1 + κ r)
/// ```
///
/// κ is the curvature of the counterpart where they touch: negative in a seat or hole, zero on a
/// flat, positive around a tooth tip. Without the cap ΔR is the clearance r_hole − r inside and the
/// sum of the radii outside. The compliance of a cylinder grows with the logarithm of its depth, so that
/// a flat needs one: the cap stands for it and takes over continuously from a large radius.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cylinders {
    /// Radius r of the roller or pin \[m\], positive.
    pub radius: f64,
    /// Curvature κ of the counterpart \[1/m\]: negative concave, zero flat; above −1/r.
    pub curvature: f64,
    /// Length L of the contact \[m\], positive.
    pub length: f64,
    /// Composite modulus E* \[Pa\], positive.
    pub modulus: f64,
    /// Greatest depth h of the counterpart \[m\], positive: the thickness of a rail, half a pitch for a tooth.
    pub depth_cap: f64,
}

impl Cylinders {
    /// A pin in a hole: radii and contact length \[m\], composite modulus \[Pa\].
    pub fn pin_in_hole(hole: f64, pin: f64, length: f64, modulus: f64) -> Self {
        Self::on_curve(pin, -1.0 / hole, length, modulus, hole)
    }

    /// Two cylinders side by side: radii and contact length \[m\], composite modulus \[Pa\].
    pub fn side_by_side(radius: f64, other: f64, length: f64, modulus: f64) -> Self {
        Self::on_curve(radius, 1.0 / other, length, modulus, other)
    }

    /// A roller on a curve: radius \[m\], signed curvature \[1/m\], contact length \[m\], composite
    /// modulus \[Pa\], greatest depth \[m\].
    pub fn on_curve(
        radius: f64,
        curvature: f64,
        length: f64,
        modulus: f64,
        depth_cap: f64,
    ) -> Self {
        Self {
            radius,
            curvature,
            length,
            modulus,
            depth_cap,
        }
    }

    /// Reduced radius R \[m\].
    ///
    /// ```text
    /// 1/R = 1/r + κ
    /// ```
    pub fn reduced_radius(&self) -> f64 {
        // R = r/(1 + κ r)
        self.radius / (1.0 + self.curvature * self.radius)
    }

    /// Clearance inside, sum of the radii outside \[m\]; infinite on a flat.
    pub fn radii(&self) -> f64 {
        // |1/κ + r|
        (1.0 / self.curvature + self.radius).abs()
    }

    /// ΔR \[m\] with the depth capped: what a logarithmic law reckons with.
    pub fn effective_radii(&self) -> f64 {
        if 1.0 / self.curvature.abs() <= self.depth_cap {
            self.radii()
        } else {
            // ΔR = h (1 + κ r)
            self.depth_cap * (1.0 + self.curvature * self.radius)
        }
    }

    /// Refuses cylinders that cannot touch along a line.
    ///
    /// # Errors
    /// Names the first parameter outside its range.
    pub fn check(&self) -> Result<(), ParameterError> {
        require_positive("radius", self.radius, "positive [m]")?;
        require(
            1.0 + self.curvature * self.radius > 0.0 && self.curvature.is_finite(),
            "curvature",
            self.curvature,
            "above −1/radius [1/m]: a pin is smaller than its hole",
        )?;
        require_positive("length", self.length, "positive [m]")?;
        require_positive("modulus", self.modulus, "positive [Pa]")?;
        require_positive("depth_cap", self.depth_cap, "positive [m]")
    }
}
