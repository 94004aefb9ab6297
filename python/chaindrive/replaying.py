"""Recorded runs to look at: one page that moves, in a browser or a notebook, or a movie."""

from __future__ import annotations

import json
from collections.abc import Sequence
from os import PathLike, fspath
from pathlib import Path
from typing import Any, ClassVar, overload

import numpy as np
import xarray as xr

from chaindrive import _core
from chaindrive.results import held
from chaindrive.shown_page import ShownPage

__all__ = ["Replay", "replay"]

#: Frames of a page: the start, and 5000 more.
_FRAMES = 5001


class Replay(ShownPage):
    """A recorded run as one HTML page, in which the drive moves."""

    _kind: ClassVar[str] = "replay"


@overload
def replay(
    run: xr.Dataset,
    path: None = None,
    *,
    plot: Sequence[str] | None = None,
    frames: int | None = None,
) -> Replay: ...


@overload
def replay(
    run: xr.Dataset,
    path: str | PathLike[str],
    *,
    plot: Sequence[str] | None = None,
    frames: int | None = None,
) -> Replay | Path: ...


def replay(
    run: xr.Dataset,
    path: str | PathLike[str] | None = None,
    *,
    plot: Sequence[str] | None = None,
    frames: int | None = None,
) -> Replay | Path:
    """Make a page or a movie of a recorded run, in which the drive moves.

    The page plays, scrubs, zooms and follows a roller; links are coloured by their tension and
    arrows show the forces of teeth on rollers, where ``link_tension`` and ``contact_force`` were
    recorded. Channels are plotted beside the picture. Press ``?`` in the page for its keys.

    Parameters
    ----------
    run
        A run with the channels ``roller_x``, ``roller_y`` and ``sprocket_angle``; with
        ``tensioner_position`` if there is a tensioner, with ``sprocket_x`` and ``sprocket_y`` if
        sprockets stand on springs.
    path
        Where to write: ``.html`` for the page, ``.mp4`` or ``.gif`` for a movie, which takes the
        extra ``movie``. Nothing is written when absent.
    plot
        Channels that a page plots beside the picture; the tension of the spans when absent.
    frames
        Largest number of frames of a page, 5001 when absent; of more samples every n-th is taken,
        and the page says so. Number of pictures of a movie, 250 when absent;
        `chaindrive.movies.movie` has more settings.

    Returns
    -------
    Replay or pathlib.Path
        The page, which a notebook shows; of a movie its path.

    Raises
    ------
    KeyError
        The channels that the motion takes were not recorded; the message names them.
    ValueError
        The path ends in something else, the run holds no samples, or its store is damaged; or
        channels are to be plotted in a movie.
    WriteError
        The file cannot be written; what was in its place is still there.

    Examples
    --------
    >>> import chaindrive as cd
    >>> run = cd.simulate(cd.scenes.spinning_ring(), until=2e-3)
    >>> page = cd.replay(run)
    >>> page.html.startswith("<!DOCTYPE html>")
    True
    """
    suffix = ".html" if path is None else Path(fspath(path)).suffix
    if path is not None and suffix in (".mp4", ".gif"):
        from chaindrive.movies import PICTURES, movie

        if plot is not None:
            raise ValueError(f"plot = {plot!r}: a movie has no plots, a page (.html) has")
        return movie(run, path, frames=PICTURES if frames is None else frames)
    if suffix not in (".html", ".htm"):
        raise ValueError(f"{path!s}: the name must end in .html, .mp4 or .gif")
    place = None if path is None else _core.NewFile(path)
    page = Replay(
        _page(run, None if plot is None else list(plot), _FRAMES if frames is None else frames)
    )
    if place is not None:
        place.write(page.html.encode())
    return page


def _page(run: xr.Dataset, plot: list[str] | None, frames: int) -> str:
    if frames < 1:
        raise ValueError(f"frames = {frames}, must be 1 or more")
    if "scene" not in run.attrs or "time" not in run.dims:
        raise ValueError("this is not a run of chaindrive: it has no scene or no time")
    samples = run.sizes["time"]
    recorded = [str(name) for name in run.data_vars if run[name].dims[:1] == ("time",)]
    wanted, stride = _core.replay_selection(recorded, plot, samples, frames)
    events = [str(name) for name in run.data_vars if str(name).startswith("event_")]
    name = str(run.attrs.get("scene_name", "run"))
    run = held(run[[*wanted, *events]].isel(time=slice(None, None, stride)), name)
    return _core.replay(
        json.dumps(run.attrs, default=_plain),
        samples,
        stride,
        _floats(run["time"]),
        recorded,
        [_channel(run[name]) for name in wanted],
        _contacts(run),
        plot,
    )


def _channel(values: xr.DataArray) -> tuple[str, str, str, list[str], Any]:
    about = values.attrs
    labels = [str(label) for label in values[values.dims[1]].to_numpy()] if values.ndim > 1 else []
    unit, name = str(about.get("units", "")), str(about.get("long_name", ""))
    return str(values.name), unit, name, labels, _floats(values)


def _contacts(run: xr.Dataset) -> tuple[list[str], Any, Any, Any] | None:
    if "event_start" not in run:
        return None
    return (
        [str(name) for name in run["event_body"].to_numpy()],
        np.ascontiguousarray(run["event_roller"].to_numpy(), dtype=np.int64),
        _floats(run["event_start"]),
        _floats(run["event_peak_force"]),
    )


def _floats(values: xr.DataArray) -> Any:
    return np.ascontiguousarray(values.to_numpy(), dtype=np.float64)


def _plain(value: object) -> object:
    """Attributes as JSON has them; netCDF gives numbers back as arrays."""
    return value.tolist() if isinstance(value, np.ndarray | np.generic) else str(value)
