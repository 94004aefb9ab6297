"""Plane curves of straights and circular arcs, as drawings exchange them.

A piece from s to e has a bulge b, as in DXF: it turns by θ to the left, and

    b = tan(θ / 4),   R = |e − s| (1 + b²) / (4 b),

so that zero is a straight, ±1 a half turn, and nothing is lost that an arc is made of.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from chaindrive.errors import ParameterError

if TYPE_CHECKING:
    from chaindrive.profile import Profile

__all__ = ["Curve", "curve_of", "joined", "turn_between"]

# Chords by which a profile is read stand off by this part of its length.
_CHORD = 1e-5
# Neighbours belong to one arc when their curvatures agree to this part, and their directions to
# this angle [rad]: distances from which they are found are exact to some 1e-16 m.
_SAME_CURVATURE = 1e-6
_SAME_DIRECTION = 1e-7
# A piece shorter than this part of its curve has no direction.
_NOTHING = 1e-9
# An arc of more than a half turn is poorly given by its ends.
_LARGEST_SWEEP = 0.9 * np.pi


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
    def length(self) -> float:
        """Length along the curve [m]."""
        chords = np.hypot(*(self.ends - self.starts).T)
        with np.errstate(invalid="ignore"):
            arcs = np.abs(self.radii * self.sweeps)
        return float(np.where(self.bulges == 0.0, chords, arcs).sum())

    @property
    def area(self) -> float:
        """Area that a closed curve encloses [m²], positive where it runs counter-clockwise."""
        (x0, y0), (x1, y1) = self.starts.T, self.ends.T
        # ½ Σ (s × e) + ½ Σ R² (θ − sin θ)
        curved = self.bulges != 0.0
        caps = self.radii[curved] ** 2 * (self.sweeps[curved] - np.sin(self.sweeps[curved]))
        return 0.5 * float(np.sum(x0 * y1 - x1 * y0) + caps.sum())

    @property
    def centroid(self) -> NDArray[np.float64]:
        """Centre of the area that a closed curve encloses [m], (2,)."""
        starts, ends = self.starts, self.ends
        twice = starts[:, 0] * ends[:, 1] - ends[:, 0] * starts[:, 1]
        # ∫ x dA = Σ (s + e) (s × e) / 6 over the triangles at the origin,
        moment = ((starts + ends) * twice[:, None]).sum(axis=0) / 6.0
        # and ½ R² (θ − sin θ) c + ⅔ R² sin³(½ θ) (m − c) over caps from chord to arc, m its middle.
        curved = self.bulges != 0.0
        radii, sweeps, centres = self.radii[curved], self.sweeps[curved], self.centres[curved]
        c, s = np.cos(0.5 * sweeps), np.sin(0.5 * sweeps)
        x, y = (starts[curved] - centres).T
        middles = np.column_stack([c * x - s * y, s * x + c * y])
        moment += (0.5 * radii**2 * (sweeps - np.sin(sweeps))) @ centres
        moment += (2.0 / 3.0 * radii**2 * s**3) @ middles
        return np.asarray(moment / self.area)

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
        (first, begin), (last, stop) = self._nearest(start), self._nearest(end)
        count = len(self.bulges)
        behind = first == last and self._along(last, stop) < self._along(first, begin)
        if not self.closed and (last < first or behind):
            message = "the end of the stretch lies before its start"
            raise ParameterError(message, "end", "swap them, or reverse the curve")
        steps = (last - first) % count if not behind else count
        order = [(first + step) % count for step in range(steps + 1)]
        points, bulges = [begin], []
        for step, piece in enumerate(order):
            reached = stop if step == steps else self.ends[piece]
            # Of a piece that the stretch touches at its very end there is nothing.
            if np.hypot(*(reached - points[-1])) > _NOTHING * self.length:
                bulges.append(self._bulge_between(piece, points[-1], reached))
                points.append(reached)
        return self._replace(points=np.array(points), bulges=np.array(bulges), closed=False)

    def _nearest(self, place: ArrayLike) -> tuple[int, NDArray[np.float64]]:
        """Return the piece nearest to a place, and the place on it, (2,)."""
        at = np.asarray(place, dtype=float)
        found: list[tuple[float, int, NDArray[np.float64]]] = []
        rows = zip(self.starts, self.ends, self.sweeps, self.radii, self.centres, strict=True)
        for piece, (start, end, sweep, radius, centre) in enumerate(rows):
            on = [start, end]
            if sweep == 0.0:
                along = end - start
                on.append(start + np.clip((at - start) @ along / (along @ along), 0, 1) * along)
            elif (at != centre).any():
                foot = centre + abs(radius) * (at - centre) / np.hypot(*(at - centre))
                if turn_between(start - centre, foot - centre, sweep) <= abs(sweep):
                    on.append(foot)
            found += [(float(np.hypot(*(at - foot))), piece, foot) for foot in on]
        _, piece, foot = min(found, key=lambda it: it[:2])
        return piece, foot

    def _along(self, piece: int, place: NDArray[np.float64]) -> float:
        """Return how far along a piece a place on it lies, in whatever measure."""
        if self.bulges[piece] == 0.0:
            return float(np.hypot(*(place - self.starts[piece])))
        centre = self.centres[piece]
        return turn_between(self.starts[piece] - centre, place - centre, self.bulges[piece])

    def _bulge_between(
        self, piece: int, start: NDArray[np.float64], end: NDArray[np.float64]
    ) -> float:
        """Return the bulge of a part of a piece."""
        bulge = self.bulges[piece]
        if bulge == 0.0:
            return 0.0
        centre = self.centres[piece]
        turn = turn_between(start - centre, end - centre, bulge)
        return float(np.sign(bulge) * np.tan(0.25 * turn))

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
        found = [self.points[:1]]
        rows = zip(self.starts, self.ends, self.bulges, self.radii, self.centres, strict=True)
        for start, end, bulge, radius, centre in rows:
            if bulge != 0.0:
                sweep = 4.0 * np.arctan(bulge)
                # A chord over φ stands off by R (1 − cos ½φ).
                largest = 2.0 * np.arccos(max(1.0 - tolerance / abs(radius), 0.0))
                count = int(np.ceil(abs(sweep) / largest))
                x, y = start - centre
                angles = np.arctan2(y, x) + sweep * np.arange(1, count) / count
                rim = np.column_stack([np.cos(angles), np.sin(angles)])
                found.append(centre + abs(radius) * rim)
            found.append(end[None])
        return np.concatenate(found)

    def distance(self, points: ArrayLike) -> NDArray[np.float64]:
        """Return the distances [m] of points (m, 2) from the curve, (m,), none negative."""
        places = np.asarray(points, dtype=float).reshape(-1, 2)
        least = np.full(len(places), np.inf)
        rows = zip(self.starts, self.ends, self.bulges, self.radii, self.centres, strict=True)
        for start, end, bulge, radius, centre in rows:
            along, from_start = end - start, places - start
            if bulge == 0.0:
                share = np.clip(from_start @ along / (along @ along), 0.0, 1.0)
                away = np.hypot(*(from_start - share[:, None] * along).T)
            else:
                x, y = (places - centre).T
                first = np.arctan2(*(start - centre)[::-1])
                turned = np.sign(bulge) * (np.arctan2(y, x) - first) % (2.0 * np.pi)
                beside = turned <= abs(4.0 * np.arctan(bulge))
                ends = np.minimum(np.hypot(*from_start.T), np.hypot(*(places - end).T))
                away = np.where(beside, np.abs(np.hypot(x, y) - abs(radius)), ends)
            least = np.minimum(least, away)
        return least


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
    """Return the profile of a sprocket or guide as a curve, its arcs as arcs.

    Raises
    ------
    ParameterError
        The profile is finer than chords of it can be told apart.
    """
    corners = profile.outline(_CHORD * profile.length)
    starts, ends = corners[:-1], corners[1:]
    # The middle of a chord is as far from its arc as the arc rises over it: b = 2 h / |e − s|.
    rise = -np.asarray(profile.distance(0.5 * (starts + ends)))
    bulges = 2.0 * rise / np.hypot(*(ends - starts).T)
    straight = np.abs(bulges) < _SAME_DIRECTION
    bulges = np.where(straight, 0.0, bulges)
    curve = _merged(Curve(corners, bulges, False, layer))
    if not profile.closed:
        return curve
    closed = curve._replace(points=curve.points[:-1], closed=True)
    if closed.area <= 0.0:
        message = f"the profile of `{profile.name}` is finer than {_CHORD:g} of its length"
        raise ParameterError(message, "profile", "give a coarser one")
    return closed


def _merged(curve: Curve) -> Curve:
    """Return an open curve with neighbours that lie on one arc made one piece."""
    begins, ends = curve.directions()
    curvatures = np.where(curve.bulges == 0.0, 0.0, 1.0 / curve.radii)
    points, sweeps = [curve.points[0]], [0.0]
    last = None
    for piece, (sweep, curvature) in enumerate(zip(curve.sweeps, curvatures, strict=True)):
        turn = 0.0 if last is None else _angle(begins[piece] - ends[piece - 1])
        same = (
            last is not None
            and abs(turn) < _SAME_DIRECTION
            and abs(curvature - last) <= _SAME_CURVATURE * abs(last)
            and abs(sweeps[-1] + sweep) < _LARGEST_SWEEP
        )
        if same:
            points[-1] = curve.points[piece + 1]
            sweeps[-1] += sweep
        else:
            points.append(curve.points[piece + 1])
            sweeps.append(sweep)
            last = curvature
    return curve._replace(points=np.array(points), bulges=np.tan(0.25 * np.array(sweeps[1:])))


def turn_between(first: NDArray[np.float64], last: NDArray[np.float64], sense: float) -> float:
    """Return the angle from one direction to another in a sense of turning [rad], in [0, 2π)."""
    turn = np.arctan2(last[1], last[0]) - np.arctan2(first[1], first[0])
    turned = float((np.sign(sense) * turn) % (2.0 * np.pi))
    # What rounding puts before the start is the start.
    return turned if turned < 2.0 * np.pi - 1e-12 else 0.0


def _angle(turn: float) -> float:
    """Return an angle in (−π, π]."""
    return float(np.pi - (np.pi - turn) % (2.0 * np.pi))
