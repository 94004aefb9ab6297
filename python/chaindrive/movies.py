"""Movies of recorded runs: the drive drawn picture by picture, packed by imageio."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from os import PathLike, fspath
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from chaindrive._core import NewFile
from chaindrive.errors import WriteError, tell
from chaindrive.extras import extra
from chaindrive.plot.scheme import CARRIER, FORCE, GUIDE, OUTLINE, PLATES, STEEL
from chaindrive.plot.units import in_trade, written
from chaindrive.pose import drive_of
from chaindrive.progress import told
from chaindrive.results import held

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["PICTURES", "RATE", "SIZE", "movie"]

PICTURES = 250
"""Pictures of a movie unless somebody asks for another number."""
RATE = 25.0
"""Pictures a second."""
SIZE = (1280, 720)
"""Width and height [pixels]; codecs want multiples of 16."""

_Floats = NDArray[np.float64]

# Movies have paper of their own.
_PAPER, _INK = "#fcfcfa", "#1c2733"
_DPI = 100
# Channels by which bodies follow, where they were recorded.
_DRAWN = ("roller_x", "roller_y", "link_tension")
_PLACING = ("sprocket_angle", "sprocket_x", "sprocket_y", "tensioner_position")


def movie(
    run: xr.Dataset,
    path: str | PathLike[str],
    *,
    frames: int = PICTURES,
    rate: float = RATE,
    size: tuple[int, int] = SIZE,
    progress: bool | Callable[[float], object] = False,
) -> Path:
    """Write a movie of a recorded run, in place of what was there.

    Parameters
    ----------
    run
        A run, with the channels that `chaindrive.replay` takes.
    path
        Where to write: ``.mp4`` or ``.gif``.
    frames
        Number of pictures, evenly over the samples of the run.
    rate
        Pictures a second.
    size
        Width and height [pixels].
    progress
        True for a bar with time left, which takes the extra ``progress``, or a function that is
        called with the share done, 0 to 1.

    Returns
    -------
    pathlib.Path

    Raises
    ------
    KeyError
        The channels that the motion takes were not recorded.
    ValueError
        The name ends in something else, or the store of the run is damaged.
    ModuleNotFoundError
        The extra ``movie`` is not installed.
    WriteError
        The file cannot be written; what was in its place is still there.
    """
    place = Path(fspath(path))
    _check(place, frames)
    _write(run, NewFile(place), place.suffix, frames, rate, size, progress)
    return place


def _check(place: Path, frames: int) -> None:
    """Refuse what is no movie, and tell what is missing for one."""
    if frames < 1:
        raise ValueError(f"frames = {frames}, must be 1 or more")
    if place.suffix not in (".mp4", ".gif"):
        raise ValueError(f"{place}: the name must end in .mp4 or .gif")
    extra("imageio.v2", "movies")
    if place.suffix == ".mp4":
        extra("imageio_ffmpeg", "movies in .mp4")


def _write(
    run: xr.Dataset,
    place: NewFile,
    suffix: str,
    frames: int,
    rate: float = RATE,
    size: tuple[int, int] = SIZE,
    progress: bool | Callable[[float], object] = False,
) -> None:
    samples = np.unique(np.linspace(0, run.sizes["time"] - 1, frames).round().astype(int))
    stage = _Stage(run, samples, size)
    with told(progress, "movie") as tell:
        write = _mp4 if suffix == ".mp4" else _gif
        with place as part:
            write(stage.pictures(tell), part, rate)


def _mp4(pictures: Iterator[NDArray[np.uint8]], place: Path, rate: float) -> None:
    # Other presets of the encoder take two to four times as long, for files of half the size.
    how: dict[str, Any] = {"codec": "libx264", "quality": None}
    how["output_params"] = ["-preset", "ultrafast", "-crf", "18"]
    with extra("imageio.v2", "movies").get_writer(place, fps=rate, **how) as writer:
        count = 0
        for picture in pictures:
            writer.append_data(picture)
            count += 1
    # The encoder is another process, and does not tell that the disk was full.
    try:
        found, _ = extra("imageio_ffmpeg", "movies in .mp4").count_frames_and_secs(place)
    except RuntimeError:
        found = 0
    if found != count:
        raise OSError(f"the encoder wrote {found} of {count} pictures: is the disk full?")


def _gif(pictures: Iterator[NDArray[np.uint8]], place: Path, rate: float) -> None:
    from PIL import Image

    # One palette for all, as the first picture has every colour of the scale.
    opaque = (Image.fromarray(picture).convert("RGB") for picture in pictures)
    plain = Image.Dither.NONE
    first = next(opaque).quantize(dither=plain)
    others = (picture.quantize(palette=first, dither=plain) for picture in opaque)
    first.save(place, save_all=True, append_images=others, duration=1e3 / rate, loop=0)


class _Stage:
    """A drive whose parts are drawn once and then moved from picture to picture."""

    def __init__(self, run: xr.Dataset, samples: NDArray[np.int_], size: tuple[int, int]) -> None:
        extra("matplotlib", "movies")
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure

        drive = drive_of(run)
        figure = drive._inner.figure(True, float(run.attrs.get("run_in", 0.0)))
        missing = [name for name in figure.needs if name not in run]
        if missing:
            raise KeyError(f"the movie takes {', '.join(missing)}: simulate(…, record=[…])")
        wanted = [name for name in (*_DRAWN, *_PLACING) if name in run]
        thinned = held(run[wanted].isel(time=samples), drive.name)
        self.times = _floats(thinned["time"])
        given = {name: _floats(thinned[name]) for name in _PLACING if name in thinned}
        self.placements = figure.placements(self.times, given)
        self.rollers = np.stack(
            [_floats(thinned["roller_x"]), _floats(thinned["roller_y"])], axis=2
        )
        known = "link_tension" in thinned
        self.tensions = _floats(thinned["link_tension"]) if known else None
        if self.tensions is not None:
            factor, self.unit = in_trade("N", self.tensions)
            self.tensions = factor * self.tensions
        # The backend is not typed.
        self.canvas: Any = FigureCanvasAgg(
            Figure(
                (size[0] / _DPI, size[1] / _DPI), dpi=_DPI, layout="constrained", facecolor=_PAPER
            )
        )
        self.axes = self.canvas.figure.add_subplot()
        self.axes.set_axis_off()
        self.axes.set_aspect("equal")
        self.axes.set_title(run.attrs.get("title") or drive.name, fontsize=11, color=_INK)
        self.links = _links(figure.chains)
        pitch = min(chain["pitch"] for chain in figure.chains)
        # A tenth of a pixel where a link is 30 pixels long.
        self._draw_bodies(figure.bodies(3e-3 * pitch))
        self._draw_chains(figure.chains)
        self.clock = self.axes.text(0.01, 0.01, "", transform=self.axes.transAxes, color=_INK)
        self._draw_still()

    def _draw_bodies(self, bodies: list[dict[str, Any]]) -> None:
        from matplotlib.colors import to_rgba
        from matplotlib.patches import PathPatch
        from matplotlib.path import Path as Outline

        self.parts: list[tuple[int, Any]] = []
        low, high = self.rollers.min(axis=(0, 1)), self.rollers.max(axis=(0, 1))
        for index, body in enumerate(bodies):
            sprocket = body["kind"] == "sprocket"
            face: dict[str, Any] = {"facecolor": to_rgba(STEEL, 0.35), "edgecolor": OUTLINE}
            face |= {"linewidth": 0.7, "zorder": 2}
            line: dict[str, Any] = {"facecolor": "none"}
            if len(body["backing"]):
                backing = {"facecolor": GUIDE, "edgecolor": "none", "alpha": 0.3, "zorder": 1.4}
                patch = PathPatch(Outline(body["backing"]), **backing)
                self.axes.add_patch(patch)
                self.parts.append((index, patch))
            lines = {"guide": (GUIDE, 1.8), "force": (FORCE, 1.8), "carrier-force": (FORCE, 1.8)}
            colour, width = lines.get(body["kind"], (CARRIER, 2.5))
            line["zorder"] = 6 if colour == FORCE else 1.5
            for outline in body["outlines"]:
                look = face if sprocket else {**line, "edgecolor": colour, "linewidth": width}
                patch = PathPatch(Outline(outline, closed=False), **look)
                self.axes.add_patch(patch)
                self.parts.append((index, patch))
                reach = np.hypot(*outline.T).max() if sprocket else 0.0
                if sprocket:
                    spoke = np.array([[0.0, 0.0], [0.4 * reach, 0.0]])
                    mark = PathPatch(Outline(spoke), edgecolor=OUTLINE, zorder=2.1)
                    self.axes.add_patch(mark)
                    self.parts.append((index, mark))
                for placement in self.placements[[0, len(self.times) // 2, -1], index]:
                    x, y, angle = placement
                    turned = np.array(
                        [[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]]
                    )
                    corners = outline @ turned + (x, y)
                    low = np.minimum(low, corners.min(axis=0))
                    high = np.maximum(high, corners.max(axis=0))
        margin = 0.04 * (high - low).max()
        self.axes.set_xlim(low[0] - margin, high[0] + margin)
        self.axes.set_ylim(low[1] - margin, high[1] + margin)

    def _draw_chains(self, chains: list[dict[str, Any]]) -> None:
        from matplotlib.collections import EllipseCollection, LineCollection

        ends = list(self.rollers[0][self.links])
        self.plates: Any = LineCollection(ends, capstyle="round", zorder=3)
        if self.tensions is None:
            self.plates.set_color(PLATES)
        else:
            self.plates.set(cmap="viridis", alpha=0.85)
            self.plates.set_clim(*np.quantile(self.tensions, [0.001, 0.999]))
            bar = self.canvas.figure.colorbar(self.plates, ax=self.axes, shrink=0.7, panchor=False)
            bar.set_label(written("link tension", self.unit))
        self.axes.add_collection(self.plates)
        # Laid out once: that takes longer than to draw what moves.
        self.canvas.draw()
        self.canvas.figure.set_layout_engine("none")
        # Lines have widths in points: a plate has its height by the scale of the layout.
        corners = self.axes.transData.transform([(0.0, 0.0), (1.0, 0.0)])
        heights = np.repeat([it["plate_height"] for it in chains], [it["links"] for it in chains])
        points = heights * (corners[1, 0] - corners[0, 0]) * 72 / _DPI
        self.plates.set(linewidths=np.maximum(1.5, points))
        diameters = np.repeat(
            [it["roller_diameter"] for it in chains], [it["rollers"] for it in chains]
        )
        self.circles = EllipseCollection(
            diameters,
            diameters,
            np.zeros_like(diameters),
            units="xy",
            offsets=self.rollers[0],
            offset_transform=self.axes.transData,
            facecolors=_PAPER,
            edgecolors=_INK,
            linewidths=0.5,
            zorder=4,
        )
        self.axes.add_collection(self.circles)

    def _draw_still(self) -> None:
        """Draw what stands still, once: titles and scales take longer than all that moves."""
        moving = [*(patch for _, patch in self.parts), self.plates, self.circles, self.clock]
        self.moving = sorted(moving, key=lambda artist: artist.get_zorder())
        for artist in self.moving:
            artist.set_animated(True)
        self.canvas.draw()
        self.still = self.canvas.copy_from_bbox(self.canvas.figure.bbox)

    def pictures(self, tell: Callable[[float], object] | None) -> Iterator[NDArray[np.uint8]]:
        """Draw one picture after the other, and tell the share done."""
        for number in range(len(self.times)):
            yield self.picture(number)
            if tell is not None:
                tell((number + 1) / len(self.times))

    def picture(self, number: int) -> NDArray[np.uint8]:
        """Draw one picture, (height, width, 4), which is valid until the next one."""
        from matplotlib.transforms import Affine2D

        for index, patch in self.parts:
            x, y, angle = self.placements[number, index]
            patch.set_transform(Affine2D().rotate(angle).translate(x, y) + self.axes.transData)
        rollers = self.rollers[number]
        self.plates.set_segments(rollers[self.links])
        if self.tensions is not None:
            self.plates.set_array(self.tensions[number])
        self.circles.set_offsets(rollers)
        self.clock.set_text(f"t = {self.times[number]:.5f} s")
        self.canvas.restore_region(self.still)
        for artist in self.moving:
            self.axes.draw_artist(artist)
        return np.asarray(self.canvas.buffer_rgba())


def _links(chains: list[dict[str, Any]]) -> NDArray[np.int_]:
    """Numbers of both rollers of every link, (links, 2)."""
    first, pairs = 0, []
    for chain in chains:
        link = np.arange(chain["links"])
        pairs.append(first + np.column_stack([link, (link + 1) % chain["rollers"]]))
        first += chain["rollers"]
    return np.concatenate(pairs)


def _floats(values: xr.DataArray) -> _Floats:
    return np.ascontiguousarray(values.to_numpy(), dtype=np.float64)


def _line(share: float) -> None:
    """Show in a terminal how far a movie is, and clear the line at its end."""
    text = f"{share:4.0%} of the movie" if share < 1.0 else "\x1b[K"
    print(f"\r{text}", end="", file=sys.stderr, flush=True)


def command(source: str, output: Path, place: NewFile, *, frames: int | None, quiet: bool) -> int:
    """Make the movie that a command line asks for, and return the exit code."""
    from chaindrive.results import open_result

    shown = _line if sys.stderr.isatty() and not quiet else False
    try:
        number = PICTURES if frames is None else frames
        _check(output, number)
        _write(open_result(source), place, output.suffix, number, progress=shown)
    except WriteError:
        raise
    except (KeyError, ValueError, FileNotFoundError, ModuleNotFoundError) as error:
        message = error.args[0] if isinstance(error, KeyError) else error
        tell(f"{source}: {message}")
        return 2
    if not quiet:
        tell(f"{output}: {output.stat().st_size / 1e6:.2f} MB")
    return 0
