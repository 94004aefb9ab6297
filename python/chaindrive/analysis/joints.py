"""The joints of a chain at work: sliding of pins in bushes, friction work, pressure, p·v."""

from __future__ import annotations

import math

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from chaindrive.analysis.parts import ChainParts, circuits, one_chain, places
from chaindrive.analysis.signal import recorded
from chaindrive.errors import ParameterError

__all__ = ["joint_work"]

_Floats = NDArray[np.float64]


def joint_work(
    run: xr.Dataset,
    *,
    chain: str | None = None,
    pin_diameter: float | None = None,
    bush_length: float | None = None,
) -> xr.Dataset:
    """Return how far the pins slide in their bushes, under which load, and what that costs.

    ::

        s = Σ |r Δγ|,    W_N = Σ N |r Δγ|,    W = μ W_N,    p = N/(n d b),    p·v = W_N/(n d b t)

    γ is the angle between the two links of a joint, r = d/2 the radius of the pin, b the length of
    the bush, n the strands. N is the force on the pin where ``joint_force`` was recorded, otherwise
    the mean tension of the two links, as in the simulation; a joint under compression bears
    nothing. A strand that swings turns its joints without sliding, within the elastic range of a
    ``spring-slider``, and as far as a pin with play c rolls up its bush, c atan μ along the
    surface; both are taken out. Samples must be close enough to see a joint articulate: ten or more
    while a tooth passes.

    W is the ``articulation_dissipated`` of the run's ledger, to 1 % where the step resolves the
    friction; the loss of the place ``joints`` has the impacts of pins in their bushes as well. A
    step chosen for the tension may leave the ledger of friction off by some per cent, which W is
    not.

    Parameters
    ----------
    run
        A run with ``roller_x``, ``roller_y``, ``link_tension`` and ``sprocket_angle``; for rigid
        links ``joint_angle`` and ``joint_force`` are better in place of the first three.
    chain
        Name of the chain, where there are several.
    pin_diameter, bush_length
        d and b [m]; from the scene or the catalogue when absent.

    Returns
    -------
    xarray.Dataset
        ``sliding`` [m], ``load_work`` W_N and ``friction_work`` W [J], ``pressure`` [Pa], the mean
        over the sliding on tight and slack side (``bearing_pressure`` of `rating` is that of the
        tight side), ``pressure_largest`` [Pa] and ``pressure_velocity`` p·v [W/m²]; (joint,).
        Joint i lies at roller i. A joint does its work where it stands on the loop, so only the
        means over all joints, or whole ``circuits`` (an attribute), stand for the drive.
        ``friction`` is the coefficient μ of the scene, ``area`` the bearing area n d b [m²],
        ``seconds`` the time examined.

    Raises
    ------
    ParameterError
        A channel was not recorded, or d or b is not known.

    Examples
    --------
    >>> import chaindrive as cd
    >>> from chaindrive.analysis import joint_work
    >>> channels = ["roller_x", "roller_y", "link_tension", "sprocket_angle"]
    >>> run = cd.simulate(cd.scenes.industrial_16b(), until=0.02, record=channels, error=False)
    >>> round(joint_work(run).attrs["area"] * 1e6, 1)
    209.6
    """
    which = one_chain(run, chain)
    diameter, length = which.pin_diameter(pin_diameter), which.bush_length(bush_length)
    area = which.bearing_area(diameter, length)
    turns, load = _turns_and_loads(run, which)
    slips = _slips(which, diameter / 2 * np.diff(turns, axis=0), load)
    between = 0.5 * (load[1:] + load[:-1])
    sliding = slips.sum(axis=0)
    # W_N = Σ N |r Δγ|
    work = (between * slips).sum(axis=0)
    seconds = float(run["time"][-1] - run["time"][0])
    with np.errstate(invalid="ignore"):
        pressure = work / sliding / area
    friction = which.friction()
    columns = {
        "sliding": (sliding, "m", "sliding of the pin"),
        "load_work": (work, "J", "load times sliding"),
        "friction_work": (friction * work, "J", "friction work"),
        "pressure": (pressure, "Pa", "mean bearing pressure while the joint slides"),
        "pressure_largest": (load.max(axis=0) / area, "Pa", "greatest bearing pressure"),
        "pressure_velocity": (work / (area * seconds), "W/m^2", "pressure times velocity"),
    }
    return xr.Dataset(
        {
            name: ("joint", values, {"units": unit, "long_name": text})
            for name, (values, unit, text) in columns.items()
        },
        coords={"joint": np.arange(sliding.size)},
        attrs={
            "chain": which.name,
            "pin_diameter": diameter,
            "bush_length": length,
            "area": area,
            "friction": friction,
            "seconds": seconds,
            "circuits": circuits(run, which),
        },
    )


def _turns_and_loads(run: xr.Dataset, chain: ChainParts) -> tuple[_Floats, _Floats]:
    """Return angle [rad] and load [N] of every joint over time, each (time, joint)."""
    if "joint_angle" in run and "joint_force" in run:
        if "joint_chain" in run.coords and chain.name:
            run = run.isel(joint=np.flatnonzero(run["joint_chain"] == chain.name))
        angle = run["joint_angle"].transpose("time", "joint").to_numpy().astype(float)
        force = run["joint_force"].transpose("time", "joint").to_numpy().astype(float)
        return np.unwrap(angle, axis=0), force
    recorded(run, "link_tension", "roller_x", "roller_y")
    x, y = places(run, chain)
    own = slice(chain.first, chain.first + chain.links)
    tension = run["link_tension"].isel(link=own).transpose("time", "link").to_numpy().astype(float)
    if chain.closed:
        along_x, along_y = np.roll(x, -1, axis=1) - x, np.roll(y, -1, axis=1) - y
        before = np.roll(np.arange(chain.links), 1)
        after = np.arange(chain.links)
    else:
        along_x, along_y = np.diff(x, axis=1), np.diff(y, axis=1)
        before, after = np.arange(chain.links - 1), np.arange(1, chain.links)
    if after.size == 0:
        raise ParameterError(f"{chain.title} has a single link: it has no joint", "chain")
    direction = np.unwrap(np.arctan2(along_y, along_x), axis=0)
    load = 0.5 * (tension[:, before] + tension[:, after])
    return direction[:, after] - direction[:, before], np.maximum(load, 0.0)


def _slips(chain: ChainParts, steps: _Floats, load: _Floats) -> _Floats:
    """Return by how much pins slide between samples [m], turning without sliding taken out."""
    friction = chain.friction()
    if friction == 0.0:
        return np.abs(steps)
    law = chain.joint_friction
    # The elastic part: σ z holds what does not slide, |σ z| ≤ μ N.
    holds = law.get("kind") in ("spring-slider", "stribeck")
    bristle = friction / float(law["stiffness"]) if holds else 0.0
    # A pin with play rolls up its bush before it slides, as far as friction carries it: c atan μ.
    rolling = chain.clearance * math.atan(friction)
    reach = bristle * load + rolling
    held = np.zeros(steps.shape[1])
    slips = np.empty_like(steps)
    for sample, step in enumerate(steps):
        new = np.clip(held + step, -reach[sample + 1], reach[sample + 1])
        slips[sample] = np.abs(step - (new - held))
        held = new
    return slips
