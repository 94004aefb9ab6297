"""The same drive by every model of the chain."""

import time
from collections.abc import Iterator
from typing import Any

import numpy as np

import chaindrive as cd

#: Play between roller and bush where rollers are free [m]: that of the pins, twice.
FREE = {"rollers": "free", "roller": {"clearance": 50e-6}}

#: Keys of `chain` by the name of the model.
MODELS: dict[str, dict[str, Any]] = {
    "particles": {},
    "particles, free rollers": FREE,
    "clearance joints": {"model": "clearance-joints"},
    "clearance joints, free rollers": {"model": "clearance-joints", **FREE},
    "joints without play": {"model": "clearance-joints", "joint": {"clearance": 0.0}},
    "ideal joints": {"model": "ideal-joints"},
}

#: Presets, changes, run-in and end [s]. With its own pretension the slack span of the industrial
#: drive bears too little for the statics of joints with play.
DRIVES: tuple[tuple[str, dict[str, Any], float, float], ...] = (
    ("bicycle", {}, 0.2, 0.2),
    ("industrial_16b", {"route.pretension": 3e3}, 0.1, 0.1),
)


def by_model(preset: str, chain: dict[str, Any]) -> cd.Drive:
    """Return a preset with nothing of its chain left but type and links, and another model."""
    scene = getattr(cd.scenes, preset)().to_dict()
    kept = {key: scene["chain"][key] for key in ("type", "links")}
    return cd.Drive.from_dict({**scene, "chain": kept | chain})


def table(
    preset: str, changes: dict[str, Any], run_in: float, until: float, share: float
) -> Iterator[str]:
    """Yield the lines of a table; `share` of the times is simulated."""
    told = ", ".join(f"`{path}` {value:g}" for path, value in changes.items())
    yield f"### {preset}" + (f", {told}" if told else "")
    yield ""
    yield (
        "| model | tight span [N] | slack span [N] | contact force, median and p99 [N] "
        "| share lost | method and step | CPU time per simulated second [s] |"
    )
    yield "|---|---|---|---|---|---|---|"
    for name, chain in MODELS.items():
        drive = by_model(preset, chain).replace({"run.run_in": share * run_in, **changes})
        began = time.process_time()
        run = cd.simulate(
            drive,
            until=share * until,
            record=["span_tension", "contact_force"],
            error=False,
        )
        cost = (time.process_time() - began) / (share * (run_in + until))
        tension = run["span_tension"].values
        order = np.argsort(-tension.mean(0))
        spans = [f"{tension[:, k].mean():.1f} ± {tension[:, k].std():.1f}" for k in order]
        force = run["contact_force"].values
        median, p99 = np.quantile(force[force > 0], [0.5, 0.99])
        lost = "–"
        if "efficiency" in run.attrs:
            error = 100 * run.attrs["efficiency_error"]
            lost = f"{100 * (1 - run.attrs['efficiency']):.2f} ± {error:.2f} %"
        step = 1e6 * run.attrs["step"]
        row = [
            name,
            *spans,
            f"{median:.0f}, {p99:.0f}",
            lost,
            f"{run.attrs['method']}, {step:.2f} µs",
            f"{cost:.3g}",
        ]
        yield "| " + " | ".join(row) + " |"
    yield ""
