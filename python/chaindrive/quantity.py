"""Quantities of pint as scenes and settings have them: texts with a unit."""

from __future__ import annotations

from typing import Any, Protocol

__all__ = ["Measured", "with_unit"]


class Measured(Protocol):
    """A number with a unit, such as a `pint.Quantity`."""

    @property
    def magnitude(self) -> Any:
        """The number, or an array of them."""

    @property
    def units(self) -> Any:
        """The unit, which formats itself as ``~C``."""

    def to_base_units(self) -> Any:
        """Return the same in base units."""


def with_unit(value: Any) -> Any:
    """Return a quantity as a text with a unit, or as a number if it has none.

    Parameters
    ----------
    value
        A quantity of pint, known by its attributes: `pint` need not be there. An array of
        quantities becomes a list. Anything else stays as it is.
    """
    if not (hasattr(value, "magnitude") and hasattr(value, "to_base_units")):
        return value
    # Scenes do not know all the units that pint knows, but they know the metre and the second.
    base = value.to_base_units()
    unit = f"{base.units:~C}".replace("**", "^")
    magnitude = base.magnitude
    return _each(magnitude.tolist() if hasattr(magnitude, "tolist") else magnitude, unit)


def _each(number: Any, unit: str) -> Any:
    if isinstance(number, list):
        return [_each(one, unit) for one in number]
    return f"{float(number)!r} {unit}" if unit else number
