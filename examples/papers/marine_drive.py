"""The marine drive of the paper, its neighbours, and what is measured on a run of it."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from replicates import arrivals, p99, spectrum

import chaindrive as cd

EVERY = 2e-4  # s
TIGHT, SPANS = "crank-camshaft", ("crank-camshaft", "tensioner-idler", "idler-crank")
ALL_SPANS = (*SPANS, "camshaft-tensioner")
SPEED = 127.0  # r/min
RPM = 2.0 * np.pi / 60.0
TEETH, PITCH, MASS = 48, 0.0889, 3.01  # of the crank; m, kg a link


@dataclass(frozen=True)
class Length:
    """How long runs are [s]."""

    until: float
    run_in: float


def paper() -> cd.Drive:
    """Return the drive as the paper models it."""
    return cd.scenes.marine_engine_bare()


def locked(drive: cd.Drive) -> cd.Drive:
    """Return a drive whose tensioner stays where it was assembled."""
    return drive.replace({"tensioners.tightener.push": {"kind": "locked"}})


def rubbing() -> cd.Drive:
    """Return the drive of the paper with oiled steel pins, μ = 0.1, and nothing else changed."""
    scene = paper().to_dict()
    scene["chain"]["type"] = "56B-1"
    scene["contact"]["teeth"]["series"] = 0.0
    return cd.Drive.from_dict(scene, "friction in the joints")


def with_play() -> cd.Drive:
    """Return the drive of the paper with play of pins in bushes and of bushes in rollers."""
    scene = rubbing().to_dict()
    scene["chain"] |= {"rollers": "free", "roller": {"clearance": "0.1 mm"}}
    scene["contact"]["joints"] = {"friction": {"kind": "none"}}
    # Without friction so little is lost that the default step, 7 µs, would miss half of it.
    scene["run"]["step"] = "2 us"
    return cd.Drive.from_dict(scene, "play in the joints")


def nearer(drive: cd.Drive, by: float) -> cd.Drive:
    """Return a drive whose guide bars are nearer to the chain by some metres."""
    scene = drive.to_dict()
    resolved = drive.resolved().to_dict()["guides"]
    for guide, known in zip(scene["guides"], resolved, strict=True):
        guide["face"]["bow"] = known["face"]["bow"] + by
    return cd.Drive.from_dict(scene, "bars nearer")


def half_pitch() -> cd.Drive:
    """Return the drive without bars, of a chain with half the pitch on twice the teeth."""
    scene = paper().replace({"guides": []}).to_dict()
    scene["chain"] |= {
        "pitch": "44.45 mm",
        "links": 244,
        "mass": "1.505 kg",
        "stiffness": "1630 MN/m",
        "roller_diameter": "26.99 mm",
        "plate_height": "38.9 mm",
    }
    for sprocket in scene["sprockets"]:
        sprocket["teeth"] *= 2
    # Twice the teeth have pitch circles that are 0.3 mm smaller.
    scene["route"]["adjust"] = {
        "kind": "sprocket",
        "name": "camshaft",
        "direction": [1.0, 0.0],
        "within": "5 mm",
    }
    return cd.Drive.from_dict(scene, "half the pitch")


def observe(drive: cd.Drive, length: Length, every: float = EVERY) -> xr.Dataset:
    """Run a drive at the default step, whose statistics are those of a sharp reference."""
    return cd.simulate(
        drive,
        run_in=length.run_in,
        until=length.until,
        every=every,
        method="auto",
        error=False,
        events=["teeth", "guides"] if drive.guides else ["teeth"],
        record=[
            "span_tension",
            "contact_force",
            "roller_x",
            "roller_y",
            "sprocket_angle",
            "sprocket_speed",
            "sprocket_x",
            "sprocket_y",
            "guide_force_x",
            "guide_force_y",
            "energy_dissipated",
        ],
    )


def tangent(drive: cd.Drive, span: str, run: xr.Dataset) -> tuple[np.ndarray, np.ndarray]:
    """Return both ends of a span on the pitch circles of its sprockets, (2, 2), and its normal.

    The normal points out of the loop.
    """
    scene = drive.resolved().to_dict()
    ends = []
    for name in span.split("-"):
        teeth = next(s["teeth"] for s in scene["sprockets"] if s["name"] == name)
        place = run.sel(sprocket=name)
        centre = np.array([float(place[f"sprocket_{axis}"].mean()) for axis in "xy"])
        ends.append((centre, 0.5 * scene["chain"]["pitch"] / np.sin(np.pi / teeth)))
    (first, radius), (second, other) = ends
    return touching(first, radius, second, other)


def touching(
    first: np.ndarray, radius: float, second: np.ndarray, other: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return both ends of the line that touches two circles on its left, and its normal."""
    along = second - first
    distance = np.hypot(*along)
    along /= distance
    # n · (second − first) = R − R′ on the right, outside the loop
    sine = (radius - other) / distance
    normal = np.sqrt(1.0 - sine**2) * np.array([along[1], -along[0]]) + sine * along
    return np.array([first + radius * normal, second + other * normal]), normal


def beside(drive: cd.Drive, span: str, run: xr.Dataset) -> tuple[np.ndarray, np.ndarray, float]:
    """Return where rollers are along and outside the line of a span, and its length [m].

    Both are (time, roller), counted from the middle of the line.
    """
    ends, normal = tangent(drive, span, run)
    length = float(np.hypot(*(ends[1] - ends[0])))
    places = np.stack([run["roller_x"].values, run["roller_y"].values], axis=-1)
    places = places - ends.mean(axis=0)
    return places @ ((ends[1] - ends[0]) / length), places @ normal, length


def offset(drive: cd.Drive, span: str, run: xr.Dataset) -> np.ndarray:
    """Return the offset of the middle of a span from its straight line, outward [m], (time,)."""
    s, y, _ = beside(drive, span, run)
    near = np.abs(y) < 2.0 * drive.resolved().to_dict()["chain"]["pitch"]
    before = np.where(near & (s <= 0.0), s, -np.inf).argmax(axis=1)
    after = np.where(near & (s > 0.0), s, np.inf).argmin(axis=1)
    rows = np.arange(len(s))
    share = -s[rows, before] / (s[rows, after] - s[rows, before])
    return (1.0 - share) * y[rows, before] + share * y[rows, after]


def taken_by_waves(drive: cd.Drive, span: str, run: xr.Dataset) -> float:
    """Return how much chain the slopes of a span take, in the mean over time [m]."""
    s, y, length = beside(drive, span, run)
    inside = (np.abs(s) < 0.5 * length - PITCH) & (np.abs(y) < PITCH)
    both = inside & np.roll(inside, -1, axis=1)
    slope = (np.roll(y, -1, axis=1) - y)[both] / (np.roll(s, -1, axis=1) - s)[both]
    # ΔL = ½ ∫ y′² ds
    return 0.5 * length * float(np.mean(slope**2))


def measure(drive: cd.Drive, length: Length) -> dict[str, Any]:
    """Return the figures of one run."""
    run = observe(drive, length)
    tension = run["span_tension"]
    tight, slack = tension.sel(span=TIGHT), tension.sel(span="tensioner-idler")
    camshaft = run["sprocket_speed"].sel(sprocket="camshaft")
    landed = arrivals(run, "crank", min(0.3, 0.2 * length.until))
    lost = run["energy_dissipated"]
    found = {
        "tight": float(tight.mean()),
        "tight_std": float(tight.std()),
        "slack": float(slack.mean()),
        "slack_std": float(slack.std()),
        "contact_p99": p99(run["contact_force"].values),
        "arrival": float(np.median(landed)) if landed.size else np.nan,
        "arrival_p90": float(np.percentile(landed, 90)) if landed.size else np.nan,
        "ripple": float(camshaft.std() / abs(camshaft.mean())),
        "loss": float(lost[-1] - lost[0]) / length.until,
        "waves": sum(taken_by_waves(drive, span, run) for span in ALL_SPANS),
        "guide": 0.0,
    }
    on_bars = ((run["event_kind"] == "guide") & (run["event_start"] > 0.0)).values
    blows = run["event_peak_force"].values[on_bars]
    found["blows"] = len(blows) / length.until
    found["blow"] = p99(blows)
    if drive.guides:
        force = np.hypot(run["guide_force_x"], run["guide_force_y"])
        found["guide"] = float(force.sum("guide").mean())
    for span in SPANS:
        swing = offset(drive, span, run)
        found[f"swing {span}"] = float(swing.std())
        found[f"reach {span}"] = float(np.percentile(swing, 99.5))
        found |= {f"{band} {span}": value for band, value in by_frequency(swing).items()}
    return found


def by_frequency(
    swing: np.ndarray, every: float = EVERY, mesh: float = TEETH * SPEED / 60.0
) -> dict[str, Any]:
    """Return the root mean square of a swing below half the mesh frequency, and above it [m].

    With its spectrum, `level`, whose lines are root mean squares as well.
    """
    frequency, level = spectrum(swing, every)
    low = frequency < 0.5 * mesh
    # A line under a Hann window spreads over others: the squares sum to 1.5 of its own.
    slow, fast = (float(np.sqrt((level[it] ** 2).sum() / 1.5)) for it in (low, ~low))
    return {"slow": slow, "fast": fast, "level": level}
