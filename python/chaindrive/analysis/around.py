"""The tension of the links around the loop: what a link bears on its way."""

from __future__ import annotations

import math

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from chaindrive.analysis.bins import by_bin
from chaindrive.analysis.parts import ChainParts, SprocketParts, one_chain, sprockets
from chaindrive.analysis.signal import recorded
from chaindrive.errors import ParameterError

__all__ = ["tension_around_loop"]


def tension_around_loop(
    run: xr.Dataset, *, chain: str | None = None, per_pitch: int = 4
) -> xr.Dataset:
    """Return the tension of the links against their place on the loop.

    The chain has gone on by the teeth that have passed, θ z / 2π pitches, so that the middle of
    link i stands at

    ::

        s = i + ½ + σ (θ − θ₀) z / 2π − s₀    modulo the number of links

    pitches of the route, σ the side on which the chain passes the first sprocket. Every sample of
    every link falls into one station; s₀ is where the chain meets that sprocket. A chain that
    jumps a tooth is out of step from then on.

    Parameters
    ----------
    run
        A run with the channels ``link_tension``, ``sprocket_angle``, ``roller_x`` and ``roller_y``;
        with ``sprocket_x`` and ``sprocket_y`` where sprockets move.
    chain
        Name of the chain, where there are several.
    per_pitch
        Stations a pitch.

    Returns
    -------
    xarray.Dataset
        ``tension_mean``, ``tension_min``, ``tension_max``, ``tension_std`` (station,) [N] and the
        number of ``samples``; the coordinate ``station`` counts pitches along the route. Where the
        sprockets are: ``sprocket_begin`` and ``sprocket_end`` (sprocket,), from the first
        roller that lies on it to the last; a wrap that passes the beginning of the loop ends beyond
        the number of links. The attribute ``travel`` is +1 where the chain moves along its route
        and −1 where it moves against it, ``circuits`` says how often it has gone around.

    Raises
    ------
    ParameterError
        A channel was not recorded, the chain is an open strand, or it passes no sprocket.

    Examples
    --------
    >>> import chaindrive as cd
    >>> from chaindrive.analysis import tension_around_loop
    >>> channels = ["link_tension", "sprocket_angle", "roller_x", "roller_y"]
    >>> run = cd.simulate(cd.scenes.industrial_16b(), until=0.02, record=channels, error=False)
    >>> loop = tension_around_loop(run)
    >>> loop.sizes["station"], float(loop["tension_max"].max()) > 6e3
    (480, True)
    """
    recorded(run, "link_tension", "sprocket_angle")
    which = one_chain(run, chain)
    wheels = [it for it in sprockets(run).values() if it.chain.name == which.name]
    if not which.closed or not wheels:
        raise ParameterError(f"{which.title} runs around no sprocket: it has no loop", "chain")
    if per_pitch < 1:
        raise ParameterError(f"per_pitch = {per_pitch}, must be at least 1", "per_pitch")
    marks = {it.name: _wrap(run, it, wheels[0]) for it in wheels}
    origin = marks[wheels[0].name][0]
    links = which.links
    # s = i + ½ + σ (θ − θ₀) z / 2π − s₀
    passed = _passed(run, wheels[0])
    stations = (np.arange(links) + 0.5 + passed[:, None] - origin) % links
    own = slice(which.first, which.first + links)
    tension = run["link_tension"].isel(link=own).transpose("time", "link").to_numpy()
    count = links * per_pitch
    # A sum may round up to the very end of the loop.
    bins = np.minimum((stations.ravel() * per_pitch).astype(int), count - 1)
    columns = by_bin(tension.ravel().astype(float), bins, count)
    moved = float(passed[-1] - passed[0])
    names = {
        "mean": "mean link tension",
        "min": "least link tension",
        "max": "maximum link tension",
        "std": "scatter of link tension",
    }
    variables: dict[str, object] = {
        f"tension_{key}": ("station", columns[key], {"units": "N", "long_name": text})
        for key, text in names.items()
    }
    variables["samples"] = ("station", columns["samples"], {"units": "1", "long_name": "samples"})
    begins = np.array([(marks[it.name][0] - origin) % links for it in wheels])
    ends = begins + np.array([marks[it.name][1] for it in wheels])
    for key, values, text in [("begin", begins, "first"), ("end", ends, "last")]:
        about = {"units": "1", "long_name": f"{text} roller on the sprocket"}
        variables[f"sprocket_{key}"] = ("sprocket", values, about)
    station = (np.arange(count) + 0.5) / per_pitch
    return xr.Dataset(
        variables,
        coords={
            "station": (
                "station",
                station,
                {"units": "1", "long_name": "place on the loop in pitches"},
            ),
            "sprocket": np.asarray([it.name for it in wheels], dtype=np.str_),
        },
        attrs={
            "chain": which.name,
            "links": links,
            "pitch": which.pitch,
            "travel": int(np.sign(moved)),
            "circuits": abs(moved) / links,
        },
    )


def _passed(run: xr.Dataset, wheel: SprocketParts) -> NDArray[np.float64]:
    """Return the pitches by which the chain has moved along its route, (time,)."""
    angle = run["sprocket_angle"].sel(sprocket=wheel.name).to_numpy().astype(float)
    passed: NDArray[np.float64] = wheel.side * (angle - angle[0]) * wheel.teeth / (2 * math.pi)
    return passed


def _wrap(run: xr.Dataset, wheel: SprocketParts, first: SprocketParts) -> tuple[float, float]:
    """Return where the wrap of a sprocket begins on the loop, and how long it is [pitches]."""
    chain: ChainParts = wheel.chain
    radius, _ = wheel.polar(run)
    on = radius <= wheel.reach(run)
    passed = _passed(run, first)
    # Rollers in a few hundred samples tell the ends of the wrap as well as those in all of them.
    every = max(1, len(passed) // 400)
    stations = ((np.arange(chain.rollers) + passed[::every, None]) % chain.links)[on[::every]]
    if stations.size == 0:
        raise ParameterError(f"no roller lies on {wheel.name} during the run", wheel.name)
    # The wrap begins after the widest stretch of the loop where no roller lies on the sprocket.
    stations = np.sort(stations)
    gaps = np.diff(stations, append=stations[0] + chain.links)
    widest = int(np.argmax(gaps))
    begin = stations[(widest + 1) % stations.size]
    return float(begin), float(chain.links - gaps[widest])
