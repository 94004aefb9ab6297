"""Plots of signals and modes: spectra, orders, Campbell diagrams, transmission, spans."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from chaindrive.errors import ParameterError
from chaindrive.plot.axes import given_or_new

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


def __dir__() -> list[str]:
    return list(__all__)


def spectrum(spread: xr.DataArray, *, ax: Axes | None = None, up_to: float | None = None) -> Axes:
    """Draw a spectrum, its amplitude logarithmic; one line a label where there are several.

    Parameters
    ----------
    spread
        What `chaindrive.analysis.spectrum` or `order_spectrum` returned.
    ax
        Where to draw; new axes when absent.
    up_to
        Highest frequency [Hz] or order; all when absent.

    Returns
    -------
    matplotlib.axes.Axes
    """
    ax = given_or_new(ax)
    axis = str(spread.dims[-1])
    # The mean has been taken off: the line at zero says nothing.
    shown = spread.sel({axis: slice(float(spread[axis][1]), up_to)})
    others = [str(dim) for dim in spread.dims[:-1]]
    rows = shown.stack(row=others) if others else shown.expand_dims("row")
    for row in rows.transpose("row", axis):
        name = ", ".join(str(row[dim].item()) for dim in others)
        ax.semilogy(shown[axis], row, linewidth=0.8, label=name)
    if others and rows.sizes["row"] <= 12:
        # Above the lines: peaks may stand anywhere.
        ax.legend(fontsize="small", loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=3)
    ax.set_xlabel(_label(shown[axis]))
    ax.set_ylabel(_label(spread))
    ax.margins(x=0)
    return ax


def order_map(found: xr.DataArray, *, ax: Axes | None = None, up_to: float | None = None) -> Axes:
    """Draw an order map: order against speed, amplitude as colour in decibels.

    Parameters
    ----------
    found
        What `chaindrive.analysis.order_map` returned.
    ax
        Where to draw; new axes when absent.
    up_to
        Highest order; all when absent.

    Returns
    -------
    matplotlib.axes.Axes
    """
    ax = given_or_new(ax)
    shown = found.sel(order=slice(None, up_to))
    _map(ax, _RPM * shown["speed"].to_numpy(), shown["order"].to_numpy(), shown)
    ax.set_xlabel(f"speed of {found.attrs['shaft']} [rpm]")
    ax.set_ylabel(f"order of {found.attrs['shaft']} [–]")
    return ax


def order_slice(cut: xr.Dataset, *, ax: Axes | None = None, **look: Any) -> Axes:
    """Draw the amplitude of one order against speed.

    Parameters
    ----------
    cut
        What `chaindrive.analysis.order_slice` returned.
    ax
        Where to draw; new axes when absent.
    **look
        Passed on to `matplotlib.axes.Axes.plot`.

    Returns
    -------
    matplotlib.axes.Axes
    """
    ax = given_or_new(ax)
    about = cut["amplitude"].attrs
    style: dict[str, Any] = {"label": f"order {about['order']:g}", "linewidth": 1.2} | look
    ax.plot(_RPM * cut["speed"], cut["amplitude"], **style)
    ax.set_xlabel(f"speed of {about['shaft']} [rpm]")
    ax.set_ylabel(_label(cut["amplitude"]))
    ax.set_ylim(bottom=0.0)
    ax.margins(x=0)
    ax.legend(fontsize="small")
    return ax


def campbell(found: xr.Dataset, *, ax: Axes | None = None) -> Axes:
    """Draw a Campbell diagram: frequency against speed, with orders and running modes.

    Parameters
    ----------
    found
        What `chaindrive.analysis.campbell` returned.
    ax
        Where to draw; new axes when absent.

    Returns
    -------
    matplotlib.axes.Axes
    """
    ax = given_or_new(ax)
    speed = _RPM * found["speed"].to_numpy()
    frequency = found["frequency"].to_numpy()
    _map(ax, speed, frequency, found["amplitude"])
    for order in found["order"].to_numpy():
        line = found["order_frequency"].sel(order=order).to_numpy()
        ax.plot(speed, line, color="white", linewidth=0.8, linestyle="--")
        last = int(np.flatnonzero(line <= frequency[-1])[np.argmax(speed[line <= frequency[-1]])])
        ax.annotate(
            f"{order:g}",
            (speed[last], line[last]),
            xytext=(-2, -9 if line[last] > 0.5 * frequency[-1] else 3),
            textcoords="offset points",
            ha="right",
            va="top" if line[last] > 0.5 * frequency[-1] else "bottom",
            color="white",
            fontsize=8,
        )
    if "mode_frequency" in found:
        at = _RPM * found["mode_speed"].to_numpy()
        lines = found["mode_frequency"].transpose("mode_speed", "mode").to_numpy()
        ax.plot(at, lines, color="#ff8c42", linewidth=0.8, alpha=0.8)
        ax.plot([], [], color="#ff8c42", linewidth=0.7, label="running modes")
        ax.plot([], [], color="grey", linewidth=0.8, linestyle="--", label="orders")
        ax.legend(fontsize="small", loc="upper left")
    ax.set_xlim(float(speed.min()), float(speed.max()))
    ax.set_ylim(0.0, float(frequency[-1]))
    ax.set_xlabel(f"speed of {found.attrs['shaft']} [rpm]")
    ax.set_ylabel("frequency [Hz]")
    return ax


def running_modes(modes: xr.Dataset, *, ax: Axes | None = None) -> Axes:
    """Draw the frequencies of the running drive against speed, coloured by where they live.

    Parameters
    ----------
    modes
        What `chaindrive.analysis.running_modes` returned, of several speeds.
    ax
        Where to draw; new axes when absent.

    Returns
    -------
    matplotlib.axes.Axes
    """
    ax = given_or_new(ax)
    parts = modes["part"].to_numpy()
    main = modes["share"].fillna(0.0).argmax("part").to_numpy()
    speed = _RPM * np.broadcast_to(modes["speed"].to_numpy()[:, None], main.shape)
    frequency = modes["frequency"].transpose("speed", "mode").to_numpy()
    ax.plot(speed, frequency, color="#c4cad0", linewidth=0.6, zorder=1)
    for i, part in enumerate(parts):
        here = (main == i) & np.isfinite(frequency)
        if here.any():
            ax.plot(speed[here], frequency[here], "o", markersize=4, label=str(part))
    ax.set_xlabel(f"speed of {modes.attrs['shaft']} [rpm]")
    ax.set_ylabel("frequency [Hz]")
    ax.set_ylim(bottom=0.0)
    ax.legend(
        fontsize="small", title="most energy in", loc="center left", bbox_to_anchor=(1.0, 0.5)
    )
    return ax


def transmission_error(found: xr.Dataset, *, ax: Axes | None = None) -> Axes:
    """Draw a transmission error over time, and the range of the kinematic one.

    Parameters
    ----------
    found
        What `chaindrive.analysis.transmission_error` returned.
    ax
        Where to draw; new axes when absent.

    Returns
    -------
    matplotlib.axes.Axes
    """
    ax = given_or_new(ax)
    about = found.attrs
    ax.plot(found["time"], 1e3 * found["error"], linewidth=0.8, label="dynamic")
    if np.isfinite(about["kinematic_range"]):
        half = 0.5e3 * about["kinematic_range"]
        ax.axhspan(-half, half, color="#b5651d", alpha=0.4, label="range of the polygon action")
    ax.legend(fontsize="small", loc="upper right")
    ax.set_xlabel("time [s]")
    ax.set_ylabel("transmission error [mrad]")
    ax.set_title(f"{about['driver']} to {about['driven']}")
    ax.margins(x=0)
    return ax


def speed_ripple(found: xr.Dataset, *, ax: Axes | None = None) -> Axes:
    """Draw the irregularity and the ripple of every sprocket's speed.

    Parameters
    ----------
    found
        What `chaindrive.analysis.speed_ripple` returned.
    ax
        Where to draw; new axes when absent.

    Returns
    -------
    matplotlib.axes.Axes
    """
    ax = given_or_new(ax)
    names = found["sprocket"].to_numpy().astype(str)
    at = np.arange(names.size)
    ax.bar(at - 0.2, 100 * found["irregularity"], 0.4, label="peak to peak")
    ax.bar(at + 0.2, 100 * found["rms_ripple"], 0.4, label="rms")
    ax.set_xticks(at, names)
    ax.set_ylabel("ripple over mean speed [%]")
    ax.legend(fontsize="small")
    return ax


def span_motion(motion: xr.DataArray, *, ax: Axes | None = None) -> Axes:
    """Draw the excursion of a span at fixed points over time.

    Parameters
    ----------
    motion
        What `chaindrive.analysis.span_motion` returned.
    ax
        Where to draw; new axes when absent.

    Returns
    -------
    matplotlib.axes.Axes
    """
    ax = given_or_new(ax)
    rows = motion if "place" in motion.dims else motion.expand_dims("place")
    for row in rows.transpose("place", "time"):
        ax.plot(row["time"], 1e3 * row, linewidth=0.8, label=f"at {float(row['place']):.3g}")
    ax.set_xlabel("time [s]")
    ax.set_ylabel(f"excursion of {motion['span'].item()} [mm]")
    ax.legend(fontsize="small", title="share of length", loc="upper right")
    ax.margins(x=0)
    return ax


def span_envelope(envelope: xr.Dataset, *, ax: Axes | None = None) -> Axes:
    """Draw how far a span swings along its length.

    Parameters
    ----------
    envelope
        What `chaindrive.analysis.span_envelope` returned.
    ax
        Where to draw; new axes when absent.

    Returns
    -------
    matplotlib.axes.Axes
    """
    ax = given_or_new(ax)
    x = envelope["distance"]
    ax.fill_between(
        x,
        1e3 * envelope["least"],
        1e3 * envelope["greatest"],
        alpha=0.25,
        label="least to greatest",
    )
    mean = 1e3 * envelope["mean"]
    rms = 1e3 * envelope["rms"]
    ax.fill_between(x, mean - rms, mean + rms, alpha=0.5, label="mean ± rms")
    ax.plot(x, mean, color="#1f4e79", label="mean")
    ax.axhline(0.0, color="grey", linewidth=0.6)
    ax.set_xlabel(f"{envelope['distance'].attrs['long_name']} [m]")
    ax.set_ylabel("excursion [mm]")
    ax.legend(fontsize="small")
    ax.margins(x=0)
    return ax


def _map(ax: Axes, x: Any, y: Any, amplitude: xr.DataArray) -> None:
    """Draw amplitudes (x, y) in decibels of the largest, in the order of x."""
    if np.ptp(x) < 1e-3 * np.abs(x).max():
        raise ParameterError("the speed does not change in this run: draw its spectrum", "found")
    values = amplitude.to_numpy().T
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
    unit = amplitude.attrs["units"]
    ax.set_title(amplitude.attrs["long_name"], fontsize="medium")
    ax.figure.colorbar(mesh, ax=ax, label=f"amplitude [dB re {largest:.3g} {unit}]")


def _label(values: xr.DataArray) -> str:
    unit = values.attrs.get("units", "1")
    return f"{values.attrs.get('long_name', values.name)} [{'–' if unit == '1' else unit}]"
