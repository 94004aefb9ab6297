"""Layouts of chains: how many links a route takes, and what has to move for them to close.

Geometry alone, nothing is assembled. `of` lays out a `Drive`, `layout` the stops of a program:

    >>> import chaindrive as cd
    >>> from chaindrive.design import Sprocket
    >>> stops = [Sprocket("driver", 19, (0, 0)), Sprocket("driven", 57, (1.03, 0))]
    >>> found = cd.design.layout(stops, 25.4e-3)
    >>> round(found.counts.pitches, 4), found.counts.even_above
    (120.0055, 122)
    >>> laid = cd.design.close(stops, 25.4e-3, 120, move="driven", along=(1, 0))
    >>> round(laid.stops[1].centre[0], 9)
    1.029929958

All lengths are in metres and all angles in radians.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any, Literal, NamedTuple, TypeAlias

from chaindrive import _core
from chaindrive.drive import Drive
from chaindrive.errors import ParameterError

__all__ = [
    "Counts",
    "Face",
    "Fit",
    "Guide",
    "Idler",
    "Layout",
    "Span",
    "Sprocket",
    "Stop",
    "Worn",
    "clashes",
    "close",
    "layout",
    "of",
]

Side: TypeAlias = Literal["left", "right"]


class Sprocket(NamedTuple):
    """A sprocket in its place."""

    name: str
    """Its name."""
    teeth: int
    """Number of teeth."""
    centre: tuple[float, float]
    """Centre (x, y) [m]."""
    side: Side = "left"
    """Side of the travelling chain on which it lies: left where it turns to the left."""


class Idler(NamedTuple):
    """A sprocket on a span, placed by the angle that the chain wraps it."""

    name: str
    """Its name."""
    teeth: int
    """Number of teeth."""
    wrap: float
    """Angle that the chain wraps it [rad], where nothing else works on the span."""
    share: float = 0.5
    """Share of the span at which it stands, from 0 where the chain leaves the sprocket before."""
    side: Side = "right"
    """Side of the travelling chain on which it lies."""


class Guide(NamedTuple):
    """A curved rail or shoe on a span, placed by share."""

    name: str
    """Its name."""
    radius: float
    """Radius of its face [m]."""
    bow: float
    """How far its crest pushes the chain across the straight span [m]; negative: a gap."""
    shares: tuple[float, float] = (0.1, 0.9)
    """Shares of the span between which the face lies, 0 where the chain leaves a sprocket."""
    crest: float = 0.5
    """Share of the span at which the crest lies: the point of contact of a shoe."""
    height: float = 0.0
    """Diameter of the rollers, or height of the plates, that slide on it [m]; 0: that of the
    ``chain`` of the catalogue, where one is named."""
    touches: Literal["rollers", "eyes", "plates"] = "rollers"
    """Which part of the chain slides on it."""
    side: Side = "right"
    """Side of the travelling chain on which it lies."""


class Counts(NamedTuple):
    """Numbers of links that a route takes."""

    pitches: float
    """By the exact polygon, at the phase of the layout: whole for a chain that closes."""
    smooth: float
    """By the smooth taut curve."""
    below: int
    """Next whole number that is not longer than the route."""
    above: int
    """Next whole number that is not shorter."""
    even_below: int
    """Next even number that is not longer: a chain without an offset link."""
    even_above: int
    """Next even number that is not shorter."""


class Stop(NamedTuple):
    """A sprocket or guide of a layout."""

    name: str
    """Its name."""
    teeth: int | None
    """Number of teeth; None for a guide."""
    centre: tuple[float, float]
    """Centre of the circle of roller centres (x, y) [m]."""
    radius: float
    """Radius of that circle [m]: of a sprocket its pitch radius."""
    side: Side
    """Side of the travelling chain on which it lies."""
    wrap: float
    """Wrap angle between the points of tangency [rad]."""
    seated: int
    """Rollers seated on it."""
    seat_angle: float
    """Angle of the first seated roller about the centre [rad]: that of a gap of the sprocket."""


class Span(NamedTuple):
    """A straight span of a layout."""

    name: str
    """Its name, ``"from-to"``."""
    direction: float
    """Direction of travel, counter-clockwise from the x axis [rad]."""
    length: float
    """Length between the points of tangency [m]."""
    links: int
    """Links between the last roller seated before and the first one after."""
    leaves: tuple[float, float]
    """Point of tangency where the chain leaves (x, y) [m]."""
    arrives: tuple[float, float]
    """Point of tangency where it arrives (x, y) [m]."""


class Face(NamedTuple):
    """The face of a guide, an arc as a scene says it."""

    name: str
    """Name of the guide."""
    centre: tuple[float, float]
    """Centre (x, y) [m]."""
    radius: float
    """Radius [m]."""
    begin: float
    """Angle at which the face begins [rad]: `from` in a scene."""
    end: float
    """Angle at which it ends [rad], counter-clockwise: `to` in a scene."""


class Fit(NamedTuple):
    """Where one body would have to stand for a number of links to close exactly."""

    links: int
    """Number of links."""
    offset_link: bool
    """Whether it is odd, and needs an offset link."""
    body: str
    """Name of the body."""
    travel: float
    """How far it moves from where it is described [m, or rad where it turns]."""
    centre: tuple[float, float] | None
    """Where its centre is then (x, y) [m]; None for a body without one."""
    centre_distance: float | None
    """Distance of the centres [m], where there are two stops."""


class Worn(NamedTuple):
    """Where the adjusted body stands when the chain is worn."""

    elongation: float
    """Elongation of the chain, 0.01 for 1 %."""
    travel: float | None
    """Travel of the body [m, or rad where it turns]; None where the chain closes nowhere near."""


class Layout(NamedTuple):
    """A closed chain, laid out."""

    chain: str | None
    """Its name; None where there is one only."""
    pitch: float
    """Pitch [m]."""
    phase: float
    """Place of the first sprocket within a tooth, 0 to 1."""
    links: int | None
    """Number of links that it has, or was asked for."""
    misfit: float | None
    """Length of the route beyond that of these links [m]: positive for a short chain."""
    travel: float | None
    """Travel of the body that moves [m, or rad where it turns]; None where nothing does."""
    turns: bool
    """Whether travels are angles."""
    counts: Counts
    """Numbers of links that the route takes."""
    stops: tuple[Stop, ...]
    """Sprockets and guides, in path order."""
    spans: tuple[Span, ...]
    """Straight spans, each after its stop."""
    faces: tuple[Face, ...]
    """Faces of the guides that were placed by share."""
    fits: tuple[Fit, ...]
    """Where one body would have to stand for the numbers of links next to those of the route."""
    wear: tuple[Worn, ...]
    """Where the body that moves goes while the chain wears, up to 3 %; empty where nothing does."""


def layout(
    stops: Sequence[Sprocket | Idler | Guide],
    pitch: float | None = None,
    links: int | None = None,
    *,
    chain: str | None = None,
    phase: float = 0.5,
) -> Layout:
    """Lay a closed chain around stops that stay where they are.

    Parameters
    ----------
    stops
        Sprockets, idlers and guides in the order in which the chain passes them.
    pitch
        Pitch of the chain [m]; that of ``chain`` when absent.
    links
        Number of links, to be told by how much it misses.
    chain
        Name of a chain of the catalogue, ``"16B-1"``, which has pitch, rollers and plates.
    phase
        Where the first sprocket stands within a tooth, 0 to 1; 0.5 is symmetric.

    Returns
    -------
    Layout
        Numbers of links, points of tangency, wraps, seats, and what would have to move.

    Raises
    ------
    ParameterError
        No chain can be laid along these stops, none has this name, or the pitch is missing.

    Examples
    --------
    >>> import chaindrive as cd
    >>> stops = [cd.design.Sprocket("driver", 19, (0, 0)), cd.design.Sprocket("driven", 57, (1, 0))]
    >>> cd.design.layout(stops, chain="16B-1").counts.even_above
    118
    """
    return _layout(json.loads(_core.layout_around(list(stops), pitch, chain, links, phase, None)))


def close(
    stops: Sequence[Sprocket | Idler | Guide],
    pitch: float | None = None,
    links: int | None = None,
    *,
    chain: str | None = None,
    move: str | None = None,
    along: tuple[float, float] | None = None,
    phase: float = 0.5,
) -> Layout:
    """Move one stop until a number of links closes exactly.

    Guides and idlers follow their spans. The nearest place that closes is found, either way.

    Parameters
    ----------
    stops, pitch, chain, phase
        As in `layout`.
    links
        Number of links; it has to be given.
    move
        Name of the stop that moves: a sprocket along a direction, of a guide the bow, of an idler
        the wrap; the sprocket after the first stop that has the greatest effect when absent.
    along
        Direction (x, y), of any length; that of the greatest effect when absent.

    Returns
    -------
    Layout
        As it closes: ``travel`` is how far the stop moved.

    Raises
    ------
    ParameterError
        No such stop or chain, no number of links, or they close nowhere within 20 pitches.
    """
    if links is None:
        raise ParameterError("links are missing; give their number", "links", "a whole number")
    names = [stop.name for stop in stops]
    if move is not None and move not in names:
        message = f"move = {move!r}: no stop has this name; there are {', '.join(names)}"
        raise ParameterError(message, "move", "must be the name of a stop")
    moved = (None if move is None else names.index(move), along)
    return _layout(json.loads(_core.layout_around(list(stops), pitch, chain, links, phase, moved)))


def of(drive: Drive) -> tuple[Layout, ...]:
    """Lay out the closed chains of a drive: as they are laid, or described if they do not close.

    Raises
    ------
    AssemblyError
        A route that no chain can be laid along.

    Examples
    --------
    >>> import chaindrive as cd
    >>> chain = cd.design.of(cd.scenes.timing_drive())[0]
    >>> [span.name for span in chain.spans]
    ['crank-fixed', 'fixed-exhaust', 'exhaust-intake', 'intake-shoe', 'shoe-crank']
    """
    layouts, _ = _core.layouts_of(drive._inner)
    return tuple(_layout(found) for found in json.loads(layouts))


def clashes(drive: Drive) -> tuple[str, ...]:
    """Tell what is in each other's way, chains in guides included, as the chains are laid."""
    _, found = _core.layouts_of(drive._inner)
    return tuple(found)


def _layout(found: Mapping[str, Any]) -> Layout:
    def pair(value: Sequence[float] | None) -> tuple[float, float] | None:
        return None if value is None else (value[0], value[1])

    def all_of(kind: Any, key: str, *points: str) -> tuple[Any, ...]:
        entries = found[key]
        return tuple(kind(**{**it, **{p: pair(it[p]) for p in points}}) for it in entries)

    words = {"from": "begin", "to": "end"}
    faces = [{words.get(key, key): it[key] for key in it} for it in found["faces"]]
    return Layout(
        **{
            **found,
            "counts": Counts(**found["counts"]),
            "stops": all_of(Stop, "stops", "centre"),
            "spans": all_of(Span, "spans", "leaves", "arrives"),
            "faces": tuple(Face(**{**it, "centre": pair(it["centre"])}) for it in faces),
            "fits": all_of(Fit, "fits", "centre"),
            "wear": all_of(Worn, "wear"),
        }
    )


def __dir__() -> list[str]:
    return list(__all__)
