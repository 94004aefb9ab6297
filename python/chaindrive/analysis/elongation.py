"""Wear of the joints by Archard's law: elongation over hours, and the drive with the worn chain."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from chaindrive.analysis.joints import joint_work
from chaindrive.analysis.parts import one_chain, sprockets
from chaindrive.drive import Drive
from chaindrive.errors import AssemblyError, ParameterError

__all__ = ["BAND", "COEFFICIENT", "COEFFICIENT_SOURCE", "LIMITS", "wear", "worn"]

COEFFICIENT = 3.0e-16
"""Wear coefficient k of an oiled joint, pin and bush together [m³/(N m)]: 3e-7 mm³/(N m)."""
BAND = 10.0
"""Factor within which `COEFFICIENT` lies on either side [–]."""
COEFFICIENT_SOURCE = (
    "assumed, within a factor of ten: nobody measured one of a roller chain with its load and oil; "
    "with a hardness of 7 GPa K = k H is 2e-6, as of oiled metals under boundary lubrication"
)
"""Origin of `COEFFICIENT` and `BAND`."""
LIMITS = (0.01, 0.02, 0.03)
"""Elongations to which `wear` counts the hours [–]."""

_HOUR = 3600.0
_BOUNDS = ("least", "greatest")
# Where the run does not say what its chain may grow by.
_USUAL = (0.03, "as most chains (Diamond Chain)")
# Travels in metres, or angles in radians, that a tensioner is given: the layout is refused where
# one of them takes it into another part, so the widest that closes is the one that is wanted.
_WITHIN = tuple(0.4 * 0.8**k for k in range(16))


def wear(
    run: xr.Dataset,
    *,
    hours: ArrayLike | None = None,
    coefficient: float | None = None,
    coefficient_range: tuple[float, float] | None = None,
    chain: str | None = None,
    pin_diameter: float | None = None,
    bush_length: float | None = None,
) -> xr.Dataset:
    """Return how a chain grows longer over hours of running as in this run.

    ::

        V = k ∫ N ds,    h = V/(d b),    ε = h/p

    V is the volume that pin and bush of a joint lose together, h the depth by which the pin sinks
    into the bush. Every pitch has one joint, so the chain grows by h a pitch in the mean; a link of
    bushes stays as it is and one of pins grows by 2 h. Load and sliding are those of the run from
    the first hour to the last: `worn` gives the drive to run anew. Running-in, some 0.1 % in the
    first hours, and the steep end after the hard layer is through are not in Archard's law. A chain
    without sprockets is refused: the coefficient is that of joints that turn on them.

    Parameters
    ----------
    run
        As for `joint_work`, at a steady speed and load.
    hours
        Hours of running; when absent 200 values, alike in their logarithms, to the greatest life.
    coefficient
        Wear coefficient k [m³/(N m)], Archard's dimensionless K over the hardness; when absent
        `COEFFICIENT`, which nobody measured, from k/`BAND` to k·`BAND`.
    coefficient_range
        Least and greatest k where it was measured; when absent with a coefficient, that alone.
    chain, pin_diameter, bush_length
        As for `joint_work`.

    Returns
    -------
    xarray.Dataset
        ``depth`` h [m] and ``elongation`` ε [–] (hours,) in the mean over all joints with k,
        ``elongation_range`` (hours, bound) with the least and the greatest k, ``hours_to`` (limit,
        bound) [h] 1, 2 and 3 % of elongation, ``life`` (bound,) [h] to ``wear_limit`` [–], at which
        a chain of this use is worn out (attribute ``wear_limit_by``); hours have two digits.
        ``depth_rate`` (joint,) [m/h] as the joints were at work during the run. Attributes
        ``coefficient``, ``coefficient_range``, ``coefficient_source``, ``circuits``.

    Raises
    ------
    ParameterError
        As `joint_work`, the coefficient is not positive or not in its range, or nothing wears.

    Notes
    -----
    Source: J. F. Archard, *J. Appl. Phys.* 24, 1953, 981–988. How large k is: see
    `COEFFICIENT_SOURCE`; dry or dirty joints wear a hundred to a thousand times faster.

    Examples
    --------
    >>> import chaindrive as cd
    >>> from chaindrive.analysis import wear
    >>> channels = ["roller_x", "roller_y", "link_tension", "sprocket_angle"]
    >>> drive = cd.scenes.industrial_16b()
    >>> run = cd.simulate(drive, until=0.1, every=2e-4, record=channels, error=False)
    >>> found = wear(run)
    >>> print(found["life"].values.astype(int), f"h to {100 * float(found['wear_limit'])} %")
    [  770 77000] h to 1.5 %
    """
    k, ends = _coefficient(coefficient, coefficient_range)
    which = one_chain(run, chain)
    if not any(it.chain.name == which.name for it in sprockets(run).values()):
        message = f"{which.title} passes no sprocket on which its joints turn: nothing wears"
        raise ParameterError(message, "run", "take a drive with sprockets")
    work = joint_work(run, chain=chain, pin_diameter=pin_diameter, bush_length=bush_length)
    pitch = which.pitch
    # dh/dt = k (∫ N ds)/(d b t)
    rates = k * work["load_work"] / (work.attrs["area"] * work.attrs["seconds"])
    rate = float(rates.mean()) * _HOUR
    if not rate > 0.0:
        message = "no joint turned under load during the run: nothing wears"
        raise ParameterError(message, "run", "run the drive at speed and under load")
    # Growth an hour, with the greatest k and the least.
    fastest, slowest = (rate / pitch * end / k for end in reversed(ends))

    def hours_to(elongation: float) -> list[float]:
        return [_two_digits(elongation / it) for it in (fastest, slowest)]

    name = f"_{which.name}" if which.name else ""
    limit = float(run.attrs.get(f"wear_limit{name}", _USUAL[0]))
    by = str(run.attrs.get(f"wear_limit_by{name}", _USUAL[1]))
    if hours is None:
        hours = np.geomspace(0.1 * limit / fastest, limit / slowest, 200)
    span = np.atleast_1d(np.asarray(hours, dtype=float))
    depth = rate * span
    return xr.Dataset(
        {
            "depth": ("hours", depth, {"units": "m", "long_name": "wear depth of a joint"}),
            "elongation": ("hours", depth / pitch, {"units": "1", "long_name": "elongation"}),
            "elongation_range": (
                ("hours", "bound"),
                np.stack([span * slowest, span * fastest], axis=1),
                {"units": "1", "long_name": "elongation"},
            ),
            "hours_to": (
                ("limit", "bound"),
                np.asarray([hours_to(it) for it in LIMITS]),
                {"units": "h", "long_name": "hours to the elongation"},
            ),
            "life": ("bound", hours_to(limit), {"units": "h", "long_name": "hours to the limit"}),
            "wear_limit": ((), limit, {"units": "1", "long_name": "elongation of a worn chain"}),
            "depth_rate": (
                "joint",
                rates.to_numpy() * _HOUR,
                {"units": "m/h", "long_name": "growth of the wear depth"},
            ),
        },
        coords={
            "hours": ("hours", span, {"units": "h", "long_name": "running time"}),
            "limit": ("limit", list(LIMITS), {"units": "1", "long_name": "elongation"}),
            "bound": ("bound", list(_BOUNDS)),
            "joint": work["joint"],
        },
        attrs={
            "chain": work.attrs["chain"],
            "pitch": pitch,
            "coefficient": k,
            "coefficient_range": list(ends),
            "coefficient_source": COEFFICIENT_SOURCE if coefficient is None else "given",
            "wear_limit_by": by,
            "circuits": work.attrs["circuits"],
        },
    )


def _coefficient(
    given: float | None, between: tuple[float, float] | None
) -> tuple[float, tuple[float, float]]:
    """Return a wear coefficient, and its least and greatest value [m³/(N m)]."""
    k = COEFFICIENT if given is None else given
    if not k > 0.0:
        raise ParameterError(f"coefficient = {k}, must be positive [m³/(N m)]", "coefficient")
    if between is None:
        return k, (k / BAND, k * BAND) if given is None else (k, k)
    low, high = between
    if not 0.0 < low <= k <= high < np.inf:
        message = f"coefficient_range = {between}, must be positive and hold {k:g} [m³/(N m)]"
        raise ParameterError(message, "coefficient_range")
    return k, (low, high)


def _two_digits(value: float) -> float:
    return float(f"{value:.1e}")


def worn(
    drive: Drive,
    elongation: float,
    *,
    chain: str | None = None,
    take_up: Mapping[str, Any] | None = None,
) -> Drive:
    """Return a drive whose chain has worn by an elongation of its mean pitch.

    ::

        inner pitch + 0,    outer pitch + 2 ε p

    Rollers sit on bushes, so wear of a joint leaves the spacing across a link of bushes alone and
    moves both rollers at the ends of a link of pins outward by the wear depth ε p. The play of pins
    with clearance stays as it was: a pin wears a bed of its own radius on the side on which it
    pulls. A closed chain of an odd number of links has no alternating links: all of them grow by ε.

    A longer chain on the same centres is slack, and a pretension would shorten its links again.
    `take_up` moves something instead, as in `route.adjust` of a scene: a sprocket, the slider or
    the arm of a tensioner, as if the drive had been set anew. Without it the drive keeps what its
    scene adjusts; where that is nothing, a single tensioner follows the chain, and where there is
    none the pretension is dropped and the excess of length hangs as sag.

    Parameters
    ----------
    drive
        The drive with the chain as it is; worn again, it wears further.
    elongation
        ε [–], such as that of `wear` after so many hours.
    chain
        Name of the chain, where there are several.
    take_up
        Such as ``{"kind": "sprocket", "name": "driven", "direction": [1, 0], "within": "30 mm"}``.

    Raises
    ------
    ParameterError
        The elongation is not in [0, 0.1], or there is no such chain.
    SceneError
        The scene refuses the take-up.

    Examples
    --------
    >>> import chaindrive as cd
    >>> from chaindrive.analysis import worn
    >>> take_up = {"kind": "sprocket", "name": "driven", "direction": [1, 0], "within": "30 mm"}
    >>> later = worn(cd.scenes.industrial_16b(), 0.01, take_up=take_up)
    >>> round(later.to_dict()["chain"]["outer_pitch"] * 1e3, 3)
    25.908
    """
    if not 0.0 <= elongation <= 0.1:
        message = f"elongation = {elongation}, must be in [0, 0.1]: 0.03 is 3 %"
        raise ParameterError(message, "elongation")
    full = drive.resolved().to_dict()
    tables = full["chains"] if "chains" in full else [full["chain"]]
    path, table = _table(full, tables, chain)
    pitch = float(table["pitch"])
    changes: dict[str, Any] = {}
    if "pitches" in table:
        first = 1 if not table.get("outer_first", False) else 0
        grown = [float(it) for it in table["pitches"]]
        grown[first::2] = [it + 2 * elongation * pitch for it in grown[first::2]]
        changes[f"{path}.pitches"] = grown
    elif "ends" not in table and int(table["links"]) % 2 == 1:
        before = 1.0 + float(table.get("elongation", 0.0))
        changes[f"{path}.elongation"] = before * (1.0 + elongation) - 1.0
    else:
        inner = float(table.get("inner_pitch", pitch))
        outer = float(table.get("outer_pitch", pitch))
        changes[f"{path}.inner_pitch"] = inner
        changes[f"{path}.outer_pitch"] = outer + 2 * elongation * pitch
    changes |= _taken_up(full, table, path, take_up)
    # A chain written as a text has no keys to replace: the drive in full has.
    written = drive.to_dict().get("chain")
    base = drive.resolved() if isinstance(written, str) else drive
    followed = f"{path}.route.adjust" if "chains" in full else "route.adjust"
    adjust = changes.get(followed)
    if adjust is None or "within" in adjust:
        return base.replace(changes)
    return _followed(base, changes, followed)


def _followed(drive: Drive, changes: Mapping[str, Any], path: str) -> Drive:
    """Return the drive whose tensioner may travel as far as its other parts let it."""
    refused: AssemblyError | None = None
    for within in _WITHIN:
        travelled = drive.replace(dict(changes) | {path: changes[path] | {"within": within}})
        try:
            travelled.profile(travelled.sprockets[0], settled=False)
        except AssemblyError as error:
            # A travel that lays the chain, but too slack, says more than one that hits another
            # part.
            refused = refused if "do not close" in str(refused) else error
        else:
            return travelled
    raise AssemblyError(
        f"the tensioner cannot follow the worn chain (take_up= moves something else): {refused}",
        path,
        "give take_up=",
    )


def _table(
    scene: Mapping[str, Any], tables: list[dict[str, Any]], name: str | None
) -> tuple[str, dict[str, Any]]:
    """Return path and table of a chain in a scene."""
    if "chains" not in scene:
        return "chain", tables[0]
    names = [table["name"] for table in tables]
    if name not in names:
        listed = ", ".join(map(repr, names))
        raise ParameterError(f"say which chain wears: chain= one of {listed}", "chain")
    return f"chains.{name}", tables[names.index(name)]


def _taken_up(
    scene: Mapping[str, Any],
    table: Mapping[str, Any],
    path: str,
    take_up: Mapping[str, Any] | None,
) -> dict[str, Any]:
    """Return the changes of a route that make room for a longer chain."""
    if "ends" in table:
        return {}
    own = "chains" in scene
    route = table.get("route", {}) if own else scene.get("route", {})
    place = f"{path}.route" if own else "route"
    if take_up is not None:
        return {f"{place}.adjust": dict(take_up)}
    if route.get("adjust", {}).get("kind", "nothing") != "nothing":
        return {}
    tensioners = scene.get("tensioners", [])
    if len(tensioners) == 1 and not own:
        return {
            f"{place}.adjust": {
                "kind": tensioners[0]["carrier"]["kind"],
                "name": tensioners[0]["name"],
            }
        }
    return {f"{place}.pretension": 0.0}
