"""Transverse vibration of both spans of the bicycle, and its drive with a tensioner and a bar."""

from functools import partial
from typing import Any

import numpy as np
import xarray as xr
from marine_drive import Length, by_frequency, offset
from matplotlib import pyplot as plt
from replicates import Page, p99, study, table

import chaindrive as cd

UPPER, LOWER = "chainring-rear", "rear-chainring"
EVERY = 5e-4  # s
MESH = 44 * 1.5  # Hz, at 90 r/min
# What the paper leaves out: plates and pins that yield behind the joints, and friction.
PAPER = {
    "contact.joints.series": 0.0,
    "contact.teeth.series": 0.0,
    "contact.joints.friction": {"kind": "none"},
}


def swing(drive: cd.Drive, length: Length, method: str | None) -> dict[str, Any]:
    """Return tensions of both spans, and the swing of their middles by frequency."""
    run = cd.simulate(
        drive,
        until=length.until,
        run_in=length.run_in,
        every=EVERY,
        method=method,
        error=False,
        record=["span_tension", "roller_x", "roller_y", "sprocket_x", "sprocket_y"],
    )
    found: dict[str, Any] = {}
    for span in (UPPER, LOWER):
        tension = run["span_tension"].sel(span=span)
        found |= {f"tension {span}": float(tension.mean()), f"std {span}": float(tension.std())}
        parts = by_frequency(offset(drive, span, run), EVERY, MESH)
        found |= {f"{band} {span}": value for band, value in parts.items()}
    return found


def spans(page: Page, length: Length) -> None:
    """Part the swing of both spans by frequency, tight and slack, default and rigid links."""
    tight, slack = cd.scenes.bicycle(), cd.scenes.bicycle_slack()
    columns = {
        f"{key} {span}": (f"{name}{text} {unit}", scale)
        for span, name in ((UPPER, "upper: "), (LOWER, "lower: "))
        for key, text, unit, scale in (
            ("tension", "tension, mean", "[N]", 1.0),
            ("std", "std", "[N]", 1.0),
            ("slow", "swing below half the mesh", "[µm]", 1e-6),
            ("fast", "above", "[µm]", 1e-6),
        )
    }
    # A chain of links that yield takes steps of 12 µs here, one of rigid links a tenth of that.
    kinds = {
        "spans, default": (tight, slack, Length(5.0 * length.until, 2.5 * length.run_in), None),
        "spans, rigid links": (
            tight.replace(PAPER),
            slack.replace(PAPER),
            Length(2.5 * length.until, length.run_in),
            "auto",
        ),
    }
    figure, axes = plt.subplots(2, 2, figsize=(12, 6.4), sharex=True, layout="constrained")
    for number, (title, (taut, loose, long, method)) in enumerate(kinds.items()):
        drives = {"tight, 60 N": taut, "slack, 1 mm nearer": loose}
        cases = study(drives, partial(swing, length=long, method=method))
        page.add(title, table(cases, columns, title.partition(", ")[2]))
        for row, (name, case) in enumerate(cases.items()):
            for column, span in enumerate((UPPER, LOWER)):
                axis = axes[row, column]
                level = np.sqrt((case[f"level {span}"] ** 2).mean(axis=0))
                frequency = np.fft.rfftfreq(round(long.until / EVERY) + 1, EVERY)
                label = title.partition(", ")[2]
                axis.semilogy(frequency, 1e6 * level, color=f"C{number}", label=label)
                for order in range(1, 8):
                    # f = n √(T/m′)/2ℓ; the chain runs at 3 to 10 % of the waves' speed
                    place = order * first_frequency(taut, float(case[f"tension {span}"].mean()))
                    axis.axvline(place, color=f"C{number}", linestyle=":", linewidth=0.7, zorder=0)
                axis.axvline(MESH, color="black", linestyle="--", linewidth=0.7, zorder=0)
                axis.set_title(f"{name}: {'upper' if span == UPPER else 'lower'} span", fontsize=10)
    for axis in axes.flat:
        axis.set(xlim=(0.0, 150.0), ylim=(1e-2, 1e3), ylabel="swing [µm]")
    for axis in axes[-1]:
        axis.set_xlabel("frequency [Hz]; dotted: modes of a string, dashed: the mesh")
    axes[0, 0].legend(fontsize="small")
    page.save(figure, "spans")


def first_frequency(drive: cd.Drive, tension: float) -> float:
    """Return the first frequency of a string as long as a span [Hz]."""
    scene = drive.resolved().to_dict()
    near, far = (np.array(it["centre"]) for it in scene["sprockets"])
    half = 0.5 * scene["chain"]["pitch"]
    radii = [half / np.sin(np.pi / it["teeth"]) for it in scene["sprockets"]]
    length = np.sqrt(((near - far) ** 2).sum() - (radii[0] - radii[1]) ** 2)
    return float(np.sqrt(tension / MASS) / (2.0 * length))


MASS = 0.300  # kg/m, of the chain 081

WHOLE = """
title = "Bicycle with a jockey on an arm and a bar"

[chain]
type = "081"
model = "clearance-joints"
rollers = "free"
roller = { clearance = "0.05 mm" }
links = 106

[contact.teeth]
restitution = 0.8
onset_floor = "0.05 m/s"

[contact.joints]
restitution = 0.7
onset_floor = "0.05 m/s"

[contact.guides]
law = { kind = "linear", stiffness = "1 MN/m" }
restitution = 0.5
onset_floor = "0.05 m/s"

[[sprockets]]
name = "chainring"
teeth = 44
centre = ["0 m", "0 m"]
motion = { kind = "constant", speed = "-90 rpm" }

[[sprockets]]
name = "rear"
teeth = 18
centre = ["-0.44 m", "0 m"]
inertia = "0.12 kg m^2"
load = [{ kind = "constant", torque = "5 N m" }]

[[sprockets]]
name = "jockey"
teeth = 11
centre = ["-0.405 m", "-113.6 mm"]
inertia = "2.5e-6 kg m^2"
mass = "12 g"
support = { kind = "tensioner", name = "arm" }

[[tensioners]]
name = "arm"
carrier = { kind = "arm", pivot = ["-0.43 m", "-70 mm"], inertia = "5e-5 kg m^2" }

[tensioners.push]
kind = "torsion-spring"
preload = "-0.8 N m"
stiffness = "0.4 N m"
damping = "0.02 N m s"

# Below the long lower span, which hangs by 1 mm.
[[guides]]
name = "bar"

[guides.face]
kind = "on-span"
between = ["jockey", "chainring"]
from = "30 %"
to = "70 %"
bow = "-1 mm"

[route]
stops = ["chainring", "rear", "jockey"]
pretension = "10 N"
adjust = { kind = "arm", name = "arm", within = "20 deg" }
"""


def whole() -> cd.Drive:
    """Return a drive that has all that the paper names: tensioner, delimiter, free rollers."""
    return cd.Drive.from_toml(WHOLE, "bicycle with a jockey")


def all_parts(drive: cd.Drive, length: Length) -> tuple[dict[str, Any], xr.Dataset]:
    """Return the figures of one run, and the run."""
    run = cd.simulate(
        drive,
        until=length.until,
        run_in=length.run_in,
        every=1e-4,
        error=False,
        record=[
            "span_tension",
            "contact_force",
            "joint_force",
            "sprocket_x",
            "sprocket_y",
            "roller_x",
            "roller_y",
            "tensioner_position",
            "energy_dissipated",
            *(["guide_force_x", "guide_force_y"] if drive.guides else []),
        ],
    )
    tension = run["span_tension"]
    lost = run["energy_dissipated"]
    found = {
        "tight": float(tension.sel(span=UPPER).mean()),
        "slack": float(tension.sel(span="jockey-chainring").mean()),
        "joint_p99": p99(run["joint_force"].values),
        "joint_open": float((run["joint_force"].values == 0.0).mean()),
        "contact_p99": p99(run["contact_force"].values),
        "arm": float(np.ptp(run["tensioner_position"].values)),
        "sway": float(offset(drive, "jockey-chainring", run).std()),
        "bar": 0.0,
        "lost": float(lost[-1] - lost[0]) / length.until,
        "residual": abs(float(run.attrs["energy_residual_largest"]))
        / float(run.attrs["energy_moved"]),
    }
    if drive.guides:
        found["bar"] = float(np.hypot(run["guide_force_x"], run["guide_force_y"]).mean())
    return found, run


def whole_drive(page: Page, length: Length) -> None:
    """Run tensioner, bar, joints with play and free rollers in one drive, and parts of it."""
    lumped = {"chain.rollers": "lumped", "chain.roller": {}}
    parts = {
        "rollers lumped": whole().replace(lumped),
        "rollers lumped, no bar": whole().replace(lumped | {"guides": []}),
    }
    short = Length(0.5 * length.until, 0.5 * length.run_in)
    columns = {
        "tight": ("upper span, mean [N]", 1.0),
        "slack": ("jockey to chainring, mean [N]", 1.0),
        "joint_p99": ("pin in bush, 99 % [N]", 1.0),
        "joint_open": ("pins out of touch [%]", 1e-2),
        "contact_p99": ("roller on tooth, 99 % [N]", 1.0),
        "arm": ("arm turns by, peak to peak [mrad]", 1e-3),
        "sway": ("jockey to chainring sways, std [mm]", 1e-3),
        "bar": ("force on the bar, mean [N]", 1.0),
        "lost": ("lost [W]", 1.0),
        "residual": ("energy unaccounted for [% of what moved]", 1e-2),
    }
    shown: dict[float, xr.Dataset] = {}

    def figures(drive: cd.Drive) -> dict[str, Any]:
        found, run = all_parts(drive, short)
        shown[drive.to_dict()["route"]["phase"]] = run
        return found

    drive = whole()
    cases = study({"jockey, bar, free rollers": drive}, figures)
    run = shown[max(shown)]
    cases |= study(parts, figures)
    page.add("one drive", table(cases, columns))

    figure, axes = plt.subplot_mosaic(
        [["drive", "tension"], ["drive", "bar"], ["drive", "arm"]],
        figsize=(12, 5),
        width_ratios=[1.3, 1],
        layout="constrained",
    )
    cd.plot.layout(drive, ax=axes["drive"])
    time = 1e3 * run["time"]
    for span in (UPPER, "rear-jockey", "jockey-chainring"):
        axes["tension"].plot(time, run["span_tension"].sel(span=span), linewidth=0.7, label=span)
    axes["tension"].legend(fontsize="small")
    axes["tension"].set_ylabel("tension [N]")
    axes["bar"].plot(time, np.hypot(run["guide_force_x"], run["guide_force_y"]), linewidth=0.7)
    axes["bar"].set_ylabel("force on the bar [N]")
    axes["arm"].plot(time, 1e3 * run["tensioner_position"], linewidth=0.9)
    axes["arm"].set(ylabel="arm [mrad]", xlabel="time [ms]")
    page.save(figure, "one-drive")
