//! The pose of a drive: all that a picture of it needs, at any instant.
//!
//! A [`Figure`] is what stays the same, bodies with their outlines in frames of their own and chains with their measures; a
//! [`Placement`] says where such a frame is. Placements follow from an [`Instant`], which a running simulation has
//! ([`Observation`](crate::Observation)) and a record holds. Whatever draws a drive draws this.

mod backing;
mod bodies;
mod carried_bodies;
mod chains;
mod forces;
mod places;
mod plate;
mod rotation;

use chaindrive_geometry::{ArcSpline, Point};
use chaindrive_integrate::{Moment, SecondOrderSystem};

pub use chains::{FigureChain, PlateShape};
pub use places::{Instant, MissingChannel};
pub use rotation::RotationArrow;

use crate::body_positions::BodyPositions;
use crate::check::clash::clashes;
use crate::drive::{Parts, Touches};
use crate::{Assembled, AssemblyError, Clash, Drive, Flow, Gap, Observation};

/// All of a drive that does not change while it moves.
#[derive(Clone, Debug)]
pub struct Figure {
    /// Sprockets, guides, tensioners, forces on sprockets, forces on tensioners, in this order, each kind in the order of the drive; an arm is followed
    /// by its plunger.
    pub bodies: Vec<Body>,
    /// The chains.
    pub chains: Vec<FigureChain>,
    /// Bodies in each other's way at the start, those that may pass side by side included.
    pub clashes: Vec<Clash>,
    /// Where chains do not close.
    pub gaps: Vec<Gap>,
    /// Why the drive cannot run as it stands, if it cannot.
    pub problem: Option<String>,
    /// Mean speed of every sprocket \[rad/s\], counter-clockwise positive, or that at the start where no motion drives it. As a chain is laid, before the
    /// drive is assembled, those that a motion turns are known, and others are zero.
    pub speeds: Vec<f64>,
    /// The drive as it was laid: centres and tensioners where the chains close.
    parts: Parts,
    /// Angle of one gap axis of every sprocket as laid \[rad\].
    gap_angles: Vec<f64>,
    /// Where it stands at the start.
    start: Start,
}

/// Positions at the start.
#[derive(Clone, Debug)]
struct Start {
    /// Bodies, as a run would show them.
    seen: Observation,
    /// Roller centres of every chain \[m\].
    rollers: Vec<Vec<Point>>,
}

/// A rigid body of a picture.
#[derive(Clone, Debug)]
pub struct Body {
    /// Name of the sprocket, guide or tensioner.
    pub name: String,
    /// Its kind.
    pub kind: BodyKind,
    /// Its outlines in its own frame: the profile of a sprocket, the face of a guide, the lines of a carrier.
    pub outlines: Vec<ArcSpline>,
    /// Outline of the material behind the face of a guide, in its own frame \[m\]; empty for other bodies. For the eye: the drive knows
    /// of the face only.
    pub backing: Vec<Point>,
}

/// Kinds of bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BodyKind {
    /// A sprocket; its frame has the centre as origin and a tooth gap on the y axis.
    Sprocket {
        /// Number of teeth.
        teeth: u32,
        /// Radius of the pitch circle \[m\].
        pitch_radius: f64,
        /// Radius of the tips \[m\].
        tip_radius: f64,
    },
    /// A guide: its face has the material on the left of travel.
    Guide {
        /// Part of the chain that touches it.
        touches: Touches,
    },
    /// Carrier of sprockets and guides of a tensioner; where it turns, its frame has the pivot as origin.
    Carrier {
        /// Its kind in one word.
        name: &'static str,
        /// Whether it turns about a pivot.
        pivots: bool,
    },
    /// The plunger that pushes a carrier; its frame has the tip as origin and the push along x.
    Plunger,
    /// The arrow of the forces of the scene on a sprocket or a tensioner, whose name it bears; its frame has the point on which they act as origin and
    /// their sum along x. Its length says nothing.
    Force {
        /// Whether they act on the tensioner of that name.
        on_carrier: bool,
    },
}

impl BodyKind {
    /// Name of the kind, in one word.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Sprocket { .. } => "sprocket",
            Self::Guide { .. } => "guide",
            Self::Carrier { name, .. } => name,
            Self::Plunger => "plunger",
            Self::Force { on_carrier: false } => "force",
            Self::Force { on_carrier: true } => "carrier-force",
        }
    }
}

/// Where the frame of a body is: a point p of the body is at `origin` + R(`angle`) p.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Placement {
    /// Origin x \[m\].
    pub x: f64,
    /// Origin y \[m\].
    pub y: f64,
    /// Angle by which it is turned \[rad\], counter-clockwise.
    pub angle: f64,
}

impl Placement {
    /// The place of a point of the body.
    pub fn place(&self, p: Point) -> Point {
        let (s, c) = self.angle.sin_cos();
        Point::new(self.x + c * p.x - s * p.y, self.y + s * p.x + c * p.y)
    }
}

/// A drive at an instant.
#[derive(Clone, Debug, PartialEq)]
pub struct Pose {
    /// Where every body of the figure is.
    pub placements: Vec<Placement>,
    /// Roller centres of every chain \[m\].
    pub rollers: Vec<Vec<Point>>,
    /// Both ends of the plates of every link of every chain \[m\]: the centres of its pins, or of its bushes.
    pub plates: Vec<Vec<[Point; 2]>>,
}

impl Assembled {
    /// The figure of the drive, to be posed at the start and in runs that begin from it.
    ///
    /// # Errors
    /// An outline that is none, which checked drives do not bring about.
    pub fn figure(&self) -> Result<Figure, AssemblyError> {
        let at = Moment {
            t: self.time,
            q: &self.q,
            v: &self.v,
            z: &self.z,
        };
        let mut seen = Observation::default();
        let mut record = self.system.new_record();
        self.system
            .observe(at, &[0.0; Flow::ALL.len()], &mut record, &mut seen);
        let start = Start {
            seen,
            rollers: self.system.roller_places(at),
        };
        let wheels = self.system.bodies.wheels.iter();
        let gap_angles = wheels.map(|wheel| wheel.angle).collect();
        let mut figure = Figure::new(&self.parts, gap_angles, start)?;
        figure.speeds = self.mean_speeds();
        figure.clashes.clone_from(&self.warnings);
        Ok(figure)
    }
}

impl Drive {
    /// The figure of the drive as its chains are laid, before it settles. A chain that does not close is laid from the first
    /// stop of its route as far as it reaches, and the figure says so.
    ///
    /// # Errors
    /// An outline that is none, which checked drives do not bring about.
    pub fn figure_as_laid(&self) -> Result<Figure, AssemblyError> {
        let (laid, gaps, problem) = self.laid_part_way();
        let parts = &laid.parts;
        let centres = || parts.sprockets.iter().map(|sprocket| sprocket.centre);
        let seen = Observation {
            time: laid.begin,
            sprocket_angle: vec![0.0; parts.sprockets.len()],
            sprocket_x: centres().map(|centre| centre.x).collect(),
            sprocket_y: centres().map(|centre| centre.y).collect(),
            tensioner_position: vec![0.0; parts.tensioners.len()],
            ..Observation::default()
        };
        let chains = laid.chains.iter();
        let rollers: Vec<_> = chains.map(|chain| chain.positions.clone()).collect();
        let found = clashes(parts, &BodyPositions::laid(&laid), &rollers);
        let start = Start { seen, rollers };
        let mut figure = Figure::new(parts, laid.gap_angles.clone(), start)?;
        figure.speeds = rotation::given_speeds(parts, laid.begin);
        for (chain, places) in figure.chains.iter_mut().zip(&figure.start.rollers) {
            // What does not close is a strand.
            chain.closed &= places.len() == chain.rollers;
        }
        let certain = found.iter().find(|clash| !clash.may_pass());
        figure.problem = problem
            .map(|problem| problem.to_string())
            .or_else(|| certain.map(Clash::to_string));
        figure.clashes = found;
        figure.gaps = gaps;
        Ok(figure)
    }

    /// The figure of the drive in static equilibrium, or as it is laid where it has none, with the reason.
    ///
    /// # Errors
    /// As [`figure_as_laid`](Self::figure_as_laid).
    pub fn figure(&self) -> Result<Figure, AssemblyError> {
        match self.assemble() {
            Ok(assembled) => assembled.figure(),
            Err(error) => {
                let mut figure = self.figure_as_laid()?;
                figure.problem = Some(error.to_string());
                Ok(figure)
            }
        }
    }
}

impl Figure {
    fn new(parts: &Parts, gap_angles: Vec<f64>, start: Start) -> Result<Self, AssemblyError> {
        Ok(Self {
            bodies: bodies::of(parts)?,
            chains: chains::of(parts),
            clashes: Vec::new(),
            gaps: Vec::new(),
            problem: None,
            speeds: Vec::new(),
            parts: parts.clone(),
            gap_angles,
            start,
        })
    }

    /// The pose at the start.
    pub fn start(&self) -> Pose {
        let Start { seen, rollers } = &self.start;
        let at = Instant::of(seen);
        Pose {
            // A start lacks nothing that places bodies.
            placements: self.placements(&at).unwrap_or_default(),
            rollers: rollers.clone(),
            plates: self.plates(rollers, &at),
        }
    }
}
