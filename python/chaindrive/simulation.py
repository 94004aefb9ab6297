"""Runs: a drive in, a labelled dataset out."""

from __future__ import annotations

import json
import warnings
from collections.abc import Callable, Iterable, Mapping
from contextlib import nullcontext
from os import PathLike, fspath
from typing import Any

import numpy as np
import xarray as xr

from chaindrive import _core
from chaindrive.channel import channels
from chaindrive.drive import Drive, _needed
from chaindrive.errors import (
    CautiousResultWarning,
    ClashWarning,
    DistrustedResultWarning,
    ParameterError,
    VerdictWarning,
    warn,
)
from chaindrive.extras import extra
from chaindrive.labelled import indexed, labelled
from chaindrive.page import show_verdicts
from chaindrive.progress import told
from chaindrive.settings import (
    ContactPlace,
    MethodName,
    Quantity,
    Recorded,
    RunSettings,
    Target,
)
from chaindrive.signals import heard

__all__ = ["resume", "simulate"]


def simulate(
    drive: Drive,
    *,
    until: Quantity | None = None,
    run_in: Quantity | None = None,
    every: Quantity | None = None,
    record: Recorded | Iterable[Recorded] | None = None,
    method: MethodName | None = None,
    step: Quantity | None = None,
    tolerance: Quantity | None = None,
    onset_depth: Quantity | None = None,
    accuracy: Quantity | None = None,
    accuracy_of: Target | None = None,
    events: ContactPlace | Iterable[ContactPlace] | None = None,
    output: str | PathLike[str] | None = None,
    overwrite: bool = False,
    checkpoint_every: Quantity | None = None,
    error: bool = True,
    progress: bool | Callable[[float], object] = False,
) -> xr.Dataset:
    """Simulate a drive and return what was recorded.

    The interpreter is free for other threads meanwhile, and Ctrl-C stops the run. A run with an
    `output` is stopped by SIGTERM and SIGHUP too: its result says so before they take effect.

    Parameters
    ----------
    drive
        The drive to simulate.
    until
        End of the run [s], or a text with a unit or a `pint.Quantity`, as all quantities here may
        be. This and the next nine come from the scene when absent.
    run_in
        Time simulated before t = 0, so that the record begins where the motion is steady: seconds
        [s], turns of a sprocket (``"5 turns"`` of the first one, ``"5 turns of camshaft"``), or
        ``"auto"``: until the tension of every span is steady, at most 32 circuits of the chain.
        Where neither this nor the scene says anything, closed chains that a motion drives and whose
        inputs repeat are run in by ``"auto"``; 0 begins at the start. Functions of time (ramps,
        tables over time, frequencies), open chains and starts from rest are not run in by default.
    every
        Interval between samples [s]. Samples are interpolated: more of them do not change the
        motion.
    record
        Names of channels, see `channels`; ``"all"`` for all that the chain has. Those of joints and
        of the direction of links belong to rigid links.
    method
        ``"verlet"``, ``"rk4"`` or ``"dormand-prince"``; the implicit methods
        ``"implicit-damping"`` and ``"generalized-alpha"`` are for rigid links and free rollers.
        ``"auto"`` takes implicit damping for them, and Verlet for particles.
    step
        Step of the fixed-step methods, longest step of the adaptive one [s]; chosen from the
        stiffest mode when neither the scene nor the caller gives it.
    tolerance
        Relative tolerance of the adaptive method [–].
    onset_depth
        Deepest penetration at which a contact may begin [m]: deeper steps are rejected and
        shortened. Absent: contacts begin wherever a step lands.
    accuracy
        Largest relative error of the tension [–], such as 0.01: method, step and onset depth are
        chosen for it by short trials at the beginning of the run, the same ones every time. 0.01
        when neither the scene nor the caller gives one of them or a tolerance. Not together with
        these.
    accuracy_of
        Quantity to which the accuracy applies: ``"tension"``, the default; ``"losses"``, and with
        them the efficiency; or ``"impacts"``, forces and impulses of rollers that come to a
        sprocket.
    events
        Contacts to log from touch to parting: of ``"teeth"``, ``"guides"``, ``"joints"``.
    output
        Zarr store to stream the recording into, ``"run.zarr"``; the name ends in ``.zarr``. It can
        be opened while the run goes on, see `open_result`; memory stays bounded, and the dataset
        returned reads from the store. Takes the extra ``zarr``.
    overwrite
        Whether an earlier result at `output` may be replaced; one that is being written may not.
    checkpoint_every
        Simulated time between two checkpoints in the store at `output` [s]: killed at any moment,
        the run goes on from the last one by `resume`. The samples are the same as without, to the
        last bit.
    error
        Whether the run ends with an estimate of its own numerical error. It takes the time of some
        40 000 steps of the default length, whatever the length of the run; more if its own steps
        are shorter.
    progress
        True for a bar with the time left, in a terminal or a notebook, which takes the extra
        ``progress``; or a function called with the share done, 0 to 1; while the drive is run in,
        with 0, or its method ``run_in``, if it has one, with the share of that.

    Returns
    -------
    xarray.Dataset
        One variable a channel, (time,) or (time, labels), with ``units`` and ``long_name``.
        Where there are several chains, rollers, links, joints and spans run over all of them in
        the order of the scene, and ``roller_chain``, ``link_chain``, ``joint_chain`` and
        ``span_chain`` name the chain of each: ``run.sel(span=run.span_chain == "primary")``.
        Contacts that were logged are ``event_kind``, ``event_body``, ``event_roller``,
        ``event_start``, ``event_end``, ``event_onset_speed``, ``event_peak_force`` and
        ``event_impulse``, (event,), in the order of their ends; what lasts comes last, with an
        infinite end. The
        attributes tell how it came about: ``scene`` (a text that reproduces the drive),
        ``chaindrive_version``, ``method``, ``step``, counts of steps, rejections and evaluations,
        ``energy_supplied``, ``energy_moved`` and ``energy_residual_largest`` [J],
        ``wall_time`` [s],
        ``real_time_factor``, ``ns_per_link_step``, and a ``summary`` to print.

        Where method and step were chosen, ``choice`` says which, why and how many were tried,
        ``accuracy_error`` what error was found [–], and ``accuracy_kept`` whether ``accuracy`` is
        ``"kept"`` or ``"not reached"``; ``accuracy_evaluations`` counts what the trials took.

        ``verdict`` says how far the result can be trusted: ``"trusted"``, ``"caution"`` or
        ``"distrusted"``; ``reasons`` names what speaks against it, with blanks between the names,
        and ``verdict_note`` says it in words.

        The numerical error is estimated from the beginning of the run, ``error_window`` [s] long,
        by the differences from runs with half and with a quarter of the step:
        ``error_span_tension`` and ``error_tight_span_tension`` of the waveform, root mean square
        over the mean tension [–]; ``error_span_tension_mean``, ``_rms``, ``_std``, ``_p1`` and
        ``_p99``, ``error_contact_force_p50``, ``_p90`` and ``_p99`` of the statistics [–];
        ``error_contact_force`` is the largest of the last three. Where no roller holds a span for
        some time, its tension is NaN, and link tensions are compared instead:
        ``error_link_tension`` and so on, and ``error_gap`` says why. ``spread_…`` is the difference
        of the same statistics between two equal runs that start 1e-12 m apart: an error that is not
        larger is chance. Such runs differ by 1 % at ``chaos_horizon`` [s]; none found, no
        attribute, and ``chaos_note`` says it in words. The span tensions of this run differ from
        the exact ones by 1 % at ``waveform_horizon`` [s], those of the links at
        ``waveform_horizon_link_tension`` [s]. Where that is before the end of the run, variables
        over time have an attribute ``waveform_horizon`` too, samples after it are for statistics
        only, and ``waveform_horizon_of`` names the variable on whose errors it was found.

    Raises
    ------
    SceneError
        A text that is not of the setting's dimension.
    ParameterError
        A setting out of range or a channel that does not exist.
    AssemblyError
        The drive does not close or settle.
    IntegrationError
        The step is unstable, or the motion ceases to be finite.
    WriteError
        The output exists or cannot be written.
    KeyboardInterrupt
        Ctrl-C. If the run had begun, its attribute `result` is the dataset as it would have been
        returned, with the samples so far and ``status`` ``"interrupted"``.

    Warns
    -----
    DistrustedResultWarning
        The result contradicts itself: its attribute ``verdict`` is ``"distrusted"``.
    CautiousResultWarning
        Its ``verdict`` is ``"caution"``; said to whoever has a filter for it, see there.
    ClashWarning
        Bodies are in each other's way, unless they pass side by side.

    Examples
    --------
    >>> import chaindrive as cd
    >>> run = cd.simulate(cd.scenes.spinning_ring(), until=2e-3, every=1e-3, record="link_tension")
    >>> run["link_tension"].shape
    (3, 20)
    """
    settings = _given(locals())
    _needed(drive)
    if output is not None:
        extra("zarr", "stores on disk")
    elif checkpoint_every is not None:
        message = "checkpoint_every: nothing is written; give `output`, a Zarr store"
        raise ParameterError(message, "checkpoint_every", "give `output`")
    # What is in memory only is lost with the program anyway.
    with told(progress, "run") as tell, nullcontext() if output is None else heard():
        result = _core.simulate(
            drive._inner,
            settings,
            output=None if output is None else fspath(output),
            overwrite=overwrite,
            checkpoint_every=checkpoint_every,
            error=error,
            progress=tell,
        )
    return _concluded(result, output)


def resume(
    path: str | PathLike[str],
    *,
    until: Quantity | None = None,
    progress: bool | Callable[[float], object] = False,
) -> xr.Dataset:
    """Carry on a run that was stopped or killed, or a complete one to a later end.

    Ctrl-C and SIGTERM leave a checkpoint in the result of a run, and runs with `checkpoint_every`
    leave them under way and at their end. What the result holds after its checkpoint is simulated
    again: in the end it is that of a run that was never stopped, to the last bit, but for the wall
    times.

    Parameters
    ----------
    path
        Zarr store of the run.
    until
        Another end than was asked for [s], not before the last sample.
    progress
        As in `simulate`.

    Returns
    -------
    xarray.Dataset
        As from `simulate`, read from the store.

    Raises
    ------
    ResumeError
        The run is complete, has no checkpoint, or one that is damaged, of another scene, or of
        another version of the program.
    ParameterError
        The end lies before the last sample.
    WriteError
        Another process writes the result, or it cannot be written.
    KeyboardInterrupt
        As from `simulate`; the run can be carried on again.

    Examples
    --------
    >>> import tempfile
    >>> import chaindrive as cd
    >>> path = tempfile.mkdtemp() + "/ring.zarr"
    >>> drive = cd.scenes.spinning_ring()
    >>> run = cd.simulate(drive, until=2e-3, every=1e-3, output=path, checkpoint_every=1e-3)
    >>> cd.resume(path, until=4e-3).sizes["time"]
    5
    """
    extra("zarr", "stores on disk")
    with told(progress, "run") as tell, heard():
        result = _core.resume(fspath(path), until=until, progress=tell)
    return _concluded(result, path)


def _given(arguments: Mapping[str, Any]) -> list[tuple[str, Any]]:
    """Return the settings of a run among the arguments of a function, as far as they are given."""
    given = ((key, arguments[key]) for key in RunSettings.__annotations__)
    return [
        (key, _listed(value) if key in ("record", "events") else value)
        for key, value in given
        if value is not None
    ]


def _concluded(result: Any, output: str | PathLike[str] | None) -> xr.Dataset:
    """Return what a run has left, or raise what stopped it."""
    if output is None:
        dataset = _dataset(result, json.loads(result["attributes"]))
    else:
        dataset = xr.open_zarr(fspath(output), chunks=None)
    stop: Any = result["stop"]
    if isinstance(stop, KeyboardInterrupt):
        # The very exception, for a class of its own would change the exit code of a script.
        vars(stop)["result"] = dataset
        reached = f"the run got to {dataset.attrs['time_reached']:.6g} s"
        stop.add_note(f"{reached}: `except KeyboardInterrupt as stop` finds it in `stop.result`")
    for clash in result["clashes"]:
        warn(clash, ClashWarning)
    if stop is not None:
        raise stop
    if result["warning"] is not None:
        warn(result["warning"], DistrustedResultWarning)
    if result["caution"] is not None and _cautions_are_asked_for():
        warn(result["caution"], CautiousResultWarning)
    return dataset


def _cautions_are_asked_for() -> bool:
    """Tell whether a filter speaks of cautions, and not of all warnings."""
    named = (category for _, _, category, _, _ in warnings.filters)
    return any(isinstance(it, type) and issubclass(it, VerdictWarning) for it in named)


def _dataset(result: Any, attributes: dict[str, Any]) -> xr.Dataset:
    known = channels()
    variables = {}
    for name, values in result["columns"].items():
        attribute, unit = result["units"][name]
        about: dict[str, Any] = {attribute: unit, "long_name": known[name].description}
        if name in result["waveform_horizons"]:
            at, found_on = result["waveform_horizons"][name]
            about |= {"waveform_horizon": at, "waveform_horizon_of": found_on}
        variables[name] = labelled(known[name].dims, values, about)
    for name, values, unit, text in result.get("events", []):
        about = {"long_name": text} if unit is None else {"units": unit, "long_name": text}
        values = np.asarray(values, dtype=np.str_) if isinstance(values, list) else values
        variables[name] = labelled(("event",), values, about)
    dimensions: dict[str, Any] = {
        dim: np.arange(labels) if isinstance(labels, int) else np.asarray(labels, dtype=np.str_)
        for dim, labels in result["labels"].items()
    }
    along = {
        name: labelled((dim,), np.asarray(chains, dtype=np.str_))
        for name, (dim, chains) in result["chains"].items()
    }
    coordinates = indexed(dimensions | {"time": result["time"]}, along)
    coordinates["time"].attrs.update({"units": "s", "long_name": "time"})
    show_verdicts()
    return xr.Dataset(variables, coords=coordinates, attrs=attributes)


def _listed(names: str | Iterable[str]) -> list[str]:
    return list(dict.fromkeys([names] if isinstance(names, str) else names))
