"""Assumptions, all at once by their distributions: the spread of a result, and whose it is."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from os import PathLike
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from chaindrive import _core
from chaindrive.assumptions.distributions import distribution_of
from chaindrive.assumptions.outputs import OUTPUTS, Given, read_off
from chaindrive.assumptions.trials import PHASES, Trials
from chaindrive.drive import Drive, _needed
from chaindrive.errors import MeasurementError, ParameterError, SimulationError
from chaindrive.extras import extra
from chaindrive.measurement.evaluations import RunStore
from chaindrive.measurement.free import free_parameters, open_to
from chaindrive.measurement.sensitivities import settings_for, starts
from chaindrive.measurement.telling import as_text, number, texts
from chaindrive.progress import told
from chaindrive.settings import Quantity
from chaindrive.simulation import simulate
from chaindrive.sweeping import sweep

__all__ = ["uncertainty"]

_Floats = NDArray[np.float64]

#: The parameter that is nobody's assumption: at which phase a run starts.
_PHASE = "route.phase"
#: Probability on either side beyond which the ends of a distribution are not tried beforehand [–].
_TAIL = 1e-3
#: Variants of a part of a sweep: what Ctrl-C may lose of a store.
_PART = 32
#: Variables of the result, and what SALib calls them.
_INDICES = {
    "first_order": "S1",
    "first_order_half_width": "S1_conf",
    "total_order": "ST",
    "total_order_half_width": "ST_conf",
}


def uncertainty(
    drive: Drive,
    distributions: Mapping[str, Any],
    outputs: Given = OUTPUTS,
    *,
    samples: int = 64,
    seed: int = 1,
    level: float = 0.95,
    until: Quantity | None = None,
    run_in: Quantity | None = None,
    store: str | PathLike[str] | None = None,
    jobs: int | None = None,
    progress: bool | Callable[[float], object] = False,
) -> xr.Dataset:
    """Carry distributions of assumptions through a drive: spread of outputs, and whose it is.

    All values are drawn at once, independent of each other, after Saltelli's plan of N (D + 2)
    variants for D values. The phase at which a run starts is one of them, so that its index is the
    scatter of the runs themselves. Method, step and run-in are chosen once on the drive as it is,
    and shorter for what is stiffer.

    Parameters
    ----------
    drive
        The drive.
    distributions
        Distribution of each value by path as `Drive.replace` takes it: a pair of ends, between
        which all are alike; ``"normal(1.5 kN, 0.2 kN)"``, ``"triangular(…)"``, ``"lognormal(…)"``,
        ``"uniform(…)"``; or a frozen distribution of ``scipy.stats``. Numbers are in SI.
    outputs
        What is read off, as `tornado` takes it.
    samples
        N, a power of two, at least 8. Intervals of the indices tell whether it was enough.
    seed
        Of the plan and of the resampling.
    level
        Level of all intervals [–].
    until, run_in, jobs, progress
        As in `sweep`.
    store
        Folder in which finished parts are kept: the same call goes on there. In memory when absent.

    Returns
    -------
    xarray.Dataset
        ``mean``, ``deviation``, ``lower`` and ``upper`` (of the interval that holds `level` of the
        variants), ``numerical`` (twice what half the step changes in the drive as it is) [unit of
        the output], ``unit`` (output,). ``first_order`` and ``total_order``, indices of Sobol, with
        ``first_order_half_width`` and ``total_order_half_width`` [–] (output, parameter). All
        variants: ``sample`` [SI] (variant, parameter), ``result`` (variant, output). Attributes:
        ``samples``, ``seed``, ``level``, ``method``, ``step`` [s], ``run_in`` [s], ``summary``,
        ``page``.

    Raises
    ------
    ParameterError
        A distribution is none, a path leads nowhere or is a whole number, an output does not exist.
    SimulationError
        A variant cannot be simulated.

    References
    ----------
    A. Saltelli et al., *Comput. Phys. Commun.* **181**, 2010, 259–270,
    <https://doi.org/10.1016/j.cpc.2009.09.018>, by SALib.
    """
    _needed(drive)
    _check(samples, level)
    laws = {path: distribution_of(it, path, drive) for path, it in distributions.items()}
    opened, ends = _opened(drive, laws)
    names = [*laws, *([_PHASE] if any(starts(opened)) else [])]
    sampler, analyser = (
        extra(f"SALib.{it}.sobol", "indices of Sobol") for it in ("sample", "analyze")
    )
    problem = {"num_vars": len(names), "names": names, "bounds": [[0.0, 1.0]] * len(names)}
    plan = sampler.sample(problem, samples, calc_second_order=False, seed=seed)
    for column, law in enumerate(laws.values()):
        plan[:, column] = law.ppf(plan[:, column])
    store_of_runs = RunStore(store)
    with told(progress, "uncertainty") as tell:
        given: Any = {"until": until, "run_in": run_in}
        run = simulate(opened, error=False, **given)
        rows = [{path: end} for path, pair in ends.items() for end in pair]
        settings = settings_for(opened, run, rows) | {
            "until": float(run.attrs["until"]),
            "run_in": float(run.attrs.get("run_in", 0.0)),
        }
        trials = Trials(opened, outputs, PHASES, settings, store_of_runs, jobs, None, 2)
        coarse = trials.of(opened, "the drive")
        fine = trials.of(opened, "half the step", step=0.5 * settings["step"])
        parts = []
        for begin in range(0, len(plan), _PART):
            design = dict(zip(names, plan[begin : begin + _PART].T.tolist(), strict=True))
            runs = _kept(store_of_runs, opened, design, settings, jobs)
            parts.append(read_off(runs, trials.outputs)[0])
            if tell is not None:
                tell(min((begin + _PART) / len(plan), 1.0))
    result = np.concatenate(parts)
    how = {"calc_second_order": False, "conf_level": level, "seed": seed}
    indices = [_indices(analyser, problem, column, how) for column in result.T]
    tail = 50.0 * (1.0 - level)
    two = ("output", "parameter")
    found = xr.Dataset(
        {
            "mean": ("output", result.mean(axis=0)),
            "deviation": ("output", result.std(axis=0, ddof=1)),
            "lower": ("output", np.percentile(result, tail, axis=0)),
            "upper": ("output", np.percentile(result, 100.0 - tail, axis=0)),
            "numerical": ("output", 2.0 * np.abs((fine - coarse).mean(axis=0))),
            "unit": ("output", texts(trials.units)),
            **{
                name: (two, np.stack([it[key] for it in indices]), {"units": "1"})
                for name, key in _INDICES.items()
            },
            "sample": (("variant", "parameter"), plan),
            "result": (("variant", "output"), result),
        },
        coords={"output": texts(it.name for it in trials.outputs), "parameter": texts(names)},
        attrs={
            "samples": samples,
            "seed": seed,
            "level": level,
            **{key: settings[key] for key in ("method", "step", "run_in", "until")},
            "scene_name": drive.name or "",
        },
    )
    outs = range(found.sizes["output"])
    sections = [_spread(found), *(_shares(found.isel(output=n)) for n in outs)]
    return found.assign_attrs(summary=as_text(sections), page=json.dumps({"sections": sections}))


def _opened(drive: Drive, laws: Mapping[str, Any]) -> tuple[Drive, dict[str, tuple[float, float]]]:
    """Return the drive with its values free to be drawn, and the ends of what may be drawn."""
    if not laws:
        raise ParameterError("no distribution is given", "distributions", "one by path")
    for path in laws:
        if path.startswith("sensors.") or path == _PHASE:
            raise ParameterError(f"{path}: no assumption of a drive", path, "a value of its scene")
    ends = {path: (float(law.ppf(_TAIL)), float(law.ppf(1 - _TAIL))) for path, law in laws.items()}
    opened = open_to(drive, ends)
    try:
        free_parameters(opened, xr.Dataset(), ends)
    except MeasurementError as error:
        words = str(error).removeprefix("free")
        raise ParameterError(f"distributions{words}", str(error.path), error.hint) from error
    return opened, ends


def _check(samples: int, level: float) -> None:
    if samples < 8 or samples & (samples - 1):
        message = f"samples = {samples}, must be a power of two, at least 8"
        raise ParameterError(message, "samples", "64, 128, 256, …")
    if not 0.0 < level < 1.0:
        raise ParameterError(f"level = {level}, must be in (0, 1)", "level")


def _kept(
    store: RunStore,
    drive: Drive,
    design: Mapping[str, Any],
    settings: Mapping[str, Any],
    jobs: int | None,
) -> xr.Dataset:
    """Return a part of the plan as a sweep, of the store where it is there."""
    of = [_core.__build__, drive.resolved().text, settings, design]
    runs = store.kept(of, lambda: sweep(drive, design=design, jobs=jobs, **settings))
    failed = [str(it) for it in runs["error"].to_numpy() if it]
    if failed:
        message = f"a variant that may be drawn cannot be simulated: {failed[0]}"
        raise SimulationError(message, "distributions", "narrower distributions")
    return runs


def _indices(
    analyser: Any, problem: Mapping[str, Any], column: _Floats, how: Mapping[str, Any]
) -> dict[str, _Floats]:
    """Return indices of one output; none where it does not move."""
    if np.ptp(column) <= 1e-12 * max(float(np.abs(column).max()), 1e-300):
        nan = np.full(problem["num_vars"], np.nan)
        return dict.fromkeys(_INDICES.values(), nan)
    found: dict[str, _Floats] = analyser.analyze(problem, column, **how)
    return found


def _spread(found: xr.Dataset) -> dict[str, Any]:
    names = ("mean", "deviation", "lower", "upper", "numerical")
    rows = [
        [
            str(row["output"].item()),
            row["unit"].item() or "–",
            *(number(float(row[it])) for it in names),
        ]
        for row in (found.isel(output=n) for n in range(found.sizes["output"]))
    ]
    share = f"{100 * found.attrs['level']:g} % from"
    variants = f"{found.sizes['variant']} variants"
    return {
        "title": f"spread of {found.attrs['scene_name'] or 'the drive'}: {variants}",
        "columns": ["output", "unit", "mean", "deviation", share, "to", "numerical"],
        "rows": rows,
        "sentences": [],
    }


def _shares(found: xr.Dataset) -> dict[str, Any]:
    """Return whose spread an output has, the largest first."""
    order = np.argsort(-np.nan_to_num(found["total_order"].to_numpy()), kind="stable")
    rows = []
    for at in order:
        row = found.isel(parameter=int(at))
        cells = [
            f"{float(row[name]):.2f} ± {float(row[f'{name}_half_width']):.2f}"
            for name in ("first_order", "total_order")
        ]
        rows.append([str(row["parameter"].item()), *cells])
    known = np.isfinite(found["total_order"].to_numpy()).any()
    return {
        "title": f"{found['output'].item()}: shares of the variance",
        "columns": ["value", "by itself", "with the others"],
        "rows": rows if known else [],
        "sentences": [] if known else ["Nothing moves it."],
    }
