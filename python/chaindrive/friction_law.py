"""Friction laws on arrays."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any, NamedTuple, cast

from numpy.typing import ArrayLike

from chaindrive import _core
from chaindrive.arrays import Values, flatten, shaped
from chaindrive.contact_law import json_of, named
from chaindrive.settings import FrictionKind, Quantity

__all__ = ["Friction", "Rub", "friction"]


class Rub(NamedTuple):
    """Force and state of a rubbing contact over a step."""

    force: Values
    """Tangential force [N] at the end of the step; opposes the slip."""
    damping: Values
    """−∂force/∂slip [N s/m], zero where the force falls with the slip."""
    state: Values
    """State at the end of the step: the deflection [m] of the bristles, zero without memory."""


class Friction:
    """A friction law; made by `friction`.

    Everything broadcasts like NumPy functions. Friction laws can be pickled.
    """

    __slots__ = ("_inner",)
    _inner: _core.Friction

    def __init__(self) -> None:
        raise TypeError("use chaindrive.friction")

    @classmethod
    def _of(cls, core: _core.Friction) -> Friction:
        made = cls.__new__(cls)
        made._inner = core
        return made

    def force(self, normal: ArrayLike, slip: ArrayLike) -> Values:
        """Return the tangential force [N] under a normal force [N] at a slip [m/s], (...).

        It opposes the slip. A law with a state answers its steady state.
        """
        shape, flat = flatten(normal, slip)
        return shaped(self._inner.act(*flat)[0], shape)

    def damping(self, normal: ArrayLike, slip: ArrayLike) -> Values:
        """Return −∂force/∂slip [N s/m], zero where the force falls with the slip, (...)."""
        shape, flat = flatten(normal, slip)
        return shaped(self._inner.act(*flat)[1], shape)

    def rub(
        self, normal: ArrayLike, slip: ArrayLike, state: ArrayLike = 0.0, dt: ArrayLike = 0.0
    ) -> Rub:
        """Rub for a time at constant normal force and slip.

        Parameters
        ----------
        normal, slip : (...)
            Normal force [N] and slip [m/s].
        state : (...)
            State at the beginning [m]; zero for a new contact, ignored by laws without memory.
        dt : (...)
            Time [s].

        Returns
        -------
        Rub
            Force, damping and state at the end, in the broadcast shape of the arguments.
        """
        shape, flat = flatten(normal, slip, state, dt)
        return Rub(*(shaped(values, shape) for values in self._inner.rub(*flat)))

    @property
    def parameters(self) -> dict[str, Any]:
        """Name and parameters in SI units."""
        return cast("dict[str, Any]", json.loads(self._inner.to_json()))

    def __reduce__(self) -> tuple[Callable[[str], Friction], tuple[str]]:
        return _from_json, (self._inner.to_json(),)

    def __repr__(self) -> str:
        return f"<chaindrive.Friction {self.parameters}>"


def friction(kind: FrictionKind, **parameters: Quantity) -> Friction:
    """Make a friction law by its name, as scenes have it: with their names, units and defaults.

    Parameters
    ----------
    kind
        ``"none"``;
        ``"coulomb"`` with ``coefficient`` [–], and if wanted ``slip_speed`` [m/s];
        ``"ambrosio"`` with ``coefficient``, ``lower_speed`` and ``upper_speed``;
        ``"threlfall"`` with ``coefficient``, and if wanted ``slip_speed``;
        ``"bengisu-akay"`` with ``static_coefficient``, ``coefficient``, ``decay`` [s/m], and if
        wanted ``slip_speed``;
        ``"brown-mcphee"`` with ``static_coefficient``, ``coefficient``, and if wanted
        ``slip_speed``, ``viscosity`` [N s/m] and ``transition_force`` [N];
        ``"lugre"`` with ``static_coefficient``, ``coefficient``, ``stiffness`` [1/m], and if
        wanted ``slip_speed``, ``damping`` [s/m] and ``viscosity`` [s/m], per normal force;
        ``"spring-slider"`` with ``coefficient`` and ``stiffness`` [N/m];
        ``"stribeck"`` with ``coefficient``, ``viscosity`` [Pa s], ``length`` [m],
        ``relative_clearance`` [–] and ``stiffness`` [N/m], and if wanted ``transition`` [–].
    **parameters
        Those of the law, as numbers in SI units or texts with a unit.

    Returns
    -------
    Friction

    Raises
    ------
    ParameterError
        An unknown kind, a missing or unknown parameter, or one out of its range.

    Examples
    --------
    >>> import chaindrive as cd
    >>> dry = cd.friction("brown-mcphee", static_coefficient=0.15, coefficient=0.1, slip_speed=1e-3)
    >>> dry.force(1000.0, [-1e-3, 0.0, 1.0]).round(1)
    array([ 149.9,   -0. , -100. ])
    """
    return _from_json(json_of({"kind": named(kind), **parameters}, "friction"))


def _from_json(text: str) -> Friction:
    return Friction._of(_core.Friction.from_json(text))
