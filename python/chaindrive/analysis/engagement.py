"""The load on the teeth of a sprocket, from the seating of a roller to its release."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from chaindrive.analysis.bins import by_bin
from chaindrive.analysis.parts import SprocketParts, rollers_of, sprockets
from chaindrive.analysis.signal import recorded
from chaindrive.errors import ParameterError

__all__ = ["decay", "pressure_angle", "tooth_load"]

_Floats = NDArray[np.float64]


def pressure_angle(teeth: int) -> float:
    """Return the pressure angle at the end of the seat [rad].

    Between the pull of a link and the normal of the tooth that holds its roller, where the seat
    of ISO 606 ends, half-way between its extreme forms:

    ::

        φ = 90° − α/2 − 180°/z,   α = 130° − 90°/z

    No load makes a roller of a new chain lie elsewhere than in its seat, so this is the
    largest angle that φ has without the roller climbing the flank.

    Source: the seating angles of ISO 606, 140° − 90°/z and 120° − 90°/z; φ by geometry.
    """
    return math.radians(90.0 - (130.0 - 90.0 / teeth) / 2 - 180.0 / teeth)


def decay(teeth: int, count: int, *, angle: float | None = None) -> _Floats:
    """Return tension of the first links and load of the first rollers on a sprocket.

    Each roller takes what equilibrium with the next link asks of a tooth at a pressure angle φ:

    ::

        T_k / T₀ = (sin φ / sin(φ + 2β))^k,    F_k / T₀ = (T_{k−1} / T₀) sin 2β / sin(φ + 2β)

    2β = 2π/z is the angle between two links; k counts from the tight side, friction and elastic
    forces count as nothing.

    Parameters
    ----------
    teeth
        Teeth of the sprocket.
    count
        Rollers that lie on it.
    angle
        Pressure angle φ [rad]; that of `pressure_angle` when absent.

    Returns
    -------
    (2, count)
        Tension after every roller and load of every roller, over the tension of the tight side.

    Notes
    -----
    Source: R. C. Binder, *Mechanics of the Roller Chain Drive*, Prentice-Hall, 1956. Measured
    loads follow it, whatever the elasticity of chain and sprocket, but differ between driver and
    driven sprocket, where friction acts the other way: M. R. Naji and K. M. Marshek,
    *J. Mech. Transm. Autom. Des.* 105(3), 1983, 331–338.
    """
    phi = pressure_angle(teeth) if angle is None else angle
    if not 0.0 < phi < math.pi / 2:
        raise ParameterError(f"angle = {phi}, must be between 0 and π/2 [rad]", "angle")
    both = phi + 2 * math.pi / teeth
    # T_k / T₀ = (sin φ / sin(φ + 2β))^k
    ratio = math.sin(phi) / math.sin(both)
    tension = ratio ** np.arange(1, count + 1)
    load = ratio ** np.arange(count) * math.sin(2 * math.pi / teeth) / math.sin(both)
    return np.stack([tension, load])


def tooth_load(
    run: xr.Dataset,
    sprocket: str,
    *,
    per_tooth: int = 10,
    angle: float | None = None,
) -> xr.Dataset:
    """Return the contact force of rollers through their engagement with a sprocket.

    A roller in its seat turns with the sprocket: its polar angle, counted from where rollers come
    within reach of the seat, is the angle by which the sprocket has turned since it was seated. All
    rollers and turns fall into bins of this angle.

    Parameters
    ----------
    run
        A run with the channels ``contact_force``, ``roller_x``, ``roller_y`` and
        ``sprocket_angle``; with ``sprocket_x`` and ``sprocket_y`` where the sprocket moves, with
        ``link_tension`` for the reference.
    sprocket
        Its name.
    per_tooth
        Bins a tooth.
    angle
        Pressure angle of the reference [rad], see `decay`.

    Returns
    -------
    xarray.Dataset
        ``force_mean``, ``force_std``, ``force_min``, ``force_max`` (angle,) [N] and
        ``force_reference``, by `decay` from the tight side, whose tension is the attribute
        ``tight_tension`` [N], less the centrifugal share m′v², which no tooth bears. The attribute
        ``tight_side`` is ``"entering"`` or ``"leaving"``, ``engagements`` how many rollers passed.

    Raises
    ------
    ParameterError
        A channel was not recorded, there is no such sprocket, or it does not turn.

    Examples
    --------
    >>> import chaindrive as cd
    >>> from chaindrive.analysis import tooth_load
    >>> channels = ["contact_force", "roller_x", "roller_y", "sprocket_angle", "link_tension"]
    >>> run = cd.simulate(cd.scenes.industrial_16b(), until=0.05, record=channels, error=False)
    >>> load = tooth_load(run, "driver")
    >>> load.attrs["tight_side"]
    'entering'
    """
    recorded(run, "contact_force", "sprocket_angle", "roller_x", "roller_y")
    known = sprockets(run)
    if sprocket not in known:
        listed = ", ".join(known)
        raise ParameterError(f"no sprocket {sprocket!r} on a route: there are {listed}", "sprocket")
    wheel = known[sprocket]
    turned = run["sprocket_angle"].sel(sprocket=sprocket).to_numpy()
    sense = float(np.sign(turned[-1] - turned[0]))
    if sense == 0.0:
        raise ParameterError(f"{sprocket} does not turn during the run", "sprocket")
    radius, polar = wheel.polar(run)
    on = radius <= wheel.reach(run)
    since, seatings, begin = _since_seating(sense * polar, on)
    own = rollers_of(run, wheel.chain)
    force = run["contact_force"].isel(roller=own).transpose("time", "roller").to_numpy()
    tooth = 2 * math.pi / wheel.teeth
    width = tooth / per_tooth
    count = math.ceil(float(since[on].max()) / width)
    bins = np.minimum((since[on] / width).astype(int), count - 1)
    values = force[on].astype(float)
    centres = (np.arange(count) + 0.5) * width
    found = by_bin(values, bins, count)
    names = {"mean": "mean", "std": "scatter of", "min": "least", "max": "largest"}
    data: dict[str, Any] = {
        f"force_{key}": ("angle", found[key], {"units": "N", "long_name": f"{text} tooth load"})
        for key, text in names.items()
    }
    about: dict[str, Any] = {"sprocket": sprocket, "teeth": wheel.teeth, "engagements": seatings}
    if "link_tension" in run:
        entering, leaving = _sides(run, wheel, sense * polar, on, begin)
        tight = max(entering, leaving)
        along = centres if entering >= leaving else centres[-1] - centres
        rollers = int(along.max() / tooth) + 1
        steps = decay(wheel.teeth, rollers, angle=angle)[1]
        reference = tight * steps[(along / tooth).astype(int)]
        binder = {"units": "N", "long_name": "Binder's geometric decay"}
        data["force_reference"] = ("angle", reference, binder)
        about |= {
            "tight_tension": tight,
            "tight_side": "entering" if entering >= leaving else "leaving",
            "pressure_angle": pressure_angle(wheel.teeth) if angle is None else angle,
        }
    coordinate = {"units": "rad", "long_name": "angle since seating"}
    return xr.Dataset(data, coords={"angle": ("angle", centres, coordinate)}, attrs=about)


def _since_seating(polar: _Floats, on: NDArray[np.bool_]) -> tuple[_Floats, int, float]:
    """Return the angle since seating [rad], how many rollers were seated, and where [rad]."""
    entered = on[1:] & ~on[:-1]
    if not entered.any():
        raise ParameterError("no roller comes to its seat during the run: simulate longer", "until")
    # All enter at nearly the same place; angles are averaged as directions.
    begin = float(np.angle(np.exp(1j * polar[1:][entered]).mean()))
    # A roller seen shortly before the mean place is not one turn farther.
    margin = 0.1
    since = (polar - begin + margin) % (2 * math.pi) - margin
    return np.maximum(since, 0.0), int(entered.sum()), begin


def _sides(
    run: xr.Dataset, wheel: SprocketParts, polar: _Floats, on: NDArray[np.bool_], begin: float
) -> tuple[float, float]:
    """Return the tension [N] that enters and that which leaves, without the centrifugal share."""
    chain = wheel.chain
    own = slice(chain.first, chain.first + chain.links)
    tension = run["link_tension"].isel(link=own).transpose("time", "link").to_numpy()
    before, after = on[:, : chain.links], np.roll(on, -1, axis=1)[:, : chain.links]
    ends = before ^ after
    # A link with one end on the sprocket enters or leaves, as its seated roller came or has been
    # there.
    seated = np.where(before, polar[:, : chain.links], np.roll(polar, -1, axis=1)[:, : chain.links])
    since = (seated - begin + 0.1) % (2 * math.pi)
    half = float(np.median(since[ends]))
    entering, leaving = tension[ends & (since <= half)], tension[ends & (since > half)]
    turned = run["sprocket_angle"].sel(sprocket=wheel.name).to_numpy()
    seconds = float(run["time"][-1] - run["time"][0])
    speed = abs(float(turned[-1] - turned[0])) / seconds * wheel.teeth * chain.pitch / (2 * math.pi)
    # m′v²: the chain turns itself around the sprocket with this part of its tension.
    share = chain.mass_per_length * speed**2
    return float(entering.mean()) - share, float(leaving.mean()) - share
