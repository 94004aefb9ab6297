"""Write docs/how-fast-how-accurate.md: what this machine measures of speed and error.

Run it as ``make report``, or ``python benchmarks/report.py [--quick] [--docs FOLDER]``. It takes
some ten minutes on one core and should have the machine to itself. The table beside other programs
is the last one that ``benchmarks/peers/compare.py`` left in results.json: those want an environment
of their own.
"""

import argparse
import json
import os
import platform
import statistics
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path

import matplotlib as mpl

mpl.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
import xarray as xr

import chaindrive as cd

HERE = Path(__file__).resolve().parent


@dataclass
class Report:
    """The page as it grows, and the claims it has to answer."""

    quick: bool
    folder: Path
    lines: list[str] = field(default_factory=list)
    claims: list[tuple[str, str, str, bool]] = field(default_factory=list)

    def say(self, *lines: str) -> None:
        """Add lines to the page, and print them."""
        self.lines.extend(lines)
        print("\n".join(lines), flush=True)

    def table(self, head: list[str], rows: list[list[str]]) -> None:
        """Add a table."""
        self.say("", "| " + " | ".join(head) + " |", "|" + "---|" * len(head))
        self.say(*("| " + " | ".join(row) + " |" for row in rows), "")

    def claim(self, what: str, wanted: str, found: str, met: bool) -> None:
        """Answer one of the targets."""
        self.claims.append((what, wanted, found, met))

    @property
    def repeats(self) -> int:
        """How often times are taken."""
        return 1 if self.quick else 5


def cost(drive: cd.Drive, report: Report, until: float = 2.0, **options) -> tuple[float, float]:
    """Give the median and the least ns per link and step, sampling not counted."""
    until = until if not report.quick else 2e-3
    options = {"method": "auto", "error": False, "every": until, "record": "span_tension"} | options
    found = []
    # The first run finds the processor asleep.
    cd.simulate(drive, until=until, **options)
    for _ in range(report.repeats):
        found.append(cd.simulate(drive, until=until, **options).attrs["ns_per_link_step"])
    return statistics.median(found), min(found)


def kernels(report: Report) -> None:
    report.say(
        "## The inner loop",
        "",
        "Whole step with the default method: forces, contacts, energy ledger, step control. "
        "Nanoseconds per link and "
        f"step, median and least of {report.repeats}.",
    )
    marine = cd.scenes.marine_engine_bare()
    bare = marine.replace({"guides": []})
    drives = {
        "marine engine, four sprockets": bare,
        "marine engine, four sprockets, three guide bars": marine,
        "large chain on two sprockets": cd.scenes.marine_two_sprockets(),
        "16B on two sprockets": cd.scenes.industrial_16b(),
        "bicycle, clearance joints": cd.scenes.bicycle(),
    }
    rows, found = [], {}
    for name, drive in drives.items():
        found[name] = cost(drive, report, 0.1 if "bicycle" in name else 2.0)
        rows.append([name, f"{found[name][0]:.1f}", f"{found[name][1]:.1f}"])
    report.table(["drive", "ns", "least"], rows)
    median = found["marine engine, four sprockets"][0]
    report.claim("whole Verlet step, four sprockets", "≤ 7 ns", f"{median:.1f} ns", median <= 7.0)

    report.say(
        "What a feature costs where a scene has it, in ns per link and step of the marine drive "
        "without guides; a "
        "scene that has not pays nothing, since its list is empty or its law another kernel.",
    )
    base = found["marine engine, four sprockets"][0]
    features = {
        "three guide bars": (marine, {}),
        "Coulomb friction on the teeth": (
            bare.replace({"contact.teeth.friction": {"coefficient": 0.1}}),
            {},
        ),
        "LuGre friction on the teeth": (
            bare.replace(
                {
                    "contact.teeth.friction": {
                        "kind": "lugre",
                        "coefficient": 0.1,
                        "static_coefficient": 0.12,
                        "stiffness": 1e4,
                    }
                }
            ),
            {},
        ),
        "Johnson's law on the teeth": (
            bare.replace(
                {"contact.teeth.law": {"kind": "johnson", "length": "50 mm", "clearance": "0.3 mm"}}
            ),
            {},
        ),
        "onset depth of 1 µm": (bare, {"onset_depth": 1e-6}),
        "contacts logged": (bare, {"events": "teeth"}),
    }
    rows = []
    for name, (drive, options) in features.items():
        try:
            ns = cost(drive, report, **options)[0]
        except cd.ChaindriveError as error:
            rows.append([name, str(error), ""])
            continue
        rows.append([name, f"{ns:.1f}", f"{ns - base:+.1f}"])
    report.table(["with", "ns", "more than without"], rows)


def long_chain(links: int) -> cd.Drive:
    """Two sprockets of ten teeth as far apart as the chain reaches, without gravity."""
    pitch = 0.0254
    apart = 0.5 * (links - 10) * pitch
    sprocket = {"teeth": 10, "contact": {"restitution": 0.8}}
    return cd.Drive.from_dict(
        {
            "title": f"{links} links",
            "gravity": [0.0, 0.0],
            "chain": {
                "pitch": pitch,
                "links": links,
                "mass": 0.0688,
                "stiffness": 161e6,
                "roller_diameter": 0.01588,
            },
            "sprockets": [
                {"name": "a", "centre": [0.0, 0.0], "motion": {"kind": "constant", "speed": 10.0}}
                | sprocket,
                {"name": "b", "centre": [apart, 0.0], "inertia": 0.05} | sprocket,
            ],
            "route": {"pretension": "500 N"},
        }
    )


def lengths(report: Report) -> None:
    report.say(
        "## Length of the chain",
        "",
        "Two sprockets of ten teeth, ever farther apart.",
    )
    counts = [20, 50, 100, 200, 500, 1000, 2000, 5000]
    counts = counts[:2] if report.quick else counts
    costs = []
    for links in counts:
        costs.append(
            cost(long_chain(links), report, until=2.0 / links, step=4e-6, method="verlet")[0]
        )
    report.table(
        ["links", *map(str, counts)],
        [["ns per link and step", *(f"{ns:.1f}" for ns in costs)]],
    )
    _, axis = plt.subplots(figsize=(6, 3))
    axis.semilogx(counts, costs, "o-")
    axis.set_xlabel("links")
    axis.set_ylabel("ns per link and step")
    axis.set_ylim(0)
    plt.tight_layout()
    plt.savefig(report.folder / "cost_of_length.png", dpi=80)
    plt.close()
    report.say("![Cost per link and step over the length of the chain](cost_of_length.png)", "")
    falling = costs[-1] <= 1.1 * costs[0]
    report.claim(
        "cost per link, 20 to 5 000 links",
        "falling or flat",
        f"{costs[0]:.1f} to {costs[-1]:.1f} ns",
        falling,
    )


PROBE = """
import resource, sys
import chaindrive as cd
drive = cd.scenes.marine_two_sprockets()
until, output, record = float(sys.argv[1]), sys.argv[2], sys.argv[3].split(",")
options = {"output": output} if output else {}
options |= {"until": until, "every": 2e-4, "record": record, "method": "auto", "error": False}
run = cd.simulate(drive, **options)
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024, run.nbytes / 1e6)
"""


def memory(report: Report) -> None:
    report.say(
        "## Memory",
        "",
        "Largest memory of a process that simulates the two sprockets with a sample every 0.2 ms.",
    )
    rows = []
    spans = [0.05, 0.1] if report.quick else [10.0, 30.0]
    for name, record, stored in [
        ("tension of the spans, in memory", "span_tension", False),
        ("tension of all 112 links, in memory", "link_tension", False),
        ("tension of all 112 links, into a store", "link_tension", True),
    ]:
        found = []
        for until in spans:
            with tempfile.TemporaryDirectory() as folder:
                output = str(Path(folder) / "run.zarr") if stored else ""
                command = [sys.executable, "-c", PROBE, str(until), output, record]
                answer = subprocess.run(command, capture_output=True, text=True, check=True)
                found.append([float(word) for word in answer.stdout.split()])
        growth = (found[1][0] - found[0][0]) / (spans[1] - spans[0])
        recorded = (found[1][1] - found[0][1]) / (spans[1] - spans[0])
        rows.append(
            [name, f"{found[0][0]:.0f}", f"{found[1][0]:.0f}", f"{growth:.1f}", f"{recorded:.1f}"]
        )
    first, second = (f"{until:g} s [MB]" for until in spans)
    report.table(
        ["recorded", first, second, "more a simulated second [MB]", "recorded a second [MB]"], rows
    )


def precision(report: Report) -> None:
    report.say(
        "## Work and precision",
        "",
        "`chaindrive.work_precision`: errors against a reference that a second method confirms, "
        "root mean square over the "
        "mean; cheapest rows within an error. Real time: simulated over processor time, median "
        "of the repeats.",
    )
    marine = cd.scenes.marine_engine_bare()
    drives = {
        "large chain on two sprockets": cd.scenes.marine_two_sprockets(),
        "marine engine, four sprockets": marine.replace({"guides": []}),
        "marine engine, with guide bars": marine,
        "bicycle, clearance joints": cd.scenes.bicycle(),
    }
    if report.quick:
        drives = dict(list(drives.items())[:1])
    figure, axes = plt.subplots(1, len(drives), figsize=(4.5 * len(drives), 3.6), squeeze=False)
    rows = []
    for (name, drive), axis in zip(drives.items(), axes[0], strict=True):
        if report.quick:
            tables = [cd.work_precision(drive, methods="verlet", until=2e-3, repeats=1)]
        else:
            tables = [cd.work_precision(drive, repeats=report.repeats)]
        # Between the steps that the automatic choice tries.
        between = {
            "marine": (["verlet", "rk4"], [1.7e-5, 1.4e-5, 1.2e-5, 1e-5, 3e-6], 1e-5),
            "bicycle": (["implicit-damping"], [2.4e-6, 2.2e-6, 1.8e-6, 1.6e-6, 1.4e-6], 1e-7),
        }.get(name.split()[0].rstrip(","))
        if between and not report.quick:
            methods, steps, depth = between
            tables += [
                cd.work_precision(
                    drive,
                    methods=methods,
                    steps=steps,
                    onset_depth=limit,
                    repeats=report.repeats,
                )
                for limit in (None, depth)
            ]
        cd.plot.work_precision(tables[0], ax=axis)
        table = xr.concat(tables, "run", combine_attrs="override")
        axis.set_title(name, fontsize=9)
        window = float(table.attrs["window"])
        agreement = float(table.attrs.get("agreement_tight_tension", np.nan))
        for limit in (0.01, 0.001):
            best = cheapest(table, limit)
            if best is None:
                rows.append([name, f"{100 * limit:g} %", "none of the list", "", "", ""])
                continue
            factor = window / float(table["cpu"][best])
            rows.append(
                [
                    name,
                    f"{100 * limit:g} %",
                    described(table, best),
                    f"{100 * float(table['error_tight_span_tension'][best]):.2g} %",
                    f"{factor:.2f}",
                    f"{100 * agreement:.1g} %",
                ]
            )
            wanted = {
                ("marine engine, four sprockets", 0.01): 8.0,
                ("marine engine, four sprockets", 0.001): 3.0,
                ("bicycle, clearance joints", 0.001): 0.3,
            }
            if (name, limit) in wanted:
                least = wanted[name, limit]
                report.claim(
                    f"{name} within {100 * limit:g} % of the tight span",
                    f"≥ {least:g} × real time",
                    f"{factor:.2f} ×",
                    factor >= least,
                )
    report.table(
        ["drive", "within", "method", "error of the tight span", "× real time", "references apart"],
        rows,
    )
    plt.tight_layout()
    plt.savefig(report.folder / "work_precision.png", dpi=70)
    plt.close(figure)
    report.say("![Error against time of the methods](work_precision.png)", "")
    if not report.quick:
        neighbours(report, cd.scenes.bicycle())


def neighbours(report: Report, drive: cd.Drive) -> None:
    """Tell how far errors of neighbouring steps lie apart where one bouncing roller decides."""
    steps = np.linspace(1.6e-6, 2.4e-6, 9)
    found = []
    for depth in (None, 1e-7):
        table = cd.work_precision(
            drive, methods="implicit-damping", steps=steps, onset_depth=depth, repeats=1
        )
        errors = 100 * table["error_tight_span_tension"].values
        found.append(
            f"{errors.min():.2g} to {errors.max():.2g} %, median {np.median(errors):.2g} %"
        )
    report.say(
        "The bicycle's error is to a degree a matter of luck: one roller bounces as it seats, and "
        "when within a step it touches decides how it comes back. Errors of the tight span with "
        f"nine steps from 1.6 to 2.4 µs: {found[0]}; where no contact may begin deeper than "
        f"0.1 µm: {found[1]}.",
        "",
    )


def cheapest(table, limit: float) -> int | None:
    """Tell the row that takes the least processor time within an error."""
    errors = table["error_tight_span_tension"].values
    good = np.flatnonzero(np.isfinite(errors) & (errors <= limit))
    return int(good[np.argmin(table["cpu"].values[good])]) if good.size else None


def described(table, row: int) -> str:
    text = str(table["method"].values[row])
    step, depth = float(table["step"][row]), float(table["onset_depth"][row])
    if np.isfinite(step):
        text += f", {1e6 * step:.3g} µs"
    else:
        text += f", {float(table['tolerance'][row]):.0e}"
    return text + (f", onset depth {depth:.0e} m" if np.isfinite(depth) else "")


def long_runs(report: Report) -> None:
    """Compare statistics of long runs at the longest step with those of replicates."""
    until = 0.05 if report.quick else 2.0
    report.say(
        "## Statistics of long runs",
        "",
        f"{until:g} s of the marine engine without guide bars, the first tenth left out. "
        "Replicates are five RK4 runs at 1 µm onset depth "
        "that begin with pretensions a billionth apart; chaos makes them different runs of the "
        "same drive.",
    )
    drive = cd.scenes.marine_engine_bare().replace({"guides": []})
    options = {"until": until, "every": 5e-4, "record": "span_tension", "error": False}

    def account(result):
        tension = result["span_tension"].sel(time=slice(0.1 * until, None))
        mean, rms = tension.mean("time"), np.sqrt((tension**2).mean("time"))
        return np.concatenate([mean.values, rms.values])

    replicates = []
    for i in range(2 if report.quick else 5):
        near = drive.replace({"route.pretension": 15e3 * (1 + 1e-9 * i)})
        run = cd.simulate(near, method="rk4", onset_depth=1e-6, **options)
        replicates.append(account(run))
    replicates = np.array(replicates)
    centre = replicates.mean(axis=0)
    spread = np.abs(replicates / centre - 1).max()
    rows, best = [], None
    for step in (1.2e-5, 1.7e-5, 2.2e-5, 2.6e-5):
        stepping, whole, run = [], [], None
        for _ in range(report.repeats):
            begin = time.process_time()
            run = cd.simulate(drive, method="verlet", step=step, **options)
            whole.append(time.process_time() - begin)
            stepping.append(float(run.attrs["real_time_factor"]))
        off = np.abs(account(run) / centre - 1).max()
        factor = statistics.median(stepping)
        inside = off <= max(spread, 1e-4)
        rows.append(
            [
                f"{1e6 * step:.0f}",
                f"{100 * off:.2f} %",
                f"{factor:.1f}",
                f"{until / statistics.median(whole):.1f}",
            ]
        )
        if inside and (best is None or factor > best):
            best = factor
    report.table(
        [
            "Verlet step [µs]",
            "largest deviation of a mean or rms",
            "× real time, stepping",
            "with assembly and samples",
        ],
        rows,
    )
    report.say(f"Replicates scatter by {100 * spread:.2f} % at most about their mean.", "")
    report.claim(
        "marine engine, statistics within the replicates' scatter",
        "≥ 20 × real time",
        "none of the steps" if best is None else f"{best:.1f} ×",
        best is not None and best >= 20.0,
    )


def sweeps(report: Report) -> None:
    count = (4, 2) if report.quick else (20, 10)
    vary = {
        "sprockets.crank.motion.speed": np.linspace(-6.3, -16.0, count[0]),
        "route.pretension": np.linspace(10e3, 28e3, count[1]),
    }
    cores = min(2, os.cpu_count() or 1)
    ratios, equal = [], True
    for _ in range(report.repeats):
        walls, results = [], []
        for jobs in (1, cores):
            begin = time.perf_counter()
            results.append(
                cd.sweep(cd.scenes.marine_engine_bare(), vary, until=0.02, every=1e-3, jobs=jobs)
            )
            walls.append(time.perf_counter() - begin)
        measured = ["stepping_time", "real_time_factor"]
        equal &= results[0].drop_vars(measured).equals(results[1].drop_vars(measured))
        ratios.append(walls[0] / walls[1])
    ratio = statistics.median(ratios)
    report.say(
        "## Sweeps",
        "",
        f"{count[0] * count[1]} variants of the marine engine over speed and pretension, 20 ms "
        f"each: {cores} threads "
        f"take the serial time over {ratio:.2f} (median of {len(ratios)}, {min(ratios):.2f} to "
        f"{max(ratios):.2f}); "
        f"the numbers are {'the same to the last bit' if equal else 'NOT the same'}. See "
        "[sweeps](sweeps.md).",
        "",
    )
    report.claim(
        "sweep of 200 variants on two cores",
        "≥ 1.8 ×, same bits",
        f"{ratio:.2f} ×, {'same bits' if equal else 'other bits'}",
        equal and ratio >= 1.8,
    )


def peers(report: Report) -> None:
    found = json.loads((HERE / "peers" / "results.json").read_text(encoding="utf-8"))
    versions = ", ".join(
        f"{name} {number}" for name, number in found["machine"]["versions"].items()
    )
    report.say(
        "## Beside other programs",
        "",
        "The same drive, side by side in one run, processor time at equal error of the tension "
        f"(≤ 2 %); {versions}. How, "
        "and what to read into it: [benchmarks/peers](../benchmarks/peers/README.md).",
    )
    rows = []
    wanted = {"numba": 3.0, "exudyn": 2000.0}
    for name, ratio in found["ratios"].items():
        text = f"{ratio['ratio']:.3g}"
        error = f"{100 * ratio['error'][1]:.2g} % against {100 * ratio['error'][0]:.2g} %"
        rows.append([name, text, error])
        if name in wanted:
            report.claim(
                f"times as fast as {name} at equal error",
                f"≥ {wanted[name]:g}",
                text,
                ratio["ratio"] >= wanted[name],
            )
    report.table(["program", "its time over ours", "its error against ours"], rows)


def machine() -> str:
    """Describe the processor as the system names it."""
    info = Path("/proc/cpuinfo")
    if info.exists():
        for line in info.read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    return platform.processor() or platform.machine()


def main() -> None:
    parser = argparse.ArgumentParser(description="Measure speed and error, and write the page.")
    parser.add_argument("--quick", action="store_true", help="only see that everything works")
    parser.add_argument(
        "--docs", type=Path, default=HERE.parent / "docs", help="folder to write to"
    )
    arguments = parser.parse_args()
    arguments.docs.mkdir(parents=True, exist_ok=True)
    report = Report(arguments.quick, arguments.docs)
    load = os.getloadavg()[0] if hasattr(os, "getloadavg") else float("nan")
    for part in (kernels, lengths, memory, precision, long_runs, sweeps, peers):
        part(report)
    body, report.lines = report.lines, []
    report.say(
        "# How fast, how accurate",
        "",
        "Written by `make report`; nothing on this page is typed by hand. Every target that was "
        "set is listed with what "
        "was found, met or not.",
        "",
        f"{machine()}, {os.cpu_count()} cores, load {load:.1f} at the start; "
        f"{platform.system()}, Python "
        f"{platform.python_version()}, chaindrive {cd.__version__}.",
    )
    report.table(
        ["target", "wanted", "found", ""],
        [
            [what, wanted, found, "met" if met else "**missed**"]
            for what, wanted, found, met in report.claims
        ],
    )
    page = report.folder / "how-fast-how-accurate.md"
    page.write_text("\n".join(report.lines + body) + "\n", encoding="utf-8")
    print(f"written to {page}", file=sys.stderr)


if __name__ == "__main__":
    main()
