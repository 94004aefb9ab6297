"""The parts of the drive that a run was made of: chains and sprockets, from its resolved scene."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from chaindrive.analysis.signal import recorded
from chaindrive.chain_catalogue import catalogue
from chaindrive.errors import ParameterError

__all__ = [
    "ChainParts",
    "SprocketParts",
    "chains",
    "circuits",
    "one_chain",
    "places",
    "rollers_of",
    "sprockets",
]

_Floats = NDArray[np.float64]


@dataclass(frozen=True)
class ChainParts:
    """A chain of a run: its links among all of the run, and what its joints are made of."""

    name: str
    """Its name; empty where there is one chain only."""
    first: int
    """Number of its first link in the run."""
    links: int
    """Number of links."""
    closed: bool
    """Whether it is an endless chain; an open strand has one roller more than links."""
    scene: Mapping[str, Any]
    """Its table in the resolved scene, in SI units."""
    route: Mapping[str, Any]
    """Its route in the resolved scene."""
    joints: Mapping[str, Any]
    """The contact of pins and bushes in the resolved scene."""

    @property
    def pitch(self) -> float:
        """Nominal pitch [m]."""
        return float(self.scene["pitch"])

    @property
    def rollers(self) -> int:
        """Number of rollers."""
        return self.links if self.closed else self.links + 1

    @property
    def mass_per_length(self) -> float:
        """Mass a length [kg/m]."""
        table = self.scene
        if "mass" in table:
            return float(table["mass"]) / self.pitch
        if "masses" in table:
            return float(np.mean(table["masses"])) / self.pitch
        links = sum(float(table[kind]["mass"]) for kind in ("inner", "outer") if kind in table) / 2
        return (links + float(table.get("roller", {}).get("mass", 0.0))) / self.pitch

    @property
    def title(self) -> str:
        """Words for messages."""
        return f"chain {self.name!r}" if self.name else "the chain"

    @property
    def entry(self) -> xr.Dataset | None:
        """Its entry of the catalogue; None where the scene names none."""
        kind = self.scene.get("type")
        return None if kind is None else catalogue().sel(chain=kind)

    def pin_diameter(self, given: float | None = None) -> float:
        """Return the diameter of the pins [m]: as given, or as in the scene."""
        if given is None:
            given = self.scene.get("joint", {}).get("pin_diameter")
        if given is None:
            raise ParameterError(
                f"{self.title} has no pin diameter in its scene: give pin_diameter= [m], "
                "or name a chain of the catalogue, `type`",
                "pin_diameter",
            )
        return _positive(given, "pin_diameter")

    def bush_length(self, given: float | None = None) -> float:
        """Return the length of the bushes, in which the pins bear [m].

        As given, as `joint.length` of the scene, or of the catalogue: the space between the inner
        plates and these plates, b₁ + 2 t, which is how catalogues count the bearing area.
        """
        if given is None:
            given = self.scene.get("joint", {}).get("length")
        entry = self.entry
        if given is None and entry is not None:
            given = float(entry["inner_width"] + 2 * entry["inner_plate"])
        if given is None or math.isnan(given):
            raise ParameterError(
                f"the bushes of {self.title} have no length in its scene: give bush_length= [m], "
                "the inner width and both inner plates, or name a chain of the catalogue, `type`",
                "bush_length",
            )
        return _positive(given, "bush_length")

    def bearing_area(self, diameter: float | None = None, length: float | None = None) -> float:
        """Return the area on which pins bear on bushes [m²]: n d b, of all n strands."""
        strands = int(self.scene.get("strands") or 1)
        return strands * self.pin_diameter(diameter) * self.bush_length(length)

    @property
    def joint_friction(self) -> Mapping[str, Any]:
        """Friction of pins in bushes, as the scene has it; empty without."""
        own: Mapping[str, Any] | None
        own = self.scene.get("joint", {}).get("contact", {}).get("friction")
        return own or self.joints.get("friction", {})

    def friction(self) -> float:
        """Return friction over force of pins in bushes [–], zero without friction.

        Of a lubricated pin it is that of boundary friction.
        """
        factor = float(self.scene.get("joint", {}).get("pressure_factor", 1.0))
        return factor * float(self.joint_friction.get("coefficient", 0.0))

    @property
    def clearance(self) -> float:
        """Radial play of pins in bushes [m], zero where the model has none."""
        return float(self.scene.get("joint", {}).get("clearance", 0.0))


@dataclass(frozen=True)
class SprocketParts:
    """A sprocket of a run, and the chain that passes it."""

    name: str
    teeth: int
    chain: ChainParts
    side: int
    """+1 where the chain, along its route, passes it counter-clockwise, or −1."""
    centre: tuple[float, float]
    """Its centre [m] as the scene has it, before anything is adjusted."""
    stands: bool
    """Whether it stands there during the run."""
    restitution: float | None
    """Restitution of rollers on its teeth [–], as asked for in the scene; None where a film of oil
    or viscous damping takes its place."""
    scene: Mapping[str, Any]
    """Its table in the resolved scene, in SI units."""

    @property
    def pitch_radius(self) -> float:
        """Pitch radius [m]."""
        return self.chain.pitch / (2.0 * math.sin(math.pi / self.teeth))

    def centres(self, run: xr.Dataset) -> tuple[_Floats, _Floats]:
        """Return its centre over time, x and y [m], each (time,) or ()."""
        if "sprocket_x" in run and "sprocket_y" in run:
            own = run.sel(sprocket=self.name)
            return own["sprocket_x"].to_numpy(), own["sprocket_y"].to_numpy()
        if not self.stands:
            recorded(run, "sprocket_x", "sprocket_y")
        return np.asarray(self.centre[0]), np.asarray(self.centre[1])

    def polar(self, run: xr.Dataset) -> tuple[_Floats, _Floats]:
        """Return radius [m] and angle [rad] of the rollers about it, each (time, roller)."""
        x, y = places(run, self.chain)
        centre_x, centre_y = self.centres(run)
        x, y = x - centre_x[..., None], y - centre_y[..., None]
        return np.hypot(x, y), np.arctan2(y, x)

    def reach(self, run: xr.Dataset) -> float:
        """Return the radius [m] within which rollers lie on it."""
        x, y = places(run.isel(time=slice(0, 1)), self.chain)
        steps = np.hypot(np.diff(x[0]), np.diff(y[0]))
        # A worn chain rides higher, in the measure in which it is longer.
        circle = self.pitch_radius * max(1.0, float(steps.mean()) / self.chain.pitch)
        # Half a pitch along the tangent a roller is p²/8R outside the circle on which it rides.
        return circle + self.chain.pitch**2 / (8.0 * circle)


def chains(run: xr.Dataset) -> list[ChainParts]:
    """Return the chains of a run, in the order of its scene."""
    scene = _scene(run)
    tables = scene["chains"] if "chains" in scene else [scene["chain"]]
    joints = scene.get("contact", {}).get("joints", {})
    found: list[ChainParts] = []
    first = 0
    for table in tables:
        chain = ChainParts(
            name=table.get("name", "") if "chains" in scene else "",
            first=first,
            links=int(table["links"]),
            closed="ends" not in table,
            scene=table,
            route=table.get("route") or scene.get("route", {}),
            joints=joints,
        )
        found.append(chain)
        first += chain.links
    return found


def one_chain(run: xr.Dataset, name: str | None) -> ChainParts:
    """Return the chain of a name, or the only one."""
    known = chains(run)
    if name is None and len(known) == 1:
        return known[0]
    names = ", ".join(repr(chain.name) for chain in known)
    for chain in known:
        if chain.name == name:
            return chain
    asked = "say which one is meant" if name is None else f"there is no chain {name!r}"
    raise ParameterError(f"{asked}: chain= one of {names}", "chain")


def sprockets(run: xr.Dataset) -> dict[str, SprocketParts]:
    """Return the sprockets that chains pass, by name, in the order of routes."""
    scene = _scene(run)
    tables = {table["name"]: table for table in scene.get("sprockets", [])}
    found: dict[str, SprocketParts] = {}
    for chain in chains(run):
        stops = chain.route.get("stops", list(tables))
        moved = chain.route.get("adjust", {}).get("kind", "nothing") != "nothing"
        for stop in stops:
            if stop not in tables:
                continue
            table = tables[stop]
            fixed = table.get("support", {}).get("kind", "fixed") == "fixed"
            found[stop] = SprocketParts(
                name=stop,
                teeth=int(table["teeth"]),
                chain=chain,
                side=-1 if table.get("side", "left") == "right" else 1,
                centre=(float(table["centre"][0]), float(table["centre"][1])),
                stands=fixed and not moved and "path" not in table,
                restitution=_restitution(scene, table),
                scene=table,
            )
    return found


def places(run: xr.Dataset, chain: ChainParts) -> tuple[_Floats, _Floats]:
    """Return the places of a chain's rollers, x and y [m], each (time, roller)."""
    recorded(run, "roller_x", "roller_y")
    own = rollers_of(run, chain)
    x, y = run["roller_x"].isel(roller=own), run["roller_y"].isel(roller=own)
    return (
        x.transpose("time", "roller").to_numpy().astype(float),
        y.transpose("time", "roller").to_numpy().astype(float),
    )


def rollers_of(run: xr.Dataset, chain: ChainParts) -> slice:
    """Return which rollers of a run are those of a chain."""
    # With several chains, open strands before this one have a roller more than links.
    before = sum(other.rollers for other in chains(run) if other.first < chain.first)
    return slice(before, before + chain.rollers)


def circuits(run: xr.Dataset, chain: ChainParts) -> float:
    """Return how often a chain has gone around during a run [–]; strands have none."""
    turned = [it for it in sprockets(run).values() if it.chain.name == chain.name]
    if not turned or not chain.closed:
        return 0.0
    recorded(run, "sprocket_angle")
    angle = run["sprocket_angle"].sel(sprocket=turned[0].name).to_numpy()
    return abs(float(angle[-1] - angle[0])) * turned[0].teeth / (2 * math.pi * chain.links)


def _scene(run: xr.Dataset) -> dict[str, Any]:
    text = run.attrs.get("resolved_scene")
    if text is None:
        raise ParameterError(
            "the dataset has no attribute resolved_scene: it is not a run of chaindrive",
            "resolved_scene",
        )
    return tomllib.loads(text)


def _restitution(scene: Mapping[str, Any], sprocket: Mapping[str, Any]) -> float | None:
    # The contact of a sprocket goes before that of all teeth.
    for contact in (sprocket.get("contact", {}), scene.get("contact", {}).get("teeth", {})):
        if "film" in contact or "damping" in contact:
            return None
        if contact.get("dissipation") == "none":
            return 1.0
        if "restitution" in contact:
            return float(contact["restitution"])
    return None


def _positive(value: float, name: str) -> float:
    if not value > 0.0:
        raise ParameterError(f"{name} = {value}, must be positive [m]", name)
    return float(value)
