"""Plots: a drive, its chain at an instant, tensions over time, work against precision.

Needs the extra ``plot`` (matplotlib). Every function draws into the axes it is given, or into
new ones, and returns them; nothing is shown or saved.
"""

from __future__ import annotations

from chaindrive.plot.curves import tension, work_precision
from chaindrive.plot.drive import frame, layout

__all__ = ["frame", "layout", "tension", "work_precision"]


def __dir__() -> list[str]:
    return list(__all__)
