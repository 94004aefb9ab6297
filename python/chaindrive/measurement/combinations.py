"""Combinations of parameters that derivatives leave in doubt, told by runs along them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from chaindrive.measurement.identifiability import Identifiability

__all__ = ["told_by_runs"]

_Floats = NDArray[np.float64]

#: Slopes of whitened residuals (designs, residuals) over a long step along a direction (p,) [half
#: ranges], by so many designs.
_Moved = Callable[[_Floats, int], _Floats]

#: Number of times that clear combinations are taken off one in doubt at most, and a share of them
#: that is little enough [–].
_CORRECTIONS, _RIGHT = 12, 3e-4


def told_by_runs(
    found: Identifiability, jacobian: _Floats, moved: _Moved, designs: int
) -> Identifiability:
    """Return the same, with combinations that are in doubt told by runs along them.

    The ends of such a combination are run, so that two parameters of which the drive knows only
    the sum or the product make the same run twice. The clearest comes first: where another one
    moves the record as it does, it holds some of it, which is taken off.

    Parameters
    ----------
    found
        By derivatives of two designs.
    jacobian
        These, of whitened residuals by half ranges (residuals, p).
    moved
        What runs along a direction move.
    designs
        Designs that tell each combination.
    """
    size = np.linalg.norm(jacobian, axis=0)
    slopes = jacobian @ found.directions
    clear = found.is_clear
    for n in np.flatnonzero(found.is_in_doubt)[::-1]:
        direction, local = _purged(
            found.directions[:, n], found.directions[:, clear], slopes[:, clear], moved
        )
        direction = direction / np.linalg.norm(direction * size)
        rows = moved(direction, designs)
        slopes[:, n] = rows.mean(axis=0)
        # λ = |P r|², P without the slopes of clear combinations, r the mean of the designs.
        basis, _ = np.linalg.qr(local)
        rows = rows - (rows @ basis) @ basis.T
        mean, noise = rows.mean(axis=0), rows.var(axis=0, ddof=1) / len(rows)
        found = found.seen_along(n, direction, float(mean @ mean), float(noise.sum()))
        clear[n] = not found.is_lost[n]
    return found


def _purged(
    direction: _Floats, clear: _Floats, slopes: _Floats, moved: _Moved
) -> tuple[_Floats, _Floats]:
    """Return a direction that moves least without clear ones, and what these move beside it.

    Slopes of clear directions bend over a long step: what each correction has taken off sets them
    right for the next (Broyden).

    Parameters
    ----------
    direction
        The direction (p,) [half ranges].
    clear, slopes
        Clear directions (p, clear) [half ranges], and their slopes (residuals, clear).
    moved
        What runs along a direction move.

    References
    ----------
    C. G. Broyden, *Math. Comp.* **19**, 1965, 577–593.
    """
    own = moved(direction, 2).mean(axis=0)
    best = (float(np.linalg.norm(own)), direction, slopes)
    for _ in range(_CORRECTIONS):
        held, *_ = np.linalg.lstsq(slopes, own)
        if min(float(np.linalg.norm(held)), best[0]) < _RIGHT:
            break
        direction = direction - clear @ held
        left = moved(direction, 2).mean(axis=0)
        # S ← S + (Δ − S h) hᵀ / |h|², Δ what the correction h has taken off.
        slopes = slopes + np.outer(own - left - slopes @ held, held) / (held @ held)
        own = left
        size = float(np.linalg.norm(own))
        if size < best[0]:
            best = (size, direction, slopes)
    return best[1:]
