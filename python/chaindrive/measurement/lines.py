"""Lines of the mesh in a vibration or a sound: where they stand, whatever their height."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from chaindrive.analysis.parts import sprockets
from chaindrive.analysis.signal import turning
from chaindrive.analysis.spectra import peaks, spectrum
from chaindrive.errors import ChaindriveError
from chaindrive.labelled import indexed, labelled
from chaindrive.measurement.series import Series
from chaindrive.plot.source import driver_of

__all__ = ["Line", "mesh_lines"]

_Floats = NDArray[np.float64]

#: Multiples of the mesh that are looked for.
_MULTIPLES = 5
#: How far from the mesh of the run a line is looked for, as a share of it: slip of a motor
#: (assumed).
_NEAR = 0.06
#: Surroundings of a line, as a share of its frequency to either side (assumed).
_AROUND = 0.2
#: Height over the median of its surroundings from which a line is one [–] (assumed).
_STANDS_OUT = 4.0


class Line(NamedTuple):
    """A multiple of the mesh frequency."""

    multiple: int
    found: float
    """Where it stands [Hz]; NaN where no line stands out."""
    expected: float
    """The multiple of the mesh frequency of the run [Hz]."""
    prominence: float
    """Its height over what is around it [–]."""


def mesh_lines(series: Series, run: xr.Dataset, shaft: str | None) -> list[Line]:
    """Return the lines of the mesh in a signal, near those of a run.

    The mesh frequency ``f = z Ω / 2π`` is that of the run. Its comb is looked for within 6 % of it:
    where the lines at f, 2 f … 5 f together stand highest out of what is around them,
    ``max Σ ln A(k f)/Ã(k f)``. A line that does not stand out by itself is not a number.
    """
    wheel = sprockets(run)[shaft if shaft in sprockets(run) else driver_of(run)]
    angle, _ = turning(run, wheel.name)
    span = float(run["time"][-1] - run["time"][0])
    mesh = wheel.teeth * float(angle[-1]) / (2.0 * np.pi * span)
    time = {"time": series.time}
    values = xr.DataArray(
        labelled(("time",), series.values), coords=indexed(time, {}), name="signal"
    )
    try:
        spread = spectrum(xr.Dataset(), values)
    except ChaindriveError:
        return []
    base = _comb(spread, mesh)
    found = [_line(spread, multiple * base) for multiple in range(1, _MULTIPLES + 1)]
    return [
        Line(multiple, place, multiple * mesh, height)
        for multiple, (place, height) in enumerate(found, 1)
    ]


def _comb(spread: xr.DataArray, mesh: float) -> float:
    """Return the frequency near that of the mesh whose multiples stand highest together [Hz]."""
    resolution = float(spread.attrs["resolution"])
    frequency, height = spread["frequency"].to_numpy(), spread.to_numpy()
    held = [k for k in range(1, _MULTIPLES + 1) if k * mesh * (1 + _NEAR) < frequency[-1]]
    tried = np.arange((1 - _NEAR) * mesh, (1 + _NEAR) * mesh, 0.2 * resolution / _MULTIPLES)
    score = np.zeros(tried.size)
    for multiple in held:
        reach = max(_AROUND * multiple * mesh, 10.0 * resolution)
        near = np.abs(frequency - multiple * mesh) < reach
        around = max(float(np.median(height[near])), 1e-300)
        score += np.log(np.interp(multiple * tried, frequency, height) / around + 1e-12)
    return float(tried[int(np.argmax(score))])


def _line(spread: xr.DataArray, at: float) -> tuple[float, float]:
    """Return the place of the line at a frequency [Hz], and how far it stands out [–]."""
    resolution = float(spread.attrs["resolution"])
    reach = 3.0 * resolution
    part = spread.sel(frequency=slice(at - reach, at + reach))
    wide = max(_AROUND * at, 10.0 * resolution)
    around = spread.sel(frequency=slice(at - wide, at + wide))
    if part.size < 5 or at + reach > float(spread["frequency"][-1]):
        return np.nan, 0.0
    height = float(part.max()) / max(float(around.median()), 1e-300)
    tops = peaks(part, count=1)
    if height < _STANDS_OUT or tops.sizes["peak"] == 0:
        return np.nan, height
    return float(tops["frequency"][0]), height
