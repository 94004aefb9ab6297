"""How far each assumption moves what one reads off a drive: tables and a diagram."""

import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy import stats

import chaindrive as cd
from assumptions import Assumption, Case
from chaindrive.plot.scheme import CURVES, LIMIT, STYLE

#: What is read off a drive, and how it is called in the tables.
RESPONSES = ("mean", "scatter", "contact", "losses")
NAMES = {
    "mean": "tight span, mean",
    "scatter": "tight span, scatter",
    "contact": "contact force, 99 %",
    "losses": "share lost",
}


def statistics(case: Case, values: dict[str, Any], phases: tuple[float, ...]) -> np.ndarray:
    """Return responses (phase, response) of a preset with some values."""
    drive = getattr(cd.scenes, case.preset)().replace({"run.run_in": case.run_in, **values})
    runs = cd.sweep(drive, {"route.phase": list(phases)}, until=case.until, method="auto")
    failed = [text for text in runs["error"].values if text]
    if failed:
        raise RuntimeError(f"{case.preset} with {values}: {failed[0]}")
    tight = int(runs["span_tension_mean"].mean("phase").values.argmax())
    lost = runs["energy_dissipated_total"] / runs["energy_supplied_total"]
    return np.stack(
        [
            runs["span_tension_mean"].values[:, tight],
            runs["span_tension_std"].values[:, tight],
            runs["contact_force_p99"].values,
            lost.values,
        ],
        axis=1,
    )


@dataclass(frozen=True)
class Effect:
    """What one assumption does to each response, relative to the preset [–]."""

    assumption: Assumption
    #: (end, response), mean over the phases, and half width of its 95 % interval.
    change: np.ndarray
    half_width: np.ndarray

    def largest(self) -> float:
        """Return the largest relative change of any response."""
        return float(np.abs(self.change).max())


def effects(case: Case) -> tuple[np.ndarray, list[Effect]]:
    """Return responses of the preset, and the effects of its assumptions, the largest first."""
    count = len(case.phases)
    base = statistics(case, {}, case.phases)
    level = base.mean(0)
    # Student's t for the mean of differences, phase by phase.
    factor = stats.t.ppf(0.975, count - 1) / np.sqrt(count)
    all_effects = []
    for assumption in case.assumptions:
        print(f"{case.preset}: {assumption.name}", file=sys.stderr, flush=True)
        runs = [
            statistics(case, end, case.phases) - base if end else np.zeros_like(base)
            for end in assumption.ends
        ]
        change = np.array([run.mean(0) / level for run in runs])
        width = np.array([factor * run.std(0, ddof=1) / level for run in runs])
        all_effects.append(Effect(assumption, change, width))
    all_effects.sort(key=lambda effect: -effect.largest())
    return level, all_effects


def table(case: Case, level: np.ndarray, found: list[Effect]) -> Iterator[str]:
    """Yield lines of Markdown."""
    units = [
        f"{level[0]:.4g} N",
        f"{level[1]:.3g} N",
        f"{level[2]:.3g} N",
        f"{100 * level[3]:.3g} %",
    ]
    header = [f"{NAMES[name]}: {unit}" for name, unit in zip(RESPONSES, units, strict=True)]
    yield f"### {case.preset}"
    yield ""
    yield "| assumption | range | " + " | ".join(header) + " |"
    yield "|---|---|" + "---|" * len(RESPONSES)
    for effect in found:
        cells = []
        for response in range(len(RESPONSES)):
            ends = zip(effect.change[:, response], effect.half_width[:, response], strict=True)
            cells.append(", ".join(f"{100 * c:+.1f} ± {100 * w:.1f} %" for c, w in ends))
        row = [effect.assumption.name, effect.assumption.range, *cells]
        yield "| " + " | ".join(row) + " |"
    yield ""
    yield "The three that matter most, by their largest effect, and what would settle them:"
    yield ""
    for number, effect in enumerate(found[:3], 1):
        worst = int(np.abs(effect.change).max(0).argmax())
        by = 100 * np.abs(effect.change[:, worst]).max()
        yield (
            f"{number}. **{effect.assumption.name}** ({NAMES[RESPONSES[worst]]} by {by:.0f} %): "
            f"{effect.assumption.settled_by}."
        )
    yield ""


def draw(results: list[tuple[Case, np.ndarray, list[Effect]]], path: Path) -> None:
    """Draw a tornado a preset and response: bars from one end of the range to the other."""
    from matplotlib import pyplot as plt

    # Two beside each other: names are read at the width of a page.
    columns = 2
    rows = len(results) * len(RESPONSES) // columns
    with plt.rc_context(dict(STYLE)):
        figure, axes = plt.subplots(
            rows, columns, figsize=(9.5, 2.8 * rows), layout="constrained", squeeze=False
        )
        panels = [(case, found, number) for case, _, found in results for number in range(4)]
        for ax, (case, found, number) in zip(axes.flat, panels, strict=True):
            ranked = sorted(found, key=lambda effect: np.abs(effect.change[:, number]).max())
            places = np.arange(len(ranked))
            for end, label in enumerate(["lower end of the range", "upper end"]):
                change = [100 * effect.change[end, number] for effect in ranked]
                width = [100 * effect.half_width[end, number] for effect in ranked]
                look = {"color": CURVES[end], "alpha": 0.8, "height": 0.6, "label": label}
                error = {"lw": 0.8, "ecolor": LIMIT}
                ax.barh(places, change, xerr=width, error_kw=error, **look)
            ax.set_yticks(places, [effect.assumption.name for effect in ranked])
            ax.axvline(0.0, color=LIMIT, lw=0.8)
            ax.set_title(f"{case.preset}: {NAMES[RESPONSES[number]]}")
            ax.set_xlabel("change [%]")
        handles = axes.flat[0].get_legend_handles_labels()
        figure.legend(*handles, loc="outside upper center", ncols=2)
        figure.savefig(path, dpi=84)
        plt.close(figure)
