"""A driver whose speed swings far, and an idler that few teeth hold: tables of the marine page.

The paper assumes neither a least number of teeth engaged nor anything of the driver's speed. Its
own drive asks for neither, so a small one does: 08B-1, 19, 19 and 13 teeth, with an idler in a
bend of 15°, half of its tooth pitch.
"""

from functools import partial

import numpy as np
import xarray as xr
from marine_drive import RPM, Length
from matplotlib import pyplot as plt
from replicates import Page, study, table

import chaindrive as cd

PITCH, TEETH, IDLER = 12.7e-3, 19, 13
MEAN, WIDEST, FREQUENCY = 300.0, 900.0, 5.0  # r/min, r/min, Hz
SPANS = ("driver-driven", "driven-idler", "idler-driver")

SCENE = """
title = "A driver that swings, an idler that few teeth hold"

[chain]
type = "08B-1"

[[sprockets]]
name = "driver"
teeth = 19
centre = ["0 mm", "0 mm"]
motion = { kind = "constant", speed = "300 rpm" }

[[sprockets]]
name = "driven"
teeth = 19
centre = ["300 mm", "0 mm"]
inertia = "0.002 kg m^2"
load = [{ kind = "constant", torque = "-2 N m" }]

[[sprockets]]
name = "idler"
teeth = 13
centre = ["150 mm", "31 mm"]
inertia = "2e-5 kg m^2"

[route]
stops = ["driver", "driven", "idler"]
pretension = "200 N"
adjust = { kind = "sprocket", name = "driven", direction = [1, 0], within = "10 mm" }
"""


def swinging(reach: float) -> cd.Drive:
    """Return the drive whose driver's speed swings by `reach` [r/min] about its mean."""
    amplitude = reach * RPM / (2.0 * np.pi * FREQUENCY)
    terms = [{"amplitude": amplitude, "frequency": FREQUENCY}]
    motion = {"kind": "harmonics", "speed": MEAN * RPM, "terms": terms}
    if reach == 0.0:
        motion = {"kind": "constant", "speed": MEAN * RPM}
    return cd.Drive.from_toml(SCENE, "far swings").replace({"sprockets.driver.motion": motion})


def run_of(drive: cd.Drive, length: Length, step: float | None = None) -> xr.Dataset:
    return cd.simulate(
        drive,
        until=length.until,
        run_in=length.run_in,
        every=2e-4,
        method="auto" if step is None else "verlet",
        step=step,
        error=False,
        record=[
            "span_tension",
            "contact_force",
            "roller_x",
            "roller_y",
            "sprocket_angle",
            "sprocket_speed",
            "sprocket_x",
            "sprocket_y",
        ],
    )


def borne(run: xr.Dataset, sprocket: str, teeth: int) -> np.ndarray:
    """Return how many rollers a sprocket's teeth bear, (time,)."""
    wheel = run.sel(sprocket=sprocket)
    radius = 0.5 * PITCH / np.sin(np.pi / teeth)
    from_centre = np.hypot(
        run["roller_x"] - wheel["sprocket_x"], run["roller_y"] - wheel["sprocket_y"]
    )
    near = (from_centre < radius + 0.25 * PITCH).values
    return (near & (run["contact_force"].values > 0.0)).sum(axis=1)


def unaccounted(run: xr.Dataset) -> float:
    """Return the largest residual of the energy ledger over the energy moved [–]."""
    return abs(float(run.attrs["energy_residual_largest"])) / float(run.attrs["energy_moved"])


def measure_swing(drive: cd.Drive, length: Length) -> dict[str, float]:
    """Return the figures of one run."""
    run = run_of(drive, length)
    tension = run["span_tension"]
    on_idler = borne(run, "idler", IDLER)
    angle = run["sprocket_angle"]
    apart = (angle.sel(sprocket="driven") - angle.sel(sprocket="driver")).values
    return {
        "none": float((on_idler == 0).mean()),
        "one": float((on_idler == 1).mean()),
        "two": float((on_idler >= 2).mean()),
        "least": float(tension.min()),
        "greatest": float(tension.max()),
        "apart": float(np.ptp(apart)) / (2.0 * np.pi / TEETH),
        "residual": unaccounted(run),
    }


def swings(page: Page, length: Length) -> None:
    """Let the driver's speed swing up to a reversal, with half a tooth of wrap on the idler."""
    short = Length(0.2 * length.until, 0.4 * length.run_in)  # one period and what goes before it
    drives = {
        f"{MEAN - reach:.0f} to {MEAN + reach:.0f} at 5 Hz": swinging(reach)
        for reach in (300.0, WIDEST)
    }
    drives = {f"{MEAN:.0f}": swinging(0.0)} | drives
    columns = {
        "none": ("idler bears no roller [%]", 1e-2),
        "one": ("… one [%]", 1e-2),
        "two": ("… two or more [%]", 1e-2),
        "least": ("least tension of a span [N]", 1.0),
        "greatest": ("greatest [N]", 1.0),
        "apart": ("driven re driver, peak to peak [% of a tooth]", 1e-2),
        "residual": ("energy unaccounted for [% of what moved]", 1e-2),
    }
    cases = study(drives, partial(measure_swing, length=short))
    run = run_of(swinging(WIDEST), short)
    half = run_of(swinging(WIDEST), short, 0.5 * float(run.attrs["step"]))
    told = (
        f"Half the step leaves {100.0 * unaccounted(half):.4f} instead of "
        f"{100.0 * unaccounted(run):.4f} % of the widest swing unaccounted for."
    )
    page.add("swings", table(cases, columns, "driver [r/min]") + "\n\n" + told)

    figure, axes = plt.subplots(3, 1, figsize=(10, 6.5), sharex=True, layout="constrained")
    for name in ("driver", "driven"):
        speed = run["sprocket_speed"].sel(sprocket=name) / RPM
        axes[0].plot(run["time"], speed, linewidth=0.9, label=name)
    axes[0].axhline(0.0, color="0.6", linewidth=0.8)
    axes[0].set(
        ylabel="speed [r/min]", title="08B-1, 19, 19 and 13 teeth: −600 to 1 200 r/min at 5 Hz"
    )
    axes[0].legend(fontsize="small")
    for span in SPANS:
        axes[1].plot(run["time"], run["span_tension"].sel(span=span), linewidth=0.6, label=span)
    axes[1].set_ylabel("tension [N]")
    axes[1].legend(fontsize="small", ncols=3)
    axes[2].step(run["time"], borne(run, "idler", IDLER), linewidth=0.6, where="post")
    axes[2].set(
        ylabel="rollers borne by the idler",
        xlabel="time [s]",
        yticks=[0, 1, 2],
        xlim=(0.0, short.until),
    )
    page.save(figure, "swings")
