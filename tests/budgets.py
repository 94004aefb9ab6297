"""Holds `make run` and `make test` against their budgets in CONTRIBUTING.md, in processor time.

One follows the other in a fresh clone of the last commit, so that the tests find the package
installed. A budget is that of the reference; this machine is measured beside it, see pace.py.
"""

import os
import re
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

import pace

ROOT = Path(__file__).resolve().parent.parent
OVER = 1.15
COMMANDS = ["make run", "make test"]


def budget(command: str) -> float:
    """Return the budget of a command [s], from its row of the table."""
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    row = re.search(rf"^\| `{command}` \| ([\d\s]+?)\s*s \|", text, re.MULTILINE)
    if not row:
        sys.exit(f"CONTRIBUTING.md has no budget of `{command}` in its table")
    return float(re.sub(r"\s", "", row[1]))


def measured(command: str, folder: str) -> float:
    """Return the processor time of a command in a clone [s]."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    # Without the cache of the yardstick.
    bare = {name: value for name, value in os.environ.items() if "NUMBA" not in name}
    subprocess.run(command.split(), cwd=folder, env=bare, check=True, stdout=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main() -> None:
    """Measure every command, and name those above their budgets."""
    over = []
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run(["git", "clone", "--quiet", ROOT, folder], check=True)
        for command in COMMANDS:
            before = pace.slowness()
            seconds = measured(command, folder)
            slowness = (before + pace.slowness()) / 2
            allowed = budget(command) * slowness
            took = f"{seconds:.0f} CPU s of {allowed:.0f}"
            line = f"{command}: {took} at {slowness:.2f} × the reference"
            print(line, flush=True)
            if seconds > OVER * allowed:
                over.append(line)
    if over:
        sys.exit("above the budget by more than 15 %:\n" + "\n".join(over))


if __name__ == "__main__":
    main()
