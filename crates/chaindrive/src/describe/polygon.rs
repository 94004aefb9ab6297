//! Polygonal kinematics of every strand between two sprockets on the same side of the chain.

use chaindrive_geometry::{Point, PolygonAction, PressureAngles, mesh_frequency};
use chaindrive_mechanics::{Drive, Layout, Observation, PlacedChain, Stop};
use schemars::JsonSchema;
use serde::Serialize;

/// A strand between two neighbouring sprockets, were it tight and the only one.
///
/// The wheel that the chain runs onto pulls: it is the driver. The figures follow from teeth,
/// pitch and centre distance alone.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct PolygonPair {
    /// The wheel the strand runs onto.
    pub driver: String,
    /// The wheel it comes from.
    pub driven: String,
    /// Mean speed ratio, teeth of the driver over teeth of the driven wheel \[–\].
    pub mean_ratio: f64,
    /// Least and greatest speed ratio \[–\].
    pub least_ratio: f64,
    /// See `least_ratio`.
    pub greatest_ratio: f64,
    /// Transmission error, peak to peak, at the driven wheel \[rad\].
    pub transmission_error: f64,
    /// Speed of a roller relative to its seat on the driver, as it comes to it \[m/s\]; zero while it stands.
    pub seating_velocity: f64,
    /// Part of it along the normal of the tooth where its flank leaves the seat \[m/s\], the closing speed of an impact there; none for a
    /// profile without a seat of its own.
    ///
    /// ```text
    /// v = p ω sin(2π/z + γ)
    /// ```
    pub closing_speed: Option<f64>,
    /// Frequency at which rollers seat \[Hz\].
    pub mesh_frequency: f64,
}

/// All strands for which the question makes sense.
pub(super) fn pairs(drive: &Drive, start: &Observation) -> Vec<PolygonPair> {
    let chains = drive.chains.iter();
    chains
        .flat_map(|placed| along(drive, placed, start))
        .collect()
}

/// Those of one chain.
fn along(drive: &Drive, placed: &PlacedChain, start: &Observation) -> Vec<PolygonPair> {
    let Layout::Route { stops, .. } = &placed.layout else {
        return Vec::new();
    };
    let next = stops.iter().cycle().skip(1);
    let neighbours = stops.iter().zip(next);
    let pitch = placed.chain.pitch;
    neighbours
        .filter_map(|(from, to)| match (*from, *to) {
            (Stop::Sprocket(from), Stop::Sprocket(to)) => pair(drive, pitch, start, from, to),
            _ => None,
        })
        .collect()
}

fn pair(
    drive: &Drive,
    pitch: f64,
    start: &Observation,
    from: usize,
    to: usize,
) -> Option<PolygonPair> {
    let (a, b) = (&drive.sprockets[from], &drive.sprockets[to]);
    if a.side != b.side {
        return None;
    }
    // Against the order of the route the chain runs onto the wheel in front.
    let along = start.sprocket_speed[to] * b.side.sense() >= 0.0;
    let (driver, driven) = if along { (to, from) } else { (from, to) };
    let centre = |i: usize| Point::new(start.sprocket_x[i], start.sprocket_y[i]);
    let distance = (centre(from) - centre(to)).norm();
    let teeth = |i: usize| drive.sprockets[i].gap.teeth;
    let action = PolygonAction::new(teeth(driver), teeth(driven), pitch, distance).ok()?;
    let (least_ratio, greatest_ratio) = action.ratio_extremes();
    let speed = start.sprocket_speed[driver];
    Some(PolygonPair {
        driver: drive.sprockets[driver].name.clone(),
        driven: drive.sprockets[driven].name.clone(),
        mean_ratio: action.mean_ratio(),
        least_ratio,
        greatest_ratio,
        transmission_error: action.transmission_error_range(),
        // v_rel = (v_rel / p ω) p ω
        seating_velocity: action.seating_velocity().relative.abs() * pitch * speed.abs(),
        closing_speed: drive.sprockets[driver]
            .gap
            .pressure_angle()
            // v = p ω sin(2π/z + γ)
            .map(|angle| PressureAngles::normal_speed(teeth(driver), angle) * pitch * speed.abs()),
        mesh_frequency: mesh_frequency(teeth(driver), speed),
    })
}
