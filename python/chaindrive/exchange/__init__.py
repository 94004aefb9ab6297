"""Profiles and results in and out: drawings in DXF and SVG, tables, NetCDF.

Curves of a drawing are read by `read_dxf` and become profiles of a scene by `tooth` and `face`;
`write_dxf` and `write_svg` write what `outlines` finds in a drive; `save` writes results.
"""

from chaindrive.exchange.biarcs import biarcs
from chaindrive.exchange.curve import Curve
from chaindrive.exchange.dxf import read_dxf, write_dxf
from chaindrive.exchange.outlines import outlines
from chaindrive.exchange.results import save
from chaindrive.exchange.scene import face, tooth
from chaindrive.exchange.svg import write_svg

__all__ = [
    "Curve",
    "biarcs",
    "face",
    "outlines",
    "read_dxf",
    "save",
    "tooth",
    "write_dxf",
    "write_svg",
]


def __dir__() -> list[str]:
    return list(__all__)
