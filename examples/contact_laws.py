"""Compare the contact laws: tables and figure of docs/contact-laws.md.

Run it as ``python examples/contact_laws.py [--results FOLDER]``; it rewrites the tables between
their marks and draws contact_laws.png, in docs unless told otherwise. With ``--criterion
target/criterion``, after ``cargo bench -p chaindrive-contact``, it also rewrites the costs.
"""

import argparse
import json
import re
from pathlib import Path

import matplotlib as mpl
import numpy as np

import chaindrive as cd

DOCS = Path(__file__).resolve().parents[1] / "docs"
MODULUS = 113.736263736e9  # steel on steel [Pa]
LENGTH = PIN = 10e-3  # length of the contact and radius of the pin [m]; most laws do not ask
LAWS = {
    "conformal": "conformal",
    "cylindrical": "cylindrical (enhanced)",
    "radzimovsky": "Radzimovsky",
    "esdu-78035": "ESDU 78035",
    "dubowsky-freudenstein": "Dubowsky–Freudenstein",
    "hertz": "Hertz point contact",
}
DISSIPATIONS = [
    "exact",
    "hunt-crossley",
    "lankarani-nikravesh",
    "lee-wang",
    "herbert-mcwhannell",
    "gonthier",
    "zhiying-qishao",
    "flores",
    "hu-guo",
]
# Where the laws are compared: radii [mm], least depth [mm], greatest depth [mm] and as a share of
# the clearance.
INSIDE = {
    "ΔR 0.01–2 mm, δ 0.3 µm – 0.1 ΔR": ((0.01, 2.0), 3e-4, 0.1, 0.1),
    "ΔR 0.02–1 mm, δ 1 µm – 0.1 ΔR": ((0.02, 1.0), 1e-3, 0.1, 0.1),
    "ΔR 0.01–2 mm, δ 0.1 µm – 0.1 ΔR": ((0.01, 2.0), 1e-4, 0.1, 0.1),
    "ΔR 0.01–2 mm, δ 0.1 µm – 0.3 ΔR": ((0.01, 2.0), 1e-4, 0.1, 0.3),
    "pin in bushing, ΔR 0.05 mm, δ 1–10 µm": ((0.05, 0.05), 1e-3, 1e-2, 1.0),
}
OUTSIDE = {
    "ΔR 5–100 mm, δ 0.3–30 µm": ((5.0, 100.0), 3e-4, 3e-2, 1.0),
    "ΔR 5–100 mm, δ 0.1–100 µm": ((5.0, 100.0), 1e-4, 1e-1, 1.0),
    "roller on flank, ΔR 22.5 mm, δ 1–30 µm": ((22.475, 22.475), 1e-3, 3e-2, 1.0),
}


def inside(kind: str, clearance: float, **more) -> cd.Law:
    return cd.law(kind, hole=PIN + clearance, pin=PIN, length=LENGTH, modulus=MODULUS, **more)


def outside(kind: str, radii: float) -> cd.Law:
    return cd.law(kind, radius=radii / 2, other=radii / 2, length=LENGTH, modulus=MODULUS)


def error(make, kind: str, radii: float, depth: np.ndarray) -> np.ndarray:
    """Return the force of a law relative to Johnson's, less one."""
    return make(kind, radii).force(depth) / make("johnson", radii).force(depth) - 1.0


def errors(make, kind: str, span, least: float, most: float, share: float) -> np.ndarray:
    """Return all errors over a range of radii and depths [mm]."""
    found = []
    for radii in np.geomspace(*span, 40 if span[0] < span[1] else 1):
        end = min(most, share * radii) if make is inside else most
        if end > least:
            depth = 1e-3 * np.geomspace(least, end, 60)
            found.append(error(make, kind, 1e-3 * radii, depth))
    return np.concatenate(found)


def against_johnson() -> str:
    lines = ["| range | " + " | ".join(LAWS.values()) + " |", "|---|" + "---|" * len(LAWS)]
    for make, ranges in [(inside, INSIDE), (outside, OUTSIDE)]:
        for name, (span, least, most, share) in ranges.items():
            row = [f"{make.__name__}, {name}"]
            for kind in LAWS:
                found = 100.0 * np.abs(errors(make, kind, span, least, most, share))
                row.append(f"{found.mean():.1f} / {found.max():.1f}")
            lines.append("| " + " | ".join(row) + " |")
    return "\n".join(lines)


def plane_strain(angle: float, terms: int = 24, nodes: int = 400) -> tuple[float, float]:
    """Solve a disk in a hole of the same material that touch over ± `angle` [rad].

    The pressure is a series of Chebyshev polynomials times the root that vanishes at the edges;
    its logarithmic part is integrated in closed form, the rest by Gauss's rule.

    Returns
    -------
    load, approach
        F/(E* L ΔR), and the approach over ΔR but for a part in proportion to the load.
    """
    rule = np.arange(1, nodes + 1) * np.pi / (nodes + 1)
    s, weight = np.cos(rule), np.pi / (nodes + 1) * np.sin(rule) ** 2
    points = np.arange(terms + 1)
    t = np.cos((2 * points + 1) * np.pi / (4 * (terms + 1)))  # half of the interval will do
    orders = 2 * np.arange(terms)
    shape = np.sin(np.outer(rule, orders + 1)) / np.sin(rule)[:, None]  # U(s), (nodes, terms)

    # kernel = −½ − 2 cos φ ln(2 |sin φ/2|) = −2 ln|φ| + rest, φ = angle (t − s)
    phi = angle * (t[:, None] - s)
    phi = np.where(np.abs(phi) < 1e-12, 1e-12, phi)
    whole = -0.5 - 2.0 * np.cos(phi) * np.log(2.0 * np.abs(np.sin(phi / 2)))
    rest = (whole + 2.0 * np.log(np.abs(phi))) * weight @ shape
    # ∫ √(1 − s²) U_m(s) ln|t − s| ds = ½ π [T_{m+2}/(m + 2) − T_m/m], for m = 0 with ln 2
    turn = np.arccos(t)[:, None]
    below = np.where(orders == 0, np.log(2.0), np.cos(orders * turn) / np.maximum(orders, 1))
    logarithm = 0.5 * np.pi * (np.cos((orders + 2) * turn) / (orders + 2) - below)
    logarithm[:, 0] += 0.5 * np.pi * np.log(angle)  # ln|φ| = ln|t − s| + ln(angle)
    matrix = np.empty((terms + 1, terms + 1))
    matrix[:, :terms] = angle / np.pi * (rest - 2.0 * logarithm)
    matrix[:, terms] = -np.cos(angle * t)
    solution = np.linalg.solve(matrix, -np.ones(terms + 1))
    load = angle * (weight * np.cos(angle * s)) @ shape @ solution[:terms]
    return float(load), float(solution[terms] - 1.0)


def conformal_solution() -> tuple[np.ndarray, np.ndarray]:
    """Return loads F/(E* L ΔR) and depths δ/ΔR of the plane-strain solution.

    The part of the approach in proportion to the load is chosen so that light loads give Johnson's
    law.
    """
    loads, depths = np.transpose([plane_strain(a) for a in [0.01, *np.linspace(0.05, 1.17, 64)]])
    q = loads[0] / np.pi
    slope = (q * (np.log(4.0 / q) - 1.0) - depths[0]) / loads[0]
    return loads[1:], depths[1:] + slope * loads[1:]


def against_the_solution() -> str:
    loads, depths = conformal_solution()
    clearances = [0.03875, 0.05, 0.1, 0.5]  # seat, bushing, roller bore, large pin [mm]
    columns = ["Johnson", "conformal", *(f"cylindrical, ΔR {c:g} mm" for c in clearances)]
    lines = ["| δ/ΔR | " + " | ".join(columns) + " |", "|---|" + "---|" * len(columns)]
    for depth in [0.02, 0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5]:
        exact = np.interp(depth, depths, loads)
        row = [f"{depth:g}"]
        cases = [("johnson", 0.05), ("conformal", 0.05), *(("cylindrical", c) for c in clearances)]
        for kind, clearance in cases:
            clearance *= 1e-3
            force = inside(kind, clearance).force(depth * clearance)
            ratio = force / (exact * MODULUS * LENGTH * clearance)
            beyond = kind == "johnson" and depth > 0.9 * 4.0 / np.e**2
            row.append("tangent" if beyond else f"{100.0 * (ratio - 1.0):+.1f}")
        lines.append("| " + " | ".join(row) + " |")
    return "\n".join(lines)


def restitutions() -> str:
    asked = [0.1, 0.3, 0.5, 0.7, 0.8, 0.9, 0.95]
    lines = ["| dissipation | " + " | ".join(f"{e:g}" for e in asked) + " |"]
    lines.append("|---|" + "---|" * len(asked))
    for kind in DISSIPATIONS:
        laws = [inside("johnson", 5e-5, dissipation=kind, restitution=e) for e in asked]
        lines.append(f"| `{kind}` | " + " | ".join(f"{law.restitution:.3f}" for law in laws) + " |")
    return "\n".join(lines)


def costs(folders: list[Path]) -> str:
    """Return a table of Criterion's medians [ns], per evaluation of a batch of 1024.

    Of several runs the least counts: what others do to the machine only adds.
    """
    found: dict[str, dict[str, float]] = {}
    files = [file for folder in folders for file in sorted(folder.glob("*/*/new/estimates.json"))]
    for file in files:
        about = json.loads((file.parent / "benchmark.json").read_text(encoding="utf-8"))
        name, _, what = about["function_id"].rpartition(" ")
        median = json.loads(file.read_text(encoding="utf-8"))["median"]["point_estimate"] / 1024
        row = found.setdefault(f"{about['group_id']}: {name}", {})
        row[what] = min(median, row.get(what, median))
    lines = ["| | force | `respond` or `rub` | energy |", "|---|---|---|---|"]
    for name, row in found.items():
        both = {**row, "respond": row.get("respond", row.get("rub"))}
        cells = [both.get(what) for what in ("force", "respond", "energy")]
        shown = ["" if cell is None else f"{cell:.1f}" for cell in cells]
        lines.append(f"| {name} | " + " | ".join(shown) + " |")
    return "\n".join(lines)


def insert(text: str, name: str, table: str) -> str:
    """Put a table between its marks."""
    pattern = rf"(<!-- {name} -->\n).*?(<!-- end -->)"
    text, count = re.subn(pattern, lambda m: f"{m[1]}\n{table}\n\n{m[2]}", text, flags=re.DOTALL)
    if count != 1:
        raise SystemExit(f"contact-laws.md has no place for the table {name}")
    return text


def draw(path: Path) -> None:
    mpl.use("Agg")
    from matplotlib import pyplot as plt

    plt.rcParams.update(cd.plot.STYLE)
    figure, axes = plt.subplots(3, 2, figsize=(9.5, 12.5), layout="constrained")
    depth = np.geomspace(1e-8, 1e-4, 300)
    cases = [(inside, 5e-5, "pin in hole, ΔR = 0.05 mm"), (outside, 22.475e-3, "roller on flank")]
    for ax, (make, radii, title) in zip(axes[0], cases, strict=True):
        shown = depth[depth < 0.9 * 4.0 * radii / np.e**2]
        for kind, name in LAWS.items():
            ax.semilogx(1e6 * shown, 100.0 * error(make, kind, radii, shown), label=name)
        ax.set(title=title, xlabel="δ [µm]", ylabel="force against Johnson's [%]", ylim=(-90, 50))
        ax.axhline(0.0, color="C7", linewidth=0.6)
    below(axes[0, 0])

    maps = [
        (inside, np.geomspace(0.005, 10.0, 121), "cylindrical against Johnson, inside [%]"),
        (outside, np.geomspace(4.0, 300.0, 121), "cylindrical against Johnson, outside [%]"),
    ]
    grid = np.geomspace(1e-7, 1e-4, 121)
    for ax, (make, radii, title) in zip(axes[1], maps, strict=True):
        rows = []
        for radius in radii:
            row = 100.0 * error(make, "cylindrical", 1e-3 * radius, grid)
            # Beyond a third of the clearance Johnson's law is no measure.
            rows.append(np.where((make is inside) & (grid > 3e-4 * radius), np.nan, row))
        shade = ax.pcolormesh(
            1e6 * grid, radii, rows, cmap="RdBu", vmin=-30, vmax=30, shading="gouraud"
        )
        lines = ax.contour(
            1e6 * grid, radii, rows, [-20, -10, -5, 5, 10], colors="black", linewidths=0.6
        )
        ax.clabel(lines, fontsize="small")
        ax.set(title=title, xlabel="δ [µm]", ylabel="ΔR [mm]", xscale="log", yscale="log")
        figure.colorbar(shade, ax=ax)

    ax = axes[2, 0]
    loads, depths = conformal_solution()
    keep = depths < 0.9
    for kind, clearance in [
        ("johnson", 0.05),
        ("conformal", 0.05),
        ("cylindrical", 0.05),
        ("cylindrical", 0.5),
    ]:
        clearance *= 1e-3
        force = inside(kind, clearance).force(depths * clearance)
        ratio = force / (loads * MODULUS * LENGTH * clearance)
        used = keep & (depths < 0.9 * 4.0 / np.e**2) if kind == "johnson" else keep
        name = kind if kind != "cylindrical" else f"cylindrical, ΔR = {1e3 * clearance:g} mm"
        ax.plot(depths[used], 100.0 * (ratio[used] - 1.0), label=name)
    ax.axhline(0.0, color="C7", linewidth=0.6)
    ax.set(
        title="a wide contact, against plane strain",
        xlabel="δ/ΔR",
        ylabel="error of the force [%]",
        ylim=(-40, 40),
    )
    below(ax)

    ax = axes[2, 1]
    asked = np.linspace(0.02, 1.0, 50)
    for kind in DISSIPATIONS:
        laws = [inside("johnson", 5e-5, dissipation=kind, restitution=e) for e in asked]
        style = {"color": "C7", "linestyle": "--"} if kind == "exact" else {}
        ax.plot(asked, [law.restitution for law in laws], label=kind, **style)
    ax.set(title="restitution of a free impact", xlabel="asked for", ylabel="delivered")
    below(ax)
    figure.savefig(path, dpi=84)


def below(ax) -> None:
    """Put the legend where it covers no curve."""
    ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.14), ncols=2)


def main() -> None:
    parser = argparse.ArgumentParser(description="Compare the contact laws.")
    parser.add_argument("--results", type=Path, default=DOCS, help="folder to write to")
    parser.add_argument("--criterion", type=Path, nargs="+", help="folders of measured costs")
    arguments = parser.parse_args()
    arguments.results.mkdir(parents=True, exist_ok=True)

    text = (DOCS / "contact-laws.md").read_text(encoding="utf-8")
    text = insert(text, "against Johnson", against_johnson())
    text = insert(text, "against plane strain", against_the_solution())
    text = insert(text, "restitution", restitutions())
    if arguments.criterion is not None:
        text = insert(text, "cost", costs(arguments.criterion))
    page, figure = arguments.results / "contact-laws.md", arguments.results / "contact_laws.png"
    page.write_text(text, encoding="utf-8")
    draw(figure)
    print(f"written: {page}, {figure}")


if __name__ == "__main__":
    main()
