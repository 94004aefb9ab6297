"""Which measurement would settle most: before the rig runs, or after a fit left too much open."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from chaindrive.analysis.parts import sprockets
from chaindrive.analysis.signal import turning
from chaindrive.drive import Drive, _needed
from chaindrive.errors import MeasurementError
from chaindrive.measurement.amount import amount
from chaindrive.measurement.features import Reading, covariance_of, features_of, readings
from chaindrive.measurement.free import FreeParameter, free_parameters, open_to
from chaindrive.measurement.quantities import quantity_of
from chaindrive.measurement.record import measured
from chaindrive.measurement.sensitivities import Sensitivities, sensitivities
from chaindrive.measurement.sensor import Sensor
from chaindrive.measurement.series import sensor_of
from chaindrive.measurement.telling import as_text, number, texts
from chaindrive.progress import told
from chaindrive.settings import Quantity
from chaindrive.simulation import simulate

__all__ = ["next_measurement"]

_Floats = NDArray[np.float64]

#: Uncertainty of the gain of a sensor of which nothing is said [–] (assumed).
_GAIN = 0.01
#: Samples of a run over those of the record [–].
_DENSER = 4
#: Lengths of records that are tried, in multiples of the run.
_LENGTHS = 2.0 ** np.arange(-1.0, 15.0, 0.25)
#: Error over what it was that a record is to reach [–] (assumed), as `check_data` has it.
_WANTED = 0.1


class _Seen(NamedTuple):
    """What one candidate sees at one operating point."""

    jacobian: _Floats
    """Change of its features with half a range (features, p)."""
    shared: _Floats
    """Covariance that a longer record does not lessen (features, features): of the sensor, of the
    run, and of what is not known of the change itself."""
    own: _Floats
    """Variance by scatter, of a record as long as the run (features,)."""

    def information(self, length: float) -> _Floats:
        """Return ``Jᵀ C⁻¹ J`` of a record that is so many times as long as the run (p, p)."""
        covariance = self.shared + np.diag(self.own / length)
        known = np.isfinite(np.diag(covariance)) & (np.diag(covariance) > 0.0)
        rows = self.jacobian[known]
        if not known.any():
            return np.zeros((rows.shape[1], rows.shape[1]))
        inside = np.linalg.solve(covariance[np.ix_(known, known)], rows)
        return np.asarray(rows.T @ inside)


def next_measurement(
    drive: Drive,
    free: Mapping[str, tuple[Any, Any]],
    candidates: Mapping[str, Any] | Iterable[str],
    *,
    settle: str | xr.Dataset | None = None,
    known: xr.Dataset | None = None,
    excitations: Mapping[str, Mapping[str, Any]] | None = None,
    rate: Quantity = 1000.0,
    record: Quantity = 1.0,
    until: Quantity = 0.2,
    shaft: str | None = None,
    progress: bool | Callable[[float], object] = False,
) -> xr.Dataset:
    """Tell which channel, at which operating point and how long, would settle most.

    Of each candidate the Fisher information ``F = Jᵀ C⁻¹ J`` of its statistics and orders is added
    to what is known, ``P' = (P⁻¹ + F)⁻¹``: errors of parameters, or of a prediction by them, shrink
    from P to P'. J and C are those of `check_data`, of a record that is a run of the drive itself;
    what two designs of J differ by counts as an error of the feature. A low-pass below half the
    sampling rate is taken for granted. It tells what to expect where the drive is about right, and
    measures nothing.

    Parameters
    ----------
    drive
        The drive, as well as it is known.
    free
        Values that are not known, by path, each with its lower and upper bound, as in `calibrate`.
        Without `known` all between the bounds is alike.
    candidates
        Channels that could be measured: sensors by name as `measured` takes them, or a list of
        quantities such as ``"span_tension[driven-driver]"``. Where no uncertainty of a gain is
        stated, it is 1 % (assumed).
    settle
        What is to be settled: a path of `free`; or what `predict` returned, of the same parameters.
        All of `free` when absent.
    known
        What `calibrate` returned of the same parameters: errors shrink from there.
    excitations
        Operating points that the rig can run, by name, each a dict of values by path. That of the
        drive when absent.
    rate
        Sampling rate of the record [Hz].
    record
        Length of the record for which candidates are ranked [s].
    until
        Length of the runs [s].
    shaft
        Shaft whose angle the rig knows; the first sprocket when absent.
    progress
        As in `sweep`.

    Returns
    -------
    xarray.Dataset
        ``before`` (target,), ``after`` (excitation, candidate, target), standard errors of what is
        to be settled [unit of it]; ``shrinking``, the mean of after over before [–], and
        ``length``, of the shortest record that leaves a tenth of all errors [s], NaN for none
        (excitation, candidate). Attributes: ``best_candidate``, ``best_excitation``,
        ``best_length`` [s], ``record`` [s], a ``summary`` to print and a ``page``.

    Raises
    ------
    MeasurementError
        A path or quantity does not exist, nothing is to be chosen from, or what is to be settled
        does not follow from `free`.
    SimulationError
        A variant cannot be simulated.
    """
    _needed(drive)
    sensors = _sensors(candidates)
    points = dict(excitations or {"as it is": {}})
    opened = open_to(drive, free)
    parameters = free_parameters(opened, xr.Dataset(), _of_scene(free))
    prior = _prior(parameters, known)
    targets, slopes = _targets(parameters, settle)
    frequency = amount(rate, "Hz", "rate")
    seconds, lasting = amount(until, "s", "until"), amount(record, "s", "record")
    for name, value in (("rate", frequency), ("until", seconds), ("record", lasting)):
        if not 0.0 < value < np.inf:
            raise MeasurementError(f"{name} = {value}, must be positive", name)
    seen: list[list[_Seen]] = []
    with told(progress, "next measurement") as tell:
        for done, changes in enumerate(points.values()):

            def share(part: float, done: int = done) -> None:
                if tell is not None:
                    tell((done + part) / len(points))

            there = opened.replace(changes)
            seen.append(_at(there, parameters, sensors, prior, (frequency, seconds, shaft), share))
    before = np.sqrt(np.einsum("ti,ij,tj->t", slopes, prior, slopes))
    shape = (len(points), len(sensors))
    after, length = np.zeros((*shape, len(targets))), np.zeros(shape)
    for at in np.ndindex(shape):
        own = seen[at[0]][at[1]]
        after[at] = _after(prior, own, slopes, lasting / seconds)
        errors = np.array([_after(prior, own, slopes, it) for it in _LENGTHS])
        near = (errors <= _WANTED * before).all(axis=1)
        length[at] = _LENGTHS[np.argmax(near)] * seconds if near.any() else np.nan
    shrinking = np.mean(after / before, axis=-1)
    # Of alike ones the first.
    best = np.unravel_index(int(np.argmin(shrinking)), shape)
    found = xr.Dataset(
        {
            "before": ("target", before),
            "after": (("excitation", "candidate", "target"), after),
            "shrinking": (("excitation", "candidate"), shrinking, {"units": "1"}),
            "length": (("excitation", "candidate"), length, {"units": "s"}),
        },
        coords={
            "target": texts(targets),
            "candidate": texts(sensors),
            "excitation": texts(points),
        },
        attrs={
            "best_excitation": list(points)[best[0]],
            "best_candidate": list(sensors)[best[1]],
            "best_length": float(length[best]),
            "record": lasting,
        },
    )
    section = _section(found)
    return found.assign_attrs(summary=as_text([section]), page=json.dumps({"sections": [section]}))


def _sensors(candidates: Any) -> dict[str, Sensor]:
    listed = [candidates] if isinstance(candidates, str) else candidates
    given = listed if isinstance(listed, Mapping) else {str(it): it for it in listed}
    if not given:
        raise MeasurementError("no candidate is given", "candidates", "quantities of the drive")
    found = {}
    for name, it in given.items():
        sensor = Sensor.of(it, name)
        if sensor.quantity is None or quantity_of(sensor.quantity).is_relative:
            message = f"candidates[{name!r}]: it has no quantity with an amplitude"
            raise MeasurementError(message, name, "such as span_tension[driven-driver]")
        gain = sensor.gain_uncertainty or _GAIN
        found[name] = replace(sensor, gain_uncertainty=gain)
    return found


def _of_scene(free: Mapping[str, Any]) -> Mapping[str, Any]:
    for path in free:
        if path.startswith("sensors."):
            message = f"free[{path!r}]: the sensors of a record that nobody has are its candidates"
            raise MeasurementError(message, path, "state gain_uncertainty in candidates")
    return free


def _prior(parameters: list[FreeParameter], known: xr.Dataset | None) -> _Floats:
    """Return the covariance that is known, in half ranges (p, p)."""
    if known is None:
        # Between two bounds all is alike: a half range over √3.
        return np.eye(len(parameters)) / 3.0
    listed = [str(it) for it in known["parameter"].to_numpy()] if "covariance" in known else []
    lost = [it.path for it in parameters if it.path not in listed]
    if lost:
        message = f"known has no {lost[0]}"
        raise MeasurementError(message, "known", "what calibrate returned of the same parameters")
    among = [listed.index(it.path) for it in parameters]
    half = np.array([it.half_range for it in parameters])
    found: _Floats = known["covariance"].to_numpy()[np.ix_(among, among)] / np.outer(half, half)
    if not np.isfinite(found).all():
        message = "known is a fit that was refused: it has no errors"
        raise MeasurementError(message, "known", "leave it out: bounds are taken in its place")
    return found


def _targets(
    parameters: list[FreeParameter], settle: str | xr.Dataset | None
) -> tuple[list[str], _Floats]:
    """Return what is to be settled, and how it moves with half ranges (targets, p)."""
    paths = [it.path for it in parameters]
    half = np.array([it.half_range for it in parameters])
    if isinstance(settle, xr.Dataset):
        listed = (
            [str(it) for it in settle["parameter"].to_numpy()] if "sensitivity" in settle else []
        )
        if sorted(listed) != sorted(paths):
            message = "settle is no prediction by the parameters in free"
            raise MeasurementError(message, "settle", "what predict returned of the same ones")
        among = [listed.index(it) for it in paths]
        # Of one standard error each: by unit, and then by half range.
        by_unit = settle["sensitivity"].to_numpy() / settle["standard_error"].to_numpy()
        return [str(it) for it in settle["output"].to_numpy()], by_unit[:, among] * half
    if settle is None:
        return paths, np.diag(half)
    if settle not in paths:
        message = f"settle = {settle!r} is not free"
        raise MeasurementError(message, "settle", f"free are {', '.join(paths)}")
    row = np.zeros((1, len(paths)))
    row[0, paths.index(settle)] = half[paths.index(settle)]
    return [settle], row


def _at(
    drive: Drive,
    parameters: list[FreeParameter],
    sensors: Mapping[str, Sensor],
    prior: _Floats,
    how: tuple[float, float, str | None],
    tell: Callable[[float], object],
) -> list[_Seen]:
    """Return what every candidate sees at an operating point."""
    rate, until, shaft = how
    # Unit, sign and scale are of a file, and here is none; nor is a name that one could have.
    plain = {
        f"candidate {n}": replace(it, unit=None, sign=1, scale=1.0, offset=0.0)
        for n, it in enumerate(sensors.values())
    }
    quantities = {name: quantity_of(str(it.quantity)) for name, it in plain.items()}
    needs = dict.fromkeys(need for it in quantities.values() for need in it.needs)
    record: Any = [*needs, "sprocket_angle"]
    run = simulate(drive, until=until, every=1.0 / (_DENSER * rate), record=record)
    wheels = sprockets(run)
    shaft = shaft or next(iter(wheels), None)
    turns = {}
    if shaft in wheels:
        angle, _ = turning(run, str(shaft))
        seconds = float(run["time"][-1] - run["time"][0])
        turns = {str(shaft): f"{float(angle[-1] - angle[0]) / seconds!r} rad/s"}
    table = xr.Dataset(
        {
            name: ("time", it.of(run, plain[name].link)[::_DENSER], {"units": it.unit})
            for name, it in quantities.items()
        },
        coords={"time": ("time", run["time"].to_numpy()[::_DENSER], {"units": "s"})},
    )
    data = measured(table, channels=plain, turns=turns)
    teeth = float(wheels[str(shaft)].teeth) if shaft in wheels else None
    own = {name: sensor_of(data, name) for name in plain}
    reads = readings(data, run, quantities, own, shaft if turns else None, teeth)
    moved = sensitivities(drive, run, reads, parameters, tell)
    return [_seen(name, reads, run, moved, np.diag(prior)) for name in plain]


def _seen(
    name: str, reads: list[Reading], run: xr.Dataset, moved: Sensitivities, variance: _Floats
) -> _Seen:
    found = features_of(reads, run)
    among = np.array([it.channel == name for it in found])
    covariance = covariance_of(reads, found, run, is_filtered=True)[np.ix_(among, among)]
    # The record and the run that stands beside it.
    scatter = np.array([2.0 * it.estimate.error**2 for it in found])[among]
    # What is not known of a slope, times what is not known of its parameter.
    vague = moved.scatter[among] ** 2 @ variance
    return _Seen(moved.slopes[among], covariance - np.diag(scatter) + np.diag(vague), scatter)


def _after(prior: _Floats, seen: _Seen, slopes: _Floats, length: float) -> _Floats:
    """Return standard errors of the targets (targets,)."""
    posterior = np.linalg.inv(np.linalg.inv(prior) + seen.information(float(length)))
    return np.asarray(np.sqrt(np.einsum("ti,ij,tj->t", slopes, posterior, slopes)))


def _section(found: xr.Dataset) -> dict[str, Any]:
    cells = [
        (float(found["shrinking"][at]), float(found["length"][at]), at)
        for at in np.ndindex(found["shrinking"].shape)
    ]
    rows = [
        [
            str(found["candidate"][at[1]].item()),
            str(found["excitation"][at[0]].item()),
            f"{100.0 * shrinking:.3g}",
            number(length),
        ]
        for shrinking, length, at in sorted(cells)
    ]
    of = found.attrs
    best = found["shrinking"].min().item()
    return {
        "title": f"settles most: {of['best_candidate']}, {of['best_excitation']}",
        "columns": ["channel", "operating point", "error left [%]", "length for 10 % [s]"],
        "rows": rows,
        "sentences": [
            f"A record of {of['record']:.3g} s leaves {100.0 * best:.3g} % of the error, "
            "in the mean of what is to be settled."
        ],
    }
