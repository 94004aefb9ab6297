"""The diagram that the command `bench` draws beside its table."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable
from pathlib import Path

import numpy as np
import xarray as xr

from chaindrive._core import NewFile
from chaindrive.errors import tell
from chaindrive.extras import extra

__all__ = ["command"]


def command(run: Callable[[], int], table: Path, picture: Path, place: NewFile) -> int:
    """Run the command, which writes its table, draw that, and return the exit code."""
    try:
        pyplot = extra("matplotlib.pyplot", "diagrams")
    except ModuleNotFoundError as error:
        tell(f"{picture}: will not be drawn, {error}")
        return run()
    code = run()
    if code:
        return code
    from chaindrive.plot import work_precision

    pyplot.switch_backend("svg")
    work_precision(_read(table))
    drawn = io.BytesIO()
    pyplot.savefig(drawn)
    place.write(drawn.getvalue())
    return 0


def _read(file: Path) -> xr.Dataset:
    """Return of a table what its diagram shows."""
    with file.open(encoding="utf-8", newline="") as table:
        rows = list(csv.DictReader(table))
    runs = [row for row in rows if row["method"] not in ("agreement", "spread")]

    def numbers(name: str, **about: str) -> xr.Variable:
        return xr.Variable("run", np.array([float(row[name] or "nan") for row in runs]), about)

    (between,) = (row for row in rows if row["method"] == "agreement")
    return xr.Dataset(
        {
            "method": ("run", np.array([row["method"] for row in runs])),
            "onset_depth": numbers("onset_depth"),
            "wall": numbers("wall", units="s", long_name="wall time"),
            "error_tight_span_tension": numbers("error_tight_span_tension"),
        },
        attrs={"agreement_tight_tension": float(between["error_tight_span_tension"] or "nan")},
    )
