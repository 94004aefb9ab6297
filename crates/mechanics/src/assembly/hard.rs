//! Chains whose links do not stretch: laid with links that hardly do.

use crate::drive::Layout;
use crate::{Assembled, AssemblyError, Drive};

/// Depth at which the teeth are asked for their stiffness \[m\].
const PRESSED: f64 = 1e-6;
/// Stiffness of a rigid link while it is laid, in those of the teeth.
const HARD: f64 = 1e3;
/// The same where there is no pretension: a slack chain hangs free, and links much stiffer than its weight
/// keep Newton's method from finding how.
const HANGING: f64 = 10.0;
/// Relative error of the pretension that is left.
const MET: f64 = 1e-3;

impl Drive {
    /// Lays links so stiff that they hardly stretch.
    ///
    /// Such a chain owes its tension to the teeth alone. What the links are shortened by is found by the secant
    /// method, until the chain without gravity and load carries the pretension.
    pub(super) fn assemble_hard(&self) -> Result<Assembled, AssemblyError> {
        let teeth = self
            .sprockets
            .iter()
            .map(|sprocket| sprocket.surface.law.stiffness(PRESSED))
            .fold(0.0, f64::max);
        if teeth <= 0.0 {
            return self.assemble_as_is();
        }
        let mut parts = self.parts().clone();
        let asked = parts.layout.pretension();
        let hard = if asked > 0.0 { HARD } else { HANGING };
        parts.chain.stiffness.fill(hard * teeth);
        let (mut given, mut before) = (asked, None);
        for _ in 0..20 {
            if let Layout::Route { fit, .. } = &mut parts.layout {
                fit.pretension = given;
            }
            let assembled = Self {
                parts: parts.clone(),
            }
            .assemble_as_is()?;
            let taut = assembled
                .statics
                .first()
                .filter(|statics| statics.stage == "pretension");
            let Some(taut) = taut.filter(|_| asked > 0.0) else {
                return Ok(assembled);
            };
            let found = taut.tensions.iter().sum::<f64>() / taut.tensions.len() as f64;
            if (found / asked - 1.0).abs() < MET {
                return Ok(assembled);
            }
            let next = match before {
                Some((x, y)) if f64::abs(found - y) > 1e-3 * asked => {
                    given + (asked - found) * (given - x) / (found - y)
                }
                _ => given * (asked / found).clamp(0.1, 30.0),
            };
            before = Some((given, found));
            given = next.clamp(0.1 * given, 30.0 * given);
        }
        Err(AssemblyError::NoEquilibrium {
            stage: "pretension on ideal joints",
            residual: 1.0,
            iterations: 20,
        })
    }
}
