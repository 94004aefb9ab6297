"""Results on disk: read them, and learn whether they are what they were meant to be."""

from __future__ import annotations

from os import PathLike
from typing import TYPE_CHECKING, Any

import xarray as xr

import chaindrive.labelled  # noqa: F401  registers `run.drive`
from chaindrive import _core
from chaindrive.errors import ResultWarning, warn
from chaindrive.extras import extra
from chaindrive.objects import Objects, Place, place_of
from chaindrive.page import show_verdicts

if TYPE_CHECKING:
    from obstore.store import ObjectStore

__all__ = ["held", "open_result", "take_over"]


def open_result(path: str | PathLike[str] | ObjectStore) -> xr.Dataset:
    """Open a result that was written to disk, at its end or while it is being written.

    Parameters
    ----------
    path
        The Zarr store of a run or a sweep: a path, or for sweeps in object stores an address or a
        store of ``obstore``.

    Returns
    -------
    xarray.Dataset
        The dataset that `simulate` or `sweep` returned, read from the store on demand. Its
        attribute ``status`` is ``"complete"``, ``"running"`` while a process writes it,
        ``"interrupted"``, ``"failed"``, with the reason in ``failure``, or ``"killed"``: the
        process that wrote it is gone without a word. In object stores nobody can tell the last from
        ``"running"``.

    Raises
    ------
    ValueError
        This is not a result of chaindrive, or it is damaged: it does not hold what it declares, is
        packed in another way, or leads elsewhere. Results of others carry out no code. Arrays are
        read when they are asked for: a damaged chunk raises then, whatever Zarr raises.
    FileNotFoundError
        Nothing is there.
    WriteError
        It cannot be told whether the result is being written.

    Warns
    -----
    ResultWarning
        The result ends early: it was interrupted, it failed, or it was killed.

    Examples
    --------
    >>> import tempfile
    >>> import chaindrive as cd
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     run = cd.simulate(cd.scenes.spinning_ring(), until=2e-3, output=f"{folder}/ring.zarr")
    ...     cd.open_result(f"{folder}/ring.zarr").attrs["status"]
    'complete'
    """
    extra("zarr", "stores on disk")
    show_verdicts()
    name = place_of(path)
    # A writer says how it ended before it gives its claim back: looked at again, a result that
    # nobody writes has ended, or its writer was killed.
    stored = _open(name)
    if isinstance(name, str) and _is_left(stored, name):
        stored = _open(name)
        if _is_left(stored, name):
            stored.attrs["status"] = "killed"
    status = stored.attrs["status"]
    if status not in ("complete", "running"):
        reason = " ".join(str(stored.attrs.get("failure", "")).split())
        held = stored.attrs.get("samples", stored.attrs.get("finished"))
        kind = "samples" if "samples" in stored.attrs else "variants"
        ending = f"{status}: {reason}" if reason else status
        warn(f"{name}: {ending}; it holds {held} {kind}", ResultWarning)
    return stored


def held(stored: xr.Dataset, of: str) -> xr.Dataset:
    """Return a dataset with its arrays read, which may be damaged in their store.

    Parameters
    ----------
    stored
        What is wanted of a run, read from a store or not.
    of
        What the run is called in the message.

    Raises
    ------
    ValueError
        An array cannot be unpacked.
    """
    try:
        return stored.load()
    except (ValueError, MemoryError):
        raise
    except Exception as error:
        # Whatever Zarr and its codecs make of a damaged chunk.
        raise ValueError(f"{of}: this result is damaged: {error!r}") from error


def _is_left(stored: xr.Dataset, name: str) -> bool:
    return stored.attrs["status"] == "running" and not _core.is_being_written(name)


def _open(name: Place) -> xr.Dataset:
    store: Any = name
    if isinstance(name, Objects):
        store = extra("zarr.storage", "stores").ObjectStore(name.store, read_only=True)
    zarr = extra("zarr", "stores on disk")
    try:
        if isinstance(name, str):
            _core.inspect(name)
        # Arrays of older formats may be packed by codecs that carry out code.
        attributes = zarr.open_group(store, mode="r", zarr_format=3).attrs
        if attributes.get("format") != "chaindrive" or "status" not in attributes:
            raise ValueError(
                f"{name}: this is not a result of chaindrive; xarray.open_zarr reads others"
            )
        stored: xr.Dataset = xr.open_zarr(store, chunks=None, zarr_format=3, consolidated=True)
    except FileNotFoundError as error:
        raise FileNotFoundError(
            f"{name}: there is no result here; check the path, a result's name ends in .zarr"
        ) from error
    except (ValueError, OSError):
        raise
    except Exception as error:
        # Whatever Zarr and xarray make of a store that contradicts itself.
        raise ValueError(f"{name}: this result is damaged: {error!r}") from error
    for array in stored.variables.values():
        array.attrs = _told(array.attrs)
    stored.attrs = _told(stored.attrs)
    return stored.assign_coords(_labels(stored))


def _told(attributes: dict[str, Any]) -> dict[str, Any]:
    """Return attributes as a terminal may have them, whoever wrote them."""
    return {
        name: _text(name, value) if isinstance(value, str) else value
        for name, value in attributes.items()
    }


# Attributes that stand in a line of ours.
_NAMES = {"title", "scene_name", "units", "long_name"}


def _text(name: str, value: str) -> str:
    if name in _NAMES:
        return _core.one_line(value)
    if value[:1] in ("{", "["):
        return _core.plain_json(value)
    # A scene may have lines as Windows ends them.
    return "\r\n".join(_core.plain(line) for line in value.split("\r\n"))


def _labels(stored: xr.Dataset) -> dict[str, Any]:
    """Return the coordinates whose labels a terminal may not have, with these spelled."""
    found = {}
    for name, values in stored.coords.items():
        if values.dtype.kind in "OTU" and values.ndim == 1:
            labels = [str(label) for label in values.to_numpy()]
            told = [_core.one_line(label) for label in labels]
            if told != labels:
                found[str(name)] = (values.dims, told, values.attrs)
    return found


def take_over(path: str | PathLike[str]) -> None:
    """Remove the folder of a writer, `.NAME.writing`, that another user left beside a result.

    Results can then be written there again. Only the folder beside the result is removed.

    Parameters
    ----------
    path
        The result.

    Raises
    ------
    WriteError
        A process that lives writes there.
    """
    _core.take_over(path)
