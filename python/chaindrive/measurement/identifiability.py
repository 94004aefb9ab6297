"""Which parameters a record identifies: scaled Fisher information, and what it cannot part."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from chaindrive.measurement.free import FreeParameter

__all__ = ["LEAST_EIGENVALUE", "Identifiability", "identifiability"]

_Floats = NDArray[np.float64]

#: Scaled eigenvalue below which a combination of parameters is not identified [–]: their estimates
#: would correlate by more than 0.9999 (assumed).
LEAST_EIGENVALUE = 1e-4
#: Multiple of what noise of derivatives makes of an eigenvalue that it has to exceed [–]: three
#: standard deviations, squared.
_FLOORS = 9.0
#: Multiple of that noise below which two designs leave it in doubt [–]: of two squares over a
#: variance that two designs tell, one in a hundred is larger (F distribution).
_DOUBT = 100.0
#: Effect of half the range, in standard errors of the whole record, below which a parameter does
#: nothing that is seen [–] (assumed: then even the bounds cannot be told apart).
_LEAST_EFFECT = 2.0
#: Share of the largest entry from which a parameter belongs to a combination [–].
_BELONGS = 0.15


@dataclass(frozen=True)
class Identifiability:
    """What a record says of parameters, before any fit."""

    parameters: list[FreeParameter]
    information: _Floats
    """Fisher information ``F = Jᵀ C⁻¹ J`` of parameters scaled by half their range (p, p) [–]."""
    eigenvalues: _Floats
    """Of the information with a unit diagonal (p,) [–], ascending by derivatives alone; NaN where a
    parameter does nothing."""
    directions: _Floats
    """Their directions (p, p), a column each, in parameters scaled by half their range."""
    floor: _Floats
    """What noise of the derivatives alone makes of the eigenvalues (p,) [–]."""
    errors: _Floats
    """Standard errors that a fit would have [SI] (p,); infinite where not identified."""
    correlation: _Floats
    """Correlation of the estimates (p, p)."""

    @property
    def silent(self) -> list[FreeParameter]:
        """Parameters that move nothing which this record can see."""
        effect = np.sqrt(np.diag(self.information))
        return [
            it for it, size in zip(self.parameters, effect, strict=True) if size < _LEAST_EFFECT
        ]

    @property
    def combinations(self) -> list[tuple[float, float, str]]:
        """Combinations that are not identified: scaled eigenvalue, what it must exceed, words."""
        loud = [n for n, it in enumerate(self.parameters) if it not in self.silent]
        own = [self.parameters[n] for n in loud]
        effect = np.sqrt(np.diag(self.information))[loud]
        found = []
        for n in np.flatnonzero(self.is_lost):
            words = _named(own, self.directions[loud, n], effect)
            found.append((float(self.eigenvalues[n]), float(self._needed[n]), words))
        return found

    @property
    def _needed(self) -> _Floats:
        """Eigenvalues from which a combination is identified (p,)."""
        return np.asarray(np.maximum(LEAST_EIGENVALUE, _FLOORS * self.floor))

    @property
    def is_lost(self) -> NDArray[np.bool_]:
        """Directions that are not identified (p,)."""
        return np.asarray(self.eigenvalues < self._needed)

    @property
    def is_in_doubt(self) -> NDArray[np.bool_]:
        """Directions whose eigenvalue is near the noise of the derivatives (p,)."""
        return np.asarray(self.eigenvalues < _DOUBT * self.floor)

    @property
    def is_clear(self) -> NDArray[np.bool_]:
        """Directions whose eigenvalue is not (p,)."""
        return np.asarray(self.eigenvalues >= _DOUBT * self.floor)

    def seen_along(
        self, n: int, direction: _Floats, eigenvalue: float, floor: float
    ) -> Identifiability:
        """Return the same where runs along a direction have told it, its eigenvalue and noise."""
        directions = self.directions.copy()
        eigenvalues, floors = self.eigenvalues.copy(), self.floor.copy()
        directions[:, n], eigenvalues[n], floors[n] = direction, eigenvalue, floor
        return replace(self, directions=directions, eigenvalues=eigenvalues, floor=floors)

    @property
    def is_identified(self) -> bool:
        """Whether every parameter is, by itself and beside the others."""
        return not self.silent and not self.combinations


def identifiability(
    parameters: Sequence[FreeParameter],
    jacobian: _Floats,
    covariance: _Floats,
    noise: _Floats | None = None,
) -> Identifiability:
    """Return what a record says of parameters.

    ``F = Jᵀ C⁻¹ J`` with J in parameters scaled by half their range; the scaled matrix
    ``F_ij / √(F_ii F_jj)`` has a unit diagonal, so that its eigenvalues know no units.

    Parameters
    ----------
    parameters
        The parameters (p).
    jacobian : (features, p)
        Change of every feature with half the range of a parameter [unit of the feature].
    covariance : (features, features)
        Covariance C of the features; those without an error are left out.
    noise : (features, p)
        Noise of the derivatives; none when absent. What it makes of an eigenvalue is no knowledge.

    References
    ----------
    Y. Bard, *Nonlinear Parameter Estimation*, 1974, ch. 7.
    """
    errors = np.diag(covariance)
    known = np.isfinite(errors) & (errors > 0.0) & np.isfinite(jacobian).all(axis=1)
    # C = L Lᵀ, so that L⁻¹ J has errors of one, independent of each other.
    root = np.linalg.cholesky(covariance[np.ix_(known, known)])
    weighted = np.linalg.solve(root, jacobian[known])
    noisy = np.linalg.solve(root, (jacobian + (0.0 if noise is None else noise))[known]) - weighted
    information = weighted.T @ weighted
    size = np.sqrt(np.diag(information))
    count = len(parameters)
    loud = np.flatnonzero(size >= _LEAST_EFFECT)
    eigenvalues = np.full(count, np.nan)
    directions = np.eye(count)
    deviations = np.full(count, np.inf)
    floor = np.zeros(count)
    correlation = np.eye(count)
    if loud.size:
        # Of the unit columns themselves: their squares would lose half of the digits.
        columns = weighted[:, loud] / size[loud]
        _, singular, right = np.linalg.svd(columns, full_matrices=True)
        values = np.zeros(loud.size)
        values[: singular.size] = singular**2
        order = np.argsort(values)
        eigenvalues[: loud.size] = values[order]
        directions = np.zeros((count, count))
        directions[np.ix_(loud, np.arange(loud.size))] = right.T[:, order] / size[loud, None]
        vectors = right.T[:, order]
        floor[: loud.size] = ((noisy[:, loud] / size[loud]) ** 2).sum(axis=0) @ vectors**2
        lost = values[order] < np.maximum(LEAST_EIGENVALUE, _FLOORS * floor[: loud.size])
        spreads = _inverse(values[order], vectors, lost)
        half = np.array([it.half_range for it in parameters])
        spread = np.sqrt(np.diag(spreads))
        identified = np.isfinite(spread)
        deviations[loud[identified]] = (spread / size[loud] * half[loud])[identified]
        product = np.outer(spread, spread)
        finite = np.isfinite(product) & np.isfinite(spreads)
        scaled = np.divide(spreads, product, where=finite, out=np.full_like(spreads, np.nan))
        correlation[np.ix_(loud, loud)] = scaled
    return Identifiability(
        list(parameters), information, eigenvalues, directions, floor, deviations, correlation
    )


def _inverse(values: _Floats, vectors: _Floats, is_lost: NDArray[np.bool_]) -> _Floats:
    """Return the covariance of unit columns; infinite for what a null direction takes part in."""
    good = ~is_lost
    found: _Floats = (vectors[:, good] / values[good]) @ vectors[:, good].T
    lost = (np.abs(vectors[:, ~good]) > 0.05).any(axis=1)
    found[lost, lost] = np.inf
    return found


def _named(parameters: Sequence[FreeParameter], direction: _Floats, effect: _Floats) -> str:
    """Return a combination in words: a product or quotient of two, else how they go together."""
    steps = direction * np.array([it.half_range for it in parameters])
    # What moves as much belongs, however small its step is.
    share = np.abs(direction * effect) / np.abs(direction * effect).max()
    parts = [
        (it, float(step))
        for it, step, own in zip(parameters, steps, share, strict=True)
        if own > _BELONGS
    ]
    names = [it.path for it, _ in parts]
    middles = [it.around(0.0)[1] for it, _ in parts]
    if len(parts) == 1:
        return f"{names[0]} alone"
    if len(parts) == 2 and all(middles):
        one, other = (step / middle for (_, step), middle in zip(parts, middles, strict=True))
        power = -one / other
        if abs(power - 1.0) < 0.1:
            return f"only the product {names[0]} × {names[1]} is known"
        if abs(power + 1.0) < 0.1:
            return f"only the quotient {names[0]} / {names[1]} is known"
    largest = max(abs(step) / it.half_range for it, step in parts)
    together = ", ".join(
        f"{it.path} by {100 * step / it.half_range / largest:+.0f} %" for it, step in parts
    )
    return f"nothing seen changes with {together} of half their ranges together"
