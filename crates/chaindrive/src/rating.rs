//! Capacity of a chain beside its duty in a run: rated power, safety factors, bearing pressure, shaft loads.
//!
//! Nothing of this moves the drive. Power is rated where a formula could be read in a public source, that for the chains of ASME B29.1
//! (see [`PowerLimits`](chaindrive_mechanics::PowerLimits)), or where the scene gives what the maker says; else a [`Rating`] tells why not.
//! ISO 10823 and DIN 8195, which rate chains of the B series, could not be read, nor the limit by galling of any chain.

mod load;
mod lubrication;
mod strands;
mod wear;

use chaindrive_mechanics::{Capacity, MissingRating, Strength};

pub use load::{Load, SprocketDuty};
pub use lubrication::{Lubrication, LubricationSpeeds};
pub use strands::strand_factor;
pub use wear::{BAND, COEFFICIENT, WearBound, WearLimit, told_hours};

/// Capacity of a chain beside its duty in a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Rating {
    /// Name of the chain; empty where there is one only.
    pub chain: String,
    /// The sprocket at which it is rated; none where nothing carries power.
    pub sprocket: Option<RatedSprocket>,
    /// Mean power that it has carried \[W\].
    pub carried: f64,
    /// Service factor of the scene \[–\], by which the carried power counts more.
    pub service_factor: f64,
    /// Strands of the chain.
    pub strands: u32,
    /// Power of all strands over that of a single one \[–\], see [`strand_factor`].
    pub strand_factor: f64,
    /// Limits of its power, or why there are none.
    pub limits: Result<Vec<PowerLimit>, MissingRating>,
    /// Power that the chain of ASME B29.1 with its pitch and strands is rated for \[W\], where there is no rating of its own.
    pub twin: Option<f64>,
    /// Its speed \[m/s\], at the sprocket at which it is rated.
    pub chain_speed: f64,
    /// How it is to be oiled, where it moves.
    pub lubrication: Option<Lubrication>,
    /// Chain speeds up to which a class of lubrication does, for its pitch.
    pub lubrication_speeds: Option<LubricationSpeeds>,
    /// Maximum link tension over all steps \[N\].
    pub greatest_tension: Option<f64>,
    /// Greatest mean tension of a span \[N\]: the pull of the tight side.
    pub tight_pull: Option<f64>,
    /// Static safety factor: breaking load over the maximum link tension \[–\]. Seven is usual in the selection of chains (*assumed*).
    pub static_safety: Option<f64>,
    /// Dynamic safety factor: breaking load over the greatest mean tension of a span, which recurs once a circuit \[–\]. From eight on the plates do not tire
    /// (Renold, *Transmission Chain Designer Guide*).
    pub dynamic_safety: Option<f64>,
    /// Bearing pressure of pins on bushes under the greatest mean tension of a span \[Pa\], all strands sharing it.
    pub bearing_pressure: Option<f64>,
    /// Elongation at which it is worn out; none where it passes no sprocket.
    pub wear_limit: Option<WearLimit>,
    /// Hours until a new chain is worn out, by a wear coefficient from [`COEFFICIENT`] / [`BAND`] to [`COEFFICIENT`] · [`BAND`].
    pub life: Option<[f64; 2]>,
    /// What the chain does to each shaft, sprocket by sprocket.
    pub shaft_loads: Vec<ShaftLoad>,
}

/// The sprocket at which a chain is rated: that with the fewest teeth of those that take a tenth of the power.
///
/// All of them see the same chain speed, and both limits grow with the teeth: no other sprocket allows less.
#[derive(Clone, Debug, PartialEq)]
pub struct RatedSprocket {
    /// Its name.
    pub name: String,
    /// Its teeth.
    pub teeth: u32,
    /// Its mean speed \[rad/s\].
    pub speed: f64,
}

/// What limits the power of a chain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LimitedBy {
    /// Fatigue of the plates.
    Plates,
    /// Impacts of rollers and bushes.
    Rollers,
    /// Galling of pins in bushes.
    Galling,
    /// What its maker says.
    Maker,
}

impl LimitedBy {
    /// Name in results.
    pub fn name(self) -> &'static str {
        match self {
            Self::Plates => "plates",
            Self::Rollers => "rollers",
            Self::Galling => "galling",
            Self::Maker => "maker",
        }
    }
}

/// One limit of the power of a chain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PowerLimit {
    /// What sets it.
    pub by: LimitedBy,
    /// The power \[W\], all strands together; none where its source is missing.
    pub power: Option<f64>,
}

/// Mean force of a chain on a sprocket, which its shaft bears.
#[derive(Clone, Debug, PartialEq)]
pub struct ShaftLoad {
    /// Name of the sprocket.
    pub sprocket: String,
    /// Magnitude \[N\].
    pub force: f64,
    /// Direction \[rad\], from the x axis towards the y axis, in (−π, π].
    pub angle: f64,
}

/// The limits of the power of a chain at a number of teeth and a speed \[rad/s\] of its smallest sprocket.
///
/// ```text
/// P_i = k P_i,1    k: factor of the strands, P_i,1: limit of a single one
/// ```
///
/// What a maker says holds for his own number of teeth and speed, and for all strands.
///
/// # Errors
/// Says why there is no rating.
pub fn power_limits(
    strength: &Strength,
    teeth: u32,
    speed: f64,
) -> Result<Vec<PowerLimit>, MissingRating> {
    let limit = |by, power| PowerLimit { by, power };
    let factor = strand_factor(strength.strands);
    match strength.capacity {
        Capacity::American(single) => Ok(vec![
            limit(
                LimitedBy::Plates,
                Some(factor * single.of_plates(teeth, speed)),
            ),
            limit(
                LimitedBy::Rollers,
                Some(factor * single.of_rollers(teeth, speed)),
            ),
            limit(LimitedBy::Galling, None),
        ]),
        Capacity::Given(power) => Ok(vec![limit(LimitedBy::Maker, Some(power))]),
        Capacity::Unknown(why) => Err(why),
    }
}

/// The power \[W\] that a chain is rated for, see [`power_limits`]: the least of its limits; zero at rest.
///
/// # Errors
/// Says why there is no rating.
pub fn rated_power(strength: &Strength, teeth: u32, speed: f64) -> Result<f64, MissingRating> {
    let limits = power_limits(strength, teeth, speed)?;
    Ok(least(&limits).map_or(0.0, |(_, power)| power))
}

/// The least of the limits that are known.
pub(crate) fn least(limits: &[PowerLimit]) -> Option<(LimitedBy, f64)> {
    let known = limits.iter().filter_map(|it| Some((it.by, it.power?)));
    known.min_by(|a, b| a.1.total_cmp(&b.1))
}

impl Rating {
    /// The rating of a chain under its load.
    pub fn of(load: &Load) -> Self {
        let strength = &load.strength;
        let sprocket = load.smallest().map(|it| RatedSprocket {
            name: it.name.clone(),
            teeth: it.teeth,
            speed: it.speed,
        });
        let (teeth, speed) = sprocket
            .as_ref()
            .map_or((0, 0.0), |it| (it.teeth, it.speed));
        let strand_factor = strand_factor(strength.strands);
        let twin = match strength.capacity {
            Capacity::Unknown(MissingRating::SourceMissing { twin }) => twin,
            _ => None,
        };
        // v = z p n
        let chain_speed = f64::from(teeth) * load.pitch * speed.abs() / std::f64::consts::TAU;
        let steady = load.steady.filter(|tension| *tension > 0.0);
        let greatest = Some(load.tension.greatest).filter(|tension| *tension > 0.0);
        let over = |tension: f64| strength.breaking_load.map(|breaking| breaking / tension);
        // p = T / (k d b)
        let area = strength.bearing_area;
        let area = area.map(|area| area * f64::from(strength.strands));
        Self {
            chain: load.chain.clone(),
            carried: load.power,
            service_factor: strength.service_factor,
            strands: strength.strands,
            strand_factor,
            limits: power_limits(strength, teeth, speed),
            twin: twin
                .map(|it| strand_factor * it.power(teeth, speed))
                .filter(|power| *power > 0.0),
            chain_speed,
            lubrication_speeds: LubricationSpeeds::of(load.pitch),
            lubrication: (chain_speed > 0.0)
                .then(|| Lubrication::at(load.pitch, chain_speed))
                .flatten(),
            greatest_tension: greatest,
            tight_pull: steady,
            static_safety: greatest.and_then(over),
            dynamic_safety: steady.and_then(over),
            bearing_pressure: steady.zip(area).map(|(tension, area)| tension / area),
            wear_limit: load.wear_limit,
            life: wear::life(strength, load.pitch, load.sliding, load.wear_limit),
            shaft_loads: load.sprockets.iter().map(ShaftLoad::of).collect(),
            sprocket,
        }
    }

    /// The limit that governs, and its power \[W\]; none where there is no rating, or nothing turns.
    pub fn governing(&self) -> Option<(LimitedBy, f64)> {
        self.sprocket.as_ref()?;
        let (by, power) = least(self.limits.as_ref().ok()?)?;
        (power > 0.0).then_some((by, power))
    }

    /// Power \[W\] that it is rated for.
    pub fn power(&self) -> Option<f64> {
        self.governing().map(|(_, power)| power)
    }

    /// Power carried times service factor, over the rated one \[–\]; above 1 is too much.
    pub fn utilisation(&self) -> Option<f64> {
        Some(self.service_factor * self.carried / self.power()?)
    }
}

impl ShaftLoad {
    fn of(duty: &SprocketDuty) -> Self {
        let [x, y] = duty.force;
        Self {
            sprocket: duty.name.clone(),
            force: x.hypot(y),
            angle: y.atan2(x),
        }
    }
}

#[cfg(test)]
mod tests;
