"""How far a run or a sweep is: a bar in the terminal or notebook, or a function that is told."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import import_module
from typing import Any

from chaindrive.extras import extra

__all__ = ["told"]

# Time elapsed, and time left at the speed of late.
_FORMAT = "{desc}: {percentage:3.0f} %|{bar}| {elapsed}, {remaining} left"


@contextmanager
def told(
    progress: bool | Callable[[float], object], what: str
) -> Iterator[Callable[[float], object] | None]:
    """Yield what is to be told how far something is: the function that was given, a bar, or None.

    Parameters
    ----------
    progress
        True for a bar, in a terminal or a notebook, and nothing in a pipe.
    what
        Name of the work, as the bar shows it.
    """
    if callable(progress) or not progress:
        yield progress if callable(progress) else None
        return
    bar = _Bar(what)
    try:
        yield bar
    finally:
        bar.close()


class _Bar:
    """One bar, which the run-in has first where there is one."""

    def __init__(self, what: str) -> None:
        self._what = self._phase = what
        # A pipe shows no bar. A notebook is none, though it is no terminal either.
        notebook = "ipykernel" in sys.modules
        shown = notebook or sys.stderr.isatty()
        self._bar: Any = extra("tqdm", "progress bars").tqdm(
            total=1.0,
            desc=what,
            bar_format=_FORMAT,
            miniters=0,
            disable=not shown,
            file=_Output() if notebook else None,
            ncols=80 if notebook else None,
        )

    def __call__(self, share: float) -> None:
        self._move(self._what, share)

    def run_in(self, share: float) -> None:
        """Take the share of the run-in; the run begins the bar anew."""
        self._move("run-in", share)

    def _move(self, phase: str, share: float) -> None:
        if self._bar.disable:
            return
        if phase != self._phase:
            self._phase = phase
            self._bar.set_description_str(phase, refresh=False)
            self._bar.reset()
        self._bar.update(share - self._bar.n)

    def close(self) -> None:
        self._bar.close()


class _Output:
    """One output of a notebook's cell, whose text is replaced.

    What is written to the standard error of a notebook is kept line by line, and the bar of
    ``tqdm.auto`` takes ipywidgets.
    """

    encoding = "utf-8"

    def __init__(self) -> None:
        self._shown: Any = None

    def write(self, text: str) -> None:
        line = text.strip()
        if not line:
            return
        as_text = {"text/plain": line}
        if self._shown is None:
            display = import_module("IPython.display").display
            self._shown = display(as_text, raw=True, display_id=True)
        else:
            self._shown.update(as_text, raw=True)

    def flush(self) -> None:
        """Do nothing: what is written is shown."""
