"""Drives drawn by lot, with everything that moves the parts of a drawing."""

from __future__ import annotations

import random
from typing import Any

import numpy as np

import chaindrive as cd

# Chain, pitch [m], mass [kg/m].
CHAINS = [("08B-1", 12.7e-3, 0.70), ("12B-1", 19.05e-3, 1.25), ("16B-1", 25.4e-3, 2.71)]
KINDS = ["guide", "adjusted", "springs", "moved", "slider", "arm"]

# Values of a drive without friction in its joints and compliance behind its contacts, set going
# with the kick of the polygons: small steps go wrong, and faults show in short runs.
BARE: dict[str, Any] = {
    "route.start": "polygon",
    "route.pretension_at": "phase",
    "run.run_in": 0,
    "contact.teeth.series": 0,
    "contact.teeth.dissipation": "lankarani-nikravesh",
    "contact.guides.dissipation": "lankarani-nikravesh",
    "contact.joints.series": 0,
    "contact.joints.friction": "none",
    "contact.joints.dissipation": "lankarani-nikravesh",
}


def random_drive(seed: int) -> cd.Drive:
    """Return a drive of two or three sprockets; the seed modulo six says of which kind."""
    lot = random.Random(seed)
    kind = KINDS[seed % len(KINDS)]
    name, pitch, mass = lot.choice(CHAINS)
    teeth = [lot.randint(15, 31), lot.randint(17, 45)]
    radius = pitch / 2 / np.sin(np.pi / max(teeth))
    length = lot.uniform(2.6, 4.0) * 2 * radius
    towards = lot.uniform(-np.pi, np.pi)
    along = np.array([np.cos(towards), np.sin(towards)])
    across = np.array([-along[1], along[0]])
    speed = lot.choice([-1, 1]) * lot.uniform(100, 600)
    pull = 400.0 * (pitch / 12.7e-3) ** 2
    driven: dict[str, Any] = {
        "name": "driven",
        "teeth": teeth[1],
        "centre": list(length * along),
        "inertia": 0.5 * 40 * radius**4 + 1e-3,
        "load": [{"kind": "constant", "torque": -np.sign(speed) * pull * radius}],
    }
    scene: dict[str, Any] = {
        "title": f"drawn by lot, {kind}",
        "chain": {
            "type": name,
            "mass": mass * pitch,
            "stiffness": 68 * 45e3 * (pitch / 25.4e-3) ** 2 / pitch,
            "damping_ratio": 0.03,
        },
        "contact": {
            "teeth": {"law": {"kind": "linear", "stiffness": 1e8}, "onset_floor": 0.05},
            "guides": {"law": {"kind": "linear", "stiffness": 1e7}, "onset_floor": 0.05},
        },
        "sprockets": [
            {
                "name": "driver",
                "teeth": teeth[0],
                "centre": [0.0, 0.0],
                "motion": {"kind": "constant", "speed": f"{speed} rpm"},
            },
            driven,
        ],
        "route": {"pretension": pull, "phase": lot.random()},
    }
    stops = [
        cd.design.Sprocket("driver", teeth[0], (0.0, 0.0)),
        cd.design.Sprocket("driven", teeth[1], tuple(driven["centre"])),
    ]
    moves = {"kind": "sprocket", "name": "driven", "direction": list(along), "within": 2 * pitch}
    if kind == "guide":
        face = {
            "kind": "on-span",
            "from": "25 %",
            "to": "75 %",
            "radius": 4 * length,
            "bow": pitch / 4,
        }
        touches = lot.choice(["rollers", "eyes"])
        scene["guides"] = [{"name": "rail", "face": face, "touches": touches}]
        scene["route"]["stops"] = ["driver", "rail", "driven"]
    elif kind == "springs":
        driven["mass"] = 20.0
        driven["support"] = {"kind": "springs", "stiffness": [5e6, 5e6], "damping": [5e3, 5e3]}
    elif kind == "moved":
        term = {"amplitude": pitch / 50, "frequency": lot.uniform(20, 60)}
        swing = {"kind": "harmonics", "terms": [term]}
        driven["support"] = {"kind": "prescribed", "x": swing, "y": swing}
    elif kind in ("slider", "arm"):
        # An idler beyond the strand that comes back, pushed away from the drive.
        centre = 0.5 * length * along + (radius + 6 * pitch) * across
        idler = {"name": "idler", "teeth": 17, "centre": list(centre), "mass": 1.0, "inertia": 1e-3}
        idler["support"] = {"kind": "tensioner", "name": "tightener"}
        scene["sprockets"].append(idler)
        stops.append(cd.design.Sprocket("idler", 17, tuple(centre)))
        push: dict[str, Any] = {
            "kind": "spring",
            "preload": pull,
            "stiffness": 1e5,
            "damping": 200.0,
        }
        if kind == "slider":
            carrier: dict[str, Any] = {"kind": "slider", "direction": list(across), "mass": 1.0}
            within: Any = 2 * pitch
        else:
            pivot = centre - 5 * pitch * along
            plunger = {"at": list(centre - 2.5 * pitch * along), "direction": list(across)}
            carrier = {"kind": "arm", "pivot": list(pivot), "inertia": 0.05, "plunger": plunger}
            within = "25 deg"
        scene["tensioners"] = [{"name": "tightener", "carrier": carrier, "push": push}]
        moves = {"kind": kind, "name": "tightener", "within": within}
    counts = cd.design.layout(stops, pitch).counts
    nearest = min(counts.even_below, counts.even_above, key=lambda it: abs(it - counts.pitches))
    scene["chain"]["links"] = nearest
    scene["route"]["adjust"] = moves
    return cd.Drive.from_dict(scene)


def swinging_drive(seed: int) -> cd.Drive:
    """Return a drawn drive whose driver and load swing by orders, with default contacts."""
    drive = random_drive(seed).to_dict()
    lot = random.Random(10_000 + seed)
    driver, driven = drive["sprockets"][:2]
    orders = lot.sample([1, 2, 3, 4, 5, 7], 2)
    speed = driver["motion"]["speed"]
    terms = [{"order": orders[0], "amplitude": lot.uniform(1e-4, 2e-3)}]
    driver["motion"] = {"kind": "orders", "speed": speed, "terms": terms}
    [steady] = driven["load"]
    amplitude = lot.uniform(0.1, 0.6) * abs(steady["torque"])
    swing = {"kind": "harmonic", "amplitude": amplitude, "order": orders[1]}
    driven["load"] = [steady, swing]
    del drive["contact"]
    return cd.Drive.from_dict(drive)
