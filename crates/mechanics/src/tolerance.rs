//! Deviations of sprockets from their drawings.

use chaindrive_geometry::Vector;

use crate::DriveError;

/// Errors of a sprocket that was cut and mounted: its teeth lie around a centre beside the axis, and its gaps are not in their places.
///
/// Both are given in the sprocket, whose first gap is the one at its gap angle. Gaps are counted counter-clockwise.
///
/// ```text
/// centre of the teeth = axis + R(θ) e (cos φ, sin φ),   angle of gap i = θ + 2π i/z + Δᵢ/R
/// ```
///
/// A run-out as a dial shows it is 2 e. Inertia is that about the axis, and the sprocket is balanced there.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tolerance {
    /// Eccentricity e \[m\], not negative.
    pub eccentricity: f64,
    /// Direction φ of the centre of the teeth, from the axis of the first gap \[rad\], counter-clockwise.
    pub eccentricity_angle: f64,
    /// Displacement Δᵢ of every gap along the pitch circle \[m\], counter-clockwise, (teeth,); empty where all are in place.
    pub gap_displacements: Vec<f64>,
}

/// Largest eccentricity or displacement, as a share of the pitch. *Assumed*: more is a mistake of units.
const FARTHEST: f64 = 0.1;

impl Tolerance {
    /// Centre of the teeth from the axis, in the frame whose x axis is that of the first gap \[m\].
    pub(crate) fn eccentricity(&self) -> Vector {
        let (sine, cosine) = self.eccentricity_angle.sin_cos();
        Vector::new(cosine, sine) * self.eccentricity
    }

    /// Angles by which the gaps stand from their places \[rad\].
    pub(crate) fn gap_angles(&self, pitch_radius: f64) -> Vec<f64> {
        let displacements = self.gap_displacements.iter();
        displacements.map(|it| it / pitch_radius).collect()
    }

    /// Whether the sprocket has no errors.
    pub fn is_none(&self) -> bool {
        self.eccentricity <= 0.0 && self.gap_displacements.iter().all(|it| it.abs() <= 0.0)
    }

    /// Names every parameter out of range.
    pub(crate) fn problems(&self, place: &str, teeth: u32, pitch: f64) -> Vec<DriveError> {
        let mut found = Vec::new();
        let mut need = |ok: bool, key: String, value: f64, allowed: &'static str| {
            found.extend(DriveError::require(ok, &format!("{place}.{key}"), value, allowed).err());
        };
        let e = self.eccentricity;
        let fits = (0.0..FARTHEST * pitch).contains(&e);
        let allowed = "not negative, below a tenth of the pitch [m]";
        need(fits, "eccentricity".into(), e, allowed);
        let angle = self.eccentricity_angle;
        let key = "eccentricity_angle".into();
        need(angle.is_finite(), key, angle, "finite [rad]");
        let count = self.gap_displacements.len();
        need(
            count == 0 || count == teeth as usize,
            "gap_displacements".into(),
            count as f64,
            "as many values as teeth, or none",
        );
        for (i, &displacement) in self.gap_displacements.iter().enumerate() {
            need(
                displacement.abs() < FARTHEST * pitch,
                format!("gap_displacements[{i}]"),
                displacement,
                "nearer to its place than a tenth of the pitch [m]",
            );
        }
        found
    }
}
