"""Faults of readings: clipping, dropouts, sampling too slow for what is to be seen."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from chaindrive.measurement.time_base import Finding

__all__ = ["faults_of", "too_slow"]

_Floats = NDArray[np.float64]

#: Equal samples in a row at the bound of the range that are clipping (assumed).
_AT_BOUND = 3
#: Samples at the bound over those at the reading next to it from which it is clipping (assumed).
_CUT = 5
#: Values that a channel has to take before its bounds tell anything: fewer are a switch (assumed).
_LEVELS = 16
#: Samples in a row that a reading stands still while it is a dropout, as a multiple of the
#: longest of its usual stands, and at least (assumed).
_STAND, _LEAST_STAND = 10.0, 8


def faults_of(values: _Floats, name: str, full_scale: float | None = None) -> list[Finding]:
    """Return what is wrong with readings (samples,)."""
    found = []
    missing = int(np.count_nonzero(~np.isfinite(values)))
    if missing:
        found.append(Finding("dropout", name, f"{missing} of {values.size} samples have no value"))
    good = values[np.isfinite(values)]
    if good.size < 8:
        return found
    starts, lengths = _stands(good)
    if lengths.size == 1:
        found.append(Finding("dropout", name, f"stands at {good[0]:.6g} throughout"))
        return found
    if np.unique(good[: 1 << 16]).size < _LEVELS:
        return found
    for bound, word in ((float(good.max()), "greatest"), (float(good.min()), "least")):
        if bound == 0.0:
            # What stands at rest reads nothing.
            continue
        long = (good[starts] == bound) & (lengths >= _AT_BOUND)
        count = int(lengths[long].sum())
        at_scale = full_scale is not None and abs(bound) >= full_scale * (1.0 - 1e-4)
        if np.count_nonzero(long) < (1 if at_scale else 2) or (full_scale and not at_scale):
            continue
        # A signal that steps by digits turns at its highest one, and is there 2.4 times as long as
        # at the next one; one that is cut stays there.
        inner = good[good != bound]
        beside = int(
            np.count_nonzero(inner == (inner.max() if word == "greatest" else inner.min()))
        )
        if count >= max(_CUT * beside, 2 * _AT_BOUND):
            text = f"clipped: {count} samples stand in rows at the {word} reading, {bound:.6g}"
            found.append(Finding("clipped", name, text))
    inside = (good[starts] != good.max()) & (good[starts] != good.min()) | (good[starts] == 0.0)
    usual = float(np.percentile(lengths, 95))
    stuck = inside & (lengths >= max(_STAND * usual, _LEAST_STAND))
    if stuck.any():
        worst = int(np.flatnonzero(stuck)[np.argmax(lengths[stuck])])
        text = (
            f"stands still {_times(int(stuck.sum()))} for {lengths[worst]} "
            f"samples at {good[starts[worst]]:.6g}, from sample {starts[worst]} on"
        )
        found.append(Finding("dropout", name, text))
    return found


def _times(count: int) -> str:
    return "once," if count == 1 else f"{count} times, the longest"


def _stands(values: _Floats) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return where stretches of equal values begin, and how long they are."""
    starts = np.concatenate([[0], np.flatnonzero(np.diff(values) != 0.0) + 1])
    return starts, np.diff(np.concatenate([starts, [values.size]]))


def too_slow(rate: float, speed: float, order: float, what: str, name: str) -> Finding | None:
    """Return that a channel is sampled below twice a frequency of interest, or None.

    ``f = order · Ω / 2π``; at half the rate and above lines fold down to other places (Nyquist).

    Parameters
    ----------
    rate
        Samples a second [Hz].
    speed
        Speed of the shaft [rad/s].
    order
        Its order of interest [–].
    what
        What stands at this order, such as ``"the mesh of driver"``.
    name
        The channel.
    """
    frequency = order * abs(speed) / (2.0 * np.pi)
    if rate >= 2.0 * frequency:
        return None
    text = (
        f"sampled at {rate:.4g} Hz, less than twice the {frequency:.4g} Hz of {what}: "
        "such lines fold down to others"
    )
    return Finding("aliased", name, text)
