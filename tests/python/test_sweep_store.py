"""Sweeps in a store: tables and grids, any executor, whatever dies on the way: the same bits."""

import contextlib
import json
import multiprocessing
import os
import pickle
import signal
import subprocess
import sys
import textwrap
import threading
import time
from concurrent.futures import Future, ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from clusters import cluster

import chaindrive as cd

zarr = pytest.importorskip("zarr")

SPEED, PRETENSION = "sprockets.crank.motion.speed", "route.pretension"
MEASURED = ["stepping_time", "real_time_factor"]
RING = {"until": 2e-3, "every": 1e-3, "record": "link_tension"}
SPEEDS = {"chain.start.speed": np.linspace(300.0, 400.0, 40), "chain.mass": ["8 g", "9 g", "10 g"]}


def marine():
    return cd.scenes.marine_two_sprockets().replace({"run.run_in": 0})


def ring():
    return cd.scenes.spinning_ring()


def assert_same(stored, expected):
    """The same names, labels and numbers, to the last bit."""
    stored = stored.load()
    assert set(stored.variables) == set(expected.variables)
    assert set(stored.coords) == set(expected.coords)
    for name in set(expected.variables) - set(MEASURED):
        one, other = stored[name], expected[name]
        assert one.dims == other.dims, name
        assert one.attrs == other.attrs, name
        if other.dtype == np.float64:
            assert one.to_numpy().tobytes() == other.to_numpy().tobytes(), name
        else:
            assert one.to_numpy().tolist() == other.to_numpy().tolist(), name


@pytest.fixture(scope="module")
def in_memory():
    return cd.sweep(ring(), SPEEDS, **RING)


def test_a_row_of_a_table_is_the_variant_of_its_values():
    """Columns as a dict, a structured array, a data frame, and a sample with its names."""
    pandas = pytest.importorskip("pandas")
    paths = [SPEED, PRETENSION]
    samples = np.array([[-8.0, 10e3], [-9.5, 14e3], [-8.0, 12e3]])
    rows = [(PRETENSION, "f8"), (SPEED, "f8")]
    structured = np.zeros(3, dtype=[(name, kind) for name, kind in reversed(rows)])
    for column, path in enumerate(paths):
        structured[path] = samples[:, column]
    tables = [
        dict(zip(paths, samples.T, strict=True)),
        structured,
        pandas.DataFrame(samples, columns=paths),
        (paths, samples),
    ]
    settings = {"until": 2e-3, "every": 4e-4, "record": "span_tension"}
    results = [cd.sweep(marine(), design=table, **settings) for table in tables]
    for result in results[1:]:
        assert_same(result, results[0])
    first = results[0]
    assert first["span_tension"].dims == ("variant", "time", "span")
    assert first["speed"].dims == ("variant",)
    assert first["pretension"].attrs["units"] == "N"
    for row, (speed, pretension) in enumerate(samples):
        alone = cd.sweep(marine(), {SPEED: speed, PRETENSION: pretension}, **settings)
        one = alone["span_tension"].to_numpy()[0, 0]
        assert one.tobytes() == first["span_tension"][row].to_numpy().tobytes()
    assert "variants: 3 of 3 done" in first.attrs["summary"]


def test_a_table_may_hold_words_counts_and_rows_twice():
    table = {
        "run.method": ["verlet", "rk4", "verlet"],
        "sprockets.crank.teeth": np.array([60.0, 59.0, 60.0]),
    }
    result = cd.sweep(marine(), design=table, until=2e-4)
    assert result["method"].to_numpy().tolist() == ["verlet", "rk4", "verlet"]
    assert result["teeth"].dtype == np.int64
    largest = result["span_tension_max"].to_numpy()
    assert largest[0].tobytes() == largest[2].tobytes() != largest[1].tobytes()


@pytest.mark.parametrize(
    ("vary", "design", "error", "words"),
    [
        (None, None, cd.ParameterError, "a table of points"),
        ({PRETENSION: [1e3]}, {PRETENSION: [1e3]}, cd.ParameterError, "a table of points"),
        (None, {PRETENSION: [1e3, 2e3], SPEED: [-8.0]}, cd.ParameterError, "has 1 values"),
        (None, {PRETENSION: []}, cd.ParameterError, "no values"),
        (None, {PRETENSION: 1e3}, cd.ParameterError, "a list or an array of values"),
        (None, ([PRETENSION], np.zeros((2, 2))), cd.ParameterError, "for 1 paths"),
        (None, 12, TypeError, "a DataFrame"),
        (None, {"route.pretenson": [1.0, 2.0]}, cd.SceneError, "pretension"),
        (None, {"chain.links": [112.0, 112.5, 113.0]}, cd.SceneError, "chain.links"),
        (None, {PRETENSION: ["1 kN", "1 mm"]}, cd.SceneError, "is a length"),
        (None, {PRETENSION: [1e3, np.nan]}, cd.SceneError, PRETENSION),
    ],
)
def test_a_wrong_table_is_refused_before_anything_runs(vary, design, error, words):
    with pytest.raises(error, match=words):
        cd.sweep(marine(), vary, design=design, until=1e-3)


def local_executors():
    fresh = multiprocessing.get_context("spawn")
    yield "threads of the core", None
    with ThreadPoolExecutor(2) as executor:
        yield "threads", executor
    with ProcessPoolExecutor(2, mp_context=fresh) as executor:
        yield "processes", executor


def stores_the_bits(name, executor, in_memory, store):
    shares = []
    result = cd.sweep(
        ring(), SPEEDS, **RING, output=store, executor=executor, progress=shares.append
    )
    assert_same(result, in_memory)
    assert result.attrs["status"] == "complete", name
    assert result.attrs["finished"] == 120, name
    assert result.attrs["summary"].splitlines()[-1] == "variants: 120 of 120 done"
    assert shares == sorted(shares), name
    assert shares[-1] == 1.0, name


def test_every_executor_stores_the_bits_of_the_sweep_in_memory(in_memory, tmp_path):
    for number, (name, executor) in enumerate(local_executors()):
        stores_the_bits(name, executor, in_memory, tmp_path / f"{number}.zarr")


@pytest.mark.slow
def test_a_cluster_stores_the_bits_of_the_sweep_in_memory(in_memory, tmp_path):
    with cluster(tmp_path) as executor:
        stores_the_bits("a Dask cluster", executor, in_memory, tmp_path / "dask.zarr")


def test_a_table_in_a_store_is_that_in_memory(tmp_path):
    qmc = pytest.importorskip("scipy.stats").qmc
    sample = qmc.scale(qmc.Sobol(2, rng=1).random_base2(5), [300.0, 8e-3], [400.0, 10e-3])
    design = (["chain.start.speed", "chain.mass"], sample)
    expected = cd.sweep(ring(), design=design, **RING)
    stored = cd.sweep(ring(), design=design, **RING, output=tmp_path / "sobol.zarr")
    assert_same(stored, expected)
    np.testing.assert_array_equal(stored["mass"], sample[:, 1])
    # All arrays are cut at the same places: xarray refuses others.
    chunks = xr.open_zarr(tmp_path / "sobol.zarr").chunks["variant"]
    assert len(chunks) > 8
    assert set(chunks) == {stored.attrs["variants_per_task"]}


def test_variants_that_fail_are_stored_with_their_messages(tmp_path):
    vary = {"chain.start.speed": [300.0, 1e300], "chain.mass": ["8 g", "9 g"]}
    expected = cd.sweep(ring(), vary, **RING)
    stored = cd.sweep(ring(), vary, **RING, output=tmp_path / "s.zarr")
    assert_same(stored, expected)
    attributes = {"failed": 2, "finished": 2, "status": "failed", "complete": 0}
    assert {name: stored.attrs[name] for name in attributes} == attributes
    # There is nothing left to do.
    again = cd.sweep(ring(), vary, **RING, output=tmp_path / "s.zarr")
    assert again.attrs["failure"] == "2 of 4 variants failed"


def test_runs_and_chains_may_be_longer_than_the_first(tmp_path):
    """Rings of 20 and 24 links, runs of 1 to 3 ms, contacts logged in some: the store grows."""
    vary = {
        "chain.links": [20, 24, 22],
        "run.until": [1e-3, 3e-3, 2e-3],
        "run.events": [[], ["teeth"]],
    }
    expected = cd.sweep(ring(), vary, every=1e-3, record="link_tension")
    for jobs in [1, 2]:
        stored = cd.sweep(
            ring(),
            vary,
            every=1e-3,
            record="link_tension",
            output=tmp_path / f"{jobs}.zarr",
            jobs=jobs,
        )
        assert_same(stored, expected)
    assert stored.sizes["link"] == 24
    assert stored.sizes["time"] == 4


class Failing(ThreadPoolExecutor):
    """Loses every task after the first few, and notes the others."""

    def __init__(self, few):
        super().__init__(1)
        self.few, self.tasks = few, []

    def submit(self, task, /, *arguments):
        if len(self.tasks) == self.few:
            future = Future()
            future.set_exception(OSError("the second machine was switched off"))
            return future
        self.tasks.append(arguments[-1])
        return super().submit(task, *arguments)


def test_what_an_executor_lost_is_carried_out_by_the_next_call(in_memory, tmp_path):
    store = tmp_path / "lost.zarr"
    words = r"switched off; .*: the same call goes on"
    with Failing(5) as executor, pytest.raises(cd.SimulationError, match=words):
        cd.sweep(ring(), SPEEDS, **RING, output=store, executor=executor)
    with pytest.warns(cd.ResultWarning, match="interrupted"):
        left = cd.open_result(store)
    each = left.attrs["variants_per_task"]
    assert left.attrs["finished"] == 5 * each
    missing = left["error"].to_numpy() != ""
    assert missing.sum() == 120 - 5 * each
    assert "not carried out" in str(left["error"].to_numpy()[missing][0])
    assert np.isnan(left["steps"].to_numpy()[missing]).all()
    with Failing(-1) as rest:
        assert_same(cd.sweep(ring(), SPEEDS, **RING, output=store, executor=rest), in_memory)
    assert set(executor.tasks) & set(rest.tasks) == set(), "each is carried out once"


def test_a_store_of_another_sweep_is_refused(tmp_path):
    store = tmp_path / "s.zarr"
    speeds = {"chain.start.speed": [300.0, 400.0]}
    cd.sweep(ring(), speeds, **RING, output=store)
    others = [
        ({"chain.start.speed": [300.0, 401.0]}, RING, "other values of `chain.start.speed`"),
        ({"chain.mass": ["8 g"]}, RING, "a grid of `chain.start.speed` instead of"),
        (speeds, RING | {"until": 3e-3}, r"line \d+ of its scene is `until = 0.002`"),
        (speeds, RING | {"record": []}, r"the channels \[link_tension\] instead of \[\]"),
    ]
    for vary, settings, words in others:
        with pytest.raises(cd.WriteError, match=words):
            cd.sweep(ring(), vary, **settings, output=store)
    with pytest.raises(cd.WriteError, match=r"a grid of .* instead of a table"):
        cd.sweep(ring(), design=speeds, **RING, output=store)
    anew = cd.sweep(ring(), {"chain.mass": ["8 g"]}, **RING, output=store, overwrite=True)
    assert anew.sizes["mass"] == 1
    run = tmp_path / "run.zarr"
    cd.simulate(ring(), **RING, output=run, error=False)
    with pytest.raises(cd.WriteError, match="already a result"):
        cd.sweep(ring(), speeds, **RING, output=run)


def test_ctrl_c_leaves_a_store_that_says_so_and_goes_on(tmp_path):
    """Two variants that end at once, and others that would take days."""
    store = tmp_path / "s.zarr"
    finished = threading.Event()

    def interrupt():
        finished.wait()
        time.sleep(0.3)
        os.kill(os.getpid(), signal.SIGINT)

    thread = threading.Thread(target=interrupt, daemon=True)
    thread.start()
    table = {"run.until": [1e-3, 1e5, 2e5, 1e-3]}
    with pytest.raises(KeyboardInterrupt) as caught:
        cd.sweep(
            ring(),
            design=table,
            every=5e-4,
            jobs=2,
            output=store,
            progress=lambda share: share > 0.0 and finished.set(),
        )
    thread.join()
    assert "the same call goes on" in caught.value.__notes__[0]
    kept = caught.value.result
    assert kept.attrs["status"] == "interrupted"
    assert kept.attrs["finished"] == (kept["error"].to_numpy() == "").sum() >= 1
    # The claim is given back: the next call is refused for what it asks, not for who asks.
    with pytest.raises(cd.WriteError, match="other values"):
        cd.sweep(ring(), design={"run.until": [1.0, 2.0]}, every=5e-4, output=store)


@pytest.mark.parametrize(
    ("how", "shares"), [("threads", [0.1, 0.4, 0.7]), ("executor", [0.4]), ("processes", [0.4])]
)
def test_ctrl_c_leaves_a_store_that_says_what_it_holds_and_goes_on(
    in_memory, tmp_path, how, shares
):
    """Whatever has been stored when it comes, and whoever computes."""
    store = tmp_path / "s.zarr"
    for share in shares:

        def interrupt(done, share=share):
            if done > share:
                os.kill(os.getpid(), signal.SIGINT)

        with contextlib.ExitStack() as stack:
            executor = None
            if how != "threads":
                fresh = {"mp_context": multiprocessing.get_context("spawn")}
                kind = ThreadPoolExecutor if how == "executor" else ProcessPoolExecutor
                executor = stack.enter_context(kind(2, **({} if how == "executor" else fresh)))
            settings = RING | {"output": store, "executor": executor, "progress": interrupt}
            with pytest.raises(KeyboardInterrupt) as caught:
                cd.sweep(ring(), SPEEDS, **settings)
        kept = caught.value.result
        held = int((kept["error"].to_numpy() == "").sum())
        status = "interrupted" if held < 120 else "complete"
        assert (kept.attrs["status"], kept.attrs["finished"]) == (status, held)
        assert f"holds {held} of 120 variants: the same call goes on" in caught.value.__notes__[0]
    assert_same(cd.sweep(ring(), SPEEDS, **RING, output=store), in_memory)
    assert cd.open_result(store).attrs["status"] == "complete"


@pytest.mark.skipif(sys.platform == "win32", reason="has no such signal")
@pytest.mark.parametrize("how", ["threads", "processes"])
def test_asked_to_end_it_says_so_before_it_does(tmp_path, how):
    script, store = tmp_path / "script.py", tmp_path / "s.zarr"
    script.write_text(textwrap.dedent(SCRIPT))
    arguments = [sys.executable, str(script), str(store), how, "480", "0.02"]
    process = subprocess.Popen(arguments, stdout=subprocess.DEVNULL)
    while not stored(store):
        assert process.poll() is None
        time.sleep(0.01)
    workers = children(process.pid)
    process.terminate()
    assert process.wait() == -signal.SIGTERM
    for worker in workers:
        with contextlib.suppress(ProcessLookupError):
            os.kill(worker, signal.SIGTERM)
    with pytest.warns(cd.ResultWarning, match="interrupted"):
        left = cd.open_result(store)
    assert left.attrs["finished"] == (left["error"].to_numpy() == "").sum() >= 1


SCRIPT = """
import sys
from concurrent.futures import ProcessPoolExecutor
import numpy as np
import chaindrive as cd

store, how, count, until = sys.argv[1], sys.argv[2], int(sys.argv[3]), float(sys.argv[4])
design = {"chain.start.speed": np.linspace(300.0, 400.0, count)}
settings = {"until": until, "every": 1e-3, "record": "link_tension", "output": store}
settings["progress"] = lambda share: print(share, flush=True)
if __name__ == "__main__":
    if how == "threads":
        cd.sweep(cd.scenes.spinning_ring(), design=design, **settings)
    else:
        # Forked, as is the default up to Python 3.13: workers inherit what their parent has open.
        import multiprocessing

        context = multiprocessing.get_context("fork")
        with ProcessPoolExecutor(2, mp_context=context) as executor:
            cd.sweep(cd.scenes.spinning_ring(), design=design, **settings, executor=executor)
"""


def children(process):
    listed = Path(f"/proc/{process}/task/{process}/children")
    return [int(child) for child in listed.read_text().split()] if listed.exists() else []


def stored(store):
    """Names of the chunks of the array that is written last."""
    return {path.relative_to(store) for path in (store / "error").glob("c/*")}


def kill_and_resume(folder, killed, kills, *, count, until, random):
    """Begin a sweep again and again, and kill workers and coordinators, until it is complete."""
    script, store = folder / "script.py", folder / "killed.zarr"
    script.write_text(textwrap.dedent(SCRIPT))
    begun, reached = {}, 0.0
    # Workers outlive a coordinator that was killed, and wait for it: the next one does not mind.
    orphans = []
    while True:
        how = "threads" if random.random() < 0.3 else "processes"
        arguments = [sys.executable, str(script), str(store), how, str(count), str(until)]
        # Not a pipe: workers that outlive a coordinator would hold it open.
        with (folder / "told").open("w") as told, (folder / "shares").open("w") as shares:
            process = subprocess.Popen(arguments, stdout=shares, stderr=told)
        enough = len(stored(store)) + random.integers(1, 4)
        while process.poll() is None and (
            len(stored(store)) < enough or (how == "processes" and not children(process.pid))
        ):
            time.sleep(0.005)
        time.sleep(random.uniform(0.0, 0.05))
        left = children(process.pid)
        if sum(killed.values()) < kills and process.poll() is None:
            fewer = killed["worker"] <= killed["coordinator"]
            victim = "worker" if left and fewer else "coordinator"
            killed[victim] += 1
            os.kill(left[0] if victim == "worker" else process.pid, signal.SIGKILL)
        process.wait()
        orphans += left
        told = (folder / "told").read_text()
        shares = [float(line) for line in (folder / "shares").read_text().split("\n")[:-1]]
        assert [reached, *shares] == sorted([reached, *shares]), "progress goes on where it was"
        reached = max([reached, *shares])
        for chunk in stored(store):
            contents = (store / chunk).read_bytes()
            assert begun.setdefault(chunk, contents) == contents, "stored twice"
        if process.returncode == 0:
            assert not shares or shares[-1] == 1.0
            for orphan in orphans:
                with contextlib.suppress(ProcessLookupError):
                    os.kill(orphan, signal.SIGKILL)
            return store
        assert process.returncode == -signal.SIGKILL or "the same call goes on" in told, told


def check_killed(tmp_path, kills, count, until):
    """Sweep after sweep, until so many processes were killed: a fast machine soon completes one."""
    design = {"chain.start.speed": np.linspace(300.0, 400.0, count)}
    run = {"until": until, "every": 1e-3, "record": "link_tension"}
    undisturbed = cd.sweep(ring(), design=design, **run)
    random = np.random.default_rng(7)
    killed = {"coordinator": 0, "worker": 0}
    for number in range(2 * kills):
        folder = tmp_path / str(number)
        folder.mkdir()
        store = kill_and_resume(folder, killed, kills, count=count, until=until, random=random)
        assert_same(cd.open_result(store), undisturbed)
        # Nothing is left of files that were on their way.
        assert not list(store.rglob("*#*"))
        if sum(killed.values()) == kills:
            return killed
    pytest.fail(f"the sweeps ended before they were killed: {killed}")


@pytest.mark.costs("an interpreter is started after every kill, and imports what it needs")
@pytest.mark.skipif(sys.platform != "linux", reason="looks at processes in /proc")
def test_killed_and_resumed_no_variant_is_lost_twice_or_different(tmp_path):
    check_killed(tmp_path, kills=2, count=64, until=30e-3)


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="looks at processes in /proc")
def test_killed_twenty_times_no_variant_is_lost_twice_or_different(tmp_path):
    killed = check_killed(tmp_path, kills=20, count=1000, until=40e-3)
    print(json.dumps(killed))
    assert min(killed.values()) >= 5


def test_the_command_goes_on_with_a_sweep_that_was_killed(tmp_path):
    store = tmp_path / "s.zarr"
    arguments = ["sweep", "spinning_ring", "-q", "-o", str(store), "-j", "1"]
    arguments += ["--vary", "chain.start.speed=300..400/60", "--until", "20 ms", "--every", "1 ms"]
    command = [sys.executable, "-m", "chaindrive", *arguments]
    process = subprocess.Popen(command)
    while len(stored(store)) < 2:
        assert process.poll() is None, "it was to take longer"
        time.sleep(0.002)
    process.kill()
    process.wait()
    left = len(stored(store))
    with pytest.warns(cd.ResultWarning, match="killed"):
        each = cd.open_result(store).attrs["variants_per_task"]
    assert 2 <= left < -(-60 // each)
    subprocess.run(command, check=True)
    speeds = {"chain.start.speed": np.linspace(300.0, 400.0, 60)}
    expected = cd.sweep(ring(), speeds, until=20e-3, every=1e-3)
    result = cd.open_result(store).load()
    assert result.attrs["finished"] == 60
    one, other = (it["steps"].to_numpy() for it in (result, expected))
    np.testing.assert_array_equal(one, other)
    # There is nothing left to do.
    subprocess.run(command, check=True)


def test_nothing_but_the_number_of_a_task_goes_out_and_counts_come_back(tmp_path):
    """Sizes of what a pool of processes would send, for tables of 40 and 400 rows."""
    sizes = {}
    for rows in [40, 400]:

        class Weighing(ThreadPoolExecutor):
            def submit(self, task, /, *arguments):
                future = super().submit(task, *arguments)
                sent, returned = pickle.dumps(arguments), pickle.dumps(future.result())
                sizes.setdefault(rows, []).append((len(sent), len(returned)))  # noqa: B023
                return future

        table = {"chain.start.speed": np.linspace(300.0, 400.0, rows)}
        with Weighing(1) as executor:
            output = tmp_path / f"{rows}.zarr"
            cd.sweep(ring(), design=table, **RING, output=output, executor=executor)
    assert np.max(sizes[400], axis=0)[0] < 400
    assert np.max(sizes[400], axis=0)[1] < 200
    assert np.max(sizes[400]) <= np.max(sizes[40]) + 10


def test_overwriting_keeps_the_earlier_store_until_there_is_something(tmp_path):
    """The second variant would take hours, and is of the first task."""
    path = tmp_path / "ring.zarr"
    settings = {"every": 1e-3, "jobs": 1, "output": path}
    cd.sweep(ring(), {"run.until": [1e-3, 2e-3]}, **settings)
    before = (path / "zarr.json").read_bytes()
    until = [1e-3, *(1e4 + np.arange(15))]
    begun = []

    def stop(_):
        begun.append((path / "zarr.json").read_bytes() == before)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt) as caught:
        cd.sweep(ring(), {"run.until": until}, **settings, overwrite=True, progress=stop)
    assert begun == [True]
    assert "holds the earlier result" in caught.value.__notes__[0]
    assert (path / "zarr.json").read_bytes() == before
    assert [it.name for it in tmp_path.iterdir()] == ["ring.zarr"]
    with cd.open_result(path) as kept:
        assert kept.attrs["status"] == "complete"
    cd.sweep(ring(), {"run.until": [1e-3]}, **settings, overwrite=True)
    assert cd.open_result(path).sizes["until"] == 1
