"""Links that open drives of the documentation in the lab, which stands on the site as one page.

A build of the package without the lab makes a site without it.
"""

import shutil
from pathlib import Path
from typing import Any

from docutils import nodes
from docutils.parsers.rst import Directive
from sphinx.application import Sphinx

import chaindrive as cd
from chaindrive.lab_page import PAGE

WORDS = "Open this drive in the lab: your browser computes it, and you change it while it runs."


class Shown:
    """A link as a notebook shows it; nothing in a build without a lab."""

    def __init__(self, drive: cd.Drive, page: str) -> None:
        self._link = cd.lab_link(drive, page)

    def _repr_html_(self) -> str:
        return f'<p><a href="{self._link}">{WORDS}</a></p>' if PAGE.exists() else ""

    def __repr__(self) -> str:
        return ""


def in_lab(drive: cd.Drive) -> Shown:
    """Show a link to a drive, from a page one folder below the first one."""
    return Shown(drive, "../lab.html")


class LabLink(Directive):
    """``{lab-link} preset``: a line that opens a preset in the lab."""

    required_arguments = 1
    has_content = False

    def run(self) -> list[nodes.Node]:
        if not PAGE.exists():
            return []
        link = cd.lab_link(getattr(cd.scenes, self.arguments[0])())
        return [nodes.raw("", f'<p><a href="{link}">{WORDS}</a></p>', format="html")]


def bring_page(app: Sphinx, failed: Exception | None) -> None:
    """Put the lab beside the pages."""
    if failed is None and PAGE.exists():
        shutil.copyfile(PAGE, Path(app.outdir) / "lab.html")


def setup(app: Sphinx) -> dict[str, Any]:
    app.add_directive("lab-link", LabLink)
    app.connect("build-finished", bring_page)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
