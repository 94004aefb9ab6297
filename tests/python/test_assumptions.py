"""Assumptions moved one at a time, and all at once: held against sweeps and closed forms."""

import re
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest
import xarray as xr

mpl.use("Agg")
from matplotlib import pyplot as plt

import chaindrive as cd
from chaindrive.assumptions.distributions import distribution_of

LOAD = "sprockets.driven.load[0].torque"
PINS = "contact.joints.friction"


def drive() -> cd.Drive:
    return cd.scenes.industrial_16b().replace({"run.run_in": "20 ms"})


@pytest.fixture(scope="module")
def ranked() -> xr.Dataset:
    ranges = {
        LOAD: ("-1500 N m", "-1300 N m"),
        "friction of pins": tuple(
            {PINS: {"kind": "spring-slider", "coefficient": mu}} for mu in (0.05, 0.15)
        ),
        "nothing": ({}, {}),
    }
    outputs = {
        "power": "sprocket_power_mean[driver]",
        "tight": "span_tension_std[driven-driver]",
        "lost": "loss_share",
        "half": lambda runs: 0.5 * runs["contact_force_p99"],
    }
    return cd.tornado(drive(), ranges, outputs, until=0.02)


def test_a_tornado_is_the_mean_of_differences_phase_by_phase(ranked: xr.Dataset) -> None:
    """Against a sweep of its own; Student's t of two degrees of freedom is 4.303 (tables)."""
    phases = {"route.phase": [0.0, 0.34, 0.67]}
    base, low = (
        cd.sweep(it, phases, until=0.02, method="auto")["span_tension_std"].sel(
            span="driven-driver"
        )
        for it in (drive(), drive().replace({LOAD: -1500.0}))
    )
    moved = (low - base).to_numpy()
    told = ranked.sel(assumption=LOAD, end="low", output="tight")
    assert float(told["change"]) == pytest.approx(moved.mean(), rel=1e-12)
    width = 4.3027 * moved.std(ddof=1) / np.sqrt(3)
    assert float(told["half_width"]) == pytest.approx(width, rel=1e-4)
    assert float(told["value"]) == pytest.approx(float(base.mean()), rel=1e-12)


def test_power_follows_the_load_and_losses_follow_friction(ranked: xr.Dataset) -> None:
    """P = M ω, so 1300 over 1433 N m takes a share of the power; the rest is lost in the chain."""
    torque = -drive().resolved().to_dict()["sprockets"][1]["load"][0]["torque"]
    power = ranked.sel(assumption=LOAD, output="power")["share"].to_numpy()
    np.testing.assert_allclose(power, [1500.0 / torque - 1.0, 1300.0 / torque - 1.0], atol=2e-3)
    lost = ranked.sel(assumption="friction of pins", output="lost")
    assert lost["share"].to_numpy() == pytest.approx([-0.45, 0.45], abs=0.06)
    assert (ranked.sel(assumption="nothing")["change"] == 0.0).all()
    assert ranked["assumption"].to_numpy().tolist() == ["friction of pins", LOAD, "nothing"]
    assert ranked["unit"].to_numpy().tolist() == ["W", "N", "1", "N"]
    assert "friction of pins" in ranked.attrs["summary"]


def test_a_tornado_is_drawn(ranked: xr.Dataset) -> None:
    ax = cd.plot.tornado(ranked, "lost")
    assert [it.get_text() for it in ax.get_yticklabels()][-1] == "friction of pins"
    with pytest.raises(cd.ParameterError, match="there are power, tight, lost, half"):
        cd.plot.tornado(ranked, "noise")
    with pytest.raises(cd.ParameterError, match="nothing to draw"):
        cd.plot.tornado(xr.Dataset())
    plt.close("all")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"ranges": {"chain.mass": 3.0}}, "no pair of a lower and an upper end"),
        ({"ranges": {}}, "no assumption"),
        ({"outputs": "span tension"}, "'span tension' is no output"),
        ({"outputs": "tension"}, r"no output 'tension'.*there are loss_share, span_tension_mean"),
        ({"outputs": "sprocket_power_mean[crank]"}, "no 'crank'.*its labels: driver, driven"),
        ({"outputs": {"all": lambda runs: runs["span_tension_mean"]}}, "a value a variant"),
        ({"phases": (0.5, 0.5)}, "no list of different phases"),
        ({"level": 2.0}, "level = 2.0"),
    ],
)
def test_what_no_tornado_can_be_made_of_is_told(arguments: dict[str, object], words: str) -> None:
    given = {"ranges": {"chain.mass": ("2.6 kg", "2.8 kg")}} | arguments
    with pytest.raises(cd.ParameterError) as told:
        cd.tornado(drive(), until=1e-3, **given)
    assert re.search(words, f"{told.value}; {told.value.hint}")


def test_a_drive_without_a_phase_has_one_replicate_and_no_interval() -> None:
    ring = cd.scenes.spinning_ring()
    ranges = {"chain.mass": ("8 g", "9 g")}
    found = cd.tornado(ring, ranges, "link_tension_max", until=1e-3, level=0.9)
    assert found.attrs["phases"] == [0.0]
    assert found["half_width"].isnull().all()
    assert "nan" not in found.attrs["summary"]


def test_a_variant_that_fails_is_named() -> None:
    stiff = {"chain.stiffness": (160e6, 1e14)}
    with pytest.raises(cd.SimulationError, match="stiffness, high"):
        cd.tornado(drive(), stiff, until=1e-3, run_in=0, method="verlet", step=6e-6)


def test_what_is_stored_is_not_computed_again(tmp_path: Path) -> None:
    ranges = {LOAD: (-1500.0, -1300.0)}
    given = {"until": 2e-3, "run_in": 0, "store": tmp_path}
    first = cd.tornado(drive(), ranges, **given)
    before = {it.name: it.stat().st_mtime_ns for it in tmp_path.iterdir()}
    assert len(before) == 3
    xr.testing.assert_identical(cd.tornado(drive(), ranges, **given), first)
    after = {it.name: it.stat().st_mtime_ns for it in tmp_path.iterdir()}
    assert before == after


MU = "contact.joints.friction.coefficient"


@pytest.fixture(scope="module")
def spread() -> xr.Dataset:
    laws = {MU: ("0.05", 0.15), LOAD: "normal(-1433 N m, 30 N m)"}
    outputs = ["sprocket_power_mean[driver]", "loss_share"]
    return cd.uncertainty(drive(), laws, outputs, samples=16, until=0.015, run_in="5 ms")


@pytest.mark.costs("indices take many variants")
def test_a_spread_is_that_of_its_distributions(spread: xr.Dataset) -> None:
    """σ_P = ω σ_M of the load; what is lost is as even as the friction, of width/√12."""
    assert spread.sizes["variant"] == 16 * (3 + 2)
    power, lost = (spread.isel(output=n) for n in range(2))
    omega = 2.0 * np.pi * 5.0 * 19.0 / 57.0
    assert float(power["deviation"]) == pytest.approx(30.0 * omega, rel=0.2)
    per_mu = float(lost["mean"]) / 0.1
    assert float(lost["deviation"]) == pytest.approx(per_mu * 0.1 / np.sqrt(12.0), rel=0.15)
    assert (spread["lower"] < spread["mean"]).all()
    assert (spread["mean"] < spread["upper"]).all()
    assert spread["sample"].sel(parameter=MU).min() >= 0.05
    assert (spread["numerical"] < 0.1 * spread["deviation"]).all()


@pytest.mark.costs("indices take many variants")
def test_indices_name_whose_spread_it_is(spread: xr.Dataset) -> None:
    total = spread["total_order"]
    assert spread["parameter"].to_numpy().tolist() == [MU, LOAD, "route.phase"]
    assert total.idxmax("parameter").to_numpy().tolist() == [LOAD, MU]
    assert float(total.sel(parameter=MU, output="loss_share")) == pytest.approx(1.0, abs=0.4)
    assert float(total.sel(parameter=LOAD, output="loss_share")) < 0.05
    ax = cd.plot.sobol_indices(spread, "loss_share")
    assert [it.get_text() for it in ax.get_yticklabels()][-1] == MU
    plt.close("all")


def test_finished_parts_of_a_plan_are_kept(tmp_path: Path) -> None:
    given = {"outputs": "contact_force_p99", "samples": 8, "until": 1e-3, "run_in": 0}
    laws = {"route.pretension": "triangular(1 kN, 1.5 kN, 2 kN)"}
    first = cd.uncertainty(drive(), laws, store=tmp_path, **given)
    before = {it.name: it.stat().st_mtime_ns for it in tmp_path.iterdir()}
    xr.testing.assert_identical(cd.uncertainty(drive(), laws, store=tmp_path, **given), first)
    assert {it.name: it.stat().st_mtime_ns for it in tmp_path.iterdir()} == before


@pytest.mark.parametrize(
    ("law", "ends"),
    [
        ((1.0, 3.0), (1.0, 3.0)),
        ("uniform(1 kN, 2 kN)", (1000.0, 2000.0)),
        ("triangular(1, 1, 3)", (1.0, 3.0)),
        ("normal(0, 1)", (-1.0, 1.0)),
        ("lognormal(2, 1.5)", (2.0 / 1.5, 3.0)),
    ],
)
def test_distributions_are_those_of_the_text(law: object, ends: tuple[float, float]) -> None:
    """Their ends; of a normal one the quantiles of one standard deviation (tables)."""
    found = distribution_of(law, "chain.mass")
    at = (0.158655, 0.841345) if "normal" in str(law) else (0.0, 1.0)
    np.testing.assert_allclose(found.ppf(at), ends, rtol=1e-4)


def test_a_deviation_of_temperatures_knows_no_zero() -> None:
    found = distribution_of("normal(40 degC, 5 degC)", "lubricant.temperature")
    assert found.mean() == pytest.approx(313.15)
    assert found.std() == pytest.approx(5.0)


@pytest.mark.parametrize(
    ("law", "words"),
    [
        ("normal(20 kN, 1 mm)", "is in N and in m"),
        ("normal(20 kN, 1 kN)", "is a force, needed is a stiffness"),
        (("20 kN", 3e4), "is a force, needed is a stiffness"),
        ("lognormal(20 MN/m, 1.5 N)", "no distribution"),
    ],
)
def test_a_distribution_is_of_the_unit_of_its_value(law: object, words: str) -> None:
    with pytest.raises(cd.ParameterError, match=words):
        distribution_of(law, "chain.stiffness", drive())
    same = distribution_of("normal(20 MN/m, 1 kN/mm)", "chain.stiffness", drive())
    assert (same.mean(), same.std()) == pytest.approx((20e6, 1e6))


@pytest.mark.parametrize(
    ("laws", "words"),
    [
        ({}, "no distribution"),
        ({"chain.mass": "gauss(1, 2)"}, "no distribution.*normal"),
        ({"chain.mass": (3.0, 2.0)}, "no distribution"),
        ({"chain.mass": "normal(3 kg, -1 g)"}, "no distribution"),
        ({"chain.links": (110, 130)}, "whole number"),
        ({"chain.weight": (1.0, 2.0)}, "weight"),
        ({"route.phase": (0.0, 1.0)}, "no assumption"),
    ],
)
def test_what_cannot_be_drawn_is_told(laws: dict[str, object], words: str) -> None:
    with pytest.raises(cd.ParameterError) as told:
        cd.uncertainty(drive(), laws, until=1e-3, run_in=0)
    assert re.search(words, f"{told.value}; {told.value.hint}")
    with pytest.raises(cd.ParameterError, match="a power of two"):
        cd.uncertainty(drive(), {"chain.mass": (1.0, 2.0)}, samples=100)
