"""One drive beside one record, as a fit looks at it: features, their errors, a part kept back."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from chaindrive import _core
from chaindrive.analysis.parts import sprockets
from chaindrive.drive import Drive
from chaindrive.errors import MeasurementError
from chaindrive.measurement.checking import run_for
from chaindrive.measurement.correspondence import correspondence, other_speeds, reference_shaft
from chaindrive.measurement.evaluations import Evaluations, RunStore
from chaindrive.measurement.features import (
    Feature,
    Reading,
    covariance_of,
    features_of,
    numerical_factor,
    readings,
    values_of,
)
from chaindrive.measurement.free import FreeParameter
from chaindrive.measurement.sensitivities import settings_for, starts
from chaindrive.measurement.series import channel_names, sensor_of
from chaindrive.settings import Quantity

__all__ = ["Errors", "Experiment", "begun", "parted"]

_Floats = NDArray[np.float64]

#: Samples of a channel that a part of a record has at least [–].
_LEAST = 8


class Errors(NamedTuple):
    """Features of a measurement with all their errors."""

    names: list[str]
    values: _Floats
    """(features,) [unit of the feature]"""
    covariance: _Floats
    """Of all errors (features, features)."""
    numerical: _Floats
    """Numerical bias (features, biases), which the covariance holds."""
    statistical: _Floats
    """Standard errors of blocks, measured and simulated (features,)."""
    freedom: _Floats
    """Degrees of freedom of these (features,)."""


@dataclass(frozen=True)
class Experiment:
    """One drive and one record."""

    drive: Drive
    data: xr.Dataset
    parameters: list[FreeParameter]
    """Those of the fit that mean something here."""
    run: xr.Dataset
    how: list[Reading]
    kept: list[Reading]
    """The part for validation; empty for none."""
    evaluations: Evaluations
    designs: list[dict[str, float]]
    """Phases of replicated designs."""

    def row(self, x: Mapping[str, float], design: int = 0) -> dict[str, float]:
        """Return the values by path that a run takes."""
        own = {it.path: x[it.path] for it in self.parameters if not it.is_of_sensor}
        return own | self.designs[design]

    def simulated(self, run: xr.Dataset, x: Mapping[str, float], kept: bool = False) -> _Floats:
        """Return the features of a run as the sensors of a parameter vector read it."""
        how = self.kept if kept else self.how
        changes: dict[str, dict[str, float]] = {}
        for it in self.parameters:
            if it.is_of_sensor:
                channel, name = it.sensor
                changes.setdefault(channel, {})[name] = x[it.path]
        sensors = {
            it.channel: it.sensor.replace(**changes[it.channel])
            for it in how
            if it.channel in changes
        }
        return values_of(_telling(features_of(how, run, sensors)))

    def errors(self, run: xr.Dataset, kept: bool = False) -> Errors:
        """Return the features of the measurement, with the errors beside a run."""
        how = self.kept if kept else self.how
        measured, simulated = features_of(how, None), features_of(how, run)
        freed = [it.sensor for it in self.parameters if it.is_of_sensor]
        covariance = covariance_of(how, measured, run, freed)
        numerical = numerical_factor(how, measured, run)
        told = _telling(measured)
        among = [n for n, it in enumerate(measured) if it in told]
        pairs = [(measured[n].estimate, simulated[n].estimate) for n in among]
        variance = [one.error**2 + other.error**2 for one, other in pairs]
        below = [
            one.error**4 / max(one.freedom, 1) + other.error**4 / max(other.freedom, 1)
            for one, other in pairs
        ]
        freedom = [v * v / b if b > 0.0 else np.inf for v, b in zip(variance, below, strict=True)]
        return Errors(
            [f"{it.channel} {it.name}" for it in told],
            values_of(told),
            covariance[np.ix_(among, among)],
            numerical[among],
            np.sqrt(variance),
            np.array(freedom),
        )


def _telling(found: Sequence[Feature]) -> list[Feature]:
    """Return the features that a fit may take.

    Noise of a sensor widens scatter and percentiles, which then say nothing of the drive: where
    orders tell how a channel moves, they are taken in their place.
    """
    ordered = {it.channel for it in found if it.name.startswith("order")}
    return [
        it
        for it in found
        if it.channel not in ordered or it.name == "mean" or it.name.startswith("order")
    ]


def parted(data: xr.Dataset, share: float) -> tuple[xr.Dataset, xr.Dataset | None]:
    """Return the part of a measurement that is fitted, and the last one, which is kept."""
    if share == 0.0:
        return data, None
    bases = [str(dim) for dim in data.dims if str(dim).startswith("time")]
    end = max(float(data[base][-1]) for base in bases)
    at = {base: int(np.searchsorted(data[base], end * (1.0 - share))) for base in bases}
    first = data.isel({base: slice(None, cut) for base, cut in at.items()})
    return first, data.isel({base: slice(cut, None) for base, cut in at.items()})


def _check_parts(parts: Mapping[str, xr.Dataset], names: Sequence[str]) -> None:
    """Refuse a channel of which a part of the record has next to nothing: not all end together."""
    for what, part in parts.items():
        for name in names:
            count = int(np.isfinite(part[name]).sum())
            if count < _LEAST:
                message = f"{name} has {count} samples with a value in what is {what}"
                hint = f"at least {_LEAST}: cut the record by `until`, or take another `validation`"
                raise MeasurementError(message, name, hint)


def begun(
    drive: Drive,
    data: xr.Dataset,
    parameters: Sequence[FreeParameter],
    share: float,
    store: RunStore,
    how: tuple[Quantity | None, str | None, Mapping[str, Any]],
) -> Experiment:
    """Return an experiment, with everything that is chosen automatically chosen and frozen.

    Parameters
    ----------
    drive
        The drive as it stands, as `open_to` returns it.
    data
        What `measured` returned.
    parameters
        What is freed in it.
    share
        Share of the record that is kept for validation [–].
    store
        Where runs are kept.
    how
        Length of the runs [s], reference shaft, ``jobs`` and ``executor`` as `sweep` takes them.
    """
    until, shaft, workers = how
    fitted, kept = parted(data, share)
    length = None if until is None else str(until)
    channels = [(name, dict(fitted[name].attrs)) for name in channel_names(data)]
    spans = {
        str(dim): [float(it) for it in fitted[dim].to_numpy()[[0, -1] if size else []]]
        for dim, size in fitted.sizes.items()
        if str(dim).startswith("time")
    }
    of = [_core.__build__, drive.resolved().text, length, repr(channels), spans]
    run = store.kept(of, lambda: run_for(drive, fitted, until)[0])
    apart = other_speeds(run, fitted)
    if apart and not any(".motion" in it.path for it in parameters):
        message = f"{apart[0]}: a fit would look for it in other parameters"
        raise MeasurementError(
            message, "drive", "set the speed of the drive, free it, or mend `turns`"
        )
    pairs = correspondence(data, run)
    shaft = shaft or reference_shaft(run, data)
    wheels = sprockets(run)
    teeth = float(wheels[shaft].teeth) if shaft in wheels else None
    sensors = {name: sensor_of(data, name) for name in channel_names(data)}
    names = [it for it in pairs if not (pairs[it].is_relative or sensors[it].relative)]
    rest = {} if kept is None else {"kept for validation": kept}
    _check_parts({"fitted": fitted} | rest, names)
    reads = readings(fitted, run, pairs, sensors, shaft, teeth)
    if not reads:
        message = "no channel has an amplitude that a drive knows: nothing can be fitted"
        raise MeasurementError(message, "data")
    looks = [] if kept is None else readings(kept, run, pairs, sensors, shaft, teeth)
    scene = [it for it in parameters if not it.is_of_sensor]
    middle = {it.path: it.around(0.0)[1] for it in scene}
    ends = [middle | {it.path: end} for it in scene for end in (it.low, it.high)]
    settings = settings_for(drive, run, ends)
    evaluations = Evaluations(drive, run, settings, store, workers)
    return Experiment(drive, data, list(parameters), run, reads, looks, evaluations, starts(drive))
