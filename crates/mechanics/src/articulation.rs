//! Resistance of the links of a chain to turning against each other in their joints.

use chaindrive_contact::Friction;

use crate::DriveError;

/// Friction of pins in bushes, and what lubricant and seals add to it.
///
/// ```text
/// M = r f(N, r ω) − c ω,   ω: angular speed of a link against the one before it
/// ```
///
/// N is the force between pin and bush. A chain of particles takes the mean of the tensions of the two links for it: the pin
/// carries the tension of the outer link, which is behind the joint and before it in turn. Ideal joints take the force that
/// keeps their ends together. Joints with clearance rub in the contact of pin and bush, and have only c here.
///
/// The work of one articulation through the angle 2π/z is μ r T 2π/z; a plucked strand comes to rest within a few cycles,
/// since each takes some 4.5 μ r from its amplitude. Pins with clearance c roll by μ (c + δ)/r before they slide, and lose nothing by
/// that.
///
/// # Source
/// C. J. Lodge and S. C. Burgess, *Proc. IMechE C* **216**, 2002, 1067–1078 (losses of articulation).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Articulation {
    /// Friction law of pin and bush.
    pub friction: Friction,
    /// Radius r of the surface that slides, half the diameter of the pin \[m\], positive.
    pub radius: f64,
    /// Viscous damping c of every joint \[N m s/rad\], not negative.
    pub damping: f64,
}

impl Articulation {
    /// Names every parameter out of range.
    pub(crate) fn problems(&self) -> Vec<DriveError> {
        let mut problems = Vec::new();
        let mut need = |ok: bool, path: &str, value: f64, allowed: &'static str| {
            problems.extend(DriveError::require(ok, path, value, allowed).err());
        };
        need(
            self.radius > 0.0 && self.radius.is_finite(),
            "chain.joint.pin_radius",
            self.radius,
            "positive [m]",
        );
        need(
            self.damping >= 0.0 && self.damping.is_finite(),
            "chain.joint.damping",
            self.damping,
            "not negative [N m s/rad]",
        );
        if let Err(source) = self.friction.check() {
            problems.push(DriveError::Law {
                path: "chain.joint.contact.friction".into(),
                source,
            });
        }
        problems
    }
}
