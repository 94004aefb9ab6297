"""Axes to draw into."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, cast

from chaindrive.extras import extra
from chaindrive.plot.scheme import STYLE

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.cm import ScalarMappable

__all__ = ["colour_bar", "drawing", "legend_below"]


@contextmanager
def drawing(ax: Axes | None) -> Iterator[Axes]:
    """Yield the axes that were given, or new ones, in the colours of the scheme.

    A new figure is closed again when what should be drawn raises.
    """
    pyplot = extra("matplotlib.pyplot", "plots")
    with pyplot.rc_context(dict(STYLE)):
        if ax is not None:
            yield ax
            return
        figure, new = pyplot.subplots(layout="constrained")
        try:
            yield cast("Axes", new)
        except BaseException:
            pyplot.close(figure)
            raise


def legend_below(ax: Axes, title: str | None = None) -> None:
    """Put the legend below the axes, where it covers nothing."""
    handles, names = ax.get_legend_handles_labels()
    if not names:
        return
    # As many beside each other as a line of some seventy letters holds.
    widest = max(len(str(name)) for name in names) + 6
    ax.legend(
        handles,
        names,
        title=title,
        loc="upper center",
        bbox_to_anchor=(0.5, -0.16),
        ncols=max(1, min(len(names), 72 // widest)),
    )


def colour_bar(ax: Axes, mesh: ScalarMappable, label: str) -> None:
    """Put a colour bar beside the axes."""
    figure = ax.get_figure()
    if figure is not None:
        figure.colorbar(mesh, ax=ax, label=label)
