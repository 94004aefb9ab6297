"""A measurement as one labelled dataset: names, units, signs, times, angles, and its faults."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from os import PathLike
from typing import Any, TypeAlias

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from chaindrive import _core
from chaindrive.errors import MeasurementError, MeasurementWarning, warn
from chaindrive.labelled import indexed, labelled
from chaindrive.measurement.amount import amount
from chaindrive.measurement.faults import faults_of, too_slow
from chaindrive.measurement.formats import read_raw
from chaindrive.measurement.raw import RawChannel, RawRecord, numbered
from chaindrive.measurement.sensor import Sensor
from chaindrive.measurement.time_base import (
    Finding,
    intervals,
    rises,
    sampling_rate,
    sorted_in_time,
)
from chaindrive.measurement.turning import Turning, angle_by, source_of, turning_by
from chaindrive.measurement.units import unit_of
from chaindrive.settings import Quantity

__all__ = ["FORMAT", "measured"]

_Floats = NDArray[np.float64]
#: Name of a base, and the samples of a channel that are taken.
_Samples: TypeAlias = tuple[str, NDArray[np.int64]]

#: Attribute ``format`` of a measurement.
FORMAT = "chaindrive measurement"
#: Names of a time, the likelier ones first.
_TIMES = (
    *("time", "t", "zeit", "temps", "sec", "secs", "second", "seconds", "clock"),
    *("timestamp", "timestamps", "datetime", "date"),
)
#: Findings that are no faults.
_HARMLESS = ("text", "seconds")


def measured(
    path: str | PathLike[str] | xr.Dataset | Any,
    *,
    channels: Mapping[str, Sensor | str | Mapping[str, Any]] | Iterable[str] | None = None,
    turns: Mapping[str, Turning | str | float | Mapping[str, Any]] | None = None,
    time: str | None = None,
    rate: Quantity | None = None,
    start: Quantity | None = None,
    until: Quantity | None = None,
    orders: Mapping[str, float] | None = None,
    encoding: str | None = None,
    decimal: str | None = None,
    separator: str | None = None,
) -> xr.Dataset:
    """Read a measurement into one labelled dataset in SI units, and tell its faults.

    Formats are known by the ending of the name: tables of text (``.csv``, ``.txt``, ``.tsv``,
    ``.dat``, ``.asc``), ``.parquet`` (extra ``parquet``), ``.nc``, ``.h5`` and ``.hdf5`` (extra
    ``netcdf``), ``.tdms`` (extra ``measured-tdms``), ``.mf4`` and ``.mdf`` (extra
    ``measured-mdf``) and ``.wav`` (extra ``analysis``).

    Parameters
    ----------
    path
        The file; or a pandas ``DataFrame``, or an xarray ``Dataset``.
    channels
        What each channel is, by its name in the file: a `chaindrive.measurement.Sensor`, the text
        of its quantity such as ``"span_tension[crank-to-cam]"``, or a dict with the fields of a
        sensor. Only these are kept. Or a list of names that are kept. All channels when absent. The
        unit of the time may stand here too: ``{"Zeit": {"unit": "ms"}}``.
    turns
        How each shaft turns, by the name of the shaft or sprocket: a stated speed such as
        ``"300 rpm"``, the name of a channel of speed, ``{"encoder": channel, "counts": 1024}``,
        ``{"tacho": channel, "pulses": 60}``, or the classes of `chaindrive.measurement`. The angle
        is positive as the readings are, by the unit, sign, scale and offset of its channel.
    time
        Name of the channel that is the time, in a file where it is not called so. Other times
        beside it are left out.
    rate
        Samples a second [Hz], where the file has no time, or a wrong one.
    start, until
        Part of the record to keep, in seconds after its first sample. Angles go on from what turned
        before.
    orders
        Highest order of interest by shaft: channels that are sampled too slowly for it are told.
    encoding, decimal, separator
        Of a table of text, where they are not found by themselves.

    Returns
    -------
    xarray.Dataset
        A variable a channel, (time,), with ``units``, ``long_name``, the name ``in_file`` and the
        ``unit_in_file``, ``sampling_rate`` [Hz], its ``quantity``, its ``sensor`` (JSON), and the
        shaft whose angle it tells (``turns``). What has another time base stands along ``time_2``
        and so on. With `turns` the angles of shafts
        are ``sprocket_angle`` (time, sprocket) [rad], so that `chaindrive.analysis.order_spectrum`
        takes the dataset as a run. Time begins at zero. Units that no drive has, such as volts,
        stay what they are. Attributes: ``measured_from``, ``findings`` (their names),
        ``findings_note`` (in words) and a ``summary`` to print.

    Raises
    ------
    MeasurementError
        The file cannot be read, has no time, or a channel does not exist; `path` and the message
        name the place.
    ModuleNotFoundError
        The extra of the format is not installed.

    Warns
    -----
    MeasurementWarning
        The record has faults: gaps, duplicates, times that go back, jitter, clipping, dropouts,
        sampling below twice an order of interest.

    Examples
    --------
    >>> import chaindrive as cd
    >>> import numpy as np
    >>> import pandas as pd
    >>> time = np.arange(2000) / 1000.0
    >>> torque = 0.05 * np.sin(2 * np.pi * 7.0 * time) + 1.2
    >>> table = pd.DataFrame({"time [ms]": 1e3 * time, "flange [kN m]": torque})
    >>> data = cd.measured(table, turns={"driver": "300 rpm"})
    >>> data["flange"].attrs["units"], round(float(data["flange"].mean()), 1)
    ('N m', 1200.0)
    """
    options = {
        name: value
        for name, value in (("encoding", encoding), ("decimal", decimal), ("separator", separator))
        if value is not None
    }
    raw, source = read_raw(path, options)
    findings = [Finding(*note) for note in raw.notes]
    said = _sensors(raw, channels)
    timed = _timed(raw, time, None if rate is None else amount(rate, "Hz", "rate"), said, findings)
    # The time is no channel.
    sensors = {name: it for name, it in said.items() if name in timed}
    if said and not sensors:
        names = ", ".join(repr(name) for name in list(timed)[:12])
        hint = f"name the channels that are kept too: there are {names}"
        raise MeasurementError("channels names the time alone", "channels", hint)
    bounds = _bounds(start, until)
    how = {name: turning_by(it, name, timed) for name, it in (turns or {}).items()}
    sources = [it for it in map(source_of, how.values()) if it is not None]
    # All bases have the zero of the earliest sample.
    first = min(
        float(np.min(times, initial=np.inf, where=np.isfinite(times)))
        for _, times in timed.values()
    )
    rising = _rising(timed, sensors, sources, findings)
    bases, of = _bases(timed, {name: rising[name] for name in sensors}, first, bounds, findings)
    keys = _keys(sensors, bases, findings)
    variables: dict[str, Any] = {}
    for name, sensor in sensors.items():
        channel = raw.named(name)
        base, kept = of[channel.name]
        values, about = _in_si(channel, sensor, kept)
        is_told = any(it.kind == "not-a-number" and it.channel == name for it in findings)
        faults = faults_of(channel.values[kept], name, channel.full_scale)
        findings += [it for it in faults if not (is_told and "no value" in it.text)]
        about["sampling_rate"] = sampling_rate(bases[base])
        shafts = [shaft for shaft, it in how.items() if source_of(it) == name]
        if shafts:
            about["turns"] = shafts[-1]
        variables[keys[name]] = labelled((base,), values, about)
        if about["units"] and not unit_of(about["units"]).is_known:
            text = f"its unit {about['units']!r} is none of a drive; give `scale` and `unit`"
            findings.append(Finding("unit", name, text))
    clocked = {}
    for name in sources:
        channel, times = timed[name]
        own = rising[name][1]
        clocked[name] = _sensed(channel, sensors.get(name, Sensor()), own), times[own] - first
    if how:
        variables |= _angles(how, clocked, bases, bounds[0], findings)
    findings += _slow(variables, bases, orders or {}, list(how))
    dimensions: dict[str, NDArray[Any]] = dict(bases)
    if how:
        dimensions["sprocket"] = np.asarray(list(how), dtype=np.str_)
    coordinates = indexed(dimensions, {})
    for base in bases:
        coordinates[base].attrs.update({"units": "s", "long_name": "time"})
    # Columns left out are no loss to a reader who named channels.
    left_out = {name for _, name, _ in raw.notes} - {"", *(it.name for it in raw.channels)}
    unmissed = left_out if channels is not None else set()
    serious = [it for it in findings if it.kind not in _HARMLESS and it.channel not in unmissed]
    attributes = {
        "format": FORMAT,
        "measured_from": _core.one_line(source),
        "findings": [it.kind for it in findings],
        "findings_note": "; ".join(_core.one_line(str(it)) for it in findings),
    }
    dataset = xr.Dataset(variables, coords=coordinates, attrs=attributes)
    dataset.attrs["summary"] = _summary(dataset, findings)
    if serious:
        told = "; ".join(map(str, serious[:6])) + (
            f"; {len(serious) - 6} more" if len(serious) > 6 else ""
        )
        warn(f"{source}: {told}", MeasurementWarning)
    return dataset


def _timed(
    raw: RawRecord,
    time: str | None,
    rate: float | None,
    sensors: Mapping[str, Sensor],
    findings: list[Finding],
) -> dict[str, tuple[RawChannel, _Floats]]:
    """Return every channel with its times [s]; the time itself is none of them."""
    if rate is not None and not rate > 0.0:
        raise MeasurementError(f"rate = {rate}, must be positive [Hz]", "rate")
    # With the units that are said of them, a `Zeit` may be in milliseconds, and a T no time.
    units = {it.name: _unit(it, sensors.get(it.name, Sensor())) for it in raw.channels}
    told = replace(raw, channels=[replace(it, unit=units[it.name]) for it in raw.channels])
    clocks = {} if rate is not None else _clocks(told, time)
    seconds = {
        size: _seconds(_sensed(clock, sensors.get(clock.name, Sensor())))
        for size, clock in clocks.items()
    }
    for clock in clocks.values():
        if not clock.unit and sensors.get(clock.name, Sensor()).scale == 1.0:
            text = "has no unit, and is taken in seconds; `channels` may state another"
            findings.append(Finding("seconds", clock.name, text))
    found = {}
    for channel in raw.channels:
        size = channel.values.size
        if size in clocks and channel.name == clocks[size].name:
            continue
        if _may_be_time(replace(channel, unit=units[channel.name]), _called(channel)):
            text = "is a time that is not taken, and is left out"
            findings.append(Finding("text", channel.name, text))
            continue
        times = seconds.get(size)
        if rate is not None:
            times = np.arange(size) / rate
        elif time is None and channel.time is not None:
            times = channel.time
        if times is None:
            names = ", ".join(repr(it.name) for it in raw.channels[:12])
            lost = [f"{name} {text}" for _, name, text in raw.notes if name.casefold() in _TIMES]
            raise MeasurementError(
                f"{channel.name} has no time beside it, and no channel is called time: "
                + "; ".join([*lost, f"there are {names}"]),
                channel.name,
                _suggested(raw),
            )
        if times.size != channel.values.size:
            message = f"{channel.name} has {channel.values.size} samples, and its time {times.size}"
            raise MeasurementError(message, channel.name)
        found[channel.name] = (channel, times)
    if not found:
        raise MeasurementError("there is a time, and no channel beside it", "channels")
    return found


def _called(channel: RawChannel) -> str:
    """Return the name of a channel without its groups, in small letters."""
    return channel.name.rpartition("/")[2].casefold()


def _is_in_seconds(channel: RawChannel) -> bool:
    return not channel.unit or unit_of(channel.unit).si == "s"


def _may_be_time(channel: RawChannel, word: str) -> bool:
    """Tell whether a channel that is called by a word may be a time.

    A T without a unit may be a temperature or a torque: a time rises.
    """
    if channel.time is not None or word not in _TIMES or not _is_in_seconds(channel):
        return False
    return word != "t" or bool(channel.unit) or rises(channel.values)


def _clocks(raw: RawRecord, time: str | None) -> dict[int, RawChannel]:
    """Return the channel that is the time, by the number of its samples."""
    if time is not None:
        clock = raw.named(time)
        return {clock.values.size: clock}
    ranked = []
    for channel in raw.channels:
        called = _called(channel)
        word = called.partition(" ")[0]
        # A `time` in metres is taken last, and refused with that reason.
        is_odd = channel.time is None and called == "time" and not _is_in_seconds(channel)
        if is_odd or _may_be_time(channel, word):
            rank = (is_odd, called != "time", not channel.unit, _TIMES.index(word))
            ranked.append((rank, channel))
    ranked.sort(key=lambda it: it[0])
    return {channel.values.size: channel for _, channel in reversed(ranked)}


def _suggested(raw: RawRecord) -> str:
    """Return what to give for a time: the first channel that rises evenly, if there is one."""
    for it in raw.channels:
        steps = np.diff(it.values)
        if steps.size and steps.min() > 0.0 and np.ptp(steps) < 1e-2 * steps.mean():
            return f"give time={it.name!r}, which rises evenly, or rate='1 kHz'"
    return "give time='…', the channel that is the time, or rate='1 kHz'"


def _seconds(clock: RawChannel) -> _Floats:
    unit = unit_of(clock.unit)
    if not _is_in_seconds(clock):
        message = f"{clock.name} is in {clock.unit}, which is no time"
        raise MeasurementError(message, clock.name, "give time='…', or rate='1 kHz'")
    return unit.factor * clock.values


def _sensors(
    raw: RawRecord, channels: Mapping[str, Any] | Iterable[str] | None
) -> dict[str, Sensor]:
    """Return the sensor of every channel that is kept, by its name in the file."""
    if channels is None:
        return {it.name: Sensor() for it in raw.channels}
    if isinstance(channels, Mapping):
        return {raw.named(name).name: Sensor.of(it, name) for name, it in channels.items()}
    names = [channels] if isinstance(channels, str) else list(channels)
    return {raw.named(name).name: Sensor() for name in names}


def _bounds(start: Quantity | None, until: Quantity | None) -> tuple[float, float]:
    begin = 0.0 if start is None else amount(start, "s", "start")
    end = np.inf if until is None else amount(until, "s", "until")
    if not begin < end:
        raise MeasurementError(f"start = {begin} s is not before until = {end} s", "start")
    return begin, float(end)


def _rising(
    timed: Mapping[str, tuple[RawChannel, _Floats]],
    sensors: Mapping[str, Sensor],
    sources: list[str],
    findings: list[Finding],
) -> dict[str, _Samples]:
    """Return the base of every channel that is kept or turns a shaft, and its samples as they rise.

    What turns a shaft, and is neither kept nor along what is, has a base of its own name.
    """
    of: dict[str, _Samples] = {}
    seen: list[tuple[_Floats, _Samples]] = []
    for name in dict.fromkeys([*sensors, *sources]):
        times = timed[name][1]
        known = next((it for at, it in seen if at is times or _same(at, times)), None)
        if known is None:
            if name in sensors:
                base, least = f"time_{len(seen) + 1}" if seen else "time", 8
            else:
                # A speed that changes slowly is written down now and then.
                base, least = name, 2
            kept, found = sorted_in_time(times, base, least)
            findings += found
            known = (base, kept)
            seen.append((times, known))
        of[name] = known
    return of


def _bases(
    timed: Mapping[str, tuple[RawChannel, _Floats]],
    rising: Mapping[str, _Samples],
    first: float,
    bounds: tuple[float, float],
    findings: list[Finding],
) -> tuple[dict[str, _Floats], dict[str, _Samples]]:
    """Return times by base, and the base of every channel with the samples within the bounds."""
    bases: dict[str, _Floats] = {}
    kept: dict[str, NDArray[np.int64]] = {}
    for name, (base, samples) in rising.items():
        if base in bases:
            continue
        after = timed[name][1][samples] - first
        inside = (after >= bounds[0]) & (after <= bounds[1])
        kept[base] = samples[inside]
        if kept[base].size < 8:
            message = f"start and until leave {kept[base].size} samples of {after[-1]:.6g} s"
            raise MeasurementError(message, "until", "at least 8")
        bases[base] = after[inside] - bounds[0]
        findings += intervals(bases[base], base)
    return bases, {name: (base, kept[base]) for name, (base, _) in rising.items()}


def _angle(base: str) -> str:
    """Return the name of the angles of shafts along a base."""
    return "sprocket_angle" + base.removeprefix("time")


def _keys(names: Iterable[str], bases: Iterable[str], findings: list[Finding]) -> dict[str, str]:
    """Return the names of channels in the dataset, beside those that are taken.

    NetCDF saves no name with a slash.
    """
    plain = {name: _core.one_line(name).replace("/", " ") for name in names}
    taken = {"sprocket", *bases, *map(_angle, bases)}
    keys = dict(zip(plain, numbered(list(plain.values()), taken), strict=True))
    for name, key in keys.items():
        if key != plain[name]:
            text = f"is called {key!r} here, since {plain[name]!r} is taken"
            findings.append(Finding("name", name, text))
    return keys


def _same(one: _Floats, other: _Floats) -> bool:
    return one.size == other.size and bool(np.array_equal(one, other, equal_nan=True))


def _unit(channel: RawChannel, sensor: Sensor) -> str | None:
    return channel.unit if sensor.unit is None else sensor.unit


def _sensed(
    channel: RawChannel, sensor: Sensor, kept: NDArray[np.int64] | slice = slice(None)
) -> RawChannel:
    """Return a channel as its sensor says it: x = sign · scale · (r − offset), in its unit."""
    values = sensor.sign * sensor.scale * (channel.values[kept] - sensor.offset)
    return replace(channel, values=values, unit=_unit(channel, sensor))


def _in_si(
    channel: RawChannel, sensor: Sensor, kept: NDArray[np.int64]
) -> tuple[_Floats, dict[str, Any]]:
    """Return readings in SI, and what is to be known about them."""
    sensed = _sensed(channel, sensor, kept)
    unit = unit_of(sensed.unit)
    if sensor.unit is not None and not unit.is_known:
        # The very complaint of the parser, with what it would take.
        _core.unit(sensor.unit)
    about: dict[str, Any] = {
        "units": unit.si,
        "long_name": channel.name,
        "in_file": channel.name,
        "unit_in_file": channel.unit or "",
        "sensor": sensor.to_json(),
    }
    if sensor.quantity is not None:
        about["quantity"] = sensor.quantity
    return unit.factor * sensed.values + unit.zero, about


def _angles(
    how: Mapping[str, Turning],
    clocked: Mapping[str, tuple[RawChannel, _Floats]],
    bases: Mapping[str, _Floats],
    begin: float,
    findings: list[Finding],
) -> dict[str, xr.Variable]:
    """Return the angles of shafts along every time base, with what turned before it begins."""
    variables = {}
    for base, times in bases.items():
        columns = []
        for name, turning in how.items():
            angle, found = angle_by(turning, clocked, times + begin, name)
            columns.append(angle)
            findings += [it for it in found if it not in findings]
        about = {"units": "rad", "long_name": "angle of shaft"}
        variables[_angle(base)] = labelled((base, "sprocket"), np.stack(columns, axis=1), about)
    return variables


def _slow(
    variables: Mapping[str, Any],
    bases: Mapping[str, _Floats],
    orders: Mapping[str, float],
    shafts: list[str],
) -> list[Finding]:
    found = []
    for base, times in bases.items():
        angles = variables.get(_angle(base))
        for shaft, order in orders.items():
            if angles is None or shaft not in shafts:
                message = f"orders.{shaft}: its speed is not known"
                raise MeasurementError(message, shaft, f"turns={{{shaft!r}: '300 rpm'}}")
            angle = angles.values[:, shafts.index(shaft)]
            speed = float(angle[-1] - angle[0]) / float(times[-1] - times[0])
            what = f"order {order:g} of {shaft}"
            slow = too_slow(sampling_rate(times), speed, order, what, base)
            found += [] if slow is None else [slow]
    return found


def _summary(dataset: xr.Dataset, findings: list[Finding]) -> str:
    lines = [f"{dataset.attrs['measured_from']}:"]
    width = max((len(str(name)) for name in dataset.data_vars), default=0)
    for name, variable in dataset.data_vars.items():
        if "sensor" in variable.attrs:
            mean, unit = float(variable.mean()), variable.attrs["units"] or "no unit"
            rate, count = variable.attrs["sampling_rate"], variable.size
            of = variable.attrs.get("quantity", "")
            lines.append(
                f"  {name!s:{width}}  mean {mean:.5g} {unit}, {count} samples at {rate:.5g} Hz"
                + (f", {of}" if of else "")
            )
    lines += [f"  {it.kind}: {it}" for it in findings]
    return _core.plain("\n".join(lines))
