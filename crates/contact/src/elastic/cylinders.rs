//! Two parallel cylinders, and which law their geometry makes.

use serde::{Deserialize, Serialize};

use super::{
    Conformal, Cylindrical, DubowskyFreudenstein, Elastic, ElasticLaw, Esdu78035, Johnson, Power,
    Radzimovsky,
};
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

/// A law of the family, to be built from the geometry of two parallel cylinders.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum CylinderLaw {
    /// [`Johnson`], D = 4ΔR; inside, outside and flat.
    Johnson,
    /// [`Conformal`] inside; a flat or convex counterpart does not conform, and its law **is** Johnson's.
    Conformal,
    /// [`Radzimovsky`], D = e^{5/3} ΔR; inside, outside and flat.
    Radzimovsky,
    /// [`Esdu78035`], D = 4e² ΔR; inside, outside and flat.
    #[serde(rename = "esdu-78035")]
    Esdu78035,
    /// [`DubowskyFreudenstein`], D = e² L²/R; needs no depth.
    DubowskyFreudenstein,
    /// [`Cylindrical`] in its range. Towards a flat it has no limit: in a hollow with more than 10 mm between
    /// the radii, on a flat, and outside with more than 300 mm the law **is** Johnson's. Below 0.005 mm
    /// inside and 4 mm outside it is refused.
    Cylindrical,
    /// [`Power::hertz`] with the reduced radius: a point contact, several times too soft for a line, as the
    /// elastic part of Lankarani and Nikravesh is often used.
    Hertz,
}

impl CylinderLaw {
    /// Every law, for tests and tables.
    pub const ALL: [Self; 7] = [
        Self::Johnson,
        Self::Conformal,
        Self::Radzimovsky,
        Self::Esdu78035,
        Self::DubowskyFreudenstein,
        Self::Cylindrical,
        Self::Hertz,
    ];

    /// The law of two cylinders. Where a law hands over to Johnson's is part of its description above,
    /// and the answer says which law it is.
    ///
    /// # Errors
    /// Names a parameter of the geometry that is impossible or outside the range of the law.
    pub fn between(self, pair: &Cylinders) -> Result<Elastic, ParameterError> {
        pair.check()?;
        let difference = pair.effective_radii();
        let modulus_length = pair.modulus * pair.length;
        let elastic = match self {
            Self::Conformal if pair.curvature < 0.0 => Elastic::Conformal(Conformal {
                clearance: difference,
                modulus_length,
            }),
            Self::Johnson | Self::Conformal => johnson(pair),
            Self::Radzimovsky => {
                Elastic::Radzimovsky(Radzimovsky::of_radii(difference, pair.length, pair.modulus))
            }
            Self::Esdu78035 => {
                Elastic::Esdu78035(Esdu78035::of_radii(difference, pair.length, pair.modulus))
            }
            Self::DubowskyFreudenstein => {
                Elastic::DubowskyFreudenstein(DubowskyFreudenstein::of_reduced_radius(
                    pair.reduced_radius(),
                    pair.length,
                    pair.modulus,
                ))
            }
            Self::Cylindrical => cylindrical(pair)?,
            Self::Hertz => Elastic::Power(Power::hertz(pair.reduced_radius(), pair.modulus)),
        };
        elastic.check()?;
        Ok(elastic)
    }
}

/// Johnson's law with the capped depth.
fn johnson(pair: &Cylinders) -> Elastic {
    Elastic::Johnson(Johnson {
        // D = 4ΔR
        length_scale: 4.0 * pair.effective_radii(),
        modulus_length: pair.modulus * pair.length,
    })
}

/// The enhanced law, or Johnson's towards a flat.
fn cylindrical(pair: &Cylinders) -> Result<Elastic, ParameterError> {
    let &Cylinders {
        radius,
        curvature,
        length,
        modulus,
        ..
    } = pair;
    let law = if curvature < 0.0 {
        if Cylindrical::is_nearly_flat_inside(pair.radii()) {
            return Ok(johnson(pair));
        }
        Cylindrical::internal(-1.0 / curvature, radius, length, modulus)?
    } else {
        if Cylindrical::is_nearly_flat_outside(pair.radii()) {
            return Ok(johnson(pair));
        }
        Cylindrical::external(radius, 1.0 / curvature, length, modulus)?
    };
    Ok(Elastic::Cylindrical(law))
}
