"""A drive as it stands at an instant: bodies, rollers and plates to scale."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from chaindrive.drive import Drive
from chaindrive.plot.axes import colour_bar, drawing
from chaindrive.plot.docstrings import completed
from chaindrive.plot.scheme import CARRIER, FORCE, GUIDE, INK, MARK, OUTLINE, PLATES, STEEL
from chaindrive.plot.units import in_trade, written
from chaindrive.pose import Pose, drive_of, figure_of, recorded_at

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

    from chaindrive import _core

_Floats = NDArray[np.float64]

# Chords of drawn outlines stand off by less than a hundredth of what can be seen in a drive of a
# metre on a thousand pixels.
_TOLERANCE = 1e-5
# Drives are drawn in millimetres.
_MM = 1e3
# Height of names, and their mean width in it [points].
_LETTER = 8.0
_WIDTH = 0.6

__all__ = ["frame", "layout", "svg"]


@completed()
def layout(
    drive: Drive | xr.Dataset,
    *,
    ax: Axes | None = None,
    names: bool = True,
    settled: bool = True,
) -> Axes:
    """Draw a drive as it stands at the start: teeth, rollers, plates, guides and tensioners.

    All outlines are those that the simulation touches, in their places. The material behind
    guides, the carriers of tensioners and the waists of plates have no shape in a scene; they
    are drawn for the eye. Arrows show which way sprockets turn, by their mean speeds or those at
    the start; what stands still has none.

    Parameters
    ----------
    drive
        What to draw: a drive, or a run for its drive.
    names
        Whether to write the names of sprockets and guides.
    settled
        Whether the chain hangs and stretches as in static equilibrium, or lies as it was laid
        (which also shows drives that do not settle).

    Notes
    -----
    A drive that does not assemble is drawn as it is laid, with the reason below the title. A chain
    that does not close is laid from the first stop of its route as far as it reaches, and its gap
    marked; parts in each other's way are marked with the depth of their overlap.
    """
    drive = drive if isinstance(drive, Drive) else drive_of(drive)
    figure = drive._inner.figure(settled, 0.0)
    with drawing(ax) as ax:
        _Picture(ax, figure, Pose(**figure.start())).draw(names=names)
        ax.set_title(textwrap.fill(drive.title, 60))
        if figure.problem is not None:
            told = textwrap.fill(figure.problem, 90)
            look: dict[str, Any] = {"color": MARK, "fontsize": 8, "ha": "center", "va": "bottom"}
            ax.text(0.5, 1.0, told, transform=ax.transAxes, **look)
            ax.set_title(textwrap.fill(drive.title, 60), pad=14.0 + 11.0 * told.count("\n"))
    return ax


@completed()
def frame(
    run: xr.Dataset, time: float, *, ax: Axes | None = None, drive: Drive | None = None
) -> Axes:
    """Draw a recorded drive at an instant, links coloured by their tension if it was recorded.

    Parameters
    ----------
    run
        A run with the channels ``roller_x``, ``roller_y`` and ``sprocket_angle``; with
        ``tensioner_position`` if there are tensioners, with ``sprocket_x`` and ``sprocket_y`` if
        centres stand on springs; with ``link_tension`` for colour.
    time
        When [s]; the nearest sample is taken.
    drive
        What was run; read from the attribute ``scene`` of the run when absent.

    Raises
    ------
    ParameterError
        A channel that places something was not recorded.
    """
    figure = figure_of(run, drive)
    sample = recorded_at(figure, run, time)
    now = run.sel(time=time, method="nearest")
    tensions = now["link_tension"].to_numpy() if "link_tension" in now else None
    with drawing(ax) as ax:
        _Picture(ax, figure, Pose(**figure.pose(**sample)), tensions).draw(names=False)
        ax.set_title(f"t = {sample['time']:.4g} s")
    return ax


def svg(run: xr.Dataset, time: float, *, drive: Drive | None = None) -> str:
    """Return a recorded drive at an instant as the text of an SVG file.

    Coordinates are millimetres of the drive, x to the right and y upwards. Every part has an
    ``id``, such as ``sprocket-crank``, ``guide-shoe``, ``roller-17`` or ``plate-17``. `Drive.svg`
    draws the start.

    Parameters
    ----------
    run
        A run with the channels that `frame` takes.
    time
        When [s]; the nearest sample is taken.
    drive
        What was run; read from the attribute ``scene`` of the run when absent.

    Raises
    ------
    ParameterError
        A channel that places something was not recorded.
    """
    figure = figure_of(run, drive)
    sample = recorded_at(figure, run, time)
    title = f"{run.attrs.get('title', '')}, t = {sample['time']:.4g} s".removeprefix(", ")
    return figure.svg(title, **sample)


class _Picture:
    """A pose drawn into axes."""

    def __init__(
        self,
        ax: Axes,
        figure: _core.Figure,
        pose: Pose,
        tensions: _Floats | None = None,
    ) -> None:
        self.ax = ax
        self.figure = figure
        self.bodies = figure.bodies(_TOLERANCE)
        self.chains = figure.chains
        self.placements = [it * (_MM, _MM, 1.0) for it in pose.placements]
        self.rollers = [_MM * it for it in pose.rollers]
        self.plates = [_MM * it for it in pose.plates]
        self.tensions = tensions

    def draw(self, *, names: bool) -> None:
        for body, placement in zip(self.bodies, self.placements, strict=True):
            self._body(body, placement)
        self._chains()
        self._marks()
        self.ax.set_aspect("equal")
        self.ax.set_xlabel("x [mm]")
        self.ax.set_ylabel("y [mm]")
        self.ax.autoscale_view()
        if names:
            self._names()

    def _body(self, body: dict[str, Any], placement: _Floats) -> None:
        from matplotlib.patches import Polygon

        outlines = [_placed(outline, placement) for outline in body["outlines"]]
        x, y, _ = placement
        if body["kind"] == "sprocket":
            self.ax.add_patch(Polygon(outlines[0], zorder=2, **_steel(0.6)))
            # The spoke shows how far the sprocket has turned.
            spoke = _placed(np.array([[0.0, 0.0], [0.0, 0.4 * body["pitch_radius"]]]), placement)
            self.ax.plot(*spoke.T, color=OUTLINE, linewidth=0.8, zorder=2.1)
            self.ax.plot(x, y, "o", color=OUTLINE, markersize=2.5, zorder=2.1)
            for part in body["arrow"] or ():
                upright = _placed(part, np.array([x, y, 0.0]))
                self.ax.plot(*upright.T, color=INK, linewidth=1.4, zorder=2.2, label="_rotation")
        elif body["kind"] == "guide":
            backing = _placed(body["backing"], placement)
            face: dict[str, Any] = {"facecolor": GUIDE, "edgecolor": "none", "alpha": 0.45}
            self.ax.add_patch(Polygon(backing, zorder=1.5, **face))
            self.ax.plot(*outlines[0].T, color=GUIDE, linewidth=1.0, zorder=3)
        elif body["kind"] in ("force", "carrier-force"):
            for outline in outlines:
                self.ax.plot(*outline.T, color=FORCE, linewidth=1.6, zorder=6, label="_force")
        else:
            wide = 1.5 if body["kind"] == "plunger" else 3.0
            look: dict[str, Any] = {"color": CARRIER, "linewidth": wide, "solid_capstyle": "round"}
            for outline in outlines:
                self.ax.plot(*outline.T, zorder=1.4, alpha=0.7, **look)
            if body["kind"] == "arm":
                self.ax.plot(x, y, "o", color=CARRIER, markersize=5, zorder=3.1)

    def _chains(self) -> None:
        from matplotlib.collections import PatchCollection, PolyCollection
        from matplotlib.patches import Circle

        shapes: list[_Floats] = []
        for chain, ends in zip(self.chains, self.plates, strict=True):
            shapes.extend(_plates(chain["plate"], ends))
        look: dict[str, Any] = {"edgecolors": OUTLINE, "linewidths": 0.4, "zorder": 4}
        if self.tensions is not None and len(self.tensions) == len(shapes):
            factor, unit = in_trade("N", self.tensions)
            plates = PolyCollection(shapes, array=factor * self.tensions, cmap="viridis", **look)
            colour_bar(self.ax, plates, written("link tension", unit))
        else:
            plates = PolyCollection(shapes, facecolors=PLATES, **look)
        # Teeth behind the plates are what one looks for.
        plates.set_alpha(0.5)
        self.ax.add_collection(plates)
        for chain, places in zip(self.chains, self.rollers, strict=True):
            radius = _MM * 0.5 * chain["roller_diameter"]
            circles = PatchCollection([Circle((x, y), radius) for x, y in places], zorder=3.5)
            circles.set(**_steel(0.5))
            self.ax.add_collection(circles)
            # Rollers lie between the plates; their rims are seen all the same.
            rims = PatchCollection([Circle((x, y), radius) for x, y in places], zorder=5)
            rims.set(facecolor="none", edgecolor=OUTLINE, linewidth=0.4, alpha=0.8)
            self.ax.add_collection(rims)

    def _marks(self) -> None:
        """Mark gaps and clashes with their sizes."""
        clashes = [(x, y, f"{1e3 * depth:.1f} mm") for x, y, depth, _ in self.figure.clashes]
        gaps = [(x, y, told) for x, y, _, told in self.figure.gaps]
        for x, y, told in clashes + gaps:
            look: dict[str, Any] = {
                "mfc": "none",
                "mec": MARK,
                "mew": 1.5,
                "markersize": 16,
                "zorder": 7,
            }
            self.ax.plot(_MM * x, _MM * y, "o", **look)
            self.ax.annotate(
                told,
                (_MM * x, _MM * y),
                xytext=(0, 11),
                textcoords="offset points",
                ha="center",
                fontsize=8,
                color=MARK,
                zorder=7,
            )

    def _names(self) -> None:
        """Write the names of sprockets and guides; one that would lie on another stands above."""
        places = [*self.rollers, *(it[None, :2] for it in self.placements)]
        middle = np.concatenate(places)[:, 0].mean()
        written: list[tuple[float, float, float]] = []
        scale = _points_per_unit(self.ax)
        for body, placement in zip(self.bodies, self.placements, strict=True):
            x, y, _ = placement
            wide = _WIDTH * _LETTER * len(body["name"])
            right: bool | None = None
            if body["kind"] == "sprocket" and wide > 1.3 * scale * _MM * body["pitch_radius"]:
                # Beside the sprocket and its chain, away from the middle of the drive.
                right = x > middle
                plates = max((0.5 * it["plate_height"] for it in self.chains), default=0.0)
                x += (1 if right else -1) * _MM * (body["pitch_radius"] + plates)
            elif body["kind"] == "guide":
                # Halfway along the face, on the side away from the loop.
                face = _placed(body["outlines"][0], placement)
                length = np.insert(np.cumsum(np.hypot(*np.diff(face, axis=0).T)), 0, 0.0)
                x, y = (float(np.interp(0.5 * length[-1], length, axis)) for axis in face.T)
                right = x > middle
            elif body["kind"] != "sprocket":
                continue
            aside, above = {None: (0.0, 6.0), True: (10.0, 0.0), False: (-10.0, 0.0)}[right]
            left = scale * x + aside - {None: 0.5, True: 0.0, False: 1.0}[right] * wide
            base = scale * y + above
            line = 1.3 * _LETTER
            while other := next(
                (
                    it
                    for it in written
                    if it[0] < left + wide and left < it[1] and abs(it[2] - base) < 0.99 * line
                ),
                None,
            ):
                base = other[2] + line
            written.append((left, left + wide, base))
            low, high = self.ax.get_xlim()
            self.ax.set_xlim(min(low, left / scale), max(high, (left + wide) / scale))
            self.ax.annotate(
                body["name"],
                (x, y),
                xytext=(aside, base - scale * y),
                textcoords="offset points",
                fontsize=_LETTER,
                ha={None: "center", True: "left", False: "right"}[right],
                va="baseline" if right is None else "center",
                color=GUIDE if body["kind"] == "guide" else None,
                zorder=6,
            )


def _steel(linewidth: float) -> dict[str, Any]:
    """Return the looks of what is of steel: its face lets the paper through."""
    from matplotlib.colors import to_rgba

    return {"facecolor": to_rgba(STEEL, 0.2), "edgecolor": OUTLINE, "linewidth": linewidth}


def _points_per_unit(ax: Axes) -> float:
    """Return how many points a unit of the data takes, about, once the axes are drawn."""
    (left, right), (low, high) = ax.get_xlim(), ax.get_ylim()
    box = ax.get_window_extent()
    pixels = min(box.width / (right - left), box.height / (high - low))
    figure = ax.get_figure()
    return float(pixels * 72.0 / (figure.dpi if figure is not None else 72.0))


def _placed(points: _Floats, placement: _Floats) -> _Floats:
    """Put points of a body (points, 2) [m] where its placement (3,) [mm, rad] has them [mm]."""
    x, y, angle = placement
    turned = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    placed: _Floats = _MM * points @ turned + (x, y)
    return placed


def _plates(halves: tuple[_Floats, _Floats], ends: _Floats) -> list[_Floats]:
    """Put the outline of a plate, in two halves seen from their ends, at every link (links, 4)."""
    shapes = []
    for x0, y0, x1, y1 in ends:
        angle = np.arctan2(y1 - y0, x1 - x0)
        first = _placed(halves[0], np.array([x0, y0, angle]))
        second = _placed(halves[1], np.array([x1, y1, angle]))
        shapes.append(np.concatenate([first, second]))
    return shapes
