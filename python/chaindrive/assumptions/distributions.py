"""Distributions of values that nobody knows exactly: by name, as a range, or of SciPy."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from chaindrive.drive import Drive
from chaindrive.errors import MeasurementError, ParameterError
from chaindrive.extras import extra
from chaindrive.measurement.amount import amount, is_number, read_amount
from chaindrive.measurement.free import check_unit, value_at

__all__ = ["KINDS", "distribution_of"]

_TEXT = re.compile(r"^\s*(?P<kind>[\w-]+)\s*\((?P<rest>[^()]*)\)\s*$")


class _Kind(NamedTuple):
    """A family of distributions."""

    names: tuple[str, ...]
    """What its arguments are."""
    make: Callable[..., Any]
    """From SciPy's distributions and the arguments [SI] to a frozen one; None where they do not
    fit together."""
    difference: str = ""
    """The argument that is a difference of two values."""
    number: str = ""
    """The argument that is a pure number, whatever is drawn."""


def _uniform(stats: Any, low: float, high: float) -> Any:
    return stats.uniform(low, high - low) if low < high else None


def _normal(stats: Any, mean: float, deviation: float) -> Any:
    return stats.norm(mean, deviation) if deviation > 0.0 else None


def _lognormal(stats: Any, median: float, factor: float) -> Any:
    if median <= 0.0 or factor <= 1.0:
        return None
    return stats.lognorm(math.log(factor), scale=median)


def _triangular(stats: Any, low: float, mode: float, high: float) -> Any:
    if not low <= mode <= high or low == high:
        return None
    return stats.triang((mode - low) / (high - low), low, high - low)


KINDS: Mapping[str, _Kind] = {
    "uniform": _Kind(("low", "high"), _uniform),
    "normal": _Kind(("mean", "deviation"), _normal, difference="deviation"),
    "lognormal": _Kind(("median", "factor above 1"), _lognormal, number="factor above 1"),
    "triangular": _Kind(("low", "mode", "high"), _triangular),
}
"""Families by name: 68 % of a log-normal lie between the median over the factor and times it."""


def distribution_of(given: Any, path: str, drive: Drive | None = None) -> Any:
    """Return a distribution of SciPy, frozen.

    Parameters
    ----------
    given
        One already, with ``ppf``; or a pair of ends, between which all are alike; or a text such as
        ``"normal(1.5 kN, 0.2 kN)"``.
    path
        Path of the value that it is of.
    drive
        The drive whose value it is: units are those of it. When absent, they are alike.

    Raises
    ------
    ParameterError
        It is none, or its units are not those of the value.
    """
    if callable(getattr(given, "ppf", None)):
        return given
    kind, values = "uniform", given
    if isinstance(given, str):
        found = _TEXT.match(given)
        kind, values = ("", ()) if found is None else (found["kind"], found["rest"].split(","))
    family = KINDS.get(kind)
    if family is None or not isinstance(values, list | tuple) or len(values) != len(family.names):
        raise _none(given, path)
    numbers: list[float] = []
    units: set[str] = set()
    try:
        for name, it in zip(family.names, map(_plain, values), strict=True):
            if name == family.number:
                numbers.append(amount(it, "1", path))
                continue
            value, unit, _ = read_amount(it, path, is_difference=name == family.difference)
            numbers.append(value)
            units |= set() if unit is None else {unit}
    except MeasurementError as error:
        raise _none(given, path) from error
    _check_units(units, given, path, drive)
    made = family.make(extra("scipy.stats", "distributions"), *numbers)
    if made is None:
        raise _none(given, path)
    return made


def _check_units(units: set[str], given: Any, path: str, drive: Drive | None) -> None:
    """Refuse units that are not those of what is drawn."""
    if len(units) > 1:
        message = f"{path}: {given!r} is in {' and in '.join(sorted(units))}"
        raise ParameterError(message, path, "units of one quantity")
    if drive is None:
        return
    full = drive.resolved()
    known = value_at(full.to_dict(), path)
    try:
        for unit in units if is_number(known) else ():
            check_unit(full, path, unit, known)
    except MeasurementError as error:
        raise ParameterError(f"{given!r}: {error}", path, error.hint) from None


def _plain(value: Any) -> Any:
    """Return a number in a text as such."""
    try:
        return float(value)
    except (TypeError, ValueError):
        return value.strip() if isinstance(value, str) else value


def _none(given: Any, path: str) -> ParameterError:
    listed = ", ".join(f"{kind}({', '.join(it.names)})" for kind, it in KINDS.items())
    message = f"{path}: {given!r} is no distribution"
    return ParameterError(message, path, f"a pair of ends, {listed}, or one of scipy.stats")
