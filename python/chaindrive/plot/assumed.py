"""Assumptions: what the ends of their ranges move, and whose spread is seen in the result."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from chaindrive.errors import ParameterError
from chaindrive.plot.axes import drawing, legend_below
from chaindrive.plot.docstrings import completed
from chaindrive.plot.scheme import CURVES, LIMIT
from chaindrive.plot.units import rounded

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["sobol_indices", "tornado"]


@completed()
def tornado(found: xr.Dataset, output: str | None = None, *, ax: Axes | None = None) -> Axes:
    """Draw what the ends of the ranges of assumptions move, the largest on top.

    A bar from the drive to each end, with the interval of its change.

    Parameters
    ----------
    found
        What `chaindrive.tornado` returned.
    output
        Which output; the first when absent.

    Raises
    ------
    ParameterError
        This is no tornado, or it has no such output.

    Examples
    --------
    >>> import chaindrive as cd
    >>> ring = cd.scenes.spinning_ring()
    >>> found = cd.tornado(ring, {"chain.mass": ("8 g", "9 g")}, "link_tension_max", until=2e-3)
    >>> cd.plot.tornado(found).get_xlabel()
    'change [%]'
    """
    own = _of(found, output, "share", "what chaindrive.tornado returns")
    share = 100.0 * own["share"].to_numpy()
    width = 100.0 * np.abs((own["half_width"] / own["value"]).to_numpy())
    # The last one stands on top.
    order = np.argsort(np.nan_to_num(np.abs(share)).max(axis=1), kind="stable")
    places = np.arange(len(order))
    # Ends that move it the same way stand above each other, not one before the other.
    alike = share[order, 0] * share[order, 1] > 0.0
    with drawing(ax) as ax:
        for end, label in enumerate(("lower end of the range", "upper end")):
            look: dict[str, Any] = {"color": CURVES[end], "alpha": 0.8}
            interval = np.nan_to_num(width[order, end])
            shown: dict[str, Any] = {"xerr": interval, "error_kw": {"lw": 0.8, "ecolor": LIMIT}}
            at = places + np.where(alike, 0.15 - 0.3 * end, 0.0)
            height = np.where(alike, 0.3, 0.6)
            ax.barh(at, share[order, end], height=height, label=label, **look, **shown)
        _name(ax, own, own["assumption"].to_numpy()[order], "change [%]")
        value = rounded(float(own["value"]), str(own["unit"].item()))
        ax.set_title(f"{own['output'].item()}: {value}")
    return ax


@completed()
def sobol_indices(found: xr.Dataset, output: str | None = None, *, ax: Axes | None = None) -> Axes:
    """Draw the indices of Sobol: whose spread makes the spread of a result.

    First order is what goes by itself, total what goes with the others too. Whiskers are their
    intervals, by resampling.

    Parameters
    ----------
    found
        What `chaindrive.uncertainty` returned.
    output
        Which output; the first when absent.

    Raises
    ------
    ParameterError
        This is no such result, or it has no such output.
    """
    own = _of(found, output, "total_order", "what chaindrive.uncertainty returns")
    order = np.argsort(np.nan_to_num(own["total_order"].to_numpy()), kind="stable")
    places = np.arange(len(order))
    with drawing(ax) as ax:
        for row, (name, label) in enumerate((("first", "by itself"), ("total", "with the others"))):
            size = own[f"{name}_order"].to_numpy()[order]
            width = np.nan_to_num(own[f"{name}_order_half_width"].to_numpy()[order])
            ax.barh(
                places + 0.19 - 0.38 * row,
                size,
                height=0.36,
                color=CURVES[row],
                alpha=0.8,
                label=label,
                xerr=width,
                error_kw={"lw": 0.8, "ecolor": LIMIT},
            )
        _name(ax, own, own["parameter"].to_numpy()[order], "share of the variance [–]")
    return ax


def _name(ax: Axes, own: xr.Dataset, rows: np.ndarray, across: str) -> None:
    """Name the rows of bars, the axis across them, and the output."""
    ax.set_yticks(np.arange(len(rows)), [str(it) for it in rows])
    ax.axvline(0.0, color=LIMIT, lw=0.8)
    ax.set_title(str(own["output"].item()))
    ax.set_xlabel(across)
    legend_below(ax)


def _of(found: xr.Dataset, output: str | None, needed: str, what: str) -> xr.Dataset:
    """Return one output of a result."""
    if not isinstance(found, xr.Dataset) or needed not in found or "output" not in found.dims:
        raise ParameterError("there is nothing to draw in this", "found", what)
    names = [str(it) for it in found["output"].to_numpy()]
    if output is None:
        return found.isel(output=0)
    if output not in names:
        raise ParameterError(f"there is no {output!r}: there are {', '.join(names)}", "output")
    return found.isel(output=names.index(output))
