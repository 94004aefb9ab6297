"""Files that are spoilt: each is told in one clear message, as an error or as a finding."""

import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

import chaindrive as cd

TWENTY = "time,b\n" + "".join(f"{n},{n}\n" for n in range(20))
COUNT = 600
TIME = np.arange(COUNT) / 1000.0
LOT = np.random.default_rng(40)
GOOD = np.round(100.0 + 5.0 * np.sin(2 * np.pi * 30.0 * TIME) + LOT.standard_normal(COUNT), 4)


def table(**changes: Any) -> pd.DataFrame:
    return pd.DataFrame({"time [s]": TIME, "torque [Nm]": GOOD} | changes)


def torque(change: Callable[[np.ndarray], Any]) -> pd.DataFrame:
    values = GOOD.copy()
    change(values)
    return table(**{"torque [Nm]": values})


def times(change: Callable[[np.ndarray], Any]) -> pd.DataFrame:
    values = TIME.copy()
    change(values)
    return table(**{"time [s]": values})


def put(at: Any, value: Any) -> Callable[[np.ndarray], Any]:
    def change(values: np.ndarray) -> None:
        values[at] = value

    return change


# What is said where nothing is read; every message has one line.
REFUSED: dict[str, tuple[str, str | bytes | None, dict[str, Any], str]] = {
    "no file": ("rig.csv", None, {}, "does not exist"),
    "empty": ("rig.csv", "", {}, "is empty"),
    "no format": ("rig.xyz", "1", {}, "no format ends in '.xyz'"),
    "headings only": ("rig.csv", "time,torque\n", {}, "no line of numbers"),
    "prose": ("rig.txt", "Dear all,\nthe rig was fine.\n", {}, "no line of numbers"),
    "zero bytes": ("rig.csv", b"t,x\n\x00\x00\x00\x00\n", {}, "zero bytes"),
    "ragged": ("rig.csv", "time,a\n" + "0,1\n" * 20 + "1,2,3,4\n", {}, "Expected 2 fields"),
    "no time": ("rig.csv", "a,b\n" + "1,2\n" * 20, {}, "no channel is called time"),
    "a time of metres": ("rig.csv", "time [mm],b\n" + "1,2\n" * 20, {}, "which is no time"),
    "too short": ("rig.csv", "time,b\n0,1\n1,2\n2,1\n", {}, "3 samples are too few"),
    "time runs back": (
        "rig.csv",
        "time,b\n" + "".join(f"{9 - n},{n}\n" for n in range(20)),
        {},
        "time goes back 19 times",
    ),
    "two records": (
        "rig.csv",
        "time,b\n" + "".join(f"{n % 50},{n * n}\n" for n in range(100)),
        {},
        "time goes back 1 times",
    ),
    "time stands": (
        "rig.csv",
        "time,b\n" + "".join(f"{n // 10},{n}\n" for n in range(100)),
        {},
        "have the time of the one before",
    ),
    "no such channel": (
        "rig.csv",
        TWENTY,
        {"channels": ["torque"]},
        "no channel is named 'torque': there are 'time', 'b'",
    ),
    "no such unit": (
        "rig.csv",
        TWENTY,
        {"channels": {"b": {"unit": "furlong"}}},
        "unknown unit `furlong`",
    ),
    "no such field": (
        "rig.csv",
        TWENTY,
        {"channels": {"b": {"gian": 2}}},
        "a sensor has no 'gian'",
    ),
    "no such angle": (
        "rig.csv",
        TWENTY,
        {"turns": {"driver": {"encoder": "enc", "counts": 4}}},
        "no channel is named 'enc'",
    ),
    "no pulses": (
        "rig.csv",
        "time,b\n" + "".join(f"{n},{n % 100}\n" for n in range(90)),
        {"turns": {"driver": {"tacho": "b"}}},
        "has 1 pulses through 44.5",
    ),
    "a speed in kilograms": (
        "rig.csv",
        TWENTY,
        {"turns": {"driver": "300 kg"}},
        "is a mass",
    ),
    "nothing left": (
        "rig.csv",
        TWENTY,
        {"start": "15 s"},
        "leave 5 samples",
    ),
    "unknown encoding": ("rig.csv", "time,b\n0,1\n", {"encoding": "klingon"}, "none that Python"),
    "an option of others": ("rig.wav", "RIFF", {"decimal": ","}, "decimal is for tables of text"),
    "no Parquet": ("rig.parquet", "PAR0 nothing", {}, "cannot be read as Parquet"),
    "no NetCDF": ("rig.nc", "nothing", {}, "cannot be read as NetCDF"),
    "no HDF5": ("rig.h5", "nothing", {}, "cannot be read as HDF5"),
    "no TDMS": ("rig.tdms", "nothing, and more of it", {}, "no channel of numbers"),
    "no WAV": ("rig.wav", "nothing, and more of it", {}, "cannot be read as WAV"),
    "half a WAV": (
        "rig.wav",
        b"RIFF\x24\x10\x00\x00WAVEfmt \x10\x00\x00\x00\x01\x00",
        {},
        "cannot be read as WAV",
    ),
}


# Findings by name; each record has one fault, and one finding of it.
FOUND: dict[str, tuple[Callable[[], pd.DataFrame], dict[str, Any], str, str]] = {
    "a gap": (
        lambda: times(put(slice(300, None), TIME[300:] + 0.5)),
        {},
        "gap",
        "longest of 0.501 s",
    ),
    "a sample twice": (
        lambda: table().iloc[[*range(100), *range(99, COUNT)]],
        {},
        "duplicate",
        "first at 0.099 s",
    ),
    "a step back": (
        lambda: times(put([200, 201], TIME[[201, 200]])),
        {},
        "back-in-time",
        "from 0.201 s to 0.2 s",
    ),
    "jitter": (
        lambda: times(put(slice(None), TIME + 1e-4 * np.sin(77.0 * np.arange(COUNT)))),
        {},
        "jitter",
        "scatter by",
    ),
    "missing values": (lambda: torque(put(slice(50, 60), np.nan)), {}, "dropout", "10 of 600"),
    "a stand": (lambda: torque(put(slice(50, 90), GOOD[50])), {}, "dropout", "for 40 samples"),
    "zeros": (lambda: torque(put(slice(50, 90), 0.0)), {}, "dropout", "at 0"),
    "a dead channel": (lambda: torque(put(slice(None), 7.0)), {}, "dropout", "throughout"),
    "clipped": (
        lambda: table(**{"torque [Nm]": np.minimum(GOOD, 103.0)}),
        {},
        "clipped",
        "at the greatest reading, 103",
    ),
    "texts among numbers": (
        lambda: table(**{"torque [Nm]": [*GOOD[:-1].tolist(), "ERR"]}),
        {},
        "not-a-number",
        "1 cells are no numbers",
    ),
    "volts": (lambda: table().rename(columns={"torque [Nm]": "torque [V]"}), {}, "unit", "'V'"),
    "too slow": (
        table,
        {"turns": {"driver": "6000 rpm"}, "orders": {"driver": 19}},
        "aliased",
        "less than twice the 1900 Hz of order 19 of driver",
    ),
    "a pulse missing": (
        lambda: table(
            tacho=np.where((np.arange(COUNT) % 20 < 5) & (np.arange(COUNT) // 20 != 9), 5.0, 0.0)
        ),
        {"turns": {"driver": {"tacho": "tacho", "pulses": 4}}, "channels": ["torque"]},
        "dropout",
        "1 pulses are missing",
    ),
}


def test_there_are_forty_spoilt_files() -> None:
    assert len(REFUSED) + len(FOUND) >= 40


@pytest.mark.parametrize("name", REFUSED)
@pytest.mark.filterwarnings("ignore")
def test_what_cannot_be_read_is_refused_in_one_line(name: str, tmp_path: Path) -> None:
    file, content, options, words = REFUSED[name]
    for package, needs in (("nptdms", ".tdms"), ("h5py", ".h5")):
        if file.endswith(needs):
            pytest.importorskip(package)
    path = tmp_path / file
    if content is not None:
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
    with pytest.raises(cd.ChaindriveError) as raised:
        cd.measured(path, **options)
    message = str(raised.value)
    assert words in message
    assert "\n" not in message
    assert len(message) < 400


@pytest.mark.parametrize("name", FOUND)
def test_a_fault_is_one_finding(name: str, tmp_path: Path) -> None:
    make, options, kind, words = FOUND[name]
    make().to_csv(tmp_path / "rig.csv", index=False, na_rep="NaN")
    with pytest.warns(cd.MeasurementWarning, match="rig.csv: ") as said:
        data = cd.measured(tmp_path / "rig.csv", **options)
    assert len(said) == 1
    assert [it for it in data.attrs["findings"] if it != "unit"] == [kind] * (kind != "unit")
    assert words in data.attrs["findings_note"]
    assert words in str(said[0].message)


def test_a_sound_record_has_no_findings() -> None:
    """Nor has one of a slow converter, whose readings step by digits."""
    coarse = np.round(GOOD / 2.0) * 2.0
    slow = 20.0 * np.round(np.sin(2 * np.pi * 3.0 * TIME) * 100.0)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        data = cd.measured(table(coarse=coarse, slow=slow))
    assert data.attrs["findings"] == []
