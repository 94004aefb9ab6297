"""Lists the twenty tests of each language that take the most processor time, each run by itself.

A test above 3 CPU s of the reference (see pace.py) fails here unless its reason stands beside it:
in Python `@pytest.mark.costs("reason")`, in Rust a comment `// Costs: reason` above `#[test]`.
"""

import contextlib
import io
import json
import re
import resource
import subprocess
import sys
from collections.abc import Generator
from pathlib import Path
from typing import NamedTuple

import pace
import pytest

ROOT = Path(__file__).resolve().parent.parent
MOST = 20
LIMIT = 3.0  # [s]
# A comment, whatever else stands between it and the function, and the name of that.
REASON = re.compile(r"// Costs: (.+)\n(?:\s*(?://|#\[).*\n)*\s*(?:async )?fn (\w+)")


class Cost(NamedTuple):
    """Processor time of a test [s], its own and that of its children, and the reason for it."""

    seconds: float
    name: str
    reason: str


def spent() -> float:
    """Return processor time of this process and of children that have ended [s]."""
    each = (resource.getrusage(it) for it in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(it.ru_utime + it.ru_stime for it in each)


def rust() -> list[Cost]:
    """Run every test of Rust in a process of its own."""
    build = ["cargo", "test", "--profile", "quick", "--workspace", "--tests", "--no-run", "--quiet"]
    told = subprocess.run(
        [*build, "--message-format", "json"],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        text=True,
        check=True,
    ).stdout
    costs = []
    for built in map(json.loads, told.splitlines()):
        if not (built.get("executable") and built["profile"]["test"]):
            continue
        place = Path(built["manifest_path"]).parent
        sources = "".join(it.read_text(encoding="utf-8") for it in place.rglob("*.rs"))
        reasons = {name: reason for reason, name in REASON.findall(sources)}
        for name in listed(built["executable"]) - listed(built["executable"], "--ignored"):
            begin = spent()
            command = [built["executable"], "--exact", name]
            subprocess.run(command, cwd=place, check=False, capture_output=True)
            reason = next((reasons[it] for it in name.split("::") if it in reasons), "")
            title = f"{place.name} {built['target']['name']} {name}"
            costs.append(Cost(spent() - begin, title, reason))
    return costs


def listed(executable: str, *options: str) -> set[str]:
    """Return the names of the tests in an executable."""
    command = [executable, "--list", "--format", "terse", *options]
    told = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    return set(re.findall(r"^(.+): test$", told, re.MULTILINE))


class Watch:
    """Notes what tests of Python cost; what several share is part of the first of them."""

    def __init__(self) -> None:
        self.costs: list[Cost] = []

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Generator[None, object, object]:
        """Take the time around a test, its fixtures included."""
        begin = spent()
        done = yield
        mark = item.get_closest_marker("costs")
        reason = str(mark.args[0]) if mark else ""
        self.costs.append(Cost(spent() - begin, item.nodeid, reason))
        return done


def python(arguments: list[str]) -> list[Cost]:
    """Run the tests of Python one after the other."""
    watch = Watch()
    with contextlib.redirect_stdout(io.StringIO()) as told:
        code = pytest.main(arguments, plugins=[watch])
    # A test that fails has its cost too.
    if code not in (pytest.ExitCode.OK, pytest.ExitCode.TESTS_FAILED):
        sys.exit(told.getvalue())
    return watch.costs


def main() -> None:
    """Print both lists, and what is above the limit without a reason; paths choose of Python's."""
    paths = sys.argv[1:]
    costs = {"Python": python(paths)} if paths else {"Rust": rust(), "Python": python([])}
    for language, found in costs.items():
        total = sum(it.seconds for it in found)
        print(f"{language}: {len(found)} tests, {total:.0f} CPU s")
        for seconds, name, reason in sorted(found, reverse=True)[:MOST]:
            print(f"{seconds:8.2f} s  {name}" + (f": {reason}" if reason else ""))
    limit = LIMIT * pace.slowness()
    above = [it for found in costs.values() for it in found if it.seconds > limit and not it.reason]
    if above:
        names = "\n".join(f"{it.seconds:8.2f} s  {it.name}" for it in sorted(above, reverse=True))
        sys.exit(f"above {limit:.1f} CPU s, {LIMIT} of the reference, and no reason:\n{names}")


# Workers of processes that start anew import this file.
if __name__ == "__main__":
    main()
