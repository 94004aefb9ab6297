"""Alignment: how far a measured signal is behind a simulated one, in angle or in time."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from chaindrive.extras import extra
from chaindrive.measurement.series import Series

__all__ = ["Aligned", "in_angle", "in_time"]

_Floats = NDArray[np.float64]


class Aligned(NamedTuple):
    """Two signals on one abscissa."""

    at: _Floats
    """Abscissa: share of a period [–], or time in the measurement [s]."""
    measured: _Floats
    simulated: _Floats
    shift: float
    """By how much the simulated signal was moved: share of a period [–], or time [s]."""
    correlation: float
    """Correlation of the two there [–]; 1 where they have one form."""


def in_angle(measured: _Floats, simulated: _Floats) -> Aligned:
    """Align two means over a period, whose phase nobody knows, by their circular correlation.

    Parameters
    ----------
    measured, simulated : (any,), (any,)
        Each over one period, at equal steps; the finer grid is taken.
    """
    count = max(measured.size, simulated.size)
    at = np.arange(count) / count
    first, second = (
        np.interp(at, np.arange(it.size + 1) / it.size, np.append(it, it[0]))
        for it in (measured, simulated)
    )
    spread = np.fft.rfft(first - first.mean()) * np.conj(np.fft.rfft(second - second.mean()))
    likeness = np.fft.irfft(spread, count)
    best = int(np.argmax(likeness))
    size = first.std() * second.std() * count
    correlation = float(likeness[best] / size) if size > 0.0 else 0.0
    return Aligned(at, first, np.roll(second, best), best / count, correlation)


def in_time(measured: Series, simulated: Series) -> Aligned:
    """Align two signals in time by their correlation, over the shorter of them.

    The shift is found to a fraction of a sample, by a parabola through the highest three values.
    """
    correlate = extra("scipy.signal", "alignments in time").correlate
    rate = measured.rate
    time = np.arange(0.0, float(simulated.time[-1] - simulated.time[0]), 1.0 / rate)
    other = np.interp(time, simulated.time - simulated.time[0], simulated.values)
    first, second = measured.values, other
    one, two = first - first.mean(), second - second.mean()
    likeness = correlate(one, two, mode="full", method="fft")
    lags = np.arange(1 - two.size, one.size)
    # A few samples that overlap are alike by chance: each lag is judged by all that it compares.
    overlap = np.minimum(lags + two.size, one.size) - np.maximum(lags, 0)
    likeness = np.where(overlap >= 0.5 * min(one.size, two.size), likeness, -np.inf)
    best = int(np.argmax(likeness))
    part = 0.0
    if 0 < best < likeness.size - 1 and np.isfinite(likeness[best - 1 : best + 2]).all():
        left, middle, right = likeness[best - 1 : best + 2]
        bend = left - 2.0 * middle + right
        part = float(0.5 * (left - right) / bend) if bend < 0.0 else 0.0
    lag = (float(lags[best]) + part) / rate
    begin, end = max(0.0, lag), min((one.size - 1) / rate, lag + float(time[-1]))
    own = np.arange(measured.values.size) / rate
    inside = (own >= begin) & (own <= end)
    at = own[inside]
    moved = np.interp(at - lag, time, other)
    kept = first[inside]
    size = kept.std() * moved.std()
    product = float(((kept - kept.mean()) * (moved - moved.mean())).mean())
    return Aligned(at, kept, moved, lag, product / float(size) if size > 0.0 else 0.0)
