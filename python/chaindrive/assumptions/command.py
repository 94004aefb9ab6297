"""The commands `uncertainty` and `tornado`."""

from __future__ import annotations

import io
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import xarray as xr

from chaindrive._core import NewFile
from chaindrive.assumptions.outputs import OUTPUTS
from chaindrive.assumptions.propagation import uncertainty
from chaindrive.assumptions.ranking import tornado
from chaindrive.extras import extra
from chaindrive.measurement.arguments import (
    drive_of,
    number_of,
    pairs_of,
    place_of_output,
    ranges_of,
    rows_of,
    runs_of,
)

__all__ = ["ranked", "spread"]

_PICTURES = (".png", ".svg", ".pdf")
_RUNS = ("method", "step", "until", "run_in")


def spread(options: Mapping[str, Any]) -> tuple[str, dict[str, Any]]:
    """Carry distributions through a drive, and return the page and the answer."""
    place = _place(options)
    laws = {
        path: tuple(map(number_of, text.split(".."))) if ".." in text else text
        for path, text in pairs_of("draw", options["draw"], "chain.mass=normal(3 kg, 20 g)").items()
    }
    more: dict[str, Any] = {
        name: options[name] for name in ("samples", "seed") if options[name] is not None
    }
    found = uncertainty(
        drive_of(options), laws, options["of"] or OUTPUTS, **more, **runs_of(options)
    )
    from chaindrive import plot

    _draw(place, options, found, plot.sobol_indices)
    indices = ("first_order", "first_order_half_width", "total_order", "total_order_half_width")
    outputs = [
        row | {"parameters": rows_of(found.isel(output=n), "parameter", indices)}
        for n, row in enumerate(
            rows_of(found, "output", ("unit", "mean", "deviation", "lower", "upper", "numerical"))
        )
    ]
    about = {name: found.attrs[name] for name in ("samples", "seed", "level", *_RUNS)}
    return (
        str(found.attrs["summary"]),
        about | {"variants": found.sizes["variant"], "outputs": outputs},
    )


def ranked(options: Mapping[str, Any]) -> tuple[str, dict[str, Any]]:
    """Rank values by what their ranges move, and return the page and the answer."""
    place = _place(options)
    ranges = ranges_of("range", options["range"])
    found = tornado(drive_of(options), ranges, options["of"] or OUTPUTS, **runs_of(options))
    from chaindrive import plot

    _draw(place, options, found, plot.tornado)
    flat = found[["change", "half_width", "share"]]
    columns = {
        f"{end}_{name}": flat[name].sel(end=end, drop=True)
        for end in ("low", "high")
        for name in flat.data_vars
    }
    table = xr.Dataset(columns)
    outputs = [
        row | {"assumptions": rows_of(table.isel(output=n), "assumption", tuple(columns))}
        for n, row in enumerate(rows_of(found, "output", ("unit", "value")))
    ]
    about = {name: found.attrs[name] for name in ("level", "phases")}
    return str(found.attrs["summary"]), about | {"outputs": outputs}


def _place(options: Mapping[str, Any]) -> NewFile | None:
    """Return the place of the diagram, before anything is simulated."""
    text = options["output"]
    if text is None:
        return None
    extra("matplotlib.pyplot", "plots")
    return place_of_output(text, _PICTURES, options["overwrite"])


def _draw(
    place: NewFile | None,
    options: Mapping[str, Any],
    found: xr.Dataset,
    draw: Callable[..., object],
) -> None:
    """Draw one panel an output, below each other."""
    if place is None:
        return
    from chaindrive.plot.scheme import STYLE

    pyplot = extra("matplotlib.pyplot", "plots")
    names = [str(it) for it in found["output"].to_numpy()]
    rows = found.sizes.get("assumption", found.sizes.get("parameter", 1))
    height = 2.6 + 0.4 * rows
    with pyplot.rc_context(dict(STYLE)):
        figure, axes = pyplot.subplots(
            len(names), figsize=(7.2, height * len(names)), layout="constrained", squeeze=False
        )
        for ax, name in zip(axes.flat, names, strict=True):
            draw(found, name, ax=ax)
        drawn = io.BytesIO()
        figure.savefig(drawn, format=Path(options["output"]).suffix[1:], dpi=110)
        pyplot.close(figure)
    place.write(drawn.getvalue())
