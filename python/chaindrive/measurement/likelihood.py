"""How far parameters may be from an optimum, where the drive is not straight: profiles of χ²."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from chaindrive.measurement.fitting import Fit, Optimum

__all__ = ["Sides", "alike", "reach_of", "sides_of"]

_Floats = NDArray[np.float64]

#: Points of each side, in half widths of the interval that a straight drive has [–]: beyond that of
#: a straight one too, for what bends may come back.
_POINTS = (1.0, 2.0, 4.0)
#: How often the last of them is doubled while the record does not contradict it.
_DOUBLINGS = 4
#: Fall of χ² at which another valley is worth a fit [–].
_BETTER = 1.0


class Sides(NamedTuple):
    """What the record does not contradict on either side of an optimum."""

    below: _Floats
    """(p,) [half ranges], at least what a straight drive has."""
    above: _Floats
    better: _Floats | None
    """A point [SI] that explains the record better than the optimum (p,)."""


class _Side:
    """One side of one parameter: multiples of its half width, and what χ² rises by there."""

    def __init__(self, number: int, sign: float, room: float) -> None:
        self.number, self.sign, self.room = number, sign, room
        self.seen = {0.0: 0.0}
        self.wanted = sorted({min(it, room) for it in _POINTS})

    def take(self, rise: Sequence[float]) -> None:
        self.seen |= dict(zip(self.wanted, rise, strict=True))
        last = max(self.seen)
        is_open = self.seen[last] < 1.0 and last < min(self.room, _POINTS[-1] * 2.0**_DOUBLINGS)
        self.wanted = [min(2.0 * last, self.room)] if is_open else []

    @property
    def end(self) -> float:
        """Multiple at which χ² leaves what chance allows for good; 1 at least, but for bounds."""
        at = sorted(self.seen)
        inside = max(n for n, it in enumerate(at) if self.seen[it] < 1.0)
        if inside == len(at) - 1:
            return at[-1]
        low, high = at[inside], at[inside + 1]
        # The root of what χ² rises by is straight where the drive is.
        first, second = (np.sqrt(max(self.seen[it], 0.0)) for it in (low, high))
        return float(low + (1.0 - first) * (high - low) / max(second - first, 1e-12))


def sides_of(fit: Fit, best: Optimum, covariance: _Floats, t: _Floats) -> Sides:
    """Return how far each parameter may be on either side of an optimum.

    Points along ``x̂ ± s t_k Σ_k / √Σ_kk`` are run, on which a straight drive has the least χ² for
    their θ_k. The others then give way along the straight line at the optimum. An interval ends
    where χ² has risen by t² for good:

    ``min over θ_j, j ≠ k, of χ²(θ) − χ²(θ̂) = t²``

    It is never shorter than that of a straight drive, ``t √Σ_kk``.

    Parameters
    ----------
    fit, best
        The fit and its optimum.
    covariance
        Σ, of a straight drive (p, p) [half ranges squared].
    t
        Student's t of every parameter (p,).

    References
    ----------
    G. A. F. Seber and C. J. Wild, *Nonlinear Regression*, 1989, sec. 5.2: profiles.
    """
    width = t * np.sqrt(np.diag(covariance))
    along = t * covariance / np.sqrt(np.diag(covariance))
    residual = fit.residuals(best.x)
    every: list[_Side] = []
    for number in range(width.size):
        for sign, bound in ((-1.0, fit.low), (1.0, fit.high)):
            gap = abs(bound[number] - best.x[number]) / (width[number] * fit.half[number])
            every.append(_Side(number, sign, float(gap)))
    better, lowest = None, -_BETTER
    while any(it.wanted for it in every):
        asked = [(side, multiple) for side in every for multiple in side.wanted]
        points = [
            np.clip(
                best.x + side.sign * multiple * along[:, side.number] * fit.half,
                fit.low,
                fit.high,
            )
            for side, multiple in asked
        ]
        rises: dict[tuple[int, float], list[float]] = {}
        for (side, _), x, seen in zip(asked, points, fit.residuals_at(points), strict=True):
            rise = np.inf
            if seen is not None:
                others = np.delete(best.jacobian, side.number, axis=1)
                rise = _left(seen, others) - _left(residual, others)
                if rise < lowest:
                    better, lowest = x, rise
            key = (side.number, side.sign)
            rises.setdefault(key, []).append(rise / t[side.number] ** 2)
        for side in every:
            if side.wanted:
                side.take(rises[side.number, side.sign])
    ends = np.array([it.end for it in every]).reshape(-1, 2)
    below, above = np.maximum(ends, 1.0).T * width
    return Sides(below, above, better)


def alike(
    fit: Fit, optima: Sequence[Optimum], best: tuple[Optimum, Sides], t: _Floats
) -> list[tuple[Optimum, Sides]]:
    """Return the other valleys that explain the record alike, each with its own sides.

    χ² may rise there by ``t² − (χ²_v − χ²(θ̂))``. A valley within the sides of the best is taken for
    a part of it, and has none of its own.
    """
    optimum, sides = best
    low, high = (optimum.x + it * fit.half for it in (-sides.below, sides.above))
    found = []
    for other in optima:
        left = t**2 - 2.0 * (other.cost - optimum.cost)
        if (left > 0.0).all() and ((other.x < low) | (other.x > high)).any():
            covariance = np.asarray(np.linalg.pinv(other.jacobian.T @ other.jacobian), np.float64)
            found.append((other, sides_of(fit, other, covariance, np.sqrt(left))))
    return found


def reach_of(
    fit: Fit,
    valleys: Sequence[tuple[Optimum, Sides]],
    moved: _Floats,
    covariance: _Floats,
    t: _Floats,
) -> tuple[_Floats, _Floats]:
    """Return how far intervals reach below and above the best of all optima (p,) [SI].

    Parameters
    ----------
    fit, valleys
        The fit; its best optimum and those that explain the record alike, with their sides, or none
        of a straight drive.
    moved
        Move of the best optimum by a new choice of method, step and run-in (p,) [SI].
    covariance
        Σ, of a straight drive (p, p) [SI²].
    t
        Student's t of every parameter (p,).
    """
    straight = t * np.sqrt(np.diag(covariance))
    if not valleys:
        return straight, straight
    best = valleys[0][0].x
    low = np.min([it.x - sides.below * fit.half for it, sides in valleys], axis=0)
    high = np.max([it.x + sides.above * fit.half for it, sides in valleys], axis=0)
    below, above = (
        np.maximum(np.hypot(it, t * np.abs(moved)), straight) for it in (best - low, high - best)
    )
    return below, above


def _left(residual: _Floats, jacobian: _Floats) -> float:
    """Return the squares that are left where some parameters give way along a straight line."""
    basis, _ = np.linalg.qr(jacobian)
    left = residual - basis @ (basis.T @ residual)
    return float(left @ left)
