"""The part of a record that was not fitted, held against the fit."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from chaindrive.measurement.fitting import Fit, Optimum, Worth, chance, drawn, joined, rooted

__all__ = ["Kept", "validated"]

_Floats = NDArray[np.float64]


class Kept(NamedTuple):
    """What was kept, beside what the fit foretells."""

    names: list[str]
    measured: _Floats
    """(features,) [unit of the feature]"""
    simulated: _Floats
    error: _Floats
    """Standard error of their difference, that of the parameters with it."""
    p_value: float
    """Chance of so large a difference by errors alone [–]."""
    verdict: str
    """``holds``, ``misses`` or ``cannot tell``."""


def validated(fit: Fit, best: Optimum, worth: Worth, level: float) -> Kept | None:
    """Return how a fit stands beside what was kept; None where nothing was.

    Parameters
    ----------
    fit, best, worth
        The fit, its optimum and what that is worth.
    level
        Level of the test [–].
    """
    if not any(it.kept for it in fit.experiments):
        return None
    errors = joined([it.errors(it.run, kept=True) for it in fit.experiments])
    (simulated,) = fit.features([best.x], kept=True)
    assert simulated is not None
    own = np.diag(errors.covariance)
    known = np.isfinite(own) & (own > 0.0) & np.isfinite(errors.values) & np.isfinite(simulated)
    if known.sum() == 0:
        nan = np.full(own.shape, np.nan)
        return Kept(errors.names, errors.values, simulated, nan, np.nan, "cannot tell")
    # Errors of the parameters move all of it together.
    jacobian, _ = fit.replicated(best.x, kept=True)
    covariance = errors.covariance + jacobian @ worth.covariance @ jacobian.T
    among = np.ix_(known, known)
    root = rooted(covariance[among])
    residual = np.asarray(np.linalg.solve(root, (simulated - errors.values)[known]), np.float64)
    cast = drawn(errors, covariance, known, root)
    p_value = chance(residual, np.zeros((residual.size, 0)), cast)
    verdict = "misses" if p_value < level else "holds"
    error = np.sqrt(np.diag(covariance))
    return Kept(errors.names, errors.values, simulated, error, p_value, verdict)
