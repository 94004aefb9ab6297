"""Units of the trade on axes: rpm, degrees, millimetres, kilonewtons."""

from __future__ import annotations

from typing import Any

import numpy as np

__all__ = ["hours", "in_trade", "rounded", "scientific", "written"]

# Unit of the trade by SI unit, and how many of it one is.
_TRADE = {
    "rad": ("°", 180.0 / np.pi),
    "rad/s": ("rpm", 30.0 / np.pi),
    "m": ("mm", 1e3),
    "Pa": ("N/mm²", 1e-6),
    "N": ("N", 1.0),
    "N m": ("N m", 1.0),
    "W": ("W", 1.0),
    "J": ("J", 1.0),
}
# Units that take a prefix where the numbers would be long.
_PREFIXED = ("N", "N m", "W", "J")


def in_trade(unit: str, values: Any) -> tuple[float, str]:
    """Return the factor that takes values [SI] to a unit of the trade, and that unit.

    Forces, torques, powers and energies are in kilos where the largest is 1000 or more.
    """
    name, factor = _TRADE.get(unit, (unit, 1.0))
    sizes = np.abs(np.asarray(values, dtype=float))
    sizes = sizes[np.isfinite(sizes)]
    if unit in _PREFIXED and sizes.size and float(sizes.max()) >= 1e3:
        return 1e-3, f"k{name}"
    return factor, name


def written(name: str, unit: str) -> str:
    """Return the label of an axis: its quantity and unit."""
    return f"{name} [{'–' if unit in ('1', '') else unit}]"


def scientific(value: float) -> str:
    """Return two digits and a power of ten: ``3·10⁻⁷``."""
    digits, exponent = f"{value:.1e}".split("e")
    raised = str(int(exponent)).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
    return f"{float(digits):g}·10{raised}"


def hours(least: float, greatest: float) -> str:
    """Return two times [h] in words, two digits each: ``1,500 to 150,000 h``."""
    return " to ".join(f"{float(f'{it:.1e}'):,.6g}" for it in (least, greatest)) + " h"


def rounded(value: float, unit: str) -> str:
    """Return a value [SI] in words: three digits and a unit of the trade."""
    factor, name = in_trade(unit, value)
    return f"{factor * value:.3g} {name}".removesuffix(" 1")
