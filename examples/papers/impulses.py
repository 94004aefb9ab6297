"""Impulses on sprockets at mesh orders: real and circular teeth, a tight and a slack chain.

Both papers name noise as the motive. What a model of the drive can tell of it is how its impulses
differ from those of another run, in dB; never what is heard.
"""

from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import xarray as xr
from marine_drive import Length
from matplotlib import pyplot as plt
from replicates import JOBS, Page, half_width, starts

import chaindrive as cd
from chaindrive import analysis

ORDERS = (1.0, 2.0, 3.0)
MARINE = ("crank", "camshaft", "tensioner", "idler")
BICYCLE = ("chainring", "rear")


@dataclass(frozen=True)
class Comparison:
    """Replicates of a drive beside those of its reference, which began alike."""

    title: str
    runs: list[xr.Dataset]
    references: list[xr.Dataset]
    reference: str
    blocks: int

    def levels(self) -> tuple[np.ndarray, list[str], str]:
        """Return levels (replicate, sprocket, order) [dB], the sprockets, and the level's name."""
        found = [
            analysis.impulse_level(
                one, other, name=self.reference, orders=ORDERS, blocks=self.blocks
            )
            for one, other in zip(self.runs, self.references, strict=True)
        ]
        level = found[0]["level"]
        rows = np.array([np.column_stack([it["level"], it["broadband_level"]]) for it in found])
        return rows, [str(name) for name in level["sprocket"].to_numpy()], level.attrs["long_name"]


def circular(drive: cd.Drive, sprockets: tuple[str, ...]) -> cd.Drive:
    return drive.replace({f"sprockets.{name}.tooth": {"kind": "circular"} for name in sprockets})


def record(drive: cd.Drive, length: Length) -> xr.Dataset:
    return cd.simulate(
        drive,
        until=length.until,
        run_in=length.run_in,
        method="auto",
        error=False,
        events=["teeth"],
        record=["sprocket_angle"],
    )


def replicates(drive: cd.Drive, length: Length) -> list[xr.Dataset]:
    with ThreadPoolExecutor(JOBS) as pool:
        return list(pool.map(partial(record, length=length), starts(drive)))


def impulses(page: Page, length: Length) -> None:
    """Draw order spectra and levels of impulses, of real and circular teeth in both drives."""
    # Some seven teeth of the chainring: a second of its links would take a minute.
    short = Length(max(0.1 * length.until, 0.04), 0.08 * length.run_in)
    engine, bicycle = cd.scenes.marine_engine(), cd.scenes.bicycle()
    real, tight = replicates(engine, length), replicates(bicycle, short)
    round_engine = replicates(circular(engine, MARINE), length)
    round_bicycle = replicates(circular(bicycle, BICYCLE), short)
    slack = replicates(cd.scenes.bicycle_slack(), short)
    blocks = 8 if length.until >= 0.5 else 2
    compared = [
        Comparison("`marine_engine`, circular teeth", round_engine, real, "ISO 606, mid", blocks),
        Comparison("`bicycle`, circular teeth", round_bicycle, tight, "ISO 606, mid", 2),
        Comparison("`bicycle_slack`", slack, tight, "`bicycle`, tight", 2),
    ]
    page.add("impulses", levels_of(compared))

    figure, axes = plt.subplots(1, 3, figsize=(14, 4.6), layout="constrained")
    teeth = {"ISO 606, mid": real, "circular": round_engine}
    spectra(axes[0], "marine_engine, crank", "crank", teeth, blocks)
    teeth = {"ISO 606, mid": tight, "circular": round_bicycle, "slack, ISO 606": slack}
    spectra(axes[1], "bicycle, chainring", "chainring", teeth, 2)
    bars(axes[2], compared)
    page.save(figure, "impulses")


SPEED, PULL = 2.0, 500.0  # of the chain [m/s], beside that of the pretension [N]


def equal_sprockets(teeth: int, speed: float = SPEED) -> cd.Drive:
    """Return a chain 08B-1 on two sprockets of so many teeth, at a speed [m/s] and a pull."""
    pitch = 12.7e-3
    radius = 0.5 * pitch / np.sin(np.pi / teeth)
    wheel = {"teeth": teeth, "centre": [0.3, 0.0], "inertia": 0.01}
    load = [{"kind": "constant", "torque": -PULL * radius}]
    motion = {"kind": "constant", "speed": 2.0 * np.pi * speed / (teeth * pitch)}
    move = {"kind": "sprocket", "name": "driven", "direction": [1, 0], "within": "10 mm"}
    return cd.Drive.from_dict(
        {
            "chain": {"type": "08B-1"},
            "sprockets": [
                {"name": "driver", "teeth": teeth, "centre": [0.0, 0.0], "motion": motion},
                {"name": "driven", "load": load} | wheel,
            ],
            "route": {"pretension": "300 N", "adjust": move},
        },
        f"{teeth} and {teeth} teeth",
    )


def teeth_and_speed(page: Page, length: Length) -> None:
    """Hold levels of impulses over the number of teeth and over the speed."""
    short = Length(max(0.3 * length.until, 0.03), 0.4 * length.run_in)
    blocks = 4 if length.until >= 0.5 else 2
    few = replicates(equal_sprockets(17), short)
    compared = [
        Comparison("25 teeth", replicates(equal_sprockets(25), short), few, "17 teeth", blocks),
        Comparison(
            "17 teeth, 4 m/s",
            replicates(equal_sprockets(17, 2.0 * SPEED), short),
            few,
            "2 m/s",
            blocks,
        ),
    ]
    page.add("impulses, teeth and speed", levels_of(compared))


def levels_of(compared: list[Comparison]) -> str:
    """Return a table of levels in Markdown, each with half of its 99 % interval."""
    orders = " | ".join(f"mesh order {order:g} [dB]" for order in ORDERS)
    lines = [f"| run | re | sprocket | {orders} | high orders [dB] |", "|---" * 7 + "|"]
    for one in compared:
        rows, sprockets, _ = one.levels()
        for number, sprocket in enumerate(sprockets):
            cells = " | ".join(cell(five) for five in rows[:, number].T)
            lines.append(f"| {one.title} | {one.reference} | {sprocket} | {cells} |")
    names = [f"- {one.title}: {one.levels()[2]}" for one in compared]
    return "\n".join([*lines, "", *names])


def cell(five: np.ndarray) -> str:
    middle, half = float(five.mean()), half_width(five)
    text = f"{middle:+.1f} ± {half:.1f}"
    return f"**{text}**" if abs(middle) > half else f"≈ ({text})"


def spectra(
    axis: Any, title: str, sprocket: str, runs: Mapping[str, list[xr.Dataset]], blocks: int
) -> None:
    """Draw the amplitude over the order of the mesh, rms over replicates and blocks."""
    for name, five in runs.items():
        found = [analysis.impulse_spectrum(it, blocks=blocks, up_to=6.5) for it in five]
        square = [it["amplitude"].sel(sprocket=sprocket).to_numpy() ** 2 for it in found]
        size = min(len(it) for it in square)
        amplitude = np.sqrt(np.mean([it[:size] for it in square], axis=0))
        axis.semilogy(found[0]["order"][:size], amplitude, linewidth=1.0, label=name)
    axis.set(
        xlabel="order of the mesh", ylabel="amplitude of impulses [N]", title=title, xlim=(0, 6.5)
    )
    axis.legend(fontsize="small")


def bars(axis: Any, compared: list[Comparison]) -> None:
    """Draw the levels with their 99 % intervals, one group a sprocket."""
    ticks, place = [], 0.0
    for number, one in enumerate(compared):
        rows, sprockets, _ = one.levels()
        for row, sprocket in enumerate(sprockets):
            for column, order in enumerate(ORDERS):
                five = rows[:, row, column]
                axis.errorbar(
                    place + 0.22 * (column - 1),
                    five.mean(),
                    half_width(five),
                    fmt="os^"[column],
                    color=f"C{(1, 1, 2)[number]}",
                    capsize=2,
                    markersize=4,
                    label=f"mesh order {order:g}" if place == 0.0 else None,
                )
            told = f"{sprocket}, slack" if number == len(compared) - 1 else sprocket
            ticks.append((place, told))
            place += 1.0
        place += 0.5
    axis.axhline(0.0, color="0.5", linewidth=0.8)
    axis.set_xticks([at for at, _ in ticks], [name for _, name in ticks], rotation=35, ha="right")
    axis.set(
        ylabel="impulse level [dB]",
        title="circular re ISO 606; slack re tight, green",
    )
    axis.legend(fontsize="small")
