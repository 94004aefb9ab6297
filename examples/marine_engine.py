"""One second of the camshaft drive of a large marine engine: summary, plots and a Zarr store.

Run it as ``python examples/marine_engine.py [--until SECONDS] [--results FOLDER]``.
"""

import argparse
from pathlib import Path

import matplotlib as mpl

import chaindrive as cd


def main() -> None:
    parser = argparse.ArgumentParser(description="Simulate the marine engine drive.")
    parser.add_argument("--until", type=float, default=1.0, help="end of the run [s]")
    parser.add_argument("--results", type=Path, default=Path("results"), help="folder to write to")
    arguments = parser.parse_args()
    arguments.results.mkdir(parents=True, exist_ok=True)

    drive = cd.scenes.marine_engine()
    run = cd.simulate(
        drive,
        until=arguments.until,
        every=2e-4,
        record=["span_tension", "contact_force", "roller_x", "roller_y", "energy_residual"],
        output=arguments.results / "marine_engine.zarr",
        overwrite=True,
        progress=True,
    )
    print(run.drive.summary())
    plot(drive, run, arguments.results / "marine_engine.png")
    print(f"written: {arguments.results}/marine_engine.png, {arguments.results}/marine_engine.zarr")


def plot(drive: cd.Drive, run, path: Path) -> None:
    mpl.use("Agg")
    from matplotlib import pyplot as plt

    figure = plt.figure(figsize=(12, 7), layout="constrained")
    panels = figure.subplot_mosaic([["layout", "tension"], ["layout", "contact"]])
    cd.plot.layout(drive, ax=panels["layout"])
    settled = run.isel(time=slice(-len(run.time) // 10, None))
    cd.plot.tension(settled, ax=panels["tension"])
    panels["tension"].set_title("span tensions, the last tenth of the run")
    force = run["contact_force"].isel(roller=0)  # (time,) N: one roller on its way around
    force.plot(ax=panels["contact"], linewidth=0.8)
    panels["contact"].set_title("contact force of roller 0")
    figure.savefig(path, dpi=110)


if __name__ == "__main__":
    main()
