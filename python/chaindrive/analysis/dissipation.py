"""Losses of a run by place, and its efficiency."""

from __future__ import annotations

import math
from numbers import Real

import numpy as np
import xarray as xr

from chaindrive.analysis.signal import recorded
from chaindrive.errors import ParameterError

__all__ = ["losses"]

_SUPPLIES = ("driver_supplied", "motions_supplied", "torques_supplied")


def losses(run: xr.Dataset, *, start: float | None = None, end: float | None = None) -> xr.Dataset:
    """Return the energy that is lost at every place, its share, and the efficiency.

    ::

        η = 1 − Σ ΔE / W,    W what drivers put in

    Over the whole run η is what the run itself states; over a part of it W is taken from the
    channel ``energy_flows``. A part that is not a whole number of turns stores or gives back
    energy, which η leaves out.

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
        [W] between samples, ``efficiency`` [–], NaN where the drivers put nothing in, nobody takes
        anything out, or W is not known.

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
    whole = part.sizes["time"] == run.sizes["time"]
    result = xr.Dataset(
        {
            "energy": energy.assign_attrs(units="J", long_name="energy lost"),
            "power": (energy / seconds).assign_attrs(units="W", long_name="power lost"),
            "share": share.assign_attrs(units="1", long_name="share of the losses"),
            "power_over_time": over_time.assign_attrs(units="W", long_name="power lost"),
            "efficiency": (
                (),
                _efficiency(run, part, total, whole=whole),
                {"units": "1", "long_name": "efficiency"},
            ),
        }
    )
    return result.assign_attrs(start=float(part["time"][0]), end=float(part["time"][-1]))


def _efficiency(run: xr.Dataset, part: xr.Dataset, lost: float, *, whole: bool) -> float:
    if whole and "efficiency" in run.attrs:
        return float(run.attrs["efficiency"])
    if "energy_flows" not in part:
        return math.nan
    taken = part["energy_flows"].sel(flow=[*_SUPPLIES, "load_supplied"])
    if float((taken.isel(time=-1) - taken.isel(time=0)).min()) >= 0.0:
        return math.nan
    flows = part["energy_flows"].sel(flow=list(_SUPPLIES))
    steps = flows.diff("time").sum("flow").to_numpy()
    # What drivers take back under a swinging load has been put in before.
    supplied = float(np.sum(steps))
    return 1.0 - lost / supplied if supplied > 0.0 else math.nan
