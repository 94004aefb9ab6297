"""Fits of known functions in the place of runs: what is identified, and which valleys are found."""

from collections.abc import Callable, Sequence
from types import SimpleNamespace

import numpy as np
import pytest
from numpy.typing import NDArray

from chaindrive.measurement.experiment import Errors
from chaindrive.measurement.fitting import Fit, Optimum
from chaindrive.measurement.free import FreeParameter
from chaindrive.measurement.likelihood import alike, reach_of, sides_of
from chaindrive.measurement.validating import validated
from chaindrive.measurement.valleys import searched

Floats = NDArray[np.float64]
Function = Callable[[Floats, int], Floats | None]


class Known(Fit):
    """A fit of a function of parameters and of the design, with errors of one."""

    def __init__(self, function: Function, values: Floats, start: Sequence[float]) -> None:
        count = values.size
        errors = Errors(
            [f"feature {n}" for n in range(count)],
            values,
            np.eye(count),
            np.zeros((count, 1)),
            np.ones(count),
            np.full(count, np.inf),
        )
        phases = [{"route.phase": 0.1 * n} for n in range(8)]
        # The part that is kept has a feature more, which is the first one again.
        more = Errors(
            [*errors.names, "feature 0 again"],
            np.append(values, values[0]),
            np.eye(count + 1),
            np.zeros((count + 1, 1)),
            np.ones(count + 1),
            np.full(count + 1, np.inf),
        )
        experiment = SimpleNamespace(
            run=None,
            errors=lambda run, kept=False: more if kept else errors,
            designs=phases,
            kept=True,
        )
        parameters = [FreeParameter(f"p{n}", -1.0, 1.0, at) for n, at in enumerate(start)]
        super().__init__([experiment], parameters, {}, "linear", lambda: None)
        self.function = function

    def _computed(self, points: Sequence[Floats], design: int, kept: bool) -> list[Floats | None]:
        found = [self.function(x, design) for x in points]
        return [it if it is None or not kept else np.append(it, it[0]) for it in found]


def test_what_was_kept_is_foretold_with_the_errors_of_the_parameters() -> None:
    """``σ² = 1 + (s σ_θ)²``, of each feature with its own slope s, also where there are others."""
    slopes = np.array([3.0, 4.0])
    fit = Known(lambda x, _: slopes * x[0], 0.1 * slopes, [0.0])
    best = fit.optimum(fit.start)
    found = validated(fit, best, fit.worth(best), 0.01)
    assert found is not None
    wanted = np.sqrt(1.0 + (np.array([3.0, 4.0, 3.0]) / 5.0) ** 2)
    np.testing.assert_allclose(found.error, wanted, rtol=1e-6)


@pytest.mark.parametrize("noise", [0.0, 0.1, 0.5])
def test_an_exact_pair_is_named_beside_one_that_is_nearly_none(noise: float) -> None:
    """Of a, b and c the record knows a + c, and b, which moves nearly what a moves."""
    rng = np.random.default_rng(57)
    slopes = 40.0 * rng.standard_normal((12, 2))
    slopes[:, 1] = slopes[:, 0] + 0.1 * slopes[:, 1]
    seen: dict[bytes, Floats] = {}

    def function(x: Floats, design: int) -> Floats:
        total = np.array([x[0] + x[2], x[1]])
        # Rough: the same run is the same, and the next one is not.
        key = np.round(total, 9).tobytes() + bytes([design])
        rough = seen.setdefault(key, noise * rng.standard_normal(12))
        return np.asarray(slopes @ total + rough)

    found = Known(function, np.zeros(12), [0.0, 0.0, 0.0]).begin()
    assert not found.silent
    [(value, least, words)] = found.combinations
    assert value < least
    assert "p0" in words
    assert "p2" in words


def test_an_exact_pair_is_named_where_the_record_bends() -> None:
    """Over a long step a + 0.3 c moves the record otherwise than over a short one."""
    rng = np.random.default_rng(57)
    slope, cube = 40.0 * rng.standard_normal(12), 100.0 * rng.standard_normal(12)
    seen: dict[bytes, Floats] = {}

    def function(x: Floats, design: int) -> Floats:
        total = x[0] + 0.3 * x[1]
        # Rough over a hundredth of the range: close to each other runs are alike.
        key = (np.round(total, 2) + 0.0).tobytes() + bytes([design])
        rough = seen.setdefault(key, 4.0 * rng.standard_normal(12))
        return np.asarray(slope * total + cube * total**3 + rough)

    found = Known(function, np.zeros(12), [0.0, 0.0]).begin()
    [(value, _, words)] = found.combinations
    assert value < 1e-4
    assert "p0" in words
    assert "p1" in words


def two_valleys(x: Floats, design: int) -> Floats | None:
    """Two valleys at a = ±0.5, of which the one at −0.5 is deeper; beyond 0.9 nothing runs."""
    a, b = x
    if a > 0.9:
        return None
    return np.array([20.0 * (a**2 - 0.25), 3.0 * (a + 0.5), 10.0 * (b - 0.2 * a)])


def test_a_deeper_valley_is_found_from_runs_alone() -> None:
    fit = Known(two_valleys, np.zeros(3), [0.5, 0.0])
    [*_] = fit.starts(5)
    wrong = fit.optimum(fit.start, is_near=True)
    assert wrong.x[0] > 0.4
    best, *others = searched(fit, [wrong])
    assert best.x == pytest.approx([-0.5, -0.1], abs=1e-3)
    assert any(it.x == pytest.approx(wrong.x) for it in others)


def test_an_interval_has_the_other_valley_with_its_width() -> None:
    """Errors of 1/20, and at 0.5 a χ² of 1 more than at −0.5; what is at 0.9 is contradicted."""

    def alike_valleys(x: Floats, design: int) -> Floats:
        return np.array([20.0 * (abs(x[0]) - 0.5), 20.0 * x[1], float(x[0] > 0.0)])

    fit = Known(alike_valleys, np.zeros(3), [0.5, 0.0])
    slope = np.diag([20.0, 20.0, 0.0])[:, :2]
    best, *others = (
        Optimum(np.array([at, 0.0]), 0.5 * chi2, slope)
        for at, chi2 in ((-0.5, 0.0), (0.5, 1.0), (0.9, 9.0))
    )
    covariance, t = 0.05**2 * np.eye(2), np.full(2, 2.0)
    first = (best, sides_of(fit, best, covariance, t))
    valleys = [first, *alike(fit, others, first, t)]
    below, above = reach_of(fit, valleys, np.zeros(2), covariance, t)
    np.testing.assert_allclose(below, [0.1, 0.1], rtol=1e-6)
    np.testing.assert_allclose(above, [1.0 + np.sqrt(2.0**2 - 1.0) * 0.05, 0.1], rtol=1e-6)


def test_one_valley_stays_alone() -> None:
    """Of a straight function the surface has the valley that the fit has found."""
    slopes = np.random.default_rng(3).standard_normal((6, 2))
    fit = Known(lambda x, _: slopes @ x, slopes @ np.array([0.3, -0.2]), [0.0, 0.0])
    fit.starts(5)
    found = searched(fit, [fit.optimum(fit.start)])
    assert len(found) == 1
    assert found[0].x == pytest.approx([0.3, -0.2], abs=1e-3)


def test_a_fit_that_ended_too_early_hides_no_valley() -> None:
    """On a rough χ² a fit may end on a step, beside the valley: a run there is deeper."""
    slopes = 10.0 * np.random.default_rng(3).standard_normal((6, 2))
    fit = Known(lambda x, _: slopes @ x, slopes @ np.array([0.3, -0.2]), [0.0, 0.0])
    fit.starts(5)
    beside = np.array([0.2, -0.1])
    early = Optimum(beside, 0.5 * float(np.sum(fit.residuals(beside) ** 2)), slopes)
    best = searched(fit, [early])[0]
    assert best.x == pytest.approx([0.3, -0.2], abs=1e-3)
