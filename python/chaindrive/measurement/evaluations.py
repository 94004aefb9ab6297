"""Runs of a fit, kept under the bits of their parameters: none is computed twice."""

from __future__ import annotations

import hashlib
import io
import json
import os
import struct
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np
import xarray as xr

from chaindrive import _core
from chaindrive._core import NewFile
from chaindrive.drive import Drive
from chaindrive.errors import MeasurementError, SimulationError
from chaindrive.measurement.sensitivities import as_run
from chaindrive.sweeping import sweep

__all__ = ["Evaluations", "RunStore"]

Row = Mapping[str, float]

#: Variants of a part that an executor computes: what is lost when the program is killed [–].
_PART = 32
#: Errors of reading a file that is cut off, or has single bits wrong.
_DAMAGES = (OSError, ValueError, KeyError, EOFError, RuntimeError, BadZipFile)


class RunStore:
    """Runs by key: in memory, or in a folder that outlives the program."""

    def __init__(self, folder: str | os.PathLike[str] | None) -> None:
        self.folder = None if folder is None else Path(folder)
        self.computed = 0
        """Runs that were computed."""
        self._runs: dict[str, xr.Dataset] = {}
        if self.folder is not None:
            try:
                self.folder.mkdir(parents=True, exist_ok=True)
            except OSError as error:
                message = f"{folder} cannot be a store: {error.strerror}"
                raise MeasurementError(message, folder, "give a folder that can be written") from (
                    error
                )

    def get(self, key: str) -> xr.Dataset | None:
        """Return the run of a key, or None."""
        if self.folder is None:
            return self._runs.get(key)
        file = self.folder / f"{key}.npz"
        try:
            with np.load(file, allow_pickle=False) as arrays:
                about = json.loads(str(arrays["about"]))
                parts = {
                    name: (tuple(dims), arrays[name], about["of"][name])
                    for name, dims in about["dims"].items()
                }
        except FileNotFoundError:
            return None
        except _DAMAGES as error:
            message = f"{file} is no run of a fit: {error}"
            raise MeasurementError(message, file, "delete it, and it is computed again") from error
        found = xr.Dataset(parts, attrs=about["attrs"])
        return found.set_coords([name for name in about["coords"] if name in found])

    def put(self, key: str, run: xr.Dataset) -> None:
        """Keep a run."""
        self.computed += 1
        if self.folder is None:
            self._runs[key] = run
            return
        names = [str(name) for name in run.variables]
        about = {
            "dims": {name: list(run[name].dims) for name in names},
            "of": {name: _plain(run[name].attrs) for name in names},
            "coords": [str(name) for name in run.coords],
            "attrs": _plain(run.attrs),
        }
        arrays: dict[str, Any] = {name: run[name].to_numpy() for name in names}
        made = io.BytesIO()
        np.savez(made, about=np.array(json.dumps(about)), **arrays)
        # Put there whole: a fit that is killed leaves no broken file.
        NewFile(self.folder / f"{key}.npz").write(made.getvalue())

    def kept(self, of: Any, compute: Callable[[], xr.Dataset]) -> xr.Dataset:
        """Return the run of what identifies it, and compute it where it is not there."""
        key = _key(json.dumps(of))
        found = self.get(key)
        if found is None:
            found = compute()
            self.put(key, found)
        return found


class Evaluations:
    """Runs of one drive with everything frozen but its parameters."""

    def __init__(
        self,
        drive: Drive,
        run: xr.Dataset,
        settings: Mapping[str, Any],
        store: RunStore,
        workers: Mapping[str, Any],
    ) -> None:
        self.drive, self.run, self.store = drive, run, store
        #: ``jobs`` and ``executor``, as `sweep` takes them.
        self.workers = workers
        recorded = sorted(str(name) for name in run.data_vars if "time" in run[name].dims)
        self.settings: dict[str, Any] = {
            "until": float(run.attrs["until"]),
            "run_in": float(run.attrs.get("run_in", 0.0)),
            "every": float(run.attrs["every"]),
            "record": recorded,
            **settings,
        }
        identity = [_core.__build__, drive.resolved().text, self.settings]
        self._identity = json.dumps(identity, sort_keys=True)

    def beside(self, run: xr.Dataset) -> Evaluations:
        """Return the same with method, step and run-in of another run."""
        chosen = {"method": run.attrs["method"], "step": float(run.attrs["step"])}
        return Evaluations(self.drive, run, chosen, self.store, self.workers)

    def runs(self, rows: Sequence[Row], *, may_fail: bool = False) -> list[xr.Dataset | None]:
        """Return the run of every row of values by path; None for one that fails, if it may.

        Raises
        ------
        SimulationError
            A variant cannot be simulated.
        """
        if not any(rows):
            # Sensors alone are free, of a drive that has no phase.
            return [self.run for _ in rows]
        keys = [self._key(row) for row in rows]
        found = {key: self.store.get(key) for key in dict.fromkeys(keys)}
        wanted = {key: row for key, row in zip(keys, rows, strict=True) if found[key] is None}
        # What a part has computed is kept before the next one begins.
        size = _PART if self.workers["executor"] else self.workers["jobs"] or os.cpu_count() or 1
        pending = list(wanted.items())
        for begin in range(0, len(pending), size):
            found |= self._computed(dict(pending[begin : begin + size]), may_fail)
        return [found[key] for key in keys]

    def _key(self, row: Row) -> str:
        bits = b"".join(
            path.encode() + struct.pack("<d", value) for path, value in sorted(row.items())
        )
        return _key(self._identity, bits)

    def _computed(self, wanted: Mapping[str, Row], may_fail: bool) -> dict[str, xr.Dataset | None]:
        rows = list(wanted.values())
        design = {path: [row[path] for row in rows] for path in rows[0]}
        try:
            swept = sweep(self.drive, design=design, **self.workers, **self.settings)
        except KeyboardInterrupt as stop:
            partly = vars(stop).get("result")
            if partly is not None:
                self._take(wanted, partly)
            raise
        found = self._take(wanted, swept)
        failed = [str(it) for it in swept["error"].to_numpy() if it]
        if failed and not may_fail:
            message = f"a variant within the bounds cannot be simulated: {failed[0]}"
            raise SimulationError(message, "free")
        return found

    def _take(self, wanted: Mapping[str, Row], swept: xr.Dataset) -> dict[str, xr.Dataset | None]:
        found: dict[str, xr.Dataset | None] = {}
        for number, key in enumerate(wanted):
            variant = swept.isel(variant=number)
            if str(variant["error"].item()):
                found[key] = None
                continue
            run = as_run(variant, self.run)
            run = run.drop_vars([name for name in run.coords if name not in self.run.coords])
            self.store.put(key, run)
            found[key] = run
        return found


def _key(identity: str, bits: bytes = b"") -> str:
    return hashlib.sha256(identity.encode() + bits).hexdigest()[:32]


def _plain(attributes: Mapping[Any, Any]) -> dict[str, Any]:
    """Return attributes as JSON takes them."""
    return {
        str(name): it.tolist() if isinstance(it, np.ndarray | np.generic) else it
        for name, it in attributes.items()
    }
