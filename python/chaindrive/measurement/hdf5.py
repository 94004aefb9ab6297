"""HDF5 of any layout: every array of numbers is a channel, its time stands beside it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from chaindrive.extras import extra
from chaindrive.measurement.raw import RawChannel, RawRecord
from chaindrive.measurement.time_base import rises
from chaindrive.measurement.units import unit_of

__all__ = ["read"]

_Floats = NDArray[np.float64]

#: Names of a time, the likelier ones first.
_TIMES = ("time", "t", "zeit", "timestamps")
#: Names of a time where nothing else is one.
_AXES = ("x",)
_UNITS = ("units", "unit", "Unit")
#: Attributes that tell an interval [s], and those that tell its inverse [Hz].
_INTERVALS = ("dt", "increment", "wf_increment", "sampling_interval", "delta_t")
_RATES = ("rate", "sampling_rate", "sample_rate", "samplerate", "fs")


def read(path: Path) -> RawRecord:
    """Read an HDF5 file by h5py.

    The time of an array follows from an attribute of its own, an interval such as ``dt`` or a rate
    such as ``fs``; or it is the array called so in its group; or an attribute of the group tells
    it; or the same of the groups above. Last it may be an array ``x``.
    """
    h5py = extra("h5py", "measurements in HDF5")
    signals: list[tuple[str, str | None, list[_Floats], _Floats | None]] = []
    notes: list[tuple[str, str, str]] = []
    # Times of other arrays, by their names in the file.
    clocks: dict[str, _Floats] = {}
    with h5py.File(path, "r") as file:
        arrays: list[Any] = []
        file.visititems(lambda _, it: arrays.append(it) if isinstance(it, h5py.Dataset) else None)
        for array in arrays:
            if array.dtype.kind not in "biuf" or array.ndim not in (1, 2) or array.size < 2:
                notes.append(("text", array.name.strip("/"), "is no signal, and is left out"))
                continue
            values = np.asarray(array[()], dtype=np.float64)
            columns = (
                [values]
                if values.ndim == 1
                else list(values.T if len(values) > values.shape[1] else values)
            )
            time = _time(array, len(columns[0]), clocks)
            signals.append((array.name, _text(array.attrs, _UNITS), columns, time))
    channels = [
        RawChannel(name.strip("/") + (f"[{n}]" if len(columns) > 1 else ""), unit, column, time)
        for name, unit, columns, time in signals
        if name not in clocks
        for n, column in enumerate(columns)
    ]
    return RawRecord(channels, notes)


def _text(attributes: Any, names: tuple[str, ...]) -> str | None:
    for name in names:
        if name in attributes:
            value = attributes[name]
            return value.decode() if isinstance(value, bytes) else str(value)
    return None


def _number(attributes: Any, names: tuple[str, ...]) -> float | None:
    known = {str(key).casefold(): key for key in attributes}
    for name in names:
        if name in known:
            return float(np.asarray(attributes[known[name]]).ravel()[0])
    return None


def _interval(place: Any) -> float | None:
    """Return the interval of samples [s] that an attribute of an array or of a group tells."""
    rate = _number(place.attrs, _RATES)
    return _number(place.attrs, _INTERVALS) or (1.0 / rate if rate else None)


def _time(array: Any, samples: int, clocks: dict[str, _Floats]) -> _Floats | None:
    """Return the times of an array [s]; None where nothing tells them, and of a time itself.

    An array that has them is put down among the clocks.
    """
    if _may_be_time(array, _TIMES):
        return None
    groups = [array.parent]
    while groups[-1].name != "/":
        groups.append(groups[-1].parent)
    for place in (array, *groups):
        time = None if place is array else _beside(place, samples, _TIMES, clocks)
        if time is not None:
            return time
        interval = _interval(place)
        if interval:
            return interval * np.arange(samples, dtype=np.float64)
    if _may_be_time(array, _AXES):
        return None
    beside = (_beside(group, samples, _AXES, clocks) for group in groups)
    return next((it for it in beside if it is not None), None)


def _beside(
    group: Any, samples: int, names: tuple[str, ...], clocks: dict[str, _Floats]
) -> _Floats | None:
    """Return the times [s] that an array of a group has, or None."""
    for called in names:
        for name, it in group.items():
            if str(name).casefold() != called or getattr(it, "shape", None) != (samples,):
                continue
            if it.name not in clocks and _may_be_time(it, names):
                unit = unit_of(_text(it.attrs, _UNITS) or "s")
                factor = unit.factor if unit.si == "s" else 1.0
                clocks[it.name] = factor * np.asarray(it[()], dtype=np.float64)
            if it.name in clocks:
                return clocks[it.name]
    return None


def _may_be_time(array: Any, names: tuple[str, ...]) -> bool:
    """Tell whether an array may be the time of others.

    A `T` or an `x` may be a temperature or a place: a time rises, and has no time itself.
    """
    called = array.name.rpartition("/")[2].casefold()
    unit = unit_of(_text(array.attrs, _UNITS))
    is_other = unit.is_known and unit.si != "s"
    if called not in names or is_other or array.ndim != 1:
        return False
    if called not in ("t", "x"):
        return True
    return _interval(array) is None and rises(np.asarray(array[()], dtype=np.float64))
