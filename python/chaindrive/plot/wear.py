"""Contacts, joints, wear and fatigue: pictures of what `chaindrive.analysis` returns."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from chaindrive.plot.axes import given_or_new

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

_GREY = "#8d99a6"
_BLUE = "#1f4e79"
_ORANGE = "#b5651d"


def tension_around_loop(loop: xr.Dataset, *, ax: Axes | None = None) -> Axes:
    """Draw the tension of links around the loop, with the sprockets shaded.

    Parameters
    ----------
    loop
        From `analysis.tension_around_loop`.
    ax
        Where to draw; new axes when absent.

    Returns
    -------
    matplotlib.axes.Axes
    """
    ax = given_or_new(ax)
    station = loop["station"]
    ax.fill_between(
        station,
        loop["tension_min"],
        loop["tension_max"],
        color=_BLUE,
        alpha=0.25,
        linewidth=0,
        label="least to largest",
    )
    ax.plot(station, loop["tension_mean"], color=_BLUE, label="mean")
    links = int(loop.attrs["links"])
    for name in loop["sprocket"].to_numpy():
        begin, end = (float(loop[f"sprocket_{it}"].sel(sprocket=name)) for it in ("begin", "end"))
        # A wrap that passes the beginning of the loop is drawn at both ends.
        for shift in (0, links) if end > links else (0,):
            ax.axvspan(begin - shift, min(end - shift, links), color=_GREY, alpha=0.25, linewidth=0)
        middle = (begin + end) / 2 % links
        ax.annotate(
            str(name),
            (middle, 1.0),
            xycoords=("data", "axes fraction"),
            xytext=(0, 3),
            textcoords="offset points",
            ha="center",
            fontsize="small",
        )
    ax.set_xlim(0, links)
    ax.set_xlabel("place on the loop [pitches]")
    ax.set_ylabel("link tension [N]")
    return _with_legend(ax)


def tooth_load(load: xr.Dataset, *, ax: Axes | None = None) -> Axes:
    """Draw the load of a roller from seating to release, beside Binder's decay.

    Parameters
    ----------
    load
        From `analysis.tooth_load`.
    ax
        Where to draw; new axes when absent.

    Returns
    -------
    matplotlib.axes.Axes
    """
    ax = given_or_new(ax)
    angle = np.degrees(load["angle"])
    ax.fill_between(
        angle,
        load["force_min"],
        load["force_max"],
        color=_GREY,
        alpha=0.3,
        linewidth=0,
        label="least to largest",
    )
    mean, scatter = load["force_mean"], load["force_std"]
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
    if "force_reference" in load:
        ax.plot(angle, load["force_reference"], "--", color=_ORANGE, label="Binder's decay")
    # One stroke at seating may be ten times what the teeth carry.
    peak = float(load["force_max"].max())
    body = float(load["force_max"].quantile(0.9))
    reference = float(load["force_reference"].max()) if "force_reference" in load else 0.0
    top = 1.3 * max(body, reference)
    if peak > 1.5 * top:
        ax.set_ylim(top=top)
        ax.set_title(f"largest {_rounded(peak, 'N')}, above the picture", fontsize="small")
    ax.set_ylim(bottom=0)
    ax.set_xlabel(f"angle of {load.attrs['sprocket']} since seating [°]")
    ax.set_ylabel("tooth load [N]")
    ax.set_xlim(0, float(angle.max()))
    return _with_legend(ax)


def impacts(found: xr.Dataset, *, ax: Axes | None = None) -> Axes:
    """Draw how fast rollers are seated: the share of engagements below a speed, by sprocket.

    Parameters
    ----------
    found
        From `analysis.impacts`.
    ax
        Where to draw; new axes when absent.

    Returns
    -------
    matplotlib.axes.Axes
    """
    ax = given_or_new(ax)
    of = found["sprocket_of"].to_numpy()
    for name in found["sprocket"].to_numpy():
        speeds = np.sort(found["speed"].to_numpy()[of == name])
        if speeds.size == 0:
            continue
        share = (np.arange(speeds.size) + 1) / speeds.size
        (line,) = ax.step(speeds, 100 * share, where="post", label=str(name))
        ideal = float(found["speed_theoretical"].sel(sprocket=name))
        ax.axvline(ideal, color=line.get_color(), linestyle=":", label=f"p ω, {name}")
    ax.set_xlim(left=0)
    ax.set_ylim(0, 101)
    ax.set_xlabel("closing speed at seating [m/s]")
    ax.set_ylabel("engagements below [%]")
    return _with_legend(ax)


def losses(found: xr.Dataset, *, ax: Axes | None = None) -> Axes:
    """Draw the mean power that is lost at every place.

    Parameters
    ----------
    found
        From `analysis.losses`.
    ax
        Where to draw; new axes when absent.

    Returns
    -------
    matplotlib.axes.Axes
    """
    ax = given_or_new(ax)
    lost = found["power"].where(found["energy"] != 0.0, drop=True)
    bars = ax.barh(lost["place"].to_numpy().astype(str), lost, color=_BLUE)
    share = 100 * found["share"].sel(place=lost["place"])
    ax.bar_label(bars, [f"{float(it):.1f} %" for it in share], padding=3, fontsize="small")
    ax.invert_yaxis()
    ax.margins(x=0.15)
    ax.set_xlabel("power lost [W]")
    efficiency = float(found["efficiency"])
    if np.isfinite(efficiency):
        ax.set_title(f"efficiency {100 * efficiency:.2f} %", fontsize="medium")
    return ax


def joint_work(work: xr.Dataset, *, ax: Axes | None = None) -> Axes:
    """Draw bearing pressure and p·v of the joints.

    Parameters
    ----------
    work
        From `analysis.joint_work`.
    ax
        Where to draw; new axes when absent.

    Returns
    -------
    matplotlib.axes.Axes
        Those of the pressure; p·v stands on the right.
    """
    ax = given_or_new(ax)
    joint = work["joint"]
    ax.plot(joint, work["pressure"] / 1e6, ".", color=_BLUE, label="mean pressure")
    ax.plot(joint, work["pressure_largest"] / 1e6, "_", color=_BLUE, label="largest pressure")
    ax.set_ylim(bottom=0)
    ax.set_xlabel("joint")
    ax.set_ylabel("bearing pressure [MPa]", color=_BLUE)
    right = ax.twinx()
    right.plot(joint, work["pressure_velocity"] / 1e6, ".", color=_ORANGE)
    right.set_ylim(bottom=0)
    right.set_ylabel("p·v [MPa m/s]", color=_ORANGE)
    # The points on the right are named on the left too, for one legend.
    ax.plot([], [], ".", color=_ORANGE, label="p·v")
    ax.set_title(f"during {work.attrs['circuits']:.2g} circuits of the chain", fontsize="small")
    return _with_legend(ax)


def elongation(found: xr.Dataset, *, ax: Axes | None = None) -> Axes:
    """Draw the elongation of a worn chain over hours.

    Parameters
    ----------
    found
        From `analysis.wear`.
    ax
        Where to draw; new axes when absent.

    Returns
    -------
    matplotlib.axes.Axes
    """
    ax = given_or_new(ax)
    ax.plot(found["hours"], 100 * found["elongation"], color=_BLUE)
    last = float(found["hours"].max())
    for limit, hours in zip(found["limit"].to_numpy(), found["hours_to"].to_numpy(), strict=True):
        if hours <= last * (1 + 1e-9):
            ax.plot([hours, hours, 0], [0, 100 * limit, 100 * limit], ":", color=_GREY)
            ax.annotate(
                f"{100 * limit:.3g} % after {hours:,.0f} h",
                (hours, 100 * limit),
                xytext=(-6, 3),
                textcoords="offset points",
                ha="right",
                fontsize="small",
            )
    k = found.attrs["coefficient"] * 1e9
    source = str(found.attrs["coefficient_source"]).partition(":")[0]
    ax.set_title(f"k = {k:.2g} mm³/(N m), {source}", fontsize="small")
    ax.set_xlim(0, last)
    ax.set_ylim(bottom=0)
    ax.set_xlabel("running time [h]")
    ax.set_ylabel("elongation [%]")
    return ax


def rainflow(found: xr.Dataset, *, ax: Axes | None = None) -> Axes:
    """Draw the load cycles of a link: their number by range and mean.

    Parameters
    ----------
    found
        From `analysis.rainflow`.
    ax
        Where to draw; new axes when absent.

    Returns
    -------
    matplotlib.axes.Axes
    """
    from matplotlib.colors import LogNorm

    ax = given_or_new(ax)
    cycles = found["cycles"].transpose("tension_mean", "tension_range")
    filled = np.ma.masked_less_equal(cycles.to_numpy(), 0.0)
    norm = LogNorm(float(filled.min()), float(filled.max())) if filled.count() else None
    mesh = ax.pcolormesh(
        found["tension_range"] / 1e3,
        found["tension_mean"] / 1e3,
        filled,
        norm=norm,
        cmap="viridis",
        shading="nearest",
    )
    figure = ax.get_figure()
    if figure is not None:
        figure.colorbar(mesh, ax=ax, label="cycles of a link in the run")
    ax.set_xlim(left=0)
    ax.set_xlabel("tension range [kN]")
    ax.set_ylabel("mean tension [kN]")
    ax.set_title(f"during {found.attrs['circuits']:.2g} circuits of the chain", fontsize="small")
    return ax


def utilisation(found: xr.Dataset, *, ax: Axes | None = None) -> Axes:
    """Draw loads over limits; beyond the line at 100 % is too much.

    Parameters
    ----------
    found
        From `analysis.utilisation`.
    ax
        Where to draw; new axes when absent.

    Returns
    -------
    matplotlib.axes.Axes
    """
    ax = given_or_new(ax)
    used = 100 * found["utilisation"].to_numpy()
    colours = [_ORANGE if it > 100 else _BLUE for it in used]
    bars = ax.barh(found["check"].to_numpy().astype(str), used, color=colours)
    texts = [
        f"{_rounded(float(load), str(unit))} of {_rounded(float(limit), str(unit))}"
        for load, limit, unit in zip(
            found["load"].to_numpy(),
            found["limit"].to_numpy(),
            found["unit"].to_numpy(),
            strict=True,
        )
    ]
    ax.bar_label(bars, texts, padding=3, fontsize="small")
    ax.axvline(100, color=_GREY, linestyle="--")
    ax.set_xlim(0, 1.6 * max(100.0, float(used.max())))
    ax.invert_yaxis()
    ax.set_xlabel("utilisation [%]")
    return ax


def _with_legend(ax: Axes) -> Axes:
    """Return the axes with a legend below them, where it covers nothing."""
    handles, names = ax.get_legend_handles_labels()
    ax.legend(
        handles,
        names,
        loc="upper center",
        bbox_to_anchor=(0.5, -0.15),
        ncols=min(len(names), 4),
        fontsize="small",
        frameon=False,
    )
    return ax


def _rounded(value: float, unit: str) -> str:
    scale, prefix = {"N": (1e3, "k"), "W": (1e3, "k"), "Pa": (1e6, "M")}.get(unit, (1.0, ""))
    return f"{value / scale:.3g} {prefix}{unit}"
