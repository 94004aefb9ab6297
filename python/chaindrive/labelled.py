"""Labelled arrays of NumPy, without a wait for packages that have arrays of other kinds.

Importing this module registers ``run.drive``, which whoever makes or opens a dataset wants.

Where dask is installed, xarray imports it to look at the first array that it is given, and at the
first one that becomes an index. That takes as long as xarray itself.
"""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import NDArray

__all__ = ["indexed", "labelled"]


@xr.register_dataset_accessor("drive")  # type: ignore[no-untyped-call, untyped-decorator]
def _drive(run: xr.Dataset) -> Any:
    """Find the methods of a run by their name: they take most of the package, and nothing here."""
    return import_module("chaindrive.accessor").DriveAccessor(run)


def labelled(
    dims: tuple[str, ...], values: NDArray[Any], attributes: Mapping[str, Any] | None = None
) -> xr.Variable:
    """Return an array with names of its dimensions."""
    # An array of NumPy is what it is.
    return xr.Variable(dims, np.asarray(values), attributes, fastpath=True)


def indexed(
    dimensions: Mapping[str, NDArray[Any]], along: Mapping[str, xr.Variable]
) -> xr.Coordinates:
    """Return the coordinates of dimensions, by which one selects, and others along them."""
    indexes = {
        dim: xr.indexes.PandasIndex(pd.Index(labels), dim, coord_dtype=labels.dtype)
        for dim, labels in dimensions.items()
    }
    variables: dict[Any, Any] = {}
    for index in indexes.values():
        variables |= index.create_variables()
    return xr.Coordinates({**variables, **along}, indexes=indexes)
