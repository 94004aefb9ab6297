"""Drawings in DXF: their curves read as profiles, drives and profiles written as outlines."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from os import PathLike, fspath
from pathlib import Path
from stat import S_ISREG
from typing import Any

import numpy as np
from numpy.typing import NDArray

from chaindrive._core import NewFile
from chaindrive.errors import ParameterError
from chaindrive.exchange.biarcs import biarcs
from chaindrive.exchange.curve import Curve, joined
from chaindrive.exchange.outlines import Outlined, outlines
from chaindrive.extras import extra

__all__ = ["read_dxf", "write_dxf"]

_WHAT = "drawings in DXF"
# Of a drawing that is read [bytes]: room for a whole engine.
_LARGEST = 256 << 20
# Drawings are written in millimetres.
_PER_METRE = 1e3
_CURVES = {"LINE", "ARC", "CIRCLE", "LWPOLYLINE", "POLYLINE", "SPLINE", "ELLIPSE"}
# What has no place in the name of a layer.
_FORBIDDEN = str.maketrans(dict.fromkeys('<>/\\":;?*|=`', "_"))


def read_dxf(
    path: str | PathLike[str],
    *,
    layers: str | Iterable[str] | None = None,
    unit: str | None = None,
    tolerance: float = 1e-6,
    gap: float = 1e-6,
) -> list[Curve]:
    """Read the curves of a drawing: lines, arcs, circles, polylines, splines and ellipses.

    What touches end to end on one layer is joined, blocks are taken apart. Lines and arcs stay as
    they are; splines and ellipses become arcs. Texts, dimensions and hatches are no curves.

    Parameters
    ----------
    path
        The file.
    layers
        Layers to read; all when absent.
    unit
        Unit of the drawing, ``"mm"`` or ``"in"``, when it does not say so or says it wrongly.
    tolerance
        How far arcs may stand off splines and ellipses [m].
    gap
        Ends this near each other touch [m].

    Returns
    -------
    list of Curve
        In metres; those of a layer follow each other.

    Raises
    ------
    ParameterError
        This is no drawing, it has no unit, no such layer or no curves, or a spline has a cusp.
    FileNotFoundError
        Nothing is there.
    """
    place = fspath(path)
    ezdxf = extra("ezdxf", _WHAT)
    about = Path(place).stat()
    if not S_ISREG(about.st_mode) or about.st_size > _LARGEST:
        message = f"{place}: no file of at most {_LARGEST >> 20} MiB"
        raise ParameterError(message, "path", "a drawing in DXF")
    try:
        return _curves_of(ezdxf.readfile(place), layers, unit, tolerance, gap, place)
    except (ParameterError, FileNotFoundError):
        raise
    except OSError as error:
        # Of the system, or of ezdxf.
        if error.errno is not None:
            raise
        raise ParameterError(f"{place}: {error}", "path", "a drawing in DXF") from error
    except Exception as error:
        # Whatever a damaged drawing makes of its reader.
        message = f"{place}: this drawing is damaged: {error!r}"
        raise ParameterError(message, "path", "a drawing in DXF") from error


def _curves_of(
    drawing: Any,
    layers: str | Iterable[str] | None,
    unit: str | None,
    tolerance: float,
    gap: float,
    path: str,
) -> list[Curve]:
    metre = _metre(drawing.units, unit)
    entities = _entities(drawing, layers, path)
    found: list[Curve] = []
    for layer in dict.fromkeys(entity.dxf.layer for entity in entities):
        pieces = [
            piece
            for entity in entities
            if entity.dxf.layer == layer
            for piece in _pieces(entity, tolerance / metre)
        ]
        found += [curve.moved(scaled=metre) for curve in _chained(pieces, gap / metre)]
    for curve in found:
        if not (np.isfinite(curve.points).all() and np.isfinite(curve.bulges).all()):
            message = f"{path}: a curve of layer {curve.layer} is not finite"
            raise ParameterError(message, "path", "a drawing in DXF")
    return found


def write_dxf(path: str | PathLike[str], what: Outlined, *, settled: bool = True) -> None:
    """Write outlines as polylines with arcs, in millimetres, each on a layer of its own.

    Parameters
    ----------
    path
        The file; one that exists is replaced.
    what
        A drive: its sprockets, guides, rollers and the line of its chains; a `Profile`; or curves.
    settled
        Of a drive: whether it stands as at the start of a run, or as the chain was laid.

    Raises
    ------
    AssemblyError
        The drive does not close or settle.
    WriteError
        The file cannot be written.
    """
    ezdxf = extra("ezdxf", _WHAT)
    curves = outlines(what, settled=settled)
    place = NewFile(path)
    drawing = ezdxf.new("R2010", units=ezdxf.units.MM)
    space = drawing.modelspace()
    for curve in curves:
        layer = curve.layer.translate(_FORBIDDEN) or "0"
        if layer not in drawing.layers:
            drawing.layers.add(layer)
        bulges = np.append(curve.bulges, [] if curve.closed else [0.0])
        corners = np.column_stack([curve.points * _PER_METRE, bulges])
        space.add_lwpolyline(
            corners.tolist(), format="xyb", close=curve.closed, dxfattribs={"layer": layer}
        )
    with place as part:
        drawing.saveas(part)


def _metre(declared: int, unit: str | None) -> float:
    """Return how long the unit of a drawing is [m]."""
    units = extra("ezdxf.units", _WHAT)
    names = {"mm": units.MM, "cm": units.CM, "m": units.M, "in": units.IN, "ft": units.FT}
    if unit is not None:
        if unit not in names:
            known = ", ".join(names)
            raise ParameterError(f"unit = {unit!r}, must be one of {known}", "unit", known)
        declared = names[unit]
    if declared == 0:
        message = "the drawing does not say in which unit it is"
        raise ParameterError(message, "unit", "give it: unit='mm'")
    return float(units.conversion_factor(declared, units.M))


def _entities(drawing: Any, layers: str | Iterable[str] | None, path: str) -> list[Any]:
    """Return the curves of a drawing on some layers, blocks taken apart, upright in the plane."""
    everything = list(extra("ezdxf.disassemble", _WHAT).recursive_decompose(drawing.modelspace()))
    curves = [entity for entity in everything if entity.dxftype() in _CURVES]
    extra("ezdxf.upright", _WHAT).upright_all(curves)
    if layers is not None:
        wanted = {layers} if isinstance(layers, str) else set(layers)
        known = {entity.dxf.layer for entity in curves}
        if not wanted <= known:
            message = f"{path}: no curve is on layer {', '.join(sorted(wanted - known))}"
            raise ParameterError(message, "layers", f"there are {', '.join(sorted(known))}")
        curves = [entity for entity in curves if entity.dxf.layer in wanted]
    if not curves:
        others = ", ".join(sorted({entity.dxftype() for entity in everything})) or "nothing"
        message = f"{path}: no curve is in the drawing, which has {others}"
        raise ParameterError(message, "path", f"draw with {', '.join(sorted(_CURVES))}")
    return curves


def _pieces(entity: Any, tolerance: float) -> Iterator[Curve]:
    """Yield an entity as curves, in units of the drawing."""
    kind, layer = entity.dxftype(), entity.dxf.layer
    if kind == "LINE":
        points = np.array([_flat(entity.dxf.start), _flat(entity.dxf.end)])
        if (points[0] != points[1]).any():
            yield Curve(points, np.zeros(1), False, layer)
    elif kind == "ARC":
        turn = np.radians((entity.dxf.end_angle - entity.dxf.start_angle) % 360.0)
        yield _arc(entity, np.radians(entity.dxf.start_angle), turn, layer)
    elif kind == "CIRCLE":
        circle = _arc(entity, 0.0, 2.0 * np.pi, layer)
        yield circle._replace(points=circle.points[:-1], closed=True)
    elif kind == "LWPOLYLINE":
        rows = np.array(entity.get_points("xyb"), dtype=float)
        yield from _polyline(rows, closed=bool(entity.closed), layer=layer)
    elif kind == "POLYLINE":
        if entity.is_2d_polyline or entity.is_3d_polyline:
            rows = np.array([[*_flat(v.dxf.location), v.dxf.bulge] for v in entity.vertices])
            yield from _polyline(rows, closed=bool(entity.is_closed), layer=layer)
    else:
        along, knots = (_spline if kind == "SPLINE" else _ellipse)(entity)
        yield biarcs(along, knots, tolerance, layer)


def _flat(vector: Any) -> NDArray[np.float64]:
    return np.array([vector.x, vector.y])


def _arc(entity: Any, first: float, turn: float, layer: str) -> Curve:
    count = int(np.ceil(turn / (0.5 * np.pi) - 1e-9))
    angles = first + turn * np.arange(count + 1) / count
    rim = np.column_stack([np.cos(angles), np.sin(angles)])
    points = _flat(entity.dxf.center) + entity.dxf.radius * rim
    return Curve(points, np.full(count, np.tan(0.25 * turn / count)), False, layer)


def _polyline(rows: NDArray[np.float64], *, closed: bool, layer: str) -> Iterator[Curve]:
    if len(rows) < 2:
        return
    points, bulges = rows[:, :2], rows[:, 2]
    # Corners that coincide with the next are no pieces.
    apart = np.hypot(*(np.roll(points, -1, axis=0) - points).T) > 0.0
    if not closed:
        apart[-1] = True
    points, bulges = points[apart], bulges[apart]
    if len(points) >= 2:
        yield Curve(points, bulges if closed else bulges[:-1], closed, layer)


def _spline(entity: Any) -> tuple[Callable[[float], Any], list[float]]:
    spline = entity.construction_tool()

    def along(parameter: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        place, derivative = spline.derivative(parameter, 1)
        return _flat(place), _flat(derivative)

    inside = [float(knot) for knot in spline.knots() if 0.0 <= knot <= spline.max_t]
    return along, sorted(set(inside))


def _ellipse(entity: Any) -> tuple[Callable[[float], Any], list[float]]:
    ellipse = entity.construction_tool()
    centre, major, minor = (
        _flat(it) for it in (ellipse.center, ellipse.major_axis, ellipse.minor_axis)
    )
    first = float(ellipse.start_param)
    turn = (float(ellipse.end_param) - first) % (2.0 * np.pi) or 2.0 * np.pi

    def along(parameter: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        # p = c + a cos t + b sin t
        c, s = np.cos(parameter), np.sin(parameter)
        return centre + c * major + s * minor, c * minor - s * major

    count = int(np.ceil(turn / (0.5 * np.pi) - 1e-9))
    return along, [first + turn * part / count for part in range(count + 1)]


def _chained(pieces: list[Curve], gap: float) -> list[Curve]:
    """Return curves, those joined that touch end to end; three at a place are left apart."""
    miner = extra("ezdxf.edgeminer", _WHAT)
    # What begins where it ends, as an ellipse does, touches nothing but itself.
    pieces = [piece if piece.closed else joined([piece], gap) for piece in pieces]
    found = [piece for piece in pieces if piece.closed]
    edges = [
        miner.make_edge(piece.points[0], piece.points[-1], piece.length, payload=piece)
        for piece in pieces
        if not piece.closed
    ]
    chains = miner.find_all_simple_chains(miner.Deposit(edges, gap_tol=gap)) if edges else []
    for chain in chains:
        parts = [edge.payload.reversed() if edge.is_reverse else edge.payload for edge in chain]
        found.append(joined(parts, gap))
    return found
