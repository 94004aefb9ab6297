"""NetCDF, and datasets of xarray: variables over time, with the units of their attributes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import xarray as xr

from chaindrive.extras import extra
from chaindrive.measurement.raw import RawChannel, RawRecord
from chaindrive.measurement.units import unit_of

__all__ = ["read", "read_dataset"]


def read(path: Path) -> RawRecord:
    """Read a NetCDF file by xarray."""
    with path.open("rb") as file:
        classic = file.read(3) == b"CDF"
    engine = "scipy" if classic else "h5netcdf"
    extra("scipy" if classic else "h5netcdf", "measurements in NetCDF")
    # Times are seconds from a start here, and none shall lose digits as a date.
    with xr.open_dataset(path, engine=engine, decode_times=False) as dataset:
        return read_dataset(dataset.load())


def read_dataset(dataset: xr.Dataset) -> RawRecord:
    """Read a dataset: a channel a variable over time, and a label of what has two dimensions."""
    channels, notes = [], []
    for key, variable in dataset.data_vars.items():
        name = str(key)
        if variable.dtype.kind not in "biuf" or variable.ndim not in (1, 2):
            notes.append(("text", name, "is no signal, and is left out"))
            continue
        along = _time_of(variable)
        if along is None:
            if variable.ndim == 1:
                channels.append(RawChannel(name, variable.attrs.get("units"), _floats(variable)))
            else:
                notes.append(("text", name, "has no time, and is left out"))
            continue
        time = _seconds(variable[along]) if along in variable.coords else None
        unit = variable.attrs.get("units")
        others = [dim for dim in variable.dims if dim != along]
        if not others:
            channels.append(RawChannel(name, unit, _floats(variable), time))
            continue
        (other,) = others
        labels = variable[other].to_numpy().tolist()
        for at, label in enumerate(labels):
            own = _floats(variable.isel({other: at}))
            channels.append(RawChannel(f"{name}[{label}]", unit, own, time))
    return RawRecord(channels, notes)


def _time_of(variable: xr.DataArray) -> str | None:
    """Return the dimension that is time: so called, in seconds, or of moments."""
    for dim in map(str, variable.dims):
        if dim.casefold().startswith("time") or dim in ("t", "zeit"):
            return dim
        if dim in variable.coords:
            own = variable[dim]
            unit = str(own.attrs.get("units", "")).partition(" since ")[0]
            if own.dtype.kind in "mM" or unit_of(unit).si == "s":
                return dim
    return None


def _seconds(time: xr.DataArray) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    if time.dtype.kind == "M":
        return np.asarray((time.to_numpy() - time.to_numpy()[0]) / np.timedelta64(1, "s"))
    if time.dtype.kind == "m":
        return np.asarray(time.to_numpy() / np.timedelta64(1, "s"))
    unit = str(time.attrs.get("units", "s")).partition(" since ")[0]
    found = unit_of(unit)
    return _floats(time) * (found.factor if found.si == "s" else 1.0)


def _floats(values: xr.DataArray) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    return np.asarray(values.to_numpy(), dtype=np.float64)
