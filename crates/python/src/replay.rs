//! Replays of recorded runs.

use chaindrive::record::{LoggedContact, RecordedChannel, RecordedRun};
use chaindrive_replay::{AnimationError, Selection};
use numpy::{PyReadonlyArray1, PyReadonlyArrayDyn};
use pyo3::exceptions::{PyKeyError, PyValueError};
use pyo3::prelude::*;

use crate::errors::IntoException;
use crate::signals::watched;

/// A channel as Python has it: name, unit, name in words, labels (none for a scalar), values.
type Channel<'py> = (
    String,
    String,
    String,
    Vec<String>,
    PyReadonlyArrayDyn<'py, f64>,
);

/// Contacts as Python has them: bodies, rollers, starts [s], peak forces [N].
type Contacts<'py> = (
    Vec<String>,
    PyReadonlyArray1<'py, i64>,
    PyReadonlyArray1<'py, f64>,
    PyReadonlyArray1<'py, f64>,
);

/// The page of a run: `attributes` are JSON, `stride` says how many samples of the run one here stands for.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "all that a recorded run is")]
pub(crate) fn replay<'py>(
    py: Python<'py>,
    attributes: &str,
    samples: usize,
    stride: usize,
    time: PyReadonlyArray1<'py, f64>,
    names: Vec<String>,
    channels: Vec<Channel<'py>>,
    contacts: Option<Contacts<'py>>,
    plots: Option<Vec<String>>,
) -> PyResult<String> {
    let attributes = serde_json::from_str(attributes);
    let attributes = attributes.map_err(|error| PyValueError::new_err(error.to_string()))?;
    let channel = |(name, unit, long_name, labels, values): Channel<'py>| RecordedChannel {
        name,
        unit,
        long_name,
        labels,
        values: values.as_array().iter().copied().collect(),
    };
    let recorded = RecordedRun {
        attributes,
        samples,
        stride,
        time: time.as_array().to_vec(),
        names,
        channels: channels.into_iter().map(channel).collect(),
        contacts: contacts.map(logged),
    };
    let selection = Selection {
        plots,
        ..Selection::default()
    };
    let (page, raised) = py.detach(|| {
        watched(|stop| {
            let film = chaindrive_replay::film(&recorded, &selection, stop)?;
            Ok(chaindrive_replay::page(&film))
        })
    });
    raised?;
    page.map_err(exception)
}

/// The channels that a replay reads if they were recorded, those to plot among them; and the stride that leaves at most
/// so many samples.
#[pyfunction]
pub(crate) fn replay_selection(
    recorded: Vec<String>,
    plots: Option<Vec<String>>,
    samples: usize,
    frames: usize,
) -> (Vec<String>, usize) {
    let selection = Selection { frames, plots };
    let wanted = recorded.into_iter().filter(|name| selection.wants(name));
    (wanted.collect(), RecordedRun::stride(samples, frames))
}

fn logged((bodies, rollers, starts, peaks): Contacts<'_>) -> Vec<LoggedContact> {
    let (rollers, starts, peaks) = (rollers.as_array(), starts.as_array(), peaks.as_array());
    let rows = bodies.into_iter().zip(rollers).zip(starts).zip(peaks);
    let contact = |(((body, &roller), &start), &peak_force)| LoggedContact {
        body,
        roller,
        start,
        peak_force,
    };
    rows.map(contact).collect()
}

fn exception(error: AnimationError) -> PyErr {
    match error {
        AnimationError::Scene(error) => error.exception(),
        AnimationError::Assembly(error) => error.exception(),
        AnimationError::Outline(error) => error.exception(),
        AnimationError::Stopped(error) => error.exception(),
        AnimationError::NotRecorded { .. }
        | AnimationError::UnknownPlot { .. }
        | AnimationError::Pose(_) => PyKeyError::new_err(error.to_string()),
        error => PyValueError::new_err(error.to_string()),
    }
}
