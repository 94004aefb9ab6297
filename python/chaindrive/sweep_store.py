"""Sweeps in a store that their workers write: tasks go out, and counts come back."""

from __future__ import annotations

import os
import time
import warnings
from collections.abc import Callable
from concurrent.futures import Executor
from typing import Any
from uuid import uuid4

import xarray as xr

from chaindrive import _core
from chaindrive.errors import DistrustedResultWarning, SimulationError, WriteError
from chaindrive.executors import ORIGIN, same_origin, spread
from chaindrive.extras import extra
from chaindrive.objects import Objects, Place
from chaindrive.results import _open
from chaindrive.signals import heard

__all__ = ["into_store"]

# The worker of the sweep whose tasks this process carries out.
_opened: dict[str, _core.SweepWorker] = {}

# Open files that hold claims of this process. A process that is forked inherits them, and would
# keep a claim alive when this one is killed.
_claims: set[int] = set()


def into_store(
    core: _core.Sweep,
    place: Place,
    overwrite: bool,
    jobs: int | None,
    executor: Executor | None,
    tell: Callable[[float], object] | None,
) -> xr.Dataset:
    """Begin a sweep in a store, or go on with it, and return the store as a dataset."""
    extra("zarr", "stores on disk")
    begin = time.perf_counter()
    if isinstance(place, Objects):
        is_there = place.size("zarr.json") is not None
    else:
        is_there = os.path.lexists(place)
    if overwrite or not is_there:
        try:
            store = _core.SweepStore.begin(place, core, overwrite, jobs)
        except WriteError:
            # The same sweep may have been begun by somebody else while some variants were timed.
            if overwrite or isinstance(place, str) or place.size("zarr.json") is None:
                raise
            store = _core.SweepStore.go_on(place, core)
    else:
        store = _core.SweepStore.go_on(place, core)
    descriptor = store.descriptor() if hasattr(store, "descriptor") else None
    if descriptor is not None:
        _claims.add(descriptor)
    stop: Any = None
    lost: list[Exception] = []
    try:
        with heard():
            stop = store.start(tell)
        if not store.is_public():
            stop.add_note(f"{place} holds the earlier result: of this sweep nothing was stored")
            raise stop
        if stop is None:
            if executor is None:
                with heard():
                    stop = store.run(jobs, tell)
            else:
                to_workers = place if isinstance(place, Objects) else os.fspath(store.place())
                stop, lost = _spread(store, to_workers, len(core), executor, tell)
        told = store.finish()
    finally:
        _claims.discard(descriptor or -1)
        store.close()
    if stop is not None and not isinstance(stop, KeyboardInterrupt):
        raise stop
    dataset = _open(place)
    dataset.attrs["wall_time"] = time.perf_counter() - begin
    dataset.attrs["summary"] = told["summary"]
    if told["warning"]:
        warnings.warn(told["warning"], DistrustedResultWarning, stacklevel=3)
    goes_on = (
        f"{place} holds {len(core) - told['open']} of {len(core)} variants: the same call goes on"
    )
    if stop is not None:
        # The very exception, for a class of its own would change the exit code of a script.
        interrupt: Any = stop
        interrupt.result = dataset
        interrupt.add_note(goes_on)
        raise interrupt
    if told["open"]:
        first = f"{type(lost[0]).__name__}: {lost[0]}" if lost else "no reason was given"
        message = f"the executor lost {max(len(lost), 1)} tasks, the first by {first}; {goes_on}"
        raise SimulationError(message, "executor") from (lost[0] if lost else None)
    return dataset


def _spread(
    store: _core.SweepStore,
    place: Place,
    variants: int,
    executor: Executor,
    tell: Callable[[float], object] | None,
) -> tuple[KeyboardInterrupt | None, list[Exception]]:
    """Have an executor carry out all open tasks; return an interrupt, and why tasks were lost."""
    sweep = uuid4().hex

    def take(_: object, counts: tuple[int, int, int]) -> None:
        store.count(counts)
        if tell is not None:
            tell(store.stored() / variants)

    tasks = [(ORIGIN, place, sweep, task) for task in store.open_tasks()]
    # What is lost stays open, and the same call goes on with it.
    return spread(executor, _task, tasks, take, lambda *_: None)


def _task(origin: str, place: Place, sweep: str, task: int) -> tuple[int, int, int]:
    """Carry out a task; called by an executor, in whatever process it likes."""
    same_origin(origin)
    return _worker(place, sweep).carry_out(task)


def _worker(place: Place, sweep: str) -> _core.SweepWorker:
    """Open a store, once in each process and for each call of `sweep`."""
    worker = _opened.get(sweep)
    if worker is None:
        worker = _core.SweepWorker(place)
        _opened.clear()
        _opened[sweep] = worker
    return worker


def _let_go() -> None:
    for descriptor in _claims:
        os.close(descriptor)
    _claims.clear()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_let_go)
