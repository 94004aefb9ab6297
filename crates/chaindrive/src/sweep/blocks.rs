//! Blocks of variants that are alike: one choice of method and step serves them all.
//!
//! The recipe decides which variants are in a block, and nothing else does: neither threads, executor, tasks nor a resume.

use std::collections::HashMap;

use super::{Setting, Sweep};
use crate::Scene;

/// Variants of a block at most. *Assumed*: a choice takes at most some short runs, so that a thirtieth of it beside a variant is not felt,
/// and neighbours in a sweep differ by little.
const LARGEST: usize = 32;

/// The blocks of a sweep.
#[derive(Debug)]
pub(super) struct SweepBlocks {
    /// Block of each variant.
    of: Vec<u32>,
    /// Variants of each block, in their order.
    members: Vec<Vec<u32>>,
}

impl SweepBlocks {
    /// Variants that differ in numbers only, 32 at most and in their order. What is no number tells variants apart, such as a model of the
    /// chain, and so does every key of `[run]`: an end or an accuracy is another question to the choice.
    #[expect(
        clippy::cast_possible_truncation,
        reason = "a sweep has a million variants at most"
    )]
    pub(super) fn of(sweep: &Sweep) -> Self {
        let kinds = sweep.dimensions.iter();
        let kinds: Vec<Vec<usize>> = kinds
            .map(|it| kinds_of(&sweep.scene, &it.path, &it.settings))
            .collect();
        let mut blocks = Self {
            of: Vec::with_capacity(sweep.len),
            members: Vec::new(),
        };
        // The block of each kind of variants that is being filled.
        let mut filling = HashMap::<Vec<usize>, usize>::new();
        for variant in 0..sweep.len {
            let places = sweep.indices(variant);
            let kind = kinds.iter().zip(&places).map(|(kinds, &at)| kinds[at]);
            let block = filling.entry(kind.collect()).or_insert(usize::MAX);
            if blocks
                .members
                .get(*block)
                .is_none_or(|it| it.len() == LARGEST)
            {
                *block = blocks.members.len();
                blocks.members.push(Vec::new());
            }
            blocks.members[*block].push(variant as u32);
            blocks.of.push(*block as u32);
        }
        blocks
    }

    /// The block of a variant.
    pub(super) fn block(&self, variant: usize) -> usize {
        self.of[variant] as usize
    }

    /// Variants of a block, in their order.
    pub(super) fn members(&self, block: usize) -> impl Iterator<Item = usize> {
        self.members[block].iter().map(|&variant| variant as usize)
    }
}

/// The kind of each value at a path: numbers are of one kind, and of everything else equal values are.
fn kinds_of(scene: &Scene, path: &str, settings: &[Setting]) -> Vec<usize> {
    let is_of_run = scene.place(path).starts_with("run.");
    let mut known = HashMap::new();
    let kinds = settings.iter().map(|setting| {
        let is_alike = setting.is_number() && !is_of_run;
        let name = (!is_alike).then(|| setting.text());
        let next = known.len();
        *known.entry(name).or_insert(next)
    });
    kinds.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn blocks(vary: &[(&str, Vec<Setting>)]) -> Vec<Vec<usize>> {
        let scene = Scene::preset("spinning_ring").unwrap();
        let vary = vary.iter();
        let vary: Vec<_> = vary
            .map(|(path, it)| ((*path).to_owned(), it.clone()))
            .collect();
        let sweep = Sweep::new(&scene, &vary, &[]).unwrap();
        let blocks = SweepBlocks::of(&sweep);
        let all = (0..blocks.members.len()).map(|block| blocks.members(block).collect());
        let all: Vec<Vec<usize>> = all.collect();
        for (block, members) in all.iter().enumerate() {
            assert!(
                members
                    .iter()
                    .all(|&variant| blocks.block(variant) == block)
            );
        }
        all
    }

    #[test]
    fn numbers_are_alike_and_nothing_else_is() {
        let text = |text: &str| Setting::Text(text.to_owned());
        let speeds: Vec<_> = (0..20).map(|n| Setting::Json((300 + n).into())).collect();
        let masses = vec![text("8 g"), text("9 g")];
        // The last path varies fastest: forty variants, 32 of them in the first block.
        let both = [
            ("chain.start.speed", speeds),
            ("chain.mass", masses.clone()),
        ];
        let sizes = |of: Vec<Vec<usize>>| of.iter().map(Vec::len).collect::<Vec<_>>();
        assert_eq!(sizes(blocks(&both)), [32, 8]);
        let models = vec![text("particles"), text("ideal-joints")];
        let apart = [("chain.mass", masses.clone()), ("chain.model", models)];
        assert_eq!(blocks(&apart), [vec![0, 2], vec![1, 3]]);
        let ends = vec![text("1 ms"), text("2 ms")];
        let apart = [("run.until", ends), ("chain.mass", masses)];
        assert_eq!(blocks(&apart), [vec![0, 1], vec![2, 3]]);
    }
}
