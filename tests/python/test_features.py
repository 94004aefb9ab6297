"""Features of signals that are known, in the place of runs, and which ones a run shares."""

from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

import chaindrive as cd
from chaindrive.measurement.features import Reading, covariance_of, features_of, readings
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
    how = [Reading("y", quantity, sensor, 0.5, False, None, None, (), measured)]
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


def test_a_zero_drifts_over_the_record_and_not_over_the_run() -> None:
    """A record of 4 s from its second second on: 3 s after the zero in the mean."""
    time = np.arange(400) / 400.0
    run = xr.Dataset({"still": ("time", np.zeros(400))}, {"time": time})
    quantity = SimpleNamespace(of=lambda run, _: run["still"].to_numpy())
    measured = Series(1.0 + np.arange(400) / RATE, np.zeros(400), None)
    how = [Reading("y", quantity, Sensor(drift=2.0), 0.1, False, None, None, (), measured)]
    mean = features_of(how, run)[0].estimate.value
    assert mean == pytest.approx(2.0 * float(measured.time.mean()), rel=0.01)


@pytest.fixture(scope="module")
def strand() -> xr.Dataset:
    """The tight strand of a run of 63 ms at 300 rpm: six pitches."""
    drive = cd.scenes.industrial_16b().replace({"run.run_in": "10 ms"})
    record = ["span_tension", "sprocket_angle"]
    return cd.simulate(drive, until=0.063, every=1.0 / 4200.0, record=record)


def test_run_and_record_have_the_same_features_where_one_resolves_an_order_more() -> None:
    """700 samples a second resolve the third order of 19 teeth at 291 rpm, and not at 300."""

    def turning(rpm: float, rate: float) -> xr.Dataset:
        time = np.arange(rate) / rate
        angle = rpm * np.pi / 30.0 * time
        table = {
            "tight": ("time", 4700.0 + np.cos(57.0 * angle), {"units": "N"}),
            "sprocket_angle": (("time", "sprocket"), angle[:, None]),
        }
        return xr.Dataset(table, {"time": ("time", time, {"units": "s"}), "sprocket": ["driver"]})

    run = turning(300.0, 2800.0)
    quantity = SimpleNamespace(is_relative=False, of=lambda run, _: run["tight"].to_numpy())
    table = turning(291.0, 700.0)[["tight"]]
    data = cd.measured(table, turns={"driver": "291 rpm"})
    how = readings(data, run, {"tight": quantity}, {"tight": Sensor()}, "driver", 19.0)
    ours, theirs = ([it.name for it in features_of(how, one)] for one in (None, run))
    assert ours == theirs
    assert ours[-1] == "order 38"
    # At four times the speed the first order has 1.8 samples a period.
    with pytest.raises(cd.MeasurementError, match="order 19 of driver has less than two samples"):
        features_of(how, turning(1200.0, 2800.0))


def of_strand(run: xr.Dataset, turns: str, count: int = 250) -> xr.Dataset:
    tight = run["span_tension"].sel(span="driven-driver").drop_vars("span")[:count]
    table = tight.assign_attrs(units="N").to_dataset(name="tight")
    channels = {"tight": "span_tension[driven-driver]"}
    return cd.measured(table, channels=channels, turns={"driver": turns})


def test_a_speed_that_is_not_that_of_the_drive_is_told(strand: xr.Dataset) -> None:
    words = "driver: turns at 200 rpm in the record, and at 300 rpm in the drive"
    drive = cd.scenes.industrial_16b()
    slow = of_strand(strand, "200 rpm")
    assert words in cd.check_data(drive, slow, until="10 ms").attrs["problems"]
    assert words in cd.compare(strand, slow).attrs["summary"]
    with pytest.raises(cd.MeasurementError, match="turns at 200 rpm"):
        cd.calibrate(drive, slow, {"route.pretension": (1e3, 2e3)}, until="10 ms")
    assert (
        cd.check_data(drive, of_strand(strand, "-306 rpm"), until="10 ms").attrs["problems"] == []
    )


def test_numbers_that_scatter_more_than_their_mean_fit_nothing(strand: xr.Dataset) -> None:
    """A tenth of the samples, spread over the record, has lost its point."""
    data = of_strand(strand, "300 rpm")
    data["tight"][::10] *= -1000.0
    assert abs(data["tight"].mean()) < 2.0 * data["tight"].std()
    [problem] = cd.check_data(cd.scenes.industrial_16b(), data, until="10 ms").attrs["problems"]
    assert "its sign is not" in problem


@pytest.mark.parametrize(
    ("count", "verdict"), [(30, "cannot tell"), (100, "cannot tell"), (250, "agrees")]
)
def test_less_than_three_pitches_tell_nothing(strand: xr.Dataset, count: int, verdict: str) -> None:
    """Of 7.5, 25 and 62.5 ms, where a pitch takes 10.5: parts of one are no blocks."""
    data = of_strand(strand, "300 rpm", count=count)
    assert cd.compare(strand, data)["verdict"].item() == verdict
