"""A run beside a measurement: overlay with bands, orders, distribution, and what they say."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from chaindrive.errors import ParameterError
from chaindrive.extras import extra
from chaindrive.plot.axes import drawing, legend_below
from chaindrive.plot.docstrings import completed
from chaindrive.plot.scheme import CURVES, INK, MARK, STEEL, STYLE
from chaindrive.plot.units import in_trade, written

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["compared_orders", "comparison", "differences", "distribution", "overlay"]

#: Standard errors on either side of a mean that are drawn as its band.
_SIDES = 2.0


@completed()
def overlay(found: xr.Dataset, quantity: str | None = None, *, ax: Axes | None = None) -> Axes:
    """Draw a measured and a simulated signal over each other, with the scatter of the measured one.

    Over a turn or a pitch both are means; the band is two standard errors of the measured one.

    Parameters
    ----------
    found
        What `chaindrive.compare` returned.
    quantity
        Which one; the first when absent.

    Raises
    ------
    ParameterError
        This is no comparison, or it has no such quantity or no signal of it.
    """
    own = _of(found, quantity)
    if "measured_mean" not in own or not np.isfinite(own["measured_mean"]).any():
        raise ParameterError(f"{_name(own)}: there is no signal to lay over another", "quantity")
    known = np.isfinite(own["place_value"].to_numpy())
    at = own["place_value"].to_numpy()[known]
    factor, unit = in_trade(str(own["unit"].item()), own["measured_mean"])
    ours, theirs, scatter = (
        factor * own[name].to_numpy()[known]
        for name in ("measured_mean", "simulated_mean", "measured_scatter")
    )
    with drawing(ax) as ax:
        if np.isfinite(scatter).any():
            band = _SIDES * scatter
            ax.fill_between(at, ours - band, ours + band, color=CURVES[0], alpha=0.25, linewidth=0)
        ax.plot(at, ours, color=CURVES[0], label="measured")
        ax.plot(at, theirs, color=CURVES[1], label="run")
        over_period = found.attrs.get("shaft") and at[-1] <= 1.0
        ax.set_xlabel("share of a period [–]" if over_period else "time [s]")
        ax.set_ylabel(written(_name(own), unit))
        ax.margins(x=0)
        legend_below(ax)
    return ax


@completed()
def compared_orders(
    found: xr.Dataset, quantity: str | None = None, *, ax: Axes | None = None
) -> Axes:
    """Draw amplitudes by order, measured and simulated, with the band of all errors.

    Parameters
    ----------
    found
        What `chaindrive.compare` returned.
    quantity
        Which one; the first when absent.

    Raises
    ------
    ParameterError
        This is no comparison, or it has no such quantity or no orders of it.
    """
    own = _of(found, quantity)
    if "measured_amplitude" not in own or not np.isfinite(own["measured_amplitude"]).any():
        raise ParameterError(f"{_name(own)}: the record holds no order", "quantity")
    own = own.isel(order=np.flatnonzero(np.isfinite(own["measured_amplitude"].to_numpy())))
    factor, unit = in_trade(str(own["unit"].item()), own["measured_amplitude"])
    at = np.arange(own.sizes["order"])
    with drawing(ax) as ax:
        ours = factor * own["measured_amplitude"].to_numpy()
        theirs = factor * own["simulated_amplitude"].to_numpy()
        width = np.nan_to_num(factor * own["amplitude_half_width"].to_numpy())
        ax.bar(at - 0.2, ours, 0.4, color=CURVES[0], label="measured")
        bars: dict[str, Any] = {"yerr": width, "ecolor": INK, "capsize": 2.0}
        ax.bar(at + 0.2, theirs, 0.4, color=CURVES[1], label="run, band of all errors", **bars)
        ax.set_xticks(at, [f"{it:g}" for it in own["order"].to_numpy()])
        ax.set_xlabel(f"order of {found.attrs['shaft']} [–]")
        ax.set_ylabel(written("amplitude", unit))
        ax.set_ylim(bottom=0.0)
        legend_below(ax)
    return ax


@completed()
def distribution(found: xr.Dataset, quantity: str | None = None, *, ax: Axes | None = None) -> Axes:
    """Draw how often a quantity takes which value, measured and simulated.

    Parameters
    ----------
    found
        What `chaindrive.compare` returned.
    quantity
        Which one; the first when absent.

    Raises
    ------
    ParameterError
        This is no comparison, or it has no such quantity or no samples of it.
    """
    own = _of(found, quantity)
    if "bin_value" not in own or not np.isfinite(own["bin_value"]).any():
        raise ParameterError(f"{_name(own)}: there are no samples to count", "quantity")
    factor, unit = in_trade(str(own["unit"].item()), own["bin_value"])
    at = factor * own["bin_value"].to_numpy()
    with drawing(ax) as ax:
        for name, colour, title in (
            ("measured_density", CURVES[0], "measured"),
            ("simulated_density", CURVES[1], "run"),
        ):
            share = own[name].to_numpy() / factor
            ax.step(at, share, where="mid", color=colour, label=title)
        ax.set_xlabel(written(_name(own), unit))
        ax.set_ylabel(written("density", f"1/{unit}"))
        ax.set_ylim(bottom=0.0)
        ax.margins(x=0)
        legend_below(ax)
    return ax


@completed()
def differences(found: xr.Dataset, quantity: str | None = None, *, ax: Axes | None = None) -> Axes:
    """Draw what is judged in bands: a difference within ±1 is one that errors explain.

    Parameters
    ----------
    found
        What `chaindrive.compare` returned.
    quantity
        Which one; the first when absent.

    Raises
    ------
    ParameterError
        This is no comparison, or it has no such quantity or no band of it.
    """
    own = _of(found, quantity)
    names = [str(it) for it in own["statistic"].to_numpy()]
    sizes = list((own["difference"] / own["half_width"]).to_numpy())
    verdicts = [str(it) for it in own["judgement"].to_numpy()]
    if "measured_amplitude" in own:
        wide = (own["simulated_amplitude"] - own["measured_amplitude"]).to_numpy()
        sizes += list(wide / own["amplitude_half_width"].to_numpy())
        names += [f"order {it:g}" for it in own["order"].to_numpy()]
        verdicts += [str(it) for it in own["order_judgement"].to_numpy()]
    rows = [it for it in zip(names, sizes, verdicts, strict=True) if np.isfinite(it[1])]
    if not rows:
        raise ParameterError(f"{_name(own)}: no band of errors is known", "quantity")
    colours = {"agrees": CURVES[2], "misses": MARK, "cannot tell": STEEL}
    with drawing(ax) as ax:
        at = np.arange(len(rows))[::-1]
        ax.axvspan(-1.0, 1.0, color=STEEL, alpha=0.25, linewidth=0)
        for verdict, colour in colours.items():
            chosen = [n for n, it in enumerate(rows) if it[2] == verdict]
            if chosen:
                places = [rows[n][1] for n in chosen]
                ax.plot(places, at[chosen], "o", color=colour, label=verdict)
        ax.set_yticks(at, [it[0] for it in rows])
        ax.set_xlabel("difference over the band of all errors [–]")
        ax.set_ylim(-0.7, len(rows) - 0.3)
        reach = max(1.5, 1.1 * max(abs(it[1]) for it in rows))
        ax.set_xlim(-reach, reach)
        legend_below(ax)
    return ax


def comparison(found: xr.Dataset, quantity: str | None = None) -> Figure:
    """Draw a quantity of a comparison in four panels.

    The signals over each other, orders, distribution, and every difference over its band. A panel
    that the record does not fill says why.

    Parameters
    ----------
    found
        What `chaindrive.compare` returned.
    quantity
        Which one; the first when absent.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    ParameterError
        This is no comparison, or it has no such quantity.
    """
    own = _of(found, quantity)
    pyplot = extra("matplotlib.pyplot", "plots")
    panels: list[Callable[..., object]] = [overlay, differences, compared_orders, distribution]
    with pyplot.rc_context(dict(STYLE)):
        figure: Figure
        figure, axes = pyplot.subplots(2, 2, figsize=(11.0, 7.5), layout="constrained")
        for ax, draw in zip(axes.flat, panels, strict=True):
            try:
                draw(found, quantity, ax=ax)
            except ParameterError as reason:
                ax.set_axis_off()
                ax.text(0.5, 0.5, str(reason), transform=ax.transAxes, ha="center", wrap=True)
        figure.suptitle(f"{own['channel'].item()}, {_name(own)}: {own['verdict'].item()}")
    return figure


def _of(found: xr.Dataset, quantity: str | None) -> xr.Dataset:
    """Return one quantity of a comparison."""
    if not isinstance(found, xr.Dataset) or "quantity" not in found.dims:
        message = "this is no comparison"
        raise ParameterError(message, "found", "what chaindrive.compare(run, data) returns")
    names = [str(it) for it in found["quantity"].to_numpy()]
    if quantity is None:
        return found.isel(quantity=0)
    if quantity not in names:
        raise ParameterError(f"there is no {quantity!r}: there are {', '.join(names)}", "quantity")
    return found.isel(quantity=names.index(quantity))


def _name(own: xr.Dataset) -> str:
    return str(own["quantity"].item())
