"""Other valleys of a fit, on a surface that is interpolated through all of its runs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from chaindrive.errors import SimulationError
from chaindrive.extras import extra
from chaindrive.measurement.fitting import Fit, Optimum, apart

__all__ = ["searched"]

_Floats = NDArray[np.float64]

#: Number of times that the surface is made anew, with runs at the bottoms of its valleys [–]
#: (assumed: it has settled by then).
_ROUNDS = 5
#: Valleys of the surface that are run each time, and fits that go from them, at most [–].
_RUN, _FITS = 4, 2
#: Searches at most [–] (assumed): each is on a surface with the runs of the last one's fits.
_PASSES = 3
#: Excess of the χ² of an optimum over that of a run beside it from which the optimum does not match
#: [–] (assumed, the square of one error): on a rough χ² fits end too early.
_DEEPER = 1.0
#: Distance of runs that are taken into the surface [half ranges]: nearer ones differ by noise.
_GRAIN = 0.04
#: Distance of two valleys [half ranges].
_APART = 0.2
#: Multiple of the least χ², or of the number of residuals, below which a bottom is worth a fit [–]
#: (assumed): the surface is a few errors off.
_WORTH = 3.0
#: Where the search over the surface begins, beside the best runs: number and seed.
_BEGINNINGS, _BEST, _SEED = 40, 10, 58


class _Valley(NamedTuple):
    """A valley of the surface."""

    chi2: float
    x: _Floats
    """Parameters [SI] (p,)."""


def searched(fit: Fit, optima: Sequence[Optimum]) -> list[Optimum]:
    """Return optima with those of other valleys, the best first.

    A few starts miss valleys of a parameter that moves little. Thin plate splines interpolate the
    features of all runs so far, and their χ² costs next to nothing. Runs at the bottoms of its
    valleys set it right; fits go from deep bottoms that no optimum beside them matches.

    References
    ----------
    H.-M. Gutmann, *J. Global Optim.* **19**, 2001, 201-227: radial basis functions that foretell
    where a costly function is least.
    """
    found = list(optima)
    for _ in range(_PASSES):
        bottoms: list[_Floats] = []
        for _ in range(_ROUNDS):
            bottoms = [it.x for it in _valleys(fit)]
            fit.features(bottoms)
        more = _fitted(fit, found, bottoms)
        if not more:
            break
        # Runs of these fits have changed the surface.
        found = apart([*found, *more], fit.half)
    return found


def _fitted(fit: Fit, found: Sequence[Optimum], bottoms: Sequence[_Floats]) -> list[Optimum]:
    """Return the optima of fits from deep bottoms that no optimum beside them matches."""
    deepest = _WORTH * max(2.0 * found[0].cost, float(fit.known.sum()))
    more: list[Optimum] = []
    for x, residual in zip(bottoms, fit.residuals_at(bottoms), strict=True):
        chi2 = np.inf if residual is None else float(residual @ residual)
        is_new = all(
            _distance(fit, x, it.x) > _APART or chi2 < 2.0 * it.cost - _DEEPER
            for it in [*found, *more]
        )
        if is_new and chi2 < deepest and len(more) < _FITS:
            try:
                more.append(fit.optimum(x, is_near=True))
            except SimulationError:
                # A way that leads where nothing runs leads to no optimum.
                continue
    return more


def _valleys(fit: Fit) -> list[_Valley]:
    """Return the deepest valleys of the surface through all runs; none where these are few."""
    points, features = _spread(fit)
    count = len(fit.parameters)
    if len(points) <= 2 * count:
        return []
    surface = extra("scipy.interpolate", "fits").RBFInterpolator(points / fit.half, features)
    runs = zip(points, features, strict=True)
    chi2 = [float(np.sum(fit.residual(y, x) ** 2)) for x, y in runs]
    share = extra("scipy.stats", "fits").qmc.LatinHypercube(count, rng=_SEED).random(_BEGINNINGS)
    begins = [*(fit.low + share * (fit.high - fit.low)), *points[np.argsort(chi2)[:_BEST]]]
    found = [_bottom(fit, surface, x) for x in begins]
    deepest: list[_Valley] = []
    for it in sorted(found, key=lambda it: it.chi2):
        if all(_distance(fit, it.x, one.x) > _APART for one in deepest):
            deepest.append(it)
    return deepest[:_RUN]


def _bottom(fit: Fit, surface: Callable[[_Floats], _Floats], begin: _Floats) -> _Valley:
    """Return the place where the χ² of a surface is least, downhill from a point [SI]."""
    found = extra("scipy.optimize", "fits").least_squares(
        lambda u: fit.residual(surface(u[None])[0], u * fit.half),
        np.clip(begin, fit.low + 1e-3 * fit.half, fit.high - 1e-3 * fit.half) / fit.half,
        bounds=(fit.low / fit.half, fit.high / fit.half),
        ftol=1e-3,
        xtol=1e-3,
        gtol=1e-3,
    )
    # Whoever solves with another rounding runs the same point.
    x = np.clip(np.round(found.x, 6) * fit.half, fit.low, fit.high)
    return _Valley(2.0 * float(found.cost), x)


def _spread(fit: Fit) -> tuple[_Floats, _Floats]:
    """Return runs that are not next to each other, the last before the first: points, features."""
    points: list[_Floats] = []
    features = []
    for x, seen in reversed(fit.seen()):
        if all(_distance(fit, x, it) > _GRAIN for it in points):
            points.append(x)
            features.append(seen)
    return np.array(points), np.array(features)


def _distance(fit: Fit, x: _Floats, other: _Floats) -> float:
    """Return the largest difference of two points [half ranges]."""
    return float(np.abs((x - other) / fit.half).max())
