//! A recorded run as it is read back: from a store, or from arrays that somebody has in memory.

use serde_json::{Map, Value};

/// Samples of a run, or every n-th of them, with what the result says about itself.
#[derive(Clone, Debug, Default)]
pub struct RecordedRun {
    /// Attributes of the result.
    pub attributes: Map<String, Value>,
    /// Samples of the run.
    pub samples: usize,
    /// One sample here stands for so many of the run.
    pub stride: usize,
    /// Instants \[s\], (time,).
    pub time: Vec<f64>,
    /// Names of all channels that were recorded.
    pub names: Vec<String>,
    /// The channels that were asked for and recorded.
    pub channels: Vec<RecordedChannel>,
    /// Contacts in the order in which they ended; none where they were not logged.
    pub contacts: Option<Vec<LoggedContact>>,
}

/// A channel of a recorded run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RecordedChannel {
    /// Its name.
    pub name: String,
    /// Its unit; empty where the result does not say.
    pub unit: String,
    /// Its name in words.
    pub long_name: String,
    /// Labels of the entries; none for a scalar.
    pub labels: Vec<String>,
    /// Values, (time, labels), or (time,) of a scalar.
    pub values: Vec<f64>,
}

/// A contact from touch to parting, as far as replays need it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LoggedContact {
    /// Name of the sprocket or guide; empty in joints.
    pub body: String,
    /// Number of the roller or joint.
    pub roller: i64,
    /// When it began \[s\].
    pub start: f64,
    /// Largest normal force \[N\].
    pub peak_force: f64,
}

impl RecordedRun {
    /// The smallest stride that leaves at most so many samples, the first among them.
    pub fn stride(samples: usize, most: usize) -> usize {
        samples.div_ceil(most.max(1)).max(1)
    }

    /// A channel by its name.
    pub fn channel(&self, name: &str) -> Option<&RecordedChannel> {
        self.channels.iter().find(|channel| channel.name == name)
    }

    /// A text that the result says about itself; empty where it does not.
    pub fn text(&self, name: &str) -> &str {
        let value = self.attributes.get(name);
        value.and_then(Value::as_str).unwrap_or_default()
    }
}

impl RecordedChannel {
    /// Entries of a sample.
    pub fn width(&self) -> usize {
        self.labels.len().max(1)
    }

    /// The entries of one sample.
    pub fn sample(&self, index: usize) -> Option<&[f64]> {
        let width = self.width();
        self.values.get(index * width..(index + 1) * width)
    }
}
