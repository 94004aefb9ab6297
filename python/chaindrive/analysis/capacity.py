"""Rating of a chain, as its run has judged it."""

from __future__ import annotations

import math

import numpy as np
import xarray as xr

from chaindrive.analysis.parts import one_chain, sprockets

__all__ = ["rating"]

_LIMITS = ("plates", "rollers", "galling", "maker")
_NUMBERS = {
    "power_carried": ("W", "mean power carried"),
    "power_rated": ("W", "rated power"),
    "power_twin": ("W", "rated power of the ASME B29.1 chain of the same pitch"),
    "strand_factor": ("1", "power over that of a single strand"),
    "service_factor": ("1", "service factor"),
    "greatest_tension": ("N", "maximum link tension"),
    "tight_pull": ("N", "mean pull of the tightest span"),
    "static_safety": ("1", "static safety factor: breaking load over maximum link tension"),
    "dynamic_safety": (
        "1",
        "dynamic safety factor: breaking load over mean pull of the tightest span",
    ),
    "bearing_pressure": ("Pa", "bearing pressure of pins on bushes by the pull of the tight side"),
    "wear_limit": ("1", "elongation at which the chain is worn out"),
    "life_least": ("h", "least time until a new chain is worn out"),
    "life_greatest": ("h", "greatest time until a new chain is worn out"),
}
_TEXTS = ("power_limited_by", "power_unrated", "lubrication", "wear_limit_by")


def rating(run: xr.Dataset, *, chain: str | None = None) -> xr.Dataset:
    """Return what the chain of a run is made for, beside what the run asked of it.

    The core has summed it up over all samples; nothing needs to be recorded for it. What is not
    known is NaN or an empty text: the power of chains of the B series, unless the scene gives
    ``rated_power`` of the maker (``power_unrated`` says why), and the limit by galling of all.

    Parameters
    ----------
    run
        A whole run.
    chain
        Name of the chain, where there are several.

    Returns
    -------
    xarray.Dataset
        ``power_limit`` (limit,) [W]: plates, rollers, galling, maker. ``shaft_load`` [N] and
        ``shaft_load_angle`` [deg] (sprocket,): mean force of the chain, from the x axis towards
        the y axis. Without dimensions ``power_carried``, ``power_rated`` [W], ``utilisation``
        (with the service factor), ``strand_factor``, ``service_factor``,
        ``power_twin`` [W] of the chain of ASME B29.1 that has the pitch, where the chain itself is
        not rated, ``greatest_tension`` of a link and ``tight_pull`` [N], ``static_safety``
        (seven is usual, assumed), ``dynamic_safety`` (from eight on plates do not tire, Renold),
        ``bearing_pressure`` [Pa] by ``tight_pull``, ``wear_limit`` [–], ``life_least`` and
        ``life_greatest`` [h]: until a new chain is worn out, by a wear coefficient that nobody
        measured. Attributes ``power_limited_by``, ``power_unrated``, ``lubrication`` (drip, bath
        or stream), ``wear_limit_by``.

    Examples
    --------
    >>> import chaindrive as cd
    >>> drive = cd.scenes.industrial_16b().replace({"chain.rated_power": "18 kW"})
    >>> run = cd.simulate(drive, until=0.02, run_in=0, error=False)
    >>> rating = run.drive.rating()
    >>> float(rating["power_rated"]), rating.attrs["lubrication"]
    (18000.0, 'bath')
    """
    which = one_chain(run, chain)

    def told(name: str) -> float:
        key = f"{name}_{which.name}" if which.name else name
        return float(run.attrs.get(key, math.nan))

    def said(name: str) -> str:
        return str(run.attrs.get(f"{name}_{which.name}" if which.name else name, ""))

    names = [name for name, it in sprockets(run).items() if it.chain.name == which.name]
    force = [float(run.attrs.get(f"shaft_load_{name}", math.nan)) for name in names]
    angle = [float(run.attrs.get(f"shaft_load_angle_{name}", math.nan)) for name in names]
    found = xr.Dataset(
        {
            "power_limit": (
                "limit",
                np.asarray([told(f"power_limit_{name}") for name in _LIMITS]),
                {"units": "W", "long_name": "limit of the power"},
            ),
            "shaft_load": (
                "sprocket",
                np.asarray(force),
                {"units": "N", "long_name": "shaft load"},
            ),
            "shaft_load_angle": (
                "sprocket",
                np.degrees(np.asarray(angle)),
                {"units": "degree", "long_name": "direction of the shaft load"},
            ),
            **{
                name: ((), told(name), {"units": unit, "long_name": words})
                for name, (unit, words) in _NUMBERS.items()
            },
        },
        coords={
            "limit": np.asarray(_LIMITS, dtype=np.str_),
            "sprocket": np.asarray(names, dtype=np.str_),
        },
        attrs={"chain": which.name, **{name: said(name) for name in _TEXTS}},
    )
    used = found["service_factor"] * found["power_carried"] / found["power_rated"]
    found["utilisation"] = used.assign_attrs(units="1", long_name="utilisation")
    return found
