"""Five replicates of every run, and what survives them: shared by the scripts beside it.

A replicate is the same drive begun elsewhere: with its first sprocket at another place within a
tooth (`route.phase`). Means do not depend on it, waveforms do, and beyond the horizon of chaos the
five runs are as good as independent.
"""

from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

import chaindrive as cd

PHASES = (0.1, 0.3, 0.5, 0.7, 0.9)
# Student's t with four degrees of freedom, 99 %: one of a hundred comparisons of equal drives finds
# a difference by chance.
CHANCE = 4.604
JOBS = 2

Measure = Callable[[cd.Drive], dict[str, Any]]
Case = dict[str, np.ndarray]
"""Quantities by name, each (replicates,); a spectrum (replicates, frequencies)."""


def starts(drive: cd.Drive) -> list[cd.Drive]:
    """Return the replicates of a drive."""
    return [drive.replace({"route.phase": phase}) for phase in PHASES]


def study(drives: Mapping[str, cd.Drive], measure: Measure) -> dict[str, Case]:
    """Measure five replicates of every drive, two at a time."""
    with ThreadPoolExecutor(JOBS) as pool:
        rows = {
            name: [pool.submit(measure, start) for start in starts(drive)]
            for name, drive in drives.items()
        }
        five = {name: [row.result() for row in several] for name, several in rows.items()}
    return {
        name: {key: np.array([row[key] for row in several]) for key in several[0]}
        for name, several in five.items()
    }


def half_width(values: np.ndarray) -> float:
    """Half of the 99 % interval of a mean over replicates."""
    return CHANCE * float(np.std(values, ddof=1)) / np.sqrt(len(values))


def p99(force: np.ndarray) -> float:
    """99th percentile of forces [N] of what bears any, as runs and sweeps state it."""
    loaded = force[force > 0.0]
    return float(np.percentile(loaded, 99)) if loaded.size else 0.0


def difference(base: np.ndarray, other: np.ndarray) -> tuple[float, float]:
    """Return by how much `other` is larger in the mean, and half of the 99 % interval.

    Replicates that began alike are compared with each other.
    """
    apart = other - base
    return float(apart.mean()), half_width(apart)


def verdict(base: np.ndarray, other: np.ndarray) -> str:
    """Say by how much `other` differs from `base`, in per cent of it, or that chance may do it."""
    by, scatter = difference(base, other)
    if not np.isfinite(by):
        return "not comparable"
    if base.mean() == 0.0:
        return "only here" if abs(by) > scatter else "≈"
    scale = 100.0 / abs(base.mean())
    if abs(by) <= scatter:
        return f"≈ (± {_short(scale * scatter)} %)"
    digits = int(np.clip(1 - np.floor(np.log10(max(scale * scatter, 1e-3))), 0, 2))
    return f"**{scale * by:+.{digits}f} ± {_short(scale * scatter)} %**"


def mean(values: np.ndarray, unit: float = 1.0) -> str:
    """Write the mean over replicates with its interval, in multiples of a unit."""
    middle, scatter = values.mean() / unit, half_width(values) / unit
    if not np.isfinite(middle):
        return "none"
    digits = int(np.clip(2 - np.floor(np.log10(abs(middle) + 1e-12)), 0, 4))
    return f"{middle:.{digits}f} ± {_short(scatter, 1)}"


def _short(value: float, digits: int = 2) -> str:
    """Write a number without exponent in so many digits, or more where it is large."""
    return f"{value:.0f}" if value >= 10.0 ** (digits - 1) else f"{value:.{digits}g}"


def table(
    cases: Mapping[str, Case], columns: Mapping[str, tuple[str, float]], first: str = "drive"
) -> str:
    """Return a table in Markdown: the first case in figures, the others beside it.

    `columns` gives heading and unit of every quantity; the unit divides what was measured.
    """
    base = next(iter(cases.values()))
    lines = [
        f"| {first} | " + " | ".join(heading for heading, _ in columns.values()) + " |",
        "|---|" + "---|" * len(columns),
    ]
    for name, case in cases.items():
        cells = []
        for key, (_, unit) in columns.items():
            shown = mean(case[key], unit)
            if case is not base:
                shown += f"<br>{verdict(base[key], case[key])}"
            cells.append(shown)
        lines.append(f"| {name} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def arrivals(run: xr.Dataset, sprocket: str, pause: float) -> np.ndarray:
    """Return the closing speeds [m/s] with which rollers come down on a sprocket.

    The first contact of a visit counts: one that no other contact of the same roller with this
    sprocket precedes by less than `pause`.
    """
    mine = (run["event_body"] == sprocket).values & (run["event_kind"] == "tooth").values
    columns = ("event_roller", "event_start", "event_end", "event_onset_speed")
    roller, start, end, speed = (run[name].values[mine] for name in columns)
    begin = float(run["time"][0])
    found = []
    for number in np.unique(roller):
        order = np.flatnonzero(roller == number)[np.argsort(start[roller == number])]
        # Whoever touched before the record began touched at its beginning.
        before = np.concatenate([[begin], end[order][:-1]])
        found.append(speed[order][start[order] - before > pause])
    return np.concatenate(found) if found else np.empty(0)


def harmonics(times: np.ndarray, values: np.ndarray, frequency: float, count: int) -> np.ndarray:
    """Amplitudes of the first harmonics of a frequency, by least squares, (count,) complex."""
    phase = 2j * np.pi * frequency * np.outer(times, np.arange(1, count + 1))
    basis = np.column_stack([np.cos(phase.imag), np.sin(phase.imag), np.ones_like(times), times])
    fit = np.linalg.lstsq(basis, values, rcond=None)[0]
    return fit[:count] - 1j * fit[count : 2 * count]


def spectrum(values: np.ndarray, every: float) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies [Hz] and root mean square amplitudes of a Hann-windowed record."""
    window = np.hanning(len(values))
    lines = np.abs(np.fft.rfft(window * (values - values.mean()))) / window.sum()
    return np.fft.rfftfreq(len(values), every), np.sqrt(2.0) * lines


class Page:
    """Tables and figures of one page: printed, and put between their marks in its text."""

    def __init__(self, results: Path, stem: str) -> None:
        results.mkdir(parents=True, exist_ok=True)
        self.results, self.stem = results, stem

    def add(self, name: str, table: str) -> None:
        """Print a table and put it into the page of the folder, which begins empty."""
        print(f"\n## {name}\n\n{table}", flush=True)
        path = self.results / f"{self.stem}.md"
        text = path.read_text(encoding="utf-8") if path.exists() else ""
        mark = f"<!-- {name} -->\n"
        if mark not in text:
            text += f"\n{mark}<!-- end -->\n"
        before, _, after = text.partition(mark)
        after = after[after.index("<!-- end -->") :]
        path.write_text(f"{before}{mark}\n{table}\n\n{after}", encoding="utf-8")

    def save(self, figure: Any, name: str) -> None:
        """Write a figure beside the page."""
        path = self.results / f"{self.stem}_{name}.png"
        figure.savefig(path, dpi=80)
        print(f"written: {path}", flush=True)
