"""Numbers and arrays alike: broadcast, computed flat, given their shape back."""

from __future__ import annotations

from typing import TypeAlias, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["Values", "flatten", "shaped"]

Values: TypeAlias = NDArray[np.float64] | np.float64
"""An array, or a number where all arguments were numbers."""


def flatten(*values: ArrayLike) -> tuple[tuple[int, ...], list[NDArray[np.float64]]]:
    """Return the broadcast shape of the arguments, and each of them flat in that shape."""
    arrays = np.broadcast_arrays(*(np.asarray(value, dtype=np.float64) for value in values))
    return arrays[0].shape, [np.ascontiguousarray(array).ravel() for array in arrays]


def shaped(values: NDArray[np.float64], shape: tuple[int, ...]) -> Values:
    """Return flat values in a shape; a number in the shape of a number."""
    return cast("Values", values.reshape(shape)[()])
