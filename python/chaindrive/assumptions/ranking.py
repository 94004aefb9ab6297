"""Assumptions, one at a time to the ends of their ranges, ranked by what they move."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from os import PathLike
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from chaindrive.assumptions.outputs import OUTPUTS, Given
from chaindrive.assumptions.trials import PHASES, Trials
from chaindrive.drive import Drive, _needed
from chaindrive.errors import ParameterError
from chaindrive.extras import extra
from chaindrive.measurement.evaluations import RunStore
from chaindrive.measurement.telling import as_text
from chaindrive.progress import told
from chaindrive.settings import MethodName, Quantity

__all__ = ["tornado"]

_Floats = NDArray[np.float64]


def tornado(
    drive: Drive,
    ranges: Mapping[str, tuple[Any, Any]],
    outputs: Given = OUTPUTS,
    *,
    phases: Sequence[float] = PHASES,
    until: Quantity | None = None,
    run_in: Quantity | None = None,
    method: MethodName | None = "auto",
    step: Quantity | None = None,
    level: float = 0.95,
    store: str | PathLike[str] | None = None,
    jobs: int | None = None,
    progress: bool | Callable[[float], object] = False,
) -> xr.Dataset:
    """Rank assumptions by how far the ends of their ranges move what one reads off a drive.

    One assumption moves at a time, all others stand as the drive has them: what two do together is
    not seen, `uncertainty` sees it. Every variant runs from several phases of the chain; a change
    is the mean of the differences from the drive, phase by phase, and its interval Student's. With
    two or three phases it is wide, and a change within it is none.

    Parameters
    ----------
    drive
        The drive.
    ranges
        Lower and upper end of each assumption. By path as `Drive.replace` takes it, with numbers in
        SI or texts with a unit; or by a name of one's own, each end a dict of values by path.
        An empty dict is the drive itself.
    outputs
        What is read off: statistics of `sweep`, ``"span_tension_std[driven-driver]"``, without a
        label the largest; ``"loss_share"``, the share of the supplied energy that is lost. Or a
        dict of functions by name, called with what `sweep` returned over the phases.
    phases
        Phases of the chain at the start [pitches], a replicate each.
    until, run_in, method, step, jobs
        As in `sweep`. Unlike there the default step is taken unless one is given: a step chosen
        for each variant would be another difference.
    level
        Level of the intervals [–].
    store
        Folder in which every variant is kept: the same call goes on there. In memory when absent.
    progress
        As in `sweep`.

    Returns
    -------
    xarray.Dataset
        ``value`` [unit of the output] (output,), of the drive; ``change`` and ``half_width`` of its
        interval [unit of the output], ``share``, the change over the value [–]
        (assumption, end, output); ``unit`` (output,). The assumption with the largest share stands
        first; `end` is ``"low"`` or ``"high"``. Attributes: ``phases``, ``level``, ``scene_name``,
        a ``summary`` to print and a ``page``.

    Raises
    ------
    SceneError
        A path leads nowhere, or a value does not belong there; before anything runs.
    ParameterError
        A range is no pair, or an output does not exist.
    SimulationError
        A variant cannot be simulated.

    Examples
    --------
    >>> import chaindrive as cd
    >>> ring = cd.scenes.spinning_ring()
    >>> ranges = {"chain.mass": ("8 g", "9 g"), "chain.start.speed": (300.0, 400.0)}
    >>> found = cd.tornado(ring, ranges, "link_tension_max", until=2e-3)
    >>> found["assumption"].values.tolist()
    ['chain.start.speed', 'chain.mass']
    """
    _needed(drive)
    variants = {name: _ends(drive, name, ends) for name, ends in ranges.items()}
    if not variants:
        raise ParameterError("no assumption is given", "ranges", "bounds by path")
    if not 0.0 < level < 1.0:
        raise ParameterError(f"level = {level}, must be in (0, 1)", "level")
    settings = {"until": until, "run_in": run_in, "method": method, "step": step}
    count = 1 + sum(it is not None for ends in variants.values() for it in ends)
    with told(progress, "tornado") as tell:
        trials = Trials(drive, outputs, phases, settings, RunStore(store), jobs, tell, count)
        base = trials.of(drive, "the drive")
        moved = np.array(
            [
                [
                    np.zeros_like(base) if it is None else trials.of(it, f"{name}, {end}") - base
                    for end, it in zip(("low", "high"), ends, strict=True)
                ]
                for name, ends in variants.items()
            ]
        )
    replicates = len(base)
    value, change = base.mean(axis=0), moved.mean(axis=2)
    half_width = np.full_like(change, np.nan)
    if replicates > 1:
        # Student's t for the mean of differences, phase by phase.
        quantile = extra("scipy.stats", "intervals").t.ppf(0.5 + 0.5 * level, replicates - 1)
        half_width = quantile / np.sqrt(replicates) * moved.std(axis=2, ddof=1)
    share = change / np.where(value == 0.0, np.nan, value)
    order = np.argsort(-np.nan_to_num(np.abs(share)).max(axis=(1, 2)), kind="stable")
    found = xr.Dataset(
        {
            "value": ("output", value),
            "unit": ("output", np.asarray(trials.units, dtype=np.str_)),
            "change": (("assumption", "end", "output"), change[order]),
            "half_width": (("assumption", "end", "output"), half_width[order]),
            "share": (("assumption", "end", "output"), share[order], {"units": "1"}),
        },
        coords={
            "assumption": np.asarray(list(variants), dtype=np.str_)[order],
            "end": np.asarray(["low", "high"]),
            "output": np.asarray([it.name for it in trials.outputs], dtype=np.str_),
        },
        attrs={"phases": trials.phases, "level": level, "scene_name": drive.name or ""},
    )
    sections = [_section(found.sel(output=name), ranges) for name in found["output"].to_numpy()]
    return found.assign_attrs(summary=as_text(sections), page=json.dumps({"sections": sections}))


def _ends(drive: Drive, name: str, ends: Any) -> tuple[Drive | None, Drive | None]:
    """Return the drives at both ends of a range; None for the drive itself."""
    if not isinstance(ends, list | tuple) or len(ends) != 2:
        message = f"ranges[{name!r}] = {ends!r} is no pair of a lower and an upper end"
        raise ParameterError(message, name)
    values = [dict(it) if isinstance(it, Mapping) and _is_named(it) else {name: it} for it in ends]
    low, high = (drive.replace(it) if it else None for it in values)
    return low, high


def _is_named(end: Mapping[str, Any]) -> bool:
    """Tell values by path from a table that stands at one."""
    return all("." in key for key in end)


def _section(found: xr.Dataset, ranges: Mapping[str, Any]) -> dict[str, Any]:
    """Return the table of one output, ranked by what is moved in it."""
    size = np.abs(found["change"].to_numpy()).max(axis=1)
    rows = []
    for at in np.argsort(-size, kind="stable"):
        row = found.isel(assumption=int(at))
        ends = [
            f"{change:+.4g}" + (f" ± {width:.2g}" if np.isfinite(width) else "")
            for change, width in zip(row["change"].values, row["half_width"].values, strict=True)
        ]
        shares = [f"{100.0 * float(it):+.1f}" for it in row["share"]]
        rows.append([str(row["assumption"].item()), *ends, *shares])
    unit = found["unit"].item()
    return {
        "title": f"{found['output'].item()}: {float(found['value']):.4g} {unit}".rstrip(),
        "columns": ["assumption", "at the low end", "at the high end", "low [%]", "high [%]"],
        "rows": rows,
        "sentences": [],
    }
