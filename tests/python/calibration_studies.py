"""Studies of fits: their draws, and one fit for each of them.

Draws stand in tables that were made before anybody had seen a record of them; `table` makes them.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
from known_records import Place, record_of

import chaindrive as cd
from chaindrive.measurement.evaluations import RunStore
from chaindrive.measurement.experiment import begun
from chaindrive.measurement.fitting import Fit, rooted
from chaindrive.measurement.free import free_parameters, open_to

LOAD = "sprockets.driven.load[0].torque"
PRETENSION = "route.pretension"
PRELOAD = "tensioners[0].push.preload"
DAMPING = "tensioners[0].push.damping"
CAMSHAFT = "sprockets.exhaust.load[0].torque"
FRICTION = "contact.joints.friction"
LAW = "contact.teeth.law"

#: Seed and rows of each table.
TABLES = {
    # Anew, after it had come to be counted what folds down from above half the sampling rate.
    "refusal_power.csv": (20261141, 180),
    "timing_records.csv": (20261142, 20),
    # Anew, after runs along a combination had come to tell whether it is identified.
    "refusal_level.csv": (20261138, 100),
    "refusal_pairs.csv": (20261144, 100),
    # Anew, after valleys that explain a record alike had come to belong to intervals.
    "forty_again.csv": (20261129, 40),
}
CHANNELS = ("tight", "slack", "torque")

#: Four free parameters of a record of a second of `industrial_16b`.
FOUR = {
    LOAD: (-1600.0, -1300.0),
    f"{FRICTION}.coefficient": (0.05, 0.15),
    PRETENSION: (1000.0, 2000.0),
    "chain.stiffness": (120e6, 200e6),
}
#: The right model: what is free of `industrial_16b`.
LEVEL_FREE = {LOAD: (-1600.0, -1300.0), PRETENSION: (1000.0, 2000.0)}
#: Of the drive with a tensioner.
POWER_FREE = {LOAD: (10.0, 30.0), PRELOAD: (60.0, 340.0)}
TENSIONED: dict[str, Place] = {
    "tight": ("span_tension", "driver-driven", 2.0),
    "slack": ("span_tension", "idler-driver", 1.0),
    "torque": ("sprocket_torque", "driver", 0.1),
}
#: Of `timing_drive`: the plunger of its tensioner, and the mean torque of a camshaft.
TIMING_FREE = {PRELOAD: (20.0, 80.0), CAMSHAFT: (0.0, 6.0)}
TIMING: dict[str, Place] = {
    "tight": ("span_tension", "crank-exhaust", 5.0),
    "slack": ("span_tension", "intake-crank", 5.0),
    "torque": ("sprocket_torque", "crank", 0.2),
}
#: Missing physics by kind: the path, its value in the fit, and in the truth by strength.
#: A tooth of F = K δ^1.5 has at 500 N a share of the secant stiffness of the fit's spring.
_SPRING, _AT = 1e8, 500.0
MISSING: dict[str, tuple[str, Any, dict[str, Any]]] = {
    "friction": (
        FRICTION,
        "none",
        {f"mu = {it:g}": {"kind": "spring-slider", "coefficient": it} for it in (0.005, 0.02, 0.1)},
    ),
    "damping": (DAMPING, 0.0, {f"{it:g} N s/m": it for it in (10.0, 50.0, 200.0)}),
    "law": (
        LAW,
        {"kind": "linear", "stiffness": _SPRING},
        {
            f"secant {it:g}": {
                "kind": "power",
                "exponent": 1.5,
                "stiffness": _AT / (_AT / (it * _SPRING)) ** 1.5,
            }
            for it in (1.0, 0.5, 0.15)
        },
    ),
}
CASES = [(kind, strength) for kind, (*_, of) in MISSING.items() for strength in of]


def table(name: str) -> pd.DataFrame:
    """Make the draws of a table."""
    seed, count = TABLES[name]
    rng = np.random.default_rng(np.random.SeedSequence(seed))
    rows: list[dict[str, Any]] = []
    for number in range(count):
        gain = 0.01
        if name == "refusal_power.csv":
            kind, strength = CASES[number % len(CASES)]
            row = {LOAD: rng.uniform(17.0, 23.0), PRELOAD: rng.uniform(160.0, 240.0)}
            gain = 0.005
        elif name.startswith("refusal_level"):
            row = {LOAD: rng.uniform(-1540.0, -1360.0), PRETENSION: rng.uniform(1200.0, 1800.0)}
        elif name == "forty_again.csv":
            # The inner 60 % of each range.
            row = {
                path: rng.uniform(0.8 * low + 0.2 * high, 0.2 * low + 0.8 * high)
                for path, (low, high) in FOUR.items()
            }
        elif name == "timing_records.csv":
            row = {PRELOAD: rng.uniform(32.0, 68.0), CAMSHAFT: rng.uniform(1.2, 4.8)}
        else:
            # The load in two parts, ranges about the values, the speed.
            row = {
                "share": rng.uniform(0.1, 0.9),
                "range": rng.uniform(0.3, 0.6),
                "speed": rng.uniform(15.0, 60.0),
                "mu": rng.uniform(0.05, 0.15),
            }
        if name.startswith(("refusal_level", "refusal_power")):
            # The fit begins near the truth: what is studied is what it says there.
            row |= {f"start {it}": rng.uniform(0.98, 1.02) for it in list(row) if "." in it}
        row["phase"] = rng.uniform()
        row |= {f"gain_{it}": 1.0 + gain * rng.standard_normal() for it in CHANNELS}
        if name == "refusal_power.csv":
            row |= {"kind": kind, "strength": strength}
        rows.append(row | {"noise": int(rng.integers(2**31))})
    return pd.DataFrame(rows)


def tensioned() -> cd.Drive:
    """Two sprockets and an idler on a slider, which a spring with a damper pushes."""
    pitch, centres = 12.7e-3, 0.28
    over = pitch / 2.0 / np.sin(np.pi / 25.0) + 5.0 * pitch
    support = {"kind": "tensioner", "name": "tightener"}
    load = [{"kind": "constant", "torque": 20.0}]
    motion = {"kind": "constant", "speed": "-1500 rpm"}
    slider = {"kind": "slider", "direction": [0.0, 1.0], "mass": 1.0}
    push = {"kind": "spring", "preload": 200.0, "stiffness": 5e4, "damping": 200.0}
    scene = {
        "chain": {"type": "08B-1", "links": 72, "drag": 25.0},
        "contact": {"teeth": {"law": {"kind": "linear", "stiffness": _SPRING}}},
        "sprockets": [
            {"name": "driver", "teeth": 19, "centre": [0.0, 0.0], "motion": motion},
            {"name": "driven", "teeth": 25, "centre": [centres, 0.0], "inertia": 0.01}
            | {"load": load},
            {"name": "idler", "teeth": 17, "centre": [centres / 2.0, over], "mass": 0.5}
            | {"inertia": 3e-4, "support": support},
        ],
        "tensioners": [{"name": "tightener", "carrier": slider, "push": push}],
        "route": {
            "pretension": 200.0,
            "adjust": {"kind": "slider", "name": "tightener", "within": 2.0 * pitch},
        },
        "run": {"run_in": 0.2, "every": 1e-4},
    }
    return cd.Drive.from_dict(scene)


def level_of(draw: Mapping[str, str], **settings: Any) -> dict[str, Any]:
    """What a fit says of the right model of `industrial_16b`."""
    rig = cd.scenes.industrial_16b().replace({"run.run_in": 0.15})
    truth = {path: float(draw[path]) for path in LEVEL_FREE}
    true = rig.replace(truth | {"route.phase": float(draw["phase"])})
    data = record_of(true, draw, 0.2, run_in=0.25)
    start = rig.replace(_start(draw, truth))
    return _told(start, data, LEVEL_FREE, truth, {"starts": 1} | settings)


def power_of(draw: Mapping[str, str], **settings: Any) -> dict[str, Any]:
    """What a fit says that lacks some physics of its record."""
    path, wrong, strengths = MISSING[draw["kind"]]
    rig = tensioned()
    truth = {it: float(draw[it]) for it in POWER_FREE}
    right = {path: strengths[draw["strength"]], "route.phase": float(draw["phase"])}
    how = {"run_in": 0.25, "step": 3e-6, "every": 2e-4}
    true = rig.replace(truth | right)
    data = record_of(true, draw, 0.2, TENSIONED, gain_uncertainty=0.005, **how)
    model = rig.replace(_start(draw, truth) | {path: wrong})
    case = {"kind": draw["kind"], "strength": draw["strength"]}
    return case | _told(model, data, POWER_FREE, truth, {"starts": 1} | settings)


def timing_of(draw: Mapping[str, str], **settings: Any) -> dict[str, Any]:
    """What a fit says of a record of `timing_drive`, which has a tensioner."""
    rig = cd.scenes.timing_drive().replace({"run.run_in": 0.15})
    truth = {path: float(draw[path]) for path in TIMING_FREE}
    true = rig.replace(truth | {"route.phase": float(draw["phase"])})
    how = {"run_in": 0.2, "step": 2.5e-6, "every": 2e-4}
    data = record_of(true, draw, 0.2, TIMING, **how)
    return _told(rig, data, TIMING_FREE, truth, {"starts": 3} | settings)


#: Pairs of which only the sum or the product can be known.
PAIRS = (
    (LOAD, LOAD.replace("[0]", "[1]")),
    (f"{FRICTION}.coefficient", "chain.joint.pressure_factor"),
)


def pair_of(draw: Mapping[str, str], pair: tuple[str, str], **settings: Any) -> list[str]:
    """What is said before a fit of a load in two parts, or of friction and its pressure factor."""
    share, wide = float(draw["share"]), float(draw["range"])
    own = {
        PAIRS[0][0]: share * -1433.0,
        PAIRS[0][1]: (1.0 - share) * -1433.0,
        PAIRS[1][0]: float(draw["mu"]),
        PAIRS[1][1]: 1.3 + 0.5 * share,
    }
    loads = [{"kind": "constant", "torque": own[it]} for it in PAIRS[0]]
    rig = cd.scenes.industrial_16b().replace(
        {
            "run.run_in": 0.3,
            "sprockets.driver.motion.speed": float(draw["speed"]),
            "sprockets.driven.load": loads,
            FRICTION: {"kind": "spring-slider", "coefficient": own[PAIRS[1][0]]},
            PAIRS[1][1]: own[PAIRS[1][1]],
        }
    )
    # Twenty pitches.
    seconds = 20.0 * 2.0 * np.pi / 19.0 / float(draw["speed"])
    true = rig.replace({"route.phase": float(draw["phase"])})
    data = record_of(true, draw, seconds, run_in=0.4, every=seconds / 1000.0)
    free = {it: tuple(sorted(own[it] * by for by in (1.0 - wide, 1.0 + wide))) for it in pair}
    if PAIRS[1][1] in free:
        low, high = free[PAIRS[1][1]]
        free[PAIRS[1][1]] = (max(low, 1.0), min(high, 2.0))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", cd.MeasurementWarning)
        found = cd.calibrate(rig, data, free, validation=0.0, **settings)
    if "chi2" in found.attrs:
        return []
    return list(found.attrs["reasons"])


def _start(draw: Mapping[str, str], truth: Mapping[str, float]) -> dict[str, float]:
    return {path: value * float(draw[f"start {path}"]) for path, value in truth.items()}


def _told(rig: cd.Drive, data: Any, free: Any, truth: Any, settings: Any) -> dict[str, Any]:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", cd.MeasurementWarning)
        found = cd.calibrate(rig, data, free, **settings)
    reasons = list(found.attrs["reasons"])
    kinds = {
        "missing": "physics are missing",
        "pair": "not identifiable",
        "silent": "moves nothing",
        "bound": " bound, ",
    }
    why = [kind for kind, words in kinds.items() if any(words in it for it in reasons)]
    hits = {
        path: bool(found["lower"].sel(parameter=path) < value < found["upper"].sel(parameter=path))
        for path, value in truth.items()
    }
    return {
        "why": "+".join(why),
        "chi2": float(found.attrs.get("chi2", np.nan)),
        "p_value": float(found.attrs.get("p_value", np.nan)),
        "validation": found.attrs.get("validation", ""),
        "residual": found["residual"].to_series().round(3).to_dict(),
        "hits": hits,
        "computed": int(found.attrs["computed"]),
    }


def straight_errors(
    rig: cd.Drive, data: Any, free: Mapping[str, Any], truth: Mapping[str, float], **settings: Any
) -> dict[str, float]:
    """Standard errors that the same record leaves to a straight drive [SI]: ``(Jᵀ C⁻¹ J)⁻¹``.

    J at the truth, C of all errors of the record, as a fit has it; four runs a parameter.
    """
    drive = open_to(rig, free)
    parameters = free_parameters(drive, data, free)
    workers = {"jobs": settings.get("jobs"), "executor": None}
    how = (settings.get("until"), None, workers)
    store = RunStore(settings.get("store"))
    own = begun(drive, data, parameters, settings.get("validation", 0.25), store, how)
    fit = Fit([own], parameters, {}, "linear", lambda: None)
    fit.begin()
    jacobian, _ = fit.replicated(np.array([truth[it.path] for it in parameters]))
    errors, known = fit.errors, fit.known
    rows = np.linalg.solve(rooted(errors.covariance[np.ix_(known, known)]), jacobian[known])
    found = np.sqrt(np.diag(np.linalg.inv(rows.T @ rows))) * fit.half
    return {it.path: float(error) for it, error in zip(parameters, found, strict=True)}
