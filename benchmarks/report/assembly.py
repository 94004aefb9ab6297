"""Processor time before the first step against the length of the chain."""

import statistics
from collections.abc import Callable
from time import process_time

import matplotlib.pyplot as plt

import chaindrive as cd
from length import chain
from page import Page

COUNTS = (250, 500, 1000, 2000, 4000, 5000, 8000)
TEETH = 40
PITCH = 0.0254


def long_chain(links: int) -> cd.Drive:
    """Return two sprockets of forty teeth with a load, and a chain that sags between them."""
    scene = chain(links, "particles", "default").to_dict()
    del scene["gravity"]
    driving, driven = scene["sprockets"]
    driving["teeth"] = driven["teeth"] = TEETH
    driven["centre"] = [0.5 * (links - TEETH) * PITCH - 0.0005, 0.0]
    driven["load"] = [{"kind": "constant", "torque": -100.0}]
    scene["route"] = {
        "pretension": "1000 N",
        "adjust": {"kind": "sprocket", "name": "driven", "direction": [1, 0], "within": "20 mm"},
    }
    return cd.Drive.from_dict(scene)


def processor_time(work: Callable[[], object], runs: int) -> float:
    """Return the median of so many runs [s]."""
    found = []
    for _ in range(runs):
        begin = process_time()
        work()
        found.append(process_time() - begin)
    return statistics.median(found)


def report(page: Page) -> None:
    """Write table and figure, and answer the targets."""
    counts = COUNTS[:2] if page.quick else COUNTS
    page.add(
        "## Assembly of long chains",
        "",
        f"Two sprockets of {TEETH} teeth with gravity, pretension and load, ever farther apart: "
        f"processor time in seconds until the drive is ready to move, and until it is described, "
        f"medians of {page.pairs}; iterations of the statics under pretension, gravity and load.",
    )
    ready, described, iterations = [], [], []
    for links in counts:
        drive = long_chain(links)
        ready.append(processor_time(drive.statics, page.pairs))
        described.append(processor_time(drive.describe, page.pairs))
        iterations.append([stage["iterations"] for stage in drive.describe()["statics"]])
    page.table(
        ["links", *map(str, counts)],
        [
            ["ready to move [s]", *(f"{it:.3f}" for it in ready)],
            ["described [s]", *(f"{it:.3f}" for it in described)],
            ["iterations", *("–".join(map(str, it)) for it in iterations)],
        ],
    )
    figure, axis = plt.subplots(figsize=(6.5, 3.2), layout="constrained")
    axis.loglog(counts, ready, "o-", label="ready to move")
    axis.loglog(counts, described, "s--", label="described")
    axis.set_xticks(counts, [f"{links}" for links in counts])
    axis.set_xticks([], minor=True)
    axis.set_xlabel("links")
    axis.set_ylabel("processor time [s]")
    axis.legend(fontsize=8)
    page.figure(figure, "assembly_of_length", "Processor time before the first step")
    if not page.quick:
        at = dict(zip(counts, ready, strict=True))
        name = "two sprockets, ready to move"
        page.target(f"{name}, 5000 links", "≤ 1 s", f"{at[5000]:.2f} s", at[5000] <= 1.0)
        ratio = at[8000] / at[4000]
        page.target(f"{name}, 8000 over 4000 links", "≤ 2.3", f"{ratio:.2f}", ratio <= 2.3)
