"""Plots: a drive, its chain at an instant, tensions, spectra and orders, work against precision.

Needs the extra ``plot`` (matplotlib). Every function draws into the axes it is given, or into
new ones, and returns them; nothing is shown or saved.
"""

from __future__ import annotations

from chaindrive.plot.curves import tension, work_precision
from chaindrive.plot.drive import frame, layout
from chaindrive.plot.spectra import (
    campbell,
    order_map,
    order_slice,
    running_modes,
    span_envelope,
    span_motion,
    spectrum,
    speed_ripple,
    transmission_error,
)

__all__ = [
    "campbell",
    "frame",
    "layout",
    "order_map",
    "order_slice",
    "running_modes",
    "span_envelope",
    "span_motion",
    "spectrum",
    "speed_ripple",
    "tension",
    "transmission_error",
    "work_precision",
]


def __dir__() -> list[str]:
    return list(__all__)
