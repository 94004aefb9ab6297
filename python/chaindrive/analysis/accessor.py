"""The accessor ``run.drive``: every analysis of a run as a method of its dataset.

Importing this module registers it; chaindrive does so when it first makes or opens a dataset.
"""

from __future__ import annotations

from typing import Any

import xarray as xr

from chaindrive.analysis import orders, running, spans, spectra, transmission

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

    def spectrum(self, channel: str, **options: Any) -> xr.DataArray:
        """See `chaindrive.analysis.spectrum`."""
        return spectra.spectrum(self._run, channel, **options)

    def order_map(self, channel: str, shaft: str, **options: Any) -> xr.DataArray:
        """See `chaindrive.analysis.order_map`."""
        return orders.order_map(self._run, channel, shaft, **options)

    def campbell(self, channel: str, shaft: str, **options: Any) -> xr.Dataset:
        """See `chaindrive.analysis.campbell`."""
        return orders.campbell(self._run, channel, shaft, **options)

    def running_modes(self, **options: Any) -> xr.Dataset:
        """See `chaindrive.analysis.running_modes`."""
        return running.running_modes(self._run, **options)

    def span_frequencies(self, **options: Any) -> xr.Dataset:
        """See `chaindrive.analysis.span_frequencies`."""
        return running.span_frequencies(self._run, **options)

    def transmission_error(self, driver: str, driven: str) -> xr.Dataset:
        """See `chaindrive.analysis.transmission_error`."""
        return transmission.transmission_error(self._run, driver, driven)

    def speed_ripple(self) -> xr.Dataset:
        """See `chaindrive.analysis.speed_ripple`."""
        return transmission.speed_ripple(self._run)

    def span_envelope(self, span: str, **options: Any) -> xr.Dataset:
        """See `chaindrive.analysis.span_envelope`."""
        return spans.span_envelope(self._run, span, **options)

    def span_motion(self, span: str, **options: Any) -> xr.DataArray:
        """See `chaindrive.analysis.span_motion`."""
        return spans.span_motion(self._run, span, **options)
