"""Functional mock-up units: a drive as a part of a simulation in another program."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from chaindrive import _core
from chaindrive.errors import ParameterError, WriteError

if TYPE_CHECKING:
    from chaindrive.drive import Drive

__all__ = ["LIBRARY", "write"]

LIBRARY = Path(__file__).with_name(_core.fmu_library())
"""Library of the units, prebuilt for this platform."""


def write(
    drive: Drive,
    path: str | PathLike[str],
    settings: dict[str, Any],
    *,
    fmi: Literal[2, 3],
    run: bool,
    library: str | PathLike[str] | None,
    overwrite: bool,
    progress: Callable[[float], object] | None,
) -> Path:
    """Write the unit of a drive; see `Drive.fmu`."""
    target = Path(path)
    if target.suffix != ".fmu":
        message = f"{target}: the name must end in .fmu"
        raise ParameterError(message, "path", "such as drive.fmu")
    if target.exists() and not overwrite:
        message = f"{target}: there is already a file here"
        raise WriteError(message, target, "give `overwrite=True`, or another name")
    given: list[tuple[str, Any | Sequence[str]]] = []
    for name, value in settings.items():
        if value is not None:
            given.append((name, [value] if name == "record" and isinstance(value, str) else value))
    _core.fmu(
        drive._inner,
        given,
        path=target,
        name=target.stem,
        version=fmi,
        run=run,
        library=LIBRARY if library is None else library,
        progress=progress,
    )
    return target
