"""A channel of a run as a uniform signal over time, and the turning of a shaft beside it."""

from __future__ import annotations

from typing import Any, TypeVar

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from chaindrive.errors import ParameterError

__all__ = [
    "finite",
    "label",
    "late",
    "recorded",
    "require",
    "sample_rate",
    "signal",
    "turning",
]

_Timed = TypeVar("_Timed", xr.Dataset, xr.DataArray)


_NAMED = ("chain", "span", "sprocket", "shaft", "guide", "tensioner", "link", "roller", "joint")


def recorded(run: xr.Dataset, *channels: str) -> None:
    """Raise unless all of these channels were recorded."""
    missing = [name for name in channels if name not in run]
    if missing:
        asked = ", ".join(repr(name) for name in missing)
        raise ParameterError(
            f"{', '.join(missing)} not in the run: simulate(…, record=[…, {asked}])", missing[0]
        )


def require(run: xr.Dataset, part: str) -> None:
    """Raise where the drive of a run has no such parts: ``"span"``, ``"sprocket"``.

    That is another matter than a channel that was not recorded.
    """
    if run.sizes.get(part, 1) == 0:
        raise ParameterError(f"this drive has no {part}s", part)


def signal(run: xr.Dataset, channel: str | xr.DataArray, at: dict[str, Any]) -> xr.DataArray:
    """Return a channel at the labels asked for, (…, time), or a signal over time as it is.

    Raises
    ------
    ParameterError
        The channel was not recorded, or a label does not exist.
    """
    if isinstance(channel, str):
        recorded(run, channel)
        chosen = run[channel]
    else:
        chosen = channel
    for dim, wanted in at.items():
        if dim not in chosen.dims:
            held = ", ".join(map(str, chosen.dims))
            raise ParameterError(f"{chosen.name} has no dimension {dim!r}: it has {held}", dim)
        held = chosen[dim].to_numpy().tolist()
        asked = wanted if isinstance(wanted, list | tuple) else [wanted]
        strange = [it for it in asked if it not in held]
        if strange:
            listed = ", ".join(map(str, held[:12])) + (", …" if len(held) > 12 else "")
            raise ParameterError(f"there is no {dim} {strange[0]!r}: there are {listed}", dim)
    chosen = chosen.sel(at)
    if "time" not in chosen.dims:
        raise ParameterError(f"{chosen.name} is no signal over time", str(chosen.name))
    return chosen.transpose(..., "time")


def late(run: _Timed, after: float) -> _Timed:
    """Return the part of a run or a signal from a time on [s].

    Raises
    ------
    ParameterError
        The part has less than two samples.
    """
    if isinstance(after, str):
        raise ParameterError(f"after = {after!r}, must be a time in s", "after", "a number")
    found = run.isel(time=slice(int(np.searchsorted(run["time"], after)), None))
    if found.sizes["time"] < 2:
        raise ParameterError(
            f"after = {after} leaves less than two samples of {run.sizes['time']}: "
            "give an earlier time, or simulate longer",
            "after",
            "an earlier time",
        )
    return found


def finite(values: xr.DataArray) -> NDArray[np.float64]:
    """Return the samples of a signal, all of which are numbers.

    Raises
    ------
    ParameterError
        Some are not, such as the tension of a span while no roller holds it.
    """
    samples = values.to_numpy().astype(float)
    missing = np.count_nonzero(~np.isfinite(samples))
    if missing:
        name = str(values.name or "the signal")
        raise ParameterError(
            f"{name} is not a number at {missing} of {samples.size} samples: leave them out, "
            "`run.sel(time=slice(…, …))`, or take another signal",
            name,
        )
    return samples


def sample_rate(values: xr.DataArray) -> float:
    """Return the samples a second [Hz] of a signal sampled at equal intervals."""
    time = values["time"].to_numpy()
    if time.size < 8:
        raise ParameterError(f"{time.size} samples are too few: record at least 8", "time")
    intervals = np.diff(time)
    # The last sample stands where the run ended, up to a step after its place.
    mean = float(time[-2] - time[0]) / (time.size - 2)
    if np.abs(intervals[:-1] - mean).max() > 1e-3 * mean:
        raise ParameterError("the samples are not at equal intervals: interpolate first", "time")
    return 1.0 / mean


def turning(run: xr.Dataset, shaft: str) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the angle that a shaft or sprocket has turned by [rad], and its speed [rad/s].

    Both (time,), positive in the direction in which it turns in the mean.

    Raises
    ------
    ParameterError
        Its angle was not recorded, or at less than two samples.
    """
    kind = "shaft" if "shaft" in run.dims and shaft in run["shaft"].to_numpy() else "sprocket"
    name = f"{kind}_angle"
    angle = signal(run, name, {kind: shaft}).to_numpy().astype(float)
    if angle.size < 2:
        raise ParameterError(f"{angle.size} samples are too few: record at least 2", "time")
    angle = (angle - angle[0]) * (1.0 if angle[-1] >= angle[0] else -1.0)
    return angle, np.gradient(angle, run["time"].to_numpy())


def label(values: xr.DataArray) -> str:
    """Return a short label of a signal: its channel, and what it was chosen at."""
    name = str(values.name or "signal").replace("_", " ")
    picked = [
        str(it.to_numpy()) for dim, it in values.coords.items() if it.ndim == 0 and dim in _NAMED
    ]
    return ", ".join([name, *picked])
