"""Sides of intervals, of drives that are straight and of those that are not: closed forms."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from chaindrive.measurement.fitting import Optimum
from chaindrive.measurement.likelihood import Sides, sides_of

HALF = np.array([1.0, 2.0, 3.0])
SLOPES = np.random.default_rng(0).standard_normal((8, 3))
STUDENT = np.array([2.0, 2.1, 2.2])


LEFT = np.random.default_rng(1).standard_normal(8)
LEFT -= SLOPES @ np.linalg.lstsq(SLOPES, LEFT, rcond=None)[0]
Floats = np.ndarray


def sides(bent: Callable[[Floats], Floats], reach: float = 100.0, share: Any = 1.0) -> Sides:
    """Sides about zero of a drive whose features are straight in some function of θ.

    A share of what is left at zero is left at θ.
    """

    def residuals(x: Floats) -> Floats:
        left = share(x / HALF) if callable(share) else share
        return left * LEFT + SLOPES @ bent(x / HALF)

    fit: Any = SimpleNamespace(
        low=-reach * HALF,
        high=reach * HALF,
        half=HALF,
        residuals=residuals,
        residuals_at=lambda points: [residuals(x) for x in points],
    )
    best = Optimum(np.zeros(3), 0.5 * float(LEFT @ LEFT), SLOPES)
    return sides_of(fit, best, np.linalg.inv(SLOPES.T @ SLOPES), STUDENT)


#: ``t √Σ_kk`` of a straight drive.
WIDTH = STUDENT * np.sqrt(np.diag(np.linalg.inv(SLOPES.T @ SLOPES)))


def test_a_straight_drive_has_the_intervals_of_its_covariance() -> None:
    found = sides(lambda z: z)
    np.testing.assert_allclose(found.below, WIDTH, rtol=1e-9)
    np.testing.assert_allclose(found.above, WIDTH, rtol=1e-9)
    assert found.better is None


def test_an_interval_reaches_as_far_as_a_parameter_moves_little() -> None:
    """Above zero a fifth of the slope: five times as far, and the other side stays."""
    found = sides(lambda z: np.where([z[0] > 0.0, False, False], 0.2 * z, z))
    assert found.above[0] == pytest.approx(5.0 * WIDTH[0], rel=1e-9)
    assert found.below[0] == pytest.approx(WIDTH[0], rel=1e-9)
    assert found.above[1] == pytest.approx(WIDTH[1], rel=0.5)


def test_an_interval_ends_where_the_record_contradicts_for_good() -> None:
    """A narrow ridge at one width, and a plain behind it up to three widths."""

    def ridge(z: np.ndarray) -> np.ndarray:
        x = z[0] / WIDTH[0]
        return np.array([WIDTH[0] * (np.interp(x, [0, 1, 2, 4, 5], [0, 1.5, 0.5, 2, 3])), *z[1:]])

    assert sides(ridge).above[0] > 2.0 * WIDTH[0]


def test_an_interval_ends_at_a_bound() -> None:
    found = sides(lambda z: 0.01 * z, reach=3.0 * float(WIDTH[0]))
    assert found.above[0] == pytest.approx(3.0 * WIDTH[0], rel=1e-9)


def test_a_deeper_valley_is_told() -> None:
    """Beyond one width nothing is left, and there the features hardly move."""
    assert float(LEFT @ LEFT) > 2.0
    found = sides(lambda z: 0.1 * z, share=lambda z: float(z[0] < 1.5 * WIDTH[0]))
    assert found.better is not None
    assert found.better[0] > 1.5 * WIDTH[0] * HALF[0]
