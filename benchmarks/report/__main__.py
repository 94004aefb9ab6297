"""Write docs/how-fast-how-accurate.md: what this machine measures of speed and error.

Run it as ``make report``, or ``python benchmarks/report [PART …] [--quick] [--docs FOLDER]``; with
parts it prints them instead. It takes some ten minutes and should have the machine to itself.
Every figure of speed is measured beside the yardstick, see yardstick.py; whatever was not measured
in this run says when it was.
"""

import argparse
import importlib
import os
import sys
import time
from pathlib import Path
from typing import Any

# One thread each, before anything that could open more is imported.
for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

import matplotlib as mpl  # noqa: E402

mpl.use("Agg")
# The same figure has the same bytes.
mpl.rcParams["svg.hashsalt"] = "chaindrive"

import numpy as np  # noqa: E402

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "benchmarks" / "peers"))

import provenance  # noqa: E402
from page import Page  # noqa: E402
from yardstick import QUIET, Yardstick  # noqa: E402

PARTS = (
    "inner_loop",
    "features",
    "length",
    "assembly",
    "real_time",
    "presets",
    "neighbours",
    "peers",
    "starting",
    "sweeps",
    "memory",
    "methods",
)


def head(page: Page, origin: dict[str, Any], begun: str, missing: list[str]) -> list[str]:
    """Return what stands above the parts: date, origin, yardstick, targets."""
    above = Page(page.quick, page.folder, page.yardstick)
    yardstick = np.array(page.yardstick.found)
    above.add(
        "# How fast, how accurate",
        "",
        provenance.dated(origin),
        "",
        "Written by `make report`; nothing on this page is typed by hand. Every target that was "
        "set is listed with what was found, met or not.",
        "",
        f"{begun}.",
        "",
        f"**The yardstick** is {page.yardstick.identity()}. It ran {len(yardstick)} times, before "
        f"every timed run, and took {np.median(yardstick):.1f} ns per link and step (median; "
        f"{np.quantile(yardstick, 0.1):.1f} to {np.quantile(yardstick, 0.9):.1f} in four fifths of "
        f"the runs). On a quiet machine of the kind on which the targets were set it takes "
        f"{QUIET:g} ns: *at rest* means scaled to that.",
    )
    if missing:
        above.add("", f"**Unfinished**, without the parts {', '.join(missing)}.")
    above.table(["target", "wanted", "found", ""], [target.row() for target in page.targets])
    return above.lines


def main() -> None:
    """Run the parts and write the page."""
    parser = argparse.ArgumentParser(description="Measure speed and error, and write the page.")
    parser.add_argument("parts", nargs="*", metavar="PART", help=f"of {', '.join(PARTS)}; all")
    parser.add_argument("--quick", action="store_true", help="only see that everything works")
    parser.add_argument("--docs", type=Path, default=ROOT / "docs", help="folder to write to")
    arguments = parser.parse_args()
    unknown = set(arguments.parts) - set(PARTS)
    if unknown:
        parser.error(f"unknown part {', '.join(sorted(unknown))}; there are {', '.join(PARTS)}")
    arguments.docs.mkdir(parents=True, exist_ok=True)
    origin = provenance.machine()
    begun = f"{provenance.told(origin)}; load {os.getloadavg()[0]:.1f} at the start"
    page = Page(arguments.quick, arguments.docs, Yardstick())
    parts = arguments.parts or PARTS
    file = page.folder / "how-fast-how-accurate.md"
    for done, part in enumerate(parts, start=1):
        begin, known = time.time(), len(page.lines)
        importlib.import_module(part).report(page)
        print("\n".join(page.lines[known:]), flush=True)
        print(f"{part}: {time.time() - begin:.0f} s", file=sys.stderr, flush=True)
        if not arguments.parts:
            # A run that is stopped leaves what it found, and says what it lacks.
            lines = head(page, origin, begun, list(parts[done:])) + page.lines
            file.write_text("\n".join(lines).rstrip() + "\n", encoding="utf-8")
    if arguments.parts:
        print("\n".join(head(page, origin, begun, [])))
        return
    print(f"written to {file}", file=sys.stderr)


if __name__ == "__main__":
    main()
