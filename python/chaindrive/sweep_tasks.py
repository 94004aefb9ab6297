"""Tasks of a sweep: numbers go out, answers come back, whoever computes and wherever results go."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from contextlib import contextmanager, suppress
from typing import Any
from uuid import uuid4

from chaindrive import _core
from chaindrive.extras import extra
from chaindrive.objects import Place

__all__ = ["begun", "carry_out"]

# Tasks that an executor has at a time: enough for hundreds of workers, few beside a large sweep.
_AHEAD = 1024

# In memory an executor gets so many tasks that its workers end at about the same time.
_TASKS = 128
# The outcomes of a task are sent back as a whole, and lost as a whole.
_LARGEST_TASK = 32

# Tasks in a store take about a second, and a pool has one or two more of them than workers [s].
_SOON = 4.0

# The worker of the sweep whose tasks this process carries out.
_opened: dict[str, _core.SweepWorker] = {}

# Open files that hold claims of this process. A process that is forked inherits them, and would
# keep a claim alive when this one is killed.
_claims: set[int] = set()


@contextmanager
def begun(
    core: _core.Sweep,
    place: Place | None,
    overwrite: bool,
    jobs: int | None,
    executor: Executor | None,
) -> Iterator[_core.SweepCoordinator]:
    """Begin a sweep in memory or in a store, or go on with it there; at the end let go of it."""
    if place is None:
        # Threads of this process wait for nothing: a task a variant.
        size = 1 if executor is None else min(max(len(core) // _TASKS, 1), _LARGEST_TASK)
        coordinator = _core.SweepCoordinator.in_memory(core, size)
    else:
        extra("zarr", "stores on disk")
        coordinator = _core.SweepCoordinator.in_store(place, core, overwrite, jobs)
    descriptor = coordinator.descriptor
    if descriptor is not None:
        _claims.add(descriptor)
    try:
        yield coordinator
    finally:
        _claims.discard(descriptor or -1)
        coordinator.close()


def carry_out(
    coordinator: _core.SweepCoordinator,
    executor: Executor | None,
    jobs: int | None,
    tell: Callable[[float], object] | None,
) -> tuple[BaseException | None, list[Exception]]:
    """Carry out all open tasks by threads of this process or by an executor.

    Returns
    -------
    stop
        What stopped it, such as Ctrl-C. Of an executor the answers count that have come back, or
        soon do.
    lost
        Reasons why the executor lost tasks, one a task.
    """
    if executor is None:
        return coordinator.run(jobs, tell), []
    stop = coordinator.start(tell)
    if stop is not None:
        return stop, []
    sweep = uuid4().hex
    pending: dict[Future[bytes], int] = {}
    lost: list[Exception] = []
    waiting = coordinator.open_tasks()[::-1]

    def lose(task: int, error: Exception) -> None:
        lost.append(error)
        reason = f"{type(error).__name__}: {error}"
        coordinator.lose(task, f"the executor lost this variant: {reason}")

    try:
        while True:
            try:
                while waiting and len(pending) < _AHEAD:
                    future = executor.submit(_task, coordinator.place, sweep, waiting[-1])
                    pending[future] = waiting.pop()
            except Exception as error:
                # Such as a pool whose worker was killed: it takes no more tasks.
                while waiting:
                    lose(waiting.pop(), error)
            if not pending:
                return None, lost
            for future in wait(pending, return_when=FIRST_COMPLETED).done:
                task = pending.pop(future)
                try:
                    answer = future.result()
                except Exception as error:
                    # A worker that died, or that has no chaindrive: others are not its fault.
                    lose(task, error)
                else:
                    coordinator.take(answer)
                if tell is not None:
                    tell(coordinator.share())
    except KeyboardInterrupt as interrupt:
        with suppress(KeyboardInterrupt):
            _take_what_is_under_way(coordinator, pending)
        return interrupt, lost
    finally:
        for future in pending:
            future.cancel()


def _take_what_is_under_way(
    coordinator: _core.SweepCoordinator, pending: Iterable[Future[bytes]]
) -> None:
    """Wait a little for tasks that nobody can stop: a store is to say what it holds."""
    running = [future for future in pending if not future.cancel()]
    for future in wait(running, timeout=_SOON).done:
        if future.exception() is None:
            coordinator.take(future.result())


def _task(place: Any, sweep: str, task: int) -> bytes:
    """Carry out a task; called by an executor, in whatever process it likes."""
    worker = _opened.get(sweep)
    if worker is None:
        # Once in each process and for each call of `sweep`.
        worker = _core.SweepWorker(place)
        _opened.clear()
        _opened[sweep] = worker
    return worker.carry_out(task)


def _let_go() -> None:
    for descriptor in _claims:
        os.close(descriptor)
    _claims.clear()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_let_go)
