"""Drives that a program moves itself."""

import importlib.util
import pickle
from pathlib import Path

import numpy as np
import pytest

import chaindrive as cd

ROOT = Path(__file__).resolve().parents[2]


def example():
    path = ROOT / "examples" / "speed_controller.py"
    spec = importlib.util.spec_from_file_location("speed_controller", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_a_controller_holds_the_speed():
    """At the end the speed is the one wanted, and the torque balances the loads through the ratio.

    The camshaft turns 60/40 as fast and bears c ω + M: the crank 60/40 times as much.
    """
    controller = example()
    _, speed, torque = controller.controlled(controller.free_drive(), 1.5).T
    assert speed[0] == 0.0
    assert np.abs(torque).max() == controller.LARGEST
    assert speed[-50:].mean() == pytest.approx(controller.WANTED, rel=2e-3)
    ratio = 60.0 / 40.0
    needed = -ratio * (300.0 * ratio * abs(controller.WANTED) + controller.LOAD)
    assert torque[-50:].mean() == pytest.approx(needed, rel=0.05)


def test_channels_are_those_of_a_run():
    drive = cd.scenes.marine_two_sprockets()
    run = cd.simulate(
        drive, until=2e-3, every=1e-3, run_in=0, method="verlet", record="all", error=False
    )
    simulation = cd.Simulation(drive, method="verlet")
    for time in run["time"].to_numpy():
        simulation.advance_to(time)
        for name in run.data_vars:
            read, kept = simulation[name], run[name].sel(time=time)
            np.testing.assert_array_equal(read, kept, name)
            assert read.attrs["units"] == kept.attrs["units"]
    assert simulation["span_tension"].sel(span="crank-camshaft").ndim == 0
    assert "Verlet" in repr(simulation)


def test_a_snapshot_brings_back_every_bit():
    simulation = cd.Simulation(cd.scenes.bicycle())
    simulation.advance_to(3e-4)
    kept = simulation.snapshot()
    simulation.advance_to(6e-4)
    first = simulation["joint_force"]
    simulation.restore(kept)
    assert simulation.time == 3e-4
    simulation.advance_to(6e-4)
    np.testing.assert_array_equal(simulation["joint_force"], first)
    for copy in (cd.Snapshot(bytes(kept)), pickle.loads(pickle.dumps(kept))):
        other = cd.Simulation(cd.scenes.bicycle())
        other.restore(copy)
        other.advance_to(6e-4)
        np.testing.assert_array_equal(other["joint_force"], first)


def test_a_snapshot_of_something_else_is_refused():
    simulation = cd.Simulation(cd.scenes.bicycle())
    with pytest.raises(cd.ParameterError, match="another drive") as caught:
        simulation.restore(cd.Simulation(cd.scenes.bicycle_slack()).snapshot())
    assert caught.value.path == "snapshot"
    data = bytearray(bytes(simulation.snapshot()))
    data[-1] ^= 1
    with pytest.raises(cd.ParameterError, match="the snapshot is damaged"):
        cd.Snapshot(bytes(data))
    with pytest.raises(cd.ParameterError, match="this is no snapshot"):
        cd.Snapshot(b"")


def test_what_cannot_be_set_is_refused():
    simulation = cd.Simulation(cd.scenes.marine_two_sprockets())
    with pytest.raises(cd.ParameterError, match="its motion is given"):
        simulation.set_torque("crank", 1.0)
    with pytest.raises(cd.ParameterError, match="there are crank, camshaft"):
        simulation.set_torque("cranc", 1.0)
    with pytest.raises(cd.ParameterError, match="none in this drive"):
        simulation.set_force("tensioner", 1.0)
    simulation.advance_to(1e-4)
    with pytest.raises(cd.ParameterError, match="is past"):
        simulation.advance_to(5e-5)
    with pytest.raises(cd.ParameterError, match="is past"):
        simulation.set_torque("camshaft", 1.0, at=5e-5)
    with pytest.raises(cd.ParameterError, match="finite"):
        simulation.set_torque("camshaft", float("nan"))
