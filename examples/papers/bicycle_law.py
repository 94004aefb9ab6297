"""The cylindrical law over radii and clearances beside Johnson's: error and cost."""

import timeit
from collections.abc import Callable

import numpy as np
from marine_drive import Length
from matplotlib import colors
from matplotlib import pyplot as plt
from replicates import Page

import chaindrive as cd

MODULUS = 113.736263736e9  # steel on steel [Pa]
WIDTH = 10e-3  # length of the contact [m]; no error depends on it
# Radii of two cylinders side by side [mm]: their sums reach from 4 to 300 mm, the range of the law.
OUTSIDE = [
    (2, 2),
    (0.5, 3.5),
    (3.9, 18.6),
    (11.25, 11.25),
    (1, 21.5),
    (50, 50),
    (10, 90),
    (150, 150),
]
# Radius of a pin and clearance of its hole [mm]: 0.005 to 10 mm, the range of the law.
INSIDE = [(2, 0.005), (2, 0.025), (10, 0.025), (2, 0.1), (10, 0.5), (50, 2), (50, 10)]
ROLLER, PIN = "side by side, radii", "in a hole, radius and clearance"

Make = Callable[[str], cd.Law]


def outside(first: float, second: float) -> Make:
    """Return the laws between two cylinders side by side, by their radii [mm]."""
    return lambda kind: cd.law(
        kind, radius=1e-3 * first, other=1e-3 * second, length=WIDTH, modulus=MODULUS
    )


def inside(pin: float, clearance: float) -> Make:
    """Return the laws of a pin in a hole, by its radius and the clearance [mm]."""
    return lambda kind: cd.law(
        kind, hole=1e-3 * (pin + clearance), pin=1e-3 * pin, length=WIDTH, modulus=MODULUS
    )


def error(make: Make, depth: np.ndarray) -> np.ndarray:
    """Return the force of the cylindrical law over that of Johnson's, less one."""
    return make("cylindrical").force(depth) / make("johnson").force(depth) - 1.0


def depths(clearance: float) -> np.ndarray:
    """Return depths at which a contact of this clearance [m] is compared [m].

    From 0.3 to 30 µm, inside to a tenth of the clearance at most: beyond Johnson's law ends.
    """
    return np.geomspace(min(3e-7, 0.01 * clearance), min(3e-5, 0.1 * clearance), 200)


def cost(law: cd.Law, depth: np.ndarray) -> float:
    """Return the time of a force and its slope, the least of twenty-five goes [ns]."""
    rate = np.zeros_like(depth)
    goes = timeit.repeat(lambda: law.respond(depth, rate), number=1, repeat=25)
    return 1e9 * min(goes) / depth.size


def law(page: Page, length: Length) -> None:
    """Hold the cylindrical law against Johnson's over radii and clearances."""
    size = 20_000 if length.until >= 0.05 else 2_000
    lines = [
        "| cylinders [mm] | clearance or sum of radii [mm] | error, mean [%] "
        "| least and greatest [%] | cylindrical [ns] | johnson [ns] |",
        "|---|---|---|---|---|---|",
    ]
    rows = [(f"{ROLLER} {a:g} and {b:g}", a + b, outside(a, b), 1.0) for a, b in OUTSIDE]
    rows += [
        (f"{PIN} {pin:g} and {play:g}", play, inside(pin, play), 1e-3 * play)
        for pin, play in INSIDE
    ]
    for name, across, make, clearance in rows:
        found = 100.0 * error(make, depths(clearance))
        many = np.resize(depths(clearance), size)
        dear = [cost(make(kind), many) for kind in ("cylindrical", "johnson")]
        lines.append(
            f"| {name} | {across:g} | {np.abs(found).mean():.1f} "
            f"| {found.min():+.1f}, {found.max():+.1f} | {dear[0]:.0f} | {dear[1]:.0f} |"
        )
    page.add("cylinders", "\n".join(lines))

    figure, axes = plt.subplots(1, 2, figsize=(12, 4.4), layout="constrained")
    scale = colors.TwoSlopeNorm(0.0, -30.0, 30.0)
    depth = np.geomspace(1e-7, 1e-4, 120)
    panels = [
        (axes[0], np.geomspace(4.0, 300.0, 80), lambda it: outside(it / 2, it / 2), "sum of radii"),
        (axes[1], np.geomspace(5e-3, 10.0, 80), lambda it: inside(10.0, it), "clearance"),
    ]
    for axis, across, make, name in panels:
        map_of = np.array([100.0 * error(make(it), depth) for it in across]).T
        if name == "clearance":
            map_of = np.where(depth[:, None] <= 0.3e-3 * across, map_of, np.nan)
        filled = axis.pcolormesh(
            across, 1e6 * depth, map_of, cmap="RdBu_r", norm=scale, rasterized=True
        )
        lines_of = axis.contour(
            across, 1e6 * depth, map_of, levels=[-15, -5, 0, 5, 15], colors="black", linewidths=0.6
        )
        axis.clabel(lines_of, fontsize=8)
        axis.set(xscale="log", yscale="log", xlabel=f"{name} [mm]", ylabel="indentation [µm]")
    axes[0].set_title("two cylinders side by side")
    axes[1].set_title("a pin in a hole, to 0.3 of the clearance")
    figure.colorbar(filled, ax=axes, label="force of `cylindrical` over Johnson's, less one [%]")
    page.save(figure, "cylinders")
