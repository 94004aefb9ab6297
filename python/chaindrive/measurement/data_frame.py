"""Parquet, and tables of pandas."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from chaindrive.extras import extra
from chaindrive.measurement.raw import RawChannel, RawRecord, left_out, numbered, numbers
from chaindrive.measurement.units import named_unit

__all__ = ["read", "read_frame"]


def read(path: Path) -> RawRecord:
    """Read a table in Parquet; units stand in headings, or in the metadata of columns."""
    parquet = extra("pyarrow.parquet", "tables in Parquet")
    table = parquet.read_table(path)
    units = {}
    for field in table.schema:
        about = {key.decode(): text.decode() for key, text in (field.metadata or {}).items()}
        units[field.name] = about.get("units") or about.get("unit")
    return read_frame(table.to_pandas(), units)


def read_frame(frame: Any, units: Mapping[str, str | None] | None = None) -> RawRecord:
    """Read a DataFrame: a column a channel, its index the time where it is one."""
    stated = {**frame.attrs.get("units", {}), **(units or {})}
    columns = [(str(name), column) for name, column in frame.items()]
    index = frame.index
    is_time = isinstance(index, pd.DatetimeIndex | pd.TimedeltaIndex)
    # A column may be the index too.
    if (is_time or index.name is not None) and index.name not in frame:
        columns.insert(0, (str(index.name or "timestamp"), index.to_series()))
    named = [named_unit(heading) for heading, _ in columns]
    names = numbered([name for name, _ in named])
    channels, notes = [], []
    for name, (_, unit), (heading, column) in zip(names, named, columns, strict=True):
        unit = stated.get(heading) or unit
        if column.dtype.kind in "mM":
            if column.isna().all():
                notes.append(left_out(name, column))
                continue
            first = column.dropna().iloc[0] if column.dtype.kind == "M" else pd.Timedelta(0)
            seconds = (column - first).dt.total_seconds().to_numpy(dtype=np.float64)
            channels.append(RawChannel(name, "s", seconds))
            continue
        values, wrong = numbers(column.to_numpy())
        if values is None:
            notes.append(left_out(name, column))
            continue
        if wrong:
            notes.append(("not-a-number", name, f"{wrong} cells are no numbers"))
        channels.append(RawChannel(name, unit, values))
    return RawRecord(channels, notes)
