"""The angle of a shaft: by an encoder, by pulses of a tacho, or by a speed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from chaindrive.errors import MeasurementError
from chaindrive.measurement.amount import amount
from chaindrive.measurement.raw import RawChannel
from chaindrive.measurement.time_base import Finding
from chaindrive.measurement.units import unit_of

__all__ = ["Encoder", "Speed", "Tacho", "Turning", "angle_by", "turning_by"]

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


@dataclass(frozen=True)
class Tacho:
    """Pulses: so many a turn, each counted where it rises."""

    channel: str
    """Name of its channel."""
    pulses: float = 1
    """Pulses a turn [–]."""
    level: float | None = None
    """Reading at which a pulse counts; half way between its levels when absent."""


@dataclass(frozen=True)
class Speed:
    """A speed: stated, ``"300 rpm"`` or a number [rad/s], or the channel that has it."""

    speed: float | str
    """Speed of the shaft, or the name of a channel."""


Turning: TypeAlias = Encoder | Tacho | Speed
_KINDS: Mapping[str, type[Encoder | Tacho]] = {"encoder": Encoder, "tacho": Tacho}


def turning_by(given: Turning | str | float | Mapping[str, Any], shaft: str) -> Turning:
    """Return how a shaft turns: as given, as a speed, or by a table such as ``{"tacho": "pulse"}``.

    Raises
    ------
    MeasurementError
        The table names neither encoder, tacho nor speed, or has keys that these have not.
    """
    if isinstance(given, Encoder | Tacho | Speed):
        return given
    if not isinstance(given, Mapping):
        return Speed(given)
    for kind, of in _KINDS.items():
        if kind in given:
            rest = {key: value for key, value in given.items() if key != kind}
            try:
                return of(str(given[kind]), **rest)
            except TypeError as error:
                reason = str(error).rpartition("__init__() ")[2]
                raise MeasurementError(f"turns.{shaft}: {reason}", shaft) from None
    if set(given) == {"speed"}:
        return Speed(given["speed"])
    keys = ", ".join(map(repr, given))
    message = f"turns.{shaft}: {keys} tell no angle"
    raise MeasurementError(message, shaft, "name an `encoder`, a `tacho` or a `speed`")


def angle_by(
    how: Turning, channels: Mapping[str, tuple[RawChannel, _Floats]], time: _Floats, shaft: str
) -> tuple[_Floats, list[Finding]]:
    """Return the angle of a shaft [rad] at the times of a base, (samples,), and what was found.

    Parameters
    ----------
    how
        How its angle is known.
    channels
        Channels of the file by name, each with the times of its samples [s].
    time
        Times at which the angle is wanted [s].
    shaft
        Its name, for messages.

    Raises
    ------
    MeasurementError
        The channel does not exist, or tells no angle.
    """
    if isinstance(how, Speed):
        return _by_speed(how, channels, time, shaft)
    if how.channel not in channels:
        known = ", ".join(map(repr, channels))
        message = f"turns.{shaft}: no channel is named {how.channel!r}: there are {known}"
        raise MeasurementError(message, shaft)
    channel, own = channels[how.channel]
    if isinstance(how, Encoder):
        angle = _by_encoder(how, channel, shaft)
        # An encoder steps: it is known where it does, and goes straight on between.
        stepped = np.flatnonzero(np.isfinite(angle))
        fresh = np.concatenate([[True], np.diff(angle[stepped]) != 0.0])
        known = stepped[fresh]
        return np.interp(time, own[known], angle[known]), []
    return _by_pulses(how, channel, own, time, shaft)


def _by_speed(
    how: Speed, channels: Mapping[str, tuple[RawChannel, _Floats]], time: _Floats, shaft: str
) -> tuple[_Floats, list[Finding]]:
    if how.speed not in channels:
        try:
            speed = amount(how.speed, "rad/s", f"turns.{shaft}")
        except MeasurementError as error:
            if not isinstance(how.speed, str) or how.speed[:1].isdigit():
                raise
            known = ", ".join(map(repr, channels))
            message = (
                f"turns.{shaft} = {how.speed!r} is neither a speed nor a channel: there are {known}"
            )
            raise MeasurementError(message, shaft) from error
        return speed * (time - time[0]), []
    channel, own = channels[str(how.speed)]
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
    good = np.isfinite(channel.values)
    own, speeds = own[good], factor * channel.values[good]
    angle = np.concatenate([[0.0], np.cumsum(0.5 * (speeds[1:] + speeds[:-1]) * np.diff(own))])
    return np.interp(time, own, angle), []


def _by_encoder(how: Encoder, channel: RawChannel, shaft: str) -> _Floats:
    values = channel.values
    unit = unit_of(channel.unit)
    if how.counts is None:
        if unit.si != "rad":
            unit_in_file = channel.unit or "no unit"
            message = f"turns.{shaft}: {channel.name} is in {unit_in_file}, which is no angle"
            raise MeasurementError(
                message, shaft, "give the `counts` a turn, or the unit of the channel"
            )
        turn, values = 2.0 * np.pi, unit.factor * values
    else:
        turn = how.wraps_at or how.counts
    good = np.isfinite(values)
    angle = np.full(values.shape, np.nan)
    # What falls by more than half a turn between two samples began anew.
    angle[good] = np.unwrap(values[good], period=turn)
    return angle if how.counts is None else angle * (2.0 * np.pi / how.counts)


def _by_pulses(
    how: Tacho, channel: RawChannel, own: _Floats, time: _Floats, shaft: str
) -> tuple[_Floats, list[Finding]]:
    values = channel.values
    low, high = np.nanpercentile(values, [1.0, 99.0])
    # Short pulses are rare among the samples.
    if high - low < 0.5 * float(np.nanmax(values) - np.nanmin(values)):
        low, high = float(np.nanmin(values)), float(np.nanmax(values))
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
    angle = 2.0 * np.pi / how.pulses * counted
    edge_first, edge_last = (angle[1] - angle[0]) / steps[0], (angle[-1] - angle[-2]) / steps[-1]
    shape = np.interp(time, moments, angle)
    shape = np.where(time < moments[0], angle[0] - edge_first * (moments[0] - time), shape)
    return np.where(time > moments[-1], angle[-1] + edge_last * (time - moments[-1]), shape), found
