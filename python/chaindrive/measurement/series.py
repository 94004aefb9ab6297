"""One channel at equal intervals with the angle beside it: measured, or simulated and sensed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from chaindrive.analysis.orders import over_angle
from chaindrive.analysis.signal import turning
from chaindrive.errors import MeasurementError
from chaindrive.labelled import labelled
from chaindrive.measurement.quantities import MeasuredQuantity
from chaindrive.measurement.record import FORMAT
from chaindrive.measurement.sensor import Sensor
from chaindrive.measurement.time_base import longest_even

__all__ = [
    "LATE",
    "Series",
    "channel_names",
    "folded",
    "measured_series",
    "sensor_of",
    "simulated_series",
]

_Floats = NDArray[np.float64]

#: Places between two samples of the measurement where samples of a run could stand as well [–].
LATE = (0.25, 0.5, 0.75)


@dataclass(frozen=True)
class Series:
    """A signal at equal intervals."""

    time: _Floats
    """Times [s] (samples,)."""
    values: _Floats
    """Readings [SI] (samples,)."""
    angle: _Floats | None
    """Angle of the reference shaft [rad] (samples,), rising from zero; None where unknown."""

    @property
    def rate(self) -> float:
        """Samples a second [Hz]."""
        return (self.time.size - 1) / float(self.time[-1] - self.time[0])

    @property
    def turns(self) -> float:
        """Turns of the reference shaft; zero where its angle is not known."""
        return 0.0 if self.angle is None else float(self.angle[-1]) / (2.0 * np.pi)

    def by_angle(self, per_turn: int) -> _Floats:
        """Return the readings at equal angles of the shaft, (samples,), so many a turn."""
        assert self.angle is not None
        values = xr.DataArray(labelled(("time",), self.values))
        return over_angle(values, self.angle, float(per_turn))[1]


def channel_names(data: xr.Dataset) -> list[str]:
    """Return the channels of a measurement.

    Raises
    ------
    MeasurementError
        This is no measurement.
    """
    if data.attrs.get("format") != FORMAT:
        message = "this dataset is no measurement"
        raise MeasurementError(message, "data", "read it by chaindrive.measured(path)")
    return [str(name) for name, it in data.data_vars.items() if "sensor" in it.attrs]


def sensor_of(data: xr.Dataset, name: str) -> Sensor:
    """Return the sensor of a channel of a measurement."""
    return Sensor.from_json(data[name].attrs["sensor"])


def measured_series(data: xr.Dataset, name: str, shaft: str | None) -> Series:
    """Return a channel of a measurement: its longest stretch without a gap.

    Parameters
    ----------
    data
        What `measured` returned.
    name
        The channel.
    shaft
        The shaft whose angle is wanted; None for none. Unknown where the measurement has it not.
    """
    channel = data[name]
    base = str(channel.dims[0])
    time, values = longest_even(data[base].to_numpy(), channel.to_numpy())
    angles = data.get("sprocket_angle" + base.removeprefix("time"))
    if shaft is None or angles is None or shaft not in angles["sprocket"].to_numpy():
        return Series(time, values, None)
    own = angles.sel(sprocket=shaft).to_numpy()
    known = np.isfinite(own)
    angle = np.interp(time, data[base].to_numpy()[known], own[known])
    return Series(time, values, _rising(angle, shaft))


def simulated_series(
    run: xr.Dataset,
    quantity: MeasuredQuantity,
    sensor: Sensor,
    beside: Series,
    shaft: str | None,
    late: float = 0.0,
) -> Series:
    """Return a quantity of a run as the sensor reads it, sampled as the measurement is.

    Parameters
    ----------
    run
        The run, sampled as densely as its motion asks for.
    quantity, sensor
        What is read, and how.
    beside
        The measurement: not more samples a second than the run has are taken, and a zero that
        drifts is on the average where it is there.
    shaft
        The shaft whose angle is wanted.
    late
        Share of an interval of the measurement by which the first sample is late, in [0, 1).
    """
    time = run["time"].to_numpy()
    # The last sample stands where the run ended, up to a step after its place.
    even, values = longest_even(time[:-1], quantity.of(run, sensor.link)[:-1])
    # A record may be longer than the run, and begin after the sensor was set to zero.
    later = float(np.mean(beside.time)) - float(np.mean(even - even[0]))
    read = sensor.observe(values, even, later)
    own = (even.size - 1) / float(even[-1] - even[0])
    # Samples of a rig are taken, not averaged: what is above half their rate folds down, and a line
    # between two of them would cut the peaks of impacts.
    denser = max(1, round(own / beside.rate))
    among = slice(int(late * denser), None, denser)
    sampled, readings = even[among], read[among]
    angle = None
    if shaft is not None and ("sprocket_angle" in run or "shaft_angle" in run):
        angle = _rising(np.interp(sampled, time, turning(run, shaft)[0]), shaft)
    return Series(sampled, readings, angle)


def folded(values: Sequence[Any], value: Any) -> _Floats:
    """Return the error of numbers of a run by lines that fold down, the shape of `value`.

    Lines above half the sampling rate fold down onto others (Nyquist). Where the rate is a whole
    multiple of something in the drive they fold onto its orders, with a phase that hangs on the
    place of a sample between two teeth, of which a record says nothing.

    Parameters
    ----------
    values
        The numbers where samples are late, at each of `LATE`.
    value
        The numbers where they are not.
    """
    moved = np.asarray(values, dtype=np.float64) - np.asarray(value, dtype=np.float64)
    return np.asarray(np.sqrt(np.mean(np.square(moved), axis=0)))


def _rising(angle: _Floats, shaft: str) -> _Floats:
    """Return an angle from zero on in the direction of turning, rising with every sample."""
    angle = (angle - angle[0]) * (1.0 if angle[-1] >= angle[0] else -1.0)
    back = float(np.minimum(np.diff(angle), 0.0).min(initial=0.0))
    if -back > 0.1 * 2.0 * np.pi:
        message = f"{shaft} goes back by {-back:.3g} rad: it has no orders"
        raise MeasurementError(message, shaft, "give its speed in place of its angle")
    # Noise of an encoder may go back a little; a shaft that turns on does not.
    risen = np.maximum.accumulate(angle)
    least = 1e-9 * max(float(risen[-1]), 1e-12)
    return np.asarray(risen + least * np.arange(risen.size))
