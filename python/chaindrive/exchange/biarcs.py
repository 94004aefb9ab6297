"""Smooth curves as arcs: pairs of arcs that begin and end with a curve, in place and direction.

Source: K. M. Bolton, *Computer-Aided Design* **7**(2), 1975, 83-92.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from chaindrive import _core
from chaindrive.errors import ParameterError
from chaindrive.exchange.curve import Curve

__all__ = ["biarcs"]

_Vector: TypeAlias = NDArray[np.float64]

# Places between the ends of a pair of arcs at which its distance from the curve is measured.
_PLACES = 16
# A curve that needs shorter pieces than 2⁻²⁰ of a stretch has a cusp.
_HALVINGS = 20


def biarcs(
    along: Callable[[float], tuple[_Vector, _Vector]],
    knots: Sequence[float],
    tolerance: float,
    layer: str = "",
) -> Curve:
    """Return arcs that stand off a smooth curve by no more than a tolerance.

    Parameters
    ----------
    along
        Place and derivative at a parameter, (2,) each.
    knots
        Parameters at which the curve begins, may have a corner, and ends; ascending.
    tolerance
        Largest distance of the curve from the arcs, in the unit of the places, measured at 16
        places a pair.
    layer
        Of the curve returned.

    Raises
    ------
    ParameterError
        The curve has a cusp.
    """
    points: list[_Vector] = [along(knots[0])[0]]
    bulges: list[float] = []
    for first, last in pairwise(knots):
        _fit(along, first, last, tolerance, _HALVINGS, points, bulges)
    return Curve(np.array(points), np.array(bulges), False, layer)


def _fit(
    along: Callable[[float], tuple[_Vector, _Vector]],
    first: float,
    last: float,
    tolerance: float,
    halvings: int,
    points: list[_Vector],
    bulges: list[float],
) -> None:
    # At a knot the directions before and after may differ: those within the stretch count.
    inside = 1e-9 * (last - first)
    start, end = along(first)[0], along(last)[0]
    pair = _pair(start, along(first + inside)[1], end, along(last - inside)[1])
    if pair is not None:
        parameters = np.linspace(first, last, _PLACES + 2)[1:-1]
        places = np.array([along(parameter)[0] for parameter in parameters])
        if pair.distance(places).max() <= tolerance:
            points += [pair.points[1], pair.points[2]]
            bulges += list(pair.bulges)
            return
    if halvings == 0:
        x, y = start
        raise ParameterError(
            f"the curve has a cusp near ({x:g}, {y:g}) of the drawing",
            "tolerance",
            "allow more, or mend the drawing",
        )
    middle = 0.5 * (first + last)
    _fit(along, first, middle, tolerance, halvings - 1, points, bulges)
    _fit(along, middle, last, tolerance, halvings - 1, points, bulges)


def _pair(start: _Vector, begin: _Vector, end: _Vector, arrive: _Vector) -> Curve | None:
    """Return two arcs with given ends and directions, equally far to where they meet."""
    lengths = np.hypot(*begin), np.hypot(*arrive)
    if min(lengths) == 0.0:
        return None
    found = _core.biarc(start, begin / lengths[0], end, arrive / lengths[1])
    if found is None:
        return None
    joint, bulges = found
    return Curve(np.array([start, joint, end]), np.array(bulges), False)
