"""How far each assumption moves what one reads off a drive: tables and a diagram."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import xarray as xr

import chaindrive as cd
from assumptions import Assumption, Case
from chaindrive.plot.scheme import STYLE


def tight_span(name: str) -> object:
    """Return a statistic of the span that is tight in the mean over the phases."""

    def of(runs: xr.Dataset) -> xr.DataArray:
        tight = int(runs["span_tension_mean"].mean("phase").values.argmax())
        return runs[name].isel(span=tight)

    return of


#: Outputs, and their names in the tables.
OUTPUTS = {
    "tight span, mean": tight_span("span_tension_mean"),
    "tight span, scatter": tight_span("span_tension_std"),
    "contact force, 99 %": "contact_force_p99",
    "share lost": "loss_share",
}


def effects(case: Case) -> xr.Dataset:
    """Return what the assumptions of a preset move, the one that moves most first."""
    return cd.tornado(
        getattr(cd.scenes, case.preset)().replace({"run.run_in": case.run_in}),
        {assumption.name: assumption.ends for assumption in case.assumptions},
        OUTPUTS,
        phases=case.phases,
        until=case.until,
        progress=True,
    )


def table(case: Case, found: xr.Dataset) -> Iterator[str]:
    """Yield lines of Markdown."""
    level = found["value"].values
    named = {it.name: it for it in case.assumptions}
    ranked: list[Assumption] = [named[name] for name in found["assumption"].values]
    change, width = found["share"].values, (found["half_width"] / found["value"]).values
    units = [
        f"{level[0]:.4g} N",
        f"{level[1]:.3g} N",
        f"{level[2]:.3g} N",
        f"{100 * level[3]:.3g} %",
    ]
    header = [f"{name}: {unit}" for name, unit in zip(OUTPUTS, units, strict=True)]
    yield f"### {case.preset}"
    yield ""
    yield "| assumption | range | " + " | ".join(header) + " |"
    yield "|---|---|" + "---|" * len(OUTPUTS)
    for number, assumption in enumerate(ranked):
        cells = []
        for output in range(len(OUTPUTS)):
            ends = zip(change[number, :, output], width[number, :, output], strict=True)
            cells.append(", ".join(f"{100 * c:+.1f} ± {100 * w:.1f} %" for c, w in ends))
        yield "| " + " | ".join([assumption.name, assumption.range, *cells]) + " |"
    yield ""
    yield "The three that matter most, by their largest effect, and what would settle them:"
    yield ""
    for number, assumption in enumerate(ranked[:3]):
        largest = np.abs(change[number]).max(0)
        worst = int(largest.argmax())
        yield (
            f"{number + 1}. **{assumption.name}** ({list(OUTPUTS)[worst]} by "
            f"{100 * largest[worst]:.0f} %): {assumption.settled_by}."
        )
    yield ""


def draw(results: list[tuple[Case, xr.Dataset]], path: Path) -> None:
    """Draw a tornado a preset and output: bars from one end of the range to the other."""
    from matplotlib import pyplot as plt

    # Two beside each other: names are read at the width of a page.
    columns = 2
    rows = len(results) * len(OUTPUTS) // columns
    with plt.rc_context(dict(STYLE)):
        figure, axes = plt.subplots(
            rows, columns, figsize=(9.5, 2.8 * rows), layout="constrained", squeeze=False
        )
        panels = [(case, found, name) for case, found in results for name in OUTPUTS]
        for ax, (case, found, name) in zip(axes.flat, panels, strict=True):
            cd.plot.tornado(found, name, ax=ax)
            ax.set_title(f"{case.preset}: {name}")
            ax.get_legend().remove()
        handles = axes.flat[0].get_legend_handles_labels()
        figure.legend(*handles, loc="outside upper center", ncols=2)
        figure.savefig(path, dpi=84)
        plt.close(figure)
