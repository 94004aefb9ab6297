"""Drives of published losses, and the runs behind the tutorial on them.

``python tests/python/published.py`` writes ``docs/tutorials/published.csv``: the loss of every case
at every draw of the inputs. It takes some two minutes of processor time.
"""

import contextlib
import csv
import io
import math
import re
import tomllib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from scipy.stats import qmc

import chaindrive as cd

ROOT = Path(__file__).resolve().parents[2]
SCENE = ROOT / "tests/validation/M01/scene.toml"
INPUTS = ROOT / "docs/tutorials/published.toml"
LOSSES = ROOT / "docs/tutorials/published.csv"
PAGE = ROOT / "docs/tutorials/published.md"
PITCH = 12.7e-3
SPANS = ("both", "one")
"""Hypotheses: the second span is as tense as the first, or slack while the first has all."""


def losses(run: xr.Dataset) -> float:
    """Mean power lost in joints, on teeth and along spans [W], not in the damper of a rig."""
    lost = run["energy_losses"].sel(place=["joints", "rollers", "teeth", "spans"]).sum("place")
    duration = float(run["time"][-1] - run["time"][0])
    return float(lost[-1] - lost[0]) / duration


def tensioned(
    rig: cd.Drive, teeth: tuple[int, int], links: int, tension: float, **changes: Any
) -> cd.Drive:
    """Give the full-tension rig other sprockets and another tension [N]."""
    chainring, cog = teeth
    centres = cd.kinematics.centre_distance(chainring, cog, PITCH, links)
    return rig.replace(
        {
            "sprockets.chainring.teeth": chainring,
            "sprockets.cog.teeth": cog,
            "sprockets.cog.centre": [-centres, 0.0],
            "chain.links": links,
            "route.pretension": tension,
        }
        | changes
    )


def transmitting(
    rig: cd.Drive, teeth: tuple[int, int], links: int, power: float, rpm: float
) -> cd.Drive:
    """Let the rig transmit a power [W], with 15 N in both spans beside half the useful tension."""
    chainring, cog = teeth
    # P = T v,   v = z p n
    useful = power / (chainring * PITCH * rpm / 60)
    # M = T z p/2π in the mean over a tooth
    torque = useful * cog * PITCH / math.tau
    changes = {
        "sprockets.chainring.motion.speed": f"-{rpm} rpm",
        "sprockets.cog.load": [{"kind": "constant", "torque": torque}],
    }
    return tensioned(rig, teeth, links, useful / 2 + 15, **changes)


def worn(rig: cd.Drive, elongation: float) -> cd.Drive:
    """Lengthen the chain, and hold its tension by a carriage that a constant force pushes."""
    centres = cd.kinematics.centre_distance(53, 11, PITCH * (1 + elongation), 108)
    push = {"kind": "spring", "preload": 469.2, "stiffness": 1e4, "damping": 500.0}
    carrier = {"kind": "slider", "direction": [-1, 0], "mass": 5.0}
    return rig.replace(
        {
            "chain.elongation": elongation,
            "sprockets.cog.centre": [-centres, 0.0],
            "sprockets.cog.mass": 0.2,
            "sprockets.cog.support": {"kind": "tensioner", "name": "carriage"},
            "tensioners": [{"name": "carriage", "carrier": carrier, "push": push}],
            "route.adjust": {
                "kind": "sprocket",
                "name": "cog",
                "direction": [-1, 0],
                "within": 0.02,
            },
        }
    )


def inputs() -> dict[str, Any]:
    """Return ranges, draws and settings of the study."""
    return tomllib.loads(INPUTS.read_text(encoding="utf-8"))


def drawn(given: dict[str, Any], cases: int) -> tuple[dict[str, Any], Any]:
    """Return the common inputs by path (draws,), and the phases of the cases (draws, cases)."""
    ranges = [*given["common"].values(), *[given["each"]["route.phase"]] * cases]
    number, seed = given["draws"]["number"], given["draws"]["seed"]
    unit = qmc.LatinHypercube(len(ranges), rng=np.random.default_rng(seed)).random(number)
    low, high = np.transpose(ranges)
    plan = low + (high - low) * unit
    common = len(given["common"])
    return dict(zip(given["common"], plan[:, :common].T, strict=True)), plan[:, common:]


def cases(rig: cd.Drive) -> dict[tuple[str, str], tuple[cd.Drive, float | None]]:
    """Return the drives by case and hypothesis, each with half its useful tension [N].

    The second is None where the second span is as tense as the first.
    """
    pairs = {"M01": ((53, 11), 108), "M17 39/11": ((39, 11), 102), "M17 53/15": ((53, 15), 110)}
    found: dict[tuple[str, str], tuple[cd.Drive, float | None]] = {}
    for name, (teeth, links) in pairs.items():
        useful = 250.0 / (teeth[0] * PITCH * 95 / 60)
        found[name, "both"] = tensioned(rig, teeth, links, useful), None
        found[name, "one"] = transmitting(rig, teeth, links, 250.0, 95.0), useful / 2
    for name, elongation in (("M18 new", 0.0), ("M18 worn 1 %", 0.01)):
        found[name, "both"] = worn(rig, elongation), None
    racer = {(60, cog): f"M20 60/{cog}" for cog in (13, 16, 24)}
    for teeth, name in (racer | {(ring, 16): f"M20 {ring}/16" for ring in (58, 62)}).items():
        half = 225.0 / (teeth[0] * PITCH * 100 / 60)
        found[name, "one"] = transmitting(rig, teeth, 116, 450.0, 100.0), half
    return found


def runs() -> Iterator[dict[str, Any]]:
    """Run every case at every draw, and the first draw with half the step as well."""
    given = inputs()
    of = cases(cd.load(SCENE))
    common, phases = drawn(given, len(of))
    slack = common.pop("slack")
    for column, ((case, spans), (drive, half)) in enumerate(of.items()):
        count = given["draws"]["racer" if case.startswith("M20") else "number"]
        design = common | {"route.phase": phases[:, column]}
        if half is not None:
            design |= {"route.pretension": half + slack}
        settings = given["run"]
        halved = settings | {"step": "0.4 us"}
        for how, rows in ((settings, count), (halved, 0 if case.startswith("M20") else 1)):
            if not rows:
                continue
            plan = {path: values[:rows].tolist() for path, values in design.items()}
            found = cd.sweep(drive, design=plan, record=["energy_losses"], **how)
            assert not any(found["error"].to_numpy()), found["error"].to_numpy()
            for draw in range(rows):
                yield {
                    "case": case,
                    "spans": spans,
                    "draw": draw,
                    "step": how["step"],
                    "coefficient": f"{common['contact.joints.friction.coefficient'][draw]:.6f}",
                    "pin_diameter": f"{common['chain.joint.pin_diameter'][draw]:.6e}",
                    "pressure_factor": f"{common['chain.joint.pressure_factor'][draw]:.6f}",
                    "slack": f"{slack[draw]:.4f}" if half is not None else "",
                    "loss": f"{losses(found.isel(variant=draw)):.5f}",
                }


def write(told: Callable[[str], None] = print) -> None:
    """Run the study, and write every loss as soon as it is known."""
    with LOSSES.open("w", encoding="utf-8", newline="") as file:
        writer: Any = None
        for row in runs():
            if writer is None:
                writer = csv.DictWriter(file, list(row), lineterminator="\n")
                writer.writeheader()
            writer.writerow(row)
            file.flush()
            told(f"{row['case']}, {row['spans']}, draw {row['draw']}: {row['loss']} W")


def page(simulate: bool = False) -> dict[str, Any]:
    """Execute the tutorial, and return its names; what simulates only when asked for."""
    text = PAGE.read_text(encoding="utf-8")
    names: dict[str, Any] = {}
    with contextlib.chdir(PAGE.parent), contextlib.redirect_stdout(io.StringIO()):
        for cell in re.findall(r"```\{code-cell\} python\n(.*?)```", text, flags=re.DOTALL):
            # What has tags shows something, and computes nothing.
            if not cell.startswith(":") and (simulate or "cd.simulate(" not in cell):
                exec(compile(cell, PAGE.name, "exec"), names)
    return names


if __name__ == "__main__":
    write()
