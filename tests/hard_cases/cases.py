"""The hard cases: drives at and beyond the edge of what one should simulate."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

import chaindrive as cd
import tooth_jump


@dataclass(frozen=True)
class Case:
    """One row of the table."""

    name: str
    what: str
    """What is hard about it, for the reader of the table."""
    drive: Callable[[], cd.Drive]
    until: float
    """Length of the run [s]."""
    step_factor: float = 1.0
    """Multiplies the step that a method would choose."""
    transient: float = 0.3
    """Share of the run that the statistics leave out."""
    settings: dict[str, Any] = field(default_factory=dict)


def large(changes=None):
    """Return the large chain on two sprockets, changed."""
    return lambda: cd.scenes.marine_two_sprockets().replace(changes or {})


def industrial(changes=None, links=120):
    """Return the 16B drive, changed; the driven wheel moves until the chain closes."""
    adjust = {"kind": "sprocket", "name": "driven", "direction": [1, 0], "within": 0.1}
    common = {"route.adjust": adjust, "chain.links": links}
    return lambda: cd.scenes.industrial_16b().replace(common | (changes or {}))


def bicycle(changes=None):
    """Return the bicycle drive with clearance joints, changed."""
    return lambda: cd.scenes.bicycle().replace(changes or {})


def sharp_guides():
    """Return the marine engine with guides that are straight lines with bare corners."""
    drive = cd.scenes.marine_engine_bare()
    changes = {}
    for name in drive.guides:
        index = drive.guides.index(name)
        # The straight part is the longest side of the outline, which runs against the chain.
        outline = drive.profile(name, settled=False).outline()
        side = np.hypot(*np.diff(outline, axis=0).T).argmax()
        points = [outline[side + 1].tolist(), outline[side].tolist()]
        changes[f"guides[{index}].face"] = {"kind": "points", "points": points, "radii": []}
    return drive.replace(changes)


def stop_and_reverse(speed, at, pause, ramp):
    """Return a motion: constant speed [rad/s], a stop within a `ramp` [s], a pause, and back."""
    times, values = [], []
    angle, t, spacing = 0.0, 0.0, ramp / 8
    end = at + pause + at
    while t < end:
        if t < at:
            rate = speed
        elif t < at + ramp:
            rate = speed * (1 - (t - at) / ramp)
        elif t < at + pause:
            rate = 0.0
        elif t < at + pause + ramp:
            rate = -speed * (t - at - pause) / ramp
        else:
            rate = -speed
        times.append(t)
        values.append(angle)
        angle += rate * spacing
        t += spacing
    return {"kind": "table", "times": times, "values": values}


CONTACT_100 = {"kind": "power", "stiffness": "6e13 N/m^1.5", "exponent": 1.5}
START = [{"kind": "ramp", "torque": "-15 kN m", "duration": "20 ms"}]

PARTICLES = [
    Case("as it is", "two sprockets, 112 links of 88.9 mm, 100 rpm", large(), 0.5),
    Case(
        "contact ×100",
        "tooth contacts a hundred times stiffer",
        large({"contact.teeth.law": CONTACT_100}),
        0.5,
    ),
    Case(
        "e = 0",
        "restitution 0, Lankarani–Nikravesh",
        large({"contact.teeth.restitution": 0, "contact.teeth.dissipation": "lankarani-nikravesh"}),
        0.5,
    ),
    Case(
        "e = 1",
        "restitution 1, undamped links: nothing is lost",
        large({"contact.teeth.restitution": 1, "chain.damping_ratio": 0}),
        0.5,
    ),
    Case("no pretension", "exactly as long as its path", large({"route.pretension": 0}), 0.5),
    Case(
        "slack",
        "centres 20 mm too near: the slack strand sags",
        large({"route.pretension": 0, "sprockets.camshaft.centre": [0, 2.7213]}),
        # The slack strand swings for two seconds before it finds its place.
        4.0,
        transient=0.5,
    ),
    Case(
        "5 000 rpm",
        "16B chain at 40 m/s, ten times its catalogue speed",
        industrial({"sprockets.driver.motion.speed": "5000 rpm"}),
        0.1,
    ),
    Case(
        "150 kN",
        "load of 150 kN in the tight span, near the breaking load",
        large({"sprockets.camshaft.load": [{"kind": "constant", "torque": "85 kN m"}]}),
        0.5,
    ),
    Case(
        "no gravity",
        "weightless and without pretension",
        large({"gravity": [0, 0], "route.pretension": 0}),
        0.5,
    ),
    Case(
        "worn and scattered",
        "16B chain, links 2 % too long, scattered by 0.3 %",
        industrial({"chain.elongation": 0.02, "chain.scatter": {"pitch": 0.003, "seed": 1}}),
        0.2,
    ),
    Case(
        "6 to 150 teeth",
        "16B chain around the smallest wheel in use and a very large one",
        industrial({"sprockets.driver.teeth": 6, "sprockets.driven.teeth": 150}, links=176),
        0.05,
    ),
    Case("sharp guides", "marine engine, guides that begin and end in a corner", sharp_guides, 0.5),
    Case("step × 10", "ten times the step of the automatic choice", large(), 0.5, step_factor=10),
    Case(
        "stop and reverse",
        "driver stops within 1 ms, waits 0.1 s, and reverses",
        large({"sprockets.crank.motion": stop_and_reverse(-10.47, 0.2, 0.1, 1e-3)}),
        0.5,
        transient=0.0,
    ),
    Case(
        "start by torque",
        "driver at rest, 15 kN m within 20 ms",
        lambda: _torque_start(),
        0.5,
        transient=0.0,
    ),
    Case(
        "tooth jump",
        "worn chain jumps three teeth of an overloaded idler and lands",
        tooth_jump.drive,
        tooth_jump.UNTIL,
    ),
]

SHORT = 3e-3  # explicit methods take steps of 0.1 µs and less
CLEARANCE = [
    Case("as it is", "bicycle, 104 links, 25 µm of play", bicycle(), SHORT),
    Case(
        "contact ×100",
        "joints and teeth of a hundred times the modulus",
        bicycle(
            {
                "contact.joints.law": {"kind": "cylindrical", "modulus": 2.07e13},
                "contact.teeth.law": {
                    "kind": "johnson",
                    "modulus": 2.07e13,
                    "length": "3.3 mm",
                    "clearance": "0.1 mm",
                },
            }
        ),
        SHORT,
    ),
    Case(
        "e = 0",
        "restitution 0 in joints and on teeth, Lankarani–Nikravesh",
        bicycle(
            {
                "contact.joints.restitution": 0,
                "contact.joints.dissipation": "lankarani-nikravesh",
                "contact.teeth.restitution": 0,
                "contact.teeth.dissipation": "lankarani-nikravesh",
            }
        ),
        SHORT,
    ),
    Case(
        "e = 1",
        "restitution 1 in joints and on teeth",
        bicycle({"contact.joints.restitution": 1, "contact.teeth.restitution": 1}),
        SHORT,
    ),
    Case("no pretension", "exactly as long as its path", bicycle({"route.pretension": 0}), SHORT),
    Case(
        "5 000 rpm",
        "chainring at 5 000 rpm, chain at 47 m/s",
        bicycle({"sprockets.chainring.motion.speed": "-5000 rpm"}),
        SHORT,
    ),
    Case(
        "10 kN",
        "load of 10 kN in the tight span, above the breaking load",
        bicycle({"sprockets.rear.load": [{"kind": "constant", "torque": "364 N m"}]}),
        0.3e-3,
    ),
    Case(
        "no gravity",
        "weightless and without pretension",
        bicycle({"gravity": [0, 0], "route.pretension": 0}),
        SHORT,
    ),
    Case(
        "step × 10", "ten times the step of the automatic choice", bicycle(), SHORT, step_factor=10
    ),
    Case(
        "stop and reverse",
        "chainring stops within 0.1 ms, waits 0.5 ms, and reverses",
        bicycle({"sprockets.chainring.motion": stop_and_reverse(-9.42, 1e-3, 5e-4, 1e-4)}),
        SHORT,
        transient=0.0,
    ),
]


def _torque_start():
    scene = cd.scenes.marine_two_sprockets().to_dict()
    crank, camshaft = scene["sprockets"]
    del crank["motion"]
    crank["inertia"] = "250 kg m^2"
    crank["drive"] = START
    camshaft["load"] = [{"kind": "resistance", "linear": "200 N m s"}]
    return cd.Drive.from_dict(scene, name="torque_start")
