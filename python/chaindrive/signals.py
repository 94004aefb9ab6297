"""Signals that ask a program to end: a run ends its result before they take effect."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from types import FrameType

__all__: list[str] = []


def _unheard() -> list[signal.Signals]:
    """Return SIGTERM and SIGHUP where nobody has decided about them; `nohup` has about one."""
    names = [name for name in ("SIGTERM", "SIGHUP") if hasattr(signal, name)]
    numbers = [signal.Signals[name] for name in names]
    return [number for number in numbers if signal.getsignal(number) is signal.SIG_DFL]


def hear() -> None:
    """Have SIGTERM and SIGHUP stop this program as Ctrl-C does."""
    for number in _unheard():
        signal.signal(number, signal.default_int_handler)


@contextmanager
def heard() -> Iterator[None]:
    """Have SIGTERM and SIGHUP stop what goes on as Ctrl-C does before they take effect.

    Python hears signals in its main thread only; elsewhere nothing changes.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    caught: list[int] = []

    def stop(number: int, _: FrameType | None) -> None:
        caught.append(number)
        raise KeyboardInterrupt

    numbers = _unheard()
    _kept.update(numbers)
    for number in numbers:
        signal.signal(number, stop)
    try:
        yield
    finally:
        _let_go(numbers)
        if caught:
            signal.raise_signal(caught[0])


# Signals that take effect after what goes on.
_kept: set[signal.Signals] = set()


def _let_go(numbers: Iterable[signal.Signals]) -> None:
    for number in numbers:
        signal.signal(number, signal.SIG_DFL)
    _kept.difference_update(numbers)


# A worker that is forked meanwhile has no result to end: whoever ends it interrupts nobody else.
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=lambda: _let_go(tuple(_kept)))
