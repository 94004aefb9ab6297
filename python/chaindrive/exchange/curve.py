"""Plane curves of straights and circular arcs, as drawings exchange them.

A piece from s to e has a bulge b, as in DXF: it turns by θ to the left, and

    b = tan(θ / 4),   R = |e − s| (1 + b²) / (4 b),

so that zero is a straight, ±1 a half turn, and nothing is lost that an arc is made of.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from chaindrive import _core
from chaindrive.errors import ParameterError

if TYPE_CHECKING:
    from chaindrive.profile import Profile

__all__ = ["Curve", "curve_of", "joined", "turn_between"]

# A piece shorter than this part of its curve has no direction.
_NOTHING = 1e-9


class Curve(NamedTuple):
    """A curve of straights and arcs."""

    points: NDArray[np.float64]
    """Where pieces begin and end [m], (n, 2); a closed curve goes from the last to the first."""
    bulges: NDArray[np.float64]
    """Bulge of every piece [–], (n − 1,) or, of a closed curve, (n,)."""
    closed: bool
    """Whether the curve comes back to where it begins."""
    layer: str = ""
    """Layer of the drawing it stands on, or what it is."""

    @property
    def starts(self) -> NDArray[np.float64]:
        """Where every piece begins [m], (pieces, 2)."""
        return self.points[: len(self.bulges)]

    @property
    def ends(self) -> NDArray[np.float64]:
        """Where every piece ends [m], (pieces, 2)."""
        return np.roll(self.points, -1, axis=0)[: len(self.bulges)]

    @property
    def sweeps(self) -> NDArray[np.float64]:
        """How far every piece turns to the left [rad], (pieces,)."""
        return 4.0 * np.arctan(self.bulges)

    @property
    def radii(self) -> NDArray[np.float64]:
        """Radius of every piece [m], (pieces,), negative to the right, infinite of a straight."""
        chords = np.hypot(*(self.ends - self.starts).T)
        with np.errstate(divide="ignore"):
            return np.where(
                self.bulges == 0.0, np.inf, chords * (1.0 + self.bulges**2) / (4.0 * self.bulges)
            )

    @property
    def centres(self) -> NDArray[np.float64]:
        """Centre of every arc [m], (pieces, 2); not a number for a straight."""
        chords = self.ends - self.starts
        left = np.column_stack([-chords[:, 1], chords[:, 0]])
        # c = (s + e) / 2 + n |e − s| (1 − b²) / (4 b)
        with np.errstate(divide="ignore", invalid="ignore"):
            rise = (1.0 - self.bulges**2) / (4.0 * self.bulges)
            middles = 0.5 * (self.starts + self.ends)
            return np.where(self.bulges[:, None] == 0.0, np.nan, middles + left * rise[:, None])

    @property
    def _exact(self) -> _core.Profile:
        """The curve of the core, without pieces that are next to nothing."""
        corners = np.ascontiguousarray(self.points, dtype=float)
        return _core.Profile.with_bulges(corners, np.ascontiguousarray(self.bulges, dtype=float))

    @property
    def length(self) -> float:
        """Length along the curve [m]."""
        return self._exact.length

    @property
    def area(self) -> float:
        """Area that a closed curve encloses [m²], positive where it runs counter-clockwise."""
        return self._exact.area()[0]

    @property
    def centroid(self) -> NDArray[np.float64]:
        """Centre of the area that a closed curve encloses [m], (2,)."""
        return np.array(self._exact.area()[1])

    def directions(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the directions [rad] in which every piece begins and ends, (pieces,) each."""
        dx, dy = (self.ends - self.starts).T
        along = np.arctan2(dy, dx)
        return along - 0.5 * self.sweeps, along + 0.5 * self.sweeps

    def reversed(self) -> Curve:
        """Return the curve run through the other way."""
        points = self.points[::-1]
        if self.closed:
            points = np.roll(points, 1, axis=0)
        return self._replace(points=points, bulges=-self.bulges[::-1])

    def stretch(self, start: ArrayLike, end: ArrayLike) -> Curve:
        """Return the open stretch of the curve from one place to another, in the sense of its run.

        Parameters
        ----------
        start, end : (2,)
            Places near the curve [m], such as the corners of the face of a shoe.

        Raises
        ------
        ParameterError
            The curve is open, and the end lies before the start.
        """
        exact = self._exact
        ends = np.array([start, end], dtype=float)
        (begin, stop), _, (first, last) = exact.closest(ends)
        if last < first:
            if not self.closed:
                message = "the end of the stretch lies before its start"
                raise ParameterError(message, "end", "swap them, or reverse the curve")
            last += exact.length
        chords = np.hypot(*(self.ends - self.starts).T)
        with np.errstate(invalid="ignore"):
            arcs = np.abs(self.radii * self.sweeps)
        lengths = np.tile(np.where(self.bulges == 0.0, chords, arcs), 1 + self.closed)
        knots = np.concatenate([np.zeros(1), np.cumsum(lengths)])
        between = np.flatnonzero((knots > first) & (knots < last))
        along = np.concatenate([[first], knots[between], [last]])
        corners = np.vstack([begin, self.points[between % len(self.points)], stop])
        # Of a piece that the stretch touches at its very end there is nothing.
        some = np.diff(along) > _NOTHING * exact.length
        piece = np.searchsorted(knots, 0.5 * (along[:-1] + along[1:])) - 1
        sweeps = np.tile(self.sweeps, 1 + self.closed)[piece] * np.diff(along) / lengths[piece]
        points = corners[np.concatenate([[True], some])]
        return self._replace(points=points, bulges=np.tan(0.25 * sweeps[some]), closed=False)

    def moved(
        self, by: ArrayLike = (0.0, 0.0), *, turned: float = 0.0, scaled: float = 1.0
    ) -> Curve:
        """Return the curve scaled and turned [rad] about the origin, then moved [m]."""
        c, s = np.cos(turned), np.sin(turned)
        points = scaled * self.points @ np.array([[c, s], [-s, c]]) + np.asarray(by, dtype=float)
        return self._replace(points=points)

    def outline(self, tolerance: float = 1e-5) -> NDArray[np.float64]:
        """Return the points of a polyline along the curve, (m, 2) [m].

        Parameters
        ----------
        tolerance
            How far its chords may stand off the curve [m].
        """
        return self._exact.outline(tolerance)

    def distance(self, points: ArrayLike) -> NDArray[np.float64]:
        """Return the distances [m] of points (m, 2) from the curve, (m,), none negative."""
        places = np.ascontiguousarray(points, dtype=float).reshape(-1, 2)
        return np.abs(self._exact.distance(places))


def joined(curves: list[Curve], gap: float) -> Curve:
    """Return open curves as one, each of which begins where the one before ends.

    The whole is closed where its ends are no farther apart than a gap [m].
    """
    last = curves[-1].points[-1:]
    places = [curve.points[:-1] for curve in curves]
    closed = bool(np.hypot(*(last[0] - places[0][0])) <= gap)
    corners = np.concatenate(places if closed else [*places, last])
    bulges = np.concatenate([curve.bulges for curve in curves])
    return Curve(corners, bulges, closed, curves[0].layer)


def curve_of(profile: Profile, layer: str = "") -> Curve:
    """Return the profile of a sprocket or guide as a curve, its arcs as arcs."""
    corners, bulges = profile._inner.bulges()
    return Curve(corners, bulges, profile.closed, layer)


def turn_between(first: NDArray[np.float64], last: NDArray[np.float64], sense: float) -> float:
    """Return the angle from one direction to another in a sense of turning [rad], in [0, 2π)."""
    turn = np.arctan2(last[1], last[0]) - np.arctan2(first[1], first[0])
    turned = float((np.sign(sense) * turn) % (2.0 * np.pi))
    # What rounding puts before the start is the start.
    return turned if turned < 2.0 * np.pi - 1e-12 else 0.0
