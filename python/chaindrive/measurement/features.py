"""What a record tells in numbers: statistics and orders of every channel, with their errors."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from chaindrive.errors import MeasurementError
from chaindrive.measurement.bands import numerical_error
from chaindrive.measurement.blocks import Blocks, Estimate, blocks_of, shared_length
from chaindrive.measurement.quantities import MeasuredQuantity
from chaindrive.measurement.sensor import Sensor
from chaindrive.measurement.series import LATE, Series, folded, measured_series, simulated_series

__all__ = [
    "Feature",
    "Reading",
    "covariance_of",
    "features_of",
    "numerical_factor",
    "readings",
    "values_of",
]

#: Multiples of the mesh whose amplitudes are features.
_MULTIPLES = (1, 2, 3)


class Reading(NamedTuple):
    """How one channel is looked at, the same for the measurement and for every run."""

    channel: str
    quantity: MeasuredQuantity
    sensor: Sensor
    length: float
    """Length of a block, in turns or seconds."""
    is_angle: bool
    """Whether it is in turns."""
    teeth: float | None
    shaft: str | None
    orders: tuple[float, ...]
    """Multiples of the mesh that measurement and run resolve."""
    measured: Series


class Feature(NamedTuple):
    """A number that a record tells."""

    channel: str
    name: str
    """``mean``, ``std``, ``p1``, ``p99`` or ``order 19``."""
    estimate: Estimate
    """Value, standard error [unit of the quantity], degrees of freedom."""


def readings(
    data: xr.Dataset,
    run: xr.Dataset,
    pairs: Mapping[str, MeasuredQuantity],
    sensors: Mapping[str, Sensor],
    shaft: str | None,
    teeth: float | None,
) -> list[Reading]:
    """Return how the channels are looked at, whose amplitudes mean something.

    Parameters
    ----------
    data, run
        Measurement and a run; both are cut into blocks of one length.
    pairs, sensors
        Quantity and sensor of every channel.
    shaft, teeth
        Reference shaft, and its teeth.
    """
    found = []
    for name, quantity in pairs.items():
        sensor = sensors[name]
        if quantity.is_relative or sensor.relative:
            continue
        ours = measured_series(data, name, shaft)
        theirs = simulated_series(run, quantity, sensor, ours, shaft)
        length, is_angle = shared_length([ours, theirs], teeth)
        look = (length, is_angle, teeth)
        cut = [blocks_of(it, *look) for it in (ours, theirs)]
        orders = tuple(_orders(cut, teeth))
        found.append(Reading(name, quantity, sensor, *look, shaft, orders, ours))
    return found


def features_of(
    how: Sequence[Reading],
    run: xr.Dataset | None,
    sensors: Mapping[str, Sensor] | None = None,
    late: float = 0.0,
) -> list[Feature]:
    """Return the features of a run, or of the measurement itself where no run is given.

    Parameters
    ----------
    how
        What `readings` returned.
    run
        A run, or None for the measurement.
    sensors
        Other sensors by channel, such as one whose gain was moved.
    late
        Share of an interval of the measurement by which samples of the run are late.
    """
    found = []
    for it in how:
        series = it.measured
        if run is not None:
            sensor = (sensors or {}).get(it.channel, it.sensor)
            series = simulated_series(run, it.quantity, sensor, it.measured, it.shaft, late)
        blocks = blocks_of(series, it.length, it.is_angle, it.teeth)
        for name in ("mean", "std", "p1", "p99"):
            found.append(Feature(it.channel, name, blocks.estimate(name)))
        for order in it.orders:
            if not blocks.resolves(order):
                raise MeasurementError(
                    f"{it.channel}: order {order:g} of {it.shaft} has less than two samples a "
                    "period",
                    it.channel,
                    "narrower bounds of speeds, or a record of more samples",
                )
            found.append(Feature(it.channel, f"order {order:g}", blocks.order(order)[1]))
    return found


def _orders(cut: Sequence[Blocks], teeth: float | None) -> list[float]:
    if teeth is None or not all(it.period for it in cut):
        return []
    return [order for k in _MULTIPLES if all(it.holds(order := k * teeth) for it in cut)]


def values_of(found: Sequence[Feature]) -> NDArray[np.float64]:
    """Return the numbers of features, (features,)."""
    return np.array([it.estimate.value for it in found])


def covariance_of(
    how: Sequence[Reading],
    found: Sequence[Feature],
    run: xr.Dataset,
    freed: Collection[tuple[str, str]] = (),
    *,
    is_filtered: bool = False,
) -> NDArray[np.float64]:
    """Return the covariance of features (features, features), of all errors.

    Standard errors of blocks, measured and simulated, are of each feature by itself, and so is what
    folds down to it from above half the sampling rate, see `folded`. The numerical
    error that the run states is a bias, see `numerical_factor`. Gain and zero of a sensor are the
    same in all features of its channel, unless they are freed: then they are parameters.

    Parameters
    ----------
    how, found
        Readings, and the features of the measurement.
    run
        A run, for its own scatter and the numerical error that it states; not a number where it
        states none.
    freed
        Nuisances that are free, as pairs of channel and field.
    is_filtered
        Whether nothing folds down, as of a rig that is only planned and has a low-pass.
    """
    by_channel = {it.channel: it for it in how}
    simulated = features_of(how, run)
    pairs = zip(found, simulated, strict=True)
    own = np.array([it.estimate.error**2 + other.estimate.error**2 for it, other in pairs])
    numerical = numerical_factor(how, found, run)
    if not is_filtered:
        late = [values_of(features_of(how, run, late=it)) for it in LATE]
        own += folded(late, values_of(simulated)) ** 2
    covariance: NDArray[np.float64] = np.diag(own) + numerical @ numerical.T
    values = values_of(found)
    for name, reading in by_channel.items():
        among = np.array([it.channel == name for it in found])
        if (name, "gain") not in freed:
            part = np.where(among, reading.sensor.gain_uncertainty * values, 0.0)
            covariance += np.outer(part, part)
        if (name, "bias") not in freed:
            shifted = among & np.array([it.name in ("mean", "p1", "p99") for it in found])
            part = np.where(shifted, reading.sensor.bias_uncertainty, 0.0)
            covariance += np.outer(part, part)
    return covariance


#: What the numerical error is the same in: one nuisance each.
_BIASES = ("mean", "std", "p1", "p99", "order")


def numerical_factor(
    how: Sequence[Reading], found: Sequence[Feature], run: xr.Dataset
) -> NDArray[np.float64]:
    """Return what a numerical error of one standard deviation moves, (features, biases).

    The error of a step is common to all samples of a record and to all channels: means are moved
    together by one nuisance, deviations by another, and so on. Its bound is taken for its standard
    deviation.
    """
    sizes = {it.channel: float(np.sqrt(np.mean(it.measured.values**2))) for it in how}
    factor = np.zeros((len(found), len(_BIASES)))
    for row, it in enumerate(found):
        of = _BIASES.index(it.name.split()[0])
        factor[row, of] = numerical_error(run, it.name, sizes[it.channel])
    return factor
