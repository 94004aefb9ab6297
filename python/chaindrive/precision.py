"""Cost and error of methods and steps."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
import xarray as xr

from chaindrive import _core
from chaindrive.drive import Drive, _needed, _number
from chaindrive.errors import ParameterError
from chaindrive.settings import MethodName, Quantity

__all__ = ["work_precision"]


def work_precision(
    drive: Drive,
    *,
    methods: MethodName | Iterable[MethodName] = (),
    steps: Iterable[Quantity] = (),
    tolerances: Iterable[Quantity] = (),
    onset_depth: Quantity | None = None,
    until: Quantity | None = None,
    repeats: int = 5,
    replicates: int = 2,
) -> xr.Dataset:
    """Measure work and precision of methods and steps on the beginning of a run.

    Every method is run with every step, or tolerance, and compared with a reference: Runge-Kutta
    with small steps that an independent method has to confirm. A run-in of the scene is carried out
    once, and all begin where it ends. Ctrl-C stops it.

    Parameters
    ----------
    drive
        The drive to simulate.
    methods
        Names of methods, see `simulate`; empty for the usual ones with the usual steps.
    steps
        Steps of the methods with fixed steps [s], or texts with units; empty for each method's own.
    tolerances
        Relative tolerances of ``"dormand-prince"`` [–]; empty for that of the scene.
    onset_depth
        Deepest penetration at which a contact may begin, in all runs [m].
    until
        Time over which to compare [s]; absent, four teeth, or less for short steps.
    repeats
        Timed runs of which the median is taken.
    replicates
        Runs of the reference that start 1e-12 m apart, for the spread of the statistics.

    Returns
    -------
    xarray.Dataset
        One variable a column, (run,), with ``units`` and ``long_name``: ``method``, ``step``,
        ``tolerance``, ``onset_depth``, ``wall`` and ``cpu`` [s], ``real_time_factor``, ``steps``,
        ``evaluations``, ``solves``, ``rejections``, and relative errors: ``error_span_tension``,
        ``error_tight_span_tension``, ``error_contact_force`` and ``error_sprocket_angle`` moment by
        moment up to the chaos horizon; ``error_span_tension_mean``, ``error_span_tension_rms``,
        ``error_contact_force_p50``, ``_p90``, ``_p99`` and ``error_mesh_amplitude`` over the whole
        window. ``remark`` says why a run failed, or that its error is below that of the reference.
        Attributes: ``agreement_…``, how far reference and check are apart; ``spread_…``, how far
        replicates are; ``run_in`` [s], where there is one; ``window`` [s], ``chaos_horizon`` [s],
        and a ``summary`` to print.

    Raises
    ------
    ParameterError
        A setting out of range, steps without methods, or steps or tolerances that none of the
        methods takes.
    SimulationError
        Reference or check fail; a method that fails keeps its row.

    Examples
    --------
    >>> import chaindrive as cd
    >>> table = cd.work_precision(
    ...     cd.scenes.spinning_ring(), methods="verlet", steps=[4e-5, 2e-5], until=5e-3, repeats=1
    ... )
    >>> coarse, fine = table["error_span_tension"].values
    >>> round(float(coarse / fine))
    4
    """
    names = [methods] if isinstance(methods, str) else list(methods)
    steps, tolerances = list(steps), list(tolerances)
    _needed(drive)
    for name, count in [("repeats", repeats), ("replicates", replicates)]:
        if count < 1:
            raise ParameterError(f"{name} = {count}, must be at least 1", name, "at least 1")
    if not names and (steps or tolerances or onset_depth is not None):
        message = "steps, tolerances and onset depths belong to methods"
        raise ParameterError(message, "methods", "name the methods")
    with_tolerance = _core.adaptive_methods()
    adaptive = [name in with_tolerance for name in names]
    if names and steps and all(adaptive):
        message = "steps are for methods with fixed steps, and there is none among `methods`"
        raise ParameterError(message, "steps", "leave them out, or name such a method")
    if tolerances and not any(adaptive):
        allowed = " or ".join(with_tolerance)
        message = f"tolerances are for {allowed}, which is not among `methods`"
        raise ParameterError(message, "tolerances", "leave them out, or name it")
    depth = _number(drive, "onset_depth", onset_depth)
    variants: list[tuple[str, float | None, float | None, float | None]] = []
    none: list[Quantity | None] = [None]
    for name in names:
        if name in with_tolerance:
            for value in [*tolerances] or none:
                variants.append((name, None, _number(drive, "tolerance", value), depth))
        else:
            for value in [*steps] or none:
                variants.append((name, _number(drive, "step", value), None, depth))
    result = _core.work_precision(
        drive._inner,
        variants,
        until=_number(drive, "until", until),
        repeats=repeats,
        replicates=replicates,
    )
    variables: dict[str, Any] = {
        "method": ("run", np.asarray(result["method"], dtype=np.str_)),
    }
    for name, values, unit, text in result["columns"]:
        variables[name] = ("run", values, {"units": unit, "long_name": text})
    variables["remark"] = ("run", np.asarray(result["remark"], dtype=np.str_))
    attributes = {
        "title": drive.title,
        **_core._origin,
        "scene_name": drive.name,
        "scene": drive.text,
        **result["attributes"],
    }
    return xr.Dataset(variables, attrs=attributes)
