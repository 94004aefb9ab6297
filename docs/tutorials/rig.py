"""Make rig.csv: a record of a rig that does not exist, for the tutorial `measured`.

Another run of `industrial_16b`, with another load, pretension, phase, step and sampling than the
drive has, noise that is correlated in time, and gains that are off. Run it as
``python docs/tutorials/rig.py``.
"""

from pathlib import Path

import numpy as np
import pandas as pd
from scipy.signal import lfilter

import chaindrive as cd

LOAD, PRETENSION = -1380.0, 1750.0  # N m, N
#: Error of the gain of each channel [–], its noise [unit of the column] and place.
CHANNELS = {
    "tight strand [kN]": (1.006, 0.02, ("span_tension", "driven-driver")),
    "slack strand [kN]": (0.993, 0.005, ("span_tension", "driver-driven")),
    "flange [N m]": (1.003, 1.0, ("sprocket_torque", "driver")),
}


def main() -> None:
    """Write the file beside this one."""
    drive = cd.scenes.industrial_16b().replace(
        {
            "sprockets.driven.load[0].torque": LOAD,
            "route.pretension": PRETENSION,
            "route.phase": 0.31,
        }
    )
    settings = {"until": 0.8, "every": 1e-3, "step": 7e-6, "method": "verlet", "run_in": 0.5}
    record = ["span_tension", "sprocket_torque"]
    run = cd.simulate(drive, record=record, error=False, **settings).isel(time=slice(0, -1))
    rng = np.random.default_rng(16)
    columns = {"time [ms]": 1e3 * run["time"].to_numpy()}
    for name, (gain, size, (quantity, place)) in CHANNELS.items():
        held = run[quantity]
        true = held.sel({str(held.dims[1]): place}).to_numpy() * (1e-3 if "kN" in name else 1.0)
        white = rng.standard_normal(true.size)
        noise = size * lfilter([np.sqrt(1.0 - 0.9**2)], [1.0, -0.9], white)
        columns[name] = gain * true + noise
    table = pd.DataFrame(columns).round(4)
    place = Path(__file__).with_name("rig.csv")
    table.to_csv(place, index=False, sep=";", decimal=",", lineterminator="\n")


if __name__ == "__main__":
    main()
