//! The duty of chains: tension, power, speed.

use std::ops::Range;

use chaindrive_mechanics::{ChainSize, Extremes, PlacedChain, Strength};
use serde::{Deserialize, Serialize};

use super::{SpanStatistics, SprocketStatistics};
use crate::Simulation;
use crate::rating::{Load, SprocketDuty};

/// Sums over readings, by chain.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct ChainDuties {
    chains: Vec<DutySums>,
    readings: f64,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct DutySums {
    name: String,
    strength: Strength,
    pitch: f64,
    links: usize,
    spans: Range<usize>,
    sprockets: Vec<usize>,
    /// Links that were pressed, over all readings.
    pressed: f64,
}

impl ChainDuties {
    pub(super) fn new(simulation: &Simulation) -> Self {
        let drive = &simulation.assembled().drive;
        let sizes = simulation.system().chain_sizes();
        let mut first_span = 0;
        let of_chain = |(placed, (name, size)): (&PlacedChain, (String, ChainSize))| {
            let spans = first_span..first_span + size.spans;
            first_span = spans.end;
            DutySums {
                name,
                strength: placed.chain.strength,
                pitch: placed.chain.pitch,
                links: size.links,
                spans,
                sprockets: placed.sprockets.clone(),
                pressed: 0.0,
            }
        };
        Self {
            chains: drive.chains.iter().zip(sizes).map(of_chain).collect(),
            readings: 0.0,
        }
    }

    /// Number of chains.
    pub(super) fn chains(&self) -> usize {
        self.chains.len()
    }

    /// Takes in how many links of every chain are pressed.
    pub(super) fn push(&mut self, pressed: &[f64]) {
        for (chain, pressed) in self.chains.iter_mut().zip(pressed) {
            chain.pressed += pressed;
        }
        self.readings += 1.0;
    }

    /// Duty of each chain; `spans`, `sprockets` and `tensions` of links are those of all chains.
    pub(super) fn loads(
        &self,
        spans: &[SpanStatistics],
        sprockets: &[SprocketStatistics],
        tensions: &[Extremes],
    ) -> Vec<Load> {
        let chains = self.chains.iter().enumerate();
        chains
            .map(|(index, chain)| {
                let tension = tensions.get(index).copied().unwrap_or_default();
                self.load(chain, spans, sprockets, tension)
            })
            .collect()
    }

    fn load(
        &self,
        chain: &DutySums,
        spans: &[SpanStatistics],
        sprockets: &[SprocketStatistics],
        tension: Extremes,
    ) -> Load {
        let duty = |index: &usize| sprockets.get(*index).map(SprocketStatistics::duty);
        let sprockets: Vec<SprocketDuty> = chain.sprockets.iter().filter_map(duty).collect();
        let spans = spans.get(chain.spans.clone()).into_iter().flatten();
        let means = spans.map(SpanStatistics::mean).filter(|it| it.is_finite());
        Load {
            chain: chain.name.clone(),
            strength: chain.strength,
            tension,
            pressed: chain.pressed / (self.readings * chain.links as f64),
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
