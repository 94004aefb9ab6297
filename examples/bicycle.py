"""The bicycle drive with play in its joints: tables and figures of docs/clearance-joints.md.

Run it as ``python examples/bicycle.py [--results FOLDER] [--until SECONDS]``. With the default of
0.25 s it takes some fifteen seconds on one core; shorter runs only show that everything works. It
prints the tables as Markdown and draws bicycle.png and bicycle_methods.png.
"""

import argparse
import time
from pathlib import Path

import matplotlib as mpl

mpl.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import NullFormatter

import chaindrive as cd

SPEEDS = {"90 r/min": -9.42, "100 rad/s": -100.0}
TRANSIENT = 0.2  # share of a run that is left out of the statistics


def run(drive, until, every=1e-4, **options):
    return cd.simulate(
        drive,
        until=until,
        run_in=0,
        every=every,
        progress=False,
        error=False,
        **({"method": "auto"} | options),
    )


def meshing(result, sprocket, until):
    """Count impacts per seating, and the share of time in contact, on one sprocket.

    A seating is a row of contacts of one roller with one sprocket with pauses shorter than a
    quarter of a revolution of the rear wheel.
    """
    begin = TRANSIENT * until
    names = result.event_body.values
    kinds = result.event_kind.values
    events = {}
    for i in range(result.sizes["event"]):
        if str(kinds[i]) != "tooth" or str(names[i]) != sprocket:
            continue
        start = float(result.event_start[i])
        end = min(float(result.event_end[i]), until)
        events.setdefault(int(result.event_roller[i]), []).append((start, end))
    impacts, touching, seated, seatings = 0, 0.0, 0.0, 0
    speeds = result.event_onset_speed.values
    for contacts in events.values():
        contacts.sort()
        rows, row = [], [contacts[0]]
        pause = max(0.1 * until, 1e-3)
        for contact in contacts[1:]:
            if contact[0] - row[-1][1] > pause:
                rows.append(row)
                row = []
            row.append(contact)
        rows.append(row)
        for row in rows:
            # Only whole seatings within the window: begun after the transient.
            if row[0][0] < begin:
                continue
            impacts += len(row)
            touching += sum(end - start for start, end in row)
            seated += row[-1][1] - row[0][0]
            seatings += 1
    share = touching / seated if seated > 0 else float("nan")
    return impacts / max(seatings, 1), share, seatings, float(np.median(speeds))


def ripple(result, until):
    """Compute the standard deviation of the driven speed over its mean."""
    window = result.sel(time=slice(TRANSIENT * until, None))
    speed = window.sprocket_speed.sel(sprocket="rear").values
    return float(np.std(speed) / abs(np.mean(speed)))


def tight_and_slack(until, folder):
    print(
        "| chain | chainring | impacts a seating: ring, rear | share of time in contact | "
        "tight span [N], mean ± std | driven speed, std |"
    )
    print("|---|---|---|---|---|---|")
    _, axes = plt.subplots(2, 2, figsize=(11, 6), sharex="col")
    for row, preset in enumerate(["bicycle", "bicycle_slack"]):
        for column, (label, speed) in enumerate(SPEEDS.items()):
            length = until if column == 0 else 0.2 * until
            drive = getattr(cd.scenes, preset)().replace(
                {"sprockets.chainring.motion": {"kind": "constant", "speed": speed}}
            )
            result = run(drive, length)
            ring = meshing(result, "chainring", length)
            rear = meshing(result, "rear", length)
            tight = result.span_tension.isel(span=0).sel(time=slice(TRANSIENT * length, None))
            print(
                f"| {preset} | {label} | {ring[0]:.1f}, {rear[0]:.1f} | {100 * ring[1]:.1f} %, "
                f"{100 * rear[1]:.1f} % | {float(tight.mean()):.0f} ± {float(tight.std()):.0f} | "
                f"{100 * ripple(result, length):.2f} % |",
                flush=True,
            )
            axis = axes[row, column]
            forces = result.contact_force.sel(time=slice(0.5 * length, None))
            # The roller that works hardest in the second half of the run.
            busiest = int(np.argmax(forces.mean("time").values))
            axis.plot(1e3 * forces.time, forces.isel(roller=busiest), lw=0.7)
            axis.set_title(f"{preset}, {label}: contact force of one roller [N]", fontsize=9)
            axis.set_xlabel("time [ms]")
    plt.tight_layout()
    plt.savefig(folder / "bicycle.png", dpi=90)


def tension_error(result, reference):
    difference = result.span_tension.isel(span=0) - reference.span_tension.isel(span=0)
    rms = float(np.sqrt((difference[1:] ** 2).mean()))
    return rms / float(reference.span_tension.isel(span=0).mean())


def methods(until, folder):
    """Error in the tight span against wall time."""
    drive = cd.scenes.bicycle()
    window = min(4e-3, until)
    every = window / 40
    reference = run(drive, window, every, method="rk4", step=5e-8)
    check = run(drive, window, every, method="verlet", step=2e-8)
    print(
        f"\nreference: RK4 at 0.05 µs; Verlet at 0.02 µs agrees to "
        f"{100 * tension_error(check, reference):.1e} %\n"
    )
    plans = [
        ("implicit-damping", [8e-6, 4e-6, 2e-6, 1e-6, 5e-7, 2.5e-7], None),
        ("generalized-alpha", [4e-6, 2e-6, 1e-6, 5e-7], None),
        ("verlet", [1e-7, 5e-8], None),
        ("verlet", [1e-7], 1e-9),
        ("rk4", [4e-7, 2e-7, 1e-7], None),
        ("rk4", [4e-7, 2e-7], 1e-9),
    ]
    print("| method | step [µs] | rejection | error of the tight span [%] | wall [s] | real time |")
    print("|---|---|---|---|---|---|")
    _, axis = plt.subplots(figsize=(7, 5))
    for method, steps, depth in plans:
        points = []
        for step in steps:
            begin = time.perf_counter()
            try:
                result = run(drive, window, every, method=method, step=step, onset_depth=depth)
            except cd.ChaindriveError as error:
                print(f"| {method} | {1e6 * step:g} | | refused: {error} | | |")
                continue
            wall = time.perf_counter() - begin
            error = tension_error(result, reference)
            points.append((wall, 100 * error))
            print(
                f"| {method} | {1e6 * step:g} | {'1 nm' if depth else 'none'} | "
                f"{100 * error:.2g} | {wall:.3f} | {window / wall:.3f} |",
                flush=True,
            )
        if points:
            label = method + (", first penetration ≤ 1 nm" if depth else "")
            axis.loglog(*zip(*points, strict=True), "o-", label=label)
    axis.set_xticks([0.03, 0.1, 0.3, 1.0], ["0.03", "0.1", "0.3", "1"])
    axis.xaxis.set_minor_formatter(NullFormatter())
    axis.set_xlabel("wall time of 4 ms [s]")
    axis.set_ylabel("error of the tight span's tension [%]")
    axis.legend(fontsize=8)
    plt.tight_layout()
    plt.savefig(folder / "bicycle_methods.png", dpi=90)


def models(until):
    """Run the same drive with each model of the chain."""
    window = min(2e-2, until)
    print("\n| chain | degrees of freedom | span tensions at rest [N] | step [µs] | real time |")
    print("|---|---|---|---|---|")
    variants = {
        "particles": {"chain.model": "particles"},
        "ideal joints": {"chain.model": "ideal-joints"},
        "clearance joints": {},
        "clearance joints, free rollers": {
            "chain.rollers": "free",
            "chain.roller": {"clearance": "0.05 mm"},
        },
        "clearance joints, bush chain": {"chain.rollers": "none"},
    }
    for name, change in variants.items():
        drive = cd.scenes.bicycle().replace(change)
        begin = time.perf_counter()
        result = run(drive, window)
        wall = time.perf_counter() - begin
        rest = result.span_tension.isel(time=0).values
        freedom = {"particles": 209, "clearance joints, free rollers": 625}.get(name, 313)
        step = float(result.attrs.get("step", np.nan))
        print(
            f"| {name} | {freedom} | {rest[0]:.1f}, {rest[1]:.1f} | {1e6 * step:.2f} | "
            f"{window / wall:.3f} |",
            flush=True,
        )


def strand(until):
    """Hang a strand: it comes to rest in the same place to the order of the clearance."""
    del until
    print("\n| model | middle joint, y [mm] | from the particles [mm] |")
    print("|---|---|---|")
    base = {
        "settle": True,
        "chain": {
            "type": "081",
            "links": 40,
            "ends": ["fixed", "fixed"],
            "start": {"kind": "hang", "from": [0.0, 0.0], "to": [0.45, 0.0]},
        },
        "contact": {"joints": {"law": "cylindrical"}},
        "run": {"until": 1e-4, "every": 1e-4},
    }
    places = {}
    for name, change in {
        "particles": {"model": "particles"},
        "ideal joints": {"model": "ideal-joints"},
        "clearance joints": {"model": "clearance-joints"},
        "bush chain": {"model": "clearance-joints", "rollers": "none"},
        "free rollers": {
            "model": "clearance-joints",
            "rollers": "free",
            "roller": {"clearance": "0.05 mm"},
        },
    }.items():
        scene = {**base, "chain": {**base["chain"], **change}}
        try:
            result = run(cd.Drive.from_dict(scene), 1e-4)
        except cd.ChaindriveError as error:
            print(f"| {name} | {error} | |")
            continue
        places[name] = 1e3 * float(result.roller_y.isel(time=0, roller=20))
        print(f"| {name} | {places[name]:.4f} | {places[name] - places['particles']:+.4f} |")


HARD = {
    "as it is": {},
    "clearance 5 µm": {"chain.joint": {"clearance": "5 µm"}},
    "clearance 0.5 mm": {"chain.joint": {"clearance": "0.5 mm"}},
    "e = 0.02, exact": {"contact.joints": {"restitution": 0.02, "dissipation": "exact"}},
    "e = 0, Lankarani–Nikravesh": {"contact.joints": {"restitution": 0.0}},
    "e = 1": {"contact.joints": {"restitution": 1.0}, "contact.teeth": {"restitution": 1.0}},
    "pretension 0": {"route.pretension": 0.0},
    "pretension 3 kN": {"route.pretension": "3 kN"},
    "onset floor 1e-5 m/s": {"contact.joints": {"restitution": 0.7, "onset_floor": 1e-5}},
    "onset floor 1e-3 m/s": {"contact.joints": {"restitution": 0.7, "onset_floor": 1e-3}},
    "ten times the modulus": {
        "contact.joints": {"law": {"kind": "cylindrical", "modulus": 2.07e12}},
        "contact.teeth": {
            "law": {
                "kind": "johnson",
                "modulus": 2.07e12,
                "length": "3.3 mm",
                "clearance": "0.1 mm",
            }
        },
    },
    "gravity off": {"gravity": [0, 0]},
    "friction 0.3": {
        "contact.joints": {"restitution": 0.7, "friction": {"coefficient": 0.3}},
        "contact.teeth": {"restitution": 0.8, "friction": {"coefficient": 0.3}},
    },
    "pins start in the middle": {"settle": False},
}


def hard_cases(until):
    window = min(1e-2, until)
    print(
        "\n| case | tight span, mean ± std [N] | energy unaccounted for, of what was moved | "
        "steps, shortest [µs] | outcome |"
    )
    print("|---|---|---|---|---|")
    for name, change in HARD.items():
        try:
            result = run(cd.scenes.bicycle().replace(change), window)
        except cd.ChaindriveError as error:
            print(f"| {name} | | | | refused: {str(error).splitlines()[-1]} |", flush=True)
            continue
        tight = result.span_tension.isel(span=0)
        kinetic = float(result.energy_kinetic.max())
        moved = abs(float(result.energy_supplied[-1])) + float(result.energy_dissipated[-1])
        residual = float(result.energy_residual[-1]) / max(moved, 1e-3 * kinetic)
        least = 1e6 * float(result.attrs.get("smallest_step", np.nan))
        verdict = "finishes" if abs(residual) < 0.05 else "finishes; the ledger does not close"
        print(
            f"| {name} | {float(tight.mean()):.0f} ± {float(tight.std()):.0f} | {residual:.1e} | "
            f"{least:.2f} | {verdict} |",
            flush=True,
        )


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--until", type=float, default=0.25, help="length of the long runs [s]")
    parser.add_argument("--results", type=Path, default=Path("results"))
    parser.add_argument(
        "--parts",
        default="meshing,methods,models,strand,hard",
        help="what to do: meshing, methods, models, strand, hard",
    )
    arguments = parser.parse_args()
    arguments.results.mkdir(parents=True, exist_ok=True)
    parts = arguments.parts.split(",")
    quick = arguments.until < 0.05
    if "meshing" in parts:
        tight_and_slack(arguments.until, arguments.results)
    if "methods" in parts and not quick:
        methods(arguments.until, arguments.results)
    if "models" in parts:
        models(arguments.until)
    if "strand" in parts:
        strand(arguments.until)
    if "hard" in parts and not quick:
        hard_cases(arguments.until)


if __name__ == "__main__":
    main()
