"""The colour scheme of every picture: plots, layouts, movies, SVG files, replays, documentation.

Paper is transparent, and every colour is seen on white and on nearly black alike: a figure follows
the page that shows it. ``docs/matplotlibrc``, the style of SVG files and that of replays repeat
these colours; a test holds them together.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

__all__ = [
    "CARRIER",
    "CURVES",
    "FORCE",
    "GUIDE",
    "INK",
    "LIMIT",
    "MARK",
    "OUTLINE",
    "PLATES",
    "STEEL",
    "STYLE",
]


INK = "#767e87"
"""Text and axes."""
STEEL = "#8d99a6"
"""Faces of steel, and lines of the grid; both faint."""
OUTLINE = "#6b7784"
"""Outlines of what is drawn to scale."""
GUIDE = "#b9702c"
"""Guides."""
CARRIER = "#7d8a52"
"""Arms, slides and plungers of tensioners."""
MARK = "#d6324a"
"""What is wrong or looked for: gaps, clashes, loads above a limit, an optimum."""
CURVES = (
    "#2f7ec2",
    "#d0661c",
    "#2f9148",
    "#a45fc0",
    "#14899c",
    "#cf4a7c",
    "#7d8c1f",
    "#767e87",
)
"""Curves, in this order."""
PLATES = CURVES[0]
"""Link plates without a tension."""
FORCE = CURVES[5]
"""Arrows of forces on centres and carriers."""
LIMIT = INK
"""Lines of limits and references."""

STYLE: Mapping[str, Any] = MappingProxyType(
    {
        "figure.facecolor": "none",
        "axes.facecolor": "none",
        "savefig.facecolor": "auto",
        "text.color": INK,
        "axes.edgecolor": INK,
        "axes.labelcolor": INK,
        "xtick.color": INK,
        "ytick.color": INK,
        "grid.color": STEEL,
        "grid.alpha": 0.35,
        "axes.prop_cycle": f"cycler('color', {list(CURVES)})",
        "axes.spines.top": False,
        "axes.spines.right": False,
        "axes.titlesize": "medium",
        "legend.fontsize": "small",
        "legend.frameon": False,
        "lines.linewidth": 1.2,
    }
)
"""Settings of matplotlib in which everything is drawn: ``with rc_context(plot.STYLE): …``."""
