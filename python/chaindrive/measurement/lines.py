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

    The mesh frequency ``f = z Ω / 2π`` is that of the run. The first line that stands out is looked
    for within 6 % of it; the others at multiples of what was found, to a hundredth of it.
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
    lines: list[Line] = []
    base, near = mesh, _NEAR
    for multiple in range(1, _MULTIPLES + 1):
        found, height = _line(spread, multiple * base, near * base * (1 if lines else multiple))
        if np.isfinite(found) and near == _NEAR:
            base, near = found / multiple, 0.01
        lines.append(Line(multiple, found, multiple * mesh, height))
    return lines


def _line(spread: xr.DataArray, at: float, reach: float) -> tuple[float, float]:
    """Return the place of the highest line near a frequency [Hz] and how far it stands out."""
    resolution = float(spread.attrs["resolution"])
    reach = max(reach, 3.0 * resolution)
    part = spread.sel(frequency=slice(at - reach, at + reach))
    around = spread.sel(frequency=slice(at - 10.0 * reach, at + 10.0 * reach))
    if part.size < 3 or at + reach > float(spread["frequency"][-1]):
        return np.nan, 0.0
    height = float(part.max()) / max(float(around.median()), 1e-300)
    if height < _STANDS_OUT:
        return np.nan, height
    tops = peaks(part, count=1)
    if tops.sizes["peak"] == 0:
        return np.nan, height
    return float(tops["frequency"][0]), height
