"""Other programs beside this one: timed now where they are installed, else named as of when."""

import importlib.metadata
import json
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np

import provenance
from page import Page
from yardstick import PEERS

STORED = PEERS / "results.json"
# Least ratios of processor times at equal error.
WANTED = {"numba": 4.0, "exudyn": 3000.0}
# Simulated time of a timed run [s]; Exudyn takes a second for a few milliseconds.
LENGTH = {"numba": 0.5, "scipy": 0.05, "exudyn": 0.005}
# Steps at which chaindrive and the numba program are compared, being the same model.
STEPS = (2e-5, 1e-4 / 7, 1e-5, 5e-6)
OURS = 0.5  # [s]


def installed(program: str, stored: dict[str, Any]) -> str | None:
    """Tell why a program cannot be timed now; its errors are those of the version on file."""
    wanted = stored["machine"]["versions"][program]
    try:
        found = importlib.metadata.version(program)
    except importlib.metadata.PackageNotFoundError:
        return "not installed"
    return (
        None if found == wanted else f"version {found} is installed, errors are known of {wanted}"
    )


def cost(
    program: str, drive: dict[str, Any], setting: list[Any], until: float
) -> Callable[[], float]:
    """Return a run of a program that gives its processor time per simulated second."""
    import compare

    run = compare.runner(program, drive)

    def timed() -> float:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DeprecationWarning)
            result = run(tuple(setting), until, min(until, 1e-3))
        return result.cpu / result.length

    return timed


def beside(
    ours: Callable[[], float], theirs: Callable[[], float], pairs: int
) -> tuple[float, float, float]:
    """Time two programs in turn; return median, least and greatest of the ratios of the pairs."""
    ours(), theirs()
    ratios = []
    for _ in range(pairs):
        mine = ours()
        ratios.append(theirs() / mine)
    return float(np.median(ratios)), min(ratios), max(ratios)


def report(page: Page) -> None:
    """Write the tables of programs and answer their targets."""
    stored = json.loads(STORED.read_text(encoding="utf-8"))
    page.add(
        "## Beside other programs",
        "",
        "The same drive, processor time of stepping at equal error of the tight span (≤ "
        f"{100 * stored['allowed_error']:g} %). What is measured now is the ratio of times, in "
        "pairs; errors belong to program, version and setting and are those on file. Programs that "
        "are not measured now are named, with the measurement that their figures come from. How, "
        "and what to read into it: [benchmarks/peers](../benchmarks/peers/README.md).",
    )
    drive = page.yardstick.drive
    rows = []
    for program, best in stored["ratios"].items():
        why = installed(program, stored)
        until = (0.1 if page.quick else 1.0) * LENGTH[program]
        errors = f"{100 * best['error'][1]:.2g} % against {100 * best['error'][0]:.2g} %"
        if why is None:
            ratio, least, most = beside(
                cost("chaindrive", drive, best["chaindrive"], (0.1 if page.quick else 1.0) * OURS),
                cost(program, drive, best["theirs"], until),
                page.pairs,
            )
            text, when = f"{ratio:.3g} ({least:.3g} to {most:.3g})", "now"
        else:
            ratio, text = best["ratio"], f"{best['ratio']:.3g}"
            when = f"**not measured now** ({why}); as of {stored['machine']['date']}"
        rows.append([program, text, errors, setting(best["theirs"]), when])
        if program in WANTED:
            page.target(
                f"times as fast as {program} at equal error",
                f"≥ {WANTED[program]:g}",
                text if why is None else f"{text}, as of {stored['machine']['date']}",
                ratio >= WANTED[program] if why is None else None,
            )
    page.table(["program", "its time over ours", "its error against ours", "setting", "when"], rows)
    page.add(f"Errors on file: {provenance.told(stored['machine'])}.", "")
    equal_steps(page)


def setting(words: list[Any]) -> str:
    """Put method and step in words."""
    return f"{words[0]} {words[1]:g}"


def equal_steps(page: Page) -> None:
    """Compare with the numba program at equal steps, at which the motions agree to rounding."""
    drive = page.yardstick.drive
    share = 0.1 if page.quick else 1.0
    page.add(
        "The numba program and chaindrive are the same model. At an equal step chaindrive errs "
        "less, since its Verlet takes the damping of teeth at the end of the step; meanwhile "
        "`simulate` watches every step:",
    )
    row = []
    for step in STEPS[:1] if page.quick else STEPS:
        ratio, least, most = beside(
            cost("chaindrive", drive, ["verlet", step, None], share * OURS),
            cost("numba", drive, ["verlet", step], share * LENGTH["numba"]),
            page.pairs,
        )
        row.append((f"{1e6 * step:.3g} µs", f"{ratio:.2f} ({least:.2f} to {most:.2f})"))
    page.table(
        ["Verlet with steps of", *(name for name, _ in row)],
        [["time of numba over ours", *(text for _, text in row)]],
    )
