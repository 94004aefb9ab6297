"""Frequencies of the running chain: moving strings, and the whole drive."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from chaindrive.analysis.ramps import prescribed
from chaindrive.analysis.running_chain import RunningChain, RunningState, samples_near
from chaindrive.analysis.signal import recorded, signal, turning
from chaindrive.analysis.spans import span_lines
from chaindrive.drive import Drive
from chaindrive.errors import ParameterError
from chaindrive.pose import drive_of

__all__ = ["critical_speeds", "moving_string", "running_modes", "span_frequencies"]


def moving_string(
    tension: ArrayLike, mass_per_length: float, length: ArrayLike, speed: ArrayLike, mode: int = 1
) -> NDArray[np.float64]:
    """Natural frequency of a string that runs between two fixed points.

    ``f_n = n (c² − v²) / (2 L c)``, ``c² = T / ρ``

    Parameters
    ----------
    tension
        Tension T, its centrifugal part ρ v² included [N].
    mass_per_length
        Mass per length ρ [kg/m].
    length
        Distance of the points L [m].
    speed
        Speed of the string v [m/s].
    mode
        Number of half waves n.

    Returns
    -------
    numpy.ndarray
        Frequency [Hz]; zero from the speed on at which v = c.

    References
    ----------
    R. Skutsch, *Ueber die Bewegung eines gespannten Fadens*, Annalen der Physik und Chemie
    **297**, 1897, 190–195; R. A. Sack, *Br. J. Appl. Phys.* **5**, 1954, 224–226.
    """
    c = np.sqrt(np.asarray(tension, dtype=float) / mass_per_length)
    v = np.asarray(speed, dtype=float)
    # f_n = n (c² − v²) / (2 L c)
    found: NDArray[np.float64] = np.maximum(
        mode * (c * c - v * v) / (2.0 * np.asarray(length) * c), 0.0
    )
    return found


def span_frequencies(
    run: xr.Dataset, *, modes: int = 3, shaft: str | None = None, speed: float | None = None
) -> xr.Dataset:
    """Natural frequencies of the spans of a run as moving strings, see `moving_string`.

    The tension is the mean one of the run, its centrifugal part included. Guides count as ends.
    What couples the spans with each other and with the wheels is left out: see `running_modes`.

    Parameters
    ----------
    run
        A run with ``span_tension`` and ``sprocket_angle``.
    modes
        How many half waves at most.
    shaft
        Sprocket whose speed is meant; the one whose motion is given when absent.
    speed
        Speed of it at which to look [rad/s], in a run-up: samples within 5 % of it count. All
        when absent.

    Returns
    -------
    xarray.Dataset
        ``frequency`` (span, half_waves) [Hz]; ``tension`` [N] and ``length`` [m] (span,); the
        attribute ``chain_speed`` [m/s].
    """
    drive = drive_of(run)
    shaft = shaft or prescribed(drive, None)[1]
    near = samples_near(run, shaft, speed)
    chain = RunningChain(drive, run)
    strands = signal(run, "span_tension", {}).isel(time=near).mean("time").to_numpy()
    # A strand over a guide is one span to the run, and several to the eye.
    tension = strands[[chain.places.strand(name) for name in chain.places.spans]]
    v = chain.speed(shaft, float(turning(run, shaft)[1][near].mean()))
    lines = span_lines(run)
    waves = np.arange(1, modes + 1)
    frequency = [
        moving_string(tension, chain.mass / chain.pitch, lines["length"], v, int(n)) for n in waves
    ]
    return xr.Dataset(
        {
            "frequency": (
                ("half_waves", "span"),
                np.array(frequency),
                {"units": "Hz", "long_name": "frequency of the moving string"},
            ),
            "tension": ("span", tension, {"units": "N", "long_name": "mean tension"}),
            "length": lines["length"],
        },
        coords={"span": lines["span"], "half_waves": waves},
        attrs={"chain_speed": v, "shaft": shaft},
    ).transpose("span", "half_waves")


def running_modes(
    source: Drive | xr.Dataset,
    *,
    shaft: str | None = None,
    speeds: float | Iterable[float] | None = None,
    up_to: float | None = None,
) -> xr.Dataset:
    """Natural frequencies and modes of a drive while its chain runs.

    ``M q̈ + 2 v G q̇ + (K + ΔK + v² H) q = 0``, with ``G = m (u_{j+1} − u_{j−1}) / 2p`` and
    ``H = m (u_{j+1} − 2 u_j + u_{j−1}) / p²``

    Looked at are the places that the rollers pass: there a roller has the acceleration
    u_tt + 2 v u_ts + v² u_ss, Coriolis and centrifugal terms included. K is the stiffness of the
    drive at rest with its teeth, guides, wheels and tensioners (`Drive.modes`), ΔK what the
    tension changes in it when the chain runs: of a drive, by what centrifugal forces stretch and
    its tensioner takes up; of a run with ``link_tension`` and ``sprocket_angle``, by the mean
    tension that was recorded at every place. Damping and friction are left out, and so is that the
    free length of a span changes by a pitch with every tooth: look upon the result as a mean.

    Parameters
    ----------
    source
        A drive with one closed chain of particles, or a run of it.
    shaft
        Sprocket or shaft with a sprocket whose speed is meant; the one whose motion is given when
        absent.
    speeds
        Speeds [rad/s]; that of the drive, or the mean of the run, when absent.
    up_to
        Highest frequency [Hz]; twice the mesh frequency at the highest speed when absent.

    Returns
    -------
    xarray.Dataset
        ``frequency`` (speed, mode) [Hz] ascending, NaN where there are fewer; ``growth`` [1/s],
        positive where the motion grows; ``share`` (speed, mode, part) [–] of the kinetic energy of
        the chain in every span and on the wheels, and of wheels and tensioners; ``roller_x`` and
        ``roller_y`` (speed, mode, roller), complex shapes; ``chain_speed`` (speed) [m/s].

    Raises
    ------
    ParameterError
        The chain is not one closed chain of particles, or no motion is given.
    AssemblyError
        The drive does not close or settle.

    References
    ----------
    J. A. Wickert and C. D. Mote, *J. Appl. Mech.* **57**, 1990, 738–744,
    <https://doi.org/10.1115/1.2897085>.
    """
    run = source if isinstance(source, xr.Dataset) else None
    drive = drive_of(source) if isinstance(source, xr.Dataset) else source
    shaft = shaft or prescribed(drive, None)[1]
    chain = RunningChain(drive, run)
    asked = _speeds(drive, run, shaft, speeds)
    fastest = chain.speed(shaft, float(asked.max()))
    top = up_to if up_to is not None else 2.0 * max(fastest / chain.pitch, 1.0)
    if run is not None:
        recorded(run, "link_tension", "sprocket_angle")
    solved = [
        chain.modes(
            chain.speed(shaft, float(speed)),
            top,
            None if run is None else chain.recorded_tension(run, shaft, float(speed)),
        )
        for speed in asked
    ]
    return _labelled(chain, shaft, asked, solved)


def critical_speeds(modes: xr.Dataset, order: float) -> xr.Dataset:
    """Speeds at which an order meets the modes of a running drive.

    Where ``order ω / 2π = f(ω)``, f interpolated between the speeds of the modes.

    Parameters
    ----------
    modes
        What `running_modes` returned, of several ascending speeds.
    order
        The order of its shaft [–]; teeth for the mesh.

    Returns
    -------
    xarray.Dataset
        ``speed`` [rad/s], ``frequency`` [Hz], ``part``, where most of the energy of the mode is,
        and its ``share`` [–], (crossing,), in the order of the speed.
    """
    speed = modes["speed"].to_numpy()
    frequency = modes["frequency"].transpose("speed", "mode").to_numpy()
    share = modes["share"].transpose("speed", "mode", "part").to_numpy()
    ahead = frequency - order * speed[:, None] / (2 * np.pi)
    found = []
    for i, k in np.argwhere((ahead[:-1] > 0.0) & (ahead[1:] <= 0.0)):
        at = ahead[i, k] / (ahead[i, k] - ahead[i + 1, k])
        main = int(share[i, k].argmax())
        where = float(speed[i] + at * (speed[i + 1] - speed[i]))
        found.append((where, order * where / (2 * np.pi), main, float(share[i, k, main])))
    found.sort()
    speeds, hertz, parts, shares = np.array(found).T if found else np.empty((4, 0))
    label = f"speed of {modes.attrs['shaft']}"
    return xr.Dataset(
        {
            "speed": ("crossing", speeds, {"units": "rad/s", "long_name": label}),
            "frequency": ("crossing", hertz, {"units": "Hz", "long_name": "frequency"}),
            "part": ("crossing", modes["part"].to_numpy()[parts.astype(int)]),
            "share": ("crossing", shares, {"units": "1", "long_name": "share of its energy"}),
        },
        attrs={"shaft": modes.attrs["shaft"], "order": order},
    )


def _labelled(
    chain: RunningChain, shaft: str, speeds: NDArray[np.float64], solved: list[RunningState]
) -> xr.Dataset:
    most = max(len(state.frequency) for state in solved)
    rollers = len(chain.places.rollers)

    def stacked(name: str, *shape: int) -> NDArray[np.float64]:
        rows = np.full((len(solved), most, *shape), np.nan)
        for row, state in zip(rows, solved, strict=True):
            values = getattr(state, name)
            row[: len(values)] = values
        return rows

    shapes = np.full((2, len(solved), most, rollers), np.nan, dtype=complex)
    for i, state in enumerate(solved):
        shapes[:, i, : len(state.frequency)] = np.moveaxis(state.shapes, 1, 0)
    parts = [*chain.places.spans, "on wheels and guides", "wheels and tensioners"]
    hertz = {"units": "Hz", "long_name": "frequency of the running drive"}
    shape = {"units": "m/kg^0.5", "long_name": "mode shape"}
    ways = [chain.speed(shaft, float(speed)) for speed in speeds]
    return xr.Dataset(
        {
            "frequency": (("speed", "mode"), stacked("frequency"), hertz),
            "growth": (
                ("speed", "mode"),
                stacked("growth"),
                {"units": "1/s", "long_name": "growth"},
            ),
            "share": (
                ("speed", "mode", "part"),
                stacked("share", len(parts)),
                {"units": "1", "long_name": "share of the kinetic energy"},
            ),
            "roller_x": (("speed", "mode", "roller"), shapes[0], shape),
            "roller_y": (("speed", "mode", "roller"), shapes[1], shape),
            "chain_speed": ("speed", ways, {"units": "m/s", "long_name": "speed of the chain"}),
        },
        coords={
            "speed": ("speed", speeds, {"units": "rad/s", "long_name": f"speed of {shaft}"}),
            "mode": np.arange(most),
            "part": np.asarray(parts, dtype=np.str_),
            "roller": np.arange(rollers),
        },
        attrs={"shaft": shaft},
    )


def _speeds(
    drive: Drive, run: xr.Dataset | None, shaft: str, speeds: float | Iterable[float] | None
) -> NDArray[np.float64]:
    if speeds is not None:
        asked = np.atleast_1d(np.asarray(speeds, dtype=float))
        if (asked < 0.0).any() or asked.size == 0:
            raise ParameterError(f"speeds = {speeds}, must not be negative [rad/s]", "speeds")
        return asked
    if run is not None:
        angle, _ = turning(run, shaft)
        return np.array([angle[-1] / float(run["time"][-1] - run["time"][0])])
    motion = prescribed(drive, shaft)[2]
    if "speed" not in motion:
        raise ParameterError(f"the motion of {shaft} has no one speed: give `speeds`", "speeds")
    return np.array([abs(float(motion["speed"]))])
