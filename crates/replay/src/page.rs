//! The page: a film packed into the HTML that shows it.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use chaindrive::plain_json;
use serde::Serialize;

use crate::animation::{Animation, Chain, PageTexts};
use crate::stream::{LEVELS, LEVELS_OF_CURVES, Stream, Streams};

const PAGE: &str = include_str!("../page/page.html");
/// Style of pages on which a drive moves: paper, ink, the picture, its legend, plots, buttons.
pub const STYLE: &str = include_str!("../page/style.css");
/// Overlay of the picture on such pages: legend, buttons of its scale, bar of length, card of the followed roller.
pub const STAGE: &str = include_str!("../page/stage.html");
/// Programs of such pages, in the order in which they run: colours, axes, the picture, and what it answers to.
pub const PICTURE: [&str; 4] = [
    include_str!("../page/colours.js"),
    include_str!("../page/axes.js"),
    include_str!("../page/view.js"),
    include_str!("../page/picture.js"),
];
/// The programs of a replay, before the picture and after it.
const DECODE: &str = include_str!("../page/decode.js");
const PROGRAMS: [&str; 3] = [
    include_str!("../page/plots.js"),
    include_str!("../page/controls.js"),
    include_str!("../page/start.js"),
];

/// Largest quantum of places \[m\].
const DISTANCE: f64 = 1e-4;

/// Quanta of places in a pitch, at least: small chains are looked at from nearer.
const IN_A_PITCH: f64 = 400.0;

/// Quantum of outlines \[m\]: they cost little, and facets would be seen.
const OUTLINES: f64 = 1e-6;

/// All of a film but the numbers.
#[derive(Debug, Serialize)]
struct Index<'a> {
    about: &'a PageTexts,
    bodies: Vec<BodyIndex<'a>>,
    chains: &'a [Chain],
    curves: Vec<CurveIndex<'a>>,
    quanta: Quanta,
    streams: &'a [Stream],
}

/// Resolution of the packed numbers.
#[derive(Debug, Serialize)]
struct Quanta {
    /// Of places \[m\].
    distance: f64,
    /// Of a channel in colours or arrows, as a share of its largest magnitude.
    channel: f64,
    /// Of a curve, as a share of its range.
    curve: f64,
}

#[derive(Debug, Serialize)]
struct BodyIndex<'a> {
    name: &'a str,
    kind: &'a str,
    /// Corners of every line, and whether it is closed.
    outlines: Vec<(usize, bool)>,
}

#[derive(Debug, Serialize)]
struct CurveIndex<'a> {
    channel: &'a str,
    name: &'a str,
    unit: &'a str,
    label: &'a str,
    /// The array with its values, and the column there.
    stream: String,
    column: usize,
}

/// The page of a film: HTML that needs nothing else.
///
/// # Panics
/// Never: texts and numbers make JSON.
pub fn page(film: &Animation) -> String {
    let streams = packed(film);
    let body = |body: &'_ crate::Body| {
        let outlines = body.outlines.iter();
        outlines.map(|it| (it.points.len(), it.is_closed)).collect()
    };
    let index = Index {
        about: &film.about,
        bodies: film
            .bodies
            .iter()
            .map(|it| BodyIndex {
                name: &it.name,
                kind: &it.kind,
                outlines: body(it),
            })
            .collect(),
        chains: &film.chains,
        curves: curves(film),
        quanta: Quanta {
            distance: distance(film),
            channel: 1.0 / LEVELS,
            curve: 1.0 / LEVELS_OF_CURVES,
        },
        streams: &streams.index,
    };
    let index = serde_json::to_string(&index).expect("texts and numbers make JSON");
    // Within a script only `</` and `<!--` end or change it; neither is left.
    let index = plain_json(&index).replace('<', "\\u003c");
    let title = if film.about.title.is_empty() {
        "Chain drive"
    } else {
        &film.about.title
    };
    let program = [DECODE, &PICTURE.concat(), &PROGRAMS.concat()].concat();
    // The texts of the run go in last: nothing is looked for in them.
    PAGE.replace("{{stage}}", STAGE.trim_end())
        .replace("{{style}}", STYLE)
        .replace("{{program}}", &program)
        .replace("{{title}}", &escaped(title))
        .replace("{{data}}", &STANDARD.encode(&streams.bytes))
        .replace("{{index}}", &index)
}

/// Where the values of every curve are: those that colours or arrows show are in the page already.
fn curves(film: &Animation) -> Vec<CurveIndex<'_>> {
    let frames = &film.frames;
    let shown = |channel: &str| match channel {
        "link_tension" => frames.link_tension.is_some(),
        "contact_force" => frames.contact_force.is_some(),
        _ => false,
    };
    let mut column = 0;
    let mut index: Vec<CurveIndex<'_>> = Vec::with_capacity(film.curves.len());
    for (number, curve) in film.curves.iter().enumerate() {
        let follows = index.last().is_some_and(|it| it.channel == curve.channel);
        column = if follows { column + 1 } else { 0 };
        let is_shown = shown(&curve.channel);
        index.push(CurveIndex {
            channel: &curve.channel,
            name: &curve.name,
            unit: &curve.unit,
            label: &curve.label,
            stream: if is_shown {
                curve.channel.clone()
            } else {
                format!("curve_{number}")
            },
            column: if is_shown { column } else { 0 },
        });
    }
    index
}

/// Quantum of the places of a film \[m\].
fn distance(film: &Animation) -> f64 {
    let pitches = film.chains.iter().map(|chain| chain.pitch / IN_A_PITCH);
    pitches.fold(DISTANCE, f64::min)
}

fn packed(film: &Animation) -> Streams {
    let distance = distance(film);
    let mut streams = Streams::default();
    let frames = &film.frames;
    let times = &frames.times;
    let span = times.last().unwrap_or(&0.0) - times.first().unwrap_or(&0.0);
    // A thousandth of the mean time between two frames.
    let moment = 1e-3 * span / (times.len().max(2) - 1) as f64;
    streams.push("time", times, 1, moment);

    let corners = || {
        film.bodies
            .iter()
            .flat_map(|it| &it.outlines)
            .flat_map(|it| &it.points)
    };
    for (name, axis) in [("outline_x", 0), ("outline_y", 1)] {
        let values: Vec<f64> = corners().map(|point| point[axis]).collect();
        streams.push(name, &values, 1, OUTLINES);
    }

    let bodies = film.bodies.len();
    let placed = |axis: usize| frames.placements.iter().skip(axis).step_by(3).copied();
    for (name, axis) in [("body_x", 0), ("body_y", 1)] {
        streams.push(name, &placed(axis).collect::<Vec<_>>(), bodies, distance);
    }
    let size = corners().map(|[x, y]| x.hypot(*y)).fold(0.0, f64::max);
    let angles: Vec<f64> = placed(2).collect();
    // No corner is off by more than a place is: angle = distance / radius.
    streams.push("body_angle", &angles, bodies, distance / size.max(distance));

    let rollers: usize = film.chains.iter().map(|chain| chain.rollers).sum();
    let links: usize = film.chains.iter().map(|chain| chain.links).sum();
    streams.push("roller_x", &frames.roller_x, rollers, distance);
    streams.push("roller_y", &frames.roller_y, rollers, distance);
    if let Some(values) = &frames.link_tension {
        streams.push_channel("link_tension", values, links);
    }
    if let Some(values) = &frames.contact_force {
        streams.push_channel("contact_force", values, rollers);
    }
    if let Some(values) = &frames.contact_direction {
        streams.push("contact_direction", values, rollers, DIRECTION);
    }
    for (curve, index) in film.curves.iter().zip(curves(film)) {
        if streams
            .index
            .iter()
            .all(|known| !known.is_called(&index.stream))
        {
            streams.push_curve(&index.stream, &curve.values);
        }
    }
    let column = |of: fn(&crate::Contact) -> f64| film.contacts.iter().map(of).collect::<Vec<_>>();
    if !film.contacts.is_empty() {
        streams.push("event_start", &column(|it| it.start), 1, moment);
        streams.push("event_roller", &column(|it| it.roller as f64), 1, 1.0);
        streams.push("event_body", &column(|it| it.body as f64), 1, 1.0);
        streams.push_channel("event_peak_force", &column(|it| it.peak_force), 1);
    }
    streams
}

/// Quantum of the direction of arrows \[rad\]: two degrees are less than an eye sees.
const DIRECTION: f64 = 2.0 * std::f64::consts::PI / 180.0;

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
        .replace('{', "&#123;")
}
