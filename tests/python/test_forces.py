"""Forces on centres: swept, set while a drive moves, drawn, and told."""

import numpy as np
import pytest

import chaindrive as cd

SPRINGS = {"kind": "springs", "stiffness": ["20 MN/m", "20 MN/m"], "damping": [0, 0]}


def forced(force="300 N"):
    drive = cd.scenes.industrial_16b()
    driven = "sprockets.driven."
    return drive.replace(
        {
            driven + "support": SPRINGS,
            driven + "mass": "4 kg",
            driven + "force_x": [{"kind": "constant", "force": force}],
        }
    )


def test_a_sweep_varies_a_force_and_its_run_has_the_bits():
    drive = forced()
    sweep = cd.sweep(
        drive,
        {"sprockets.driven.force_x[0].force": ["0 N", "300 N"]},
        until=1e-3,
        every=1e-3,
        run_in=0,
        record=["sprocket_x", "centre_force_x", "energy_flows"],
    )
    at = sweep["sprocket_x"].sel(sprocket="driven").isel(time=0).to_numpy()
    assert 0.0 < at[1] - at[0] < 300.0 / 20e6
    force = sweep["centre_force_x"].sel(sprocket="driven").isel(time=-1).to_numpy()
    np.testing.assert_array_equal(force, [0.0, 300.0])
    assert "forces_supplied" in sweep["flow"].to_numpy()


def test_a_force_is_set_and_told(tmp_path):
    drive = forced()
    simulation = cd.Simulation(drive)
    simulation.set_centre_force("driven", (50.0, -20.0))
    simulation.advance_to(1e-4)
    at = {name: simulation[f"centre_force_{name}"].sel(sprocket="driven") for name in "xy"}
    assert (float(at["x"]), float(at["y"])) == (350.0, -20.0)
    with pytest.raises(cd.ParameterError, match="there are driver, driven"):
        simulation.set_centre_force("idler", (1.0, 0.0))
    assert "sprockets.driven: 300 N along x, 0 N along y" in str(drive.describe())
    assert 'id="force-driven"' in drive.svg()
    assert "force-driven" not in cd.scenes.industrial_16b().svg()


def test_a_replay_shows_the_arrow_where_the_force_points(tmp_path):
    """The force turns with the shaft: its arrow points where the components recorded say."""
    order = {"kind": "orders", "terms": [{"order": 1, "amplitude": "5 N"}]}
    drive = forced("1 N").replace({"sprockets.driven.force_y": [order]})
    run = cd.simulate(drive, until=2e-3, every=1e-3, run_in=0)
    components = [run[f"centre_force_{axis}"].sel(sprocket="driven") for axis in "xy"]
    figure = cd.pose.figure_of(run, None)
    index = [body["kind"] for body in figure.bodies(1e-3)].index("force")
    channels = {name: run[name].to_numpy() for name in figure.placing if name in run}
    angle = figure.placements(run["time"].to_numpy(), channels)[:, index, 2]
    np.testing.assert_allclose(angle, np.arctan2(*components[::-1]))
    assert len(set(angle)) == 3
