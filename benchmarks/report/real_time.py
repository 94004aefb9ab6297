"""Speed of runs as users ask for them: real-time factors at an accuracy, and their errors."""

import warnings
from dataclasses import dataclass
from time import process_time
from typing import Any

import numpy as np
import xarray as xr

import chaindrive as cd
from features import frictionless
from page import Page
from presets import found_error
from stepping import Pairs, Stretch, at_once, in_turn
from yardstick import QUIET


@dataclass(frozen=True)
class Asked:
    """A run as a user asks for it, and the stretch that stands for its stepping."""

    run: xr.Dataset
    stretch: Stretch
    whole: float
    """Processor time of the whole call per simulated second, at rest [–]."""

    def factor(self, pairs: Pairs) -> float:
        """Return simulated time over that of stepping where the yardstick takes its quiet time."""
        return 1e9 / (pairs.quiet * self.stretch.links * self.stretch.steps_per_second)


def ask(page: Page, drive: cd.Drive, until: float, **settings: Any) -> Asked:
    """Simulate with the default choice, and prepare the timing of its stepping."""
    drive = at_once(drive)
    until = 0.02 * until if page.quick else until
    before = page.yardstick.time()
    begin = process_time()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", cd.VerdictWarning)
        run = cd.simulate(
            drive, until=until, **({"every": until / 2000, "record": "span_tension"} | settings)
        )
    whole = process_time() - begin
    beside = 0.5 * (before + page.yardstick.time())
    chosen = {name: run.attrs[name] for name in ("method", "step")}
    if "onset_depth" in run.attrs:
        chosen["onset_depth"] = run.attrs["onset_depth"]
    return Asked(run, Stretch(drive, page.quick, **chosen), whole / until * QUIET / beside)


def report(page: Page) -> None:
    """Write the table of runs and answer the targets of speed."""
    page.add(
        "## Faster than real time",
        "",
        "Simulated over processor time with the default choice of method and step and an accuracy "
        "of 1 %, as it would be where the yardstick takes its quiet time: stepping alone, medians "
        f"of {page.pairs} pairs; and the whole call once, with assembly, trials, samples and "
        "estimate, without a run-in.",
    )
    marine, two = cd.scenes.marine_engine_bare(), cd.scenes.marine_two_sprockets()
    bicycle, timing = cd.scenes.bicycle(), cd.scenes.timing_drive()
    asked = {
        "marine engine as in the paper, 0.1 s": (marine, 0.1, 14.0),
        "marine engine as in the paper, 10 s": (marine, 10.0, 24.0),
        "timing drive, 0.4 s": (timing, 0.4, 0.5),
        "marine engine, 1 s": (cd.scenes.marine_engine(), 1.0, None),
        "large chain on two sprockets, 0.1 s": (two, 0.1, None),
        "large chain on two sprockets, 0.1 s, no friction": (frictionless(two), 0.1, None),
        "bicycle, 0.1 s": (bicycle, 0.1, None),
        "bicycle, 0.1 s, no friction": (frictionless(bicycle), 0.1, None),
    }
    if page.quick:
        asked = {name: asked[name] for name in list(asked)[:1]}
    ready = {name: ask(page, drive, until) for name, (drive, until, _) in asked.items()}
    runs = {name: it.stretch.time for name, it in ready.items()}
    found = in_turn(page.yardstick, runs, page.pairs)
    rows = []
    for name, it in ready.items():
        factor, wanted = it.factor(found[name]), asked[name][2]
        rows.append(
            [
                name,
                f"{it.stretch.method}, {1e6 * it.stretch.step:.3g}",
                f"{it.stretch.evaluations_per_second:.3g}",
                f"{found[name].faster:.2f}",
                f"{factor:.3g}",
                f"{1 / it.whole:.3g}",
                found_error(it.run.attrs),
            ]
        )
        if wanted is not None:
            page.target(
                f"{name}, stepping, at rest",
                f"≥ {wanted:g} × real time",
                f"{factor:.3g} × (whole call {1 / it.whole:.3g} ×)",
                factor >= wanted,
            )
    page.table(
        [
            "run",
            "method, step [µs]",
            "evaluations per simulated s",
            "yardstick over it, per link and step",
            "× real time, stepping",
            "× real time, whole call",
            "error found",
        ],
        rows,
    )
    if page.quick:
        return
    for name in ("large chain on two sprockets", "bicycle"):
        on, off = (f"{name}, 0.1 s{it}" for it in ("", ", no friction"))
        more = ready[off].factor(found[off]) / ready[on].factor(found[on])
        page.target(
            f"{name}: default friction in joints, time per simulated second at 1 %",
            "≤ 1.25 × without",
            f"{more:.2f} ×",
            more <= 1.25,
        )
    statistics(page, ready["marine engine as in the paper, 10 s"].run, marine)


def account(run: xr.Dataset) -> np.ndarray:
    """Return mean and rms of the tension of every span, the first tenth left out."""
    tension = run["span_tension"].values[run.sizes["time"] // 10 :]
    return np.concatenate([tension.mean(axis=0), np.sqrt((tension**2).mean(axis=0))])


def statistics(page: Page, run: xr.Dataset, drive: cd.Drive) -> None:
    """Hold the statistics of long runs against those of a finer method, ten replicates each."""
    until = float(run.attrs["until"])
    settings = {"until": until, "every": until / 2000, "record": "span_tension", "error": False}
    chosen = {"method": run.attrs["method"], "step": float(run.attrs["step"])}
    finer = {"method": "rk4", "step": 2e-5, "onset_depth": 1e-6}

    def replicates(**method: Any) -> np.ndarray:
        twins = (15e3 * (1 + 1e-9 * twin) for twin in range(10))
        drives = (at_once(drive).replace({"route.pretension": it}) for it in twins)
        return np.array([account(cd.simulate(near, **method, **settings)) for near in drives])

    found, exact = replicates(**chosen), replicates(**finer)
    centre = exact.mean(axis=0)
    spread = max(float(np.abs((it - it.mean(axis=0)) / centre).max()) for it in (found, exact))
    off = float(np.abs(found.mean(axis=0) / centre - 1).max())
    page.add(
        f"Over {until:g} s the means and rms of the spans' tensions, averages of ten runs that "
        f"begin with pretensions a billionth apart, lie within {100 * off:.2g} % of those of RK4 "
        "(20 µs, contacts begin no deeper than 1 µm); single runs scatter by "
        f"{100 * spread:.2g} % about the average of their kind.",
        "",
    )
    page.target(
        f"marine engine as in the paper, {until:g} s, statistics",
        "within the replicates' scatter",
        f"{100 * off:.2g} % off, scatter {100 * spread:.2g} %",
        off <= spread,
    )
