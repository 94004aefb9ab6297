"""Sweeps: a result over what was varied, and its optimum."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from chaindrive.errors import ParameterError
from chaindrive.plot.axes import colour_bar, drawing, legend_below
from chaindrive.plot.docstrings import completed
from chaindrive.plot.scheme import CURVES, MARK
from chaindrive.plot.units import in_trade, written

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

__all__ = ["response"]


@completed()
def response(
    sweep: xr.Dataset,
    quantity: str = "span_tension_max",
    *,
    optimum: Literal["least", "largest"] = "least",
    ax: Axes | None = None,
    **at: Any,
) -> Axes:
    """Draw a result of a sweep over what was varied, its optimum marked.

    A curve over one dimension, a map over two. Variants that failed are left out; variants whose
    verdict is ``"distrusted"`` are crossed out, and are never the optimum.

    Parameters
    ----------
    sweep
        What `chaindrive.sweep` returned, over one or two values.
    quantity
        A statistic of it.
    optimum
        Whether the least or the largest value is marked.
    **at
        Labels by dimension: ``span="crank-cam"`` where the statistic has one a span, or one of
        more than two values varied. Of labels that nobody chooses the largest value is drawn.

    Raises
    ------
    ParameterError
        The sweep has no such statistic or label, varies more than two values, no variant of it has
        one, or there is no such optimum.

    Examples
    --------
    >>> import chaindrive as cd
    >>> ring = cd.scenes.spinning_ring()
    >>> vary = {"chain.start.speed": [300.0, 350.0, 400.0]}
    >>> result = cd.sweep(ring, vary, until=2e-3, every=1e-3)
    >>> ax = cd.plot.response(result, "energy_residual_max")
    >>> ax.get_xlabel()
    'speed [rpm]'
    """
    if optimum not in ("least", "largest"):
        raise ParameterError(f"optimum = {optimum!r}, must be 'least' or 'largest'", "optimum")
    values, distrusted = _chosen(sweep, quantity, at)
    varied = [str(dim) for dim in values.dims]
    trusted = values.where(~distrusted)
    if not np.isfinite(trusted.to_numpy()).any():
        message = f"no variant has a {quantity} that is not distrusted: nothing to draw"
        raise ParameterError(message, quantity, "look at sweep['error'] and sweep['verdict_note']")
    best = trusted.argmin(...) if optimum == "least" else trusted.argmax(...)
    place = {dim: int(index) for dim, index in best.items()}
    factor, unit = in_trade(values.attrs.get("units", "1"), trusted)
    name = values.attrs.get("long_name", quantity)
    with drawing(ax) as ax:
        axes = [_Axis(sweep, dim) for dim in varied]
        shown = factor * values.transpose(*varied).to_numpy()
        told = ", ".join(axis.told(place[axis.dim]) for axis in axes)
        here = factor * float(values[place])
        label = f"{optimum}: {here:.4g} {unit} at {told}".replace(" 1 at", " at")
        ring: dict[str, Any] = {"mfc": "none", "mec": MARK, "mew": 1.5, "markersize": 12}
        crosses = np.argwhere(distrusted.transpose(*varied).to_numpy())
        if len(axes) == 1:
            (x,) = axes
            ax.plot(x.places, shown, "o-", color=CURVES[0], markersize=4)
            ax.plot(x.places[place[x.dim]], here, "o", label=label, **ring)
            marks = [x.places[crosses[:, 0]], shown[crosses[:, 0]]]
            ax.set_ylabel(written(name, unit))
        else:
            x, y = axes
            mesh = ax.pcolormesh(x.places, y.places, shown.T, shading="nearest", cmap="viridis")
            colour_bar(ax, mesh, written(name, unit))
            ax.plot(x.places[place[x.dim]], y.places[place[y.dim]], "o", label=label, **ring)
            marks = [x.places[crosses[:, 0]], y.places[crosses[:, 1]]]
            y.label(ax.yaxis)
        if len(crosses):
            ax.plot(*marks, "x", color=MARK, label="distrusted")
        x.label(ax.xaxis)
        legend_below(ax)
    return ax


class _Axis:
    """One dimension of a sweep as an axis: numbers in trade units, anything else by its place."""

    def __init__(self, sweep: xr.Dataset, dim: str) -> None:
        self.dim = dim
        held = sweep[dim] if dim in sweep.coords else None
        self.names: list[str] | None = None
        self.unit = ""
        if held is not None and np.issubdtype(held.dtype, np.number):
            factor, self.unit = in_trade(str(held.attrs.get("units", "1")), held)
            self.places = factor * held.to_numpy().astype(float)
        else:
            labels = range(sweep.sizes[dim]) if held is None else held.to_numpy()
            self.names = [str(it) for it in labels]
            self.places = np.arange(len(self.names), dtype=float)
        self.title = dim.replace("_", " ")

    def told(self, index: int) -> str:
        """Return the value at a place, in words."""
        if self.names is not None:
            return self.names[index]
        return f"{self.places[index]:.4g} {self.unit}".removesuffix(" 1")

    def label(self, axis: Any) -> None:
        """Label an axis of matplotlib."""
        if self.names is None:
            axis.set_label_text(written(self.title, self.unit))
        else:
            axis.set_label_text(self.title)
            axis.set_ticks(self.places, self.names)


def _chosen(
    sweep: xr.Dataset, quantity: str, at: dict[str, Any]
) -> tuple[xr.DataArray, xr.DataArray]:
    """Return a statistic over what is varied, and which variants are distrusted."""
    swept = [str(dim) for dim in sweep["verdict"].dims] if "verdict" in sweep else []
    numbers = [
        str(name)
        for name, held in sweep.data_vars.items()
        if np.issubdtype(held.dtype, np.number) and "time" not in held.dims
    ]
    if quantity not in numbers:
        listed = ", ".join(numbers[:12]) + (", …" if len(numbers) > 12 else "")
        raise ParameterError(f"the sweep has no {quantity}: it has {listed}", "quantity")
    values, distrusted = sweep[quantity], sweep["verdict"] == "distrusted"
    for dim, label in at.items():
        if dim not in values.dims:
            held = ", ".join(map(str, values.dims))
            raise ParameterError(f"{quantity} has no dimension {dim!r}: it has {held}", dim)
        known = values[dim].to_numpy().tolist()
        if label not in known:
            listed = ", ".join(map(str, known[:12])) + (", …" if len(known) > 12 else "")
            raise ParameterError(f"there is no {dim} {label!r}: there are {listed}", dim)
        values = values.sel({dim: label})
        if dim in swept:
            distrusted = distrusted.sel({dim: label})
    attributes = values.attrs
    others = [dim for dim in values.dims if dim not in swept]
    values = values.max(others).assign_attrs(attributes) if others else values
    if values.ndim == 0 or values.ndim > 2:
        count = f"{values.ndim} values are varied: {', '.join(map(str, values.dims))}"
        raise ParameterError(f"{count}; one or two are drawn", "sweep", "choose the others by name")
    return values, distrusted
