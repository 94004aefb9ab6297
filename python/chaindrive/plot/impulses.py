"""Orders of the impulses on sprockets."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from chaindrive import analysis
from chaindrive.plot.axes import drawing, legend_below
from chaindrive.plot.docstrings import completed
from chaindrive.plot.source import analysed
from chaindrive.plot.units import in_trade, written

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

__all__ = ["impulse_spectrum"]

#: Amplitudes below this share of the largest are not shown: 60 dB.
_FLOOR = 1e-3


@completed(run='A run with ``events="teeth"``')
def impulse_spectrum(source: xr.Dataset, *, ax: Axes | None = None, **options: Any) -> Axes:
    """Draw the amplitude of impulses by order of the mesh, one line a sprocket."""
    found = analysed(source, analysis.impulse_spectrum, "broadband", options)
    amplitude = found["amplitude"]
    top = float(amplitude.max())
    with drawing(ax) as ax:
        factor, unit = in_trade("N", amplitude)
        for name in amplitude["sprocket"].to_numpy():
            heights = factor * amplitude.sel(sprocket=name)
            ax.plot(amplitude["order"], heights, label=str(name), linewidth=0.9)
        ax.set_yscale("log")
        if top > 0.0:
            ax.set_ylim(factor * _FLOOR * top, 1.5 * factor * top)
        ax.set_ylabel(written("amplitude of impulses", unit))
        ax.set_xlim(0.0, float(amplitude["order"][-1]))
        ax.set_xlabel("order of the mesh")
        ax.set_title(amplitude.attrs["long_name"], fontsize="small")
        legend_below(ax)
    return ax
