"""Where everything of a drive stands: at the start, and at the instants of a run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from chaindrive.drive import Drive, _from_text
from chaindrive.errors import AssemblyError, ParameterError

if TYPE_CHECKING:
    import xarray as xr

    from chaindrive import _core

__all__ = ["Pose", "at_start", "drive_of", "figure_of", "recorded_at"]

_Floats = NDArray[np.float64]


@dataclass
class Pose:
    """Places: of bodies (bodies, 3), of rollers (rollers, 2) and plate ends (links, 4) a chain."""

    placements: _Floats
    rollers: list[_Floats]
    plates: list[_Floats]


def drive_of(run: xr.Dataset) -> Drive:
    """Return the drive that a run was made of.

    Raises
    ------
    ParameterError
        This is not a run.
    """
    if "scene" not in run.attrs:
        message = "the dataset has no attribute scene: it is not a run of chaindrive"
        raise ParameterError(message, "scene", "the dataset of chaindrive.simulate")
    return _from_text(run.attrs["scene"], run.attrs.get("scene_name", "scene"))


def figure_of(run: xr.Dataset, drive: Drive | None = None) -> _core.Figure:
    """Return the figure of the drive that was run, assembled as it was for the run."""
    drive = drive or drive_of(run)
    return drive._inner.figure(True, float(run.attrs.get("run_in", 0.0)))


def recorded_at(figure: _core.Figure, run: xr.Dataset, time: float) -> dict[str, Any]:
    """Return the sample of a run that is nearest to a time [s], as a figure takes it.

    Raises
    ------
    ParameterError
        A channel that places something was not recorded.
    """
    absent = [name for name in figure.needs if name not in run]
    if absent:
        names = ", ".join(repr(name) for name in absent)
        raise ParameterError(
            f"{', '.join(absent)} not in the run: simulate(…, record=[…, {names}])", absent[0]
        )
    now = run.sel(time=time, method="nearest")
    given = {name: _row(now[name]) for name in figure.placing if name in now}
    return {"time": float(now["time"]), "channels": given}


def at_start(drive: Drive, *, settled: bool) -> dict[str, Any]:
    """Return chains with their rollers, and sprockets by name with their centres, at the start.

    Raises
    ------
    AssemblyError
        The drive does not close, or settle if asked to.
    """
    figure = drive._inner.figure(settled, 0.0)
    if figure.problem is not None:
        raise AssemblyError(figure.problem)
    pose = figure.start()
    bodies = zip(figure.bodies(_COARSE), pose["placements"], strict=True)
    sprockets = {
        body["name"]: body | {"centre": placement[:2]}
        for body, placement in bodies
        if body["kind"] == "sprocket"
    }
    names = list(sprockets)
    chains = [
        chain | {"rollers": rollers, "sprockets": [names[it] for it in chain["sprockets"]]}
        for chain, rollers in zip(figure.chains, pose["rollers"], strict=True)
    ]
    return {"chains": chains, "sprockets": sprockets}


# Outlines are not looked at here; their chords may stand off by a millimetre.
_COARSE = 1e-3


def _row(values: xr.DataArray) -> _Floats:
    return np.ascontiguousarray(values.to_numpy(), dtype=np.float64)
