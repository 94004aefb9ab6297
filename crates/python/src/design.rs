//! Layouts of chains: of drives, and of stops that a program names.

use chaindrive::catalogue::Number;
use chaindrive::design::{self, Movement};
use chaindrive::scene::chain_named;
use chaindrive_geometry::{CurvedGuide, Plan, Point, Side, Station, Vector, Wheel};
use chaindrive_mechanics::Touches;
use pyo3::prelude::*;

use crate::drive::Drive;
use crate::errors::{OrRaise, parameter};

/// A stop of the chain, told apart by its attributes.
#[derive(Debug, FromPyObject)]
pub(crate) enum Stop {
    Sprocket {
        name: String,
        teeth: u32,
        centre: [f64; 2],
        side: String,
    },
    Idler {
        name: String,
        teeth: u32,
        share: f64,
        wrap: f64,
        side: String,
    },
    Guide {
        name: String,
        radius: f64,
        bow: f64,
        shares: [f64; 2],
        crest: f64,
        height: f64,
        touches: String,
        side: String,
    },
}

impl Stop {
    fn name(&self) -> &str {
        match self {
            Self::Sprocket { name, .. } | Self::Idler { name, .. } | Self::Guide { name, .. } => {
                name
            }
        }
    }

    /// `size` is the chain's: pitch, roller diameter and plate height \[m\].
    fn station(&self, size: [f64; 3]) -> PyResult<Station> {
        let [pitch, roller, plate] = size;
        Ok(match self {
            Self::Sprocket {
                teeth,
                centre: [x, y],
                side: lies,
                ..
            } => Station::Wheel(Wheel::toothed(
                Point::new(*x, *y),
                *teeth,
                pitch,
                side(lies)?,
            )),
            Self::Idler {
                teeth,
                share,
                wrap,
                side: lies,
                ..
            } => Station::Idler {
                wheel: Wheel::toothed(Point::origin(), *teeth, pitch, side(lies)?),
                share: *share,
                wrap: *wrap,
            },
            Self::Guide {
                radius,
                bow,
                shares,
                crest,
                height,
                touches,
                side: lies,
                ..
            } => Station::Guide(CurvedGuide {
                shares: *shares,
                crest: *crest,
                bow: *bow,
                radius: *radius,
                ride: {
                    let own = |of_chain| if *height > 0.0 { *height } else { of_chain };
                    touching(touches)?.ride(*radius, [pitch, own(roller), own(plate)])
                },
                side: side(lies)?,
            }),
        })
    }
}

fn side(name: &str) -> PyResult<Side> {
    match name {
        "left" => Ok(Side::Left),
        "right" => Ok(Side::Right),
        _ => Err(refused(
            "side",
            name,
            "\"left\" or \"right\" of the travelling chain",
        )),
    }
}

fn touching(name: &str) -> PyResult<Touches> {
    match name {
        "rollers" => Ok(Touches::Rollers),
        "eyes" => Ok(Touches::Eyes),
        "plates" => Ok(Touches::Plates),
        _ => Err(refused(
            "touches",
            name,
            "\"rollers\", \"eyes\" or \"plates\"",
        )),
    }
}

fn refused(name: &str, value: &str, allowed: &str) -> PyErr {
    parameter(
        format!("{name} = {value:?}, must be {allowed}"),
        name,
        allowed,
    )
}

/// The layouts of the chains of a drive as JSON, and what is in each other's way.
#[pyfunction]
pub(crate) fn layouts_of(
    py: Python<'_>,
    drive: PyRef<'_, Drive>,
) -> PyResult<(String, Vec<String>)> {
    let drive = drive.drive.clone();
    let (layouts, clashes) = py.detach(|| (design::of(&drive), design::clashes(&drive)));
    let clashes = clashes.or_raise()?;
    let told = clashes.iter().map(ToString::to_string).collect();
    Ok((json(serde_json::to_string(&layouts.or_raise()?))?, told))
}

/// The layout of a chain around stops, as JSON; with a stop moved until so many links close, where one is named. What is not
/// given of the chain is that of one of the catalogue.
#[pyfunction]
pub(crate) fn layout_around(
    stops: Vec<Stop>,
    pitch: Option<f64>,
    chain: Option<&str>,
    links: Option<u32>,
    phase: f64,
    moved: Option<(Option<usize>, Option<[f64; 2]>)>,
) -> PyResult<String> {
    let names: Vec<String> = stops.iter().map(|stop| stop.name().to_owned()).collect();
    let chain = chain.map(chain_named).transpose().map_err(|problem| {
        let known = "a chain of the catalogue, see chaindrive.catalogue()";
        parameter(problem.to_string(), "chain", known)
    })?;
    let of_chain = |number| chain.and_then(|chain| chain.number(number));
    let pitch = pitch.or(of_chain(Number::Pitch)).ok_or_else(|| {
        let needed = "a pitch [m], or a chain of the catalogue";
        parameter(
            format!("the pitch is missing; give {needed}"),
            "pitch",
            needed,
        )
    })?;
    let [roller, plate] = [Number::RollerDiameter, Number::PlateHeight].map(of_chain);
    let size = [pitch, roller.unwrap_or(0.0), plate.unwrap_or(0.0)];
    let stops = stops.iter().map(|stop| stop.station(size));
    let plan = Plan {
        stops: stops.collect::<PyResult<_>>()?,
    };
    let movement = moved.map(|(stop, along)| Movement {
        stop,
        direction: along.map(|[x, y]| Vector::new(x, y)),
    });
    let layout = design::of_plan(&plan, &names, pitch, links, phase, movement);
    let layout = layout.map_err(|error| {
        let named = error.with_names(&|stop| format!("`{}`", names[stop]));
        parameter(named, "stops", "a route that a chain can be laid along")
    })?;
    json(serde_json::to_string(&layout))
}

fn json(text: serde_json::Result<String>) -> PyResult<String> {
    text.map_err(|error| parameter(error.to_string(), "layout", "finite"))
}
