"""Sweeps in an object store: the bits of a sweep in memory, whoever computes or dies."""

import contextlib
import multiprocessing
import os
import pickle
import signal
import socket
import subprocess
import sys
import textwrap
import time
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np
import pytest

import chaindrive as cd

pytest.importorskip("zarr")
stores = pytest.importorskip("obstore.store")
moto = pytest.importorskip("moto.server")

from clusters import cluster  # noqa: E402
from test_sweep_store import RING, assert_same, children, local_executors, ring  # noqa: E402

# A task a variant: the server answers one request after the other.
SPEEDS = {"chain.start.speed": np.linspace(300.0, 400.0, 4), "chain.mass": ["8 g", "9 g"]}
ACCOUNT = {"access_key_id": "nobody", "secret_access_key": "nothing", "region": "us-east-1"}


@pytest.fixture(scope="module")
def server():
    """The address of an object store that speaks like S3, with a bucket in it."""
    import boto3

    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    server = moto.ThreadedMotoServer(ip_address="127.0.0.1", port=port, verbose=False)
    server.start()
    address = f"http://127.0.0.1:{port}"
    known = {"aws_access_key_id": "nobody", "aws_secret_access_key": "nothing"}
    client = boto3.client("s3", endpoint_url=address, region_name="us-east-1", **known)
    client.create_bucket(Bucket="sweeps")
    yield address
    server.stop()


def bucket(server, prefix, name="sweeps"):
    options = {"allow_http": True}
    return stores.S3Store(name, prefix=prefix, endpoint=server, client_options=options, **ACCOUNT)


@pytest.fixture(scope="module")
def in_memory():
    return cd.sweep(ring(), SPEEDS, **RING)


@pytest.mark.slow
def test_every_executor_stores_the_bits_of_the_sweep_in_memory(server, in_memory):
    for number, (name, executor) in enumerate(local_executors()):
        store = bucket(server, f"{number}.zarr")
        result = cd.sweep(ring(), SPEEDS, **RING, output=store, executor=executor)
        assert_same(result, in_memory)
        assert result.attrs["status"] == "complete", name
        assert result.attrs["finished"] == 8, name
        again = cd.open_result(store)
        assert_same(again, in_memory)
        assert again.attrs["status"] == "complete"


@pytest.mark.costs("imports and starts the server, which is a Python program")
def test_an_address_is_enough(server, in_memory, monkeypatch):
    monkeypatch.setenv("AWS_ENDPOINT_URL", server)
    monkeypatch.setenv("AWS_ALLOW_HTTP", "true")
    for name, value in ACCOUNT.items():
        monkeypatch.setenv(f"AWS_{name.upper()}", value)
    address = "s3://sweeps/by/address.zarr"
    assert_same(cd.sweep(ring(), SPEEDS, **RING, output=address), in_memory)
    assert_same(cd.open_result(address), in_memory)
    # The same call finds nothing to do; another sweep is refused, and replaces it when asked to.
    assert_same(cd.sweep(ring(), SPEEDS, **RING, output=address), in_memory)
    with pytest.raises(cd.WriteError, match="another sweep here"):
        cd.sweep(ring(), {"chain.mass": ["8 g", "9 g"]}, **RING, output=address)
    fewer = {"chain.mass": ["8 g", "9 g"]}
    replaced = cd.sweep(ring(), fewer, **RING, output=address, overwrite=True)
    assert_same(replaced, cd.sweep(ring(), fewer, **RING))


@pytest.mark.slow
def test_a_cluster_writes_into_a_bucket(server, in_memory, tmp_path):
    with cluster(tmp_path) as executor:
        store = bucket(server, "dask.zarr")
        result = cd.sweep(ring(), SPEEDS, **RING, output=store, executor=executor)
    assert_same(result, in_memory)


SCRIPT = """
import sys
import numpy as np
import chaindrive as cd
from obstore.store import S3Store

server, prefix, how = sys.argv[1:]
store = S3Store("sweeps", prefix=prefix, endpoint=server, client_options={"allow_http": True},
                access_key_id="nobody", secret_access_key="nothing", region="us-east-1")
settings = {"until": 0.1, "every": 1e-3, "record": "link_tension", "output": store}
design = {"chain.start.speed": np.linspace(300.0, 400.0, 6)}
if __name__ == "__main__":
    if how == "threads":
        cd.sweep(cd.scenes.spinning_ring(), design=design, **settings)
    else:
        import multiprocessing
        from concurrent.futures import ProcessPoolExecutor

        context = multiprocessing.get_context(how)
        with ProcessPoolExecutor(2, mp_context=context) as executor:
            cd.sweep(cd.scenes.spinning_ring(), design=design, **settings, executor=executor)
"""


def chunks(store):
    """Names of the chunks of the array that tasks write last.

    The server answers one request after the other, some milliseconds each: those of a test are
    what the sweep waits for.
    """
    return {entry["path"] for entries in store.list("error/c/") for entry in entries}


@pytest.mark.slow
@pytest.mark.parametrize(("how", "kills"), [("threads", 1), ("spawn", 3)])
def test_killed_and_resumed_no_variant_is_lost_twice_or_different(server, tmp_path, how, kills):
    """Resumed in this process: to start one and import what it needs takes seconds."""
    script = tmp_path / "script.py"
    script.write_text(textwrap.dedent(SCRIPT))
    prefix = f"killed-{how}.zarr"
    store, begun = bucket(server, prefix), {}
    killed = 0
    for _ in range(kills):
        arguments = [sys.executable, str(script), server, prefix, how]
        before = len(chunks(store))
        with subprocess.Popen(arguments) as process:
            while process.poll() is None and len(chunks(store)) < before + 1:
                time.sleep(0.03)
            # Workers outlive a coordinator that was killed, and wait for it.
            orphans = children(process.pid)
            killed += process.poll() is None
            process.kill()
            for orphan in orphans:
                with contextlib.suppress(ProcessLookupError):
                    os.kill(orphan, signal.SIGKILL)
        for path in chunks(store):
            contents = bytes(store.get(path).bytes())
            assert begun.setdefault(path, contents) == contents, "stored twice"
    assert killed >= 1
    design = {"chain.start.speed": np.linspace(300.0, 400.0, 6)}
    run = {"until": 0.1, "every": 1e-3, "record": "link_tension"}
    resumed = cd.sweep(ring(), design=design, **run, output=store)
    for path, contents in begun.items():
        assert bytes(store.get(path).bytes()) == contents, "stored twice"
    assert_same(resumed, cd.sweep(ring(), design=design, **run))


def test_ctrl_c_leaves_a_store_that_says_so(server, in_memory):
    """Requests to the store go on meanwhile, and none of them takes Ctrl-C for its own error."""
    store = bucket(server, "interrupted.zarr")

    def interrupt(share):
        if share > 0.2:
            os.kill(os.getpid(), signal.SIGINT)

    with pytest.raises(KeyboardInterrupt) as caught:
        cd.sweep(ring(), SPEEDS, **RING, output=store, progress=interrupt)
    assert "the same call goes on" in caught.value.__notes__[0]
    with pytest.warns(cd.ResultWarning, match="interrupted"):
        assert 1 <= cd.open_result(store).attrs["finished"] < 8
    begun = {path: bytes(store.get(path).bytes()) for path in chunks(store)}
    assert_same(cd.sweep(ring(), SPEEDS, **RING, output=store), in_memory)
    for path, contents in begun.items():
        assert bytes(store.get(path).bytes()) == contents, "stored twice"


@pytest.mark.costs("a process that imports all that it needs, and its forks")
def test_workers_that_were_forked_are_told_of(server, tmp_path):
    """They would wait for ever: threads that speak to the store are not inherited."""
    script = tmp_path / "script.py"
    script.write_text(textwrap.dedent(SCRIPT))
    arguments = [sys.executable, str(script), server, "forked.zarr", "fork"]
    done = subprocess.run(arguments, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 1
    last = done.stderr.strip().splitlines()[-1]
    assert "SimulationError" in last
    assert "get_context('spawn')" in last


def test_what_cannot_hold_a_sweep_is_refused_with_a_reason(server, tmp_path):
    with pytest.raises(cd.WriteError, match="NoSuchBucket") as caught:
        cd.sweep(ring(), SPEEDS, **RING, output=bucket(server, "x.zarr", name="nowhere"))
    assert "Debug source" not in str(caught.value)
    with pytest.raises(cd.ParameterError, match=r"must end in \.zarr"):
        cd.sweep(ring(), SPEEDS, **RING, output="s3://sweeps/x")
    with pytest.raises(cd.WriteError, match="an address and no folder"):
        cd.sweep(ring(), SPEEDS, **RING, output=Path("s3://sweeps/x.zarr"))
    with pytest.raises(cd.ParameterError, match="which has a path"):
        cd.sweep(ring(), SPEEDS, **RING, output=(tmp_path / "x.zarr").as_uri())
    with pytest.raises(cd.ParameterError, match="gopher"):
        cd.sweep(ring(), SPEEDS, **RING, output="gopher://sweeps/x.zarr")
    with pytest.raises(cd.ParameterError, match="which has a path"):
        cd.sweep(ring(), SPEEDS, **RING, output=stores.LocalStore(tmp_path))
    with pytest.raises(TypeError, match="needed is a path, an address"):
        cd.sweep(ring(), SPEEDS, **RING, output=12)
    with pytest.raises(FileNotFoundError, match="there is no result here"):
        cd.open_result(bucket(server, "nothing.zarr"))
    # A run goes onto a disk: nobody wants a folder of the name `s3:`.
    with pytest.raises(cd.WriteError, match="an address and no folder"):
        cd.simulate(ring(), until=1e-3, output="s3://sweeps/run.zarr")


def test_what_others_have_put_there_stays(server):
    store = bucket(server, "thesis")
    store.put("thesis.tex", b"years of work")
    for overwrite in (False, True):
        with pytest.raises(cd.WriteError, match="not a result of chaindrive"):
            cd.sweep(ring(), SPEEDS, **RING, output=store, overwrite=overwrite)
    assert bytes(store.get("thesis.tex").bytes()) == b"years of work"


def test_a_store_of_this_process_alone_is_for_its_threads(in_memory):
    """What is in memory cannot be sent to other processes, and says so."""
    store = stores.MemoryStore()
    with pytest.raises(TypeError):
        pickle.dumps(store)
    fresh = multiprocessing.get_context("spawn")
    with (
        ProcessPoolExecutor(1, mp_context=fresh) as executor,
        pytest.raises(cd.SimulationError, match="MemoryStore"),
    ):
        cd.sweep(ring(), SPEEDS, **RING, output=store, executor=executor)
    assert_same(cd.sweep(ring(), SPEEDS, **RING, output=store, jobs=2), in_memory)
