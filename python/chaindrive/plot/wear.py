"""Contacts, joints, wear and fatigue of a run."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from chaindrive import analysis
from chaindrive.errors import ParameterError
from chaindrive.extras import extra
from chaindrive.plot.axes import colour_bar, drawing, legend_below
from chaindrive.plot.docstrings import completed
from chaindrive.plot.scheme import CURVES, LIMIT, MARK, STEEL
from chaindrive.plot.source import analysed, chain_of, driver_of
from chaindrive.plot.units import hours, in_trade, rounded, scientific, written

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

__all__ = [
    "elongation",
    "impacts",
    "joint_work",
    "losses",
    "rainflow",
    "tension_around_loop",
    "tooth_load",
    "utilisation",
]

_BLUE, _ORANGE = CURVES[:2]
# Checks whose bars have other names.
_TITLES = {"twin": "power, ASME twin"}


@completed(chain=True)
def tension_around_loop(source: xr.Dataset, *, ax: Axes | None = None, **options: Any) -> Axes:
    """Draw the tension of links around the loop, with the sprockets shaded."""
    usual = {"chain": chain_of}
    loop = analysed(source, analysis.tension_around_loop, "tension_mean", options, usual)
    with drawing(ax) as ax:
        station = loop["station"]
        factor, unit = in_trade("N", loop["tension_max"])
        ends = (factor * loop["tension_min"], factor * loop["tension_max"])
        look: dict[str, Any] = {"alpha": 0.25, "linewidth": 0}
        ax.fill_between(station, *ends, color=_BLUE, label="least to largest", **look)
        ax.plot(station, factor * loop["tension_mean"], color=_BLUE, label="mean")
        links = int(loop.attrs["links"])
        row = 0
        previous = -np.inf
        for name in loop["sprocket"].to_numpy():
            begin, end = (
                float(loop[f"sprocket_{it}"].sel(sprocket=name)) for it in ("begin", "end")
            )
            # A wrap that passes the beginning of the loop is drawn at both ends.
            for shift in (0, links) if end > links else (0,):
                ax.axvspan(begin - shift, min(end - shift, links), color=STEEL, **look)
            middle = (begin + end) / 2 % links
            # Names of sprockets near each other stand in two rows.
            row = 1 - row if abs(middle - previous) < 0.2 * links else 0
            previous = middle
            ax.annotate(
                str(name),
                (middle, 1.0),
                xycoords=("data", "axes fraction"),
                xytext=(0, 3 + 11 * row),
                textcoords="offset points",
                ha="center",
                fontsize="small",
            )
        ax.set_xlim(0, links)
        ax.set_xlabel("place on the loop [pitches]")
        ax.set_ylabel(written("link tension", unit))
        legend_below(ax)
    return ax


@completed()
def tooth_load(
    source: xr.Dataset, sprocket: str | None = None, *, ax: Axes | None = None, **options: Any
) -> Axes:
    """Draw the load of a roller from seating to release, beside Binder's decay.

    Parameters
    ----------
    sprocket
        Of a run, the sprocket; the driver when absent.
    """
    chosen = {"sprocket": sprocket, **options}
    usual = {"sprocket": driver_of}
    load = analysed(source, analysis.tooth_load, "force_mean", chosen, usual)
    with drawing(ax) as ax:
        angle = np.degrees(load["angle"])
        # One stroke at seating may be ten times what the teeth carry.
        peak = float(load["force_max"].max())
        body = float(load["force_max"].quantile(0.9))
        reference = load.get("force_reference")
        top = 1.3 * max(body, 0.0 if reference is None else float(reference.max()))
        factor, unit = in_trade("N", top)
        ends = (factor * load["force_min"], factor * load["force_max"])
        ax.fill_between(angle, *ends, color=STEEL, alpha=0.3, linewidth=0, label="least to largest")
        mean, scatter = factor * load["force_mean"], factor * load["force_std"]
        ax.fill_between(
            angle,
            mean - scatter,
            mean + scatter,
            color=_BLUE,
            alpha=0.3,
            linewidth=0,
            label="mean ± scatter",
        )
        ax.plot(angle, mean, color=_BLUE, label="mean")
        if reference is not None:
            ax.plot(angle, factor * reference, "--", color=_ORANGE, label="Binder's decay")
        if peak > 1.5 * top > 0.0:
            ax.set_ylim(top=factor * top)
            ax.set_title(f"largest {rounded(peak, 'N')}, above the picture", fontsize="small")
        ax.set_ylim(bottom=0)
        ax.set_xlabel(f"angle of {load.attrs['sprocket']} since seating [°]")
        ax.set_ylabel(written("tooth load", unit))
        ax.set_xlim(0, float(angle.max()))
        legend_below(ax)
    return ax


@completed(run='A run with ``events="teeth"``')
def impacts(source: xr.Dataset, *, ax: Axes | None = None, **options: Any) -> Axes:
    """Draw how fast rollers are seated: the share of engagements below a speed, by sprocket."""
    found = analysed(source, analysis.impacts, "speed_theoretical", options)
    with drawing(ax) as ax:
        of = found["sprocket_of"].to_numpy()
        for name in found["sprocket"].to_numpy():
            speeds = np.sort(found["speed"].to_numpy()[of == name])
            if speeds.size == 0:
                continue
            share = (np.arange(speeds.size) + 1) / speeds.size
            (line,) = ax.step(speeds, 100 * share, where="post", label=str(name))
            ideal = float(found["speed_theoretical"].sel(sprocket=name))
            ax.axvline(ideal, color=line.get_color(), linestyle=":")
        ax.plot([], [], ":", color=LIMIT, label="p ω of each")
        ax.set_xlim(left=0)
        ax.set_ylim(0, 101)
        ax.set_xlabel("closing speed at seating [m/s]")
        ax.set_ylabel("engagements below [%]")
        legend_below(ax)
    return ax


@completed()
def losses(source: xr.Dataset, *, ax: Axes | None = None, **options: Any) -> Axes:
    """Draw the mean power that is lost at every place.

    Raises
    ------
    ParameterError
        Nothing was lost; or the analysis refuses the run: the message names the channel to record.
    """
    found = analysed(source, analysis.losses, "power_over_time", options)
    lost = found["power"].where(found["energy"] != 0.0, drop=True)
    if lost.size == 0:
        message = "nothing is lost in this run: contacts and joints neither rub nor damp"
        raise ParameterError(message, "energy_losses", "give friction or damping in the scene")
    with drawing(ax) as ax:
        factor, unit = in_trade("W", lost)
        places = [str(place) for place in lost["place"].to_numpy()]
        bars = ax.barh(places, factor * lost, color=_BLUE)
        share = 100 * found["share"].sel(place=lost["place"])
        ax.bar_label(bars, [f"{float(it):.1f} %" for it in share], padding=3, fontsize="small")
        ax.invert_yaxis()
        ax.margins(x=0.15)
        ax.set_xlabel(written("power lost", unit))
        efficiency = found["efficiency"]
        if np.isfinite(efficiency):
            ax.set_title(f"efficiency {100 * float(efficiency):.2f} %")
        elif unknown := efficiency.attrs.get("unknown"):
            ax.set_title(f"no efficiency: {unknown}", fontsize="small")
    return ax


@completed(chain=True)
def joint_work(source: xr.Dataset, *, ax: Axes | None = None, **options: Any) -> Axes:
    """Draw pressure and p·v of the joints.

    Returns
    -------
    matplotlib.axes.Axes
        Those of the pressure; p·v stands on the right.
    """
    usual = {"chain": chain_of}
    work = analysed(source, analysis.joint_work, "pressure_velocity", options, usual)
    with drawing(ax) as ax:
        joint = work["joint"]
        ax.plot(joint, work["pressure"] / 1e6, ".", color=_BLUE, label="mean while it slides")
        ax.plot(joint, work["pressure_largest"] / 1e6, "_", color=_BLUE, label="largest")
        ax.set_ylim(bottom=0)
        ax.set_xlabel("joint")
        ax.set_ylabel("bearing pressure [N/mm²]", color=_BLUE)
        right = ax.twinx()
        right.spines["right"].set_visible(True)
        right.plot(joint, work["pressure_velocity"] / 1e6, ".", color=_ORANGE)
        right.set_ylim(bottom=0)
        right.set_ylabel("p·v [N/mm² · m/s]", color=_ORANGE)
        # The points on the right are named on the left too, for one legend.
        ax.plot([], [], ".", color=_ORANGE, label="p·v")
        ax.set_title(_during(work))
        legend_below(ax)
    return ax


@completed(of="wear", chain=True)
def elongation(source: xr.Dataset, *, ax: Axes | None = None, **options: Any) -> Axes:
    """Draw the elongation of a chain over hours: a band, for nobody knows how fast joints wear."""
    found = analysed(source, analysis.wear, "elongation", options, {"chain": chain_of})
    with drawing(ax) as ax:
        time = found["hours"].to_numpy()
        ends = 100 * found["elongation_range"]
        least, greatest = (ends.sel(bound=it).to_numpy() for it in ("least", "greatest"))
        k = scientific(found.attrs["coefficient"] * 1e9)
        low, high = found.attrs["coefficient_range"]
        name = f"k = {k} mm³/(N m)"
        if low < high:
            words = [scientific(it * 1e9) for it in (low, high)]
            band = f"k = {words[0]} to {words[1]} mm³/(N m)"
            ax.fill_between(time, least, greatest, color=_BLUE, alpha=0.25, linewidth=0, label=band)
        ax.plot(time, 100 * found["elongation"], color=_BLUE, label=name)
        limit = 100 * float(found["wear_limit"])
        life = [float(it) for it in found["life"]]
        told = hours(*life) if low < high else hours(life[0], life[0]).partition(" to ")[0] + " h"
        ax.axhline(limit, linestyle=":", color=LIMIT)
        ax.annotate(
            f"worn out after {told}: {limit:.2g} %, {found.attrs['wear_limit_by']}",
            (0.0, limit),
            xycoords=("axes fraction", "data"),
            xytext=(4, 3),
            textcoords="offset points",
            fontsize="small",
        )
        source_of_k = str(found.attrs["coefficient_source"]).partition(":")[0]
        ax.set_title(f"wear coefficient {source_of_k}", fontsize="small")
        ax.set_xscale("log")
        ax.set_xlim(time[0], time[-1])
        ax.set_ylim(0, 1.25 * limit)
        ax.set_xlabel("running time [h]")
        ax.set_ylabel("elongation [%]")
        legend_below(ax)
    return ax


@completed(chain=True)
def rainflow(source: xr.Dataset, *, ax: Axes | None = None, **options: Any) -> Axes:
    """Draw the load cycles of a link: their number by range and mean."""
    norm_of = extra("matplotlib.colors", "plots").LogNorm

    found = analysed(source, analysis.rainflow, "cycles", options, {"chain": chain_of})
    with drawing(ax) as ax:
        cycles = found["cycles"].transpose("tension_mean", "tension_range")
        filled = np.ma.masked_less_equal(cycles.to_numpy(), 0.0)
        norm = norm_of(float(filled.min()), float(filled.max())) if filled.count() else None
        factor, unit = in_trade("N", found["tension_mean"])
        mesh = ax.pcolormesh(
            factor * found["tension_range"],
            factor * found["tension_mean"],
            filled,
            norm=norm,
            cmap="viridis",
            shading="nearest",
        )
        colour_bar(ax, mesh, "cycles of a link in the run")
        ax.set_xlim(left=0)
        ax.set_xlabel(written("tension range", unit))
        ax.set_ylabel(written("mean tension", unit))
        ax.set_title(_during(found))
    return ax


@completed(chain=True)
def utilisation(source: xr.Dataset, *, ax: Axes | None = None, **options: Any) -> Axes:
    """Draw loads over limits; beyond the line at 100 % is too much. Hatched: that of the twin."""
    usual = {"chain": chain_of}
    found = analysed(source, analysis.utilisation, "utilisation", options, usual)
    with drawing(ax) as ax:
        used = 100 * found["utilisation"].to_numpy()
        colours = [MARK if it > 100 else _BLUE for it in used]
        names = [
            f"{_TITLES.get(str(check), check)}\n{rounded(float(load), str(unit))}"
            f" of {rounded(float(limit), str(unit))}"
            for check, load, limit, unit in zip(
                found["check"].to_numpy(),
                found["load"].to_numpy(),
                found["limit"].to_numpy(),
                found["unit"].to_numpy(),
                strict=True,
            )
        ]
        bars = ax.barh(names, used, color=colours)
        # A twin is another chain: its bar is no verdict on this one.
        for bar, check in zip(bars, found["check"].to_numpy(), strict=True):
            if check == "twin":
                bar.set(hatch="///", facecolor="none", edgecolor=bar.get_facecolor())
        ax.bar_label(bars, [f"{it:.0f} %" for it in used], padding=3, fontsize="small")
        ax.axvline(100, color=LIMIT, linestyle="--")
        ax.set_xlim(0, 1.15 * max(100.0, float(np.nanmax(used))))
        ax.invert_yaxis()
        ax.set_xlabel("utilisation [%]")
    return ax


def _during(found: xr.Dataset) -> str:
    """Title that tells which chain, and how much of its way was seen."""
    chain = str(found.attrs.get("chain", ""))
    return f"{chain}, {found.attrs['circuits']:.2g} circuits".removeprefix(", ")
