"""Parameters of a drive from measurements: fitted, with intervals, or refused with a reason."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import replace
from numbers import Integral
from os import PathLike
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from chaindrive.drive import Drive, _needed
from chaindrive.errors import MeasurementError, MeasurementWarning, warn
from chaindrive.extras import extra
from chaindrive.measurement.amount import check_share, is_number
from chaindrive.measurement.evaluations import RunStore
from chaindrive.measurement.experiment import Experiment, begun
from chaindrive.measurement.fitting import Fit, Optimum, Worth, differs
from chaindrive.measurement.free import (
    FreeParameter,
    Opened,
    check_free,
    free_parameters,
    open_to,
    priors_of,
)
from chaindrive.measurement.likelihood import Sides, alike, reach_of, sides_of
from chaindrive.measurement.profiling import Profile, profiled
from chaindrive.measurement.provenance import fitted_drive
from chaindrive.measurement.series import channel_names
from chaindrive.measurement.telling import texts, told_calibration
from chaindrive.measurement.validating import Kept, validated
from chaindrive.measurement.valleys import searched
from chaindrive.progress import told
from chaindrive.settings import Quantity
from chaindrive.simulation import simulate
from chaindrive.sweeping import checked_workers

__all__ = ["calibrate", "fitted"]

_Floats = NDArray[np.float64]

#: Level of the tests for missing physics [–]: so often the right model is refused.
_LEVEL = 0.01
#: Share of half a range within which an estimate is at its bound [–].
_AT_BOUND = 2e-3
#: Difference of χ² below which two optima explain the record alike [–]: 95 % of one parameter.
_ALIKE = 3.84
#: How often a fit goes on from a deeper valley that a profile has met.
_VALLEYS = 3
_LOSSES = ("linear", "soft_l1", "huber", "cauchy", "arctan")


class Settled(NamedTuple):
    """A fit that has ended."""

    fit: Fit
    optima: list[Optimum]
    worth: Worth
    moved: _Floats
    """What another choice of method, step and run-in moves (p,) [SI]; zero for the same choice."""
    valleys: list[tuple[Optimum, Sides]]
    """The best optimum and those that explain the record alike, with what the record does not
    contradict around them; none of a robust loss."""


def calibrate(
    drive: Drive | Sequence[Drive],
    data: xr.Dataset | Sequence[xr.Dataset],
    free: Mapping[str, tuple[Any, Any]],
    *,
    priors: Mapping[str, tuple[Any, Any]] | None = None,
    loss: str = "linear",
    validation: float = 0.25,
    starts: int = 5,
    level: float = 0.95,
    profiles: bool | Iterable[str] = False,
    until: Quantity | None = None,
    shaft: str | None = None,
    store: str | PathLike[str] | None = None,
    jobs: int | None = None,
    executor: Executor | None = None,
    progress: bool | Callable[[float], object] = False,
) -> xr.Dataset:
    """Fit parameters of a drive to measurements, with intervals of all errors; or refuse.

    ``min Σ ρ(|L⁻¹ (y(θ) − y)|²)`` over bounded θ by SciPy's ``least_squares``, with the features y
    of the record: means and amplitudes of mesh orders; of channels without an angle means, standard
    deviations and percentiles. ``C = L Lᵀ`` holds the scatter of blocks, measured and simulated,
    the sensors' uncertainties, and the numerical error of the run as a bias that all samples share.
    Method, step, run-in, phase and sampling are chosen at the start and the same for all
    evaluations, so that differences are of the parameters alone; they are chosen anew at the
    optimum, and where that differs, there is one more fit.

    Parameters
    ----------
    drive
        The drive, as well as it is known; or a drive for each record.
    data
        What `measured` returned; or several records, whose parameters are shared.
    free
        Values to be found, by path as `Drive.replace` takes it, each with its lower and upper
        bound: numbers in SI or texts with a unit. ``sensors.CHANNEL.NUISANCE`` frees gain, bias,
        drift, delay, corner or integration of a sensor. Whole numbers cannot be freed.
    priors
        Mean and standard deviation of parameters that something else knows of, by path: numbers in
        SI or texts with a unit.
    loss
        ``"linear"``, or a robust loss of SciPy, ``"soft_l1"``, ``"huber"``, ``"cauchy"`` or
        ``"arctan"``, to which single features that contradict all others count less.
    validation
        Share of the end of each record that is not fitted, but held against the fit [–]; 0 for
        none.
    starts
        Starts over the ranges, at least 1: the best of the drive's own and of a Latin hypercube
        with twice as many points for each parameter of the scene; then other valleys that these
        runs foretell, unless the loss is robust. 1: the drive's own alone.
    level
        Level of the intervals [–].
    profiles
        True, or paths: these parameters are held at six places each while all others are fitted
        again, which gives intervals that need not be symmetric. Takes a few fits for each, and the
        loss ``"linear"``.
    until
        Length of the runs [s]; that of the fitted part, and at most a second, when absent.
    shaft
        Reference shaft, as in `compare`.
    store
        Folder in which every run is kept under the bits of its parameters: the same call goes on
        there, takes the same path and computes nothing twice. In memory when absent.
    jobs, executor
        Runs at a time, or who computes them, such as a ``ProcessPoolExecutor`` or a Dask cluster,
        as in `sweep`; the numbers do not depend on it.
    progress
        As in `sweep`; its share is a guess, for nobody knows how many steps a fit takes.

    Returns
    -------
    xarray.Dataset
        ``estimate``, ``error`` (standard), ``lower`` and ``upper`` (of the interval at `level`, by
        Student's t), ``freedom`` (of its error), ``start``, ``low``, ``high`` [SI] (parameter,);
        ``covariance`` [SI], ``correlation`` (parameter, parameter_2). ``measured``, ``simulated``,
        ``feature_error`` [unit of the feature] and ``residual`` (difference over its error)
        (feature,), and the same of the part that was kept, ``kept_measured`` and so on
        (kept_feature,). ``optimum`` (valley, parameter) [SI] with ``optimum_chi2`` (valley,).
        ``eigenvalue`` (direction,) of the information at the start, see `check_data`. With
        `profiles` ``profile_value`` [SI] and ``profile_chi2``, what χ² exceeds its least by [–]
        (parameter, profile_point), and ``profile_lower`` and ``profile_upper`` [SI] (parameter,),
        infinite where a bound comes before. Attributes:
        ``verdict``, ``"calibrated"`` or ``"refused"``, with the ``reasons`` in words; ``chi2``,
        ``dof``, ``p_value``, ``validation_p_value``; ``method``, ``step`` [s], ``run_in`` [s] of
        all evaluations; ``computed``, the number of runs that were not in the store; a ``summary``
        to print and a ``page``. Unless refused, ``scene`` is the drive with the fitted values, and
        says behind each where it is from: ``chaindrive.load(result)`` makes it a `Drive`. Of
        several drives it is the first one, and ``scenes`` has all.

    Raises
    ------
    MeasurementError
        A path of `free` leads nowhere or is a whole number, bounds are in the wrong order, or the
        record tells nothing of the drive.
    SimulationError
        A variant within the bounds cannot be simulated.

    Warns
    -----
    MeasurementWarning
        The fit is refused: parameters are not identifiable, which is told before anything is
        fitted; one ends at a bound; or what is left is more than errors explain, by a test of level
        1 %, and physics are missing.

    References
    ----------
    G. A. F. Seber and C. J. Wild, *Nonlinear Regression*, 1989, ch. 2 and 5.
    """
    drives, records = _listed(drive, data)
    _check(loss, validation, starts, level)
    checked_workers(jobs, executor)
    opened, parameters = _opened(drives, records, free)
    known = priors_of(priors or {}, opened)
    asked = _profiled(profiles, parameters, loss)
    keep = RunStore(store)
    how = (until, shaft, {"jobs": jobs, "executor": executor})
    experiments = [begun(*it, validation, keep, how) for it in opened]
    with told(progress, "fit") as tell:
        steps = _Steps(tell, 12 + starts)
        found, settled = fitted(experiments, parameters, (known, loss, steps), starts, level)
        if asked and settled is not None:
            found = found.assign(_profiles(settled, asked, found, level))
    found.attrs["computed"] = keep.computed
    reasons = found.attrs["reasons"]
    if settled is not None and not reasons:
        found.attrs |= _scenes(found, settled.fit, records, level)
    summary, page = told_calibration(found, records)
    found.attrs |= {"summary": summary, "page": page}
    if reasons:
        warn(f"the fit is refused: {'; '.join(reasons)}", MeasurementWarning)
    return found


def fitted(
    experiments: Sequence[Experiment],
    parameters: Sequence[FreeParameter],
    how: tuple[Mapping[str, tuple[float, float]], str, Callable[[], object]],
    starts: int,
    level: float,
) -> tuple[xr.Dataset, Settled | None]:
    """Return what `calibrate` says of experiments, in numbers, and the fit where there is one.

    Parameters
    ----------
    experiments
        Drives beside records, as `begun` returns them.
    parameters
        What is free in any of them.
    how
        Priors, loss, and what is called when a step is done.
    starts, level
        As in `calibrate`.
    """
    known, loss, steps = how
    fit = Fit(experiments, parameters, known, loss, steps)
    before = fit.begin()
    reasons = [f"{it.path} moves nothing that this record sees" for it in before.silent] + [
        f"not identifiable: {words} (scaled eigenvalue {value:.2g}, needed {least:.2g})"
        for value, least, words in before.combinations
    ]
    settled: Settled | None = None
    kept: Kept | None = None
    if before.is_identified:
        settled = _settled(fit, starts, level, how)
        reasons += _reasons(settled)
        kept = validated(settled.fit, settled.optima[0], settled.worth, _LEVEL)
    return _dataset(settled, fit, before.eigenvalues, kept, (reasons, level)), settled


class _Steps:
    """Tells how far a fit may be."""

    def __init__(self, tell: Callable[[float], object] | None, expected: int) -> None:
        self._tell, self._expected, self._done = tell, expected, 0

    def __call__(self) -> None:
        self._done += 1
        if self._tell is not None:
            self._tell(self._done / (self._done + self._expected))


def _listed(drive: Any, data: Any) -> tuple[list[Drive], list[xr.Dataset]]:
    records = [data] if isinstance(data, xr.Dataset) else list(data)
    drives = [drive] * len(records) if isinstance(drive, Drive) else list(drive)
    for it in drives:
        _needed(it)
    if not records or len(drives) != len(records):
        message = f"{len(drives)} drives for {len(records)} records"
        raise MeasurementError(message, "drive", "one drive, or one for each record")
    return drives, records


def _check(loss: str, validation: float, starts: int, level: float) -> None:
    check_share(level, "level")
    is_part = is_number(validation) and 0.0 <= validation < 0.9
    is_count = isinstance(starts, Integral) and starts >= 1
    bounds = (
        ("loss", loss, loss in _LOSSES, f"one of {', '.join(_LOSSES)}"),
        ("validation", validation, is_part, "a number in [0, 0.9)"),
        ("starts", starts, is_count, "a whole number, at least 1"),
    )
    for name, value, is_right, allowed in bounds:
        if not is_right:
            raise MeasurementError(f"{name} = {value!r}, must be {allowed}", name)


def _opened(
    drives: Sequence[Drive],
    records: Sequence[xr.Dataset],
    free: Mapping[str, tuple[Any, Any]],
) -> tuple[list[Opened], list[FreeParameter]]:
    """Return drives, open to what is freed in each, and the parameters that they share."""
    check_free(free)
    by_path: dict[str, FreeParameter] = {}
    found = []
    for drive, data in zip(drives, records, strict=True):
        own = _own(drive, data, free, records) if len(records) > 1 else free
        opened = open_to(drive, own)
        parameters = free_parameters(opened, data, own) if own or len(records) == 1 else []
        for it in parameters:
            by_path.setdefault(it.path, it)
        found.append((opened, data, parameters))
    lost = [path for path in free if path not in by_path]
    if lost:
        # The first record says what is wrong with it.
        free_parameters(drives[0], records[0], {path: free[path] for path in lost})
    return found, [by_path[path] for path in free]


def _own(
    drive: Drive,
    data: xr.Dataset,
    free: Mapping[str, tuple[Any, Any]],
    records: Sequence[xr.Dataset],
) -> dict[str, tuple[Any, Any]]:
    """Return what of several drives and records one drive and record knows."""
    channels = channel_names(data)
    elsewhere = {name for it in records for name in channel_names(it)} - set(channels)
    own = {}
    for path, bounds in free.items():
        channel = path.removeprefix("sensors.").rpartition(".")[0]
        if path.startswith("sensors.") and channel in elsewhere:
            continue
        try:
            free_parameters(open_to(drive, [path]), data, {path: bounds})
        except MeasurementError:
            continue
        own[path] = bounds
    return own


def _profiled(
    profiles: bool | Iterable[str], parameters: Sequence[FreeParameter], loss: str
) -> list[int]:
    """Return which parameters have a profile."""
    paths = [it.path for it in parameters]
    if isinstance(profiles, bool):
        wanted = paths if profiles else []
    else:
        wanted = [profiles] if isinstance(profiles, str) else list(profiles)
    for path in wanted:
        if path not in paths:
            message = f"profiles: {path!r} is not free"
            raise MeasurementError(message, path, f"free are {', '.join(paths)}")
    if wanted and loss != "linear":
        message = f"profiles: a fit with the loss {loss!r} has none"
        raise MeasurementError(message, "profiles", "loss='linear'")
    return [paths.index(path) for path in wanted]


def _settled(
    fit: Fit, starts: int, level: float, how: tuple[Any, str, Callable[[], object]]
) -> Settled:
    """Fit; choose anew what was frozen; where that differs, fit once more."""
    known, loss, steps = how
    optima = fit.optima(starts)
    if starts > 1 and loss == "linear":
        optima = searched(fit, optima)
    again = [_anew(it, fit, optima[0]) for it in fit.experiments]
    moved = np.zeros(len(fit.parameters))
    if any(new is not old for new, old in zip(again, fit.experiments, strict=True)):
        other = Fit(again, fit.parameters, known, loss, steps)
        other.designs, other.steps = fit.designs, fit.steps
        last = other.optimum(optima[0].x, is_near=True)
        moved = last.x - optima[0].x
        fit, optima = other, [last, *optima[1:]]
    worth = fit.worth(optima[0])
    if loss != "linear":
        # Of a robust loss χ² is no likelihood.
        return Settled(fit, optima, worth, moved, [])
    t = _student(level, worth.freedom)
    sides = sides_of(fit, optima[0], worth.covariance, t)
    for _ in range(_VALLEYS):
        if sides.better is None:
            break
        deeper = fit.optimum(sides.better, is_near=True)
        if deeper.cost >= optima[0].cost:
            break
        optima = [deeper, *optima]
        worth = fit.worth(deeper)
        t = _student(level, worth.freedom)
        sides = sides_of(fit, deeper, worth.covariance, t)
    best = (optima[0], sides)
    return Settled(fit, optima, worth, moved, [best, *alike(fit, optima[1:], best, t)])


def _student(level: float, freedom: _Floats) -> _Floats:
    t = extra("scipy.stats", "intervals").t.ppf(0.5 + 0.5 * level, np.minimum(freedom, 1e9))
    return np.asarray(t, dtype=np.float64)


def _anew(experiment: Experiment, fit: Fit, best: Optimum) -> Experiment:
    """Return an experiment with method, step and run-in as a run of the optimum chooses them."""
    paths = {it.path for it in experiment.parameters if not it.is_of_sensor}
    values = {
        it.path: float(x) for it, x in zip(fit.parameters, best.x, strict=True) if it.path in paths
    }
    old = experiment.evaluations
    drive = experiment.drive.replace(values)
    of = [
        *("anew", drive.resolved().text, old.settings["until"], old.settings["every"]),
        old.settings["record"],
    ]
    settings: Any = {name: old.settings[name] for name in ("until", "every", "record")}
    run = old.store.kept(of, lambda: simulate(drive, **settings))
    if not differs(experiment.run.attrs, run.attrs):
        return experiment
    return replace(experiment, run=run, evaluations=old.beside(run))


def _reasons(settled: Settled) -> list[str]:
    """Return why a fit is refused, in words; none where it stands."""
    fit, best, worth = settled.fit, settled.optima[0], settled.worth
    found = []
    for it, value in zip(fit.parameters, best.x, strict=True):
        for bound, which in ((it.low, "lower"), (it.high, "upper")):
            if abs(value - bound) < _AT_BOUND * it.half_range:
                found.append(
                    f"{it.path} ends at its {which} bound, {bound:.6g}: widen it, or ask what "
                    "else is wrong"
                )
    if worth.p_value < _LEVEL:
        size = np.abs(worth.residual) / np.sqrt(np.diag(fit.errors.covariance))
        largest = np.argsort(np.where(fit.known, size, -1.0))[::-1][:3]
        where = ", ".join(f"{fit.errors.names[n]} ({size[n]:.1f} errors)" for n in largest)
        found.append(
            f"physics are missing: χ² is {worth.chi2:.3g} of {worth.dof} degrees of freedom, "
            f"chance {worth.p_value:.2g}; most is left in {where}"
        )
    return found


def _dataset(
    settled: Settled | None,
    before: Fit,
    eigenvalues: _Floats,
    kept: Kept | None,
    said: tuple[list[str], float],
) -> xr.Dataset:
    reasons, level = said
    fit = before if settled is None else settled.fit
    parameters, errors = fit.parameters, fit.errors
    count = len(parameters)
    nan = np.full(count, math.nan)
    one, two = ("parameter",), ("parameter", "parameter_2")
    estimate, covariance, freedom = nan, np.full((count, count), math.nan), nan
    residual = np.full(len(errors.names), math.nan)
    attributes: dict[str, Any] = {
        "verdict": "refused" if reasons else "calibrated",
        "reasons": reasons,
        "level": level,
        **{key: fit.experiments[0].evaluations.settings[key] for key in ("method", "step")},
        "run_in": fit.experiments[0].evaluations.settings["run_in"],
        "designs": fit.designs,
    }
    variables: dict[str, Any] = {}
    if settled is not None:
        worth, moved = settled.worth, settled.moved
        estimate, freedom = settled.optima[0].x, worth.freedom
        # What another choice of method moves is an error of the method.
        covariance = worth.covariance * np.outer(fit.half, fit.half) + np.outer(moved, moved)
        residual = worth.residual
        attributes |= {
            "chi2": worth.chi2,
            "dof": worth.dof,
            "p_value": worth.p_value,
            "chosen_anew": int(bool(np.any(moved))),
        }
        chi2 = [2.0 * it.cost for it in settled.optima]
        attributes["alike"] = sum(it < chi2[0] + _ALIKE for it in chi2)
        variables |= {
            "optimum": (("valley", "parameter"), np.stack([it.x for it in settled.optima])),
            "optimum_chi2": ("valley", chi2, {"units": "1"}),
        }
    t = _student(level, freedom)
    below, above = nan, nan
    if settled is not None:
        below, above = reach_of(settled.fit, settled.valleys, settled.moved, covariance, t)
    error = np.maximum(below, above) / t
    # Where an interval is wider than that of a straight drive, so is what follows from it.
    wider = error / np.sqrt(np.diag(covariance))
    covariance = covariance * np.outer(wider, wider)
    deviation = np.sqrt(np.diag(errors.covariance))
    variables |= {
        "estimate": (one, estimate),
        "error": (one, error),
        "lower": (one, estimate - below),
        "upper": (one, estimate + above),
        "freedom": (one, freedom, {"units": "1"}),
        "start": (one, [it.start for it in parameters]),
        "low": (one, [it.low for it in parameters]),
        "high": (one, [it.high for it in parameters]),
        "covariance": (two, covariance),
        "correlation": (two, covariance / np.outer(error, error), {"units": "1"}),
        "measured": ("feature", errors.values),
        "simulated": ("feature", errors.values + residual),
        "feature_error": ("feature", deviation),
        "residual": ("feature", residual / deviation, {"units": "1"}),
        "eigenvalue": ("direction", eigenvalues, {"units": "1"}),
    }
    coordinates: dict[str, Any] = {
        "parameter": texts(it.path for it in parameters),
        "parameter_2": texts(it.path for it in parameters),
        "feature": texts(errors.names),
    }
    if kept is not None:
        attributes["validation_p_value"] = kept.p_value
        attributes["validation"] = kept.verdict
        variables |= {
            "kept_measured": ("kept_feature", kept.measured),
            "kept_simulated": ("kept_feature", kept.simulated),
            "kept_error": ("kept_feature", kept.error),
            "kept_residual": ("kept_feature", (kept.simulated - kept.measured) / kept.error),
        }
        coordinates["kept_feature"] = texts(kept.names)
    return xr.Dataset(variables, coords=coordinates, attrs=attributes)


def _profiles(
    settled: Settled, asked: Sequence[int], found: xr.Dataset, level: float
) -> dict[str, Any]:
    """Return profiles as variables of the result; none of parameters that were not asked for."""
    made: dict[int, Profile] = {}
    t = extra("scipy.stats", "intervals").t
    for n in asked:
        freedom = min(float(settled.worth.freedom[n]), 1e9)
        error = float(found["error"][n])
        own = float(t.ppf(0.5 + 0.5 * level, freedom))
        made[n] = profiled(settled.fit, settled.optima[0], n, error, own)
    points = max(it.values.size for it in made.values())
    table = np.full((2, found.sizes["parameter"], points), math.nan)
    ends = np.full((2, found.sizes["parameter"]), math.nan)
    for n, it in made.items():
        table[:, n] = it.values, it.chi2
        ends[:, n] = it.lower, it.upper
    two = ("parameter", "profile_point")
    return {
        "profile_value": (two, table[0]),
        "profile_chi2": (two, table[1], {"units": "1"}),
        "profile_lower": ("parameter", ends[0]),
        "profile_upper": ("parameter", ends[1]),
    }


def _scenes(
    found: xr.Dataset, fit: Fit, records: Sequence[xr.Dataset], level: float
) -> dict[str, Any]:
    """Return the fitted drives as attributes: texts that say where each number is from."""
    sources = ", ".join(dict.fromkeys(str(it.attrs["measured_from"]) for it in records))
    # The name of a file is of another's making, and a comment has one line.
    sources = " ".join(sources.split())
    scenes = []
    for experiment in fit.experiments:
        values, notes = {}, {}
        for it in experiment.parameters:
            if it.is_of_sensor:
                continue
            row = found.sel(parameter=it.path)
            values[it.path] = float(row["estimate"])
            width = 0.5 * float(row["upper"] - row["lower"])
            notes[it.path] = f"fitted: ± {width:.3g} at {100 * level:g} %, to {sources}"
        drive = fitted_drive(experiment.drive, values, notes) if values else experiment.drive
        scenes.append(drive)
    return {
        "scene": scenes[0].text,
        "scene_name": scenes[0].name,
        "scenes": json.dumps([it.text for it in scenes]),
    }
