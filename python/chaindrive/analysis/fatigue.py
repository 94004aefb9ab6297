"""Load cycles of links, counted by the rainflow method."""

from __future__ import annotations

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from chaindrive import _core
from chaindrive.analysis.parts import circuits, one_chain
from chaindrive.analysis.signal import recorded
from chaindrive.errors import ParameterError

__all__ = ["cycles", "rainflow"]


def cycles(values: ArrayLike) -> NDArray[np.float64]:
    """Return the cycles of a signal by the rainflow method of ASTM E1049-85, §5.4.4.

    Parameters
    ----------
    values : (samples,)
        The signal.

    Returns
    -------
    (cycles, 3)
        Range, mean, and count: 1 for a cycle, ½ for a half.

    Examples
    --------
    >>> from chaindrive.analysis import cycles
    >>> cycles([-2, 1, -3, 5, -1, 3, -4, 4, -2]).tolist()[0]
    [3.0, -0.5, 0.5]
    """
    counted, _ = _core.rainflow(np.asarray(values, dtype=float).reshape(1, -1))
    return counted


def rainflow(
    run: xr.Dataset,
    *,
    chain: str | None = None,
    ranges: int = 32,
    means: int = 16,
    exponent: float = 5.0,
) -> xr.Dataset:
    """Return the load cycles of all links of a chain, counted by the rainflow method.

    Each link bears a large cycle on every circuit, from the tight side to the slack side, and small
    ones from teeth and vibration. A run of less than two circuits (the attribute ``circuits``)
    holds that cycle as halves or not at all.

    ::

        S_eq = (Σ n_i S_i^m / n)^(1/m),    n circuits of all links

    Parameters
    ----------
    run
        A run with the channel ``link_tension``; with ``sprocket_angle``, which tells the circuits.
    chain
        Name of the chain, where there are several.
    ranges, means
        Bins of the histogram.
    exponent
        Slope m of the Wöhler curve for S_eq, *assumed* 5 for plates with punched holes.

    Returns
    -------
    xarray.Dataset
        ``cycles`` (tension_range, tension_mean) of a link in the run; ``exceedances``
        (tension_range,), cycles of at least this range; ``largest_range`` and ``largest_tension``
        (link,) [N]; ``equivalent_range`` S_eq [N], the range that once a circuit does the damage of
        all, by Miner's rule (NaN where the chain does not go around).

    Raises
    ------
    ParameterError
        The channel was not recorded.
    """
    recorded(run, "link_tension")
    if ranges < 1 or means < 1:
        raise ParameterError("ranges and means must be at least 1", "ranges")
    which = one_chain(run, chain)
    own = slice(which.first, which.first + which.links)
    tension = run["link_tension"].isel(link=own).transpose("link", "time").to_numpy().astype(float)
    table, each = _core.rainflow(tension)
    high = float(table[:, 0].max()) if table.size else 0.0
    least, most = float(tension.min()), float(tension.max())
    edges = np.linspace(0.0, high or 1.0, ranges + 1)
    across = np.linspace(least, most if most > least else least + 1.0, means + 1)
    histogram, _, _ = np.histogram2d(
        table[:, 0], table[:, 1], bins=[edges, across], weights=table[:, 2]
    )
    count = histogram / which.links
    around = circuits(run, which) if "sprocket_angle" in run else 0.0
    if around > 0.0:
        # S_eq = (Σ n_i S_i^m / n)^(1/m)
        damage = float((table[:, 2] * table[:, 0] ** exponent).sum())
        equivalent = (damage / (which.links * around)) ** (1.0 / exponent)
    else:
        equivalent = np.nan
    of_link = np.repeat(np.arange(which.links), each.astype(np.intp))
    largest = np.zeros(which.links)
    np.maximum.at(largest, of_link, table[:, 0])
    newton = {"units": "N"}
    per_link = {"units": "1"}
    return xr.Dataset(
        {
            "cycles": (
                ("tension_range", "tension_mean"),
                count,
                per_link | {"long_name": "cycles of a link"},
            ),
            "exceedances": (
                "tension_range",
                count.sum(axis=1)[::-1].cumsum()[::-1],
                per_link | {"long_name": "cycles of at least the range"},
            ),
            "largest_range": ("link", largest, newton | {"long_name": "largest tension range"}),
            "largest_tension": (
                "link",
                tension.max(axis=1),
                newton | {"long_name": "largest tension"},
            ),
            "equivalent_range": ((), equivalent, newton | {"long_name": "equivalent range"}),
        },
        coords={
            "tension_range": (
                "tension_range",
                _middles(edges),
                newton | {"long_name": "tension range"},
            ),
            "tension_mean": (
                "tension_mean",
                _middles(across),
                newton | {"long_name": "mean tension"},
            ),
            "link": np.arange(which.links),
        },
        attrs={
            "chain": which.name,
            "links": which.links,
            "circuits": around,
            "exponent": exponent,
            "seconds": float(run["time"][-1] - run["time"][0]),
        },
    )


def _middles(edges: NDArray[np.float64]) -> NDArray[np.float64]:
    middles: NDArray[np.float64] = 0.5 * (edges[1:] + edges[:-1])
    return middles
