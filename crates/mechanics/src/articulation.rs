//! Resistance of the links of a chain to turning against each other in their joints.

use chaindrive_contact::Friction;
use chaindrive_quantities::{JsonSchema, Length, Ratio, check};
use serde::{Deserialize, Serialize};

use crate::DriveError;

/// Friction of pins in bushes, and what lubricant and seals add to it.
///
/// ```text
/// M = r f(N, r ω) − c ω,   ω: angular speed of a link against the one before it
/// ```
///
/// N is the force between pin and bush. A chain of particles takes the mean of the tensions of the two links for it: the pin
/// carries the tension of the outer link, which is after the joint and before it in turn. Ideal joints take the force that
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
    /// Torque that the seal of every joint holds back with \[N m\], not negative: rings between inner and outer plates. It holds at rest
    /// and slides with the pin, and needs a friction that holds by a spring for that (of coefficient 0 where pins have play).
    pub seal: f64,
    /// Friction of plates where a chain runs out of line, if sprockets do; it needs such a friction as well.
    pub lateral: Option<LateralRub>,
}

/// Plates that rub where the sprockets at the ends of a span are out of line, by Δy on a length L.
///
/// ```text
/// tan γ = max(0, |Δy| − play)/L,   F_s = T tan γ,   M = μ_s F_s h
/// ```
///
/// The side force F_s passes from the span to the first tooth: where an inner link swings in, its plate rubs on the flank of the tooth, where
/// an outer link does, on the inner plate before it. Either rubs with the coefficient μ_s at a lever h from the pin while the joint turns, and that is by α = 2π/z
/// at each end: the work is μ_s F_s h α. Nothing moves out of the plane.
///
/// # Source
/// J. B. Spicer, C. J. K. Richardson, M. J. Ehrlich, J. R. Bernstein, M. Fukuda and M. Terada, *Hum. Power* **50**, 2000, 3–9: their loss by
/// offset, with a radius r₀ of the plates for h, and sin γ, which is tan γ to 0.5 % below 5°.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(
    rename = "Lateral",
    description = "Plates that rub where the chain runs out of line: between sprockets whose `lateral` places differ."
)]
pub struct LateralRub {
    /// Coefficient of friction of plates on teeth and on each other \[–\].
    #[serde(rename = "friction")]
    #[schemars(with = "Option<Ratio>", extend("minimum" = 0))]
    pub coefficient: f64,
    /// Lever from the pin to where they rub \[m\].
    #[schemars(with = "Option<Length>", extend("exclusiveMinimum" = 0))]
    pub lever: f64,
    /// Lateral play of the chain on its sprockets \[m\]: an offset within it costs nothing.
    #[schemars(with = "Option<Length>", extend("minimum" = 0))]
    pub play: f64,
}

impl Articulation {
    /// Whether pins rub in their bushes: a spring without friction serves seals and plates alone.
    pub fn rubs(&self) -> bool {
        match self.friction {
            Friction::None => false,
            Friction::SpringSlider(spring) => spring.coefficient > 0.0,
            _ => true,
        }
    }

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
        need(
            self.seal >= 0.0 && self.seal.is_finite(),
            "chain.joint.seal",
            self.seal,
            "not negative [N m]",
        );
        let lateral = self.lateral.and_then(|it| check(&it).err());
        problems.extend(lateral.map(|error| DriveError::law("chain.lateral", error)));
        let springs = matches!(
            self.friction,
            Friction::SpringSlider(_) | Friction::Stribeck(_)
        );
        if !springs && (self.seal > 0.0 || self.lateral.is_some()) {
            let problem = "seals and plates hold by a spring; take `spring-slider` or `stribeck`";
            problems.push(DriveError::Conflict {
                path: "chain.joint.contact.friction".into(),
                problem: problem.into(),
            });
        }
        if let Err(source) = self.friction.check() {
            problems.push(DriveError::Law {
                path: "chain.joint.contact.friction".into(),
                source,
            });
        }
        problems
    }
}
