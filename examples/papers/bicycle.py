"""The bicycle paper reproduced: tables and figures of docs/bicycle-paper.md.

Draws every comparison that "Contact mechanics in a roller chain drive using a multibody approach"
makes on the chain of a bicycle, each with five replicates and a verdict.

Run it as ``python examples/papers/bicycle.py [--until SECONDS] [--results FOLDER]``. With the
default of 0.08 s a run it takes some five minutes on two cores.
"""

import argparse
import warnings
from collections.abc import Callable, Iterable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import xarray as xr
from bicycle_law import law
from bicycle_spans import PAPER, spans, whole_drive
from life import Life, life
from marine_drive import Length
from replicates import Case, Page, arrivals, p99, study, table

import chaindrive as cd

mpl.use("Agg")
from matplotlib import pyplot as plt

PITCH = 0.0127  # m
TEETH = {"chainring": 44, "rear": 18}
ELASTIC = [
    "cylindrical",
    "johnson",
    "conformal",
    "radzimovsky",
    "esdu-78035",
    "dubowsky-freudenstein",
    "hertz",
]
DISSIPATIONS = [
    "exact",
    "lankarani-nikravesh",
    "hunt-crossley",
    "lee-wang",
    "herbert-mcwhannell",
    "gonthier",
    "zhiying-qishao",
    "flores",
    "hu-guo",
]
CLEARANCES = [25, 10, 50, 100, 200]  # µm, that of the preset first


def tight() -> cd.Drive:
    return cd.scenes.bicycle().replace(PAPER)


def slack() -> cd.Drive:
    return cd.scenes.bicycle_slack().replace(PAPER)


def observe(drive: cd.Drive, length: Length, **options: Any) -> xr.Dataset:
    """Run a drive at its default step, some 2 µs; a quarter of it changes no figure by 1 %."""
    particles = drive.resolved().to_dict()["chain"]["model"] == "particles"
    ideal = drive.resolved().to_dict()["chain"]["model"] == "ideal-joints"
    joints = [] if particles or ideal else ["joint_force", "joint_depth"]
    settings = {"method": "auto"} | options
    return cd.simulate(
        drive,
        run_in=length.run_in,
        until=length.until,
        every=5e-5,
        error=False,
        events=["teeth"] if particles or ideal else ["teeth", "joints"],
        record=[
            "span_tension",
            "contact_force",
            "roller_x",
            "roller_y",
            "sprocket_speed",
            *joints,
        ],
        **settings,
    )


def seated(run: xr.Dataset, drive: cd.Drive, sprocket: str) -> np.ndarray:
    """Return which rollers lie in the gaps of a sprocket, (time, roller)."""
    scene = drive.resolved().to_dict()["sprockets"]
    x, y = next(s["centre"] for s in scene if s["name"] == sprocket)
    radius = 0.5 * PITCH / np.sin(np.pi / TEETH[sprocket])
    return (np.hypot(run["roller_x"] - x, run["roller_y"] - y) < radius + 0.05 * PITCH).values


def measure(drive: cd.Drive, length: Length, **options: Any) -> dict[str, float]:
    """Return the figures of one run."""
    run = observe(drive, length, **options)
    tension = run["span_tension"]
    rear = run["sprocket_speed"].sel(sprocket="rear")
    force = run["contact_force"].values
    moved = float(run.attrs["energy_moved"])
    ring = float(run["sprocket_speed"].sel(sprocket="chainring").mean())
    visits = TEETH["chainring"] * abs(ring) / (2.0 * np.pi) * length.until
    found = {
        "tight": float(tension[:, 0].mean()),
        "tight_std": float(tension[:, 0].std()),
        "slack": float(tension[:, 1].mean()),
        "contact_p99": p99(force),
        "ripple": float(rear.std() / abs(rear.mean())),
        "residual": abs(float(run.attrs["energy_residual_largest"])) / moved,
        "evaluations": float(run.attrs["evaluations"]),
        "step_time": float(run.attrs["ns_per_link_step"]),
    }
    begun = (run["event_start"] > 0.0).values  # what lasts from before the record is no blow
    for name, sprocket in (("ring", "chainring"), ("rear", "rear")):
        inside = seated(run, drive, sprocket)
        found[f"held {name}"] = float((force[inside] > 0.0).mean())
        mine = (run["event_body"] == sprocket).values & (run["event_kind"] == "tooth").values
        found[f"blows {name}"] = float((mine & begun).sum()) / visits
        landed = arrivals(run, sprocket, 0.1 * length.until)
        found[f"arrival {name}"] = float(np.median(landed)) if landed.size else np.nan
    if "joint_force" in run:
        pins = run["joint_force"].values
        found["joint_p99"] = p99(pins)
        found["joint_open"] = float((pins == 0.0).mean())
        found["depth_p99"] = float(np.percentile(run["joint_depth"].values, 99))
        knocks = (run["event_kind"] == "joint").values & begun
        found["knocks"] = float(knocks.sum()) / (run.sizes["joint"] * length.until)
    else:
        found |= dict.fromkeys(("joint_p99", "joint_open", "depth_p99", "knocks"), np.nan)
    return found


FORCES = {
    "tight": ("tight span, mean [N]", 1.0),
    "tight_std": ("tight span, std [N]", 1.0),
    "joint_p99": ("pin in bush, 99 % [N]", 1.0),
    "depth_p99": ("indentation of pins, 99 % [µm]", 1e-6),
    "contact_p99": ("roller on tooth, 99 % [N]", 1.0),
    "held ring": ("seated rollers held, ring [%]", 1e-2),
    "ripple": ("rear speed, std [%]", 1e-2),
}
MESHING = {
    "held ring": ("seated rollers held: ring [%]", 1e-2),
    "held rear": ("… rear [%]", 1e-2),
    "blows ring": ("contacts a visit: ring", 1.0),
    "blows rear": ("… rear", 1.0),
    "arrival ring": ("rollers arrive with: ring [m/s]", 1.0),
    "joint_open": ("pins out of touch [%]", 1e-2),
    "tight_std": ("tight span, std [N]", 1.0),
    "contact_p99": ("roller on tooth, 99 % [N]", 1.0),
}


def with_law(drive: cd.Drive, kind: str) -> cd.Drive:
    """Give joints, seats and flanks a law of the family, with the dimensions that they have."""
    scene = drive.to_dict()
    scene.setdefault("contact", {}).setdefault("joints", {})["law"] = kind
    known = drive.resolved().to_dict()["sprockets"]
    for sprocket, resolved in zip(scene["sprockets"], known, strict=True):
        seat = {key: resolved["contact"]["law"][key] for key in ("length", "radius", "clearance")}
        law = resolved["flank"]["law"]
        flank = {key: law[key] for key in ("length", "radius", "other_radius", "depth_cap")}
        if kind == "hertz":
            # Points have neither length nor clearance: the hollow is a negative radius.
            seat = {"radius": seat["radius"], "other_radius": -seat["radius"] - seat["clearance"]}
            flank = {key: flank[key] for key in ("radius", "other_radius")}
        sprocket["contact"] = {"law": {"kind": kind} | seat}
        sprocket["flank"] = {"law": {"kind": kind} | flank}
    return cd.Drive.from_dict(scene, f"{drive.name}, {kind}")


def laws(page: Page, length: Length) -> None:
    """Run the bicycle with every elastic law and every dissipation."""
    columns = FORCES | {"step_time": ("cost [ns a link and step]", 1.0)}
    drives = {kind: with_law(tight(), kind) for kind in ELASTIC}
    rigid = study(drives, partial(measure, length=length))
    page.add("laws", table(rigid, columns, "elastic law, rigid links"))

    drives = {kind: with_law(cd.scenes.bicycle(), kind) for kind in ELASTIC}
    default = study(drives, partial(measure, length=length))
    page.add("laws, default", table(default, FORCES, "elastic law, links that yield"))

    drives = {
        kind: tight().replace(
            {"contact.joints.dissipation": kind, "contact.teeth.dissipation": kind}
        )
        for kind in DISSIPATIONS
    }
    lost = study(drives, partial(measure, length=length))
    page.add("dissipations", table(lost, FORCES, "dissipation, rigid links"))

    figure, axes = plt.subplots(1, 3, figsize=(13, 4.6), layout="constrained")
    depth = np.geomspace(1e-8, 2e-5, 200)
    for kind in ELASTIC:
        law = with_law(tight(), kind).law("joints")
        axes[0].loglog(1e6 * depth, law.force(depth), label=kind)
    axes[0].set(
        xlabel="indentation [µm]", ylabel="force [N]", title="the laws: pin in bush, 25 µm of play"
    )
    axes[0].legend(fontsize="small")
    bars(axes[1], rigid, default, "joint_p99", "pin in bush, 99 % [N]")
    bars(axes[2], rigid, default, "tight_std", "tight span, std [N]")
    axes[1].legend(fontsize="small")
    page.save(figure, "laws")


def bars(axis: Any, rigid: Mapping[str, Case], default: Mapping[str, Case], key: str, label: str):
    """Draw the same figure with rigid links and with links that yield, replicates as dots."""
    places = np.arange(len(rigid))
    for shift, cases, name in ((-0.2, rigid, "rigid links"), (0.2, default, "links that yield")):
        values = np.array([case[key] for case in cases.values()])
        axis.bar(places + shift, values.mean(axis=1), 0.38, alpha=0.6, label=name)
        for place, five in zip(places, values, strict=True):
            axis.plot(np.full(len(five), place + shift), five, ".", color="black", markersize=3)
    axis.set_xticks(places, list(rigid), rotation=35, ha="right", fontsize=8)
    axis.set_ylabel(label)


def clearances(page: Page, length: Length) -> None:
    """Give the pins 10 to 200 µm of play, in a tight chain and in a slack one."""
    columns = {
        key: FORCES[key] for key in ("tight", "tight_std", "joint_p99", "depth_p99", "contact_p99")
    } | {
        "joint_open": ("pins out of touch [%]", 1e-2),
        "knocks": ("knocks a joint [1/s]", 1.0),
        "held ring": ("seated rollers held, ring [%]", 1e-2),
        "ripple": ("rear speed, std [%]", 1e-2),
    }
    figure, axes = plt.subplots(1, 3, figsize=(13, 4.2), layout="constrained")
    panels = [
        ("joint_p99", "pin in bush, 99 % [N]", 1.0),
        ("joint_open", "pins out of touch [%]", 1e-2),
        ("tight_std", "tight span, std [N]", 1.0),
    ]
    kinds = {
        "tight": tight(),
        "slack": slack(),
        "tight, default": cd.scenes.bicycle(),
        "slack, default": cd.scenes.bicycle_slack(),
    }
    for title, base in kinds.items():
        drives = {
            f"{play} µm": base.replace({"chain.joint": {"clearance": 1e-6 * play}})
            for play in CLEARANCES
        }
        cases = study(drives, partial(measure, length=length))
        page.add(f"clearance, {title}", table(cases, columns, f"play, {title}"))
        order = np.argsort(CLEARANCES)
        for axis, (key, label, unit) in zip(axes, panels, strict=True):
            rows = np.array([case[key] for case in cases.values()])[order] / unit
            line = ":" if "default" in title else "-"
            spread = np.ptp(rows, axis=1) / 2
            plays = np.array(CLEARANCES)[order]
            axis.errorbar(plays, rows.mean(1), spread, capsize=3, linestyle=line, label=title)
            axis.set(xlabel="radial clearance [µm]", ylabel=label, xscale="log")
            axis.set_xticks(plays, [str(play) for play in plays])
            axis.minorticks_off()
    axes[0].legend(fontsize="small")
    page.save(figure, "clearance")


def tension(page: Page, length: Length) -> None:
    """Hold a tight chain against a slack one."""
    drives = {
        "tight, 60 N": tight(),
        "tight, 200 N": tight().replace({"route.pretension": "200 N"}),
        "tight, 0 N": tight().replace({"route.pretension": 0.0}),
        "slack, 1 mm nearer": slack(),
    }
    page.add("tight and slack", table(study(drives, partial(measure, length=length)), MESHING))
    default = {"tight, 60 N": cd.scenes.bicycle(), "slack, 1 mm nearer": cd.scenes.bicycle_slack()}
    cases = study(default, partial(measure, length=length))
    page.add("tight and slack, default", table(cases, MESHING))

    turning = {"sprockets.chainring.motion": {"kind": "constant", "speed": -100.0}}
    fast = {name: drive.replace(turning) for name, drive in default.items()}
    short = Length(0.5 * length.until, 0.5 * length.run_in)
    cases = study(fast, partial(measure, length=short))
    page.add("tight and slack, 100 rad/s", table(cases, MESHING, "default, 100 rad/s"))

    figure, axes = plt.subplots(2, 2, figsize=(12, 6), sharex="col", layout="constrained")
    shown = [
        ("tight, rigid links", tight()),
        ("tight, default", cd.scenes.bicycle()),
        ("slack, rigid links", slack()),
        ("slack, default", cd.scenes.bicycle_slack()),
    ]
    for axis, (name, drive) in zip(axes.flat, shown, strict=True):
        run = observe(drive, length)
        inside = seated(run, drive, "chainring")
        roller = int(inside.sum(axis=0).argmax())
        force = np.where(inside[:, roller], run["contact_force"].values[:, roller], np.nan)
        axis.plot(1e3 * run["time"], force, linewidth=0.6)
        axis.set_title(f"{name}: force of the chainring on one roller [N]", fontsize=10)
        axis.set_ylim(0.0, None)
    for axis in axes[-1]:
        axis.set_xlabel("time [ms]")
    page.save(figure, "tension")


def rollers(page: Page, length: Length) -> None:
    """Take rollers as bodies of their own, lump them with their bushes, or leave them out."""
    free = {"chain.rollers": "free", "chain.roller": {"clearance": "0.05 mm"}}
    kinds: dict[str, dict[str, Any]] = {
        "rollers lumped": {},
        "free rollers, 50 µm": free,
        "bush chain": {"chain.rollers": "none"},
        "perfect hinges": {"chain.model": "ideal-joints"},
        "particles": {"chain.model": "particles"},
    }
    columns = FORCES | {"step_time": ("cost [ns a link and step]", 1.0)}
    for title, base in (("rollers", tight()), ("rollers, default", cd.scenes.bicycle())):
        drives = {name: base.replace(change) for name, change in kinds.items()}
        cases = study(drives, partial(measure, length=length))
        page.add(title, table(cases, columns, "chain"))
    drives = {name: slack().replace(kinds[name]) for name in list(kinds)[:3]}
    cases = study(drives, partial(measure, length=length))
    page.add("rollers, slack", table(cases, MESHING, "slack chain"))


STEPS = [8e-6, 4e-6, 2e-6, 1e-6, 5e-7, 2e-7]  # s
# Where contacts may begin, by the step [s]: a depth [m], or None for no limit.
ANYWHERE, SPEED, DEPTH = "anywhere", "as deep as 1 m/s takes it", "at most 0.1 µm deep"
LIMITS: Mapping[str, Callable[[float], float | None]] = {
    ANYWHERE: lambda _: None,
    SPEED: lambda step: 1.0 * step,
    DEPTH: lambda _: 1e-7,
}
LOST = 0.1  # of the energy moved: more than that unaccounted for, and a run is distrusted


def steps(page: Page, length: Length) -> None:
    """Control the step where contacts begin: one pin that falls, and a chain of impacts."""
    figure, axes = plt.subplots(1, 2, figsize=(12, 4.6), layout="constrained")
    methods = [
        ("implicit-damping", ANYWHERE),
        ("implicit-damping", SPEED),
        ("implicit-damping", DEPTH),
        ("rk4", ANYWHERE),
        ("rk4", DEPTH),
    ]
    # A thousandfold weight makes impacts of 2 m/s. A replicate falls a little deeper, and so begins
    # its contact at another place within a step.
    pins = [
        cd.scenes.pin_in_bush().replace(
            {"gravity": [0.0, -9810.0], "chain.joint": {"clearance": play}}
        )
        for play in 1e-4 * np.linspace(0.98, 1.02, 5)
    ]
    exact = [rebound(pin, "rk4", 2e-8, 1e-9) for pin in pins]
    lines = [
        "| error of the rebound [%], root mean square of five | "
        + " | ".join(f"{1e6 * h:g} µs" for h in STEPS)
        + " |",
        "|---|" + "---|" * len(STEPS),
    ]
    for method, limit in methods:
        errors = []
        for step in STEPS:
            found = [rebound(pin, method, step, LIMITS[limit](step)) for pin in pins]
            errors.append(100.0 * float(np.sqrt(np.mean((np.divide(found, exact) - 1.0) ** 2))))
        name = f"{method}, contacts begin {limit}"
        lines.append(f"| {name} | " + " | ".join(f"{error:.2g}" for error in errors) + " |")
        axes[0].loglog(1e6 * np.array(STEPS), errors, "o-", label=name)
    page.add("a pin that falls", "\n".join(lines))
    axes[0].set(
        xlabel="step [µs]",
        ylabel="error of the rebound [%]",
        title="a pin strikes its bush at 2 m/s",
    )
    axes[0].legend(fontsize="small")

    fast = slack().replace({"sprockets.chainring.motion": {"kind": "constant", "speed": -100.0}})
    short = Length(0.25 * length.until, 0.25 * length.run_in)
    columns = {
        "residual": ("energy unaccounted for [% of what moved]", 1e-2),
        "tight": ("tight span, mean [N]", 1.0),
        "tight_std": ("tight span, std [N]", 1.0),
        "joint_p99": ("pin in bush, 99 % [N]", 1.0),
        "contact_p99": ("roller on tooth, 99 % [N]", 1.0),
        "evaluations": ("evaluations [1000]", 1e3),
    }
    cases: dict[str, Case] = {}
    worst: dict[tuple[float, str], np.ndarray] = {}
    for step, limit in [
        (5e-7, DEPTH),
        (5e-7, ANYWHERE),
        (1e-6, ANYWHERE),
        (2e-6, ANYWHERE),
        (2e-6, SPEED),
        (2e-6, DEPTH),
        (1e-6, DEPTH),
    ]:
        depth = LIMITS[limit](step)
        one = partial(if_it_ends, columns=columns, length=short, step=step, onset_depth=depth)
        ((name, case),) = study({f"{1e6 * step:g} µs, {limit}": fast}, one).items()
        worst[step, limit] = case["residual"]
        lost = int((case["residual"] > LOST).sum())
        if lost:
            # What such a run bears and holds says nothing.
            name += f": energy lost sight of in {lost} of {len(case['residual'])}"
            case |= {k: np.full_like(v, np.nan) for k, v in case.items() if k != "evaluations"}
        cases[name] = case
    page.add("a chain of impacts", table(cases, columns, "slack chain at 100 rad/s"))
    for limit in (ANYWHERE, DEPTH):
        sizes = sorted(step for step, at in worst if at == limit)
        for five in np.transpose([worst[step, limit] for step in sizes]):
            colour = "C3" if limit == ANYWHERE else "C2"
            axes[1].plot(1e6 * np.array(sizes), 100.0 * five, "o-", color=colour, linewidth=0.8)
        axes[1].plot([], [], "o-", color=colour, label=limit)
    axes[1].set(
        xscale="log",
        yscale="log",
        xlabel="step [µs]",
        ylabel="energy unaccounted for [%]",
        title="slack chain at 100 rad/s, rigid links: five replicates",
    )
    for axis, shown in ((axes[0], STEPS), (axes[1], sizes)):
        axis.set_xticks(1e6 * np.array(shown), [f"{1e6 * step:g}" for step in shown])
        axis.minorticks_off()
    axes[1].legend(fontsize="small")
    page.save(figure, "steps")


def if_it_ends(drive: cd.Drive, columns: Iterable[str], **options: Any) -> dict[str, float]:
    """Measure a run that need not end: where it ceases to be finite all energy is lost sight of."""
    try:
        return measure(drive, **options)
    except cd.IntegrationError:
        return dict.fromkeys(columns, np.nan) | {"residual": np.inf}


def rebound(drive: cd.Drive, method: str, step: float, depth: float | None) -> float:
    """Return closing speed of the second impact over that of the first."""
    run = cd.simulate(
        drive,
        until=1e-3,
        every=1e-4,
        method=method,
        step=step,
        onset_depth=depth,
        error=False,
    )
    speeds = run["event_onset_speed"].values
    # The pin begins at the top of its play, and may touch the bush there.
    first, second = speeds[speeds > 0.1][:2]
    return float(second / first)


def wear(page: Page, length: Length) -> None:
    """Wear the chain to the 1.5 % at which one on fixed centres is worn out.

    The states are particles, which bear the same tensions for a quarter of the price; joints with
    play wear beside them.
    """
    new = cd.scenes.bicycle().replace({"chain.model": "particles"})
    takes_up = {"kind": "sprocket", "name": "rear", "direction": [-1, 0], "within": "30 mm"}
    states = {0.0: new} | {it: cd.worn(new, it, take_up=takes_up) for it in (0.0075, 0.015)}
    # Two circuits of the chain, and some more; a sixth of one for the joints with play.
    longer = Length(40.0 * length.until, 2.5 * length.run_in)
    short = Length(3.0 * length.until, 1.5 * length.run_in)
    play = {"new, pins with play": (cd.scenes.bicycle(), short, ["joint_angle", "joint_force"])}
    life(page, "life", Life("`bicycle`", states, longer, 1e-3, ("N", 1.0), play))


PARTS: Mapping[str, Callable[[Page, Length], None]] = {
    "laws": laws,
    "clearances": clearances,
    "tension": tension,
    "rollers": rollers,
    "steps": steps,
    "spans": spans,
    "law": law,
    "one drive": whole_drive,
    "life": wear,
}


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description="Reproduce the bicycle paper.")
    parser.add_argument("--until", type=float, default=0.08, help="length of a run [s]")
    parser.add_argument("--run-in", type=float, default=0.04, help="what goes before it [s]")
    parser.add_argument("--results", type=Path, default=Path("results"), help="folder to write to")
    parser.add_argument("--parts", nargs="+", default=list(PARTS), choices=list(PARTS))
    given = parser.parse_args(arguments)
    # Rigid links lose too little for their ledger, and some runs are meant to fail: see the page.
    warnings.simplefilter("ignore", cd.VerdictWarning)
    page = Page(given.results, "bicycle-paper")
    for name in given.parts:
        PARTS[name](page, Length(given.until, given.run_in))


if __name__ == "__main__":
    main()
