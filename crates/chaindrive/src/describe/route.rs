//! The route: what sits where, and what the spans carry at rest.

use std::f64::consts::TAU;
use std::ops::Range;

use chaindrive_geometry::{Point, Route, Wheel};
use chaindrive_mechanics::{Assembled, Drive, Fitting, Layout, Observation, PlacedChain, Stop};
use schemars::JsonSchema;
use serde::Serialize;

use super::{SagFacts, at_start};

/// A body of the route.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct StopFacts {
    /// Name of the chain; none where there is one only.
    pub chain: Option<String>,
    /// Name of the sprocket or guide.
    pub name: String,
    /// Teeth; none for a guide.
    pub teeth: Option<u32>,
    /// Pitches seated: one less than the rollers on it.
    pub pitches: u32,
    /// Wrap angle \[rad\] between the points of tangency; of the seated pitches where a guide is
    /// on the route, and none on a guide.
    pub wrap: Option<f64>,
}

/// A span between two stops, at rest under all loads.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct SpanAtRest {
    /// Name of the chain; none where there is one only.
    pub chain: Option<String>,
    /// Name, "from-to".
    pub name: String,
    /// Number of links.
    pub pitches: usize,
    /// Distance between the last roller before and the first roller after \[m\].
    pub length: f64,
    /// Mean tension of its links \[N\].
    pub tension: f64,
    /// First transverse frequency \[Hz\] while the chain stands; none without tension.
    ///
    /// ```text
    /// f = √(T/μ) / 2L
    /// ```
    pub frequency: Option<f64>,
}

/// The spans of the route, with their tension before the run begins.
pub fn spans_at_rest(drive: &Drive, assembled: &Assembled) -> Vec<SpanAtRest> {
    let start = at_start(assembled);
    let tensions = assembled
        .statics
        .last()
        .map_or(&start.link_tension, |last| &last.tensions);
    let mut spans = Vec::new();
    for run in runs(drive, assembled) {
        let chain = &run.placed.chain;
        let masses = chain.masses.iter().sum::<f64>() / chain.masses.len() as f64;
        let mass_per_length = masses / chain.pitch;
        let place = |roller: usize| {
            let i = run.first_roller + roller % chain.rollers();
            Point::new(start.roller_x[i], start.roller_y[i])
        };
        let span = |(name, links): (String, Range<usize>)| {
            let tension = mean(&tensions[run.of_all(&links)]);
            let length = (place(links.end) - place(links.start)).norm();
            SpanAtRest {
                chain: run.placed.name.clone(),
                name,
                pitches: links.len(),
                length,
                tension,
                // f = √(T/μ) / 2L
                frequency: (tension > 0.0)
                    .then(|| (tension / mass_per_length).sqrt() / (2.0 * length)),
            }
        };
        spans.extend(ranges(drive, &run).into_iter().map(span));
    }
    spans
}

/// A chain, how it was fitted, and where its rollers and links stand among those of all chains.
struct ChainRun<'d> {
    placed: &'d PlacedChain,
    fitting: Option<&'d Fitting>,
    first_roller: usize,
    first_link: usize,
}

impl ChainRun<'_> {
    /// Links of the chain among those of all.
    fn of_all(&self, links: &Range<usize>) -> Range<usize> {
        self.first_link + links.start..self.first_link + links.end
    }
}

/// All chains.
fn runs<'d>(drive: &'d Drive, assembled: &'d Assembled) -> Vec<ChainRun<'d>> {
    let (mut first_roller, mut first_link) = (0, 0);
    let chains = drive.chains.iter().zip(&assembled.fittings);
    chains
        .map(|(placed, fitting)| {
            let run = ChainRun {
                placed,
                fitting: fitting.as_ref(),
                first_roller,
                first_link,
            };
            first_roller += placed.chain.rollers();
            first_link += placed.chain.links();
            run
        })
        .collect()
}

/// Mean of some link tensions over every span \[N\].
pub(super) fn tensions(drive: &Drive, assembled: &Assembled, links: &[f64]) -> Vec<f64> {
    let mut spans = Vec::new();
    for run in runs(drive, assembled) {
        let ranges = ranges(drive, &run).into_iter();
        spans.extend(ranges.map(|(_, range)| mean(&links[run.of_all(&range)])));
    }
    spans
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Name and links of every span: roller 0 is the first on the first stop.
fn ranges(drive: &Drive, run: &ChainRun<'_>) -> Vec<(String, Range<usize>)> {
    let (Layout::Route { stops, .. }, Some(fitting)) = (&run.placed.layout, run.fitting) else {
        return Vec::new();
    };
    let links = run.placed.chain.links();
    let mut at = 0;
    let mut ranges = Vec::with_capacity(stops.len());
    for (i, (seated, span)) in fitting.seated.iter().zip(&fitting.spans).enumerate() {
        let from = (at + *seated as usize).min(links);
        // A slack chain carries its excess in the last span.
        let last = i + 1 == stops.len();
        at = if last {
            links
        } else {
            (from + *span as usize).min(links)
        };
        let next = &stops[(i + 1) % stops.len()];
        ranges.push((
            format!("{}-{}", name(drive, &stops[i]), name(drive, next)),
            from..at,
        ));
    }
    ranges
}

fn name<'d>(drive: &'d Drive, stop: &Stop) -> &'d str {
    match *stop {
        Stop::Sprocket(i) => &drive.sprockets[i].name,
        Stop::Guide(i) => &drive.guides[i].name,
    }
}

/// Wraps of the sprockets \[rad\], in the order of the drive; none of those that no route passes.
pub fn wraps(drive: &Drive, assembled: &Assembled) -> Vec<Option<f64>> {
    let stops = stops(drive, assembled, &at_start(assembled));
    let wrap = |name: &String| stops.iter().find(|it| it.name == *name)?.wrap;
    drive.sprockets.iter().map(|it| wrap(&it.name)).collect()
}

/// The bodies of the routes.
pub(super) fn stops(drive: &Drive, assembled: &Assembled, start: &Observation) -> Vec<StopFacts> {
    let runs = runs(drive, assembled);
    runs.iter()
        .flat_map(|run| stops_of(drive, run, start))
        .collect()
}

fn stops_of(drive: &Drive, run: &ChainRun<'_>, start: &Observation) -> Vec<StopFacts> {
    let (Layout::Route { stops, .. }, Some(fitting)) = (&run.placed.layout, run.fitting) else {
        return Vec::new();
    };
    let taut = taut(drive, run, stops, start);
    let facts = |(i, stop): (usize, &Stop)| {
        let pitches = fitting.seated[i];
        let teeth = match *stop {
            Stop::Sprocket(index) => Some(drive.sprockets[index].gap.teeth),
            Stop::Guide(_) => None,
        };
        let seated = teeth.map(|z| f64::from(pitches) * TAU / f64::from(z));
        StopFacts {
            chain: run.placed.name.clone(),
            name: name(drive, stop).to_owned(),
            teeth,
            pitches,
            wrap: taut.as_ref().map_or(seated, |route| Some(route.wraps[i])),
        }
    };
    stops.iter().enumerate().map(facts).collect()
}

/// The smooth route around the sprockets where they stand; none where a guide takes part.
fn taut(drive: &Drive, run: &ChainRun<'_>, stops: &[Stop], start: &Observation) -> Option<Route> {
    let wheel = |stop: &Stop| match *stop {
        Stop::Sprocket(i) => {
            let sprocket = &drive.sprockets[i];
            let centre = Point::new(start.sprocket_x[i], start.sprocket_y[i]);
            Some(Wheel::toothed(
                centre,
                sprocket.gap.teeth,
                run.placed.chain.pitch,
                sprocket.side,
            ))
        }
        Stop::Guide(_) => None,
    };
    let wheels: Option<Vec<Wheel>> = stops.iter().map(wheel).collect();
    Route::taut(&wheels?).ok()
}

/// The sag that a chain was fitted with, where one was asked for.
pub(super) fn sag(assembled: &Assembled, chain: usize) -> Option<SagFacts> {
    let sag = assembled.sag(chain)?;
    let drive = &assembled.drive;
    let Layout::Route { stops, .. } = &drive.chains[chain].layout else {
        return None;
    };
    let name = |place: usize| match stops[place % stops.len()] {
        Stop::Sprocket(index) => drive.sprockets[index].name.as_str(),
        Stop::Guide(index) => drive.guides[index].name.as_str(),
    };
    Some(SagFacts {
        span: format!("{}-{}", name(sag.span), name(sag.span + 1)),
        asked: sag.asked,
        shared: sag.shared,
    })
}
