"""A fit of few and short runs, also as a program of its own that somebody may kill.

``python cheap_fit.py RECORD DRIVE STORE`` says ``begun`` when it begins.
"""

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

import chaindrive as cd

LOAD = "sprockets.driven.load[0].torque"
PRETENSION = "route.pretension"
FREE = {LOAD: (-1600.0, -1300.0), PRETENSION: (1000.0, 2000.0)}


def written(folder: Path) -> tuple[Path, Path]:
    """Write a record, made of a run with noise, and the drive that is fitted to it."""
    drive = cd.scenes.industrial_16b().replace({"run.run_in": "10 ms"})
    (folder / "drive.toml").write_text(drive.text, encoding="utf-8")
    true = drive.replace({LOAD: -1400.0, PRETENSION: 1400.0, "route.phase": 0.37})
    settings = {"until": 0.06, "every": 4e-4, "step": 6e-6, "method": "verlet", "error": False}
    run = cd.simulate(true, record=["span_tension"], **settings).isel(time=slice(0, -1))
    noise = np.random.default_rng(5).standard_normal((2, run.sizes["time"]))
    table = pd.DataFrame(
        {
            "time [s]": run["time"],
            "tight [N]": run["span_tension"][:, 1] + 5.0 * noise[0],
            "slack [N]": run["span_tension"][:, 0] + 5.0 * noise[1],
        }
    )
    table.to_csv(folder / "rig.csv", index=False)
    return folder / "rig.csv", folder / "drive.toml"


def fitted(files: tuple[Path, Path], store: Path | None, **workers: Any) -> xr.Dataset:
    """Fit the drive to the record."""
    record, drive = files
    channels = {
        "tight": {"quantity": "span_tension[driven-driver]", "gain_uncertainty": 0.001},
        "slack": {"quantity": "span_tension[driver-driven]", "gain_uncertainty": 0.001},
    }
    data = cd.measured(record, channels=channels, turns={"driver": "300 rpm"})
    return cd.calibrate(cd.load(drive), data, FREE, starts=2, store=store, **workers)


if __name__ == "__main__":
    print("begun", flush=True)
    fitted((Path(sys.argv[1]), Path(sys.argv[2])), Path(sys.argv[3]), jobs=1)
