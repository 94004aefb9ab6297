"""The band of all errors of a difference: numerical, statistical, of the sensor."""

from __future__ import annotations

import math
from typing import NamedTuple

import xarray as xr

from chaindrive.extras import extra
from chaindrive.measurement.blocks import LEAST, Estimate

__all__ = ["Band", "Judgement", "band_of", "judged", "numerical_error"]

#: Statistics of a run, and the estimate of its error that speaks of them.
_ERRORS = {"mean": "mean", "std": "std", "p1": "p1", "p99": "p99"}


class Band(NamedTuple):
    """Half widths of what a difference may be by error alone [SI]."""

    numerical: float
    """Bound on the numerical error of the run: a bias, the same in all samples."""
    simulated: float
    """Standard error of the simulated statistic."""
    measured: float
    """Standard error of the measured one."""
    sensor: float
    """Standard uncertainty of the sensor and of its samples."""
    freedom: float
    """Degrees of freedom of the combined standard error, after Welch and Satterthwaite."""
    half_width: float
    """All of it: ``W = t √(u_s² + u_m² + u_sensor²) + b``."""


def numerical_error(run: xr.Dataset, statistic: str, size: float) -> float:
    """Return the bound that a run states of its own numerical error [SI]; NaN if it states none.

    Runs estimate the errors of span tensions, over the mean tension, or of link tensions where no
    roller holds a span. Other quantities follow from these, and have the same error over their own
    size.

    Parameters
    ----------
    run
        The run.
    statistic
        ``mean``, ``std``, ``p1``, ``p99``; orders and cycles err as ``std`` does.
    size
        Root mean square of the quantity [SI].
    """
    of = _ERRORS.get(statistic, "std")
    for tension in ("span_tension", "link_tension"):
        stated = run.attrs.get(f"error_{tension}_{of}")
        if stated is not None and math.isfinite(float(stated)):
            return float(stated) * size
    return math.nan


def band_of(
    simulated: Estimate, measured: Estimate, sensor: float, numerical: float, level: float
) -> Band:
    """Return the band of a difference at a level of confidence [–].

    The numerical error is a bias with a bound, and is added; the others are independent.
    Degrees of freedom: ``ν = u⁴ / Σ (u_i⁴ / ν_i)``; those of the sensor are infinite.
    """
    parts = [(simulated.error, simulated.freedom), (measured.error, measured.freedom)]
    variance = sum(error**2 for error, _ in parts) + sensor**2
    if min(simulated.freedom, measured.freedom) < LEAST - 1 or not math.isfinite(variance):
        nan = math.nan
        return Band(numerical, simulated.error, measured.error, sensor, nan, nan)
    below = sum(error**4 / freedom for error, freedom in parts)
    freedom = variance**2 / below if below > 0.0 else math.inf
    t = float(extra("scipy.stats", "intervals").t.ppf(0.5 + 0.5 * level, min(freedom, 1e9)))
    half_width = t * math.sqrt(variance) + numerical
    return Band(numerical, simulated.error, measured.error, sensor, freedom, half_width)


class Judgement(NamedTuple):
    """What a difference says."""

    verdict: str
    """``agrees``, ``misses`` or ``cannot tell``."""
    reason: str
    """Why nobody can tell; empty else."""


def judged(difference: float, band: Band, scale: float, telling: float) -> Judgement:
    """Return the verdict on a difference.

    Parameters
    ----------
    difference
        Simulated less measured [SI].
    band
        Its band.
    scale
        Size of what is judged [SI].
    telling
        Greatest half width over that size at which an agreement says anything [–].
    """
    if not math.isfinite(difference):
        return Judgement("cannot tell", "there is no number")
    if not math.isfinite(band.numerical):
        return Judgement("cannot tell", "the run states no numerical error")
    if not math.isfinite(band.half_width):
        return Judgement("cannot tell", "the record is too short for an interval")
    if abs(difference) > band.half_width:
        return Judgement("misses", "")
    if band.half_width > telling * abs(scale):
        share = 100.0 * band.half_width / abs(scale) if scale else math.inf
        return Judgement("cannot tell", f"the band is {share:.3g} % of the value")
    return Judgement("agrees", "")
