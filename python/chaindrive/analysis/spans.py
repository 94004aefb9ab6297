"""Spans: their lines, how far they swing, and their motion at a fixed point."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from chaindrive.analysis.signal import drive_of, recorded
from chaindrive.drive import Drive
from chaindrive.errors import ParameterError

__all__ = ["Stations", "span_envelope", "span_lines", "span_motion", "stations"]


def __dir__() -> list[str]:
    return list(__all__)


# Samples that are interpolated at a time.
_CHUNK = 4096


class Stations:
    """Places of the settled chain: its rollers at the start, cut into stops and spans."""

    def __init__(self, drive: Drive, seated: list[int], free: list[int], spans: list[str]) -> None:
        drawn = drive._inner.drawing(True)
        if len(drawn["chains"]) != 1 or not drawn["chains"][0]["closed"]:
            raise ParameterError("spans are looked at of drives with one closed chain", "run")
        self.chain = drawn["chains"][0]
        self.sprockets = drawn["sprockets"]
        self.rollers: NDArray[np.float64] = self.chain["rollers"]
        self.pitch = float(self.chain["pitch"])
        self.spans = [str(it) for it in spans]
        ends = np.cumsum([[0, 0], *np.transpose([seated, free])], axis=0)
        # A stop begins where the span before it ends.
        self.begin = {name: int(ends[i].sum() + seated[i]) for i, name in enumerate(self.spans)}
        self.links = {name: int(free[i]) for i, name in enumerate(self.spans)}

    def free(self, span: str) -> NDArray[np.int64]:
        """Return the rollers between the stops of a span."""
        first = self.begin[span]
        return np.arange(first + 1, first + self.links[span]) % len(self.rollers)

    def sense(self, sprocket: str) -> float:
        """Return 1 where a positive turn of a sprocket moves rollers to higher places, else −1."""
        centre = np.asarray(self.sprockets[sprocket]["centre"], dtype=float).ravel()
        arms = self.rollers - centre
        radius = float(self.sprockets[sprocket]["pitch_radius"])
        nearest = int(np.abs(np.hypot(*arms.T) - radius).argmin())
        along = np.roll(self.rollers, -1, axis=0)[nearest] - self.rollers[nearest]
        arm = arms[nearest]
        return float(np.sign(arm[0] * along[1] - arm[1] * along[0]))

    def line(
        self, span: str, centres: dict[str, NDArray[np.float64]]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the ends of the line that a span would lie on if it were straight [m]."""
        if span not in self.begin:
            raise ParameterError(
                f"there is no span {span!r}: there are {', '.join(self.spans)}", "span"
            )
        count = len(self.rollers)
        first = self.begin[span]
        last = first + self.links[span]
        ends = [self.rollers[first % count], self.rollers[last % count]]
        left, reached = (self._wheel(index, centres) for index in (first, last))
        if left is None or reached is None:
            return ends[0], ends[1]
        (from_, radius1, sense1), (to, radius2, sense2) = left, reached
        apart = to - from_
        # φ = β − asin((σ₂ r₂ − σ₁ r₁) / D), the common tangent of the pitch circles
        direction = np.arctan2(apart[1], apart[0]) - np.arcsin(
            (sense2 * radius2 - sense1 * radius1) / np.hypot(*apart)
        )
        normal = np.array([-np.sin(direction), np.cos(direction)])
        return from_ - sense1 * radius1 * normal, to - sense2 * radius2 * normal

    def _wheel(
        self, index: int, centres: dict[str, NDArray[np.float64]]
    ) -> tuple[NDArray[np.float64], float, float] | None:
        """Return centre, pitch radius and sense of the sprocket that a roller sits on."""
        count = len(self.rollers)
        place = self.rollers[index % count]
        for name in self.chain["sprockets"]:
            wheel = self.sprockets[name]
            centre = np.asarray(wheel["centre"], dtype=float)
            radius = float(wheel["pitch_radius"])
            arm = place - centre
            if abs(np.hypot(*arm) - radius) < 0.05 * self.pitch:
                along = self.rollers[(index + 1) % count] - self.rollers[(index - 1) % count]
                sense = np.sign(arm[0] * along[1] - arm[1] * along[0])
                return centres.get(name, centre), radius, float(sense)
        return None


def stations(source: Drive | xr.Dataset) -> Stations:
    """Return the places of the settled chain of a drive, or of a run when it began."""
    if isinstance(source, Drive):
        facts = source.describe()
        stops, spans = facts["stops"], facts["spans"]
        return Stations(
            source,
            [int(stop["pitches"]) for stop in stops],
            [int(span["pitches"]) for span in spans],
            [str(span["name"]) for span in spans],
        )
    run = source
    seated = np.atleast_1d(run.attrs["pitches_seated"]).tolist()
    free = np.atleast_1d(run.attrs["pitches_in_spans"]).tolist()
    return Stations(drive_of(run), seated, free, run["span"].to_numpy().tolist())


def span_lines(run: xr.Dataset) -> xr.Dataset:
    """Line of every span: from tangent point to tangent point.

    The common tangent of the pitch circles, their centres where they are in the mean; at a guide,
    the last roller that rested on it at the start.

    Returns
    -------
    xarray.Dataset
        ``start_x``, ``start_y``, ``end_x``, ``end_y``, ``length`` (span,) [m].
    """
    places = stations(run)
    centres = _centres(run)
    ends = np.array([np.ravel(places.line(name, centres)) for name in places.spans])
    names = ("start_x", "start_y", "end_x", "end_y")
    found = {
        name: ("span", ends[:, i], {"units": "m", "long_name": name.replace("_", " of span, ")})
        for i, name in enumerate(names)
    }
    length = np.hypot(ends[:, 2] - ends[:, 0], ends[:, 3] - ends[:, 1])
    found["length"] = ("span", length, {"units": "m", "long_name": "length of span"})
    return xr.Dataset(found, coords={"span": np.asarray(places.spans, dtype=np.str_)})


def span_motion(
    run: xr.Dataset, span: str, *, places: float | Iterable[float] = 0.5, after: float = 0.0
) -> xr.DataArray:
    """Excursion of a span at fixed points of its line, normal to it.

    The chain runs through; looked at is the link that passes the point at the time.

    Parameters
    ----------
    run
        A run with ``roller_x`` and ``roller_y``.
    span
        Name of the span.
    places : (place,)
        Where along the line, 0 at its start and 1 at its end [–]; one number gives a signal over
        time alone.
    after
        Time up to which samples are left out [s].

    Returns
    -------
    xarray.DataArray
        (place, time) or (time,) [m], positive to the left of who looks from start to end; NaN where
        no link crosses the normal.

    Raises
    ------
    ParameterError
        Positions were not recorded, or there is no such span.
    """
    recorded(run, "roller_x", "roller_y")
    run = run.isel(time=slice(int(np.searchsorted(run["time"], after)), None))
    wanted = np.atleast_1d(np.asarray(places, dtype=float))
    if ((wanted <= 0.0) | (wanted >= 1.0)).any():
        raise ParameterError(f"places = {places}, must lie between 0 and 1", "places")
    start, end = stations(run).line(span, _centres(run))
    length = float(np.hypot(*(end - start)))
    d = (end - start) / length
    n = np.array([-d[1], d[0]])
    excursion = np.empty((wanted.size, run.sizes["time"]))
    for first in range(0, run.sizes["time"], _CHUNK):
        part = run.isel(time=slice(first, first + _CHUNK))
        x = part["roller_x"].to_numpy() - start[0]
        y = part["roller_y"].to_numpy() - start[1]
        along, across = x * d[0] + y * d[1], x * n[0] + y * n[1]
        for row, place in enumerate(wanted):
            excursion[row, first : first + _CHUNK] = _crossing(along, across, place * length)
    found = xr.DataArray(
        excursion,
        dims=("place", "time"),
        coords={
            "place": ("place", wanted, {"units": "1", "long_name": "place along the span"}),
            "time": run["time"],
            "span": span,
        },
        name="excursion",
        attrs={"units": "m", "long_name": f"excursion of {span}"},
    )
    return found.isel(place=0) if isinstance(places, float | int) else found


def span_envelope(
    run: xr.Dataset, span: str, *, places: int = 33, after: float = 0.0
) -> xr.Dataset:
    """Largest and least excursion of a span along its line, and its mean.

    Parameters
    ----------
    run, span, after
        As in `span_motion`.
    places
        How many points, equally spaced.

    Returns
    -------
    xarray.Dataset
        ``least``, ``mean``, ``greatest`` and ``rms`` (about the mean) (place,) [m], with the
        coordinate ``distance`` from the start of the span [m].
    """
    at = (np.arange(places) + 0.5) / places
    motion = span_motion(run, span, places=at.tolist(), after=after)
    start, end = stations(run).line(span, _centres(run))
    kinds: dict[str, Any] = {
        "least": motion.min("time"),
        "mean": motion.mean("time"),
        "greatest": motion.max("time"),
        "rms": motion.std("time"),
    }
    for name, values in kinds.items():
        values.attrs = {"units": "m", "long_name": f"{name} excursion of {span}"}
    about = {"units": "m", "long_name": f"distance along {span}"}
    length = float(np.hypot(*(end - start)))
    return xr.Dataset(kinds).assign_coords(distance=("place", at * length, about))


def _centres(run: xr.Dataset) -> dict[str, NDArray[np.float64]]:
    """Return the mean centres of sprockets that were recorded."""
    if "sprocket_x" not in run or "sprocket_y" not in run:
        return {}
    mean = run[["sprocket_x", "sprocket_y"]].mean("time")
    return {
        str(name): np.array([float(mean["sprocket_x"][i]), float(mean["sprocket_y"][i])])
        for i, name in enumerate(run["sprocket"].to_numpy())
    }


def _crossing(
    along: NDArray[np.float64], across: NDArray[np.float64], place: float
) -> NDArray[np.float64]:
    """Return where the links (time, roller) cross the normal at a place; NaN where none does."""
    before = along <= place
    # A link that goes from start to end: the strand on the other side goes back.
    crosses = before & ~np.roll(before, -1, axis=1)
    following, beyond = np.roll(along, -1, axis=1), np.roll(across, -1, axis=1)
    share = np.divide(place - along, following - along, where=crosses, out=np.zeros_like(along))
    heights = np.where(crosses, across + share * (beyond - across), np.inf)
    nearest = np.abs(heights).argmin(axis=1)
    found = heights[np.arange(len(heights)), nearest]
    return np.where(np.isfinite(found), found, np.nan)
