"""Links that open drives of the documentation in the lab, which stands on the site as one page.

A build of the package without the lab makes a site without it.
"""

import shutil
from pathlib import Path
from typing import Any

from docutils import nodes
from docutils.parsers.rst import Directive
from IPython.display import HTML, display
from sphinx.application import Sphinx

import chaindrive as cd
from chaindrive.lab_page import PAGE

#: The lab on the site; `lab.html` is the page that tells of it.
ADDRESS = "live-lab.html"

WORDS = "Open this drive in the lab: your browser computes it, and you change it while it runs."


def paragraph(drive: cd.Drive, page: str) -> str:
    """Return a paragraph of HTML that opens a drive in the lab at an address."""
    return f'<p><a href="{cd.lab_link(drive, page)}">{WORDS}</a></p>'


def in_lab(drive: cd.Drive) -> None:
    """Show a link to a drive, on a page one folder below the first one."""
    if PAGE.exists():
        display(HTML(paragraph(drive, f"../{ADDRESS}")))


class LabLink(Directive):
    """``{lab-link} preset``: a line that opens a preset in the lab."""

    required_arguments = 1
    has_content = False

    def run(self) -> list[nodes.Node]:
        if not PAGE.exists():
            return []
        drive = getattr(cd.scenes, self.arguments[0])()
        return [nodes.raw("", paragraph(drive, ADDRESS), format="html")]


def bring_page(app: Sphinx, failed: Exception | None) -> None:
    """Put the lab beside the pages."""
    if failed is None and PAGE.exists():
        shutil.copyfile(PAGE, Path(app.outdir) / ADDRESS)


def setup(app: Sphinx) -> dict[str, Any]:
    app.add_directive("lab-link", LabLink)
    app.connect("build-finished", bring_page)
    # Pages that were read with another choice are read anew.
    version = 1 + PAGE.exists()
    return {"env_version": version, "parallel_read_safe": True, "parallel_write_safe": True}
