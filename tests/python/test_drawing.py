"""Drawings: what is measured in them is what the simulation has.

Gaps are measured in the text of the SVG files, between circles and paths of straight lines and arcs,
by formulas of their own. The simulation says which rollers press on teeth, how deep the deepest is,
and through `Drive.profile` how far the others are from teeth and guides that stood elsewhere when
the run began.
"""

import json
import random
import re
import subprocess
import sys

import numpy as np
import pytest

import chaindrive as cd
from drives import random_drive

# Agreement asked for [m].
ALLOWED = 1e-4
# Coordinates have four digits behind the point of a millimetre; both ends of a distance round.
DIGITS = 2e-7

_TOKEN = re.compile(r"[MLAZ]|-?[0-9.]+(?:e-?[0-9]+)?")


def part(svg, kind, name):
    """Return the attributes of the element with this id."""
    found = re.search(rf'<(\w+) id="{re.escape(kind)}-{re.escape(name)}" ([^>]*)/>', svg)
    assert found, f"{kind}-{name}"
    return dict(re.findall(r'([\w-]+)="([^"]*)"', found[2]))


def rollers(svg, chain=""):
    """Return centres (n, 2) and radius of the rollers of a chain [m]."""
    circles = re.findall(
        rf'<circle id="roller-{chain}(\d+)" class="roller" cx="([^"]+)" cy="([^"]+)" r="([^"]+)"/>',
        svg,
    )
    numbers = np.array(circles, dtype=float)
    assert (numbers[:, 0] == np.arange(len(numbers))).all()
    return 1e-3 * numbers[:, 1:3], 1e-3 * numbers[0, 3]


def pieces(path):
    """Return the lines and arcs of path data [m]: (start, end, radius or None, counter-clockwise)."""
    tokens = _TOKEN.findall(path)
    found, here, first = [], None, None
    at = 0

    def numbers(count):
        nonlocal at
        values = [float(token) for token in tokens[at : at + count]]
        at += count
        return values

    while at < len(tokens):
        command = tokens[at]
        at += 1
        if command == "M":
            here = first = 1e-3 * np.array(numbers(2))
        elif command == "L":
            end = 1e-3 * np.array(numbers(2))
            found.append((here, end, None, True))
            here = end
        elif command == "A":
            radius, _, _, large, turn, x, y = numbers(7)
            assert large == 0
            end = 1e-3 * np.array([x, y])
            found.append((here, end, 1e-3 * radius, turn == 1))
            here = end
        else:
            found.append((here, first, None, True))
            here = first
    return found


def distances(path, places):
    """Return the distances of places (n, 2) from the curve of path data [m]."""
    nearest = np.full(len(places), np.inf)
    for start, end, radius, left in pieces(path):
        chord = end - start
        length = np.hypot(*chord)
        if length == 0:
            continue
        if radius is None:
            along = np.clip((places - start) @ chord / length**2, 0, 1)
            away = places - (start + along[:, None] * chord)
            nearest = np.minimum(nearest, np.hypot(*away.T))
            continue
        # Of the two centres the one that lies left of the chord, for a short arc to the left.
        radius = max(radius, length / 2)
        side = np.array([-chord[1], chord[0]]) / length * (1 if left else -1)
        centre = (start + end) / 2 + side * np.sqrt(radius**2 - length**2 / 4)
        away = places - centre
        middle = (start + end) / 2 - centre
        if np.hypot(*middle) < 1e-9 * radius:
            middle = -side
        middle = middle / np.hypot(*middle)
        half = np.arcsin(min(length / (2 * radius), 1.0))
        angle = np.arccos(np.clip(away @ middle / np.hypot(*away.T), -1, 1))
        within = angle <= half
        to_ends = np.minimum(np.hypot(*(places - start).T), np.hypot(*(places - end).T))
        to_arc = np.abs(np.hypot(*away.T) - radius)
        nearest = np.minimum(nearest, np.where(within, to_arc, to_ends))
    return nearest


def turned(places, angle, about):
    rotation = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    return (places - about) @ rotation.T + about


class Carrier:
    """How a tensioner moves points, from the resolved scene alone."""

    def __init__(self, drive, run, name):
        tensioners = drive.resolved().to_dict()["tensioners"]
        self.carrier = next(it for it in tensioners if it["name"] == name)["carrier"]
        self.position = run["tensioner_position"].sel(tensioner=name)

    def back(self, places, index):
        """Return places (n, 2) of a sample as a carrier sees them that stands as at the start."""
        moved = float(self.position[index] - self.position[0])
        if self.carrier["kind"] == "arm":
            return turned(places, -moved, np.array([metres(it) for it in self.carrier["pivot"]]))
        direction = np.array([float(it) for it in self.carrier["direction"]])
        return places - moved * direction / np.hypot(*direction)


def metres(value):
    if isinstance(value, (int, float)):
        return float(value)
    number, _, unit = value.partition(" ")
    return float(number) * {"m": 1.0, "mm": 1e-3, "": 1.0}[unit]


def check(drive, *, samples=20, until=None):
    """Compare a drive's drawings with its simulation at some instants of a short run."""
    wanted = ["contact_force", "contact_depth", "roller_x", "roller_y", "guide_force_x"]
    wanted += ["guide_force_y", "sprocket_angle", "sprocket_x", "sprocket_y", "tensioner_position"]
    until = until or min(drive.run_defaults()["until"], 5e-3)
    run = cd.simulate(drive, until=until, every=until / (samples - 1), record=wanted, accuracy=None)
    assert run.sizes["time"] >= samples
    scene = drive.resolved().to_dict()
    chains = drive.chains or {"": drive.links}
    names = [f"{name}-" if name else "" for name in chains]
    profiles = {name: drive.profile(name) for name in [*drive.sprockets, *drive.guides]}
    shoes = {guide["name"]: guide for guide in scene.get("guides", [])}
    worst = {"depth": 0.0, "pressing": 0.0, "open": 0.0}
    counted = 0
    for index in range(samples):
        svg = cd.plot.svg(run, float(run["time"][index]), drive=drive)
        now = run.isel(time=index)
        first = 0
        deepest = dict.fromkeys(drive.sprockets, 0.0)
        for chain, name in zip(figure_chains(drive), names, strict=True):
            centres, radius = rollers(svg, name)
            force = now["contact_force"].values[first : first + len(centres)]
            first += len(centres)
            touched = np.zeros(len(centres), dtype=bool)
            for sprocket in (drive.sprockets[it] for it in chain["sprockets"]):
                gaps = distances(part(svg, "sprocket", sprocket)["d"], centres) - radius
                deepest[sprocket] = max(deepest[sprocket], -gaps.min())
                touched |= gaps < 0
                # Gaps of the same rollers to the teeth as they stood at the start.
                there = [
                    np.array(
                        [run[f"sprocket_{axis}"].sel(sprocket=sprocket)[at] for axis in "xy"],
                        dtype=float,
                    )
                    for at in (0, index)
                ]
                angle = run["sprocket_angle"].sel(sprocket=sprocket)
                angle = float(angle[index] - angle[0])
                seen = turned(centres - there[1] + there[0], -angle, there[0])
                expected = profiles[sprocket].distance(seen) - radius
                near = gaps < chain["pitch"]
                worst["open"] = max(worst["open"], np.abs(gaps - expected)[near].max(initial=0.0))
                counted += int(near.sum())
            # A roller presses where it overlaps, to rounding; both ways.
            gaps = np.min(
                [
                    distances(part(svg, "sprocket", drive.sprockets[it])["d"], centres)
                    for it in chain["sprockets"]
                ]
                or [np.full(len(centres), 1.0)],
                axis=0,
            )
            gaps = gaps - radius
            worst["pressing"] = max(
                worst["pressing"],
                gaps[force > 0].max(initial=0.0),
                -gaps[(force == 0)].min(initial=0.0),
            )
            for guide in (drive.guides[it] for it in chain["guides"]):
                face = part(svg, "guide", guide)["d"]
                support = shoes[guide].get("support", {"kind": "fixed"})
                seen = centres
                if isinstance(support, dict) and support["kind"] == "tensioner":
                    seen = Carrier(drive, run, support["name"]).back(centres, index)
                elif isinstance(support, dict) and support["kind"] != "fixed":
                    continue
                drawn = distances(face, centres)
                expected = np.abs(profiles[guide].distance(seen))
                near = drawn < 3 * chain["pitch"]
                worst["open"] = max(worst["open"], np.abs(drawn - expected)[near].max(initial=0.0))
                counted += int(near.sum())
        for sprocket, depth in deepest.items():
            said = float(now["contact_depth"].sel(sprocket=sprocket))
            worst["depth"] = max(worst["depth"], abs(max(depth, 0.0) - max(said, 0.0)))
    return worst, counted


def figure_chains(drive):
    return drive._inner.figure(False, 0.0).chains


# Every preset stands in one of the two lists; the second takes minutes to assemble and run.
QUICK = [
    "chain_pendulum",
    "hanging_chain",
    "industrial_16b",
    "marine_engine",
    "marine_two_sprockets",
    "pendulum_in_bush",
    "pin_in_bush",
    "spinning_ring",
    "timing_drive",
    "two_stage_timing",
]
SLOW = ["bicycle", "bicycle_crank", "bicycle_slack", "marine_engine_bare", "motorcycle"]
LOTS = range(20)


def test_every_preset_is_drawn_and_measured():
    assert sorted([*QUICK, *SLOW]) == sorted(name for name, _ in cd.scenes.presets().items())


@pytest.mark.parametrize(
    "name", [*QUICK, *(pytest.param(name, marks=pytest.mark.slow) for name in SLOW)]
)
def test_gaps_in_drawings_of_presets_are_those_of_the_simulation(name):
    drive = getattr(cd.scenes, name)()
    worst, counted = check(drive)
    print(f"{name}: {worst} of {counted}")
    assert max(worst.values()) < DIGITS, worst
    assert counted > 20 or not drive.sprockets


@pytest.mark.parametrize(
    "seed", [*LOTS[:6], *(pytest.param(seed, marks=pytest.mark.slow) for seed in LOTS[6:])]
)
def test_gaps_in_drawings_of_drives_by_lot_are_those_of_the_simulation(seed):
    worst, counted = check(random_drive(seed))
    print(f"lot {seed}: {worst} of {counted}")
    assert max(worst.values()) < DIGITS, worst
    assert counted > 200
