"""Curves: tension over time, work against precision."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from chaindrive.analysis.signal import require
from chaindrive.errors import ParameterError
from chaindrive.plot.axes import drawing, legend_below
from chaindrive.plot.docstrings import completed
from chaindrive.plot.scheme import LIMIT
from chaindrive.plot.units import in_trade, written

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

__all__ = ["tension", "work_precision"]


@completed()
def tension(run: xr.Dataset, *, ax: Axes | None = None) -> Axes:
    """Draw span tensions over time, or link tensions where there are no spans.

    Parameters
    ----------
    run
        A run with the channel ``span_tension`` or ``link_tension``.

    Raises
    ------
    ParameterError
        Neither was recorded, or the drive has neither spans nor links.
    """
    known = [name for name in ("span_tension", "link_tension") if name in run]
    if not known:
        raise ParameterError(
            "neither span_tension nor link_tension is in the run: "
            "simulate(…, record=[…, 'span_tension'])",
            "span_tension",
        )
    # Open strands and rings have links, and no spans.
    name = next((name for name in known if run[name].size), known[0])
    values = run[name]
    dim = name.removesuffix("_tension")
    require(run, dim)
    if dim not in values.dims:
        values = values.expand_dims(dim)
    with drawing(ax) as ax:
        factor, unit = in_trade("N", values)
        crowded = values.sizes[dim] > 12
        for label in values[dim].to_numpy():
            line = factor * values.sel({dim: label})
            (curve,) = ax.plot(values["time"], line, label=str(label), linewidth=0.8)
            if crowded:
                curve.set(linewidth=0.4, alpha=0.5)
        ax.set_xlabel("time [s]")
        ax.set_ylabel(written(f"{dim} tension", unit))
        if not crowded:
            legend_below(ax)
        ax.margins(x=0)
    return ax


@completed()
def work_precision(table: xr.Dataset, *, ax: Axes | None = None, cost: str = "wall") -> Axes:
    """Draw error against cost, both logarithmic, one line a method and onset depth.

    Parameters
    ----------
    table
        What `chaindrive.work_precision` returned.
    cost
        Column for the abscissa: ``"wall"``, ``"cpu"`` or ``"evaluations"``.

    Raises
    ------
    ParameterError
        This is no such table.
    """
    if "error_tight_span_tension" not in table:
        raise ParameterError(
            "this draws a table of errors and costs: make it by chaindrive.work_precision(drive)"
        )
    with drawing(ax) as ax:
        error = table["error_tight_span_tension"]
        methods = [str(method) for method in table["method"].to_numpy()]
        depths = table["onset_depth"].values
        names = [
            name if np.isnan(depth) else f"{name}, onset {1e6 * depth:g} µm"
            for name, depth in zip(methods, depths, strict=True)
        ]
        for name in dict.fromkeys(names):
            rows = np.array([other == name for other in names]) & np.isfinite(error.values)
            if rows.any():
                order = np.argsort(table[cost].values[rows])
                ax.plot(
                    table[cost].values[rows][order], error.values[rows][order], "o-", label=name
                )
        agreement = table.attrs.get("agreement_tight_tension", 0.0)
        if agreement > 0.0:
            ax.axhline(agreement, color=LIMIT, linestyle=":", label="reference and check apart")
        unit = table[cost].attrs["units"]
        ax.set_xlabel(table[cost].attrs["long_name"] + ("" if unit == "1" else f" [{unit}]"))
        ax.set_ylabel("error of the tight span, rms [–]")
        ax.set_xscale("log")
        ax.set_yscale("log")
        ax.set_title(table.attrs.get("title", ""))
        legend_below(ax)
    return ax
