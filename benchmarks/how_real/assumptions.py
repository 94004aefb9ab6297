"""The presets whose assumptions are tried, what is assumed in them, and in which ranges."""

import re
from dataclasses import dataclass
from typing import Any

import chaindrive as cd


@dataclass(frozen=True)
class Assumption:
    """A number that nobody has measured for this drive."""

    name: str
    #: Values by path of the scene, at the lower and the upper end of the range.
    ends: tuple[dict[str, Any], dict[str, Any]]
    #: The ends in words, and where they come from.
    range: str
    #: The measurement that would settle it.
    settled_by: str


@dataclass(frozen=True)
class Case:
    """A preset, how it is run, and what is assumed in it."""

    preset: str
    run_in: float
    until: float
    assumptions: tuple[Assumption, ...]
    #: Phases of the tooth at which replicates start.
    phases: tuple[float, ...] = (0.0, 0.34, 0.67)

    def shortened(self) -> "Case":
        """Return the case with runs that show nothing but that it runs."""
        return Case(self.preset, 0.0, 0.02 * self.until, self.assumptions[:2], self.phases[:2])


def at(path: str, low: Any, high: Any) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the ends of a range at one path."""
    return {path: low}, {path: high}


def scaled(preset: str, paths: list[str], low: float, high: float) -> tuple[dict, dict]:
    """Return ends as multiples of what the preset has, lists included."""

    def times(value: Any, factor: float) -> Any:
        if isinstance(value, list):
            return [times(item, factor) for item in value]
        return value * factor

    values = {path: found(preset, path) for path in paths}
    return tuple(
        {path: times(value, factor) for path, value in values.items()} for factor in (low, high)
    )


def scaled_at(preset: str, path: str, low: float, high: float | None = None) -> tuple[dict, dict]:
    """Return ends at one path as multiples; an absent upper one mirrors the lower."""
    return scaled(preset, [path], low, 2.0 - low if high is None else high)


def found(preset: str, path: str) -> Any:
    """Look up the number or numbers [SI] at a path of a preset, written out in full."""
    node: Any = getattr(cd.scenes, preset)().resolved().to_dict()
    for key in re.findall(r"[^.\[\]]+", path):
        if isinstance(node, list):
            named = [item for item in node if item.get("name") == key] if not key.isdigit() else []
            node = named[0] if named else node[int(key)]
        else:
            node = node[key]
    return node


def friction(spring: str = "spring-slider") -> tuple[dict[str, Any], dict[str, Any]]:
    """Return coefficients of oiled pins, from well oiled to starved."""
    path = "contact.joints.friction"
    return tuple({path: {"kind": spring, "coefficient": mu}} for mu in (0.05, 0.15))


PINS = "a pendulum that hangs on the chain over a sprocket: its decay is the friction of the pins"
DROP = "a roller dropped on an oiled tooth, 0.2 to 3 m/s"
PLUCK = "a plucked strand of the chain: the decay of its first modes along itself"
PULL = "a piece of the chain in a tensile test, from 1 to 10 % of its breaking load"


def cases() -> tuple[Case, ...]:
    """Return the presets with what is assumed in them."""
    return (
        Case(
            "marine_engine",
            1.0,
            1.0,
            (
                Assumption("friction of pins", friction(), "0.05 to 0.15", PINS),
                Assumption(
                    "restitution of teeth",
                    at("contact.teeth.restitution", 0.1, 0.8),
                    "0.1 to 0.8: drowned in oil to dry",
                    DROP,
                ),
                Assumption(
                    "damping of links", at("chain.damping_ratio", 0.0, 0.03), "0 to 0.03", PLUCK
                ),
                Assumption(
                    "stiffness of links",
                    scaled_at("marine_engine", "chain.stiffness", 0.8),
                    "± 20 %",
                    PULL,
                ),
                Assumption(
                    "pretension",
                    at("route.pretension", 10e3, 20e3),
                    "10 to 20 kN",
                    "the sag of a strand, or the length of the tensioner's spring",
                ),
                Assumption(
                    "inertia of the camshaft",
                    scaled_at("marine_engine", "sprockets.camshaft.inertia", 0.7),
                    "± 30 %",
                    "the drawing of the camshaft",
                ),
                Assumption(
                    "torque of pumps and valves",
                    scaled_at("marine_engine", "sprockets.camshaft.load[1].torques", 0.8),
                    "± 20 %",
                    "strain gauges on the camshaft",
                ),
                Assumption(
                    "orders of the crank",
                    scaled(
                        "marine_engine",
                        [f"sprockets.crank.motion.terms[{k}].amplitude" for k in (0, 1)],
                        0.0,
                        2.0,
                    ),
                    "none to twice",
                    "an encoder at the free end of the crankshaft",
                ),
                Assumption(
                    "damping of the tensioner",
                    scaled_at("marine_engine", "tensioners.tightener.push.damping", 0.5, 2.0),
                    "half to twice",
                    "a step of load on the tensioner alone",
                ),
            ),
        ),
        Case(
            "timing_drive",
            0.8,
            0.1,
            (
                Assumption("friction of pins", friction(), "0.05 to 0.15", PINS),
                Assumption(
                    "friction of guides",
                    tuple(
                        {"contact.guides.friction": {"coefficient": mu, "slip_speed": 0.1}}
                        for mu in (0.05, 0.15)
                    ),
                    "0.05 to 0.15",
                    "the torque to drag the chain over its guides",
                ),
                Assumption(
                    "restitution of teeth",
                    at("contact.teeth.restitution", 0.1, 0.9),
                    "0.1 to 0.9",
                    DROP,
                ),
                Assumption(
                    "damping of links", at("chain.damping_ratio", 0.0, 0.05), "0 to 0.05", PLUCK
                ),
                Assumption(
                    "stiffness of links",
                    scaled_at("timing_drive", "chain.stiffness", 0.8),
                    "± 20 %",
                    PULL,
                ),
                Assumption(
                    "torque of the valves",
                    scaled(
                        "timing_drive",
                        [f"sprockets.{name}.load[1].amplitude" for name in ("exhaust", "intake")],
                        0.7,
                        1.3,
                    ),
                    "± 30 %",
                    "strain gauges on a camshaft",
                ),
                Assumption(
                    "inertia of the camshafts",
                    scaled(
                        "timing_drive",
                        [f"sprockets.{name}.inertia" for name in ("exhaust", "intake")],
                        0.7,
                        1.3,
                    ),
                    "± 30 %",
                    "the drawing of the camshafts",
                ),
                Assumption(
                    "leakage gap of the plunger",
                    scaled_at("timing_drive", "tensioners.arm.push.oil.gap", 0.8),
                    "± 20 %",
                    "a leak-down test of the plunger",
                ),
                Assumption(
                    "viscosity of the oil",
                    scaled_at("timing_drive", "tensioners.arm.push.oil.viscosity", 0.5, 2.0),
                    "half to twice: 70 to 120 °C",
                    "the temperature of the oil",
                ),
                Assumption(
                    "spring of the plunger",
                    scaled_at("timing_drive", "tensioners.arm.push.preload", 0.7),
                    "± 30 %",
                    "the spring on a balance",
                ),
            ),
        ),
        Case(
            "industrial_16b",
            0.2,
            0.2,
            (
                Assumption("friction of pins", friction(), "0.05 to 0.15", PINS),
                Assumption(
                    "restitution of teeth",
                    at("contact.teeth.restitution", 0.1, 0.9),
                    "0.1 to 0.9",
                    DROP,
                ),
                Assumption(
                    "damping of links", at("chain.damping_ratio", 0.01, 0.05), "0.01 to 0.05", PLUCK
                ),
                Assumption(
                    "stiffness of links",
                    scaled_at("industrial_16b", "chain.stiffness", 0.8),
                    "± 20 %",
                    PULL,
                ),
                Assumption(
                    "pretension",
                    at("route.pretension", 0.5e3, 3e3),
                    "0.5 to 3 kN",
                    "the sag of the slack span at rest",
                ),
                Assumption(
                    "inertia of the driven machine",
                    scaled_at("industrial_16b", "sprockets.driven.inertia", 0.5, 2.0),
                    "half to twice",
                    "a run-down without load",
                ),
            ),
        ),
        Case(
            "bicycle",
            0.2,
            0.2,
            (
                Assumption("friction of pins", friction(), "0.05 to 0.15", PINS),
                Assumption(
                    "restitution of teeth",
                    at("contact.teeth.restitution", 0.1, 0.9),
                    "0.1 to 0.9",
                    DROP,
                ),
                Assumption(
                    "restitution of pins",
                    at("contact.joints.restitution", 0.1, 0.9),
                    "0.1 to 0.9",
                    DROP,
                ),
                Assumption(
                    "play of pins",
                    at("chain.joint.clearance", 10e-6, 50e-6),
                    "10 to 50 µm",
                    "the sideways shake of a pin under a microscope",
                ),
                Assumption("stiffness of links", at("chain.stiffness", 38e6, 57e6), "± 20 %", PULL),
                Assumption(
                    "pretension",
                    at("route.pretension", 30.0, 120.0),
                    "30 to 120 N",
                    "the sag of the lower run",
                ),
                Assumption(
                    "inertia of wheel and rider",
                    scaled_at("bicycle", "sprockets.rear.inertia", 0.5, 2.0),
                    "half to twice",
                    "a coast-down",
                ),
            ),
        ),
    )
