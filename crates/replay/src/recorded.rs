//! A recorded run as a film.

use chaindrive::record::{LoggedContact, RecordedChannel, RecordedRun};
use chaindrive::scene::SceneError;
use chaindrive::{
    BodyKind, Figure, Instant, MissingChannel, Scene, SimulationError, one_line, patiently, plain,
};
use chaindrive_geometry::GeometryError;
use chaindrive_mechanics::AssemblyError;

use crate::animation::{Animation, Contact, Curve, Frames, PageTexts};
use crate::picture::Picture;

/// Frames of a film unless somebody asks for another number: the start, and 5000 more.
pub const MOST_FRAMES: usize = 5001;

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
    let mut picture = Picture::of(figure)?;
    Ok(Animation {
        about: about(recorded),
        frames: frames(recorded, &mut picture)?,
        curves: curves(recorded, selection)?,
        contacts: contacts(recorded, picture.figure()),
        bodies: picture.bodies,
        chains: picture.chains,
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

fn frames(recorded: &RecordedRun, picture: &mut Picture) -> Result<Frames, AnimationError> {
    let values = |name: &str| recorded.channel(name).map(|channel| channel.values.clone());
    let has_forces = recorded.channel("contact_force").is_some();
    let (mut placements, mut directions) = (Vec::new(), Vec::new());
    for index in 0..recorded.time.len() {
        let sample = |name: &str| recorded.channel(name).and_then(|it| it.sample(index));
        let at = Instant::recorded(recorded.time[index], sample);
        picture.move_to(&at, sample("contact_force"))?;
        placements.extend_from_slice(picture.placements());
        directions.extend_from_slice(picture.directions());
    }
    Ok(Frames {
        times: recorded.time.clone(),
        placements,
        roller_x: values("roller_x").unwrap_or_default(),
        roller_y: values("roller_y").unwrap_or_default(),
        link_tension: values("link_tension"),
        contact_force: values("contact_force"),
        contact_direction: has_forces.then_some(directions),
    })
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
