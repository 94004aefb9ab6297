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
    let mut or_default = |given: Option<f64>, key: &str, default| {
        findings.or_default(given, &format!("housing.{key}"), default)
    };
    let steel = housing.chain_expansion.map(|it| it.0);
    let steel = or_default(steel, "chain_expansion", &defaults::CHAIN_EXPANSION);
    let fitted = housing.assembled_at.map(|it| it.0);
    let fitted = or_default(fitted, "assembled_at", &defaults::ASSEMBLED_AT);
    (housing.expansion.0 - steel) * (housing.temperature.0 - fitted)
}
