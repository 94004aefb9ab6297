"""Angles of shafts in a measurement: right wherever the record is cut, logged or spoilt."""

from typing import Any

import numpy as np
import pandas as pd
import pytest

import chaindrive as cd

TIME = np.arange(2000) / 1000.0
FLANGE = 1000.0 + 50.0 * np.sin(2 * np.pi * 7.0 * TIME)
#: A run-up over a second, and 10 rev/s from there on.
SPEED = np.minimum(10.0 * TIME, 10.0)
TURNED = np.where(TIME < 1.0, 5.0 * TIME**2, 10.0 * TIME - 5.0)


def table(**columns: Any) -> pd.DataFrame:
    return pd.DataFrame({"time [s]": TIME, "flange [N m]": FLANGE} | columns)


def turned(data: Any) -> np.ndarray:
    """Turns of the driver [–]."""
    turns: np.ndarray = data["sprocket_angle"].sel(sprocket="driver").to_numpy() / (2 * np.pi)
    return turns


@pytest.mark.parametrize(
    "turn",
    [
        "speed",
        "300 rpm",
        {"encoder": "counts", "counts": 3600},
        {"tacho": "pulse", "pulses": 20},
    ],
    ids=["speed", "stated", "encoder", "tacho"],
)
def test_a_record_that_is_read_from_the_middle_has_the_angle_of_the_whole(turn: Any) -> None:
    rig = table(
        **{
            "speed [Hz]": SPEED,
            "counts": np.floor(3600.0 * TURNED),
            "pulse [V]": 5.0 * (np.mod(20.0 * TURNED, 1.0) < 0.5),
        }
    )
    keep = {"channels": ["flange"], "turns": {"driver": turn}}
    whole, part = cd.measured(rig, **keep), cd.measured(rig, start=1.2, **keep)
    np.testing.assert_allclose(turned(part), turned(whole)[1200:], rtol=0, atol=1e-9)


@pytest.mark.parametrize(
    ("heading", "readings", "sensor"),
    [
        ("n", 60.0 * SPEED, {"unit": "rpm"}),
        ("n [rad/s]", 60.0 * SPEED, {"unit": "rpm"}),
        ("n [V]", -0.1 * SPEED + 2.5, {"unit": "Hz", "scale": 10.0, "offset": 2.5, "sign": -1}),
    ],
    ids=["no unit", "another unit", "volts"],
)
def test_a_channel_that_turns_a_shaft_is_read_as_it_is_said(
    heading: str, readings: np.ndarray, sensor: dict[str, Any]
) -> None:
    rig = table(**{heading: readings})
    data = cd.measured(rig, channels={"n": sensor}, turns={"driver": "n"})
    np.testing.assert_allclose(turned(data), TURNED, rtol=0, atol=1e-5)
    assert data["n"].attrs["turns"] == "driver"


@pytest.mark.parametrize(
    ("readings", "turn", "first", "last"),
    [
        (36000.0 * TIME, {"encoder": "it", "counts": 3600}, 0.0, -19.99),
        # It rises where it fell: not before 4.5 ms, but 1.5 ms.
        (np.mod(200.0 * TIME, 1.0) < 0.3, {"tacho": "it", "pulses": 20}, -0.015, 19.975),
    ],
    ids=["encoder", "tacho"],
)
def test_a_channel_that_counts_the_other_way_turns_a_shaft_so(
    readings: Any, turn: Any, first: float, last: float
) -> None:
    rig = table(it=1.0 * readings)
    data = cd.measured(rig, channels={"it": {"sign": -1}}, turns={"driver": turn})
    np.testing.assert_allclose(turned(data)[[0, -1]], [first, last], rtol=0, atol=1e-9)


@pytest.mark.parametrize("kept", [["flange"], ["flange", "n"]], ids=["alone", "kept too"])
@pytest.mark.parametrize(
    ("readings", "turn"),
    [
        (SPEED, "n"),
        (3600.0 * TURNED, {"encoder": "n", "counts": 3600}),
        (5.0 * (np.mod(20.0 * TURNED, 1.0) < 0.5), {"tacho": "n", "pulses": 20}),
    ],
    ids=["speed", "encoder", "tacho"],
)
def test_a_sample_without_a_time_is_left_out_of_an_angle(
    readings: Any, turn: Any, kept: list[str]
) -> None:
    times = TIME.copy()
    times[1500] = np.nan
    rig = table(**{"time [s]": times, "n [Hz]": readings})
    with pytest.warns(cd.MeasurementWarning, match="1 samples have no time"):
        data = cd.measured(rig, channels=kept, turns={"driver": turn})
    error = turned(data) - np.delete(TURNED, 1500)
    assert np.ptp(error[100:]) < 0.03
    assert data.attrs["findings_note"].count("have no time") == 1


def test_a_speed_of_its_own_times_goes_on_where_it_ends(tmp_path: Any) -> None:
    """One a second for a torque at 1 kHz: five are enough, and the shaft does not stand after."""
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "rig.h5", "w") as file:
        for name, values, rate, unit in (
            ("flange", np.sin(np.arange(4900)), 1000.0, "N m"),
            ("speed", np.full(5, 10.0), 1.0, "Hz"),
        ):
            file[name] = values
            file[name].attrs.update({"fs": rate, "unit": unit})
    data = cd.measured(tmp_path / "rig.h5", channels=["flange"], turns={"driver": "speed"})
    np.testing.assert_allclose(turned(data), 10.0 * data["time"], rtol=0, atol=1e-9)


SLOW = np.arange(1500) / 15.0


@pytest.mark.parametrize(
    ("time", "heading", "readings", "turn"),
    [
        (SLOW, "it", 36000.0 * SLOW, {"counts": 3600}),
        (SLOW, "it [deg]", 3600.0 * SLOW, {}),
        (TIME, "it", 36000.0 * TIME % 3600.0, {"counts": 3600}),
        (TIME, "it", 36000.0 * TIME % 65536.0, {"counts": 3600, "wraps_at": 65536}),
        (TIME, "it [deg]", 3600.0 * TIME % 360.0, {}),
        (TIME, "it [deg]", 3600.0 * TIME % 720.0, {}),
        (SLOW, "it [deg]", 3600.0 * SLOW % 3600.0, {"wraps_at": 3600.0}),
    ],
    ids=["never", "angle, never", "turns", "65536", "angle, turns", "cycle", "angle, ten turns"],
)
def test_a_counter_begins_anew_by_turns_or_as_said_or_never(
    time: Any, heading: str, readings: Any, turn: Any
) -> None:
    """10 rev/s, of which a sampling at 15 Hz sees two thirds of a turn at a time."""
    rig = pd.DataFrame({"time [s]": time, "flange": np.sin(time), heading: readings})
    data = cd.measured(rig, turns={"driver": {"encoder": "it"} | turn})
    np.testing.assert_allclose(turned(data), 10.0 * time, rtol=0, atol=1e-6)


def test_a_counter_that_begins_anew_nobody_knows_where_is_refused() -> None:
    rig = table(it=np.floor(36000.0 * TIME) % 65536.0)
    with pytest.raises(cd.MeasurementError, match="back from 65520 to 20; give `wraps_at`"):
        cd.measured(rig, turns={"driver": {"encoder": "it", "counts": 3600}})


@pytest.mark.parametrize(
    ("kind", "field", "value"),
    [
        ("Encoder", "counts", 0),
        ("Encoder", "counts", "3600"),
        ("Encoder", "wraps_at", -1),
        ("Tacho", "pulses", 0),
        ("Tacho", "level", "2 V"),
    ],
)
def test_numbers_of_an_encoder_and_a_tacho_are_asked_at_once(
    kind: str, field: str, value: Any
) -> None:
    with pytest.raises(cd.MeasurementError, match=f"{kind.lower()}: {field} = {value!r}, must be"):
        getattr(cd.measurement, kind)("it", **{field: value})
    table_of_it = {kind.lower(): "it", field: value}
    with pytest.raises(cd.MeasurementError, match=r"turns\.driver: "):
        cd.measured(table(it=TIME), turns={"driver": table_of_it})
