"""Datasets: dimensions, units, labels, provenance, and numbers that are known."""

import logging
import math
import signal
import subprocess
import sys
import time
import warnings

import numpy as np
import pytest
import xarray as xr
from drives import BARE

import chaindrive as cd

# The ring of the scene, in SI units.
LINKS, PITCH, MASS, STIFFNESS, SPEED = 20, 12.7e-3, 8.89e-3, 100e3, 400.0


@pytest.fixture(scope="module")
def marine():
    return cd.simulate(cd.scenes.marine_engine(), until=5e-3, every=1e-3, run_in=0, record="all")


def test_ring_is_stretched_by_its_rotation():
    """T = k (l − p) with l = k p / (k − m ω² / (4 sin²(π/N)))."""
    length = (
        STIFFNESS * PITCH / (STIFFNESS - MASS * SPEED**2 / (4.0 * math.sin(math.pi / LINKS) ** 2))
    )
    expected = STIFFNESS * (length - PITCH)
    run = cd.simulate(
        cd.scenes.spinning_ring(), record="link_tension", every=1e-3, method="rk4", step=1e-6
    )
    np.testing.assert_allclose(run["link_tension"], expected, rtol=1e-9)


@pytest.mark.parametrize("method", ["verlet", "rk4", "dormand-prince"])
def test_every_method_keeps_the_ring_turning(method):
    channels = ["roller_x", "roller_y", "energy_residual"]
    run = cd.simulate(
        cd.scenes.spinning_ring(), until=5e-3, every=1e-3, record=channels, method=method
    )
    radius = np.hypot(run["roller_x"], run["roller_y"])
    np.testing.assert_allclose(radius, float(radius[0, 0]), rtol=1e-3)
    assert run.attrs["method"] == method


def test_every_channel_is_recorded_with_its_dimensions_and_unit(marine):
    of_joints_and_strands = ("joint_", "bush_", "link_angle", "strand_")
    absent = {name for name in cd.channels() if name.startswith(of_joints_and_strands)}
    # Shafts have channels of their own where they have names, and couplings join them.
    absent |= {"shaft_angle", "shaft_speed", "coupling_torque"}
    # Its seats are dry.
    absent |= {"film_thickness"}
    for name in set(cd.channels()) - absent:
        channel = cd.channels()[name]
        assert marine[name].dims == channel.dims
        assert marine[name].attrs["units"] in channel.unit.split(" or ")
        assert marine[name].attrs["long_name"] == channel.description
        assert marine[name].dtype == np.float64
    assert set(marine.data_vars) == set(cd.channels()) - absent


def test_a_dataset_is_the_one_that_xarray_makes(marine):
    data = {name: (it.dims, it.to_numpy(), it.attrs) for name, it in marine.data_vars.items()}
    coords = {name: (it.dims, it.to_numpy(), it.attrs) for name, it in marine.coords.items()}
    made = xr.Dataset(data, coords, marine.attrs)
    xr.testing.assert_identical(marine, made)
    assert {name: index.dtype for name, index in marine.indexes.items()} == {
        name: index.dtype for name, index in made.indexes.items()
    }


def test_coordinates_carry_names(marine):
    assert list(marine["sprocket"].to_numpy()) == ["crank", "camshaft", "tensioner", "idler"]
    assert marine["span"].to_numpy()[0] == "crank-camshaft"
    assert list(marine["link"].to_numpy()) == list(range(122))
    assert marine["time"].attrs == {"units": "s", "long_name": "time"}
    np.testing.assert_array_equal(marine["time"], np.arange(6) * 1e-3)
    assert float(marine["span_tension"].sel(span="idler-crank", time=0.0)) > 0.0


def test_arrays_are_contiguous_and_writable(marine):
    tension = marine["link_tension"].to_numpy()
    assert tension.flags.c_contiguous
    assert tension.flags.writeable


def test_default_channels_are_those_of_the_scene():
    run = cd.simulate(cd.scenes.marine_engine(), until=1e-3, every=1e-3, run_in=0, error=False)
    defaults = cd.scenes.marine_engine().run_defaults["record"]
    assert list(run.data_vars) == defaults
    assert "span_tension" in run


def test_provenance_reproduces_the_run():
    drive = cd.scenes.marine_engine().replace({"sprockets.crank.motion.speed": "-100 rpm"})
    run = cd.simulate(drive, until=2e-3, every=1e-3, run_in=0, record="link_tension", error=False)
    story = run.attrs
    assert story["chaindrive_version"] == cd.__version__
    assert story["chaindrive_build"] == cd.__build__
    assert story["chaindrive_profile"] in ("quick", "release")
    assert story["instruction_set"] in ("sse2", "avx2", "avx512", "neon", "baseline")
    assert story["title"] == drive.title
    assert story["steps"] > 0
    assert story["step"] > 0.0
    for name in ("real_time_factor", "ns_per_link_step", "wall_time", "stepping_time"):
        assert story[name] > 0.0
    assert math.isfinite(story["energy_supplied"])
    assert "span tension" in story["summary"]
    again = cd.simulate(
        cd.Drive.from_toml(story["scene"]),
        until=story["until"],
        every=story["every"],
        run_in=0,
        record="link_tension",
        error=False,
        method=story["method"],
        step=story["step"],
    )
    xr.testing.assert_identical(again["link_tension"], run["link_tension"])


def test_energy_is_accounted_for(marine):
    residual = np.abs(marine["energy_residual"]).max()
    assert float(residual) < 1e-3 * float(marine["energy_kinetic"][0])


def test_statics_of_the_marine_engine():
    drive = cd.scenes.marine_engine()
    statics = drive.statics()
    assert list(statics["stage"].to_numpy()) == ["pretension", "gravity", "load"]
    assert statics["link_tension"].sizes == {"stage": 3, "link": 122}
    assert statics["link_tension"].attrs["units"] == "N"
    # Spans are means of link tensions.
    last = statics.sel(stage="load")
    assert last["span_tension"].min() >= last["link_tension"].min()
    assert last["span_tension"].max() <= last["link_tension"].max()
    run = cd.simulate(drive, until=1e-4, every=1e-4, run_in=0, record="span_tension")
    np.testing.assert_allclose(run["span_tension"][0], last["span_tension"], rtol=1e-2)
    assert statics["contacts"].sel(stage="load").min() > 0


def test_modes_of_a_hanging_chain():
    """Two degrees of freedom a free roller, all stable, shapes of unit modal mass φᵀ M φ = 1."""
    drive = cd.scenes.hanging_chain()
    modes = drive.modes()
    frequency = modes["frequency"].to_numpy()
    assert frequency.size == 2 * (drive.links - 1)
    assert (frequency > 0.0).all()
    assert (np.diff(frequency) >= 0.0).all()
    np.testing.assert_array_equal(drive.natural_frequencies(), frequency)
    moving = (modes["roller_x"] ** 2 + modes["roller_y"] ** 2).sum("roller")
    np.testing.assert_allclose(8.89e-3 * moving, 1.0, rtol=1e-9)
    assert float(abs(modes["roller_x"].isel(roller=0)).max()) == 0.0
    assert modes["frequency"].attrs["units"] == "Hz"


def test_a_drive_that_is_not_at_rest_has_no_modes():
    with pytest.raises(cd.AssemblyError):
        cd.scenes.spinning_ring().modes()


def test_chains_of_rigid_links_have_modes():
    """Defect A9: their state was read as that of particles; one link made the program panic."""
    frequency = cd.scenes.bicycle().natural_frequencies()
    assert frequency.size == 3 * 104 + 1
    assert (frequency > 0.0).all()
    with pytest.raises(cd.AssemblyError, match="let the drive settle"):
        cd.scenes.pin_in_bush().modes()


def test_a_drive_that_does_not_settle_has_no_statics():
    assert cd.scenes.spinning_ring().statics().sizes["stage"] == 0


def test_results_can_be_written_as_netcdf_attributes(marine):
    for value in marine.attrs.values():
        assert isinstance(value, str | int | float | list)


def test_zarr_holds_what_memory_holds(tmp_path):
    pytest.importorskip("zarr")
    drive = cd.scenes.marine_engine()
    settings = {"until": 2e-3, "every": 1e-3, "run_in": 0}
    settings["record"] = ["span_tension", "roller_x", "contacts"]
    memory = cd.simulate(drive, **settings)
    disk = cd.simulate(drive, **settings, output=tmp_path / "run.zarr")
    xr.testing.assert_equal(disk.load(), memory)
    for name in memory.variables:
        assert disk[name].attrs == memory[name].attrs, name
    costs = {"wall_time", "stepping_time", "real_time_factor", "ns_per_link_step", "numerics"}
    for name in set(memory.attrs) - costs:
        assert disk.attrs[name] == memory.attrs[name], name
    with pytest.raises(cd.WriteError) as caught:
        cd.simulate(drive, **settings, output=tmp_path / "run.zarr")
    assert "overwrite" in caught.value.hint
    cd.simulate(drive, **settings, output=tmp_path / "run.zarr", overwrite=True)


def test_a_run_says_how_exact_it_is() -> None:
    bare = cd.scenes.bicycle_slack().replace(BARE)
    run = cd.simulate(bare, until=12e-3, every=1e-3, run_in=0, record="span_tension")
    story = run.attrs
    assert story["error_estimate"] == "made"
    assert 0 < story["error_tight_span_tension"] < 0.05
    assert story["error_contact_force"] >= story["error_contact_force_p50"]
    assert "numerical error" in story["numerics"]
    # The waveform is good for two milliseconds, twins for seven, and the variable says so.
    assert run["span_tension"].attrs["waveform_horizon"] == story["waveform_horizon"] < 4e-3
    assert story["chaos_horizon"] > story["waveform_horizon"]
    assert run["span_tension"].attrs["waveform_horizon_of"] == "span_tension"


def test_a_result_that_contradicts_itself_is_warned_of(recwarn: pytest.WarningsRecorder) -> None:
    """The verdict itself is tested in Rust: here it becomes a warning."""
    settings = {"every": 1e-5, "run_in": 0, "method": "implicit-damping", "error": False}
    changes = BARE | {"sprockets.chainring.motion.speed": "-5000 rpm"}
    fast = cd.scenes.bicycle().replace(changes)
    with pytest.warns(cd.DistrustedResultWarning, match="does not add up"):
        run = cd.simulate(fast, until=3e-4, **settings)
    assert run.attrs["verdict"] == "distrusted"
    assert "energy-missing" in run.attrs["reasons"].split()
    recwarn.clear()
    settings["method"] = "verlet"
    run = cd.simulate(cd.scenes.marine_two_sprockets(), until=3e-3, **settings)
    assert run.attrs["verdict"] == "caution"
    assert not recwarn.list


def test_a_caution_is_heard_by_whoever_asks() -> None:
    def run() -> None:
        cd.simulate(cd.scenes.spinning_ring(), until=0.02, every=1e-3, error=False)

    with warnings.catch_warnings(record=True) as told:
        run()
        assert not told
        warnings.simplefilter("default", cd.CautiousResultWarning)
        run()
        assert [str(warning.message) for warning in told] == [
            "be careful with this run: the error is not estimated, switched off: "
            "run it without --no-error, to its end"
        ]
        warnings.simplefilter("error", cd.VerdictWarning)
        with pytest.raises(cd.CautiousResultWarning):
            run()
        warnings.simplefilter("ignore", cd.VerdictWarning)
        run()
    assert issubclass(cd.DistrustedResultWarning, cd.VerdictWarning)


def test_the_line_and_functions_are_told_of_the_run_in() -> None:
    class Told:
        def __init__(self) -> None:
            self.shares: list[float] = []

        def __call__(self, share: float) -> None:
            assert 0 < share <= 1

        def run_in(self, share: float) -> None:
            self.shares.append(share)

    drive, told = cd.scenes.marine_two_sprockets(), Told()
    settings = {"method": "verlet", "until": 1e-3, "every": 1e-3, "error": False}
    cd.simulate(drive, run_in=1.0, progress=told, **settings)
    assert told.shares
    assert all(0 <= share <= 1 for share in told.shares)
    plain: list[float] = []
    cd.simulate(drive, run_in=1.0, progress=plain.append, **settings)
    assert plain[0] == 0
    assert plain[-1] == 1

    def refuse(share: float) -> None:
        raise RuntimeError(f"stopped at {share}")

    with pytest.raises(RuntimeError, match="stopped at 0"):
        cd.simulate(drive, run_in=1000.0, progress=refuse, **settings)


def test_bodies_in_each_others_way_are_warned_of_once() -> None:
    face = {"kind": "bar", "start": [0.2, 0.86], "end": [-0.2, 0.86], "end_radius": 0.02}
    rail = {"name": "rail", "touches": "plates", "face": face}
    drive = cd.scenes.marine_two_sprockets().replace({"guides": [rail], "run.run_in": 0})
    with pytest.warns(cd.ClashWarning, match="`rail` cuts into the teeth of `crank`") as told:
        cd.simulate(drive, until=1e-3, error=False)
    assert len(told) == 1


def test_the_error_can_be_left_out() -> None:
    run = cd.simulate(cd.scenes.spinning_ring(), until=2e-3, error=False)
    assert run.attrs["error_estimate"] == "switched off"
    assert "error_span_tension" not in run.attrs
    assert "numerical error" not in run.attrs["numerics"]


def test_the_method_is_chosen_for_an_accuracy() -> None:
    drive = cd.scenes.spinning_ring()
    coarse = cd.simulate(drive, until=0.02, accuracy=0.05).attrs
    fine = cd.simulate(drive, until=0.02, accuracy=1e-5).attrs
    assert coarse["accuracy_kept"] == fine["accuracy_kept"] == "kept"
    assert fine["accuracy_error"] <= 1e-5
    assert fine["evaluations"] > coarse["evaluations"]
    assert fine["error_link_tension"] <= 1e-5
    assert "cheapest" in fine["choice"]
    # What is given is not chosen.
    assert "choice" not in cd.simulate(drive, until=0.02, method="verlet").attrs


def test_an_accuracy_and_a_method_do_not_go_together() -> None:
    drive = cd.scenes.spinning_ring()
    with pytest.raises(cd.ParameterError, match="`step` is given as well") as caught:
        cd.simulate(drive, until=0.02, accuracy=0.01, step=1e-6)
    assert caught.value.path == "accuracy"
    with pytest.raises(cd.ParameterError, match="between 0 and 1"):
        cd.simulate(drive, until=0.02, accuracy=2.0)


WALL = {"wall_time", "stepping_time", "real_time_factor", "ns_per_link_step"}


def timeless(attributes):
    """Attributes without what a clock had a say in."""
    lines = attributes["numerics"].splitlines()
    numerics = "\n".join(line for line in lines if not line.startswith("speed"))
    return {k: v for k, v in attributes.items() if k not in WALL} | {"numerics": numerics}


def same_run(tmp_path, preset, settings):
    """Hold memory against a store, and the store against that of the command."""
    pytest.importorskip("zarr")
    drive = getattr(cd.scenes, preset)()
    settings = {"until": "400 us", "every": "100 us"} | settings
    memory = cd.simulate(drive, **settings)
    disk = cd.simulate(drive, **settings, output=tmp_path / "python.zarr")
    arguments = ["chaindrive", "run", preset, "-q", "-o", str(tmp_path / "command.zarr")]
    for name, value in settings.items():
        text = ",".join(value) if isinstance(value, list) else str(value)
        arguments += [f"--{name.replace('_', '-')}", text]
    assert cd._core._cli(arguments) == 0
    command = xr.open_zarr(tmp_path / "command.zarr", chunks=None)
    for other in (disk, command):
        xr.testing.assert_equal(other.load(), memory)
        assert timeless(other.attrs) == timeless(memory.attrs)
        for name in memory.variables:
            assert other[name].attrs == memory[name].attrs, name


CASES = {
    "default": {},
    "method": {"method": "rk4"},
    "step": {"step": "40 ns"},
    "accuracy": {"accuracy": "5%"},
    "events": {"events": ["teeth", "joints"]},
    "record all": {"record": ["all"]},
}


@pytest.mark.parametrize("case", CASES)
def test_python_and_the_command_do_the_same(tmp_path, case):
    same_run(tmp_path, "spinning_ring", CASES[case])


def test_python_and_the_command_do_the_same_with_joints(tmp_path):
    same_run(tmp_path, "bicycle", CASES["events"] | {"run_in": 0})


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("preset", list(cd.scenes.presets()))
def test_python_and_the_command_do_the_same_with_every_preset(tmp_path, preset, case):
    same_run(tmp_path, preset, CASES[case])


def test_the_log_is_told_what_a_long_run_does():
    """A line within two seconds, at a level that Python shows; a signal then ends the run."""

    class Impatient(logging.Handler):
        def emit(self, record):
            told.append((record.levelname, record.getMessage(), time.perf_counter() - begin))
            signal.raise_signal(signal.SIGINT)

    told, logger, handler = [], logging.getLogger("chaindrive"), Impatient()
    logger.addHandler(handler)
    begin = time.perf_counter()
    try:
        with pytest.raises(KeyboardInterrupt):
            cd.simulate(cd.scenes.spinning_ring(), until=1e3, every=1e-3, method="verlet")
    finally:
        logger.removeHandler(handler)
    [(level, message, after)] = told
    assert level == "WARNING"
    assert "the run is under way" in message
    assert after < 4, "two seconds, on a machine that does other things as well"


# Modes of a long chain are found from all of them at once, which takes a while.
LONG_CHAIN = """
import logging, os, signal
import chaindrive as cd
class Impatient(logging.Handler):
    def emit(self, record):
        print(record.getMessage())
        signal.raise_signal(signal.SIGINT)
logging.getLogger("chaindrive").addHandler(Impatient())
drive = cd.Drive.from_dict({
    "chain": {"type": "16B-1", "links": 1000},
    "sprockets": [
        {"name": "driver", "centre": [0, 0], "teeth": 20,
         "motion": {"kind": "constant", "speed": "300 rpm"}},
        {"name": "driven", "centre": ["12.446 m", 0], "teeth": 20, "inertia": "0.05 kg m^2"},
    ],
    "route": {"pretension": "2 kN"},
})
try:
    drive.modes()
except KeyboardInterrupt:
    print("interrupted", flush=True)
    os._exit(0)
"""


def test_the_log_is_told_that_a_drive_settles() -> None:
    command = [sys.executable, "-c", LONG_CHAIN]
    done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=60)
    assert done.stdout == "the drive is assembled and settled\ninterrupted\n"


def test_a_slack_chain_without_gravity_is_refused_soon() -> None:
    """The chain is 6 mm too long, and nothing says where it hangs: that took half a minute."""
    sprocket = {"teeth": 20, "centre": [0, 0]}
    load = [{"kind": "constant", "torque": "-20 N m"}]
    motion = {"kind": "constant", "speed": "300 rpm"}
    drive = cd.Drive.from_dict(
        {
            "gravity": [0, 0],
            "chain": {"type": "16B-1", "links": 60},
            "sprockets": [
                sprocket | {"name": "driver", "motion": motion},
                sprocket
                | {"name": "driven", "centre": ["505 mm", 0], "inertia": 0.05, "load": load},
            ],
        }
    )
    # Fewer iterations than a search downhill makes before it is given up.
    with pytest.raises(cd.AssemblyError, match=r"after 1?\d{4} iterations.*raise the pretension"):
        drive.describe()


def test_an_interrupted_run_keeps_what_there_is():
    def stop(_: float) -> None:
        raise KeyboardInterrupt

    ring = cd.scenes.spinning_ring()
    with pytest.raises(KeyboardInterrupt) as caught:
        cd.simulate(ring, until=1e3, every=1e-3, method="verlet", progress=stop)
    kept = caught.value.result
    assert kept.attrs["status"] == "interrupted"
    assert kept.attrs["error_estimate"] == "interrupted"
    assert 0 < kept.sizes["time"] < 1e6
    assert kept.sizes["time"] == kept.attrs["samples"]
    assert "stop.result" in caught.value.__notes__[0]


def test_a_run_in_lies_before_the_record():
    drive = cd.scenes.marine_two_sprockets()
    result = cd.simulate(drive, run_in="5 ms", until=2e-3, every=1e-3, error=False)
    assert result["time"].values.tolist() == [0.0, 1e-3, 2e-3]
    assert result.attrs["run_in"] == 5e-3
    moved = cd.Simulation(drive, run_in=5e-3)
    assert moved.time == 0.0
    with pytest.raises(cd.ParameterError, match="there are crank, camshaft"):
        cd.simulate(drive, run_in="1 turn of cam", until=1e-3)
    with pytest.raises(cd.SceneError, match="no number of turns"):
        cd.simulate(drive, run_in="five turns", until=1e-3)
