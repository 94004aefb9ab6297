"""Texts of a number and a unit, as arguments of this room have them, in SI."""

from __future__ import annotations

import re
from typing import Any

from chaindrive import _core
from chaindrive.errors import MeasurementError, ParameterError
from chaindrive.quantity import with_unit

__all__ = ["amount"]

_FORM = re.compile(r"^\s*(?P<number>[-+]?[\d.]+(?:[eE][-+]?\d+)?)\s*(?P<unit>.*)$")


def amount(given: Any, unit: str | None, name: str) -> float:
    """Return a number in SI: as it is, of a text with a unit, or a quantity of pint.

    Parameters
    ----------
    given
        ``0.02``, ``"20 ms"``, or a quantity.
    unit
        Unit of SI that is needed; None takes any.
    name
        What it is, for messages.

    Raises
    ------
    MeasurementError
        The text is no number with a unit, or of another quantity.
    """
    given = with_unit(given)
    if isinstance(given, int | float):
        return float(given)
    form = _FORM.match(str(given))
    needed = "a number and a unit" if unit is None else f"a number and a unit of {unit}"
    if form is None:
        raise MeasurementError(f"{name} = {given!r} is not {needed}", name)
    try:
        factor, zero, found, quantity = _core.unit(form["unit"])
    except ParameterError as error:
        raise MeasurementError(f"{name} = {given!r}: {error}", name, error.hint) from None
    if unit is not None and found != unit:
        raise MeasurementError(f"{name} = {given!r} is {quantity}, needed is {needed}", name)
    return factor * float(form["number"]) + zero
