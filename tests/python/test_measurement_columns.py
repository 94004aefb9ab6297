"""Columns of a measurement: which of them is the time, and no other one is lost."""

import re
import warnings
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
    "a unit": (
        {"Zeit": 1e3 * TIME, "a": OIL},
        {"channels": {"Zeit": {"unit": "ms"}, "a": {}}},
        ["a"],
    ),
    "a scale": (
        {"x": 1e3 * TIME, "a": OIL},
        {"time": "x", "channels": {"x": {"scale": 1e-3}, "a": {}}},
        ["a"],
    ),
    "another unit": (
        {"time [m]": 1e3 * TIME, "a": OIL},
        {"channels": {"time": {"unit": "ms"}, "a": {}}},
        ["a"],
    ),
    "a T of a unit": (
        {"T": 7.0 * TIME, "clock": TIME},
        {"channels": {"T": {"unit": "degC"}}},
        ["T"],
    ),
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


def test_a_time_without_a_unit_is_told_and_no_fault() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        data = cd.measured(pd.DataFrame({"Zeit": TIME, "a": OIL}))
    assert data.attrs["findings"] == ["seconds"]
    assert data.attrs["findings_note"].startswith("Zeit: has no unit, and is taken in seconds")


def test_channels_that_are_the_time_alone_are_refused() -> None:
    table = pd.DataFrame({"Zeit": TIME, "a": OIL})
    with pytest.raises(cd.MeasurementError, match=r"names the time alone; .* there are 'a'"):
        cd.measured(table, channels={"Zeit": {"unit": "ms"}})


def written(folder: Path, heading: str, line: str) -> Path:
    """Write a table of 20 lines, whose time is the number that stands in them."""
    path = folder / "rig.csv"
    path.write_text("\n".join([heading, *(line.format(n) for n in range(20))]), encoding="utf-8")
    return path


GERMAN = "Zeit [ms];Kraft [N];Drehmoment [Nm]"
#: Headings, a line, options, and the force [N] in it; the time is in milliseconds.
FORCES: dict[str, tuple[str, str, dict[str, Any], float]] = {
    "English": ("Time [ms],Force [N]", '{},"6,396.6"', {}, 6396.6),
    "English, whole": ("Time [ms],Force [N]", '{},"6,397"', {}, 6397.0),
    "millions": ("Time [ms],Force [N]", '{},"-1,006,397.5"', {}, -1006397.5),
    "German": (GERMAN, "{};6.396,6;-470,9556", {}, 6396.6),
    "German, stated": (GERMAN, "{};6.396,6;-470", {"decimal": ",", "separator": ";"}, 6396.6),
    "whole, by the others": (GERMAN, "{};6.397;-470,9556", {}, 6397.0),
    "whole, stated": (GERMAN, "{};6.397;-471", {"decimal": ","}, 6397.0),
    "decimals, if they may be": (GERMAN, "{};6,397;-470,956", {}, 6.397),
    "blanks": (GERMAN, "{};6 396,6;-470,9556", {}, 6396.6),
    "blanks between tabs": (GERMAN.replace(";", "\t"), "{}\t6 396,6\t-470,9", {}, 6396.6),
    "blanks that do not break": (GERMAN, "{};6\u00a0396,6;-470,9556", {}, 6396.6),
    "Swiss": (GERMAN, "{};6'396.6;-470.9556", {}, 6396.6),
    "quoted": ("Zeit [ms],Kraft [N]", '"{},0","6,3966"', {}, 6.3966),
    "quoted, stated": (
        "Zeit [ms],Kraft [N]",
        '{},"6,397"',
        {"decimal": ",", "separator": ","},
        6.397,
    ),
}


@pytest.mark.parametrize("name", FORCES)
@pytest.mark.filterwarnings("ignore:.*throughout:chaindrive.MeasurementWarning")
def test_thousands_and_decimals_are_told_apart(name: str, tmp_path: Path) -> None:
    heading, line, options, force = FORCES[name]
    with warnings.catch_warnings():
        warnings.simplefilter("error", FutureWarning)
        data = cd.measured(written(tmp_path, heading, line), **options)
    np.testing.assert_allclose(data["time"], np.arange(20) / 1e3, atol=1e-12)
    _, second, *others = heading.replace(";", ",").replace("\t", ",").split(",")
    channel = data[second.removesuffix(" [N]")]
    assert channel.attrs["units"] == "N"
    np.testing.assert_allclose(channel, force, rtol=1e-15)
    assert len(data.data_vars) == 1 + len(others)


@pytest.mark.parametrize(
    ("heading", "cell"),
    [
        ("lot", "3/14"),
        ("lot", "2024-11"),
        ("a [N]", "2024-11-26 10:00:00"),
        ("a", "12,50.1"),
    ],
)
def test_a_column_of_texts_is_no_date_and_told(heading: str, cell: str, tmp_path: Path) -> None:
    path = written(tmp_path, f"Time [ms];b;{heading}", "{0};{0}.5;" + cell)
    name = heading.partition(" ")[0]
    text = f"{name}: holds texts such as {cell!r}, and is left out"
    with pytest.warns(cd.MeasurementWarning, match=re.escape(text)):
        data = cd.measured(path)
    assert list(data.data_vars) == ["b"]
    assert data.attrs["findings"] == ["not-a-number"]
    # A reader who named other channels knows.
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        cd.measured(path, channels=["b"])
    with pytest.raises(cd.MeasurementError, match=f"{name} holds texts .* there are 'Time', 'b'"):
        cd.measured(path, channels=[name])


@pytest.mark.parametrize(
    "form",
    [
        "%d.%m.%Y %H:%M:%S,%f",
        "%d.%m.%y %H:%M:%S.%f",
        "%m/%d/%Y %I:%M:%S.%f %p",
        "%d-%b-%Y %H:%M:%S.%f",
        "%Y-%m-%dT%H:%M:%S.%fZ",
    ],
)
def test_dates_of_a_column_have_one_form(form: str, tmp_path: Path) -> None:
    """Over a midnight: day and month are the same ones in all lines."""
    moments = pd.Timestamp("2024-12-03 23:59:59.995") + pd.to_timedelta(np.arange(20), unit="ms")
    path = tmp_path / "rig.csv"
    rows = [f"{it};{n}.5;{-n}" for n, it in enumerate(moments.strftime(form))]
    path.write_text("\n".join(["time;a;b", *rows]))
    data = cd.measured(path)
    np.testing.assert_allclose(data["time"], np.arange(20) / 1e3, atol=1e-12)
    # One cell of another form, and it is none.
    path.write_text("\n".join(["time;a;b", *rows, "3/14;1.5;2"]))
    with pytest.raises(cd.MeasurementError, match="called time: time holds texts such as '3/14'"):
        cd.measured(path)


@pytest.mark.parametrize(
    ("heading", "line", "notes"),
    [
        ("Zeit [ms];a [N];spare", "{0};{0}.5;", ["spare: holds nothing, and is left out"]),
        ("Zeit [ms];a [N];", "{0};{0}.5;", []),
        ("Zeit [ms];a [N]", "{0};{0}.5;;", []),
        ("Zeit [ms];a [N];;", "{0};{0}.5", []),
        ("Test 7;;\nZeit;a;count\nms;N;", "{0};{0}.5;", ["count: holds nothing, and is left out"]),
    ],
)
def test_empty_cells_at_the_ends_of_lines_cost_no_heading(
    heading: str, line: str, notes: list[str], tmp_path: Path
) -> None:
    data = cd.measured(written(tmp_path, heading, line))
    np.testing.assert_allclose(data["time"], np.arange(20) / 1e3, atol=1e-12)
    assert list(data.data_vars) == ["a"]
    assert data["a"].attrs["units"] == "N"
    assert data.attrs["findings_note"] == "; ".join(notes)


def test_a_table_of_pandas_tells_its_texts() -> None:
    table = pd.DataFrame(RIG).assign(lot="3/14", spare=None)
    with pytest.warns(cd.MeasurementWarning, match="lot: holds texts such as '3/14'") as said:
        data = cd.measured(table)
    assert "spare" not in str(said[0].message)
    assert data.attrs["findings"] == ["not-a-number", "text"]


def test_a_decimal_mark_is_a_point_or_a_comma(tmp_path: Path) -> None:
    with pytest.raises(cd.MeasurementError, match=re.escape("decimal = ';', must be '.' or ','")):
        cd.measured(written(tmp_path, "time;a", "{};1"), decimal=";")
