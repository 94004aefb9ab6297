//! Rigid links: the chain as bodies, joined ideally or with clearance.

use chaindrive_geometry::Vector;

use crate::DriveError;
use crate::surface::Surface;

/// Rigid inner and outer links in turn.
///
/// Inner links carry the bushes, outer links the pins. The roller distance over an inner link is
/// its own; over an outer link it grows with the clearance, as it does when a chain wears:
///
/// ```text
/// inner: L = p,   outer: L = p − 2 (c + δ(T₀))
/// ```
///
/// so that the chain under its pretension T₀ has the pitch p everywhere.
///
/// # Source
/// C. Pereira, J. Ambrósio and A. Ramalho, *Contact mechanics in a roller chain drive using a
/// multibody approach*, 13th World Congress in Mechanism and Machine Science, 2011, A8-585.
#[derive(Clone, Debug, PartialEq)]
pub struct RigidLinks {
    /// Links with bushes.
    pub inner: LinkBody,
    /// Links with pins.
    pub outer: LinkBody,
    /// Whether link 0 is an outer one.
    pub outer_first: bool,
    /// How neighbouring links are joined.
    pub joint: Joint,
    /// The part that runs on the teeth.
    pub rollers: RollerModel,
}

/// Mass properties of one link, both plates and its pins or bushes; free rollers not included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkBody {
    /// Mass \[kg\], positive.
    pub mass: f64,
    /// Moment of inertia about the centre of mass \[kg m²\], positive.
    pub inertia: f64,
    /// Centre of mass from the middle between the joints \[m\]: along the link in the order of the
    /// chain, and to its left.
    pub centre: Vector,
}

/// How neighbouring links are joined.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Joint {
    /// An ideal hinge.
    Ideal,
    /// A pin in a larger bush.
    Clearance(Clearance),
}

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

/// The part that runs on the teeth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RollerModel {
    /// Rollers that move with the bush: their mass is the link's. They slide, as the particles do.
    Lumped {
        /// Mass of one roller \[kg\], not negative.
        mass: f64,
    },
    /// Rollers as bodies of their own, loose on the bush.
    Free(FreeRoller),
    /// None: the bush itself meets the tooth, and turns with its link.
    Bush,
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

impl RigidLinks {
    /// Whether link `index` carries the bushes.
    pub(crate) fn is_inner(&self, index: usize) -> bool {
        index.is_multiple_of(2) != self.outer_first
    }

    /// Names every parameter out of range.
    pub(crate) fn problems(&self) -> Vec<DriveError> {
        let mut problems = Vec::new();
        let mut need = |ok: bool, path: &str, value: f64, allowed: &'static str| {
            problems.extend(DriveError::require(ok, path, value, allowed).err());
        };
        let positive = |value: f64| value > 0.0 && value.is_finite();
        for (name, body) in [("inner", &self.inner), ("outer", &self.outer)] {
            let path = |what: &str| format!("chain.{name}.{what}");
            need(
                positive(body.mass),
                &path("mass"),
                body.mass,
                "positive [kg]",
            );
            need(
                positive(body.inertia),
                &path("inertia"),
                body.inertia,
                "positive [kg m²]",
            );
            for (axis, value) in [("x", body.centre.x), ("y", body.centre.y)] {
                need(
                    value.is_finite(),
                    &path(&format!("centre.{axis}")),
                    value,
                    "finite [m]",
                );
            }
        }
        if let RollerModel::Lumped { mass } = self.rollers {
            need(
                mass >= 0.0 && mass.is_finite(),
                "chain.roller.mass",
                mass,
                "not negative [kg]",
            );
        }
        if let Joint::Clearance(joint) = &self.joint {
            problems.extend(joint.problems());
        }
        if let RollerModel::Free(roller) = &self.rollers {
            problems.extend(roller.problems());
        }
        problems
    }
}

/// Whether something that turns in a bore has play in it.
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
