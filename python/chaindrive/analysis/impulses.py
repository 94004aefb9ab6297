"""Spectra of the impulses with which rollers strike sprockets, and their level re another run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from chaindrive.analysis.parts import SprocketParts, sprockets
from chaindrive.analysis.seating import striking
from chaindrive.analysis.signal import late, recorded, require, turning
from chaindrive.errors import ParameterError
from chaindrive.extras import extra

__all__ = ["impulse_level", "impulse_spectrum"]

_Floats = NDArray[np.float64]

#: Multiples of the mesh up to which a spectrum reaches unless somebody asks for more.
_UP_TO = 8.5
#: Of the interval of a level.
_CONFIDENCE = 0.95


def impulse_spectrum(
    run: xr.Dataset,
    *,
    blocks: int = 8,
    meshes: int | None = None,
    up_to: float = _UP_TO,
    after: float = 0.0,
    mass: float | None = None,
) -> xr.Dataset:
    """Return order spectra of the impulses with which contacts on each sprocket begin.

    Every contact of a roller with a tooth, bounces too, is an impulse at the instant of its touch,
    at the angle φ of the sprocket with z teeth. The run is cut into blocks of whole mesh periods:

    ::

        J = (1 + e) m v,    F(o) = Σ J e^(−i o z φ)
        A(o) = 2 |F(o)| / T,    S(o) = 2 |F(o)|² / T

    o is the order of the mesh, T the time of a block. A periodic train of impulses J at intervals
    T₀ has lines of height 2J/T₀ at its multiples; a random one (Poisson) of the rate λ has the
    flat density 2λJ² (Campbell's theorem), and trains whose intervals scatter come near to 2λ⟨J²⟩
    at high orders, the variable ``broadband``.

    Forces that contacts bear while they last are left out: the impulse that is logged of a roller
    that stays is its load times the time of its wrap, and no blow. So is the length of a blow:
    above the inverse of twice that, lines of a force would be lower. e is that of the scene, and of
    no loss where a film of oil or viscous damping takes its place.

    Parameters
    ----------
    run
        A run with ``events="teeth"`` and the channel ``sprocket_angle``.
    blocks
        Into how many blocks the run is cut, 2 or more; what is left at its end is left out.
    meshes
        Mesh periods a block; as many as the run has for `blocks` when absent, and then those
        blocks that the run has count.
    up_to
        Highest order of the mesh [–].
    after
        Time up to which contacts are left out [s].
    mass
        Mass m that strikes [kg], see `impacts`.

    Returns
    -------
    xarray.Dataset
        ``amplitude`` [N], the root of the mean of A² over the blocks, and ``density`` [N²/Hz], the
        mean of S, both (sprocket, order); ``broadband`` [N²/Hz], ``rate`` [Hz] of contacts and
        ``mesh_frequency`` [Hz], (sprocket,). Attributes ``blocks`` and ``meshes``, of a block.

    Raises
    ------
    ParameterError
        No contacts were logged, a sprocket stands or goes back, or the run is too short.

    References
    ----------
    S. O. Rice, *Mathematical analysis of random noise*, Bell System Technical Journal 23(3), 1944,
    282–332: shot effect, Campbell's theorem and the spectrum of a Poisson train.

    Examples
    --------
    >>> import chaindrive as cd
    >>> run = cd.simulate(cd.scenes.industrial_16b(), until=0.1, events="teeth", error=False)
    >>> cd.analysis.impulse_spectrum(run, blocks=4)["amplitude"].dims
    ('sprocket', 'order')
    """
    trains = _trains(run, after, mass)
    meshes, blocks = _cut(trains, blocks, meshes)
    line = np.arange(1, int(up_to * meshes + 1e-9) + 1)
    if line.size == 0:
        raise ParameterError(f"up_to = {up_to}: the first order is {1 / meshes:.3g}", "up_to")
    squares, seconds, energies, counts = (
        np.array(it)
        for it in zip(*(train.blocks(line, meshes, blocks) for train in trains), strict=True)
    )
    # A = 2 |F| / T,  S = 2 |F|² / T
    amplitude = np.sqrt((4.0 * squares / seconds[..., None] ** 2).mean(axis=1))
    density = (2.0 * squares / seconds[..., None]).mean(axis=1)
    whole = seconds.sum(axis=1)
    over = _averaging(blocks, meshes)
    return xr.Dataset(
        {
            "amplitude": (
                ("sprocket", "order"),
                amplitude,
                {"units": "N", "long_name": f"amplitude of impulses, rms of {over}"},
            ),
            "density": (
                ("sprocket", "order"),
                density,
                {"units": "N²/Hz", "long_name": f"density of impulses, mean of {over}"},
            ),
            "broadband": (
                "sprocket",
                2.0 * energies.sum(axis=1) / whole,
                {"units": "N²/Hz", "long_name": "density of impulses at high orders"},
            ),
            "rate": (
                "sprocket",
                counts.sum(axis=1) / whole,
                {"units": "Hz", "long_name": "contacts a second"},
            ),
            "mesh_frequency": (
                "sprocket",
                meshes * blocks / whole,
                {"units": "Hz", "long_name": "mesh frequency"},
            ),
        },
        coords={
            "sprocket": np.array([it.name for it in trains], dtype=np.str_),
            "order": ("order", line / meshes, {"units": "1", "long_name": "order of the mesh"}),
        },
        attrs={"blocks": blocks, "meshes": meshes},
    )


def impulse_level(
    run: xr.Dataset,
    reference: xr.Dataset,
    *,
    name: str = "reference run",
    orders: tuple[float, ...] = (1.0, 2.0, 3.0),
    half_width: float = 0.25,
    blocks: int = 8,
    after: float = 0.0,
    mass: float | None = None,
) -> xr.Dataset:
    """Return by how much the impulses of a run at mesh orders are above those of another.

    ::

        P = ⟨Σ A(o)² / 2⟩,    L = 10 log₁₀(P / P₀)

    summed over the band of orders o around a mesh order, in the mean over blocks, see
    `impulse_spectrum`; 6.02 dB are twice the impulse. It compares the excitation of two drives.
    What is heard is another matter: structure and air stand between, and no level here is a sound
    pressure. Runs of several speeds or tooth counts are compared at the mesh of each.

    Parameters
    ----------
    run, reference
        Runs with ``events="teeth"`` and ``sprocket_angle``, their sprockets of the same names.
        Blocks have as many mesh periods in both.
    name
        What the reference is; part of the names of all levels.
    orders
        Orders of the mesh [–].
    half_width
        Half width of each band, in orders of the mesh [–]; lines at its ends count.
    blocks, after, mass
        As in `impulse_spectrum`, of both runs.

    Returns
    -------
    xarray.Dataset
        ``level``, ``low`` and ``high`` [dB] (sprocket, order), the latter two the ends of its 95 %
        interval by blocks (Student, jackknife of the logarithm), and ``broadband_level``
        (sprocket,) of the density at high orders. ``long_name`` of each tells reference, band and
        averaging. NaN where neither run or only the reference has no impulses.

    Raises
    ------
    ParameterError
        As in `impulse_spectrum`; or the runs have other sprockets, or a band holds no line.

    Examples
    --------
    >>> import chaindrive as cd
    >>> drive = cd.scenes.industrial_16b()
    >>> runs = [cd.simulate(drive, until=0.1, events="teeth", error=False) for _ in range(2)]
    >>> level = cd.analysis.impulse_level(*runs, name="itself", blocks=4)["level"]
    >>> level.attrs["long_name"][:46]
    'impulse level at mesh orders 1, 2, 3 re itself'
    """
    both = [_trains(it, after, mass) for it in (run, reference)]
    names, known = ([it.name for it in trains] for trains in both)
    if names != known:
        raise ParameterError(
            f"the run has the sprockets {', '.join(names)}, the reference {', '.join(known)}",
            "reference",
        )
    meshes, _ = _cut([it for trains in both for it in trains], blocks, None)
    line = np.arange(1, int((max(orders) + half_width) * meshes + 1e-9) + 1)
    near = [np.abs(line / meshes - order) <= half_width + 1e-9 for order in orders]
    for order, band in zip(orders, near, strict=True):
        if not band.any():
            raise ParameterError(
                f"half_width = {half_width}: the band of order {order:g} holds no line; they "
                f"stand {1 / meshes:.3g} apart",
                "half_width",
            )
    powers, densities = [], []
    for trains in both:
        rows = [train.blocks(line, meshes, blocks) for train in trains]
        # P = Σ A² / 2, in every block
        power = [2.0 * squares / seconds[:, None] ** 2 for squares, seconds, *_ in rows]
        powers.append(np.array([[it[:, band].sum(axis=1) for band in near] for it in power]))
        densities.append(np.array([2.0 * row[2].sum() / row[1].sum() for row in rows]))
    with np.errstate(divide="ignore", invalid="ignore"):
        level = _decibels(powers[0].mean(axis=-1) / powers[1].mean(axis=-1))
        broadband = _decibels(densities[0] / densities[1])
        scatter = np.hypot(*(_jackknife(it) for it in powers))
    student = extra("scipy.special", "intervals of levels").stdtrit
    half = scatter * float(student(blocks - 1, 0.5 + _CONFIDENCE / 2))
    listed = ", ".join(f"{it:g}" for it in orders)
    plural = "s" if len(orders) > 1 else ""
    told = f"at mesh order{plural} {listed} re {name}, band ± {half_width:g} mesh orders"
    told += f", mean over {_averaging(blocks, meshes)}"

    def values(what: str, of: _Floats) -> tuple[Any, ...]:
        return ("sprocket", "order"), of, {"units": "dB", "long_name": f"{what} {told}"}

    end = f"end of the {_CONFIDENCE:.0%} interval of the impulse level"
    return xr.Dataset(
        {
            "level": values("impulse level", level),
            "low": values(f"lower {end}", level - half),
            "high": values(f"upper {end}", level + half),
            "broadband_level": (
                "sprocket",
                broadband,
                {
                    "units": "dB",
                    "long_name": f"impulse level re {name}, density at high orders, "
                    f"mean over {blocks * meshes} mesh periods",
                },
            ),
        },
        coords={
            "sprocket": np.array(names, dtype=np.str_),
            "order": ("order", list(orders), {"units": "1", "long_name": "order of the mesh"}),
        },
        attrs={"reference": name, "blocks": blocks, "meshes": meshes, "half_width": half_width},
    )


@dataclass(frozen=True)
class _Train:
    """The impulses on one sprocket."""

    name: str
    phase: _Floats
    """Where each contact began, in mesh periods of the sprocket."""
    impulse: _Floats
    """[N s]"""
    turned: _Floats
    """What the sprocket has turned by at every sample, in mesh periods."""
    time: _Floats
    """Of the samples [s]."""

    def blocks(self, line: NDArray[np.int_], meshes: int, count: int) -> tuple[_Floats, ...]:
        """Return |F|² (block, line) [N² s²], T [s], ΣJ² [N² s²] and contacts, each (block,)."""
        edges = np.interp(np.arange(count + 1) * float(meshes), self.turned, self.time)
        block = np.floor(self.phase / meshes).astype(int)
        squares, energies, counts = np.zeros((count, line.size)), np.zeros(count), np.zeros(count)
        for number in range(count):
            mine = block == number
            impulse, within = self.impulse[mine], self.phase[mine] / meshes - number
            # F(o) = Σ J e^(−i o z φ), φ from the beginning of the block on: lines are whole there.
            turns = np.exp(-2j * np.pi * np.outer(line, within))
            squares[number] = np.abs((turns * impulse).sum(axis=1)) ** 2
            energies[number] = impulse @ impulse
            counts[number] = impulse.size
        return squares, np.diff(edges), energies, counts


def _trains(run: xr.Dataset, after: float, mass: float | None) -> list[_Train]:
    """Return the impulses on every sprocket that a chain runs over."""
    if "event_kind" not in run:
        raise ParameterError("no contacts were logged: simulate(…, events='teeth')", "events")
    recorded(run, "sprocket_angle")
    require(run, "sprocket")
    part = late(run, after)
    return [_train(run, part, wheel, mass) for wheel in sprockets(run).values()]


def _train(run: xr.Dataset, part: xr.Dataset, wheel: SprocketParts, mass: float | None) -> _Train:
    time = part["time"].to_numpy().astype(float)
    angle, _ = turning(part, wheel.name)
    if (np.diff(angle) <= 0.0).any():
        raise ParameterError(
            f"{wheel.name} stands or goes back: orders need a sprocket that turns on", "sprocket"
        )
    turned = angle * wheel.teeth / (2 * np.pi)
    begun = run["event_start"].to_numpy()
    of = (run["event_kind"].to_numpy() == "tooth") & (run["event_body"].to_numpy() == wheel.name)
    # A contact that is closed when the record begins has no onset in it.
    mine = of & (begun > time[0]) & (begun <= time[-1])
    speed = run["event_onset_speed"].to_numpy()[mine]
    restitution = 1.0 if wheel.restitution is None else wheel.restitution
    # J = (1 + e) m v
    impulse = (1.0 + restitution) * striking(wheel.chain, mass) * speed
    phase = np.interp(begun[mine], time, turned)
    # The order in which contacts were logged is that in which they ended: it must not matter.
    order = np.argsort(phase, kind="stable")
    return _Train(wheel.name, phase[order], impulse[order], turned, time)


def _cut(trains: list[_Train], blocks: int, meshes: int | None) -> tuple[int, int]:
    """Return mesh periods a block, and how many blocks there are."""
    if not trains:
        raise ParameterError("no chain of this drive runs over a sprocket", "sprocket")
    if blocks < 2:
        raise ParameterError(f"blocks = {blocks}, must be 2 or more", "blocks")
    shortest = min(trains, key=lambda it: it.turned[-1])
    # What misses a mesh period by rounding is a whole one.
    held = int(shortest.turned[-1] + 1e-9)
    if meshes is None:
        meshes = held // blocks
    elif meshes >= 1:
        blocks = held // meshes
    if meshes < 1 or blocks < 2:
        raise ParameterError(
            f"{held} teeth of {shortest.name} came into mesh, too few for {max(blocks, 2)} blocks: "
            "simulate longer, or ask for fewer or shorter blocks",
            "blocks",
        )
    return meshes, blocks


def _averaging(blocks: int, meshes: int) -> str:
    return f"{blocks} blocks of {meshes} mesh period{'s' if meshes > 1 else ''}"


def _decibels(ratio: _Floats) -> _Floats:
    return np.asarray(10.0 * np.log10(ratio))


def _jackknife(power: _Floats) -> _Floats:
    """Return the standard error of the level of a mean over blocks [dB], (…,) of (…, block)."""
    count = power.shape[-1]
    without = _decibels((power.sum(axis=-1, keepdims=True) - power) / (count - 1))
    about = without - without.mean(axis=-1, keepdims=True)
    return np.asarray(np.sqrt((count - 1) / count * (about**2).sum(axis=-1)))
