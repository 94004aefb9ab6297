"""A run held against a measurement: per quantity agrees, misses by so much, or cannot tell."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
import xarray as xr

from chaindrive.analysis.order_names import order_names
from chaindrive.analysis.parts import sprockets
from chaindrive.errors import MeasurementError
from chaindrive.measurement.alignment import Aligned, in_angle, in_time
from chaindrive.measurement.amount import check_share
from chaindrive.measurement.bands import Band, Judgement, band_of, judged, numerical_error
from chaindrive.measurement.blocks import Blocks, blocks_of, shared_length
from chaindrive.measurement.correspondence import correspondence, reference_shaft
from chaindrive.measurement.lines import Line, mesh_lines
from chaindrive.measurement.quantities import MeasuredQuantity
from chaindrive.measurement.series import (
    LATE,
    Series,
    channel_names,
    folded,
    measured_series,
    sensor_of,
    simulated_series,
)
from chaindrive.measurement.telling import told_comparison

__all__ = ["compare"]

#: Statistics that are compared of every quantity.
STATISTICS = ("mean", "std", "p1", "p99")
#: Orders that are compared at most.
_ORDERS = 6
_BINS = 40


@dataclass
class Compared:
    """What was found for one channel."""

    name: str
    quantity: MeasuredQuantity
    unit: str
    rows: list[tuple[str, float, float, Band, Judgement]] = field(default_factory=list)
    """Statistic, measured, simulated, band, judgement."""
    orders: list[tuple[float, str, complex, complex, Band, Judgement]] = field(default_factory=list)
    lines: list[Line] = field(default_factory=list)
    overlay: Aligned | None = None
    scatter: Any = None
    samples: tuple[Any, Any] | None = None
    notes: list[str] = field(default_factory=list)

    @property
    def judgements(self) -> list[tuple[str, Judgement]]:
        """Judgements by the name of what is judged."""
        by_order = [(f"order {order:g}", it) for order, *_, it in self.orders]
        return [(name, it) for name, *_, it in self.rows] + by_order

    @property
    def verdict(self) -> str:
        """``misses`` where anything does, else ``agrees`` where anything does."""
        known = [it.verdict for _, it in self.judgements]
        return next((it for it in ("misses", "agrees") if it in known), "cannot tell")


def compare(
    run: xr.Dataset,
    data: xr.Dataset,
    *,
    shaft: str | None = None,
    align: Literal["angle", "time"] | None = None,
    level: float = 0.95,
    telling: float = 0.2,
) -> xr.Dataset:
    """Hold a run against a measurement, quantity by quantity.

    The simulated quantity goes through the model of its sensor and is sampled as the measurement
    is. Then mean, standard deviation, 1st and 99th percentile, orders and the mean over a turn or
    a pitch are compared. A difference is judged by the band of all errors,

    ::

        W = t √(u_run² + u_measured² + u_sensor²) + b

    u are standard errors of blocks of whole periods and the standard uncertainty of the sensor, t
    is Student's, b the numerical error that the run states of itself. A difference beyond W is a
    **miss**. Within W the two **agree** where W is at most the share `telling` of the value; else,
    or where a part of W is not known, nobody **can tell**. The level holds for all that is judged
    of a quantity together (Bonferroni).

    Parameters
    ----------
    run
        A run of the drive in the state that was measured, with the channels of its quantities;
        where orders matter with ``sprocket_angle``, and sampled more often than the measurement
        where a sensor has a low-pass.
    data
        What `measured` returned. What a channel measures is said there, or guessed by its name.
    shaft
        Sprocket or shaft whose angle is the reference; the first one of which the measurement knows
        the angle, when absent.
    align
        ``"angle"``: means over a turn or a pitch, shifted onto each other; ``"time"``: by
        correlation, inside the horizon of the run. By the angle where it is known, when absent.
    level
        Level of confidence [–].
    telling
        Greatest half width of a band over the value at which agreement says anything [–].

    Returns
    -------
    xarray.Dataset
        ``verdict`` (quantity,) and ``channel`` (quantity,); ``measured``, ``simulated``,
        ``difference``, ``half_width`` and its parts ``numerical``, ``simulated_error``,
        ``measured_error``, ``sensor`` [unit of the quantity], ``judgement`` and ``reason``
        (quantity, statistic). ``measured_amplitude``, ``simulated_amplitude``, ``measured_phase``,
        ``simulated_phase`` [rad], ``amplitude_half_width``, ``order_judgement`` (quantity, order):
        phases are those after the first of these orders, k φ₁ taken off, for nobody knows where the
        angle begins. ``measured_mean``, ``measured_scatter``, ``simulated_mean``, ``residual``
        (quantity, place) over a period [–], or over time. ``measured_density``,
        ``simulated_density`` (quantity, bin) over ``bin_value`` (quantity, bin). Of vibrations:
        ``line_frequency``, ``mesh_frequency`` [Hz] (quantity, line). Attributes: ``verdict`` (the
        worst), ``summary`` to print and ``page``.

    Raises
    ------
    MeasurementError
        This is no measurement, no channel corresponds to a quantity, or a place does not exist.
    ParameterError
        The run has not recorded a quantity.

    Examples
    --------
    >>> import chaindrive as cd
    >>> drive = cd.scenes.industrial_16b()
    >>> run = cd.simulate(drive, until=0.1, record=["span_tension", "sprocket_angle"])
    >>> tight = run["span_tension"].sel(span="driven-driver").drop_vars("span")
    >>> table = tight.to_dataset(name="tight").isel(time=slice(0, -1))
    >>> table["tight"] = 1.1 * table["tight"]
    >>> data = cd.measured(
    ...     table,
    ...     channels={"tight": "span_tension[driven-driver]"},
    ...     turns={"driver": "300 rpm"},
    ... )
    >>> found = cd.compare(run, data)
    >>> found["verdict"].item()
    'misses'
    """
    _check(run, align, level, telling)
    pairs = correspondence(data, run)
    if not pairs:
        names = ", ".join(map(repr, channel_names(data)))
        raise MeasurementError(
            f"no channel corresponds to a quantity of the drive: there are {names}",
            "channels",
            "say it: measured(…, channels={'flange': 'sprocket_torque[driver]'})",
        )
    shaft = shaft or reference_shaft(run, data)
    wheels = sprockets(run)
    teeth = float(wheels[shaft].teeth) if shaft in wheels else None
    found = [
        _compared(run, data, pair, shaft, teeth, (align, level, telling)) for pair in pairs.items()
    ]
    return _dataset(run, data, found, shaft, level)


def _check(run: xr.Dataset, align: str | None, level: float, telling: float) -> None:
    if "scene" not in run.attrs or "time" not in run.dims:
        message = "run is no run of chaindrive"
        raise MeasurementError(message, "run", "the dataset of chaindrive.simulate")
    if align not in (None, "angle", "time"):
        message = f"align = {align!r}, must be 'angle' or 'time'"
        raise MeasurementError(message, "align", "by the angle where it is known, when absent")
    check_share(level, "level")
    check_share(telling, "telling")


def _compared(
    run: xr.Dataset,
    data: xr.Dataset,
    pair: tuple[str, MeasuredQuantity],
    shaft: str | None,
    teeth: float | None,
    how: tuple[str | None, float, float],
) -> Compared:
    name, quantity = pair
    align, level, telling = how
    sensor = sensor_of(data, name)
    found = Compared(name, quantity, str(data[name].attrs["units"]))
    ours = measured_series(data, name, shaft)
    if quantity.is_relative or sensor.relative:
        found.lines = mesh_lines(ours, run, shaft)
        reason = "the amplitude of a vibration or a sound is not simulated"
        nan = math.nan
        band = Band(nan, nan, nan, nan, nan, nan)
        found.rows = [
            (it, math.nan, math.nan, band, Judgement("cannot tell", reason)) for it in STATISTICS
        ]
        return found
    theirs = simulated_series(run, quantity, sensor, ours, shaft)
    _units(found, quantity)
    length, is_angle = shared_length([ours, theirs], teeth)
    cut = [blocks_of(it, length, is_angle, teeth) for it in (ours, theirs)]
    names = _orders(run, shaft, cut) if is_angle and shaft is not None else {}
    # Of so many judgements at once, each at its share of what may be wrong.
    each = 1.0 - (1.0 - level) / (len(STATISTICS) + len(names) + 1)
    size = float(np.sqrt(np.mean(theirs.values**2)))
    late = [
        blocks_of(simulated_series(run, quantity, sensor, ours, shaft, it), length, is_angle, teeth)
        for it in LATE
    ]
    for statistic in STATISTICS:
        one, other = (it.estimate(statistic) for it in cut)
        own = math.hypot(
            sensor.uncertainty(other.value, is_mean=statistic != "std"),
            folded([it.estimate(statistic).value for it in late], other.value),
        )
        band = band_of(other, one, own, numerical_error(run, statistic, size), each)
        judgement = judged(other.value - one.value, band, one.value, telling)
        found.rows.append((statistic, one.value, other.value, band, judgement))
    for order, title in names.items():
        (first, one), (second, other) = (it.order(order) for it in cut)
        own = math.hypot(
            sensor.uncertainty(other.value, is_mean=False),
            folded([it.order(order)[1].value for it in late], other.value),
        )
        band = band_of(other, one, own, numerical_error(run, "std", size), each)
        judgement = judged(other.value - one.value, band, one.value, telling)
        found.orders.append((order, title, first, second, band, judgement))
    in_angles = is_angle and align != "time"
    _overlay(found, cut, (ours, theirs), run, in_angles)
    return found


def _units(found: Compared, quantity: MeasuredQuantity) -> None:
    """Refuse a channel whose unit is not that of its quantity."""
    needed = quantity.unit
    if needed not in (found.unit, "m or rad") and needed:
        raise MeasurementError(
            f"{found.name} is in {found.unit or 'no unit'}, and {quantity} in {needed}",
            found.name,
            f"say it: channels={{{found.name!r}: {{'quantity': …, 'unit': …, 'scale': …}}}}",
        )


def _orders(run: xr.Dataset, shaft: str, cut: Sequence[Blocks]) -> dict[float, str]:
    """Return the named orders that both records hold in whole periods, the first ones."""
    known = order_names(run, shaft)
    held = {order: name for order, name in known.items() if all(it.holds(order) for it in cut)}
    meshes = [order for order, name in held.items() if "mesh" in name]
    chosen = [*meshes, *(order for order in held if order not in meshes)][:_ORDERS]
    return {order: held[order] for order in sorted(chosen)}


def _overlay(
    found: Compared,
    cut: Sequence[Blocks],
    records: tuple[Series, Series],
    run: xr.Dataset,
    in_angles: bool,
) -> None:
    """Lay both signals over each other, and keep what they scatter."""
    ours, theirs = records
    found.samples = (cut[0].values.ravel(), cut[1].values.ravel())
    if in_angles and cut[0].period:
        (one, error, _), (other, _, _) = (it.cycle() for it in cut)
        found.overlay = in_angle(one, other)
        places = np.arange(error.size + 1) / error.size
        found.scatter = np.interp(found.overlay.at, places, np.append(error, error[0]))
        return
    horizon = float(run.attrs.get("waveform_horizon", math.inf))
    inside = theirs.time - theirs.time[0] <= horizon
    if np.count_nonzero(inside) < 16:
        found.notes.append(f"{found.name}: the run can be followed for {horizon:.3g} s only")
        return
    angle = None
    short = Series(theirs.time[inside], theirs.values[inside], angle)
    found.overlay = in_time(ours, short)


def _dataset(
    run: xr.Dataset, data: xr.Dataset, found: list[Compared], shaft: str | None, level: float
) -> xr.Dataset:
    verdicts = [it.verdict for it in found]
    worst = next(
        (it for it in ("misses", "cannot tell", "agrees") if it in verdicts), "cannot tell"
    )
    text, page = told_comparison(run, data, found, shaft, level)
    variables = {
        "verdict": ("quantity", np.asarray(verdicts, dtype=np.str_)),
        "channel": ("quantity", np.asarray([it.name for it in found], dtype=np.str_)),
        "unit": ("quantity", np.asarray([it.unit for it in found], dtype=np.str_)),
        **_statistics(found),
        **_amplitudes(found),
        **_overlays(found),
        **_densities(found),
        **_lines(found),
    }
    coordinates: dict[str, Any] = {
        "quantity": np.asarray([str(it.quantity) for it in found], dtype=np.str_),
        "statistic": np.asarray(STATISTICS, dtype=np.str_),
    }
    orders = _all_orders(found)
    if orders:
        coordinates["order"] = (
            "order",
            list(orders),
            {"units": "1", "long_name": f"order of {shaft}"},
        )
        coordinates["order_name"] = ("order", np.asarray(list(orders.values()), dtype=np.str_))
    attributes = {
        "verdict": worst,
        "level": level,
        "shaft": shaft or "",
        "measured_from": data.attrs["measured_from"],
        "findings": list(data.attrs["findings"]),
        "summary": text,
        "page": page,
    }
    return xr.Dataset(variables, coords=coordinates, attrs=attributes)


def _statistics(found: list[Compared]) -> dict[str, Any]:
    def numbers(of: Any) -> Any:
        return ("quantity", "statistic"), np.array([[of(row) for row in it.rows] for it in found])

    def texts(of: Any) -> Any:
        rows = [[of(row) for row in it.rows] for it in found]
        return ("quantity", "statistic"), np.asarray(rows, dtype=np.str_)

    return {
        "measured": numbers(lambda row: row[1]),
        "simulated": numbers(lambda row: row[2]),
        "difference": numbers(lambda row: row[2] - row[1]),
        "half_width": numbers(lambda row: row[3].half_width),
        "numerical": numbers(lambda row: row[3].numerical),
        "simulated_error": numbers(lambda row: row[3].simulated),
        "measured_error": numbers(lambda row: row[3].measured),
        "sensor": numbers(lambda row: row[3].sensor),
        "judgement": texts(lambda row: row[4].verdict),
        "reason": texts(lambda row: row[4].reason),
    }


def _all_orders(found: list[Compared]) -> dict[float, str]:
    return dict(sorted((order, name) for it in found for order, name, *_ in it.orders))


def _amplitudes(found: list[Compared]) -> dict[str, Any]:
    orders = list(_all_orders(found))
    if not orders:
        return {}
    shape = (len(found), len(orders))
    ours, theirs = np.full(shape, np.nan, complex), np.full(shape, np.nan, complex)
    width, judgement = np.full(shape, np.nan), np.full(shape, "", dtype="U11")
    for row, it in enumerate(found):
        for order, _, one, other, band, judged_so in it.orders:
            at = orders.index(order)
            ours[row, at], theirs[row, at] = one, other
            width[row, at], judgement[row, at] = band.half_width, judged_so.verdict
    dims = ("quantity", "order")
    return {
        "measured_amplitude": (dims, np.abs(ours)),
        "simulated_amplitude": (dims, np.abs(theirs)),
        "measured_phase": (dims, _relative(ours, orders), {"units": "rad"}),
        "simulated_phase": (dims, _relative(theirs, orders), {"units": "rad"}),
        "amplitude_half_width": (dims, width),
        "order_judgement": (dims, judgement),
    }


def _relative(found: Any, orders: list[float]) -> Any:
    """Return phases φ_k − (k/k₁) φ₁, in (−π, π]: the angle has no zero that both share."""
    phases = np.full(found.shape, np.nan)
    for row, values in enumerate(found):
        known = np.flatnonzero(np.isfinite(values.real))
        if known.size:
            first = known[0]
            turned = np.angle(values) - np.angle(values[first]) * np.array(orders) / orders[first]
            phases[row] = np.angle(np.exp(1j * turned))
    return phases


def _overlays(found: list[Compared]) -> dict[str, Any]:
    laid = [it.overlay for it in found]
    longest = max((it.at.size for it in laid if it is not None), default=0)
    if not longest:
        return {}

    def rows(of: Any) -> Any:
        table = np.full((len(found), longest), np.nan)
        for row, it in enumerate(found):
            values = of(it) if it.overlay is not None else None
            if values is not None:
                table[row, : values.size] = values
        return ("quantity", "place"), table

    shifts = [math.nan if it is None else it.shift for it in laid]
    likeness = [math.nan if it is None else it.correlation for it in laid]
    return {
        "place_value": rows(lambda it: it.overlay.at),
        "measured_mean": rows(lambda it: it.overlay.measured),
        "measured_scatter": rows(lambda it: it.scatter),
        "simulated_mean": rows(lambda it: it.overlay.simulated),
        "residual": rows(lambda it: it.overlay.simulated - it.overlay.measured),
        "shift": ("quantity", shifts),
        "correlation": ("quantity", likeness, {"units": "1"}),
    }


def _densities(found: list[Compared]) -> dict[str, Any]:
    if all(it.samples is None for it in found):
        return {}
    middles = np.full((len(found), _BINS), np.nan)
    densities = [middles.copy(), middles.copy()]
    for row, it in enumerate(found):
        if it.samples is not None:
            both = np.concatenate(it.samples)
            edges = np.histogram_bin_edges(both, _BINS)
            middles[row] = 0.5 * (edges[1:] + edges[:-1])
            for density, values in zip(densities, it.samples, strict=True):
                density[row] = np.histogram(values, edges, density=True)[0]
    dims = ("quantity", "bin")
    ours, theirs = densities
    return {
        "bin_value": (dims, middles),
        "measured_density": (dims, ours),
        "simulated_density": (dims, theirs),
    }


def _lines(found: list[Compared]) -> dict[str, Any]:
    longest = max((len(it.lines) for it in found), default=0)
    if not longest:
        return {}
    tables: Mapping[str, Any] = {
        name: np.full((len(found), longest), np.nan)
        for name in ("line_frequency", "mesh_frequency")
    }
    for row, it in enumerate(found):
        for at, line in enumerate(it.lines):
            tables["line_frequency"][row, at] = line.found
            tables["mesh_frequency"][row, at] = line.expected
    about = {"units": "Hz"}
    return {name: (("quantity", "line"), table, about) for name, table in tables.items()}
