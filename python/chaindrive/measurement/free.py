"""Parameters that a fit may move: values of a scene, and nuisances of sensors."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import xarray as xr

from chaindrive.drive import Drive, diff
from chaindrive.errors import MeasurementError, SceneError
from chaindrive.measurement.amount import is_number, read_amount
from chaindrive.measurement.sensor import NUISANCES
from chaindrive.measurement.series import channel_names, sensor_of

__all__ = [
    "FreeParameter",
    "Opened",
    "check_free",
    "check_unit",
    "free_parameters",
    "open_to",
    "priors_of",
    "value_at",
]

#: A path of this beginning is a nuisance of a sensor: ``sensors.flange.gain``.
_SENSORS = "sensors."


@dataclass(frozen=True)
class FreeParameter:
    """A parameter between two bounds."""

    path: str
    """Path in the scene, as `Drive.replace` takes it; or ``sensors.CHANNEL.NUISANCE``."""
    low: float
    """Lower bound [SI]."""
    high: float
    """Upper bound [SI]."""
    start: float
    """Its value in the drive, or of the sensor [SI]; the middle where none is stated."""

    @property
    def is_of_sensor(self) -> bool:
        """Whether it is a nuisance of a sensor: no simulation knows it."""
        return self.path.startswith(_SENSORS)

    @property
    def sensor(self) -> tuple[str, str]:
        """Channel and field of a nuisance."""
        channel, _, name = self.path.removeprefix(_SENSORS).rpartition(".")
        return channel, name

    @property
    def half_range(self) -> float:
        """Half of the range [SI], in which sensitivities are scaled."""
        return 0.5 * (self.high - self.low)

    def around(self, share: float) -> tuple[float, float, float]:
        """Return lower, middle and upper point of a central difference, within the bounds [SI].

        Parameters
        ----------
        share
            Its step as a share of half the range [–].
        """
        step = share * self.half_range
        middle = min(max(self.start, self.low + step), self.high - step)
        return middle - step, middle, middle + step


#: A drive, open to what is freed, its record, and the parameters that mean something there.
Opened: TypeAlias = tuple[Drive, xr.Dataset, list[FreeParameter]]


def free_parameters(
    drive: Drive, data: xr.Dataset, free: Mapping[str, tuple[Any, Any]]
) -> list[FreeParameter]:
    """Return the parameters of a mapping from paths to bounds, in SI.

    Parameters
    ----------
    drive
        The drive, as `open_to` returns it.
    data
        The measurement, whose sensors may have nuisances.
    free
        Bounds by path: numbers in SI, or texts with a unit.

    Raises
    ------
    MeasurementError
        A path leads nowhere, bounds are in the wrong order, or a whole number would be freed.
    """
    check_free(free)
    scene = drive.resolved().to_dict()
    found = []
    for path, bounds in free.items():
        if not isinstance(bounds, list | tuple) or len(bounds) != 2:
            raise MeasurementError(f"free[{path!r}] = {bounds!r} is no pair of bounds", path)
        if path.startswith(_SENSORS):
            found.append(_of_sensor(data, path, bounds))
        else:
            found.append(_of_scene(drive, scene, path, bounds))
        one = found[-1]
        if not one.low < one.high:
            message = f"free[{path!r}]: {one.low:g} is not below {one.high:g}"
            raise MeasurementError(message, path, "give the lower bound first")
    return found


def check_free(free: Any) -> None:
    """Refuse anything but a mapping from paths to bounds.

    Raises
    ------
    MeasurementError
        It is another thing, or empty.
    """
    if not isinstance(free, Mapping) or not free:
        message = "free is no mapping from paths to bounds"
        raise MeasurementError(
            message, "free", "such as {'chain.stiffness': ('10 MN/m', '40 MN/m')}"
        )


def priors_of(
    priors: Mapping[str, tuple[Any, Any]], opened: Sequence[Opened]
) -> dict[str, tuple[float, float]]:
    """Return mean and standard deviation of prior knowledge, by path, in SI.

    Parameters
    ----------
    priors
        Both by path: numbers in SI, or texts with a unit.
    opened
        Drives and records whose parameters they may be.

    Raises
    ------
    MeasurementError
        A path is not free, or these are no pair of numbers of its unit.
    """
    owners = {it.path: (it, drive, data) for drive, data, own in opened for it in own}
    found = {}
    for path, given in priors.items():
        if path not in owners:
            message = f"priors[{path!r}]: it is not free"
            raise MeasurementError(message, path, f"free are {', '.join(owners)}")
        if not isinstance(given, list | tuple) or len(given) != 2:
            message = f"priors[{path!r}] = {given!r} is no pair of mean and standard deviation"
            raise MeasurementError(message, path)
        try:
            mean = _amount(*owners[path], given[0])
            deviation = _amount(*owners[path], given[1], is_difference=True)
        except MeasurementError as error:
            raise MeasurementError(f"priors[{path!r}] = {given!r}: {error}", path) from error
        if not deviation > 0.0:
            message = f"priors[{path!r}]: the standard deviation is {deviation:g}"
            raise MeasurementError(message, path, "positive [SI]")
        found[path] = (mean, deviation)
    return found


def _amount(
    it: FreeParameter, drive: Drive, data: xr.Dataset, given: Any, *, is_difference: bool = False
) -> float:
    """Return a finite number in the SI unit of a parameter."""
    if it.is_of_sensor:
        return _nuisance(data, it.path, given)
    found = read_amount(given, it.path, is_difference=is_difference)
    if not is_number(found.value):
        raise MeasurementError(f"{it.path} = {found.value}, must be finite", it.path)
    if found.unit is not None:
        check_unit(drive, it.path, found.unit, it.low)
    return found.value


def check_unit(drive: Drive, path: str, unit: str, known: float) -> None:
    """Refuse a unit of another quantity than that of a value of a scene.

    Parameters
    ----------
    drive
        The drive.
    path
        Path of the value.
    unit
        Unit of SI, ``"1"`` of a pure number.
    known
        A value that the scene takes [SI], so that nothing but the unit can be wrong.

    Raises
    ------
    MeasurementError
        The scene does not take it.
    """
    try:
        drive.replace({path: f"{known!r} {'' if unit == '1' else unit}"})
    except SceneError as error:
        message = f"{path}: {error.problems[0].message}"
        raise MeasurementError(message, path, error.hint) from None


def open_to(drive: Drive, paths: Iterable[str]) -> Drive:
    """Return the same drive, written so that its values at some paths can be replaced alone.

    A value in a table that the scene leaves open, such as the coefficient of a default friction,
    chooses another kind of law where the kind is not written beside it. Defaults that follow from a
    value, such as a stiffness from a radius, go on following it; where that cannot be, all defaults
    are written out.
    """
    full = drive.resolved().to_dict()
    opened = drive
    for path in paths:
        table, _, key = path.rpartition(".")
        known = value_at(full, table) if table and not path.startswith(_SENSORS) else None
        if not isinstance(known, Mapping) or key not in known:
            continue
        kind = known.get("kind")
        written = value_at(drive.to_dict(), table)
        if kind is None or (isinstance(written, Mapping) and "kind" in written):
            continue
        own = {} if not isinstance(written, Mapping) else dict(written)
        try:
            opened = opened.replace({table: own | {"kind": kind, key: known[key]}})
        except SceneError:
            return drive.resolved()
    return opened if not diff(drive.resolved(), opened.resolved()) else drive.resolved()


def _of_sensor(data: xr.Dataset, path: str, bounds: Any) -> FreeParameter:
    channel, _, name = path.removeprefix(_SENSORS).rpartition(".")
    names = channel_names(data)
    if channel not in names or name not in NUISANCES:
        raise MeasurementError(
            f"free[{path!r}]: no sensor has this",
            path,
            f"sensors.CHANNEL.NUISANCE, of {', '.join(map(repr, names))}: {', '.join(NUISANCES)}",
        )
    try:
        low, high = (_nuisance(data, path, it) for it in bounds)
    except MeasurementError as error:
        raise MeasurementError(f"free[{path!r}]: {error}", path) from error
    start = getattr(sensor_of(data, channel), name)
    return FreeParameter(path, low, high, 0.5 * (low + high) if start is None else float(start))


def _nuisance(data: xr.Dataset, path: str, given: Any) -> float:
    """Return the value of a nuisance [SI], read as its sensor reads it."""
    channel, _, name = path.removeprefix(_SENSORS).rpartition(".")
    sensor = sensor_of(data, channel)
    unit = str(data[channel].attrs["units"]) or sensor.unit
    value = getattr(sensor.replace(unit=unit, **{name: given}), name)
    if value is None:
        raise MeasurementError(f"{name} = None is no number", path)
    return float(value)


def _of_scene(drive: Drive, scene: Mapping[str, Any], path: str, bounds: Any) -> FreeParameter:
    ends = []
    for bound in bounds:
        try:
            value = value_at(drive.replace({path: bound}).resolved().to_dict(), path)
        except SceneError as error:
            raise MeasurementError(f"free[{path!r}]: {error}", path) from error
        if not is_number(value):
            message = f"free[{path!r}]: {value!r} is no number that a fit can move"
            raise MeasurementError(message, path)
        ends.append(float(value))
    middle = 0.5 * (ends[0] + ends[1])
    try:
        # Between two whole numbers is none.
        drive.replace({path: middle + 1e-3 * (ends[1] - ends[0])})
    except SceneError as error:
        raise MeasurementError(
            f"free[{path!r}]: {error}",
            path,
            "whole numbers, such as teeth and links, are not freed",
        ) from error
    start = value_at(scene, path)
    return FreeParameter(path, ends[0], ends[1], float(start) if is_number(start) else middle)


_STEP = re.compile(r"([^.\[\]]+)|\[(\d+)\]")


def value_at(scene: Any, path: str) -> Any:
    """Return the value at a path of a resolved scene; None where it states none."""
    for name, number in _STEP.findall(path):
        if isinstance(scene, list):
            at = [it for it in scene if isinstance(it, Mapping) and it.get("name") == name]
            if number:
                at = scene[int(number) : int(number) + 1]
            scene = at[0] if at else None
        elif isinstance(scene, Mapping):
            scene = scene.get(name)
        else:
            return None
    return scene
