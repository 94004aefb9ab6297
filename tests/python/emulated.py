"""A fit whose runs are polynomials: a thousand records cost what a few runs do."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.stats import qmc

from chaindrive.measurement.calibration import fitted
from chaindrive.measurement.experiment import Errors, Experiment, _telling
from chaindrive.measurement.features import features_of

Floats = NDArray[np.float64]


class Polynomials:
    """The features of an experiment as polynomials of its free parameters, of each design."""

    def __init__(self, experiment: Experiment, degree: int, points: int, seed: int) -> None:
        self.parameters = experiment.parameters
        count = len(self.parameters)
        self._powers = np.array(
            [it for it in itertools.product(range(degree + 1), repeat=count) if sum(it) <= degree]
        )
        share = qmc.LatinHypercube(count, rng=seed).random(points)
        rows = self._terms(2.0 * share - 1.0)
        self._of: list[Floats] = []
        for design in range(len(experiment.designs)):
            seen = features_at(experiment, self.points(share), design)
            self._of.append(np.linalg.lstsq(rows, seen, rcond=None)[0])

    def points(self, share: Floats) -> list[dict[str, float]]:
        """Parameters by path, of shares of their ranges (points, p) [–]."""
        return [
            {
                it.path: it.low + s * (it.high - it.low)
                for it, s in zip(self.parameters, row, strict=True)
            }
            for row in share
        ]

    def __call__(self, x: Mapping[str, float], design: int) -> Floats:
        scaled = [2.0 * (x[it.path] - it.low) / (it.high - it.low) - 1.0 for it in self.parameters]
        return self._terms(np.array([scaled]))[0] @ self._of[design]

    def _terms(self, scaled: Floats) -> Floats:
        return np.prod(scaled[:, None, :] ** self._powers[None], axis=2)


def features_at(
    experiment: Experiment, points: Sequence[Mapping[str, float]], design: int = 0
) -> Floats:
    """Features of runs (points, features)."""
    runs = experiment.evaluations.runs([experiment.row(x, design) for x in points])
    return np.array(
        [
            experiment.simulated(run, x)
            for run, x in zip(runs, points, strict=True)
            if run is not None
        ]
    )


class PolynomialRuns:
    """In the place of `Evaluations`: a run is the row of its parameters."""

    def __init__(self, experiment: Experiment) -> None:
        self.settings = experiment.evaluations.settings
        # What is chosen anew at an optimum is what it was.
        self.store = SimpleNamespace(kept=lambda of, compute: experiment.run)

    def runs(self, rows: Sequence[Any], *, may_fail: bool = False) -> list[Any]:
        return list(rows)


@dataclass(frozen=True)
class Emulated(Experiment):
    """An experiment with polynomials for a drive, and with drawn errors."""

    polynomials: Any = None
    drawn: Any = None

    def simulated(self, run: Any, x: Mapping[str, float], kept: bool = False) -> Floats:
        design = next(
            n for n, it in enumerate(self.designs) if all(run[path] == it[path] for path in it)
        )
        return self.polynomials(x, design)

    def errors(self, run: xr.Dataset, kept: bool = False) -> Errors:
        return self.drawn


def emulated(experiment: Experiment, polynomials: Polynomials) -> Emulated:
    """An experiment without a part that is kept, whose records are drawn by `record`."""
    own = {name: getattr(experiment, name) for name in Experiment.__dataclass_fields__}
    runs: Any = PolynomialRuns(experiment)
    return Emulated(**own | {"kept": [], "evaluations": runs}, polynomials=polynomials)


def record(experiment: Emulated, truth: Mapping[str, float], rng: np.random.Generator) -> Emulated:
    """The same experiment with a record of a truth: all errors drawn anew.

    What blocks scatter by is taken for the true scatter; that which a record estimates is drawn,
    too. Gains and the numerical bias are normal, as the covariance of a fit has them.
    """
    whole = Experiment.errors(experiment, experiment.run)
    looks = [_telling(features_of(experiment.how, it)) for it in (None, experiment.run)]
    variance, below = np.zeros(len(whole.names)), np.zeros(len(whole.names))
    values = experiment.polynomials(truth, 0)
    for found in looks:
        own = np.array([it.estimate.error for it in found])
        freedom = np.array([it.estimate.freedom for it in found])
        values = values + own * rng.standard_normal(own.size)
        estimated = own**2 * rng.chisquare(freedom) / freedom
        variance += estimated
        below += estimated**2 / freedom
    values = values + whole.numerical @ rng.standard_normal(whole.numerical.shape[1])
    covariance = np.diag(variance) + whole.numerical @ whole.numerical.T
    for it in experiment.how:
        among = np.array([one.channel == it.channel for one in looks[0]])
        gain = it.sensor.gain_uncertainty
        values = np.where(among, values * (1.0 + gain * rng.standard_normal()), values)
        shared = np.where(among, gain * values, 0.0)
        covariance += np.outer(shared, shared)
    errors = Errors(
        whole.names, values, covariance, whole.numerical, np.sqrt(variance), variance**2 / below
    )
    return replace(experiment, drawn=errors)


def fit_of(experiment: Emulated, starts: int = 5) -> xr.Dataset:
    """What `calibrate` says of it."""
    how: Any = ({}, "linear", lambda: None)
    return fitted([experiment], experiment.parameters, how, starts, 0.95)[0]
