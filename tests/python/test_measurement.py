"""A run held against measurements that are made of runs, so that what is true is known."""

import json
import subprocess
import sys
import tomllib
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pandas as pd
import pytest
import xarray as xr

mpl.use("Agg")
from matplotlib import pyplot as plt

import chaindrive as cd
from chaindrive.measurement.bands import band_of, judged
from chaindrive.measurement.blocks import Estimate
from chaindrive.measurement.free import FreeParameter, free_parameters
from chaindrive.measurement.identifiability import identifiability

RATE = 5000.0
LOAD = "sprockets.driven.load[0].torque"
CHANNELS = ["span_tension", "sprocket_torque", "sprocket_angle"]
FLANGE = cd.measurement.Sensor(quantity="sprocket_torque[driver]", gain_uncertainty=0.002)


@pytest.fixture(scope="module")
def run() -> xr.Dataset:
    drive = cd.scenes.industrial_16b()
    return cd.simulate(drive, until=0.3, every=5e-5, record=CHANNELS)


@pytest.fixture(scope="module")
def table() -> pd.DataFrame:
    """The same drive from another phase, with another step and sampling, and noise upon it."""
    drive = cd.scenes.industrial_16b().replace({"route.phase": 0.37})
    settings = {"until": 0.5, "every": 1 / RATE, "step": 6e-6, "method": "verlet"}
    truth = cd.simulate(drive, record=CHANNELS, error=False, run_in=0.3, **settings)
    truth = truth.isel(time=slice(0, -1))
    noise = np.random.default_rng(16).standard_normal((2, truth.sizes["time"]))
    return pd.DataFrame(
        {
            "time [s]": truth["time"],
            "strand driven-driver [N]": truth["span_tension"][:, 1] + 5.0 * noise[0],
            "torque driver [Nm]": truth["sprocket_torque"][:, 0] + 0.5 * noise[1],
        }
    )


def read(table: pd.DataFrame, **channels: object) -> xr.Dataset:
    return cd.measured(table, channels=channels or None, turns={"driver": "300 rpm"})


def test_the_right_model_agrees_and_a_gain_is_missed(run: xr.Dataset, table: pd.DataFrame) -> None:
    found = cd.compare(run, read(table))
    assert found["quantity"].to_numpy().tolist() == [
        "span_tension[driven-driver]",
        "sprocket_torque[driver]",
    ]
    assert found["verdict"].to_numpy().tolist() == ["agrees", "agrees"]
    means = found.sel(statistic="mean")
    assert (abs(means["difference"]) <= means["half_width"]).all()
    assert float(found["correlation"].sel(quantity="span_tension[driven-driver]")) > 0.98
    # A gauge that reads 10 % too much misses by that; one that may err by 10 % does not.
    wrong = table.assign(**{"strand driven-driver [N]": 1.1 * table["strand driven-driver [N]"]})
    missed = cd.compare(run, read(wrong)).isel(quantity=0)
    assert missed["verdict"].item() == "misses"
    mean = missed.sel(statistic="mean")
    assert float(mean["difference"]) == pytest.approx(
        -0.1 / 1.1 * float(mean["measured"]), rel=0.01
    )
    loose = cd.measurement.Sensor("span_tension[driven-driver]", gain_uncertainty=0.1)
    told = cd.compare(run, read(wrong, **{"strand driven-driver": loose})).isel(quantity=0)
    assert told["verdict"].item() == "cannot tell"
    assert "the band is" in told.sel(statistic="mean")["reason"].item()


def test_the_order_of_the_mesh_has_its_amplitude_and_phase(
    run: xr.Dataset, table: pd.DataFrame
) -> None:
    """Of the same drive both are the same; against the amplitude of a least-squares fit."""
    found = cd.compare(run, read(table)).sel(quantity="span_tension[driven-driver]")
    tension = table["strand driven-driver [N]"].to_numpy()
    angle = 19 * 2 * np.pi * 5.0 * table["time [s]"].to_numpy()
    waves = np.stack([np.ones_like(angle), np.cos(angle), np.sin(angle)], axis=1)
    _, *pair = np.linalg.lstsq(waves, tension, rcond=None)[0]
    mesh = found.sel(order=19.0)
    assert float(mesh["measured_amplitude"]) == pytest.approx(np.hypot(*pair), rel=0.01)
    assert float(mesh["simulated_amplitude"]) == pytest.approx(np.hypot(*pair), rel=0.03)
    second = found.sel(order=38.0)
    apart = float(second["measured_phase"] - second["simulated_phase"])
    assert abs(np.angle(np.exp(1j * apart))) < 0.3


def test_a_run_without_an_estimate_tells_nothing(table: pd.DataFrame) -> None:
    drive = cd.scenes.industrial_16b()
    plain = cd.simulate(drive, until=0.1, record=CHANNELS, error=False)
    found = cd.compare(plain, read(table))
    assert (found["verdict"] == "cannot tell").all()
    assert "states no numerical error" in found["reason"].to_numpy().ravel()[0]


def test_signals_are_aligned_in_time_by_correlation(run: xr.Dataset) -> None:
    """Readings that come 7.3 ms late are found to do so."""
    tension = run["span_tension"][:-1, 1].to_numpy()
    time = run["time"][:-1].to_numpy()
    late = np.interp(time[:4000], time, tension)[146:]
    rows = pd.DataFrame({"time": time[: late.size], "strand driven-driver [N]": late})
    data = cd.measured(rows)
    found = cd.compare(run, data)
    # The mesh repeats: any multiple of its period is the same.
    period = 1.0 / 95.0
    apart = (float(found["shift"][0]) + 146 * 5e-5) % period
    assert min(apart, period - apart) < 2e-5
    assert float(found["correlation"][0]) > 0.999


def test_lines_of_the_mesh_are_found_in_a_sound(run: xr.Dataset) -> None:
    """Lines 1 to 5 within 0.1 % of where they were put, 1.5 % off the drive; no amplitude."""
    rate, mesh = 20000, 95.0 * 1.015
    time = np.arange(5 * rate) / rate
    sound = np.random.default_rng(5).standard_normal(time.size) * 0.2
    for multiple in range(1, 6):
        sound += 0.1 / multiple * np.sin(2 * np.pi * multiple * mesh * time + multiple)
    data = cd.measured(pd.DataFrame({"time": time, "mic": sound}), channels={"mic": "vibration"})
    found = cd.compare(run, data).isel(quantity=0)
    np.testing.assert_allclose(found["line_frequency"], mesh * np.arange(1, 6), rtol=1e-3)
    np.testing.assert_allclose(found["mesh_frequency"], 95.0 * np.arange(1, 6), rtol=1e-3)
    assert found["verdict"].item() == "cannot tell"
    assert (found["judgement"] == "cannot tell").all()


def test_bands_are_those_of_student() -> None:
    """``t √(u₁² + u₂² + u_s²) + b``: with 8 degrees of freedom and 95 %, t = 2.306 (tables)."""
    exact = Estimate(10.0, 0.0, 10**9)
    band = band_of(Estimate(10.0, 0.3, 8), exact, 0.0, 0.05, 0.95)
    assert band.freedom == pytest.approx(8.0)
    assert band.half_width == pytest.approx(2.306 * 0.3 + 0.05, rel=1e-3)
    # Welch and Satterthwaite of two equal errors: twice the degrees of freedom.
    both = band_of(Estimate(1.0, 0.3, 8), Estimate(1.0, 0.3, 8), 0.0, 0.0, 0.95)
    assert both.freedom == pytest.approx(16.0)
    assert judged(0.7, band, 10.0, 0.2).verdict == "agrees"
    assert judged(-0.8, band, 10.0, 0.2).verdict == "misses"
    assert judged(0.1, band, 1.0, 0.2).verdict == "cannot tell"


# A sine of 40 Hz of amplitude 1, sampled densely.
FINE = np.arange(40000) / 20000.0
SINE = np.sin(2 * np.pi * 40.0 * FINE)


@pytest.mark.parametrize(
    ("fields", "gain", "lag"),
    [
        # |H| = 1/√(1 + (f/f_c)^2n) and its phase of a first-order low-pass, atan(f/f_c)
        ({"corner": "40 Hz", "order": 1}, 1 / np.sqrt(2.0), np.pi / 4),
        (
            {"corner": "80 Hz", "order": 2},
            1 / np.sqrt(1 + 0.5**4),
            np.arctan2(np.sqrt(2) / 2, 0.75),
        ),
        ({"delay": "2 ms"}, 1.0, 2 * np.pi * 40.0 * 2e-3),
        # sin(π f T)/(π f T), and half of T late
        ({"integration": "10 ms"}, np.sin(0.4 * np.pi) / (0.4 * np.pi), np.pi * 40.0 * 0.01),
        ({"gain": 1.02}, 1.02, 0.0),
    ],
    ids=["first order", "second order", "delay", "integration", "gain"],
)
def test_a_sensor_does_to_a_sine_what_its_transfer_function_says(
    fields: dict[str, object], gain: float, lag: float
) -> None:
    read = cd.measurement.Sensor(**fields).observe(SINE, FINE)[20000:]
    wave = 2.0 * np.mean(read * np.exp(-2j * np.pi * 40.0 * FINE[20000:]))
    assert abs(wave) == pytest.approx(gain, rel=2e-3)
    # sin has the phase −π/2
    assert np.angle(wave * np.exp(1j * (np.pi / 2 + lag))) == pytest.approx(0.0, abs=5e-3)


@pytest.mark.parametrize("field", [{"corner": "2 Hz"}, {"integration": "0.2 s"}])
def test_a_slow_sensor_starts_where_the_quantity_is_in_the_mean(field: dict[str, str]) -> None:
    """It looks back over longer than the record: 300 N at 95 Hz, from their crest on."""
    time = np.arange(3000) / 1e4
    strand = 6500.0 + 300.0 * np.cos(190.0 * np.pi * time)
    read = cd.measurement.Sensor(**field).observe(strand, time)
    assert np.abs(read - 6500.0).max() < 10.0


def test_a_sensor_has_a_zero_that_drifts_and_refuses_what_it_cannot_see() -> None:
    sensor = cd.measurement.Sensor(
        bias=2.0, drift=0.5, bias_uncertainty="3 N", gain_uncertainty=0.01
    )
    np.testing.assert_allclose(sensor.observe(0 * FINE, FINE), 2.0 + 0.5 * FINE)
    assert sensor.uncertainty(400.0, is_mean=True) == pytest.approx(5.0)
    assert sensor.uncertainty(400.0, is_mean=False) == pytest.approx(4.0)
    assert cd.measurement.Sensor.from_json(sensor.to_json()) == sensor
    with pytest.raises(cd.MeasurementError, match="needs samples every"):
        cd.measurement.Sensor(corner="12 kHz").observe(SINE, FINE)
    with pytest.raises(cd.MeasurementError, match=r"gain_uncertainty = 2\.0, must be in \[0, 1\)"):
        cd.measurement.Sensor(gain_uncertainty=2)


def free(*names: str) -> list[FreeParameter]:
    return [FreeParameter(name, 1.0, 3.0, 2.0) for name in names]


def test_an_exact_pair_is_named_in_every_one_of_a_hundred() -> None:
    """Columns that are multiples of each other, of any size and beside any third."""
    lot = np.random.default_rng(100)
    for _ in range(100):
        one, third = lot.standard_normal((2, 12)) * 10.0 ** lot.uniform(-3, 6)
        jacobian = np.stack([one, lot.uniform(0.1, 9.0) * one, third], axis=1)
        errors = np.diag((1e-2 * np.abs(one)) ** 2)
        found = identifiability(free("first", "second", "third"), jacobian, errors)
        ((value, least, words),) = found.combinations
        assert value < 1e-10
        assert least == pytest.approx(1e-4)
        assert [it in words for it in ("first", "second", "third")] == [True, True, False]
        assert np.isinf(found.errors[:2]).all()
        assert np.isfinite(found.errors[2])


def test_errors_of_a_fit_are_those_of_least_squares() -> None:
    """``C = (Jᵀ W J)⁻¹`` of a straight line through n points: σ² / Σ (x − x̄)² for its slope."""
    x = np.linspace(0.0, 1.0, 11)
    jacobian = np.stack([np.ones_like(x), x], axis=1)
    found = identifiability(free("level", "slope"), 10.0 * jacobian, np.diag(np.full(11, 4.0)))
    slope = 2.0 / np.sqrt(((x - x.mean()) ** 2).sum()) / 10.0
    assert found.errors[1] == pytest.approx(slope, rel=1e-9)
    assert found.is_identified
    assert found.correlation[0, 1] == pytest.approx(-x.mean() / np.sqrt((x**2).mean()), rel=1e-9)


@pytest.mark.slow
def test_friction_and_radius_of_pins_are_one_number(table: pd.DataFrame) -> None:
    """The torque of a pin is μ r F: nothing that is measured knows more than the product."""
    drive = cd.scenes.industrial_16b()
    bounds = {
        "contact.joints.friction.coefficient": (0.05, 0.15),
        "chain.joint.pin_diameter": ("7 mm", "9.5 mm"),
    }
    check = cd.check_data(drive, read(table), free=bounds)
    assert not check.attrs["identified"]
    (words,) = check.attrs["combinations"]
    assert words.startswith(
        "only the product contact.joints.friction.coefficient × chain.joint.pin"
    )


@pytest.mark.slow
def test_load_and_stiffness_are_identified(table: pd.DataFrame) -> None:
    drive = cd.scenes.industrial_16b()
    bounds = {
        "sprockets.driven.load[0].torque": ("-1600 N m", "-1300 N m"),
        "sensors.torque driver.gain": (0.95, 1.05),
    }
    check = cd.check_data(drive, read(table), free=bounds)
    assert check.attrs["identified"]
    load = check.sel(parameter="sprockets.driven.load[0].torque")
    assert float(load["start"]) == -1433.0
    assert 0.0 < float(load["error"]) < 30.0


def test_what_cannot_be_freed_is_refused(table: pd.DataFrame) -> None:
    drive, data = cd.scenes.industrial_16b(), read(table)
    for free, words in (
        ({"sprockets.driver.teeth": (17, 21)}, "whole numbers, such as teeth"),
        ({"chain.pich": (1, 2)}, "did you mean `pitch`"),
        ({"chain.stiffness": (2e8, 1e8)}, "is not below"),
        ({"sensors.flange.gain": (0.9, 1.1)}, "no sensor has this"),
        ({"chain.model": ("particles", "ideal-joints")}, "no number that a fit can move"),
        ({"chain.stiffness": 2e8}, "is no pair of bounds"),
        ({}, "no mapping from paths to bounds"),
    ):
        with pytest.raises(cd.MeasurementError, match=words):
            free_parameters(drive, data, free)


def test_slips_of_unit_and_sign_are_named(table: pd.DataFrame) -> None:
    """Channels: a unit a thousandfold, a sign, one that nobody simulates."""
    wrong = table.assign(
        **{
            "strand driven-driver [N]": 1e-3 * table["strand driven-driver [N]"],
            "torque driver [Nm]": -table["torque driver [Nm]"],
            "oil [degC]": 60.0 + np.arange(len(table)) * 1e-3,
        }
    )
    check = cd.check_data(cd.scenes.industrial_16b(), read(wrong), until=0.05)
    problems = dict(zip(check["channel"].to_numpy(), check["problem"].to_numpy(), strict=True))
    assert "kilo mixed up?" in problems["strand driven-driver"]
    assert "its sign is not that of the drive" in problems["torque driver"]
    assert problems["oil"] == "corresponds to no quantity"
    assert "Say in `channels` what oil is" in check.attrs["summary"]
    angle = 36.0 * np.arange(40) % 360.0
    rows = {"time": np.arange(40) / 50.0, "torque driver [Nm]": -480.0 + np.arange(40)}
    turns = {"driver": {"encoder": "shaft"}}
    slow = cd.measured(pd.DataFrame(rows | {"shaft [°]": angle}), turns=turns)
    told = cd.check_data(cd.scenes.industrial_16b(), slow, until=0.05)
    assert "less than twice the 95 Hz of the mesh of driver" in told.attrs["summary"]
    assert "tells how driver turns" in told.attrs["summary"]
    assert told["problem"].sel(channel="shaft").item() == ""


def test_a_comparison_is_drawn(run: xr.Dataset, table: pd.DataFrame) -> None:
    found = cd.compare(run, read(table))
    figure = cd.plot.comparison(found, "sprocket_torque[driver]")
    titles = [ax.get_xlabel() for ax in figure.axes]
    assert titles[:3] == [
        "share of a period [–]",
        "difference over the band of all errors [–]",
        "order of driver [–]",
    ]
    plt.close(figure)
    with pytest.raises(cd.ParameterError, match="this is no comparison"):
        cd.plot.overlay(run)


@pytest.mark.slow
def test_a_report_has_the_comparison(run: xr.Dataset, table: pd.DataFrame) -> None:
    found = cd.compare(run, read(table))
    page = cd.report(run, comparison=found)
    assert "Against the measurement" in page
    assert page.count("span_tension[driven-driver]: differences over their bands") == 2


@pytest.mark.slow
def test_the_command_reads_a_rig_file_and_answers_in_json(
    tmp_path: Path, table: pd.DataFrame
) -> None:
    table.to_csv(tmp_path / "rig.csv", index=False)
    (tmp_path / "rig.toml").write_text(
        '[channels."torque driver"]\nquantity = "sprocket_torque[driver]"\n'
        'gain_uncertainty = 0.002\n[turns]\ndriver = "300 rpm"\n'
    )

    def chaindrive(*arguments: str) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, "-m", "chaindrive", *arguments]
        return subprocess.run(command, capture_output=True, text=True, cwd=tmp_path, check=False)

    rig = ("industrial_16b", "rig.csv", "--rig", "rig.toml")
    told = chaindrive("compare", *rig, "--json", "-o", "report.html")
    assert told.returncode == 0, told.stderr
    (quantity,) = json.loads(told.stdout)["quantities"]
    assert quantity["channel"] == "torque driver"
    assert {it["statistic"] for it in quantity["statistics"]} == {"mean", "std", "p1", "p99"}
    assert "Against the measurement" in (tmp_path / "report.html").read_text(encoding="utf-8")
    bounds = "sprockets.driven.load[0].torque=-1600 N m..-1300 N m"
    checked = chaindrive("check-data", *rig, "--json", "--free", bounds)
    assert json.loads(checked.stdout)["identified"] is True
    refused = chaindrive("check-data", "industrial_16b", "nothing.csv", "--json")
    assert refused.returncode == 2
    assert json.loads(refused.stderr)["error"]["what"].startswith("nothing.csv does not exist")
    again = chaindrive("compare", *rig, "-o", "report.html")
    assert again.returncode == 3


def test_a_drive_without_a_run_in_is_checked(table: pd.DataFrame) -> None:
    """Such a run states no run-in, and its variants have none either."""
    drive = cd.scenes.industrial_16b().replace({"run.run_in": 0})
    free = {LOAD: (-1600.0, -1300.0)}
    found = cd.check_data(drive, read(table), free, until=0.05)
    assert found.attrs["identified"] == 1


@pytest.mark.costs("differences over two steps, of two designs")
def test_what_bends_is_told_and_identified_over_a_shorter_step() -> None:
    """Against a difference of runs over 2 % of half the range; a fifth of it is off by a third."""
    place = Path(__file__).resolve().parents[2] / "docs" / "tutorials"
    rig = tomllib.loads((place / "rig.toml").read_text(encoding="utf-8"))
    data = cd.measured(place / "rig.csv", **rig)
    free = {LOAD: (-1600.0, -1300.0), "route.pretension": (1000.0, 2500.0)}
    drive = cd.scenes.industrial_16b().replace({"run.run_in": "50 ms"})
    found = cd.check_data(drive, data, free, until=0.06)
    assert found.attrs["identified"] == 1, found.attrs["summary"]
    bent = found.sel(parameter="route.pretension")
    assert float(bent["bending"]) > 0.1
    assert float(bent["step"]) < 0.2
    assert "What route.pretension moves bends" in found.attrs["summary"]
    ends = {"route.pretension": [1500.0 - 15.0, 1500.0 + 15.0]}
    runs = cd.sweep(drive, ends, until=0.06, method="verlet", step=1e-5)
    low, high = runs["span_tension_mean"].sel(span="driver-driven").to_numpy()
    slope = bent["sensitivity"].sel(feature="slack strand mean")
    assert float(slope) == pytest.approx((high - low) / 30.0 * 750.0, rel=0.1)
