"""Docstrings of plots: what most of them take, return and raise stands here once."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable
from typing import TypeVar

__all__ = ["completed"]

Plot = TypeVar("Plot", bound=Callable[..., object])

_SECTION = re.compile(r"\n\n(Parameters|Returns|Raises|Notes|Examples)\n-+\n")


def completed(
    *, run: str = "A run", of: str | None = None, chain: bool = False
) -> Callable[[Plot], Plot]:
    """Complete the docstring of a plot: what it says itself goes before what is usual.

    Parameters
    ----------
    run
        The run that is drawn.
    of
        The function of `chaindrive.analysis` that the plot draws; the one of its name when absent.
    chain
        Whether it draws one chain.
    """
    of_chain = "; the first chain is drawn unless ``chain`` names one" if chain else ""

    def complete(plot: Plot) -> Plot:
        if plot.__doc__ is None:  # as Python was told
            return plot
        usual = {
            "source": f"{run}, or what `chaindrive.analysis.{of or plot.__name__}` returned.",
            "ax": "Where to draw; new axes when absent.",
            "**options": f"Of a run, passed on to that function{of_chain}.",
        }
        summary, *parts = _SECTION.split(inspect.cleandoc(plot.__doc__))
        sections = dict(zip(parts[::2], parts[1::2], strict=True))
        own = re.split(r"\n(?=\S)", sections.get("Parameters", ""))
        said = {name: entry for entry in own for name in entry.partition("\n")[0].split(", ")}
        taken = inspect.signature(plot).parameters
        names = ["**" * (it.kind is it.VAR_KEYWORD) + it.name for it in taken.values()]
        entries = [said.get(name) or f"{name}\n    {usual[name]}" for name in names]
        found = {
            "Parameters": "\n".join(dict.fromkeys(entries)),
            "Returns": sections.get("Returns", "matplotlib.axes.Axes"),
            "Raises": sections.get("Raises", _REFUSES if "source" in taken else ""),
            "Notes": sections.get("Notes", ""),
            "Examples": sections.get("Examples", ""),
        }
        texts = [f"{title}\n{'-' * len(title)}\n{text}" for title, text in found.items() if text]
        plot.__doc__ = "\n\n".join([summary, *texts]) + "\n"
        return plot

    return complete


_REFUSES = """\
ParameterError
    The analysis refuses the run: the message names what to record, or what is absent."""
