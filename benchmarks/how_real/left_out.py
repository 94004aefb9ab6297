"""Effects that the presets leave out, each turned on alone, as far as it can reasonably go."""

import math
from typing import Any

import chaindrive as cd
from assumptions import Assumption, Case, cases, found

RUN_OUT = "a dial on the root circle"
PITCH = "a gear tester, or the lines of the shafts in a measured spectrum"
SHIFT = "a straight edge on the sprockets"
WEAR = "bores of worn bushes, measured"
DROP = "a roller dropped on an oiled tooth, 0.2 to 3 m/s"

#: Films at touch [m], thin and thick, and viscosity [Pa s]; length [m] where the scene has none.
#: Chains of bicycles are not flooded.
OIL: dict[str, tuple[tuple[float, float], dict[str, float]]] = {
    "marine_engine": ((10e-6, 270e-6), {"viscosity": 0.042, "half_width": 14e-3}),
    "timing_drive": ((5e-6, 50e-6), {"viscosity": 0.01, "length": 5e-3, "half_width": 1.5e-3}),
    "industrial_16b": ((10e-6, 100e-6), {"viscosity": 0.1}),
}


def left_out() -> tuple[Case, ...]:
    """Return the presets with what is added to them."""
    return tuple(
        Case(case.preset, case.run_in, case.until, tuple(effects(case.preset)), case.phases)
        for case in cases()
    )


def effects(preset: str) -> list[Assumption]:
    """Return what is added to a preset. The lower ends are the preset, but for those of oil."""
    drive = getattr(cd.scenes, preset)()
    names = list(drive.sprockets)
    added = [
        Assumption("run-out", run_out(preset, names), "none to the limit of ISO 606", RUN_OUT),
        Assumption(
            "pitch errors of teeth",
            (
                {},
                {
                    f"sprockets.{name}.gap_errors": {
                        "kind": "random",
                        "deviation": "30 µm",
                        "seed": seed,
                    }
                    for seed, name in enumerate(names, 1)
                },
            ),
            "none to 30 µm (assumed)",
            PITCH,
        ),
        Assumption(
            "a sprocket out of line",
            ({}, {f"sprockets.{names[1]}.lateral": 0.002 * centre_distance(preset)}),
            "none to 0.2 % of the centre distance (SEDIS)",
            SHIFT,
        ),
        Assumption(
            "pressure in worn-in pins",
            ({}, {"chain.joint.pressure_factor": "uniform"}),
            "line to uniform",
            WEAR,
        ),
    ]
    if preset in OIL:
        films, more = OIL[preset]
        kept = {"law": found(preset, "contact.teeth.law")}
        ends = tuple(
            {"contact.teeth": {**kept, "film": {"thickness": film, **more}}} for film in films
        )
        thin, thick = (f"{1e6 * film:.0f}" for film in films)
        added.append(Assumption("oil in the seats", ends, f"{thin} to {thick} µm at touch", DROP))
    return added


def run_out(preset: str, names: list[str]) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return eccentricities [m]: half of what ISO 606 lets a dial show, 0.0008 d_f + 0.08 mm."""
    pitch = found(preset, "chain.pitch")
    roller = found(preset, "chain.roller_diameter")
    ends = {}
    for name in names:
        teeth = found(preset, f"sprockets.{name}.teeth")
        root = pitch / math.sin(math.pi / teeth) - roller
        dial = min(max(0.8e-3 * root + 0.08e-3, 0.15e-3), 0.76e-3)
        ends[f"sprockets.{name}.eccentricity"] = 0.5 * dial
    return {}, ends


def centre_distance(preset: str) -> float:
    """Return the distance [m] of the first two sprockets of a preset."""
    first, second = (found(preset, f"sprockets[{i}].centre") for i in (0, 1))
    return math.dist(first, second)
