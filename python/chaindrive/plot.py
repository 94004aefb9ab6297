"""Plots: a drive, its chain at an instant, tensions over time, work against precision.

Needs the extra ``plot`` (matplotlib). Every function draws into the axes it is given, or into
new ones, and returns them; nothing is shown or saved.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from chaindrive.drive import Drive, _from_text
from chaindrive.extras import extra

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["frame", "layout", "tension", "work_precision"]

_STEEL = "#8d99a6"
_OUTLINE = "#3c4650"
_CHAIN = "#1f4e79"
_GUIDE = "#b5651d"


def layout(
    drive: Drive, *, ax: Axes | None = None, names: bool = True, settled: bool = True
) -> Axes:
    """Draw a drive as it stands at the start: teeth, rollers, links and guides to scale.

    Parameters
    ----------
    drive
        What to draw.
    ax
        Where to draw; new axes when absent.
    names
        Whether to write the names of sprockets and guides.
    settled
        Whether the chain hangs and stretches as in static equilibrium, or lies as it was laid
        (which also shows drives that do not settle).

    Returns
    -------
    matplotlib.axes.Axes

    Raises
    ------
    AssemblyError
        The drive does not close, or settle if asked to.
    """
    drawing = drive._inner.drawing(settled)
    ax = _axes(ax)
    rollers = [chain["rollers"] for chain in drawing["chains"]]
    for chain, places in zip(drawing["chains"], rollers, strict=True):
        _links(ax, places, closed=chain["closed"])
    centres = {name: wheel["centre"] for name, wheel in drawing["sprockets"].items()}
    _bodies(ax, drawing, rollers, centres, names=names)
    ax.set_title(drive.title)
    return _finish(ax)


def frame(
    run: xr.Dataset, time: float, *, ax: Axes | None = None, drive: Drive | None = None
) -> Axes:
    """Draw a recorded drive at an instant, links coloured by their tension if it was recorded.

    Parameters
    ----------
    run
        A run with the channels ``roller_x`` and ``roller_y``; with ``sprocket_x`` and
        ``sprocket_y`` if sprockets move, with ``link_tension`` for colour.
    time
        When [s]; the nearest sample is taken.
    ax
        Where to draw; new axes when absent.
    drive
        What was run; read from the attribute ``scene`` of the run when absent.

    Returns
    -------
    matplotlib.axes.Axes

    Raises
    ------
    KeyError
        The roller positions were not recorded.
    """
    for name in ("roller_x", "roller_y"):
        if name not in run:
            raise KeyError(f"{name} was not recorded: simulate(…, record=[…, {name!r}])")
    drive = drive or _from_text(run.attrs["scene"], run.attrs.get("scene_name", "scene"))
    drawing = drive._inner.drawing(False)
    now = run.sel(time=time, method="nearest")
    places = np.column_stack([now["roller_x"].to_numpy(), now["roller_y"].to_numpy()])
    ends = np.cumsum([len(chain["rollers"]) for chain in drawing["chains"]])
    rollers = np.split(places, ends[:-1])
    centres = {name: wheel["centre"] for name, wheel in drawing["sprockets"].items()}
    if "sprocket_x" in now and "sprocket_y" in now:
        for name in centres:
            place = now.sel(sprocket=name)
            centres[name] = np.array([float(place["sprocket_x"]), float(place["sprocket_y"])])
    ax = _axes(ax)
    tensions = now["link_tension"].to_numpy() if "link_tension" in now else None
    _recorded_links(ax, drawing["chains"], rollers, tensions)
    _bodies(ax, drawing, rollers, centres, names=False)
    ax.set_title(f"t = {float(now['time']):.4g} s")
    return _finish(ax)


def tension(run: xr.Dataset, *, ax: Axes | None = None) -> Axes:
    """Draw span tensions over time, or link tensions where spans were not recorded.

    Parameters
    ----------
    run
        A run with the channel ``span_tension`` or ``link_tension``.
    ax
        Where to draw; new axes when absent.

    Returns
    -------
    matplotlib.axes.Axes

    Raises
    ------
    KeyError
        Neither was recorded.
    """
    name = next((name for name in ("span_tension", "link_tension") if name in run), None)
    if name is None:
        raise KeyError("neither span_tension nor link_tension was recorded")
    ax = _axes(ax)
    values = run[name]
    dim = str(values.dims[1])
    for label in values[dim].to_numpy():
        ax.plot(values["time"], values.sel({dim: label}), label=str(label), linewidth=0.8)
    ax.set_xlabel("time [s]")
    ax.set_ylabel(f"{dim} tension [N]")
    if values.sizes[dim] <= 12:
        ax.legend(fontsize="small")
    ax.margins(x=0)
    return ax


def work_precision(table: xr.Dataset, *, ax: Axes | None = None, cost: str = "wall") -> Axes:
    """Draw error against cost, both logarithmic, one line a method and onset depth.

    Parameters
    ----------
    table
        What `chaindrive.work_precision` returned.
    ax
        Where to draw; new axes when absent.
    cost
        Column for the abscissa: ``"wall"``, ``"cpu"`` or ``"evaluations"``.

    Returns
    -------
    matplotlib.axes.Axes
    """
    ax = _axes(ax)
    error = table["error_tight_span_tension"]
    methods = table["method"].values.astype(str)
    depths = table["onset_depth"].values
    names = [
        name if np.isnan(depth) else f"{name}, onset {depth:.0e} m"
        for name, depth in zip(methods, depths, strict=True)
    ]
    for name in dict.fromkeys(names):
        rows = np.array([other == name for other in names]) & np.isfinite(error.values)
        if rows.any():
            order = np.argsort(table[cost].values[rows])
            ax.plot(table[cost].values[rows][order], error.values[rows][order], "o-", label=name)
    agreement = table.attrs.get("agreement_tight_tension", 0.0)
    if agreement > 0.0:
        ax.axhline(agreement, color=_STEEL, linestyle=":", label="reference and check apart")
    unit = table[cost].attrs["units"]
    ax.set_xlabel(table[cost].attrs["long_name"] + ("" if unit == "1" else f" [{unit}]"))
    ax.set_ylabel("error of the tight span, rms [–]")
    ax.set_xscale("log")
    ax.set_yscale("log")
    ax.set_title(table.attrs.get("title", ""))
    ax.legend()
    return ax


def _axes(ax: Axes | None) -> Axes:
    if ax is not None:
        return ax
    _, ax = extra("matplotlib.pyplot", "plots").subplots(layout="constrained")
    return cast("Axes", ax)


def _finish(ax: Axes) -> Axes:
    ax.set_aspect("equal")
    ax.set_xlabel("x [m]")
    ax.set_ylabel("y [m]")
    ax.autoscale_view()
    return ax


_LOOK: dict[str, Any] = {"linewidths": 2.5, "capstyle": "round", "zorder": 5}


def _segments(rollers: NDArray[np.float64], *, closed: bool) -> NDArray[np.float64]:
    path = np.concatenate([rollers, rollers[:1]]) if closed else rollers
    return np.stack([path[:-1], path[1:]], axis=1)


def _links(ax: Axes, rollers: NDArray[np.float64], *, closed: bool) -> None:
    from matplotlib.collections import LineCollection

    segments = _segments(rollers, closed=closed)
    ax.add_collection(LineCollection(list(segments), colors=_CHAIN, **_LOOK))


def _recorded_links(
    ax: Axes,
    chains: list[dict[str, Any]],
    rollers: list[NDArray[np.float64]],
    tensions: NDArray[np.float64] | None,
) -> None:
    """Draw all chains with one scale of colours, where tensions are known."""
    from matplotlib.collections import LineCollection

    pairs = list(zip(chains, rollers, strict=True))
    if tensions is None:
        for chain, places in pairs:
            _links(ax, places, closed=chain["closed"])
        return
    segments = np.concatenate([_segments(it, closed=chain["closed"]) for chain, it in pairs])
    links = LineCollection(list(segments), array=tensions, cmap="viridis", **_LOOK)
    ax.add_collection(links)
    ax.figure.colorbar(links, ax=ax, label="link tension [N]", shrink=0.8)


def _bodies(
    ax: Axes,
    drawing: dict[str, Any],
    rollers: list[NDArray[np.float64]],
    centres: dict[str, NDArray[np.float64]],
    *,
    names: bool,
) -> None:
    from matplotlib.collections import PatchCollection
    from matplotlib.patches import Circle, Polygon

    chains = list(zip(drawing["chains"], rollers, strict=True))
    named: list[NDArray[np.float64]] = []
    for name, wheel in drawing["sprockets"].items():
        centre = centres[name]
        turn = 0.0
        for chain, places in chains:
            if name in chain["sprockets"]:
                turn = _turn(places, centre, wheel, chain["pitch"])
        rotation = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
        outline = centre + wheel["outline"] @ rotation
        ax.add_patch(Polygon(outline, facecolor=_STEEL, edgecolor=_OUTLINE, alpha=0.6, lw=0.6))
        ax.plot(*centre, "+", color=_OUTLINE, markersize=6)
        if names:
            # Names of sprockets on one axis stand above each other.
            above = sum(bool(np.hypot(*(centre - other)) < 1e-6) for other in named)
            named.append(centre)
            ax.annotate(
                name,
                (centre[0], centre[1]),
                xytext=(0, 6 + 9 * above),
                textcoords="offset points",
                ha="center",
                fontsize=8,
            )
    for name, face in drawing["guides"].items():
        ax.plot(face[:, 0], face[:, 1], color=_GUIDE, linewidth=2.0, zorder=2)
        if names:
            # Halfway along the face, on the side away from the loop.
            length = np.insert(np.cumsum(np.hypot(*np.diff(face, axis=0).T)), 0, 0.0)
            x, y = (float(np.interp(0.5 * length[-1], length, axis)) for axis in face.T)
            right = x > np.concatenate(rollers)[:, 0].mean()
            ax.annotate(
                name,
                (x, y),
                xytext=(10 if right else -10, 0),
                textcoords="offset points",
                color=_GUIDE,
                fontsize=7,
                ha="left" if right else "right",
                va="center",
            )
    for chain, places in chains:
        radius = 0.5 * chain["roller_diameter"]
        circles = PatchCollection([Circle((x, y), radius) for x, y in places], zorder=4)
        circles.set(facecolor="white", edgecolor=_OUTLINE, linewidth=0.5)
        ax.add_collection(circles)


def _turn(
    rollers: NDArray[np.float64],
    centre: NDArray[np.float64],
    wheel: dict[str, Any],
    pitch: float,
) -> float:
    """Angle by which an outline is turned so that its gaps meet the rollers seated in them."""
    x, y = (rollers - centre).T
    seated = np.abs(np.hypot(x, y) - wheel["pitch_radius"]) < 0.02 * pitch
    if not seated.any():
        return 0.0
    # The outline has a gap on its y axis; the mean phase of the rollers within a tooth decides.
    phases = np.exp(1j * wheel["teeth"] * (np.arctan2(y, x)[seated] - 0.5 * np.pi))
    return float(np.angle(phases.mean()) / wheel["teeth"])


def __dir__() -> list[str]:
    return list(__all__)
