"""Signals and modes of a run: spectra, orders, Campbell diagrams, transmission, spans."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from chaindrive import analysis
from chaindrive.errors import ParameterError
from chaindrive.plot.axes import colour_bar, drawing, legend_below
from chaindrive.plot.docstrings import completed
from chaindrive.plot.scheme import CURVES, LIMIT, STEEL
from chaindrive.plot.source import (
    analysed,
    driven_of,
    driver_of,
    is_run,
    mesh_order_of,
    span_of,
    tightest_span,
    turns_of,
)
from chaindrive.plot.units import in_trade, written

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = [
    "campbell",
    "order_map",
    "order_slice",
    "running_modes",
    "span_envelope",
    "span_motion",
    "spectrum",
    "speed_ripple",
    "transmission_error",
]

_RPM = 60.0 / (2.0 * np.pi)
# Amplitudes below this share of the largest are drawn in the darkest colour.
_FLOOR_DB = -60.0
# Share of an axis that an upright line of text takes.
_LETTER = 0.022


@completed()
def spectrum(
    source: xr.Dataset | xr.DataArray,
    channel: str | xr.DataArray | None = None,
    *,
    ax: Axes | None = None,
    up_to: float | None = None,
    **options: Any,
) -> Axes:
    """Draw a spectrum, its amplitude logarithmic; one line a label where there are several.

    Lines of an order spectrum that are known from the scene have names.

    Parameters
    ----------
    source
        A run, or what `chaindrive.analysis.spectrum` or `order_spectrum` returned.
    channel
        Of a run, the channel or a signal over time; ``"span_tension"`` when absent.
    up_to
        Highest frequency [Hz] or order; all when absent.
    **options
        Of a run, passed on to `chaindrive.analysis.spectrum`.

    Raises
    ------
    ParameterError
        The channel was not recorded, or has no labels in this drive; or the analysis refuses it.
    """
    holds = "order" if not is_run(source) and "order" in source.coords else "frequency"
    chosen = {"channel": channel, **options}
    spread = analysed(source, analysis.spectrum, holds, chosen, {"channel": _span_tension})
    with drawing(ax) as ax:
        axis = str(spread.dims[-1])
        # The mean has been taken off: the line at zero says nothing.
        shown = spread.sel({axis: slice(float(spread[axis][1]), up_to)})
        others = [str(dim) for dim in spread.dims[:-1]]
        rows = shown.stack(row=others) if others else shown.expand_dims("row")
        factor, unit = in_trade(spread.attrs.get("units", "1"), shown)
        for row in rows.transpose("row", axis):
            name = ", ".join(str(row[dim].item()) for dim in others)
            ax.semilogy(shown[axis], factor * row, linewidth=0.8, label=name)
        if others and rows.sizes["row"] <= 12:
            legend_below(ax)
        about = shown[axis].attrs
        ax.set_xlabel(written(about.get("long_name", axis), about.get("units", "1")))
        ax.set_ylabel(written(spread.attrs.get("long_name", str(spread.name)), unit))
        ax.margins(x=0)
        if axis == "order":
            _name_lines(ax, spread.attrs, float(shown[axis][0]), float(shown[axis][-1]))
    return ax


@completed(run="A run in which the speed changes")
def order_map(
    source: xr.Dataset | xr.DataArray,
    channel: str | xr.DataArray | None = None,
    shaft: str | None = None,
    *,
    ax: Axes | None = None,
    up_to: float | None = None,
    **options: Any,
) -> Axes:
    """Draw an order map: order against speed, amplitude as colour in decibels.

    Parameters
    ----------
    channel
        Of a run, the channel or a signal over time; the tension of the tightest span when absent.
    shaft
        Of a run, the sprocket or shaft whose turns count; the driver when absent.
    up_to
        Highest order; when absent two and a half times the mesh order for a run, else all.

    Raises
    ------
    ParameterError
        The speed does not change; a channel was not recorded; or the analysis refuses the run.
    """
    chosen = {"channel": channel, "shaft": shaft, **options}
    usual = {**_TIGHTEST, "turns": lambda run: turns_of(run, shaft or driver_of(run))}
    found = analysed(source, analysis.order_map, "turn", chosen, usual)
    if up_to is None and isinstance(source, xr.Dataset):
        up_to = 2.5 * mesh_order_of(source, found.attrs["shaft"])
    shown = found.sel(order=slice(None, up_to))
    with drawing(ax) as ax:
        _map(ax, _RPM * shown["speed"].to_numpy(), shown["order"].to_numpy(), shown)
        ax.set_xlabel(f"speed of {found.attrs['shaft']} [rpm]")
        ax.set_ylabel(f"order of {found.attrs['shaft']} [–]")
    return ax


@completed()
def order_slice(
    source: xr.Dataset, order: float | None = None, *, ax: Axes | None = None, **look: Any
) -> Axes:
    """Draw the amplitude of one order against speed.

    Parameters
    ----------
    source
        A run in which the speed changes, of which the tension of the tightest span is drawn by
        orders of the driver; or what `chaindrive.analysis.order_slice` returned.
    order
        Of a run, the order; that of the driver's teeth when absent.
    **look
        Passed on to `matplotlib.axes.Axes.plot`.

    Raises
    ------
    ParameterError
        The speed does not change; a channel was not recorded; or the analysis refuses the run.
    """

    def order_slice(run: xr.Dataset, order: float) -> xr.Dataset:
        shaft = driver_of(run)
        turns = turns_of(run, shaft)
        found = analysis.order_map(run, tightest_span(run), shaft, turns=turns)
        _changing(found["speed"].to_numpy())
        return analysis.order_slice(found, order)

    usual = {"order": lambda run: mesh_order_of(run, driver_of(run))}
    cut = analysed(source, order_slice, "amplitude", {"order": order}, usual)
    with drawing(ax) as ax:
        about = cut["amplitude"].attrs
        style: dict[str, Any] = {"label": _named_order(about, about["order"])} | look
        factor, unit = in_trade(about.get("units", "1"), cut["amplitude"])
        ax.plot(_RPM * cut["speed"], factor * cut["amplitude"], **style)
        ax.set_xlabel(f"speed of {about['shaft']} [rpm]")
        ax.set_ylabel(written(about.get("long_name", "amplitude"), unit))
        ax.set_ylim(bottom=0.0)
        ax.margins(x=0)
        legend_below(ax)
    return ax


@completed(run="A run in which the speed changes")
def campbell(
    source: xr.Dataset,
    channel: str | xr.DataArray | None = None,
    shaft: str | None = None,
    *,
    ax: Axes | None = None,
    **options: Any,
) -> Axes:
    """Draw a Campbell diagram: frequency against speed, with orders and running modes.

    Parameters
    ----------
    channel
        Of a run, the channel or a signal over time; the tension of the tightest span when absent.
    shaft
        Of a run, the sprocket or shaft whose speed is the abscissa; the driver when absent.

    Raises
    ------
    ParameterError
        The speed does not change; a channel was not recorded; or the analysis refuses the run.
    """
    chosen = {"channel": channel, "shaft": shaft, **options}
    found = analysed(source, analysis.campbell, "order_frequency", chosen, _TIGHTEST)
    with drawing(ax) as ax:
        speed = _RPM * found["speed"].to_numpy()
        frequency = found["frequency"].to_numpy()
        _map(ax, speed, frequency, found["amplitude"])
        for order in found["order"].to_numpy():
            line = found["order_frequency"].sel(order=order).to_numpy()
            within = line <= frequency[-1]
            if not within.any():
                continue
            ax.plot(speed, line, color="white", linewidth=0.8, linestyle="--")
            last = int(np.flatnonzero(within)[np.argmax(speed[within])])
            high = line[last] > 0.5 * frequency[-1]
            ax.annotate(
                _named_order(found.attrs, order).removeprefix("order "),
                (speed[last], line[last]),
                xytext=(-2, -9 if high else 3),
                textcoords="offset points",
                ha="right",
                va="top" if high else "bottom",
                color="white",
                fontsize=8,
            )
        ax.plot([], [], color=LIMIT, linewidth=0.8, linestyle="--", label="orders, white")
        if "mode_frequency" in found:
            at = _RPM * found["mode_speed"].to_numpy()
            lines = found["mode_frequency"].transpose("mode_speed", "mode").to_numpy()
            ax.plot(at, lines, color=CURVES[1], linewidth=0.8)
            ax.plot([], [], color=CURVES[1], linewidth=0.8, label="running modes")
        ax.set_xlim(float(speed.min()), float(speed.max()))
        ax.set_ylim(0.0, float(frequency[-1]))
        ax.set_xlabel(f"speed of {found.attrs['shaft']} [rpm]")
        ax.set_ylabel("frequency [Hz]")
        legend_below(ax)
    return ax


@completed()
def running_modes(source: xr.Dataset, *, ax: Axes | None = None, **options: Any) -> Axes:
    """Draw the frequencies of the running drive against speed, coloured by where they live.

    Parameters
    ----------
    source
        A run, or what `chaindrive.analysis.running_modes` returned, best of several speeds.
    """
    modes = analysed(source, analysis.running_modes, "growth", options, {"shaft": driver_of})
    with drawing(ax) as ax:
        parts = modes["part"].to_numpy()
        main = modes["share"].fillna(0.0).argmax("part").to_numpy()
        speed = _RPM * np.broadcast_to(modes["speed"].to_numpy()[:, None], main.shape)
        frequency = modes["frequency"].transpose("speed", "mode").to_numpy()
        ax.plot(speed, frequency, color=STEEL, linewidth=0.6, alpha=0.5, zorder=1)
        for i, part in enumerate(parts):
            here = (main == i) & np.isfinite(frequency)
            if here.any():
                ax.plot(speed[here], frequency[here], "o", markersize=4, label=str(part))
        ax.set_xlabel(f"speed of {modes.attrs['shaft']} [rpm]")
        ax.set_ylabel("frequency [Hz]")
        ax.set_ylim(bottom=0.0)
        legend_below(ax, "most energy in")
    return ax


@completed()
def transmission_error(
    source: xr.Dataset,
    driver: str | None = None,
    driven: str | None = None,
    *,
    ax: Axes | None = None,
    **options: Any,
) -> Axes:
    """Draw a transmission error over time, and the range of the kinematic one.

    Parameters
    ----------
    driver, driven
        Of a run, sprockets of one chain; the first whose motion is given and the first under a
        load when absent.
    """
    chosen = {"driver": driver, "driven": driven, **options}
    usual = {"driver": driver_of, "driven": lambda run: driven_of(run, driver)}
    found = analysed(source, analysis.transmission_error, "error", chosen, usual)
    with drawing(ax) as ax:
        about = found.attrs
        ax.plot(found["time"], np.degrees(found["error"]), linewidth=0.8, label="dynamic")
        if np.isfinite(about["kinematic_range"]):
            half = 0.5 * np.degrees(about["kinematic_range"])
            look: dict[str, Any] = {"color": CURVES[1], "alpha": 0.4}
            ax.axhspan(-half, half, label="range of the polygon action", **look)
        ax.set_xlabel("time [s]")
        ax.set_ylabel("transmission error [°]")
        ax.set_title(f"{about['driver']} to {about['driven']}")
        ax.margins(x=0)
        legend_below(ax)
    return ax


@completed()
def speed_ripple(source: xr.Dataset, *, ax: Axes | None = None, **options: Any) -> Axes:
    """Draw the irregularity and the ripple of every sprocket's speed.

    Raises
    ------
    ParameterError
        No sprocket turns; or the speeds were not recorded.
    """
    found = analysed(source, analysis.speed_ripple, "irregularity", options)
    # What stands in the mean has no ripple over its mean speed.
    turning = found.isel(sprocket=np.flatnonzero(np.isfinite(found["irregularity"])))
    if turning.sizes["sprocket"] == 0:
        raise ParameterError("no sprocket turns during the run: there is no ripple", "sprocket")
    with drawing(ax) as ax:
        names = [str(name) for name in turning["sprocket"].to_numpy()]
        at = np.arange(len(names))
        ax.bar(at - 0.2, 100 * turning["irregularity"], 0.4, label="peak to peak")
        ax.bar(at + 0.2, 100 * turning["rms_ripple"], 0.4, label="rms")
        ax.set_xticks(at, names)
        ax.set_ylabel("ripple over mean speed [%]")
        legend_below(ax)
    return ax


@completed()
def span_motion(
    source: xr.Dataset | xr.DataArray,
    span: str | None = None,
    *,
    ax: Axes | None = None,
    **options: Any,
) -> Axes:
    """Draw the excursion of a span at fixed points over time.

    Parameters
    ----------
    span
        Of a run, the span; the longest when absent.
    """
    chosen = {"span": span, **options}
    motion = analysed(source, analysis.span_motion, "place", chosen, {"span": span_of})
    with drawing(ax) as ax:
        rows = motion if "place" in motion.dims else motion.expand_dims("place")
        for row in rows.transpose("place", "time"):
            place = f"at {float(row['place']):.3g} of its length"
            ax.plot(row["time"], 1e3 * row, linewidth=0.8, label=place)
        ax.set_xlabel("time [s]")
        ax.set_ylabel(f"excursion of {motion['span'].item()} [mm]")
        ax.margins(x=0)
        legend_below(ax)
    return ax


@completed()
def span_envelope(
    source: xr.Dataset, span: str | None = None, *, ax: Axes | None = None, **options: Any
) -> Axes:
    """Draw how far a span swings along its length.

    Parameters
    ----------
    span
        Of a run, the span; the longest when absent.
    """
    chosen = {"span": span, **options}
    envelope = analysed(source, analysis.span_envelope, "distance", chosen, {"span": span_of})
    with drawing(ax) as ax:
        x = 1e3 * envelope["distance"]
        ends = (1e3 * envelope["least"], 1e3 * envelope["greatest"])
        mean, rms = 1e3 * envelope["mean"], 1e3 * envelope["rms"]
        ax.fill_between(x, *ends, color=CURVES[0], alpha=0.25, label="least to greatest")
        ax.fill_between(x, mean - rms, mean + rms, color=CURVES[0], alpha=0.5, label="mean ± rms")
        ax.plot(x, mean, color=CURVES[0], label="mean")
        ax.axhline(0.0, color=LIMIT, linewidth=0.6)
        ax.set_xlabel(f"{envelope['distance'].attrs['long_name']} [mm]")
        ax.set_ylabel("excursion [mm]")
        ax.margins(x=0)
        legend_below(ax)
    return ax


def _span_tension(run: xr.Dataset) -> str:
    tightest_span(run)
    return "span_tension"


def _name_lines(ax: Axes, about: Mapping[str, Any], least: float, greatest: float) -> None:
    """Name the orders of an axis that are known; those that stand too near share a text."""
    known = zip(about.get("named_orders", ()), about.get("order_names", ()), strict=True)
    groups: list[list[tuple[float, str]]] = []
    for order, name in known:
        if not least <= order <= greatest:
            continue
        if groups and order - groups[-1][0][0] < _LETTER * (greatest - least):
            groups[-1].append((order, name))
        else:
            groups.append([(order, name)])
    for group in groups:
        for order, _ in group:
            ax.axvline(order, color=LIMIT, linewidth=0.5, linestyle=":", zorder=0.5)
        ax.annotate(
            "; ".join(f"{order:.4g} {name}" for order, name in group),
            (group[0][0], 1.0),
            xycoords=("data", "axes fraction"),
            xytext=(1, -2),
            textcoords="offset points",
            rotation=90,
            ha="left",
            va="top",
            fontsize=6,
            color=LIMIT,
        )


def _named_order(about: Mapping[str, Any], order: float) -> str:
    """Return an order in words, with its name where it has one."""
    known = zip(about.get("named_orders", ()), about.get("order_names", ()), strict=True)
    name = next((f", {name}" for it, name in known if np.isclose(it, order, rtol=1e-6)), "")
    return f"order {order:g}{name}"


# The signal and the shaft of orders, where nobody names them.
_TIGHTEST = {"channel": tightest_span, "shaft": driver_of}


def _changing(speed: Any) -> None:
    """Raise where the speed is one."""
    if np.ptp(speed) < 1e-3 * np.abs(speed).max():
        raise ParameterError("the speed does not change in this run: draw its spectrum", "source")


def _map(ax: Axes, x: Any, y: Any, amplitude: xr.DataArray) -> None:
    """Draw amplitudes (x, y) in decibels of the largest, in the order of x."""
    _changing(x)
    values = amplitude.to_numpy().T
    if len(values) < 2:
        raise ParameterError("the run is too short for any frequency but zero: simulate longer")
    # At the ends of a ramp windows follow each other at one speed.
    order = np.argsort(x)
    order = order[np.insert(np.diff(x[order]) > 1e-6 * np.ptp(x), 0, True)]
    x, values = x[order], values[:, order]
    # The line at zero holds what is left of the mean.
    largest = float(values[1:].max())
    decibels = 20.0 * np.log10(np.maximum(values / largest, 10.0 ** (_FLOOR_DB / 20.0)))
    mesh = ax.pcolormesh(
        x, y, decibels, vmin=_FLOOR_DB, vmax=0.0, shading="nearest", rasterized=True
    )
    factor, unit = in_trade(amplitude.attrs["units"], largest)
    ax.set_title(amplitude.attrs["long_name"])
    colour_bar(ax, mesh, f"amplitude [dB re {factor * largest:.3g} {unit}]")
