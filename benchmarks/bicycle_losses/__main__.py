"""Write the tables and the diagram of docs/bicycle-losses.md: what a rider's watts lose where.

Run it as ``make bicycle-losses``. It takes some three minutes.
"""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np

import chaindrive as cd

mpl.use("Agg")

DOCS = Path(__file__).resolve().parents[2] / "docs"
CADENCE = 90 * 2 * math.pi / 60
RING = 50
PLACES = ["joints", "offset", "teeth", "bearings", "spans", "tensioners"]


def torque(power: float, cog: int) -> list[dict[str, Any]]:
    """Return the load of the rear wheel that takes a power [W]."""
    return [{"kind": "constant", "torque": power / (CADENCE * RING / cog)}]


def radius(teeth: int) -> float:
    """Return the pitch radius of a sprocket [m]."""
    return 12.7e-3 / (2 * math.sin(math.pi / teeth))


def derailleur(
    power: float = 250.0, cog: int = 17, lateral: float = 5e-3, **changes: Any
) -> cd.Drive:
    """Return the derailleur with another cog, its pulleys in line with it and as far from it."""
    scene = cd.scenes.bicycle_derailleur().resolved().to_dict()
    scene["chain"].pop("links")
    _, wheel, guide, _ = scene["sprockets"]
    down = np.subtract(guide["centre"], wheel["centre"])
    grown = radius(cog) - radius(wheel["teeth"])
    moved = grown * down / np.hypot(*down)
    cage = scene["tensioners"][0]["carrier"]
    for part, key in [*((pulley, "centre") for pulley in scene["sprockets"][2:]), (cage, "pivot")]:
        part[key] = [float(place) for place in np.add(part[key], moved)]
    for aside in scene["sprockets"][1:]:
        aside["lateral"] = lateral
    wheel |= {"teeth": cog, "load": torque(power, cog)}
    return cd.Drive.from_dict(scene).replace(changes)


def two_rings(power: float, teeth: Sequence[int], centres: float, pull: float) -> cd.Drive:
    """Return the chain of the derailleur on two sprockets in line, without pulleys."""
    scene = cd.scenes.bicycle_derailleur().resolved().to_dict()
    scene["chain"].pop("links")
    del scene["tensioners"]
    ring, cog = scene["sprockets"][:2]
    ring["teeth"], cog["teeth"] = teeth
    cog |= {"lateral": 0.0, "centre": [-centres, 0.0]}
    cog["load"] = [{"kind": "constant", "torque": power / (CADENCE * teeth[0] / teeth[1])}]
    scene["sprockets"] = [ring, cog]
    move = {"kind": "sprocket", "name": "cog", "direction": [1, 0], "within": 10e-3}
    scene["route"] = {"pretension": pull, "adjust": move}
    return cd.Drive.from_dict(scene)


def losses(drive: cd.Drive) -> dict[str, float]:
    """Return the mean power [W] that is lost at every place."""
    run = cd.simulate(drive, record=["energy_losses"], error=False)
    lost = run["energy_losses"]
    time = float(lost.time[-1] - lost.time[0])
    mean = (lost.isel(time=-1) - lost.isel(time=0)) / time
    return {str(place): float(mean.sel(place=place)) for place in mean.place.values}


def row(name: str, lost: Mapping[str, float], power: float) -> str:
    """Return a row of a table."""
    whole = sum(lost.values())
    parts = " | ".join(f"{lost[place]:.2f}" for place in PLACES)
    return f"| {name} | {parts} | {whole:.2f} | {100 * whole / (power + whole):.2f} % |"


def write_into(text: str, mark: str, lines: Sequence[str]) -> str:
    """Return the text with lines between the marks of that name."""
    begin, end = f"<!-- {mark}: begin -->", f"<!-- {mark}: end -->"
    before, rest = text.split(begin)
    _, after = rest.split(end)
    return before + "\n".join([begin, "", *lines, "", end]) + after


def main() -> None:
    head = ["| drive | " + " | ".join(PLACES) + " | all [W] | share |", "|---" * 9 + "|"]
    drives = {
        "derailleur, 50 to 17, 5 mm out of line": derailleur(),
        "the same in line": derailleur(lateral=0.0),
        "cross-chained, 50 to 32, 20 mm": derailleur(cog=32, lateral=20e-3),
        "small cog, 50 to 11, 15 mm": derailleur(cog=11, lateral=-15e-3),
        "single speed, 50 to 17, slack side 10 N": two_rings(250.0, [50, 17], 0.41, 10.0),
        "timing chain of a tandem, 40 to 40, 50 N": two_rings(250.0, [40, 40], 0.7, 50.0),
    }
    table = [row(name, losses(drive), 250.0) for name, drive in drives.items()]

    cogs = [11, 13, 15, 17, 19, 21, 25, 28, 32]
    by_cog = [sum(losses(derailleur(cog=cog)).values()) for cog in cogs]
    offsets = np.array([-20, -15, -10, -5, -0.5, 0.5, 5, 10, 15, 20]) * 1e-3
    by_offset = [sum(losses(derailleur(lateral=float(y))).values()) for y in offsets]
    powers = np.array([25, 50, 100, 150, 200, 250, 300, 400])
    of_powers = [losses(derailleur(power=float(power))) for power in powers]
    by_power = [sum(lost.values()) for lost in of_powers]
    slope, intercept = np.polyfit(powers, by_power, 1)
    at_nothing = {
        place: np.polyfit(powers, [lost[place] for lost in of_powers], 1)[1] for place in PLACES
    }
    parts = ", ".join(f"{place} {watts:.3f} W" for place, watts in at_nothing.items())
    line = [
        f"Over the power that comes out, the loss is {intercept:.2f} W + {100 * slope:.2f} %.",
        f"Of the intercept: {parts}.",
    ]

    figure, axes = plt.subplots(1, 3, figsize=(9.6, 3.0), layout="constrained", sharey=False)
    axes[0].plot(cogs, by_cog, "o-")
    axes[0].set(xlabel="teeth of the cog", ylabel="lost of 250 W [W]")
    axes[1].plot(1e3 * offsets, by_offset, "o-")
    axes[1].set(xlabel="out of line [mm]")
    axes[2].plot(powers, by_power, "o")
    axes[2].plot([0, 400], [intercept, intercept + 400 * slope], "-")
    axes[2].set(xlabel="power that comes out [W]", xlim=(0, None))
    for panel, most in zip(axes, [max(by_cog), max(by_offset), max(by_power)], strict=True):
        panel.set_ylim(0, 1.1 * most)
    figure.savefig(DOCS / "bicycle-losses.png", dpi=110)

    page = DOCS / "bicycle-losses.md"
    text = write_into(page.read_text(encoding="utf-8"), "places", [*head, *table])
    page.write_text(write_into(text, "power", line), encoding="utf-8")


if __name__ == "__main__":
    main()
