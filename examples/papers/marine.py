"""The marine engine paper reproduced: tables and figures of docs/marine-paper.md.

Draws every comparison that "Contact problems in roller chain drive systems" makes on the camshaft
drive of a large two-stroke engine, each with five replicates and a verdict.

Run it as ``python examples/papers/marine.py [--until SECONDS] [--results FOLDER]``. With the
default of 1 s a run it takes some two minutes on two cores.
"""

import argparse
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

import matplotlib as mpl
import numpy as np
import xarray as xr
from marine_drive import (
    EVERY,
    MASS,
    PITCH,
    RPM,
    SPANS,
    SPEED,
    TEETH,
    TIGHT,
    Length,
    half_pitch,
    locked,
    measure,
    nearer,
    observe,
    offset,
    paper,
    rubbing,
    tangent,
    with_play,
)
from replicates import JOBS, PHASES, Case, Page, harmonics, mean, spectrum, study, table

import chaindrive as cd

mpl.use("Agg")
from matplotlib import pyplot as plt

DISTANCE = 2.4725  # m, of crank and camshaft
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
    drives = {
        "real: ISO 606, mid": paper(),
        "real: ASME type II": paper().replace(every_tooth("asa-type-ii")),
        "circular": paper().replace(every_tooth("circular")),
    }
    page.add("profile", table(study(drives, partial(measure, length=length)), CONTACT, "profile"))

    figure, (left, right) = plt.subplots(1, 2, figsize=(12, 4.6), layout="constrained")
    for number, (name, drive) in enumerate(drives.items()):
        outline = drive.profile("crank", settled=False).outline(1e-5)
        radius = 0.5 * PITCH / np.sin(np.pi / TEETH)
        x, y = gap_upward(outline, radius)
        left.plot(1e3 * x, 1e3 * y, label=name, linewidth=1.2, color=f"C{number}")
        run = observe(drive, Length(max(length.until, 0.3), length.run_in))
        time, force = visit(run, radius)
        right.plot(1e3 * time, force / 1e3, label=name, linewidth=0.7, color=f"C{number}")
    roller = plt.Circle((0.0, 0.0), 26.99, fill=False, linestyle="--", linewidth=0.8)
    left.add_patch(roller)
    left.set(
        aspect="equal",
        xlim=(-50, 50),
        ylim=(-32, 32),
        xlabel="from the middle of the gap [mm]",
        ylabel="from the pitch circle [mm]",
        title="gaps of the crank's sprocket; dashed: a seated roller",
    )
    left.legend(fontsize="small", loc="upper center")
    right.set(
        xlabel="time since the roller came within half a pitch of the pitch circle [ms]",
        ylabel="force of the teeth [kN]",
        title="one roller on its way around the crank",
    )
    right.legend(fontsize="small")
    page.save(figure, "profiles")


def gap_upward(outline: np.ndarray, radius: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the gap nearest to the top, turned upright, from its seated roller's centre [m]."""
    distance = np.hypot(*outline.T)
    angle = np.arctan2(outline[:, 1], outline[:, 0])
    near = np.abs(angle - 0.5 * np.pi) < 1.1 * np.pi / TEETH
    lowest = angle[near][distance[near].argmin()]
    turn = np.abs(np.angle(np.exp(1j * (angle - lowest)))) < 1.25 * np.pi / TEETH
    turned = distance[turn] * np.exp(1j * (angle[turn] - lowest + 0.5 * np.pi))
    order = np.argsort(-np.angle(turned))
    return turned.real[order], turned.imag[order] - radius


def visit(run: xr.Dataset, radius: float) -> tuple[np.ndarray, np.ndarray]:
    """Return time [s] and force [N] of the roller that stays longest at the crank."""
    crank = run.sel(sprocket="crank")
    distance = np.hypot(
        run["roller_x"] - crank["sprocket_x"], run["roller_y"] - crank["sprocket_y"]
    )
    there = (distance < radius + 0.5 * PITCH).values
    # Whole visits: away at both ends of the record.
    whole = ~there[0] & ~there[-1] & there.any(axis=0)
    roller = int((there.sum(axis=0) * (whole if whole.any() else True)).argmax())
    shown = there[:, roller]
    time = run["time"].values[shown]
    return time - time[0], run["contact_force"].values[shown, roller]


def guides(page: Page, length: Length) -> None:
    """Compare drives with and without guide bars, and with bars that are nearer."""
    columns = {f"reach {span}": (f"{span} reaches outward [mm]", 1e-3) for span in SPANS} | {
        "tight_std": ("tight span, std [kN]", 1e3),
        "slack_std": ("tensioner-idler, std [kN]", 1e3),
        "contact_p99": ("roller on tooth, 99 % [kN]", 1e3),
        "blows": ("blows on bars [1/s]", 1.0),
        "guide": ("force on bars, mean [N]", 1.0),
    }
    drives = {}
    for title, base in (("guides", paper()), ("guides, default", cd.scenes.marine_engine())):
        drives = {
            "bars 5 mm clear of the rollers": base,
            "bars 1 mm clear": nearer(base, 4e-3),
            "no bars": base.replace({"guides": []}),
        }
        cases = study(drives, partial(measure, length=length))
        page.add(title, table(cases, columns, "guide bars"))

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
    axes[0].legend(fontsize="small", ncols=3, loc="lower right")
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
    for k in range(round(length.until / PERIOD) + 1):
        simulation.advance_to(k * PERIOD)
        tight, _, slack, _ = simulation["span_tension"].values
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
    starts = [drive.replace({"route.phase": phase}) for phase in PHASES]
    windows = {
        "before": (0.05, 0.2),
        "camshaft 1 mm out": (0.5, 0.7),
        "and 10 kN m more": (0.85, 1),
    }
    cases: dict[str, Case] = {}
    traces = {}
    with ThreadPoolExecutor(JOBS) as pool:
        for name, run in kinds.items():
            rows = list(pool.map(run, starts))
            traces[name] = rows[2]
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


def polygon(page: Page, length: Length) -> None:
    """Compare the motion of the driven sprocket with the kinematics of polygons."""
    slow(page, length)
    halves(page, length)
    speeds(page, length)


def slow(page: Page, length: Length) -> None:
    """Turn the crank so slowly that nothing but kinematics is left."""
    speed = 2.0 * RPM
    taut = cd.scenes.marine_two_sprockets().replace({"contact.joints.friction": {"kind": "none"}})
    drives = {
        "four sprockets, 48 to 48 teeth": paper(),
        "two sprockets, 60 to 40, both spans taut": taut,
        "two sprockets, centres 3 mm nearer: one span slack": taut.replace(
            {"sprockets.camshaft.centre": [0.0, 2.7382651], "route.pretension": 0.0}
        ),
    }
    lines = [
        "| drive, crank at 2 r/min | swing of the camshaft at the mesh [µrad] "
        "| closed form [µrad] |",
        "|---|---|---|",
    ]
    for name, drive in drives.items():
        crank, camshaft = drive.resolved().to_dict()["sprockets"][:2]
        distance = float(np.hypot(*np.subtract(crank["centre"], camshaft["centre"])))
        exact = cd.kinematics.polygon_action(crank["teeth"], camshaft["teeth"], PITCH, distance)
        closed = exact["transmission_error"].values[:-1]
        theory = 2.0 * abs(np.fft.fft(closed)[1]) / len(closed)
        moving = drive.replace({"sprockets.crank.motion": {"kind": "constant", "speed": -speed}})
        mesh = crank["teeth"] * speed / (2.0 * np.pi)

        def swing(it: cd.Drive, mesh: float = mesh) -> dict[str, float]:
            run = observe(it, Length(2.0 * length.until, length.run_in), every=1e-3)
            angle = run["sprocket_angle"].sel(sprocket="camshaft").values
            return {"swing": abs(harmonics(run["time"].values, angle, mesh, 3)[0])}

        values = study({name: moving}, swing)[name]["swing"]
        lines.append(f"| {name} | {mean(values, 1e-6)} | {1e6 * theory:.1f} |")
    page.add("slow", "\n".join(lines))


def halves(page: Page, length: Length) -> None:
    """Halve the pitch and double the teeth: a quarter of the chordal action, the same drive."""
    drives = {
        "pitch 88.9 mm, 48 teeth": paper().replace({"guides": []}),
        "pitch 44.45 mm, 96 teeth": half_pitch(),
    }
    columns = {
        "tight_std": ("tight span, std [kN]", 1e3),
        "slack_std": ("tensioner-idler, std [kN]", 1e3),
        **{f"swing {span}": (f"swing of {span}, std [mm]", 1e-3) for span in SPANS},
        "ripple": ("camshaft speed, std [%]", 1e-2),
        "arrival": ("rollers arrive with, median [m/s]", 1.0),
        "contact_p99": ("roller on tooth, 99 % [kN]", 1e3),
        "loss": ("lost [kW]", 1e3),
    }
    page.add("pitch", table(study(drives, partial(measure, length=length)), columns, "chain"))


def speeds(page: Page, length: Length) -> None:
    """Sweep the speed: what the polygon does to camshaft, tension and spans."""
    rounds = np.arange(30.0, 171.0, 20.0)
    drives = {
        f"{n:g}": paper().replace(
            {"sprockets.crank.motion": {"kind": "constant", "speed": -n * RPM}, "guides": []}
        )
        for n in rounds
    }
    cases = study(drives, partial(measure, length=length))
    columns = {
        "ripple": ("camshaft speed, std [%]", 1e-2),
        "tight_std": ("tight span, std [kN]", 1e3),
        **{f"swing {span}": (f"swing of {span}, std [mm]", 1e-3) for span in SPANS},
        "arrival": ("rollers arrive with, median (kinematics) [m/s]", 1.0),
        "loss": ("lost [kW]", 1e3),
    }
    lines = ["| crank [r/min] | " + " | ".join(name for name, _ in columns.values()) + " |"]
    lines.append("|---|" + "---|" * len(columns))
    for name, case in cases.items():
        cells = {key: mean(case[key], unit) for key, (_, unit) in columns.items()}
        exact = cd.kinematics.seating_speed(TEETH, TEETH, PITCH, DISTANCE, float(name) * RPM)
        cells["arrival"] += f" ({exact:.3f})"
        lines.append(f"| {name} | " + " | ".join(cells.values()) + " |")
    page.add("speeds", "\n".join(lines))

    figure, axes = plt.subplots(1, 3, figsize=(13, 4.2), layout="constrained")
    groups = [
        (["ripple"], "camshaft speed, std [%]", 1e-2),
        (["tight_std", "slack_std"], "tension of a span, std [kN]", 1e3),
        ([f"swing {span}" for span in SPANS], "swing of the middle of a span, std [mm]", 1e-3),
    ]
    names = {"tight_std": TIGHT, "slack_std": "tensioner-idler"}
    for axis, (keys, label, unit) in zip(axes, groups, strict=True):
        for key in keys:
            rows = np.array([cases[name][key] for name in drives]) / unit
            name = names.get(key, key.removeprefix("swing "))
            axis.errorbar(rounds, rows.mean(1), np.ptp(rows, axis=1) / 2, capsize=3, label=name)
        axis.set(xlabel="crank speed [r/min]", ylabel=label, ylim=(0, None))
        axis.axvline(SPEED, color="0.7", linestyle=":", zorder=0)
        if len(keys) > 1:
            axis.legend(fontsize="small")
    page.save(figure, "speeds")


def vibration(page: Page, length: Length) -> None:
    """Split longitudinal and transverse vibration by frequency."""
    drive = paper()
    mesh = TEETH * SPEED / 60.0
    starts = [drive.replace({"route.phase": phase}) for phase in PHASES]
    with ThreadPoolExecutor(JOBS) as pool:
        runs = list(pool.map(partial(observe, length=length), starts))
    lines = [
        "| signal | below half the mesh frequency [%] | at the mesh and its multiples, ± 3 Hz [%] "
        "| all else [%] |",
        "|---|---|---|---|",
    ]
    figure, axes = plt.subplots(len(SPANS), 2, figsize=(13, 8), sharex="col", layout="constrained")
    for row, span in enumerate(SPANS):
        tensions = [run["span_tension"].sel(span=span).values for run in runs]
        swings = [offset(drive, span, run) for run in runs]
        string = string_frequencies(drive, span, runs[0], float(np.mean(tensions)))
        kinds = [("tension", tensions, 1e3, "kN"), ("swing", swings, 1e-3, "mm")]
        for column, (kind, signals, unit, name) in enumerate(kinds):
            spectra = [spectrum(signal, EVERY) for signal in signals]
            shares = np.array([bands(*it, mesh) for it in spectra])
            cells = " | ".join(mean(shares[:, k], 1e-2) for k in range(3))
            lines.append(f"| {kind} of {span} | {cells} |")
            axis = axes[row, column]
            level = np.sqrt(np.mean([it[1] ** 2 for it in spectra], axis=0)) / unit
            axis.semilogy(spectra[0][0], level, linewidth=0.8)
            for order in range(1, 5):
                axis.axvline(order * mesh, color="C3", linestyle=":", linewidth=1.0, zorder=0)
            if kind == "swing":
                for number, value in enumerate(string):
                    label = "moving string" if number == 0 else None
                    axis.axvline(value, color="C2", linewidth=0.8, zorder=0, label=label)
                axis.legend(fontsize="small", loc="upper right")
            top = level[spectra[0][0] > 1.0].max()
            widest, deepest = (450.0, 2e-2) if kind == "tension" else (150.0, 3e-3)
            axis.set(xlim=(0.0, widest), ylim=(deepest * top, 2.0 * top))
            axis.set_ylabel(f"{kind} of {span} [{name}]", fontsize=9)
    for axis in axes[-1]:
        axis.set_xlabel("frequency [Hz]")
    axes[0, 0].set_title("longitudinal: dotted the mesh and its multiples")
    axes[0, 1].set_title("transverse: green the modes of a moving string")
    turning = camshaft_mode(drive)
    for axis in axes[:, 0]:
        axis.axvline(
            turning, color="C1", linewidth=0.8, zorder=0, label=f"camshaft turns, {turning:.1f} Hz"
        )
    axes[0, 0].legend(fontsize="small", loc="lower right")
    page.add("vibration", "\n".join(lines))
    page.save(figure, "vibration")


def camshaft_mode(drive: cd.Drive) -> float:
    """Return the frequency of the mode at rest in which the camshaft turns most [Hz]."""
    modes = drive.modes()
    turn = np.abs(modes["sprocket_angle"].sel(sprocket="camshaft"))
    return float(modes["frequency"][int(np.argmax(turn.values))])


def bands(frequency: np.ndarray, amplitude: np.ndarray, mesh: float) -> list[float]:
    """Shares of the variance: below half the mesh frequency, at its multiples, elsewhere."""
    power = amplitude**2
    order = np.round(frequency / mesh)
    at = (order >= 1) & (np.abs(frequency - order * mesh) <= 3.0)
    low = frequency < 0.5 * mesh
    parts = [power[low].sum(), power[at].sum(), power[~low & ~at].sum()]
    return [part / power.sum() for part in parts]


def string_frequencies(drive: cd.Drive, span: str, run: xr.Dataset, tension: float) -> list[float]:
    """First natural frequencies of a string that moves along itself [Hz]."""
    ends, _ = tangent(drive, span, run)
    span_length = np.hypot(*(ends[1] - ends[0]))
    squared = tension * PITCH / MASS  # c² = T/m′
    speed = SPEED * RPM * 0.5 * PITCH / np.sin(np.pi / TEETH)
    # f = n (c² − v²)/(2 ℓ c)
    first = (squared - speed**2) / (2.0 * span_length * np.sqrt(squared))
    return [n * first for n in range(1, 8)]


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


PARTS: Mapping[str, Callable[[Page, Length], None]] = {
    "profile": profiles,
    "guides": guides,
    "centres": centres,
    "polygon": polygon,
    "vibration": vibration,
    "models": models,
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
    page.write()


if __name__ == "__main__":
    main()
