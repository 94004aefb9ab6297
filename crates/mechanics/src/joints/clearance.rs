//! Pins and rollers with play, as a drive describes them.

use crate::DriveError;
use crate::surface::Surface;

/// A pin in a bush.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clearance {
    /// Radius of the pin \[m\], positive.
    pub pin_radius: f64,
    /// Radius of the bore \[m\], at least the pin's: equal radii are a joint without play, whose law is that of the link that yields.
    pub bore_radius: f64,
    /// Contact of pin and bush.
    pub surface: Surface,
}

/// A roller loose on its bush.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreeRoller {
    /// Mass \[kg\], positive.
    pub mass: f64,
    /// Moment of inertia \[kg m²\], positive.
    pub inertia: f64,
    /// Outer radius of the bush \[m\], positive.
    pub bush_radius: f64,
    /// Radius of the roller's bore \[m\], larger than the bush's.
    pub bore_radius: f64,
    /// Contact of bush and roller.
    pub surface: Surface,
}

impl Clearance {
    /// Radial clearance c \[m\].
    pub fn gap(&self) -> f64 {
        self.bore_radius - self.pin_radius
    }

    /// Names every parameter out of range.
    pub(crate) fn problems(&self) -> Vec<DriveError> {
        let names = ["chain.joint.pin_radius", "chain.joint.bore_radius"];
        let mut problems = fit([self.pin_radius, self.bore_radius], names, Play::MayLack);
        problems.extend(self.surface.problems("chain.joint"));
        problems
    }
}

impl FreeRoller {
    /// Radial clearance \[m\].
    pub fn gap(&self) -> f64 {
        self.bore_radius - self.bush_radius
    }

    /// Names every parameter out of range.
    pub(crate) fn problems(&self) -> Vec<DriveError> {
        let names = ["chain.roller.bush_radius", "chain.roller.bore_radius"];
        let mut problems = fit([self.bush_radius, self.bore_radius], names, Play::Must);
        for (path, value, allowed) in [
            ("chain.roller.mass", self.mass, "positive [kg]"),
            ("chain.roller.inertia", self.inertia, "positive [kg m²]"),
        ] {
            let positive = value > 0.0 && value.is_finite();
            problems.extend(DriveError::require(positive, path, value, allowed).err());
        }
        problems.extend(self.surface.problems("chain.roller"));
        problems
    }
}

/// Play that a part turning in a bore must have, or may have.
#[derive(Clone, Copy)]
enum Play {
    /// It must have play.
    Must,
    /// With play or without.
    MayLack,
}

/// Names what is wrong with the radii of something that turns in a bore.
fn fit([inside, outside]: [f64; 2], names: [&'static str; 2], play: Play) -> Vec<DriveError> {
    let (fits, allowed) = match play {
        Play::Must => (outside > inside, "larger than what turns in it [m]"),
        Play::MayLack => (outside >= inside, "as large as the pin or larger [m]"),
    };
    let fits = outside.is_finite() && fits;
    let found = [
        DriveError::require(
            inside > 0.0 && inside.is_finite(),
            names[0],
            inside,
            "positive [m]",
        ),
        DriveError::require(fits, names[1], outside, allowed),
    ];
    found.into_iter().filter_map(Result::err).collect()
}
