"""Contact laws on arrays."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping
from difflib import get_close_matches
from typing import Any, NamedTuple, cast

from numpy.typing import ArrayLike

from chaindrive import _core
from chaindrive.arrays import Values, flatten, shaped
from chaindrive.errors import ParameterError
from chaindrive.quantity import with_unit
from chaindrive.settings import DissipationKind, LawKind

__all__ = ["Law", "Response", "json_of", "law"]

# How two cylinders can lie, by the keywords that say so.
_ARRANGEMENTS = {
    "pin_in_hole": ("hole", "pin"),
    "side_by_side": ("radius", "other"),
    "on_curve": ("radius", "curvature", "depth_cap"),
}
_CHOICES = ", ".join(" and ".join(words) for words in _ARRANGEMENTS.values())
_GEOMETRY = ("hole", "pin", "radius", "other", "curvature", "depth_cap", "length", "modulus")


# Parameters of every law and dissipation: the names that the core has.
_LAWS: dict[LawKind, tuple[str, ...]] = {
    "linear": ("stiffness",),
    "power": ("stiffness", "exponent"),
    "hertz": (),
    "johnson": ("length_scale", "modulus_length"),
    "conformal": ("clearance", "modulus_length"),
    "radzimovsky": ("length_scale", "modulus_length"),
    "esdu-78035": ("length_scale", "modulus_length"),
    "dubowsky-freudenstein": ("length_scale", "modulus_length"),
    "cylindrical": ("stiffness", "exponent"),
}
_NOT_OF_CYLINDERS = ("linear", "power")
_DISSIPATIONS: dict[DissipationKind, tuple[str, ...]] = {
    "none": (),
    "viscous": ("damping",),
    "exact": ("restitution",),
    "hunt-crossley": ("restitution",),
    "lankarani-nikravesh": ("restitution",),
    "lee-wang": ("restitution",),
    "herbert-mcwhannell": ("restitution",),
    "gonthier": ("restitution",),
    "zhiying-qishao": ("restitution",),
    "flores": ("restitution",),
    "hu-guo": ("restitution",),
}


class Response(NamedTuple):
    """Force of a contact under an approach, and its derivatives."""

    force: Values
    """Normal force [N], compressive, never negative."""
    elastic: Values
    """Elastic part of the force [N]."""
    stiffness: Values
    """∂force/∂penetration [N/m] at constant rate."""
    damping: Values
    """∂force/∂rate [N s/m]."""


class Law:
    """A normal force law, as sprockets and guides use it; made by `law` or `Drive.law`.

    Everything broadcasts like NumPy functions and is zero across a gap; numbers give a number.
    Laws can be pickled.
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

    def respond(
        self, penetration: ArrayLike, rate: ArrayLike = 0.0, onset_rate: ArrayLike = 0.0
    ) -> Response:
        """Return force, elastic part, stiffness and damping at once; arguments as in `force`."""
        shape, flat = flatten(penetration, rate, onset_rate)
        return Response(*(shaped(values, shape) for values in self._inner.respond(*flat)))

    def force(
        self, penetration: ArrayLike, rate: ArrayLike = 0.0, onset_rate: ArrayLike = 0.0
    ) -> Values:
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
        return self.respond(penetration, rate, onset_rate).force

    def damping(
        self, penetration: ArrayLike, rate: ArrayLike = 0.0, onset_rate: ArrayLike = 0.0
    ) -> Values:
        """Return the damping ∂F/∂rate [N s/m]; arguments as in `force`."""
        return self.respond(penetration, rate, onset_rate).damping

    def stiffness(
        self, penetration: ArrayLike, rate: ArrayLike = 0.0, onset_rate: ArrayLike = 0.0
    ) -> Values:
        """Return the tangent stiffness ∂F/∂penetration [N/m]; arguments as in `force`.

        At rest it is that of the elastic part.
        """
        return self.respond(penetration, rate, onset_rate).stiffness

    def energy(self, penetration: ArrayLike) -> Values:
        """Return the energy [J] stored at a penetration [m], (...)."""
        shape, flat = flatten(penetration)
        return shaped(self._inner.energy(*flat), shape)

    @property
    def restitution(self) -> float | None:
        """Coefficient of restitution [–] that a free impact delivers, whatever was asked for.

        None for viscous damping, where it depends on mass and speed; 1 without dissipation.
        """
        if self.parameters["dissipation"]["kind"] == "none":
            return 1.0
        found = self._inner.hysteresis()
        return None if found is None else found[1]

    @property
    def factor(self) -> float | None:
        """Damping factor χ [–] of a hysteretic law; None for others."""
        found = self._inner.hysteresis()
        return None if found is None else found[0]

    @property
    def parameters(self) -> dict[str, Any]:
        """Elastic law, dissipation and onset floor, with their parameters in SI units."""
        return cast("dict[str, Any]", json.loads(self._inner.to_json()))

    def __reduce__(self) -> tuple[Callable[[str], Law], tuple[str]]:
        return _from_json, (self._inner.to_json(),)

    def __repr__(self) -> str:
        return f"<chaindrive.Law {self.parameters}>"


def law(
    kind: LawKind,
    *,
    restitution: float | None = None,
    damping: float | None = None,
    dissipation: DissipationKind | Mapping[str, Any] | None = None,
    onset_floor: float = 0.05,
    **parameters: float,
) -> Law:
    """Make a contact law by the name of its elastic part.

    Parameters
    ----------
    kind
        With the parameters of the law: ``"linear"`` with ``stiffness`` [N/m]; ``"power"`` with
        ``stiffness`` [N/mⁿ] and ``exponent`` [–]; ``"johnson"``, ``"radzimovsky"``,
        ``"esdu-78035"`` and ``"dubowsky-freudenstein"`` with ``length_scale`` [m] and
        ``modulus_length`` [N/m]; ``"conformal"`` with ``clearance`` [m] and ``modulus_length``;
        ``"cylindrical"`` with ``stiffness`` and ``exponent``.

        Or with the geometry of two parallel cylinders, for ``"hertz"`` and all of these but
        ``"linear"`` and ``"power"``: ``length`` [m] of the contact and composite ``modulus`` [Pa],
        together with ``hole`` and ``pin``, the radii [m] of one in the other; ``radius`` and
        ``other``, the radii of two side by side; or ``radius``, ``curvature`` [1/m] of the
        counterpart, negative in a hollow and zero on a flat, and ``depth_cap`` [m], the greatest
        depth it is reckoned with. ``"conformal"`` is Johnson's law where the counterpart is not
        hollow; ``"cylindrical"`` is Johnson's law towards a flat: in hollows with more than 10 mm
        between the radii, and outside with more than 300 mm; `Law.parameters` tells.
    restitution
        Coefficient of restitution [–], which an impact has exactly unless ``dissipation`` names
        another factor than ``"exact"``: ``"lankarani-nikravesh"``, ``"hunt-crossley"``,
        ``"lee-wang"``, ``"herbert-mcwhannell"``, ``"gonthier"``, ``"zhiying-qishao"``,
        ``"flores"``, ``"hu-guo"``.
    damping
        Viscous damping [N s/m]: a Kelvin–Voigt element.
    dissipation
        The name of a dissipation, or the name with its parameters,
        ``{"kind": "lankarani-nikravesh", "restitution": 0.8}``. With none of these three the law
        is elastic.
    onset_floor
        Least speed at onset a hysteretic dissipation reckons with [m/s].
    **parameters
        Those of the elastic law, or of the geometry.

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
    >>> pin = cd.law(
    ...     "johnson", hole=1.85e-3, pin=1.8e-3, length=4.5e-3, modulus=113.7e9,
    ...     dissipation="exact", restitution=0.7,
    ... )
    >>> round(float(pin.force(1e-6)), 1), round(pin.restitution, 6)
    (263.2, 0.7)
    """
    described = json_of(_dissipation(restitution, damping, dissipation), "dissipation")
    kind = named(kind)
    _known(kind, _LAWS, "law", "kind")
    _numbers({**parameters, "onset_floor": onset_floor})
    if any(name in parameters for name in _GEOMETRY) and kind not in _NOT_OF_CYLINDERS:
        finite = json.loads(json_of(parameters, "law"))
        arrangement, measures, length, modulus = _cylinders(finite)
        return Law._of(
            _core.Law.between(
                kind, arrangement, measures, length, modulus, described, float(onset_floor)
            )
        )
    _complete(kind, parameters, _LAWS[kind])
    elastic = {"kind": kind, **parameters}
    if kind == "linear":
        elastic = {"kind": "power", "exponent": 1.0, **parameters}
    text = json_of(
        {
            "elastic": elastic,
            "dissipation": json.loads(described),
            "onset_floor": onset_floor,
        },
        "law",
    )
    return _from_json(text)


def _from_json(text: str) -> Law:
    return Law._of(_core.Law.from_json(text))


def _known(name: Any, known: Mapping[Any, object], what: str, path: str) -> None:
    """Refuse a name that is not one of some."""
    if isinstance(name, str) and name in known:
        return
    near = get_close_matches(str(name), known, 1)
    hint = f"did you mean {near[0]!r}?" if near else f"there are {', '.join(known)}"
    raise ParameterError(f"no {what} is called {name!r}; {hint}", path, hint)


def _numbers(given: Mapping[str, Any]) -> None:
    """Refuse what is no number."""
    for name, value in json.loads(json_of(given, "law")).items():
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise ParameterError(f"{name} = {value!r}, must be a number", name, "must be a number")


def _complete(kind: str, given: Iterable[str], needed: tuple[str, ...]) -> None:
    """Refuse parameters that a law does not have, or has too few of."""
    takes = f"give {' and '.join(needed)}" if needed else "it has no parameters"
    if kind in _LAWS and kind not in _NOT_OF_CYLINDERS:
        cylinders = f"give length, modulus and one of: {_CHOICES}"
        takes = f"{takes}, or for two cylinders {cylinders}" if needed else cylinders
    given = set(given)
    for name in sorted(given - set(needed)):
        raise ParameterError(f"{kind!r} has no parameter {name!r}; {takes}", name, takes)
    for name in needed:
        if name not in given:
            raise ParameterError(f"{kind!r} lacks {name!r}; {takes}", name, takes)
    if kind == "hertz":
        raise ParameterError(f"{kind!r} lacks the two cylinders; {takes}", "cylinders", takes)


def named(kind: Any) -> Any:
    """Return the name of a law as scenes spell it; underscores will do for hyphens."""
    return kind.replace("_", "-") if isinstance(kind, str) else kind


def json_of(described: Mapping[str, Any], what: str) -> str:
    """Return a description as JSON; anything but finite numbers is a `ParameterError`."""
    try:
        return json.dumps(described, default=_plain, allow_nan=False)
    except (TypeError, ValueError) as error:
        raise ParameterError(f"{what}: {error}", what, "finite numbers") from error


def _plain(value: Any) -> Any:
    measured = with_unit(value)
    return float(value) if measured is value else measured


def _dissipation(
    restitution: float | None,
    damping: float | None,
    dissipation: str | Mapping[str, Any] | None,
) -> dict[str, Any]:
    """Return the dissipation with its parameters, from its short forms."""
    given = {
        name: value
        for name, value in {"restitution": restitution, "damping": damping}.items()
        if value is not None
    }
    names = [*given, *(["dissipation"] if isinstance(dissipation, Mapping) else [])]
    if len(names) > 1:
        raise ParameterError(
            f"{' and '.join(names)} are given, must be one of them", names[1], "keep one of them"
        )
    if isinstance(dissipation, Mapping):
        given = {str(name): value for name, value in dissipation.items() if name != "kind"}
        dissipation = dissipation.get("kind")
    elif dissipation is None:
        short = {"restitution": "exact", "damping": "viscous"}
        dissipation = short[names[0]] if names else "none"
    kind = named(dissipation)
    _known(kind, _DISSIPATIONS, "dissipation", "dissipation")
    _complete(kind, given, _DISSIPATIONS[kind])
    return {"kind": kind, **given}


def _cylinders(parameters: Mapping[str, float]) -> tuple[str, list[float], float, float]:
    """Return arrangement, measures, length and modulus of two cylinders."""
    given = set(parameters) - {"length", "modulus"}
    matching = [name for name, words in _ARRANGEMENTS.items() if given == set(words)]
    if not matching or not {"length", "modulus"} <= set(parameters):
        raise ParameterError(
            f"{', '.join(parameters)} do not describe two cylinders",
            "cylinders",
            f"give length, modulus and one of: {_CHOICES}",
        )
    measures = [parameters[word] for word in _ARRANGEMENTS[matching[0]]]
    return matching[0], measures, parameters["length"], parameters["modulus"]
