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
    return cd.tornado(drive(), ranges, outputs, until=0.05)


def test_a_tornado_is_the_mean_of_differences_phase_by_phase(ranked: xr.Dataset) -> None:
    """Against a sweep of its own; Student's t of two degrees of freedom is 4.303 (tables)."""
    phases = {"route.phase": [0.0, 0.34, 0.67]}
    base, low = (
        cd.sweep(it, phases, until=0.05, method="auto")["span_tension_std"].sel(
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
