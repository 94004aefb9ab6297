"""A run in one figure: the pictures that are looked at first."""

from __future__ import annotations

import textwrap
from collections.abc import Callable
from typing import TYPE_CHECKING

import xarray as xr

from chaindrive.analysis import order_spectrum
from chaindrive.errors import ChaindriveError
from chaindrive.extras import extra
from chaindrive.plot.curves import tension
from chaindrive.plot.drive import layout
from chaindrive.plot.scheme import STYLE
from chaindrive.plot.source import driver_of, mesh_order_of, tightest_span
from chaindrive.plot.spectra import spectrum
from chaindrive.plot.wear import impacts, losses, tension_around_loop
from chaindrive.pose import drive_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["orders", "overview"]


def overview(run: xr.Dataset) -> Figure:
    """Draw a run in six panels.

    The drive at its start; the tension of its spans over time; the tension around the loop; orders
    of the driver in the tension of the tightest span; the speeds of impacts; what is lost where. A
    panel whose channel was not recorded, or whose physics the drive lacks, says so in a sentence
    instead. ``simulate(…, record="all", events="teeth")`` fills all of them.

    Parameters
    ----------
    run
        A run, whatever it recorded.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    ParameterError
        This is not a run: it has no scene.
    """
    drive = drive_of(run)
    pyplot = extra("matplotlib.pyplot", "plots")
    with pyplot.rc_context(dict(STYLE)):
        figure: Figure
        figure, axes = pyplot.subplots(2, 3, figsize=(14.0, 8.0), layout="constrained")
        panels: list[tuple[str, Callable[[Axes], object]]] = [
            ("drive", lambda ax: layout(drive, ax=ax)),
            ("tension over time", lambda ax: tension(run, ax=ax)),
            ("tension around the loop", lambda ax: tension_around_loop(run, ax=ax)),
            ("orders in the tension", lambda ax: orders(run, ax=ax)),
            ("impacts", lambda ax: impacts(run, ax=ax)),
            ("losses", lambda ax: losses(run, ax=ax)),
        ]
        try:
            for ax, (title, draw) in zip(axes.flat, panels, strict=True):
                try:
                    draw(ax)
                except ChaindriveError as reason:
                    _instead(ax, title, str(reason))
        except BaseException:
            pyplot.close(figure)
            raise
        title = str(run.attrs.get("title", ""))
        # The panel of the drive would say it a second time.
        axes.flat[0].set_title("")
        figure.suptitle(title)
    return figure


def orders(run: xr.Dataset, *, ax: Axes) -> None:
    """Draw the orders of the driver up to some three times its teeth."""
    driver = driver_of(run)
    pull = tightest_span(run)
    spread = order_spectrum(run, pull, driver)
    spectrum(spread, ax=ax, up_to=3.2 * mesh_order_of(run, driver))
    ax.set_title(str(pull["span"].item()))


def _instead(ax: Axes, title: str, reason: str) -> None:
    """Write why a panel is not drawn."""
    ax.clear()
    ax.set_axis_off()
    ax.set_title(title)
    told = textwrap.fill(reason, 42)
    ax.text(0.5, 0.5, told, transform=ax.transAxes, ha="center", va="center", fontsize="small")
