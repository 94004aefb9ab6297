"""Processor time of stepping, each run with the yardstick before it."""

import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from time import process_time
from typing import Any

import numpy as np

import chaindrive as cd
from yardstick import QUIET, Yardstick

# Link-steps of a timed stretch: some 40 ms, as long as the yardstick takes.
PARTICLES, RIGID_LINKS = 5e6, 5e5


def at_once(drive: cd.Drive) -> cd.Drive:
    """Return the drive without a run-in: what is measured begins with the first step."""
    return drive.replace({"run.run_in": 0})


class Stretch:
    """The first stretch of the motion of a drive, stepped again and again.

    It begins from one snapshot, so that every repetition takes the same steps; assembly and samples
    are not timed. Without further settings the method and step are those of a simulation that
    nobody asked for an accuracy. It begins after a run-in [s], where one is given.
    """

    def __init__(
        self, drive: cd.Drive, quick: bool = False, run_in: float = 0.0, **settings: Any
    ) -> None:
        drive = drive.replace({"run.run_in": run_in})
        settings = {"method": "auto"} | settings
        instant = {"until": 1e-9, "every": 1e-9, "record": "energy_residual", "error": False}
        chosen = cd.simulate(drive, **instant, **settings).attrs
        self.method, self.step = chosen["method"], float(chosen["step"])
        self.links = int(chosen["links"])
        settings |= {"method": self.method, "step": self.step}
        settings.pop("accuracy", None)
        if "onset_depth" in chosen:
            settings["onset_depth"] = float(chosen["onset_depth"])
        rigid = chosen["degrees_of_freedom"] > 2.5 * self.links
        work = RIGID_LINKS if rigid else PARTICLES
        self.until = max(20.0, (0.01 if quick else 1.0) * work / self.links) * self.step
        whole = instant | {"until": self.until, "every": self.until}
        with warnings.catch_warnings():
            # Of a run for its cost; whoever shows the cost shows `remark`.
            warnings.simplefilter("ignore", cd.VerdictWarning)
            counts = cd.simulate(drive, **whole, **settings).attrs
        self.remark = counts["verdict_note"] if counts["verdict"] == "distrusted" else ""
        self.steps, self.evaluations = int(counts["steps"]), int(counts["evaluations"])
        self._simulation = cd.Simulation(drive, **settings)
        self._start = self._simulation.snapshot()

    def time(self) -> float:
        """Step it once and return ns per link and step, processor time."""
        self._simulation.restore(self._start)
        begin = process_time()
        self._simulation.advance_to(self.until)
        return 1e9 * (process_time() - begin) / (self.steps * self.links)

    @property
    def evaluations_per_second(self) -> float:
        """Evaluations of the forces per simulated second."""
        return self.evaluations / self.until

    @property
    def steps_per_second(self) -> float:
        """Steps per simulated second."""
        return self.steps / self.until


@dataclass(frozen=True)
class Pairs:
    """Times of one figure and of the yardstick just before each [ns per link and step]."""

    own: np.ndarray
    yardstick: np.ndarray

    @property
    def ns(self) -> float:
        """Median time, as it was."""
        return float(np.median(self.own))

    @property
    def faster(self) -> float:
        """How many times as fast as the yardstick, median of the pairs."""
        return float(np.median(self.yardstick / self.own))

    @property
    def scatter(self) -> str:
        """Least and greatest of the pairs."""
        ratio = self.yardstick / self.own
        return f"{ratio.min():.2f} to {ratio.max():.2f}"

    @property
    def quiet(self) -> float:
        """Time on a machine on which the yardstick takes its quiet time [ns]."""
        return QUIET / self.faster

    def over(self, base: "Pairs") -> float:
        """Time over that of another figure of the same rounds, median."""
        ours, theirs = self.own / self.yardstick, base.own / base.yardstick
        return float(np.median(ours / theirs))


def in_turn(
    yardstick: Yardstick, runs: Mapping[str, Callable[[], float]], pairs: int
) -> dict[str, Pairs]:
    """Time several runs: yardstick, first run, yardstick, second run, …, and so on again."""
    found: dict[str, list[tuple[float, float]]] = {name: [] for name in runs}
    for run in runs.values():
        run()  # The first one finds caches cold and the processor asleep.
    for _ in range(pairs):
        for name, run in runs.items():
            beside = yardstick.time()
            found[name].append((run(), beside))
    return {name: Pairs(*np.array(values).T) for name, values in found.items()}
