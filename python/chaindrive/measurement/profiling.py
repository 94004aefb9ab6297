"""Profiles of a fit: what it leaves where a parameter is held and all others are fitted again."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from chaindrive.extras import extra
from chaindrive.measurement.fitting import Fit, Optimum

__all__ = ["Profile", "profiled"]

_Floats = NDArray[np.float64]

#: Places at which a parameter is held, on either side, in half widths of its interval [–].
_PLACES = (0.5, 1.0, 1.5)


class Profile(NamedTuple):
    """What is left where a parameter is held."""

    values: _Floats
    """Where it is held, ascending, the optimum in the middle (points,) [SI]."""
    chi2: _Floats
    """χ² there, less that of the optimum (points,) [–]; NaN beyond a bound."""
    lower: float
    """Where it exceeds t² (SI); minus infinity where that is not within the bounds and places."""
    upper: float


def profiled(fit: Fit, best: Optimum, n: int, error: float, t: float) -> Profile:
    """Return the profile of a parameter, and its interval, on which ``χ²(θ) − χ² ≤ t²``.

    Parameters
    ----------
    fit, best
        The fit and its optimum.
    n
        Which parameter.
    error
        Its standard error [SI], which gives the places.
    t
        Student's t of the level of the interval.

    References
    ----------
    D. M. Bates and D. G. Watts, *Nonlinear Regression Analysis and Its Applications*, 1988, ch. 6.
    """
    sides = []
    for side in (-1.0, 1.0):
        x, at, left = best.x, [], []
        for place in _PLACES:
            value = best.x[n] + side * place * t * error
            if not fit.low[n] <= value <= fit.high[n]:
                value = math.nan
            at.append(value)
            if math.isnan(value):
                left.append(math.nan)
                continue
            held = x.copy()
            held[n] = value
            found = fit.held(held, n)
            # The next one begins where this one ended.
            x = found.x
            left.append(2.0 * max(found.cost - best.cost, 0.0))
        sides.append((np.array(at), np.array(left)))
    (below, left_below), (above, left_above) = sides
    return Profile(
        np.concatenate([below[::-1], [best.x[n]], above]),
        np.concatenate([left_below[::-1], [0.0], left_above]),
        _crossed(best.x[n], below, left_below, t, -math.inf),
        _crossed(best.x[n], above, left_above, t, math.inf),
    )


def _crossed(middle: float, at: _Floats, chi2: _Floats, t: float, beyond: float) -> float:
    """Return where √Δχ², which is nearly straight, reaches t on one side."""
    known = np.isfinite(chi2)
    roots = np.concatenate([[0.0], np.sqrt(chi2[known])])
    values = np.concatenate([[middle], at[known]])
    if roots[-1] < t or (np.diff(roots) <= 0.0).any():
        return beyond
    curve = extra("scipy.interpolate", "profiles of fits").PchipInterpolator(roots, values)
    return float(curve(t))
