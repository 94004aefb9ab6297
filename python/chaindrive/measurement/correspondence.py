"""Which channel of a measurement is which quantity of a drive, and the shaft that both turn by."""

from __future__ import annotations

import xarray as xr

from chaindrive.errors import MeasurementError
from chaindrive.measurement.quantities import MeasuredQuantity, guessed, quantity_of
from chaindrive.measurement.series import channel_names, sensor_of

__all__ = ["correspondence", "reference_shaft"]


def correspondence(data: xr.Dataset, run: xr.Dataset) -> dict[str, MeasuredQuantity]:
    """Return the quantity of every channel that has one: as said, or guessed by its name."""
    found = {}
    for name in channel_names(data):
        sensor = sensor_of(data, name)
        if sensor.quantity is not None:
            found[name] = quantity_of(sensor.quantity)
            continue
        guess = guessed(name, str(data[name].attrs["units"]), run)
        if guess is not None:
            found[name] = guess
    return found


def reference_shaft(run: xr.Dataset, data: xr.Dataset) -> str | None:
    """Return the first shaft of which the measurement knows the angle, and the run has one."""
    if "sprocket_angle" not in data:
        return None
    known = [str(it) for it in data["sprocket"].to_numpy()]
    ours = [
        str(it) for dim in ("sprocket", "shaft") if dim in run.coords for it in run[dim].to_numpy()
    ]
    for name in known:
        if name in ours:
            return name
    message = (
        f"the measurement knows how {', '.join(known)} turns, and the drive has {', '.join(ours)}"
    )
    raise MeasurementError(message, "turns", "name a sprocket or shaft of the drive")
