"""MDF of versions 3 and 4, the format of test benches, read by asammdf."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from chaindrive.extras import extra
from chaindrive.measurement.raw import RawChannel, RawRecord, numbered

__all__ = ["read"]


def read(path: Path) -> RawRecord:
    """Read all channels of an MDF file; every group has a time base of its own."""
    channels: list[RawChannel] = []
    notes: list[tuple[str, str, str]] = []
    with extra("asammdf", "measurements in MDF").MDF(path) as file:
        for signal in file.iter_channels():
            values = np.asarray(signal.samples)
            name = str(signal.name)
            if values.dtype.kind not in "biuf" or values.ndim != 1 or values.size == 0:
                notes.append(("text", name, "is no signal of numbers, and is left out"))
                continue
            time = np.asarray(signal.timestamps, dtype=np.float64)
            channels.append(RawChannel(name, signal.unit or None, values.astype(np.float64), time))
    names = numbered([it.name for it in channels])
    alone = [replace(it, name=name) for it, name in zip(channels, names, strict=True)]
    return RawRecord(alone, notes)
