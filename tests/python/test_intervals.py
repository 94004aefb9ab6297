"""Intervals of statistics after a run-in, against references ten times as long."""

import numpy as np
import pytest
import xarray as xr

import chaindrive as cd

STATISTICS = ["mean", "std", "p1", "p99"]
TEETH = [4, 8, 16, 40]

# Chaotic or not, passages of a tooth in a second, run-ins of references [s].
DRIVES = {
    "marine_engine_bare": (True, 101.6, 5.0),
    "marine_engine": (True, 101.88, 5.0),
    "industrial_16b": (False, 95.0, 2.0),
    "marine_two_sprockets": (False, 100.0, 8.0),
}
# Least share of true values within intervals of 95 %, of every statistic.
HELD = 0.88


def swept(
    name: str, phases: list[float], tooth: float, teeth: float, run_in: float | str
) -> xr.Dataset:
    """Statistics by phase, of records that last so many times a tooth [s]."""
    until, every = teeth * tooth, tooth / 24.0
    drive = getattr(cd.scenes, name)()
    return cd.sweep(drive, {"route.phase": phases}, until=until, every=every, run_in=run_in)


def statistics(sweep: xr.Dataset, of: str) -> tuple[np.ndarray, np.ndarray]:
    """Values and half widths, by record and span."""
    half_width = "half_width" if of == "mean" else f"{of}_half_width"
    return sweep[f"span_tension_{of}"].values, sweep[f"span_tension_{half_width}"].values


@pytest.mark.slow
def test_intervals_hold_what_is_true() -> None:
    """By statistic more than 1000 of them: 32 phases of four drives, 4 to 40 teeth long."""
    phases = np.random.default_rng(4).random(32).tolist()
    held: dict[bool, list[list[bool]]] = {True: [[], [], [], []], False: [[], [], [], []]}
    for name, (is_chaotic, passages, run_in) in DRIVES.items():
        run = (name, phases, 1.0 / passages)
        reference = swept(*run, 400.0, run_in)
        for teeth in TEETH:
            found = swept(*run, teeth + 0.05, "auto")
            for of, into in zip(STATISTICS, held[is_chaotic], strict=True):
                value, half_width = statistics(found, of)
                true_value, _ = statistics(reference, of)
                is_stated = np.isfinite(half_width)
                into.extend((np.abs(value - true_value) <= half_width)[is_stated])
            if teeth == max(TEETH):
                assert is_stated.mean() >= 0.8, name
    assert sum(len(it[0]) for it in held.values()) >= 1000
    for is_chaotic, of_kind in held.items():
        found_shares = [np.mean(it) for it in of_kind]
        print("chaotic" if is_chaotic else "others", np.round(found_shares, 3))
        assert min(found_shares) >= HELD, (is_chaotic, found_shares)
