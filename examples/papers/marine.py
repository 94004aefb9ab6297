"""The marine engine paper reproduced: tables and figures of docs/marine-paper.md.

Draws every comparison that "Contact problems in roller chain drive systems" makes on the camshaft
drive of a large two-stroke engine, each with five replicates and a verdict.

Run it as ``python examples/papers/marine.py [--until SECONDS] [--results FOLDER]``. With the
default of 1 s a run it takes some three minutes on two cores.
"""

import argparse
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

import matplotlib as mpl
import numpy as np
import xarray as xr
from far_swings import swings
from impulses import impulses, teeth_and_speed
from life import Life, life
from marine_bars import shapes, spans_between_bars
from marine_drive import (
    PITCH,
    SPANS,
    TEETH,
    TIGHT,
    Length,
    locked,
    measure,
    nearer,
    observe,
    offset,
    paper,
    rubbing,
    with_play,
)
from marine_waves import polygon, vibration
from matplotlib import pyplot as plt
from replicates import JOBS, Case, Page, p99, starts, study, table

import chaindrive as cd

mpl.use("Agg")

SPROCKETS = ("crank", "camshaft", "tensioner", "idler")
CONTACT = {
    "tight": ("tight span, mean [kN]", 1e3),
    "tight_std": ("tight span, std [kN]", 1e3),
    "contact_p99": ("roller on tooth, 99 % [kN]", 1e3),
    "arrival": ("rollers arrive with, median [m/s]", 1.0),
    "arrival_p90": ("… 90 % [m/s]", 1.0),
    "loss": ("lost [kW]", 1e3),
}


def every_tooth(kind: str) -> dict[str, object]:
    return {f"sprockets.{name}.tooth": {"kind": kind} for name in SPROCKETS}


def profiles(page: Page, length: Length) -> None:
    """Compare circular and real profiles."""
    figure, axes = plt.subplots(1, 3, figsize=(14, 4.6), layout="constrained")
    radius = 0.5 * PITCH / np.sin(np.pi / TEETH)
    bases = (("profile", paper()), ("profile, default", cd.scenes.marine_engine()))
    for (title, base), axis in zip(bases, axes[1:], strict=True):
        drives = {
            "real: ISO 606, mid": base,
            "real: ASME type II": base.replace(every_tooth("asa-type-ii")),
            "circular": base.replace(every_tooth("circular")),
        }
        page.add(title, table(study(drives, partial(measure, length=length)), CONTACT, "profile"))
        for number, (name, drive) in enumerate(drives.items()):
            angle, mean_force, high = along_the_wrap(observe(drive, length), radius)
            axis.plot(angle, mean_force / 1e3, color=f"C{number}", label=name)
            axis.plot(angle, high / 1e3, color=f"C{number}", linewidth=0.7, linestyle="--")
            if axis is axes[1]:
                outline = drive.profile("crank", settled=False).outline(1e-5)
                x, y = gap_upward(outline, radius)
                axes[0].plot(1e3 * x, 1e3 * y, linewidth=1.2, color=f"C{number}")
        axis.set(
            xlabel="angle on the crank, from the tight span on [°]",
            ylabel="force of the teeth on a roller [kN]",
            title=f"{title.partition(', ')[2] or 'as in the paper'}: mean, dashed 99 %",
        )
        axis.legend(fontsize="small")
    roller = plt.Circle((0.0, 0.0), 26.99, fill=False, linestyle="--", linewidth=0.8)
    axes[0].add_patch(roller)
    axes[0].set(
        aspect="equal",
        xlim=(-50, 50),
        ylim=(-32, 32),
        xlabel="from the middle of the gap [mm]",
        ylabel="from the pitch circle [mm]",
        title="gaps of the crank; dashed: a seated roller",
    )
    page.save(figure, "profiles")


def gap_upward(outline: np.ndarray, radius: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the gap nearest to the top, turned upright, from its seated roller's centre [m]."""
    distance = np.hypot(*outline.T)
    angle = np.arctan2(outline[:, 1], outline[:, 0])
    near = np.abs(angle - 0.5 * np.pi) < 1.1 * np.pi / TEETH
    lowest = angle[near][distance[near].argmin()]
    # Its middle is that of the arc that it cuts out of the pitch circle.
    cut = angle[(distance < radius) & (np.abs(angle - lowest) < np.pi / TEETH)]
    middle = 0.5 * (cut.min() + cut.max())
    shown = np.abs(angle - middle) < 1.25 * np.pi / TEETH
    turned = distance[shown] * np.exp(1j * (angle[shown] - middle + 0.5 * np.pi))
    order = np.argsort(-np.angle(turned))
    return turned.real[order], turned.imag[order] - radius


def along_the_wrap(run: xr.Dataset, radius: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return angles on the crank [°], and mean and 99 % of the force there on a roller [N]."""
    crank = run.sel(sprocket="crank")
    x = (run["roller_x"] - crank["sprocket_x"]).values
    y = (run["roller_y"] - crank["sprocket_y"]).values
    near = np.abs(np.hypot(x, y) - radius) < 0.3 * PITCH
    # Clockwise from the lower right, where the tight span ends.
    angle = np.degrees(np.mod(-np.arctan2(y, x)[near] + np.pi / 4.0, 2.0 * np.pi)) - 45.0
    force = run["contact_force"].values[near]
    edges = np.arange(10.0, 205.0, 5.0)
    groups = np.digitize(angle, edges)
    middle, means, high = [], [], []
    for k in range(1, len(edges)):
        here = force[groups == k]
        if here.size:
            middle.append(0.5 * (edges[k - 1] + edges[k]))
            means.append(here.mean())
            high.append(p99(here))
    return np.array(middle), np.array(means), np.array(high)


def guides(page: Page, length: Length) -> None:
    """Compare drives with and without guide bars, and with bars that are nearer."""
    columns = {f"reach {span}": (f"{span} reaches outward [mm]", 1e-3) for span in SPANS} | {
        "tight_std": ("tight span, std [kN]", 1e3),
        "slack_std": ("tensioner-idler, std [kN]", 1e3),
        "contact_p99": ("roller on tooth, 99 % [kN]", 1e3),
        "blows": ("blows on bars [1/s]", 1.0),
        "guide": ("force on bars, mean [N]", 1.0),
    }
    drives, by_drive = {}, {}
    for title, base in (("guides", paper()), ("guides, default", cd.scenes.marine_engine())):
        drives = {
            "bars 5 mm clear of the rollers": base,
            "bars 1 mm clear": nearer(base, 4e-3),
            "no bars": base.replace({"guides": []}),
        }
        cases = study(drives, partial(measure, length=length))
        page.add(title, table(cases, columns, "guide bars"))
        by_drive[base.name] = cases
    spans_between_bars(page, by_drive)

    figure, axes = plt.subplots(len(SPANS), 1, figsize=(10, 6.5), sharex=True, layout="constrained")
    shown = Length(min(length.until, 0.5), length.run_in)
    for number, (name, drive) in enumerate(drives.items()):
        run = observe(drive, shown)
        for axis, span in zip(axes, SPANS, strict=True):
            swing = 1e3 * offset(drive, span, run)
            axis.plot(run["time"], swing, linewidth=0.8, color=f"C{number}", label=name)
            axis.set(ylabel=f"{span} [mm]", xlim=(0.0, shown.until))
    for axis in axes:
        for clear, number in ((5.0, 0), (1.0, 1)):
            axis.axhline(clear, color=f"C{number}", linestyle="--", linewidth=0.8)
    axes[1].legend(fontsize="small", ncols=3, loc="center")
    axes[0].set_title(
        "marine_engine: offset of the middle of a span, outward; dashed: faces of the bars"
    )
    axes[-1].set_xlabel("time [s]")
    page.save(figure, "guides")


def centres(page: Page, length: Length) -> None:
    """Compare fixed, sprung, moved and actively tensioned centres."""
    moved = {"kind": "prescribed", "x": {"kind": "harmonics", "terms": [oscillation()]}}
    drives = {
        "tensioner on its spring": paper(),
        "tensioner locked": locked(paper()),
        "locked, with friction in the joints": locked(rubbing()),
        "idler moved, 1 mm at 5 Hz": paper().replace({"sprockets.idler.support": moved}),
    }
    columns = {
        "tight": ("tight span, mean [kN]", 1e3),
        "tight_std": ("tight span, std [kN]", 1e3),
        "slack": ("tensioner-idler, mean [kN]", 1e3),
        "slack_std": ("tensioner-idler, std [kN]", 1e3),
        "contact_p99": ("roller on tooth, 99 % [kN]", 1e3),
        "waves": ("chain taken by waves [mm]", 1e-3),
        "ripple": ("camshaft speed, std [%]", 1e-2),
    }
    page.add("centres", table(study(drives, partial(measure, length=length)), columns, "centres"))
    active(page, length)


def oscillation() -> dict[str, float]:
    return {"amplitude": 1e-3, "frequency": 5.0}


PERIOD = 1e-3  # s
GAIN, RATE = 0.5, 40.0  # N of push a N of tension, and that per second
GROWTH, STEP = 1e-3, 10e3  # m, N m


def controlled(drive: cd.Drive, length: Length, wanted: float | None) -> np.ndarray:
    """Return time [s], slack tension, tight tension and force of the controller [N].

    Every millisecond a PI law reads the tension of the span behind the tensioner and sets a force
    beside the push of its spring; without a tension that is wanted it only reads.
    """
    simulation = cd.Simulation(drive, run_in=length.run_in, method="auto")
    # Outward by GROWTH within a fifth of the run: faster in its first half, slower in its second.
    pace = 4.0 * GROWTH / (0.2 * length.until) ** 2
    outward = np.array([1.220977776126472, 2.15]) / np.hypot(1.220977776126472, 2.15)
    for share, acceleration in ((0.2, pace), (0.3, -pace), (0.4, 0.0)):
        x, y = acceleration * outward
        simulation.set_centre_acceleration("camshaft", (x, y), at=share * length.until)
    simulation.set_torque("camshaft", STEP, at=0.7 * length.until)
    integral = force = 0.0
    smooth = None
    rows = []
    tensions = simulation.view("span_tension")["span_tension"]
    for k in range(round(length.until / PERIOD) + 1):
        simulation.advance_to(k * PERIOD)
        tight, _, slack, _ = tensions.tolist()
        # A first-order filter of 20 ms: the mesh at 100 Hz is not the controller's business.
        smooth = slack if smooth is None else smooth + (slack - smooth) * PERIOD / 20e-3
        if wanted is not None:
            integral += RATE * (wanted - smooth) * PERIOD
            force = GAIN * (wanted - smooth) + integral
            simulation.set_force("tightener", force)
        rows.append((simulation.time, slack, tight, force))
    return np.array(rows)


def active(page: Page, length: Length) -> None:
    """Move the camshaft outward, then load it: locked, sprung and actively tensioned."""
    length = Length(2.5 * length.until, length.run_in)
    drive = paper()
    wanted = 17.5e3  # N: the mean with the spring, before anything moves
    kinds: dict[str, Callable[[cd.Drive], np.ndarray]] = {
        "spring": lambda it: controlled(it, length, None),
        "locked": lambda it: controlled(locked(it), length, None),
        "active": lambda it: controlled(it, length, wanted),
    }
    windows = {
        "before": (0.05, 0.2),
        "camshaft 1 mm out": (0.5, 0.7),
        "and 10 kN m more": (0.85, 1),
    }
    cases: dict[str, Case] = {}
    traces = {}
    with ThreadPoolExecutor(JOBS) as pool:
        for name, run in kinds.items():
            rows = list(pool.map(run, starts(drive)))
            traces[name] = rows[-1]
            cases[name] = {
                window: np.array([mean_between(row, *edges, length.until) for row in rows])
                for window, edges in windows.items()
            }
    columns = {window: (f"tensioner-idler, {window} [kN]", 1e3) for window in windows}
    page.add("active", table(cases, columns, "tensioner"))

    figure, (above, below) = plt.subplots(2, 1, figsize=(10, 6), sharex=True, layout="constrained")
    for number, (name, rows) in enumerate(traces.items()):
        time, slack, _, force = rows.T
        above.plot(time, slack / 1e3, linewidth=0.4, alpha=0.35, color=f"C{number}")
        kernel = np.ones(50) / 50
        inner = slice(25, -24)
        above.plot(
            time[inner], np.convolve(slack, kernel, "valid") / 1e3, color=f"C{number}", label=name
        )
        if name == "active":
            below.plot(time, force / 1e3, color=f"C{number}", linewidth=0.8)
    above.axhline(wanted / 1e3, color="black", linestyle="--", linewidth=0.8)
    above.set(
        ylabel="tensioner-idler [kN]",
        ylim=(10, 42),
        title="camshaft moved 1 mm out, then loaded; bold: mean over 50 ms, dashed: wanted",
    )
    above.legend(fontsize="small", loc="upper left")
    below.set(ylabel="force of the controller [kN]", xlabel="time [s]")
    for axis in (above, below):
        axis.axvspan(0.2 * length.until, 0.4 * length.until, color="0.9", zorder=0)
        axis.axvline(0.7 * length.until, color="0.6", zorder=0)
        axis.set_xlim(0.0, length.until)
    page.save(figure, "centres")


def mean_between(rows: np.ndarray, first: float, last: float, until: float) -> float:
    inside = (rows[:, 0] >= first * until) & (rows[:, 0] <= last * until)
    return float(rows[inside, 1].mean())


def models(page: Page, length: Length) -> None:
    """Compare what the paper chose, or left out, with its neighbours."""
    teeth = {"kind": "power", "exponent": 1.5}
    drives = {
        "exact restitution of 0.8": paper(),
        "Lankarani–Nikravesh, 0.8": paper().replace(
            {"contact.teeth.dissipation": "lankarani-nikravesh"}
        ),
        "restitution 0.5": paper().replace({"contact.teeth.restitution": 0.5}),
        "teeth half as stiff": paper().replace(
            {"contact.teeth.law": teeth | {"stiffness": "3e11 N/m^1.5"}}
        ),
        "teeth twice as stiff": paper().replace(
            {"contact.teeth.law": teeth | {"stiffness": "1.2e12 N/m^1.5"}}
        ),
        "damping of links 0.1": paper().replace({"chain.damping_ratio": 0.1}),
        "friction of pins, 0.1": rubbing(),
        "play in joints and rollers": with_play(),
        "`marine_engine`: friction, orders of the engine": cd.scenes.marine_engine(),
    }
    columns = CONTACT | {
        "slack_std": ("tensioner-idler, std [kN]", 1e3),
        f"swing {TIGHT}": ("swing of the tight span, std [mm]", 1e-3),
    }
    page.add("models", table(study(drives, partial(measure, length=length)), columns, "model"))


def wear(page: Page, length: Length) -> None:
    """Wear the drive with friction to the 1 % at which a chain beside guides is worn out."""
    new = cd.scenes.marine_engine()
    takes_up = {"kind": "slider", "name": "tightener", "within": "0.1 m"}
    states = {0.0: new} | {it: cd.worn(new, it, take_up=takes_up) for it in (0.005, 0.01)}
    # Two circuits of the chain, and some more.
    longer = Length(2.5 * length.until, length.run_in)
    life(page, "life", Life("`marine_engine`", states, longer, 1e-3, ("kN", 1e3)))


PARTS: Mapping[str, Callable[[Page, Length], None]] = {
    "profile": profiles,
    "guides": guides,
    "shapes": shapes,
    "centres": centres,
    "polygon": polygon,
    "vibration": vibration,
    "models": models,
    "impulses": impulses,
    "teeth": teeth_and_speed,
    "swings": swings,
    "life": wear,
}


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description="Reproduce the marine engine paper.")
    parser.add_argument("--until", type=float, default=1.0, help="length of a run [s]")
    parser.add_argument("--run-in", type=float, default=0.5, help="what goes before it [s]")
    parser.add_argument("--results", type=Path, default=Path("results"), help="folder to write to")
    parser.add_argument("--parts", nargs="+", default=list(PARTS), choices=list(PARTS))
    given = parser.parse_args(arguments)
    page = Page(given.results, "marine-paper")
    for name in given.parts:
        PARTS[name](page, Length(given.until, given.run_in))


if __name__ == "__main__":
    main()
