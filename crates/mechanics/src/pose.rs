//! The pose of a drive: all that a picture of it needs, at any instant.
//!
//! A [`Figure`] is what stays the same, bodies with their outlines in frames of their own and chains with their measures; a
//! [`Placement`] says where such a frame is. Placements follow from an [`Instant`], which a running simulation has
//! ([`Observation`](crate::Observation)) and a record holds. Whatever draws a drive draws this.

mod backing;
mod bodies;
mod carried;
mod chains;
mod places;

use chaindrive_geometry::{ArcSpline, Point};
use chaindrive_integrate::Moment;

pub use chains::{FigureChain, PlateShape};
pub use places::{Instant, MissingChannel};

use crate::check::clash::clashes;
use crate::drive::{Parts, Touches};
use crate::standing::Standing;
use crate::system::{Laid, Wheel};
use crate::{Assembled, AssemblyError, Clash, Drive};

/// All of a drive that does not change while it moves.
#[derive(Clone, Debug)]
pub struct Figure {
    /// Sprockets, guides, tensioners, in this order, each kind in the order of the drive; behind an arm stands its plunger.
    pub bodies: Vec<Body>,
    /// The chains.
    pub chains: Vec<FigureChain>,
    /// Bodies in each other's way at the start, those that may pass side by side included.
    pub clashes: Vec<Clash>,
    /// The drive as it was laid: centres and tensioners where the chains close.
    parts: Parts,
    /// Angle of one gap axis of every sprocket as laid \[rad\].
    gap_angles: Vec<f64>,
    /// Where it stands at the start.
    start: Start,
}

/// Where everything stands at the start: rollers \[m\], and bodies as a record would have them.
#[derive(Clone, Debug)]
struct Start {
    time: f64,
    rollers: Vec<Vec<Point>>,
    sprocket_angle: Vec<f64>,
    sprocket_x: Vec<f64>,
    sprocket_y: Vec<f64>,
    tensioner_position: Vec<f64>,
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
    /// The arm of a tensioner; its frame has the pivot as origin.
    Arm,
    /// The slide of a tensioner.
    Slider,
    /// The plunger that pushes an arm; its frame has the tip as origin and the push along x.
    Plunger,
}

impl BodyKind {
    /// Name of the kind, in one word.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Sprocket { .. } => "sprocket",
            Self::Guide { .. } => "guide",
            Self::Arm => "arm",
            Self::Slider => "slider",
            Self::Plunger => "plunger",
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
        let bodies = &self.system.bodies;
        let at = Moment {
            t: self.time,
            q: &self.q,
            v: &self.v,
            z: &self.z,
        };
        let wheels = || bodies.wheels.iter();
        let centres: Vec<Point> = (0..bodies.wheels.len())
            .map(|index| bodies.wheel_centre(index, at))
            .collect();
        let turned = |wheel: &Wheel| wheel.kinematics(at.t, at.q, at.v).position - wheel.angle;
        let slides = bodies.slides.iter();
        let start = Start {
            time: self.time,
            rollers: self.system.roller_places(at),
            sprocket_angle: wheels().map(turned).collect(),
            sprocket_x: centres.iter().map(|centre| centre.x).collect(),
            sprocket_y: centres.iter().map(|centre| centre.y).collect(),
            tensioner_position: slides
                .map(|slide| slide.pose(at.q, at.v).coordinate)
                .collect(),
        };
        let gap_angles = wheels().map(|wheel| wheel.angle).collect();
        Figure::new(&self.parts, gap_angles, start, self.warnings.clone())
    }
}

impl Drive {
    /// The figure of the drive as its chains are laid, before it settles.
    ///
    /// # Errors
    /// [`AssemblyError`] when a chain does not close.
    pub fn figure_as_laid(&self) -> Result<Figure, AssemblyError> {
        let laid = self.laid()?;
        let rollers: Vec<_> = laid.chains.iter().map(|it| it.positions.clone()).collect();
        let found = clashes(&laid.parts, &Standing::laid(&laid), &rollers);
        Figure::laid(&laid, found)
    }
}

impl Figure {
    fn new(
        parts: &Parts,
        gap_angles: Vec<f64>,
        start: Start,
        clashes: Vec<Clash>,
    ) -> Result<Self, AssemblyError> {
        Ok(Self {
            bodies: bodies::of(parts)?,
            chains: chains::of(parts),
            clashes,
            parts: parts.clone(),
            gap_angles,
            start,
        })
    }

    /// The drive as its chains were laid, before it settles.
    fn laid(laid: &Laid, clashes: Vec<Clash>) -> Result<Self, AssemblyError> {
        let parts = &laid.parts;
        let centres = || parts.sprockets.iter().map(|sprocket| sprocket.centre);
        let chains = laid.chains.iter();
        let start = Start {
            time: laid.begin,
            rollers: chains.map(|chain| chain.positions.clone()).collect(),
            sprocket_angle: vec![0.0; parts.sprockets.len()],
            sprocket_x: centres().map(|centre| centre.x).collect(),
            sprocket_y: centres().map(|centre| centre.y).collect(),
            tensioner_position: vec![0.0; parts.tensioners.len()],
        };
        Self::new(parts, laid.gap_angles.clone(), start, clashes)
    }

    /// The pose at the start.
    pub fn start(&self) -> Pose {
        let start = &self.start;
        let at = Instant {
            time: start.time,
            sprocket_angle: Some(&start.sprocket_angle),
            sprocket_x: Some(&start.sprocket_x),
            sprocket_y: Some(&start.sprocket_y),
            tensioner_position: Some(&start.tensioner_position),
            ..Instant::default()
        };
        Pose {
            // A start lacks nothing that places bodies.
            placements: self.placements(&at).unwrap_or_default(),
            rollers: start.rollers.clone(),
            plates: self.plates(&start.rollers, &at),
        }
    }
}
