"""The cost of each law and model over the frictionless lumped model of the same kind."""

from dataclasses import dataclass, field
from typing import Any

import chaindrive as cd
from page import Page
from stepping import Stretch, in_turn

COULOMB = {"kind": "coulomb", "coefficient": 0.1}
LUGRE = {
    "kind": "lugre",
    "coefficient": 0.1,
    "static_coefficient": 0.12,
    "stiffness": 1e4,
}
#: Rollers that lie loose on their bushes, with the play of the pins twice.
FREE = {"chain.rollers": "free", "chain.roller": {"clearance": 50e-6}}


@dataclass(frozen=True)
class Feature:
    """Something that a drive may have, by the changes that bring it."""

    name: str
    changes: dict[str, Any]
    at_most: float | None = None
    """Largest cost that is wanted, over that of the drive without it [–]."""


@dataclass(frozen=True)
class Family:
    """A drive without friction, and what is added to it."""

    name: str
    drive: cd.Drive
    features: list[Feature] = field(default_factory=list)


def chain_of(drive: cd.Drive, model: str) -> cd.Drive:
    """Return the drive with nothing of its chain left but type and links, and another model."""
    scene = drive.to_dict()
    kept = {key: scene["chain"][key] for key in ("type", "links")}
    scene["chain"] = kept | {"model": model}
    scene["contact"].setdefault("joints", {})
    return cd.Drive.from_dict(scene)


def frictionless(drive: cd.Drive) -> cd.Drive:
    """Return the drive with joints that turn freely."""
    return drive.replace({"contact.joints.friction": {"kind": "none"}})


def families() -> list[Family]:
    """Return the drives and their features."""
    marine = cd.scenes.marine_engine_bare()
    bars = marine.to_dict()["guides"]
    for bar in bars:
        # At 5 mm, where bars along rollers lie, no static equilibrium is found with plates.
        bar["touches"] = "plates"
        bar["face"]["bow"] = "-10 mm"
    teeth, joints = "contact.teeth.friction", "contact.joints.friction"
    # Its chain is one of the catalogue, which says what joints and free rollers need.
    bicycle = cd.scenes.bicycle()
    default = {joints: {"kind": "spring-slider", "coefficient": 0.1}}
    johnson = {"kind": "johnson", "length": "50 mm", "clearance": "0.3 mm"}
    of_joints = [
        Feature("default friction in joints (spring and slider)", default, 1.25),
        Feature("Coulomb friction in joints", {joints: COULOMB}, 1.25),
        Feature("LuGre friction in joints", {joints: LUGRE}, 1.5),
        Feature("Coulomb friction on teeth", {teeth: COULOMB}, 1.25),
        Feature("LuGre friction on teeth", {teeth: LUGRE}, 1.5),
        Feature("free rollers", FREE, 2.0),
    ]
    return [
        Family(
            "particles, marine engine without guides",
            marine.replace({"guides": []}),
            [
                Feature("Coulomb friction on teeth", {teeth: COULOMB}, 1.25),
                Feature("LuGre friction on teeth", {teeth: LUGRE}, 1.5),
                Feature("Johnson's law on teeth", {"contact.teeth.law": johnson}, 1.3),
                Feature(
                    "compliance of the stack behind the teeth", {"contact.teeth.series": 4.37e9}
                ),
                Feature(
                    "three guide bars, 5 mm clear of the rollers",
                    {"guides": marine.to_dict()["guides"]},
                ),
                Feature("three guide bars, 10 mm clear of the plates", {"guides": bars}, 1.3),
            ],
        ),
        Family("particles, bicycle", frictionless(chain_of(bicycle, "particles")), list(of_joints)),
        Family(
            "clearance joints, bicycle",
            frictionless(bicycle),
            [*of_joints, Feature("ideal joints instead", {"chain.model": "ideal-joints"}, 1.0)],
        ),
    ]


def report(page: Page) -> None:
    """Write one table a family, and answer the targets of its features."""
    page.add(
        "## What models and laws cost",
        "",
        "Beside the frictionless lumped model of the same kind, in turn with it and the yardstick, "
        f"medians of {page.pairs} rounds. Each takes the step of its own stiffest mode: *per "
        "simulated second* is the cost of a step times the number of them.",
    )
    for family in families():
        features = family.features[:1] if page.quick else family.features
        drives = {"without": family.drive}
        refused = {}
        for feature in features:
            try:
                drives[feature.name] = family.drive.replace(feature.changes)
                Stretch(drives[feature.name], quick=True)
            except cd.ChaindriveError as error:
                refused[feature.name] = str(error).splitlines()[-1]
                drives.pop(feature.name, None)
        page.add(f"### {family.name[0].upper()}{family.name[1:]}", "")
        table(page, family, drives, refused)


def table(page: Page, family: Family, drives: dict[str, cd.Drive], refused: dict[str, str]) -> None:
    """Time the drives of a family in turn and write their table."""
    stretches = {name: Stretch(drive, page.quick) for name, drive in drives.items()}
    runs = {name: stretch.time for name, stretch in stretches.items()}
    found = in_turn(page.yardstick, runs, page.pairs)
    base, counts = found["without"], stretches["without"]
    rows = []
    for name, pairs in found.items():
        stretch = stretches[name]
        cost = pairs.over(base)
        more = stretch.steps_per_second / counts.steps_per_second
        rows.append(
            [
                name,
                f"{pairs.ns:.1f}",
                f"{pairs.faster:.2f}",
                f"{cost:.2f}",
                f"{stretch.steps_per_second:.3g}",
                f"{stretch.evaluations / stretch.steps:.2f}",
                f"{cost * more:.2f}",
            ]
        )
    page.table(
        [
            "with",
            "ns per link and step",
            "yardstick over it",
            "cost over that without",
            "steps per simulated s",
            "evaluations a step",
            "per simulated second, over that without",
        ],
        rows,
    )
    remarks = {name: f"refused, {text}" for name, text in refused.items()}
    remarks |= {name: it.remark for name, it in stretches.items() if it.remark}
    page.add(*(f"- {name}: {text}" for name, text in remarks.items()), "")
    for feature in family.features:
        if feature.at_most is None or feature.name not in found:
            continue
        cost = found[feature.name].over(base)
        page.target(
            f"{family.name}: {feature.name}, cost per link and step",
            f"≤ {feature.at_most:g} × without",
            f"{cost:.2f} ×",
            cost <= feature.at_most,
        )
