"""Whole profiles of sprockets and guides, asked about points."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from chaindrive import _core
from chaindrive.arrays import Values, shaped
from chaindrive.errors import ParameterError

__all__ = ["Closest", "Profile"]


class Closest(NamedTuple):
    """The places of a profile nearest to points."""

    points: NDArray[np.float64]
    """The places [m], (..., 2)."""
    normals: NDArray[np.float64]
    """Unit vectors out of the material, (..., 2): the gradient of the distance."""
    parameter: Values
    """Arc lengths from the start of the profile to the places [m], (...)."""


class Profile:
    """The whole profile of a sprocket or guide in its place; made by `Drive.profile`.

    Arcs and straights stay exact: distances and normals have no facets. The profile of a sprocket
    is closed, all its teeth, and runs counter-clockwise. That of a guide is its working face, an
    open curve with the material on the left of travel.

    Distances are positive in the void and negative in the material. Behind an open face, whose
    material has no stated thickness, they are negative as far as the normals of the face reach;
    beyond its ends they are those from the end, positive on either side. Coordinates that are not
    finite give NaN. Profiles can be pickled.

    Examples
    --------
    >>> import chaindrive as cd
    >>> crank = cd.scenes.marine_engine().profile("crank", settled=False)
    >>> crank.distance([[0.0, 0.0], [0.0, 1.0]]).round(3)
    array([-0.653,  0.301])
    >>> crank.contains([[0.6, 0.1], [0.6, 0.4]])
    array([ True, False])
    >>> crank.outline(1e-4).shape[1]
    2
    """

    __slots__ = ("_inner", "_name")
    _inner: _core.Profile
    _name: str

    def __init__(self) -> None:
        raise TypeError("use Drive.profile")

    @classmethod
    def _of(cls, core: _core.Profile, name: str) -> Profile:
        made = cls.__new__(cls)
        made._inner, made._name = core, name
        return made

    @property
    def name(self) -> str:
        """Name of the sprocket or guide."""
        return self._name

    @property
    def closed(self) -> bool:
        """Whether the profile encloses its material: a sprocket's does, a guide's does not."""
        return self._inner.closed

    @property
    def length(self) -> float:
        """Length along the profile [m]."""
        return self._inner.length

    def distance(self, points: ArrayLike) -> Values:
        """Return the signed distance of points from the profile.

        Parameters
        ----------
        points : (..., 2)
            Places in the plane of the drive [m].

        Returns
        -------
        distance : (...)
            Distance [m], negative inside the material; a number for a single point.

        Raises
        ------
        ParameterError
            The last axis has not two entries.
        """
        shape, flat = _pairs(points)
        return shaped(self._inner.distance(flat), shape)

    def closest(self, points: ArrayLike) -> Closest:
        """Return the places of the profile nearest to points; arguments as in `distance`.

        Returns
        -------
        points : (..., 2)
            The nearest places [m]; of equally near ones any.
        normals : (..., 2)
            Unit vectors out of the material there, so that a point is its nearest place plus
            distance times normal. At an edge they point from the edge to the point, or back where
            the distance is negative.
        parameter : (...)
            Arc length from the start of the profile to the nearest place [m], in [0, `length`].
        """
        shape, flat = _pairs(points)
        found, normals, parameter = self._inner.closest(flat)
        return Closest(
            found.reshape((*shape, 2)), normals.reshape((*shape, 2)), shaped(parameter, shape)
        )

    def contains(self, points: ArrayLike) -> NDArray[np.bool_] | np.bool_:
        """Return whether points lie in the material or on its border, (...); as in `distance`.

        Raises
        ------
        ParameterError
            The profile is the open face of a guide, which encloses nothing.
        """
        if not self.closed:
            raise ParameterError(
                f"the face of guide `{self.name}` is open and encloses nothing",
                "name",
                "ask for the distance, which is negative behind the face",
            )
        shape, flat = _pairs(points)
        inside = self._inner.contains(flat).reshape(shape)[()]
        return cast("NDArray[np.bool_] | np.bool_", inside)

    def outline(self, tolerance: float = 1e-5) -> NDArray[np.float64]:
        """Return the points of a polyline along the profile, (n, 2) [m].

        Parameters
        ----------
        tolerance
            How far its chords may stand off the profile [m]. All joints between arcs and straights
            are among the points; a closed profile ends with the point it starts from.

        Raises
        ------
        ParameterError
            The tolerance is less than a billionth of the size of the profile.
        """
        return self._inner.outline(tolerance)

    def __reduce__(self) -> tuple[Callable[..., Profile], tuple[Any, ...]]:
        return _of_pieces, (self._inner.pieces(), self.closed, self.name)

    def __repr__(self) -> str:
        kind = "closed" if self.closed else "open"
        return f"<chaindrive.Profile of {self.name!r}: {kind}, {self.length:.4g} m>"


def _of_pieces(pieces: list[list[float]], closed: bool, name: str) -> Profile:
    return Profile._of(_core.Profile.of_pieces(pieces, closed), name)


def _pairs(points: ArrayLike) -> tuple[tuple[int, ...], NDArray[np.float64]]:
    """Return the shape of an array of points without its last axis, and the points as (n, 2)."""
    array = np.asarray(points, dtype=np.float64)
    if array.ndim == 0 or array.shape[-1] != 2:
        raise ParameterError(
            f"points have the shape {array.shape}", "points", "must be (..., 2): x and y [m]"
        )
    return array.shape[:-1], np.ascontiguousarray(array.reshape(-1, 2))
