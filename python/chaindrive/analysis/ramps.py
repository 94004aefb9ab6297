"""Run-ups: a drive whose prescribed motion goes from one speed to another."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from chaindrive.drive import Drive
from chaindrive.errors import ParameterError
from chaindrive.quantity import with_unit
from chaindrive.settings import Quantity
from chaindrive.simulation import simulate

__all__ = ["prescribed", "run_up", "with_run_up"]


# Knots of a table in the shortest period of an order: the spline is then 0.2 % short in
# acceleration, (2π / 40)² / 12.
_KNOTS = 40


def run_up(
    drive: Drive,
    from_: Quantity,
    to: Quantity,
    *,
    until: float,
    run_in: Quantity | None = None,
    of: str | None = None,
    record: Any = None,
    **settings: Any,
) -> xr.Dataset:
    """Simulate a drive while its speed goes from one value to another.

    ``ω(t) = from + (to − from) (3 s² − 2 s³)``, ``s = t / until``

    The given rotation of the drive is replaced by this ramp, whose acceleration does not jump;
    orders that the motion has stay, with their amplitudes in angle. All else is as in the scene.
    A resonance is passed the more closely the slower the ramp: a line that sweeps by a hertz a
    second is some hertz wide.

    Parameters
    ----------
    drive
        What is run up.
    from_, to
        Speeds [rad/s], or texts with a unit, positive in the direction in which the drive turns.
        A run-down goes from the higher speed to the lower one.
    until
        Duration of the ramp and of the run [s].
    run_in
        What is simulated before the ramp, at the speed from which it starts, as in `simulate`, or
        in the scene when absent; in seconds where the motion has orders.
    of
        Sprocket or shaft whose motion is replaced; needed where several have one.
    record
        Channels, as in `simulate`; ``sprocket_angle`` is recorded too.
    **settings
        Further settings of `simulate`.

    Returns
    -------
    xarray.Dataset
        As from `simulate`, with the coordinate ``speed`` (time,) [rad/s] of the ramp, and
        the attribute ``run_up``: the sprocket or shaft.

    Raises
    ------
    ParameterError
        No motion is given, several are, it turns neither way, or the speeds are not positive.
    """
    changed, name, speed = with_run_up(drive, from_, to, until=until, run_in=run_in, of=of)
    channels = _with_angles(drive, record)
    run = simulate(changed, until=until, run_in=run_in, record=channels, **settings)
    time = run["time"].to_numpy()
    about = {"units": "rad/s", "long_name": f"speed of {name}"}
    run = run.assign_coords(speed=("time", _ramp(*speed, until, time)[1], about))
    run.attrs["run_up"] = name
    return run


def with_run_up(
    drive: Drive,
    from_: Quantity,
    to: Quantity,
    *,
    until: float,
    run_in: Quantity | None = None,
    of: str | None = None,
) -> tuple[Drive, str, tuple[float, float]]:
    """Return a drive that runs up, the sprocket or shaft with the ramp, and the speeds [rad/s].

    Parameters and errors as in `run_up`.
    """
    if not until > 0.0:
        raise ParameterError(f"until = {until}, must be positive [s]", "until")
    kind, name, motion = prescribed(drive, of)
    path = f"{kind}.{name}.motion"
    direction = _direction(motion)
    if direction == 0.0:
        raise ParameterError(
            f"{path} turns neither way, so that a run-up has no direction: give it a speed, "
            "negative for clockwise",
            "drive",
        )
    ramp = {"kind": "ramp", "from": from_, "to": to, "duration": until}
    ramped = drive.replace({path: ramp})
    # The scene's own reader turns texts with units into rad/s.
    read = _motions(ramped)[kind, name]
    start, end = float(read["from"]), float(read["to"])
    if min(start, end) < 0.0 or start == end:
        raise ParameterError(
            f"from {start:g} to {end:g} rad/s: both must be positive or zero, and differ; "
            "the drive keeps its direction",
            "from_",
        )
    terms = motion.get("terms", [])
    if not terms:
        ramp |= {"from": direction * start, "to": direction * end}
        return drive.replace({path: ramp}), name, (start, end)
    if motion["kind"] != "orders" or motion.get("of", name) != name:
        raise ParameterError(
            f"{path}: a run-up keeps orders of {name} itself, not harmonics over time or orders of "
            "another shaft: replace the motion first",
            "drive",
        )
    fastest = max(start, end) * max(float(term["order"]) for term in terms) / (2 * math.pi)
    if run_in is None:
        run_in = drive.resolved().to_dict().get("run", {}).get("run_in")
    in_seconds: Any = with_unit(run_in)
    if isinstance(in_seconds, str):
        raise ParameterError(
            f"run_in = {in_seconds!r}: {path} has orders, give the time in seconds", "run_in"
        )
    # Knots beyond both ends: the curvature of a natural spline vanishes at its own.
    step = 1.0 / (_KNOTS * fastest)
    before = math.ceil((in_seconds or 0.0) / step) + 4
    after = math.ceil(until / step) + 4
    time = np.linspace(-before * step, after * step, before + after + 1)
    smooth = direction * _ramp(start, end, until, time)[0]
    angle = smooth.copy()
    for term in terms:
        order, amplitude, phase = (
            float(term.get(key, 0.0)) for key in ("order", "amplitude", "phase")
        )
        # θ = α + Σ A (sin(o α + φ) − sin φ), α the angle of the ramp
        angle += amplitude * (np.sin(order * smooth + phase) - math.sin(phase))
    table = {"kind": "table", "times": time, "values": angle}
    return drive.replace({path: table}), name, (start, end)


def _direction(motion: Mapping[str, Any]) -> float:
    """Return 1 for a motion that turns counter-clockwise, −1 for clockwise, 0 for neither."""
    if motion["kind"] == "table":
        return float(np.sign(motion["values"][-1] - motion["values"][0]))
    speeds = motion.get("speeds", [motion.get(key, 0.0) for key in ("speed", "to", "from")])
    return next((float(np.sign(speed)) for speed in speeds if speed != 0.0), 0.0)


def _ramp(
    start: float, end: float, duration: float, time: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return angle [rad] and speed [rad/s] of a ramp, as a scene's motion ``ramp`` has them."""
    s = np.clip(time / duration, 0.0, 1.0)
    change = end - start
    # ω = from + Δ (3 s² − 2 s³),   α = from t + Δ (T (s³ − ½ s⁴) + t − T where t > T)
    late = np.maximum(time - duration, 0.0)
    angle = start * time + change * (duration * (s**3 - 0.5 * s**4) + late)
    return angle, start + change * s * s * (3.0 - 2.0 * s)


def _motions(drive: Drive) -> dict[tuple[str, str], dict[str, Any]]:
    """Return the rotations that are given, in SI units, by kind and name of what turns."""
    scene = drive.resolved().to_dict()
    return {
        (kind, body["name"]): body["motion"]
        for kind in ("shafts", "sprockets")
        for body in scene.get(kind, [])
        if "motion" in body and body["motion"]["kind"] != "held"
    }


def prescribed(drive: Drive, of: str | None) -> tuple[str, str, dict[str, Any]]:
    """Return the rotation that is given, in SI units, after kind and name of what turns."""
    found = {key: motion for key, motion in _motions(drive).items() if of in (None, key[1])}
    if not found:
        whose = "nothing" if of is None else repr(of)
        raise ParameterError(
            f"a run-up replaces a motion that is given, and {whose} has none: a wheel that torques "
            "drive runs up by itself",
            "of",
        )
    if len(found) > 1:
        names = ", ".join(repr(name) for _, name in found)
        raise ParameterError(f"several motions are given: name one, of={names}", "of")
    (kind, name), motion = next(iter(found.items()))
    return kind, name, motion


def _with_angles(drive: Drive, record: Any) -> Any:
    if record == "all" or record == ["all"]:
        return record
    names = drive.run_defaults.get("record") if record is None else record
    listed = [names] if isinstance(names, str) else list(names or [])
    return list(dict.fromkeys([*listed, "sprocket_angle"])) if listed else None
