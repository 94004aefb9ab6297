"""What every program is measured by: the tension in the middle of the tight span."""

import json
import math
from pathlib import Path
from typing import NamedTuple

import numpy as np

HALF_WIDTH = 8.0  # pitches
EVERY = 1e-4  # interval between samples [s]


class Result(NamedTuple):
    """One run of one program."""

    tension: np.ndarray
    """Tension of every link [N], (samples, links)."""
    cpu: float
    """CPU time of the time stepping [s]."""
    steps: int
    """Accepted steps."""
    evaluations: int
    """Evaluations of the forces."""
    length: float
    """Simulated time [s]."""


def load(file=None):
    """Return drive.json."""
    file = file or Path(__file__).with_name("drive.json")
    return json.loads(Path(file).read_text(encoding="utf-8"))


def link_tension(drive, place, velocity):
    """Tension of every link [N], (..., links), from places and velocities (..., rollers, 2)."""
    chain = drive["chain"]
    along = np.roll(place, -1, axis=-2) - place
    moving = np.roll(velocity, -1, axis=-2) - velocity
    length = np.sqrt((along**2).sum(axis=-1))
    # T = k (ℓ − ℓ₀) + d ℓ̇
    stretch = length - np.asarray(chain["rest_length"])
    return chain["stiffness"] * stretch + chain["damping"] * (along * moving).sum(axis=-1) / length


def tight_middle(drive):
    """Place in the chain, in links, of the middle of the tight span at t = 0.

    The tight span leads from the crank to the camshaft against the travel of the chain.
    """
    place = np.asarray(drive["start"]["place"])
    wheels = {wheel["name"]: np.asarray(wheel["centre"]) for wheel in drive["sprockets"]}
    radius = {wheel["name"]: wheel["tip_radius"] for wheel in drive["sprockets"]}
    between = 0.5 * (wheels["crank"] + wheels["camshaft"])
    # The span lies on the right of the line of centres, by about the radius of the wheels.
    along = (wheels["camshaft"] - wheels["crank"]) / np.linalg.norm(
        wheels["camshaft"] - wheels["crank"]
    )
    middle = between + radius["crank"] * np.array([along[1], -along[0]])
    link = 0.5 * (place + np.roll(place, -1, axis=0))
    return int(np.argmin(((link - middle) ** 2).sum(axis=1)))


def tight_tension(drive, tension):
    """Tension of the middle of the tight span [N], (samples,), sampled every EVERY.

    Weighted mean over sixteen links; the weights travel against the chain at its nominal speed, so
    that the place stays, and no link enters or leaves with a jump.
    """
    samples, links = tension.shape
    crank = next(wheel for wheel in drive["sprockets"] if wheel["prescribed"])
    sense = _travel(drive)
    # Pitches that the chain has moved on: z ω t / 2π
    moved = sense * abs(crank["speed"]) * crank["teeth"] / (2 * math.pi) * EVERY
    centre = tight_middle(drive) - moved * np.arange(samples)
    away = np.arange(links) - centre[:, None]
    away = (away + 0.5 * links) % links - 0.5 * links
    weight = np.where(
        np.abs(away) < HALF_WIDTH, 1 + np.cos(np.pi * np.clip(away / HALF_WIDTH, -1, 1)), 0
    )
    return (weight * tension).sum(axis=1) / weight.sum(axis=1)


def _travel(drive):
    """+1 if the chain travels from low to high numbers of its rollers, else −1."""
    velocity = np.asarray(drive["start"]["velocity"])
    place = np.asarray(drive["start"]["place"])
    along = np.roll(place, -1, axis=0) - place
    return float(np.sign((along * velocity).sum()))


def error(drive, result, reference):
    """Rms difference of the tight tension over its mean [–], of two runs sampled alike."""
    ours, theirs = tight_tension(drive, result.tension), tight_tension(drive, reference.tension)
    count = min(len(ours), len(theirs))
    difference = ours[1:count] - theirs[1:count]
    return float(np.sqrt((difference**2).mean()) / theirs[1:count].mean())
