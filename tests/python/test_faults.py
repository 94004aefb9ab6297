"""Thirty faults, each against a check: each is named by its reason. And presets, which have few."""

from typing import Any

import pytest
from drives import BARE

import chaindrive as cd

TWO = "marine_two_sprockets"
CRANK, CAM = "sprockets.crank", "sprockets.camshaft"
SHORT = {"until": 0.05, "every": 5e-4, "run_in": 0}
STEADY = {"until": 0.5, "every": 1e-3}


def load(torque: str) -> list[dict[str, str]]:
    return [{"kind": "constant", "torque": torque}]


def turning(speed: str) -> dict[str, str]:
    return {"kind": "constant", "speed": speed}


# Reason, preset, what is changed in it, and how it is run.
FAULTS: list[tuple[str, str, dict[str, Any], dict[str, Any]]] = [
    # Chains that would break.
    ("above-breaking-load", TWO, {"chain.breaking_load": "15 kN"}, SHORT),
    ("above-breaking-load", "industrial_16b", {"chain.breaking_load": "6 kN"}, STEADY),
    ("above-breaking-load", "bicycle", {"sprockets.rear.load": load("400 N m")}, SHORT),
    ("above-breaking-load", "marine_engine", {"chain.breaking_load": "30 kN"}, STEADY),
    # Motions that fight.
    (
        "motions-fight",
        TWO,
        {f"{CAM}.motion": turning("-140 rpm"), f"{CAM}.load": []},
        SHORT | {"until": 0.5},
    ),
    (
        "motions-fight",
        "industrial_16b",
        {"sprockets.driven.motion": turning("300 rpm"), "sprockets.driven.load": []},
        STEADY,
    ),
    # Loads with the wrong sign.
    ("load-drives", TWO, {f"{CAM}.load": load("-5 kN m")}, STEADY),
    ("load-drives", "industrial_16b", {"sprockets.driven.load": load("400 N m")}, STEADY),
    # Samples that alias the mesh.
    ("samples-rare", TWO, {}, {"until": 1.0, "every": 8e-3}),
    ("samples-rare", "industrial_16b", {}, {"until": 0.5, "every": 8e-3}),
    ("samples-rare", "bicycle", {}, {"until": 0.1, "every": 1e-2}),
    # Records that are too short for what forces them.
    ("statistics-unknown", "marine_engine", {}, {"until": 0.1, "every": 1e-3}),
    ("statistics-unknown", "bicycle_crank", {}, {"until": 0.1}),
    ("statistics-unknown", "timing_drive", {}, {"until": 0.02, "every": 1e-4}),
    # Errors that nobody estimated.
    ("not-estimated", TWO, {}, STEADY | {"error": False}),
    ("not-estimated", "industrial_16b", {}, STEADY | {"error": False, "method": "verlet"}),
    # Starts that are taken for steady.
    ("not-steady", "timing_drive", {}, {"until": 0.4, "every": 1e-4, "run_in": 0}),
    ("start-counts", "timing_drive", {}, {"until": 0.2, "every": 1e-4, "run_in": 0}),
    (
        "not-run-in",
        TWO,
        {
            f"{CAM}.load": [
                {"kind": "harmonic", "amplitude": "1 kN m", "order": 0.02},
                *load("10 kN m"),
            ],
            f"{CRANK}.motion.speed": "-300 rpm",
        },
        {"until": 0.01, "method": "verlet"},
    ),
    # Steps that are too long.
    ("accuracy-missed", "motorcycle", {}, {"until": 5e-3, "run_in": 0, "accuracy": 1e-5}),
    ("losses-uncertain", "motorcycle", {}, {"until": 0.1}),
    (
        "losses-wrong",
        "motorcycle",
        BARE,
        {"until": 1e-4, "every": 1e-5, "run_in": 0, "step": 2.2e-6},
    ),
    (
        "energy-missing",
        "bicycle",
        BARE | {"sprockets.chainring.motion.speed": "-5000 rpm"},
        {"until": 3e-3, "every": 1e-5, "run_in": 0, "method": "implicit-damping"},
    ),
    (
        "links-pressed",
        "marine_engine_bare",
        BARE,
        {"until": 0.2, "every": 1e-3, "run_in": 0.1, "step": 3.7e-5},
    ),
    (
        "too-short",
        "motorcycle",
        {},
        {"until": 1e-6, "every": 1e-6, "run_in": 0, "method": "implicit-damping"},
    ),
    # Contacts and spans beyond their laws.
    ("fast-impact", "marine_engine_bare", {}, STEADY),
    (
        "fast-impact",
        TWO,
        {f"{CRANK}.motion.speed": "-900 rpm"},
        {"until": 0.05, "every": 1e-4, "run_in": 0},
    ),
    (
        "span-not-held",
        TWO,
        {f"{CRANK}.motion.speed": "-500 rpm"},
        {"until": 0.02, "every": 2e-5, "run_in": 0},
    ),
    (
        "span-rarely-held",
        TWO,
        {f"{CRANK}.motion.speed": "-10000 rpm"},
        {"until": 0.02, "every": 2e-4, "run_in": 0},
    ),
]


def test_there_are_twenty_nine() -> None:
    assert len(FAULTS) == 29


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::chaindrive.VerdictWarning")
@pytest.mark.parametrize(
    ("reason", "preset", "changes", "settings"),
    FAULTS,
    ids=[f"{number} {reason}" for number, (reason, *_) in enumerate(FAULTS)],
)
def test_a_fault_is_named(
    reason: str, preset: str, changes: dict[str, Any], settings: dict[str, Any]
) -> None:
    drive = getattr(cd.scenes, preset)().replace(changes)
    run = cd.simulate(drive, **settings)
    assert run.attrs["verdict"] != "trusted"
    assert reason in run.attrs["reasons"].split(), run.attrs["verdict_note"]


# Limit, outcome, and what is changed in a drive.
WEAK: list[tuple[str, str, dict[str, Any]]] = [
    ("rated-power", "fail", {"chain.type": "80"}),
    ("out-of-line", "warning", {"sprockets.driven.lateral": "5 mm"}),
]


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::chaindrive.VerdictWarning")
@pytest.mark.parametrize(("limit", "outcome", "changes"), WEAK)
def test_a_limit_that_a_chain_exceeds_is_named(
    limit: str, outcome: str, changes: dict[str, Any]
) -> None:
    run = cd.simulate(cd.scenes.industrial_16b().replace(changes), **STEADY)
    assert run.attrs["chain_verdict"] == outcome
    assert limit in run.attrs["chain_reasons"].split(), run.attrs["chain_verdict_note"]


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::chaindrive.VerdictWarning")
@pytest.mark.parametrize("preset", cd.scenes.presets())
def test_presets_have_no_fault_but_those_that_they_are_known_for(preset: str) -> None:
    """The drive of the paper strikes fast, a motorcycle's steps are long."""
    known = {
        "marine_engine_bare": "fast-impact",
        "motorcycle": "losses-uncertain",
    }
    run = cd.simulate(getattr(cd.scenes, preset)())
    assert run.attrs["reasons"] == known.get(preset, "")
