//! Readings of a state, as plain data.

use serde::{Deserialize, Serialize};

use super::pose::Pose;
use crate::energy::Energy;

/// Everything that can be read off one state. SI units; arrays in the order of the drive.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Observation {
    /// Time \[s\].
    pub time: f64,
    /// Roller coordinates x and y \[m\], (rollers,) each.
    pub roller_x: Vec<f64>,
    /// See `roller_x`.
    pub roller_y: Vec<f64>,
    /// Roller velocities \[m/s\], (rollers,) each.
    pub roller_vx: Vec<f64>,
    /// See `roller_vx`.
    pub roller_vy: Vec<f64>,
    /// Direction of every rigid link \[rad\], (links,); empty for particles, like all that follows of joints.
    pub link_angle: Vec<f64>,
    /// Eccentricity of every pin, seen from the centre of its bush, x and y \[m\], (joints,) each;
    /// NaN where the chain ends.
    pub joint_offset_x: Vec<f64>,
    /// See `joint_offset_x`.
    pub joint_offset_y: Vec<f64>,
    /// Force on every pin, x and y \[N\], (joints,) each.
    pub joint_force_x: Vec<f64>,
    /// See `joint_force_x`.
    pub joint_force_y: Vec<f64>,
    /// Its magnitude \[N\], (joints,).
    pub joint_force: Vec<f64>,
    /// Direction of the link with the pin from that with the bush \[rad\], (joints,).
    pub joint_angle: Vec<f64>,
    /// Indentation of pin and bush \[m\], (joints,).
    pub joint_depth: Vec<f64>,
    /// Eccentricity of every bush, seen from the centre of its free roller, x and y \[m\], (joints,) each; NaN where there is none,
    /// like all of bushes.
    pub bush_offset_x: Vec<f64>,
    /// See `bush_offset_x`.
    pub bush_offset_y: Vec<f64>,
    /// Force of the free roller on every bush, x and y \[N\], (joints,) each.
    pub bush_force_x: Vec<f64>,
    /// See `bush_force_x`.
    pub bush_force_y: Vec<f64>,
    /// Its magnitude \[N\], (joints,).
    pub bush_force: Vec<f64>,
    /// Indentation of bush and roller \[m\], (joints,).
    pub bush_depth: Vec<f64>,
    /// Tension of every link, damping included \[N\], (links,).
    pub link_tension: Vec<f64>,
    /// Greatest tension of the strands of every link \[N\], (links,); NaN in chains that do not tell them apart.
    pub strand_tension_max: Vec<f64>,
    /// Least tension of the strands of every link \[N\], (links,).
    pub strand_tension_min: Vec<f64>,
    /// Mean tension of the links between consecutive sprockets of the route \[N\], (spans,).
    pub span_tension: Vec<f64>,
    /// Normal force between every roller and the teeth \[N\], (rollers,).
    pub contact_force: Vec<f64>,
    /// Oil between every roller and the teeth, above the roughness \[m\], (rollers,); zero where metal bears, NaN where nothing presses.
    pub film_thickness: Vec<f64>,
    /// Deepest indentation on every sprocket \[m\], (sprockets,).
    pub contact_depth: Vec<f64>,
    /// Closed contacts on every sprocket, (sprockets,).
    pub contacts: Vec<f64>,
    /// Resultant of the chain on every guide, x and y \[N\], (guides,) each.
    pub guide_force_x: Vec<f64>,
    /// See `guide_force_x`.
    pub guide_force_y: Vec<f64>,
    /// Rotation since the start \[rad\], (sprockets,).
    pub sprocket_angle: Vec<f64>,
    /// Speed \[rad/s\], (sprockets,).
    pub sprocket_speed: Vec<f64>,
    /// Torque of the chain on every sprocket \[N m\], (sprockets,).
    pub sprocket_torque: Vec<f64>,
    /// Resultant of the chain on every sprocket \[N\], (sprockets,) each.
    pub sprocket_force_x: Vec<f64>,
    /// See `sprocket_force_x`.
    pub sprocket_force_y: Vec<f64>,
    /// Force from outside on every centre, x and y \[N\], (sprockets,) each.
    pub centre_force_x: Vec<f64>,
    /// See `centre_force_x`.
    pub centre_force_y: Vec<f64>,
    /// Force of its support on every centre, x and y \[N\], (sprockets,) each; NaN on a tensioner where the laws were not asked.
    pub support_force_x: Vec<f64>,
    /// See `support_force_x`.
    pub support_force_y: Vec<f64>,
    /// Centres \[m\], (sprockets,) each.
    pub sprocket_x: Vec<f64>,
    /// See `sprocket_x`.
    pub sprocket_y: Vec<f64>,
    /// Rotation of every shaft with a name since the start \[rad\], (shafts,).
    pub shaft_angle: Vec<f64>,
    /// Its speed \[rad/s\], (shafts,).
    pub shaft_speed: Vec<f64>,
    /// Torque of every coupling on its first shaft \[N m\], (couplings,).
    pub coupling_torque: Vec<f64>,
    /// Coordinate of every tensioner \[m or rad\], (tensioners,).
    pub tensioner_position: Vec<f64>,
    /// Push of every tensioner \[N or N m\], (tensioners,).
    pub tensioner_force: Vec<f64>,
    /// Force from outside on every tensioner itself, x and y \[N\], (tensioners,) each.
    pub carrier_force_x: Vec<f64>,
    /// See `carrier_force_x`.
    pub carrier_force_y: Vec<f64>,
    /// Pressure above that of the air of oil that can be compressed \[Pa\], (oil columns,).
    pub oil_pressure: Vec<f64>,
    /// The energy ledger.
    pub energy: Energy,
}

impl Observation {
    /// Appends the rollers of a chain, without the copies after the last one.
    pub(crate) fn add_rollers(&mut self, pose: Pose<'_>, rollers: usize) {
        self.roller_x.extend_from_slice(&pose.x[..rollers]);
        self.roller_y.extend_from_slice(&pose.y[..rollers]);
        self.roller_vx.extend_from_slice(&pose.vx[..rollers]);
        self.roller_vy.extend_from_slice(&pose.vy[..rollers]);
    }

    /// Makes room for what every chain appends.
    pub(crate) fn clear_chains(&mut self) {
        for values in [
            &mut self.roller_x,
            &mut self.roller_y,
            &mut self.roller_vx,
            &mut self.roller_vy,
            &mut self.link_angle,
            &mut self.joint_offset_x,
            &mut self.joint_offset_y,
            &mut self.joint_angle,
            &mut self.joint_depth,
            &mut self.bush_offset_x,
            &mut self.bush_offset_y,
            &mut self.bush_depth,
            &mut self.strand_tension_max,
            &mut self.strand_tension_min,
        ] {
            values.clear();
        }
    }
}
