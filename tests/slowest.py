"""Lists the twenty slowest tests of Rust and of Python, each run alone in its lane."""

import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
MOST = 20


def rust() -> list[tuple[float, str]]:
    """Run the tests of Rust by nextest, which times each of them."""
    command = ["cargo", "nextest", "run", "--cargo-profile", "quick", "--no-fail-fast"]
    command += ["--workspace", "--tests"]
    told = subprocess.run(
        [*command, "--status-level", "pass", "--color", "never"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    ).stderr
    times = re.findall(
        r"^\s+(?:PASS|FAIL) \[\s*([\d.]+)s\](?: \([^)]*\))? (.+)$", told, re.MULTILINE
    )
    if not times:
        sys.exit(f"cargo-nextest times the tests of Rust; it said:\n{told}")
    return [(float(seconds), name) for seconds, name in times]


def main() -> None:
    """Print both lists."""
    print("Rust")
    for seconds, name in sorted(rust(), reverse=True)[:MOST]:
        print(f"{seconds:8.2f} s  {name}")
    print("Python")
    pytest = Path(sys.executable).parent / "pytest"
    told = subprocess.run(
        [pytest, "-q", f"--durations={MOST}", "--durations-min=0"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    ).stdout
    print(told[told.find("slowest") :])


main()
