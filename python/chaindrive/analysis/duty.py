"""How far a drive is used: its loads over what its chain is made for."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import xarray as xr

from chaindrive.analysis.capacity import rating
from chaindrive.analysis.parts import one_chain, sprockets
from chaindrive.analysis.seating import swing_speed
from chaindrive.analysis.signal import recorded
from chaindrive.errors import ParameterError

__all__ = ["BEARING_PRESSURE", "ENDURANCE_FACTOR", "SEATING_SPEED", "STATIC_FACTOR", "utilisation"]

STATIC_FACTOR = 7.0
"""Static safety factor, breaking load over maximum link tension [–]: assumed, 7 is usual."""
ENDURANCE_FACTOR = 7.0
"""Breaking load over the tension that recurs [–], below which plates do not tire: iwis."""
BEARING_PRESSURE = 30e6
"""Bearing pressure that oiled joints bear for long [Pa]: assumed."""
SEATING_SPEED = 4.0
"""Speed p ω at which rollers are seated that rollers and bushes bear for long [m/s]: assumed."""

_IWIS = "iwis, Dauerfestigkeit: endurance is 15 to 20 % of the breaking load"
_TWIN = "ASME B29.1 rates another chain: its twin of the same pitch"
_MAKER = "the maker, as the scene has it"
_RATING = "American Chain Association, 1982: 15 000 h under smooth load"


class _Check(NamedTuple):
    name: str
    value: float
    limit: float
    unit: str
    source: str


def utilisation(
    run: xr.Dataset,
    *,
    chain: str | None = None,
    breaking_load: float | None = None,
    static_factor: float = STATIC_FACTOR,
    endurance_factor: float = ENDURANCE_FACTOR,
    bearing_pressure: float = BEARING_PRESSURE,
    seating_speed: float = SEATING_SPEED,
    pin_diameter: float | None = None,
    bush_length: float | None = None,
) -> xr.Dataset:
    """Return loads of a run over what the chain is made for; above 1 is too much.

    ========= ================================== ================================
    check     load                               limit
    ========= ================================== ================================
    static    maximum link tension               F_u / 7, assumed
    endurance mean pull of the tightest span     F_u / 7 (iwis)
    pressure  mean pull of the tight side over   30 N/mm², assumed
              the bearing area
    seating   largest p ω of a sprocket          4 m/s, assumed
    power     mean power times service factor    rating at the smallest sprocket
    twin      the same                           rating of the ASME B29.1 chain of
                                                 this pitch, where it has none
    ========= ================================== ================================

    Tensions and pressure are those of the page and of `rating`, followed over all steps. F_u is the
    breaking load of the scene. The rating is that of `chaindrive.Drive.rated_power`, by the formula
    of the American Chain Association or by what the scene says of the maker; the twin is another
    chain, an orientation. `rating` tells more of them. What is assumed is a place to put limits of
    your own.

    Parameters
    ----------
    run
        A run that has ended, with ``sprocket_angle``.
    chain
        Name of the chain, where there are several.
    breaking_load
        F_u [N]; that of the scene when absent.
    static_factor, endurance_factor, bearing_pressure, seating_speed
        Limits of your own.
    pin_diameter, bush_length
        As for `joint_work`.

    Returns
    -------
    xarray.Dataset
        ``load``, ``limit``, ``utilisation``, ``unit`` and ``source`` (check,).

    Raises
    ------
    ParameterError
        A channel was not recorded, the run has not ended, the breaking load or the joints are not
        known, or one that is given is not positive.
    """
    recorded(run, "sprocket_angle")
    for name, value in {
        "static_factor": static_factor,
        "endurance_factor": endurance_factor,
        "bearing_pressure": bearing_pressure,
        "seating_speed": seating_speed,
        "breaking_load": breaking_load,
    }.items():
        if value is not None and not value > 0.0:
            raise ParameterError(f"{name} = {value}, must be positive", name)
    which = one_chain(run, chain)
    strength = which.scene.get("breaking_load") if breaking_load is None else breaking_load
    if strength is None:
        raise ParameterError(
            f"{which.title} has no breaking load in its scene: give breaking_load= [N], "
            "or name a chain of the catalogue, `type`",
            "breaking_load",
        )
    made_for = rating(run, chain=chain)
    if made_for["greatest_tension"].isnull():
        message = f"nothing pulls at {which.title}, or the run has not ended: it has no tension"
        raise ParameterError(message, "run")
    pull = float(made_for["tight_pull"])
    wheels = [it for it in sprockets(run).values() if it.chain.name == which.name]

    def said(value: float, usual: float, source: str) -> str:
        return source if math.isclose(value, usual) else "given"

    checks = [
        _Check(
            "static",
            float(made_for["greatest_tension"]),
            float(strength) / static_factor,
            "N",
            said(static_factor, STATIC_FACTOR, "assumed"),
        ),
    ]
    # Strands have no span between sprockets, and perhaps no sprocket.
    if math.isfinite(pull):
        area = which.bearing_area(pin_diameter, bush_length)
        checks += [
            _Check(
                "endurance",
                pull,
                float(strength) / endurance_factor,
                "N",
                said(endurance_factor, ENDURANCE_FACTOR, _IWIS),
            ),
            _Check(
                "pressure",
                pull / area,
                bearing_pressure,
                "Pa",
                said(bearing_pressure, BEARING_PRESSURE, "assumed"),
            ),
        ]
    if wheels:
        checks.append(
            _Check(
                "seating",
                max(swing_speed(run, it) for it in wheels),
                seating_speed,
                "m/s",
                said(seating_speed, SEATING_SPEED, "assumed"),
            )
        )
    # The run itself has summed up the power at every sprocket, with the rating of the smallest.
    duty = float(made_for["service_factor"] * made_for["power_carried"])
    if made_for["power_twin"].notnull():
        checks.append(_Check("twin", duty, float(made_for["power_twin"]), "W", _TWIN))
    if made_for["power_rated"].notnull():
        source = _MAKER if made_for.attrs["power_limited_by"] == "maker" else _RATING
        checks.append(_Check("power", duty, float(made_for["power_rated"]), "W", source))
    names, loads, limits, units, sources = zip(*checks, strict=True)
    load, limit = np.asarray(loads), np.asarray(limits)
    return xr.Dataset(
        {
            "load": ("check", load, {"long_name": "load"}),
            "limit": ("check", limit, {"long_name": "limit"}),
            "utilisation": ("check", load / limit, {"units": "1", "long_name": "utilisation"}),
            "unit": ("check", np.asarray(units, dtype=np.str_), {"long_name": "unit"}),
            "source": ("check", np.asarray(sources, dtype=np.str_), {"long_name": "source"}),
        },
        coords={"check": np.asarray(names, dtype=np.str_)},
        attrs={"chain": which.name, "breaking_load": float(strength)},
    )
