//! From an instant of a motion to placements.

use std::f64::consts::FRAC_PI_2;

use chaindrive_geometry::{Point, Vector};

use super::{Body, BodyKind, Figure, Placement, Pose};
use crate::Observation;
use crate::drive::{GuideSupport, Support};
use crate::tensioner::carriers::Plunger;

/// The instant of a motion, as far as it is known: values of the channels of the same names.
#[derive(Clone, Copy, Debug, Default)]
pub struct Instant<'a> {
    /// Time \[s\].
    pub time: f64,
    /// Roller centres x \[m\], (rollers,).
    pub roller_x: Option<&'a [f64]>,
    /// See `roller_x`.
    pub roller_y: Option<&'a [f64]>,
    /// Rotation since the start \[rad\], (sprockets,).
    pub sprocket_angle: Option<&'a [f64]>,
    /// Centres x \[m\], (sprockets,).
    pub sprocket_x: Option<&'a [f64]>,
    /// See `sprocket_x`.
    pub sprocket_y: Option<&'a [f64]>,
    /// Coordinates of tensioners \[m or rad\], (tensioners,).
    pub tensioner_position: Option<&'a [f64]>,
    /// Eccentricities of the pins in their bushes x \[m\], (joints,); without them plates end where their rollers are.
    pub joint_offset_x: Option<&'a [f64]>,
    /// See `joint_offset_x`.
    pub joint_offset_y: Option<&'a [f64]>,
    /// Eccentricities of the bushes in their rollers x \[m\], (joints,).
    pub bush_offset_x: Option<&'a [f64]>,
    /// See `bush_offset_x`.
    pub bush_offset_y: Option<&'a [f64]>,
    /// Forces from outside on centres x \[N\], (sprockets,); without them arrows show those of the scene where no shaft has turned.
    pub centre_force_x: Option<&'a [f64]>,
    /// See `centre_force_x`.
    pub centre_force_y: Option<&'a [f64]>,
    /// Forces from outside on tensioners x \[N\], (tensioners,).
    pub carrier_force_x: Option<&'a [f64]>,
    /// See `carrier_force_x`.
    pub carrier_force_y: Option<&'a [f64]>,
}

impl<'a> Instant<'a> {
    /// Names of the channels of its fields.
    pub const CHANNELS: [&'static str; 14] = [
        "roller_x",
        "roller_y",
        "sprocket_angle",
        "sprocket_x",
        "sprocket_y",
        "tensioner_position",
        "joint_offset_x",
        "joint_offset_y",
        "bush_offset_x",
        "bush_offset_y",
        "centre_force_x",
        "centre_force_y",
        "carrier_force_x",
        "carrier_force_y",
    ];

    /// The instant at which channels have the values that `values` knows by their names.
    pub fn recorded(time: f64, values: impl Fn(&str) -> Option<&'a [f64]>) -> Self {
        let [
            roller_x,
            roller_y,
            sprocket_angle,
            sprocket_x,
            sprocket_y,
            tensioner_position,
            joint_offset_x,
            joint_offset_y,
            bush_offset_x,
            bush_offset_y,
            centre_force_x,
            centre_force_y,
            carrier_force_x,
            carrier_force_y,
        ] = Self::CHANNELS.map(values);
        Self {
            time,
            roller_x,
            roller_y,
            sprocket_angle,
            sprocket_x,
            sprocket_y,
            tensioner_position,
            joint_offset_x,
            joint_offset_y,
            bush_offset_x,
            bush_offset_y,
            centre_force_x,
            centre_force_y,
            carrier_force_x,
            carrier_force_y,
        }
    }

    /// The instant of an observation.
    pub fn of(seen: &'a Observation) -> Self {
        Self {
            time: seen.time,
            roller_x: Some(&seen.roller_x),
            roller_y: Some(&seen.roller_y),
            sprocket_angle: Some(&seen.sprocket_angle),
            sprocket_x: Some(&seen.sprocket_x),
            sprocket_y: Some(&seen.sprocket_y),
            tensioner_position: Some(&seen.tensioner_position),
            joint_offset_x: Some(&seen.joint_offset_x),
            joint_offset_y: Some(&seen.joint_offset_y),
            bush_offset_x: Some(&seen.bush_offset_x),
            bush_offset_y: Some(&seen.bush_offset_y),
            centre_force_x: Some(&seen.centre_force_x),
            centre_force_y: Some(&seen.centre_force_y),
            carrier_force_x: Some(&seen.carrier_force_x),
            carrier_force_y: Some(&seen.carrier_force_y),
        }
    }
}

/// A channel that a pose needs and a record lacks, or has too few entries of.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the pose needs `{channel}` with {entries} entries a sample; record it")]
pub struct MissingChannel {
    /// Name of the channel.
    pub channel: &'static str,
    /// Entries of a sample.
    pub entries: usize,
}

impl Figure {
    /// Channels that a record must have to be posed: what does not follow from the drive and the time.
    pub fn needs(&self) -> Vec<&'static str> {
        let mut needs = vec!["roller_x", "roller_y"];
        if !self.parts.sprockets.is_empty() {
            needs.push("sprocket_angle");
        }
        if self
            .parts
            .sprockets
            .iter()
            .any(|it| matches!(it.support, Support::Springs { .. }))
        {
            needs.extend(["sprocket_x", "sprocket_y"]);
        }
        if !self.parts.tensioners.is_empty() {
            needs.push("tensioner_position");
        }
        needs
    }

    /// Where every body is at an instant.
    ///
    /// Centres that are not known follow from their supports: fixed, moved in time, carried by a tensioner.
    ///
    /// # Errors
    /// The first channel that is missing.
    pub fn placements(&self, at: &Instant<'_>) -> Result<Vec<Placement>, MissingChannel> {
        let bodies = self.bodies.iter().enumerate();
        bodies
            .map(|(index, body)| self.placement(index, body, at))
            .collect()
    }

    /// The drive at an instant.
    ///
    /// # Errors
    /// The first channel that is missing.
    pub fn pose(&self, at: &Instant<'_>) -> Result<Pose, MissingChannel> {
        let count = self.chains.iter().map(|chain| chain.rollers).sum();
        let x = entries(at.roller_x, "roller_x", count)?;
        let y = entries(at.roller_y, "roller_y", count)?;
        let mut places = x.iter().zip(y).map(|(&x, &y)| Point::new(x, y));
        let chains = self.chains.iter();
        let rollers: Vec<Vec<Point>> = chains
            .map(|chain| places.by_ref().take(chain.rollers).collect())
            .collect();
        Ok(Pose {
            placements: self.placements(at)?,
            plates: self.plates(&rollers, at),
            rollers,
        })
    }

    fn placement(
        &self,
        index: usize,
        body: &Body,
        at: &Instant<'_>,
    ) -> Result<Placement, MissingChannel> {
        let guides = self.parts.sprockets.len();
        Ok(match body.kind {
            BodyKind::Sprocket { .. } => {
                let centre = self.centre(index, at)?;
                let turned = entries(at.sprocket_angle, "sprocket_angle", guides)?[index];
                Placement {
                    x: centre.x,
                    y: centre.y,
                    // The first gap of the outline lies on its y axis.
                    angle: self.gap_angles[index] - FRAC_PI_2 + turned,
                }
            }
            BodyKind::Guide { .. } => match &self.parts.guides[index - guides].support {
                GuideSupport::Fixed => Placement::default(),
                GuideSupport::Prescribed { x, y } => Placement {
                    x: x.at(at.time).position,
                    y: y.at(at.time).position,
                    angle: 0.0,
                },
                GuideSupport::Tensioner(tensioner) => self.carried(*tensioner, at)?,
            },
            BodyKind::Force { on_carrier } => self.force_arrow(body, on_carrier, at)?,
            BodyKind::Carrier { .. } => self.carried(self.tensioner(body), at)?,
            BodyKind::Plunger => {
                let tensioner = self.tensioner(body);
                let s = self.coordinate(tensioner, at)?;
                let carrier = &self.parts.tensioners[tensioner].carrier;
                let Some(Plunger { at: tip, direction }) = carrier.plunger() else {
                    return Ok(Placement::default());
                };
                let tip = tip + direction * carrier.extension(s).length;
                Placement {
                    x: tip.x,
                    y: tip.y,
                    angle: direction.y.atan2(direction.x),
                }
            }
        })
    }

    pub(super) fn tensioner(&self, body: &Body) -> usize {
        let mut tensioners = self.parts.tensioners.iter();
        tensioners.position(|it| it.name == body.name).unwrap_or(0)
    }

    /// Coordinate of a tensioner since it was laid.
    pub(super) fn coordinate(
        &self,
        tensioner: usize,
        at: &Instant<'_>,
    ) -> Result<f64, MissingChannel> {
        let count = self.parts.tensioners.len();
        let all = entries(at.tensioner_position, "tensioner_position", count)?;
        Ok(all[tensioner])
    }

    /// Where the frame of a carrier is.
    fn carried(&self, tensioner: usize, at: &Instant<'_>) -> Result<Placement, MissingChannel> {
        let s = self.coordinate(tensioner, at)?;
        let carrier = &self.parts.tensioners[tensioner].carrier;
        let (origin, _) = carrier.carry(s, carrier.origin());
        Ok(Placement {
            x: origin.x,
            y: origin.y,
            angle: carrier.turning() * s,
        })
    }

    /// Centre of a sprocket: the recorded one, or where its support has it.
    pub(super) fn centre(&self, index: usize, at: &Instant<'_>) -> Result<Point, MissingChannel> {
        let count = self.parts.sprockets.len();
        if let (Some(x), Some(y)) = (at.sprocket_x, at.sprocket_y) {
            let x = entries(Some(x), "sprocket_x", count)?[index];
            let y = entries(Some(y), "sprocket_y", count)?[index];
            return Ok(Point::new(x, y));
        }
        let sprocket = &self.parts.sprockets[index];
        Ok(match &sprocket.support {
            Support::Fixed => sprocket.centre,
            Support::Prescribed { x, y } => {
                let moved = [x, y].map(|motion| motion.at(at.time).position);
                sprocket.centre + Vector::from(moved)
            }
            Support::Springs { .. } => {
                return Err(MissingChannel {
                    channel: if at.sprocket_x.is_none() {
                        "sprocket_x"
                    } else {
                        "sprocket_y"
                    },
                    entries: count,
                });
            }
            Support::Tensioner(tensioner) => {
                let s = self.coordinate(*tensioner, at)?;
                let carrier = &self.parts.tensioners[*tensioner].carrier;
                carrier.carry(s, sprocket.centre).0
            }
        })
    }
}

/// The entries of a channel, of which there must be `count`.
pub(super) fn entries<'a>(
    values: Option<&'a [f64]>,
    channel: &'static str,
    count: usize,
) -> Result<&'a [f64], MissingChannel> {
    let found = values.filter(|values| values.len() == count);
    found.ok_or(MissingChannel {
        channel,
        entries: count,
    })
}
