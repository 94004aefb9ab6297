"""The scenes that come with the program, one function each.

>>> from chaindrive import scenes
>>> scenes.marine_engine().links
122
>>> "marine_engine" in scenes.presets()
True
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from chaindrive import _core
from chaindrive.drive import Drive

__all__ = [
    "bicycle",
    "bicycle_crank",
    "bicycle_derailleur",
    "bicycle_slack",
    "chain_pendulum",
    "hanging_chain",
    "industrial_16b",
    "marine_engine",
    "marine_engine_bare",
    "marine_engine_oil",
    "marine_two_sprockets",
    "motorcycle",
    "pendulum_in_bush",
    "pin_in_bush",
    "presets",
    "spinning_ring",
    "timing_drive",
    "two_stage_timing",
]


def presets() -> dict[str, str]:
    """Return name and one-line description of every scene."""
    return dict(_core.presets())


def marine_engine() -> Drive:
    """Marine two-stroke engine, camshaft drive.

    Camshaft drive of a large two-stroke engine under its pumps and valves: four sprockets,
    three guide bars, tensioner.
    """
    return Drive._of(_core.Drive.preset("marine_engine"))


def marine_engine_bare() -> Drive:
    """Marine two-stroke engine, camshaft drive as in the paper.

    The same drive as the paper models it: no friction in the joints, constant loads.
    """
    return Drive._of(_core.Drive.preset("marine_engine_bare"))


def marine_engine_oil() -> Drive:
    """Marine two-stroke engine, camshaft drive with oil in its seats.

    The camshaft drive with oil in the seats of its rollers: what an impact leaves follows from the
    film.
    """
    return Drive._of(_core.Drive.preset("marine_engine_oil"))


def marine_two_sprockets() -> Drive:
    """Large chain on two sprockets.

    The chain of the marine engine around two sprockets: the smallest large drive.
    """
    return Drive._of(_core.Drive.preset("marine_two_sprockets"))


def industrial_16b() -> Drive:
    """Industrial drive, 16B-1, 19 to 57 teeth.

    15 kW through a 16B-1 chain, 19 to 57 teeth.
    """
    return Drive._of(_core.Drive.preset("industrial_16b"))


def timing_drive() -> Drive:
    """Timing chain with guide, tensioner arm and hydraulic plunger.

    Valve timing of a car: 8 mm bush chain, fixed guide, arm with a hydraulic plunger.
    """
    return Drive._of(_core.Drive.preset("timing_drive"))


def two_stage_timing() -> Drive:
    """Valve timing in two stages: crankshaft, intermediate shaft, camshaft.

    Valve timing in two stages: two chains, an intermediate shaft, arms with hydraulic
    plungers.
    """
    return Drive._of(_core.Drive.preset("two_stage_timing"))


def bicycle() -> Drive:
    """Bicycle, tight chain, 44 to 18 teeth.

    Chain of a bicycle, 44 to 18 teeth, tight: rigid links with play in their joints.
    """
    return Drive._of(_core.Drive.preset("bicycle"))


def bicycle_slack() -> Drive:
    """Bicycle, slack chain, 44 to 18 teeth.

    The chain of the bicycle, slack: the rear wheel 1 mm nearer.
    """
    return Drive._of(_core.Drive.preset("bicycle_slack"))


def bicycle_crank() -> Drive:
    """Bicycle with pedal crank: two legs at 200 W, hub and wheel joined by a torsional spring.

    A rider who pedals: torque of two legs, chain, rear hub and wheel joined by a torsional
    spring.
    """
    return Drive._of(_core.Drive.preset("bicycle_crank"))


def bicycle_derailleur() -> Drive:
    """Bicycle with a derailleur, 50 to 17 teeth, 250 W.

    A bicycle with a derailleur: two pulleys on a sprung cage, a chain out of line, and what all of
    it loses.
    """
    return Drive._of(_core.Drive.preset("bicycle_derailleur"))


def motorcycle() -> Drive:
    """Motorcycle rear drive, 520 chain, 15 to 46 teeth.

    Rear drive of a motorcycle, 520 chain with a slack lower run, 15 to 46 teeth.
    """
    return Drive._of(_core.Drive.preset("motorcycle"))


def pin_in_bush() -> Drive:
    """A pin dropped into its bush.

    A pin dropped into its bush: one link with play, and how it bounces.
    """
    return Drive._of(_core.Drive.preset("pin_in_bush"))


def pendulum_in_bush() -> Drive:
    """A link that swings in its bush.

    A link that swings by its pin in a bush, with play and friction.
    """
    return Drive._of(_core.Drive.preset("pendulum_in_bush"))


def chain_pendulum() -> Drive:
    """Pendulum on a chain over a chainring.

    A pendulum on a chainring over which a chain is drawn: its swing dies by the friction of
    the joints alone.
    """
    return Drive._of(_core.Drive.preset("chain_pendulum"))


def hanging_chain() -> Drive:
    """Hanging chain.

    Twenty links between two fixed ends: a discrete catenary.
    """
    return Drive._of(_core.Drive.preset("hanging_chain"))


def spinning_ring() -> Drive:
    """Spinning ring.

    A free ring of twenty elastic links, stretched by its rotation.
    """
    return Drive._of(_core.Drive.preset("spinning_ring"))


# Type checkers know the functions above, and would take any name for one of these.
if not TYPE_CHECKING:

    def __getattr__(name: str) -> object:
        known = ", ".join(presets())
        raise AttributeError(f"there is no scene `{name}`; there are {known}", name=name)


def __dir__() -> list[str]:
    return list(__all__)
