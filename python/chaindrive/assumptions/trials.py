"""Variants of a drive, each begun at several phases of its chain: replicates, and their store."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from chaindrive import _core
from chaindrive.assumptions.outputs import Given, outputs_of, read_off
from chaindrive.drive import Drive
from chaindrive.errors import ParameterError, SimulationError
from chaindrive.measurement.evaluations import RunStore
from chaindrive.measurement.sensitivities import starts
from chaindrive.sweeping import sweep

__all__ = ["PHASES", "Trials"]

_Floats = NDArray[np.float64]

#: Phases of the chain at the start of replicates [pitches]; they do not divide a pitch evenly.
PHASES = (0.0, 0.34, 0.67)


class Trials:
    """Outputs of variants, read off replicates that differ by the phase of the chain alone."""

    def __init__(
        self,
        drive: Drive,
        outputs: Given,
        phases: Sequence[float],
        settings: Mapping[str, Any],
        store: RunStore,
        jobs: int | None,
        tell: Callable[[float], object] | None,
        count: int,
    ) -> None:
        """Prepare trials.

        Parameters
        ----------
        drive
            The drive; one without a phase has one replicate.
        outputs, settings, jobs
            As `outputs_of` and `sweep` take them.
        phases
            Phases [pitches].
        store
            Where runs are kept under the text of their scene.
        tell
            Told the share that is done.
        count
            Variants that there will be, for that share.
        """
        self.outputs = outputs_of(outputs)
        self.units: list[str] = []
        """Units of the outputs, known after the first variant."""
        if not phases or len(set(phases)) < len(phases):
            message = f"phases = {list(phases)}: this is no list of different phases"
            raise ParameterError(message, "phases", "such as (0.0, 0.34, 0.67)")
        has_phase = any(starts(drive))
        self.phases = [float(it) for it in phases] if has_phase else [0.0]
        # A drive without a phase varies what changes nothing: the title.
        self._vary = {"route.phase": self.phases} if has_phase else {"title": ["replicate"]}
        self._settings = {key: it for key, it in settings.items() if it is not None}
        self._store, self._jobs, self._tell = store, jobs, tell
        self._done, self._count = 0, count

    def of(self, drive: Drive, name: str, **more: Any) -> _Floats:
        """Return the outputs of a variant (replicates, outputs).

        Parameters
        ----------
        drive
            The variant.
        name
            Its name, for the error.
        **more
            Settings of this one.

        Raises
        ------
        SimulationError
            A replicate cannot be simulated.
        """
        settings = self._settings | more
        # A quantity of pint is no JSON, but its text tells it.
        told = json.dumps(settings, sort_keys=True, default=str)
        runs = self._store.kept(
            [_core.__build__, drive.resolved().text, self._vary, told],
            lambda: sweep(drive, self._vary, jobs=self._jobs, progress=self._share, **settings),
        )
        self._done += 1
        failed = [str(it) for it in runs["error"].to_numpy() if it]
        if failed:
            raise SimulationError(f"{name}: {failed[0]}", name)
        found, self.units = read_off(runs, self.outputs)
        return found

    def _share(self, share: float) -> None:
        if self._tell is not None:
            self._tell(min((self._done + share) / self._count, 1.0))
