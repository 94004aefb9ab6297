"""The time base of a channel: when its samples were taken, and what is wrong with that."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from chaindrive.errors import MeasurementError

__all__ = ["Finding", "intervals", "longest_even", "rises", "sampling_rate", "sorted_in_time"]

_Floats = NDArray[np.float64]

#: An interval longer than so many usual ones is a gap [–] (assumed).
_GAP = 1.5
#: Scatter of intervals over their mean from which samples are no longer equally spaced [–]: what
#: a table rounded to three digits of the interval has (assumed).
_JITTER = 1e-3
#: Share of samples that may go back in time before the record is refused [–] (assumed).
_BACK = 0.01


class Finding(NamedTuple):
    """Something that was noticed in a record."""

    kind: str
    """Its name: ``gap``, ``duplicate``, ``back-in-time``, ``jitter``, ``clipped``, ``dropout`` …"""
    channel: str
    """The channel, or an empty text for all of the record."""
    text: str
    """It, in a sentence without its subject."""

    def __str__(self) -> str:
        return f"{self.channel}: {self.text}" if self.channel else self.text


def sorted_in_time(
    time: _Floats, name: str, least: int = 8
) -> tuple[NDArray[np.int64], list[Finding]]:
    """Return which samples to take, in their order, and what was found.

    Parameters
    ----------
    time
        Times of the samples [s].
    name
        What they belong to, for messages.
    least
        How many samples are needed.

    Raises
    ------
    MeasurementError
        Times are no numbers, too few, or go back more often than by mistake.
    """
    found: list[Finding] = []
    good = np.flatnonzero(np.isfinite(time))
    if len(good) < len(time):
        found.append(
            Finding(
                "dropout", name, f"{len(time) - len(good)} samples have no time, and are left out"
            )
        )
    if len(good) < least:
        message = f"{name}: {len(good)} samples are too few"
        raise MeasurementError(message, name, f"at least {least}")
    steps = np.diff(time[good])
    back = int(np.count_nonzero(steps < 0.0))
    if back:
        at = int(np.argmax(steps < 0.0))
        where = (
            f"from {time[good[at]]:.6g} s to {time[good[at + 1]]:.6g} s at sample {good[at + 1]}"
        )
        longest = float(steps.min())
        if back > max(1.0, _BACK * len(good)) or -longest > 0.5 * float(np.ptp(time[good])):
            raise MeasurementError(
                f"{name}: time goes back {back} times, first {where}",
                name,
                "several records in one file are read one by one: give each as a DataFrame",
            )
        found.append(
            Finding("back-in-time", name, f"goes back {back} times, first {where}; sorted")
        )
        good = good[np.argsort(time[good], kind="stable")]
    twice = np.concatenate([[False], np.diff(time[good]) == 0.0])
    if twice.any():
        if twice.mean() > 0.5:
            raise MeasurementError(
                f"{name}: {np.count_nonzero(twice)} of {len(good)} samples have the time of the "
                "one before",
                name,
                "its times have too few digits: give `rate` in place of them",
            )
        first = float(time[good][twice][0])
        text = (
            f"{np.count_nonzero(twice)} samples have the time of the one before, first at "
            f"{first:.6g} s; left out"
        )
        found.append(Finding("duplicate", name, text))
        good = good[~twice]
    return good, found


def rises(values: _Floats) -> bool:
    """Tell whether values may be times: they go on, and back by mistake at most."""
    steps = np.diff(values[np.isfinite(values)])
    back = int(np.count_nonzero(steps < 0.0))
    return bool(steps.sum() > 0.0 and back <= max(1.0, _BACK * len(steps)))


def intervals(time: _Floats, name: str) -> list[Finding]:
    """Return what is wrong with the intervals of sorted times: gaps and jitter."""
    steps = np.diff(time)
    usual = float(np.median(steps))
    gaps = np.flatnonzero(steps > _GAP * usual)
    found = []
    if gaps.size:
        worst = gaps[int(np.argmax(steps[gaps]))]
        found.append(
            Finding(
                "gap",
                name,
                f"{gaps.size} gap{'s' if gaps.size > 1 else ''}, the longest of "
                f"{steps[worst]:.4g} s after {time[worst]:.6g} s; samples are {usual:.4g} s apart",
            )
        )
    regular = steps[steps <= _GAP * usual]
    scatter = float(regular.std() / usual) if regular.size else 0.0
    if scatter > _JITTER:
        found.append(
            Finding(
                "jitter", name, f"intervals scatter by {100 * scatter:.2g} % about {usual:.4g} s"
            )
        )
    return found


def sampling_rate(time: _Floats) -> float:
    """Return the samples a second [Hz] between gaps."""
    return 1.0 / float(np.median(np.diff(time)))


def longest_even(time: _Floats, values: _Floats) -> tuple[_Floats, _Floats]:
    """Return the longest stretch without gap or missing value at equal intervals, (samples,) each.

    Samples that jitter are interpolated; those that do not are kept as they are.
    """
    good = np.isfinite(values)
    time, values = time[good], values[good]
    if time.size < 8:
        raise MeasurementError("fewer than 8 samples have a value", "time")
    steps = np.diff(time)
    usual = float(np.median(steps))
    ends = np.concatenate([[-1], np.flatnonzero(steps > _GAP * usual), [time.size - 1]])
    longest = int(np.argmax(np.diff(ends)))
    part = slice(int(ends[longest]) + 1, int(ends[longest + 1]) + 1)
    time, values = time[part], values[part]
    if time.size < 8:
        raise MeasurementError("no stretch without a gap has 8 samples", "time")
    even = np.linspace(time[0], time[-1], time.size)
    if np.abs(time - even).max() <= 1e-3 * usual:
        return even, values
    count = round(float(time[-1] - time[0]) / usual) + 1
    even = np.linspace(time[0], time[-1], count)
    return even, np.interp(even, time, values)
