"""Arguments that the functions of measurements refuse before any run."""

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
import xarray as xr

import chaindrive as cd
from chaindrive.measurement import predicting
from chaindrive.measurement.amount import amount
from chaindrive.measurement.evaluations import RunStore
from chaindrive.measurement.free import free_parameters, priors_of

LOAD = "sprockets.driven.load[0].torque"
MOTION = "sprockets.driver.motion"
STIFFNESS = "chain.stiffness"
BIAS = "sensors.flange.bias"
GAIN = "sensors.flange.gain"
#: At 300 rpm, up to three times as fast.
TABLE = {"kind": "speed-table", "times": [0.0, 1.0], "speeds": ["300 rpm", "310 rpm"]}


def fit_of(drive: cd.Drive, path: str, value: float) -> xr.Dataset:
    """A fit of one parameter, as far as a prediction reads it."""
    return xr.Dataset(
        {
            "estimate": ("parameter", [value]),
            "freedom": ("parameter", [20.0]),
            "covariance": (("parameter", "parameter_2"), [[1e-4 * value**2]]),
        },
        coords={"parameter": [path]},
        attrs={"verdict": "calibrated", "level": 0.95, "scene": drive.text, "scene_name": "it"},
    )


def industrial() -> cd.Drive:
    return cd.scenes.industrial_16b().replace({"run.run_in": 0})


@pytest.fixture(scope="module")
def fit() -> xr.Dataset:
    return fit_of(industrial(), LOAD, -1433.0)


@pytest.fixture(scope="module")
def data() -> xr.Dataset:
    """A torque in N m at 1 kHz."""
    time = np.arange(200) / 1000.0
    table = pd.DataFrame({"time": time, "flange [N m]": 480.0 + np.sin(600.0 * time)})
    channels = {"flange": {"quantity": "sprocket_torque[driver]"}}
    return cd.measured(table, channels=channels)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"at": {"sprockets[1].load[0].torque": -1000.0}}, "at changes .*load.* it is fitted"),
        ({"at": {"sprockets.driven.load[0]": {"kind": "constant", "torque": -9.0}}}, "is fitted"),
        ({"at": {"sprockets.driven.load": [{"kind": "constant", "torque": -9.0}]}}, "is fitted"),
        ({"at": {"sprockets.driven.load": []}}, "is fitted"),
        (
            {"at": {MOTION: {"kind": "constant", "speed": "1200 rpm"}}},
            r"motion\.speed = 125\.664 is out of reach of a fit at 31\.4159",
        ),
        ({"reach": float("nan")}, "reach = nan, must be a finite number, at least 1"),
        ({"reach": 0.5}, "reach = 0.5, must be"),
        ({"reach": "3"}, "reach = '3', must be"),
        ({"telling": float("nan")}, "telling = nan, must be"),
        ({"level": "95 %"}, r"level = '95 %', must be a number in \(0, 1\)"),
    ],
)
def test_a_prediction_keeps_what_was_fitted_and_within_reach(
    fit: xr.Dataset, change: dict[str, Any], words: str
) -> None:
    with pytest.raises(cd.MeasurementError, match=words):
        cd.predict(fit, **change)


class SimulatedError(Exception):
    """A run has begun: nothing was refused."""


@pytest.mark.parametrize(
    ("motion", "at"),
    [
        (None, {MOTION: {"kind": "constant", "speed": "600 rpm"}}),
        (None, {"sprockets.driven.load": [{"kind": "constant", "torque": -1433.0}]}),
        (None, {"sprockets.driver.eccentricity": 0.0}),
        # Another record of a motion has other times, and speeds that may begin at zero.
        (TABLE, {MOTION: TABLE | {"times": [0.0, 1.0, 2.0], "speeds": [0.0, 40.0, 80.0]}}),
    ],
)
def test_an_operating_point_may_be_given_by_a_table(
    motion: Any, at: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    def simulate(*_: Any, **__: Any) -> None:
        raise SimulatedError

    monkeypatch.setattr(predicting, "simulate", simulate)
    drive = industrial() if motion is None else industrial().replace({MOTION: motion})
    with pytest.raises(SimulatedError):
        cd.predict(fit_of(drive, LOAD, -1433.0), at=at)


@pytest.mark.parametrize(
    ("drive", "path"),
    [
        (cd.scenes.two_stage_timing(), "chains[0].stiffness"),
        (cd.scenes.spinning_ring(), STIFFNESS),
    ],
    ids=["several chains", "ring"],
)
def test_a_drive_without_a_phase_is_not_foretold(drive: cd.Drive, path: str) -> None:
    with pytest.raises(cd.MeasurementError, match=r"has no route\.phase to start from"):
        cd.predict(fit_of(drive, path, 1e5))


@pytest.mark.parametrize(
    ("path", "prior", "words"),
    [
        (STIFFNESS, ("20 kN", "1 m"), "is a force, needed is a stiffness"),
        (STIFFNESS, ("160 MN/m", "1 m"), "is a length, needed is a stiffness"),
        (STIFFNESS, ("160", "5"), "has no unit"),
        (STIFFNESS, (float("nan"), 1e6), "nan, must be finite"),
        (STIFFNESS, (1.6e8, float("inf")), "inf, must be finite"),
        (STIFFNESS, (1.6e8, 0.0), "the standard deviation is 0"),
        (STIFFNESS, (1.6e8, None), "None is not a number and a unit"),
        (BIAS, (0.0, "1 kN"), "is a force, needed is a number and a unit of N m"),
        (GAIN, (1.0, "1 N m"), "is a torque, needed is a bare number"),
        (GAIN, (float("nan"), 0.1), "gain = nan, must be finite"),
    ],
)
def test_a_prior_is_of_the_unit_of_its_parameter(
    data: xr.Dataset, path: str, prior: tuple[Any, Any], words: str
) -> None:
    bounds = {STIFFNESS: (1e8, 2e8), BIAS: (-5.0, 5.0), GAIN: (0.9, 1.1)}
    opened = (industrial(), data, free_parameters(industrial(), data, bounds))
    with pytest.raises(cd.MeasurementError, match=words):
        priors_of({path: prior}, [opened])


def test_a_prior_is_read_in_the_unit_that_it_is_given_in(data: xr.Dataset) -> None:
    """A deviation of 5 °C is one of 5 K, and one of a torque may be larger than any range."""
    warm = industrial().replace({"lubricant": {"grade": "VG 150", "temperature": "60 degC"}})
    temperature = "lubricant.temperature"
    bounds = {temperature: ("40 degC", "80 degC"), GAIN: (0.9, 1.1), BIAS: ("-5 N m", 5.0)}
    parameters = free_parameters(warm, data, bounds)
    assert (parameters[2].low, parameters[2].high) == (-5.0, 5.0)
    priors = {temperature: ("60 degC", "5 degC"), GAIN: (1.0, "2 %"), BIAS: (0.0, "0.01 kN m")}
    assert priors_of(priors, [(warm, data, parameters)]) == {
        temperature: (333.15, pytest.approx(5.0)),
        GAIN: (1.0, 0.02),
        BIAS: (0.0, 10.0),
    }


@pytest.mark.parametrize(
    ("bounds", "words"),
    [
        ({BIAS: ("-1 kN", "1 kN")}, "is a force, needed is a number and a unit of N m"),
        ({GAIN: (0.9, float("inf"))}, "gain = inf, must be finite"),
        ({GAIN: (0.0, 2.0)}, "gain = 0.0, must be other than 0"),
        ({"sensors.flange.corner": (0.0, 100.0)}, "corner = 0.0, must be positive"),
        ({"sensors.flange.corner": (None, 100.0)}, "corner = None is no number"),
    ],
)
def test_bounds_are_what_the_sensor_or_scene_takes(
    data: xr.Dataset, bounds: dict[str, Any], words: str
) -> None:
    with pytest.raises(cd.MeasurementError, match=words):
        cd.calibrate(industrial(), data, bounds)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"free": None}, "no mapping from paths to bounds"),
        ({"free": [STIFFNESS]}, "no mapping from paths to bounds"),
        ({"free": {}}, "no mapping from paths to bounds"),
        ({"level": "95 %"}, "level = '95 %'"),
        ({"validation": "a quarter"}, "validation = 'a quarter'"),
        ({"starts": 2.5}, "starts = 2.5, must be a whole number"),
        ({"priors": {STIFFNESS: (float("nan"), 1.0)}}, "must be finite"),
    ],
)
def test_a_fit_is_refused_before_it_begins(
    data: xr.Dataset, change: dict[str, Any], words: str
) -> None:
    given = {"free": {STIFFNESS: (1e8, 2e8)}} | change
    with pytest.raises(cd.MeasurementError, match=words):
        cd.calibrate(industrial(), [data, data], **given)


def test_a_channel_that_ends_early_is_named() -> None:
    """The strand ends before the last quarter, which is kept, begins."""
    time = np.arange(200) / 1000.0
    table = xr.Dataset(
        {
            "flange": ("time", 480.0 + np.sin(600.0 * time), {"units": "N m"}),
            "strand": ("time_2", 1e3 + np.sin(600.0 * time[:120]), {"units": "N"}),
        },
        coords={"time": time, "time_2": time[:120]},
    )
    channels = {"flange": "sprocket_torque[driver]", "strand": "span_tension[driven-driver]"}
    record = cd.measured(table, channels=channels)
    with pytest.raises(cd.MeasurementError, match=r"strand has 0 samples .* kept for validation"):
        cd.calibrate(industrial(), record, {GAIN: (0.9, 1.1)}, until=1e-3)


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({"drift": "1 N"}, "drift = '1 N' is a force, needed is a bare number"),
        ({"gain": "two"}, "gain = 'two' is not a bare number"),
        ({"gain": float("nan")}, "gain = nan, must be finite"),
        ({"gain": 0.0}, "gain = 0.0, must be other than 0"),
        ({"gain": None}, "gain = None"),
        ({"gain": True}, "gain = True"),
        ({"delay": float("inf")}, "delay = inf, must be finite"),
        ({"bias": "1 kN", "unit": "N m"}, "is a force, needed is a number and a unit of N m"),
        ({"bias_uncertainty": "1 kN", "quantity": "losses"}, "needed is a number and a unit of W"),
    ],
)
def test_fields_of_a_sensor_are_numbers_of_their_units(fields: dict[str, Any], words: str) -> None:
    with pytest.raises(cd.MeasurementError, match=words):
        cd.measurement.Sensor(**fields)
    with pytest.raises(cd.MeasurementError, match=f"channels.flange: .*{words}"):
        cd.measurement.Sensor.of(fields, "flange")


@pytest.mark.parametrize("given", [None, 3, ["gain"]])
def test_what_is_no_sensor_is_told(given: object) -> None:
    with pytest.raises(cd.MeasurementError, match=r"channels.flange = .* is no sensor"):
        cd.measurement.Sensor.of(given, "flange")  # type: ignore[arg-type]


def test_texts_in_a_file_of_a_rig_are_numbers_of_a_sensor() -> None:
    """As a table of TOML has them; a zero that is half a degree off is half a kelvin off."""
    table = {"gain": "1.02", "offset": "0.02", "gain_uncertainty": "0.2 %", "scale": "50"}
    read = cd.measurement.Sensor.of(table | {"bias_uncertainty": "0.5 degC", "delay": "2 ms"})
    assert (read.gain, read.offset, read.gain_uncertainty, read.scale) == (1.02, 0.02, 0.002, 50.0)
    assert (read.bias_uncertainty, read.delay) == (0.5, 0.002)
    placed = cd.measurement.Sensor(quantity="tensioner_position", bias="1 mm")
    assert placed.bias == 1e-3
    assert cd.measurement.Sensor.from_json(placed.to_json()) == placed


@pytest.mark.parametrize("one", [1, np.int64(1), np.float32(1), "1. s"])
def test_amounts_are_numbers_of_python_and_of_numpy(one: object) -> None:
    assert amount(one, "s", "until") == 1.0


@pytest.mark.parametrize("given", ["1.2.3 s", "s", None, True])
def test_what_is_no_amount_is_told(given: object) -> None:
    with pytest.raises(cd.MeasurementError, match=r"until = .* is not a number and a unit of s"):
        amount(given, "s", "until")


def test_a_difference_of_temperatures_knows_no_zero() -> None:
    """5 °C from place to place are 5 K, of pint too, and as a place they are 278.15 K."""
    pint = pytest.importorskip("pint")
    for given in ("5 degC", pint.UnitRegistry().Quantity(5.0, "degC")):
        assert amount(given, "K", "it", is_difference=True) == pytest.approx(5.0)
        assert amount(given, "K", "it") == pytest.approx(278.15)


@pytest.mark.parametrize("damage", ["empty", "cut", "changed"])
def test_a_damaged_run_of_a_store_is_named(tmp_path: Path, damage: str) -> None:
    store = RunStore(tmp_path)
    store.put("run", xr.Dataset({"tension": ("time", np.arange(50.0))}))
    file = tmp_path / "run.npz"
    whole = file.read_bytes()
    half = len(whole) // 2
    file.write_bytes(
        {
            "empty": b"",
            "cut": whole[:half],
            "changed": whole[:half] + bytes([whole[half] ^ 255]) + whole[half + 1 :],
        }[damage]
    )
    with pytest.raises(cd.MeasurementError, match=r"run\.npz is no run of a fit.*; delete it, and"):
        store.get("run")


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"align": "tme"}, "align = 'tme', must be 'angle' or 'time'"),
        ({"level": "95 %"}, r"level = '95 %', must be a number in \(0, 1\)"),
        ({"telling": None}, r"telling = None, must be a number in \(0, 1\)"),
    ],
)
def test_a_comparison_has_arguments_of_its_own(change: dict[str, Any], words: str) -> None:
    run = xr.Dataset(coords={"time": [0.0, 1.0]}, attrs={"scene": ""})
    with pytest.raises(cd.MeasurementError, match=words):
        cd.compare(run, xr.Dataset(), **change)
