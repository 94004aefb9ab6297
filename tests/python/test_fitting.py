"""Fits of known functions in the place of runs: what is identified, and which valleys are found."""

from collections.abc import Callable, Sequence
from types import SimpleNamespace

import numpy as np
import pytest
from numpy.typing import NDArray

from chaindrive.measurement.experiment import Errors
from chaindrive.measurement.fitting import Fit, Optimum
from chaindrive.measurement.free import FreeParameter
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
        experiment = SimpleNamespace(run=None, errors=lambda run: errors, designs=phases)
        parameters = [FreeParameter(f"p{n}", -1.0, 1.0, at) for n, at in enumerate(start)]
        super().__init__([experiment], parameters, {}, "linear", lambda: None)
        self.function = function

    def _computed(self, points: Sequence[Floats], design: int) -> list[Floats | None]:
        return [self.function(x, design) for x in points]


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
