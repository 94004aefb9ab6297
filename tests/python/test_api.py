"""The public surface: drives from everywhere, changed, described, sent around, drawn."""

import copy
import inspect
import json
import pickle
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest

import chaindrive as cd

TWO_SPROCKETS = {
    "title": "Two sprockets",
    "chain": {
        "pitch": "25.4 mm",
        "links": 78,
        "mass": "68.8 g",
        "stiffness": "161 MN/m",
        "roller_diameter": "15.88 mm",
    },
    "sprockets": [
        {
            "name": "driver",
            "teeth": 19,
            "centre": ["0 mm", "0 mm"],
            "motion": {"kind": "constant", "speed": "300 rpm"},
        },
        {
            "name": "driven",
            "teeth": 19,
            "centre": ["749.3 mm", "0 mm"],
            "inertia": "0.05 kg m^2",
            "load": [{"kind": "constant", "torque": "-40 N m"}],
        },
    ],
}


def test_methods_of_a_run_show_their_parameters():
    run = cd.simulate(cd.scenes.spinning_ring(), until=1e-3, error=False)
    names = {name for name in dir(run.drive) if not name.startswith("_")}
    functions = {name: getattr(cd.analysis, name, None) for name in names}
    functions |= {"report": cd.report, "replay": cd.replay, "frame": cd.plot.frame}
    assert functions.pop("summary") is None
    for name, function in functions.items():
        method = getattr(run.drive, name)
        _, *others = inspect.signature(function).parameters.values()
        assert [*inspect.signature(method).parameters.values()] == others
        # Labels by dimension are the only ones without a name of their own.
        assert {it.name for it in others if it.kind == it.VAR_KEYWORD} <= {"at"}
        assert all(it.kind != it.VAR_POSITIONAL for it in others)
        told = method.__doc__.partition("Parameters\n")[2]
        assert method.__doc__.splitlines()[0] == function.__doc__.splitlines()[0]
        assert "    run\n" not in told
        assert "    run, " not in told
        assert all(it.name in told for it in others)
    assert "DriveAccessor\n   :members:\n" in (
        Path(__file__).parents[2] / "docs" / "api" / "analysis.md"
    ).read_text(encoding="utf-8")


def test_all_names_are_there():
    for name in cd.__all__:
        assert getattr(cd, name) is not None


def test_functions_and_presets_are_the_same():
    assert set(cd.scenes.__all__) == {"presets", *cd.scenes.presets()}
    with pytest.raises(AttributeError, match="no scene `marine_engin`; there are marine_engine,"):
        _ = cd.scenes.marine_engin


@pytest.mark.parametrize("name", cd.scenes.presets())
def test_every_preset_has_a_function(name):
    preset = getattr(cd.scenes, name)
    drive = preset()
    assert name in dir(cd.scenes)
    assert drive.name == name
    assert drive.title
    assert name in repr(drive)
    # Written out as functions, which editors and type checkers know, they are those of the core.
    assert preset.__name__ == name
    summary, description = preset.__doc__.split("\n\n")
    assert summary == f"{drive.title}."
    assert " ".join(description.split()) == f"{cd.scenes.presets()[name]}."
    scene = drive.to_dict()
    chains = scene.get("chains") or [scene["chain"]]
    assert sum(chain["links"] for chain in chains) == drive.links


def test_a_file_reads_as_its_text(tmp_path):
    text = cd.scenes.industrial_16b().text
    file = tmp_path / "drive.toml"
    file.write_text(text, encoding="utf-8")
    assert cd.load(file).text == text
    assert cd.load(str(file)).text == cd.Drive.from_toml(text).text


def test_a_dict_is_a_scene():
    drive = cd.Drive.from_dict(TWO_SPROCKETS)
    assert drive.sprockets == ["driver", "driven"]
    assert drive.to_dict() == TWO_SPROCKETS
    assert drive.replace({"chain.links": 80}).to_dict()["chain"]["links"] == 80


def test_replace_makes_another_drive():
    drive = cd.scenes.marine_engine()
    other = drive.replace({"sprockets.crank.motion.speed": "-80 rpm", "route.pretension": 20e3})
    assert drive.to_dict()["route"]["pretension"] == "15 kN"
    assert other.to_dict()["route"]["pretension"] == 20e3
    assert other.to_dict()["sprockets"][0]["motion"]["speed"] == "-80 rpm"
    assert other != drive
    with pytest.raises(AttributeError):
        drive.links = 3


def test_arrays_stand_for_lists():
    times = np.linspace(0.0, 1.0, 11)
    motion = {"kind": "table", "times": times, "values": np.float32(30.0) * times**2}
    drive = cd.Drive.from_dict(TWO_SPROCKETS).replace({"sprockets.driver.motion": motion})
    assert drive.to_dict()["sprockets"][0]["motion"]["times"] == times.tolist()
    toml = cd.scenes.industrial_16b()
    assert toml.replace({"chain.links": np.int64(toml.links)}).links == toml.links


def test_drives_travel():
    drive = cd.scenes.timing_drive()
    assert pickle.loads(pickle.dumps(drive)) == drive
    assert copy.deepcopy(drive) == drive
    assert hash(copy.copy(drive)) == hash(drive)


COPIES = {"pickle": lambda it: pickle.loads(pickle.dumps(it)), "copy": copy.copy}
COPIES |= {"deepcopy": copy.deepcopy}


@pytest.mark.parametrize("copied", COPIES.values(), ids=COPIES)
def test_laws_and_profiles_travel(copied):
    depths, rates = np.linspace(-1e-6, 3e-5, 50), np.linspace(-0.3, 0.3, 50)
    drive = cd.scenes.timing_drive()
    pin = {"hole": 1.85e-3, "pin": 1.8e-3, "length": 4.5e-3, "modulus": 113.7e9}
    for law in [drive.law("crank"), drive.law("fixed"), cd.law("johnson", **pin, restitution=0.7)]:
        again = copied(law)
        assert again.parameters == law.parameters
        assert np.array_equal(again.force(depths, rates, 0.1), law.force(depths, rates, 0.1))
    laws = {
        "none": {},
        "coulomb": {"coefficient": 0.1},
        "brown-mcphee": {"static_coefficient": 0.15, "coefficient": 0.1, "slip_speed": "1 mm/s"},
        "lugre": {"static_coefficient": 0.15, "coefficient": 0.1, "stiffness": 1e5},
        "spring-slider": {"coefficient": 0.1, "stiffness": 1e6},
    }
    for kind, parameters in laws.items():
        friction = cd.friction(kind, **parameters)
        assert copied(friction).parameters == friction.parameters
        assert np.array_equal(copied(friction).force(1e3, rates), friction.force(1e3, rates))
    points = np.random.default_rng(1).uniform(-0.2, 0.2, (50, 2))
    for name in ("crank", "fixed"):
        profile = drive.profile(name, settled=False)
        again = copied(profile)
        assert (again.name, again.closed, again.length) == (name, profile.closed, profile.length)
        assert np.array_equal(again.distance(points), profile.distance(points))


@pytest.mark.parametrize("copied", COPIES.values(), ids=COPIES)
def test_a_simulation_goes_on_as_its_copy_does(copied):
    drive = cd.scenes.marine_two_sprockets()
    simulation = cd.Simulation(drive, run_in="5 ms", method="verlet", step=2e-5)
    simulation.advance_to(1e-3)
    simulation.set_torque("camshaft", 2e5, at=1.5e-3)
    again = copied(simulation)
    assert repr(again) == repr(simulation)
    again.advance_to(2e-3)
    assert simulation.time == 1e-3
    simulation.advance_to(2e-3)
    for channel in ("span_tension", "roller_x", "sprocket_speed"):
        assert np.array_equal(again[channel], simulation[channel])


def test_description_is_a_dict_and_a_text():
    description = cd.scenes.marine_engine().describe()
    assert description["chain"]["links"] == 122
    assert "crank" in str(description)
    json.dumps(description)
    several = cd.scenes.two_stage_timing().describe()
    assert [chain["links"] for chain in several["chains"]] == [76, 84]
    assert "chain" not in several
    assert "closing" not in several


def test_a_description_says_where_a_run_will_choose_another_step():
    drive = cd.scenes.marine_two_sprockets()
    description = drive.describe()
    assert description["cost"]["unless_chosen_for"] == 0.01
    assert "by default; a run chooses them for an accuracy of 1 %" in str(description)
    asking = drive.replace({"run.accuracy": 0.002}).describe()
    assert "for an accuracy of 0.2 %" in str(asking)
    named = drive.replace({"run.method": "verlet"}).describe()
    assert named["cost"]["unless_chosen_for"] is None
    assert "by default" not in str(named)


def test_schema_is_a_schema():
    assert "chain" in cd.schema()["properties"]


def test_defaults_come_from_the_scene():
    run = cd.simulate(cd.scenes.spinning_ring())
    assert run.attrs["until"] == 0.05
    assert run.sizes["time"] == 501


def test_progress_goes_from_nothing_to_one():
    shares = []
    settings = {"until": 5e-3, "every": 1e-4, "run_in": 0, "error": False}
    cd.simulate(cd.scenes.marine_engine(), **settings, progress=shares.append)
    assert shares == sorted(shares)
    assert shares[-1] == 1.0


def test_an_exception_in_progress_stops_the_run():
    def refuse(share):
        raise LookupError(share)

    with pytest.raises(LookupError):
        cd.simulate(cd.scenes.spinning_ring(), progress=refuse)


def test_other_threads_go_on_during_a_run():
    counted = 0
    done = threading.Event()

    def simulate():
        cd.simulate(cd.scenes.marine_engine(), until=0.05, every=0.05, run_in=0, error=False)
        done.set()

    thread = threading.Thread(target=simulate)
    thread.start()
    while not done.is_set():
        counted += 1
        time.sleep(1e-3)
    thread.join()
    assert counted > 10


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
def test_ctrl_c_stops_a_run():
    code = (
        "import signal\n"
        "import chaindrive as cd\n"
        # A process in the background of a shell is born deaf to it.
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "drive = cd.scenes.marine_engine()\n"
        "print('ready', flush=True)\n"
        "cd.simulate(drive, until=1e5, every=1e-3, record='energy_residual')\n"
    )
    with subprocess.Popen(
        [sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout.readline() == "ready\n"
        time.sleep(1.0)
        process.send_signal(signal.SIGINT)
        try:
            _, complaint = process.communicate(timeout=5.0)
        finally:
            process.kill()
    assert "KeyboardInterrupt" in complaint


def test_plots_draw(tmp_path):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    drive = cd.scenes.marine_engine()
    channels = ["span_tension", "link_tension", "roller_x", "roller_y", "sprocket_angle"]
    channels += ["tensioner_position"]
    run = cd.simulate(drive, until=4e-3, every=1e-3, run_in=0, record=channels, error=False)
    ax = cd.plot.layout(drive)
    assert {text.get_text() for text in ax.texts} >= {"crank", "camshaft", "tensioner", "idler"}
    assert len(cd.plot.tension(run).lines) == 4
    assert "0.002" in cd.plot.frame(run, 0.0021).get_title()
    for number in plt.get_fignums():
        plt.figure(number).savefig(tmp_path / f"{number}.png")
    plt.close("all")


def test_layout_puts_rollers_into_gaps():
    """The outline of a sprocket has gaps where its own angle has them, and rollers sit in these."""
    drive = cd.scenes.marine_engine()
    figure = drive._inner.figure(True, 0.0)
    pose = figure.start()
    (rollers,) = pose["rollers"]
    for body, (x, y, angle) in zip(figure.bodies(1e-5), pose["placements"], strict=True):
        if body["kind"] != "sprocket":
            continue
        away = rollers - (x, y)
        seated = np.abs(np.hypot(*away.T) - body["pitch_radius"]) < 1e-3
        # A gap stands on the y axis of the sprocket.
        turned = np.arctan2(*away[seated].T[::-1]) - np.pi / 2 - angle
        phase = body["teeth"] * turned / (2 * np.pi)
        np.testing.assert_allclose(phase, np.round(phase), atol=0.02)
        assert seated.sum() > 3
