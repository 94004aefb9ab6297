"""The accessor ``run.drive``: every analysis of a run as a method of its dataset.

Importing this module registers it; chaindrive does so when it first makes or opens a dataset.
"""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, overload

import xarray as xr

from chaindrive import plot, replaying
from chaindrive.analysis import (
    around,
    capacity,
    dissipation,
    duty,
    elongation,
    engagement,
    fatigue,
    joints,
    orders,
    running,
    seating,
    spans,
    spectra,
    transmission,
)
from chaindrive.page import Page, page_of
from chaindrive.replaying import Replay

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["DriveAccessor"]


def __dir__() -> list[str]:
    return list(__all__)


@xr.register_dataset_accessor("drive")  # type: ignore[no-untyped-call]
class DriveAccessor:
    """Analysis of a run; every method stands for the function of the same name in `analysis`.

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

    def report(self, path: str | PathLike[str] | None = None) -> str:
        """See `chaindrive.report`."""
        from chaindrive.reporting import report

        return report(self._run, path)

    def spectrum(self, channel: str | xr.DataArray, **options: Any) -> xr.DataArray:
        """See `chaindrive.analysis.spectrum`."""
        return spectra.spectrum(self._run, channel, **options)

    def order_map(self, channel: str | xr.DataArray, shaft: str, **options: Any) -> xr.DataArray:
        """See `chaindrive.analysis.order_map`."""
        return orders.order_map(self._run, channel, shaft, **options)

    def order_spectrum(
        self, channel: str | xr.DataArray, shaft: str, **options: Any
    ) -> xr.DataArray:
        """See `chaindrive.analysis.order_spectrum`."""
        return orders.order_spectrum(self._run, channel, shaft, **options)

    def campbell(self, channel: str | xr.DataArray, shaft: str, **options: Any) -> xr.Dataset:
        """See `chaindrive.analysis.campbell`."""
        return orders.campbell(self._run, channel, shaft, **options)

    def running_modes(self, **options: Any) -> xr.Dataset:
        """See `chaindrive.analysis.running_modes`."""
        return running.running_modes(self._run, **options)

    def span_frequencies(self, **options: Any) -> xr.Dataset:
        """See `chaindrive.analysis.span_frequencies`."""
        return running.span_frequencies(self._run, **options)

    def transmission_error(self, driver: str, driven: str, **options: Any) -> xr.Dataset:
        """See `chaindrive.analysis.transmission_error`."""
        return transmission.transmission_error(self._run, driver, driven, **options)

    def speed_ripple(self, **options: Any) -> xr.Dataset:
        """See `chaindrive.analysis.speed_ripple`."""
        return transmission.speed_ripple(self._run, **options)

    def span_envelope(self, span: str, **options: Any) -> xr.Dataset:
        """See `chaindrive.analysis.span_envelope`."""
        return spans.span_envelope(self._run, span, **options)

    def span_motion(self, span: str, **options: Any) -> xr.DataArray:
        """See `chaindrive.analysis.span_motion`."""
        return spans.span_motion(self._run, span, **options)

    def tension_around_loop(self, **options: Any) -> xr.Dataset:
        """See `chaindrive.analysis.tension_around_loop`."""
        return around.tension_around_loop(self._run, **options)

    def tooth_load(self, sprocket: str, **options: Any) -> xr.Dataset:
        """See `chaindrive.analysis.tooth_load`."""
        return engagement.tooth_load(self._run, sprocket, **options)

    def impacts(self, **options: Any) -> xr.Dataset:
        """See `chaindrive.analysis.impacts`."""
        return seating.impacts(self._run, **options)

    def losses(self, **options: Any) -> xr.Dataset:
        """See `chaindrive.analysis.losses`."""
        return dissipation.losses(self._run, **options)

    def joint_work(self, **options: Any) -> xr.Dataset:
        """See `chaindrive.analysis.joint_work`."""
        return joints.joint_work(self._run, **options)

    def wear(self, **options: Any) -> xr.Dataset:
        """See `chaindrive.analysis.wear`."""
        return elongation.wear(self._run, **options)

    def rainflow(self, **options: Any) -> xr.Dataset:
        """See `chaindrive.analysis.rainflow`."""
        return fatigue.rainflow(self._run, **options)

    def rating(self, **options: Any) -> xr.Dataset:
        """See `chaindrive.analysis.rating`."""
        return capacity.rating(self._run, **options)

    def utilisation(self, **options: Any) -> xr.Dataset:
        """See `chaindrive.analysis.utilisation`."""
        return duty.utilisation(self._run, **options)

    def frame(self, time: float, **options: Any) -> Axes:
        """See `chaindrive.plot.frame`."""
        return plot.frame(self._run, time, **options)

    @overload
    def replay(self, path: None = None, **options: Any) -> Replay: ...

    @overload
    def replay(self, path: str | PathLike[str], **options: Any) -> Replay | Path: ...

    def replay(self, path: str | PathLike[str] | None = None, **options: Any) -> Replay | Path:
        """See `chaindrive.replay`."""
        return replaying.replay(self._run, path, **options)
