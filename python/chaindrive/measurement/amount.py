"""Texts of a number and a unit, as arguments of this room have them, in SI."""

from __future__ import annotations

import math
import re
from numbers import Real
from typing import Any, NamedTuple, TypeGuard

from chaindrive import _core
from chaindrive.errors import MeasurementError, ParameterError
from chaindrive.quantity import with_unit

__all__ = ["Amount", "amount", "check_share", "is_number", "read_amount"]

_FORM = re.compile(
    r"^\s*(?P<number>[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)(?![\d.])\s*(?P<unit>.*)$"
)


class Amount(NamedTuple):
    """A number in SI, and what it is of."""

    value: float
    unit: str | None
    """Unit of SI, ``"1"`` of a pure number; None of a bare number, which is in SI."""
    quantity: str
    """The quantity of this unit with its article, ``a force``; empty for a bare number."""


def amount(given: Any, unit: str | None, name: str, *, is_difference: bool = False) -> float:
    """Return a number in SI: as it is, of a text with a unit, or a quantity of pint.

    Parameters
    ----------
    given
        ``0.02``, ``"20 ms"``, or a quantity.
    unit
        Unit of SI that is needed, ``"1"`` for a pure number; None takes any.
    name
        What it is, for messages.
    is_difference
        As in `read_amount`.

    Raises
    ------
    MeasurementError
        The text is no number with a unit, or of another quantity.
    """
    words = {None: "a number and a unit", "1": "a bare number"}
    needed = words.get(unit, f"a number and a unit of {unit}")
    found = read_amount(given, name, needed, is_difference=is_difference)
    if unit is not None and found.unit not in (unit, None):
        raise MeasurementError(f"{name} = {given!r} is {found.quantity}, needed is {needed}", name)
    return found.value


def read_amount(
    given: Any, name: str, needed: str = "a number and a unit", *, is_difference: bool = False
) -> Amount:
    """Return a number in SI with the unit that it was given in.

    Parameters
    ----------
    given, name
        As in `amount`.
    needed
        What is needed, for messages.
    is_difference
        A difference of two values, such as a standard deviation: 5 °C are 5 K then, and not
        278.15 K.

    Raises
    ------
    MeasurementError
        It is no number, and no text of a number with a unit.
    """
    plain = with_unit(given)
    if is_difference and plain is not given:
        # Pint takes 5 °C for a place on the scale, and their difference from 0 °C for 5 K.
        plain = with_unit(given - type(given)(0.0, given.units))
    if isinstance(plain, Real) and not isinstance(plain, bool):
        return Amount(float(plain), None, "")
    form = _FORM.match(str(plain))
    if form is None:
        raise MeasurementError(f"{name} = {given!r} is not {needed}", name)
    try:
        factor, zero, unit, quantity = _core.unit(form["unit"])
    except ParameterError as error:
        raise MeasurementError(f"{name} = {given!r}: {error}", name, error.hint) from None
    value = factor * float(form["number"]) + (0.0 if is_difference else zero)
    return Amount(value, unit, quantity)


def is_number(value: Any) -> TypeGuard[float]:
    """Tell whether a value is a finite number, of Python or of NumPy; a truth value is none."""
    return isinstance(value, Real) and not isinstance(value, bool) and math.isfinite(value)


def check_share(value: Any, name: str) -> None:
    """Refuse a level of confidence, or another share, outside (0, 1).

    Raises
    ------
    MeasurementError
        The value is no such share.
    """
    if not (is_number(value) and 0.0 < value < 1.0):
        raise MeasurementError(f"{name} = {value!r}, must be a number in (0, 1)", name)
