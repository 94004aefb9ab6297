//! Everything that a replay shows: a figure that does not change, and frames of it.

use serde::Serialize;

/// A recorded run, ready to be shown. All quantities are in SI units.
#[derive(Clone, Debug, Default)]
pub struct Animation {
    /// Words of the page about the run.
    pub about: PageTexts,
    /// Sprockets, guides, arms: all that has an outline.
    pub bodies: Vec<Body>,
    /// The chains, in the order of their rollers.
    pub chains: Vec<Chain>,
    /// The motion.
    pub frames: Frames,
    /// Recorded quantities over time, for the plots beside the picture.
    pub curves: Vec<Curve>,
    /// Contacts from touch to parting, where they were logged.
    pub contacts: Vec<Contact>,
}

/// Texts of the page.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct PageTexts {
    /// Headline.
    pub title: String,
    /// How the run ended: `complete`, `running`, `interrupted`, `failed` or `killed`.
    pub status: String,
    /// The reason why it failed; empty if it did not.
    pub failure: String,
    /// Whether the result is to be trusted, in a word; empty where nobody judged.
    pub verdict: String,
    /// Doubts of the verdict, in a line.
    pub note: String,
    /// The account of the run, verdict first.
    pub summary: String,
    /// The program that made the page.
    pub version: String,
    /// Samples of the run, of which the frames are some.
    pub samples: usize,
    /// One frame stands for so many samples.
    pub stride: usize,
}

/// A line in the frame of its body.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outline {
    /// Corners \[m\], (points,).
    pub points: Vec<[f64; 2]>,
    /// Whether the last corner is joined to the first, and the inside filled.
    pub is_closed: bool,
}

/// A sprocket, a guide, or whatever else has an outline.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Body {
    /// Name in the scene.
    pub name: String,
    /// Its kind: `sprocket`, `guide`, `arm`, …; the page chooses colours by it.
    pub kind: String,
    /// Its lines.
    pub outlines: Vec<Outline>,
}

/// Constant properties of a chain.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Chain {
    /// Name in the scene.
    pub name: String,
    /// Number of rollers.
    pub rollers: usize,
    /// Number of links: as many as rollers if the chain is closed, else one less.
    pub links: usize,
    /// Distance between two rollers \[m\].
    pub pitch: f64,
    /// Radius of a roller \[m\].
    pub roller_radius: f64,
    /// Height of a plate \[m\].
    pub plate_height: f64,
    /// Whether the plates have a waist between the eyes.
    pub is_waisted: bool,
    /// Whether link 0 is an outer one.
    pub is_outer_first: bool,
}

/// The motion, frame by frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Frames {
    /// Instants \[s\], (time,).
    pub times: Vec<f64>,
    /// Place \[m\] and angle \[rad\] of every body, (time, body, 3).
    pub placements: Vec<f64>,
    /// Roller centres \[m\], (time, roller).
    pub roller_x: Vec<f64>,
    /// Roller centres \[m\], (time, roller).
    pub roller_y: Vec<f64>,
    /// Tension of the links \[N\], (time, link), if it was recorded.
    pub link_tension: Option<Vec<f64>>,
    /// Normal force between rollers and teeth \[N\], (time, roller), if it was recorded.
    pub contact_force: Option<Vec<f64>>,
    /// Direction in which the teeth press on the rollers \[rad\], (time, roller); where nothing presses, the last one
    /// before.
    pub contact_direction: Option<Vec<f64>>,
}

/// A quantity over time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curve {
    /// Name of the channel; curves of one channel share a plot.
    pub channel: String,
    /// The channel in words.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// The entry of the channel, such as a span; empty for a scalar.
    pub label: String,
    /// Values, (time,).
    pub values: Vec<f64>,
}

/// A contact from touch to parting.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Contact {
    /// When it begins \[s\].
    pub start: f64,
    /// Number of the roller.
    pub roller: usize,
    /// Index of the body it touches.
    pub body: usize,
    /// Largest normal force \[N\].
    pub peak_force: f64,
}
