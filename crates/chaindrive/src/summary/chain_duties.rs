//! The duty of chains: tension, power, speed.

use std::ops::Range;

use chaindrive_mechanics::{ChainSize, Extremes, PlacedChain, Strength};
use serde::{Deserialize, Serialize};

use super::{SpanStatistics, SprocketStatistics};
use crate::Simulation;
use crate::rating::{Load, SprocketDuty, WearLimit};

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
    /// Sprockets at the ends of every span.
    ends: Vec<[usize; 2]>,
    wear_limit: Option<WearLimit>,
    /// Links that were pressed, over all readings.
    pressed: f64,
}

impl ChainDuties {
    pub(super) fn new(simulation: &Simulation) -> Self {
        let drive = &simulation.assembled().drive;
        let sizes = simulation.system().chain_sizes();
        let ends = simulation.system().span_sprockets();
        let mut first_span = 0;
        let of_chain = |(placed, (name, size)): (&PlacedChain, (String, ChainSize))| {
            let spans = first_span..first_span + size.spans;
            first_span = spans.end;
            DutySums {
                name,
                strength: placed.chain.strength,
                pitch: placed.chain.pitch,
                links: size.links,
                ends: ends.get(spans.clone()).unwrap_or_default().to_vec(),
                spans,
                wear_limit: WearLimit::of(placed, drive),
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
        let sliding = chain.sliding(spans, sprockets);
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
            sliding,
            wear_limit: chain.wear_limit,
            sprockets,
        }
    }
}

impl DutySums {
    /// Load times sliding of a joint a second, in the mean, see [`Load::sliding`]; `spans` and `sprockets` are those of all chains.
    fn sliding(&self, spans: &[SpanStatistics], sprockets: &[SprocketStatistics]) -> Option<f64> {
        let radius = self.strength.pin_radius?;
        let spans = spans.get(self.spans.clone())?.iter().zip(&self.ends);
        let speed = |end: &usize| Some(sprockets.get(*end)?.speed.abs());
        let mut sum = 0.0;
        for (span, ends) in spans {
            // A span that no roller holds pulls at no joint.
            let tension = Some(span.mean()).filter(|it| *it > 0.0).unwrap_or(0.0);
            for end in ends {
                sum += tension * speed(end)?;
            }
        }
        // Q = r Σ T ω/X
        Some(radius * sum / self.links as f64)
    }
}
