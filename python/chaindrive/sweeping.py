"""Sweeps: many variants of a drive at once, on all cores or on other machines."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import Executor
from contextlib import nullcontext
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from chaindrive import _core
from chaindrive.drive import Drive, _needed
from chaindrive.errors import DistrustedResultWarning, ParameterError, SimulationError, warn
from chaindrive.objects import place_of
from chaindrive.progress import told
from chaindrive.quantity import with_unit
from chaindrive.results import _open
from chaindrive.scene_values import scene_json
from chaindrive.settings import ContactPlace, MethodName, Quantity, Recorded, Target
from chaindrive.signals import heard
from chaindrive.simulation import _given, _listed
from chaindrive.sweep_tasks import begun, carry_out

if TYPE_CHECKING:
    from obstore.store import ObjectStore

__all__ = ["checked_workers", "sweep"]


def sweep(
    drive: Drive,
    vary: Mapping[str, Any] | None = None,
    *,
    design: Any = None,
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
    output: str | PathLike[str] | ObjectStore | None = None,
    overwrite: bool = False,
    jobs: int | None = None,
    executor: Executor | None = None,
    progress: bool | Callable[[float], object] = False,
) -> xr.Dataset:
    """Simulate variants of a drive's scene and stack the results.

    The variants are every combination of the values in `vary`, or the rows of the table `design`.

    Every variant is computed by one thread: the numbers do not depend on `jobs` or `executor`, to
    the last bit. They are those of `simulate` with the same method and step. Method and step are
    chosen for an accuracy as in `simulate`, but once for up to 32 variants that differ in numbers
    only: each takes the same multiple of its own time scale. ``method="auto"`` takes the default
    step instead, which is shorter than most drives need.

    The interpreter is free for other threads meanwhile, and Ctrl-C stops the sweep: what is
    finished is the `result` of the ``KeyboardInterrupt``.

    Parameters
    ----------
    drive
        The drive to vary.
    vary
        Values by dotted path, see `Drive.replace`; the last path varies fastest. Values are numbers
        in SI units, texts with units, or whatever else stands at the path: a list, an array
        such as ``numpy.linspace(10e3, 20e3, 11)``, or a single value.
    design
        A table instead: a row a variant, a column a path. A pandas ``DataFrame``, a structured
        array, a dict of equally long columns, or a pair of paths and samples (row, path) such as
        ``SALib`` and ``scipy.stats.qmc`` give them. Of the numbers of a column the least, the
        greatest and the first are tried in the scene before anything runs, of everything else
        each value; a row that is wrong in another way is a variant that fails.
    until
        End of the runs [s], or a text with a unit. This and the next come from the scene when
        absent.
    run_in
        Time simulated before t = 0 in every variant, as `simulate` takes it. Where neither this nor
        the scene says anything, closed chains whose inputs repeat are run in until they are steady.
    every
        Interval between samples [s], or a text with a unit. Statistics are those of the samples.
    record
        Names of channels to keep, see `channels`. None unless asked for: they take the memory of a
        run times the number of variants.
    accuracy
        Largest relative error of the tension [–], such as 0.01 or ``"1 %"``, by the trials of
        ``simulate(…, accuracy=…)`` on the first variant of each block. 0.01 when neither the scene
        nor the caller gives one, or a method, step, tolerance or onset depth. The same as
        ``run.accuracy`` in the scene.
    method, step, tolerance, onset_depth, accuracy_of, events
        As `simulate` takes them, for every variant; they go before what the scene says. Any of them
        may be varied instead, as ``run.method`` and so on.
    output
        Zarr store, a path that ends in ``.zarr``, for sweeps that outgrow the memory or the
        patience: takes the extra ``zarr``. Variants are computed in tasks of about a second, and
        whoever computes a task writes it, so that nothing but counts comes back. Where there is
        such a store of the same sweep already, the sweep goes on with what it lacks. An address
        such as ``"s3://bucket/name.zarr"``, or a store of the package ``obstore``, is a place in an
        object store; that takes the extra ``object-store``.
    overwrite
        Begin anew in place of the earlier result of this name.
    jobs
        Variants at a time; as many as there are cores when absent.
    executor
        Who computes instead of threads of this process: any `concurrent.futures.Executor`, such as
        a ``ProcessPoolExecutor``, or ``client.get_executor()`` of a Dask cluster. With `output`
        its workers must see the store under the same path.
    progress
        True for a bar with the time left, in a terminal or a notebook, which takes the extra
        ``progress``; or a function called with the share of variants done, 0 to 1.

    Returns
    -------
    xarray.Dataset
        Dimensions are those swept, named by the end of their paths, with coordinates in SI
        units; `path` in their attributes is the whole path. Of a table the dimension is
        ``variant``, and its columns are coordinates along it. With `output` the dataset is read
        from the store on demand. Variables:

        - statistics of each variant, such as ``span_tension_mean``, ``span_tension_half_width``
          (of the 95 % interval of the mean), ``span_tension_std``, ``span_tension_min``,
          ``span_tension_max`` (…, span), ``contact_force_p99``,
          ``contact_force_max``, ``link_tension_max`` [N], ``sprocket_power_mean`` [W],
          ``bearing_force_max`` [N] (…, sprocket), ``impact_force_p50``, ``impact_force_p99`` [N]
          (NaN below 100 impacts),
          ``impact_impulse`` [N s], ``impact_speed`` [m/s] (…, sprocket), see the summary of a run,
          ``energy_dissipated_total``, ``energy_residual_max`` [J],
          ``steps``; those of contacts by kind where the scene logs them; ``accuracy_error`` and
          ``accuracy_kept`` (1 or 0), found on one variant of the block, and ``step_chosen`` [s],
          where method and step were chosen. ``stepping_time`` and
          ``real_time_factor`` are measured, all others are the same with every sweep;
        - channels, (…, time) or (…, time, labels), NaN where a variant has fewer samples or labels
          than others;
        - ``verdict`` (…), a text: ``"trusted"``, ``"caution"`` or ``"distrusted"``, with the names
          of the ``reasons`` and a ``verdict_note`` in words, as the attributes of a run have them;
          no variant is better than ``"caution"``, since a sweep does not estimate errors;
        - ``chain_verdict`` (…), a text: ``"pass"``, ``"not judged"``, ``"warning"`` or ``"fail"``,
          with ``chain_reasons`` and a ``chain_verdict_note``: whether the chains may carry their
          loads;
        - ``error`` (…), a text: why a variant failed, empty when it did not. Its numbers are NaN
          and its verdict is empty.

        Attributes tell the ``scene`` that is varied, ``chaindrive_version``, ``method``, the number
        of ``variants`` and of those ``finished``, ``failed`` and ``distrusted``, ``status``
        (``"complete"``,
        ``"interrupted"``, or ``"failed"`` with the number of failed variants as ``failure``),
        ``wall_time`` [s] and a ``summary`` to print.

    Raises
    ------
    SceneError
        A path leads nowhere, or a value does not belong there; before anything runs.
    ParameterError
        Nothing is varied, a value stands twice, a channel does not exist; a value is varied that is
        given as an argument too, or that an accuracy chooses; columns of a table are not equally
        long.
    SimulationError
        The executor lost tasks, and no variant reached its end; with `output`, the executor lost a
        task. What is stored stays there, and the same call goes on with it.
    WriteError
        The output holds another sweep or another result, or cannot be written.
    KeyboardInterrupt
        Ctrl-C. Its attribute `result` is the dataset as it would have been returned, with the
        variants that were finished; ``error`` of the others says that they were not carried out.
        Of an executor the tasks count that have come back, or do within some seconds. With
        `output` the same call goes on.

    Warns
    -----
    DistrustedResultWarning
        The numbers of some variants contradict themselves; ``verdict`` says which.

    Examples
    --------
    >>> import chaindrive as cd
    >>> import numpy as np
    >>> ring = cd.scenes.spinning_ring()
    >>> result = cd.sweep(
    ...     ring,
    ...     {"chain.start.speed": np.linspace(300.0, 400.0, 3), "chain.mass": ["8 g", "9 g"]},
    ...     until=2e-3,
    ...     every=1e-3,
    ...     record="link_tension",
    ... )
    >>> result["link_tension"].dims
    ('speed', 'mass', 'time', 'link')
    >>> bool((result["error"] == "").all())
    True
    """
    settings = [(key, value) for key, value in _given(locals()) if key != "record"]
    _needed(drive)
    columns = _columns(vary, design)
    checked_workers(jobs, executor)
    varied = [(path, _values(values, path)) for path, values in columns.items()]
    asked = (_listed(() if record is None else record), design is not None, settings)
    core = _core.Sweep(drive._inner, varied, *asked)
    begin = time.perf_counter()
    place = None if output is None else place_of(output)
    # What is in memory only is lost with the program anyway.
    with (
        told(progress, "sweep") as tell,
        nullcontext() if place is None else heard(),
        begun(core, place, overwrite, jobs, executor) as coordinator,
    ):
        stop, lost = carry_out(coordinator, executor, jobs, tell)
        if stop is not None and not coordinator.is_public():
            stop.add_note(f"{place} holds the earlier result: of this sweep nothing was stored")
            raise stop
        result = coordinator.finish()
    if stop is not None and not isinstance(stop, KeyboardInterrupt):
        raise stop
    if place is None:
        dataset = _dataset(result)
        done = f"{result['finished']} of {len(core)} variants are done"
        note = f"{done}: `except KeyboardInterrupt as stop` finds them in `stop.result`"
    else:
        dataset = _open(place)
        done = f"{len(core) - result['open']} of {len(core)} variants"
        note = f"{place} holds {done}: the same call goes on"
    dataset.attrs["wall_time"] = time.perf_counter() - begin
    dataset.attrs["summary"] = result["summary"]
    if result["warning"]:
        warn(result["warning"], DistrustedResultWarning)
    if stop is not None:
        # The very exception, for a class of its own would change the exit code of a script.
        vars(stop)["result"] = dataset
        stop.add_note(note)
        raise stop
    if lost and (result["open"] or not result["finished"]):
        tasks = f"the executor lost {len(lost)} tasks, the first by {type(lost[0]).__name__}"
        message = f"{tasks}: {lost[0]}" + ("" if place is None else f"; {note}")
        raise SimulationError(message, "executor") from lost[0]
    return dataset


def checked_workers(jobs: int | None, executor: Executor | None) -> None:
    """Refuse a number of threads that is none, or that stands beside an executor.

    Raises
    ------
    ParameterError
        Names ``jobs``.
    """
    if executor is not None and jobs is not None:
        message = "`jobs` is for the threads of this process; the executor decides on its own"
        raise ParameterError(message, "jobs", "leave it out, or give it to the executor")
    if jobs is not None and jobs < 1:
        raise ParameterError(f"jobs = {jobs}, must be at least 1", "jobs", "at least 1")


def _columns(vary: Any, design: Any) -> dict[str, Any]:
    """Return values by path: those of a grid, or the columns of a table."""
    if (vary is None) == (design is None):
        message = "give values to be combined as `vary`, or a table of points as `design`"
        raise ParameterError(message, "design", "one of the two")
    if design is None:
        if not isinstance(vary, Mapping):
            raise TypeError(f"vary is a {type(vary).__name__}, needed is a dict of values by path")
        return dict(vary)
    if isinstance(design, tuple) and len(design) == 2:
        paths, samples = list(design[0]), np.asarray(design[1])
        if samples.ndim != 2 or samples.shape[1] != len(paths):
            message = f"design: samples of shape {samples.shape} for {len(paths)} paths"
            raise ParameterError(message, "design", f"samples of shape (rows, {len(paths)})")
        return dict(zip(paths, samples.T, strict=True))
    if isinstance(design, np.ndarray) and design.dtype.names is not None:
        return {path: design[path] for path in design.dtype.names}
    if isinstance(design, Mapping):
        return {path: _column(design[path]) for path in design}
    if hasattr(design, "columns"):
        return {path: design[path] for path in design.columns}
    message = f"design is a {type(design).__name__}, needed is a table with a column a path: "
    message += "a DataFrame, a structured array, a dict of columns, or a pair (paths, samples)"
    raise TypeError(message)


def _column(values: Any) -> Any:
    if isinstance(values, str | bytes | Mapping) or not isinstance(values, Iterable):
        message = f"design: a column is a list or an array of values, not {values!r}"
        raise ParameterError(message, "design", "a value for every row")
    return values


def _values(values: Any, path: str) -> tuple[str, ...]:
    """Return every value at a path as JSON."""
    values = with_unit(values)
    if isinstance(values, np.ndarray | np.generic | xr.DataArray):
        values = np.asarray(values).tolist()
    single = isinstance(values, str | bytes | Mapping) or not isinstance(values, Iterable)
    listed = [values] if single else values
    return tuple(scene_json(_counted(value), "vary", path) for value in listed)


def _counted(value: Any) -> Any:
    """Return a float that is a whole number as such: `numpy.linspace` may count teeth."""
    whole = isinstance(value, float | np.floating) and float(value).is_integer()
    # Minus zero has no whole number.
    return int(value) if whole and str(float(value)) != "-0.0" else value


def _dataset(result: Mapping[str, Any]) -> xr.Dataset:
    coordinates: dict[str, Any] = {}
    swept = result["dims"]
    for name, path, unit, values in result["swept"]:
        about = {"long_name": path, "path": path} | dict([] if unit is None else [unit])
        coordinates[name] = (swept if result["table"] else name, _labels(values), about)
    if result["table"]:
        rows = len(coordinates[result["swept"][0][0]][1])
        coordinates[swept[0]] = (swept[0], np.arange(rows))
    if result["time"] is not None:
        coordinates["time"] = ("time", result["time"], {"units": "s", "long_name": "time"})
    for name, values in result["labels"].items():
        coordinates[name] = (name, _labels(values))
    variables: dict[str, Any] = {}
    for name, dims, values, unit, text in result["quantities"]:
        variables[name] = (dims, values, dict([unit, ("long_name", text)]))
    shape = [len(coordinates[name][1]) for name in swept]
    for name, texts, text in result["texts"]:
        entries = np.asarray(texts, dtype=np.str_).reshape(shape)
        variables[name] = (swept, entries, {"long_name": text})
    return xr.Dataset(variables, coords=coordinates, attrs=json.loads(result["attributes"]))


def _labels(values: Any) -> Any:
    return np.asarray(values, dtype=np.str_) if isinstance(values, list) else values
