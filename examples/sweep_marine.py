"""Two hundred variants of the marine engine drive: twenty crank speeds times ten pretensions.

Runs the sweep on one core and on several in turn, tells how much faster several are, checks that
both give the same bits, and draws the peak tension of the chain over speed and pretension.

Run it as ``python examples/sweep_marine.py [--until SECONDS] [--jobs N] [--rounds N]
[--results FOLDER]``.
"""

import argparse
import os
import statistics
import time
from pathlib import Path

import matplotlib as mpl
import numpy as np
import xarray as xr

import chaindrive as cd

RPM = 2.0 * np.pi / 60.0
VARY = {
    "sprockets.crank.motion.speed": np.linspace(-60.0 * RPM, -155.0 * RPM, 20),  # clockwise
    "route.pretension": np.linspace(10e3, 28e3, 10),  # N
}


def main() -> None:
    parser = argparse.ArgumentParser(description="Sweep speed and pretension of the marine drive.")
    parser.add_argument("--until", type=float, default=0.1, help="end of each run [s]")
    parser.add_argument("--jobs", type=int, default=2, help="variants at a time")
    parser.add_argument("--rounds", type=int, default=3, help="how often both are timed")
    parser.add_argument("--results", type=Path, default=Path("results"), help="folder to write to")
    arguments = parser.parse_args()
    arguments.results.mkdir(parents=True, exist_ok=True)

    # In turn, so that whatever else the machine does slows both down.
    wall: dict[int, list[float]] = {1: [], arguments.jobs: []}
    cpu: dict[int, list[float]] = {1: [], arguments.jobs: []}
    results: dict[int, xr.Dataset] = {}
    for number in range(arguments.rounds):
        for jobs in wall:
            result, *times = timed(arguments.until, jobs)
            wall[jobs].append(times[0])
            cpu[jobs].append(times[1])
            results[jobs] = result
            print(
                f"round {number + 1}, {jobs} at a time: {times[0]:6.2f} s, "
                f"CPU {times[1]:6.2f} s, load {os.getloadavg()[0]:.1f}"
            )
    many = results[arguments.jobs]
    print(many.attrs["summary"])
    for jobs in wall:
        print(
            f"{jobs} at a time: median {statistics.median(wall[jobs]):.2f} s, "
            f"CPU {statistics.median(cpu[jobs]):.2f} s"
        )
    ratios = [one / more for one, more in zip(wall[1], wall[arguments.jobs], strict=True)]
    told = ", ".join(f"{ratio:.2f}" for ratio in ratios)
    print(f"ratio: median {statistics.median(ratios):.2f} of {told}")
    assert_same_bits(results[1], many)
    print("same bits: yes")
    plot(many, arguments.results / "sweep_marine.png")
    print(f"written: {arguments.results}/sweep_marine.png")


def timed(until: float, jobs: int) -> tuple[xr.Dataset, float, float]:
    """Return the sweep with its wall time and the processor time of this process [s]."""
    wall, cpu = time.perf_counter(), time.process_time()
    result = cd.sweep(
        cd.scenes.marine_engine_bare(), VARY, until=until, run_in=0, method="auto", jobs=jobs
    )
    return result, time.perf_counter() - wall, time.process_time() - cpu


def assert_same_bits(one: xr.Dataset, other: xr.Dataset) -> None:
    for name in set(one.variables) - {"stepping_time", "real_time_factor"}:
        if one[name].to_numpy().tobytes() != other[name].to_numpy().tobytes():
            raise SystemExit(f"`{name}` depends on the number of threads")


def plot(result: xr.Dataset, path: Path) -> None:
    mpl.use("Agg")
    from matplotlib import pyplot as plt

    # (speed, pretension) N: the largest sample of all spans.
    peak = result["span_tension_max"].max("span")
    figure, axes = plt.subplots(figsize=(8, 5), layout="constrained")
    mesh = axes.pcolormesh(
        -result["speed"] / RPM, result["pretension"] / 1e3, peak.T / 1e3, shading="nearest"
    )
    axes.set_xlabel("crank speed [r/min]")
    axes.set_ylabel("pretension [kN]")
    axes.set_title(
        f"Marine drive: peak span tension in {float(result['time_reached'].max()):.2g} s"
    )
    figure.colorbar(mesh, ax=axes, label="peak span tension [kN]")
    figure.savefig(path, dpi=110)


if __name__ == "__main__":
    main()
