"""Channels as they stand in a file, before anything is done to them."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field
from itertools import count
from typing import Any

import numpy as np
from numpy.typing import NDArray

from chaindrive.errors import MeasurementError

__all__ = ["RawChannel", "RawRecord", "left_out", "numbered", "numbers"]

_Floats = NDArray[np.float64]


@dataclass(frozen=True)
class RawChannel:
    """One channel of a file."""

    name: str
    """Its name, without its unit."""
    unit: str | None
    """Its unit as the file has it; None where it has none."""
    values: _Floats
    """Readings (samples,), NaN where there is none."""
    time: _Floats | None = None
    """Times of its samples [s] (samples,); None where the file tells none beside it."""
    full_scale: float | None = None
    """Greatest reading that its converter knows, where the file tells."""


@dataclass(frozen=True)
class RawRecord:
    """All channels of a file."""

    channels: list[RawChannel]
    notes: list[tuple[str, str, str]] = field(default_factory=list)
    """What was noticed: name of the finding, channel, sentence."""

    def named(self, name: str) -> RawChannel:
        """Return the channel of a name, whatever its case.

        Raises
        ------
        MeasurementError
            There is none; the message lists those that there are.
        """
        exact = [it for it in self.channels if it.name == name]
        near = exact or [it for it in self.channels if it.name.casefold() == name.casefold()]
        if len(near) == 1:
            return near[0]
        known = ", ".join(repr(it.name) for it in self.channels[:24])
        lost = [text for _, channel, text in self.notes if channel.casefold() == name.casefold()]
        if lost and not near:
            raise MeasurementError(f"{name} {lost[0]}: there are {known}", name)
        how = "several channels are" if near else "no channel is"
        raise MeasurementError(f"{how} named {name!r}: there are {known}", name)


def numbered(names: Sequence[str], taken: Collection[str] = ()) -> list[str]:
    """Return names of which no two are alike: with a number behind those that are, or are taken."""
    found: list[str] = []
    for name in names:
        if name in taken or names.count(name) > 1:
            others = {*names, *taken, *found}
            name = next(it for n in count(1) if (it := f"{name} {n}") not in others)
        found.append(name)
    return found


def left_out(name: str, column: Any) -> tuple[str, str, str]:
    """Return the note of a column of pandas that holds nothing, or texts for `numbers`."""
    stated = column.dropna()
    if stated.empty:
        return "text", name, "holds nothing, and is left out"
    example = str(stated.iloc[0])[:24]
    return "not-a-number", name, f"holds texts such as {example!r}, and is left out"


def numbers(values: object) -> tuple[_Floats | None, int]:
    """Return values as numbers, NaN where they are none, and how many texts are no numbers.

    None stands for a column of texts: at most half of its entries are numbers.
    """
    array = np.asarray(values)
    if array.dtype.kind in "biuf":
        return array.astype(np.float64), 0
    import pandas as pd

    given = pd.Series(array)
    found = pd.to_numeric(given, errors="coerce").to_numpy(dtype=np.float64)
    stated = given.notna().to_numpy() & (given.astype(str).str.strip() != "").to_numpy()
    wrong = int(np.count_nonzero(stated & np.isnan(found)))
    if 2 * int(np.isfinite(found).sum()) <= max(int(stated.sum()), 1):
        return None, wrong
    return found, wrong
