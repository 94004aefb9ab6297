"""The words that settings take, for editors and type checkers.

>>> import chaindrive as cd
>>> quick: cd.settings.RunSettings = {"until": 2e-3, "every": 1e-3, "method": "verlet"}
>>> cd.simulate(cd.scenes.spinning_ring(), **quick).attrs["method"]
'verlet'

They are those of the core: a test compares them.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal, TypeAlias, TypedDict

from chaindrive.quantity import Measured

__all__ = [
    "ChainModel",
    "ChannelName",
    "ContactPlace",
    "DissipationKind",
    "FrictionKind",
    "LawKind",
    "MethodName",
    "Quantity",
    "Recorded",
    "RunSettings",
    "Target",
]

Quantity: TypeAlias = float | str | Measured
"""A number in SI units, a text with a unit such as ``"20 ms"``, or a `pint.Quantity`."""

MethodName: TypeAlias = Literal[
    "auto",
    "verlet",
    "rk4",
    "dormand-prince",
    "implicit-damping",
    "generalized-alpha",
]
"""Methods of time stepping, see `simulate`."""

Target: TypeAlias = Literal["tension", "losses", "impacts"]
"""Quantities that an accuracy can be one of."""

ContactPlace: TypeAlias = Literal["teeth", "guides", "joints"]
"""Contacts that a run can log."""

ChainModel: TypeAlias = Literal["particles", "bush-strands", "ideal-joints", "clearance-joints"]
"""Models of a chain, ``chain.model`` of a scene."""

ChannelName: TypeAlias = Literal[
    "span_tension",
    "link_tension",
    "strand_tension_max",
    "strand_tension_min",
    "link_angle",
    "joint_force",
    "joint_force_x",
    "joint_force_y",
    "joint_depth",
    "joint_offset_x",
    "joint_offset_y",
    "joint_angle",
    "bush_force",
    "bush_force_x",
    "bush_force_y",
    "bush_depth",
    "bush_offset_x",
    "bush_offset_y",
    "film_thickness",
    "contact_force",
    "contact_depth",
    "contacts",
    "roller_x",
    "roller_y",
    "roller_vx",
    "roller_vy",
    "sprocket_angle",
    "sprocket_speed",
    "sprocket_torque",
    "sprocket_force_x",
    "sprocket_force_y",
    "centre_force_x",
    "centre_force_y",
    "support_force_x",
    "support_force_y",
    "sprocket_x",
    "sprocket_y",
    "shaft_angle",
    "shaft_speed",
    "coupling_torque",
    "guide_force_x",
    "guide_force_y",
    "tensioner_position",
    "tensioner_force",
    "carrier_force_x",
    "carrier_force_y",
    "oil_pressure",
    "energy_kinetic",
    "energy_stored",
    "energy_dissipated",
    "energy_supplied",
    "energy_residual",
    "energy_stores",
    "energy_flows",
    "energy_losses",
]
"""Quantities that a run can record, see `channels`."""

Recorded: TypeAlias = ChannelName | Literal["all"]
"""A channel, or all that the chain has."""

LawKind: TypeAlias = Literal[
    "linear",
    "power",
    "hertz",
    "johnson",
    "conformal",
    "radzimovsky",
    "esdu-78035",
    "dubowsky-freudenstein",
    "cylindrical",
]
"""Elastic parts of contact laws, see `law`."""

DissipationKind: TypeAlias = Literal[
    "none",
    "viscous",
    "exact",
    "hunt-crossley",
    "lankarani-nikravesh",
    "lee-wang",
    "herbert-mcwhannell",
    "gonthier",
    "zhiying-qishao",
    "flores",
    "hu-guo",
]
"""Dissipations of contact laws, see `law`."""

FrictionKind: TypeAlias = Literal[
    "none",
    "coulomb",
    "ambrosio",
    "threlfall",
    "bengisu-akay",
    "brown-mcphee",
    "lugre",
    "spring-slider",
    "stribeck",
]
"""Friction laws, see `friction`."""


class RunSettings(TypedDict, total=False):
    """Settings of a run that `simulate` takes by name; see there."""

    until: Quantity
    run_in: Quantity
    every: Quantity
    method: MethodName
    step: Quantity
    tolerance: Quantity
    onset_depth: Quantity
    accuracy: Quantity
    accuracy_of: Target
    record: Recorded | Iterable[Recorded]
    events: ContactPlace | Iterable[ContactPlace]


def __dir__() -> list[str]:
    return list(__all__)
