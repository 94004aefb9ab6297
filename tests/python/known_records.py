"""Records that are made of runs, so that what is true is known; and the tables of their draws."""

from __future__ import annotations

import csv
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
from scipy.signal import lfilter

import chaindrive as cd

#: A channel of a record: quantity, label of its place, noise [SI].
Place = tuple[str, str, float]
#: What a record of `industrial_16b` has, and how it is simulated: not as a fit does it.
INDUSTRIAL: dict[str, Place] = {
    "tight": ("span_tension", "driven-driver", 20.0),
    "slack": ("span_tension", "driver-driven", 5.0),
    "torque": ("sprocket_torque", "driver", 1.0),
}
LIKE_NO_FIT: dict[str, Any] = {"every": 4e-4, "step": 7e-6, "method": "verlet", "run_in": 0.6}
#: Noise of a sample that the one before knows of [–].
_KEPT = 0.9


def draws_of(name: str) -> list[dict[str, str]]:
    """Draws of a table, which was made before anybody had seen a record of it."""
    text = (Path(__file__).parent / name).read_text(encoding="utf-8")
    return list(csv.DictReader(text.splitlines()))


def record_of(
    rig: cd.Drive,
    draw: Mapping[str, str],
    seconds: float,
    places: Mapping[str, Place] = INDUSTRIAL,
    *,
    gain_uncertainty: float = 0.01,
    **changes: Any,
) -> xr.Dataset:
    """A record of a rig, its gains off as drawn, its noise correlated in time."""
    rng = np.random.default_rng(int(draw["noise"]))
    channels = list(dict.fromkeys(quantity for quantity, *_ in places.values()))
    settings = {"until": seconds, "record": [*channels, "sprocket_angle"]} | LIKE_NO_FIT | changes
    run = cd.simulate(rig, error=False, **settings).isel(time=slice(0, -1))
    table, sensors = {"time [s]": run["time"].to_numpy()}, {}
    for name, (quantity, place, size) in places.items():
        white = rng.standard_normal(run.sizes["time"])
        noise = size * lfilter([np.sqrt(1.0 - _KEPT**2)], [1.0, -_KEPT], white)
        seen = run[quantity]
        label = next(str(it) for it in seen.dims if it != "time")
        unit = str(seen.attrs["units"])
        table[f"{name} [{unit}]"] = float(draw[f"gain_{name}"]) * seen.sel({label: place}) + noise
        sensors[name] = {"quantity": f"{quantity}[{place}]", "gain_uncertainty": gain_uncertainty}
    [driver, *_] = rig.resolved().to_dict()["sprockets"]
    turns = {driver["name"]: f"{driver['motion']['speed']} rad/s"}
    return cd.measured(pd.DataFrame(table), channels=sensors, turns=turns)
