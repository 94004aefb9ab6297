"""The model of a sensor: what it makes of a quantity before that is sampled, and how well."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from chaindrive.errors import MeasurementError
from chaindrive.extras import extra
from chaindrive.measurement.amount import amount, is_number
from chaindrive.measurement.quantities import quantity_of
from chaindrive.measurement.units import unit_of

__all__ = ["NUISANCES", "Sensor"]

_Floats = NDArray[np.float64]

#: Parameters of a sensor that a fit may free, with what they are in SI.
NUISANCES: Mapping[str, str] = {
    "gain": "1",
    "bias": "the unit of the quantity",
    "drift": "the unit of the quantity a second",
    "delay": "s",
    "corner": "Hz",
    "integration": "s",
}

# Fields that are numbers, with their units of SI; None: that of the quantity.
_UNITS: Mapping[str, str | None] = {
    **dict.fromkeys(("scale", "offset", "gain_uncertainty", "gain", "drift"), "1"),
    **dict.fromkeys(("bias_uncertainty", "bias"), None),
    **{"corner": "Hz", "delay": "s", "integration": "s"},
}


@dataclass(frozen=True)
class Sensor:
    """One channel: which quantity of a drive it reads, in which unit, and how.

    A reading r of the file stands for ``x = sign · scale · (r − offset)`` in ``unit``. A simulated
    quantity x(t) is read as

    ::

        y(t) = gain · (1/T) ∫ (h ∗ x)(t′ − delay) dt′ + bias + drift · t,   t − T < t′ < t

    h is a Butterworth low-pass of an order and a corner, T the time of integration. All of it
    happens before anything is sampled. The standard uncertainty of a reading is
    ``u² = (gain_uncertainty · x)² + bias_uncertainty²``, common to all samples of a record.

    Examples
    --------
    >>> import chaindrive as cd
    >>> flange = cd.measurement.Sensor(
    ...     quantity="sprocket_torque[driver]", unit="N m", corner="1 kHz", gain_uncertainty=0.002
    ... )
    >>> flange.corner
    1000.0
    """

    quantity: str | None = None
    """Quantity of a drive, with the label of its place: ``"span_tension[crank-to-cam]"``."""
    unit: str | None = None
    """Unit of the readings, where the file does not tell it, or is wrong."""
    sign: int = 1
    """−1 where the sensor counts against the signs of the drive."""
    scale: float = 1.0
    """Of ``unit`` a unit of the file, such as 50 N m a volt."""
    offset: float = 0.0
    """Reading [unit of the file] of a quantity that is zero."""
    gain_uncertainty: float = 0.0
    """Standard uncertainty of the gain [–]."""
    bias_uncertainty: float = 0.0
    """Standard uncertainty of the zero [SI], or a text with a unit."""
    gain: float = 1.0
    """Reading over what is there [–]: an error of the gain, known or to be fitted."""
    bias: float = 0.0
    """Reading of nothing [SI]."""
    drift: float = 0.0
    """Change of the bias with time [SI/s]."""
    corner: float | None = None
    """Corner of the low-pass, −3 dB [Hz]; absent: none."""
    order: int = 2
    """Order of the low-pass [–]."""
    delay: float = 0.0
    """Time by which readings come late [s]."""
    integration: float = 0.0
    """Time over which a reading is a mean [s]."""
    link: int | None = None
    """Link that carries the gauge, of one that travels with the chain; absent: unknown."""
    relative: bool = False
    """Whether amplitudes mean nothing, as those of a microphone: its lines are compared alone."""

    def __post_init__(self) -> None:
        for name, unit in _UNITS.items():
            value = getattr(self, name)
            if name == "corner" and value is None:
                continue
            if unit is None and not is_number(value):
                unit = self._unit_of_quantity()
            # A zero that is 2 °C off is so many kelvin off.
            found = amount(value, unit, name, is_difference=True)
            if not is_number(found):
                raise MeasurementError(f"sensor: {name} = {found}, must be finite", name)
            object.__setattr__(self, name, found)
        bounds = [
            ("sign", self.sign in (-1, 1), "1 or −1"),
            ("scale", self.scale > 0.0, "positive; `sign` turns it around"),
            ("gain", self.gain != 0.0, "other than 0, at which a sensor reads nothing"),
            ("gain_uncertainty", 0.0 <= self.gain_uncertainty < 1.0, "in [0, 1)"),
            ("bias_uncertainty", self.bias_uncertainty >= 0.0, "0 or more"),
            ("order", self.order in range(1, 13), "1 to 12"),
            ("corner", self.corner is None or self.corner > 0.0, "positive [Hz]"),
            ("integration", self.integration >= 0.0, "0 or more [s]"),
        ]
        for name, is_right, allowed in bounds:
            if not is_right:
                message = f"sensor: {name} = {getattr(self, name)!r}, must be {allowed}"
                raise MeasurementError(message, name)

    def _unit_of_quantity(self) -> str | None:
        """Return the unit of SI that readings are in; None where it is not known."""
        if self.unit is not None:
            return unit_of(self.unit).si
        if self.quantity is None:
            return None
        unit = quantity_of(self.quantity).unit
        # Of a tensioner it is that of its kind, `m or rad`.
        return None if " or " in unit else unit or None

    @classmethod
    def of(cls, given: Sensor | str | Mapping[str, Any], channel: str = "") -> Sensor:
        """Return a sensor as given, by the text of its quantity, or by a table of its fields.

        Raises
        ------
        MeasurementError
            A field does not exist, or is out of its range; the message names the channel.
        """
        if isinstance(given, Sensor):
            return given
        if isinstance(given, str):
            return cls(quantity=given)
        if not isinstance(given, Mapping):
            message = f"channels.{channel} = {given!r} is no sensor"
            hint = "give the text of a quantity, or a table of fields; or leave the channel out"
            raise MeasurementError(message, channel, hint)
        known = {it.name for it in fields(cls)}
        strange = [name for name in given if name not in known]
        if strange:
            message = f"channels.{channel}: a sensor has no {strange[0]!r}"
            raise MeasurementError(message, channel, f"it has {', '.join(sorted(known))}")
        try:
            return cls(**given)
        except MeasurementError as error:
            raise MeasurementError(f"channels.{channel}: {error}", channel) from None
        except TypeError as error:
            raise MeasurementError(f"channels.{channel}: {error}", channel) from None

    def replace(self, **changes: Any) -> Sensor:
        """Return the same sensor with some fields changed."""
        return replace(self, **changes)

    def to_json(self) -> str:
        """Return what differs from a plain sensor, as JSON."""
        plain = asdict(Sensor())
        return json.dumps({key: it for key, it in asdict(self).items() if it != plain[key]})

    @classmethod
    def from_json(cls, text: str) -> Sensor:
        """Return the sensor of such a text."""
        return cls.of(json.loads(text))

    def observe(self, values: _Floats, time: _Floats, later: float = 0.0) -> _Floats:
        """Return what the sensor reads of a quantity, at the times at which it is known.

        Parameters
        ----------
        values : (samples,)
            The quantity [SI].
        time : (samples,)
            Equally spaced times [s], as densely as the motion asks for.
        later
            Time from the zero of the drift to the first value [s].

        Returns
        -------
        (samples,)
            Readings [SI]. Before the first value the quantity is taken as the mean over the time
            that the low-pass, or the integration, looks back: what is faster leaves no start-up.

        Raises
        ------
        MeasurementError
            The low-pass needs samples more often than there are.
        """
        found = np.asarray(values, dtype=np.float64)
        interval = float(time[-1] - time[0]) / (len(time) - 1)
        if self.corner is not None:
            if self.corner >= 0.5 / interval:
                raise MeasurementError(
                    f"a low-pass of {self.corner:.6g} Hz needs samples every "
                    f"{0.25 / self.corner:.3g} s or less; the run has them every {interval:.3g} s",
                    "corner",
                    "record more often: every=…; or leave the corner out",
                )
            scipy = extra("scipy.signal", "models of sensors")
            sections = scipy.butter(self.order, self.corner, fs=1.0 / interval, output="sos")
            at_rest = scipy.sosfilt_zi(sections) * _before(found, 1.0 / (self.corner * interval))
            found, _ = scipy.sosfilt(sections, found, zi=at_rest)
        if self.integration > 0.0:
            # (1/T) ∫ x dt′ of straight lines between samples, exactly.
            steps = 0.5 * (found[1:] + found[:-1]) * np.diff(time)
            area = np.concatenate([[0.0], np.cumsum(steps)])
            begin = time - self.integration
            first = _before(found, self.integration / interval)
            early = np.minimum(begin - time[0], 0.0) * first
            found = (area - _area(time, found, area, begin) - early) / self.integration
        if self.delay != 0.0:
            found = np.interp(time - self.delay, time, found)
        read: _Floats = self.gain * found + self.bias + self.drift * (later + time - time[0])
        return read

    def uncertainty(self, value: float, *, is_mean: bool) -> float:
        """Return the standard uncertainty of a statistic of the readings [SI].

        Parameters
        ----------
        value
            The statistic [SI].
        is_mean
            Whether the zero counts, as in means and percentiles; amplitudes and scatter know none.
        """
        bias = self.bias_uncertainty if is_mean else 0.0
        return float(np.hypot(self.gain_uncertainty * value, bias))


def _before(values: _Floats, samples: float) -> float:
    """Return the level of a quantity before its first value: its mean over some samples."""
    return float(values[: max(1, round(samples))].mean())


def _area(time: _Floats, values: _Floats, area: _Floats, at: _Floats) -> _Floats:
    """Return the integral up to given times, of straight lines between samples."""
    at = np.clip(at, time[0], time[-1])
    before = np.clip(np.searchsorted(time, at, side="right") - 1, 0, len(time) - 2)
    within = at - time[before]
    slope = (values[before + 1] - values[before]) / (time[before + 1] - time[before])
    found: _Floats = area[before] + within * (values[before] + 0.5 * slope * within)
    return found
