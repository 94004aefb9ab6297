"""Executors: tasks go out, answers come back, and what is lost on the way is told."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from typing import Any, TypeVar

from chaindrive import _core
from chaindrive.errors import SimulationError

__all__ = ["ORIGIN", "same_origin", "spread"]

_Task = TypeVar("_Task", bound=tuple[Any, ...])
_Answer = TypeVar("_Answer")

# Tasks that an executor has at a time: enough for hundreds of workers, few beside a large sweep.
_AHEAD = 1024

# Who computes here: workers of another origin would give other bits.
ORIGIN = f"{_core.__build__} on {_core._origin['instruction_set']}"


def same_origin(origin: str) -> None:
    """Refuse to compute for a process of another build, or on another instruction set."""
    if origin != ORIGIN:
        message = f"a worker has chaindrive {ORIGIN} instead of {origin}"
        remedy = "install the same build everywhere"
        if origin.split(" on ")[0] == _core.__build__:
            remedy = "set CHAINDRIVE_INSTRUCTION_SET to the same everywhere"
        raise SimulationError(message, "executor", remedy)


def spread(
    executor: Executor,
    work: Callable[..., _Answer],
    tasks: Iterable[_Task],
    take: Callable[[_Task, _Answer], object],
    lose: Callable[[_Task, Exception], object],
) -> tuple[KeyboardInterrupt | None, list[Exception]]:
    """Have an executor do some work on every task; return an interrupt, and why tasks were lost.

    `take` gets a task and its answer as soon as it is there, `lose` a task that was lost and the
    reason. After an interrupt neither hears of the tasks that had not come back.
    """
    pending: dict[Future[_Answer], _Task] = {}
    lost: list[Exception] = []
    waiting = list(tasks)[::-1]
    try:
        while True:
            try:
                while waiting and len(pending) < _AHEAD:
                    pending[executor.submit(work, *waiting[-1])] = waiting[-1]
                    waiting.pop()
            except Exception as error:
                # Such as a pool whose worker was killed: it takes no more tasks.
                lost.append(error)
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
                    lost.append(error)
                    lose(task, error)
                else:
                    take(task, answer)
    except KeyboardInterrupt as interrupt:
        return interrupt, lost
    finally:
        for future in pending:
            future.cancel()
