"""Every diagram of the package, drawn of two runs: a run-up, and an industrial drive.

Run it as ``python examples/gallery.py [--results FOLDER]``; it takes half a minute.
"""

import argparse
from collections.abc import Iterator
from pathlib import Path

import matplotlib as mpl
import numpy as np

import chaindrive as cd


def main() -> None:
    parser = argparse.ArgumentParser(description="Draw every diagram of the package.")
    parser.add_argument(
        "--results", type=Path, default=Path("results/gallery"), help="folder to write to"
    )
    folder = parser.parse_args().results
    folder.mkdir(parents=True, exist_ok=True)
    mpl.use("Agg")
    for name, axes in diagrams():
        axes.figure.savefig(folder / f"{name}.png", dpi=110)
        print(f"written: {folder / name}.png")


def diagrams():
    """Yield name and axes of every diagram."""
    yield from signals()
    yield from contacts()


def signals() -> Iterator[tuple[str, object]]:
    """Draw a run-up of two sprockets: spectra, orders, modes, spans."""
    drive = cd.scenes.marine_two_sprockets()
    record = ["span_tension", "link_tension", "roller_x", "roller_y", "sprocket_speed"]
    run = cd.run_up(drive, "40 rpm", "100 rpm", until=8, every="1 ms", record=record, error=False)
    yield "tension", cd.plot.tension(run)
    yield "spectrum", cd.plot.spectrum(run, segments=4, up_to=250)
    motion = run.drive.span_motion("crank-camshaft", places=0.37)
    yield "order_map", cd.plot.order_map(run, motion, turns=1.0, up_to=150)
    orders = run.drive.order_map(motion, "crank", turns=1.0)
    yield "order_slice", cd.plot.order_slice(cd.analysis.order_slice(orders, 60))
    yield "campbell", cd.plot.campbell(run, motion, window_time=0.5, up_to=120)
    modes = cd.analysis.running_modes(drive, speeds=np.linspace(0, 15, 7), up_to=40)
    yield "running_modes", cd.plot.running_modes(modes)
    places = run.drive.span_motion("camshaft-crank", places=[0.25, 0.5])
    yield "span_motion", cd.plot.span_motion(places.sel(time=slice(6, 7)))
    yield "span_envelope", cd.plot.span_envelope(run, "camshaft-crank")
    steady = cd.simulate(drive, run_in="2 turns", until=0.5, every="0.2 ms", error=False)
    yield "frame", cd.plot.frame(steady, 0.25)
    yield "transmission_error", cd.plot.transmission_error(steady)
    yield "speed_ripple", cd.plot.speed_ripple(steady)
    pretensions = {"route.pretension": [5e3, 10e3, 15e3, 20e3]}
    table = cd.sweep(drive, pretensions, run_in=0, until=0.2, every="1 ms")
    yield "response", cd.plot.response(table)


def contacts() -> Iterator[tuple[str, object]]:
    """Draw an industrial drive: the drive, loads on teeth and links, losses, wear."""
    drive = cd.scenes.industrial_16b()
    yield "layout", cd.plot.layout(drive)
    record = ["link_tension", "span_tension", "contact_force", "roller_x", "roller_y"]
    record += ["sprocket_x", "sprocket_y", "sprocket_angle", "energy_losses", "energy_flows"]
    run = cd.simulate(
        drive, run_in=0.2, until=0.1, every=1e-4, record=record, events="teeth", error=False
    )
    yield "overview", cd.plot.overview(run).axes[0]
    yield "tension_around_loop", cd.plot.tension_around_loop(run)
    yield "tooth_load", cd.plot.tooth_load(run)
    yield "impacts", cd.plot.impacts(run)
    yield "losses", cd.plot.losses(run)
    yield "joint_work", cd.plot.joint_work(run)
    yield "elongation", cd.plot.elongation(run)
    yield "rainflow", cd.plot.rainflow(run)
    yield "utilisation", cd.plot.utilisation(run)
    table = cd.work_precision(cd.scenes.spinning_ring(), until=0.01)
    yield "work_precision", cd.plot.work_precision(table)


if __name__ == "__main__":
    main()
