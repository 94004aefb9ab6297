//! From a valid drive to one that is ready to move: lay the chain, settle it, set it going.

mod lay;
mod relax;
mod setting_off;
mod slack;

use chaindrive_geometry::Point;

use crate::drive::Layout;
use crate::{AssemblyError, ChainModel, Drive, Joint, System};

pub use relax::Statics;
pub(crate) use relax::{Curvature, curvature};

/// A drive ready to move.
#[derive(Clone, Debug)]
pub struct Assembled {
    /// The compiled drive.
    pub system: System,
    /// Coordinates at t = 0.
    pub q: Vec<f64>,
    /// Velocities at t = 0.
    pub v: Vec<f64>,
    /// Static states on the way, when the drive was settled: after pretension, gravity and load.
    pub statics: Vec<Statics>,
    /// How the chain was fitted, when it runs around sprockets.
    pub fitting: Option<Fitting>,
}

/// How a closed chain was fitted.
#[derive(Clone, Debug, PartialEq)]
pub struct Fitting {
    /// Pitches seated on each stop of the route.
    pub seated: Vec<u32>,
    /// Pitches in the span behind each stop.
    pub spans: Vec<u32>,
    /// Strain of the links as laid \[–\], negative where a slack span sags instead.
    pub strain: f64,
    /// Travel of the adjusted body \[m, or rad\].
    pub travel: f64,
}

impl Drive {
    /// Lays the chain, finds the static state where asked, and sets everything going at the
    /// speed of the first driven sprocket.
    ///
    /// # Errors
    /// [`AssemblyError`] when the chain does not close or no equilibrium is found.
    pub fn assemble(&self) -> Result<Assembled, AssemblyError> {
        match &self.chain.model {
            ChainModel::Rigid(links) if links.joint == Joint::Ideal => self.assemble_rigid(),
            ChainModel::Rigid(_) | ChainModel::Particles => self.assemble_as_is(),
        }
    }

    pub(crate) fn assemble_as_is(&self) -> Result<Assembled, AssemblyError> {
        let (laid, fitting) = lay::lay(self)?;
        let (mut system, mut q) = System::build(&laid)?;
        let mut statics = Vec::new();
        if self.settle {
            statics = relax::settle(&mut system, &mut q)?;
        }
        let mut v = vec![0.0; q.len()];
        match &self.layout {
            Layout::Route { stops, .. } => setting_off::along_route(&system, stops, &q, &mut v),
            Layout::Points { velocities, .. } => {
                for (i, velocity) in velocities.iter().enumerate() {
                    v[i] = velocity.x;
                    v[system.stride + i] = velocity.y;
                }
            }
        }
        setting_off::ghosts(&system, &mut v);
        if let ChainModel::Rigid(links) = &laid.parts.chain.model {
            (system, q, v) = self.with_links(system, &laid.parts, links, &q, &v)?;
        }
        system.start(0.0, &mut q, &mut v);
        Ok(Assembled {
            system,
            q,
            v,
            statics,
            fitting,
        })
    }

    /// Lays the chain only, without settling: roller positions \[m\], (rollers,), and the fitting.
    ///
    /// # Errors
    /// [`AssemblyError`] when the chain does not close.
    pub fn layout_positions(&self) -> Result<(Vec<Point>, Option<Fitting>), AssemblyError> {
        lay::lay(self).map(|(laid, fitting)| (laid.positions, fitting))
    }
}
