"""Spectra of channels over time, and the lines in them."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from chaindrive.analysis.signal import finite, label, late, sample_rate, signal
from chaindrive.errors import ParameterError
from chaindrive.extras import extra

__all__ = ["peaks", "spectrum"]


def spectrum(
    run: xr.Dataset,
    channel: str | xr.DataArray,
    *,
    kind: Literal["amplitude", "density"] = "amplitude",
    window: str = "hann",
    segments: int = 1,
    after: float = 0.0,
    **at: Any,
) -> xr.DataArray:
    """Spectrum of a channel over the time of a run.

    ``A(f) = 2 |Σ w x e^(−2πi f t)| / Σ w``, and the density ``S(f) = A² Σ²w / (2 fs Σ w²)``

    The mean is taken off. The amplitude spectrum shows a sine of amplitude a as a line of height a
    where its frequency falls on a line, and up to 15 % (Hann) less between two; `peaks` corrects
    that. The density is for what has no lines, such as the noise of impacts.

    Parameters
    ----------
    run
        A run sampled at equal intervals.
    channel
        Name of a channel, or a signal over time of one's own, such as `span_motion` returns.
    kind
        ``"amplitude"``, in the unit of the channel, or ``"density"``, in its square a hertz.
    window
        Window of `scipy.signal.get_window`.
    segments
        Into how many parts, overlapping by half, the run is cut and averaged (Welch).
    after
        Time up to which samples are left out, such as a transient [s].
    **at
        Labels by dimension: ``span="crank-camshaft"``, ``sprocket="camshaft"``; those not given
        stay a dimension of the result.

    Returns
    -------
    xarray.DataArray
        (…, frequency).

    Raises
    ------
    ParameterError
        The channel was not recorded, a label or kind does not exist, samples are too few, or some
        are not a number.

    References
    ----------
    G. Heinzel, A. Rüdiger, R. Schilling, *Spectrum and spectral density estimation by the
    discrete Fourier transform*, Max-Planck-Institut für Gravitationsphysik, 2002.
    """
    if kind not in ("amplitude", "density"):
        raise ParameterError(f"kind = {kind!r}, must be 'amplitude' or 'density'", "kind")
    scipy_signal = extra("scipy.signal", "spectra")
    values = late(signal(run, channel, at), after)
    rate = sample_rate(values)
    if segments < 1:
        raise ParameterError(f"segments = {segments}, must be at least 1", "segments")
    # With an overlap of a half n parts are (n + 1) / 2 lengths long.
    length = int(2 * values.sizes["time"] / (segments + 1))
    if length < 8:
        raise ParameterError(f"{segments} segments leave {length} samples each", "segments")
    density = kind == "density"
    frequency, power = scipy_signal.welch(
        finite(values),
        rate,
        window=window,
        nperseg=length,
        detrend="constant",
        scaling="density" if density else "spectrum",
        axis=-1,
    )
    unit = values.attrs.get("units", "1")
    # SciPy gives the mean square of a line: a²/2, but a² at zero and at half the sample rate.
    spread = power if density else np.sqrt(2.0 * power)
    return xr.DataArray(
        spread,
        dims=(*values.dims[:-1], "frequency"),
        coords={
            **{name: it for name, it in values.coords.items() if "time" not in it.dims},
            "frequency": ("frequency", frequency, {"units": "Hz", "long_name": "frequency"}),
        },
        name=values.name,
        attrs={
            "units": f"({unit})²/Hz" if density else unit,
            "long_name": ("density of " if density else "amplitude of ") + label(values),
            "window": window,
            "resolution": rate / length,
        },
    )


def peaks(
    spread: xr.DataArray, *, count: int = 10, prominence: float = 0.05, over: str | None = None
) -> xr.Dataset:
    """Lines of an amplitude spectrum, their places and heights corrected.

    Of a sine that stands alone, seen through a Hann window, place and height are exact: the ratio
    of a line to its higher neighbour tells how far it lies between the two. Other windows are
    refused.

    Parameters
    ----------
    spread
        An amplitude spectrum of one signal, over ``frequency`` or ``order``.
    count
        How many, the highest ones.
    prominence
        Least height above what is around it, in fractions of the highest line [–].
    over
        Dimension; the only one when absent.

    Returns
    -------
    xarray.Dataset
        ``amplitude`` and ``frequency`` or ``order`` (peak,), the highest first.
    """
    find_peaks = extra("scipy.signal", "spectra").find_peaks
    axis = over or str(spread.dims[-1])
    if spread.attrs.get("window") != "hann":
        raise ParameterError("lines are corrected for a Hann window: take window='hann'", "window")
    if spread.dims != (axis,):
        raise ParameterError(
            f"lines are looked for in one spectrum, not over {spread.dims}: select one first", axis
        )
    heights = spread.to_numpy().astype(float)
    places = spread[axis].to_numpy()
    found, _ = find_peaks(heights, prominence=prominence * heights.max())
    found = found[np.argsort(-heights[found])][:count]
    where, height = _tops(places, heights, found)
    known = spread[axis].attrs
    return xr.Dataset(
        {
            "amplitude": ("peak", height, dict(spread.attrs)),
            axis: ("peak", where, dict(known)),
        },
        coords={"peak": np.arange(found.size)},
    )


def _tops(
    places: NDArray[np.float64], heights: NDArray[np.float64], found: NDArray[np.int64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return place and height of sines whose spectra have their highest lines at `found`."""
    left, middle, right = (heights[found + shift] for shift in (-1, 0, 1))
    side = np.where(right >= left, 1.0, -1.0)
    ratio = np.maximum(left, right) / middle
    # δ = (2 a − 1) / (a + 1),   A = A₀ (1 − δ²) / sinc(δ)
    shift = (2.0 * ratio - 1.0) / (ratio + 1.0)
    step = places[1] - places[0]
    return places[found] + side * shift * step, middle * (1.0 - shift**2) / np.sinc(shift)
