//! A recorded run as a film.

use std::f64::consts::TAU;

use chaindrive::record::{LoggedContact, RecordedChannel, RecordedRun};
use chaindrive::scene::SceneError;
use chaindrive::{
    Figure, Instant, MissingChannel, Placement, Scene, SimulationError, one_line, patiently, plain,
};
use chaindrive_geometry::{ArcSpline, GeometryError, Point};
use chaindrive_mechanics::{AssemblyError, BodyKind};

use crate::animation::{Animation, Body, Chain, Contact, Curve, Frames, Outline, PageTexts};

/// Frames of a film unless somebody asks for another number: the start, and 5000 more.
pub const MOST_FRAMES: usize = 5001;

/// How far chords may stand off outlines, in pitches: a tenth of a pixel where a pitch fills the window.
const CHORDS: f64 = 1e-4;

/// The frames and plots that a film is to have.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Selection {
    /// Largest number of frames.
    pub frames: usize,
    /// Channels to plot beside the picture; none for the tension of the spans, where it was recorded.
    pub plots: Option<Vec<String>>,
}

impl Default for Selection {
    fn default() -> Self {
        Self {
            frames: MOST_FRAMES,
            plots: None,
        }
    }
}

/// Why there is no film of a run.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "each message names its fields")]
pub enum AnimationError {
    /// The motion was not recorded.
    #[error("the replay takes {}, which {} not recorded: record={record:?}, or --record {}",
        .missing.join(", "), if .missing.len() == 1 { "was" } else { "were" }, .record.join(","))]
    NotRecorded {
        missing: Vec<&'static str>,
        record: Vec<&'static str>,
    },

    /// A channel to plot was not recorded.
    #[error("`{name}` was not recorded, so it cannot be plotted; there are {known}")]
    UnknownPlot { name: String, known: String },

    /// There is not a single sample.
    #[error("the result holds no samples yet")]
    NoSamples,

    /// The result does not hold the scene it was made of.
    #[error(transparent)]
    Scene(#[from] SceneError),

    /// The drive cannot be put together, which its run could.
    #[error(transparent)]
    Assembly(#[from] AssemblyError),

    /// Somebody did not want to wait for the drive to be put together.
    #[error(transparent)]
    Stopped(#[from] SimulationError),

    /// A sample lacks entries.
    #[error(transparent)]
    Pose(#[from] MissingChannel),

    /// An outline that is none.
    #[error(transparent)]
    Outline(#[from] GeometryError),
}

impl Selection {
    /// Whether a film of this selection reads a channel.
    pub fn wants(&self, channel: &str) -> bool {
        const SHOWN: [&str; 12] = [
            "roller_x",
            "roller_y",
            "sprocket_angle",
            "sprocket_x",
            "sprocket_y",
            "tensioner_position",
            "centre_force_x",
            "centre_force_y",
            "carrier_force_x",
            "carrier_force_y",
            "link_tension",
            "contact_force",
        ];
        SHOWN.contains(&channel) || self.plots_channel(channel)
    }

    fn plots_channel(&self, channel: &str) -> bool {
        match &self.plots {
            None => channel == "span_tension",
            Some(plots) => plots.iter().any(|plot| plot == channel),
        }
    }
}

/// The film of a recorded run; `stop` is asked now and then whether to give up.
///
/// # Errors
/// [`AnimationError`]: what the film needs was not recorded, or the scene in the result does not make a drive.
pub fn film(
    recorded: &RecordedRun,
    selection: &Selection,
    stop: &dyn Fn() -> bool,
) -> Result<Animation, AnimationError> {
    let name = match recorded.text("scene_name") {
        "" => "scene",
        name => name,
    };
    let drive = Scene::from_text(recorded.text("scene"), name)?.drive()?;
    let run_in = recorded.attributes.get("run_in");
    let run_in = run_in.and_then(serde_json::Value::as_f64).unwrap_or(0.0);
    let figure = patiently(
        move || {
            let drive = if run_in > 0.0 {
                drive.beginning(-run_in)?
            } else {
                drive
            };
            drive.assemble()?.figure()
        },
        stop,
    )??;
    let record = figure.needs();
    let missing = record.iter().filter(|it| recorded.channel(it).is_none());
    let missing: Vec<&'static str> = missing.copied().collect();
    if !missing.is_empty() {
        return Err(AnimationError::NotRecorded { missing, record });
    }
    if recorded.time.is_empty() {
        return Err(AnimationError::NoSamples);
    }
    let pitches = figure.chains.iter().map(|chain| chain.pitch);
    let chords = CHORDS * pitches.fold(f64::INFINITY, f64::min);
    let bodies = figure.bodies.iter().map(|body| shown_body(body, chords));
    Ok(Animation {
        about: about(recorded),
        bodies: bodies.collect::<Result<_, _>>()?,
        chains: figure.chains.iter().map(shown_chain).collect(),
        frames: frames(recorded, &figure)?,
        curves: curves(recorded, selection)?,
        contacts: contacts(recorded, &figure),
    })
}

fn about(recorded: &RecordedRun) -> PageTexts {
    // Whoever wrote the result.
    let text = |name: &str| plain(recorded.text(name)).into_owned();
    let name = |name: &str| one_line(recorded.text(name)).into_owned();
    PageTexts {
        title: match recorded.text("title") {
            "" => name("scene_name"),
            _ => name("title"),
        },
        status: text("status"),
        failure: text("failure"),
        verdict: text("verdict"),
        note: text("verdict_note"),
        summary: text("summary"),
        version: format!("chaindrive {}", text("chaindrive_version")),
        samples: recorded.samples,
        stride: recorded.stride,
    }
}

fn shown_body(body: &chaindrive::Body, chords: f64) -> Result<Body, GeometryError> {
    let line = |curve: &ArcSpline, is_closed: bool| {
        let points = curve.polyline(chords)?;
        let points = points.iter().map(|point| [point.x, point.y]).collect();
        Ok(Outline { points, is_closed })
    };
    let is_sprocket = matches!(body.kind, BodyKind::Sprocket { .. });
    let mut outlines = Vec::new();
    if !body.backing.is_empty() {
        outlines.push(Outline {
            points: body
                .backing
                .iter()
                .map(|point| [point.x, point.y])
                .collect(),
            is_closed: true,
        });
    }
    for outline in &body.outlines {
        outlines.push(line(outline, is_sprocket)?);
    }
    Ok(Body {
        name: body.name.clone(),
        kind: body.kind.name().to_owned(),
        outlines,
    })
}

fn shown_chain(chain: &chaindrive::FigureChain) -> Chain {
    Chain {
        name: chain.name.clone().unwrap_or_default(),
        rollers: chain.rollers,
        links: chain.links,
        pitch: chain.pitch,
        roller_radius: 0.5 * chain.roller_diameter,
        plate_height: chain.plate_height,
        is_waisted: chain.plates == chaindrive::PlateShape::Waisted,
        is_outer_first: chain.outer_first,
    }
}

fn frames(recorded: &RecordedRun, figure: &Figure) -> Result<Frames, AnimationError> {
    let values = |name: &str| recorded.channel(name).map(|channel| channel.values.clone());
    let mut placements = Vec::new();
    let mut directions = Directions::new(figure);
    for index in 0..recorded.time.len() {
        let sample = |name: &str| recorded.channel(name).and_then(|it| it.sample(index));
        let at = Instant::recorded(recorded.time[index], sample);
        let pose = figure.pose(&at)?;
        if let Some(forces) = sample("contact_force") {
            directions.push(figure, &pose, forces);
        }
        let placed = pose.placements.iter();
        placements.extend(placed.flat_map(|it| [it.x, it.y, it.angle]));
    }
    let has_forces = recorded.channel("contact_force").is_some();
    Ok(Frames {
        times: recorded.time.clone(),
        placements,
        roller_x: values("roller_x").unwrap_or_default(),
        roller_y: values("roller_y").unwrap_or_default(),
        link_tension: values("link_tension"),
        contact_force: values("contact_force"),
        contact_direction: has_forces.then_some(directions.all),
    })
}

/// Directions in which teeth press on rollers: normals of the teeth where they are nearest.
struct Directions {
    /// Of every sample so far, (time, roller).
    all: Vec<f64>,
    /// Of the last sample.
    last: Vec<f64>,
}

impl Directions {
    fn new(figure: &Figure) -> Self {
        let rollers = figure.chains.iter().map(|chain| chain.rollers).sum();
        Self {
            all: Vec::new(),
            last: vec![0.0; rollers],
        }
    }

    fn push(&mut self, figure: &Figure, pose: &chaindrive::Pose, forces: &[f64]) {
        let mut roller = 0;
        for (chain, places) in figure.chains.iter().zip(&pose.rollers) {
            for &place in places {
                if forces.get(roller).is_some_and(|force| *force > 0.0) {
                    let nearest = chain.sprockets.iter().filter_map(|&sprocket| {
                        let reach = chain.roller_diameter;
                        normal(
                            &figure.bodies[sprocket],
                            &pose.placements[sprocket],
                            place,
                            reach,
                        )
                    });
                    let found = nearest.min_by(|a, b| a.0.total_cmp(&b.0));
                    let last = &mut self.last[roller];
                    if let Some((_, direction)) = found {
                        // The turn that is nearest to the last direction, so that few numbers change.
                        *last += (direction - *last + 0.5 * TAU).rem_euclid(TAU) - 0.5 * TAU;
                    }
                }
                roller += 1;
            }
        }
        self.all.extend_from_slice(&self.last);
    }
}

/// Distance of the teeth of a sprocket, and the direction of their normal there.
fn normal(
    body: &chaindrive::Body,
    placement: &Placement,
    place: Point,
    reach: f64,
) -> Option<(f64, f64)> {
    let BodyKind::Sprocket { tip_radius, .. } = body.kind else {
        return None;
    };
    let away = place - Point::new(placement.x, placement.y);
    if away.norm() > tip_radius + reach {
        return None;
    }
    let (sin, cos) = placement.angle.sin_cos();
    let own = Point::new(cos * away.x + sin * away.y, cos * away.y - sin * away.x);
    let feet = body.outlines.iter().filter_map(|it| it.nearest(own, reach));
    let foot = feet.min_by(|a, b| a.distance.total_cmp(&b.distance))?;
    Some((
        foot.distance,
        foot.normal.y.atan2(foot.normal.x) + placement.angle,
    ))
}

fn curves(recorded: &RecordedRun, selection: &Selection) -> Result<Vec<Curve>, AnimationError> {
    for name in selection.plots.iter().flatten() {
        if recorded.channel(name).is_none() {
            return Err(AnimationError::UnknownPlot {
                name: name.clone(),
                known: recorded.names.join(", "),
            });
        }
    }
    let plotted = recorded.channels.iter();
    let plotted = plotted.filter(|channel| selection.plots_channel(&channel.name));
    Ok(plotted.flat_map(curves_of).collect())
}

fn curves_of(channel: &RecordedChannel) -> Vec<Curve> {
    let curve = |entry: usize, label: &str| Curve {
        channel: channel.name.clone(),
        name: channel.name.replace('_', " "),
        unit: channel.unit.clone(),
        label: label.to_owned(),
        values: channel
            .values
            .iter()
            .skip(entry)
            .step_by(channel.width())
            .copied()
            .collect(),
    };
    if channel.values.is_empty() {
        // A channel of spans in a drive that has none.
        return Vec::new();
    }
    if channel.labels.is_empty() {
        return vec![curve(0, "")];
    }
    let labels = channel.labels.iter().enumerate();
    labels.map(|(entry, label)| curve(entry, label)).collect()
}

/// Contacts of rollers with bodies, in the order of their beginning.
fn contacts(recorded: &RecordedRun, figure: &Figure) -> Vec<Contact> {
    let shown = |logged: &LoggedContact| {
        let bodies = figure.bodies.iter();
        let touchable = bodies.enumerate().filter(|(_, body)| {
            matches!(
                body.kind,
                BodyKind::Sprocket { .. } | BodyKind::Guide { .. }
            )
        });
        let mut touchable = touchable;
        Some(Contact {
            start: logged.start,
            roller: usize::try_from(logged.roller).ok()?,
            body: touchable.find(|(_, body)| body.name == logged.body)?.0,
            peak_force: logged.peak_force,
        })
    };
    let logged = recorded.contacts.iter().flatten();
    let mut contacts: Vec<Contact> = logged.filter_map(shown).collect();
    contacts.sort_by(|a, b| a.start.total_cmp(&b.start));
    contacts
}
