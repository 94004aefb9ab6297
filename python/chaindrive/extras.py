"""Packages that some functions take and that are installed by name: the extras of the wheel."""

from __future__ import annotations

from importlib import import_module
from typing import Any

__all__ = ["extra"]

# The extra that brings each package; pyproject.toml says in which version.
_BRINGS = {
    "SALib": "uncertainty",
    "asammdf": "measured-mdf",
    "dask": "dask",
    "distributed": "dask",
    "ezdxf": "dxf",
    "h5netcdf": "netcdf",
    "h5py": "netcdf",
    "imageio": "movie",
    "imageio_ffmpeg": "movie",
    "matplotlib": "plot",
    "nptdms": "measured-tdms",
    "obstore": "object-store",
    "pyarrow": "parquet",
    "scipy": "analysis",
    "tqdm": "progress",
    "zarr": "zarr",
}


def extra(module: str, what: str) -> Any:
    """Import a module of a package that an extra brings.

    Parameters
    ----------
    module
        The module: ``"matplotlib.pyplot"``.
    what
        The feature that takes it, as the subject of a sentence in the plural: ``"plots"``.

    Raises
    ------
    ModuleNotFoundError
        The package is not installed; the message says how to get it.
    """
    package = module.partition(".")[0]
    try:
        return import_module(module)
    except ModuleNotFoundError as error:
        # A package that is there and broken has reasons of its own.
        if (error.name or "").partition(".")[0] != package:
            raise
        how = f"pip install 'chaindrive[{_BRINGS[package]}]'"
        message = f"{what} take the package {package}: {how}"
        raise ModuleNotFoundError(message, name=package) from error
