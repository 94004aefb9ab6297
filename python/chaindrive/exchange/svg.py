"""Outlines in SVG, for cutting and drawing: true to scale, arcs as arcs."""

from __future__ import annotations

from os import PathLike
from xml.sax.saxutils import quoteattr

import numpy as np

from chaindrive._core import NewFile
from chaindrive.exchange.curve import Curve
from chaindrive.exchange.outlines import Outlined, outlines

__all__ = ["write_svg"]

# Drawings are written in millimetres; a margin is a part of their size.
_PER_METRE = 1e3
_MARGIN = 0.02


def write_svg(path: str | PathLike[str], what: Outlined, *, settled: bool = True) -> None:
    """Write outlines as paths of straights and arcs, in millimetres, one group a layer.

    A user unit is a millimetre of the drive and the paper has its size; y runs upwards within the
    groups. For a picture of a drive to look at there is `Drive.svg`.

    Parameters
    ----------
    path
        The file; one that exists is replaced.
    what, settled
        As in `write_dxf`.

    Raises
    ------
    AssemblyError
        The drive does not close or settle.
    WriteError
        The file cannot be written.
    """
    place = NewFile(path)
    curves = outlines(what, settled=settled)
    corners = np.concatenate([curve.outline(1e-4) for curve in curves]) * _PER_METRE
    low, high = corners.min(axis=0), corners.max(axis=0)
    margin = _MARGIN * (high - low).max()
    (left, bottom), (width, height) = low - margin, high - low + 2.0 * margin
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.6f}mm" height="{height:.6f}mm" '
        f'viewBox="{left:.6f} {-(bottom + height):.6f} {width:.6f} {height:.6f}">',
        '<g transform="scale(1 -1)" fill="none" stroke="black" stroke-width="0.1">',
    ]
    for layer in dict.fromkeys(curve.layer for curve in curves):
        drawn = [_path(curve) for curve in curves if curve.layer == layer]
        lines += [f"<g id={quoteattr(layer)}>", *drawn, "</g>"]
    lines += ["</g>", "</svg>", ""]
    place.write("\n".join(lines).encode())


def _path(curve: Curve) -> str:
    x, y = curve.points[0] * _PER_METRE
    steps = [f"M{x:.9f} {y:.9f}"]
    for end, bulge, radius in zip(curve.ends, curve.bulges, curve.radii, strict=True):
        x, y = end * _PER_METRE
        if bulge == 0.0:
            steps.append(f"L{x:.9f} {y:.9f}")
        else:
            r = abs(radius) * _PER_METRE
            steps.append(
                f"A{r:.9f} {r:.9f} 0 {int(abs(bulge) > 1)} {int(bulge > 0)} {x:.9f} {y:.9f}"
            )
    return f'<path d="{"".join(steps)}{"Z" if curve.closed else ""}"/>'
