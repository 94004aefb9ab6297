"""The accessor ``run.drive``: every analysis of a run as a method of its dataset.

It stands above all that it takes; `labelled` has xarray find it when somebody first asks for it.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable
from functools import wraps
from typing import Any, TypeVar

import xarray as xr

from chaindrive import plot, replaying, reporting
from chaindrive.analysis import (
    around,
    capacity,
    dissipation,
    duty,
    elongation,
    engagement,
    fatigue,
    impulses,
    joints,
    orders,
    running,
    seating,
    spans,
    spectra,
    transmission,
)
from chaindrive.page import Page, page_of

__all__ = ["DriveAccessor"]


Found = TypeVar("Found")


def _method(function: Callable[..., Found]) -> Callable[..., Found]:
    """Return a function of a run as a method, with its signature and its text."""

    @wraps(function)
    def method(self: DriveAccessor, *args: Any, **options: Any) -> Found:
        return function(self._run, *args, **options)

    run, *others = inspect.signature(function).parameters.values()
    itself = inspect.Parameter("self", inspect.Parameter.POSITIONAL_ONLY)
    told: Any = method
    told.__signature__ = inspect.signature(function).replace(parameters=[itself, *others])
    # The run is not among the parameters of the method.
    alone, among = rf"^( *){run.name}\n(?:\1 +\S.*\n)+", rf"^( *){run.name}, "
    text = re.sub(alone, "", function.__doc__ or "", count=1, flags=re.MULTILINE)
    told.__doc__ = re.sub(among, r"\1", text, count=1, flags=re.MULTILINE)
    return method


class DriveAccessor:
    """Analysis of a run; every method is the function of the same name in `analysis`.

    Drawings, replays and reports are those of `chaindrive`.

    Examples
    --------
    >>> import chaindrive as cd
    >>> run = cd.simulate(cd.scenes.spinning_ring(), until=0.02, record=["link_tension"])
    >>> run.drive.spectrum("link_tension", link=3).dims
    ('frequency',)
    """

    def __init__(self, run: xr.Dataset) -> None:
        self._run = run

    def summary(self) -> Page:
        """Return the page of the run, as text and as tables of a notebook.

        Verdict, what the drive does, tensions, bearings and guides, impacts, tensioners,
        irregularity, losses, utilisation, assumed inputs; ``numerics`` holds steps and errors.
        """
        return page_of(self._run)

    spectrum = _method(spectra.spectrum)
    order_map = _method(orders.order_map)
    order_spectrum = _method(orders.order_spectrum)
    campbell = _method(orders.campbell)
    running_modes = _method(running.running_modes)
    span_frequencies = _method(running.span_frequencies)
    transmission_error = _method(transmission.transmission_error)
    speed_ripple = _method(transmission.speed_ripple)
    span_envelope = _method(spans.span_envelope)
    span_motion = _method(spans.span_motion)
    tension_around_loop = _method(around.tension_around_loop)
    tooth_load = _method(engagement.tooth_load)
    impacts = _method(seating.impacts)
    impulse_spectrum = _method(impulses.impulse_spectrum)
    impulse_level = _method(impulses.impulse_level)
    losses = _method(dissipation.losses)
    joint_work = _method(joints.joint_work)
    wear = _method(elongation.wear)
    rainflow = _method(fatigue.rainflow)
    rating = _method(capacity.rating)
    utilisation = _method(duty.utilisation)
    frame = _method(plot.frame)
    replay = _method(replaying.replay)
    report = _method(reporting.report)
