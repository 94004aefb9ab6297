"""What a plot is drawn of: a run, of which it makes the analysis, or the analysis itself.

A run has more channels, chains, spans and sprockets than one plot shows. What is taken unless
somebody asks for another is decided here.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, TypeVar, cast

import numpy as np
import xarray as xr

from chaindrive.analysis.orders import mesh_orders
from chaindrive.analysis.parts import chains, sprockets
from chaindrive.analysis.signal import recorded, require, turning
from chaindrive.analysis.spans import span_lines
from chaindrive.errors import ParameterError

__all__ = [
    "analysed",
    "chain_of",
    "driven_of",
    "driver_of",
    "is_run",
    "mesh_order_of",
    "span_of",
    "tightest_span",
    "turns_of",
]

Analysis = TypeVar("Analysis", xr.Dataset, xr.DataArray)


def is_run(source: object) -> bool:
    """Return whether this is a run, as `simulate` and `open_result` return it."""
    return isinstance(source, xr.Dataset) and "scene" in source.attrs and "time" in source.dims


def analysed(
    source: xr.Dataset | xr.DataArray,
    analysis: Callable[..., Analysis],
    holds: str,
    options: Mapping[str, Any],
    usual: Mapping[str, Callable[[xr.Dataset], Any]] | None = None,
) -> Analysis:
    """Return the analysis of a run, or what is one already.

    Parameters
    ----------
    source
        A run, or what `analysis` returned.
    analysis
        The function of `chaindrive.analysis`.
    holds
        A variable or coordinate of what it returns.
    options
        What it is to be told besides the run; None stands for what is usual.
    usual
        How to choose, in a run, options that nobody gave.

    Raises
    ------
    ParameterError
        This is neither; or the function refuses the run.
    """
    name = f"chaindrive.analysis.{analysis.__name__}"
    given = {key: value for key, value in options.items() if value is not None}
    if isinstance(source, xr.Dataset) and is_run(source):
        choices = (usual or {}).items()
        chosen = {key: choose(source) for key, choose in choices if key not in given}
        return analysis(source, **chosen, **given)
    if given:
        first = next(iter(given))
        message = f"{first} = {given[first]!r} chooses within a run; this is what {name} returned"
        raise ParameterError(message, first, f"give it to {name}")
    known = isinstance(source, xr.Dataset | xr.DataArray) and (
        holds in source.coords or (isinstance(source, xr.Dataset) and holds in source)
    )
    if not known:
        message = f"this is neither a run of chaindrive nor what {name} returns"
        raise ParameterError(message, "source", "the dataset of chaindrive.simulate")
    return cast("Analysis", source)


def chain_of(run: xr.Dataset) -> str | None:
    """Return the name of the first chain, None where there is only one."""
    return chains(run)[0].name or None


def driver_of(run: xr.Dataset) -> str:
    """Return the first sprocket on a route whose motion is given, else the first on it."""
    require(run, "sprocket")
    known = sprockets(run)
    if not known:
        raise ParameterError("no chain of this drive runs over a sprocket", "sprocket")
    moved = [
        name
        for name, it in known.items()
        if it.scene.get("motion", {}).get("kind", "held") != "held"
    ]
    return moved[0] if moved else next(iter(known))


def driven_of(run: xr.Dataset, driver: str | None = None) -> str:
    """Return the first sprocket under a load on the chain of the driver, else the next one."""
    driver = driver or driver_of(run)
    known = sprockets(run)
    own = known[driver].chain.name if driver in known else ""
    others = {name: it for name, it in known.items() if name != driver and it.chain.name == own}
    if not others:
        raise ParameterError(f"the chain runs over no sprocket but {driver}", "driven")
    return next((name for name, it in others.items() if "load" in it.scene), next(iter(others)))


def span_of(run: xr.Dataset) -> str:
    """Return the longest span."""
    require(run, "span")
    return str(span_lines(run)["length"].idxmax("span").item())


def tightest_span(run: xr.Dataset) -> xr.DataArray:
    """Return the tension of the span that is tightest in the mean while held [N], (time,)."""
    require(run, "span")
    recorded(run, "span_tension")
    tension = run["span_tension"]
    if "span" not in tension.dims:
        return tension
    # A span that no roller ever holds has no mean.
    mean = tension.mean("time").fillna(-np.inf)
    return tension.isel(span=int(np.argmax(mean.to_numpy())))


def turns_of(run: xr.Dataset, shaft: str) -> float:
    """Return the length of a window of an order map [turns]: a tenth of the run, of 1 to 8."""
    angle, _ = turning(run, shaft)
    return float(np.clip(np.floor(0.1 * angle[-1] / (2.0 * np.pi)), 1.0, 8.0))


def mesh_order_of(run: xr.Dataset, shaft: str) -> float:
    """Return how many teeth of a shaft's sprocket, or else of the driver, come into mesh a turn."""
    orders = mesh_orders(run)
    return orders.get(shaft) or orders[driver_of(run)]
