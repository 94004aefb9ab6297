"""Curves as a scene spells them: the gap between two teeth, the face of a guide or shoe."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from chaindrive.errors import ParameterError
from chaindrive.exchange.curve import Curve, turn_between

__all__ = ["face", "tooth"]

# A scene takes arcs of less than a half turn; these are well given by ends and radius.
_LARGEST_SWEEP = 0.5 * np.pi
# A piece shorter than this part of the outline has no direction.
_NOTHING = 1e-9


def tooth(
    outline: Curve,
    teeth: int,
    *,
    centre: ArrayLike | None = None,
    tolerance: float = 1e-5,
) -> dict[str, Any]:
    """Return the profile of teeth as a scene takes it, from the outline of a whole sprocket.

    One gap is cut out, half a tooth on either side of the deepest place; the others must be like
    it.

    Parameters
    ----------
    outline
        The closed outline; hub and bore are curves of their own.
    teeth
        Number of teeth.
    centre
        Centre of the sprocket [m]; that of the area when absent.
    tolerance
        How far the other gaps may stand off the one that is taken [m].

    Returns
    -------
    dict
        The value of ``tooth``: ``drive.replace({"sprockets.crank.tooth": tooth(outline, 18)})``.

    Raises
    ------
    ParameterError
        The outline is open, does not run around the centre once, or has not so many equal gaps.

    Examples
    --------
    >>> import chaindrive as cd
    >>> drive = cd.scenes.industrial_16b()
    >>> (outline,) = cd.exchange.outlines(drive.profile("driver"))
    >>> same = drive.replace({"sprockets.driver.tooth": cd.exchange.tooth(outline, 19)})
    >>> places = outline.outline(1e-4)
    >>> float(abs(same.profile("driver").distance(places)).max()) < 1e-8
    True
    """
    if not outline.closed:
        message = f"the outline of {len(outline.bulges)} pieces is open"
        raise ParameterError(message, "outline", "join its ends, or allow a larger gap in read_dxf")
    _sound(outline)
    if teeth < 3:
        raise ParameterError(f"teeth = {teeth}, must be at least 3", "teeth", "at least 3")
    curve = outline if outline.area > 0.0 else outline.reversed()
    middle = curve.centroid if centre is None else np.asarray(centre, dtype=float)
    curve = curve.moved(-middle)
    deepest = _deepest(curve)
    # The scene has the gap on the y axis.
    curve = curve.moved(turned=0.5 * np.pi - float(np.arctan2(deepest[1], deepest[0])))
    half = np.pi / teeth
    gap = curve.stretch(_crossing(curve, 0.5 * np.pi - half), _crossing(curve, 0.5 * np.pi + half))
    worst = max(
        float(gap.distance(_within(curve.moved(turned=-2.0 * half * turn), half)).max(initial=0.0))
        for turn in range(teeth)
    )
    if worst > tolerance:
        message = f"the gaps of {teeth} teeth differ by {worst * 1e3:.3g} mm"
        hint = f"give number of teeth and centre, or allow it: tolerance={worst:.2g}"
        raise ParameterError(message, "teeth", hint)
    return {"kind": "path", "from": gap.points[0].tolist(), "pieces": _pieces(gap)}


def face(curve: Curve, *, material: str = "right") -> dict[str, Any]:
    """Return the face of a guide or shoe as a scene takes it.

    Parameters
    ----------
    curve
        The open face, in the plane of the drive.
    material
        Side of the curve on which the material lies, ``"left"`` or ``"right"`` of its run; see
        `Curve.reversed`.

    Returns
    -------
    dict
        The value of ``face``: ``drive.replace({"guides.shoe.face": face(curve)})``.

    Raises
    ------
    ParameterError
        The curve is closed, or empty.

    Examples
    --------
    >>> import chaindrive as cd
    >>> drive = cd.scenes.timing_drive()
    >>> (curve,) = cd.exchange.outlines(drive.profile("shoe", settled=False))
    >>> same = drive.replace({"guides.shoe.face": cd.exchange.face(curve, material="left")})
    >>> places = curve.outline(1e-4)
    >>> float(abs(same.profile("shoe", settled=False).distance(places)).max()) < 1e-9
    True
    """
    if curve.closed:
        message = "the curve is closed, and the face of a guide is open"
        raise ParameterError(message, "curve", "cut the face out: curve.stretch(start, end)")
    _sound(curve)
    whole = _split(curve)
    corners, radii = [whole.points[0]], []
    rows = zip(whole.starts, whole.ends, whole.bulges, whole.radii, strict=True)
    for start, end, bulge, radius in rows:
        if bulge != 0.0:
            # Where the tangents of the ends meet: over the middle by ½ |e − s| tan(½ θ).
            along = end - start
            right = np.array([along[1], -along[0]])
            rise = 0.5 * np.tan(2.0 * np.arctan(bulge))
            corners.append(0.5 * (start + end) + rise * right)
            radii.append(abs(float(radius)))
        corners.append(end)
        radii.append(0.0)
    return {
        "kind": "points",
        "points": np.array(corners).tolist(),
        "radii": radii[:-1],
        "material": material,
    }


def _sound(curve: Curve) -> None:
    """Refuse a curve of which nothing can be made."""
    if len(curve.points) < 2:
        raise ParameterError("the curve is empty", "curve", "two points at least")
    with np.errstate(over="ignore"):
        # Radii go with the square of a bulge.
        numbers = [*curve.points.flat, *curve.bulges**2]
    if not np.isfinite(numbers).all():
        message = "the curve has a place, a bulge or a length that is not finite"
        raise ParameterError(message, "curve", "finite numbers, places in m")


def _pieces(curve: Curve) -> list[dict[str, Any]]:
    whole = _split(curve)
    return [
        {"kind": "line", "to": end.tolist()}
        if bulge == 0.0
        else {"kind": "arc", "to": end.tolist(), "radius": float(radius)}
        for end, bulge, radius in zip(whole.ends, whole.bulges, whole.radii, strict=True)
    ]


def _split(curve: Curve) -> Curve:
    """Return an open curve without pieces that are next to nothing, and long arcs in parts."""
    points, bulges = [curve.points[0]], []
    least = _NOTHING * curve.length
    for start, end, sweep, centre in zip(
        curve.starts, curve.ends, curve.sweeps, curve.centres, strict=True
    ):
        if np.hypot(*(end - start)) <= least:
            continue
        count = max(int(np.ceil(abs(sweep) / _LARGEST_SWEEP - 1e-9)), 1)
        for part in range(1, count):
            points.append(centre + _turned(start - centre, sweep * part / count))
            bulges.append(np.tan(0.25 * sweep / count))
        points.append(end)
        bulges.append(np.tan(0.25 * sweep / count))
    return curve._replace(points=np.array(points), bulges=np.array(bulges))


def _turned(vector: NDArray[np.float64], angle: float) -> NDArray[np.float64]:
    (x, y), c, s = vector, np.cos(angle), np.sin(angle)
    return np.array([c * x - s * y, s * x + c * y])


def _deepest(curve: Curve) -> NDArray[np.float64]:
    """Return the place of a curve nearest to the origin, (2,)."""
    found = [*curve.points]
    rows = zip(curve.starts, curve.sweeps, curve.radii, curve.centres, strict=True)
    for start, sweep, radius, centre in rows:
        if sweep == 0.0:
            continue
        distance = np.hypot(*centre)
        if distance == 0.0:
            continue
        # The near and the far side of the circle, as seen from the origin.
        for side in (-1.0, 1.0):
            place = centre + side * abs(radius) * centre / distance
            turn = turn_between(start - centre, place - centre, sweep)
            if turn <= abs(sweep):
                found.append(place)
    return min(found, key=lambda place: float(np.hypot(*place)))


def _within(curve: Curve, half: float) -> NDArray[np.float64]:
    """Return the corners of a curve in the sector of the gap on the y axis, (n, 2)."""
    angles = np.arctan2(curve.points[:, 1], curve.points[:, 0]) - 0.5 * np.pi
    return curve.points[np.abs(angles) < half * (1.0 - 1e-9)]


def _crossing(curve: Curve, angle: float) -> NDArray[np.float64]:
    """Return the one place where a curve crosses a ray out of the origin, (2,)."""
    ray = np.array([np.cos(angle), np.sin(angle)])
    found: list[NDArray[np.float64]] = []
    rows = zip(curve.starts, curve.ends, curve.sweeps, curve.radii, curve.centres, strict=True)
    for start, end, sweep, radius, centre in rows:
        places = []
        if sweep == 0.0:
            # s + u (e − s) = t r
            matrix = np.column_stack([end - start, -ray])
            if abs(np.linalg.det(matrix)) > 0.0:
                share, _ = np.linalg.solve(matrix, -start)
                if -_NOTHING <= share <= 1.0 + _NOTHING:
                    places.append(start + share * (end - start))
        else:
            # |t r − c| = R
            nearest = centre @ ray
            root = nearest**2 - centre @ centre + radius**2
            for side in (-1.0, 1.0) if root >= 0.0 else ():
                place = (nearest + side * np.sqrt(root)) * ray
                if turn_between(start - centre, place - centre, sweep) <= abs(sweep) + _NOTHING:
                    places.append(place)
        found += [place for place in places if place @ ray > 0.0]
    # A pointed tooth is found on both of its flanks.
    apart = [
        place
        for index, place in enumerate(found)
        if all(np.hypot(*(place - other)) > 1e-6 * curve.length for other in found[:index])
    ]
    if len(apart) != 1:
        crossings = f"crosses the middle of a tooth {len(apart)} times"
        hint = "give the outline of the teeth alone, their number and the centre"
        raise ParameterError(f"the outline {crossings}, must be once", "outline", hint)
    return apart[0]
