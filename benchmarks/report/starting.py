"""Time until a command answers and the package is imported."""

import statistics
import sys
import sysconfig
from pathlib import Path
from subprocess import DEVNULL, run
from time import perf_counter

from page import Page


def report(page: Page) -> None:
    """Write the table of wall times and answer their targets."""
    program = Path(sysconfig.get_path("scripts")) / "chaindrive"
    commands = {
        "`python -c pass`": ([sys.executable, "-c", "pass"], None),
        "`import chaindrive`": ([sys.executable, "-c", "import chaindrive"], 0.5),
    }
    if program.exists():
        commands |= {
            "`chaindrive -V`": ([str(program), "-V"], 0.15),
            "`chaindrive --help`": ([str(program), "--help"], 0.15),
        }
    page.add(
        "## Starting",
        "",
        f"Wall time of whole processes, median of {page.pairs} after one that warms the caches of "
        "files; the first row is Python alone.",
    )
    rows = []
    for name, (command, most) in commands.items():
        found = []
        for _ in range(page.pairs + 1):
            begin = perf_counter()
            run(command, check=True, stdout=DEVNULL)
            found.append(perf_counter() - begin)
        median = statistics.median(found[1:])
        rows.append([name, f"{median:.3f}"])
        if most is not None:
            page.target(name, f"≤ {most:g} s", f"{median:.3f} s", median <= most)
    page.table(["command", "s"], rows)
