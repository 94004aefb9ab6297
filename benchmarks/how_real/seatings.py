"""Peaks of seating forces by every model of the chain, with the scatter of replicates.

The first contact of a roller that comes to a sprocket has a highest force; its percentiles over
all engagements of a run are one replicate, and the same drive begun at another place within a tooth
is the next.
"""

from collections.abc import Iterator

import numpy as np
from scipy import stats

import chaindrive as cd
from models import FREE, MODELS, by_model

PRESET, PRETENSION = "industrial_16b", 3e3  # N
RUN_IN, UNTIL = 0.1, 0.1  # s
#: Step of all runs [s]: a peak needs a shorter one than the tension, which the choice minds.
STEP = 1e-6
PERCENTILES = (50.0, 90.0, 99.0)

#: Play that is all but closed [m]: what a lumped roller is the limit of.
CLOSED = {"rollers": "free", "roller": {"clearance": 5e-6}}

CHAINS = {
    "particles": MODELS["particles"],
    "particles, free rollers, 5 µm": CLOSED,
    "particles, free rollers, 50 µm": FREE,
    "clearance joints": MODELS["clearance joints"],
    "clearance joints, free rollers, 50 µm": MODELS["clearance joints"] | FREE,
}


def table(replicates: int, share: float) -> Iterator[str]:
    """Yield the lines of a table: mean over replicates ± half of its 95 % interval (Student)."""
    yield f"### {PRESET}, `route.pretension` {PRETENSION:g}"
    yield ""
    wheels = by_model(PRESET, {}).sprockets
    columns = [f"{wheel}, p{p:.0f} [N]" for wheel in wheels for p in PERCENTILES]
    yield f"| model | {' | '.join(columns)} |"
    yield "|---" * (len(columns) + 1) + "|"
    for name, chain in CHAINS.items():
        found = np.array([peaks(chain, phase, share) for phase in phases(replicates)])
        middle = found.mean(0)
        half = np.full_like(middle, np.nan)
        if replicates > 1:
            t = stats.t.ppf(0.975, replicates - 1)
            half = t * found.std(0, ddof=1) / np.sqrt(replicates)
        cells = [f"{m:.0f} ± {h:.0f}" for m, h in zip(middle, half, strict=True)]
        yield "| " + " | ".join([name, *cells]) + " |"
    yield ""


def phases(replicates: int) -> np.ndarray:
    """Return where within a tooth the replicates begin."""
    return (np.arange(replicates) + 0.5) / replicates


def peaks(chain: dict[str, object], phase: float, share: float) -> np.ndarray:
    """Return percentiles of the peaks [N], sprocket after sprocket: (sprockets × percentiles)."""
    drive = by_model(PRESET, chain).replace(
        {
            "run.run_in": share * RUN_IN,
            "run.step": STEP,
            "route.phase": phase,
            "route.pretension": PRETENSION,
        }
    )
    run = cd.simulate(
        drive,
        until=share * UNTIL,
        record=["sprocket_angle"],
        events="teeth",
        error=False,
    )
    struck = run.drive.impacts()
    wheel, force = struck["sprocket_of"].values, struck["peak_force"].values
    names = run["sprocket"].values
    return np.concatenate([np.percentile(force[wheel == one], PERCENTILES) for one in names])
