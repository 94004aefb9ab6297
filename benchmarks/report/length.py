"""The cost of a link and step against the length of the chain."""

from typing import Any

import matplotlib.pyplot as plt

import chaindrive as cd
from page import Page
from stepping import Pairs, Stretch, in_turn

COUNTS = (20, 50, 100, 200, 500, 1000, 2000, 5000)
FRICTION = {"none": {"kind": "none"}, "default": {"kind": "spring-slider", "coefficient": 0.1}}
MODELS = {"particles": 4e-6, "clearance-joints": 1e-6}


def chain(links: int, model: str, friction: str) -> cd.Drive:
    """Return two sprockets of ten teeth as far apart as a 16B chain reaches, without gravity."""
    pitch = 0.0254
    sprocket: dict[str, Any] = {"teeth": 10}
    return cd.Drive.from_dict(
        {
            "title": f"{links} links",
            "gravity": [0.0, 0.0],
            "chain": {"type": "16B-1", "model": model, "links": links},
            "contact": {"joints": {"friction": FRICTION[friction]}},
            "sprockets": [
                {
                    "name": "driving",
                    "centre": [0.0, 0.0],
                    "motion": {"kind": "constant", "speed": 10.0},
                }
                | sprocket,
                {"name": "driven", "centre": [0.5 * (links - 10) * pitch, 0.0], "inertia": 0.05}
                | sprocket,
            ],
            "route": {"pretension": "500 N"},
        }
    )


def report(page: Page) -> None:
    """Write table and figure, and answer the targets."""
    counts = COUNTS[:2] if page.quick else COUNTS
    page.add(
        "## Length of the chain",
        "",
        "Two sprockets of ten teeth, ever farther apart: ns per link and step, and in brackets how "
        "many times as fast as the yardstick. Steps of "
        f"{' and '.join(f'{1e6 * step:g} µs ({model})' for model, step in MODELS.items())} at any "
        "length.",
    )
    found: dict[str, list[Pairs]] = {}
    for links in counts:
        runs = {
            f"{model.replace('-', ' ')}, friction {'off' if friction == 'none' else 'on'}": Stretch(
                chain(links, model, friction), page.quick, step=step
            ).time
            for model, step in MODELS.items()
            for friction in FRICTION
        }
        for name, pairs in in_turn(page.yardstick, runs, page.pairs).items():
            found.setdefault(name, []).append(pairs)
    page.table(
        ["links", *map(str, counts)],
        [[name, *(f"{it.ns:.1f} ({it.faster:.2f})" for it in row)] for name, row in found.items()],
    )
    figure, axis = plt.subplots(figsize=(6.5, 3.6), layout="constrained")
    for name, row in found.items():
        style = "--" if name.endswith("on") else "-"
        colour = "C0" if name.startswith("particles") else "C1"
        axis.loglog(counts, [1 / it.faster for it in row], "o" + style, color=colour, label=name)
    axis.axhline(1.0, color="grey", lw=0.8)
    axis.annotate("yardstick", (counts[0], 1.05), color="grey", fontsize=8)
    axis.set_xticks(counts, [f"{links}" for links in counts])
    axis.set_xticks([], minor=True)
    axis.yaxis.set_major_formatter("{x:g}")
    axis.set_xlabel("links")
    axis.set_ylim(0.05, 50)
    axis.set_ylabel("time per link and step\nover that of the yardstick")
    axis.legend(fontsize=8, ncols=2)
    page.figure(figure, "cost_of_length", "Cost per link and step over the length of the chain")
    for name, row in found.items():
        first, last = row[0].quiet, row[-1].quiet
        page.target(
            f"cost per link and step, {counts[0]} to {counts[-1]} links, {name}",
            "falling or flat (within 10 %)",
            f"{first:.1f} to {last:.1f} ns at rest",
            last <= 1.1 * first,
        )
