"""The commands of measurements and assumptions, which the core leaves to this package."""

from __future__ import annotations

import json
import math
import os
import sys
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from chaindrive import _core
from chaindrive._core import NewFile
from chaindrive.assumptions.command import ranked, spread
from chaindrive.errors import (
    ChaindriveError,
    MeasurementError,
    MeasurementWarning,
    ProgramError,
    SceneError,
    WriteError,
    tell,
)
from chaindrive.measurement.arguments import drive_of, is_seen, ranges_of, record_of, rows_of
from chaindrive.measurement.checking import check_data, run_for
from chaindrive.measurement.comparison import compare
from chaindrive.measurement.fit_command import calibrated, foretold, proposed
from chaindrive.reporting import report
from chaindrive.results import open_result

__all__ = ["command"]

_BAD_INPUT, _NOT_WRITTEN = 2, 3


def command(verb: str, options: Mapping[str, Any]) -> int:
    """Do what a command line asks of this package, and return the exit code.

    Parameters
    ----------
    verb
        ``check-data``, ``compare``, ``calibrate``, ``predict``, ``next-measurement``,
        ``uncertainty`` or ``tornado``.
    options
        Its options by name, as the core has read them.
    """
    does = _VERBS[verb]
    try:
        with warnings.catch_warnings():
            # The page tells them.
            warnings.simplefilter("ignore", MeasurementWarning)
            page, answer = does(options)
    except ProgramError:
        raise
    except KeyboardInterrupt:
        if options.get("store") is not None:
            tell(f"{options['store']} holds what was computed: the same command goes on")
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


def _check(options: Mapping[str, Any]) -> tuple[str, dict[str, Any]]:
    data = record_of(options)
    drive = drive_of(options)
    free = ranges_of("free", options["free"]) or None
    found = check_data(drive, data, free, progress=is_seen())
    answer: dict[str, Any] = {
        "measured_from": data.attrs["measured_from"],
        "findings": list(data.attrs["findings"]),
        "findings_note": data.attrs["findings_note"],
        "problems": list(found.attrs["problems"]),
        "channels": rows_of(
            found, "channel", ("quantity", "unit", "measured_mean", "simulated_mean", "problem")
        ),
    }
    if "parameter" in found.dims:
        answer |= {
            "identified": bool(found.attrs["identified"]),
            "silent": list(found.attrs["silent"]),
            "combinations": list(found.attrs["combinations"]),
            "eigenvalues": found["eigenvalue"].to_numpy().tolist(),
            "parameters": rows_of(
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
    data = record_of(options)
    source = options["source"]
    if Path(source).suffix == ".zarr":
        run = open_result(source).load()
    else:
        run, _ = run_for(drive_of(options), data)
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
        "statistics": rows_of(found, "statistic", columns),
    }
    if "order" in found.dims:
        told["orders"] = rows_of(
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
        told["lines"] = rows_of(found, "line", ("line_frequency", "mesh_frequency"))
    return told


def _plain(value: Any) -> Any:
    """Return a document of JSON: numbers that are none become null."""
    if isinstance(value, Mapping):
        return {str(key): _plain(it) for key, it in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(it) for it in value]
    if isinstance(value, np.generic):
        value = value.item()
    return None if isinstance(value, float) and not math.isfinite(value) else value


_VERBS = {
    "check-data": _check,
    "compare": _compare,
    "calibrate": calibrated,
    "predict": foretold,
    "next-measurement": proposed,
    "uncertainty": spread,
    "tornado": ranked,
}
