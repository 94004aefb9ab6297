"""Measurements: read, checked against a drive, compared with a run.

`chaindrive.measured` reads a file into a dataset, `chaindrive.check_data` tells what it can say of
a drive, `chaindrive.compare` holds a run against it. Here stands what they take besides: `Sensor`,
the model of a channel, and `Encoder`, `Tacho` and `Speed`, which tell how a shaft turns.

    >>> import chaindrive as cd
    >>> gauge = cd.measurement.Sensor("span_tension[driven-driver]", gain_uncertainty=0.01)
    >>> gauge.uncertainty(6000.0, is_mean=True)
    60.0
"""

from chaindrive.measurement.formats import FORMATS
from chaindrive.measurement.sensor import NUISANCES, Sensor
from chaindrive.measurement.turning import Encoder, Speed, Tacho

__all__ = ["FORMATS", "NUISANCES", "Encoder", "Sensor", "Speed", "Tacho"]


def __dir__() -> list[str]:
    return list(__all__)
