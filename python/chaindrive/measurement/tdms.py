"""TDMS, the format of LabVIEW and DIAdem, read by npTDMS."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from chaindrive.extras import extra
from chaindrive.measurement.raw import RawChannel, RawRecord

__all__ = ["read"]

_UNITS = ("unit_string", "NI_UnitDescription", "unit", "Unit", "units")


def read(path: Path) -> RawRecord:
    """Read all channels of a TDMS file; each may have a time base of its own."""
    file = extra("nptdms", "measurements in TDMS").TdmsFile.read(path)
    listed = [(group.name, it) for group in file.groups() for it in group.channels()]
    names = [it.name for _, it in listed]
    starts = [it.properties.get("wf_start_time") for _, it in listed]
    known = [it for it in starts if it is not None]
    first = min(known) if known else None
    channels: list[RawChannel] = []
    notes: list[tuple[str, str, str]] = []
    for (group, channel), start in zip(listed, starts, strict=True):
        name = channel.name if names.count(channel.name) == 1 else f"{group}/{channel.name}"
        values = channel[:]
        unit = next(
            (str(channel.properties[it]) for it in _UNITS if it in channel.properties), None
        )
        if len(values) == 0:
            notes.append(("text", name, "holds nothing, and is left out"))
            continue
        if values.dtype.kind == "M":
            seconds = (values - values[0]) / np.timedelta64(1, "s")
            channels.append(RawChannel(name, "s", seconds))
            continue
        if values.dtype.kind not in "biuf":
            notes.append(("text", name, "holds texts, and is left out"))
            continue
        channels.append(
            RawChannel(name, unit or None, values.astype(np.float64), _time(channel, start, first))
        )
    return RawRecord(channels, notes)


def _time(channel: Any, start: Any, first: Any) -> Any:
    """Return the times of a waveform [s] after the first start of the file; None of others."""
    if not channel.properties.get("wf_increment"):
        return None
    channel.properties.setdefault("wf_start_offset", 0.0)
    time = np.asarray(channel.time_track(), dtype=np.float64)
    if start is None:
        return time
    return time + float((start - first) / np.timedelta64(1, "s"))
