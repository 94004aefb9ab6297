//! A drive that begins before t = 0.

use chaindrive_geometry::{ArcSpline, GeometryError, Vector};

use crate::chains::chain::{End, Ends};
use crate::drive::{GuideSupport, Layout, Rotation, Support};
use crate::{AssemblyError, Drive, Motion};

impl Drive {
    /// The drive as it stands at a time t₀ \[s\], to be assembled there: 0, or before.
    ///
    /// Functions of time begin at their value at t₀. Angles and turns count from t₀: the length of a run-in makes no other drive.
    ///
    /// # Errors
    /// A time after 0; a guide whose face does not stand where its motion takes it.
    pub fn beginning(&self, t: f64) -> Result<Self, AssemblyError> {
        if !(t <= 0.0 && t.is_finite()) {
            return Err(AssemblyError::Layout {
                problem: format!("a drive begins at 0 or before, not at {t} s"),
            });
        }
        let mut drive = Self {
            parts: self.parts.clone(),
            begin: t,
        };
        let parts = &mut drive.parts;
        for sprocket in &mut parts.sprockets {
            if let Support::Prescribed { x, y } = &mut sprocket.support {
                sprocket.centre += gone_on([x, y], t);
            }
        }
        for guide in &mut parts.guides {
            if let GuideSupport::Prescribed { x, y } = &mut guide.support {
                guide.face = translated(&guide.face, gone_on([x, y], t))?;
            }
        }
        for shaft in &mut parts.shafts {
            if let Rotation::Prescribed(motion) = &mut shaft.rotation {
                *motion = motion.from(t).0;
            }
        }
        for placed in &mut parts.chains {
            let Ends::Open(ends) = &mut placed.chain.ends else {
                continue;
            };
            let Layout::Points { positions, .. } = &mut placed.layout else {
                continue;
            };
            let last = positions.len() - 1;
            for (end, roller) in ends.iter_mut().zip([0, last]) {
                if let End::Driven { x, y } = end {
                    positions[roller] += gone_on([x, y], t);
                }
            }
        }
        Ok(drive)
    }
}

/// Values of a pair of motions at a time; from then on both count from there.
fn gone_on(motions: [&mut Motion; 2], t: f64) -> Vector {
    let [x, y] = motions.map(|motion| {
        let (onward, there) = motion.from(t);
        *motion = onward;
        there
    });
    Vector::new(x, y)
}

fn translated(face: &ArcSpline, by: Vector) -> Result<ArcSpline, GeometryError> {
    let pieces = face.pieces().iter().map(|piece| piece.translated(by));
    ArcSpline::open(&pieces.collect::<Vec<_>>())
}
