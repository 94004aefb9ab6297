"""Losses of a run by place, and its efficiency."""

from __future__ import annotations

import math
from numbers import Real

import numpy as np
import xarray as xr

from chaindrive.analysis.signal import recorded
from chaindrive.errors import ParameterError

__all__ = ["losses"]

_OUTSIDE = (
    "driver_supplied",
    "motions_supplied",
    "torques_supplied",
    "load_supplied",
    "forces_supplied",
)
# Those of the core: `Ledger::unknown` of the summary.
_TAKEN, _TO_AND_FRO = 1e-6, 0.1


def losses(run: xr.Dataset, *, start: float | None = None, end: float | None = None) -> xr.Dataset:
    """Return the energy that is lost at every place, its share, and the efficiency.

    ::

        η = 1 − Σ ΔE / W,    W what was put in and not taken back

    Over the whole run η is what the run itself states; over a part of it W is taken from the
    channel ``energy_flows``. A part that is not a whole number of turns stores or gives back
    energy, which η leaves out. Where what goes to and fro makes η uncertain by more than 0.1 there
    is none.

    Parameters
    ----------
    run
        A run with the channel ``energy_losses``; with ``energy_flows`` for the efficiency of a
        part.
    start, end
        Part of the run [s]; all of it when absent.

    Returns
    -------
    xarray.Dataset
        ``energy`` [J], ``power`` [W] and ``share`` [–] (place,), ``power_over_time`` (time, place)
        [W] between samples, ``efficiency`` [–], NaN where there is none: its attribute ``unknown``
        says why.

    Raises
    ------
    ParameterError
        The channel was not recorded, or the part holds fewer than two samples.

    Examples
    --------
    >>> import chaindrive as cd
    >>> from chaindrive.analysis import losses
    >>> drive = cd.scenes.industrial_16b()
    >>> run = cd.simulate(drive, until=0.02, record="energy_losses", error=False)
    >>> str(losses(run)["energy"].idxmax().item())
    'joints'
    """
    recorded(run, "energy_losses")
    for name, time in (("start", start), ("end", end)):
        if not (time is None or isinstance(time, Real)):
            raise ParameterError(f"{name} = {time!r}, must be a time in s", name, "a number")
    part = run.sel(time=slice(start, end))
    if part.sizes["time"] < 2:
        held = f"{float(run['time'][0]):.6g} to {float(run['time'][-1]):.6g} s"
        raise ParameterError(f"fewer than two samples in this part: the run holds {held}", "start")
    lost = part["energy_losses"].transpose("time", "place")
    energy = (lost.isel(time=-1, drop=True) - lost.isel(time=0, drop=True)).astype(float)
    seconds = float(part["time"][-1] - part["time"][0])
    total = float(energy.sum())
    share = energy / total if total > 0.0 else xr.full_like(energy, math.nan)
    over_time = lost.diff("time", label="lower") / part["time"].diff("time", label="lower")
    # A run that was cut before holds less than it recorded.
    whole = part.sizes["time"] == run.attrs.get("samples")
    efficiency, unknown = _efficiency(run, part, total, whole=whole)
    told = {"units": "1", "long_name": "efficiency"} | ({"unknown": unknown} if unknown else {})
    result = xr.Dataset(
        {
            "energy": energy.assign_attrs(units="J", long_name="energy lost"),
            "power": (energy / seconds).assign_attrs(units="W", long_name="power lost"),
            "share": share.assign_attrs(units="1", long_name="share of the losses"),
            "power_over_time": over_time.assign_attrs(units="W", long_name="power lost"),
            "efficiency": ((), efficiency, told),
        }
    )
    return result.assign_attrs(start=float(part["time"][0]), end=float(part["time"][-1]))


def _efficiency(
    run: xr.Dataset, part: xr.Dataset, lost: float, *, whole: bool
) -> tuple[float, str | None]:
    """Efficiency, or NaN and why there is none, by the rules and in the words of a run."""
    if whole and "efficiency" in run.attrs:
        return float(run.attrs["efficiency"]), None
    if whole and "efficiency_unknown" in run.attrs:
        return math.nan, str(run.attrs["efficiency_unknown"])
    if "energy_flows" not in part:
        return math.nan, "energy_flows is not recorded"
    work = part["energy_flows"].sel(flow=list(_OUTSIDE)).transpose("time", "flow").to_numpy()
    work = work - work[0]
    net = work[-1]
    # The most that whoever puts energy in had taken back, and whoever takes it out had given back.
    fall = (np.maximum.accumulate(work) - work).max(axis=0)
    rise = (work - np.minimum.accumulate(work)).max(axis=0)
    supplied, back = float(net[net > 0.0].sum()), float(fall[net > 0.0].sum())
    delivered, returned = -float(net[net < 0.0].sum()), float(rise[net < 0.0].sum())
    if supplied <= 0.0:
        return math.nan, "nobody puts energy in"
    if delivered <= _TAKEN * supplied:
        return math.nan, "nobody takes energy out"
    if back * lost > _TO_AND_FRO * supplied**2 or returned > delivered:
        return math.nan, "too much energy goes to and fro for this record: take a longer one"
    return 1.0 - lost / supplied, None
