"""Run-up of the marine engine drive: Campbell diagram, and the mesh order of three spans.

Run it as ``python examples/run_up.py [--until SECONDS] [--results FOLDER]``; a minute of the drive
takes half a minute.
"""

import argparse
from pathlib import Path

import matplotlib as mpl
import numpy as np

import chaindrive as cd

MESH = 48
SPANS = ["camshaft-tensioner", "tensioner-idler", "idler-crank"]


def main() -> None:
    parser = argparse.ArgumentParser(description="Run the marine engine drive up.")
    parser.add_argument("--until", type=float, default=60.0, help="duration [s]")
    parser.add_argument("--results", type=Path, default=Path("results"), help="folder to write to")
    arguments = parser.parse_args()
    arguments.results.mkdir(parents=True, exist_ok=True)
    mpl.use("Agg")
    from matplotlib import pyplot as plt

    drive = cd.scenes.marine_engine_bare()
    run = cd.run_up(
        drive,
        "28 rpm",
        "60 rpm",
        until=arguments.until,
        every="2 ms",
        record=["link_tension", "roller_x", "roller_y"],
        error=False,
    )
    speeds = np.linspace(3.0, 6.2, 9)
    modes = run.drive.running_modes(speeds=speeds, up_to=60)
    critical = cd.analysis.critical_speeds(modes, MESH)

    plt.rcParams.update(cd.plot.STYLE)
    figure, axes = plt.subplots(2, 2, figsize=(12, 8), layout="constrained")
    for ax, span in zip(axes.flat, SPANS, strict=False):
        motion = run.drive.span_motion(span, places=0.37)
        orders = run.drive.order_map(motion, "crank", turns=3, overlap=0.9)
        cut = cd.analysis.order_slice(orders, MESH, half_width=0.5)
        cd.plot.order_slice(cut, ax=ax, label=f"{span}, order {MESH}")
        here = (critical["part"] == span) & (critical["share"] > 0.6)
        for speed in critical["speed"][here].to_numpy():
            ax.axvline(speed * 30 / np.pi, color="C1", linewidth=0.8)
        ax.set_title(f"{span}; lines where a running mode is met")
    motion = run.drive.span_motion("tensioner-idler", places=0.37)
    diagram = run.drive.campbell(motion, "crank", window_time=2.0, modes=False, up_to=60)
    mine = modes.isel(mode=np.flatnonzero(modes["share"].sel(part="tensioner-idler")[0] > 0.6))
    diagram = diagram.assign(mode_frequency=mine["frequency"].rename(speed="mode_speed"))
    cd.plot.campbell(diagram, ax=axes.flat[3])
    figure.savefig(arguments.results / "run_up.png", dpi=90)
    print(critical.to_dataframe().round(2))
    print(f"written: {arguments.results}/run_up.png")


if __name__ == "__main__":
    main()
