"""What a measurement can say of a drive, before any fit."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from chaindrive.analysis.parts import sprockets
from chaindrive.analysis.signal import turning
from chaindrive.drive import Drive, _needed
from chaindrive.errors import MeasurementError
from chaindrive.measurement.correspondence import correspondence, other_speeds, reference_shaft
from chaindrive.measurement.faults import too_slow
from chaindrive.measurement.features import readings
from chaindrive.measurement.free import check_free, free_parameters, open_to
from chaindrive.measurement.identifiability import (
    Identifiability,
    identifiability,
)
from chaindrive.measurement.lines import mesh_lines
from chaindrive.measurement.quantities import MeasuredQuantity
from chaindrive.measurement.sensitivities import Sensitivities, sensitivities
from chaindrive.measurement.series import channel_names, measured_series, sensor_of
from chaindrive.measurement.telling import as_text, number, texts
from chaindrive.measurement.time_base import Finding
from chaindrive.progress import told
from chaindrive.settings import Quantity
from chaindrive.simulation import simulate

__all__ = ["check_data", "run_for"]

_Floats = NDArray[np.float64]

#: Run that a check simulates at most [s]: a check takes a look, and no fit's time (assumed).
_LONGEST = 1.0
#: Samples of a run over those of the measurement [–].
_DENSER = 4
#: Standard error over half the range that a record is to reach [–] (assumed).
_WANTED = 0.1
#: Bending that is told [–] (assumed): errors of a fit are then those near the start alone.
_BENT = 0.2
#: Blocks that tell the noise of a mean, and multiples of it by which means differ [–] (assumed).
_BLOCKS, _CLEAR = 8, 4.0
#: Slips of units that are looked for where means differ: their factors, and what they are.
_SLIPS: tuple[tuple[float, str], ...] = (
    (1000.0, "kilo"),
    (60.0 / (2.0 * np.pi), "rpm and rad/s"),
    (2.0 * np.pi, "turns and radians"),
    (180.0 / np.pi, "degrees and radians"),
    (9.80665, "kgf and N"),
    (4.448222, "lbf and N"),
    (1e5, "bar and Pa"),
    (1e6, "mega"),
)


class Corresponding(NamedTuple):
    """One channel beside its quantity."""

    name: str
    quantity: MeasuredQuantity | None
    unit: str
    measured: float
    simulated: float
    problem: str


def check_data(
    drive: Drive,
    data: xr.Dataset,
    free: Mapping[str, tuple[Any, Any]] | None = None,
    *,
    until: Quantity | None = None,
    shaft: str | None = None,
    progress: bool | Callable[[float], object] = False,
) -> xr.Dataset:
    """Tell what a measurement can say of a drive, before any fit.

    A run of the drive as it is stands beside the measurement: does every channel correspond to a
    quantity, do means and signs agree, is it sampled often enough for the mesh? Of the parameters
    in `free`, central differences with common random numbers (same phase, start, method, step and
    run-in) give the Fisher information of means, deviations, percentiles and orders, and with it
    which parameters the record identifies, the combinations that it cannot tell apart, the errors
    that a fit would have, and how long the record must be.

    Parameters
    ----------
    drive
        The drive, as well as it is known.
    data
        What `measured` returned.
    free
        Values that a fit is to find, by path as `Drive.replace` takes it, each with its lower and
        upper bound: numbers in SI or texts with a unit. ``sensors.CHANNEL.NUISANCE`` frees gain,
        bias, drift, delay, corner or integration of a sensor. None: channels only.
    until
        Length of the runs [s]; that of the record, and at most a second, when absent.
    shaft
        Reference shaft, as in `compare`.
    progress
        As in `sweep`.

    Returns
    -------
    xarray.Dataset
        ``quantity``, ``measured_mean``, ``simulated_mean`` [unit of the channel], ``unit`` and
        ``problem`` (channel,). With `free` ``start``, ``low``, ``high``, ``error`` (the standard
        error that a fit would have), ``length`` [s] (of a record that leaves a tenth of half the
        range), ``effect`` (of half the range in standard errors of the record), ``step`` of the
        differences (as a share of half the range) and ``bending`` (what differences over a fifth of
        half the range and over less differ by, over their size) (parameter,);
        ``information``, ``correlation`` (parameter, parameter_2); ``eigenvalue`` of the information
        with a unit diagonal, ``eigenvalue_floor`` (what noise makes of it) (direction,) and
        ``direction`` (parameter, direction); ``sensitivity`` (feature, parameter) and
        ``feature_error`` (feature,). Attributes: ``identified`` (1 or 0), ``silent`` (parameters
        that move nothing), ``combinations`` (in words), ``problems``, ``summary`` and ``page``.

    Raises
    ------
    MeasurementError
        A path of `free` leads nowhere or is a whole number, or bounds are in the wrong order.
    SimulationError
        A variant of the drive cannot be simulated.

    Examples
    --------
    >>> import chaindrive as cd
    >>> drive = cd.scenes.industrial_16b()
    >>> run = cd.simulate(drive, until=0.1, record=["sprocket_torque"], error=False)
    >>> torque = run["sprocket_torque"].sel(sprocket="driver").drop_vars("sprocket")
    >>> table = torque.to_dataset(name="torque driver").isel(time=slice(0, -1))
    >>> data = cd.measured(table, turns={"driver": "300 rpm"})
    >>> check = cd.check_data(drive, data)
    >>> check["quantity"].item(), check["problem"].item()
    ('sprocket_torque[driver]', '')
    """
    _needed(drive)
    names = channel_names(data)
    if free is not None:
        check_free(free)
        drive = open_to(drive, free)
    parameters = free_parameters(drive, data, free) if free is not None else []
    with told(progress, "check") as tell:
        run, pairs = run_for(drive, data, until)
        if tell is not None:
            tell(1.0 / (2.0 + 2.0 * len(parameters)))
        shaft = shaft or reference_shaft(run, data)
        rows = [_beside(run, data, name, pairs.get(name)) for name in names]
        findings = other_speeds(run, data) + _sampling(run, data, shaft)
        found, moved = None, None
        if parameters:
            wheels = sprockets(run)
            teeth = float(wheels[shaft].teeth) if shaft in wheels else None
            sensors = {name: sensor_of(data, name) for name in names}
            how = readings(data, run, pairs, sensors, shaft, teeth)
            if not how:
                message = "no channel has an amplitude that a drive knows: nothing can be fitted"
                hint = "say what channels are: {'flange': 'sprocket_torque[driver]'}"
                raise MeasurementError(message, "data", hint)
            moved = sensitivities(drive, run, how, parameters, tell)
            found = identifiability(parameters, moved.jacobian, moved.covariance, moved.noise)
    return _dataset(data, rows, findings, found, moved)


def run_for(
    drive: Drive, data: xr.Dataset, until: Quantity | None = None
) -> tuple[xr.Dataset, dict[str, MeasuredQuantity]]:
    """Return a run of a drive that holds what a measurement has, and the quantity of each channel.

    Its samples stand as densely as the measurement and its sensors ask for; its length is that of
    the record, at most a second where nobody says another.
    """
    seconds, rate = 0.0, 0.0
    for name in channel_names(data):
        channel = data[name]
        time = data[str(channel.dims[0])].to_numpy()
        # A part of a record may have nothing of a channel.
        seconds = max(seconds, float(np.ptp(time)) if time.size else 0.0)
        # A low-pass is computed at more than eight times its corner.
        rate = max(
            rate, float(channel.attrs["sampling_rate"]), 2.0 * (sensor_of(data, name).corner or 0.0)
        )
    # Of more samples than the rig takes one can take as the rig does.
    rate *= _DENSER
    # A first look tells the places that there are: labels of spans, sprockets and so on.
    every = min(1.0 / rate, float(drive.run_defaults.get("every", 1.0 / rate)))
    first = simulate(drive, until=2.0 * every, every=every, run_in=0, record="all", error=False)
    pairs = correspondence(data, first)
    needed = [need for it in pairs.values() for need in it.needs]
    known = [name for name in ("sprocket_angle", "shaft_angle") if name in first]
    record: Any = list(dict.fromkeys([*needed, *known]))
    run = simulate(
        drive, until=min(seconds, _LONGEST) if until is None else until, every=every, record=record
    )
    return run, pairs


def _beside(
    run: xr.Dataset, data: xr.Dataset, name: str, quantity: MeasuredQuantity | None
) -> Corresponding:
    """Return a channel beside its quantity, and what is wrong with it."""
    unit = str(data[name].attrs["units"])
    ours = float(np.nanmean(data[name].to_numpy()))
    if quantity is None:
        problem = "" if "turns" in data[name].attrs else "corresponds to no quantity"
        return Corresponding(name, None, unit, ours, math.nan, problem)
    sensor = sensor_of(data, name)
    if quantity.is_relative:
        series = measured_series(data, name, None)
        lines = mesh_lines(series, run, None)
        good = [it for it in lines if math.isfinite(it.found)]
        problem = "" if good else "no line of the mesh stands out of it"
        return Corresponding(name, quantity, unit, ours, math.nan, problem)
    if quantity.unit and quantity.unit != "m or rad" and unit != quantity.unit:
        problem = f"is in {unit or 'no unit'}, and the quantity in {quantity.unit}"
        return Corresponding(name, quantity, unit, ours, math.nan, problem)
    time = run["time"].to_numpy()
    read = sensor.observe(quantity.of(run, sensor.link), time)
    theirs, spread = float(read.mean()), float(read.std())
    problem = _unlike(ours, _noise(data[name].to_numpy()), theirs, spread)
    return Corresponding(name, quantity, unit, ours, theirs, problem)


def _noise(values: _Floats) -> float:
    """Return the standard error of a mean, of blocks one after the other."""
    known = values[np.isfinite(values)]
    means = [float(it.mean()) for it in np.array_split(known, _BLOCKS) if it.size]
    return float(np.std(means)) / math.sqrt(len(means))


def _unlike(ours: float, noise: float, theirs: float, spread: float) -> str:
    """Return how two means contradict each other, and what slip would explain it.

    Means within the scatter of the run are near zero, and those within the noise of the record
    may be anything.
    """
    if max(abs(ours), abs(theirs)) < 2.0 * spread or abs(ours - theirs) < _CLEAR * noise:
        return ""
    ratio = ours / theirs if theirs else math.inf
    for factor, what in _SLIPS:
        for slip in (factor, 1.0 / factor):
            if abs(abs(ratio) / slip - 1.0) < 0.1:
                return f"its mean is {abs(ratio):.4g} times that of the drive: {what} mixed up?"
    if ratio < 0.0:
        return "its sign is not that of the drive: sign = -1?"
    if not 0.5 <= ratio <= 2.0:
        return f"its mean is {ratio:.3g} times that of the drive"
    return ""


def _sampling(run: xr.Dataset, data: xr.Dataset, shaft: str | None) -> list[Finding]:
    """Return which channels are sampled below twice the mesh frequency."""
    wheels = sprockets(run)
    if not wheels or "sprocket_angle" not in run:
        return []
    wheel = wheels[shaft] if shaft in wheels else next(iter(wheels.values()))
    angle, _ = turning(run, wheel.name)
    speed = float(angle[-1]) / float(run["time"][-1] - run["time"][0])
    found = []
    for name in channel_names(data):
        rate = float(data[name].attrs["sampling_rate"])
        slow = too_slow(rate, speed, wheel.teeth, f"the mesh of {wheel.name}", name)
        found += [] if slow is None else [slow]
    return found


def _dataset(
    data: xr.Dataset,
    rows: list[Corresponding],
    findings: list[Finding],
    found: Identifiability | None,
    moved: Sensitivities | None,
) -> xr.Dataset:
    seconds = max(float(data[dim][-1]) for dim in data.dims if str(dim).startswith("time"))
    variables: dict[str, Any] = {
        "quantity": (
            "channel",
            texts("" if it.quantity is None else str(it.quantity) for it in rows),
        ),
        "unit": ("channel", texts(it.unit for it in rows)),
        "measured_mean": ("channel", [it.measured for it in rows]),
        "simulated_mean": ("channel", [it.simulated for it in rows]),
        "problem": ("channel", texts(it.problem for it in rows)),
    }
    coordinates: dict[str, Any] = {"channel": texts(it.name for it in rows)}
    problems = [f"{it.name} {it.problem}" for it in rows if it.problem] + [
        str(it) for it in findings
    ]
    attributes: dict[str, Any] = {"problems": problems, "record_length": seconds}
    sections = [_channels(rows, data, findings)]
    if found is not None and moved is not None:
        half = np.array([it.half_range for it in found.parameters])
        # An error falls with the root of the length.
        length = seconds * (found.errors / (_WANTED * half)) ** 2
        one, two = ("parameter",), ("parameter", "parameter_2")
        variables |= {
            "start": (one, [it.start for it in found.parameters]),
            "low": (one, [it.low for it in found.parameters]),
            "high": (one, [it.high for it in found.parameters]),
            "error": (one, found.errors),
            "length": (one, length, {"units": "s"}),
            "step": (one, moved.steps, {"units": "1"}),
            "bending": (one, moved.bending, {"units": "1"}),
            "effect": (one, np.sqrt(np.diag(found.information)), {"units": "1"}),
            "information": (two, found.information, {"units": "1"}),
            "correlation": (two, found.correlation, {"units": "1"}),
            "eigenvalue": ("direction", found.eigenvalues, {"units": "1"}),
            "eigenvalue_floor": ("direction", found.floor, {"units": "1"}),
            "direction": (("parameter", "direction"), found.directions, {"units": "1"}),
            "sensitivity": (("feature", "parameter"), moved.jacobian),
            "feature_error": ("feature", np.sqrt(np.diag(moved.covariance))),
        }
        paths = texts(it.path for it in found.parameters)
        coordinates |= {"parameter": paths, "parameter_2": paths, "feature": texts(moved.features)}
        attributes |= {
            "identified": int(found.is_identified),
            "silent": [it.path for it in found.silent],
            "combinations": [words for *_, words in found.combinations],
        }
        sections.append(_identified(found, length, seconds, moved.bending))
    attributes["summary"] = as_text(sections)
    attributes["page"] = json.dumps({"sections": sections})
    return xr.Dataset(variables, coords=coordinates, attrs=attributes)


def _channels(
    rows: list[Corresponding], data: xr.Dataset, findings: list[Finding]
) -> dict[str, Any]:
    told = [
        [
            it.name,
            "–" if it.quantity is None else str(it.quantity),
            it.unit or "–",
            number(it.measured),
            number(it.simulated),
            it.problem or _told(it, data),
        ]
        for it in rows
    ]
    words = [f"The record: {data.attrs['findings_note']}."] if data.attrs["findings_note"] else []
    words += [f"{it}." for it in findings]
    unknown = [it.name for it in rows if it.quantity is None and it.problem]
    if unknown:
        words.append(
            f"Say in `channels` what {', '.join(unknown)} is, such as "
            f"{{{unknown[0]!r}: 'QUANTITY[PLACE]'}}; `chaindrive channels` lists quantities."
        )
    return {
        "title": f"what {data.attrs['measured_from']} can say",
        "columns": ["channel", "quantity", "unit", "mean measured", "of the drive", "so"],
        "rows": told,
        "sentences": words,
    }


def _told(it: Corresponding, data: xr.Dataset) -> str:
    turns = data[it.name].attrs.get("turns")
    return f"tells how {turns} turns" if it.quantity is None and turns else "fits"


def _identified(
    found: Identifiability, length: _Floats, seconds: float, bending: _Floats
) -> dict[str, Any]:
    rows = []
    effect = np.sqrt(np.diag(found.information))
    for it, error, own, needed in zip(found.parameters, found.errors, effect, length, strict=True):
        if it in found.silent:
            so = "moves nothing that is seen"
        elif not math.isfinite(error):
            so = "not by itself"
        else:
            so = "identified" if error < it.half_range else "less well than its bounds"
        rows.append(
            [
                it.path,
                number(it.low),
                number(it.high),
                number(own),
                number(error),
                number(needed),
                so,
            ]
        )
    words = [f"The record lasts {seconds:.4g} s; errors fall with the root of its length."]
    words += [
        f"What {it.path} moves bends: over a fifth of half its range by {100.0 * bent:.0f} %."
        for it, bent in zip(found.parameters, bending, strict=True)
        if bent > _BENT
    ]
    words += [
        f"Not identified: {words_of}; scaled eigenvalue {value:.1e}, must exceed {least:.1e}."
        for value, least, words_of in found.combinations
    ]
    return {
        "title": "identified: " + ("yes" if found.is_identified else "no"),
        "columns": [
            "parameter",
            "low",
            "high",
            "effect [σ]",
            "error of a fit",
            "length for 10 % [s]",
            "so",
        ],
        "rows": rows,
        "sentences": words,
    }
