"""The page as it grows, and the targets that it answers."""

from dataclasses import dataclass, field
from pathlib import Path

import matplotlib.pyplot as plt
from matplotlib.figure import Figure

from yardstick import Yardstick


@dataclass(frozen=True)
class Target:
    """One target and what was found."""

    name: str
    wanted: str
    found: str
    met: bool | None
    """None where nothing was measured now."""

    def row(self) -> list[str]:
        """Return the cells of its row."""
        words = {True: "met", False: "**missed**", None: "not measured now"}
        return [self.name, self.wanted, self.found, words[self.met]]


@dataclass
class Page:
    """Text, tables and figures in the order of the page."""

    quick: bool
    folder: Path
    yardstick: Yardstick
    lines: list[str] = field(default_factory=list)
    targets: list[Target] = field(default_factory=list)

    def add(self, *lines: str) -> None:
        """Add lines."""
        self.lines.extend(lines)

    def table(self, head: list[str], rows: list[list[str]]) -> None:
        """Add a table."""
        self.add("", "| " + " | ".join(head) + " |", "|" + "---|" * len(head))
        self.add(*("| " + " | ".join(row) + " |" for row in rows), "")

    def figure(self, figure: Figure, name: str, title: str) -> None:
        """Write a figure beside the page and show it there."""
        figure.savefig(self.folder / f"{name}.svg")
        plt.close(figure)
        self.add(f"![{title}]({name}.svg)", "")

    def target(self, name: str, wanted: str, found: str, met: bool | None) -> None:
        """Answer a target."""
        self.targets.append(Target(name, wanted, found, None if met is None else bool(met)))

    @property
    def pairs(self) -> int:
        """Number of pairs of yardstick and run of which the median is taken."""
        return 1 if self.quick else 7
