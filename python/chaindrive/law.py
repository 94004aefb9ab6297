"""Contact laws on arrays."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from chaindrive import _core
from chaindrive.errors import ParameterError

__all__ = ["Law", "law"]


class Law:
    """A normal force law, as sprockets and guides use it; made by `law` or `Drive.law`.

    Everything broadcasts like NumPy functions and is zero across a gap.
    """

    __slots__ = ("_inner",)
    _inner: _core.Law

    def __init__(self) -> None:
        raise TypeError("use chaindrive.law or Drive.law")

    @classmethod
    def _of(cls, core: _core.Law) -> Law:
        made = cls.__new__(cls)
        made._inner = core
        return made

    def force(
        self, penetration: ArrayLike, rate: ArrayLike = 0.0, onset_rate: ArrayLike = 0.0
    ) -> NDArray[np.float64]:
        """Return the normal force, element by element.

        Parameters
        ----------
        penetration : (...)
            Overlap of the surfaces [m]; zero or negative across a gap.
        rate, onset_rate : (...)
            Closing speed now, and when the contact began [m/s]. A law with a floor under the
            speed at onset takes the larger of the two.

        Returns
        -------
        force : (...)
            Compressive force [N], never negative, in the broadcast shape of the arguments.

        Raises
        ------
        ValueError
            The arguments do not broadcast.
        """
        shape, flat = _flatten(penetration, rate, onset_rate)
        return self._inner.force(*flat).reshape(shape)

    def damping(
        self, penetration: ArrayLike, rate: ArrayLike = 0.0, onset_rate: ArrayLike = 0.0
    ) -> NDArray[np.float64]:
        """Return the damping ∂F/∂rate [N s/m]; arguments as in `force`."""
        shape, flat = _flatten(penetration, rate, onset_rate)
        return self._inner.damping(*flat).reshape(shape)

    def stiffness(self, penetration: ArrayLike) -> NDArray[np.float64]:
        """Return the tangent stiffness [N/m] of the elastic part at a penetration [m], (...)."""
        shape, flat = _flatten(penetration)
        return self._inner.stiffness(*flat).reshape(shape)

    def energy(self, penetration: ArrayLike) -> NDArray[np.float64]:
        """Return the energy [J] stored at a penetration [m], (...)."""
        shape, flat = _flatten(penetration)
        return self._inner.energy(*flat).reshape(shape)

    @property
    def parameters(self) -> dict[str, Any]:
        """Elastic law, dissipation and onset floor, with their parameters in SI units."""
        return cast("dict[str, Any]", json.loads(self._inner.to_json()))

    def __repr__(self) -> str:
        return f"<chaindrive.Law {self.parameters}>"


def law(
    kind: str,
    *,
    restitution: float | None = None,
    damping: float | None = None,
    dissipation: str | Mapping[str, Any] | None = None,
    onset_floor: float = 0.05,
    **parameters: float,
) -> Law:
    """Make a contact law by the name of its elastic part.

    Parameters
    ----------
    kind
        ``"power"`` with ``stiffness`` [N/mⁿ] and ``exponent`` [–]; ``"johnson"`` with
        ``length_scale`` [m] and ``modulus_length`` [N/m].
    restitution
        Coefficient of restitution [–] after Lankarani and Nikravesh.
    damping
        Viscous damping [N s/m].
    dissipation
        Any other dissipation, by name or with its parameters,
        ``{"kind": "lankarani_nikravesh", "restitution": 0.8}``. Of these three at most one; with
        none the law is elastic.
    onset_floor
        Least speed at onset a hysteretic dissipation reckons with [m/s].
    **parameters
        Those of the elastic law.

    Returns
    -------
    Law

    Raises
    ------
    ParameterError
        An unknown kind, a missing or unknown parameter, or one out of its range.

    Examples
    --------
    >>> import chaindrive as cd
    >>> steel = cd.law("power", stiffness=6e11, exponent=1.5, restitution=0.8)
    >>> steel.force([0.0, 1e-5]).round()
    array([    0., 18974.])
    """
    given = {
        "restitution": restitution is not None,
        "damping": damping is not None,
        "dissipation": dissipation is not None,
    }
    names = [name for name, present in given.items() if present]
    if len(names) > 1:
        raise ParameterError(
            f"{' and '.join(names)} are given, must be one of them", names[1], "keep one of them"
        )
    if restitution is not None:
        dissipation = {"kind": "lankarani_nikravesh", "restitution": restitution}
    elif damping is not None:
        dissipation = {"kind": "viscous", "damping": damping}
    elif dissipation is None:
        dissipation = {"kind": "none"}
    elif isinstance(dissipation, str):
        dissipation = {"kind": dissipation}
    described = {
        "elastic": {"kind": kind, **parameters},
        "dissipation": dict(dissipation),
        "onset_floor": onset_floor,
    }
    try:
        text = json.dumps(described, default=float, allow_nan=False)
    except (TypeError, ValueError) as error:
        raise ParameterError(f"law: {error}", "law", "finite numbers") from error
    return Law._of(_core.Law.from_json(text))


def _flatten(*values: ArrayLike) -> tuple[tuple[int, ...], list[NDArray[np.float64]]]:
    arrays = np.broadcast_arrays(*(np.asarray(value, dtype=np.float64) for value in values))
    return arrays[0].shape, [np.ascontiguousarray(array).ravel() for array in arrays]
