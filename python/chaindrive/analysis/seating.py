"""Impacts of rollers that are seated: speed, momentum and energy of every engagement."""

from __future__ import annotations

import math

import numpy as np
import xarray as xr

from chaindrive.analysis.parts import ChainParts, SprocketParts, sprockets
from chaindrive.analysis.signal import recorded, require
from chaindrive.errors import ParameterError

__all__ = ["PERCENTILES", "impacts", "striking", "swing_speed"]

PERCENTILES = (10.0, 50.0, 90.0, 99.0)
"""Percentiles that `impacts` returns."""


def impacts(run: xr.Dataset, *, mass: float | None = None) -> xr.Dataset:
    """Return the seating impact of every roller that came to a sprocket.

    The impact of an engagement is the first contact of its roller with the sprocket; later ones
    are bounces. A roller engages anew when it has been away for longer than it stays.

    ::

        J = (1 + e) m v,    E = ½ m v²,    ΔE = ½ (1 − e²) m v²

    The closing speed v is along the normal of the tooth. It is held against the speed of a roller
    that swings about its seated neighbour, v₀ = p ω: with a pressure angle φ about p ω sin(φ +
    2π/z) of it is along the normal. e is the restitution that the scene asks for. Where a film of
    oil or viscous damping takes its place, J, ΔE and the power that is lost are NaN: what comes
    back then hangs on the speed.

    Parameters
    ----------
    run
        A run with ``events="teeth"`` and the channel ``sprocket_angle``.
    mass
        Mass m that strikes [kg]. Absent: what the model has at a roller, the mass of a whole link
        for particles, that of the roller where rollers are bodies of their own.

    Returns
    -------
    xarray.Dataset
        One row an engagement: ``sprocket_of``, ``roller_of``, ``time_of`` [s], ``speed`` [m/s],
        ``impulse`` [N s], ``energy`` and ``energy_lost`` [J], ``peak_force`` [N]; (engagement,).
        For every sprocket: ``speed_percentile`` and ``energy_percentile`` (sprocket, percentile),
        ``rate`` [Hz] of engagements, ``power`` [W] of the energy lost, ``contacts`` per engagement
        and ``speed_theoretical``, p ω [m/s]; (sprocket,).

    Raises
    ------
    ParameterError
        No contacts were logged, or no roller came to a sprocket.

    Examples
    --------
    >>> import chaindrive as cd
    >>> from chaindrive.analysis import impacts
    >>> run = cd.simulate(cd.scenes.industrial_16b(), until=0.05, events="teeth", error=False)
    >>> found = impacts(run)
    >>> bool((found["speed"] < found["speed_theoretical"].max()).all())
    True
    """
    if "event_kind" not in run:
        raise ParameterError("no contacts were logged: simulate(…, events='teeth')", "events")
    recorded(run, "sprocket_angle")
    require(run, "sprocket")
    known = sprockets(run)
    rows = [_of(run, wheel, striking(wheel.chain, mass)) for wheel in known.values()]
    seconds = float(run["time"][-1] - run["time"][0])
    if not any(engaged.sizes["engagement"] for engaged, _ in rows):
        message = "no roller came to a sprocket during the run: simulate longer"
        raise ParameterError(message, "until")
    engagements = xr.concat([engaged for engaged, _ in rows], "engagement")
    names = np.asarray(list(known), dtype=np.str_)
    of = engagements["sprocket_of"].to_numpy()
    summary: dict[str, tuple[tuple[str, ...], list[object], dict[str, str]]] = {}
    for key, unit in [("speed", "m/s"), ("energy", "J")]:
        values = engagements[key].to_numpy()
        table: list[object] = [
            np.percentile(values[of == name], PERCENTILES)
            if (of == name).any()
            else np.full(len(PERCENTILES), np.nan)
            for name in names
        ]
        text = {"units": unit, "long_name": f"{key} of impacts"}
        summary[f"{key}_percentile"] = (("sprocket", "percentile"), table, text)
    lost = engagements["energy_lost"].to_numpy()
    for key, unit, label, column in [
        ("rate", "Hz", "engagements a second", [(of == name).sum() / seconds for name in names]),
        (
            "power",
            "W",
            "power lost in impacts",
            [lost[of == name].sum() / seconds for name in names],
        ),
        ("contacts", "1", "contacts an engagement", [contacts for _, contacts in rows]),
        (
            "speed_theoretical",
            "m/s",
            "pitch times speed",
            [swing_speed(run, it) for it in known.values()],
        ),
    ]:
        summary[key] = (("sprocket",), list(column), {"units": unit, "long_name": label})
    return engagements.assign(summary).assign_coords(
        sprocket=names,
        percentile=("percentile", list(PERCENTILES), {"units": "%", "long_name": "percentile"}),
    )


def _of(run: xr.Dataset, wheel: SprocketParts, mass: float) -> tuple[xr.Dataset, float]:
    """Return the engagements with a sprocket, and how many contacts each has in the mean."""
    start = float(run["time"][0])
    mine = (run["event_kind"] == "tooth") & (run["event_body"] == wheel.name)
    # A contact that is closed when the record begins has no onset in it.
    chosen = run.isel(event=np.flatnonzero(mine & (run["event_start"] > start)))
    roller = chosen["event_roller"].to_numpy()
    begun, ended = chosen["event_start"].to_numpy(), chosen["event_end"].to_numpy()
    order = np.lexsort((begun, roller))
    roller, begun, ended = roller[order], begun[order], ended[order]
    # A roller is away for the rest of the chain's circuit, and bounces for less than its wrap.
    away = _absence(run, wheel)
    first = np.ones(order.size, dtype=bool)
    first[1:] = (roller[1:] != roller[:-1]) | (begun[1:] - ended[:-1] > away)
    # What lies on the sprocket when the record begins bounces there without having come.
    present = run.isel(event=np.flatnonzero(mine & (run["event_start"] <= start)))
    lain = dict(
        zip(present["event_roller"].to_numpy(), present["event_end"].to_numpy(), strict=True)
    )
    stays = np.array([b - lain.get(r, -np.inf) < away for r, b in zip(roller, begun, strict=True)])
    came = first & ~stays if order.size else first
    picked = chosen.isel(event=order[came])
    speed = picked["event_onset_speed"].to_numpy()
    restitution = math.nan if wheel.restitution is None else wheel.restitution
    # J = (1 + e) m v,  E = ½ m v²,  ΔE = ½ (1 − e²) m v²
    energy = 0.5 * mass * speed**2
    columns = {
        "time_of": (picked["event_start"].to_numpy(), "s", "time of seating"),
        "speed": (speed, "m/s", "closing speed"),
        "impulse": ((1 + restitution) * mass * speed, "N s", "impulse of the impact"),
        "energy": (energy, "J", "energy of the impact"),
        "energy_lost": ((1 - restitution**2) * energy, "J", "energy lost in the impact"),
        "peak_force": (picked["event_peak_force"].to_numpy(), "N", "largest force of the contact"),
    }
    data = {
        name: ("engagement", values, {"units": unit, "long_name": text})
        for name, (values, unit, text) in columns.items()
    }
    names = np.full(speed.size, wheel.name, dtype="U64")
    engaged = xr.Dataset(data).assign(
        sprocket_of=("engagement", names, {"long_name": "sprocket"}),
        roller_of=("engagement", picked["event_roller"].to_numpy(), {"long_name": "roller"}),
    )
    # Bounces of what lay there when the record begins belong to no engagement.
    visits = int(came.sum())
    touches = came[np.maximum.accumulate(np.where(first, np.arange(order.size), 0))]
    return engaged, float(touches.sum() / visits) if visits else math.nan


def _absence(run: xr.Dataset, wheel: SprocketParts) -> float:
    """Return half of the time of a circuit of the chain [s]; infinite where it stands."""
    turns = _speed(run, wheel) * wheel.teeth / (2 * math.pi)
    return 0.5 * wheel.chain.links / turns if turns > 0.0 else math.inf


def _speed(run: xr.Dataset, wheel: SprocketParts) -> float:
    angle = run["sprocket_angle"].sel(sprocket=wheel.name).to_numpy()
    return abs(float(angle[-1] - angle[0])) / float(run["time"][-1] - run["time"][0])


def swing_speed(run: xr.Dataset, wheel: SprocketParts) -> float:
    """Return the speed of a roller that swings about its seated neighbour, p ω [m/s]."""
    return wheel.chain.pitch * _speed(run, wheel)


def striking(chain: ChainParts, given: float | None) -> float:
    """Return the mass that the model lets strike a tooth [kg]."""
    if given is not None:
        if not given > 0.0:
            raise ParameterError(f"mass = {given}, must be positive [kg]", "mass")
        return given
    scene = chain.scene
    own = scene.get("roller", {}).get("mass")
    if scene.get("rollers") == "free" and own is not None:
        return float(own)
    if "mass" in scene:
        return float(scene["mass"])
    if "masses" in scene:
        return float(np.mean(scene["masses"]))
    halves = [float(scene[kind]["mass"]) for kind in ("inner", "outer") if kind in scene]
    if not halves:
        raise ParameterError(f"{chain.title} has no mass in its scene: give mass= [kg]", "mass")
    # A hinged link struck at its end answers with a quarter of its mass, and two of them meet
    # there.
    return sum(halves) / 4 + float(own or 0.0)
