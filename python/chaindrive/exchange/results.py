"""Results as files of other programs: NetCDF, CSV, Parquet."""

from __future__ import annotations

import json
from collections.abc import Callable
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from chaindrive import _core
from chaindrive._core import NewFile
from chaindrive.errors import ParameterError
from chaindrive.extras import extra

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["save"]

_SUFFIXES = ".nc, .csv or .parquet"


def save(run: xr.Dataset, path: str | PathLike[str]) -> list[Path]:
    """Write a result for other programs, in the form that the name ends in.

    ``.nc`` is NetCDF with everything that the dataset holds, and takes the extra ``netcdf``;
    ``.csv`` and ``.parquet`` (extra ``parquet``) are tables of one row a sample, with columns such
    as ``span_tension[crank-to-cam] [N]``. Contacts that were logged go to a second table beside
    it, ``run.events.csv``. Parquet has unit, description and label of every column in its metadata,
    and the attributes of the result as JSON under ``chaindrive``.

    Parameters
    ----------
    run
        What `simulate` or `open_result` returned; of a sweep, for NetCDF.
    path
        The file; one that exists is replaced.

    Returns
    -------
    list of pathlib.Path
        What was written.

    Raises
    ------
    ParameterError
        The name ends otherwise; or for a table the dataset has no samples over time, more than one
        run, or another dimension before time.
    WriteError
        A file cannot be written; what was in its place is still there.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> import chaindrive as cd
    >>> ring = cd.scenes.spinning_ring()
    >>> run = cd.simulate(ring, until=2e-3, every=1e-3, record="link_tension")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     (table,) = cd.save(run, f"{folder}/run.csv")
    ...     table.read_text().splitlines()[0].split(",")[:2]
    ['time [s]', 'link_tension[0] [N]']
    """
    file = Path(path)
    if file.suffix == ".nc":
        for package in ("h5netcdf", "h5py"):
            extra(package, "results in NetCDF")
        with NewFile(file) as part:
            # Made in memory: on a full disk HDF5 ends the whole process.
            part.write_bytes(run.to_netcdf(engine="h5netcdf"))
        return [file]
    if file.suffix not in (".csv", ".parquet"):
        hint = "a Zarr store is written by `simulate(…, output=…)`"
        raise ParameterError(f"{file}: the name must end in {_SUFFIXES}", "path", hint)
    over_time = [of.dims for of in run.data_vars.values() if "time" in of.dims]
    if "time" not in run.dims or any(of[0] != "time" or len(of) > 2 for of in over_time):
        message = "the dataset is no table: it has no samples over time, or more than one run, or "
        message += "another dimension before time"
        hint = "select one run, put time first by run.transpose('time', ...), or write NetCDF"
        raise ParameterError(message, "run", hint)
    make = _csv if file.suffix == ".csv" else _parquet
    tables = {"time": file}
    if "event" in run.dims:
        tables["event"] = file.with_suffix(f".events{file.suffix}")
    # Both places are found fit, and packages imported, before one is written.
    places = [(NewFile(table), of) for of, table in tables.items()]
    made = [(place, make(_columns(run, of), run.attrs)) for place, of in places]
    for place, write in made:
        with place as part:
            write(part)
    return list(tables.values())


# A column: its heading, its values, and what is to be known about it.
_Column = tuple[str, Any, dict[str, str]]


def _over(run: xr.Dataset, dimension: str) -> list[xr.DataArray]:
    return [variable for variable in run.data_vars.values() if variable.dims[:1] == (dimension,)]


def _columns(run: xr.Dataset, dimension: str) -> list[_Column]:
    """Return the columns of a table whose rows are the entries of a dimension."""
    index = [run[dimension]] if dimension in run.coords else []
    found = []
    for variable in [*index, *_over(run, dimension)]:
        about = {key: str(value) for key, value in variable.attrs.items()}
        unit = f" [{about['units']}]" if "units" in about else ""
        values = variable.to_numpy()
        if values.ndim == 1:
            found.append((f"{variable.name}{unit}", values, about))
            continue
        for label, column in zip(variable[variable.dims[1]].to_numpy(), values.T, strict=True):
            heading = f"{variable.name}[{label}]{unit}"
            found.append((heading, column, about | {str(variable.dims[1]): str(label)}))
    return found


def _csv(columns: list[_Column], _: dict[str, Any]) -> Callable[[Path], object]:
    # It comes with xarray.
    import pandas as pd

    # Every column under its own heading: names of bodies may repeat.
    told = [(_core.cell(heading), _cells(values)) for heading, values, _ in columns]
    table = pd.concat([pd.Series(values, name=heading) for heading, values in told], axis=1)
    return lambda file: table.to_csv(file, index=False)


def _cells(values: Any) -> Any:
    """Return texts as no spreadsheet takes them for formulas."""
    if values.dtype.kind not in "OUST":
        return values
    return [_core.cell(it) if isinstance(it, str) else it for it in values.tolist()]


def _parquet(columns: list[_Column], attributes: dict[str, Any]) -> Callable[[Path], object]:
    arrow = extra("pyarrow", "tables in Parquet")
    parquet = extra("pyarrow.parquet", "tables in Parquet")
    arrays = [arrow.array(_plain(values)) for _, values, _ in columns]
    fields = [
        arrow.field(heading, array.type, metadata=about)
        for (heading, _, about), array in zip(columns, arrays, strict=True)
    ]
    told = json.dumps(attributes, default=lambda value: np.asarray(value).tolist())
    schema = arrow.schema(fields, metadata={"chaindrive": told})
    table = arrow.Table.from_arrays(arrays, schema=schema)
    return lambda file: parquet.write_table(table, file)


def _plain(values: Any) -> Any:
    return values.tolist() if values.dtype.kind in "US" else np.ascontiguousarray(values)
