"""Channels: the quantities that a run can record."""

from __future__ import annotations

from typing import NamedTuple, cast

from chaindrive import _core
from chaindrive.settings import ChannelName

__all__ = ["Channel", "channels"]


class Channel(NamedTuple):
    """A quantity that can be recorded."""

    unit: str
    """SI unit; ``"m or rad"`` where it hangs on the drive, whose recording tells it."""
    dims: tuple[str, ...]
    """Dimensions in a dataset, ``time`` first."""
    description: str
    """One line of description."""
    default: bool
    """Whether a run records it unless told otherwise."""


def channels() -> dict[ChannelName, Channel]:
    """Everything a run can record, by name.

    Returns
    -------
    dict of ChannelName to Channel
        Unit, dimensions and description of every channel.

    Examples
    --------
    >>> import chaindrive as cd
    >>> cd.channels()["span_tension"].unit
    'N'
    """
    return {
        cast("ChannelName", name): Channel(
            unit, ("time",) if dim is None else ("time", dim), description, default
        )
        for name, unit, dim, description, default in _core.channels()
    }
