"""Several chains, shafts and couplings, from Python."""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest
import xarray as xr

import chaindrive as cd

CHANNELS = ["link_tension", "span_tension", "roller_x", "shaft_speed", "sprocket_speed"]
SETTINGS = {"until": 5e-4, "every": 1e-4, "run_in": 0, "method": "verlet", "error": False}


@pytest.fixture(scope="module")
def run() -> xr.Dataset:
    drive = cd.scenes.two_stage_timing()
    return cd.simulate(drive, record=CHANNELS, **SETTINGS)


def test_a_drive_tells_its_chains_and_shafts() -> None:
    drive = cd.scenes.two_stage_timing()
    assert drive.chains == {"primary": 76, "secondary": 84}
    assert drive.links == 160
    assert drive.shafts == ["intermediate shaft"]
    assert cd.scenes.bicycle_crank().couplings == ["spokes and tyre"]
    assert cd.scenes.bicycle().chains == {}


def test_a_run_is_selected_by_chain(run: xr.Dataset) -> None:
    for dim, counts in [("roller", [76, 84]), ("link", [76, 84]), ("span", [2, 2])]:
        chains = run[f"{dim}_chain"]
        assert chains.dims == (dim,)
        assert f"{dim}_chain" in run.coords
        for chain, count in zip(["primary", "secondary"], counts, strict=True):
            assert run.sel({dim: chains == chain}).sizes[dim] == count
    secondary = run["span_tension"].sel(span=run.span_chain == "secondary")
    assert list(secondary["span"].values) == ["pinion-camshaft", "camshaft-pinion"]
    assert "shaft" in run["shaft_speed"].dims
    shaft = run["shaft_speed"].sel(shaft="intermediate shaft")
    for sprocket in ["intermediate", "pinion"]:
        np.testing.assert_array_equal(shaft, run["sprocket_speed"].sel(sprocket=sprocket))


def test_one_chain_needs_no_name() -> None:
    drive = cd.scenes.marine_two_sprockets()
    run = cd.simulate(drive, record="all", **SETTINGS)
    assert not [name for name in run.coords if str(name).endswith("_chain")]
    assert not [name for name in run if str(name).startswith(("shaft", "coupling"))]


def test_a_store_tells_the_chains_too(tmp_path: Path, run: xr.Dataset) -> None:
    pytest.importorskip("zarr")
    drive = cd.scenes.two_stage_timing()
    path = tmp_path / "run.zarr"
    cd.simulate(drive, record=CHANNELS, output=path, **SETTINGS)
    stored = cd.open_result(path)
    assert set(stored.coords) == set(run.coords)
    for name in run.coords:
        np.testing.assert_array_equal(stored[name], run[name])


def test_statics_tell_the_chain_of_a_link() -> None:
    statics = cd.scenes.two_stage_timing().statics()
    primary = statics["link_tension"].sel(link=statics.link_chain == "primary")
    assert primary.sizes["link"] == 76
    assert float(primary.isel(stage=-1).min()) > 0.0


def test_a_simulation_turns_shafts() -> None:
    simulation = cd.Simulation(cd.scenes.bicycle_crank())
    simulation.advance_to(1e-4)
    assert simulation["roller_x"].sizes["roller"] == 104
    simulation.set_torque("crank", -50.0)
    before = float(simulation["shaft_speed"].sel(shaft="crank"))
    simulation.advance_to(1e-3)
    assert float(simulation["shaft_speed"].sel(shaft="crank")) < before - 0.1
    with pytest.raises(cd.ChaindriveError, match="its motion is given"):
        simulation.set_torque("wheel", 1.0)
    with pytest.raises(cd.ChaindriveError, match="there are chainring, cog, crank, hub, wheel"):
        simulation.set_torque("saddle", 1.0)


def test_all_chains_are_drawn(run: xr.Dataset) -> None:
    mpl.use("Agg")
    from matplotlib import pyplot

    ax = cd.plot.layout(cd.scenes.two_stage_timing())
    (plates,) = [it for it in ax.collections if type(it).__name__ == "PolyCollection"]
    assert len(plates.get_paths()) == 76 + 84
    pyplot.close(ax.figure)
    wanted = ["roller_x", "roller_y", "sprocket_angle", "tensioner_position", "link_tension"]
    both = cd.simulate(cd.scenes.two_stage_timing(), record=wanted, **SETTINGS)
    ax = cd.plot.frame(both, 1e-4)
    (plates,) = [it for it in ax.collections if type(it).__name__ == "PolyCollection"]
    assert len(plates.get_array()) == len(plates.get_paths()) == 160
    pyplot.close(ax.figure)
