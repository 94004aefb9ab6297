"""Spans: their lines, how far they swing, and their motion at a fixed point."""

from __future__ import annotations

from collections.abc import Iterable
from functools import lru_cache
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from chaindrive.analysis.signal import late, recorded
from chaindrive.drive import Drive
from chaindrive.errors import ParameterError
from chaindrive.pose import at_start, drive_of

__all__ = ["Stations", "span_envelope", "span_lines", "span_motion", "stations"]


# A guide of a larger radius counts as straight [pitches]: the chain leaves it where it ends.
_STRAIGHT = 1000.0
# Least force that pushes a roller, in fractions of the largest tension.
_PUSHED = 1e-4
# Samples that are interpolated at a time.
_CHUNK = 4096


class Stations:
    """Places of the settled chain: its rollers at the start, cut into stops and spans."""

    def __init__(self, drive: Drive, seated: list[int], free: list[int], spans: list[str]) -> None:
        drawn = at_start(drive, settled=True)
        if len(drawn["chains"]) != 1 or not drawn["chains"][0]["closed"]:
            raise ParameterError("spans are looked at of drives with one closed chain", "run")
        self.chain = drawn["chains"][0]
        self.sprockets = drawn["sprockets"]
        self.rollers: NDArray[np.float64] = self.chain["rollers"]
        self.pitch = float(self.chain["pitch"])
        self.spans = [str(it) for it in spans]
        pushed = _pushed(drive, self.rollers)
        count, stops = len(self.rollers), len(self.spans)
        # Where the stops begin and end, in the order of the route: s₀ e₀ s₁ e₁ …
        edges = np.insert(np.cumsum(np.ravel(np.transpose([seated, free]))), 0, 0)
        ends: list[tuple[int, int]] = []
        for i in range(stops):
            first, last = int(edges[2 * i + 1]), int(edges[2 * i + 2])
            third = (last - first) // 3
            # The layout counts pitches; the chain rests on a guide somewhat further or less far.
            while pushed[(first + 1) % count] and first - edges[2 * i + 1] < third:
                first += 1
            while not pushed[first % count] and first > edges[2 * i]:
                first -= 1
            while pushed[(last - 1) % count] and edges[2 * i + 2] - last < third:
                last -= 1
            while not pushed[last % count] and last < edges[2 * i + 2] + seated[(i + 1) % stops]:
                last += 1
            ends.append((first, last))
        self.begin = {name: ends[i][0] for i, name in enumerate(self.spans)}
        self.links = {name: ends[i][1] - ends[i][0] for i, name in enumerate(self.spans)}
        # Rollers at the stops on either side of a span, by the first and last roller of the span.
        self.resting: dict[int, int] = {}
        for i, (first, _) in enumerate(ends):
            resting = (first - ends[i - 1][1]) % count + 1
            self.resting[first % count] = self.resting[ends[i - 1][1] % count] = resting

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
        left, reached = self._round(first, -1, centres), self._round(last, 1, centres)
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

    def length(self, span: str) -> float:
        """Return the length of the line of a span at the start [m]."""
        start, end = self.line(span, {})
        return float(np.hypot(*(end - start)))

    def strand(self, span: str) -> int:
        """Return which strand from sprocket to sprocket, in the order of the route, has a span."""
        on_wheel = [self._sprocket(self.begin[name]) is not None for name in self.spans]
        before = sum(on_wheel[: self.spans.index(span) + 1]) - 1
        return before % max(sum(on_wheel), 1)

    def _sprocket(self, index: int) -> str | None:
        """Return the sprocket that a roller sits on."""
        place = self.rollers[index % len(self.rollers)]
        for name in self.chain["sprockets"]:
            wheel = self.sprockets[name]
            apart = np.hypot(*(place - np.ravel(wheel["centre"]))) - float(wheel["pitch_radius"])
            if abs(apart) < 0.05 * self.pitch:
                return str(name)
        return None

    def _round(
        self, index: int, before: int, centres: dict[str, NDArray[np.float64]]
    ) -> tuple[NDArray[np.float64], float, float] | None:
        """Return centre, radius and sense of what the rollers rest on up to or from a roller.

        `before` is −1 where the stop lies before the roller, 1 where it lies after.
        """
        count = len(self.rollers)
        place = self.rollers[index % count]
        along = self.rollers[(index + 1) % count] - self.rollers[(index - 1) % count]
        name = self._sprocket(index)
        if name is not None:
            wheel = self.sprockets[name]
            centre = np.asarray(wheel["centre"], dtype=float).ravel()
            arm = place - centre
            sense = np.sign(arm[0] * along[1] - arm[1] * along[0])
            return centres.get(name, centre), float(wheel["pitch_radius"]), float(sense)
        # On a guide: the circle through rollers that rest on it; the last one hardly does.
        behind = min(self.resting[index % count] - 2, 8)
        if behind < 3:
            return None
        x, y = self.rollers[(index + before * np.arange(1, behind + 1)) % count].T
        # x² + y² = 2 a x + 2 b y + c, the circle about (a, b), in pitches about the last roller
        x, y = (x - place[0]) / self.pitch, (y - place[1]) / self.pitch
        columns = np.column_stack([2 * x, 2 * y, np.ones_like(x)])
        a, b, c = np.linalg.lstsq(columns, x * x + y * y)[0]
        radius = self.pitch * float(np.sqrt(c + a * a + b * b))
        if radius > _STRAIGHT * self.pitch:
            return None
        arm = -self.pitch * np.array([a, b])
        sense = np.sign(arm[0] * along[1] - arm[1] * along[0])
        return place - arm, radius, float(sense)


def stations(source: Drive | xr.Dataset) -> Stations:
    """Return the places of the settled chain of a drive, or of a run when it began."""
    if isinstance(source, Drive):
        facts = source.describe()
        stops, spans = facts["stops"], facts["spans"]
        seated = [int(stop["pitches"]) for stop in stops]
        free = [int(span["pitches"]) for span in spans]
        names = [str(span["name"]) for span in spans]
        return _kept(source, tuple(seated), tuple(free), tuple(names))
    # Attributes of a run with one closed chain.
    if "pitches_seated" not in source.attrs:
        raise ParameterError("spans are looked at of drives with one closed chain", "run")
    seated = [int(it) for it in np.atleast_1d(source.attrs["pitches_seated"])]
    free = [int(it) for it in np.atleast_1d(source.attrs["pitches_in_spans"])]
    names = [str(it) for it in drive_of(source).statics()["span"].to_numpy()]
    return _kept(drive_of(source), tuple(seated), tuple(free), tuple(names))


# To settle a drive takes longer than most of what is asked about it afterwards.
@lru_cache(maxsize=4)
def _kept(
    drive: Drive, seated: tuple[int, ...], free: tuple[int, ...], spans: tuple[str, ...]
) -> Stations:
    return Stations(drive, list(seated), list(free), list(spans))


def _pushed(drive: Drive, rollers: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return which rollers of a settled chain something pushes, (roller,)."""
    scene = drive.resolved().to_dict()
    if "mass" not in scene.get("chain", {}):
        raise ParameterError("spans are looked at of a chain of particles", "chain.model")
    tension = drive.statics()["link_tension"].isel(stage=-1).to_numpy()
    links = np.roll(rollers, -1, axis=0) - rollers
    pull = (tension / np.hypot(*links.T))[:, None] * links
    weight = float(scene["chain"]["mass"]) * np.asarray(scene["gravity"], dtype=float)
    # F = −(T_j t_j − T_{j−1} t_{j−1}) − m g
    force = np.roll(pull, 1, axis=0) - pull - weight
    pushed: NDArray[np.bool_] = np.hypot(*force.T) > _PUSHED * tension.max()
    return pushed


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
        Positions were not recorded, there is no such span, or less than two samples are left.
    """
    recorded(run, "roller_x", "roller_y")
    run = late(run, after)
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
