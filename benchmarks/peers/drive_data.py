"""Write drive.json: the marine drive in plain numbers, for programs that know no scene files.

The drive is the preset `marine_engine_bare` without guides, its tensioner wheel fixed where it is
drawn, its teeth with a circular seat and straight flanks. The initial state is the static
equilibrium under gravity and load, set going at the speed of the chain, as chaindrive starts a run.

    python benchmarks/peers/drive_data.py
"""

import json
import math
from pathlib import Path

import numpy as np

import chaindrive as cd
from chaindrive.pose import at_start

FILE = Path(__file__).with_name("drive.json")

CENTRE_SEATS = 0.505  # seat radius over roller diameter, the least of ISO 606


def scene():
    """Return the drive that every program simulates."""
    text = cd.scenes.marine_engine_bare().to_dict()
    del text["guides"], text["tensioners"]
    # What every program has: the loss of Lankarani and Nikravesh; joints of this chain do not rub.
    text["contact"]["teeth"]["dissipation"] = "lankarani-nikravesh"
    text["route"] |= {"start": "polygon", "pretension_at": "phase"}
    text["run"]["run_in"] = 0
    text["title"] = "Marine two-stroke engine, camshaft drive, without guides and tensioner"
    diameter = text["chain"]["roller_diameter"]
    value, unit = diameter.split()
    seat = f"{CENTRE_SEATS * float(value):.6f} {unit}"
    for sprocket in text["sprockets"]:
        sprocket.pop("support", None)
        sprocket.pop("mass", None)
        sprocket["tooth"] = {"kind": "circular", "seat_radius": seat}
    text["contact"].pop("guides")
    return cd.Drive.from_dict(text, name="marine_engine_bare")


def _phase(drawing, name, pitch):
    """Direction of a tooth gap as the chain is laid, modulo a tooth [rad]."""
    wheel = drawing["sprockets"][name]
    away = drawing["chains"][0]["rollers"] - wheel["centre"]
    on = np.abs(np.hypot(*away.T) - wheel["pitch_radius"]) < 1e-6 * pitch
    step = 2 * math.pi / wheel["teeth"]
    angles = np.arctan2(away[on, 1], away[on, 0])
    # Every seated roller gives the same gap; the mean on the circle knows no seam.
    mean = np.exp(1j * angles * wheel["teeth"]).mean()
    if abs(abs(mean) - 1) > 1e-8:
        raise ValueError(f"the rollers on `{name}` do not sit in its gaps")
    return float(np.angle(mean)) % (2 * math.pi) / wheel["teeth"], step


def numbers():
    """Return the drive in SI units as plain lists and numbers."""
    drive = scene()
    record = ["roller_x", "roller_y", "roller_vx", "roller_vy", "link_tension", "contact_force"]
    record += ["sprocket_angle", "sprocket_speed"]
    start = cd.simulate(drive, until=1e-6, every=1e-6, record=record).isel(time=0)
    drawing = at_start(drive, settled=False)
    chain = drive.to_dict()["chain"]
    quantity = {"mass": 3.01, "stiffness": 815e6, "pitch": 0.0889, "roller_diameter": 0.05398}
    stated = {"mass": "3.01 kg", "stiffness": "815 MN/m", "pitch": "88.9 mm"}
    for key, text in (stated | {"roller_diameter": "53.98 mm"}).items():
        if chain[key] != text:
            raise ValueError(f"the preset's chain.{key} is {chain[key]} now, not {text}")
    mass, stiffness, pitch = quantity["mass"], quantity["stiffness"], quantity["pitch"]
    damping = 2 * chain["damping_ratio"] * math.sqrt(stiffness * mass)  # c = 2 ζ √(k m)

    place = np.stack([start.roller_x.values, start.roller_y.values], axis=1)
    speed = np.stack([start.roller_vx.values, start.roller_vy.values], axis=1)
    along = np.roll(place, -1, axis=0) - place
    length = np.hypot(*along.T)
    rate = ((np.roll(speed, -1, axis=0) - speed) * along).sum(axis=1) / length
    # ℓ₀ = ℓ − (T − d ℓ̇)/k
    rest = length - (start.link_tension.values - damping * rate) / stiffness

    wheels = []
    for index, sprocket in enumerate(drive.to_dict()["sprockets"]):
        name = sprocket["name"]
        phase, step = _phase(drawing, name, pitch)
        wheel = drawing["sprockets"][name]
        load = sprocket.get("load", [])
        wheels.append(
            {
                "name": name,
                "teeth": wheel["teeth"],
                "centre": [float(value) for value in wheel["centre"]],
                "tip_radius": wheel["tip_radius"],
                "gap_angle": (phase + float(start.sprocket_angle[index])) % step,
                "speed": float(start.sprocket_speed[index]),
                "prescribed": "motion" in sprocket,
                "inertia": float(str(sprocket.get("inertia", "0 kg m^2")).split()[0]),
                "torque": 1e3 * sum(float(term["torque"].removesuffix(" kN m")) for term in load),
            }
        )
    law = drive.law("crank")
    return {
        "title": drive.title,
        "gravity": [0.0, -9.81],
        "chain": {
            "links": drive.links,
            "pitch": pitch,
            "mass": mass,
            "stiffness": stiffness,
            "damping": damping,
            "roller_radius": 0.5 * quantity["roller_diameter"],
            "rest_length": rest.tolist(),
        },
        "seat_radius": CENTRE_SEATS * quantity["roller_diameter"],
        "contact": {
            "stiffness": 6e11,
            "exponent": 1.5,
            "restitution": 0.8,
            "onset_floor": 0.05,
            "law": json.loads(law._inner.to_json()) if hasattr(law, "_inner") else None,
        },
        "sprockets": wheels,
        "start": {"place": place.tolist(), "velocity": speed.tolist()},
        "check": {
            "link_tension": start.link_tension.values.tolist(),
            "contact_force": start.contact_force.values.tolist(),
        },
    }


def main():
    FILE.write_text(json.dumps(numbers(), indent=1) + "\n", encoding="utf-8")
    print(f"wrote {FILE.name}")


if __name__ == "__main__":
    main()
