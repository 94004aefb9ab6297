"""The page of a run: what a chain engineer asks of it, as text, in a notebook, in a report."""

from __future__ import annotations

import html
import json
import sys
from typing import Any

import xarray as xr

from chaindrive import _core

__all__ = ["Page", "page_of"]


class Page:
    """The page of a run, in the order of a design review and the units of the trade.

    Verdict, what the drive does, tensions, bearings and guides, impacts, tensioners,
    irregularity, losses, utilisation, assumed inputs, what next. `print` shows it as text, a
    notebook as tables.
    """

    def __init__(
        self,
        text: str,
        sections: list[dict[str, Any]],
        numerics: str,
        front: dict[str, Any] | None = None,
    ) -> None:
        self.text = text
        """The page as text."""
        self.sections = sections
        """Its sections: ``title``, ``columns``, ``rows`` and ``sentences``, all of them text."""
        self.front = front or {}
        """Six numbers that are signed, a section for the first page of a report."""
        self.numerics = numerics
        """Steps, contacts, energy and errors of the run, as text."""

    def __str__(self) -> str:
        return self.text

    def __repr__(self) -> str:
        return self.text

    def _repr_html_(self) -> str:
        return "\n".join(section(it) for it in self.sections)


def page_of(run: xr.Dataset) -> Page:
    """Return the page of a run.

    Parameters
    ----------
    run
        A run that ended, in memory or opened from a store.

    Raises
    ------
    ValueError
        The dataset is no run of chaindrive, or has no page: it did not end, or is older. Or the
        page is damaged.

    Examples
    --------
    >>> import chaindrive as cd
    >>> run = cd.simulate(cd.scenes.spinning_ring(), until=2e-3, error=False)
    >>> str(run.drive.summary()).splitlines()[0]
    'verdict: caution'
    """
    attributes = run.attrs
    missing = [name for name in ("summary", "page", "numerics") if name not in attributes]
    if missing:
        raise ValueError(
            "this dataset has no page of a run: "
            "the run has not ended, or a version before 0.3 made it; simulate it again"
        )
    try:
        told = json.loads(str(attributes["page"]))
        # A result of 0.3.0 has no first page.
        texts = _told(attributes, "summary"), _told(attributes, "numerics")
        page = Page(texts[0], told["sections"], texts[1], told.get("front"))
        page._repr_html_()
    except (ValueError, KeyError, TypeError, IndexError, AttributeError) as error:
        raise ValueError(f"the page of this run is damaged: {error!r}") from error
    return page


def _told(attributes: dict[str, Any], name: str) -> str:
    return _core.plain(str(attributes[name]))


def escaped(text: str) -> str:
    """Return a text as HTML; texts of others have no characters in it that are not seen."""
    return html.escape(_core.plain(text))


def section(told: dict[str, Any], level: int = 4) -> str:
    """Return a section as HTML, its heading of a level."""
    parts = [f"<h{level}>{escaped(_heading(told['title']))}</h{level}>"]
    if told["rows"]:
        # Words after the names stand left as well: "drives", "mm".
        words = 1 + (not any(it.isdigit() for it in told["rows"][0][1]))
        parts.append(table(told["columns"], told["rows"], len(told["columns"]) - words))
    parts += [f"<p>{escaped(sentence)}</p>" for sentence in told["sentences"]]
    return "\n".join(parts)


def table(columns: list[str], rows: list[list[str]], figures: int | None = None) -> str:
    """Return a table as HTML: names on the left, figures on the right.

    ``figures`` is the number of columns at the end that are figures; all but the first if absent.
    """
    names = 1 if figures is None else len(columns) - figures
    head = "".join(f"<th>{escaped(name)}</th>" for name in columns)
    sides = ["left"] * names + ["right"] * (len(columns) - names)
    body = "\n".join(
        "<tr>"
        + "".join(
            f'<td style="text-align: {side}">{escaped(cell)}</td>'
            for side, cell in zip(sides, row, strict=True)
        )
        + "</tr>"
        for row in rows
    )
    return f"<table>\n<thead><tr>{head}</tr></thead>\n<tbody>\n{body}\n</tbody>\n</table>"


def _heading(title: str) -> str:
    return title[:1].upper() + title[1:]


def show_verdicts() -> None:
    """Let a notebook show the verdict of a run above its dataset; nothing elsewhere."""
    shell = getattr(sys.modules.get("IPython"), "get_ipython", lambda: None)()
    if shell is None or shell.display_formatter is None:
        return
    formatter = shell.display_formatter.formatters["text/html"]
    formatter.for_type(xr.Dataset, _with_verdict)


def _with_verdict(dataset: xr.Dataset) -> str:
    shown = str(dataset._repr_html_())
    if "page" not in dataset.attrs or "verdict" not in dataset.attrs:
        return shown
    try:
        return section(page_of(dataset).sections[0]) + "\n" + shown
    except (ValueError, IndexError):
        return shown
