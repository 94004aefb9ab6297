"""WAV, read by SciPy: whole numbers of 8 to 32 bits, and floats."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np

from chaindrive.extras import extra
from chaindrive.measurement.raw import RawChannel, RawRecord

__all__ = ["read"]


def read(path: Path) -> RawRecord:
    """Read a WAV file; its channels are in fractions of the full scale."""
    wavfile = extra("scipy.io.wavfile", "measurements in WAV")
    with warnings.catch_warnings():
        # Recorders put remarks of their own beside the samples.
        warnings.simplefilter("ignore", wavfile.WavFileWarning)
        rate, data = wavfile.read(path)
    columns = data.reshape(len(data), -1).T
    time = np.arange(len(data)) / float(rate)
    channels = []
    for number, column in enumerate(columns):
        values = column.astype(np.float64)
        if column.dtype == np.uint8:
            values = (values - 128.0) / 128.0
        elif column.dtype.kind == "i":
            # SciPy puts 24 bits into the upper ones of 32.
            values = values / -float(np.iinfo(column.dtype).min)
        full_scale = 1.0 if column.dtype.kind in "iu" else None
        channels.append(RawChannel(f"channel {number + 1}", "1", values, time, full_scale))
    return RawRecord(channels)
