//! Chains whose links do not stretch: laid with links that hardly do. The second search for the pretension: see [`assembly`](super).

use super::carried;
use crate::drive::{Layout, Parts, PlacedChain, PretensionAt};
use crate::{Assembled, AssemblyError, Drive};

/// Depth at which the teeth are asked for their stiffness \[m\].
const PRESSED: f64 = 1e-6;
/// Stiffness of a rigid link while the chain is laid, as a multiple of that of the teeth.
const HARD: f64 = 1e3;
/// The same where there is no pretension: a slack chain hangs free, and links much stiffer than its weight
/// keep Newton's method from finding how.
const HANGING: f64 = 10.0;
/// Relative error of the pretension that is left.
const MET: f64 = 1e-3;
/// Drives assembled before the search is given up.
const MOST: usize = 20;

/// Search for the tension to lay a chain with, such that it carries its pretension in equilibrium.
struct Search {
    /// Which chain.
    chain: usize,
    /// Tension \[N\] that it shall carry, and that it is laid with.
    asked: f64,
    given: f64,
    /// The last pair of tensions given and found.
    before: Option<(f64, f64)>,
}

impl Drive {
    /// Lays links so stiff that they hardly stretch.
    ///
    /// Such a chain owes its tension to the teeth alone. What the links are shortened by is found by the secant
    /// method, until the chain without gravity and load carries the pretension.
    pub(super) fn assemble_hard(&self) -> Result<Assembled, AssemblyError> {
        let mut parts = self.parts().clone();
        let mut searches = Vec::new();
        for (index, placed) in parts.chains.iter_mut().enumerate() {
            let asked = placed.layout.pretension();
            let touched = placed.sprockets.iter().map(|&i| &self.sprockets[i]);
            let teeth = touched
                .map(|sprocket| sprocket.surface.law.stiffness(PRESSED))
                .fold(0.0, f64::max);
            if placed.chain.model.stretches() || teeth <= 0.0 {
                continue;
            }
            let hard = if asked > 0.0 { HARD } else { HANGING };
            placed.chain.stiffness.fill(hard * teeth);
            if let Layout::Route { fit, phase, .. } = &mut placed.layout {
                // The tension is found at one phase; which one must not depend on where the run begins.
                if fit.at == PretensionAt::MeanPhase {
                    fit.at = PretensionAt::Phase;
                    *phase = 0.5;
                }
                // What it carries before the frame grows is looked for.
                fit.growth = 0.0;
            }
            searches.extend((asked > 0.0).then_some(Search {
                chain: index,
                asked,
                given: asked,
                before: None,
            }));
        }
        for _ in 0..MOST {
            for search in &searches {
                if let Layout::Route { fit, .. } = &mut parts.chains[search.chain].layout {
                    fit.pretension = search.given;
                }
            }
            let assembled = Self {
                parts: parts.clone(),
                begin: self.begin,
            }
            .assemble_as_is()?;
            let mut met = true;
            for search in &mut searches {
                let links = links_of(&parts.chains, search.chain);
                let Some(found) = carried(&assembled.statics, links) else {
                    return self.laid_by(parts, assembled);
                };
                met &= search.meets(found);
            }
            if met {
                return self.laid_by(parts, assembled);
            }
        }
        Err(AssemblyError::NoEquilibrium {
            stage: "pretension on ideal joints",
            residual: 1.0,
            iterations: MOST,
            tensioned: !parts.tensioners.is_empty(),
            pull: None,
        })
    }
}

impl Drive {
    /// The drive of some parts, which stands assembled, at the phases of this one and with the pretension where this one has it.
    fn laid_by(&self, mut parts: Parts, assembled: Assembled) -> Result<Assembled, AssemblyError> {
        let mut elsewhere = false;
        for (placed, own) in parts.chains.iter_mut().zip(&self.chains) {
            let (layout, own) = (&mut placed.layout, &own.layout);
            if let (
                Layout::Route { fit, phase, .. },
                Layout::Route {
                    fit: own,
                    phase: at,
                    ..
                },
            ) = (layout, own)
            {
                elsewhere |= fit.at != own.at || (fit.growth - own.growth).abs() > 0.0;
                (fit.at, fit.growth, *phase) = (own.at, own.growth, *at);
            }
        }
        if !elsewhere {
            return Ok(assembled);
        }
        let begin = self.begin;
        Self { parts, begin }.assemble_as_is()
    }
}

impl Search {
    /// Whether the tension found is near enough; if not, sets the next one to try.
    fn meets(&mut self, found: f64) -> bool {
        let Self { asked, given, .. } = *self;
        if (found / asked - 1.0).abs() < MET {
            return true;
        }
        let next = match self.before {
            Some((x, y)) if f64::abs(found - y) > 1e-3 * asked => {
                given + (asked - found) * (given - x) / (found - y)
            }
            _ => given * (asked / found).clamp(0.1, 30.0),
        };
        self.before = Some((given, found));
        self.given = next.clamp(0.1 * given, 30.0 * given);
        false
    }
}

/// Indices of the links of a chain among those of all chains.
pub(super) fn links_of(chains: &[PlacedChain], index: usize) -> std::ops::Range<usize> {
    let first = chains[..index]
        .iter()
        .map(|placed| placed.chain.links())
        .sum();
    first..first + chains[index].chain.links()
}
