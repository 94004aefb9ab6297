"""Figures in the prose of pages that say where they are from: `0.60<!-- timing_drive.run_in -->`.

What stands behind a preset is an attribute of its default run, or `mean` or `std` of the tension of
its tight span. Figures are of AVX-512: chaotic motions part on other instruction sets.
"""

import functools
import re
from pathlib import Path

import pytest
import xarray as xr

import chaindrive as cd

PAGES = sorted((Path(__file__).resolve().parents[2] / "docs").rglob("*.md"))
# Digits may stand in groups of three.
FIGURE = re.compile(r"(\d[\d ]*(?:\.(\d+))?)<!-- (\w+)\.(\w+)(?: in (\S+))? -->")
UNITS = {None: 1.0, "ms": 1e3, "µs": 1e6}
# Half of the last digit, or what another compiler makes of a chaotic motion.
TOLERANCE = 0.02


@functools.cache
def run_of(preset: str) -> xr.Dataset:
    drive = getattr(cd.scenes, preset)()
    return cd.simulate(drive, record="span_tension", error=False)


def value_of(preset: str, what: str) -> float:
    run = run_of(preset)
    if what not in ("mean", "std"):
        return float(run.attrs[what])
    tension = run["span_tension"]
    tight = tension.sel(span=tension.mean("time").idxmax("span"))
    return float(getattr(tight, what)())


@pytest.mark.slow
def test_figures_are_those_of_runs() -> None:
    if run_of("industrial_16b").attrs["instruction_set"] != "avx512":
        pytest.skip("the figures of the pages are of AVX-512")
    found = [(page.name, it) for page in PAGES for it in FIGURE.finditer(page.read_text("utf-8"))]
    assert len(found) >= 10
    wrong = []
    for page, it in found:
        printed, digits, preset, what, unit = it.groups()
        value = value_of(preset, what) * UNITS[unit]
        told = float(printed.replace(" ", ""))
        if abs(value - told) > max(0.5 * 10.0 ** -len(digits or ""), TOLERANCE * abs(value)):
            wrong.append(f"{page}: {it.group()} is {value:.6g}")
    assert not wrong, "\n".join(wrong)
