"""A page that needs nothing else: a notebook shows it, a file keeps it."""

from __future__ import annotations

import html
from os import PathLike
from pathlib import Path
from typing import ClassVar

from chaindrive import _core

__all__ = ["ShownPage"]


class ShownPage:
    """One HTML page that asks for nothing outside of itself.

    In a notebook it shows itself, and stays when the notebook is converted: the page is part of
    the output and asks for no kernel and no network.
    """

    #: Its kind, as readers of screens name it.
    _kind: ClassVar[str] = "page"
    #: Height in a notebook [pixels].
    _height: ClassVar[int] = 640

    def __init__(self, page: str) -> None:
        self.html = page
        """The page."""

    def save(self, path: str | PathLike[str]) -> Path:
        """Write the page to a file, in place of what was there, and return its path."""
        _core.NewFile(path).write(self.html.encode())
        return Path(path)

    def _repr_html_(self) -> str:
        # The page lives in a frame of its own: neither its style nor its names meet the notebook's.
        return (
            f'<iframe srcdoc="{html.escape(self.html)}" title="{self._kind}" '
            f'style="width: 100%; height: {self._height}px; border: 0"></iframe>'
        )

    def __repr__(self) -> str:
        size = len(self.html) / 1e6
        return f"<chaindrive.{type(self).__name__}, {size:.2f} MB of HTML>"
