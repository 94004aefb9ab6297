"""Features of signals that are known, in the place of runs."""

from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

from chaindrive.measurement.features import Reading, covariance_of, features_of
from chaindrive.measurement.sensor import Sensor
from chaindrive.measurement.series import Series

RATE = 100.0


def folded(line: float, sensor: Sensor) -> dict[str, float]:
    """Variances of the features of a line [Hz] at 100 samples a second, of which a run has 400."""
    time = np.arange(1601) / (4.0 * RATE)
    run = xr.Dataset({"line": ("time", np.cos(2.0 * np.pi * line * time))}, {"time": time})
    quantity = SimpleNamespace(of=lambda run, _: run["line"].to_numpy())
    still = np.zeros(400)
    measured = Series(np.arange(400) / RATE, still, None)
    how = [Reading("y", quantity, sensor, RATE, 0.5, False, None, None, measured)]
    found = features_of(how, None)
    stated = run.assign_attrs(error_span_tension_mean=0.0, error_span_tension_std=0.0)
    stated = stated.assign_attrs(error_span_tension_p1=0.0, error_span_tension_p99=0.0)
    variances = np.diag(covariance_of(how, found, stated))
    return {it.name: float(value) for it, value in zip(found, variances, strict=True)}


def test_what_folds_down_to_a_mean_is_an_error_of_it() -> None:
    """A line at the sampling rate reads cos φ: 1 at the first place, and 0, −1, 0 at the others."""
    assert folded(RATE, Sensor())["mean"] == pytest.approx((1.0 + 4.0 + 1.0) / 3.0, abs=1e-6)


@pytest.mark.parametrize("line", [10.0, 30.0])
def test_lines_below_half_the_rate_fold_nowhere(line: float) -> None:
    """Of a whole number of periods a block has a mean of zero, wherever its samples stand."""
    assert folded(line, Sensor())["mean"] < 1e-20


def test_a_low_pass_leaves_nothing_to_fold() -> None:
    """Of order 4 at a fifth of a line it leaves (1/5)⁴ of it, and its start a hundredth."""
    assert folded(RATE, Sensor(corner=20.0, order=4))["mean"] < 2.0 * 0.01**2
