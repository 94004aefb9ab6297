"""Axes to draw into."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from chaindrive.extras import extra

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def given_or_new(ax: Axes | None) -> Axes:
    """Return the axes that were given, or new ones."""
    if ax is not None:
        return ax
    _, ax = extra("matplotlib.pyplot", "plots").subplots(layout="constrained")
    return cast("Axes", ax)
