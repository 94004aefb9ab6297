"""The outlines of drives and profiles as curves: sprockets, guides, rollers, lines of chains."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TypeAlias

import numpy as np

from chaindrive.drive import Drive
from chaindrive.errors import ParameterError
from chaindrive.exchange.curve import Curve, curve_of
from chaindrive.profile import Profile

__all__ = ["Outlined", "outlines"]

Outlined: TypeAlias = Drive | Profile | Curve | Iterable[Curve | Profile]
"""What outlines can be drawn of."""


def outlines(what: Outlined, *, settled: bool = True) -> list[Curve]:
    """Return outlines in their places, in metres; `Curve.layer` says whose they are.

    Parameters
    ----------
    what
        A drive: its sprockets, guides, rollers and the line of its chains; a `Profile`; or curves.
    settled
        Of a drive: whether it stands as at the start of a run, or as the chain was laid.

    Raises
    ------
    AssemblyError
        The drive does not close or settle.
    ParameterError
        This is nothing that has outlines.

    Examples
    --------
    >>> import chaindrive as cd
    >>> found = cd.exchange.outlines(cd.scenes.industrial_16b(), settled=False)
    >>> [curve.layer for curve in found][:3]
    ['sprocket driver', 'sprocket driven', 'chain']
    >>> len([curve for curve in found if curve.layer == "rollers"])
    120
    """
    if isinstance(what, Drive):
        return _of_drive(what, settled=settled)
    if isinstance(what, Profile):
        return [curve_of(what, what.name)]
    if isinstance(what, Curve):
        return [what]
    if isinstance(what, Iterable) and not isinstance(what, str):
        return [curve for each in what for curve in outlines(each)]
    raise ParameterError(
        f"{what!r} has no outlines", "what", "give a drive, a profile, a curve, or several curves"
    )


def _of_drive(drive: Drive, *, settled: bool) -> list[Curve]:
    # Of a sprocket and a guide of one name `Drive.profile` knows the sprocket only.
    guides = [name for name in drive.guides if name not in drive.sprockets]
    found = [
        curve_of(drive.profile(name, settled=settled), f"{kind} {name}")
        for kind, names in (("sprocket", drive.sprockets), ("guide", guides))
        for name in names
    ]
    start = drive._inner.figure(settled, 0.0)
    for chain, places in zip(start.chains, start.start()["rollers"], strict=True):
        corners = np.asarray(places)
        pieces = len(corners) if chain["closed"] else len(corners) - 1
        found.append(Curve(corners, np.zeros(pieces), chain["closed"], "chain"))
        beside = np.array([0.5 * chain["roller_diameter"], 0.0])
        found += [
            # Two half turns are a circle.
            Curve(np.array([centre - beside, centre + beside]), np.ones(2), True, "rollers")
            for centre in corners
        ]
    return found
