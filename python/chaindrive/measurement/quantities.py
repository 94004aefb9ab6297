"""Quantities of a drive that a channel can correspond to, and which one it does."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from chaindrive.analysis.signal import recorded
from chaindrive.channel import channels
from chaindrive.errors import MeasurementError

__all__ = ["MeasuredQuantity", "guessed", "quantity_of"]

_Floats = NDArray[np.float64]


class _Derived(NamedTuple):
    """A quantity that follows from channels."""

    needs: tuple[str, ...]
    dim: str | None
    unit: str
    text: str
    make: Callable[..., _Floats]


def _power(time: _Floats, energy: _Floats) -> _Floats:
    return np.asarray(np.gradient(energy, time))


def _size(_: _Floats, x: _Floats, y: _Floats) -> _Floats:
    return np.asarray(np.hypot(x, y))


_DERIVED: Mapping[str, _Derived] = {
    "bearing_force": _Derived(
        ("sprocket_force_x", "sprocket_force_y"), "sprocket", "N", "force on a bearing", _size
    ),
    "guide_force": _Derived(
        ("guide_force_x", "guide_force_y"), "guide", "N", "force on a guide", _size
    ),
    "losses": _Derived(("energy_dissipated",), None, "W", "power lost", _power),
    "power": _Derived(("energy_supplied",), None, "W", "power supplied", _power),
    # Its amplitude is nobody's: what it has of a drive are the lines of the meshes.
    "vibration": _Derived((), None, "", "vibration or sound, by its orders only", _size),
}


@dataclass(frozen=True)
class MeasuredQuantity:
    """A quantity of a drive at a place: ``span_tension[crank-to-cam]``."""

    name: str
    """A channel of a run, or ``bearing_force``, ``guide_force``, ``losses``, ``power``, or
    ``vibration``."""
    label: str | None
    """Label of its place; None where the quantity has no places, or it has one only."""

    def __str__(self) -> str:
        return self.name if self.label is None else f"{self.name}[{self.label}]"

    @property
    def needs(self) -> tuple[str, ...]:
        """Channels that a run has to record for it."""
        return _DERIVED[self.name].needs if self.name in _DERIVED else (self.name,)

    @property
    def unit(self) -> str:
        """Its unit of SI; empty where it has none."""
        return _DERIVED[self.name].unit if self.name in _DERIVED else _known()[self.name].unit

    @property
    def is_relative(self) -> bool:
        """Whether its amplitude means nothing."""
        return not self.needs

    def of(self, run: xr.Dataset, link: int | None) -> _Floats:
        """Return the quantity of a run, as it is before a sensor reads it, (time,) [SI].

        A gauge that travels with the chain is on a link; where that is not known, on the first.

        Raises
        ------
        ParameterError
            The channel was not recorded.
        MeasurementError
            There is no such place, or several and none is named.
        """
        recorded(run, *self.needs)
        columns = [self._column(run[name], link) for name in self.needs]
        if self.name in _DERIVED:
            return _DERIVED[self.name].make(run["time"].to_numpy(), *columns)
        return columns[0]

    def _column(self, channel: xr.DataArray, link: int | None) -> _Floats:
        others = [str(dim) for dim in channel.dims if dim != "time"]
        if not others:
            return channel.to_numpy().astype(float)
        (dim,) = others
        labels = [str(it) for it in channel[dim].to_numpy()]
        label = self.label
        if label is None and dim == "link":
            label = str(link or 0)
        if label is None and len(labels) == 1:
            label = labels[0]
        if label not in labels:
            listed = ", ".join(labels[:12]) + (", …" if len(labels) > 12 else "")
            what = "names no place" if label is None else f"there is no {dim} {label!r}"
            raise MeasurementError(f"{self}: {what}: there are {listed}", str(self))
        return channel.isel({dim: labels.index(label)}).to_numpy().astype(float)


def _known() -> Mapping[str, Any]:
    return {str(name): it for name, it in channels().items()}


_FORM = re.compile(r"^(?P<name>\w+)(?:\[(?P<label>.+)\])?$")


def quantity_of(text: str) -> MeasuredQuantity:
    """Return the quantity of a text such as ``sprocket_torque[driver]``.

    Raises
    ------
    MeasurementError
        No quantity has this name; the message says which there are.
    """
    form = _FORM.match(text.strip())
    known = [*_DERIVED, *_known()]
    if form is None or form["name"] not in known:
        raise MeasurementError(
            f"quantity = {text!r}: no quantity of a drive has this name",
            text,
            f"there are {', '.join(known)}, with a place such as span_tension[crank-to-cam]",
        )
    return MeasuredQuantity(form["name"], form["label"])


#: Words in names of channels, the quantity that they speak of, and the unit that it must have.
_WORDS: tuple[tuple[str, str, str], ...] = (
    (r"bearing|lager|shaft.?load", "bearing_force", "N"),
    (r"guide|rail|schiene", "guide_force", "N"),
    (r"torque|moment|flange", "sprocket_torque", "N m"),
    (r"speed|rpm|drehzahl", "sprocket_speed", "rad/s"),
    (r"span|strand|trum|tension", "span_tension", "N"),
    (r"link|gauge|strain|lasche", "link_tension", "N"),
    (r"plunger|piston|tensioner|travel|stroke", "tensioner_position", "m"),
    (r"pressure|druck|chamber", "oil_pressure", "Pa"),
    (r"loss|verlust", "losses", "W"),
    (r"power|leistung", "power", "W"),
    (r"acc|vib|mic|sound|noise|channel \d", "vibration", ""),
)


def guessed(name: str, unit: str, run: xr.Dataset) -> MeasuredQuantity | None:
    """Return the quantity that the name of a channel speaks of; None where it is not clear.

    Parameters
    ----------
    name
        Name of the channel, ``span_tension[tight]`` as results have it, or in words.
    unit
        Its unit of SI.
    run
        A run of the drive, whose labels say which places there are.
    """
    try:
        return quantity_of(name)
    except MeasurementError:
        pass
    found = []
    for words, quantity, needed in _WORDS:
        if not re.search(words, name, re.IGNORECASE) or (needed and unit != needed):
            continue
        chosen = MeasuredQuantity(quantity, None)
        if not all(need in run for need in chosen.needs):
            # Its places are not known.
            continue
        dims = [dim for need in chosen.needs for dim in run[need].dims]
        others = list(dict.fromkeys(str(dim) for dim in dims if dim != "time"))
        if not others or others == ["link"]:
            found.append(chosen)
            continue
        labels = [str(it) for it in run[others[0]].to_numpy()]
        named = [it for it in labels if _plain(it) in _plain(name)]
        # Of a sprocket `driver` and a span `driver-driven` the longer name is meant.
        named = [it for it in named if not any(it != other and it in other for other in named)]
        if len(named) == 1 or len(labels) == 1:
            found.append(MeasuredQuantity(quantity, (named or labels)[0]))
    return found[0] if found else None


def _plain(text: str) -> str:
    return re.sub(r"[^a-z0-9]", "", text.casefold())
