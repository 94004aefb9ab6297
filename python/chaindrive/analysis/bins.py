"""Samples gathered in bins: their mean, scatter and bounds."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["by_bin"]


def by_bin(
    values: NDArray[np.float64], bins: NDArray[np.int_], count: int
) -> dict[str, NDArray[np.float64]]:
    """Return mean, least, largest, scatter and number of values by bin; NaN in empty ones."""
    samples = np.bincount(bins, minlength=count).astype(float)
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = np.bincount(bins, values, count) / samples
        # About the mean of all, where squares of equal numbers would lose their digits.
        about = float(values.mean())
        spread = np.bincount(bins, (values - about) ** 2, count) / samples - (mean - about) ** 2
    least, largest = np.full(count, np.inf), np.full(count, -np.inf)
    np.minimum.at(least, bins, values)
    np.maximum.at(largest, bins, values)
    empty = samples == 0
    least[empty] = largest[empty] = np.nan
    return {
        "mean": mean,
        "min": least,
        "max": largest,
        "std": np.sqrt(np.maximum(spread, 0.0)),
        "samples": samples,
    }
