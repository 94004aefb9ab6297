//! The duty of chains, as the samples see it: tension, power, speed.

use std::ops::Range;

use chaindrive_mechanics::{ChainSize, Observation, PlacedChain, Strength};
use serde::{Deserialize, Serialize};

use super::{SpanStatistics, SprocketStatistics, Summary};
use crate::Simulation;
use crate::rating::{Load, SprocketDuty};

/// Sums over the samples, by chain.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct ChainDuties {
    chains: Vec<DutySums>,
    samples: f64,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct DutySums {
    name: String,
    strength: Strength,
    pitch: f64,
    links: Range<usize>,
    spans: Range<usize>,
    sprockets: Vec<usize>,
    /// Greatest and least tension of a link \[N\].
    greatest: f64,
    least: f64,
    /// Links that were pressed, over all samples.
    pressed: f64,
}

impl ChainDuties {
    pub(super) fn new(simulation: &Simulation) -> Self {
        let drive = &simulation.assembled().drive;
        let sizes = simulation.system().chain_sizes();
        let (mut first, mut first_span) = (0, 0);
        let of_chain = |(placed, (name, size)): (&PlacedChain, (String, ChainSize))| {
            let links = first..first + size.links;
            first = links.end;
            let spans = first_span..first_span + size.spans;
            first_span = spans.end;
            DutySums {
                name,
                strength: placed.chain.strength,
                pitch: placed.chain.pitch,
                links,
                spans,
                sprockets: placed.sprockets.clone(),
                greatest: f64::NEG_INFINITY,
                least: f64::INFINITY,
                pressed: 0.0,
            }
        };
        Self {
            chains: drive.chains.iter().zip(sizes).map(of_chain).collect(),
            samples: 0.0,
        }
    }

    pub(super) fn push(&mut self, sample: &Observation) {
        for chain in &mut self.chains {
            let links = &sample.link_tension[chain.links.clone()];
            let spans = sample.span_tension.get(chain.spans.clone());
            let tight = spans.into_iter().flatten().copied().fold(0.0, f64::max);
            let limit = -Summary::PRESSED * tight;
            for &tension in links {
                chain.greatest = chain.greatest.max(tension);
                chain.least = chain.least.min(tension);
                if tight > 0.0 && tension < limit {
                    chain.pressed += 1.0;
                }
            }
        }
        self.samples += 1.0;
    }

    /// Duty of each chain; `spans` and `sprockets` are those of all chains.
    pub(super) fn loads(
        &self,
        spans: &[SpanStatistics],
        sprockets: &[SprocketStatistics],
    ) -> Vec<Load> {
        let chains = self.chains.iter();
        chains
            .map(|chain| self.load(chain, spans, sprockets))
            .collect()
    }

    fn load(
        &self,
        chain: &DutySums,
        spans: &[SpanStatistics],
        sprockets: &[SprocketStatistics],
    ) -> Load {
        let sprockets: Vec<SprocketDuty> = chain
            .sprockets
            .iter()
            .map(|index| sprockets[*index].duty())
            .collect();
        let spans = spans.get(chain.spans.clone()).into_iter().flatten();
        let means = spans.map(SpanStatistics::mean).filter(|it| it.is_finite());
        Load {
            chain: chain.name.clone(),
            strength: chain.strength,
            tension: chain.greatest,
            least: chain.least,
            pressed: chain.pressed / (self.samples * chain.links.len() as f64),
            power: sprockets
                .iter()
                .map(|it| it.power.abs())
                .fold(0.0, f64::max),
            pitch: chain.pitch,
            steady: means.reduce(f64::max),
            sprockets,
        }
    }
}
