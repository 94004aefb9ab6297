//! Growth of a warm housing.

use super::Findings;
use crate::scene::defaults;
use crate::scene::schema::SceneText;

/// Growth of the centre distances against chain and sprockets since the chain was fitted \[–\].
///
/// ```text
/// g = (α_housing − α_chain)(T − T_fitted)
/// ```
pub(super) fn growth(scene: &SceneText, findings: &mut Findings<'_>) -> f64 {
    let Some(housing) = &scene.housing else {
        return 0.0;
    };
    let mut at = findings.at("housing");
    let steel = at
        .key("chain_expansion")
        .or(housing.chain_expansion, &defaults::CHAIN_EXPANSION);
    let fitted = at
        .key("assembled_at")
        .or(housing.assembled_at, &defaults::ASSEMBLED_AT);
    (housing.expansion.0 - steel) * (housing.temperature.0 - fitted)
}
