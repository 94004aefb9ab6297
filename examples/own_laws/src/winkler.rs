//! A lined guide.

use chaindrive::laws::elastic::ElasticLaw;
use chaindrive::laws::quantities::{JsonSchema, Length, Pressure};
use serde::{Deserialize, Serialize};

/// A rigid roller on a thin layer that yields as a mattress of springs, each by itself.
///
/// ```text
/// g = (4√2/3) (K L/h) √R δ^{3/2},   U = (2/5) g δ
/// ```
///
/// For a layer much thinner than the patch of contact is wide, bonded to a rigid rail: K = E (1 − ν)/\[(1 + ν)(1 − 2ν)\].
///
/// # Source
/// K. L. Johnson, *Contact Mechanics*, Cambridge University Press, 1985, section 4.3: p = (K/h)(δ − x²/2R), integrated over
/// the patch |x| < √(2Rδ).
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Winkler {
    /// Modulus of the layer K \[Pa\].
    #[schemars(with = "Pressure", extend("exclusiveMinimum" = 0))]
    pub modulus: f64,
    /// Thickness of the layer h \[m\].
    #[schemars(with = "Length", extend("exclusiveMinimum" = 0))]
    pub thickness: f64,
    /// Length of the contact L \[m\].
    #[schemars(with = "Length", extend("exclusiveMinimum" = 0))]
    pub length: f64,
    /// Radius of the roller R \[m\].
    #[schemars(with = "Length", extend("exclusiveMinimum" = 0))]
    pub radius: f64,
}

impl Winkler {
    /// g/δ^{3/2} \[N/m^1.5\]
    pub fn scale(&self) -> f64 {
        4.0 * 2_f64.sqrt() / 3.0 * self.modulus * self.length / self.thickness * self.radius.sqrt()
    }
}

impl ElasticLaw for Winkler {
    fn force(&self, penetration: f64) -> f64 {
        let depth = penetration.max(0.0);
        self.scale() * depth * depth.sqrt()
    }

    fn stiffness(&self, penetration: f64) -> f64 {
        1.5 * self.scale() * penetration.max(0.0).sqrt()
    }

    fn energy(&self, penetration: f64) -> f64 {
        0.4 * self.force(penetration) * penetration.max(0.0)
    }
}
