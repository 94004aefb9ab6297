"""Results on disk as Python opens them: while they grow, after they were stopped or killed."""

import signal
import subprocess
import sys
import time
import warnings

import pandas as pd
import pytest
import xarray as xr

import chaindrive as cd

pytest.importorskip("zarr")

LONG = """
import sys
import chaindrive as cd
cd.simulate(cd.scenes.bicycle_slack(), until=100.0, every=1e-4, run_in=0, error=False,
            output=sys.argv[1], method="implicit-damping",
            record=["span_tension", "joint_force", "sprocket_speed"])
"""
posix = pytest.mark.skipif(sys.platform == "win32", reason="signals")


class Growing:
    """A store with samples, and the process that writes it."""

    def __init__(self, store):
        self.store = store
        command = [sys.executable, "-c", LONG, store]
        self.writer = subprocess.Popen(command, stderr=subprocess.DEVNULL)
        limit = time.monotonic() + 60
        while not (store.exists() and xr.open_zarr(store, chunks=None).sizes["time"]):
            assert time.monotonic() < limit, "no sample was committed"
            time.sleep(0.05)

    def end(self):
        self.writer.kill()
        self.writer.wait()


@pytest.mark.costs("another interpreter writes until it is stopped")
@posix
@pytest.mark.parametrize("name", ["SIGTERM", "SIGHUP"])
def test_a_signal_takes_effect_when_the_result_says_so(tmp_path, name):
    number = signal.Signals[name]
    if signal.getsignal(number) is signal.SIG_IGN:
        pytest.skip(f"{name} is ignored here, as under nohup, and by what is started here")
    made = Growing(tmp_path / "long.zarr")
    made.writer.send_signal(number)
    made.writer.wait(60)
    assert made.writer.returncode == -number
    with pytest.warns(cd.ResultWarning, match="interrupted; it holds"):
        assert cd.open_result(made.store).attrs["status"] == "interrupted"


@posix
def test_the_command_hears_signals_too(tmp_path):
    store = tmp_path / "ring.zarr"
    command = [sys.executable, "-m", "chaindrive", "run", "spinning_ring", "--until", "1e4"]
    with subprocess.Popen([*command, "-o", store], stderr=subprocess.PIPE) as writer:
        while not store.exists():
            assert writer.poll() is None
            time.sleep(0.02)
        writer.send_signal(signal.SIGTERM)
        assert writer.wait(60) == 130
    assert xr.open_zarr(store, chunks=None).attrs["status"] == "interrupted"


def test_a_result_that_is_not_there_is_told_by_name(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"none\.zarr: there is no result here; check"):
        cd.open_result(tmp_path / "none.zarr")


@pytest.mark.parametrize("name", ["run.nc", "run", "run.csv"])
def test_the_name_of_an_output_says_what_it_is(tmp_path, name):
    with pytest.raises(cd.WriteError, match=r"must end in \.zarr") as caught:
        cd.simulate(cd.scenes.spinning_ring(), until=1e-3, output=tmp_path / name, error=False)
    assert ".zarr" in caught.value.hint
    assert not list(tmp_path.iterdir())


def test_tables_are_read_with_their_units(tmp_path):
    command = [sys.executable, "-m", "chaindrive", "run", "marine_two_sprockets", "--until", "2 ms"]
    options = ["--every", "1 ms", "--events", "teeth", "-q", "--no-error", "-o", "drive.csv"]
    subprocess.run([*command, *options], cwd=tmp_path, check=True)
    table = pd.read_csv(tmp_path / "drive.csv", index_col="time [s]")
    assert table["span_tension[crank-camshaft] [N]"].dtype == float
    contacts = pd.read_csv(tmp_path / "drive.events.csv")
    assert set(contacts["event_kind"]) == {"tooth"}
    assert (contacts["event_end [s]"] > contacts["event_start [s]"]).all()


def test_units_of_tensioners_are_those_of_their_carriers():
    names = ["tensioner_position", "tensioner_force"]
    for drive, units in [
        (cd.scenes.marine_engine(), ["m", "N"]),
        (cd.scenes.timing_drive(), ["rad", "N"]),
    ]:
        run = cd.simulate(
            drive, until=1e-4, every=1e-4, run_in=0, record=names, error=False, method="verlet"
        )
        assert [run[name].attrs["units"] for name in names] == units


# These come last: the writer ends with them.


@pytest.fixture(scope="module")
def growing(tmp_path_factory):
    """For those who only look at it."""
    made = Growing(tmp_path_factory.mktemp("growing") / "long.zarr")
    yield made
    made.end()


@pytest.fixture(scope="module")
def killed(tmp_path_factory):
    made = Growing(tmp_path_factory.mktemp("killed") / "long.zarr")
    made.end()
    return made.store


@pytest.mark.costs("another interpreter writes until it is stopped")
def test_chunks_agree_while_a_store_grows_and_when_it_is_stopped(killed, growing, tmp_path):
    assert xr.open_zarr(growing.store).chunks["time"]
    assert xr.open_zarr(killed).chunks["time"]
    # More samples than fit in a chunk of the widest array.
    stopped = tmp_path / "ring.zarr"
    cd.simulate(
        cd.scenes.spinning_ring(), until=0.08, every=1e-5, output=stopped, record="all", error=False
    )
    assert len(xr.open_zarr(stopped).chunks["time"]) == 2


def test_a_result_is_running_or_was_killed(growing, killed):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert cd.open_result(growing.store).attrs["status"] == "running"
    with pytest.warns(cd.ResultWarning, match=r"long\.zarr: killed; it holds \d+ samples"):
        left = cd.open_result(killed)
    assert left.attrs["status"] == "killed"
    assert left.sizes["time"] == left.attrs["samples"] > 0
    assert bool(left["span_tension"].notnull().any())


@pytest.mark.costs("another interpreter writes until it is stopped")
def test_a_writer_keeps_others_out(growing):
    who = f"process {growing.writer.pid} is writing"
    with pytest.raises(cd.WriteError, match=who) as caught:
        cd.simulate(cd.scenes.spinning_ring(), until=1e-3, output=growing.store, overwrite=True)
    assert "another name" in caught.value.hint
