"""Units of channels, as files write them, in SI: read by the parser of scenes."""

from __future__ import annotations

import re
from typing import NamedTuple

from chaindrive import _core
from chaindrive.errors import ParameterError

__all__ = ["Unit", "named_unit", "unit_of"]

# What other programs call units that the parser of scenes has under another name.
_OTHERWISE = {
    "-": "",
    "–": "",
    "1": "",
    "1/min": "rpm",
    "1/s": "Hz",
    "s^-1": "Hz",
    "U/min": "rpm",
    "RPM": "rpm",
    "r/min": "rpm",
    "rev/min": "rpm",
    "min-1": "rpm",
    "min^-1": "rpm",
    "degree": "deg",
    "degrees": "deg",
    "grad": "deg",
    "radian": "rad",
    "radians": "rad",
    "sec": "s",
    "second": "s",
    "seconds": "s",
    "msec": "ms",
    "milliseconds": "ms",
    "microseconds": "us",
    "nanoseconds": "ns",
    "minutes": "min",
    "hours": "h",
    "Newton": "N",
    "newton": "N",
    "percent": "%",
    "C": "degC",
    "mm/s²": "mm/s^2",
    "m/s²": "m/s^2",
    "µε": "um/m",
    "ue": "um/m",
    "µm/m": "um/m",
}


class Unit(NamedTuple):
    """A unit in SI: x of it are ``factor`` x + ``zero``."""

    factor: float
    zero: float
    si: str
    """Unit of SI; of what is no quantity of a drive, the unit as it was written."""
    is_known: bool


def unit_of(text: str | None) -> Unit:
    """Return what a unit is in SI; one that no quantity of a drive has is kept as it is.

    Raises
    ------
    ParameterError
        Never: a volt is no mistake, it only corresponds to nothing before a scale is given.
    """
    if text is None:
        return Unit(1.0, 0.0, "", False)
    bare = " ".join(text.strip().split())
    try:
        factor, zero, si, _ = _core.unit(_OTHERWISE.get(bare, bare))
    except ParameterError:
        return Unit(1.0, 0.0, bare, False)
    return Unit(factor, zero, si, True)


# A name and its unit: `torque [N m]`, `torque (Nm)`, `torque / Nm`, `torque in Nm`.
_FORMS = (
    re.compile(r"^(?P<name>.*?)\s*\[(?P<unit>[^\[\]]*)\]\s*$"),
    re.compile(r"^(?P<name>.*?)\s*\((?P<unit>[^()]*)\)\s*$"),
    re.compile(r"^(?P<name>.*\S)\s+/\s+(?P<unit>\S.*)$"),
    re.compile(r"^(?P<name>.*\S)\s+in\s+(?P<unit>\S+)$"),
)


def named_unit(heading: str) -> tuple[str, str | None]:
    """Return name and unit of the heading of a column; None where it names no unit.

    Brackets at the end hold a unit, but for labels of results: ``span_tension[tight]``.
    """
    heading = " ".join(heading.replace("\ufeff", "").strip().strip('"').split())
    for number, form in enumerate(_FORMS):
        found = form.match(heading)
        if found is None or not found["name"]:
            continue
        known = unit_of(found["unit"]).is_known
        # `[V]` is a unit that nobody simulates, `[crank-to-cam]` and `(left)` are labels.
        apart = number == 0 and heading[: found.start("unit") - 1].endswith(" ")
        if known or apart:
            return found["name"], found["unit"].strip()
    return heading, None
