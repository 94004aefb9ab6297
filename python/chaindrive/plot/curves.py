"""Curves: tension over time, work against precision."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from chaindrive.plot.axes import given_or_new

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

_GREY = "#8d99a6"


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
    ax = given_or_new(ax)
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
    ax = given_or_new(ax)
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
        ax.axhline(agreement, color=_GREY, linestyle=":", label="reference and check apart")
    unit = table[cost].attrs["units"]
    ax.set_xlabel(table[cost].attrs["long_name"] + ("" if unit == "1" else f" [{unit}]"))
    ax.set_ylabel("error of the tight span, rms [–]")
    ax.set_xscale("log")
    ax.set_yscale("log")
    ax.set_title(table.attrs.get("title", ""))
    ax.legend()
    return ax
