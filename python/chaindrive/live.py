"""Drives that a program moves itself: read at any time, act on them, go back to where one was."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from chaindrive import _core
from chaindrive.channel import channels
from chaindrive.drive import Drive, _needed
from chaindrive.settings import ChannelName, MethodName, Quantity, Target

__all__ = ["Simulation", "Snapshot", "View", "step_many"]

# Dimensions whose labels are numbers; those of all others are names, even where these are digits.
_NUMBERED = ("roller", "link", "joint")

Snapshot = _core.Snapshot
"""A simulation as it was at a moment, to the last bit; see `Simulation.snapshot`.

``bytes(snapshot)`` is for a file or another process, ``Snapshot(data)`` reads it back, and `pickle`
does both. Only the version that wrote it reads it.
"""


class Simulation:
    """A drive in motion, stepped from outside: for controllers, co-simulation and notebooks.

    The method takes its own steps and what is read is interpolated between them: a run in a hundred
    pieces is the run in one, bit for bit. What is set is an event, on whose time a step lands.
    Copies and pickles go on to the last bit too. They begin anew, which takes its time.

    Parameters
    ----------
    drive
        The drive to move.
    run_in, method, step, tolerance, onset_depth, accuracy, accuracy_of
        As in `simulate`, but for one thing: method and step are chosen for an accuracy only where
        one is asked for, here or in the scene.

    Raises
    ------
    AssemblyError
        The drive does not close or settle.
    ParameterError, SceneError
        A setting out of range, or a text that is not of its dimension.

    Examples
    --------
    >>> import chaindrive as cd
    >>> simulation = cd.Simulation(cd.scenes.marine_two_sprockets())
    >>> simulation.advance_to(1e-3)
    >>> before = float(simulation["sprocket_speed"].sel(sprocket="camshaft"))
    >>> simulation.set_torque("camshaft", 2e5)
    >>> simulation.advance_to(2e-3)
    >>> float(simulation["sprocket_speed"].sel(sprocket="camshaft")) > before
    True

    A loop that looks often reads arrays that are filled wherever the drive has moved:

    >>> view = simulation.view(["span_tension", "sprocket_speed"])
    >>> speed, camshaft = view["sprocket_speed"], view.labels["sprocket_speed"].index("camshaft")
    >>> for _ in range(10):
    ...     simulation.advance(1)
    ...     simulation.set_torque("camshaft", -50.0 * speed[camshaft])
    """

    def __init__(
        self,
        drive: Drive,
        *,
        run_in: Quantity | None = None,
        method: MethodName | None = None,
        step: Quantity | None = None,
        tolerance: Quantity | None = None,
        onset_depth: Quantity | None = None,
        accuracy: Quantity | None = None,
        accuracy_of: Target | None = None,
    ) -> None:
        _needed(drive)
        given: dict[str, Any] = {
            "run_in": run_in,
            "method": method,
            "step": step,
            "tolerance": tolerance,
            "onset_depth": onset_depth,
            "accuracy": accuracy,
            "accuracy_of": accuracy_of,
        }
        settings = [(name, value) for name, value in given.items() if value is not None]
        self._inner = _core.Simulation(drive._inner, settings)
        self._name = drive.name
        self._begun = drive, given
        self._labels: dict[str, Any] = {}

    @property
    def time(self) -> float:
        """Time of the last reading [s]."""
        return self._inner.time

    def advance_to(self, time: float) -> None:
        """Move on to a time and read everything off the drive there.

        Parameters
        ----------
        time
            Time [s], not before the last reading; it may lie after the end that the scene names.

        Raises
        ------
        ParameterError
            The time is past.
        IntegrationError, SimulationError
            The motion cannot go on.
        KeyboardInterrupt
            Ctrl-C. The simulation can go on from where it is.
        """
        self._inner.advance_to(time)

    def advance(self, steps: int = 1) -> None:
        """Take steps of the method, and read at the end of the last one.

        Parameters
        ----------
        steps
            How many; each is as long as the method wants, and shorter before an event.

        Raises
        ------
        IntegrationError, SimulationError
            The motion cannot go on, or another thread moves the simulation.
        KeyboardInterrupt
            Ctrl-C. The simulation can go on from where it is.
        """
        self._inner.advance(steps)

    def view(self, channels: ChannelName | Iterable[ChannelName]) -> View:
        """Return arrays of channels that are filled wherever the simulation has moved.

        The same channels have the same arrays, as long as the simulation lives.

        Parameters
        ----------
        channels
            Names of channels; see `channels`.

        Raises
        ------
        ParameterError
            There is no channel of this name, or the drive has nothing of the kind.
        """
        names = [channels] if isinstance(channels, str) else list(channels)
        inner = self._inner.view(names)
        labels: dict[str, list[str]] = {name: self._inner.labels(name) or [] for name in names}
        return View(inner, labels)

    def __getitem__(self, channel: ChannelName) -> xr.DataArray:
        """Return a channel at the last reading: a number, or one a label; see `channels`."""
        values: Any = self._inner.channel(channel)
        about = channels()[channel]
        if channel not in self._labels:
            self._labels[channel] = self._inner.labels(channel)
        labels = self._labels[channel]
        dims = [dim for dim in about.dims if dim != "time"]
        coordinates: dict[str, Any] = {"time": self.time}
        if labels is None:
            values = values[0]
        elif dims[0] in _NUMBERED:
            coordinates[dims[0]] = np.arange(len(labels))
        else:
            coordinates[dims[0]] = labels
        chains = self._inner.chains(channel)
        if chains is not None:
            coordinates[chains[0]] = (dims[0], chains[1])
        attribute, unit = self._inner.unit(channel)
        attributes = {attribute: unit, "long_name": about.description}
        return xr.DataArray(values, coords=coordinates, dims=dims, name=channel, attrs=attributes)

    def set_torque(
        self,
        shaft: str,
        torque: float,
        *,
        over: float = 0.0,
        rate: float = 0.0,
        at: float | None = None,
    ) -> None:
        """Set a torque on a shaft, beside those of the scene; it ends a speed or an angle.

        Parameters
        ----------
        shaft
            Its name, or that of a sprocket on it; one whose motion the scene gives takes no torque.
        torque
            Torque [N m], counter-clockwise positive; it acts until another one is set.
        over
            Time in which it comes there from what it is [s]; zero for a jump.
        rate
            How it goes on from there [N m/s].
        at
            From when on [s]; from the last reading on when absent.

        Raises
        ------
        ParameterError
            No shaft or sprocket has this name, its motion is given, or the time is past.
        """
        self._inner.set("torque", shaft, (torque, over, rate), at)

    def set_speed(
        self,
        shaft: str,
        speed: float,
        *,
        over: float = 0.0,
        rate: float = 0.0,
        at: float | None = None,
    ) -> None:
        """Let an ideal drive turn a shaft at a speed; it ends torques that were set.

        The work of the drive is ``energy_driver_supplied``, that of a jump included.

        Parameters
        ----------
        shaft
            Its name, or that of a sprocket on it; with or without a motion of the scene.
        speed
            Speed [rad/s], counter-clockwise positive.
        over
            Time in which it comes there from what it is [s]; zero for a jump.
        rate
            Acceleration from there on [rad/s²].
        at
            From when on [s]; from the last reading on when absent.

        Raises
        ------
        ParameterError
            No shaft or sprocket has this name, or the time is past.
        """
        self._inner.set("speed", shaft, (speed, over, rate), at)

    def set_angle(
        self, shaft: str, angle: float, *, over: float, speed: float = 0.0, at: float | None = None
    ) -> None:
        """Let an ideal drive turn a shaft to an angle, along a cubic without a jump of speed.

        Parameters
        ----------
        shaft
            Its name, or that of a sprocket on it; with or without a motion of the scene.
        angle
            Angle [rad] as ``shaft_angle`` or, of a sprocket, ``sprocket_angle`` has it.
        over
            Time in which it comes there [s], positive.
        speed
            Speed there, at which it goes on [rad/s]; at zero it stays.
        at
            From when on [s]; from the last reading on when absent.

        Raises
        ------
        ParameterError
            No shaft or sprocket has this name, no time to come there, or the time is past.
        """
        self._inner.set("angle", shaft, (angle, over, speed), at)

    def set_force(
        self,
        tensioner: str,
        force: float,
        *,
        over: float = 0.0,
        rate: float = 0.0,
        at: float | None = None,
    ) -> None:
        """Set a force on a tensioner, beside its push.

        Parameters
        ----------
        tensioner
            Its name; one that is locked takes no force.
        force
            Force [N] along the travel of a slider, or moment [N m] on an arm; it acts until another
            one is set.
        over
            Time in which it comes there from what it is [s]; zero for a jump.
        rate
            How it goes on from there [N/s or N m/s].
        at
            From when on [s]; from the last reading on when absent.

        Raises
        ------
        ParameterError
            No tensioner has this name, it is locked, or the time is past.
        """
        self._inner.set("force", tensioner, (force, over, rate), at)

    def set_centre_force(
        self,
        sprocket: str,
        force: tuple[float, float],
        *,
        over: float = 0.0,
        rate: tuple[float, float] = (0.0, 0.0),
        at: float | None = None,
    ) -> None:
        """Set a force on the centre of a sprocket or of a roller, beside those of the scene.

        The bearing of a fixed centre bears it, a prescribed motion works against it; on springs or
        a tensioner it moves the centre, and a roller goes along with the force. Its work is
        ``forces_supplied`` of ``energy_flows``.

        Parameters
        ----------
        sprocket
            Its name; or ``tensioners.NAME``, the carrier itself, where forces of the scene act; or
            ``rollers.NUMBER``, a roller of any chain but one with ideal joints.
        force
            Along x and y [N]; it acts until another one is set.
        over
            Time in which it comes there from what it is [s]; zero for a jump.
        rate
            How it goes on from there, along x and y [N/s].
        at
            From when on [s]; from the last reading on when absent.

        Raises
        ------
        ParameterError
            No sprocket or carrier has this name, an arm has no ``force_at``, or the time is past.
        """
        for axis, to, further in zip("xy", force, rate, strict=True):
            self._inner.set(f"force_{axis}", sprocket, (to, over, further), at)

    def set_centre_acceleration(
        self,
        sprocket: str,
        acceleration: tuple[float, float],
        *,
        over: float = 0.0,
        at: float | None = None,
    ) -> None:
        """Set the acceleration of the centre of a sprocket, which goes on from where it is.

        Parameters
        ----------
        sprocket
            Its name; a centre on springs or on a tensioner moves by itself.
        acceleration
            Along x and y [m/s²], until another one is set.
        over
            Time in which it comes there from what it is [s]; zero for a jump.
        at
            From when on [s]; from the last reading on when absent.

        Raises
        ------
        ParameterError
            No sprocket has this name, its centre moves by itself, or the time is past.
        """
        x, y = acceleration
        self._inner.set("centre_x", sprocket, (x, over, 0.0), at)
        self._inner.set("centre_y", sprocket, (y, over, 0.0), at)

    def tune(self, place: str, value: float, *, at: float | None = None) -> None:
        """Change a parameter that the scene lists under ``tunable``.

        Parameters
        ----------
        place
            ``sprockets.NAME.load`` or ``shafts.NAME.load``, a factor on the loads [-];
            ``tensioners.NAME.push.preload`` [N or N m], ``tensioners.NAME.push.stiffness``
            [N/m or N m/rad] of a spring.
        value
            Its value from then on.
        at
            From when on [s]; from the last reading on when absent.

        Raises
        ------
        ParameterError
            The scene does not list it, the value is out of its range, or the time is past.
        """
        self._inner.set("parameter", place, (value, 0.0, 0.0), at)

    def snapshot(self) -> Snapshot:
        """Return the simulation as it is now, to the last bit: contacts and time stepping too."""
        return self._inner.snapshot()

    def restore(self, snapshot: Snapshot) -> None:
        """Go back, or on, to what a snapshot holds.

        Parameters
        ----------
        snapshot
            Of a simulation of the same drive, begun with the same method and step: this one,
            another one, or one in another process.

        Raises
        ------
        ParameterError
            The snapshot is of something else.
        """
        self._inner.restore(snapshot)

    def __reduce__(self) -> tuple[Callable[..., Simulation], tuple[Any, ...]]:
        return _restored, (*self._begun, self.snapshot())

    def __repr__(self) -> str:
        method, steps = self._inner.account()
        at = f"t = {self.time:.6g} s, {steps} steps by {method}"
        return f"<chaindrive.Simulation {self._name!r}: {at}>"


def _restored(drive: Drive, settings: dict[str, Any], snapshot: Snapshot) -> Simulation:
    """Return a simulation that begins anew, with its run-in, and goes on to a snapshot."""
    simulation = Simulation(drive, **settings)
    simulation.restore(snapshot)
    return simulation


class View(Mapping[str, NDArray[np.float64]]):
    """Channels of a `Simulation` by name, as arrays that stay the same while their entries change.

    Each has the shape ``(entries,)``, one entry for a number. They are written wherever the
    simulation has moved or gone back; copy what is to be kept. See `Simulation.view`.
    """

    labels: Mapping[str, list[str]]
    """Labels of the entries of every channel; empty for a number."""

    def __init__(self, inner: _core.View, labels: Mapping[str, list[str]]) -> None:
        self._inner = inner
        self._arrays = dict(zip(labels, inner.arrays, strict=True))
        self.labels = labels

    def __getitem__(self, channel: str) -> NDArray[np.float64]:
        """Return the array of a channel, always the same one."""
        return self._arrays[channel]

    def __iter__(self) -> Iterator[str]:
        return iter(self._arrays)

    def __len__(self) -> int:
        return len(self._arrays)

    def __repr__(self) -> str:
        return f"<chaindrive.View of {', '.join(self._arrays)}>"


def step_many(simulations: Iterable[Simulation], time: float) -> None:
    """Move many simulations on to a time, on all cores.

    Parameters
    ----------
    simulations
        Simulations, each once.
    time
        Time [s], not before the last reading of any of them.

    Raises
    ------
    ParameterError
        The time is past for one of them.
    IntegrationError, SimulationError
        The motion of one of them cannot go on, or another thread moves it. The others have moved.
    KeyboardInterrupt
        Ctrl-C. They can go on from where they are.
    """
    _core.step_many([simulation._inner for simulation in simulations], time)
