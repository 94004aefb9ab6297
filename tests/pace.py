"""The pace of this machine now, by the yardstick of the report: a fixed program of work."""

import statistics
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "benchmarks" / "report"))

from yardstick import QUIET, Yardstick  # noqa: E402


def slowness(runs: int = 20) -> float:
    """Return how many times the processor time of the reference, an idle AVX-512 machine, it takes.

    The reference is that on which budgets and the limit of a test are stated.
    """
    yardstick = Yardstick()
    return statistics.median(yardstick.time() for _ in range(runs)) / QUIET
