"""Packages that analysis takes beside the package itself, asked for by name."""

from __future__ import annotations

from importlib import import_module
from typing import Any

__all__ = ["needed"]


def __dir__() -> list[str]:
    return list(__all__)


def needed(module: str) -> Any:
    """Return a module of the extra ``analysis``.

    Raises
    ------
    ImportError
        It is not installed; the message says what to install.
    """
    try:
        return import_module(module)
    except ImportError as error:
        package = module.partition(".")[0]
        message = f"this analysis takes the package {package}: pip install 'chaindrive[analysis]'"
        raise ImportError(message) from error
