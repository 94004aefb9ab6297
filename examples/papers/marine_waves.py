"""Polygon effect and vibration of the marine drive: tables and figures of the paper's page."""

from concurrent.futures import ThreadPoolExecutor
from functools import partial

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
    measure,
    observe,
    offset,
    paper,
    tangent,
)
from matplotlib import pyplot as plt
from replicates import JOBS, Page, harmonics, mean, spectrum, starts, study, table

import chaindrive as cd

DISTANCE = 2.4725  # m, of crank and camshaft


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
    with ThreadPoolExecutor(JOBS) as pool:
        runs = list(pool.map(partial(observe, length=length), starts(drive)))
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
