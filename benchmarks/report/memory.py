"""Largest memory of processes that simulate and record."""

import subprocess
import sys
import tempfile
from pathlib import Path

from page import Page

PROBE = """
import re, sys
import chaindrive as cd
drive = cd.scenes.marine_two_sprockets().replace({"run.run_in": 0})
until, output, record = float(sys.argv[1]), sys.argv[2], sys.argv[3].split(",")
options = {"output": output} if output else {}
options |= {"until": until, "every": 2e-4, "record": record, "method": "auto", "error": False}
run = cd.simulate(drive, **options)
# Not the largest resident set of the process, which begins with that of whoever started it.
peak = re.search("VmHWM:[^0-9]*([0-9]+) kB", open("/proc/self/status").read())
print(int(peak[1]) / 1024, run.nbytes / 1e6)
"""


def report(page: Page) -> None:
    """Write the table of memory."""
    if not Path("/proc/self/status").exists():
        page.add("## Memory", "", "Not measured now: read from Linux's /proc, absent here.", "")
        return
    page.add(
        "## Memory",
        "",
        "Largest memory of a process that simulates the two sprockets with a sample every 0.2 ms.",
    )
    spans = [0.05, 0.1] if page.quick else [4.0, 12.0]
    rows = []
    for name, record, stored in [
        ("tension of the spans, in memory", "span_tension", False),
        ("tension of all 112 links, in memory", "link_tension", False),
        ("tension of all 112 links, into a store", "link_tension", True),
    ]:
        found = []
        for until in spans:
            with tempfile.TemporaryDirectory() as folder:
                output = str(Path(folder) / "run.zarr") if stored else ""
                command = [sys.executable, "-c", PROBE, str(until), output, record]
                answer = subprocess.run(command, capture_output=True, text=True, check=True)
                found.append([float(word) for word in answer.stdout.split()])
        growth, recorded = ((found[1][i] - found[0][i]) / (spans[1] - spans[0]) for i in (0, 1))
        rows.append(
            [name, f"{found[0][0]:.0f}", f"{found[1][0]:.0f}", f"{growth:.1f}", f"{recorded:.1f}"]
        )
    first, second = (f"{until:g} s [MB]" for until in spans)
    page.table(
        ["recorded", first, second, "more a simulated second [MB]", "recorded a second [MB]"], rows
    )
