"""The commands `check-data` and `compare`, which the core leaves to this package."""

from __future__ import annotations

import json
import math
import os
import sys
import tomllib
import warnings
from collections.abc import Mapping
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from chaindrive import _core
from chaindrive._core import NewFile
from chaindrive.drive import Drive, load
from chaindrive.errors import (
    ChaindriveError,
    MeasurementError,
    MeasurementWarning,
    ProgramError,
    SceneError,
    WriteError,
    tell,
)
from chaindrive.measurement.checking import check_data, run_for
from chaindrive.measurement.comparison import compare
from chaindrive.measurement.record import measured
from chaindrive.reporting import named, report
from chaindrive.results import open_result

__all__ = ["command"]

_BAD_INPUT, _NOT_WRITTEN = 2, 3
#: Arguments of `measured` that a rig file may have.
_RIG = ("channels", "turns", "time", "rate", "start", "until", "orders")
_RIG_TEXT = ("encoding", "decimal", "separator")


def command(verb: str, options: Mapping[str, Any]) -> int:
    """Do what a command line asks about a measurement, and return the exit code.

    Parameters
    ----------
    verb
        ``check-data`` or ``compare``.
    options
        Its options by name, as the core has read them.
    """
    does = {"check-data": _check, "compare": _compare}[verb]
    try:
        with warnings.catch_warnings():
            # The page tells them.
            warnings.simplefilter("ignore", MeasurementWarning)
            page, answer = does(options)
    except (ProgramError, KeyboardInterrupt):
        raise
    except WriteError as error:
        return _refused(options, error, _NOT_WRITTEN)
    except (ChaindriveError, ValueError, OSError, ModuleNotFoundError) as error:
        return _refused(options, error, _BAD_INPUT)
    if options["json"]:
        page = _core.plain_json(json.dumps(_plain(answer), indent=2, ensure_ascii=False))
    try:
        print(page, flush=True)
    except BrokenPipeError:
        # Who reads no further is no failure; Python would complain when it ends.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    return 0


def _refused(options: Mapping[str, Any], error: Exception, code: int) -> int:
    if not options["json"]:
        tell(error)
        return code
    place = getattr(error, "path", None)
    problems = [
        {
            "path": it.path,
            "line": it.line,
            "column": it.column,
            "what": it.message,
            "remedy": it.hint,
        }
        for it in (error.problems if isinstance(error, SceneError) else [])
    ]
    told: dict[str, Any] = {"what": str(error), "exit_code": code, "problems": problems}
    document = {"error": ({"where": place} if place else {}) | told}
    print(_core.plain_json(json.dumps(document, indent=2, ensure_ascii=False)), file=sys.stderr)
    return code


def _record(options: Mapping[str, Any]) -> xr.Dataset:
    """Return the measurement, read as the rig file says."""
    rig: dict[str, Any] = {}
    if options["rig"] is not None:
        place = Path(options["rig"])
        try:
            rig = tomllib.loads(place.read_text(encoding="utf-8"))
        except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
            raise MeasurementError(f"{place}: this is no TOML: {error}", place) from error
        known = (*_RIG, *_RIG_TEXT)
        strange = [it for it in rig if it not in known]
        if strange:
            message = f"{place}: a rig has no {strange[0]!r}"
            raise MeasurementError(message, place, f"it has {', '.join(known)}")
    return measured(options["data"], **rig)


def _drive(source: str) -> Drive:
    found = named(source)
    return found if isinstance(found, Drive) else load(found)


def _free(texts: list[str]) -> dict[str, tuple[Any, Any]] | None:
    """Return bounds by path, of texts such as ``chain.stiffness=10 MN/m..40 MN/m``."""
    found = {}
    for text in texts:
        path, _, bounds = text.partition("=")
        low, dots, high = bounds.partition("..")
        if not (path and dots):
            message = f"--free {text}: this is no path and two bounds"
            raise MeasurementError(
                message, "free", 'such as --free "chain.stiffness=10 MN/m..40 MN/m"'
            )
        found[path.strip()] = (_number(low), _number(high))
    return found or None


def _number(text: str) -> Any:
    try:
        return float(text)
    except ValueError:
        return text.strip()


def _check(options: Mapping[str, Any]) -> tuple[str, dict[str, Any]]:
    data = _record(options)
    # A bar is shown where somebody can see it, and its package is there.
    seen = sys.stderr.isatty() and find_spec("tqdm") is not None
    drive = _drive(options["source"])
    found = check_data(drive, data, _free(options["free"]), progress=seen)
    answer: dict[str, Any] = {
        "measured_from": data.attrs["measured_from"],
        "findings": list(data.attrs["findings"]),
        "findings_note": data.attrs["findings_note"],
        "problems": list(found.attrs["problems"]),
        "channels": _rows(
            found, "channel", ("quantity", "unit", "measured_mean", "simulated_mean", "problem")
        ),
    }
    if "parameter" in found.dims:
        answer |= {
            "identified": bool(found.attrs["identified"]),
            "silent": list(found.attrs["silent"]),
            "combinations": list(found.attrs["combinations"]),
            "eigenvalues": found["eigenvalue"].to_numpy().tolist(),
            "parameters": _rows(
                found, "parameter", ("start", "low", "high", "effect", "error", "length")
            ),
        }
    return str(found.attrs["summary"]), answer


def _compare(options: Mapping[str, Any]) -> tuple[str, dict[str, Any]]:
    place = None
    if options["output"] is not None:
        # Before anything is simulated.
        place = NewFile(options["output"], options["overwrite"])
        if Path(options["output"]).suffix not in (".html", ".htm"):
            message = f"{options['output']}: the name must end in .html"
            raise MeasurementError(message, options["output"])
    data = _record(options)
    source = options["source"]
    if Path(source).suffix == ".zarr":
        run = open_result(source).load()
    else:
        run, _ = run_for(_drive(source), data)
    found = compare(run, data)
    if place is not None:
        place.write(report(run, comparison=found).encode())
    answer: dict[str, Any] = {
        "verdict": found.attrs["verdict"],
        "level": found.attrs["level"],
        "shaft": found.attrs["shaft"] or None,
        "measured_from": data.attrs["measured_from"],
        "findings": list(data.attrs["findings"]),
        "findings_note": data.attrs["findings_note"],
        "quantities": [
            _of_quantity(found.isel(quantity=n)) for n in range(found.sizes["quantity"])
        ],
    }
    return str(found.attrs["summary"]), answer


def _of_quantity(found: xr.Dataset) -> dict[str, Any]:
    columns = (
        "measured",
        "simulated",
        "difference",
        "half_width",
        "numerical",
        "simulated_error",
        "measured_error",
        "sensor",
        "judgement",
        "reason",
    )
    told: dict[str, Any] = {
        "quantity": found["quantity"].item(),
        "channel": found["channel"].item(),
        "unit": found["unit"].item(),
        "verdict": found["verdict"].item(),
        "statistics": _rows(found, "statistic", columns),
    }
    if "order" in found.dims:
        told["orders"] = _rows(
            found,
            "order",
            (
                "order_name",
                "measured_amplitude",
                "simulated_amplitude",
                "amplitude_half_width",
                "measured_phase",
                "simulated_phase",
                "order_judgement",
            ),
        )
    if "line" in found.dims:
        told["lines"] = _rows(found, "line", ("line_frequency", "mesh_frequency"))
    return told


def _rows(found: xr.Dataset, dim: str, columns: tuple[str, ...]) -> list[dict[str, Any]]:
    """Return columns along a dimension as a list of objects, its label first."""
    labels = found[dim].to_numpy().tolist()
    tables = [(name, found[name].to_numpy().tolist()) for name in columns]
    return [
        {dim: label} | {name: values[row] for name, values in tables}
        for row, label in enumerate(labels)
    ]


def _plain(value: Any) -> Any:
    """Return a document of JSON: numbers that are none become null."""
    if isinstance(value, Mapping):
        return {str(key): _plain(it) for key, it in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(it) for it in value]
    if isinstance(value, np.generic):
        value = value.item()
    return None if isinstance(value, float) and not math.isfinite(value) else value
