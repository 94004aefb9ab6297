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

#: Steps of central differences of two designs, as shares of half the range [–] (assumed: the effect
#: of what matters exceeds the noise of a run, and is still a straight line).
_STEPS = (0.2, 0.1)
#: Phases of the chain at the start of the two, after that of the drive [pitches]. What they differ
#: by is noise and bending.
_PHASES = (0.0, 0.37)
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
    """Half of what two designs differ by (features, p) [unit of the feature]."""
    covariance: _Floats
    """Covariance of the features (features, features)."""
    features: list[str]
    """Names of the features, ``flange mean``."""
    slopes: _Floats
    """As `jacobian`, of all features (features, p)."""
    scatter: _Floats
    """As `noise`, of all features (features, p)."""


def sensitivities(
    drive: Drive,
    run: xr.Dataset,
    how: Sequence[Reading],
    parameters: Sequence[FreeParameter],
    tell: Callable[[float], object] | None = None,
) -> Sensitivities:
    """Return how features move with parameters.

    ``∂y/∂θ ≈ (y(θ + h) − y(θ − h)) / 2h`` from runs that have all else in common: phase, start,
    method, step, run-in, sampling. Two designs, of two h and from two phases of the chain, give the
    noise; a feature counts only where the differences of all parameters are three times that.

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
    scene = [it for it in parameters if not it.is_of_sensor]
    points = _points(drive, run, scene, tell) if scene else {}
    columns, noises = [], []
    for it in parameters:
        if it.is_of_sensor:
            low, _, high = it.around(_STEPS[0])
            slopes = [_of_sensor(it, how, run, (low, high)) / (2.0 * _STEPS[0])]
        else:
            # ∂y/∂θ · (range/2) by central differences
            slopes = [
                (values_of(features_of(how, above)) - values_of(features_of(how, below)))
                / (2.0 * step)
                for step, (below, above) in zip(_STEPS, points[it.path], strict=False)
            ]
        columns.append(np.mean(slopes, axis=0))
        noises.append(np.std(slopes, axis=0))
    freed = [it.sensor for it in parameters if it.is_of_sensor]
    covariance = covariance_of(how, base, run, freed)
    jacobian, noise = np.stack(columns, axis=1), np.stack(noises, axis=1)
    quiet = noise <= _QUIET * np.sqrt(np.diag(covariance))[:, None]
    clear = ((np.abs(jacobian) > CLEAR * noise) | quiet).all(axis=1)
    return Sensitivities(
        np.where(clear[:, None], jacobian, 0.0),
        np.where(clear[:, None], noise, 0.0),
        covariance,
        [f"{it.channel} {it.name}" for it in base],
        jacobian,
        noise,
    )


def _of_sensor(
    it: FreeParameter, how: Sequence[Reading], run: xr.Dataset, ends: tuple[float, float]
) -> _Floats:
    """Return what a nuisance moves between two values: one run does, read by two sensors."""
    channel, name = it.sensor
    sensor = next((one.sensor for one in how if one.channel == channel), None)
    if sensor is None:
        return np.zeros(len(features_of(how, None)))
    below, above = (
        values_of(features_of(how, run, {channel: sensor.replace(**{name: at})})) for at in ends
    )
    return np.asarray(above - below)


def _points(
    drive: Drive,
    run: xr.Dataset,
    parameters: Sequence[FreeParameter],
    tell: Callable[[float], object] | None,
) -> dict[str, list[tuple[xr.Dataset, xr.Dataset]]]:
    """Return the runs below and above of every parameter, of every design."""
    middles = {it.path: it.around(_STEPS[0])[1] for it in parameters}
    rows: list[dict[str, float]] = []
    designs = starts(drive)
    for start, step in zip(designs, _STEPS, strict=False):
        for it in parameters:
            low, high = (middles[it.path] + sign * step * it.half_range for sign in (-1, 1))
            rows += [middles | start | {it.path: low}, middles | start | {it.path: high}]
    recorded: Any = [str(name) for name in run.data_vars if "time" in run[name].dims]
    found = sweep(
        drive,
        design={path: [row[path] for row in rows] for path in rows[0]},
        until=float(run.attrs["until"]),
        run_in=float(run.attrs.get("run_in", 0.0)),
        every=float(run.attrs["every"]),
        record=recorded,
        progress=tell if tell is not None else False,
        **settings_for(drive, run, rows),
    )
    failed = [str(it) for it in found["error"].to_numpy() if it]
    if failed:
        message = f"a variant within the bounds cannot be simulated: {failed[0]}"
        raise SimulationError(message, "free")
    runs = [as_run(found.isel(variant=row), run) for row in range(len(rows))]
    count = len(parameters)
    return {
        it.path: [
            (runs[2 * (design * count + n)], runs[2 * (design * count + n) + 1])
            for design in range(len(designs))
        ]
        for n, it in enumerate(parameters)
    }


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
