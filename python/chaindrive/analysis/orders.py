"""Orders of a shaft: channels over its angle, order against speed, and the Campbell diagram."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from chaindrive.analysis.order_names import order_names
from chaindrive.analysis.running import running_modes
from chaindrive.analysis.signal import finite, label, late, sample_rate, signal, turning
from chaindrive.errors import ParameterError
from chaindrive.extras import extra
from chaindrive.pose import at_start, drive_of

__all__ = ["campbell", "mesh_orders", "order_map", "order_slice", "order_spectrum"]


def order_map(
    run: xr.Dataset,
    channel: str | xr.DataArray,
    shaft: str,
    *,
    turns: float = 8.0,
    overlap: float = 0.75,
    window: str = "hann",
    **at: Any,
) -> xr.DataArray:
    """Amplitude of a channel by order of a shaft, over its turns.

    The channel is interpolated at equal angles of the shaft, as densely as the samples stand where
    it turns slowest, and cut into windows of whole turns; each is transformed. What happens so many
    times a turn stands at that order whatever the speed; a resonance stands where its frequency is
    order × speed.

    Parameters
    ----------
    run
        A run, best of `run_up`, with ``sprocket_angle`` or ``shaft_angle``.
    channel
        Name of a channel, or a signal over time of one's own.
    shaft
        Sprocket or shaft whose turns count.
    turns
        Length of a window [turns]: orders closer than some two windows' inverse are one.
    overlap
        Share of a window that the next one has in common with it, in [0, 1).
    window
        Window of `scipy.signal.get_window`.
    **at
        Labels by dimension, as in `spectrum`; one signal must remain.

    Returns
    -------
    xarray.DataArray
        (turn, order), with the coordinates ``speed`` [rad/s] and ``time`` [s] at the middle of
        each window. Attributes ``named_orders`` and ``order_names``: what `order_names` knows.

    Raises
    ------
    ParameterError
        A channel is missing or holds what is not a number, the shaft goes back, or turns less than
        one window.
    """
    values = _single(signal(run, channel, at))
    run = _during(run, values)
    angle, _ = turning(run, shaft)
    revolution, even, density = over_angle(values, angle)
    size = round(turns * density)
    if size > even.size or size < 8:
        raise ParameterError(
            f"turns = {turns}: {shaft} turns {angle[-1] / (2 * np.pi):.3g} times in all; "
            "make it less, or the run longer",
            "turns",
        )
    starts = _starts(even.size, size, overlap)
    order, amplitude = _amplitudes(even, starts, size, density, window)
    middle = revolution[starts] + 0.5 * size / density
    # The speed is the mean one of a window: its angle over its time.
    time = run["time"].to_numpy()
    turned = angle / (2 * np.pi)
    begin, end = (
        np.interp(edge, turned, time)
        for edge in (revolution[starts], revolution[starts] + size / density)
    )
    speed = 2 * np.pi * (size / density) / (end - begin)
    return xr.DataArray(
        amplitude,
        dims=("turn", "order"),
        coords={
            "turn": ("turn", middle, {"units": "1", "long_name": f"turns of {shaft}"}),
            "order": ("order", order, {"units": "1", "long_name": f"order of {shaft}"}),
            "speed": ("turn", speed, {"units": "rad/s", "long_name": f"speed of {shaft}"}),
            "time": ("turn", 0.5 * (begin + end), {"units": "s", "long_name": "time"}),
        },
        name=values.name,
        attrs={
            "units": values.attrs.get("units", "1"),
            "long_name": f"amplitude of {label(values)}",
            "shaft": shaft,
            "window": window,
            "resolution": density / size,
            **_named(run, shaft),
        },
    )


def order_spectrum(
    run: xr.Dataset,
    channel: str | xr.DataArray,
    shaft: str,
    *,
    window: str = "hann",
    after: float = 0.0,
    **at: Any,
) -> xr.DataArray:
    """Amplitude of a channel by order of a shaft, over the whole run.

    One window as long as the run: the finest orders that it gives. Take `peaks` of it.

    Parameters
    ----------
    run, channel, shaft, window, **at
        As in `order_map`.
    after
        Time up to which samples are left out [s].

    Returns
    -------
    xarray.DataArray
        (order,).
    """
    values = late(signal(run, channel, at), after)
    run = late(run, after)
    angle, _ = turning(_during(run, values), shaft)
    # Whole turns: the orders of the shaft fall on lines.
    turns = np.floor(angle[-1] / (2 * np.pi))
    if turns < 1:
        raise ParameterError(f"{shaft} does not turn once in this run", "shaft")
    found = order_map(run, values, shaft, turns=float(turns), window=window)
    return found.isel(turn=0, drop=True)


def order_slice(
    found: xr.DataArray, order: float, *, half_width: float | None = None
) -> xr.Dataset:
    """Amplitude along one order of an order map, against the speed of the shaft.

    Parameters
    ----------
    found
        What `order_map` returned.
    order
        The order [–].
    half_width
        Orders to either side that count as this one; two lines of the map when absent.

    Returns
    -------
    xarray.Dataset
        ``amplitude`` (turn,) with the coordinates ``speed`` [rad/s] and ``frequency`` [Hz].
    """
    half = 2.0 * float(found.attrs["resolution"]) if half_width is None else half_width
    near = found.sel(order=slice(order - half, order + half))
    if near.sizes["order"] == 0:
        top = float(found["order"][-1])
        raise ParameterError(f"order = {order}: the map reaches from 0 to {top:.4g}", "order")
    speed = found["speed"]
    frequency = order * speed / (2 * np.pi)
    frequency.attrs = {"units": "Hz", "long_name": f"frequency of order {order:g}"}
    amplitude = near.max("order")
    amplitude.attrs = {**found.attrs, "order": order}
    return xr.Dataset({"amplitude": amplitude}, coords={"frequency": frequency, "speed": speed})


def campbell(
    run: xr.Dataset,
    channel: str | xr.DataArray,
    shaft: str,
    *,
    window_time: float | None = None,
    overlap: float = 0.75,
    orders: Iterable[float] | None = None,
    modes: bool = True,
    up_to: float | None = None,
    **at: Any,
) -> xr.Dataset:
    """Campbell diagram of a run-up: frequency against speed, with orders and running modes.

    Parameters
    ----------
    run
        A run in which the speed changes, see `run_up`.
    channel
        Name of a channel, or a signal over time of one's own.
    shaft
        Sprocket or shaft whose speed is the abscissa.
    window_time
        Length of a window [s]; a fortieth of the run when absent.
    overlap
        Share of a window that the next one has in common with it, in [0, 1).
    orders
        Orders of the shaft to draw as lines; 1 and the mesh orders of its sprocket when absent.
    modes
        Whether to compute the frequencies of the running chain at five speeds.
    up_to
        Highest frequency [Hz]; half the sample rate, or 2.2 times the highest mesh frequency.
    **at
        Labels by dimension, as in `spectrum`; one signal must remain.

    Returns
    -------
    xarray.Dataset
        ``amplitude`` (time, frequency) with the coordinate ``speed`` [rad/s] of every window;
        ``order_frequency`` (order, time) [Hz]; ``mode_frequency`` (mode, mode_speed) [Hz].

    Raises
    ------
    ParameterError
        A channel is missing or holds what is not a number, or a window too few samples.
    """
    values = _single(signal(run, channel, at))
    rate = sample_rate(values)
    samples = finite(values)
    size = round((window_time or samples.size / rate / 40.0) * rate)
    if not 8 <= size <= samples.size:
        raise ParameterError(
            f"a window of {size / rate:.3g} s holds {size} of {samples.size} samples, must hold 8 "
            "or more; record more often, or give window_time",
            "window_time",
        )
    starts = _starts(samples.size, size, overlap)
    line, amplitude = _amplitudes(samples, starts, size, rate, "hann")
    middle = (starts + 0.5 * size) / rate + float(values["time"][0])
    # The mean speed of a window: the ripple within it is not what the abscissa shows.
    angle, _ = turning(run, shaft)
    begin, end = (
        np.interp(middle + half * size / rate, run["time"].to_numpy(), angle)
        for half in (-0.5, 0.5)
    )
    speed = (end - begin) * rate / size
    teeth = mesh_orders(run)
    chosen = list(orders) if orders is not None else [1.0, *_mesh_of(teeth, shaft)]
    top = up_to or min(0.5 * rate, 2.2 * max(chosen) * float(speed.max()) / (2 * np.pi))
    kept = line <= top
    found = xr.Dataset(
        {
            "amplitude": (
                ("time", "frequency"),
                amplitude[:, kept],
                {
                    "units": values.attrs.get("units", "1"),
                    "long_name": f"amplitude of {label(values)}",
                },
            ),
            "order_frequency": (
                ("order", "time"),
                np.outer(chosen, speed) / (2 * np.pi),
                {"units": "Hz", "long_name": "frequency of the order"},
            ),
        },
        coords={
            "time": ("time", middle, {"units": "s", "long_name": "time"}),
            "frequency": ("frequency", line[kept], {"units": "Hz", "long_name": "frequency"}),
            "speed": ("time", speed, {"units": "rad/s", "long_name": f"speed of {shaft}"}),
            "order": ("order", chosen, {"units": "1", "long_name": f"order of {shaft}"}),
        },
        attrs={"shaft": shaft, **_named(run, shaft)},
    )
    if not modes:
        return found
    speeds = np.linspace(float(speed.min()), float(speed.max()), 5)
    running = running_modes(drive_of(run), shaft=shaft, speeds=speeds, up_to=top)
    return found.assign(
        mode_frequency=running["frequency"].rename(speed="mode_speed"),
    )


def _named(run: xr.Dataset, shaft: str) -> dict[str, Any]:
    """Return the named orders as attributes, which survive a file; none without a scene."""
    if "resolved_scene" not in run.attrs:
        return {}
    names = order_names(run, shaft)
    return {"named_orders": list(names), "order_names": list(names.values())}


def mesh_orders(run: xr.Dataset) -> dict[str, float]:
    """Return the mesh order of every sprocket: its number of teeth."""
    drawn = at_start(drive_of(run), settled=False)["sprockets"]
    return {name: float(wheel["teeth"]) for name, wheel in drawn.items()}


def _mesh_of(teeth: dict[str, float], shaft: str) -> list[float]:
    return [teeth[shaft], 2.0 * teeth[shaft]] if shaft in teeth else []


def _single(values: xr.DataArray) -> xr.DataArray:
    if values.dims != ("time",):
        others = [str(dim) for dim in values.dims if dim != "time"]
        raise ParameterError(
            f"{values.name} has {', '.join(others)} left: name one, such as {others[0]}=…",
            others[0],
        )
    return values


def _during(run: xr.Dataset, values: xr.DataArray) -> xr.Dataset:
    """Return a run at the times of a signal, which may be one over a part of it."""
    times = values["time"].to_numpy()
    if np.array_equal(times, run["time"]):
        return run
    if not np.isin(times, run["time"]).all():
        raise ParameterError(
            f"{label(values)} has samples at times at which the run has none: orders need the "
            "angle of the shaft at each",
            "channel",
            "a signal at samples of the run",
        )
    return run.sel(time=times)


def over_angle(
    values: xr.DataArray, angle: NDArray[np.float64], density: float | None = None
) -> tuple[NDArray[np.float64], NDArray[np.float64], float]:
    """Return revolutions at equal steps, the signal there, and the samples a revolution.

    Parameters
    ----------
    values : (time,)
        The signal.
    angle : (time,)
        Angle of the shaft [rad], from zero on.
    density
        Samples a revolution; as many as the signal has where the shaft turns slowest when absent.

    Raises
    ------
    ParameterError
        The shaft stands or goes back, or the signal holds what is not a number.
    """
    samples = finite(values)
    cubic = extra("scipy.interpolate", "order maps").CubicSpline
    steps = np.diff(angle)
    if (steps <= 0.0).any():
        raise ParameterError(
            "the shaft stands or goes back: orders need one that turns on", "shaft"
        )
    if density is None:
        density = float(np.ceil(2 * np.pi / steps.min()))
        # Twenty times the samples at mean speed are enough for any run-up, and fit into memory.
        density = min(density, np.ceil(20.0 * angle.size * 2 * np.pi / angle[-1]))
    revolution = np.arange(0.0, angle[-1] / (2 * np.pi), 1.0 / density)
    return revolution, cubic(angle / (2 * np.pi), samples)(revolution), density


def _starts(samples: int, size: int, overlap: float) -> NDArray[np.int64]:
    if not 0.0 <= overlap < 1.0:
        raise ParameterError(f"overlap = {overlap}, must be in [0, 1)", "overlap")
    return np.arange(0, samples - size + 1, max(round(size * (1.0 - overlap)), 1))


def _amplitudes(
    samples: NDArray[np.float64],
    starts: NDArray[np.int64],
    size: int,
    rate: float,
    window: str,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return lines, and the amplitudes (window, line) of windows that begin at `starts`."""
    weights = extra("scipy.signal", "order maps").get_window(window, size)
    amplitude = np.empty((starts.size, size // 2 + 1))
    for row, start in enumerate(starts):
        part = samples[start : start + size]
        # A(o) = 2 |Σ w x e^(−2πi o φ)| / Σ w
        amplitude[row] = 2.0 * np.abs(np.fft.rfft(weights * (part - part.mean()))) / weights.sum()
    line = np.asarray(np.fft.rfftfreq(size, 1.0 / rate), dtype=np.float64)
    return line, amplitude
