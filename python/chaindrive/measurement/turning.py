"""The angle of a shaft: by an encoder, by pulses of a tacho, or by a speed."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from chaindrive.errors import MeasurementError
from chaindrive.measurement.amount import amount, is_number
from chaindrive.measurement.raw import RawChannel
from chaindrive.measurement.time_base import Finding
from chaindrive.measurement.units import unit_of

__all__ = ["Encoder", "Speed", "Tacho", "Turning", "angle_by", "source_of", "turning_by"]

_Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Encoder:
    """An encoder: counts, or an angle that begins anew every turn."""

    channel: str
    """Name of its channel."""
    counts: float | None = None
    """Counts a turn; absent where the channel has a unit of an angle."""
    wraps_at: float | None = None
    """Count after which its counter begins anew, such as 65536; absent: by turns, or never."""

    def __post_init__(self) -> None:
        for name in ("counts", "wraps_at"):
            value = getattr(self, name)
            if value is not None:
                _refuse_unless_positive("encoder", name, value)


@dataclass(frozen=True)
class Tacho:
    """Pulses: so many a turn, each counted where it rises."""

    channel: str
    """Name of its channel."""
    pulses: float = 1
    """Pulses a turn [–]."""
    level: float | None = None
    """Reading at which a pulse counts; half way between its levels when absent."""

    def __post_init__(self) -> None:
        _refuse_unless_positive("tacho", "pulses", self.pulses)
        if self.level is not None and not is_number(self.level):
            raise MeasurementError(f"tacho: level = {self.level!r}, must be a number", "level")


def _refuse_unless_positive(what: str, name: str, value: Any) -> None:
    if not is_number(value) or value <= 0.0:
        raise MeasurementError(f"{what}: {name} = {value!r}, must be a positive number", name)


@dataclass(frozen=True)
class Speed:
    """A speed: stated, ``"300 rpm"`` or a number [rad/s], or the channel that has it."""

    speed: float | str
    """Speed of the shaft, or the name of a channel."""


Turning: TypeAlias = Encoder | Tacho | Speed
_KINDS: Mapping[str, type[Encoder | Tacho]] = {"encoder": Encoder, "tacho": Tacho}


def turning_by(
    given: Turning | str | float | Mapping[str, Any], shaft: str, channels: Iterable[str]
) -> Turning:
    """Return how a shaft turns: as given, as a speed, or by a table such as ``{"tacho": "pulse"}``.

    A speed that is stated is a number [rad/s] then; any other has a channel that there is.

    Parameters
    ----------
    given
        How its angle is known.
    shaft
        Its name, for messages.
    channels
        Names of the channels that there are.

    Raises
    ------
    MeasurementError
        The table names neither encoder, tacho nor speed, or has keys that these have not, or
        values out of their range; the channel does not exist, or the speed is none.
    """
    how = _turning(given, shaft)
    names = list(channels)
    source = how.speed if isinstance(how, Speed) else how.channel
    if source in names:
        return how
    known = ", ".join(map(repr, names))
    if not isinstance(how, Speed):
        message = f"turns.{shaft}: no channel is named {source!r}: there are {known}"
        raise MeasurementError(message, shaft)
    try:
        return Speed(amount(source, "rad/s", f"turns.{shaft}"))
    except MeasurementError as error:
        if not isinstance(source, str) or source[:1].isdigit():
            raise
        message = f"turns.{shaft} = {source!r} is neither a speed nor a channel: there are {known}"
        raise MeasurementError(message, shaft) from error


def _turning(given: Turning | str | float | Mapping[str, Any], shaft: str) -> Turning:
    if isinstance(given, Encoder | Tacho | Speed):
        return given
    if not isinstance(given, Mapping):
        return Speed(given)
    for kind, of in _KINDS.items():
        if kind in given:
            rest = {key: value for key, value in given.items() if key != kind}
            try:
                return of(str(given[kind]), **rest)
            except MeasurementError as error:
                raise MeasurementError(f"turns.{shaft}: {error}", shaft) from None
            except TypeError as error:
                reason = str(error).rpartition("__init__() ")[2]
                raise MeasurementError(f"turns.{shaft}: {reason}", shaft) from None
    if set(given) == {"speed"}:
        return Speed(given["speed"])
    keys = ", ".join(map(repr, given))
    message = f"turns.{shaft}: {keys} tell no angle"
    raise MeasurementError(message, shaft, "name an `encoder`, a `tacho` or a `speed`")


def source_of(how: Turning) -> str | None:
    """Return the channel that tells the angle of a shaft; None where its speed is stated."""
    source = how.speed if isinstance(how, Speed) else how.channel
    return source if isinstance(source, str) else None


def angle_by(
    how: Turning, channels: Mapping[str, tuple[RawChannel, _Floats]], time: _Floats, shaft: str
) -> tuple[_Floats, list[Finding]]:
    """Return the angle of a shaft [rad] at the times of a base, (samples,), and what was found.

    Parameters
    ----------
    how
        How its angle is known, by `turning_by`.
    channels
        Channels that tell angles, by name, each with the times of its samples [s], which rise.
    time
        Times at which the angle is wanted [s].
    shaft
        Its name, for messages.

    Raises
    ------
    MeasurementError
        The channel tells no angle.
    """
    if isinstance(how, Speed) and isinstance(how.speed, float):
        return how.speed * time, []
    channel, own = channels[str(source_of(how))]
    good = np.isfinite(channel.values)
    channel, own = replace(channel, values=channel.values[good]), own[good]
    if own.size < 2:
        message = f"turns.{shaft}: {channel.name} has {own.size} readings"
        raise MeasurementError(message, shaft, "at least 2")
    if isinstance(how, Speed):
        return _by_speed(channel, own, time, shaft), []
    if isinstance(how, Encoder):
        angle = _by_encoder(how, channel, shaft)
        # An encoder steps: it is known where it does, and goes straight on between.
        fresh = np.concatenate([[True], np.diff(angle) != 0.0])
        return np.interp(time, own[fresh], angle[fresh]), []
    return _by_pulses(how, channel, own, time, shaft)


def _by_speed(channel: RawChannel, own: _Floats, time: _Floats, shaft: str) -> _Floats:
    unit = unit_of(channel.unit)
    # A tacho that reads 1/s counts turns.
    factor = {"rad/s": unit.factor, "Hz": 2.0 * np.pi * unit.factor}.get(unit.si)
    if factor is None:
        message = (
            f"turns.{shaft}: {channel.name} is in {channel.unit or 'no unit'}, which is no speed"
        )
        raise MeasurementError(
            message, shaft, f"say it: channels = {{{channel.name!r}: {{'unit': 'rpm'}}}}"
        )
    speeds = factor * channel.values
    angle = np.concatenate([[0.0], np.cumsum(0.5 * (speeds[1:] + speeds[:-1]) * np.diff(own))])
    return _straight_on(time, own, angle)


def _by_encoder(how: Encoder, channel: RawChannel, shaft: str) -> _Floats:
    if how.counts is not None:
        factor, turn = 2.0 * np.pi / how.counts, float(how.counts)
    else:
        unit = unit_of(channel.unit)
        if unit.si != "rad":
            unit_in_file = channel.unit or "no unit"
            message = f"turns.{shaft}: {channel.name} is in {unit_in_file}, which is no angle"
            raise MeasurementError(
                message, shaft, "give the `counts` a turn, or the unit of the channel"
            )
        factor, turn = unit.factor, 2.0 * np.pi / unit.factor
    values = channel.values
    # 0° to 360° is a turn, whatever the last digit of 2π.
    if how.wraps_at is None and float(np.ptp(values)) > turn * (1.0 + 1e-9):
        steps = np.diff(values)
        forth = np.sign(np.sign(steps).sum())
        anew = np.flatnonzero(-forth * steps > 0.5 * turn)
        if not anew.size:
            # It never begins anew: two of its samples may be any number of turns apart.
            return factor * values
        # An angle begins anew after whole turns; where a counter does, nobody knows.
        if how.counts is not None:
            before, after = values[anew[0]], values[anew[0] + 1]
            message = (
                f"turns.{shaft}: {channel.name} counts beyond a turn of {how.counts:g}, and goes "
                f"back from {before:.10g} to {after:.10g}"
            )
            raise MeasurementError(
                message, shaft, "give `wraps_at`, where it begins anew, such as 65536"
            )
    # A fall by more than half of that between two samples is a new beginning.
    return factor * np.unwrap(values, period=how.wraps_at or turn)


def _straight_on(time: _Floats, moments: _Floats, angle: _Floats) -> _Floats:
    """Return an angle that is known at moments at other times: straight on between and beyond."""
    found = np.interp(time, moments, angle)
    for at, beside, is_beyond in ((0, 1, time < moments[0]), (-1, -2, time > moments[-1])):
        speed = (angle[at] - angle[beside]) / (moments[at] - moments[beside])
        found = np.where(is_beyond, angle[at] + speed * (time - moments[at]), found)
    return found


def _by_pulses(
    how: Tacho, channel: RawChannel, own: _Floats, time: _Floats, shaft: str
) -> tuple[_Floats, list[Finding]]:
    values = channel.values
    low, high = np.percentile(values, [1.0, 99.0])
    # Short pulses are rare among the samples.
    if high - low < 0.5 * float(np.ptp(values)):
        low, high = float(values.min()), float(values.max())
    level = 0.5 * (low + high) if how.level is None else how.level
    # A tenth of the height of hysteresis: noise at the level counts once.
    margin = 0.1 * (high - low)
    state = np.where(values > level + margin, 1, np.where(values < level - margin, 0, -1))
    known = np.flatnonzero(state >= 0)
    rises = np.flatnonzero(np.diff(state[known]) == 1)
    before, after = known[rises], known[rises + 1]
    if len(after) < 3:
        message = f"turns.{shaft}: {channel.name} has {len(after)} pulses through {level:.4g}"
        raise MeasurementError(message, shaft, "at least 3; give the `level` of a pulse")
    rise = values[after] - values[before]
    share = np.clip((level - values[before]) / rise, 0.0, 1.0)
    moments = own[before] + share * (own[after] - own[before])
    steps = np.diff(moments)
    neighbours = np.array([np.median(steps[max(0, n - 3) : n + 4]) for n in range(len(steps))])
    missed = np.maximum(np.round(steps / neighbours).astype(int), 1)
    found = []
    if (missed > 1).any():
        first = float(moments[int(np.argmax(missed > 1))])
        count = int((missed - 1).sum())
        text = f"{count} pulses are missing, first after {first:.6g} s; counted as passed"
        found.append(Finding("dropout", channel.name, text))
    counted = np.concatenate([[0], np.cumsum(missed)])
    return _straight_on(time, moments, 2.0 * np.pi / how.pulses * counted), found
