"""What is read off the variants of a drive: statistics of a sweep by name, or a function of it."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from chaindrive.errors import ParameterError

__all__ = ["DERIVED", "OUTPUTS", "Given", "Output", "outputs_of", "read_off"]

_Floats = NDArray[np.float64]

#: Names of statistics, or functions of a sweep by a name of one's own.
Given = str | Iterable[str] | Mapping[str, "str | Callable[[xr.Dataset], Any]"]

OUTPUTS = ("span_tension_mean", "span_tension_std", "contact_force_p99", "loss_share")
"""Default outputs."""


def _loss_share(runs: xr.Dataset) -> xr.DataArray:
    share = runs["energy_dissipated_total"] / runs["energy_supplied_total"]
    return share.assign_attrs(units="1", long_name="share of the supplied energy that is lost")


DERIVED: Mapping[str, Callable[[xr.Dataset], xr.DataArray]] = MappingProxyType(
    {"loss_share": _loss_share}
)
"""Outputs that follow from several statistics, by name."""

_TEXT = re.compile(r"^(?P<name>\w+)(?:\[(?P<label>[^\[\]]+)\])?$")


class Output(NamedTuple):
    """A number that is read off every variant."""

    name: str
    of: Callable[[xr.Dataset], Any]
    """Its values, of what `sweep` returned (variants,)."""


def outputs_of(given: Given) -> list[Output]:
    """Return the outputs that are asked for.

    Parameters
    ----------
    given
        Statistics of `sweep`, such as ``"span_tension_std[driven-driver]"``, or ``"loss_share"``.
        Without a label the largest counts. Or a mapping from names to these, or to functions that
        are called with what `sweep` returned and return a value a variant.

    Raises
    ------
    ParameterError
        A name cannot be read, or nothing is asked for.
    """
    named: Mapping[str, Any]
    if isinstance(given, Mapping):
        named = given
    else:
        texts = [given] if isinstance(given, str) else list(given)
        named = {str(it): it for it in texts}
    if not named:
        raise ParameterError("no output is asked for", "outputs", "such as span_tension_mean")
    return [Output(name, it if callable(it) else _statistic(it)) for name, it in named.items()]


def _statistic(text: Any) -> Callable[[xr.Dataset], xr.DataArray]:
    found = _TEXT.match(text) if isinstance(text, str) else None
    if found is None:
        raise ParameterError(
            f"{text!r} is no output",
            "outputs",
            "a statistic of a sweep, such as span_tension_mean or sprocket_power_mean[driver]",
        )
    name, label = found["name"], found["label"]
    return lambda runs: _looked_up(runs, name, label)


def _looked_up(runs: xr.Dataset, name: str, label: str | None) -> xr.DataArray:
    """Return a statistic, of a label, or the largest of all."""
    if name in DERIVED:
        return DERIVED[name](runs)
    varied = runs["error"].dims
    known = [
        str(it)
        for it, held in runs.data_vars.items()
        if np.issubdtype(held.dtype, np.number) and "time" not in held.dims
    ]
    if name not in known:
        listed = ", ".join([*DERIVED, *known])
        raise ParameterError(f"there is no output {name!r}", "outputs", f"there are {listed}")
    found = runs[name]
    others = [dim for dim in found.dims if dim not in varied]
    if label is None:
        attributes = found.attrs
        return found.max(others).assign_attrs(attributes) if others else found
    labels = [str(it) for dim in others for it in found[dim].to_numpy()]
    if len(others) != 1 or label not in labels:
        listed = ", ".join(labels) or "none"
        message = f"{name} has no {label!r}"
        raise ParameterError(message, "outputs", f"its labels: {listed}")
    return found.sel({others[0]: label})


def read_off(runs: xr.Dataset, outputs: list[Output]) -> tuple[_Floats, list[str]]:
    """Return the outputs of variants along one dimension (variants, outputs), and their units."""
    columns, units = [], []
    for it in outputs:
        found = it.of(runs)
        units.append(str(found.attrs.get("units", "")) if isinstance(found, xr.DataArray) else "")
        column = np.asarray(found, dtype=np.float64)
        if column.shape != runs["error"].shape:
            message = f"output {it.name!r} has the shape {column.shape}"
            raise ParameterError(message, "outputs", f"a value a variant: {runs['error'].shape}")
        columns.append(column)
    return np.stack(columns, axis=1), units
