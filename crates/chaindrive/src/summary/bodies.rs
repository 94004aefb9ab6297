//! Motion of sprockets and tensioners, and what their bearings and the guides bear.

use chaindrive_geometry::mesh_frequency;
use chaindrive_mechanics::{Drive, Layout, Observation, Rotation, Stop};
use serde::{Deserialize, Serialize};

use crate::rating::SprocketDuty;

/// A quantity over the samples.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SampleStatistics {
    sum: f64,
    count: u64,
    /// Least sample.
    pub least: f64,
    /// Greatest sample.
    pub greatest: f64,
}

impl Default for SampleStatistics {
    fn default() -> Self {
        Self {
            sum: 0.0,
            count: 0,
            least: f64::INFINITY,
            greatest: f64::NEG_INFINITY,
        }
    }
}

impl SampleStatistics {
    fn push(&mut self, value: f64) {
        self.sum += value;
        self.count += 1;
        self.least = self.least.min(value);
        self.greatest = self.greatest.max(value);
    }

    /// Mean of the samples; NaN without one.
    pub fn mean(&self) -> f64 {
        self.sum / self.count as f64
    }

    /// Greatest less least sample.
    pub fn range(&self) -> f64 {
        self.greatest - self.least
    }
}

/// Force on a body.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BearingForce {
    x: SampleStatistics,
    y: SampleStatistics,
    /// Magnitude \[N\].
    pub magnitude: SampleStatistics,
}

impl BearingForce {
    fn push(&mut self, x: f64, y: f64) {
        self.x.push(x);
        self.y.push(y);
        self.magnitude.push(x.hypot(y));
    }

    /// Magnitude \[N\] and direction \[rad\] of the mean force, counter-clockwise from the x axis.
    pub fn mean(&self) -> [f64; 2] {
        let (x, y) = (self.x.mean(), self.y.mean());
        [x.hypot(y), y.atan2(x)]
    }
}

/// A sprocket over the samples.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SprocketStatistics {
    /// Its name.
    pub name: String,
    /// Its chain, by index.
    pub chain: usize,
    /// Its teeth.
    pub teeth: u32,
    /// Speed \[rad/s\].
    pub speed: SampleStatistics,
    /// Torque of the chain \[N m\].
    pub torque: SampleStatistics,
    /// Power that the chain gives it \[W\].
    pub power: SampleStatistics,
    /// Force of the chain, which its bearings bear.
    pub force: BearingForce,
    /// Angle beyond that of an exact ratio to the sprocket that leads its chain \[rad\]: the transmission error.
    pub lag: SampleStatistics,
    /// The sprocket that leads, by index, and the exact ratio to it.
    leader: (usize, f64),
}

impl SprocketStatistics {
    /// Means over the samples, as the rating of its chain asks for them.
    pub(super) fn duty(&self) -> SprocketDuty {
        SprocketDuty {
            name: self.name.clone(),
            teeth: self.teeth,
            speed: self.speed.mean(),
            power: self.power.mean(),
            force: [self.force.x.mean(), self.force.y.mean()],
        }
    }

    /// Index of the sprocket that its speed ratio and transmission error are measured from.
    pub fn leader(&self) -> usize {
        self.leader.0
    }
}

/// Loads of the bodies that chains touch, over the samples.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Bodies {
    /// Sprockets.
    pub sprockets: Vec<SprocketStatistics>,
    /// Guides: name, and force of the chain.
    pub guides: Vec<(String, BearingForce)>,
    /// Tensioners: name, unit of the coordinate (m or rad), coordinate, and push \[N, or N m of an arm without a plunger\].
    pub tensioners: Vec<(String, String, [SampleStatistics; 2])>,
}

impl Bodies {
    /// Greatest frequency at which rollers seat on a sprocket, in the mean \[Hz\].
    pub(super) fn mesh_frequency(&self) -> f64 {
        let sprockets = self.sprockets.iter();
        let frequencies = sprockets.map(|it| mesh_frequency(it.teeth, it.speed.mean()).abs());
        frequencies.fold(0.0, f64::max)
    }

    pub(super) fn new(drive: &Drive) -> Self {
        let sprockets = drive.sprockets.iter().enumerate();
        let guides = drive.guides.iter().map(|it| it.name.clone());
        let tensioners = drive.tensioners.iter().map(|it| {
            let unit = it.carrier.coordinate_unit();
            (
                it.name.clone(),
                unit.to_owned(),
                [SampleStatistics::default(); 2],
            )
        });
        let sprocket = |(index, it): (usize, &chaindrive_mechanics::Sprocket)| {
            let mut chains = drive.chains.iter();
            let chain = chains.position(|placed| placed.sprockets.contains(&index));
            SprocketStatistics {
                name: it.name.clone(),
                chain: chain.unwrap_or(0),
                teeth: it.gap.teeth,
                speed: SampleStatistics::default(),
                torque: SampleStatistics::default(),
                power: SampleStatistics::default(),
                force: BearingForce::default(),
                lag: SampleStatistics::default(),
                leader: leader(drive, index),
            }
        };
        Self {
            sprockets: sprockets.map(sprocket).collect(),
            guides: guides.map(|name| (name, BearingForce::default())).collect(),
            tensioners: tensioners.collect(),
        }
    }

    pub(super) fn push(&mut self, sample: &Observation) {
        let angles = &sample.sprocket_angle;
        for (index, it) in self.sprockets.iter_mut().enumerate() {
            let (speed, torque) = (sample.sprocket_speed[index], sample.sprocket_torque[index]);
            it.speed.push(speed);
            it.torque.push(torque);
            it.power.push(torque * speed);
            let (x, y) = (
                sample.sprocket_force_x[index],
                sample.sprocket_force_y[index],
            );
            it.force.push(x, y);
            let (leader, ratio) = it.leader;
            // ε = θ − i θ₀
            it.lag.push(angles[index] - ratio * angles[leader]);
        }
        let forces = sample.guide_force_x.iter().zip(&sample.guide_force_y);
        for ((_, force), (x, y)) in self.guides.iter_mut().zip(forces) {
            force.push(*x, *y);
        }
        let pushes = sample
            .tensioner_position
            .iter()
            .zip(&sample.tensioner_force);
        for ((.., [travel, push]), (place, force)) in self.tensioners.iter_mut().zip(pushes) {
            travel.push(*place);
            push.push(*force);
        }
    }
}

/// The sprocket that leads a chain, as seen from one of its route, and the exact ratio to it: the first whose motion is given, or else the first of all.
/// A sprocket that no route passes leads itself.
fn leader(drive: &Drive, index: usize) -> (usize, f64) {
    let routes = drive
        .chains
        .iter()
        .filter_map(|placed| match &placed.layout {
            Layout::Route { stops, .. } => Some(stops.iter().filter_map(|stop| match stop {
                Stop::Sprocket(index) => Some(*index),
                Stop::Guide(_) => None,
            })),
            Layout::Points { .. } => None,
        });
    let mut routes = routes.map(Iterator::collect::<Vec<_>>);
    let Some(route) = routes.find(|route| route.contains(&index)) else {
        return (index, 1.0);
    };
    let is_given = |it: &&usize| {
        let shaft = &drive.shafts[drive.sprockets[**it].shaft];
        matches!(shaft.rotation, Rotation::Prescribed(_))
    };
    let first = *route.iter().find(is_given).unwrap_or(&route[0]);
    // i = ± z₀/z
    let signed = |it: usize| {
        let sprocket = &drive.sprockets[it];
        f64::from(sprocket.gap.teeth) * sprocket.side.sense()
    };
    (first, signed(first) / signed(index))
}
