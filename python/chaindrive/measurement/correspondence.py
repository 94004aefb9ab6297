"""Which channel of a measurement is which quantity of a drive, and the shaft that both turn by."""

from __future__ import annotations

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from chaindrive.analysis.parts import sprockets
from chaindrive.analysis.signal import turning
from chaindrive.errors import MeasurementError
from chaindrive.measurement.quantities import MeasuredQuantity, guessed, quantity_of
from chaindrive.measurement.series import channel_names, sensor_of
from chaindrive.measurement.time_base import Finding

__all__ = ["correspondence", "other_speeds", "reference_shaft"]

#: Difference of two speeds that is told, over the greater one [–] (assumed): motors slip by less.
_APART = 0.05


def correspondence(data: xr.Dataset, run: xr.Dataset) -> dict[str, MeasuredQuantity]:
    """Return the quantity of every channel that has one: as said, or guessed by its name."""
    found = {}
    for name in channel_names(data):
        sensor = sensor_of(data, name)
        if sensor.quantity is not None:
            found[name] = quantity_of(sensor.quantity)
            continue
        guess = guessed(name, str(data[name].attrs["units"]), run)
        if guess is not None:
            found[name] = guess
    return found


def reference_shaft(run: xr.Dataset, data: xr.Dataset) -> str | None:
    """Return the first shaft of which the measurement knows the angle, and the run has one."""
    if "sprocket_angle" not in data:
        return None
    known = [str(it) for it in data["sprocket"].to_numpy()]
    ours = [
        str(it) for dim in ("sprocket", "shaft") if dim in run.coords for it in run[dim].to_numpy()
    ]
    for name in known:
        if name in ours:
            return name
    message = (
        f"the measurement knows how {', '.join(known)} turns, and the drive has {', '.join(ours)}"
    )
    raise MeasurementError(message, "turns", "name a sprocket or shaft of the drive")


def other_speeds(run: xr.Dataset, data: xr.Dataset) -> list[Finding]:
    """Return the sprockets that turn at another speed in the measurement than in the run.

    Unsteady speeds are left out: a run may be another part of a run-up.
    """
    if "sprocket_angle" not in run:
        return []
    found = []
    every = [it for name, it in data.data_vars.items() if str(name).startswith("sprocket_angle")]
    for angles in every:
        base = next(str(dim) for dim in angles.dims if str(dim).startswith("time"))
        for shaft in map(str, angles["sprocket"].to_numpy()):
            if shaft not in sprockets(run):
                continue
            ours = _speed(data[base].to_numpy(), angles.sel(sprocket=shaft).to_numpy())
            theirs = _speed(run["time"].to_numpy(), turning(run, shaft)[0])
            if abs(ours - theirs) > _APART * max(ours, theirs):
                speeds = [f"{it * 30.0 / np.pi:.4g} rpm" for it in (ours, theirs)]
                text = f"turns at {speeds[0]} in the record, and at {speeds[1]} in the drive"
                found.append(Finding("speed", shaft, text))
    return found


def _speed(time: NDArray[np.float64], angle: NDArray[np.float64]) -> float:
    """Return the speed of a shaft [rad/s]; NaN of one that is not steady, or not known."""
    known = np.isfinite(angle)
    if known.sum() < 3:
        return np.nan
    ends = [0, int(known.sum()) // 2, -1]
    first, last = np.abs(np.diff(angle[known][ends]) / np.diff(time[known][ends]))
    return float(first + last) / 2.0 if abs(first - last) <= _APART * max(first, last) else np.nan
