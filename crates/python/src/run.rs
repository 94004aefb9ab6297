//! Runs: without the interpreter's lock, stopped by Ctrl-C, results handed over without a copy.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use chaindrive::record::{
    self, Ending, EventColumn, EventTable, Existing, Provenance, Recording, ZarrWriter,
};
use chaindrive::{Axis, Channel, EventKinds, Method, Run, Simulation, Stepping, Summary};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::drive::Drive;
use crate::errors::{OrRaise, parameter};

/// Between two looks at signals.
pub(crate) const PATIENCE: Duration = Duration::from_millis(50);

/// Runs a drive and returns its recording: time, columns, labels and attributes.
#[pyfunction]
#[pyo3(signature = (drive, channels, *, until, every, method, step, tolerance, onset_depth, events, output, overwrite, progress))]
#[expect(clippy::too_many_arguments, reason = "keywords in Python")]
pub(crate) fn simulate<'py>(
    py: Python<'py>,
    drive: &Drive,
    channels: Vec<String>,
    until: f64,
    every: f64,
    method: &str,
    step: Option<f64>,
    tolerance: f64,
    onset_depth: Option<f64>,
    events: Vec<String>,
    output: Option<PathBuf>,
    overwrite: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    Channel::check(&channels).or_raise()?;
    let run = Run {
        until,
        every,
        stepping: stepping(method)?,
        step,
        tolerance,
        onset_depth,
        events: event_kinds(&events)?,
    };
    let output = output.map(|path| {
        let existing = if overwrite {
            Existing::Replace
        } else {
            Existing::Keep
        };
        (path, existing)
    });
    let Outcome {
        simulation,
        recording,
        contacts,
        summary,
    } = py.detach(|| carry_out(drive, &run, &channels, output, progress.as_ref()))?;
    let answer = PyDict::new(py);
    let recorded = recording.columns.iter().map(|column| column.channel);
    let recorded: Vec<Channel> = recorded.collect();
    answer.set_item("labels", labels(py, &recorded, &simulation)?)?;
    answer.set_item("attributes", attributes(py, &simulation, &summary)?)?;
    let samples = recording.len();
    answer.set_item("time", PyArray1::from_vec(py, recording.time))?;
    let columns = PyDict::new(py);
    for column in recording.columns {
        let values = PyArray1::from_vec(py, column.values);
        let values = match column.channel.axis() {
            Axis::None => values.into_any(),
            _ => values.reshape([samples, column.width])?.into_any(),
        };
        columns.set_item(column.channel.name(), values)?;
    }
    answer.set_item("columns", columns)?;
    if run.events != EventKinds::default() {
        answer.set_item("events", event_columns(py, contacts)?)?;
    }
    Ok(answer)
}

/// Name, values, unit and description of every column of the table of contacts.
fn event_columns(py: Python<'_>, contacts: EventTable) -> PyResult<Bound<'_, PyList>> {
    let columns = PyList::empty(py);
    for column in EventColumn::ALL {
        let values = match column {
            EventColumn::Kind => PyList::new(py, &contacts.kind)?.into_any(),
            EventColumn::Body => PyList::new(py, &contacts.body)?.into_any(),
            EventColumn::Roller => PyArray1::from_slice(py, &contacts.roller).into_any(),
            _ => PyArray1::from_slice(py, contacts.numbers(column).unwrap_or_default()).into_any(),
        };
        columns.append((column.name(), values, column.unit(), column.description()))?;
    }
    Ok(columns)
}

fn event_kinds(names: &[String]) -> PyResult<EventKinds> {
    let mut kinds = EventKinds::default();
    for name in names {
        match name.as_str() {
            "teeth" => kinds.teeth = true,
            "guides" => kinds.guides = true,
            "joints" => kinds.joints = true,
            _ => {
                let known = "teeth, guides, joints";
                let message = format!("no contacts are named `{name}`; there are {known}");
                return Err(parameter(message, "events", &format!("of {known}")));
            }
        }
    }
    Ok(kinds)
}

fn stepping(name: &str) -> PyResult<Stepping> {
    Stepping::from_name(name).ok_or_else(|| {
        let known = Stepping::ALL.map(Stepping::name).join(", ");
        let message = format!("no method is named `{name}`; there are {known}");
        parameter(message, "method", &format!("one of {known}"))
    })
}

/// What a run leaves.
struct Outcome {
    simulation: Simulation,
    recording: Recording,
    contacts: EventTable,
    summary: Summary,
}

fn carry_out(
    drive: &Drive,
    run: &Run,
    names: &[String],
    output: Option<(PathBuf, Existing)>,
    progress: Option<&Py<PyAny>>,
) -> PyResult<Outcome> {
    let mut simulation = Simulation::start(&drive.drive, run).or_raise()?;
    let channels = Channel::chosen(names, simulation.system()).or_raise()?;
    let channels = channels.as_slice();
    let mut summary = Summary::new(&simulation);
    let mut contacts = EventTable::new(simulation.system());
    let Some((path, existing)) = output else {
        let mut recording = Recording::new(channels, simulation.system());
        advance(&mut simulation, &mut summary, progress, |simulation| {
            recording.push(simulation.observation());
            for event in simulation.events() {
                contacts.push(event);
            }
            Ok(())
        })?;
        for event in simulation.outstanding_events() {
            contacts.push(&event);
        }
        return Ok(Outcome {
            simulation,
            recording,
            contacts,
            summary,
        });
    };
    // On disk; nothing is kept in memory.
    let recording = Recording::new(&[], simulation.system());
    let provenance = Provenance::of(&drive.scene, run);
    let mut writer =
        ZarrWriter::create(&path, &simulation, channels, provenance, existing).or_raise()?;
    let outcome = advance(&mut simulation, &mut summary, progress, |simulation| {
        writer.push(simulation).or_raise()
    });
    let ending = match &outcome {
        Ok(()) => Ending::Complete,
        Err(error) => Python::attach(|py| {
            if error.is_instance_of::<PyKeyboardInterrupt>(py) {
                Ending::Interrupted
            } else {
                Ending::Failed(error.value(py).to_string())
            }
        }),
    };
    let finished = writer.finish(&simulation, &ending).or_raise();
    outcome.and(finished)?;
    Ok(Outcome {
        simulation,
        recording,
        contacts,
        summary,
    })
}

/// Takes sample after sample to the end of the run.
fn advance(
    simulation: &mut Simulation,
    summary: &mut Summary,
    progress: Option<&Py<PyAny>>,
    mut keep: impl FnMut(&Simulation) -> PyResult<()>,
) -> PyResult<()> {
    let mut looked = Instant::now();
    loop {
        while !simulation.advance(PATIENCE).or_raise()? {
            look(progress, simulation.progress())?;
        }
        if simulation.next_sample().or_raise()?.is_none() {
            break;
        }
        summary.push(simulation.observation());
        summary.count(simulation.events());
        keep(simulation)?;
        if looked.elapsed() > PATIENCE {
            look(progress, simulation.progress())?;
            looked = Instant::now();
        }
    }
    look(progress, simulation.progress())
}

/// Lets Python handle signals and tells it how far the run is.
pub(crate) fn look(progress: Option<&Py<PyAny>>, share: f64) -> PyResult<()> {
    Python::attach(|py| {
        py.check_signals()?;
        progress.map_or(Ok(()), |tell| tell.call1(py, (share,)).map(drop))
    })
}

/// Labels of every axis that a channel uses.
fn labels<'py>(
    py: Python<'py>,
    channels: &[Channel],
    simulation: &Simulation,
) -> PyResult<Bound<'py, PyDict>> {
    let answer = PyDict::new(py);
    for axis in channels.iter().map(|channel| channel.axis()) {
        if let (Some(name), Some(labels)) = (axis.name(), record::labels(axis, simulation.system()))
        {
            if axis.is_numbered() {
                answer.set_item(name, labels.len())?;
            } else {
                answer.set_item(name, labels)?;
            }
        }
    }
    Ok(answer)
}

/// How the run came about and what it cost.
fn attributes<'py>(
    py: Python<'py>,
    simulation: &Simulation,
    summary: &Summary,
) -> PyResult<Bound<'py, PyDict>> {
    let answer = PyDict::new(py);
    let statistics = simulation.statistics();
    let (time, wall) = (simulation.time(), simulation.stepping_time());
    let link_steps = statistics.steps.max(1) as f64 * simulation.system().links() as f64;
    let method = simulation.method();
    answer.set_item("method", Stepping::from(method).name())?;
    match method {
        Method::Verlet { step } | Method::Rk4 { step } | Method::ImplicitDamping { step } => {
            answer.set_item("step", step)?;
        }
        Method::GeneralizedAlpha {
            step,
            spectral_radius,
        } => {
            answer.set_item("step", step)?;
            answer.set_item("spectral_radius", spectral_radius)?;
        }
        Method::DormandPrince {
            relative, max_step, ..
        } => {
            answer.set_item("relative_tolerance", relative)?;
            answer.set_item("max_step", max_step)?;
        }
    }
    if let Some(depth) = simulation.system().onset_depth() {
        answer.set_item("onset_depth", depth)?;
    }
    answer.set_item("steps", statistics.steps)?;
    answer.set_item("rejections", statistics.rejections)?;
    answer.set_item("error_rejections", statistics.error_rejections)?;
    answer.set_item("reductions", statistics.reductions)?;
    answer.set_item("evaluations", statistics.evaluations)?;
    answer.set_item("solves", statistics.solves)?;
    answer.set_item("newton_failures", statistics.newton_failures)?;
    answer.set_item("jumps", statistics.jumps)?;
    answer.set_item("smallest_step", statistics.smallest_step)?;
    answer.set_item("largest_step", statistics.largest_step)?;
    answer.set_item("samples", summary.samples)?;
    answer.set_item("time_reached", time)?;
    answer.set_item("energy_supplied", summary.energy_supplied())?;
    answer.set_item("energy_dissipated", summary.energy_dissipated())?;
    answer.set_item("energy_residual_largest", summary.residual)?;
    answer.set_item("contact_force_largest", summary.forces().max)?;
    answer.set_item("stepping_time", wall)?;
    answer.set_item("real_time_factor", time / wall)?;
    answer.set_item("ns_per_link_step", wall * 1e9 / link_steps)?;
    answer.set_item("summary", summary.report(simulation).to_string())?;
    Ok(answer)
}

/// Name, unit, dimension, description and whether a run records it by default, of every channel.
#[pyfunction]
pub(crate) fn channels(py: Python<'_>) -> PyResult<Bound<'_, PyList>> {
    PyList::new(
        py,
        Channel::ALL.iter().map(|channel| {
            (
                channel.name(),
                channel.unit(),
                channel.axis().name(),
                channel.description(),
                Channel::DEFAULT.contains(channel),
            )
        }),
    )
}

/// Names of the methods of time stepping.
#[pyfunction]
pub(crate) fn methods() -> Vec<&'static str> {
    Stepping::ALL.map(Stepping::name).to_vec()
}
