//! Positions of the bodies: whole profiles of sprockets and guides in the frame of the drive.

use std::f64::consts::FRAC_PI_2;

use chaindrive_geometry::{ArcSpline, GeometryError, Piece, Point};
use chaindrive_integrate::Moment;

use crate::contact::Frame;
use crate::drive::{GuideSupport, Parts};
use crate::system::LaidDrive;
use crate::{AssemblyError, System};

/// The bodies of a drive in their places at one moment.
#[derive(Clone, Debug)]
pub(crate) struct BodyPositions {
    /// Centre \[m\] and angle of one gap axis \[rad\] of every sprocket.
    pub(crate) sprockets: Vec<(Point, f64)>,
    /// Working face of every guide.
    pub(crate) faces: Vec<ArcSpline>,
}

impl BodyPositions {
    /// The bodies where they are when the chains have been laid.
    pub(crate) fn laid(laid: &LaidDrive) -> Self {
        let sprockets = laid.parts.sprockets.iter().zip(&laid.gap_angles);
        Self {
            sprockets: sprockets.map(|(s, &angle)| (s.centre, angle)).collect(),
            faces: laid.parts.guides.iter().map(|g| g.face.clone()).collect(),
        }
    }

    /// The bodies of a system made of `parts`, at a moment of its motion.
    ///
    /// # Errors
    /// A face that is none after it was moved, which rounding does not bring about.
    pub(crate) fn of(
        system: &System,
        parts: &Parts,
        at: Moment<'_>,
    ) -> Result<Self, GeometryError> {
        let bodies = &system.bodies;
        let sprockets = bodies.wheels.iter().enumerate().map(|(index, wheel)| {
            let angle = wheel.kinematics(at.t, at.q, at.v).position;
            (bodies.wheel_centre(index, at), angle)
        });
        let faces = parts.guides.iter().enumerate().map(|(index, guide)| {
            let frame = bodies.rail_frame(index, at);
            moved(&guide.face, &frame, parts.reference(&guide.support))
        });
        Ok(Self {
            sprockets: sprockets.collect(),
            faces: faces.collect::<Result<_, _>>()?,
        })
    }

    /// The whole profile of the sprocket or guide of this name.
    pub(crate) fn profile(&self, parts: &Parts, name: &str) -> Result<ArcSpline, AssemblyError> {
        let named = |other: &str| other == name;
        if let Some(index) = parts.sprockets.iter().position(|s| named(&s.name)) {
            let (centre, angle) = self.sprockets[index];
            // The first gap of the outline lies on its y axis.
            let outline = parts.sprockets[index].gap.outline()?;
            let pieces = outline.pieces().iter();
            let placed = |piece: &Piece| piece.rotated(angle - FRAC_PI_2).translated(centre.coords);
            return Ok(ArcSpline::closed(&pieces.map(placed).collect::<Vec<_>>())?);
        }
        match parts.guides.iter().position(|g| named(&g.name)) {
            Some(index) => Ok(self.faces[index].clone()),
            None => Err(no_such_body(parts, name)),
        }
    }
}

impl Parts {
    /// The point of a guide's face at the origin of its frame: the pivot of an arm.
    pub(crate) fn reference(&self, support: &GuideSupport) -> Point {
        match support {
            GuideSupport::Tensioner(index) => self.tensioners[*index].carrier.origin(),
            GuideSupport::Fixed | GuideSupport::Prescribed { .. } => Point::origin(),
        }
    }
}

/// A face carried by a frame whose origin lies at `reference` in the face's own coordinates.
fn moved(face: &ArcSpline, frame: &Frame, reference: Point) -> Result<ArcSpline, GeometryError> {
    let [c, s] = frame.turn;
    let pieces = face.pieces().iter().map(|piece| {
        piece
            .translated(-reference.coords)
            .rotated(s.atan2(c))
            .translated(frame.origin.coords)
    });
    ArcSpline::open(&pieces.collect::<Vec<_>>())
}

fn no_such_body(parts: &Parts, name: &str) -> AssemblyError {
    let sprockets = parts.sprockets.iter().map(|s| &s.name);
    let known = sprockets.chain(parts.guides.iter().map(|g| &g.name));
    let known: Vec<_> = known.map(|name| format!("`{name}`")).collect();
    AssemblyError::UnknownBody {
        name: name.to_owned(),
        known: if known.is_empty() {
            "the drive has neither".to_owned()
        } else {
            format!("there are {}", known.join(", "))
        },
    }
}
