"""HDF5 of any layout: every array of numbers is a channel, its time stands beside it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from chaindrive.extras import extra
from chaindrive.measurement.raw import RawChannel, RawRecord
from chaindrive.measurement.units import unit_of

__all__ = ["read"]

_TIMES = ("time", "t", "zeit", "timestamps", "x")
#: Attributes that tell an interval [s], and those that tell its inverse [Hz].
_INTERVALS = ("dt", "increment", "wf_increment", "sampling_interval", "delta_t")
_RATES = ("rate", "sampling_rate", "sample_rate", "samplerate", "fs")


def read(path: Path) -> RawRecord:
    """Read an HDF5 file by h5py.

    The time of an array is the one called so in its group or in one above, or follows from an
    attribute: an interval such as ``dt``, or a rate such as ``fs``, of the array, of its group or
    of the file.
    """
    h5py = extra("h5py", "measurements in HDF5")
    channels: list[RawChannel] = []
    notes: list[tuple[str, str, str]] = []
    with h5py.File(path, "r") as file:
        arrays: list[Any] = []
        file.visititems(lambda _, it: arrays.append(it) if isinstance(it, h5py.Dataset) else None)
        for array in arrays:
            name = array.name.strip("/")
            if array.dtype.kind not in "biuf" or array.ndim not in (1, 2) or array.size < 2:
                notes.append(("text", name, "is no signal, and is left out"))
                continue
            if name.rpartition("/")[2].casefold() in _TIMES and len(arrays) > 1:
                continue
            values = np.asarray(array[()], dtype=np.float64)
            columns = (
                [values]
                if values.ndim == 1
                else list(values.T if len(values) > values.shape[1] else values)
            )
            time = _time(array, len(columns[0]))
            for number, column in enumerate(columns):
                own = name if len(columns) == 1 else f"{name}[{number}]"
                channels.append(
                    RawChannel(own, _text(array.attrs, ("units", "unit", "Unit")), column, time)
                )
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


def _time(array: Any, samples: int) -> Any:
    """Return the times of an array [s], or None where nothing tells them."""
    place = array
    while True:
        interval, rate = _number(place.attrs, _INTERVALS), _number(place.attrs, _RATES)
        interval = interval or (1.0 / rate if rate else None)
        if interval:
            return interval * np.arange(samples)
        if place.name == "/":
            return None
        place = place.parent
        for name in place:
            if str(name).casefold() in _TIMES and place[name].shape == (samples,):
                unit = unit_of(_text(place[name].attrs, ("units", "unit", "Unit")) or "s")
                return np.asarray(place[name][()], dtype=np.float64) * (
                    unit.factor if unit.si == "s" else 1.0
                )
