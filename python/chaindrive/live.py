"""Drives that a program moves itself: read at any time, act on them, go back to where one was."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import xarray as xr

from chaindrive import _core
from chaindrive.channel import channels
from chaindrive.drive import Drive, _needed
from chaindrive.settings import ChannelName, MethodName, Quantity, Target

__all__ = ["Simulation", "Snapshot"]

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
            Time [s], not before the last reading; it may lie behind the end that the scene names.

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
        elif all(label.isdecimal() for label in labels):
            coordinates[dims[0]] = np.arange(len(labels))
        else:
            coordinates[dims[0]] = labels
        chains = self._inner.chains(channel)
        if chains is not None:
            coordinates[chains[0]] = (dims[0], chains[1])
        attribute, unit = self._inner.unit(channel)
        attributes = {attribute: unit, "long_name": about.description}
        return xr.DataArray(values, coords=coordinates, dims=dims, name=channel, attrs=attributes)

    def set_torque(self, shaft: str, torque: float, *, at: float | None = None) -> None:
        """Set a torque on a shaft, beside those of the scene.

        Parameters
        ----------
        shaft
            Its name, or that of a sprocket on it; one whose motion is given takes no torque.
        torque
            Torque [N m], counter-clockwise positive; it acts until another one is set.
        at
            From when on [s]; from the last reading on when absent.

        Raises
        ------
        ParameterError
            No shaft or sprocket has this name, its motion is given, or the time is past.
        """
        self._inner.set("torque", shaft, torque, at)

    def set_force(self, tensioner: str, force: float, *, at: float | None = None) -> None:
        """Set a force on a tensioner, beside its push.

        Parameters
        ----------
        tensioner
            Its name; one that is locked takes no force.
        force
            Force [N] along the travel of a slider, or moment [N m] on an arm; it acts until another
            one is set.
        at
            From when on [s]; from the last reading on when absent.

        Raises
        ------
        ParameterError
            No tensioner has this name, it is locked, or the time is past.
        """
        self._inner.set("force", tensioner, force, at)

    def set_centre_acceleration(
        self, sprocket: str, acceleration: tuple[float, float], *, at: float | None = None
    ) -> None:
        """Set the acceleration of the centre of a sprocket, which goes on from where it is.

        Parameters
        ----------
        sprocket
            Its name; a centre on springs or on a tensioner moves by itself.
        acceleration
            Along x and y [m/s²], until another one is set.
        at
            From when on [s]; from the last reading on when absent.

        Raises
        ------
        ParameterError
            No sprocket has this name, its centre moves by itself, or the time is past.
        """
        x, y = acceleration
        self._inner.set("centre_x", sprocket, x, at)
        self._inner.set("centre_y", sprocket, y, at)

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
