"""The cost of a whole step, by drive."""

import json

import chaindrive as cd
import provenance
from older_registers import STORED
from page import Page
from stepping import Stretch, in_turn


def report(page: Page) -> None:
    """Write the table of whole steps."""
    page.add(
        "## The inner loop",
        "",
        "Whole step with the method and step of a simulation that nobody asked for an accuracy: "
        "forces, contacts, energy ledger, step control. Nanoseconds per link and step of processor "
        f"time, medians of {page.pairs} pairs with the yardstick; *at rest*, what it would be "
        "where the yardstick takes its quiet time.",
    )
    marine = cd.scenes.marine_engine_bare()
    drives = {
        "marine engine as in the paper, four sprockets, no guides": marine.replace({"guides": []}),
        "marine engine as in the paper, three guide bars": marine,
        "marine engine": cd.scenes.marine_engine(),
        "large chain on two sprockets": cd.scenes.marine_two_sprockets(),
        "16B on two sprockets": cd.scenes.industrial_16b(),
        "timing drive": cd.scenes.timing_drive(),
        "bicycle, clearance joints": cd.scenes.bicycle(),
    }
    if page.quick:
        drives = {name: drives[name] for name in list(drives)[:2]}
    stretches = {name: Stretch(drive, page.quick) for name, drive in drives.items()}
    runs = {name: stretch.time for name, stretch in stretches.items()}
    found = in_turn(page.yardstick, runs, page.pairs)
    page.table(
        [
            "drive",
            "method, step [µs]",
            "ns",
            "yardstick over it",
            "least to greatest",
            "ns at rest",
        ],
        [
            [
                name,
                f"{stretches[name].method}, {1e6 * stretches[name].step:.3g}",
                f"{pairs.ns:.1f}",
                f"{pairs.faster:.2f}",
                pairs.scatter,
                f"{pairs.quiet:.1f}",
            ]
            for name, pairs in found.items()
        ],
    )
    other_registers(page)
    first = next(iter(found.values()))
    page.target(
        "whole Verlet step, four sprockets, over the yardstick",
        "≥ 5 × as fast",
        f"{first.faster:.2f} × ({first.scatter})",
        first.faster >= 5.0,
    )


def other_registers(page: Page) -> None:
    """Write the table of builds that take other registers: as it was found, not now."""
    stored = json.loads(STORED.read_text(encoding="utf-8"))
    widest, *_ = stored.values()
    page.add(
        "The library takes the widest registers that the processor has (AVX-512, AVX2, SSE2) and "
        "cannot be told to take others. What others do was found with builds that do not take "
        "the wider ones, on a processor that has all: the first drive, its yardstick with all "
        f"registers throughout, medians of {widest['pairs']} pairs. **Not measured now**; as of "
        f"{widest['machine']['date']}.",
    )
    page.table(
        ["registers", "ns", "yardstick over it", "least to greatest", "library"],
        [
            [
                kind,
                f"{row['ns']:.1f}",
                f"{row['ratio']:.2f}",
                row["scatter"],
                row["machine"]["library"],
            ]
            for kind, row in stored.items()
        ],
    )
    page.add(
        f"On file: {provenance.told(widest['machine'])}. How they were built: "
        "`benchmarks/report/older_registers.py`.",
        "",
    )
