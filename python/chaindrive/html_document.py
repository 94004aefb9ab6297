"""One HTML file that needs nothing else: its frame, and diagrams in it."""

from __future__ import annotations

import io
from base64 import b64encode
from collections.abc import Callable, Sequence
from importlib.resources import files
from typing import TYPE_CHECKING

from chaindrive.errors import ChaindriveError
from chaindrive.extras import extra
from chaindrive.page import escaped

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["document", "picture"]

#: Width and height of a diagram [inches], and its dots per inch: sharp on paper, some 40 kB.
_SIZE = (7.2, 3.6)
_DOTS = 110


def document(title: str, parts: Sequence[str]) -> str:
    """Return a document of parts that are HTML already."""
    style = (files("chaindrive") / "report.css").read_text(encoding="utf-8")
    body = "\n".join(parts)
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escaped(title)}</title>\n<style>\n{style}</style>\n</head>\n"
        f"<body>\n<main>\n{body}\n</main>\n</body>\n</html>\n"
    )


def picture(title: str, draw: Callable[[Axes], object]) -> str:
    """Return a diagram as a figure of the document, or the sentence that says why there is none."""
    pyplot = extra("matplotlib.pyplot", "plots")
    from chaindrive.plot.scheme import STYLE

    with pyplot.rc_context(dict(STYLE)):
        figure, ax = pyplot.subplots(figsize=_SIZE, layout="constrained")
        try:
            draw(ax)
            drawn = io.BytesIO()
            figure.savefig(drawn, format="png", dpi=_DOTS)
        except (ChaindriveError, ModuleNotFoundError) as reason:
            return f"<h3>{escaped(title)}</h3>\n<p>{escaped(str(reason))}</p>"
        finally:
            pyplot.close(figure)
    data = b64encode(drawn.getvalue()).decode("ascii")
    caption = escaped(title)
    return (
        f'<figure><img src="data:image/png;base64,{data}" alt="{caption}">'
        f"<figcaption>{caption}</figcaption></figure>"
    )
