"""Columns of a measurement: which of them is the time, and no other one is lost."""

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

import chaindrive as cd

TIME = np.arange(400) / 1000.0
LOT = np.random.default_rng(58)
FLANGE = 100.0 + LOT.standard_normal(TIME.size)
OIL = 60.0 + LOT.standard_normal(TIME.size)
RIG = {"time [s]": TIME, "flange [N m]": FLANGE}
DATES = pd.to_datetime("2026-03-01") + pd.to_timedelta(7.0 * TIME, unit="s")

#: Columns, options, and the channels that come of them; their time is `TIME`.
COLUMNS: dict[str, tuple[dict[str, Any], dict[str, Any], list[str]]] = {
    "a wrong time": (RIG | {"time [s]": 2.0 * TIME}, {"rate": 1000.0}, ["flange"]),
    "a time without a unit": ({"time": 2.0 * TIME, "a": OIL}, {"rate": "1 kHz"}, ["a"]),
    "dates before": ({"timestamp": DATES} | RIG, {}, ["flange"]),
    "seconds before": ({"seconds": 3.0 * TIME + 5.0} | RIG, {}, ["flange"]),
    "one that is said": (RIG | {"time [s]": DATES, "s": TIME}, {"time": "s"}, ["flange"]),
    "a day before": ({"Date": DATES.normalize(), "Zeit [ms]": 1e3 * TIME, "a": OIL}, {}, ["a"]),
    "oil in degrees": ({"T oil [degC]": OIL} | RIG, {}, ["T oil", "flange"]),
    "T": ({"T": OIL} | RIG, {}, ["T", "flange"]),
    "t": ({"T [degC]": OIL, "t": TIME}, {}, ["T"]),
    "a time in metres": ({"time [m]": OIL, "t [s]": TIME}, {}, ["time 1"]),
}


@pytest.mark.parametrize("name", COLUMNS)
@pytest.mark.filterwarnings("ignore::chaindrive.MeasurementWarning")
def test_the_time_is_the_likeliest_and_no_other_column_is_taken_for_it(name: str) -> None:
    columns, options, channels = COLUMNS[name]
    data = cd.measured(pd.DataFrame(columns), **options)
    np.testing.assert_allclose(data["time"], TIME, rtol=0, atol=1e-12)
    assert list(data.data_vars) == channels


def test_a_second_time_is_told_and_no_fault() -> None:
    data = cd.measured(pd.DataFrame({"timestamp": DATES} | RIG))
    assert data.attrs["findings"] == ["text"]
    assert data.attrs["findings_note"].startswith("timestamp: is a time that is not taken")


def test_a_table_of_text_has_a_date_beside_its_time(tmp_path: Path) -> None:
    rows = "".join(f"2026-03-01;{time};;{it}\n" for time, it in zip(TIME, FLANGE, strict=True))
    (tmp_path / "rig.csv").write_text("Date;Time [s];spare;flange [Nm]\n" + rows)
    data = cd.measured(tmp_path / "rig.csv")
    np.testing.assert_array_equal(data["time"], TIME)
    assert list(data.data_vars) == ["flange"]
    assert "spare: holds nothing, and is left out" in data.attrs["findings_note"]


@pytest.mark.parametrize(
    ("names", "called"),
    [
        (["a/b", "a b"], ["a b 1", "a b 2"]),
        (["sprocket", "b"], ["sprocket 1", "b"]),
        (["sprocket_angle", "sprocket_angle 1"], ["sprocket_angle 2", "sprocket_angle 1"]),
    ],
)
def test_channels_of_one_name_or_of_a_coordinate_are_numbered(
    names: list[str], called: list[str]
) -> None:
    rig = pd.DataFrame(RIG | dict(zip(names, (OIL, OIL[::-1]), strict=True)))
    with pytest.warns(cd.MeasurementWarning, match=f"{names[0]}: is called {called[0]!r} here"):
        data = cd.measured(rig, turns={"driver": "300 rpm"})
    assert list(data.data_vars) == ["flange", *called, "sprocket_angle"]
    assert data["sprocket_angle"].dims == ("time", "sprocket")
    for name, key in zip(names, called, strict=True):
        assert data[key].attrs["in_file"] == name


#: Arrays and where a rate of 1 kHz stands, and the channels that come of them.
ARRAYS: dict[str, tuple[dict[str, Any], str, list[str]]] = {
    "each": ({"x": OIL, "y": FLANGE, "z": -OIL}, "each", ["x", "y", "z"]),
    "file": ({"x": OIL, "y": FLANGE, "z": -OIL}, "file", ["x", "y", "z"]),
    "temperature": ({"T": OIL, "y": FLANGE}, "file", ["T", "y"]),
    "time before x": ({"X": 2.0 * TIME, "time": TIME, "y": FLANGE}, "", ["X", "y"]),
    "x": ({"x": TIME, "y": FLANGE}, "", ["y"]),
    "a time with a rate": ({"time": TIME, "y": FLANGE}, "each", ["y"]),
}


@pytest.mark.parametrize("name", ARRAYS)
def test_an_array_of_hdf5_is_a_channel_unless_it_is_the_time(name: str, tmp_path: Path) -> None:
    h5py = pytest.importorskip("h5py")
    arrays, place, channels = ARRAYS[name]
    with h5py.File(tmp_path / "rig.h5", "w") as file:
        for array, values in arrays.items():
            file[array] = values
        for it in {"each": list(file.values()), "file": [file]}.get(place, []):
            it.attrs["fs"] = 1000.0
    data = cd.measured(tmp_path / "rig.h5")
    assert list(data.data_vars) == channels
    np.testing.assert_allclose(data["time"], TIME, rtol=0, atol=1e-12)


@pytest.mark.parametrize("count", [2, 3])
def test_columns_of_one_heading_are_numbered(count: int, tmp_path: Path) -> None:
    columns = [TIME, FLANGE, OIL, FLANGE * OIL][: count + 1]
    table = pd.DataFrame(np.stack(columns, axis=1), columns=["time [s]", *["a [N]"] * count])
    table.to_csv(tmp_path / "rig.csv", index=False)
    for source in (table, tmp_path / "rig.csv"):
        data = cd.measured(source)
        assert list(data.data_vars) == ["a 1", "a 2", "a 3"][:count]
        np.testing.assert_array_equal(data[f"a {count}"], columns[-1])


def test_an_index_that_is_a_column_too_is_read_once() -> None:
    data = cd.measured(pd.DataFrame(RIG).set_index("time [s]", drop=False))
    assert list(data.data_vars) == ["flange"]


@pytest.mark.parametrize("table", [pd.DataFrame(), pd.DataFrame(RIG).iloc[:0]])
def test_a_table_without_rows_is_refused(table: pd.DataFrame) -> None:
    with pytest.raises(cd.MeasurementError, match="DataFrame: no channel of numbers is in it"):
        cd.measured(table)


@pytest.mark.parametrize("kind", ["datetime64[ns]", "timedelta64[ns]"])
def test_a_column_without_any_date_is_left_out(kind: str) -> None:
    data = cd.measured(pd.DataFrame(RIG).assign(when=pd.Series(np.nan, dtype=kind)))
    assert list(data.data_vars) == ["flange"]
    assert "when: holds nothing, and is left out" in data.attrs["findings_note"]
