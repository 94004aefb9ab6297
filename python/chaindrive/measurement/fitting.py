"""Bounded least squares on whitened features, from several starts, and what the fit is worth."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from chaindrive.errors import MeasurementError, SimulationError
from chaindrive.extras import extra
from chaindrive.measurement.combinations import told_by_runs
from chaindrive.measurement.experiment import Errors, Experiment
from chaindrive.measurement.free import FreeParameter
from chaindrive.measurement.identifiability import Identifiability, identifiability
from chaindrive.measurement.sensitivities import CLEAR

__all__ = ["Fit", "Optimum", "Worth", "apart", "chance", "differs", "drawn", "joined", "rooted"]

_Floats = NDArray[np.float64]

#: Step of the differences of a fit, as a share of half the range [–] (assumed): amplitudes bend
#: over more of it as drives come near to a resonance, and beside it a run has little noise.
_STEP = 0.05
#: Step where differences over that are noise, as `check_data` takes it [–].
_LONG_STEP = 0.2
#: Longest step along a combination that is in doubt, of any parameter [half ranges] (assumed), and
#: the shares of it that are taken where runs fail.
_FAR, _SHARES = 0.5, (1.0, 0.5, 0.25, 0.1)
#: Share by which amplitudes may be off in the first of two fits [–] (assumed).
_LOOSE = 0.5
#: Shortest step (assumed): the numbers of a run are rough below.
_LEAST_STEP = 0.005
#: Relative change of cost, parameters and gradient at which a fit ends [–]: some
#: hundredths of an error.
_ENOUGH = 1e-3
#: Iterations of a fit at most.
_LONGEST = 30
#: Share of a start's residual that the straight line of an optimum may leave for it to lie in the
#: same valley [–] (assumed).
_SAME_VALLEY = 0.5
#: Draws for the distribution of χ², and their seed.
_DRAWS, _SEED = 20_000, 57


class Optimum(NamedTuple):
    """Where a fit ended."""

    x: _Floats
    """Parameters [SI] (p,)."""
    cost: float
    """Half the sum of squares, of the loss and of the priors with it [–]."""
    jacobian: _Floats
    """Of whitened residuals by half ranges, as the loss weighs it (residuals, p)."""


class Worth(NamedTuple):
    """What an optimum is worth."""

    covariance: _Floats
    """Of the parameters in half ranges (p, p) [–]."""
    freedom: _Floats
    """Degrees of freedom of their errors (p,)."""
    residual: _Floats
    """Differences, simulated less measured (features,) [unit of the feature]."""
    chi2: float
    dof: int
    p_value: float
    """Chance of so large a χ² of the right model [–]; NaN without degrees of freedom."""


def joined(parts: Sequence[Errors]) -> Errors:
    """Return the features of several records as one: their numerical bias is the same."""
    numerical = np.concatenate([it.numerical for it in parts])
    covariance = numerical @ numerical.T
    at = 0
    for it in parts:
        own = slice(at, at + len(it.names))
        covariance[own, own] = it.covariance
        at = own.stop
    names = [
        name if len(parts) == 1 else f"record {number}: {name}"
        for number, it in enumerate(parts, start=1)
        for name in it.names
    ]
    return Errors(
        names,
        np.concatenate([it.values for it in parts]),
        covariance,
        numerical,
        np.concatenate([it.statistical for it in parts]),
        np.concatenate([it.freedom for it in parts]),
    )


def apart(optima: Sequence[Optimum], half: _Floats) -> list[Optimum]:
    """Return optima that are not the same, the best first; of half ranges [SI] (p,)."""
    found: list[Optimum] = []
    for it in sorted(optima, key=lambda it: it.cost):
        if all(np.abs((it.x - one.x) / half).max() > 0.05 for one in found):
            found.append(it)
    return found


def rooted(covariance: _Floats) -> _Floats:
    """Return L of a covariance ``C = L Lᵀ``."""
    return np.asarray(np.linalg.cholesky(covariance), dtype=np.float64)


def differs(frozen: Mapping[str, Any], anew: Mapping[str, Any]) -> bool:
    """Tell whether another run chooses otherwise: another method or step, or a longer run-in.

    Numbers may differ by 5 %. A run-in that is longer than it needs to be is as steady.
    """
    step, run_in = float(frozen["step"]), float(frozen.get("run_in", 0.0))
    return (
        frozen["method"] != anew["method"]
        or abs(float(anew["step"]) - step) > 0.05 * step
        or float(anew.get("run_in", 0.0)) > 1.05 * run_in
    )


class Fit:
    """A least-squares problem whose every evaluation is frozen but for its parameters."""

    def __init__(
        self,
        experiments: Sequence[Experiment],
        parameters: Sequence[FreeParameter],
        priors: Mapping[str, tuple[float, float]],
        loss: str,
        tell: Callable[[], object],
    ) -> None:
        self.experiments, self.parameters = list(experiments), list(parameters)
        self.errors = joined([it.errors(it.run) for it in experiments])
        own = np.diag(self.errors.covariance)
        self.known = np.isfinite(own) & (own > 0.0) & np.isfinite(self.errors.values)
        if not self.known.any():
            message = "no feature of the record has an error that is known: nothing can be fitted"
            raise MeasurementError(
                message, "data", "a longer record, of three periods of the slowest forcing or more"
            )
        among = np.ix_(self.known, self.known)
        self._root = rooted(self.errors.covariance[among])
        # Of a first fit: amplitudes that only have to be about right make fewer valleys.
        orders = np.array([" order " in it for it in self.errors.names])
        loose = np.where(orders, _LOOSE * self.errors.values, 0.0) ** 2
        self._soft = rooted((self.errors.covariance + np.diag(loose))[among])
        self.low = np.array([it.low for it in parameters])
        self.high = np.array([it.high for it in parameters])
        self.half = np.array([it.half_range for it in parameters])
        self.start = np.clip([it.start for it in parameters], self.low, self.high)
        self._priors = [
            (n, *priors[it.path]) for n, it in enumerate(parameters) if it.path in priors
        ]
        self._loss, self._tell = loss, tell
        self._seen: dict[tuple[bool, int, bytes], _Floats | None] = {}
        #: Designs that derivatives are taken from: one, or all where one is too noisy.
        self.designs = 1
        #: Steps of differences, as shares of half a range (p,) [–].
        self.steps = np.full(len(parameters), _STEP)

    def begin(self) -> Identifiability:
        """Return what the record says of parameters at the start; take designs and steps by it.

        What is noise over a short step may be clear over a longer one. Where two designs leave it
        in doubt whether a combination moves anything, runs along it decide.
        """
        jacobian, noise = self.replicated(self._inside(_STEP))
        self.designs = 1 + self.is_noisy(jacobian, noise)
        if self.designs > 1:
            short = self.steps
            self.steps = np.full(len(self.parameters), _LONG_STEP)
            longer, quieter = self.replicated(self._inside(_LONG_STEP))
            if self._chaos(quieter).max() < self._chaos(noise).max():
                jacobian, noise = longer, quieter
            else:
                self.steps = short
        found = self._identifiability(jacobian, noise)
        if self._designs > 2:
            found = told_by_runs(found, self._whole(jacobian), self._moved, self._designs)
        self._refine(jacobian)
        return found

    @property
    def _designs(self) -> int:
        return max(len(it.designs) for it in self.experiments)

    def _moved(self, direction: _Floats, designs: int) -> _Floats:
        """Return slopes along a direction, over as long a step as runs, (designs, residuals)."""
        x = self._inside(_FAR)
        for share in _SHARES:
            step = share * _FAR / np.abs(direction).max()
            by = step * direction * self.half
            ends = [np.clip(it, self.low, self.high) for it in (x + by, x - by)]
            found = [self.residuals_at(ends, design) for design in range(designs)]
            rows = [
                (above - below) / (2.0 * step)
                for above, below in found
                if above is not None and below is not None
            ]
            if len(rows) == designs:
                return np.stack(rows)
        message = "combinations of the parameters cannot be simulated beside the start"
        raise SimulationError(message, "free", "narrower bounds")

    def _whole(self, jacobian: _Floats) -> _Floats:
        """Return derivatives of whitened residuals by half ranges, priors last."""
        return self.with_priors(self._rooted(jacobian), np.eye(int(self.known.sum())))[0]

    def _identifiability(self, jacobian: _Floats, noise: _Floats) -> Identifiability:
        both, covariance = self.with_priors(jacobian, self.errors.covariance)
        noises = np.zeros_like(both)
        noises[: len(noise)] = noise
        return identifiability(self.parameters, both, covariance, noises)

    def _inside(self, share: float) -> _Floats:
        """Return the start, far enough from the bounds for central differences."""
        return np.array([it.around(share)[1] for it in self.parameters])

    def _refine(self, jacobian: _Floats) -> None:
        """Take steps that move the record by about one error, where that is less."""
        size = np.linalg.norm(self._whole(jacobian), axis=0)
        self.steps = np.clip(1.0 / np.maximum(size, 1.0), _LEAST_STEP, self.steps)

    def features(
        self, points: Sequence[_Floats], design: int = 0, *, kept: bool = False
    ) -> list[_Floats | None]:
        """Return the features of parameter vectors [SI]; None where a run fails.

        Those of the part that is fitted, or of the one that is kept.
        """
        keys = [(kept, design, x.tobytes()) for x in points]
        new = {key: x for key, x in zip(keys, points, strict=True) if key not in self._seen}
        if new:
            found = self._computed(list(new.values()), design, kept)
            self._seen |= dict(zip(new, found, strict=True))
            self._tell()
        return [self._seen[key] for key in keys]

    def seen(self) -> list[tuple[_Floats, _Floats]]:
        """Return the points [SI] that one design has been run at, with the features there."""
        return [
            (np.frombuffer(bits), found)
            for (kept, design, bits), found in self._seen.items()
            if design == 0 and not kept and found is not None
        ]

    def _computed(self, points: Sequence[_Floats], design: int, kept: bool) -> list[_Floats | None]:
        vectors = [self._named(x) for x in points]
        parts: list[list[_Floats | None]] = []
        for it in self.experiments:
            at = design % len(it.designs)
            runs = it.evaluations.runs([it.row(x, at) for x in vectors], may_fail=True)
            parts.append(
                [
                    None if run is None else it.simulated(run, x, kept)
                    for run, x in zip(runs, vectors, strict=True)
                ]
            )
        rows = zip(*parts, strict=True)
        # Of several records a point counts where each of its runs reached its end.
        return [None if any(it is None for it in row) else np.concatenate([*row]) for row in rows]

    def derivatives(
        self,
        x: _Floats,
        factor: float = 1.0,
        design: int = 0,
        among: Sequence[int] | None = None,
        *,
        kept: bool = False,
    ) -> _Floats:
        """Return the change of features with half ranges at a point [SI], (features, p).

        ``∂y/∂θ ≈ (y(θ + h) − y(θ − h)) / 2h``, with common random numbers, within the bounds. Of
        some parameters alone where `among` names them.
        """
        points, widths = [], []
        for n in range(x.size) if among is None else among:
            above, below = x.copy(), x.copy()
            step = factor * self.steps[n] * self.half[n]
            above[n] = min(x[n] + step, self.high[n])
            below[n] = max(x[n] - step, self.low[n])
            points += [above, below]
            widths.append((above[n] - below[n]) / self.half[n])
        found = self._all(points, design, kept=kept)
        columns = [(found[2 * n] - found[2 * n + 1]) / width for n, width in enumerate(widths)]
        return np.stack(columns, axis=1)

    def replicated(self, x: _Floats, *, kept: bool = False) -> tuple[_Floats, _Floats]:
        """Return derivatives by designs of two phases: their mean, and its standard error.

        Of one step, for what bends is no noise. Where no chain has a phase, by one step and by two
        of it, whose difference is more than noise.
        """
        how = [(1.0, 0), (1.0, 1)] if self._designs > 1 else [(1.0, 0), (2.0, 0)]
        slopes = [self.derivatives(x, *it, kept=kept) for it in how]
        return np.mean(slopes, axis=0), np.std(slopes, axis=0)

    def is_noisy(self, jacobian: _Floats, noise: _Floats) -> bool:
        """Tell whether one design is not enough: what a parameter moves is not clear of noise."""
        signal = np.linalg.norm(self._rooted(jacobian), axis=0)
        return bool((signal < CLEAR * self._chaos(noise)).any())

    def _chaos(self, noise: _Floats) -> _Floats:
        own = np.sqrt(np.diag(self.errors.covariance))[self.known, None]
        return np.asarray(np.linalg.norm(noise[self.known] / own, axis=0))

    def with_priors(self, jacobian: _Floats, covariance: _Floats) -> tuple[_Floats, _Floats]:
        """Return derivatives and covariance of features with the priors as features of theirs."""
        count = len(self._priors)
        rows = np.zeros((count, len(self.parameters)))
        for row, (n, _, deviation) in enumerate(self._priors):
            rows[row, n] = self.half[n] / deviation
        size = len(covariance)
        both = np.eye(size + count)
        both[:size, :size] = covariance
        return np.concatenate([jacobian, rows]), both

    def residuals(self, x: _Floats) -> _Floats:
        """Return whitened residuals, of errors of one, independent of each other; priors last."""
        return self.residual(self._all([x], 0)[0], x)

    def residuals_at(self, points: Sequence[_Floats], design: int = 0) -> list[_Floats | None]:
        """Return whitened residuals of several points [SI]; None where a run fails."""
        rows = zip(points, self.features(points, design), strict=True)
        return [None if it is None else self.residual(it, x) for x, it in rows]

    def starts(self, count: int) -> list[tuple[float, _Floats]]:
        """Return starts over the ranges with their costs, the best of many.

        The drive's own is one, and a Latin hypercube has twice as many as starts for each
        parameter of the scene: nuisances of sensors take no runs.
        """
        qmc = extra("scipy.stats", "fits").qmc
        scene = sum(not it.is_of_sensor for it in self.parameters)
        wanted = 0 if count == 1 else count * max(2 * scene, 1) - 1
        share = qmc.LatinHypercube(len(self.parameters), rng=_SEED).random(wanted)
        points = [self.start, *(self.low + share * (self.high - self.low))]
        rows = zip(points, self.features(points), strict=True)
        found = [
            (0.5 * float(np.sum(self.residual(it, x, self._soft) ** 2)), x)
            for x, it in rows
            if it is not None
        ]
        if not found:
            message = "none of the starts over the ranges can be simulated"
            raise SimulationError(message, "free", "narrower bounds")
        return sorted(found, key=lambda it: it[0])[:count]

    def optima(self, count: int) -> list[Optimum]:
        """Return the optima that are found from several starts, the best first.

        The fit goes from the best start. Another one is followed only where the straight line at
        the optimum does not explain what it leaves: then it may lie in another valley.
        """
        best, *others = self.starts(count)
        found = [self.optimum(best[1])]
        for _, x in others:
            residual = self.residuals(x)
            if not any(self._explains(it, x, residual) for it in found):
                found.append(self.optimum(x))
        return apart(found, self.half)

    def optimum(self, start: _Floats, *, is_near: bool = False) -> Optimum:
        """Return where SciPy's bounded least squares end from a start.

        Amplitudes near a resonance have many valleys: a first fit takes them loosely, unless the
        start is near an optimum.
        """
        x = start
        for root in [self._root] if is_near else [self._soft, self._root]:
            inside = np.clip(x, self.low + 1e-3 * self.half, self.high - 1e-3 * self.half)
            found = extra("scipy.optimize", "fits").least_squares(
                lambda x, root: self.residual(self._all([x], 0)[0], x, root),
                inside,
                jac=self._whitened,
                bounds=(self.low, self.high),
                x_scale=self.half,
                loss=self._loss,
                ftol=_ENOUGH,
                xtol=_ENOUGH,
                gtol=_ENOUGH,
                max_nfev=_LONGEST,
                args=(root,),
            )
            x = found.x
        return Optimum(found.x, float(found.cost), found.jac * self.half)

    def held(self, start: _Floats, n: int) -> Optimum:
        """Return the optimum of all parameters but one, which stays where a start has it.

        Of squares alone: a robust loss is not asked for.
        """
        among = [it for it in range(start.size) if it != n]
        if not among:
            residual = self.residuals(start)
            return Optimum(start, 0.5 * float(residual @ residual), np.zeros((residual.size, 0)))

        def whole(part: _Floats) -> _Floats:
            x = start.copy()
            x[among] = part
            return x

        low, high, half = self.low[among], self.high[among], self.half[among]
        found = extra("scipy.optimize", "fits").least_squares(
            lambda part: self.residuals(whole(part)),
            np.clip(start[among], low + 1e-3 * half, high - 1e-3 * half),
            jac=lambda part: self._whitened(whole(part), self._root, among),
            bounds=(low, high),
            x_scale=half,
            ftol=_ENOUGH,
            xtol=_ENOUGH,
            gtol=_ENOUGH,
            max_nfev=_LONGEST,
        )
        return Optimum(whole(found.x), float(found.cost), found.jac * half)

    def worth(self, at: Optimum) -> Worth:
        """Return covariance, intervals and test of an optimum."""
        mean, noise = self.replicated(at.x)
        features = self._all([at.x], 0)[0]
        jacobian = self._rooted(mean)
        rows, _ = self.with_priors(jacobian, np.eye(len(jacobian)))
        if self._loss != "linear":
            # As the loss weighs the residuals.
            rows = at.jacobian
        inverse = np.asarray(np.linalg.pinv(rows.T @ rows), dtype=np.float64)
        residual = (features - self.errors.values)[self.known]
        whitened = np.linalg.solve(self._root, residual)
        # Noise of derivatives moves the gradient, and with it the optimum: δg = δJᵀ C⁻¹ r.
        weighed = np.linalg.solve(self._root.T, whitened)
        moved = (noise[self.known] ** 2 * weighed[:, None] ** 2).sum(axis=0)
        covariance = inverse + inverse @ np.diag(moved) @ inverse
        gain = inverse @ np.linalg.solve(self._root.T, rows[: len(jacobian)]).T
        freedom = self._freedom(gain, covariance)
        full = self.residual(features, at.x)
        dof = full.size - len(self.parameters)
        p_value = np.nan
        if dof > 0:
            cast = drawn(self.errors, self.errors.covariance, self.known, self._root)
            priors = np.random.default_rng(_SEED + 1).standard_normal((_DRAWS, len(self._priors)))
            p_value = chance(full, rows, np.concatenate([cast, priors], axis=1))
        return Worth(
            covariance,
            freedom,
            features - self.errors.values,
            float(full @ full),
            dof,
            p_value,
        )

    def _freedom(self, gain: _Floats, covariance: _Floats) -> _Floats:
        """Return ν after Welch and Satterthwaite: ``ν = u⁴ / Σ (u_i⁴ / ν_i)``."""
        parts = (gain * self.errors.statistical[self.known]) ** 2
        below = (parts**2 / self.errors.freedom[self.known]).sum(axis=1)
        found: _Floats = np.divide(
            np.diag(covariance) ** 2, below, out=np.full(len(gain), np.inf), where=below > 0.0
        )
        return found

    def _explains(self, optimum: Optimum, x: _Floats, residual: _Floats) -> bool:
        at = self.residuals(optimum.x)
        line = at + optimum.jacobian @ ((x - optimum.x) / self.half)
        left = float(np.linalg.norm(residual - line))
        return left <= _SAME_VALLEY * max(float(np.linalg.norm(residual)), 1.0)

    def _named(self, x: _Floats) -> dict[str, float]:
        return {it.path: float(value) for it, value in zip(self.parameters, x, strict=True)}

    def _all(self, points: Sequence[_Floats], design: int, *, kept: bool = False) -> list[_Floats]:
        found = self.features(points, design, kept=kept)
        for x, it in zip(points, found, strict=True):
            if it is None:
                at = ", ".join(f"{path} = {value:.6g}" for path, value in self._named(x).items())
                message = f"within the bounds a drive cannot be simulated: {at}"
                raise SimulationError(message, "free", "narrower bounds")
        return [it for it in found if it is not None]

    def residual(self, features: _Floats, x: _Floats, root: _Floats | None = None) -> _Floats:
        """Return whitened residuals of features as a run at a point [SI] has them."""
        root = self._root if root is None else root
        white = np.linalg.solve(root, (features - self.errors.values)[self.known])
        priors = [(x[n] - mean) / deviation for n, mean, deviation in self._priors]
        return np.concatenate([white, priors])

    def _rooted(self, jacobian: _Floats) -> _Floats:
        return np.asarray(np.linalg.solve(self._root, jacobian[self.known]), dtype=np.float64)

    def _whitened(self, x: _Floats, root: _Floats, among: Sequence[int] | None = None) -> _Floats:
        """Return derivatives of whitened residuals by parameters [SI], of some of them alone."""
        slopes = [self.derivatives(x, 1.0, design, among) for design in range(self.designs)]
        rows = np.linalg.solve(root, np.mean(slopes, axis=0)[self.known])
        own = slice(None) if among is None else among
        priors = self.with_priors(np.zeros((0, x.size)), np.zeros((0, 0)))[0][:, own]
        found: _Floats = np.concatenate([rows, priors]) / self.half[own]
        return found


def drawn(errors: Errors, covariance: _Floats, known: NDArray[np.bool_], root: _Floats) -> _Floats:
    """Return whitened errors as they may be (draws, known), of Student's t where few blocks tell.

    Parameters
    ----------
    errors
        Features with their errors.
    covariance
        Of all errors, maybe more than those of `errors` (features, features).
    known
        Features that count.
    root
        Root of their covariance, ``C = L Lᵀ``.
    """
    rng = np.random.default_rng(_SEED)
    own = errors.statistical[known]
    freedom = np.minimum(errors.freedom[known], 1e6)
    cast = rng.standard_t(freedom, (_DRAWS, own.size)) * own
    # What is common: sensors and the numerical bias.
    common = covariance[np.ix_(known, known)] - np.diag(own**2)
    values, vectors = np.linalg.eigh(common)
    shared = rng.standard_normal((_DRAWS, own.size)) * np.sqrt(np.maximum(values, 0.0))
    return np.asarray(np.linalg.solve(root, (cast + shared @ vectors.T).T).T)


def chance(residual: _Floats, jacobian: _Floats, cast: _Floats) -> float:
    """Return how often errors alone leave as much as a fit has left.

    Of errors e a fit leaves ``e − J (JᵀJ)⁻¹ Jᵀ e``; e are of Student's t, whose tails a χ² of
    normal errors does not have.
    """
    basis, _ = np.linalg.qr(jacobian)
    left = cast - (cast @ basis) @ basis.T
    return float(np.mean((left**2).sum(axis=1) >= float(residual @ residual)))
