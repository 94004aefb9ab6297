"""A run as one file to hand on: pages to print, and a replay to watch in a browser."""

from __future__ import annotations

import html
import json
import re
from collections.abc import Callable, Iterator
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

import xarray as xr

from chaindrive._core import NewFile
from chaindrive.drive import Drive, load
from chaindrive.errors import ChaindriveError, ProgramError, WriteError, tell
from chaindrive.extras import extra
from chaindrive.front_page import front_page
from chaindrive.html_document import document, picture
from chaindrive.page import escaped, page_of, section, table
from chaindrive.replaying import replay
from chaindrive.simulation import simulate

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["named", "report"]

#: Frames of the replay in a report: half of its size, and enough for two turns of a sprocket.
_FRAMES = 400


def report(
    source: Drive | xr.Dataset | str | PathLike[str],
    path: str | PathLike[str] | None = None,
    *,
    comparison: xr.Dataset | None = None,
    reference: xr.Dataset | None = None,
) -> str:
    """Make the report of a run or a fit: one HTML file that needs nothing else, and prints well.

    The first page is what is signed: drive, load case, both verdicts, six numbers, limits; after it
    layout, page of the run, diagrams, inputs with their sources, replay, scene, build. What the
    run did not record, or the drive has not, is said in its place.

    Parameters
    ----------
    source
        A run; or a drive, or the file of a scene, which is simulated for it with its own settings
        and all channels; or the store of a result. Or what `calibrate` returned: then the page has
        its tables, diagrams of intervals, correlations and residuals, and the fitted scene.
    path
        Where to write, in place of what was there; absent: nowhere.
    comparison
        What `compare` returned of this run and a measurement: a section of the report.
    reference
        Another run with ``events="teeth"``: a section has the levels of impulses at mesh orders re
        it, by `chaindrive.analysis.impulse_level`.

    Returns
    -------
    str
        The text of the file.

    Raises
    ------
    ChaindriveError
        The drive cannot be read or simulated.
    ValueError
        The run has not ended, or an older version made it.
    WriteError
        The file cannot be written; what was in its place is still there.
    """
    place = None if path is None else NewFile(path)
    text = _report(source, comparison, reference)
    if place is not None:
        place.write(text.encode())
    return text


def _report(
    source: Drive | xr.Dataset | str | PathLike[str],
    comparison: xr.Dataset | None = None,
    reference: xr.Dataset | None = None,
) -> str:
    # Missed before anything is simulated.
    extra("matplotlib.pyplot", "plots")
    if isinstance(source, xr.Dataset) and "estimate" in source:
        from chaindrive.measurement.fit_report import fit_report

        return fit_report(source)
    return _of_run(_run(source), comparison, reference)


def _run(source: Drive | xr.Dataset | str | PathLike[str]) -> xr.Dataset:
    if isinstance(source, xr.Dataset):
        return source
    if not isinstance(source, Drive):
        place = Path(source)
        if place.suffix == ".zarr":
            from chaindrive.results import open_result

            return open_result(place)
        source = load(place)
    return simulate(source, record="all", events=["teeth"])


def _of_run(run: xr.Dataset, comparison: xr.Dataset | None, reference: xr.Dataset | None) -> str:
    about = run.attrs
    told = page_of(run)
    title = _title(run)
    verdict, *sections = told.sections
    parts = [
        f"<h1>{escaped(title)}</h1>",
        front_page(run, told),
        section(verdict, level=2),
        picture("The drive at the start", lambda ax: _layout(run, ax)),
        *(section(it, level=2) for it in sections),
        *_compared(comparison),
        *impulse_levels(run, reference),
        "<h2>Diagrams</h2>",
        *(picture(name, draw) for name, draw in _diagrams(run)),
        "<h2>Inputs and their sources</h2>",
        _inputs(str(about.get("resolved_scene", ""))),
        "<h2>Numerics</h2>",
        f"<pre>{escaped(told.numerics)}</pre>",
        _replay(run),
        "<h2>Scene</h2>",
        f"<pre>{escaped(str(about.get('scene', '')))}</pre>",
        "<h2>Build</h2>",
        "<p>"
        + escaped(
            f"chaindrive {about.get('chaindrive_version')}, build {about.get('chaindrive_build')}, "
            f"instruction set {about.get('instruction_set')}."
        )
        + "</p>",
    ]
    return document(title, parts)


def _compared(found: xr.Dataset | None) -> Iterator[str]:
    """Sections and diagrams of a comparison with a measurement; none without one."""
    if found is None:
        return
    from chaindrive import plot

    for told in json.loads(found.attrs["page"])["sections"]:
        yield section(told, level=2)
    for quantity in map(str, found["quantity"].to_numpy()):
        for title, draw in (
            ("over each other", plot.overlay),
            ("differences over their bands", plot.differences),
            ("orders", plot.compared_orders),
            ("distribution", plot.distribution),
        ):
            yield picture(
                f"{quantity}: {title}",
                lambda ax, draw=draw, it=quantity: draw(found, it, ax=ax),  # type: ignore[misc]
            )


def _title(run: xr.Dataset) -> str:
    return str(run.attrs.get("title") or run.attrs.get("scene_name") or "chain drive")


def impulse_levels(run: xr.Dataset, reference: xr.Dataset | None) -> Iterator[str]:
    """Section of the levels of impulses re another run; none without one."""
    if reference is None:
        return
    from chaindrive.analysis import impulse_level

    title = f"impulse level re {_title(reference)}"
    try:
        found = impulse_level(run, reference, name=_title(reference))
    except ChaindriveError as reason:
        yield section({"title": title, "columns": [], "rows": [], "sentences": [str(reason)]}, 2)
        return
    cells = [
        f"{float(at['level']):+.2f} ({float(at['low']):+.2f} to {float(at['high']):+.2f})"
        for name in found["sprocket"]
        for at in (found.sel(sprocket=name, order=order) for order in found["order"])
    ]
    orders = found.sizes["order"]
    rows = [
        [str(name), *cells[orders * row : orders * (row + 1)], f"{broadband:+.2f}"]
        for row, (name, broadband) in enumerate(
            zip(found["sprocket"].to_numpy(), found["broadband_level"].to_numpy(), strict=True)
        )
    ]
    columns = [f"mesh order {order:g} [dB]" for order in found["order"].to_numpy()]
    yield section(
        {
            "title": found["level"].attrs["long_name"],
            "columns": ["sprocket", *columns, "high orders [dB]"],
            "rows": rows,
            "sentences": [
                "In brackets: 95 % interval by blocks. High orders: the density of all impulses. "
                "Levels compare how contacts begin, and are no sound pressure."
            ],
        },
        2,
    )


def _layout(run: xr.Dataset, ax: Axes) -> None:
    from chaindrive import plot

    plot.layout(run, ax=ax)
    ax.set_title("")


def _diagrams(run: xr.Dataset) -> Iterator[tuple[str, Callable[[Axes], object]]]:
    """Diagrams with their titles; each is drawn when it is asked for."""
    from chaindrive import plot
    from chaindrive.plot.panels import orders

    for name, draw in (
        ("Tension of the spans", plot.tension),
        ("Force around the loop", plot.tension_around_loop),
        ("Orders in the tension", orders),
        ("Impacts", plot.impacts),
        ("Orders of the impulses on sprockets", plot.impulse_spectrum),
        ("Losses", plot.losses),
        ("Utilisation", plot.utilisation),
        ("Elongation by wear to the limit", plot.elongation),
    ):
        yield name, lambda ax, draw=draw: draw(run, ax=ax)  # type: ignore[misc]


#: A line of a scene in full: key, value, and after them its unit and source.
_LINE = re.compile(r"^(?P<key>[\w\-]+) = (?P<value>.*?)(?: # (?P<source>.*))?$")
#: A number with more digits than anybody gave.
_LONG = re.compile(r"-?\d+\.\d{8,}")
_HEADING = re.compile(r"^\[+(?P<name>[^\]]+)\]+$")


def _inputs(scene: str) -> str:
    """Return all inputs that say where they are from, as a table; assumed ones are marked."""
    place, rows = "", []
    entries: dict[str, int] = {}
    for line in scene.splitlines():
        if heading := _HEADING.match(line):
            name = heading["name"]
            if line.startswith("[["):
                # The lists within an entry begin anew with it.
                entries = {it: n for it, n in entries.items() if not it.startswith(f"{name}.")}
                entries[name] = entries.get(name, -1) + 1
            place = _numbered(name, entries) + "."
        elif (found := _LINE.match(line)) and found["source"]:
            value = _LONG.sub(lambda it: f"{float(it[0]):.7g}", found["value"])
            shown = value if len(value) <= 60 else value[:57] + "…"
            mark = "assumed" if "assumed" in found["source"] else ""
            rows.append([place + found["key"], shown, mark, found["source"]])
    if not rows:
        return "<p>The result holds no scene in full.</p>"
    listed = table(["input", "value", "", "unit, source"], rows, figures=0)
    return f'<div class="inputs">\n{listed}\n</div>'


def _numbered(name: str, entries: dict[str, int]) -> str:
    """Return the path of a heading with the numbers of the entries of lists that it is in."""
    path, steps = "", name.split(".")
    for count, step in enumerate(steps, 1):
        number = entries.get(".".join(steps[:count]))
        path += f".{step}" if number is None else f".{step}[{number}]"
    return path[1:]


def _replay(run: xr.Dataset) -> str:
    try:
        film = replay(run, frames=_FRAMES).html
    except (ChaindriveError, KeyError) as reason:
        told = reason.args[0] if isinstance(reason, KeyError) else reason
        return f"<h2>Replay</h2>\n<p>{escaped(str(told))}</p>"
    return (
        '<section class="replay">\n<h2>Replay</h2>\n'
        f'<iframe srcdoc="{html.escape(film)}" title="replay"></iframe>\n</section>'
    )


def command(source: str, output: Path, place: NewFile, *, quiet: bool) -> int:
    """Make the report that a command line asks for, and return the exit code."""
    if output.suffix not in (".html", ".htm"):
        tell(f"{output}: the name must end in .html")
        return 2
    try:
        text = _report(named(source)).encode()
        place.write(text)
    except (ProgramError, WriteError):
        raise
    except (ChaindriveError, ValueError, OSError, ModuleNotFoundError) as error:
        tell(f"{source}: {error}")
        return 2
    if not quiet:
        tell(f"{output}: {len(text) / 1e6:.2f} MB")
    return 0


def named(source: str) -> Drive | str:
    """Return the drive of a preset, where no file has its name."""
    from chaindrive import scenes

    if not Path(source).exists() and source in scenes.__all__:
        drive: Drive = getattr(scenes, source)()
        return drive
    return source
