"""A fit: intervals of its parameters, how they go together, and what it leaves."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from chaindrive.errors import ParameterError
from chaindrive.extras import extra
from chaindrive.plot.axes import colour_bar, drawing, legend_below
from chaindrive.plot.docstrings import completed
from chaindrive.plot.scheme import CURVES, LIMIT, MARK, STEEL

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["fit_correlations", "fit_intervals", "fit_profile", "fit_residuals"]

#: Errors beyond which a residual is marked [–]: 1 % of normal ones.
_FAR = 2.58
#: Correlation from which its colour is dark [–].
_DARK = 0.7


@completed()
def fit_intervals(fit: xr.Dataset, *, ax: Axes | None = None) -> Axes:
    """Draw where the parameters of a fit ended between their bounds, with their intervals.

    Parameters
    ----------
    fit
        What `chaindrive.calibrate` returned.

    Raises
    ------
    ParameterError
        This is no fit, or it was refused before anything was fitted.
    """
    _checked(fit)
    low, high = fit["low"].to_numpy(), fit["high"].to_numpy()
    places = np.arange(low.size)[::-1]

    def share(name: str) -> Any:
        return (fit[name].to_numpy() - low) / (high - low)

    at = share("estimate")
    with drawing(ax) as ax:
        ax.axvspan(0.0, 1.0, color=STEEL, alpha=0.15, linewidth=0)
        widths = [np.maximum(at - share("lower"), 0.0), np.maximum(share("upper") - at, 0.0)]
        label = f"fitted, {100 * fit.attrs['level']:g} %"
        ax.errorbar(at, places, xerr=widths, fmt="o", color=CURVES[0], capsize=3, label=label)
        ax.plot(share("start"), places, "|", color=CURVES[1], markersize=14, label="start")
        ax.set_yticks(places, [str(it) for it in fit["parameter"].to_numpy()])
        ax.set_xlabel("place between the bounds [–]")
        ax.set_ylim(-0.6, low.size - 0.4)
        legend_below(ax)
    return ax


@completed()
def fit_correlations(fit: xr.Dataset, *, ax: Axes | None = None) -> Axes:
    """Draw how the errors of the fitted parameters go together.

    Near ±1 only a combination of the two is known.

    Parameters
    ----------
    fit
        What `chaindrive.calibrate` returned.

    Raises
    ------
    ParameterError
        This is no fit, or it was refused before anything was fitted.
    """
    _checked(fit)
    found = fit["correlation"].to_numpy()
    names = [str(it) for it in fit["parameter"].to_numpy()]
    places = np.arange(len(names))
    with drawing(ax) as ax:
        mesh = ax.pcolormesh(places, places, found, cmap="coolwarm", vmin=-1.0, vmax=1.0)
        colour_bar(ax, mesh, "correlation [–]")
        for row, column in np.ndindex(found.shape):
            value = float(found[row, column])
            # White is read on the dark ends of the map alone.
            colour = "white" if abs(value) > _DARK else "black"
            ax.text(column, row, f"{value:+.2f}", ha="center", va="center", color=colour)
        short = [_short(it) for it in names]
        ax.set_xticks(places, short, rotation=30, ha="right")
        ax.set_yticks(places, short)
        ax.invert_yaxis()
        ax.set_xlabel("parameter")
    return ax


@completed()
def fit_profile(fit: xr.Dataset, parameter: str | None = None, *, ax: Axes | None = None) -> Axes:
    """Draw what a fit leaves where one parameter is held and all others are fitted again.

    A parabola is what a straight model would leave. The interval is where the curve is below t².

    Parameters
    ----------
    fit
        What ``chaindrive.calibrate(…, profiles=True)`` returned.
    parameter
        Its path; the first that has a profile when absent.

    Raises
    ------
    ParameterError
        This is no fit, or it has no such profile.
    """
    _checked(fit)
    names = [str(it) for it in fit["parameter"].to_numpy()]
    has = []
    if "profile_chi2" in fit:
        known = np.isfinite(fit["profile_chi2"].to_numpy()).any(axis=1)
        has = [name for name, it in zip(names, known, strict=True) if it]
    if not has or (parameter is not None and parameter not in has):
        message = f"there is no profile of {parameter or 'any parameter'}"
        raise ParameterError(message, "parameter", "chaindrive.calibrate(…, profiles=True)")
    own = fit.isel(parameter=names.index(parameter or has[0]))
    middle, error = float(own["estimate"]), float(own["error"])
    # The interval by a straight model is ± t errors.
    wide = (float(own["upper"]) - middle) / error
    at, chi2 = own["profile_value"].to_numpy(), own["profile_chi2"].to_numpy()
    known = np.isfinite(chi2)
    line = np.linspace(at[known][0], at[known][-1], 200)
    curve = extra("scipy.interpolate", "plots of profiles").PchipInterpolator(
        at[known], np.sign(at[known] - middle) * np.sqrt(chi2[known])
    )
    with drawing(ax) as ax:
        straight = ((line - middle) / error) ** 2
        ax.plot(line, straight, "--", color=STEEL, label="straight model")
        ax.plot(line, curve(line) ** 2, color=CURVES[0], label="profile")
        ax.plot(at[known], chi2[known], "o", color=CURVES[0])
        limit = f"t² at {100 * fit.attrs['level']:g} %"
        ax.axhline(wide**2, color=LIMIT, lw=0.8, label=limit)
        ends = [float(own[name]) for name in ("profile_lower", "profile_upper")]
        for n, end in enumerate(it for it in ends if np.isfinite(it)):
            ax.axvline(end, color=CURVES[1], lw=0.8, label=None if n else "interval")
        ax.set_xlabel(f"{own['parameter'].item()} [SI]")
        ax.set_ylabel("χ² above its least [–]")
        ax.set_ylim(bottom=0.0)
        ax.margins(x=0)
        legend_below(ax)
    return ax


@completed()
def fit_residuals(fit: xr.Dataset, *, ax: Axes | None = None) -> Axes:
    """Draw what a fit leaves of every feature over its error, and of the part that was kept.

    Parameters
    ----------
    fit
        What `chaindrive.calibrate` returned.

    Raises
    ------
    ParameterError
        This is no fit, or it was refused before anything was fitted.
    """
    _checked(fit)
    names = [str(it) for it in fit["feature"].to_numpy()]
    places = np.arange(len(names))[::-1]
    left = fit["residual"].to_numpy()
    with drawing(ax) as ax:
        ax.axvspan(-1.0, 1.0, color=STEEL, alpha=0.25, linewidth=0)
        ax.axvline(0.0, color=LIMIT, lw=0.8)
        ax.plot(left, places, "o", color=CURVES[0], label="fitted")
        far = np.abs(left) > _FAR
        ax.plot(left[far], places[far], "o", mfc="none", mec=MARK, markersize=12)
        if "kept_residual" in fit:
            rows = dict(zip(names, places, strict=True))
            kept = [
                (float(it), rows[str(name)])
                for name, it in zip(
                    fit["kept_feature"].to_numpy(), fit["kept_residual"].to_numpy(), strict=True
                )
                if str(name) in rows
            ]
            ax.plot(*np.array(kept).reshape(-1, 2).T, "x", color=CURVES[1], label="kept")
        ax.set_yticks(places, names)
        ax.set_xlabel("difference over its error [–]")
        reach = max(3.0, 1.1 * float(np.nanmax(np.abs(left))))
        ax.set_xlim(-reach, reach)
        legend_below(ax)
    return ax


def _short(path: str) -> str:
    """Return the last two names of a path, which are read beside each other."""
    return ".".join(path.split(".")[-2:])


def _checked(fit: Any) -> None:
    if not isinstance(fit, xr.Dataset) or "estimate" not in fit or "residual" not in fit:
        raise ParameterError("this is no fit", "fit", "what chaindrive.calibrate returns")
    if not np.isfinite(fit["estimate"]).all():
        reasons = "; ".join(fit.attrs.get("reasons", []))
        raise ParameterError(f"nothing was fitted: {reasons}", "fit")
