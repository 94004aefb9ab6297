"""Plots: a drive, its chain at an instant, and what a run, its analysis or a sweep shows.

Needs the extra ``plot`` (matplotlib). Plots of an analysis take the run as well and make the
analysis themselves: ``plot.losses(run)``. Every function draws into the axes it is given, or into
new ones, and returns them; nothing is shown or saved, and a new figure is left behind only when it
was drawn. Paper is transparent, and colours are seen on white and on black: `STYLE` has them for
figures of one's own.
"""

from __future__ import annotations

from chaindrive.plot.assumed import sobol_indices, tornado
from chaindrive.plot.curves import tension, work_precision
from chaindrive.plot.drive import frame, layout, svg
from chaindrive.plot.fitted import (
    fit_correlations,
    fit_intervals,
    fit_profile,
    fit_residuals,
)
from chaindrive.plot.impulses import impulse_spectrum
from chaindrive.plot.measured import (
    compared_orders,
    comparison,
    differences,
    distribution,
    overlay,
)
from chaindrive.plot.panels import overview
from chaindrive.plot.scheme import STYLE
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
from chaindrive.plot.variants import response
from chaindrive.plot.wear import (
    elongation,
    impacts,
    joint_work,
    losses,
    rainflow,
    tension_around_loop,
    tooth_load,
    utilisation,
)

__all__ = [
    "STYLE",
    "campbell",
    "compared_orders",
    "comparison",
    "differences",
    "distribution",
    "elongation",
    "fit_correlations",
    "fit_intervals",
    "fit_profile",
    "fit_residuals",
    "frame",
    "impacts",
    "impulse_spectrum",
    "joint_work",
    "layout",
    "losses",
    "order_map",
    "order_slice",
    "overlay",
    "overview",
    "rainflow",
    "response",
    "running_modes",
    "sobol_indices",
    "span_envelope",
    "span_motion",
    "spectrum",
    "speed_ripple",
    "svg",
    "tension",
    "tension_around_loop",
    "tooth_load",
    "tornado",
    "transmission_error",
    "utilisation",
    "work_precision",
]


def __dir__() -> list[str]:
    return list(__all__)
