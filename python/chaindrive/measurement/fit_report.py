"""The report of a fit: verdict, tables, diagrams, and the drive that came of it."""

from __future__ import annotations

import json

import xarray as xr

from chaindrive import _core
from chaindrive.html_document import document, picture
from chaindrive.page import escaped, section

__all__ = ["fit_report"]


def fit_report(fit: xr.Dataset) -> str:
    """Return the report of a fit as HTML.

    Parameters
    ----------
    fit
        What `calibrate` returned; a refused fit says why, with the diagrams that there are.
    """
    from chaindrive import plot

    about = fit.attrs
    told = json.loads(str(about["page"]))["sections"]
    pictures = (
        ("Parameters between their bounds", plot.fit_intervals),
        ("Correlation of their errors", plot.fit_correlations),
        ("What is left of every feature", plot.fit_residuals),
    )
    scene = about.get("scene")
    title = f"Fit of {about.get('scene_name') or 'a drive'}"
    return document(
        title,
        [
            f"<h1>{escaped(title)}</h1>",
            section(told[0], level=2),
            *(picture(name, lambda ax, draw=draw: draw(fit, ax=ax)) for name, draw in pictures),  # type: ignore[misc]
            *(section(it, level=2) for it in told[1:]),
            "<h2>The drive</h2>",
            "<p>No drive comes of a fit that is refused.</p>"
            if scene is None
            else f"<pre>{escaped(str(scene))}</pre>",
            "<h2>Build</h2>",
            f"<p>{escaped(f'chaindrive {_core.__version__}, build {_core.__build__}.')}</p>",
        ],
    )
