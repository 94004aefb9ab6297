//! Chains of a figure: measures, and where the plates of their links end.

use chaindrive_geometry::{Point, Vector};

use super::{Figure, Instant};
use crate::chains::chain::Chain;
use crate::drive::{Layout, Parts, PlacedChain, Stop, Touches};

/// A chain of a figure.
#[derive(Clone, Debug, PartialEq)]
pub struct FigureChain {
    /// Its name; none where there is one only.
    pub name: Option<String>,
    /// Whether the last link returns to roller 0.
    pub closed: bool,
    /// Number of rollers.
    pub rollers: usize,
    /// Number of links.
    pub links: usize,
    /// Number of joints with a state of their own: one a roller, or none.
    pub joints: usize,
    /// Nominal pitch \[m\].
    pub pitch: f64,
    /// Diameter of the rollers \[m\].
    pub roller_diameter: f64,
    /// Diameter of the pins \[m\], where the model has pins.
    pub pin_diameter: Option<f64>,
    /// Height of the plates \[m\].
    pub plate_height: f64,
    /// Shape of the plates.
    pub plates: PlateShape,
    /// Whether link 0 is an outer one: it and every other link have their plates on top.
    pub outer_first: bool,
    /// Names of the spans, as records label them: from one sprocket of the route to the next.
    pub spans: Vec<String>,
    /// Indices of the sprockets that it can touch, among those of the drive.
    pub sprockets: Vec<usize>,
    /// Indices of the guides that it can touch, among those of the drive.
    pub guides: Vec<usize>,
}

/// Shape of the plates of a link.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlateShape {
    /// Round eyes about the pins and a waist between them. How narrow the waist is, is for the eye.
    Waisted,
    /// Straight edges from eye to eye.
    Straight,
}

impl PlateShape {
    /// Its name, in one word.
    pub fn name(self) -> &'static str {
        match self {
            Self::Waisted => "waisted",
            Self::Straight => "straight",
        }
    }
}

/// The chains of some parts.
pub(super) fn of(parts: &Parts) -> Vec<FigureChain> {
    parts
        .chains
        .iter()
        .map(|placed| chain(parts, placed))
        .collect()
}

fn chain(parts: &Parts, placed: &PlacedChain) -> FigureChain {
    let Chain {
        pitch,
        roller_diameter,
        plate_height,
        ..
    } = placed.chain;
    let mut guides = placed.guides.iter().map(|&guide| &parts.guides[guide]);
    let straight = guides.any(|guide| guide.touches == Touches::Plates);
    let pin = placed.chain.model.clearance();
    FigureChain {
        name: placed.name.clone(),
        closed: placed.chain.is_closed(),
        rollers: placed.chain.rollers(),
        links: placed.chain.links(),
        joints: if placed.chain.model.has_joints() {
            placed.chain.rollers()
        } else {
            0
        },
        pitch,
        roller_diameter,
        pin_diameter: pin.map(|joint| 2.0 * joint.pin_radius),
        plate_height,
        plates: if straight {
            PlateShape::Straight
        } else {
            PlateShape::Waisted
        },
        outer_first: placed.chain.model.begins_outside(),
        spans: spans(parts, placed),
        sprockets: placed.sprockets.clone(),
        guides: placed.guides.clone(),
    }
}

/// Names of the spans between the sprockets of the route, as [`System::span_names`](crate::System::span_names) has them.
fn spans(parts: &Parts, placed: &PlacedChain) -> Vec<String> {
    let Layout::Route { stops, .. } = &placed.layout else {
        return Vec::new();
    };
    let route: Vec<&str> = stops
        .iter()
        .filter_map(|stop| match stop {
            Stop::Sprocket(index) => Some(parts.sprockets[*index].name.as_str()),
            Stop::Guide(_) => None,
        })
        .collect();
    let next = route.iter().cycle().skip(1);
    route
        .iter()
        .zip(next)
        .map(|(from, to)| format!("{from}-{to}"))
        .collect()
}

impl Figure {
    /// Both ends of the plates of every link: bushes of inner links, pins of outer ones.
    pub(super) fn plates(&self, rollers: &[Vec<Point>], at: &Instant<'_>) -> Vec<Vec<[Point; 2]>> {
        let mut first = 0;
        let mut plates = Vec::with_capacity(rollers.len());
        for (chain, places) in self.chains.iter().zip(rollers) {
            let end = |joint: usize, outer: bool| {
                if chain.joints == 0 {
                    return places[joint];
                }
                let bush =
                    places[joint] + offset(at.bush_offset_x, at.bush_offset_y, first + joint);
                if outer {
                    bush + offset(at.joint_offset_x, at.joint_offset_y, first + joint)
                } else {
                    bush
                }
            };
            // A chain that does not close has fewer rollers laid than it has links.
            let links = if chain.closed {
                places.len()
            } else {
                places.len().saturating_sub(1)
            };
            plates.push(
                (0..links)
                    .map(|link| {
                        let outer = link.is_multiple_of(2) == chain.outer_first;
                        [end(link, outer), end((link + 1) % places.len(), outer)]
                    })
                    .collect(),
            );
            first += chain.joints;
        }
        plates
    }
}

/// An eccentricity; none where it is not known, or there is none.
fn offset(x: Option<&[f64]>, y: Option<&[f64]>, joint: usize) -> Vector {
    let known = |values: Option<&[f64]>| {
        let value = values.and_then(|values| values.get(joint).copied());
        value.filter(|value| value.is_finite()).unwrap_or(0.0)
    };
    Vector::new(known(x), known(y))
}
