//! A drive described before it is simulated: route, statics, model, time scales, cost.
//!
//! Everything is read off the assembled drive or follows from geometry alone; only the cost is
//! measured, by a few hundred steps. Front ends print a [`Description`] as text or as JSON.

mod alignment;
mod cost;
mod forces;
mod free_train;
mod links;
mod oil;
mod polygon;
mod route;
mod stack;
mod text;
mod tolerance;

use std::f64::consts::TAU;

use chaindrive_geometry::mesh_frequency;
use chaindrive_integrate::{Moment, SecondOrderSystem};
use chaindrive_mechanics::{
    Adjust, Assembled, Capacity, Chain, Clash, Drive, Fitting, Flow, GuideSupport, Layout,
    MissingRating, MotionConflict, Observation, PlacedChain, Rotation, Statics,
};
use schemars::JsonSchema;
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

pub use alignment::AlignmentFacts;
pub use cost::{Cost, foretelling, foretold};
pub use forces::ForceFacts;
pub use free_train::FreeTrainFacts;
pub use links::{ContactFacts, LinkFacts, left_out};
pub use oil::OilFacts;
pub use polygon::PolygonPair;
pub use route::{SpanAtRest, StopFacts, spans_at_rest, wraps};
pub use stack::{StackFacts, StackTermFacts};
pub use tolerance::ToleranceFacts;

use crate::chain_verdict::{layout_checks, remarks};
use crate::plausibility::implausible;
use crate::{Run, SimulationError, rating};

/// A drive and a run, described.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Description {
    /// The chains; in JSON `chain` and its `closing` where there is one, as scenes have it.
    #[serde(flatten, serialize_with = "as_in_scenes")]
    #[schemars(with = "AsInScenes")]
    pub chains: Vec<ChainFacts>,
    /// The bodies of the routes, in path order, chain by chain.
    pub stops: Vec<StopFacts>,
    /// The spans of the routes after the last static stage, in path order, chain by chain.
    pub spans: Vec<SpanAtRest>,
    /// Shafts with a name of their own.
    pub shafts: Vec<ShaftFacts>,
    /// Sprockets that are not as drawn.
    pub tolerances: Vec<ToleranceFacts>,
    /// Spans whose sprockets are not in one plane.
    pub out_of_line: Vec<AlignmentFacts>,
    /// Parts behind teeth that yield, where the scene asks for them.
    pub stacks: Vec<StackFacts>,
    /// The oil; absent where the scene describes none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub oil: Option<OilFacts>,
    /// Shafts that torques turn, and no motion.
    pub free_trains: Vec<FreeTrainFacts>,
    /// Forces from outside on centres and carriers.
    pub forces: Vec<ForceFacts>,
    /// The static states on the way to the start.
    pub statics: Vec<StaticStage>,
    /// Moving parts and contacts.
    pub model: Model,
    /// How fast things happen.
    pub time_scales: TimeScales,
    /// Exact polygonal kinematics of neighbouring sprockets on the same side of the chain.
    pub polygon: Vec<PolygonPair>,
    /// Method, steps and run time.
    pub cost: Cost,
    /// Bodies that take the same room in the plane, and must pass side by side; guides that are too short; motions that fight.
    pub warnings: Vec<String>,
    /// Departures of the layout from good practice, each with the limit and its source.
    pub against_practice: Vec<String>,
    /// Implausible inputs, each with the limit and its source.
    pub implausible: Vec<String>,
}

/// A chain in numbers.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct ChainFacts {
    /// Its name; none where there is one chain only.
    pub name: Option<String>,
    /// Number of links.
    pub links: usize,
    /// Nominal pitch \[m\].
    pub pitch: f64,
    /// Least and greatest roller diameter \[m\].
    pub roller_diameters: [f64; 2],
    /// Mass per length \[kg/m\].
    pub mass_per_length: f64,
    /// Its links, joints and rollers.
    pub bodies: LinkFacts,
    /// Axial stiffness of one link \[N/m\], mean; of rigid links that with which they are laid.
    pub link_stiffness: f64,
    /// Axial stiffness k p \[N\]: force over strain.
    pub axial_stiffness: f64,
    /// Speed of longitudinal waves \[m/s\].
    pub longitudinal_wave_speed: f64,
    /// Speed of transverse waves at the least and the greatest static tension of a span \[m/s\].
    pub transverse_wave_speeds: Option<[f64; 2]>,
    /// Power that it is rated for, or why there is none; absent where nothing turns, or the chain has no type.
    pub rated_power: Option<RatedPower>,
    /// How the chain was fitted; absent when it does not run around sprockets.
    pub closing: Option<Closing>,
    /// That it runs against the order of its route, and so against the names of its spans, in a sentence; absent where it does not.
    pub against_route: Option<String>,
}

/// A shaft and all that turns with it.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct ShaftFacts {
    /// Its name.
    pub name: String,
    /// Names of the sprockets on it.
    pub sprockets: Vec<String>,
    /// Moment of inertia with its sprockets \[kg m²\].
    pub inertia: f64,
    /// Speed at the start \[rad/s\].
    pub speed: f64,
    /// Couplings and pairs of gears that join it with others.
    pub joined_by: Vec<String>,
}

/// How the chain was fitted.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Closing {
    /// Strain of the links as laid \[–\].
    pub strain: f64,
    /// Travel of the adjusted body, see `unit`.
    pub travel: f64,
    /// Unit of the travel: m, or rad of an arm.
    pub unit: &'static str,
    /// Name of the sprocket or tensioner that was adjusted, if one was.
    pub adjusted: Option<String>,
    /// Growth of the housing against chain and sprockets since then \[–\]; absent where there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub growth: Option<f64>,
    /// Sag of the slack span; absent where none was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sag: Option<SagFacts>,
}

/// Sag of the slack span of a chain.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct SagFacts {
    /// The span, "from-to".
    pub span: String,
    /// Sag \[m\] that was asked for: all slack hangs there, and the other spans are straight.
    pub asked: f64,
    /// Sag \[m\] where nothing pulls and the spans share the slack.
    pub shared: f64,
}

/// Power that a chain is rated for where the run starts.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct RatedPower {
    /// The smallest sprocket that something drives or loads.
    pub sprocket: String,
    /// Its teeth.
    pub teeth: u32,
    /// Its speed at the start \[rad/s\].
    pub speed: f64,
    /// Its strands.
    pub strands: u32,
    /// By how much the power that is carried counts more \[–\].
    pub service_factor: f64,
    /// The power \[W\], see [`rated_power`](crate::rating::rated_power); absent where no rating is known.
    pub power: Option<f64>,
    /// The limit that governs; absent where no rating is known.
    pub limited_by: Option<&'static str>,
    /// Why there is no rating; absent where there is one.
    pub unrated: Option<String>,
}

/// A number of things: `1 guide`, `2 guides`.
pub fn counted(number: usize, thing: &str) -> String {
    match number {
        1 => format!("1 {thing}"),
        _ => format!("{number} {thing}s"),
    }
}

/// A static state on the way to the start.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct StaticStage {
    /// The load applied last: pretension, gravity or load.
    pub stage: &'static str,
    /// Newton iterations.
    pub iterations: usize,
    /// Largest force out of balance, relative to the largest link tension.
    pub residual: f64,
    /// Mean tension of every span \[N\], in path order.
    pub span_tensions: Vec<f64>,
}

/// Moving parts and contacts.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Model {
    /// Degrees of freedom that move.
    pub degrees_of_freedom: usize,
    /// Rollers.
    pub rollers: usize,
    /// Pairs of a roller and a body near enough to be tested for contact at the start.
    pub candidates: usize,
    /// Sprockets that turn freely, and those whose rotation is given.
    pub free_sprockets: usize,
    /// See `free_sprockets`.
    pub driven_sprockets: usize,
    /// Guides that stand still, and those that move.
    pub fixed_guides: usize,
    /// See `fixed_guides`.
    pub moving_guides: usize,
    /// Tensioners.
    pub tensioners: usize,
    /// Contact laws, each kind of pair once for every law.
    pub contacts: Vec<ContactFacts>,
    /// Kinds of bodies and effects that the drive does not have.
    pub absent: Vec<&'static str>,
}

/// How fast things happen at the start.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct TimeScales {
    /// 1/ω of the stiffest mode \[s\].
    pub stiffest: f64,
    /// The same with the damping left out \[s\].
    pub undamped: f64,
    /// Mean speed of the fastest chain \[m/s\]; where none runs around a sprocket that of the fastest roller at the start.
    pub chain_speed: f64,
    /// Frequency \[Hz\] at which rollers seat on every sprocket.
    pub mesh_frequencies: Vec<(String, f64)>,
}

impl Description {
    /// Assembles the drive, reads it off, and takes a few hundred steps to see what they cost.
    ///
    /// # Errors
    /// As [`Simulation::start`](crate::Simulation::start).
    pub fn of(drive: &Drive, run: &Run) -> Result<Self, SimulationError> {
        run.check()?;
        Self::of_assembled(&drive.assemble()?, run)
    }

    /// The same of a drive that is assembled already: settling takes a while.
    ///
    /// # Errors
    /// As [`Simulation::from_assembled`](crate::Simulation::from_assembled).
    pub fn of_assembled(assembled: &Assembled, run: &Run) -> Result<Self, SimulationError> {
        run.check()?;
        let drive = &assembled.drive;
        let start = at_start(assembled);
        let system = &assembled.system;
        let spans = spans_at_rest(drive, assembled);
        let speed = |x: f64, y: f64| x.hypot(y);
        let speeds = start
            .roller_vx
            .iter()
            .zip(&start.roller_vy)
            .map(|(x, y)| speed(*x, *y));
        let mean_speeds = assembled.mean_speeds();
        // v = z p ω/2π
        let running = drive.chains.iter().filter_map(|placed| {
            let first = *placed.sprockets.first()?;
            let teeth = f64::from(drive.sprockets[first].gap.teeth);
            Some(teeth * placed.chain.pitch * mean_speeds[first].abs() / TAU)
        });
        let fastest = speeds.fold(0.0, f64::max);
        let chain_speed = running.reduce(f64::max).unwrap_or(fastest);
        let meshing = drive.sprockets.iter().zip(&mean_speeds);
        let mesh = meshing.map(|(s, speed)| (s.name.clone(), mesh_frequency(s.gap.teeth, *speed)));
        let chains = drive.chains.iter().zip(&assembled.fittings);
        let mut chains: Vec<ChainFacts> = chains
            .enumerate()
            .map(|(index, (placed, fitting))| {
                let rated_power = rated_power(drive, placed, &start);
                let closing = fitting.as_ref().map(|it| closing(drive, placed, it));
                let closing = closing.map(|it| Closing {
                    sag: route::sag(assembled, index),
                    ..it
                });
                chain_facts(placed, closing, rated_power, &spans)
            })
            .collect();
        for against in drive.against_routes(&assembled.mean_speeds()) {
            chains[against.index].against_route = Some(against.to_string());
        }
        let cost = cost::measure(assembled, run)?;
        Ok(Self {
            chains,
            shafts: shafts(drive, &start),
            tolerances: tolerance::of(drive),
            out_of_line: alignment::of(drive),
            stacks: stack::of(drive),
            oil: oil::of(drive),
            free_trains: free_train::of(assembled),
            forces: forces::of(assembled),
            stops: route::stops(drive, assembled, &start),
            statics: static_stages(drive, assembled),
            model: model(drive, assembled),
            time_scales: TimeScales {
                stiffest: system.time_scale(),
                undamped: system.undamped_time_scale(),
                chain_speed,
                mesh_frequencies: mesh.collect(),
            },
            polygon: polygon::pairs(drive, &start),
            warnings: warnings(assembled, run.until),
            against_practice: remarks(layout_checks(drive, &wraps(drive, assembled))),
            implausible: implausible(drive, Some(cost.whole_time()))
                .iter()
                .map(ToString::to_string)
                .collect(),
            cost,
            spans,
        })
    }
}

/// Objections to an assembled drive before it runs until a time \[s\]: bodies in each other's way, motions that fight, chains that are pulled
/// beyond their breaking load at rest.
pub fn warnings(assembled: &Assembled, until: f64) -> Vec<String> {
    let clashes = assembled.warnings.iter().map(Clash::to_string);
    let fights = assembled.drive.fights(0.0, until);
    let fights = fights.iter().map(MotionConflict::to_string);
    clashes.chain(fights).chain(overloads(assembled)).collect()
}

/// Chains that are pulled beyond their breaking load at rest.
fn overloads(assembled: &Assembled) -> Vec<String> {
    let Some(statics) = assembled.statics.last() else {
        return Vec::new();
    };
    let mut tensions = statics.tensions.iter();
    let chains = assembled.drive.chains.iter().filter_map(|placed| {
        let own = tensions.by_ref().take(placed.chain.links());
        let pull = own.copied().fold(0.0, f64::max);
        let breaking = placed.chain.strength.breaking_load?;
        let named = placed.name.as_ref();
        let chain = named.map_or_else(|| "the chain".to_owned(), |name| format!("chain `{name}`"));
        (pull > breaking).then(|| {
            let [pull, breaking] = [pull, breaking].map(|force| force * 1e-3);
            format!("at rest, {chain} is pulled with {pull:.1} kN, and breaks at {breaking:.1} kN: lower the load, or take a stronger chain")
        })
    });
    chains.collect()
}

impl Description {
    /// Says that a run will choose method and step for this accuracy, if for any, instead of those described.
    #[must_use]
    pub fn unless_chosen_for(mut self, accuracy: Option<f64>) -> Self {
        self.cost.unless_chosen_for = accuracy;
        self
    }
}

/// One `chain`, or several `chains`: the form of [`as_in_scenes`], for the schema.
#[derive(JsonSchema)]
#[expect(dead_code, reason = "only its schema is asked for")]
struct AsInScenes {
    /// The chain, where there is one only.
    #[serde(skip_serializing_if = "Option::is_none")]
    chain: Option<ChainFacts>,
    /// Fit to its route; absent for a chain around no sprockets.
    #[serde(skip_serializing_if = "Option::is_none")]
    closing: Option<Closing>,
    /// The chains, where there are several.
    #[serde(skip_serializing_if = "Option::is_none")]
    chains: Option<Vec<ChainFacts>>,
}

/// One `chain`, or several `chains`.
fn as_in_scenes<S: Serializer>(chains: &[ChainFacts], serializer: S) -> Result<S::Ok, S::Error> {
    let mut map = serializer.serialize_map(None)?;
    if let [only] = chains {
        map.serialize_entry("chain", only)?;
        map.serialize_entry("closing", &only.closing)?;
    } else {
        map.serialize_entry("chains", chains)?;
    }
    map.end()
}

/// The static states on the way to the start of an assembled drive.
pub fn static_stages(drive: &Drive, assembled: &Assembled) -> Vec<StaticStage> {
    let stage = |statics: &Statics| StaticStage {
        stage: statics.stage,
        iterations: statics.iterations,
        residual: statics.residual,
        span_tensions: route::tensions(drive, assembled, &statics.tensions),
    };
    assembled.statics.iter().map(stage).collect()
}

/// Everything that can be read off the assembled drive.
fn at_start(assembled: &Assembled) -> Observation {
    let system = &assembled.system;
    let at = Moment {
        t: 0.0,
        q: &assembled.q,
        v: &assembled.v,
        z: &assembled.z,
    };
    let mut start = Observation::default();
    let flows = [0.0; Flow::ALL.len()];
    system.observe(at, &flows, &mut system.new_record(), &mut start);
    start
}

/// The shafts that have names.
fn shafts(drive: &Drive, start: &Observation) -> Vec<ShaftFacts> {
    let shafts = drive.shafts.iter().enumerate();
    let named = shafts.filter_map(|(index, shaft)| Some((index, shaft, shaft.name.clone()?)));
    named
        .zip(&start.shaft_speed)
        .map(|((index, shaft, name), &speed)| {
            let on_it = || drive.sprockets.iter().filter(|s| s.shaft == index);
            let couplings = drive.couplings.iter().map(|it| (&it.name, it.shafts));
            let gears = drive.gears.iter().map(|it| (&it.name, it.shafts));
            let joins = couplings.chain(gears);
            ShaftFacts {
                name,
                sprockets: on_it().map(|sprocket| sprocket.name.clone()).collect(),
                inertia: shaft.inertia + on_it().map(|sprocket| sprocket.inertia).sum::<f64>(),
                speed,
                joined_by: joins
                    .filter(|(_, ends)| ends.contains(&index))
                    .map(|(name, _)| name.clone())
                    .collect(),
            }
        })
        .collect()
}

fn closing(drive: &Drive, placed: &PlacedChain, fitting: &Fitting) -> Closing {
    let (adjust, growth) = match &placed.layout {
        Layout::Route { fit, .. } => (&fit.adjust, Some(fit.growth)),
        Layout::Points { .. } => (&Adjust::Nothing, None),
    };
    let (adjusted, unit) = match adjust {
        Adjust::Nothing => (None, "m"),
        Adjust::Sprocket { sprocket, .. } => (Some(&drive.sprockets[*sprocket].name), "m"),
        Adjust::Tensioner { tensioner, .. } => {
            let tensioner = &drive.tensioners[*tensioner];
            (Some(&tensioner.name), tensioner.carrier.coordinate_unit())
        }
    };
    Closing {
        strain: fitting.strain,
        travel: fitting.travel,
        unit,
        adjusted: adjusted.cloned(),
        growth: growth.filter(|it| *it != 0.0),
        sag: None,
    }
}

/// The rating at the smallest sprocket that takes part; idlers do not.
fn rated_power(drive: &Drive, placed: &PlacedChain, start: &Observation) -> Option<RatedPower> {
    let strength = &placed.chain.strength;
    if let Capacity::Unknown(MissingRating::NoType) = strength.capacity {
        return None;
    }
    let takes_part = |shaft: usize| {
        let joined = drive.couplings.iter().map(|it| it.shafts);
        let mut joined = joined.chain(drive.gears.iter().map(|it| it.shafts));
        let alone = drive
            .sprockets
            .iter()
            .filter(|it| it.shaft == shaft)
            .count()
            < 2;
        let idle = match &drive.shafts[shaft].rotation {
            Rotation::Prescribed(_) => false,
            Rotation::Free { drive, load, .. } => drive.is_empty() && load.is_empty(),
        };
        !idle || !alone || joined.any(|ends| ends.contains(&shaft))
    };
    let own = placed.sprockets.iter().copied();
    let own = own.filter(|&index| takes_part(drive.sprockets[index].shaft));
    let smallest = own.min_by_key(|&index| drive.sprockets[index].gap.teeth)?;
    let sprocket = &drive.sprockets[smallest];
    let (teeth, speed) = (sprocket.gap.teeth, start.sprocket_speed[smallest]);
    let (limits, unrated) = match rating::power_limits(strength, teeth, speed) {
        Ok(limits) => (limits, None),
        Err(why) => (Vec::new(), Some(why.to_string())),
    };
    let least = rating::least(&limits);
    (speed.abs() > 0.0).then(|| RatedPower {
        sprocket: sprocket.name.clone(),
        teeth,
        speed,
        strands: strength.strands,
        service_factor: strength.service_factor,
        power: least.map(|(_, power)| power),
        limited_by: least.map(|(by, _)| by.name()),
        unrated,
    })
}

fn chain_facts(
    placed: &PlacedChain,
    closing: Option<Closing>,
    rated_power: Option<RatedPower>,
    spans: &[SpanAtRest],
) -> ChainFacts {
    let chain = &placed.chain;
    let links = chain.links() as f64;
    let mass = chain.masses.iter().sum::<f64>() / chain.masses.len() as f64;
    // Springs in series: the harmonic mean.
    let stiffness = links / chain.stiffness.iter().map(|k| 1.0 / k).sum::<f64>();
    let mass_per_length = mass / chain.pitch;
    let tensions = || {
        spans
            .iter()
            .filter(|span| span.chain == placed.name)
            .map(|span| span.tension)
            .filter(|tension| *tension > 0.0)
    };
    let (least, most) = (tensions().reduce(f64::min), tensions().reduce(f64::max));
    ChainFacts {
        name: placed.name.clone(),
        closing,
        against_route: None,
        rated_power,
        links: chain.links(),
        pitch: chain.pitch,
        roller_diameters: roller_diameters(chain),
        mass_per_length,
        bodies: LinkFacts::of(chain),
        link_stiffness: stiffness,
        axial_stiffness: stiffness * chain.pitch,
        // c = p √(k/m)
        longitudinal_wave_speed: chain.pitch * (stiffness / mass).sqrt(),
        // c = √(T/μ)
        transverse_wave_speeds: least
            .zip(most)
            .map(|(a, b)| [a, b].map(|tension| (tension / mass_per_length).sqrt())),
    }
}

/// Least and greatest roller diameter of a chain.
fn roller_diameters(chain: &Chain) -> [f64; 2] {
    let deviations = &chain.roller_deviations;
    let [least, most] = deviations.iter().fold([0.0_f64; 2], |[least, most], it| {
        [least.min(*it), most.max(*it)]
    });
    [least, most].map(|it| chain.roller_diameter + it)
}

fn model(drive: &Drive, assembled: &Assembled) -> Model {
    let fixed = drive
        .guides
        .iter()
        .filter(|guide| guide.support == GuideSupport::Fixed);
    let [free, driven] = assembled.system.turning_sprockets();
    let fixed = fixed.count();
    let bodies = [
        (drive.sprockets.is_empty(), "sprockets"),
        (drive.guides.is_empty(), "guides"),
        (drive.tensioners.is_empty(), "tensioners"),
    ];
    let start = [(!drive.settle, "settling before the start")];
    let lacking = |(lacks, name): (bool, &'static str)| lacks.then_some(name);
    let effects = left_out(drive);
    let absent = bodies.into_iter().filter_map(lacking).chain(effects);
    let absent = absent.chain(start.into_iter().filter_map(lacking));
    Model {
        degrees_of_freedom: assembled.system.free_dofs(),
        rollers: assembled.system.rollers(),
        candidates: assembled.system.candidates(),
        free_sprockets: free,
        driven_sprockets: driven,
        fixed_guides: fixed,
        moving_guides: drive.guides.len() - fixed,
        tensioners: drive.tensioners.len(),
        contacts: links::contacts(drive),
        absent: absent.collect(),
    }
}
