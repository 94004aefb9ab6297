"""Drives that a program moves itself."""

import importlib.util
import pickle
import threading
from pathlib import Path

import numpy as np
import pytest

import chaindrive as cd

ROOT = Path(__file__).resolve().parents[2]


def example(name):
    spec = importlib.util.spec_from_file_location(name, ROOT / "examples" / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_a_controller_holds_the_speed():
    """At the end the speed is the one wanted, and the torque balances the loads through the ratio.

    The camshaft turns 60/40 as fast and bears c ω + M: the crank 60/40 times as much.
    """
    controller = example("speed_controller")
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


def test_names_of_digits_are_names():
    scene = cd.scenes.marine_two_sprockets()
    text = scene.text.replace('"crank"', '"2"').replace('"camshaft"', '"1"')
    simulation = cd.Simulation(cd.Drive.from_toml(text), method="verlet")
    assert list(simulation["sprocket_angle"]["sprocket"].to_numpy()) == ["2", "1"]
    assert simulation["link_tension"]["link"].dtype.kind == "i"


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


def test_a_view_is_filled_wherever_the_drive_has_moved():
    """The same arrays all along, equal to what the simulation says of a channel to the bit."""
    for drive in (cd.scenes.marine_engine(), cd.scenes.bicycle()):
        simulation = cd.Simulation(drive)
        names = ["span_tension", "sprocket_speed", "sprocket_torque", "link_tension"]
        lean = simulation.view(names)
        full = simulation.view([*names, "contacts", "energy_residual", "contact_force"])
        kept = [lean[name] for name in names]
        assert list(lean) == names
        assert lean["link_tension"].size == len(lean.labels["link_tension"])
        start = simulation.snapshot()
        first = {name: lean[name].copy() for name in names}
        for k in range(1, 40):
            if k % 3:
                simulation.advance(k % 5)
            else:
                simulation.advance_to(simulation.time + 1.7e-5)
            for view in (lean, full):
                for name in view:
                    expected = np.atleast_1d(simulation[name].to_numpy())
                    np.testing.assert_array_equal(view[name], expected, name)
        assert all(lean[name] is array for name, array in zip(names, kept, strict=True))
        assert any((lean[name] != first[name]).any() for name in names)
        simulation.restore(start)
        for name in names:
            np.testing.assert_array_equal(lean[name], first[name])
        with pytest.raises(cd.ParameterError, match="spam_tension"):
            simulation.view("spam_tension")


def test_steps_are_those_of_the_method():
    simulation = cd.Simulation(cd.scenes.industrial_16b(), method="verlet", step=4e-6)
    begin = simulation.time
    simulation.advance(25)
    assert simulation.time == pytest.approx(begin + 25 * 4e-6, rel=1e-9)
    simulation.advance(0)
    simulation.set_speed("driver", 120.0, at=simulation.time + 1e-6)
    simulation.advance()
    assert simulation.time == pytest.approx(begin + 101e-6, rel=1e-9)


def test_many_move_as_each_by_itself():
    drive = cd.scenes.marine_two_sprockets()
    one = cd.Simulation(drive)
    many = [cd.Simulation(drive) for _ in range(5)]
    views = [simulation.view("link_tension") for simulation in many]
    for simulation in many[1:]:
        simulation.set_torque("camshaft", 1e3)
    one.set_torque("camshaft", 1e3)
    one.advance_to(2e-3)
    cd.step_many(many, 2e-3)
    for view in views[1:]:
        np.testing.assert_array_equal(view["link_tension"], one["link_tension"])
    assert (views[0]["link_tension"] != views[1]["link_tension"]).any()
    with pytest.raises(cd.SimulationError, match="twice"):
        cd.step_many([one, one], 3e-3)
    with pytest.raises(cd.ParameterError, match="is past"):
        cd.step_many([one, *many], 1e-3)


def test_a_second_thread_is_refused():
    simulation = cd.Simulation(cd.scenes.marine_engine())
    worker = threading.Thread(target=simulation.advance_to, args=(0.5,))
    worker.start()
    refused = []
    while worker.is_alive() and not refused:
        try:
            simulation.advance()
        except cd.SimulationError as error:
            refused.append(error)
    worker.join()
    assert "another thread" in str(refused[0])
    assert "own" in refused[0].hint


def test_speeds_angles_and_parameters_are_set():
    drive = cd.scenes.marine_engine().replace({"tunable": ["tensioners.tightener.push.preload"]})
    simulation = cd.Simulation(drive)
    view = simulation.view(["sprocket_speed", "sprocket_angle", "tensioner_position"])
    crank = view.labels["sprocket_speed"].index("crank")
    before = view["sprocket_speed"][crank]
    simulation.set_speed("crank", 1.1 * before, over=1e-3, rate=5.0)
    simulation.advance_to(3e-3)
    assert view["sprocket_speed"][crank] == pytest.approx(1.1 * before + 5.0 * 2e-3, rel=1e-9)
    angle = view["sprocket_angle"][crank] + before * 1e-3
    simulation.set_angle("crank", angle, over=1e-3, speed=before)
    simulation.advance_to(4e-3)
    assert view["sprocket_angle"][crank] == pytest.approx(angle, rel=1e-12)
    place = float(view["tensioner_position"][0])
    still = cd.Simulation(drive)
    still.restore(simulation.snapshot())
    simulation.tune("tensioners.tightener.push.preload", 40e3)
    for it in (simulation, still):
        it.advance_to(8e-3)
    assert view["tensioner_position"][0] > still["tensioner_position"].item() + 1e-5, place
    with pytest.raises(cd.ParameterError, match="an angle takes time"):
        simulation.set_angle("crank", 0.0, over=0.0)
    with pytest.raises(cd.ParameterError, match="there are"):
        simulation.tune("tensioners.tightener.push.damping", 1.0)


def test_a_rider_turns_the_cranks():
    """Torque over pitch radius is the pull of the chain, but for what speeds the cranks up."""
    rider = example("rider")
    time, torque, speed, pull = rider.ride(rider.ridden(), 0.05).T
    radius = 12.7e-3 / (2.0 * np.sin(np.pi / 44))
    gained = 0.1 * (speed[-1] - speed[10]) / (time[-1] - time[10])
    expected = (gained - torque[10:].mean()) / radius
    assert pull[10:].mean() == pytest.approx(expected, rel=0.05)
    assert np.ptp(torque) > 0.2 * abs(rider.MEAN)
