"""Faults as exceptions under `ChaindriveError`, and warnings.

Every exception carries `path`, the place it speaks of, and `hint`, what to try, where they are
known; otherwise they are None.

A warning points at the line of the program that called this package, and filters know it by its
class: ``warnings.filterwarnings("error", category=chaindrive.VerdictWarning)``. Python reads its
option ``-W`` before it can import packages: there, all of them are ``UserWarning``. Functions print
nothing. The logger ``chaindrive`` has two lines at the level ``WARNING``, which Python shows unless
told otherwise: before a run that is foretold to take above ten minutes, and after a second and a
half of a run that nobody watches by ``progress``, what goes on.
``logging.getLogger("chaindrive").setLevel(logging.ERROR)`` keeps it quiet,
``logging.captureWarnings(True)`` puts warnings into the log of a program too.
"""

from __future__ import annotations

import sys
import warnings
from collections.abc import Iterable
from typing import NamedTuple

from chaindrive import _core

__all__ = [
    "AssemblyError",
    "CautiousResultWarning",
    "ChaindriveError",
    "ClashWarning",
    "DistrustedResultWarning",
    "IntegrationError",
    "MeasurementError",
    "MeasurementWarning",
    "ParameterError",
    "Problem",
    "ProgramError",
    "ResultWarning",
    "ResumeError",
    "SceneError",
    "SimulationError",
    "VerdictWarning",
    "WriteError",
]


class Problem(NamedTuple):
    """One thing to mend in a scene."""

    path: str
    """Place in the scene, such as ``sprockets[1].teeth``; empty for the text as a whole."""
    line: int | None
    """Line of the text, counted from 1; None in a scene of values, which stands in no text."""
    message: str
    """The mistake, with the offending value."""
    hint: str | None
    """The values that are allowed, or something to try."""
    column: int | None = None
    """Column of the line, counted from 1; None where the line is meant as a whole."""


class ChaindriveError(Exception):
    """Anything this package refuses or fails to do.

    Attributes
    ----------
    path : str or None
        The place: a path in a scene, a parameter, a file.
    hint : str or None
        The values that are allowed, or something to try.
    """

    path: str | None
    hint: str | None

    def __init__(self, message: str, path: str | None = None, hint: str | None = None) -> None:
        # Scenes and files of unknown origin speak in messages.
        super().__init__(_core.plain(message))
        self.path = path
        self.hint = hint

    def __str__(self) -> str:
        return str(self.args[0])


class SceneError(ChaindriveError, ValueError):
    """A text is not a scene, or a scene not a drive.

    Attributes
    ----------
    problems : list of Problem
        Everything that was found, in the order of the text; at least one.
    source : str or None
        File, preset or whatever the text was called.
    path, hint : str or None
        Those of the first problem.
    """

    problems: list[Problem]
    source: str | None

    def __init__(
        self,
        message: str,
        problems: Iterable[tuple[str, int | None, str, str | None, int | None]] = (),
        source: str | None = None,
    ) -> None:
        self.problems = [Problem(*problem) for problem in problems]
        self.source = source
        first = self.problems[0] if self.problems else Problem("", None, message, None)
        super().__init__(message, first.path, first.hint)


class ParameterError(ChaindriveError, ValueError):
    """An argument is outside its range; `path` names it, `hint` says what is allowed."""


class SimulationError(ChaindriveError, RuntimeError):
    """A simulation could not start or go on."""


class AssemblyError(SimulationError):
    """A valid drive could not be brought into its initial state: it does not close or settle."""


class IntegrationError(SimulationError):
    """The time stepping failed: an unstable step, or a motion that ceased to be finite."""


class ProgramError(ChaindriveError, RuntimeError):
    """The package made a mistake of its own: its message is what to report."""


class WriteError(ChaindriveError, OSError):
    """Results could not be written; `path` is the file."""

    def __init__(self, message: str, path: object = None, hint: str | None = None) -> None:
        super().__init__(message, None if path is None else str(path), hint)


class ResumeError(ChaindriveError, ValueError):
    """A run cannot be carried on: there is nothing to go on from; `path` is its result."""

    def __init__(self, message: str, path: object = None, hint: str | None = None) -> None:
        super().__init__(message, None if path is None else str(path), hint)


class MeasurementError(ChaindriveError, ValueError):
    """A measurement cannot be read or used; `path` is its file, channel or argument."""

    def __init__(self, message: str, path: object = None, hint: str | None = None) -> None:
        told = message if hint is None else f"{message}; {hint}"
        super().__init__(told, None if path is None else str(path), hint)


def warn(message: str, category: type[Warning]) -> None:
    """Warn at the line outside of this package from which it was called, however deep it is."""
    frame, level = sys._getframe(), 1
    while frame.f_globals.get("__name__", "").partition(".")[0] == "chaindrive" and frame.f_back:
        frame, level = frame.f_back, level + 1
    warnings.warn(_core.plain(message), category, stacklevel=level)


def tell(message: object) -> None:
    """Write a line to the standard error output; texts of others command no terminal in it."""
    print(_core.plain(str(message)), file=sys.stderr)


class ResultWarning(UserWarning):
    """A result is less than it was meant to be."""


class MeasurementWarning(UserWarning):
    """A measurement has faults: its attribute ``findings`` names them."""


class ClashWarning(UserWarning):
    """Bodies of a drive are in each other's way, unless they pass side by side."""


class VerdictWarning(UserWarning):
    """A result is not to be trusted without a second look: its attribute ``verdict`` says how far.

    ``warnings.simplefilter("error", chaindrive.VerdictWarning)`` makes an exception of every such
    result.
    """


class DistrustedResultWarning(VerdictWarning):
    """A result contradicts itself: its attribute ``verdict`` is ``"distrusted"``."""


class CautiousResultWarning(VerdictWarning):
    """Some of a result is uncertain or was not examined: its ``verdict`` is ``"caution"``.

    Most short runs are, so that nothing is said unless there is a filter for it, or for
    `VerdictWarning`: ``warnings.simplefilter("default", chaindrive.CautiousResultWarning)``.
    """


def __dir__() -> list[str]:
    return list(__all__)
