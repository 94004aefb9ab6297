"""The settled chain of a drive: its modes at rest, and the equations of the places it runs past."""

from __future__ import annotations

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from chaindrive.analysis.signal import signal, turning
from chaindrive.analysis.spans import Stations, stations
from chaindrive.drive import Drive
from chaindrive.errors import ParameterError
from chaindrive.extras import extra

__all__ = ["RunningChain", "RunningState", "samples_near"]


# Modes at rest up to this many times the highest frequency asked for carry the running ones.
_BASIS = 4.0
# Samples within this share of a speed count for the tension at that speed.
_NEAR = 0.05


class RunningState:
    """Frequencies [Hz] (mode,), growth [1/s] (mode,) and shapes (mode, …) at one speed."""

    def __init__(
        self,
        frequency: NDArray[np.float64],
        growth: NDArray[np.float64],
        shapes: NDArray[np.complex128],
        share: NDArray[np.float64],
    ) -> None:
        self.frequency = frequency
        self.growth = growth
        self.shapes = shapes
        self.share = share


class RunningChain:
    """One closed chain of particles at its static state, in coordinates of the modes at rest."""

    def __init__(self, drive: Drive, run: xr.Dataset | None = None) -> None:
        scene = drive.resolved().to_dict()
        if "chain" not in scene or scene["chain"].get("model", "particles") != "particles":
            raise ParameterError(
                "running modes are found of one closed chain of particles", "chain.model"
            )
        self.mass = float(scene["chain"]["mass"])
        self.places: Stations = stations(drive if run is None else run)
        self.pitch = self.places.pitch
        self.teeth = {name: int(wheel["teeth"]) for name, wheel in self.places.sprockets.items()}
        self._axles = {
            str(shaft["name"]): [str(it) for it in shaft["sprockets"]]
            for shaft in scene.get("shafts", [])
        }
        rest = drive.modes()
        self._rest = rest
        self._square = (
            np.sign(rest["frequency"].to_numpy()) * (2 * np.pi * rest["frequency"].to_numpy()) ** 2
        )
        shapes = [rest[name].transpose("mode", "roller").to_numpy() for name in _AXES]
        self._shapes = np.stack(shapes)
        static = drive.statics()["link_tension"]
        self._static: NDArray[np.float64] = static.isel(stage=-1).to_numpy()
        links = np.roll(self.places.rollers, -1, axis=0) - self.places.rollers
        self._length = np.hypot(*links.T)
        # Between two tangent points lie L / p links in the mean, and not the whole number of the
        # instant that is looked at: the places of a span stand h = L / n apart.
        self._spacing = np.full(len(links), self.pitch)
        for name in self.places.spans:
            first, count = self.places.begin[name], self.places.links[name]
            within = np.arange(first, first + count) % len(links)
            self._spacing[within] = self.places.length(name) / count
        self._tangent = links / self._length[:, None]
        self._stiffness = float(scene["chain"]["stiffness"])

    def speed(self, shaft: str, speed: float) -> float:
        """Return the speed of the chain [m/s] at a speed of a sprocket or its shaft [rad/s]."""
        names = [shaft] if shaft in self.teeth else self._axles.get(shaft, [])
        if not names:
            raise ParameterError(f"{shaft!r} has no sprocket under the chain", "shaft")
        # v = z p ω / 2π
        return self.teeth[names[0]] * self.pitch * speed / (2 * np.pi)

    def gained_tension(self, v: float) -> NDArray[np.float64]:
        """Return by how much links are tenser at a chain speed than at rest [N], (link,).

        Centrifugal forces, −m v² (r_{j+1} − 2 r_j + r_{j−1}) / p², on the drive at rest.
        """
        r = self.places.rollers
        bend = np.roll(r, -1, axis=0) - 2.0 * r + np.roll(r, 1, axis=0)
        force = -self.mass * (v / self.pitch) ** 2 * bend
        # δq = Φ Λ⁻¹ Φᵀ F; what nothing holds, nothing stretches
        modal = np.einsum("amj,ja->m", self._shapes, force)
        held = self._square > 1e-9 * self._square.max()
        shift = np.einsum("m,amj->ja", modal[held] / self._square[held], self._shapes[:, held])
        stretch = np.sum((np.roll(shift, -1, axis=0) - shift) * self._tangent, axis=1)
        gain: NDArray[np.float64] = self._stiffness * stretch
        return gain

    def recorded_tension(self, run: xr.Dataset, shaft: str, speed: float) -> NDArray[np.float64]:
        """Return the mean tension at every place [N], (link,), of a run near a speed of a shaft."""
        near = samples_near(run, shaft, speed)
        name = shaft if shaft in self.teeth else self._axles[shaft][0]
        angle = signal(run, "sprocket_angle", {"sprocket": name}).to_numpy()
        tension = signal(run, "link_tension", {}).transpose("time", "link").to_numpy()
        # Angles count from where the drive was assembled, before it was run in.
        passed = self.places.sense(name) * angle * self.teeth[name] / (2 * np.pi)
        tension, passed = tension[near], passed[near]
        # The link at place j at time t is the one that started at j − passed.
        count = tension.shape[1]
        at = (np.arange(count) - passed[:, None]) % count
        low = np.floor(at).astype(int)
        part = at - low
        row = np.arange(len(tension))[:, None]
        low %= count
        met = (1.0 - part) * tension[row, low] + part * tension[row, (low + 1) % count]
        mean: NDArray[np.float64] = met.mean(axis=0)
        return mean

    def modes(self, v: float, up_to: float, tension: NDArray[np.float64] | None) -> RunningState:
        """Return the modes at a chain speed [m/s] below a frequency [Hz].

        `tension` is that of the links when the chain runs, by centrifugal forces when absent.
        """
        linalg = extra("scipy.linalg", "modes of running chains")
        kept = self._square < (2 * np.pi * _BASIS * up_to) ** 2
        shapes, count = self._shapes[:, kept], int(np.count_nonzero(kept))
        gain = self.gained_tension(v) if tension is None else tension - self._static
        step = np.roll(shapes, -1, axis=2) - shapes
        # G = ½ ρ (u_{j+1} − u_{j−1}),   H = ρ ((u_{j+1} − u_j) / h_j − (u_j − u_{j−1}) / h_{j−1})
        density = self.mass / self.pitch
        coriolis = 0.5 * density * np.einsum("amj,anj->mn", shapes, step + np.roll(step, 1, axis=2))
        centrifugal = -density * np.einsum("amj,anj,j->mn", step, step, 1.0 / self._spacing)
        # ΔK = (T / h − T₀ / ℓ) n nᵀ, link by link, on the difference of its ends
        normal = np.stack([-self._tangent[:, 1], self._tangent[:, 0]])
        turn = np.einsum("amj,aj->mj", step, normal)
        change = (self._static + gain) / self._spacing - self._static / self._length
        tight = np.einsum("mj,nj,j->mn", turn, turn, change)
        # ΔM = ρ ½ (h_{j−1} + h_j) − m, place by place
        heavier = 0.5 * density * (self._spacing + np.roll(self._spacing, 1)) - self.mass
        mass = np.eye(count) + np.einsum("amj,anj,j->mn", shapes, shapes, heavier)
        stiffness = np.diag(self._square[kept]) + tight + v * v * centrifugal
        # q̇ = w,   (M + ΔM) ẇ = −(K + ΔK + v² H) q − 2 v G w
        rates = -linalg.solve(mass, np.hstack([stiffness, 2.0 * v * coriolis]), assume_a="pos")
        first_order = np.vstack([np.eye(count, 2 * count, count), rates])
        values, vectors = linalg.eig(first_order)
        frequency = values.imag / (2 * np.pi)
        chosen = np.flatnonzero((frequency > 1e-6 * up_to) & (frequency <= up_to))
        chosen = chosen[np.argsort(frequency[chosen])]
        weights = vectors[:count, chosen].T
        found = np.einsum("km,amj->kaj", weights, shapes)
        # Kinetic energy: 1 of a mode at rest, of which the chain has m Σ |u|².
        energy = self.mass * np.sum(np.abs(found) ** 2, axis=1)
        whole = np.sum(np.abs(weights) ** 2, axis=1)[:, None]
        parts = [energy[:, self.places.free(name)].sum(axis=1) for name in self.places.spans]
        share = np.stack([*parts, energy.sum(axis=1) - sum(parts)], axis=1) / whole
        share = np.column_stack([share, 1.0 - share.sum(axis=1)])
        found /= np.sqrt(whole)[:, :, None]
        return RunningState(frequency[chosen], values.real[chosen], found, share)


_AXES = ("roller_x", "roller_y")


def samples_near(run: xr.Dataset, shaft: str, speed: float | None) -> NDArray[np.bool_]:
    """Return which samples count for a speed of a shaft [rad/s]: all where none is given."""
    _, then = turning(run, shaft)
    if speed is None:
        return np.ones(then.size, dtype=bool)
    near: NDArray[np.bool_] = np.abs(then - speed) <= _NEAR * speed
    if not near.any():
        raise ParameterError(
            f"{shaft} does not turn at {speed:.4g} rad/s in this run, but from {then.min():.4g} to "
            f"{then.max():.4g}",
            "speed",
        )
    return near
