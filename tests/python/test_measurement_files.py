"""Measurements as other programs write them: the same numbers, units and times come back."""

import wave
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from scipy.io import wavfile

import chaindrive as cd

RATE = 5000.0
TIME = np.arange(400) / RATE
# Drawn by lot, so that no two samples are alike and nothing looks like a fault.
LOT = np.random.default_rng(57)
TORQUE = 120.0 + 3.0 * np.sin(2 * np.pi * 95.0 * TIME) + LOT.standard_normal(TIME.size)
FORCE = 6.5 + 0.1 * LOT.standard_normal(TIME.size)


def csv(path: Path) -> None:
    table = pd.DataFrame({"time [s]": TIME, "torque [N m]": TORQUE, "force [kN]": FORCE})
    table.to_csv(path, index=False)


def german(path: Path) -> None:
    """Semicolons, decimal commas, the code page of Windows, a line of units, an umlaut."""
    table = pd.DataFrame({"Zeit": 1e3 * TIME, "torque": TORQUE, "force": FORCE})
    text = table.to_csv(index=False, sep=";", decimal=",", header=False)
    head = "Prüfstand 3;\nZeit;torque;force\nms;Nm;kN\n"
    path.write_bytes((head + text).encode("cp1252"))


def labview(path: Path) -> None:
    """Tabs, UTF-16, and units in brackets."""
    table = pd.DataFrame({"Time (s)": TIME, "torque (Nm)": TORQUE, "force (kN)": FORCE})
    table.to_csv(path, index=False, sep="\t", encoding="utf-16")


def blanks(path: Path) -> None:
    rows = np.stack([TIME, TORQUE, FORCE], axis=1)
    np.savetxt(path, rows, fmt="%.17g", header="time[s] torque[Nm] force[kN]")


def parquet(path: Path) -> None:
    pd.DataFrame({"time [s]": TIME, "torque [N m]": TORQUE, "force [kN]": FORCE}).to_parquet(path)


def parquet_with_units(path: Path) -> None:
    import pyarrow as pa
    import pyarrow.parquet as pq

    columns = {"time": (TIME, "s"), "torque": (TORQUE, "N m"), "force": (FORCE, "kN")}
    fields = [pa.field(it, pa.float64(), metadata={"unit": u}) for it, (_, u) in columns.items()]
    arrays = [pa.array(values) for values, _ in columns.values()]
    pq.write_table(pa.Table.from_arrays(arrays, schema=pa.schema(fields)), path)


def dataset() -> xr.Dataset:
    return xr.Dataset(
        {
            "torque": ("time", TORQUE, {"units": "N m"}),
            "force": ("time", FORCE, {"units": "kN"}),
        },
        coords={"time": ("time", TIME, {"units": "s"})},
    )


def netcdf(path: Path) -> None:
    dataset().to_netcdf(path, engine="h5netcdf")


def classic(path: Path) -> None:
    dataset().to_netcdf(path, engine="scipy")


def hdf5(path: Path) -> None:
    import h5py

    with h5py.File(path, "w") as file:
        group = file.create_group("rig")
        for name, values, unit in (("time", TIME, "s"), ("torque", TORQUE, "N m")):
            group[name] = values
            group[name].attrs["unit"] = unit
        group["force"] = FORCE
        group["force"].attrs["units"] = "kN"


def tdms(path: Path) -> None:
    from nptdms import ChannelObject, TdmsWriter

    with TdmsWriter(path) as writer:
        about = {"wf_increment": 1 / RATE, "wf_start_offset": 0.0}
        writer.write_segment(
            [
                ChannelObject("rig", "torque", TORQUE, about | {"unit_string": "N m"}),
                ChannelObject("rig", "force", FORCE, about | {"unit_string": "kN"}),
            ]
        )


def mdf(path: Path) -> None:
    from asammdf import MDF, Signal

    with MDF(version="4.10") as file:
        signals = [
            Signal(TORQUE, TIME, unit="Nm", name="torque"),
            Signal(FORCE, TIME, unit="kN", name="force"),
        ]
        file.append(signals)
        file.save(path, overwrite=True)


WRITERS: dict[str, tuple[str, Callable[[Path], None]]] = {
    "csv": ("rig.csv", csv),
    "german": ("rig.csv", german),
    "labview": ("rig.txt", labview),
    "blanks": ("rig.dat", blanks),
    "parquet": ("rig.parquet", parquet),
    "parquet with units": ("rig.parquet", parquet_with_units),
    "netcdf": ("rig.nc", netcdf),
    "netcdf 3": ("rig.nc", classic),
    "hdf5": ("rig.h5", hdf5),
    "tdms": ("rig.tdms", tdms),
    "mdf": ("rig.mf4", mdf),
}


@pytest.mark.parametrize(
    "name",
    [
        # Its package takes seconds to import.
        pytest.param(name, marks=pytest.mark.slow if name == "mdf" else [])
        for name in WRITERS
    ],
)
@pytest.mark.filterwarnings("ignore::chaindrive.MeasurementWarning")
def test_files_of_other_programs_come_back(name: str, tmp_path: Path) -> None:
    if name in ("tdms", "mdf"):
        pytest.importorskip({"tdms": "nptdms", "mdf": "asammdf"}[name])
    file, write = WRITERS[name]
    write(tmp_path / file)
    data = cd.measured(tmp_path / file)
    names = {str(it).rpartition(" ")[2]: it for it in data.data_vars}
    assert set(names) == {"torque", "force"}
    assert data["time"].attrs["units"] == "s"
    np.testing.assert_allclose(data["time"], TIME, rtol=0, atol=1e-12)
    torque, force = data[names["torque"]], data[names["force"]]
    np.testing.assert_array_equal(torque, TORQUE)
    np.testing.assert_allclose(force, 1e3 * FORCE, rtol=1e-15)
    assert (torque.attrs["units"], force.attrs["units"]) == ("N m", "N")
    assert torque.attrs["sampling_rate"] == pytest.approx(RATE)
    kinds = set(data.attrs["findings"])
    assert kinds == ({"encoding"} if name == "german" else set())


def test_a_table_of_pandas_with_dates() -> None:
    moments = pd.to_datetime("2026-03-01 10:00") + pd.to_timedelta(np.round(TIME * 1e9), unit="ns")
    table = pd.DataFrame({"torque [Nm]": TORQUE}, index=moments)
    data = cd.measured(table)
    np.testing.assert_allclose(data["time"], TIME, atol=1e-9)
    np.testing.assert_array_equal(data["torque"], TORQUE)


def test_a_run_is_read_back_as_it_was_saved(tmp_path: Path) -> None:
    ring = cd.scenes.spinning_ring()
    run = cd.simulate(ring, until=2e-2, every=1e-4, record="link_tension", error=False)
    for file in ("run.csv", "run.nc"):
        cd.save(run.isel(time=slice(0, -1)), tmp_path / file)
        data = cd.measured(tmp_path / file)
        assert data.sizes["time"] == run.sizes["time"] - 1
        np.testing.assert_array_equal(data["link_tension[3]"], run["link_tension"][:-1, 3])


SOUND = (0.5 * np.sin(2 * np.pi * 440.0 * np.arange(2000) / 48e3)).astype(np.float64)


def wav_24(path: Path) -> None:
    samples = np.round(SOUND * (1 << 23)).astype("<i4")
    with wave.open(str(path), "wb") as file:
        file.setnchannels(1)
        file.setsampwidth(3)
        file.setframerate(48000)
        file.writeframes(samples.view(np.uint8).reshape(-1, 4)[:, :3].tobytes())


@pytest.mark.parametrize(
    ("write", "digit"),
    [
        (lambda path: wavfile.write(path, 48000, SOUND.astype(np.float32)), 2.0**-25),
        (
            lambda path: wavfile.write(path, 48000, np.round(SOUND * 2**15).astype(np.int16)),
            2.0**-16,
        ),
        (
            lambda path: wavfile.write(path, 48000, np.round(SOUND * 128 + 128).astype(np.uint8)),
            2.0**-8,
        ),
        (wav_24, 2.0**-24),
    ],
    ids=["float", "16 bit", "8 bit", "24 bit"],
)
def test_sounds_are_in_shares_of_their_full_scale(
    write: Callable[[Path], None], digit: float, tmp_path: Path
) -> None:
    write(tmp_path / "mic.wav")
    data = cd.measured(tmp_path / "mic.wav")
    assert data["channel 1"].attrs["sampling_rate"] == pytest.approx(48e3)
    np.testing.assert_allclose(data["channel 1"], SOUND, atol=1.001 * digit)


def test_channels_of_several_rates_keep_their_own_times(tmp_path: Path) -> None:
    pytest.importorskip("nptdms")
    from nptdms import ChannelObject, TdmsWriter

    begin = np.datetime64("2026-03-01T10:00:00.000000")
    with TdmsWriter(tmp_path / "rig.tdms") as writer:
        for name, rate, start in (("fast", 5e3, 0), ("slow", 50.0, 100)):
            about = {"wf_increment": 1 / rate, "wf_start_offset": 0.0}
            about["wf_start_time"] = begin + np.timedelta64(start, "ms")
            values = LOT.standard_normal(round(rate))
            writer.write_segment([ChannelObject("rig", name, values, about)])
    data = cd.measured(tmp_path / "rig.tdms")
    assert data["fast"].dims == ("time",)
    assert data["slow"].dims == ("time_2",)
    assert float(data["time_2"][0]) == pytest.approx(0.1)
    assert data["slow"].attrs["sampling_rate"] == pytest.approx(50.0)


def test_sign_offset_scale_and_unit_are_applied() -> None:
    """``x = sign · scale · (r − offset)`` in the unit of the sensor."""
    volts = LOT.uniform(0.0, 5.0, 100)
    table = pd.DataFrame({"time": np.arange(100) / 1e3, "flange [V]": volts})
    with pytest.warns(cd.MeasurementWarning, match="its unit 'V' is none of a drive"):
        plain = cd.measured(table)
    assert plain["flange"].attrs["units"] == "V"
    sensor = {"unit": "kN m", "scale": 0.05, "offset": 2.5, "sign": -1}
    data = cd.measured(table, channels={"flange": sensor})
    np.testing.assert_allclose(data["flange"], -50.0 * (volts - 2.5), rtol=1e-14)
    assert data["flange"].attrs["units"] == "N m"
    warm = cd.measured(table, channels={"flange": {"unit": "degC"}})
    np.testing.assert_allclose(warm["flange"], volts + 273.15, rtol=1e-15)


ANGLE = 2 * np.pi * (5.0 * TIME + 0.02 * np.sin(2 * np.pi * 5.0 * TIME))


@pytest.mark.parametrize("kind", ["counts", "angle", "tacho", "stated", "speed"])
def test_the_angle_of_a_shaft(kind: str) -> None:
    """By an encoder, by pulses or by a speed: the angle that was put in, to what each resolves."""
    counts = np.floor(ANGLE / (2 * np.pi) * 3600) + 65000
    pulse = 5.0 * (np.mod(ANGLE / (2 * np.pi) * 60, 1.0) < 0.3)
    speed = np.gradient(ANGLE, TIME)
    columns, turn, digit = {
        "counts": (
            {"enc": counts % 65536},
            {"encoder": "enc", "counts": 3600, "wraps_at": 65536},
            2 * np.pi / 3600,
        ),
        "angle": ({"enc [deg]": np.degrees(ANGLE) % 360}, {"encoder": "enc"}, 1e-9),
        "tacho": ({"enc [V]": pulse}, {"tacho": "enc", "pulses": 60}, 2 * np.pi / 60 / 5),
        "stated": ({"enc": counts}, "300 rpm", 0.13),
        "speed": ({"enc [rpm]": speed * 30 / np.pi}, "enc", 1e-4),
    }[kind]
    table = pd.DataFrame({"time": TIME, "torque [Nm]": TORQUE, **columns})
    data = cd.measured(table, channels=["torque"], turns={"driver": turn})
    angle = data["sprocket_angle"].sel(sprocket="driver").to_numpy()
    error = (angle - angle[0]) - (ANGLE - ANGLE[0])
    assert np.ptp(error) <= 2.0 * digit
    assert (np.diff(angle) >= 0.0).all()


def test_analyses_of_runs_take_a_measurement() -> None:
    """The order of the mesh of 19 teeth, three of it: 3 N m."""
    time = np.arange(10000) / RATE
    torque = 100.0 + 3.0 * np.sin(19 * 2 * np.pi * 5.0 * time)
    table = pd.DataFrame({"time": time, "torque [Nm]": torque})
    data = cd.measured(table, turns={"driver": "300 rpm"})
    spread = cd.analysis.order_spectrum(data, "torque", "driver")
    lines = cd.analysis.peaks(spread, count=1)
    assert float(lines["order"][0]) == pytest.approx(19.0, abs=0.02)
    assert float(lines["amplitude"][0]) == pytest.approx(3.0, rel=0.01)
