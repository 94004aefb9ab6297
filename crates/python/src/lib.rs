//! `chaindrive._core`: what Python sees of the simulator.
//!
//! Nothing here computes. Every function converts its arguments, calls the library and converts
//! the answer back; what users meet is the Python package around it.

#![expect(
    clippy::needless_pass_by_value,
    reason = "Python hands over its arguments; references to them cannot be extracted"
)]

mod cycles;
mod design;
mod drawing;
mod drive;
mod errors;
mod fmu;
mod friction;
mod kinematics;
mod lab;
mod law;
mod live;
mod new_file;
mod precision;
mod profile;
mod replay;
mod run;
mod signals;
mod sweep;
mod unit;

/// Blocks that begin where a cache line does: whole registers of states and contacts are then read at once, where the system's
/// allocator leaves it to chance (up to a tenth of a step).
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

/// The compiled core of the package; use `chaindrive` instead.
#[pyo3::pymodule(name = "_core")]
mod core {
    use std::cell::Cell;
    use std::ffi::OsString;

    use chaindrive::Origin;
    use pyo3::prelude::*;
    use pyo3::types::IntoPyDict;

    #[pymodule_export]
    use crate::cycles::rainflow;
    #[pymodule_export]
    use crate::design::{layout_around, layouts_of};
    #[pymodule_export]
    use crate::drawing::Figure;
    #[pymodule_export]
    use crate::drive::{Drive, catalogue, diff, presets, schema};
    #[pymodule_export]
    use crate::fmu::{fmu, fmu_library};
    #[pymodule_export]
    use crate::friction::Friction;
    #[pymodule_export]
    use crate::kinematics::{centre_distance_for, links_for, polygon_action};
    #[pymodule_export]
    use crate::lab::lab_page;
    #[pymodule_export]
    use crate::law::Law;
    #[pymodule_export]
    use crate::live::{Simulation, Snapshot, View, step_many};
    #[pymodule_export]
    use crate::new_file::NewFile;
    #[pymodule_export]
    use crate::precision::work_precision;
    #[pymodule_export]
    use crate::profile::{Profile, biarc};
    #[pymodule_export]
    use crate::replay::{replay, replay_selection};
    #[pymodule_export]
    use crate::run::{
        adaptive_methods, cell, channels, inspect, is_being_written, methods, one_line, plain,
        plain_json, resume, simulate, take_over,
    };

    #[pymodule_export]
    use crate::sweep::{Sweep, SweepCoordinator, SweepWorker};
    #[pymodule_export]
    use crate::unit::unit;

    #[pymodule_export]
    #[expect(non_upper_case_globals, reason = "the name that Python expects")]
    const __version__: &str = env!("CARGO_PKG_VERSION");

    /// The identity of the build, and the attributes that tell who computed a result.
    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        let build = chaindrive::Build::here();
        let Origin {
            build: id,
            instruction_set,
        } = Origin::here();
        let origin = [
            ("chaindrive_version", build.version),
            ("chaindrive_build", &id),
            ("chaindrive_profile", build.profile),
            ("instruction_set", &instruction_set),
        ];
        crate::errors::net_panics(module.py())?;
        module.add("__build__", &build.id)?;
        module.add("_origin", origin.into_py_dict(module.py())?)
    }

    /// Source, output, number of pictures, whether to overwrite and to be quiet, of the movie, report or diagram that a command line asks for.
    #[pyfunction]
    fn _drawn(arguments: Vec<OsString>) -> Option<(OsString, OsString, Option<usize>, bool, bool)> {
        let it = chaindrive_cli::drawn(arguments)?;
        Some((
            it.source.into(),
            it.output.into(),
            it.frames,
            it.overwrite,
            it.quiet,
        ))
    }

    /// Verb and options, as JSON, of what a command line asks about a measurement.
    #[pyfunction]
    fn _of_measurement(arguments: Vec<OsString>) -> Option<(&'static str, String)> {
        let (verb, options) = chaindrive_cli::of_measurement(arguments)?;
        Some((verb, options.to_string()))
    }

    /// Panics, so that tests see what becomes of it: here, or in a thread that the caller waits for.
    #[pyfunction]
    fn _panic(py: Python<'_>, elsewhere: bool) -> PyResult<()> {
        let fail = || -> () { panic!("as asked for") };
        if elsewhere {
            return crate::signals::patiently(py, "this is going to fail", fail);
        }
        fail();
        Ok(())
    }

    /// Runs the command line with its arguments, the program's name first; returns the exit code.
    #[pyfunction]
    fn _cli(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
        py.detach(|| {
            let asked = Cell::new(false);
            let interrupted = || {
                // A signal is reported once.
                asked.set(asked.get() || Python::attach(|py| py.check_signals().is_err()));
                asked.get()
            };
            chaindrive_cli::run(arguments, &interrupted)
        })
    }
}
