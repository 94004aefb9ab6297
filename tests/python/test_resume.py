"""Runs that are stopped, killed and carried on from Python, and what nobody has to wait for."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
import xarray as xr

import chaindrive as cd

pytest.importorskip("zarr")
posix = pytest.mark.skipif(sys.platform == "win32", reason="signals and pipes")
WALL = ["stepping_time", "real_time_factor", "ns_per_link_step", "wall_time", "numerics"]


def whole(**settings):
    drive = cd.scenes.bicycle()
    given = {"every": 1e-5, "method": "implicit-damping", "error": False, "events": "joints"}
    given["run_in"] = 0
    return cd.simulate(drive, **given | settings)


def timeless(run):
    return {name: value for name, value in run.attrs.items() if name not in WALL}


def stop_at(share):
    def look(done):
        if done > share:
            raise KeyboardInterrupt

    return look


def test_an_interrupted_run_goes_on(tmp_path):
    """What is stored has passed through the store twice; wall times aside, all is the same."""
    store = tmp_path / "run.zarr"
    with pytest.raises(KeyboardInterrupt):
        whole(until=1.0, output=store, progress=stop_at(2e-4))
    reached = xr.open_zarr(store, chunks=None).sizes["time"]
    with pytest.raises(KeyboardInterrupt):
        cd.resume(store, progress=stop_at(4e-4))
    until = float(xr.open_zarr(store, chunks=None)["time"][-1]) + 3e-4
    carried = cd.resume(store, until=until)
    assert carried.sizes["time"] > reached + 30
    straight = whole(until=until, output=tmp_path / "whole.zarr")
    assert carried.identical(straight.assign_attrs(carried.attrs))
    assert timeless(carried) == timeless(straight)


def test_a_complete_run_goes_on_to_a_later_end(tmp_path):
    store = tmp_path / "run.zarr"
    whole(until=2e-4, output=store, checkpoint_every="0.1 ms")
    with pytest.raises(cd.ResumeError, match=r"complete, up to 0\.0002 s") as caught:
        cd.resume(store)
    assert caught.value.path == str(store)
    carried = cd.resume(store, until="0.6 ms")
    straight = whole(until="0.6 ms", output=tmp_path / "whole.zarr")
    assert carried.identical(straight.assign_attrs(carried.attrs))
    with pytest.raises(cd.ParameterError, match="is past") as caught:
        cd.resume(store, until=1e-4)
    assert caught.value.path == "until"


def test_what_cannot_go_on_is_refused(tmp_path):
    with pytest.raises(cd.ResumeError, match="nothing of this name"):
        cd.resume(tmp_path / "run.zarr")
    with pytest.raises(cd.ParameterError, match="give `output`"):
        whole(until=1e-4, checkpoint_every=1e-4)
    with pytest.raises(cd.ParameterError, match="must be positive") as caught:
        whole(until=1e-4, checkpoint_every=0.0, output=tmp_path / "run.zarr")
    assert caught.value.path == "checkpoint_every"
    with pytest.raises(cd.SceneError, match="is a length"):
        whole(until=1e-4, checkpoint_every="1 mm", output=tmp_path / "run.zarr")


KILLED = """
import sys
import chaindrive as cd
cd.simulate(cd.scenes.bicycle(), until=1.0, every=1e-5, method="implicit-damping", error=False,
            run_in=0, events="joints", output=sys.argv[1], checkpoint_every=1e-4)
"""


@posix
def test_a_killed_run_goes_on(tmp_path):
    store = tmp_path / "run.zarr"
    with subprocess.Popen([sys.executable, "-c", KILLED, store]) as writer:
        limit = time.monotonic() + 60
        while not (store.exists() and xr.open_zarr(store, chunks=None).sizes["time"] > 50):
            assert time.monotonic() < limit
            assert writer.poll() is None
            time.sleep(0.02)
        writer.kill()
    killed = xr.open_zarr(store, chunks=None)
    assert killed.attrs["status"] == "running"
    until = float(killed["time"][-1]) + 3e-4
    carried = cd.resume(store, until=until)
    straight = whole(until=until, output=tmp_path / "whole.zarr")
    assert carried.identical(straight.assign_attrs(carried.attrs))
    assert timeless(carried) == timeless(straight)


# Modules are imported when they are first needed, and some of them swallow what interrupts them.
LONG_SETTLING = """
cd.scenes.hanging_chain().NAME()
drive = cd.scenes.bicycle().replace(
    {"chain.links": 4000, "sprockets.rear.centre": ["-25.200144624366 m", "0 m"]})
print("begun", flush=True)
drive.NAME()
"""
READING = """
print("begun", flush=True)
cd.load(sys.argv[1])
"""


@pytest.mark.costs("another interpreter settles for long until it is stopped")
@posix
@pytest.mark.parametrize("what", ["describe", "statics", "modes", "load"])
def test_ctrl_c_is_heard_while_nothing_comes(tmp_path, what):
    pipe = tmp_path / "pipe.toml"
    os.mkfifo(pipe)
    work = READING if what == "load" else LONG_SETTLING.replace("NAME", what)
    program = [sys.executable, "-c", "import sys\nimport chaindrive as cd" + work, str(pipe)]
    with subprocess.Popen(program, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdout.readline() == b"begun\n"
        time.sleep(0.2)
        process.send_signal(signal.SIGINT)
        begin = time.monotonic()
        complaint = process.communicate(timeout=60)[1].decode()
    assert "KeyboardInterrupt" in complaint
    assert time.monotonic() - begin < 20
    assert not Path(pipe).is_file()
