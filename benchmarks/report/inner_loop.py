"""The cost of a whole step, by drive."""

import chaindrive as cd
import registers
from page import Page
from stepping import Stretch, in_turn

# How many times as fast as the yardstick on the same registers.
WANTED = {"avx512": 3.8, "avx2": 3.5}


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
    """Write the table of the first drive on every set of registers."""
    found = registers.measure(page.pairs, 1 if page.quick else registers.ROUNDS)
    page.add(
        "The library takes the widest registers that the processor has, or those that "
        "`CHAINDRIVE_INSTRUCTION_SET` asks for. The first drive on each, in processes that take "
        "turns, its yardstick compiled for the same registers:",
    )
    page.table(
        ["registers", "ns", "yardstick over it", "least to greatest", "pairs"],
        [
            [kind, f"{row.ns:.1f}", f"{row.faster:.2f}", row.scatter, f"{len(row.own)}"]
            if row
            else [kind, "not on this processor", "", "", ""]
            for kind, row in found.items()
        ],
    )
    for kind, wanted in WANTED.items():
        row = found[kind]
        page.target(
            f"whole Verlet step, four sprockets, over the yardstick, both on {kind}",
            f"≥ {wanted:g} × as fast",
            f"{row.faster:.2f} × ({row.scatter})" if row else "not on this processor",
            row.faster >= wanted if row else None,
        )
