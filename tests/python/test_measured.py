"""Published measurements of losses: what the program says of them, agreement and miss alike."""

import math
from typing import Any

import numpy as np
import pytest
from published import PITCH, losses, page, tensioned, transmitting, worn
from verdicts import MeasuredCase

import chaindrive as cd

FRICTION = "contact.joints.friction.coefficient"
#: Ranges of what no source tells of a chain: friction of pins in bushes, of handbooks, and the
#: pressure around a pin, from that of a line to that of a pin which has worn in.
OPEN: dict[str, list[float]] = {
    FRICTION: [0.10, 0.15],
    "chain.joint.pressure_factor": [1.0, math.pi / 2],
}
FAST = {"error": False}
"""Numerical errors are estimated elsewhere."""


def corners(drive: cd.Drive, vary: dict[str, list[float]]) -> list[float]:
    """Power lost at every combination of values [W]."""
    stacked = cd.sweep(drive, vary, record=["energy_losses"])
    keys = [name for name in stacked["energy_losses"].dims if name not in ("time", "place")]
    variants = stacked.stack(variant=keys)
    return [losses(variants.isel(variant=i)) for i in range(variants.sizes["variant"])]


def foretold(case: MeasuredCase, what: str, name: str, spans: str) -> None:
    """Judge what the tutorial on published measurements foretells from one of them."""
    found, width = page()["foretold"][name, spans]
    told = {"both": "both spans tense", "one": "one span slack"}[spans]
    quantity = f"{what}, foretold by M01's chain A, {told}"
    case.number(quantity, found, interval=(found - width, found + width))


def efficiency(
    rig: cd.Drive, teeth: tuple[int, int], links: int, power: float, rpm: float
) -> float:
    """Efficiency of the rig that transmits a power [W]: [–]."""
    lost = losses(cd.simulate(transmitting(rig, teeth, links, power, rpm), **FAST))
    return power / (power + lost)


@pytest.mark.slow
def test_m01_loss_of_bicycle_chains() -> None:
    with MeasuredCase("M01") as case:
        rig = case.drive()
        found = losses(cd.simulate(rig, **FAST))
        powers = corners(rig, OPEN | {"chain.joint.pin_diameter": [3.5e-3, 3.7e-3]})
        hours = np.array(case.data["measured"]["hours"])
        for chain in "ABC":
            mean = np.mean(np.array(case.data["measured"][chain])[hours >= 1])
            quantity = f"loss of chain {chain}, mean of 1 to 8 h"
            row = case.row(quantity)
            assert row["expected"] == pytest.approx(mean, abs=1e-3)
            case.number(quantity, found, interval=(min(powers), max(powers)))


def derailed(
    rig: cd.Drive, cog: int, power: float, rpm: float, lateral: float = 0.0, **changes: Any
) -> cd.Drive:
    """Give the derailleur another cog, its pulleys as far from it, and a power [W] to transmit."""
    scene = rig.resolved().to_dict()
    scene["chain"].pop("links")
    ring, wheel, guide, tension = scene["sprockets"]
    cage = scene["tensioners"][0]["carrier"]
    down = np.subtract(guide["centre"], wheel["centre"])
    before, now = (PITCH / (2 * math.sin(math.pi / teeth)) for teeth in (wheel["teeth"], cog))
    moved = (now - before) * down / np.hypot(*down)
    for part, key in ((guide, "centre"), (tension, "centre"), (cage, "pivot")):
        part[key] = np.add(part[key], moved).tolist()
    for aside in (wheel, guide, tension):
        aside["lateral"] = lateral
    ring |= {"teeth": 52, "motion": {"kind": "constant", "speed": f"-{rpm} rpm"}}
    torque = power / (math.tau * rpm / 60 * 52 / cog)
    wheel |= {"teeth": cog, "load": [{"kind": "constant", "torque": torque}]}
    return cd.Drive.from_dict(scene, "derailed").replace(changes)


def by_place(drive: cd.Drive) -> dict[str, float]:
    """Mean power lost at every place [W]."""
    lost = cd.simulate(drive, record=["energy_losses"], **FAST)["energy_losses"]
    mean = (lost[-1] - lost[0]) / float(lost["time"][-1] - lost["time"][0])
    return {str(place): float(mean.sel(place=place)) for place in mean["place"].values}


#: What no source tells of a derailleur, each turned to its ends alone: by name the changes.
PULLEYS = ("sprockets.guide.bearing", "sprockets.tension.bearing")
OF_DERAILLEURS: dict[str, list[dict[str, Any]]] = {
    "bearings": [
        {key: {"kind": "torque", "torque": torque} for key in PULLEYS} for torque in (2e-4, 5e-3)
    ],
    "cage": [
        {"tensioners.cage.push.preload": -0.1 * pull, "route.pretension": pull}
        for pull in (5.0, 12.0)
    ],
    "offset": [{"lateral": 20e-3}],
}


@pytest.mark.slow
def test_m04_efficiency_over_tension_and_sprocket() -> None:
    with MeasuredCase("M04") as case:
        rig = case.drive().replace(
            {"chain.lateral.friction": 0.125} | dict(zip(OPEN, (0.125, 1.0), strict=True))
        )
        powers = [50.0, 100.0, 175.0]
        small = [by_place(derailed(rig, 11, power, 60)) for power in powers]
        middle, large = (by_place(derailed(rig, cog, 100.0, 60)) for cog in (15, 21))
        lost = [sum(it.values()) for it in small]
        shares = [power / (power + it) for power, it in zip(powers, lost, strict=True)]
        inverse = 1 / np.array(powers)  # as 1/T: the speed of the chain is the same
        correlation = float(np.corrcoef(inverse, shares)[0, 1])
        percent = ", ".join(f"{100 * it:.2f}" for it in shares)
        case.trend(
            "efficiency over 1/tension, 52 to 11 teeth",
            correlation < -0.95 and shares[0] < shares[1] < shares[2],
            f"{percent} % at 50, 100, 175 W; correlation {correlation:.3f}",
        )
        slope, intercept = np.polyfit(powers, lost, 1)
        parts = {place: np.polyfit(powers, [it[place] for it in small], 1)[1] for place in small[0]}
        off = max(abs(np.polyval([slope, intercept], powers) - lost)) / lost[-1]
        assert off < 0.02, off
        line = case.data["line"]
        assert intercept == pytest.approx(line["intercept"], abs=0.02), intercept
        assert slope == pytest.approx(line["slope"], rel=0.03), slope
        for place, part in parts.items():
            assert part == pytest.approx(line["parts"].get(place, 0.0), abs=0.02), place
        whole = [sum(it.values()) for it in (large, middle)]
        best, between = (100.0 / (100.0 + it) for it in whole)
        case.trend(
            "order of the rear sprockets",
            best > between > shares[1],
            f"{100 * best:.2f}, {100 * between:.2f}, {100 * shares[1]:.2f} %",
        )

        def points(**changes: Any) -> float:
            worst, good = (
                sum(by_place(derailed(rig, cog, 100.0, 60, **changes)).values()) for cog in (11, 21)
            )
            return worst - good  # of 100 W

        taken = points()
        corners = [
            points(**{FRICTION: friction, "chain.lateral.friction": friction, factor: pressure})
            for friction in OPEN[FRICTION]
            for factor in ["chain.joint.pressure_factor"]
            for pressure in OPEN[factor]
        ]
        low, high = min(corners), max(corners)
        for ends in OF_DERAILLEURS.values():
            by = [points(**changes) - taken for changes in ends]
            low, high = low + min(0.0, *by), high + max(0.0, *by)
        case.number(
            "efficiency of 52 to 21 less that of 52 to 11 teeth, 100 W",
            100 * (best - shares[1]),
            interval=(low, high),
        )


@pytest.mark.slow
def test_m17_small_sprockets_at_the_same_ratio() -> None:
    with MeasuredCase("M17") as case:
        rig = case.drive()

        pairs = []
        for teeth, links in (((39, 11), 102), ((53, 15), 110)):
            tension = 250 / (teeth[0] * PITCH * 95 / 60)
            drive = tensioned(rig, teeth, links, tension)
            pairs.append([losses(cd.simulate(drive, **FAST)), *corners(drive, OPEN)])
        found, *extra = np.subtract(*pairs)
        case.trend("order of the two pairs", found > 0 and min(extra) > 0, f"{found:+.2f} W")
        case.number(
            "loss of 39 to 11 less that of 53 to 15 teeth",
            found,
            interval=(min(extra), max(extra)),
        )
        foretold(case, "loss of 39 to 11 less that of 53 to 15 teeth", "M17", "both")
        foretold(case, "loss of 39 to 11 less that of 53 to 15 teeth", "M17", "one")


@pytest.mark.slow
def test_m18_worn_chains() -> None:
    with MeasuredCase("M18") as case:
        rig = case.drive()

        runs = [cd.simulate(worn(rig, it), **FAST) for it in (0.0, 0.005, 0.01)]
        for run in runs:
            tension = run["span_tension"].mean("time").to_numpy()
            assert np.all(abs(tension - 234.6) < 0.03 * 234.6), tension
        new, half, one = map(losses, runs)
        powers = corners(worn(rig, 0.0), OPEN)
        case.number("loss of a new chain", new, interval=(min(powers), max(powers)))
        foretold(case, "loss of a new chain", "M18 new", "both")
        foretold(case, "rise of the loss for 1 % of elongation", "M18 rise", "both")
        # Loss is nearly proportional to friction.
        needed = 0.125 * (new + 2.02) / one
        case.number(
            "rise of the loss for 1 % of elongation",
            one - new,
            f"The measured rise would take a friction of {needed:.2f} in the worn joints.",
        )
        case.trend(
            "sign of the change with elongation",
            new < half < one,
            f"{new:.2f}, {half:.2f}, {one:.2f} W at 0, 0.5, 1 %",
        )


@pytest.mark.slow
def test_m19_single_speed() -> None:
    with MeasuredCase("M19") as case:
        rig = case.drive()
        found = efficiency(rig, (52, 15), 108, 250.0, 90)
        drive = transmitting(rig, (52, 15), 108, 250.0, 90)
        useful = 250.0 / (52 * PITCH * 90 / 60)
        powers = corners(drive, OPEN | {"route.pretension": [useful / 2, useful / 2 + 50]})
        least, most = (100 * 250 / (250 + it) for it in (max(powers), min(powers)))
        case.number("efficiency", 100 * found, interval=(least, most))


@pytest.mark.slow
def test_m20_sprockets_of_a_racer() -> None:
    with MeasuredCase("M20") as case:
        rig = case.drive()
        cogs = [efficiency(rig, (60, cog), 116, 450.0, 100) for cog in (13, 16, 24)]
        rings = [efficiency(rig, (ring, 16), 116, 450.0, 100) for ring in (58, 62)]
        case.trend(
            "order of the sprockets, chainring of 60",
            cogs[0] < cogs[1] < cogs[2],
            ", ".join(f"{100 * it:.2f}" for it in cogs) + " % with 13, 16, 24 teeth",
        )
        useful = 450 / (60 * PITCH * 100 / 60)
        slack = [
            corners(
                transmitting(rig, (ring, 16), 116, 450.0, 100),
                {"route.pretension": [useful * 30 / ring + 5, useful * 30 / ring + 30]},
            )
            for ring in (58, 62)
        ]
        signs = ", ".join(f"{it:+.3f} W" for it in np.subtract(slack[1], slack[0]))
        by_ring, by_cog = abs(rings[1] - rings[0]), cogs[2] - cogs[0]
        case.trend(
            "chainring against sprocket",
            by_ring < 0.2 * by_cog,
            f"{100 * by_ring:.3f} points from 58 to 62, {100 * by_cog:.2f} from 13 to 24 teeth; "
            f"62 against 58 with 5 and 30 N of slack tension: {signs}",
        )
