"""What a chain makes of an even rotation: transmission error and speed ripple."""

from __future__ import annotations

import numpy as np
import xarray as xr

from chaindrive import kinematics
from chaindrive.analysis.signal import late, recorded, require, signal
from chaindrive.errors import ParameterError
from chaindrive.pose import at_start, drive_of

__all__ = ["speed_ripple", "transmission_error"]


def transmission_error(
    run: xr.Dataset, driver: str, driven: str, *, after: float = 0.0
) -> xr.Dataset:
    """How far a sprocket runs ahead of or behind an even ratio.

    ``e(t) = θ₂ − θ₂(0) ∓ (z₁ / z₂) (θ₁ − θ₁(0))``, its mean taken off

    The dynamic error contains all: polygon action, stretch of the chain under changing load, and
    vibration. The kinematic one is that of a rigid chain that runs as a polygon over two sprockets
    in fixed bearings, by `chaindrive.kinematics.polygon_action`; only its range is given.

    Parameters
    ----------
    run
        A run with ``sprocket_angle``.
    driver, driven
        Sprockets of one chain.
    after
        Time up to which samples are left out [s].

    Returns
    -------
    xarray.Dataset
        ``error`` (time,) [rad] at the driven sprocket and ``error_length`` [m] at its pitch circle.
        Attributes: ``error_range``, peak to peak, and ``kinematic_range`` [rad], the latter NaN
        where the two turn against each other.

    Raises
    ------
    ParameterError
        The angles were not recorded, there is no such sprocket, or less than two samples are left.
    """
    run = late(run, after)
    angles = [
        signal(run, "sprocket_angle", {"sprocket": name}).to_numpy() for name in (driver, driven)
    ]
    first, second = (angle - angle[0] for angle in angles)
    drawn = at_start(drive_of(run), settled=False)
    wheels = [drawn["sprockets"][name] for name in (driver, driven)]
    chains = [chain for chain in drawn["chains"] if {driver, driven} <= set(chain["sprockets"])]
    if not chains:
        raise ParameterError(f"no chain runs over both {driver} and {driven}", "driven")
    ratio = wheels[0]["teeth"] / wheels[1]["teeth"]
    same = np.sign(first[-1]) * np.sign(second[-1])
    # e = θ₂ ∓ (z₁ / z₂) θ₁
    error = second - same * ratio * first
    error -= error.mean()
    apart = np.hypot(*np.subtract(wheels[1]["centre"], wheels[0]["centre"]).ravel())
    kinematic = np.nan
    if same > 0:
        first_teeth, second_teeth = (int(wheel["teeth"]) for wheel in wheels)
        action = kinematics.polygon_action(
            first_teeth, second_teeth, float(chains[0]["pitch"]), float(apart)
        )
        kinematic = float(action.attrs["transmission_error_range"])
    title = f"transmission error, {driver} to {driven}"
    radius = float(wheels[1]["pitch_radius"])
    return xr.Dataset(
        {
            "error": ("time", error, {"units": "rad", "long_name": title}),
            "error_length": ("time", radius * error, {"units": "m", "long_name": title}),
        },
        coords={"time": run["time"]},
        attrs={
            "driver": driver,
            "driven": driven,
            "ratio": ratio,
            "error_range": float(np.ptp(error)),
            "kinematic_range": kinematic,
        },
    )


def speed_ripple(run: xr.Dataset, *, after: float = 0.0) -> xr.Dataset:
    """How unevenly every sprocket turns.

    ``δ = (ω_max − ω_min) / |ω̄|``, the degree of irregularity

    Parameters
    ----------
    run
        A run with ``sprocket_speed`` at a steady mean speed.
    after
        Time up to which samples are left out [s].

    Returns
    -------
    xarray.Dataset
        ``mean_speed`` [rad/s], ``irregularity`` δ [–] and ``rms_ripple``, the standard deviation
        over the mean speed [–], (sprocket,).
    """
    recorded(run, "sprocket_speed")
    require(run, "sprocket")
    run = late(run, after)
    speed = run["sprocket_speed"]
    mean = speed.mean("time")
    found = {
        "mean_speed": (mean, "rad/s", "mean speed"),
        "irregularity": ((speed.max("time") - speed.min("time")) / abs(mean), "1", "irregularity"),
        "rms_ripple": (speed.std("time") / abs(mean), "1", "speed ripple, rms over mean"),
    }
    for values, unit, text in found.values():
        values.attrs = {"units": unit, "long_name": text}
    return xr.Dataset({name: values for name, (values, *_) in found.items()})
