//! The particle chain: point masses at the rollers, joined by spring-damper links.

use super::model::ChainModel;
use crate::{Articulation, DriveError, Strength};

/// How the two ends of the chain are joined.
#[derive(Clone, Debug, PartialEq)]
#[expect(
    clippy::large_enum_variant,
    reason = "a drive holds one, and a box would show in every scene"
)]
pub enum Ends {
    /// The last link returns to roller 0: as many rollers as links.
    Closed,
    /// A strand with one roller more than links; what happens at its first and last roller.
    Open([End; 2]),
}

/// Condition at one end of an open strand.
#[derive(Clone, Debug, PartialEq)]
pub enum End {
    /// The end roller moves freely.
    Free,
    /// The end roller stays where it was laid.
    Fixed,
    /// The end roller follows a motion from where it was laid.
    Driven {
        /// Displacement along x \[m\].
        x: crate::Motion,
        /// Displacement along y \[m\].
        y: crate::Motion,
    },
    /// A constant force pulls at the end roller.
    Pulled {
        /// Force \[N\], (x, y).
        force: chaindrive_geometry::Vector,
    },
}

/// A chain of `links` spring-damper links between point masses.
///
/// ```text
/// T = k (ℓ − p) + d ℓ̇          along the link, tension positive
/// ```
///
/// Link i joins roller i and roller i + 1 (for a closed chain, the last one returns to roller 0).
/// The spring acts in tension and in compression: a strand that is pushed folds, as a
/// chain does, because its joints carry no moment.
///
/// # Source
/// The lumped model of S. L. Pedersen, J. M. Hansen and J. A. C. Ambrósio, *Multibody Syst.
/// Dyn.* **12**, 2004, 285–301.
#[derive(Clone, Debug, PartialEq)]
pub struct Chain {
    /// Nominal pitch \[m\], positive: what the sprockets are cut for.
    pub pitch: f64,
    /// Unstressed length of every link \[m\], (links,): wear and scatter live here.
    pub lengths: Vec<f64>,
    /// Stiffness of every link \[N/m\], (links,), positive.
    pub stiffness: Vec<f64>,
    /// Damping of every link \[N s/m\], (links,), not negative.
    pub damping: Vec<f64>,
    /// Mass at every roller \[kg\], (rollers,), positive.
    pub masses: Vec<f64>,
    /// Roller diameter \[m\], positive.
    pub roller_diameter: f64,
    /// By how much the diameter of every roller exceeds that \[m\], (rollers,); empty where all are alike.
    pub roller_deviations: Vec<f64>,
    /// Height of the link plates \[m\], positive: what a guide for plates touches.
    pub plate_height: f64,
    /// Resistance of the joints, if there is any. Joints with clearance have their friction in the contact of pin and bush.
    pub articulation: Option<Articulation>,
    /// Drag b of oil or air across every link per length \[N s/m²\], not negative.
    ///
    /// ```text
    /// f = −b v_n    on every piece of a link, v_n its velocity across the link
    /// ```
    ///
    /// Together −b ℓ v_n in the middle of a link, and −b ℓ³ ω/12 against its turning. The first mode of a span, m′ its mass per
    /// length, has ζ = b/(2 m′ ω).
    pub drag: f64,
    /// How the ends are joined.
    pub ends: Ends,
    /// Its model. Rigid links take their lengths from `lengths`; stiffness, damping and
    /// masses are then those of the particle chain that serves to lay and settle them.
    pub model: ChainModel,
    /// Its strength, as far as that is known. Nothing follows from it but what is said of the result.
    pub strength: Strength,
}

/// Whether a value is in its range.
type Range = fn(f64) -> bool;

impl Chain {
    /// Number of links.
    pub fn links(&self) -> usize {
        self.lengths.len()
    }

    /// Number of rollers.
    pub fn rollers(&self) -> usize {
        match self.ends {
            Ends::Closed => self.links(),
            Ends::Open(_) => self.links() + 1,
        }
    }

    /// Whether the last link returns to roller 0.
    pub fn is_closed(&self) -> bool {
        self.ends == Ends::Closed
    }

    /// What is wrong with the deviations of rollers.
    fn roller_problems(&self) -> Option<DriveError> {
        let deviations = &self.roller_deviations;
        let path = "chain.roller_deviations";
        let count = deviations.len();
        if count > 0 && count != self.rollers() {
            let allowed = "one value for every roller, or none";
            return DriveError::require(false, path, count as f64, allowed).err();
        }
        let widest = 0.5 * self.roller_diameter;
        let fits = |it: &f64| it.abs() < widest;
        let bad = deviations.iter().position(|it| !fits(it))?;
        let allowed = "less than half of the roller diameter [m]";
        let path = format!("{path}[{bad}]");
        DriveError::require(false, &path, deviations[bad], allowed).err()
    }

    /// Names every parameter out of range.
    pub fn problems(&self) -> Vec<DriveError> {
        let mut problems = Vec::from_iter(self.roller_problems());
        let mut need = |ok: bool, path: String, value: f64, allowed: &'static str| {
            problems.extend(DriveError::require(ok, &path, value, allowed).err());
        };
        let positive = |value: f64| value > 0.0 && value.is_finite();
        let least = if self.is_closed() { 3 } else { 1 };
        need(
            self.links() >= least,
            "chain.links".into(),
            self.links() as f64,
            "at least 3 in a closed chain, 1 in a strand",
        );
        need(
            positive(self.pitch),
            "chain.pitch".into(),
            self.pitch,
            "positive [m]",
        );
        need(
            positive(self.roller_diameter),
            "chain.roller_diameter".into(),
            self.roller_diameter,
            "positive [m]",
        );
        need(
            positive(self.plate_height),
            "chain.plate_height".into(),
            self.plate_height,
            "positive [m]",
        );
        need(
            self.drag >= 0.0 && self.drag.is_finite(),
            "chain.drag".into(),
            self.drag,
            "not negative [N s/m²]",
        );
        let counts = [
            ("stiffness", self.stiffness.len(), self.links()),
            ("damping", self.damping.len(), self.links()),
            ("masses", self.masses.len(), self.rollers()),
        ];
        for (name, found, wanted) in counts {
            need(
                found == wanted,
                format!("chain.{name}"),
                found as f64,
                "one value for every link (stiffness, damping) or roller (masses)",
            );
        }
        let arrays: [(&str, &[f64], Range, &'static str); 4] = [
            ("lengths", &self.lengths, |v| v > 0.0, "positive [m]"),
            ("stiffness", &self.stiffness, |v| v > 0.0, "positive [N/m]"),
            (
                "damping",
                &self.damping,
                |v| v >= 0.0,
                "not negative [N s/m]",
            ),
            ("masses", &self.masses, |v| v > 0.0, "positive [kg]"),
        ];
        for (name, values, inside, allowed) in arrays {
            let bad = values.iter().position(|&v| !(v.is_finite() && inside(v)));
            if let Some(i) = bad {
                need(false, format!("chain.{name}[{i}]"), values[i], allowed);
            }
        }
        problems.extend(self.model.problems());
        problems.extend(self.strength.problems());
        let conflict = |path: &str, problem: &str| DriveError::Conflict {
            path: path.into(),
            problem: problem.into(),
        };
        let odd = self.is_closed() && !self.links().is_multiple_of(2);
        if odd && matches!(self.model, ChainModel::Strands(_)) {
            let problem = "inner and outer links alternate: a closed chain has an even number";
            problems.push(conflict("chain.links", problem));
        }
        if let ChainModel::Points(points) = &self.model {
            if !self.is_closed() || odd {
                let problem = "rollers, bushes and pins are points in closed chains of an even number of links only";
                problems.push(conflict("chain.links", problem));
            }
            if self.drag > 0.0 {
                let problem = "points have no drag; take rigid links with free rollers";
                problems.push(conflict("chain.drag", problem));
            }
            if self.masses.iter().any(|mass| *mass <= points.roller.mass) {
                let problem = "the roller is heavier than the whole joint";
                problems.push(conflict("chain.roller.mass", problem));
            }
        }
        problems.extend(self.articulation.iter().flat_map(Articulation::problems));
        let rubs = |it: &Articulation| it.rubs();
        if self.model.rubs_in_bushes() && self.articulation.as_ref().is_some_and(rubs) {
            problems.push(DriveError::Conflict {
                path: "chain.joint.contact.friction".into(),
                problem: "pins with clearance rub by the contact with their bushes".into(),
            });
        }
        problems
    }
}
