//! A drive: everything that stays constant during a run, valid by construction.

use chaindrive_contact::Lubricant;
use chaindrive_geometry::{ArcSpline, Point, Side, ToothGap, Vector};
use serde::{Deserialize, Serialize};

use crate::{
    Chain, Coupling, Flank, Forces, Input, Motion, ShaftLoss, Surface, Tensioner, Tolerance,
    ToothStack, Torque,
};

/// A toothed wheel.
#[derive(Clone, Debug)]
pub struct Sprocket {
    /// Name, unique in the drive.
    pub name: String,
    /// Tooth gap: number of teeth, pitch circle and profile.
    pub gap: ToothGap,
    /// Side of the travelling chain on which the wheel lies.
    pub side: Side,
    /// Centre in the assembled position \[m\].
    pub centre: Point,
    /// Index of the shaft that it sits on.
    pub shaft: usize,
    /// Support of its centre.
    pub support: Support,
    /// Forces on its centre from outside.
    pub forces: Forces,
    /// Moment of inertia about the centre \[kg m²\], beside that of its shaft; not negative.
    pub inertia: f64,
    /// Mass \[kg\]; positive when the centre is free to move.
    pub mass: f64,
    /// Contact with the rollers.
    pub surface: Surface,
    /// Parts that the spring behind that contact stands for, where a scene asks for them; nothing reads them in motion.
    pub stack: Option<ToothStack>,
    /// Differences on the flanks, if there are any.
    pub flank: Option<Flank>,
    /// Angle of one gap axis at assembly \[rad\] for wheels that no route passes over; along a
    /// route the closing of the chain decides.
    pub gap_angle: f64,
    /// Deviations from its drawing.
    pub tolerance: Tolerance,
    /// Place of the middle of its teeth along its shaft \[m\]: where that of two sprockets differs, the chain runs out of line.
    pub lateral: f64,
    /// Losses of the shaft at the sprocket; the bearings there carry what the chain pulls with, and the weight of the sprocket.
    pub loss: ShaftLoss,
}

/// A body that turns: it carries sprockets of any chains, rigidly, or none.
#[derive(Clone, Debug, PartialEq)]
pub struct Shaft {
    /// Name, unique among the shafts; none for the shaft of a single sprocket, which is called like that.
    pub name: Option<String>,
    /// Its drive: a motion, or torques.
    pub rotation: Rotation,
    /// Moment of inertia \[kg m²\] beside those of its sprockets, not negative.
    pub inertia: f64,
    /// Losses beside those at its sprockets; its bearing has a stated torque, since nothing says what it carries.
    pub loss: ShaftLoss,
}

impl Shaft {
    /// The shaft of a single sprocket.
    pub fn of_one(rotation: Rotation) -> Self {
        Self {
            name: None,
            rotation,
            inertia: 0.0,
            loss: ShaftLoss::default(),
        }
    }

    /// Whether torques drive or load it.
    pub fn is_turned(&self) -> bool {
        self.torques().next().is_some()
    }

    /// All torques on it.
    pub fn torques(&self) -> impl Iterator<Item = &Torque> {
        let [drive, load]: [&[Torque]; 2] = match &self.rotation {
            Rotation::Prescribed(_) => [&[], &[]],
            Rotation::Free { drive, load, .. } => [drive, load],
        };
        drive.iter().chain(load)
    }

    /// All torques on it, to change them.
    pub(crate) fn torques_mut(&mut self) -> impl Iterator<Item = &mut Torque> {
        let [drive, load]: [&mut [Torque]; 2] = match &mut self.rotation {
            Rotation::Prescribed(_) => [&mut [], &mut []],
            Rotation::Free { drive, load, .. } => [drive, load],
        };
        drive.iter_mut().chain(load)
    }
}

/// Drive of a shaft: a motion, or torques.
#[derive(Clone, Debug, PartialEq)]
pub enum Rotation {
    /// The angle is given in time \[rad\].
    Prescribed(Motion),
    /// The angle follows from inertia, chains, couplings, gears and torques.
    Free {
        /// Torques that drive the shaft.
        drive: Vec<Torque>,
        /// Torques that load the shaft.
        load: Vec<Torque>,
        /// Its speed where the simulation begins.
        start: StartSpeed,
    },
}

/// Speed of a free shaft where the simulation begins.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum StartSpeed {
    /// That of what chains, gears and couplings join it with; rest where nothing there turns.
    #[default]
    Joined,
    /// A speed \[rad/s\], counter-clockwise positive.
    Given(f64),
    /// The speed at which the torques on all that it is joined with add up to nothing: that of a motor under its load.
    WorkingPoint,
}

/// Support of the centre of a sprocket.
#[derive(Clone, Debug, PartialEq)]
pub enum Support {
    /// A fixed bearing.
    Fixed,
    /// A centre moved in time by (x, y) \[m\]: the active tensioner.
    Prescribed {
        /// Displacement along x.
        x: Motion,
        /// Displacement along y.
        y: Motion,
    },
    /// Bearing springs and dampers along x and y, unstressed at the assembled centre.
    Springs {
        /// Stiffness (x, y) \[N/m\], not negative.
        stiffness: [f64; 2],
        /// Damping (x, y) \[N s/m\], not negative.
        damping: [f64; 2],
    },
    /// Carried by a tensioner.
    Tensioner(usize),
}

/// A rail on which the chain slides.
#[derive(Clone, Debug)]
pub struct Guide {
    /// Name, unique in the drive.
    pub name: String,
    /// Working face in the assembled position; material on the left of travel.
    pub face: ArcSpline,
    /// Its support.
    pub support: GuideSupport,
    /// Which part of the chain touches it.
    pub touches: Touches,
    /// Contact with the chain.
    pub surface: Surface,
}

/// Support of a guide.
#[derive(Clone, Debug, PartialEq)]
pub enum GuideSupport {
    /// Bolted to the frame.
    Fixed,
    /// Moved in time by (x, y) \[m\].
    Prescribed {
        /// Displacement along x.
        x: Motion,
        /// Displacement along y.
        y: Motion,
    },
    /// Carried by a tensioner.
    Tensioner(usize),
}

/// Which part of the chain touches a guide.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema,
)]
#[serde(rename_all = "kebab-case")]
pub enum Touches {
    /// The rollers, as circles of the roller diameter.
    #[default]
    Rollers,
    /// Waisted link plates, with their eyes: circles of the plate height about the pins.
    Eyes,
    /// Straight-edged link plates, anywhere along the edge.
    Plates,
}

impl Touches {
    /// Its name, in one word.
    pub fn name(self) -> &'static str {
        match self {
            Self::Rollers => "rollers",
            Self::Eyes => "eyes",
            Self::Plates => "plates",
        }
    }
}

/// One body that a closed chain wraps, in path order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Stop {
    /// A sprocket.
    Sprocket(usize),
    /// A guide whose longest convex arc the chain follows.
    Guide(usize),
}

/// Layout of the chain at the start of the run.
#[derive(Clone, Debug, PartialEq)]
pub enum Layout {
    /// Taut around sprockets and curved guides.
    Route {
        /// The bodies in path order.
        stops: Vec<Stop>,
        /// Where the first wheel stands within its half-tooth window, 0 to 1; 0.5 is symmetric.
        phase: f64,
        /// How the spans set off.
        start: SpanStart,
        /// How the loop is fitted and tightened.
        fit: Fit,
    },
    /// Rollers at given places with given velocities.
    Points {
        /// Positions \[m\], (rollers,).
        positions: Vec<Point>,
        /// Velocities \[m/s\], (rollers,).
        velocities: Vec<Vector>,
    },
}

impl Layout {
    /// How a closed chain is fitted; none of a strand.
    fn fit(&self) -> Option<&Fit> {
        match self {
            Self::Route { fit, .. } => Some(fit),
            Self::Points { .. } => None,
        }
    }

    /// Where it carries its pretension; a strand, where it lies.
    pub(crate) fn pretension_at(&self) -> PretensionAt {
        self.fit().map_or(PretensionAt::Phase, |fit| fit.at)
    }

    /// Growth of the frame after the chain was fitted \[–\].
    pub(crate) fn growth(&self) -> f64 {
        self.fit().map_or(0.0, |fit| fit.growth)
    }

    /// Tension that the chain is laid with \[N\].
    pub(crate) fn pretension(&self) -> f64 {
        self.fit().map_or(0.0, |fit| fit.pretension)
    }
}

/// How the chain moves between the sprockets when the run begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SpanStart {
    /// Along itself: the polygon effect reaches the spans with the first teeth.
    Quiet,
    /// With the motion across that the polygons have at the first instant, linear between the seated rollers at both ends: a kick
    /// after which spans swing.
    Polygon,
}

/// Fit of a closed chain to its sprockets.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// The body that is moved until the links close without stress.
    pub adjust: Adjust,
    /// Tension of every link before gravity and load \[N\], not negative.
    pub pretension: f64,
    /// How the pretension is made.
    pub tighten: Tighten,
    /// Where the chain carries the pretension.
    pub at: PretensionAt,
    /// Growth of the frame against chain and sprockets since they were fitted, such as that of a warm housing of aluminium \[–\]: a pretension, sag or
    /// slack is that before it. All bodies move apart by as much about the origin, and links keep their lengths. There is one frame: where chains tell
    /// different ones, that of the first which grows.
    pub growth: f64,
    /// Sag of the slack span \[m\] where all slack hangs there and the other spans are straight, made by the body that is moved; none: no more
    /// slack than the closing leaves.
    pub sag: Option<f64>,
    /// The span that takes what the chain is longer than its way, by the stop that it leaves. None: the last one, unless a guide lies along it;
    /// then the longest without a guide.
    pub slack: Option<usize>,
}

/// Where in the passing of a tooth a chain carries its pretension.
///
/// The way around polygons is longer at some phases than at others, so that the same chain on the same centres is tighter there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum PretensionAt {
    /// In the mean over a tooth that passes: the phase that a run begins at makes no other drive of it.
    MeanPhase,
    /// At the phase where the run begins.
    Phase,
}

/// The body that is moved until the given number of links closes without stress.
#[derive(Clone, Debug, PartialEq)]
pub enum Adjust {
    /// Nothing: the centres are as they are. A small misfit becomes strain of all links; an
    /// excess of length becomes sag of the slack span.
    Nothing,
    /// A sprocket, along a direction.
    Sprocket {
        /// Its index.
        sprocket: usize,
        /// Direction, of any length.
        direction: Vector,
        /// How far it may move either way \[m\], positive.
        within: f64,
    },
    /// A tensioner, along its travel.
    Tensioner {
        /// Its index.
        tensioner: usize,
        /// How far it may move either way \[m, or rad for an arm\], positive.
        within: f64,
    },
}

/// How the pretension is made.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema,
)]
#[serde(rename_all = "kebab-case")]
pub enum Tighten {
    /// The links are made shorter by the strain of the pretension.
    #[default]
    RestLength,
    /// The adjusted body moves on until the chain carries the pretension.
    Travel,
}

/// A chain, where it lies, and what it can touch.
///
/// Chains run in planes of their own: a chain meets the sprockets and guides of its plane and passes all others.
#[derive(Clone, Debug)]
pub struct PlacedChain {
    /// Name, unique among the chains; none where there is one only.
    pub name: Option<String>,
    /// The chain.
    pub chain: Chain,
    /// Where it lies at the start.
    pub layout: Layout,
    /// Sprockets that it can touch, those of its route among them.
    pub sprockets: Vec<usize>,
    /// Guides that it can touch.
    pub guides: Vec<usize>,
}

/// A pair of gears between two shafts, without play or loss.
///
/// ```text
/// θ₁ − θ₁(0) = i (θ₀ − θ₀(0))
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct GearPair {
    /// Name, unique among the pairs.
    pub name: String,
    /// The two shafts.
    pub shafts: [usize; 2],
    /// Ratio i \[–\]: −z₀/z₁ for gears side by side, +z₀/z₁ where one runs within the other.
    pub ratio: f64,
}

/// A drive as described, not yet checked.
#[derive(Clone, Debug)]
pub struct Parts {
    /// The chains, at least one, and where they lie.
    pub chains: Vec<PlacedChain>,
    /// Sprockets.
    pub sprockets: Vec<Sprocket>,
    /// Guides.
    pub guides: Vec<Guide>,
    /// Tensioners.
    pub tensioners: Vec<Tensioner>,
    /// Shafts, those of single sprockets included.
    pub shafts: Vec<Shaft>,
    /// Torsional springs and dampers between shafts.
    pub couplings: Vec<Coupling>,
    /// Pairs of gears between shafts.
    pub gears: Vec<GearPair>,
    /// Whether the drive settles into static equilibrium under gravity and load before it runs.
    pub settle: bool,
    /// Gravity \[m/s²\], (x, y).
    pub gravity: Vector,
    /// The oil, where one is described.
    pub oil: Option<OilSupply>,
    /// Parameters that may be changed while the drive moves.
    pub tunable: Vec<Tunable>,
}

/// A parameter that may be changed while a drive moves.
#[derive(Clone, Debug, PartialEq)]
pub struct Tunable {
    /// Its place in the scene.
    pub place: String,
    /// Input of the drive.
    pub input: Input,
}

/// The oil of a drive. The parameters that follow from it are with the parts: nothing else reads it in motion.
#[derive(Clone, Debug, PartialEq)]
pub struct OilSupply {
    /// Its properties.
    pub lubricant: Lubricant,
    /// Places of the parameters that follow from it.
    pub used_by: Vec<String>,
}

impl Parts {
    /// Place of a shaft in the scene: under its own name, or that of its only sprocket.
    pub fn shaft_name(&self, index: usize) -> String {
        if let Some(name) = &self.shafts[index].name {
            return format!("shafts.{name}");
        }
        let on_it = self.sprockets.iter().find(|s| s.shaft == index);
        on_it.map_or_else(
            || format!("shafts[{index}]"),
            |sprocket| format!("sprockets.{}", sprocket.name),
        )
    }
}

impl Parts {
    /// All bodies with the forces on them, each by its place in the scene: sprockets, then tensioners.
    pub fn forces(&self) -> impl Iterator<Item = (String, &Forces)> {
        let sprockets = self.sprockets.iter();
        let sprockets = sprockets.map(|it| (format!("sprockets.{}", it.name), &it.forces));
        let tensioners = self.tensioners.iter();
        let tensioners = tensioners.map(|it| (format!("tensioners.{}", it.name), &it.forces));
        sprockets.chain(tensioners)
    }
}

/// A drive that can be assembled: the parts, checked.
#[derive(Clone, Debug)]
pub struct Drive {
    pub(crate) parts: Parts,
    /// Time at which it is assembled \[s\], 0 or before.
    pub(crate) begin: f64,
}

impl Parts {
    /// The sprocket that leads the chain of one, by index, and the exact ratio to it: the first of the route whose motion is given, or else the first
    /// of all. A sprocket that no route passes leads itself.
    pub fn leader(&self, sprocket: usize) -> (usize, f64) {
        let routes = self
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
        let Some(route) = routes.find(|route| route.contains(&sprocket)) else {
            return (sprocket, 1.0);
        };
        let is_given = |it: &&usize| {
            let shaft = &self.shafts[self.sprockets[**it].shaft];
            matches!(shaft.rotation, Rotation::Prescribed(_))
        };
        let first = *route.iter().find(is_given).unwrap_or(&route[0]);
        // i = ± z₀/z
        let signed = |it: usize| {
            let sprocket = &self.sprockets[it];
            f64::from(sprocket.gap.teeth) * sprocket.side.sense()
        };
        (first, signed(first) / signed(sprocket))
    }
}

impl Drive {
    /// Time at which it is assembled \[s\]: 0, but for a drive that [begins](Self::beginning) before.
    pub fn begin(&self) -> f64 {
        self.begin
    }
    /// The parts.
    pub fn parts(&self) -> &Parts {
        &self.parts
    }
}

impl Parts {
    /// Chains that run against the order of their stops at such speeds of the sprockets \[rad/s\].
    ///
    /// Spans bear the names of their stops in this order, so such chains run against the names of their spans.
    ///
    /// ```text
    /// v = s R ω < 0      s: +1 of a sprocket on the left of the chain, −1 on the right
    /// ```
    pub fn against_routes(&self, speeds: &[f64]) -> Vec<AgainstRoute> {
        let told = |(index, placed): (usize, &PlacedChain)| {
            let Layout::Route { stops, .. } = &placed.layout else {
                return None;
            };
            let mut sprockets = stops.iter().filter_map(|stop| match stop {
                Stop::Sprocket(index) => Some(*index),
                Stop::Guide(_) => None,
            });
            let (first, second) = (sprockets.next()?, sprockets.next()?);
            let speed = self.sprockets[first].side.sense() * speeds.get(first)?;
            (speed < 0.0).then(|| AgainstRoute {
                index,
                chain: placed.name.clone(),
                span: [first, second].map(|it| self.sprockets[it].name.clone()),
            })
        };
        self.chains.iter().enumerate().filter_map(told).collect()
    }
}

/// A chain that runs against the order of its stops.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AgainstRoute {
    /// Its index.
    pub index: usize,
    /// Its name; none where there is one only.
    pub chain: Option<String>,
    /// Its first two sprockets, which the first span is named after.
    pub span: [String; 2],
}

impl std::fmt::Display for AgainstRoute {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let name = self.chain.as_ref().map(|it| format!(" {it}"));
        let [from, to] = &self.span;
        write!(
            f,
            "The chain{} runs against the order of its route: span {from}-{to} leads from {to} to {from}.",
            name.unwrap_or_default()
        )
    }
}

impl std::ops::Deref for Drive {
    type Target = Parts;

    fn deref(&self) -> &Parts {
        &self.parts
    }
}
