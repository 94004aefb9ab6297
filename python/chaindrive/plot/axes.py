"""Axes to draw into."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def given_or_new(ax: Axes | None) -> Axes:
    """Return the axes that were given, or new ones."""
    if ax is not None:
        return ax
    try:
        from matplotlib import pyplot
    except ImportError as error:
        message = "plots take the package matplotlib: pip install 'chaindrive[plot]'"
        raise ImportError(message) from error
    _, ax = pyplot.subplots(layout="constrained")
    return ax
