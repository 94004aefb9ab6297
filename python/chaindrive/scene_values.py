"""Values of Python as those of a scene, and what no scene holds."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from itertools import islice
from os import PathLike, fspath
from typing import Any

import numpy as np

from chaindrive.errors import SceneError
from chaindrive.quantity import with_unit

__all__ = ["scene_json"]

_TAKEN = "a number, text, truth value, list, dict or NumPy array of finite numbers"
# Of mistakes, as many as anybody mends at once.
_MOST_MISTAKES = 100
_DEEPEST = 32


def scene_json(value: Any, name: str, path: str) -> str:
    """Return a part of a scene, which has this name and stands at this path, as JSON."""
    try:
        return json.dumps(value, default=_plain, allow_nan=False)
    except (TypeError, ValueError, RecursionError) as error:
        found = list(islice(_mistakes(value, path), _MOST_MISTAKES)) or [(path, str(error))]
        told = "\n".join(f"{name}: {at}: {what}; {_TAKEN}" for at, what in found)
        problems = [(at, None, what, _TAKEN, None) for at, what in found]
        raise SceneError(told, problems, name) from None


def _mistakes(value: Any, path: str, depth: int = 0) -> Iterator[tuple[str, str]]:
    """Find what no scene holds, each with its path."""
    if depth > _DEEPEST:
        yield path, "nested deeper than any scene"
    elif isinstance(value, dict):
        for key, within in value.items():
            if isinstance(key, str):
                yield from _mistakes(within, f"{path}.{key}".lstrip("."), depth + 1)
            else:
                yield path, f"the key {key!r} is no text"
    elif isinstance(value, list | tuple):
        for index, within in enumerate(value):
            yield from _mistakes(within, f"{path}[{index}]", depth + 1)
    elif isinstance(value, float):
        if not math.isfinite(value):
            yield path, f"{value}, must be finite"
    elif value is not None and not isinstance(value, str | int):
        try:
            plain = _plain(value)
        except (TypeError, ValueError) as error:
            yield path, str(error)
        else:
            yield from _mistakes(plain, path, depth + 1)


def _plain(value: object) -> object:
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    if isinstance(value, PathLike):
        return fspath(value)
    measured = with_unit(value)
    if measured is not value:
        return measured
    import xarray as xr

    if isinstance(value, xr.DataArray):
        return value.to_numpy().tolist()
    raise TypeError(f"{type(value).__name__} has no place in a scene")
