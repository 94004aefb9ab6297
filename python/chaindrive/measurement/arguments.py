"""What a command line says, as arguments of this package."""

from __future__ import annotations

import sys
import tomllib
from collections.abc import Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import xarray as xr

from chaindrive._core import NewFile
from chaindrive.drive import Drive, load
from chaindrive.errors import MeasurementError
from chaindrive.measurement.record import measured
from chaindrive.reporting import named

__all__ = [
    "drive_of",
    "is_seen",
    "number_of",
    "pairs_of",
    "place_of_output",
    "ranges_of",
    "record_of",
    "rig_of",
    "rows_of",
    "runs_of",
]

#: Arguments of `measured` that a rig file may have.
_RIG = ("channels", "turns", "time", "rate", "start", "until", "orders")
_RIG_TEXT = ("encoding", "decimal", "separator")
_EXAMPLE = "chain.stiffness=10 MN/m"


def record_of(options: Mapping[str, Any]) -> xr.Dataset:
    """Return the measurement, read as the rig file says."""
    return measured(options["data"], **rig_of(options))


def rig_of(options: Mapping[str, Any]) -> dict[str, Any]:
    """Return the arguments of `measured` in the rig file; none where none is given."""
    if options["rig"] is None:
        return {}
    place = Path(options["rig"])
    try:
        rig = tomllib.loads(place.read_text(encoding="utf-8"))
    except OSError as error:
        raise MeasurementError(f"{place}: {error.strerror}", place) from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise MeasurementError(f"{place}: this is no TOML: {error}", place) from error
    known = (*_RIG, *_RIG_TEXT)
    strange = [it for it in rig if it not in known]
    if strange:
        message = f"{place}: a rig has no {strange[0]!r}"
        raise MeasurementError(message, place, f"it has {', '.join(known)}")
    return rig


def drive_of(options: Mapping[str, Any]) -> Drive:
    """Return the drive of a file or a preset."""
    found = named(options["source"])
    return found if isinstance(found, Drive) else load(found)


def ranges_of(option: str, texts: Sequence[str]) -> dict[str, tuple[Any, Any]]:
    """Return ends by path, of texts such as ``chain.stiffness=10 MN/m..40 MN/m``."""
    found = {}
    for path, text in pairs_of(option, texts, f"{_EXAMPLE}..40 MN/m").items():
        low, dots, high = text.partition("..")
        if not dots:
            message = f"--{option} {path}={text}: this is no path and two bounds"
            raise MeasurementError(message, option, f'such as --{option} "{_EXAMPLE}..40 MN/m"')
        ends = (number_of(low), number_of(high))
        bare = [it for it in ends if isinstance(it, float)]
        if len(bare) == 1:
            message = f"--{option} {path}={text}: one bound has a unit, and the other none"
            raise MeasurementError(message, option, f"give {bare[0]:g} its unit too")
        found[path] = ends
    return found


def pairs_of(option: str, texts: Sequence[str], example: str) -> dict[str, str]:
    """Return texts by path, of texts such as ``chain.stiffness=10 MN/m``."""
    found = {}
    for given in texts:
        path, sign, text = given.partition("=")
        if not (path.strip() and sign):
            message = f"--{option} {given}: this is no path and what belongs to it"
            raise MeasurementError(message, option, f'such as --{option} "{example}"')
        found[path.strip()] = text.strip()
    return found


def number_of(text: str) -> Any:
    """Return a number in a text as such, and other texts as they are."""
    try:
        return float(text)
    except ValueError:
        return text.strip()


def runs_of(options: Mapping[str, Any]) -> dict[str, Any]:
    """Return how runs are made: length, store, jobs, progress."""
    given = {
        name: options[name] for name in ("until", "store", "jobs") if options[name] is not None
    }
    if "until" in given:
        given["until"] = number_of(given["until"])
    return given | {"progress": is_seen()}


def is_seen() -> bool:
    """Tell whether somebody would see a bar, and its package is there."""
    return sys.stderr.isatty() and find_spec("tqdm") is not None


def place_of_output(text: str, endings: Sequence[str], overwrite: bool) -> NewFile:
    """Return the place of a file, before anything is simulated."""
    if Path(text).suffix not in endings:
        message = f"{text}: the name must end in {' or '.join(endings)}"
        raise MeasurementError(message, text)
    return NewFile(text, overwrite)


def rows_of(found: xr.Dataset, dim: str, columns: tuple[str, ...]) -> list[dict[str, Any]]:
    """Return columns along a dimension as a list of objects, its label first."""
    labels = found[dim].to_numpy().tolist()
    tables = [(name, found[name].to_numpy().tolist()) for name in columns]
    return [
        {dim: label} | {name: values[row] for name, values in tables}
        for row, label in enumerate(labels)
    ]
