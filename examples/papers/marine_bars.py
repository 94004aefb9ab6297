"""Guide bars of the marine drive: what their shape changes, and the spans without them."""

from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import ezdxf
import numpy as np
from marine_drive import (
    EVERY,
    PITCH,
    SPANS,
    Length,
    measure,
    paper,
    touching,
)
from matplotlib import pyplot as plt
from replicates import Case, Page, study, table

import chaindrive as cd
from chaindrive import exchange

CLEAR = 5e-3  # m from the rollers of a straight span to the nearest place of every bar
BARS = ("crank-to-camshaft", "tensioner-to-idler", "idler-to-crank")

Face = Callable[["Line"], dict[str, Any]]


class Line:
    """The straight line of a span as drawn, and places on it and outside of it."""

    def __init__(self, drive: cd.Drive, bar: str) -> None:
        scene = drive.resolved().to_dict()
        self.face = next(it["face"] for it in scene["guides"] if it["name"] == bar)
        sprockets = {it["name"]: it for it in scene["sprockets"]}
        centres = [np.array(sprockets[name]["centre"]) for name in self.face["between"]]
        radii = [
            0.5 * PITCH / np.sin(np.pi / sprockets[name]["teeth"]) for name in self.face["between"]
        ]
        self.ends, self.normal = touching(centres[0], radii[0], centres[1], radii[1])
        self.half = 0.5 * scene["chain"]["roller_diameter"]

    def place(self, share: float, clear: float) -> np.ndarray:
        """Return the place that a straight span's rollers clear by some metres, (2,).

        `share` counts from the end of the bar to which the chain's path comes first.
        """
        first, last = self.face["from"], self.face["to"]
        along = self.ends[0] + (first + share * (last - first)) * (self.ends[1] - self.ends[0])
        return along + (self.half + clear) * self.normal

    @property
    def length(self) -> float:
        """Length of the bar [m]."""
        return float(np.hypot(*(self.place(1.0, 0.0) - self.place(0.0, 0.0))))


def straight(line: Line) -> dict[str, Any]:
    """Return the face of the preset: straight, with ends that curve away."""
    return line.face


def arc(line: Line, radius: float = 10.0) -> dict[str, Any]:
    """Return a face that bulges towards the chain, nearest half-way."""
    crown = line.place(0.5, CLEAR)
    centre = crown + radius * line.normal
    half = np.arcsin(0.5 * line.length / radius)
    towards = float(np.arctan2(*(-line.normal)[::-1]))
    return {
        "kind": "arc",
        "centre": centre.tolist(),
        "radius": radius,
        "from": towards - half,
        "to": towards + half,
    }


def polyline(line: Line) -> dict[str, Any]:
    """Return a flat middle third between two slopes of some 3°, with rounded corners."""
    fall = 0.05 * line.length / 3.0
    corners = [(0.0, CLEAR + fall), (1 / 3, CLEAR), (2 / 3, CLEAR), (1.0, CLEAR + fall)]
    return {
        "kind": "points",
        "points": [line.place(*corner).tolist() for corner in corners],
        "radii": [0.5, 0.5],
        "material": "right",
    }


def drawn(line: Line, sag: float = 3e-3) -> dict[str, Any]:
    """Return a hollow face: a spline of a drawing, as a designer of bars would give it.

    Its middle gives way to the weight of the span; its last tenths curve away from the chain.
    """
    across = np.linspace(-1.0, 1.0, 41)
    inside = np.minimum(np.abs(across) / 0.8, 1.0)
    beyond = np.maximum(np.abs(across) - 0.8, 0.0) / 0.2
    clear = CLEAR + sag * np.cos(0.5 * np.pi * inside) ** 2 + 15e-3 * beyond**2
    places = list(map(line.place, 0.5 + 0.5 * across, clear))
    with TemporaryDirectory() as folder:
        file = Path(folder) / "bar.dxf"
        drawing = ezdxf.new(units=ezdxf.units.MM)
        drawing.modelspace().add_spline([(1e3 * x, 1e3 * y) for x, y in places])
        drawing.saveas(file)
        (curve,) = exchange.read_dxf(file)
    return exchange.face(curve, material="right")


SHAPES: Mapping[str, Face] = {
    "straight, ends curved": straight,
    "arc of 10 m": arc,
    "polyline of three": polyline,
    "drawn, hollow by 3 mm": drawn,
}


def with_bars(drive: cd.Drive, shape: Face) -> cd.Drive:
    """Return a drive whose bars have another shape, as near to the chain as before."""
    faces = {f"guides.{bar}.face": shape(Line(drive, bar)) for bar in BARS}
    return drive.replace(faces)


def shapes(page: Page, length: Length) -> None:
    """Compare shapes of guide bars that are equally near to the chain."""
    length = Length(0.6 * length.until, length.run_in)
    columns = {f"reach {span}": (f"{span} reaches outward [mm]", 1e-3) for span in SPANS} | {
        "tight_std": ("tight span, std [kN]", 1e3),
        "contact_p99": ("roller on tooth, 99 % [kN]", 1e3),
        "blows": ("blows on bars [1/s]", 1.0),
        "blow": ("blow on a bar, 99 % [kN]", 1e3),
        "guide": ("force on bars, mean [N]", 1.0),
    }
    for title, base in (("shapes", paper()), ("shapes, default", cd.scenes.marine_engine())):
        drives = {name: with_bars(base, shape) for name, shape in SHAPES.items()}
        cases = study(drives, partial(measure, length=length))
        page.add(title, table(cases, columns, "guide bars"))

    figure, axis = plt.subplots(figsize=(10, 3.2), layout="constrained")
    drive = paper()
    line = Line(drive, BARS[0])
    along = (line.ends[1] - line.ends[0]) / np.hypot(*(line.ends[1] - line.ends[0]))
    for number, (name, shape) in enumerate(SHAPES.items()):
        (curve,) = exchange.outlines(with_bars(drive, shape).profile(BARS[0], settled=False))
        places = curve.outline(1e-5) - line.place(0.5, 0.0)
        axis.plot(places @ along, 1e3 * places @ line.normal, color=f"C{number}", label=name)
    axis.axhline(0.0, color="black", linestyle="--", linewidth=0.8)
    axis.set(
        xlabel="along the span of crank and camshaft, from the middle of the bar [m]",
        ylabel="from the rollers [mm]",
        title="faces of four bars; dashed: the rollers of a straight span",
        ylim=(-2.0, 40.0),
    )
    axis.legend(fontsize="small", loc="upper center")
    page.save(figure, "shapes")


def spans_between_bars(page: Page, cases: Mapping[str, Mapping[str, Case]]) -> None:
    """Part the swing of spans by frequency, with guide bars and without, by drive."""
    texts = {"slow": "below half the mesh", "fast": "above"}
    columns = {
        f"{band} {span}": (f"{span}, {text} [mm]", 1e-3)
        for span in SPANS
        for band, text in texts.items()
    }
    figure, axes = plt.subplots(len(SPANS), 2, figsize=(13, 7), sharex=True, layout="constrained")
    for column, (drive, several) in enumerate(cases.items()):
        page.add(f"bars and spans, {drive}", table(several, columns, "swing, root mean square"))
        for number, (name, case) in enumerate(several.items()):
            for axis, span in zip(axes[:, column], SPANS, strict=True):
                level = np.sqrt((case[f"level {span}"] ** 2).mean(axis=0))
                frequency = np.fft.rfftfreq(2 * len(level) - 1, EVERY)
                axis.semilogy(frequency, 1e3 * level, color=f"C{number}", label=name)
                axis.set(xlim=(0.0, 60.0), ylim=(3e-4, 3.0))
                axis.set_ylabel(f"{span} [mm]", fontsize=9)
        axes[0, column].set_title(f"swing of the middle of spans, {drive}")
        axes[-1, column].set_xlabel("frequency [Hz]")
    axes[0, 0].legend(fontsize="small")
    page.save(figure, "bars")
