"""Fits that are killed, resumed, and computed by others: the same bits, and no run twice."""

import multiprocessing
import subprocess
import sys
import time
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path

import cheap_fit
import numpy as np
import pandas as pd
import pytest
import xarray as xr
from cheap_fit import fitted
from clusters import cluster

import chaindrive as cd
from chaindrive.measurement.evaluations import RunStore

#: A record and the drive that is fitted to it.
Files = tuple[Path, Path]


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Files:
    return cheap_fit.written(tmp_path_factory.mktemp("rig"))


@pytest.fixture(scope="module")
def fit(files: Files, tmp_path_factory: pytest.TempPathFactory) -> xr.Dataset:
    return fitted(files, tmp_path_factory.mktemp("whole"), jobs=1)


def assert_same(one: xr.Dataset, other: xr.Dataset) -> None:
    """The same numbers and the same drive; how many runs were computed is another thing."""
    xr.testing.assert_identical(one.drop_attrs(deep=False), other.drop_attrs(deep=False))
    assert one.attrs["scene"] == other.attrs["scene"]


def there(store: Path) -> dict[str, int]:
    """The runs in a store, but those in the making, and when they were written."""
    return {it.name: it.stat().st_mtime_ns for it in store.glob("[!.]*.npz")}


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="signals")
def test_a_fit_killed_at_ten_moments_goes_on(fit: xr.Dataset, files: Files, tmp_path: Path) -> None:
    """Moments are drawn over what is left of the fit; runs that are there stay as they are."""
    store = tmp_path / "runs"
    store.mkdir()
    program = [sys.executable, cheap_fit.__file__, *map(str, files), str(store)]
    lot = np.random.default_rng(57)
    whole = int(fit.attrs["computed"])
    kept: dict[str, int] = {}
    for left in range(10, 0, -1):
        with subprocess.Popen(program, stdout=subprocess.PIPE) as process:
            assert process.stdout is not None
            assert process.stdout.readline() == b"begun\n"
            # So many runs, of those that are left, and then a moment within one.
            more = int(lot.integers(0, max(2, 2 * (whole - len(kept)) // (left + 1))))
            limit = time.monotonic() + 60.0
            while len(there(store)) < len(kept) + more and process.poll() is None:
                assert time.monotonic() < limit
                time.sleep(1e-3)
            time.sleep(lot.uniform(0.0, 0.05))
            process.kill()
        found = there(store)
        assert kept.items() <= found.items(), "a run was computed twice"
        kept = found
        runs = RunStore(store)
        assert all(runs.get(Path(name).stem) is not None for name in kept)
    assert len(kept) > 0
    again = fitted(files, store, jobs=1)
    assert again.attrs["computed"] == whole - len(kept)
    assert_same(again, fit)


@pytest.mark.slow
def test_who_computes_changes_nothing(fit: xr.Dataset, files: Files, tmp_path: Path) -> None:
    """Two threads, threads and processes of an executor, and a cluster."""
    assert_same(fitted(files, None, jobs=2), fit)
    fresh = multiprocessing.get_context("spawn")
    with ThreadPoolExecutor(2) as threads:
        assert_same(fitted(files, None, executor=threads), fit)
    with ProcessPoolExecutor(2, mp_context=fresh) as processes:
        assert_same(fitted(files, None, executor=processes), fit)
    with cluster(tmp_path) as workers:
        assert_same(fitted(files, None, executor=workers), fit)


@pytest.mark.slow
def test_six_parameters_of_a_second_cost_at_most_240_s() -> None:
    """Sixty-five runs of a second with their run-in and a start, by central differences."""
    rig = cd.scenes.industrial_16b()
    free = {
        cheap_fit.LOAD: (-1600.0, -1300.0),
        cheap_fit.PRETENSION: (1000.0, 2000.0),
        "contact.joints.friction.coefficient": (0.05, 0.15),
        "chain.stiffness": (120e6, 200e6),
        "chain.mass": (0.055, 0.085),
        "sprockets.driven.inertia": (1.2, 1.9),
    }
    true = rig.replace({cheap_fit.LOAD: -1400.0, "route.phase": 0.37, "chain.stiffness": 150e6})
    settings = {"until": 1.0, "every": 4e-4, "step": 7e-6, "method": "verlet", "error": False}
    record = ["span_tension", "sprocket_torque"]
    run = cd.simulate(true, record=record, **settings).isel(time=slice(0, -1))
    noise = np.random.default_rng(6).standard_normal((3, run.sizes["time"]))
    table = pd.DataFrame(
        {
            "time [s]": run["time"],
            "tight [N]": run["span_tension"][:, 1] + 20.0 * noise[0],
            "slack [N]": run["span_tension"][:, 0] + 5.0 * noise[1],
            "torque [N m]": run["sprocket_torque"][:, 0] + noise[2],
        }
    )
    places = ("span_tension[driven-driver]", "span_tension[driver-driven]")
    quantities = dict(zip(("tight", "slack"), places, strict=True))
    quantities["torque"] = "sprocket_torque[driver]"
    channels = {name: {"quantity": it, "gain_uncertainty": 0.01} for name, it in quantities.items()}
    data = cd.measured(table, channels=channels, turns={"driver": "300 rpm"})
    begin = time.process_time()
    fit = cd.calibrate(rig, data, free, starts=1, validation=0.0)
    spent = time.process_time() - begin
    print(f"{spent:.0f} CPU s, {fit.attrs['computed']} runs")
    assert fit.attrs["verdict"] == "calibrated", fit.attrs["summary"]
    assert spent / fit.attrs["computed"] < 240.0 / 66


def test_threads_and_an_executor_are_not_given_both(files: Files) -> None:
    with (
        ThreadPoolExecutor(1) as executor,
        pytest.raises(cd.ParameterError, match="the executor decides on its own"),
    ):
        fitted(files, None, jobs=2, executor=executor)
    with pytest.raises(cd.ParameterError, match="jobs = 0, must be at least 1"):
        fitted(files, None, jobs=0)
