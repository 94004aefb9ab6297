//! Motion of sprockets and tensioners, and what their bearings and the guides bear.

use chaindrive_geometry::mesh_frequency;
use chaindrive_mechanics::{Drive, DriveExtremes, Extremes};
use serde::{Deserialize, Serialize};

use super::ConfidenceInterval;
use super::account::{Account, place_of};
use crate::rating::SprocketDuty;

/// A force over the run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForceRecord {
    /// Mean over whole periods, x and y \[N\].
    pub mean: [f64; 2],
    /// Extremes of its magnitude over all steps \[N\].
    pub extremes: Extremes,
    /// Median of the greatest magnitude of every period of the slowest forcing \[N\]; none without a whole period.
    pub usual_greatest: Option<ConfidenceInterval>,
}

impl ForceRecord {
    /// Magnitude \[N\] and direction \[rad\] of the mean force, counter-clockwise from the x axis.
    pub fn mean_polar(&self) -> [f64; 2] {
        let [x, y] = self.mean;
        [x.hypot(y), y.atan2(x)]
    }
}

/// A sprocket over the run. Means are integrals over steps, of whole periods of the slowest forcing where there is one.
#[derive(Clone, Debug, PartialEq)]
pub struct SprocketStatistics {
    /// Its name.
    pub name: String,
    /// Its chain, by index.
    pub chain: usize,
    /// Its teeth.
    pub teeth: u32,
    /// Mean speed \[rad/s\]: angle over time.
    pub speed: f64,
    /// Mean torque of the chain \[N m\]: impulse over time.
    pub torque: f64,
    /// Mean power that the chain gives it \[W\]: work over time.
    pub power: f64,
    /// Mean power of forces from outside on its centre \[W\]: work over time.
    pub forced: f64,
    /// Force of the chain, which its bearings bear.
    pub force: ForceRecord,
    /// Extremes of the force of one roller on its teeth \[N\].
    pub contact: Extremes,
    /// Extremes of its speed \[rad/s\].
    pub speeds: Extremes,
    /// Extremes of its angle beyond that of an exact ratio to the sprocket that leads its chain \[rad\]: the transmission error.
    pub lag: Extremes,
    leader: usize,
}

impl SprocketStatistics {
    /// Greatest less least speed over the mean \[–\]; none of what stands, or swings to and fro: that has no mean speed to speak of.
    ///
    /// ```text
    /// δ = (ω_max − ω_min)/ω̄
    /// ```
    pub fn irregularity(&self) -> Option<f64> {
        let swings = self.speeds.least < 0.0 && self.speeds.greatest > 0.0;
        let irregularity = self.speeds.range() / self.speed.abs();
        (irregularity.is_finite() && !swings).then_some(irregularity)
    }

    /// Means, as the rating of its chain asks for them.
    pub(super) fn duty(&self) -> SprocketDuty {
        SprocketDuty {
            name: self.name.clone(),
            teeth: self.teeth,
            speed: self.speed,
            power: self.power,
            force: self.force.mean,
        }
    }

    /// Index of the sprocket that its speed ratio and transmission error are measured from.
    pub fn leader(&self) -> usize {
        self.leader
    }
}

/// A tensioner over the run.
#[derive(Clone, Debug, PartialEq)]
pub struct TensionerStatistics {
    /// Its name.
    pub name: String,
    /// Unit of its coordinate, m or rad.
    pub unit: String,
    /// Mean of its coordinate.
    pub mean: f64,
    /// Extremes of its coordinate.
    pub travel: Extremes,
    /// Mean push \[N, or N m of an arm without a plunger\].
    pub push: f64,
    /// Mean power of forces from outside on it, beside those on the centres that it carries \[W\].
    pub forced: f64,
}

/// Loads of the bodies that chains touch.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bodies {
    /// Sprockets.
    pub sprockets: Vec<SprocketStatistics>,
    /// Guides: name, and force of the chain.
    pub guides: Vec<(String, ForceRecord)>,
    /// Tensioners.
    pub tensioners: Vec<TensionerStatistics>,
}

/// What does not change of the bodies in a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct BodyNames {
    sprockets: Vec<SprocketNames>,
    guides: Vec<String>,
    /// Name and unit of the coordinate.
    tensioners: Vec<(String, String)>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct SprocketNames {
    name: String,
    chain: usize,
    teeth: u32,
    shaft: usize,
    leader: usize,
}

impl BodyNames {
    pub(super) fn new(drive: &Drive) -> Self {
        let sprocket = |(index, it): (usize, &chaindrive_mechanics::Sprocket)| {
            let mut chains = drive.chains.iter();
            let chain = chains.position(|placed| placed.sprockets.contains(&index));
            SprocketNames {
                name: it.name.clone(),
                chain: chain.unwrap_or(0),
                teeth: it.gap.teeth,
                shaft: it.shaft,
                leader: drive.leader(index).0,
            }
        };
        let unit = |it: &chaindrive_mechanics::Tensioner| it.carrier.coordinate_unit().to_owned();
        Self {
            sprockets: drive.sprockets.iter().enumerate().map(sprocket).collect(),
            guides: drive.guides.iter().map(|it| it.name.clone()).collect(),
            tensioners: drive
                .tensioners
                .iter()
                .map(|it| (it.name.clone(), unit(it)))
                .collect(),
        }
    }

    /// Statistics of the bodies, by the account of the run; none before there is one.
    pub(super) fn bodies(&self, account: &Account) -> Bodies {
        let (Some(means), Some(extremes)) = (account.of_means(), account.extremes()) else {
            return Bodies::default();
        };
        let time = means.length();
        let accounts = &means.accounts;
        let record = |mean: [f64; 2], of: fn(&DriveExtremes, usize) -> &Extremes, index: usize| {
            let seen = of(&extremes, index);
            let place = place_of(&extremes, seen);
            ForceRecord {
                mean,
                extremes: *seen,
                usual_greatest: place.and_then(|place| account.usual_greatest(place)),
            }
        };
        let sprocket = |(index, it): (usize, &SprocketNames)| {
            let own = &accounts.sprockets[index];
            let seen = &extremes.sprockets[index];
            SprocketStatistics {
                name: it.name.clone(),
                chain: it.chain,
                teeth: it.teeth,
                speed: accounts.shafts[it.shaft].angle / time,
                torque: own.torque / time,
                power: own.work / time,
                forced: own.forced / time,
                force: record(
                    own.force.map(|impulse| impulse / time),
                    |all, index| &all.sprockets[index].force,
                    index,
                ),
                contact: seen.contact,
                speeds: seen.speed,
                lag: seen.lag,
                leader: it.leader,
            }
        };
        let guide = |(index, name): (usize, &String)| {
            let mean = accounts.guides[index].force.map(|impulse| impulse / time);
            let record = record(mean, |all, index| &all.guides[index], index);
            (name.clone(), record)
        };
        let tensioner = |(index, (name, unit)): (usize, &(String, String))| {
            let own = &accounts.tensioners[index];
            TensionerStatistics {
                name: name.clone(),
                unit: unit.clone(),
                mean: own.course / time,
                travel: extremes.tensioners[index],
                push: own.push / time,
                forced: own.forced / time,
            }
        };
        Bodies {
            sprockets: self.sprockets.iter().enumerate().map(sprocket).collect(),
            guides: self.guides.iter().enumerate().map(guide).collect(),
            tensioners: self.tensioners.iter().enumerate().map(tensioner).collect(),
        }
    }
}

impl Bodies {
    /// Greatest frequency at which rollers seat on a sprocket, in the mean \[Hz\].
    pub(super) fn mesh_frequency(&self) -> f64 {
        let sprockets = self.sprockets.iter();
        let frequencies = sprockets.map(|it| mesh_frequency(it.teeth, it.speed).abs());
        frequencies.fold(0.0, f64::max)
    }
}
