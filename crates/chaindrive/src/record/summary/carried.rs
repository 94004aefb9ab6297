//! The duty of chains, as the samples see it: tension, power, speed.

use std::ops::Range;

use chaindrive_geometry::mesh_frequency;
use chaindrive_mechanics::{ChainSize, Observation, PlacedChain, Strength};
use serde::{Deserialize, Serialize};

use super::Summary;
use crate::Simulation;

/// Sums over the samples, by chain and by sprocket.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct Carried {
    chains: Vec<OfChain>,
    sprockets: Vec<OfSprocket>,
    samples: f64,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct OfChain {
    name: String,
    strength: Strength,
    links: Range<usize>,
    spans: Range<usize>,
    sprockets: Vec<usize>,
    /// Greatest and least tension of a link \[N\].
    greatest: f64,
    least: f64,
    /// Links that were pressed, over all samples.
    pressed: f64,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct OfSprocket {
    name: String,
    teeth: u32,
    /// Σ ω \[rad/s\] and Σ M ω \[W\].
    speed: f64,
    power: f64,
}

/// Duty of one chain, beside its strength.
#[derive(Clone, Debug, PartialEq)]
pub struct Load {
    /// Name of the chain; empty where there is one only.
    pub chain: String,
    /// Its strength, as far as that is known.
    pub strength: Strength,
    /// Greatest tension of a link \[N\].
    pub tension: f64,
    /// Least tension of a link \[N\].
    pub least: f64,
    /// Share of links and samples in which a link was pressed by more than [`Summary::PRESSED`](super::Summary::PRESSED) of the greatest span tension
    /// at that time \[–\]; 0 without spans.
    pub pressed: f64,
    /// Mean power that it has carried to or from a sprocket \[W\].
    pub power: f64,
    /// The smallest sprocket that takes a share in it: name, teeth, mean speed \[rad/s\].
    pub smallest: Option<(String, u32, f64)>,
}

impl Load {
    /// Power \[W\] that the chain is rated for at the teeth and the mean speed of its smallest sprocket, see
    /// [`Rating::power`](chaindrive_mechanics::Rating::power); none where no rating is known, or nothing has turned.
    pub fn rated(&self) -> Option<f64> {
        let (_, teeth, speed) = self.smallest.as_ref()?;
        let rated = self.strength.rating?.power(*teeth, *speed);
        (rated > 0.0).then_some(rated)
    }
}

/// Share of the power of a chain that a sprocket takes part with, at least; idlers do not.
const TAKES_PART: f64 = 0.1;

impl Carried {
    pub(super) fn new(simulation: &Simulation) -> Self {
        let drive = &simulation.assembled().drive;
        let sizes = simulation.system().chain_sizes();
        let (mut first, mut first_span) = (0, 0);
        let of_chain = |(placed, (name, size)): (&PlacedChain, (String, ChainSize))| {
            let links = first..first + size.links;
            first = links.end;
            let spans = first_span..first_span + size.spans;
            first_span = spans.end;
            OfChain {
                name,
                strength: placed.chain.strength,
                links,
                spans,
                sprockets: placed.sprockets.clone(),
                greatest: f64::NEG_INFINITY,
                least: f64::INFINITY,
                pressed: 0.0,
            }
        };
        let sprockets = drive.sprockets.iter().map(|sprocket| OfSprocket {
            name: sprocket.name.clone(),
            teeth: sprocket.gap.teeth,
            speed: 0.0,
            power: 0.0,
        });
        Self {
            chains: drive.chains.iter().zip(sizes).map(of_chain).collect(),
            sprockets: sprockets.collect(),
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
        let motions = sample.sprocket_speed.iter().zip(&sample.sprocket_torque);
        for (sprocket, (speed, torque)) in self.sprockets.iter_mut().zip(motions) {
            sprocket.speed += speed;
            sprocket.power += speed * torque;
        }
        self.samples += 1.0;
    }

    pub(super) fn loads(&self) -> Vec<Load> {
        self.chains.iter().map(|chain| self.load(chain)).collect()
    }

    fn load(&self, chain: &OfChain) -> Load {
        let own = || chain.sprockets.iter().map(|index| &self.sprockets[*index]);
        let power = own().map(|it| it.power.abs()).fold(0.0, f64::max);
        let takes_part = own().filter(|it| it.power.abs() > TAKES_PART * power);
        let smallest = takes_part.min_by_key(|it| it.teeth);
        Load {
            chain: chain.name.clone(),
            strength: chain.strength,
            tension: chain.greatest,
            least: chain.least,
            pressed: chain.pressed / (self.samples * chain.links.len() as f64),
            power: power / self.samples,
            smallest: smallest.map(|it| (it.name.clone(), it.teeth, it.speed / self.samples)),
        }
    }

    pub(super) fn mesh_frequency(&self) -> f64 {
        let sprockets = self.sprockets.iter();
        let frequencies = sprockets.map(|it| mesh_frequency(it.teeth, it.speed / self.samples));
        frequencies.fold(0.0, |most, frequency| most.max(frequency.abs()))
    }
}
