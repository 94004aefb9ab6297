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
    from chaindrive.settings import MethodName, Quantity, Recorded, Target

__all__ = ["LIBRARY", "export"]

LIBRARY = Path(__file__).with_name("library") / _core.fmu_library()
"""Library of the units, prebuilt for this platform."""


def export(
    drive: Drive,
    path: str | PathLike[str],
    *,
    fmi: Literal[2, 3] = 3,
    record: Recorded | Sequence[Recorded] | None = None,
    run: bool = True,
    until: Quantity | None = None,
    run_in: Quantity | None = None,
    method: MethodName | None = None,
    step: Quantity | None = None,
    tolerance: Quantity | None = None,
    onset_depth: Quantity | None = None,
    accuracy: Quantity | None = None,
    accuracy_of: Target | None = None,
    library: str | PathLike[str] | None = None,
    overwrite: bool = False,
    progress: Callable[[float], object] | None = None,
) -> Path:
    """Write a functional mock-up unit (FMU) for co-simulation in other programs.

    The unit needs neither Python nor this package. Every shaft takes ``set_torque``,
    ``set_speed`` or ``set_angle``, which its parameter ``input`` chooses; tensioners take
    ``set_force``, fixed centres ``set_centre_x`` and ``set_centre_y``, and what the scene lists
    under ``tunable`` is a tunable parameter. Outputs are the entries of channels, such as
    ``span_tension[crank-camshaft]``, in SI units.

    Parameters
    ----------
    path
        The file to write; its name ends in ``.fmu``.
    fmi
        Version of the standard.
    record
        Channels whose entries are outputs; those of sprockets, shafts, spans, tensioners and
        energies when absent.
    run
        Whether a run without inputs is made, whose verdict and horizon the constants
        ``at_export`` hold.
    until, run_in, method, step, tolerance, onset_depth, accuracy, accuracy_of
        As in `Simulation`; `until` ends that run.
    library
        Library of the unit; that of this package when absent.
    overwrite
        Whether an earlier file of this name is replaced.
    progress
        Called with the share of that run that is done.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    ParameterError, SceneError
        A setting out of range, another ending, or a channel that the drive does not have.
    AssemblyError
        The drive does not close or settle.
    WriteError
        The file exists, or cannot be written.

    Examples
    --------
    >>> import chaindrive as cd
    >>> unit = cd.scenes.marine_two_sprockets().fmu("drive.fmu", run=False)  # doctest: +SKIP
    """
    target = Path(path)
    if target.suffix != ".fmu":
        message = f"{target}: the name must end in .fmu"
        raise ParameterError(message, "path", "such as drive.fmu")
    try:
        is_taken = target.exists()
    except OSError as error:
        # A name that the system does not take.
        raise WriteError(f"{target}: {error.strerror}", target, "give another name") from error
    if is_taken and not overwrite:
        message = f"{target}: there is already a file here"
        raise WriteError(message, target, "give `overwrite=True`, or another name")
    settings: dict[str, Any] = {
        "record": [record] if isinstance(record, str) else record,
        "until": until,
        "run_in": run_in,
        "method": method,
        "step": step,
        "tolerance": tolerance,
        "onset_depth": onset_depth,
        "accuracy": accuracy,
        "accuracy_of": accuracy_of,
    }
    _core.fmu(
        drive._inner,
        [(name, value) for name, value in settings.items() if value is not None],
        path=target,
        name=target.stem,
        version=fmi,
        run=run,
        library=LIBRARY if library is None else library,
        progress=progress,
    )
    return target
