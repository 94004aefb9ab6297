"""Impacts of rollers in oil: how hard they are over the film at touch and the viscosity.

The median of the greatest force of every impact on a sprocket, with what half the step changes.
"""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

import chaindrive as cd
from chaindrive.plot.scheme import CURVES, STYLE

PRESET = "marine_engine_oil"
DRY = "marine_engine"
#: Sprocket whose impacts are drawn.
WHEEL = "tensioner"
RUN_IN, UNTIL = 0.5, 0.5  # s
FILMS = (10e-6, 30e-6, 100e-6, 270e-6)  # m
VISCOSITIES = (0.02, 0.05, 0.1)  # Pa s
#: Steps that are compared [s]; the shorter one is told.
STEPS = (4e-6, 2e-6)


def table(share: float) -> Iterator[str]:
    """Yield the lines of a table: median force ± change by half the step, sprocket by sprocket."""
    dry = getattr(cd.scenes, DRY)()
    law = dry.resolved().to_dict()["contact"]["teeth"]["law"]
    rows: list[tuple[str, cd.Drive]] = [("dry, restitution 0.4", dry)]
    elastic = dry.replace({"contact.teeth": {"law": law, "dissipation": "none"}})
    rows.append(("dry, restitution 1", elastic))
    oiled = getattr(cd.scenes, PRESET)()
    for film in FILMS:
        for viscosity in VISCOSITIES:
            changed = {"thickness": film, "viscosity": viscosity}
            drive = oiled.replace(
                {f"contact.teeth.film.{key}": value for key, value in changed.items()}
            )
            rows.append((f"{1e6 * film:.0f} µm, {viscosity:g} Pa s", drive))
    yield f"### {PRESET}"
    yield ""
    yield f"| film at touch, viscosity | {', median [kN] | '.join(dry.sprockets)}, median [kN] |"
    yield "|---" * (1 + len(dry.sprockets)) + "|"
    for name, drive in rows:
        coarse, fine = (medians(drive, step, share) for step in STEPS)
        cells = [
            f"{1e-3 * f:.1f} ± {100 * abs(c / f - 1.0):.1f} %"
            for c, f in zip(coarse, fine, strict=True)
        ]
        yield "| " + " | ".join([name, *cells]) + " |"
    yield ""


def medians(drive: cd.Drive, step: float, share: float) -> np.ndarray:
    """Return the median of the greatest forces [N] of the impacts on each sprocket."""
    drive = drive.replace({"run.run_in": share * RUN_IN, "run.step": step, "run.method": "verlet"})
    run = cd.simulate(
        drive, until=share * UNTIL, record=["sprocket_angle"], events="teeth", error=False
    )
    struck = run.drive.impacts()
    wheel, force = struck["sprocket_of"].values, struck["peak_force"].values
    return np.array([np.median(force[wheel == one]) for one in run["sprocket"].values])


def draw(path: Path) -> None:
    """Draw force and film of one roller that seats, for a dry seat and three films."""
    from matplotlib import pyplot as plt

    oiled = getattr(cd.scenes, PRESET)()
    with plt.rc_context(dict(STYLE)):
        figure, axes = plt.subplots(2, 1, figsize=(7.0, 5.5), sharex=True, layout="constrained")
        for film, color in zip(FILMS[1:], CURVES, strict=False):
            drive = oiled.replace(
                {
                    "contact.teeth.film.thickness": film,
                    "run.run_in": 0.05,
                    "run.step": STEPS[1],
                    "run.method": "verlet",
                }
            )
            run = cd.simulate(
                drive,
                until=0.03,
                every=STEPS[1],
                record=["contact_force", "film_thickness", "sprocket_angle"],
                events="teeth",
                error=False,
            )
            struck = run.drive.impacts()
            there = (struck["sprocket_of"].values == WHEEL) & (struck["time_of"].values > 0.01)
            first = int(np.argmax(there))
            roller, start = int(struck["roller_of"][first]), float(struck["time_of"][first])
            seen = run.sel(roller=roller, time=slice(start - 2e-4, start + 2e-3))
            time = 1e3 * (seen["time"].values - start)
            look = {"color": color, "label": f"{1e6 * film:.0f} µm at touch"}
            axes[0].plot(time, 1e-3 * seen["contact_force"].values, **look)
            axes[1].plot(time, 1e6 * seen["film_thickness"].values, **look)
        axes[0].set_ylabel("force [kN]")
        axes[1].set_ylabel("film [µm]")
        axes[1].set_yscale("log")
        axes[1].set_xlabel("time since the roller met the oil [ms]")
        axes[0].legend()
        figure.savefig(path, dpi=100)
        plt.close(figure)
