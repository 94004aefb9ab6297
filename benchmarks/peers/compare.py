"""Speed against error of chaindrive and of what else could simulate the marine drive.

    python benchmarks/peers/compare.py            # some fifteen minutes
    python benchmarks/peers/compare.py --quick    # half a minute: does everything still run?

Prints a table, and writes results.json and the results in README.md, which says what is compared
and how.
"""

import argparse
import importlib.util
import json
import os
import re
import statistics
import sys
import warnings
from pathlib import Path
from typing import NamedTuple

# One thread each, before anything that could open more is imported.
for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

from measure import error, load, tight_tension  # noqa: E402
from provenance import dated, machine, told  # noqa: E402

FOLDER = Path(__file__).parent
RESULTS = FOLDER / "results.json"
ALLOWED = 0.02  # error at which programs are compared [–]
BEGIN, END = "<!-- written by compare.py -->", "<!-- until here -->"
DATED = re.compile(r"^Measured with chaindrive .*$", re.MULTILINE)
SEVENTH = 1e-4 / 7  # a step between 20 and 10 µs that divides the sampling interval [s]
TRANSIENT = 0.01  # left out of the mean [s]


class Plan(NamedTuple):
    """What one program is asked to do."""

    program: str
    reference: tuple
    check: tuple
    settings: list
    timing: float
    """Simulated time of a timed run [s]."""
    coarse: float
    """Sampling interval of a timed run [s]."""


PLANS = [
    Plan(
        "chaindrive",
        ("rk4", 1e-6, 1e-7),
        ("verlet", 1e-7, None),
        [
            ("verlet", 2.5e-5, None),
            ("verlet", 2e-5, None),
            ("verlet", SEVENTH, None),
            ("verlet", 1e-5, None),
            ("verlet", 5e-6, None),
            ("verlet", 2e-6, None),
            ("rk4", 2e-5, None),
            ("rk4", 2e-5, 1e-6),
            ("rk4", 1e-5, 1e-6),
        ],
        1.0,
        1e-3,
    ),
    Plan(
        "numba",
        ("rk4", 2e-7),
        ("verlet", 1e-7),
        [
            ("verlet", 2.5e-5),
            ("verlet", 2e-5),
            ("verlet", SEVENTH),
            ("verlet", 1e-5),
            ("verlet", 5e-6),
            ("verlet", 2e-6),
            ("rk4", 2e-5),
            ("rk4", 1e-5),
        ],
        1.0,
        1e-3,
    ),
    Plan(
        "scipy",
        ("DOP853", 1e-10),
        ("RK45", 1e-10),
        [("RK45", 1e-3), ("RK45", 1e-4), ("RK45", 1e-5), ("DOP853", 1e-4), ("DOP853", 1e-5)],
        0.1,
        1e-3,
    ),
    Plan(
        "exudyn",
        ("verlet", 5e-7),
        ("rk4", 2e-6),
        [("verlet", 2e-5), ("verlet", 1e-5), ("verlet", 5e-6), ("verlet", 2e-6), ("rk4", 1e-5)],
        0.005,
        1e-3,
    ),
]
NEEDS = {"chaindrive": "chaindrive", "numba": "numba", "scipy": "scipy", "exudyn": "exudyn"}


def runner(program, drive):
    """Return run(setting, until, every) of a program."""
    if program == "chaindrive":
        import with_chaindrive

        return lambda setting, until, every: with_chaindrive.run(
            setting[0], setting[1], until, every, setting[2]
        )
    module = __import__(f"with_{program}")
    return lambda setting, until, every: module.run(drive, *setting, until, every=every)


def missing(program):
    """Names of the packages that a program lacks."""
    needed = {NEEDS[program], "numba"} if program == "scipy" else {NEEDS[program]}
    return sorted(name for name in needed if importlib.util.find_spec(name) is None)


def accuracy(drive, plan, run, window, quick):
    """Return rows with the errors of a program, and what they are relative to."""
    every = 1e-4
    reference_setting = plan.settings[-1] if quick else plan.reference
    reference = run(reference_setting, window, every)
    twin = None if quick else error(drive, run(plan.check, window, every), reference)
    rows = []
    for setting in plan.settings:
        row = {"program": plan.program, "setting": list(setting)}
        rows.append(row)
        try:
            result = run(setting, window, every)
        except Exception as failure:
            row["failed"] = str(failure).splitlines()[-1]
            print(f"{plan.program} {setting}: {row['failed']}", file=sys.stderr)
            continue
        row["error"] = error(drive, result, reference)
        tight = tight_tension(drive, result.tension)[round(TRANSIENT / every) :]
        row["mean"], row["deviation"] = float(tight.mean()), float(tight.std())
    tight = tight_tension(drive, reference.tension)[round(TRANSIENT / every) :]
    about = {
        "setting": list(reference_setting),
        "twin": None if quick else list(plan.check),
        "twin_error": twin,
        "mean": float(tight.mean()),
        "deviation": float(tight.std()),
    }
    return rows, about


def finer_teeth(drive, window):
    """Return the mean tension in Exudyn with three times as many chords, nearer to the arcs."""
    import with_exudyn

    setting = ("verlet", 5e-6)
    result = with_exudyn.run(drive, *setting, window, refine=4)
    tight = tight_tension(drive, result.tension)[round(TRANSIENT / 1e-4) :]
    mean, deviation = float(tight.mean()), float(tight.std())
    return {"setting": list(setting), "twin": None, "mean": mean, "deviation": deviation}


def timings(drive, plans, rows, runs, repeats, shorten):
    """Add the median CPU time of every setting; the programs take turns within each repetition."""
    times = {}
    for _ in range(repeats):
        for plan in plans:
            for index, row in enumerate(rows[plan.program]):
                if "failed" in row:
                    continue
                result = runs[plan.program](
                    plan.settings[index], plan.timing * shorten, plan.coarse * shorten
                )
                times.setdefault((plan.program, index), []).append(result)
    for (program, index), results in times.items():
        row = rows[program][index]
        per_second = [result.cpu / result.length for result in results]
        row["cpu_per_second"] = statistics.median(per_second)
        row["cpu_range"] = [min(per_second), max(per_second)]
        row["ns_per_link_step"] = 1e9 * statistics.median(
            result.cpu / result.steps / drive["chain"]["links"] for result in results
        )
        row["repeats"] = len(results)


def best(rows):
    """Return the cheapest row within the allowed error, else the most exact one."""
    rows = [row for row in rows if "cpu_per_second" in row]
    within = [row for row in rows if row["error"] <= ALLOWED]
    if within:
        return min(within, key=lambda row: row["cpu_per_second"])
    return min(rows, key=lambda row: row["error"])


def at_no_larger_error(row, ours):
    """Return the CPU time of a row over that of the cheapest of our rows that is as exact."""
    as_exact = [
        mine["cpu_per_second"]
        for mine in ours
        if "cpu_per_second" in mine and mine["error"] <= row["error"] * (1 + 1e-6)
    ]
    return row["cpu_per_second"] / min(as_exact) if as_exact else None


def ratios(rows):
    """Return the CPU time of every program over that of chaindrive."""
    ours = best(rows["chaindrive"])
    found = {}
    for program, theirs in rows.items():
        if program == "chaindrive" or not any("cpu_per_second" in row for row in theirs):
            continue
        other = best(theirs)
        found[program] = {
            "ratio": other["cpu_per_second"] / ours["cpu_per_second"],
            "chaindrive": ours["setting"],
            "theirs": other["setting"],
            "error": [ours["error"], other["error"]],
            "within": other["error"] <= ALLOWED,
        }
        twins = [
            (mine, row)
            for mine in rows["chaindrive"]
            for row in theirs
            if row["setting"][:2] == mine["setting"][:2]
            and len(mine["setting"]) == 3
            and mine["setting"][2] is None
            and "cpu_per_second" in row
            and "cpu_per_second" in mine
        ]
        found[program]["per_link_step"] = {
            f"{mine['setting'][0]} {mine['setting'][1]:g} s": row["ns_per_link_step"]
            / mine["ns_per_link_step"]
            for mine, row in twins
        }
    return found


def name(setting):
    """Put a setting in words."""
    text = f"{setting[0]} {setting[1]:g}"
    return text + f", onset ≤ {setting[2]:g} m" if len(setting) > 2 and setting[2] else text


def table(results):
    """Write the results as Markdown."""
    lines = [
        "| program | method, step [s] or tolerance | error of the tight span | "
        "CPU s per simulated s | ns per link and step | mean ± std [N] | "
        "times chaindrive, as exact |",
        "|---|---|---|---|---|---|---|",
    ]
    for program, rows in results["rows"].items():
        for row in rows:
            if "cpu_per_second" not in row:
                lines.append(f"| {program} | {name(row['setting'])} | {row['failed']} | | | | |")
                continue
            lines.append(
                f"| {program} | {name(row['setting'])} | {100 * row['error']:.2g} % | "
                f"{row['cpu_per_second']:.3g} | {row['ns_per_link_step']:.3g} | "
                f"{row['mean']:.0f} ± {row['deviation']:.0f} | "
                + (f"{row['times_chaindrive']:.3g} |" if row.get("times_chaindrive") else "|")
            )
    for program, about in results["references"].items():
        twin = (
            f"{100 * about['twin_error']:.2g} % from {name(about['twin'])}" if about["twin"] else ""
        )
        lines.append(
            f"| {program}, reference | {name(about['setting'])} | {twin} | | | "
            f"{about['mean']:.0f} ± {about['deviation']:.0f} | |"
        )
    lines.append("")
    for program, ratio in results["ratios"].items():
        ours, theirs = ratio["error"]
        remark = "" if ratio["within"] else ", its most exact run, above the allowed error"
        lines.append(
            f"- {program} takes {ratio['ratio']:.3g} times the CPU time of chaindrive "
            f"({name(ratio['theirs'])} at {100 * theirs:.2g} %{remark}, "
            f"against {name(ratio['chaindrive'])} at {100 * ours:.2g} %)"
        )
        for setting, value in ratio["per_link_step"].items():
            lines.append(f"    - per link and step, both {setting}: {value:.3g}")
    return "\n".join(lines)


def account(results):
    """Write machine and table as the README shows them."""
    return f"{told(results['machine'])}.\n\n{table(results)}\n"


def write_account(results):
    """Put the results between the marks of the README, and their date into its first line."""
    file = FOLDER / "README.md"
    before, rest = file.read_text(encoding="utf-8").split(BEGIN)
    before = DATED.sub(dated(results["machine"]), before, count=1)
    after = rest.split(END)[1]
    file.write_text(f"{before}{BEGIN}\n{account(results)}{END}{after}", encoding="utf-8")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="run everything once, briefly")
    parser.add_argument("--repeats", type=int, default=5, help="timed runs of each setting")
    parser.add_argument("--window", type=float, default=0.03, help="length of the error runs [s]")
    parser.add_argument("--programs", default="chaindrive,numba,scipy,exudyn")
    arguments = parser.parse_args()
    drive = load()
    wanted = arguments.programs.split(",")
    plans = []
    for plan in PLANS:
        if plan.program in wanted and missing(plan.program):
            print(f"{plan.program}: not compared, needs {', '.join(missing(plan.program))}")
        elif plan.program in wanted:
            plans.append(plan)
    if arguments.quick:
        plans = [plan._replace(settings=plan.settings[1:3]) for plan in plans]
    window = 0.0112 if arguments.quick else arguments.window
    rows, references = {}, {}
    runs = {plan.program: runner(plan.program, drive) for plan in plans}
    for plan in plans:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DeprecationWarning)
            rows[plan.program], references[plan.program] = accuracy(
                drive, plan, runs[plan.program], window, arguments.quick
            )
        print(f"{plan.program}: errors found", file=sys.stderr, flush=True)
    if "exudyn" in runs and not arguments.quick:
        references["exudyn, 12 chords a tooth"] = finer_teeth(drive, window)
    repeats, shorten = (1, 0.2) if arguments.quick else (arguments.repeats, 1.0)
    timings(drive, plans, rows, runs, repeats, shorten)
    for program in rows.keys() - {"chaindrive"} if "chaindrive" in rows else ():
        for row in rows[program]:
            if "cpu_per_second" in row:
                row["times_chaindrive"] = at_no_larger_error(row, rows["chaindrive"])
    results = {
        "machine": machine(),
        "window": window,
        "allowed_error": ALLOWED,
        "references": references,
        "rows": rows,
        "ratios": ratios(rows) if "chaindrive" in rows else {},
    }
    print(table(results))
    if not arguments.quick:
        RESULTS.write_text(json.dumps(results, indent=1) + "\n", encoding="utf-8")
        write_account(results)


if __name__ == "__main__":
    main()
