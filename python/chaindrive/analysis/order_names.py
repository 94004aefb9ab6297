"""Names of orders: meshes, chain loops, turns of sprockets, what torques and motions repeat."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
import xarray as xr

from chaindrive.analysis.parts import SprocketParts, sprockets
from chaindrive.analysis.signal import turning
from chaindrive.errors import ParameterError

__all__ = ["order_names"]

#: Multiples of a mesh that are named.
_MULTIPLES = (1, 2, 3)
#: Orders of a table over the angle that are named: the strongest, from this share of it on.
_STRONG = 0.5
#: Orders nearer than this are one [–].
_ONE = 1e-6


def order_names(run: xr.Dataset, shaft: str) -> dict[float, str]:
    """Return the names of orders of a shaft that are known from the scene.

    ::

        mesh z ω/Ω,    turn ω/Ω,    chain loop z ω/(n Ω),    torque or motion k ω/Ω

    z and ω are the teeth and the mean speed of a sprocket, n the links of its chain, k an order of
    a torque, Ω the mean speed of the shaft.

    Parameters
    ----------
    run
        A run with ``sprocket_angle``, or ``shaft_angle`` of the shaft.
    shaft
        Sprocket or shaft whose turns count.

    Returns
    -------
    dict
        Names by order [–], rising; things at one order share a name: ``"turn of crank, camshaft"``.

    Raises
    ------
    ParameterError
        The shaft is not in the run, or its angle was not recorded.

    Examples
    --------
    >>> import chaindrive as cd
    >>> run = cd.simulate(cd.scenes.industrial_16b(), until=0.01, run_in=0, error=False)
    >>> cd.analysis.order_names(run, "driver")[19.0]
    'mesh, 19 teeth of driver'
    """
    found: dict[str, float] = {}
    known = sprockets(run)
    ratios = _ratios(run, known, shaft)
    several = len({it.chain.name for it in known.values()}) > 1
    for chain in {it.chain.name: it.chain for it in known.values()}.values():
        own = {name: it for name, it in known.items() if it.chain.name == chain.name}
        name = shaft if shaft in own else next(iter(own))
        if name not in ratios:
            continue
        of = f" of {chain.name}" if several else ""
        mesh = own[name].teeth * ratios[name]
        for multiple in _MULTIPLES:
            teeth = f", {own[name].teeth} teeth of {name}"
            words = f"mesh{of}{teeth}" if multiple == 1 else f"{multiple} × mesh{of}"
            found[words] = multiple * mesh
        found[f"chain loop{of}"] = mesh / chain.links
    turns: dict[float, list[str]] = {}
    for name, ratio in ratios.items():
        turns.setdefault(round(ratio, 9), []).append(name)
    for ratio, names in turns.items():
        found[f"turn of {', '.join(names)}"] = ratio
    for words, of, order in _acting(known):
        if of in ratios:
            found[words] = order * ratios[of]
    named: dict[float, str] = {}
    for words, order in sorted(found.items(), key=lambda it: it[1]):
        last = next(reversed(named), None)
        if last is not None and order - last <= _ONE * max(order, 1.0):
            named[last] += f"; {words}"
        else:
            named[order] = words
    return named


def _ratios(run: xr.Dataset, known: Mapping[str, SprocketParts], shaft: str) -> dict[str, float]:
    """Speeds of the sprockets over that of the shaft; on one chain those of the teeth."""
    turned = float(turning(run, shaft)[0][-1])
    if turned <= 0.0:
        raise ParameterError(f"{shaft} does not turn in this run: it has no orders", "shaft")
    own = known.get(shaft)
    ratios = {}
    for name, it in known.items():
        if own is not None and it.chain.name == own.chain.name:
            ratios[name] = own.teeth / it.teeth
        elif "sprocket_angle" in run:
            ratios[name] = float(turning(run, name)[0][-1]) / turned
    return ratios


def _acting(known: Mapping[str, SprocketParts]) -> Iterator[tuple[str, str, float]]:
    """Name, sprocket whose turns count, and order of what motions and torques do in turns."""
    for name, it in known.items():
        motion = it.scene.get("motion", {})
        for term in motion.get("terms", ()) if motion.get("kind") == "orders" else ():
            order = float(term["order"])
            yield f"motion of {name}, order {order:g}", str(motion.get("of") or name), order
        for key, what in _ACTIONS.items():
            for action in _listed(it.scene.get(key)):
                of = str(action.get("of") or name)
                for order in _orders(action):
                    yield f"{what} on {name}, order {order:g}", of, order


#: Lists of torques and forces on a sprocket, by their keys.
_ACTIONS = {"drive": "torque", "load": "torque", "force_x": "force", "force_y": "force"}


def _listed(actions: Any) -> list[Mapping[str, Any]]:
    if actions is None:
        return []
    return [actions] if isinstance(actions, Mapping) else list(actions)


def _orders(action: Mapping[str, Any]) -> list[float]:
    """Orders of a torque or a force: as it says, or the strongest of its table."""
    kind = action.get("kind")
    if kind == "harmonic":
        return [float(action["order"])]
    if kind == "orders":
        return [float(term["order"]) for term in action["terms"]]
    if kind != "angle-table":
        return []
    angles = np.asarray(action["angles"])
    values = np.asarray(action["torques"] if "torques" in action else action["forces"])
    even = np.linspace(0.0, angles[-1], 720, endpoint=False)
    amplitude = np.abs(np.fft.rfft(np.interp(even, angles, values)))
    amplitude[0] = 0.0
    strong = np.flatnonzero(amplitude >= _STRONG * max(amplitude.max(), 1e-300))
    turns = round(float(angles[-1]) / (2.0 * np.pi))
    return [float(k) / turns for k in strong]
