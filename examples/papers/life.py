"""Wear and load cycles of a drive over its life: the drive new, and worn by steps of elongation.

Archard's law gives the rate at which a drive wears its joints; a worn drive is run anew and has
another. So the life is the integral of both, t = ∫ dε/ε′(ε), and not the limit over the first rate.
"""

from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np
import xarray as xr
from marine_drive import Length
from matplotlib import pyplot as plt
from replicates import JOBS, Case, Page, p99, starts, table

import chaindrive as cd
from chaindrive import analysis

CHANNELS = [
    "link_tension",
    "span_tension",
    "contact_force",
    "roller_x",
    "roller_y",
    "sprocket_angle",
    "sprocket_x",
    "sprocket_y",
]
PER_HOURS = 1000.0


@dataclass(frozen=True)
class Life:
    """A drive over its life, and what its page calls things."""

    title: str
    states: Mapping[float, cd.Drive]
    """The drive by the elongation of its chain [–], from new to worn out."""
    length: Length
    every: float
    unit: tuple[str, float]
    """Of forces: its name, and how many newtons it has."""
    other: Mapping[str, tuple[cd.Drive, Length, Sequence[str]]] = field(default_factory=dict)
    """Neighbours of the new drive with channels that they have: wear alone is measured."""


def measure_life(
    drive: cd.Drive, length: Length, every: float, channels: Sequence[str] = ()
) -> tuple[dict[str, float], xr.Dataset]:
    """Return the figures of one run, and the run."""
    run = cd.simulate(
        drive,
        until=length.until,
        run_in=length.run_in,
        every=every,
        error=False,
        record=[*CHANNELS, *channels],
    )
    wear, work = analysis.wear(run), analysis.joint_work(run)
    cycles = analysis.rainflow(run)
    around = float(cycles.attrs["circuits"])
    whole = around >= 1.0
    return {
        # ε′ = h′/p
        "rate": float(wear["depth_rate"].mean()) / float(wear.attrs["pitch"]) * PER_HOURS,
        "limit": float(wear["wear_limit"]),
        "power": float(work["friction_work"].sum()) / float(work.attrs["seconds"]),
        "tight": float(run["span_tension"][:, 0].mean()),
        "contact_p99": p99(run["contact_force"].values),
        "largest": float(cycles["largest_range"].mean()) if whole else np.nan,
        "equivalent": float(cycles["equivalent_range"]) if whole else np.nan,
        "cycles": float(cycles["cycles"].sum()) / around if whole else np.nan,
    }, run


def life(page: Page, name: str, of: Life) -> None:
    """Write the table of a life and draw it: elongation over hours, cycles, tension around."""
    unit, newtons = of.unit
    columns = {
        "rate": (f"elongation in {PER_HOURS:.0f} h [%]", 1e-2),
        "power": ("friction of joints [W]", 1.0),
        "tight": (f"tight span, mean [{unit}]", newtons),
        "contact_p99": (f"roller on tooth, 99 % [{unit}]", newtons),
        "largest": (f"largest cycle of a link [{unit}]", newtons),
        "equivalent": (f"… equivalent, once a circuit [{unit}]", newtons),
        "cycles": ("cycles a circuit", 1.0),
    }
    cases: dict[str, Case] = {}
    runs: dict[float, xr.Dataset] = {}
    with ThreadPoolExecutor(JOBS) as pool:
        for elongation, drive in of.states.items():
            one = partial(measure_life, length=of.length, every=of.every)
            five = list(pool.map(one, starts(drive)))
            label = f"worn by {100.0 * elongation:g} %" if elongation else "new"
            cases[label] = gathered([figures for figures, _ in five])
            runs[elongation] = five[-1][1]
        for label, (drive, length, channels) in of.other.items():
            one = partial(measure_life, length=length, every=of.every, channels=channels)
            cases[label] = gathered([figures for figures, _ in pool.map(one, starts(drive))])
    worn = np.array(list(of.states))
    rates = np.array([case["rate"].mean() for case in list(cases.values())[: len(worn)]])
    grown = np.linspace(0.0, worn[-1], 401)
    hours = over_life(grown, np.interp(grown, worn, rates / PER_HOURS))
    told = (
        f"{100.0 * worn[-1]:g} % of elongation after {hours[-1]:.0f} h; at the rate of the new "
        f"drive after {worn[-1] / rates[0] * PER_HOURS:.0f} h."
    )
    page.add(name, table(cases, columns, of.title) + "\n\n" + told)
    figure, axes = plt.subplots(1, 3, figsize=(14, 4.4), layout="constrained")
    draw_growth(axes[0], grown, hours, rates[0] / PER_HOURS)
    for number, (elongation, run) in enumerate(runs.items()):
        label = f"worn by {100.0 * elongation:g} %" if elongation else "new"
        counted = analysis.rainflow(run)
        ranges = counted["tension_range"] / newtons
        per_circuit = counted["exceedances"] / counted.attrs["circuits"]
        axes[1].semilogy(ranges, per_circuit, color=f"C{number}", label=label)
        loop = analysis.tension_around_loop(run, per_pitch=1)
        axes[2].plot(
            loop["station"], loop["tension_mean"] / newtons, color=f"C{number}", linewidth=0.9
        )
    axes[1].set(
        xlabel=f"range of a cycle [{unit}]",
        ylabel="cycles a circuit of at least this range",
        title="load cycles of a link",
    )
    axes[1].legend(fontsize="small")
    axes[2].set(
        xlabel="place on the loop [pitches]",
        ylabel=f"tension, mean [{unit}]",
        title="tension around the loop",
    )
    page.save(figure, name)


def over_life(elongations: np.ndarray, rates: np.ndarray) -> np.ndarray:
    """Return the hours to every elongation, of the rates [1/h] there."""
    slowness = 1.0 / rates
    # t = ∫ dε/ε′(ε)
    hours = 0.5 * (slowness[1:] + slowness[:-1]) * np.diff(elongations)
    return np.concatenate([[0.0], np.cumsum(hours)])


def draw_growth(axis: Any, grown: np.ndarray, hours: np.ndarray, first: float) -> None:
    """Draw the elongation over hours with the band of the wear coefficient."""
    band = analysis.elongation.BAND
    axis.fill_betweenx(100.0 * grown, hours / band, hours * band, color="C0", alpha=0.15)
    axis.plot(hours, 100.0 * grown, color="C0", label="as the worn drive wears")
    axis.plot(grown / first, 100.0 * grown, "--", color="C3", label="at the rate of the new one")
    axis.set(
        xscale="log",
        xlim=(hours[-1] / band / 10.0, hours[-1] * band),
        ylim=(0.0, None),
        xlabel="hours of steady running",
        ylabel="elongation [%]",
        title=f"shaded: coefficient of wear {band:g} times higher, lower",
    )
    axis.legend(fontsize="small", loc="upper left")


def gathered(rows: Sequence[Mapping[str, float]]) -> Case:
    return {key: np.array([row[key] for row in rows]) for key in rows[0]}
