"""What a calibrated drive foretells, at any operating point, with the band of all errors."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from os import PathLike
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from chaindrive.assumptions.outputs import OUTPUTS, Given
from chaindrive.assumptions.trials import Trials
from chaindrive.drive import Drive, load
from chaindrive.errors import MeasurementError, MeasurementWarning, SceneError, warn
from chaindrive.extras import extra
from chaindrive.measurement.amount import check_share, is_number
from chaindrive.measurement.evaluations import RunStore
from chaindrive.measurement.free import open_to, value_at
from chaindrive.measurement.sensitivities import CLEAR, settings_for, starts
from chaindrive.measurement.telling import as_text, number, texts
from chaindrive.progress import told
from chaindrive.settings import Quantity
from chaindrive.simulation import simulate

__all__ = ["predict"]

_Floats = NDArray[np.float64]

#: Phases of replicates [pitches]: they cover a pitch evenly.
_PHASES = (0.0, 0.2, 0.4, 0.6, 0.8)
#: Numerical error over what half the step changes [–]: twice, of a method of first order, and less
#: of any other.
_OF_HALF = 2.0
#: Share of the parameters' error that bending over it may have [–] (assumed): beyond, a band that
#: is drawn along a straight line says nothing.
_STRAIGHT = 0.5


class _Moved(NamedTuple):
    """What one standard error of a parameter moves."""

    slope: _Floats
    """By replicate (replicates, outputs)."""
    bend: _Floats
    """Half of what both sides move together (replicates, outputs)."""


def predict(
    calibrated: xr.Dataset,
    outputs: Given = OUTPUTS,
    *,
    at: Mapping[str, Any] | None = None,
    drive: Drive | None = None,
    reach: float = 3.0,
    telling: float = 0.2,
    phases: Sequence[float] = _PHASES,
    until: Quantity | None = None,
    run_in: Quantity | None = None,
    level: float | None = None,
    store: str | PathLike[str] | None = None,
    jobs: int | None = None,
    progress: bool | Callable[[float], object] = False,
) -> xr.Dataset:
    """Foretell outputs of a calibrated drive, here or at another operating point, with their bands.

    ``W = t √(u_θ² + u_run²) + b``: u_θ² = j R jᵀ of the fitted parameters, with j what one standard
    error of each moves and R their correlation; u_run the scatter of a run that starts at a phase
    nobody knows, ``s √(1 + 1/K)`` of K replicates; b the numerical error, twice what half the step
    changes, and the bending over an error. t is Student's. So a
    band is for one record as long as `until`. Method, step and run-in are chosen once and the same
    in all runs.

    Parameters
    ----------
    calibrated
        What `calibrate` returned, not refused.
    outputs
        What is foretold, as `tornado` takes it: ``"span_tension_mean[driven-driver]"``.
    at
        Values by path that are another operating point: speed, load, pretension.
    drive
        Another drive with the fitted parameters in it; the calibrated one when absent.
    reach
        Largest factor, up or down, between a number in `at`, within tables and lists too, and in
        the fit [–] (assumed), at least 1. Beyond it the prediction is refused: a fit says little of
        what is far away.
    telling
        Greatest half width over the value that is told as a prediction [–].
    phases
        Phases of the chain at the start [pitches], a replicate each; at least 2. A drive without
        one, such as that of several chains, is refused.
    until, run_in
        As in `simulate`. The length of the run is that of the record that is foretold.
    level
        Level of the bands [–]; that of the fit when absent.
    store
        Folder in which every variant is kept: the same call goes on there.
    jobs, progress
        As in `sweep`.

    Returns
    -------
    xarray.Dataset
        ``value``, ``half_width``, ``lower``, ``upper``, and the parts ``parameter_error``,
        ``run_error`` (standard), ``numerical``, ``bending`` (bounds) [unit of the output],
        ``freedom`` (of the errors), ``unit``, ``verdict`` (``"foretold"`` or ``"cannot tell"``),
        ``reason`` (output,); ``sensitivity`` to one standard error of each parameter [unit of the
        output] (output, parameter), and these, ``standard_error`` [SI] (parameter,). Attributes:
        ``reach`` in words, ``level``, ``until`` [s],
        ``method``, ``step`` [s], ``run_in`` [s], ``scene``, a ``summary`` to print and a ``page``.

    Raises
    ------
    MeasurementError
        The fit was refused, or misses the part of its record that was kept; an operating point is
        out of reach, or changes a fitted value, by whatever path; another drive lacks a fitted
        parameter; the drive has no phase. The reason is in the message.
    SimulationError
        A variant within the errors of the fit cannot be simulated.

    Warns
    -----
    MeasurementWarning
        Of an output nobody can tell: its band is wide, a straight line does not hold over the
        errors, or the numbers of the run contradict themselves.
    """
    scale, correlation, freedom, values = _fitted(calibrated)
    level = float(calibrated.attrs["level"]) if level is None else level
    _check(level, reach, telling, phases)
    changes = dict(at or {})
    base, words = _drive(calibrated, values, changes, drive, reach)
    if not any(starts(base)):
        message = "this drive has no route.phase to start from: one run tells no scatter"
        hint = "of several chains sweep the phases of each, such as chains[0].route.phase"
        raise MeasurementError(message, "phases", hint)
    given = {"until": until, "run_in": run_in}
    with told(progress, "predict") as tell:
        run = simulate(base, error=False, **given)  # type: ignore[arg-type]
        # Below and above the estimate by one error, of one parameter after the other.
        errors = dict(zip(values, scale, strict=True))
        ends = [{it: values[it] + side * errors[it]} for it in values for side in (-1.0, 1.0)]
        frozen = settings_for(base, run, ends) | {
            "until": float(run.attrs["until"]),
            "run_in": float(run.attrs.get("run_in", 0.0)),
        }
        count = 2 + len(ends)
        trials = Trials(base, outputs, phases, frozen, RunStore(store), jobs, tell, count)
        middle = trials.of(base, "the calibrated drive")
        finer = trials.of(base, "half the step", step=0.5 * frozen["step"])
        moved = []
        for n, path in enumerate(values):
            below, above = (
                trials.of(base.replace(it), f"{path} by one error")
                for it in ends[2 * n : 2 * n + 2]
            )
            moved.append(_Moved(0.5 * (above - below), 0.5 * (above + below) - middle))
    rows = _bands(middle, finer, moved, (correlation, freedom, level))
    size = np.abs(rows["value"])
    verdicts = _verdicts(rows, size, run, telling)
    found = xr.Dataset(
        {name: ("output", it) for name, it in rows.items() if name != "sensitivity"}
        | {
            "sensitivity": (("output", "parameter"), rows["sensitivity"]),
            "standard_error": ("parameter", scale),
            "unit": ("output", texts(trials.units)),
            "verdict": ("output", texts("cannot tell" if it else "foretold" for it in verdicts)),
            "reason": ("output", texts(verdicts)),
        },
        coords={
            "output": texts(it.name for it in trials.outputs),
            "parameter": texts(values),
        },
        attrs={
            "reach": words,
            "level": level,
            "phases": trials.phases,
            **{key: frozen[key] for key in ("method", "step", "until", "run_in")},
            "scene": base.text,
            "scene_name": base.name or "",
        },
    )
    section = _section(found)
    found.attrs |= {"summary": as_text([section]), "page": json.dumps({"sections": [section]})}
    lost = [f"{it.item()}: {why}" for it, why in zip(found["output"], verdicts, strict=True) if why]
    if lost:
        warn(f"cannot tell {'; '.join(lost)}", MeasurementWarning)
    return found


def _fitted(calibrated: xr.Dataset) -> tuple[_Floats, _Floats, _Floats, dict[str, float]]:
    """Return errors, correlation, degrees of freedom and values of what is of the scene."""
    if not isinstance(calibrated, xr.Dataset) or "covariance" not in calibrated:
        raise MeasurementError("this is no fit", "calibrated", "what chaindrive.calibrate returns")
    of = calibrated.attrs
    if of["verdict"] != "calibrated":
        why = "; ".join(of["reasons"])
        raise MeasurementError(f"a fit that was refused foretells nothing: {why}", "calibrated")
    if of.get("validation") == "misses":
        message = "the fit misses the part of its record that was kept, and foretells nothing"
        raise MeasurementError(message, "calibrated", "see kept_residual: physics may be missing")
    paths = [str(it) for it in calibrated["parameter"].to_numpy()]
    own = [n for n, path in enumerate(paths) if not path.startswith("sensors.")]
    covariance = calibrated["covariance"].to_numpy()[np.ix_(own, own)]
    scale = np.sqrt(np.diag(covariance))
    values = {paths[n]: float(calibrated["estimate"][n]) for n in own}
    return scale, covariance / np.outer(scale, scale), calibrated["freedom"].to_numpy()[own], values


def _check(level: float, reach: float, telling: float, phases: Sequence[float]) -> None:
    check_share(level, "level")
    for name, value, least in (("reach", reach, 1.0), ("telling", telling, 0.0)):
        if not (is_number(value) and value >= least):
            message = f"{name} = {value!r}, must be a finite number, at least {least:g}"
            raise MeasurementError(message, name)
    if len(phases) < 2:
        message = f"phases = {list(phases)}: one run tells no scatter"
        raise MeasurementError(message, "phases", "at least two")


def _drive(
    calibrated: xr.Dataset,
    values: Mapping[str, float],
    changes: Mapping[str, Any],
    other: Drive | None,
    reach: float,
) -> tuple[Drive, str]:
    """Return the drive at its operating point, and how far that is from the record, in words."""
    first = load(calibrated)
    try:
        base = first if other is None else open_to(other, values).replace(values)
        point = base.replace(changes) if changes else base
    except SceneError as error:
        raise MeasurementError(f"this drive cannot take it: {error}", "at") from error
    here, own, there = (it.resolved().to_dict() for it in (first, base, point))
    for path in values:
        # A path can be written in several ways, and be part of a table.
        if value_at(there, path) != value_at(own, path):
            message = f"at changes {path}: it is fitted, and a prediction takes what was found"
            raise MeasurementError(message, path, "leave it out, or simulate without a fit")
    words = []
    for path in changes:
        for place, old, new in _apart(value_at(here, path), value_at(there, path), path):
            if not (is_number(old) and is_number(new)):
                if _is_other(old, new):
                    message = f"at[{path!r}]: {new!r} is another model than the one that was fitted"
                    raise MeasurementError(message, place, "fit a record of that")
                words.append(f"{place} is another")
                continue
            ratio = new / old if old else math.inf
            times = max(abs(ratio), 1.0 / abs(ratio) if ratio else math.inf)
            if ratio < 0.0 or times > reach:
                message = (
                    f"at[{path!r}]: {place} = {new:.6g} is out of reach of a fit at {old:.6g}: "
                    f"it tells of what is up to {reach:g} times as much or as little"
                )
                raise MeasurementError(message, place, "fit a record of there, or raise `reach`")
            words.append(f"{place} is {ratio:.3g} times that of the record")
    return point, "; ".join(words) or "the operating point of the record"


def _apart(old: Any, new: Any, path: str) -> Iterator[tuple[str, Any, Any]]:
    """Find what differs between two values of a scene, each with its path, down to its numbers.

    Of lists of numbers, such as the speeds of a measured motion, those of the greatest size count.
    """
    if old == new:
        return
    if isinstance(old, Mapping) and isinstance(new, Mapping) and not _is_other(old, new):
        for key in {**old, **new}:
            yield from _apart(old.get(key), new.get(key), f"{path}.{key}")
    elif _are_numbers(old) and _are_numbers(new):
        yield path, max(old, key=abs), max(new, key=abs)
    elif isinstance(old, list) and isinstance(new, list) and not _is_other(old, new):
        for n, pair in enumerate(zip(old, new, strict=True)):
            yield from _apart(*pair, f"{path}[{n}]")
    else:
        yield path, old, new


def _is_other(old: Any, new: Any) -> bool:
    """Tell whether two values at a path are not of one kind."""

    def kind(it: Any) -> Any:
        if isinstance(it, Mapping):
            return it.get("kind")
        return len(it) if isinstance(it, list) else type(it)

    return bool(kind(old) != kind(new))


def _are_numbers(values: Any) -> bool:
    return isinstance(values, list) and bool(values) and all(map(is_number, values))


def _bands(
    middle: _Floats,
    finer: _Floats,
    moved: Sequence[_Moved],
    errors: tuple[_Floats, _Floats, float],
) -> dict[str, _Floats]:
    """Return bands with their parts, by output."""
    correlation, freedom, level = errors
    replicates = len(middle)
    outputs = middle.shape[1]
    slopes = np.array([it.slope.mean(axis=0) for it in moved]).reshape(len(moved), outputs)
    noises = np.array([it.slope.std(axis=0, ddof=1) for it in moved]).reshape(slopes.shape)
    bends = np.array([it.bend.mean(axis=0) for it in moved]).reshape(slopes.shape)
    rough = np.array([it.bend.std(axis=0, ddof=1) for it in moved]).reshape(slopes.shape)
    root = math.sqrt(replicates)
    # u_θ² = j R jᵀ, and what the noise of j adds
    variance = np.einsum("io,ij,jo->o", slopes, correlation, slopes)
    variance = variance + (noises**2).sum(axis=0) / replicates
    run = middle.std(axis=0, ddof=1) * math.sqrt(1.0 + 1.0 / replicates)
    # Bending counts where it is clear of its noise.
    clear = np.abs(bends) > CLEAR * rough / root
    bending = np.sqrt((np.where(clear, bends, 0.0) ** 2).sum(axis=0))
    numerical = _OF_HALF * np.abs((finer - middle).mean(axis=0))
    least = float(freedom.min()) if freedom.size else math.inf
    total = variance + run**2
    below = variance**2 / least + run**4 / (replicates - 1)
    found = np.divide(total**2, below, out=np.full(outputs, np.inf), where=below > 0.0)
    t = extra("scipy.stats", "intervals").t.ppf(0.5 + 0.5 * level, np.minimum(found, 1e9))
    value = middle.mean(axis=0)
    half_width = t * np.sqrt(total) + numerical + bending
    return {
        "value": value,
        "half_width": half_width,
        "lower": value - half_width,
        "upper": value + half_width,
        "parameter_error": np.sqrt(variance),
        "run_error": run,
        "numerical": numerical,
        "bending": bending,
        "freedom": found,
        "sensitivity": slopes.T,
    }


def _verdicts(
    rows: Mapping[str, _Floats], size: _Floats, run: xr.Dataset, telling: float
) -> list[str]:
    """Return why nobody can tell an output; empty where it is foretold."""
    found = []
    for n, value in enumerate(size):
        parameter, bending, half_width = (
            float(rows[name][n]) for name in ("parameter_error", "bending", "half_width")
        )
        why = ""
        if run.attrs.get("verdict") == "distrusted":
            why = f"the run contradicts itself: {run.attrs.get('verdict_note', '')}"
        elif not math.isfinite(half_width):
            why = "there is no number"
        elif bending > _STRAIGHT * parameter and bending > telling * 0.5 * value:
            why = "it bends over one error of the fit: a longer record, or tighter priors"
        elif half_width > telling * value:
            why = (
                f"the band is {100.0 * half_width / value:.3g} % of the value"
                if value
                else "it is 0"
            )
        found.append(why)
    return found


def _section(found: xr.Dataset) -> dict[str, Any]:
    names = (
        "value",
        "half_width",
        "parameter_error",
        "run_error",
        "numerical",
        "bending",
        "freedom",
    )
    rows = [
        [
            str(row["output"].item()),
            str(row["unit"].item()) or "–",
            *(number(float(row[name])) for name in names),
            row["verdict"].item() + (f": {row['reason'].item()}" if row["reason"].item() else ""),
        ]
        for row in (found.isel(output=n) for n in range(found.sizes["output"]))
    ]
    of = found.attrs
    return {
        "title": f"foretold: {of['scene_name'] or 'drive'}, a record of {of['until']:.4g} s",
        "columns": [
            *("output", "unit", "value", f"± band at {100 * of['level']:g} %", "u parameters"),
            *("u run", "numerical", "bending", "ν", "verdict"),
        ],
        "rows": rows,
        "sentences": [
            f"Reach: {of['reach']}.",
            f"All runs: {of['method']}, step {1e6 * of['step']:.3g} µs, run in for "
            f"{of['run_in']:.3g} s.",
        ],
    }
