"""Statistics of a signal with their standard errors: of blocks as long as whole periods."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from chaindrive.measurement.series import Series

__all__ = ["Blocks", "Estimate", "blocks_of", "shared_length"]

_Floats = NDArray[np.float64]
_Complex = NDArray[np.complex128]

#: Blocks that a record is cut into at most: longer ones know less of each other [–].
_MOST = 16
#: Blocks below which no error is stated: Student's t of one or two says nothing.
LEAST = 3
#: Samples at which a pitch or a period is looked at, at least.
_LEAST_SAMPLES = 24


class Estimate(NamedTuple):
    """A statistic, its standard error, and the degrees of freedom of that."""

    value: float
    error: float
    freedom: int


@dataclass(frozen=True)
class Blocks:
    """A signal cut into equal blocks, each a whole number of periods."""

    values: _Floats
    """Readings [SI] (blocks, samples), at equal angles, or times where no angle is known."""
    per_turn: float
    """Samples a turn of the shaft; NaN without an angle."""
    period: int
    """Samples of a period, which blocks hold whole: a turn, or a pitch of the chain; 0 without."""
    is_turn: bool
    """Whether the period is a turn of the shaft."""

    def estimate(self, name: str) -> Estimate:
        """Return mean, std, p1 or p99, with the error by the scatter of the blocks."""
        rows = self.values
        of_block: dict[str, _Floats] = {
            "mean": rows.mean(axis=1),
            "std": rows.std(axis=1),
            "p1": np.percentile(rows, 1.0, axis=1),
            "p99": np.percentile(rows, 99.0, axis=1),
        }
        return _of_blocks(of_block[name])

    def order(self, order: float) -> tuple[complex, Estimate]:
        """Return an order: its complex amplitude, and its amplitude with the error.

        ``c = (2/N) Σ x e^(−i k θ)`` over every block; their mean keeps what is bound to the angle.
        """
        count = self.values.shape[1]
        angle = 2.0 * np.pi * np.arange(count) / self.per_turn
        # Over blocks one after the other the phase goes on.
        start = 2.0 * np.pi * order * count / self.per_turn * np.arange(len(self.values))
        wave: _Complex = np.exp(-1j * order * angle)
        found: _Complex = 2.0 / count * (self.values @ wave) * np.exp(-1j * start)
        mean = complex(found.mean())
        blocks = len(found)
        # Error along the phasor: what moves its length.
        along = (found * np.exp(-1j * np.angle(mean))).real
        error = float(along.std(ddof=1) / np.sqrt(blocks)) if blocks > 1 else np.nan
        return mean, Estimate(abs(mean), error, blocks - 1)

    def holds(self, order: float) -> bool:
        """Tell whether every block holds an order in whole periods, and resolves it."""
        periods = order * self.values.shape[1] / self.per_turn
        return (
            abs(periods - round(periods)) < 1e-6 and order < 0.4 * self.per_turn and periods > 0.5
        )

    def resolves(self, order: float) -> bool:
        """Tell whether an order has two samples a period (Nyquist)."""
        return order < 0.5 * self.per_turn

    def cycle(self) -> tuple[_Floats, _Floats, int]:
        """Return mean and standard error by angle over a period, and how many were averaged."""
        rows = self.values.reshape(-1, self.period)
        count = len(rows)
        error = (
            rows.std(axis=0, ddof=1) / np.sqrt(count) if count > 1 else np.full(self.period, np.nan)
        )
        return rows.mean(axis=0), error, count


def _of_blocks(values: _Floats) -> Estimate:
    count = values.size
    error = float(values.std(ddof=1) / np.sqrt(count)) if count > 1 else np.nan
    return Estimate(float(values.mean()), error, count - 1)


def shared_length(records: Sequence[Series], teeth: float | None) -> tuple[float, bool]:
    """Return the length of blocks that two records share, and whether it is in turns.

    Parameters
    ----------
    records
        The records, such as a measured and a simulated one.
    teeth
        Teeth of the reference shaft; None where no chain runs over it.

    Returns
    -------
    tuple
        Turns of the shaft, of whole turns where each record has four of them, else of whole
        pitches; or seconds where an angle is not known, or where there is no pitch: of all of it.
    """
    turns = min(it.turns for it in records)
    shortest = min(float(it.time[-1] - it.time[0]) for it in records)
    if all(it.angle is not None for it in records):
        if turns >= LEAST + 1 or teeth is None:
            whole = int(turns + 1e-6)
            return float(max(1, whole // min(_MOST, max(whole, 1)))), True
        pitches = int(turns * teeth + 1e-6)
        if pitches >= 1:
            return max(1, pitches // min(_MOST, pitches)) / teeth, True
        # Parts of a pitch tell nothing of the next one.
        return shortest, False
    return shortest / 8.0, False


def blocks_of(series: Series, length: float, is_angle: bool, teeth: float | None) -> Blocks:
    """Cut a signal into blocks of a length.

    Parameters
    ----------
    series
        The signal.
    length, is_angle
        As `shared_length` returned them.
    teeth
        Teeth of the reference shaft.
    """
    if not is_angle:
        size = max(2, round(length * series.rate))
        count = max(1, series.values.size // size)
        return Blocks(series.values[: count * size].reshape(count, size), np.nan, 0, False)
    is_turn = abs(length - round(length)) < 1e-9
    of = 1.0 if is_turn or teeth is None else teeth
    # Samples a turn: as many as there are, a whole number a period.
    density = series.time.size / max(series.turns, 1e-9)
    period = max(_LEAST_SAMPLES, int(np.ceil(density / of)))
    per_turn = period * of
    even = series.by_angle(round(per_turn))
    size = round(length * per_turn)
    count = even.size // size
    return Blocks(even[: count * size].reshape(count, size), per_turn, period, is_turn)
