"""Every format that is read: the ending of a name, and who reads it."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from os import PathLike
from pathlib import Path
from typing import Any

import xarray as xr

from chaindrive.errors import ChaindriveError, MeasurementError
from chaindrive.measurement.raw import RawRecord

__all__ = ["FORMATS", "read_raw"]

#: Endings of names, what the format is called, and the module that has its `read`.
FORMATS: Mapping[str, tuple[str, str]] = {
    ".csv": ("a table of text", "text_table"),
    ".txt": ("a table of text", "text_table"),
    ".tsv": ("a table of text", "text_table"),
    ".dat": ("a table of text", "text_table"),
    ".asc": ("a table of text", "text_table"),
    ".parquet": ("Parquet", "data_frame"),
    ".nc": ("NetCDF", "netcdf"),
    ".h5": ("HDF5", "hdf5"),
    ".hdf5": ("HDF5", "hdf5"),
    ".hdf": ("HDF5", "hdf5"),
    ".tdms": ("TDMS", "tdms"),
    ".mf4": ("MDF", "mdf"),
    ".mdf": ("MDF", "mdf"),
    ".wav": ("WAV", "sound"),
}


def read_raw(source: Any, options: Mapping[str, Any]) -> tuple[RawRecord, str]:
    """Return the channels of a file, a DataFrame or a dataset, and the name of the source.

    Raises
    ------
    MeasurementError
        There is no such file, its ending is of no format, or its reader refuses it.
    """
    if isinstance(source, xr.Dataset):
        return _with_channels(_of("netcdf").read_dataset(source), "dataset"), "dataset"
    if not isinstance(source, str | PathLike):
        if hasattr(source, "columns") and hasattr(source, "index"):
            return _with_channels(_of("data_frame").read_frame(source), "DataFrame"), "DataFrame"
        kind = type(source).__name__
        message = f"path is a {kind}, needed is a file, a pandas DataFrame or an xarray Dataset"
        raise TypeError(message)
    path = Path(source)
    known = FORMATS.get(path.suffix.lower())
    if known is None:
        endings = ", ".join(FORMATS)
        message = f"{path}: no format ends in {path.suffix or 'nothing'!r}"
        raise MeasurementError(message, path, f"one of {endings}; or read it into a DataFrame")
    if not path.is_file():
        what = "is a folder" if path.is_dir() else "does not exist"
        raise MeasurementError(f"{path} {what}", path, "the file of a measurement")
    if path.stat().st_size == 0:
        raise MeasurementError(f"{path} is empty", path, "a file with channels in it")
    name, module = known
    own = {"encoding", "decimal", "separator"} if module == "text_table" else set()
    for option in options:
        if option not in own:
            message = f"{path}: {option} is for tables of text, and this is {name}"
            raise MeasurementError(message, option, "leave it out")
    try:
        record: RawRecord = _of(module).read(path, **options)
    except (ChaindriveError, ModuleNotFoundError, MemoryError):
        raise
    except Exception as error:
        # Whatever a library makes of a file that is none of its format.
        reason = " ".join(str(error).split()) or type(error).__name__
        message = f"{path}: this cannot be read as {name}: {reason[:300]}"
        raise MeasurementError(
            message, path, "is the file whole, and is its ending right?"
        ) from error
    return _with_channels(record, path), path.name


def _with_channels(record: RawRecord, source: str | Path) -> RawRecord:
    """Return a record as it is, or refuse one that holds no number."""
    if not any(it.values.size for it in record.channels):
        raise MeasurementError(f"{source}: no channel of numbers is in it", source)
    return record


def _of(module: str) -> Any:
    """Import a reader: what it takes is not installed everywhere."""
    return import_module(f"chaindrive.measurement.{module}")
