"""The data sheet of a drive: what it is made of, in a few lines of text or a table in HTML."""

from __future__ import annotations

from base64 import b64encode
from html import escape
from textwrap import wrap
from typing import Any, NamedTuple

__all__ = ["Row", "html", "rows", "text"]

# A sheet names so many parts of a kind and counts the rest.
_NAMED = 12


class Row(NamedTuple):
    """One kind of part."""

    kind: str
    """Name of the parts, in the plural."""
    parts: list[str]
    """Every part in a few words."""


def rows(scene: dict[str, Any]) -> list[Row]:
    """Return what a scene is made of, kind by kind; kinds that it has none of are left out.

    Parameters
    ----------
    scene
        A scene in which every default is written out, in SI units.
    """
    chains = scene.get("chains") or [scene["chain"]]
    found = [
        Row("chains" if len(chains) > 1 else "chain", [_chain(chain) for chain in chains]),
        Row("sprockets", [_sprocket(sprocket) for sprocket in scene.get("sprockets", [])]),
        Row("shafts", [shaft["name"] for shaft in scene.get("shafts", [])]),
        Row("couplings", [coupling["name"] for coupling in scene.get("couplings", [])]),
        Row("guides", [_guide(guide) for guide in scene.get("guides", [])]),
        Row("tensioners", [_tensioner(tensioner) for tensioner in scene.get("tensioners", [])]),
    ]
    return [Row(kind, _shortened(parts)) for kind, parts in found if parts]


def text(name: str, title: str, of: list[Row]) -> str:
    """Return a sheet as lines of text."""
    lines = [f"<chaindrive.Drive {name!r}>", *([title] if title else [])]
    width = max(len(row.kind) for row in of)
    indent = " " * (width + 4)
    for row in of:
        start = f"  {row.kind:{width}}  "
        # A part stays on one line: its blanks are others until the lines are broken.
        parts = "; ".join(part.replace(" ", "\u00a0") for part in row.parts)
        lines += wrap(
            parts, 100, initial_indent=start, subsequent_indent=indent, break_on_hyphens=False
        )
    return "\n".join(lines).replace("\u00a0", " ")


def html(name: str, title: str, of: list[Row], drawing: str | None) -> str:
    """Return a sheet as HTML, with a drawing in SVG where there is one.

    Colours are those of the page around it, so that it can be read on light and on dark ones.
    """
    cell = 'style="text-align: left; vertical-align: top; padding: 0.1em 1em 0.1em 0"'
    table = "".join(
        f"<tr><th {cell}>{escape(row.kind)}</th><td {cell}>"
        f"{'<br>'.join(escape(part) for part in row.parts)}</td></tr>"
        for row in of
    )
    heading = f"<strong>{escape(title or name)}</strong> <code>{escape(name)}</code>"
    return f"<div>{heading}<table>{table}</table>{_picture(title or name, drawing)}</div>"


def _picture(title: str, drawing: str | None) -> str:
    """Return an image that fits the page; its parts have names of their own, page by page."""
    if drawing is None:
        return ""
    data = b64encode(drawing.encode()).decode()
    look = "max-width: min(100%, 40em); max-height: 40em; height: auto; background: white"
    source = f"data:image/svg+xml;base64,{data}"
    return f'<img src="{source}" alt="{escape(title)}" style="{look}">'


def _chain(chain: dict[str, Any]) -> str:
    own = f"{chain['name']}: " if "name" in chain else ""
    links = f"{chain['links']} link{'s' if chain['links'] != 1 else ''}"
    return f"{own}{links} of {chain['pitch'] * 1e3:.6g} mm, {chain['model']}"


def _sprocket(sprocket: dict[str, Any]) -> str:
    about = f"{sprocket['teeth']} teeth" + (", driving" if "motion" in sprocket else "")
    return f"{sprocket['name']} ({about})"


def _guide(guide: dict[str, Any]) -> str:
    face = guide["face"]["kind"]
    return f"{guide['name']} ({face}, touches {guide['touches']})"


def _tensioner(tensioner: dict[str, Any]) -> str:
    carrier, push = tensioner["carrier"]["kind"], tensioner["push"]["kind"]
    return f"{tensioner['name']} ({carrier}, {push})"


def _shortened(parts: list[str]) -> list[str]:
    rest = len(parts) - _NAMED
    return parts if rest < 2 else [*parts[:_NAMED], f"and {rest} more"]
