"""How features move with parameters: central differences with common random numbers."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from chaindrive.drive import Drive
from chaindrive.errors import IntegrationError, SceneError, SimulationError
from chaindrive.measurement.features import Reading, covariance_of, features_of, values_of
from chaindrive.measurement.free import FreeParameter
from chaindrive.simulation import simulate
from chaindrive.sweeping import sweep

__all__ = [
    "CLEAR",
    "Sensitivities",
    "as_run",
    "sensitivities",
    "settings_for",
    "starts",
]

_Floats = NDArray[np.float64]

#: Longest step of central differences, as a share of half the range [–] (assumed: the effect of
#: what matters exceeds the noise of a run), and the shortest: the numbers of a run are rough below.
_COARSE, _LEAST = 0.2, 0.01
#: Phases of the chain at the start of the designs, after that of the drive [pitches]; what they
#: differ by is noise and bending. Two, and the others where two leave it in doubt.
_PHASES = (0.0, 0.37, 0.74, 0.11, 0.48, 0.85, 0.22, 0.59)
#: Multiple of that noise from which a difference is taken [–] (assumed).
CLEAR = 3.0
#: Noise in standard errors of a feature below which it does not matter [–] (assumed).
_QUIET = 0.03
#: How often the step of the run is shortened for a variant that is stiffer.
_SHORTER = 8


class Sensitivities(NamedTuple):
    """How every feature moves with every parameter."""

    jacobian: _Floats
    """Change with half the range of a parameter (features, p) [unit of the feature]; zero in
    features in which that of any parameter does not stand out of its noise."""
    noise: _Floats
    """Half of what two designs differ by, and what bends over the step (features, p) [unit of the
    feature]."""
    covariance: _Floats
    """Covariance of the features (features, features)."""
    features: list[str]
    """Names of the features, ``flange mean``."""
    slopes: _Floats
    """As `jacobian`, of all features (features, p)."""
    scatter: _Floats
    """As `noise`, of all features (features, p)."""
    steps: _Floats
    """Steps that were taken, as shares of half the range (p,) [–]; NaN of sensors."""
    bending: _Floats
    """What slopes over the longest and the shorter step differ by, over their size (p,) [–]."""


class _Slopes(NamedTuple):
    """Change of the features with half the range of a parameter, by one step."""

    mean: _Floats
    """(features,)"""
    noise: _Floats
    """Half of what two designs differ by (features,)."""
    step: float


def sensitivities(
    drive: Drive,
    run: xr.Dataset,
    how: Sequence[Reading],
    parameters: Sequence[FreeParameter],
    tell: Callable[[float], object] | None = None,
) -> Sensitivities:
    """Return how features move with parameters.

    ``∂y/∂θ ≈ (y(θ + h) − y(θ − h)) / 2h`` from runs that have all else in common: start, method,
    step, run-in, sampling. Two designs, from two phases of the chain, give the noise; without a
    phase, h and 2 h do. First h is a fifth of half the range, then what moves the record by about
    one of its errors. Of the two each parameter takes the one whose slopes are known better: over
    the longer step they may bend, over the shorter one noise counts more. A feature counts only
    where the differences of all parameters are three times their noise.

    Parameters
    ----------
    drive
        The drive, as `open_to` returns it.
    run
        A run of it, whose method, step and run-in all others take.
    how
        Readings, see `readings`.
    parameters
        What is moved.
    tell
        Told the share that is done.

    Raises
    ------
    SimulationError
        A variant cannot be simulated.
    """
    base = features_of(how, None)
    freed = [it.sensor for it in parameters if it.is_of_sensor]
    covariance = covariance_of(how, base, run, freed)
    scene = [it for it in parameters if not it.is_of_sensor]

    def size(rows: _Floats) -> float:
        return _in_errors(rows, covariance)

    def part(share: float, before: float) -> None:
        if tell is not None:
            tell(before + 0.5 * share)

    # The ends of the longest steps are the stiffest; at which phase they start does not matter.
    middles = {it.path: it.around(_COARSE)[1] for it in scene}
    ends = [middles | {it.path: end} for it in scene for end in it.around(_COARSE)[::2]]
    settings = settings_for(drive, run, ends)
    coarse = dict.fromkeys((it.path for it in scene), _COARSE)
    long = _slopes(drive, run, how, scene, coarse, settings, lambda share: part(share, 0.0))
    steps = {
        path: min(max(1.0 / max(size(it.mean), 1e-9), _LEAST), 0.5 * _COARSE)
        for path, it in long.items()
    }
    short = _slopes(drive, run, how, scene, steps, settings, lambda share: part(share, 0.5))
    chosen, bending = [], []
    for it in parameters:
        if it.is_of_sensor:
            slope = _of_sensor(it, how, run, it.around(_COARSE)) / (2.0 * _COARSE)
            chosen.append(_Slopes(slope, np.zeros_like(slope), np.nan))
            bending.append(0.0)
            continue
        one, other = long[it.path], short[it.path]
        # Over the longer step slopes err by what they bend, too.
        bent = one._replace(noise=np.hypot(one.noise, one.mean - other.mean))
        chosen.append(min((bent, other), key=lambda it: size(it.noise)))
        bending.append(size(one.mean - other.mean) / max(size(other.mean), 1e-9))
    jacobian = np.stack([it.mean for it in chosen], axis=1)
    noise = np.stack([it.noise for it in chosen], axis=1)
    quiet = noise <= _QUIET * np.sqrt(np.diag(covariance))[:, None]
    clear = np.all((np.abs(jacobian) > CLEAR * noise) | quiet, axis=1)
    return Sensitivities(
        np.where(clear[:, None], jacobian, 0.0),
        np.where(clear[:, None], noise, 0.0),
        covariance,
        [f"{it.channel} {it.name}" for it in base],
        jacobian,
        noise,
        np.array([it.step for it in chosen]),
        np.array(bending),
    )


def _in_errors(rows: _Floats, covariance: _Floats) -> float:
    """Return the size of a change of features in standard errors of the record [–]."""
    own = np.diag(covariance)
    known = np.isfinite(own) & (own > 0.0) & np.isfinite(rows)
    if not known.any():
        return 0.0
    root = np.linalg.cholesky(covariance[np.ix_(known, known)])
    return float(np.linalg.norm(np.linalg.solve(root, rows[known])))


def _of_sensor(
    it: FreeParameter, how: Sequence[Reading], run: xr.Dataset, ends: tuple[float, float, float]
) -> _Floats:
    """Return what a nuisance moves between two values: one run does, read by two sensors."""
    channel, name = it.sensor
    sensor = next((one.sensor for one in how if one.channel == channel), None)
    if sensor is None:
        return np.zeros(len(features_of(how, None)))
    below, above = (
        values_of(features_of(how, run, {channel: sensor.replace(**{name: at})}))
        for at in (ends[0], ends[2])
    )
    return np.asarray(above - below)


def _slopes(
    drive: Drive,
    run: xr.Dataset,
    how: Sequence[Reading],
    parameters: Sequence[FreeParameter],
    steps: Mapping[str, float],
    settings: Mapping[str, Any],
    tell: Callable[[float], object],
) -> dict[str, _Slopes]:
    """Return the slopes of every parameter by one step each, of two designs."""
    if not parameters:
        return {}
    phases = starts(drive)[:2]
    designs = [(it, 1.0) for it in phases] if len(phases) > 1 else [({}, 1.0), ({}, 2.0)]
    middles = {it.path: it.around(_COARSE * designs[-1][1])[1] for it in parameters}
    rows: list[dict[str, float]] = []
    for start, factor in designs:
        for it in parameters:
            step = factor * steps[it.path] * it.half_range
            # Below, then above.
            rows += [middles | start | {it.path: middles[it.path] + by} for by in (-step, step)]
    recorded: Any = [str(name) for name in run.data_vars if "time" in run[name].dims]
    found = sweep(
        drive,
        design={path: [row[path] for row in rows] for path in rows[0]},
        until=float(run.attrs["until"]),
        run_in=float(run.attrs.get("run_in", 0.0)),
        every=float(run.attrs["every"]),
        record=recorded,
        progress=tell,
        **settings,
    )
    failed = [str(it) for it in found["error"].to_numpy() if it]
    if failed:
        message = f"a variant within the bounds cannot be simulated: {failed[0]}"
        raise SimulationError(message, "free")
    values = [
        values_of(features_of(how, as_run(found.isel(variant=row), run)))
        for row in range(len(rows))
    ]
    count = len(parameters)
    slopes = {}
    for n, it in enumerate(parameters):
        own = []
        for design, (_, factor) in enumerate(designs):
            at = 2 * (design * count + n)
            # ∂y/∂θ · (range/2) by central differences
            own.append((values[at + 1] - values[at]) / (2.0 * factor * steps[it.path]))
        slopes[it.path] = _Slopes(np.mean(own, axis=0), np.std(own, axis=0), steps[it.path])
    return slopes


def starts(drive: Drive) -> list[dict[str, float]]:
    """Return what the designs begin with; nothing where a chain has no phase: one design only."""
    route = drive.to_dict().get("route", {})
    if not isinstance(route, Mapping):
        return [{}]
    own = route.get("phase", 0.0)
    try:
        drive.replace({"route.phase": _PHASES[1]})
    except SceneError:
        return [{}]
    return [{"route.phase": (float(own) + it) % 1.0} for it in _PHASES]


def settings_for(
    drive: Drive, run: xr.Dataset, rows: Sequence[Mapping[str, Any]]
) -> dict[str, Any]:
    """Return method and step for all variants: those of the run, shorter where one is stiffer."""
    settings: dict[str, Any] = {"method": run.attrs["method"], "step": float(run.attrs["step"])}
    short: dict[str, Any] = {"until": 1e-4, "run_in": 0, "record": [], "error": False}
    for row in rows:
        for _ in range(_SHORTER):
            try:
                simulate(drive.replace(row), **short, **settings)
            except IntegrationError:
                settings["step"] *= 0.75
                continue
            break
    return settings


def as_run(variant: xr.Dataset, run: xr.Dataset) -> xr.Dataset:
    """Return a variant of a sweep as a run of its own."""
    kept = [name for name in variant.data_vars if name in run]
    return variant[kept].assign_attrs(run.attrs)
