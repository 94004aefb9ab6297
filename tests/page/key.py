"""Answers to the ten questions of `questions.md`, from the arrays of a run.

python tests/page/key.py marine_engine
"""

import sys
import tomllib

import numpy as np
import xarray as xr

import chaindrive as cd


def greatest(values: xr.DataArray) -> tuple[str, float]:
    """Name of the greatest value along the only dimension, and that value."""
    at = values.idxmax().item()
    return at, float(values.max())


def key(preset: str) -> list[str]:
    drive = getattr(cd.scenes, preset)()
    run = cd.simulate(drive, record="all")
    duration = float(run.time[-1] - run.time[0])
    # The chain holds back what drives it.
    power = (-run["sprocket_torque"] * run["sprocket_speed"]).mean("time")
    driver, driven_by = greatest(power)
    tight, tension = greatest(run["span_tension"].mean("time"))
    mean = run[["sprocket_force_x", "sprocket_force_y"]].mean("time")
    shaft, bearing = greatest(np.hypot(mean["sprocket_force_x"], mean["sprocket_force_y"]))
    breaking = tomllib.loads(run.attrs["resolved_scene"])["chain"].get("breaking_load")
    pull = float(run["link_tension"].max())
    struck = {str(name): run.attrs[f"impact_force_max_{name}"] for name in run.sprocket.values}
    hardest = max(struck, key=lambda name: struck[name])
    lost = run["energy_losses"].isel(time=-1) - run["energy_losses"].isel(time=0)
    place, _ = greatest(lost)
    stepping = {f"run.{name}": run.attrs[name] for name in ("method", "step")}
    swept = cd.sweep(
        drive.replace(stepping),
        {"run.until": [run.attrs["until"]]},
        run_in=run.attrs["run_in"],
    )
    half_width = float(swept["span_tension_half_width"].sel(span=tight).item())
    assumed = [
        line.split("=")[0].strip()
        for line in run.attrs["resolved_scene"].splitlines()
        if "# assumed" in line or "] assumed" in line
    ]
    return [
        f"{driver}, {driven_by * 1e-3:.4g} kW",
        f"{tight}, {tension:.5g} N",
        f"{breaking / pull:.4g}" if breaking else "no breaking load is known",
        f"{shaft}, {bearing:.5g} N",
        f"{hardest}, {struck[hardest]:.5g} N",
        f"{float(lost.sum()) / duration:.4g} W, {place}",
        f"steady: {bool(run.attrs['run_in_steady'])}, {run.attrs['run_in']:.4g} s",
        f"± {half_width:.3g} N",
        "one of " + ", ".join(assumed),
        f"{run.attrs['verdict']}: {run.attrs['verdict_note']}",
    ]


if __name__ == "__main__":
    for number, answer in enumerate(key(sys.argv[1]), 1):
        print(f"{number:2}. {answer}")
