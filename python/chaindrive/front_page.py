"""The first page of a report, which is signed: drive, load case, verdicts, six numbers, limits."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
import xarray as xr

from chaindrive.analysis.parts import chains
from chaindrive.page import Page, escaped, table
from chaindrive.plot.units import in_trade
from chaindrive.pose import at_start, drive_of

__all__ = ["front_page"]

#: Units of forces on centres and carriers, by their lists.
_FORCES = {"force_x": "N", "force_y": "N"}
#: Units of what motions, torques and forces say, in SI; a motion has amplitudes in radians.
_UNITS = {
    "speed": "rad/s",
    "from": "rad/s",
    "to": "rad/s",
    "torque": "N m",
    "linear": "N m s",
    "quadratic": "N m s²",
    "force": "N",
}
#: Sentences of a verdict that the first page has room for.
_SENTENCES = 2


def front_page(run: xr.Dataset, told: Page) -> str:
    """Return what is signed as HTML that fits one sheet.

    Parameters
    ----------
    run
        A run that ended.
    told
        Its page.

    Returns
    -------
    str
        A section of the class ``front``, with headings of level 2.
    """
    sections = {it["title"].partition(":")[0]: it for it in told.sections}
    limits = sections.get("assumed inputs", {}).get("sentences", [])
    record = sections.get("record", {}).get("sentences", [])
    parts = [
        "<h2>Drive</h2>",
        *(_paragraph(it) for it in _designations(run)),
        _sprockets(run, sections.get("what the drive does")),
        "<h2>Load case</h2>",
        _paragraph(" ".join(_load_case(run))),
        "<h2>Verdicts</h2>",
        *(_verdict(it) for it in told.sections if it["title"].startswith("verdict")),
    ]
    if told.front.get("rows"):
        parts += ["<h2>Six numbers</h2>", table(told.front["columns"], told.front["rows"], 0)]
    parts += [
        "<h2>Limits</h2>",
        *(_paragraph(it) for it in [*record, *limits] if "`" not in it),
        '<p class="signature">Name, date, signature:</p>',
    ]
    body = "\n".join(parts)
    return f'<section class="front">\n{body}\n</section>'


def _paragraph(text: str) -> str:
    return f"<p>{escaped(text)}</p>" if text else ""


def _designations(run: xr.Dataset) -> Iterator[str]:
    """Designation, links and pitch of each chain, a sentence each."""
    for chain in chains(run):
        name = f" {chain.name}" if chain.name else ""
        kind = chain.scene.get("type") or "no type of the catalogue"
        strands = int(chain.scene.get("strands", 1))
        beside = f", {strands} strands" if strands > 1 else ""
        yield f"Chain{name}: {kind}, {chain.links} links of {1e3 * chain.pitch:.6g} mm{beside}."


def _sprockets(run: xr.Dataset, told: Mapping[str, Any] | None) -> str:
    """Role, teeth, speed, torque, power and ratio of the sprockets; their centres at the start."""
    if told is None or not told["rows"]:
        return ""
    # Not as the scene has them: what takes up the slack of a chain moves them.
    known = at_start(drive_of(run), settled=False)["sprockets"]

    def centre(name: str) -> str:
        x, y = known[name]["centre"] if name in known else (np.nan, np.nan)
        return f"{1e3 * x:.1f}, {1e3 * y:.1f}"

    rows = [[*row, centre(row[0])] for row in told["rows"]]
    return table([*told["columns"], "centre x, y [mm]"], rows, len(told["columns"]) - 1)


def _load_case(run: xr.Dataset) -> Iterator[str]:
    """Motions, torques, forces, pretension and tensioners of the scene, a sentence each."""
    scene = tomllib.loads(str(run.attrs.get("resolved_scene", "")))
    for body in (*scene.get("sprockets", ()), *scene.get("shafts", ())):
        motion = body.get("motion", {})
        if motion.get("kind", "held") != "held":
            yield f"{body['name']}: motion {_acting(motion, 'rad')}."
        yield from _uses(body, {"drive": "N m", "load": "N m", **_FORCES}, body["name"])
    for chain in chains(run):
        pretension = chain.route.get("pretension")
        if pretension:
            of = f" of {chain.name}" if chain.name else ""
            yield f"Pretension{of} {_told(float(pretension), 'N')}."
    for tensioner in scene.get("tensioners", ()):
        push = tensioner.get("push", {})
        preload = push.get("preload")
        unit = "N m" if push.get("kind") == "torsion-spring" else "N"
        by = f", preload {_told(float(preload), unit)}" if preload is not None else ""
        kind = tensioner.get("carrier", {}).get("kind", "carrier")
        yield f"Tensioner {tensioner['name']}: {kind}, {push.get('kind', 'no push')}{by}."
        yield from _uses(tensioner, _FORCES, f"Tensioner {tensioner['name']}")


def _uses(body: Mapping[str, Any], units: Mapping[str, str], name: str) -> Iterator[str]:
    """Tell the torques and forces on a body, a sentence a list; ``units`` by the keys of lists."""
    for use, unit in units.items():
        acting = body.get(use, ())
        acting = [acting] if isinstance(acting, Mapping) else acting
        if acting:
            yield f"{name}: {use} {'; '.join(_acting(it, unit) for it in acting)}."


def _acting(it: Mapping[str, Any], unit: str) -> str:
    """Return a motion, a torque or a force in words; ``unit`` is that of its amplitudes."""
    words = [str(it.get("kind", ""))]
    words += [f"{key} {_told(float(it[key]), of)}" for key, of in _UNITS.items() if key in it]
    terms = [it] if "order" in it else it.get("terms", ())
    for term in terms:
        at = f"order {term['order']:g}" if "order" in term else f"{term.get('frequency', 0):g} Hz"
        words.append(f"{at} with {_told(float(term['amplitude']), unit)}")
    table = next((it[key] for key in ("torques", "forces") if key in it), None)
    if table is not None:
        values = np.asarray(table, dtype=float)
        low, high = _told(float(values.min()), unit), _told(float(values.max()), unit)
        words.append(f"from {low} to {high}")
    return ", ".join(words)


def _told(value: float, unit: str) -> str:
    """Return a value [SI] with six digits, as a scene has it, in a unit of the trade."""
    factor, name = in_trade(unit, value)
    return f"{factor * value:.6g} {name}"


def _verdict(told: Mapping[str, Any]) -> str:
    """Return a verdict and its worst reasons."""
    title, _, outcome = told["title"].partition(": ")
    on = "On the chain" if title.endswith("chain") else "On the numbers"
    first = " ".join(told["sentences"][:_SENTENCES])
    return f"<p><strong>{on}: {escaped(outcome)}.</strong> {escaped(first)}</p>"
