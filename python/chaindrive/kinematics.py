"""Exact kinematics of a chain that runs over sprockets as a polygon, and centre distances.

No simulation: closed forms of two sprockets on the same side of a taut chain.
"""

from __future__ import annotations

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from chaindrive import _core
from chaindrive.errors import ParameterError

__all__ = ["centre_distance", "links_for", "polygon_action", "seating_speed"]

_UNITS = {
    "driven_angle": ("rad", "angle of the driven wheel since a seating on the driver"),
    "speed_ratio": ("1", "speed ratio, driven to driver"),
    "speed_ratio_rate": ("1/rad", "rate of the speed ratio with the driver's angle"),
    "transmission_error": ("rad", "transmission error at the driven wheel"),
    "span_angle": ("rad", "direction of the tight span against the line of centres"),
    "span_rate": ("1", "rate of the span's rotation with the driver's angle"),
    "span_links": ("1", "links in the tight span"),
    "driver_seat": ("rad", "angle of the driver's last seat past the normal of the span"),
    "driven_seat": ("rad", "angle of the driven wheel's first seat past the normal of the span"),
}


# No wheel has more, and more fit no number of the core.
_MOST_TEETH = 1_000_000


def polygon_action(
    teeth1: int,
    teeth2: int,
    pitch: float,
    centre_distance: float,
    *,
    driver_angle: ArrayLike | None = None,
) -> xr.Dataset:
    """Polygon action of an open drive over one tooth period.

    Parameters
    ----------
    teeth1, teeth2
        Teeth of the driver and of the driven wheel, each at least 3.
    pitch
        Pitch of the chain [m].
    centre_distance
        Distance of the centres [m].
    driver_angle : (driver_angle,)
        Angles of the driver since a seating [rad]; 361 over one tooth period when absent.

    Returns
    -------
    xarray.Dataset
        Over ``driver_angle``: ``driven_angle`` and ``transmission_error`` [rad], ``speed_ratio``
        and its rate, direction and rotation of the tight span, links in it, and the seats at
        both of its ends. Attributes: ``mean_ratio``, ``least_ratio``, ``greatest_ratio``,
        ``transmission_error_range`` [rad, peak to peak], ``lift_off`` [rad, driver angle from a
        seating to the lift-off at the driven wheel], pitch radii [m] and
        ``relative_seating_speed`` [in units of pitch × driver speed].

    Raises
    ------
    ParameterError
        Numbers out of range, wheels that overlap, or no whole link between them.
    """
    teeth = _counted(teeth1, teeth2)
    if driver_angle is None:
        driver_angle = np.linspace(0.0, 2.0 * np.pi / teeth1, 361)
    angle = np.ascontiguousarray(driver_angle, dtype=np.float64).ravel()
    columns, constants = _core.polygon_action(teeth, pitch, centre_distance, angle)
    return xr.Dataset(
        {
            name: ("driver_angle", columns[name], {"units": units, "long_name": long_name})
            for name, (units, long_name) in _UNITS.items()
        },
        coords={
            "driver_angle": (
                "driver_angle",
                angle,
                {"units": "rad", "long_name": "angle of the driver since a seating"},
            )
        },
        attrs={
            "teeth1": teeth1,
            "teeth2": teeth2,
            "pitch": pitch,
            "centre_distance": centre_distance,
            **constants,
        },
    )


def seating_speed(
    teeth1: int, teeth2: int, pitch: float, centre_distance: float, speed: float
) -> float:
    """Speed at which rollers meet their seats on the driver.

    Parameters
    ----------
    teeth1, teeth2, pitch, centre_distance
        As in `polygon_action`.
    speed
        Angular speed of the driver [rad/s].

    Returns
    -------
    float
        Speed of the roller relative to its seat, just before it touches [m/s].

    Raises
    ------
    ParameterError
        As `polygon_action`.
    """
    at_rest = np.zeros(0)
    _, constants = _core.polygon_action(_counted(teeth1, teeth2), pitch, centre_distance, at_rest)
    return constants["relative_seating_speed"] * pitch * abs(speed)


def links_for(teeth1: int, teeth2: int, pitch: float, centre_distance: float) -> float:
    """Links that a taut chain takes around two wheels, a number that is not whole.

    Parameters
    ----------
    teeth1, teeth2
        Teeth of the two wheels.
    pitch, centre_distance
        Pitch and distance of the centres [m].

    Raises
    ------
    ParameterError
        Numbers out of range, or wheels that overlap.

    Examples
    --------
    >>> from chaindrive import kinematics
    >>> round(kinematics.links_for(19, 57, 25.4e-3, 1.0), 3)
    117.671
    """
    return _core.links_for(_counted(teeth1, teeth2), pitch, centre_distance)


def centre_distance(teeth1: int, teeth2: int, pitch: float, links: float) -> float:
    """Centre distance [m] at which a taut chain takes so many links: the inverse of `links_for`.

    Parameters
    ----------
    teeth1, teeth2
        Teeth of the two wheels.
    pitch
        Pitch [m].
    links
        Number of links.

    Raises
    ------
    ParameterError
        Numbers out of range, or fewer links than wheels that touch need.
    """
    return _core.centre_distance_for(_counted(teeth1, teeth2), pitch, links)


def _counted(teeth1: int, teeth2: int) -> list[int]:
    """Return the teeth of two wheels; numbers that no wheel has are a `ParameterError`."""
    for name, teeth in (("teeth1", teeth1), ("teeth2", teeth2)):
        if not 3 <= teeth <= _MOST_TEETH:
            allowed = f"3 to {_MOST_TEETH}"
            raise ParameterError(f"{name} = {teeth}, must be {allowed}", name, allowed)
    return [teeth1, teeth2]


def __dir__() -> list[str]:
    return list(__all__)
